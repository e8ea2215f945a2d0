//! Visibility along one line, exactly: what it meets in order, and what is free in between.
//!
//! After [Bittner02, 2.2.3] (maximal free line segments). Both ends are grid points, so every
//! order along the line is decided by integers.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use antumbra_kernel::{Plane, Point, sub};
use antumbra_scene::{PolygonId, PolygonRef};

use crate::caster::Caster;
use crate::line::{FineLine, Meeting, Position};
use crate::verdict::FinePoint;

/// A polygon on a segment's way.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// The polygon.
    pub polygon: PolygonId,
    /// Where the segment meets it, from 0 (start) to 1 (end); rounded for output.
    pub at: f64,
    /// Where it leaves it: the same, unless it runs inside the polygon's plane.
    pub until: f64,
}

/// What a segment meets.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// All occluders that it meets (touching counts), in exact order along it, ties by number.
    pub hits: Vec<Hit>,
    /// The maximal free parts, as parameters.
    pub free: Vec<[f64; 2]>,
}

struct Stretch {
    polygon: PolygonId,
    from: Position,
    to: Position,
}

impl Caster<'_> {
    /// Follows the segment between two grid points; `None` if they coincide. Exact order and
    /// membership, degree 8; the parameters are rounded on the way out.
    #[must_use]
    pub fn trace(&self, from: Point, to: Point) -> Option<Trace> {
        let line = FineLine::new(FinePoint::from_grid(from), FinePoint::from_grid(to))?;
        let mut met: Vec<Stretch> = Vec::new();
        self.visit(&line.segment(), (-1e-9, 1.0 + 1e-9), 1.0, |items, _, _| {
            for &id in items {
                if self.occludes(id)
                    && met.iter().all(|m| m.polygon != id)
                    && let Some(stretch) = stretch(&line, &self.scene().polygon(id))
                {
                    met.push(stretch);
                }
            }
            ControlFlow::Continue(())
        });
        met.sort_by(|a, b| a.from.compare(&b.from).then(a.polygon.cmp(&b.polygon)));
        let mut free = Vec::new();
        let mut done = Position::START;
        for m in &met {
            if m.from.compare(&done) == Ordering::Greater {
                free.push([done.to_f64(), m.from.to_f64()]);
            }
            if m.to.compare(&done) == Ordering::Greater {
                done = m.to;
            }
        }
        if Position::END.compare(&done) == Ordering::Greater {
            free.push([done.to_f64(), 1.0]);
        }
        let hits = met
            .iter()
            .map(|m| Hit {
                polygon: m.polygon,
                at: m.from.to_f64(),
                until: m.to.to_f64(),
            })
            .collect();
        Some(Trace { hits, free })
    }
}

/// The part of the segment inside a polygon.
fn stretch(line: &FineLine, polygon: &PolygonRef<'_>) -> Option<Stretch> {
    let inside = |p: &Position| {
        p.compare(&Position::START) != Ordering::Less
            && p.compare(&Position::END) != Ordering::Greater
    };
    let id = polygon.id;
    if let Some(at) = line.position(polygon.plane) {
        let met = line.meeting(polygon.corners, polygon.plane) != Meeting::Miss;
        return (met && inside(&at)).then_some(Stretch {
            polygon: id,
            from: at,
            to: at,
        });
    }
    let (p, _) = line.evaluate(polygon.plane);
    if p != 0 {
        return None;
    }
    // In the polygon's plane: clip by the planes that stand on its edges, inner side positive.
    let (mut from, mut to) = (Position::START, Position::END);
    let n = polygon.corners.len();
    for i in 0..n {
        let (a, b) = (polygon.corners[i], polygon.corners[(i + 1) % n]);
        let (u, v) = edge_values(polygon.plane, a, b, line);
        if u < 0 && v < 0 {
            return None;
        }
        if u < 0 || v < 0 {
            let at = Position::new(u, v);
            if u < 0 && at.compare(&from) == Ordering::Greater {
                from = at;
            }
            if v < 0 && at.compare(&to) == Ordering::Less {
                to = at;
            }
        }
    }
    (from.compare(&to) != Ordering::Greater).then_some(Stretch {
        polygon: id,
        from,
        to,
    })
}

