//! Does a point see a polygon? Exact, by subtraction of convex cones of directions in R^3.
//!
//! The from-point row of the theory's table: a hyperplane through the viewpoint e and an edge u, v
//! has the normal (u - e) x (v - e), depth order along a direction is linear once both planes are
//! fixed. Directions are products of normals, so big integers carry them; pieces are convex
//! polygons of directions, and each has its own vertex sum as a rational point inside.

use std::ops::ControlFlow;

use antumbra_kernel::{Plane, Point, Sign, cross, sub};
use antumbra_scene::{PolygonId, PolygonRef};
use dashu_int::IBig;

use crate::caster::{Caster, Segment};
use crate::line::lies_in;

/// The verdict about a point and a polygon.
#[derive(Clone, Debug, PartialEq)]
pub enum PointVerdict {
    /// An open set of directions is free; one of them, to the polygon, in fractional grid
    /// coordinates (verified before it was rounded).
    Visible {
        /// Where the free segment meets the polygon.
        at: [f64; 3],
        /// How many splits it took.
        splits: u64,
    },
    /// No open set of directions is free.
    Hidden {
        /// How many splits it took.
        splits: u64,
        /// How many pieces were found blocked.
        leaves: u64,
    },
}

type Direction = [IBig; 3];

/// The polygon's plane as seen from the eye: the normal points away, the distance is positive.
struct Facing {
    normal: [IBig; 3],
    distance: IBig,
    flipped: bool,
}

impl Facing {
    fn new(plane: &Plane, eye: Point) -> Option<Self> {
        let d = -plane.evaluate(eye);
        if d == 0 {
            return None;
        }
        let flipped = d < 0;
        let normal = plane
            .normal
            .map(|c| IBig::from(if flipped { -c } else { c }));
        Some(Self {
            normal,
            distance: IBig::from(d.abs()),
            flipped,
        })
    }
}

impl Caster<'_> {
    /// Decides whether a grid point sees a polygon. Exact; occluders in the polygon's plane do not
    /// hide it, and those whose plane holds the eye block no open set. A polygon seen edge-on is
    /// hidden.
    #[must_use]
    pub fn point_sees(&self, eye: Point, target: PolygonId) -> PointVerdict {
        let polygon = self.scene().polygon(target);
        let Some(facing) = Facing::new(polygon.plane, eye) else {
            return PointVerdict::Hidden {
                splits: 0,
                leaves: 0,
            };
        };
        let start: Vec<Direction> = polygon
            .corners
            .iter()
            .map(|&c| sub(c, eye).map(IBig::from))
            .collect();
        let (mut splits, mut leaves) = (0, 0);
        let mut stack = vec![start];
        while let Some(piece) = stack.pop() {
            let inner = inner_direction(&piece);
            let Some(blocker) = self.blocker(eye, &inner, &polygon, &facing) else {
                let w = dot(&facing.normal, &inner).to_f64().value();
                let t = facing.distance.to_f64().value() / w;
                let at = std::array::from_fn(|k| eye.to_f64()[k] + t * inner[k].to_f64().value());
                return PointVerdict::Visible { at, splits };
            };
            let mut piece = piece;
            for row in rows(&self.scene().polygon(blocker), eye, &polygon, &facing) {
                let (inside, outside) = split(&piece, &row);
                splits += 1;
                if let Some(outside) = outside {
                    stack.push(outside);
                }
                match inside {
                    Some(inside) => piece = inside,
                    None => break,
                }
            }
            leaves += 1;
        }
        PointVerdict::Hidden { splits, leaves }
    }

    /// An occluder that meets the ray before the target, exactly.
    fn blocker(
        &self,
        eye: Point,
        direction: &Direction,
        target: &PolygonRef<'_>,
        facing: &Facing,
    ) -> Option<PolygonId> {
        let along = dot(&facing.normal, direction);
        let t = facing.distance.to_f64().value() / along.to_f64().value();
        let e = eye.to_f64();
        let end = std::array::from_fn(|k| e[k] + t * direction[k].to_f64().value());
        let mut found = None;
        self.visit(
            &Segment::new(e, end),
            (-1e-9, 1.0 + 1e-9),
            1.0,
            |items, _, _| {
                for &id in items {
                    if self.occludes(id) && id != target.id {
                        let polygon = self.scene().polygon(id);
                        if !lies_in(&polygon, target.plane)
                            && meets(&polygon, eye, direction, facing)
                        {
                            found = Some(id);
                            return ControlFlow::Break(());
                        }
                    }
                }
                ControlFlow::Continue(())
            },
        );
        found
    }
}

/// Whether a ray meets a polygon no later than the target's plane.
fn meets(polygon: &PolygonRef<'_>, eye: Point, d: &Direction, target: &Facing) -> bool {
    let Some(facing) = Facing::new(polygon.plane, eye) else {
        return false;
    };
    let along = dot(&facing.normal, d);
    if sign(&along) != Sign::Positive {
        return false;
    }
    let before = &facing.distance * dot(&target.normal, d) <= &target.distance * along;
    before
        && edge_rows(polygon, eye, facing.flipped)
            .iter()
            .all(|r| !sign(&dot(r, d)).is_negative())
}