/// The values of the plane through an edge, perpendicular to the polygon, at both ends of the
/// line, which runs between grid points: 103 bits.
fn edge_values(plane: &Plane, a: Point, b: Point, line: &FineLine) -> (i128, i128) {
    let e = sub(b, a);
    // n x e points inwards, since the corners turn counter-clockwise about the normal.
    let n = plane.normal.map(i128::from);
    let e = e.map(i128::from);
    let inward = [
        n[1] * e[2] - n[2] * e[1],
        n[2] * e[0] - n[0] * e[2],
        n[0] * e[1] - n[1] * e[0],
    ];
    let at = |p: &FinePoint| {
        let q = FinePoint::from_grid(a);
        (0..3)
            .map(|k| inward[k] * i128::from((p.0[k] - q.0[k]) >> crate::verdict::FINE_BITS))
            .sum::<i128>()
    };
    (at(&line.u), at(&line.v))
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Point;
    use antumbra_scene::{Faces, ObjectInput, PartInput, Scene, SceneBuilder, SceneInput};

    use crate::Caster;

    fn scene(polygons: &[&[[f64; 3]]]) -> Scene {
        let objects = polygons
            .iter()
            .map(|corners| {
                let mut faces = Faces::default();
                faces.push(&(0..corners.len() as u32).collect::<Vec<_>>());
                let part = PartInput {
                    class: None,
                    translucent: false,
                    vertices: corners.to_vec(),
                    faces,
                };
                ObjectInput {
                    name: None,
                    parts: vec![part],
                }
            })
            .collect();
        let input = SceneInput {
            objects,
            source_name: "test".into(),
        };
        SceneBuilder::new(input)
            .grid(Some(1.0))
            .build()
            .expect("a sound scene")
            .0
    }

    #[test]
    fn hits_come_in_order_and_free_parts_lie_between() {
        let wall = |x: f64| {
            [
                [x, -4.0, -4.0],
                [x, 4.0, -4.0],
                [x, 4.0, 4.0],
                [x, -4.0, 4.0],
            ]
        };
        let (a, b) = (wall(4.0), wall(-4.0));
        let s = scene(&[&a, &b]);
        let caster = Caster::new(&s);
        let trace = caster
            .trace(Point::new(-8, 0, 0), Point::new(8, 1, 0))
            .expect("two points");
        let ids: Vec<u32> = trace.hits.iter().map(|h| h.polygon.0).collect();
        assert_eq!(ids, [1, 0]);
        assert_eq!(trace.free, [[0.0, 0.25], [0.25, 0.75], [0.75, 1.0]]);
    }

    #[test]
    fn a_segment_in_the_plane_of_a_polygon_is_blocked_along_it() {
        let floor = [
            [-4.0, -4.0, 0.0],
            [4.0, -4.0, 0.0],
            [4.0, 4.0, 0.0],
            [-4.0, 4.0, 0.0],
        ];
        let s = scene(&[&floor]);
        let caster = Caster::new(&s);
        let z = -s.grid().origin()[2] as i32;
        let trace = caster
            .trace(Point::new(-8, 0, z), Point::new(8, 0, z))
            .expect("two points");
        assert_eq!(trace.free, [[0.0, 0.25], [0.75, 1.0]]);
        let beside = caster
            .trace(Point::new(-8, 5, z), Point::new(8, 5, z))
            .expect("two points");
        assert_eq!(beside.free, [[0.0, 1.0]]);
        let edge = caster
            .trace(Point::new(-8, 4, z), Point::new(8, 4, z))
            .expect("two points");
        assert_eq!(edge.free, [[0.0, 0.25], [0.75, 1.0]]);
    }
}