/// The inward rows of a polygon's edges, as planes through the eye.
fn edge_rows(polygon: &PolygonRef<'_>, eye: Point, flipped: bool) -> Vec<Direction> {
    let n = polygon.corners.len();
    (0..n)
        .map(|i| {
            let (u, v) = (polygon.corners[i], polygon.corners[(i + 1) % n]);
            let r = cross(sub(u, eye), sub(v, eye)).map(IBig::from);
            if flipped { r.map(|c| -c) } else { r }
        })
        .collect()
}

/// All rows of the directions that a polygon blocks before the target.
fn rows(
    polygon: &PolygonRef<'_>,
    eye: Point,
    target: &PolygonRef<'_>,
    goal: &Facing,
) -> Vec<Direction> {
    let Some(facing) = Facing::new(polygon.plane, eye) else {
        return Vec::new();
    };
    let mut rows = edge_rows(polygon, eye, facing.flipped);
    let eye_side = target.plane.side(eye);
    if polygon
        .corners
        .iter()
        .any(|&c| target.plane.side(c).times(eye_side).is_negative())
    {
        // Before the target: D_o / (n_o . d) < D_t / (n_t . d).
        rows.push(std::array::from_fn(|k| {
            &goal.distance * &facing.normal[k] - &facing.distance * &goal.normal[k]
        }));
    }
    rows
}

/// The parts of a convex cone of directions on both sides of a plane, if they have an interior.
fn split(piece: &[Direction], row: &Direction) -> (Option<Vec<Direction>>, Option<Vec<Direction>>) {
    let values: Vec<IBig> = piece.iter().map(|d| dot(row, d)).collect();
    let (mut inside, mut outside) = (Vec::new(), Vec::new());
    let n = piece.len();
    for i in 0..n {
        let j = (i + 1) % n;
        let (s, t) = (sign(&values[i]), sign(&values[j]));
        if !s.is_negative() {
            inside.push(piece[i].clone());
        }
        if !s.is_positive() {
            outside.push(piece[i].clone());
        }
        if s.times(t).is_negative() {
            let (a, b) = (magnitude(&values[j]), magnitude(&values[i]));
            let d = primitive(std::array::from_fn(|k| {
                &a * &piece[i][k] + &b * &piece[j][k]
            }));
            inside.push(d.clone());
            outside.push(d);
        }
    }
    let has = |s: Sign| values.iter().any(|v| sign(v) == s);
    (
        has(Sign::Positive).then_some(inside),
        has(Sign::Negative).then_some(outside),
    )
}

/// A direction strictly inside: the sum of the vertices, brought to like sizes first.
fn inner_direction(piece: &[Direction]) -> Direction {
    use dashu_int::ops::BitTest;
    let size = |d: &Direction| d.iter().map(BitTest::bit_len).max().unwrap_or(0);
    let largest = piece.iter().map(size).max().unwrap_or(0);
    let mut sum = [IBig::ZERO, IBig::ZERO, IBig::ZERO];
    for d in piece {
        let shift = largest - size(d);
        for k in 0..3 {
            sum[k] += d[k].clone() << shift;
        }
    }
    primitive(sum)
}

fn primitive(d: Direction) -> Direction {
    use dashu_int::ops::Gcd;
    // The greatest common divisor of two zeros is not defined, so zeros are left out.
    let components = d.iter().filter(|c| **c != IBig::ZERO);
    let common = components
        .map(magnitude)
        .reduce(|a, b| IBig::from(a.gcd(b)));
    match common {
        Some(common) if common > IBig::ONE => d.map(|c| c / &common),
        _ => d,
    }
}

fn dot(a: &Direction, b: &Direction) -> IBig {
    (0..3).map(|k| &a[k] * &b[k]).sum()
}

fn sign(v: &IBig) -> Sign {
    Sign::of_ordering(v.cmp(&IBig::ZERO))
}

fn magnitude(v: &IBig) -> IBig {
    if *v < IBig::ZERO { -v } else { v.clone() }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Point;
    use antumbra_scene::{Faces, ObjectInput, PartInput, PolygonId, SceneBuilder, SceneInput};

    use crate::{Caster, PointVerdict};

    /// The middle of the square is straight above: two components of that direction are zero.
    #[test]
    fn a_square_is_seen_along_an_axis() {
        let mut faces = Faces::default();
        faces.push(&[0, 1, 2, 3]);
        let vertices = vec![
            [-4.0, -4.0, 4.0],
            [4.0, -4.0, 4.0],
            [4.0, 4.0, 4.0],
            [-4.0, 4.0, 4.0],
        ];
        let parts = vec![PartInput {
            vertices,
            faces,
            ..PartInput::default()
        }];
        let input = SceneInput {
            objects: vec![ObjectInput { name: None, parts }],
            source_name: "test".into(),
        };
        let (scene, _) = SceneBuilder::new(input)
            .grid(Some(1.0))
            .build()
            .expect("a sound scene");
        let z = scene.bounds().min.z;
        let answer = Caster::new(&scene).point_sees(Point::new(0, 0, z - 4), PolygonId(0));
        let at = [0.0, 0.0, f64::from(z)];
        assert_eq!(answer, PointVerdict::Visible { at, splits: 0 });
    }
}
