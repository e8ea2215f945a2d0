//! What lines leave and what they reach: the gates of a cell and of a target, and which pairs of
//! them have lines in between.

use std::ops::Range;

use antumbra_kernel::{Aabb, Plane, Point, Sign};
use antumbra_scene::{CellKind, PolygonId, Scene, ViewCell};

use crate::proof::Target;

/// An oriented convex polygon that lines cross along its normal.
#[derive(Clone, Debug)]
pub(super) struct Gate {
    /// Counter-clockwise about the normal.
    pub corners: Vec<Point>,
    /// The plane, oriented alike.
    pub plane: Plane,
}

impl Gate {
    fn along(corners: &[Point], plane: &Plane) -> Self {
        Self {
            corners: corners.to_vec(),
            plane: *plane,
        }
    }

    fn against(corners: &[Point], plane: &Plane) -> Self {
        Self {
            corners: corners.iter().rev().copied().collect(),
            plane: plane.flipped(),
        }
    }

    /// Whether some corner lies strictly on a side of a plane.
    pub(super) fn reaches(&self, plane: &Plane, side: Sign) -> bool {
        self.corners.iter().any(|&p| plane.side(p) == side)
    }

    /// Whether there are corners strictly on both sides of a plane.
    pub(super) fn straddles(&self, plane: &Plane) -> bool {
        self.reaches(plane, Sign::Positive) && self.reaches(plane, Sign::Negative)
    }
}

/// A face of a box, as a rectangle with an orientation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    axis: usize,
    /// Whether the normal points to larger coordinates.
    up: bool,
    at: i32,
    low: [i32; 3],
    high: [i32; 3],
}

impl Face {
    /// Face `number` (-x, +x, -y, +y, -z, +z) of a box; `None` if it has no area.
    fn of(bounds: &Aabb, number: usize, outward: bool) -> Option<Self> {
        let (axis, upper) = (number / 2, number % 2 == 1);
        let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
        let face = Self {
            axis,
            up: upper == outward,
            at: if upper { high[axis] } else { low[axis] },
            low,
            high,
        };
        face.has_area().then_some(face)
    }

    fn has_area(&self) -> bool {
        (0..3).all(|k| k == self.axis || self.low[k] < self.high[k])
    }

    /// The part before (behind the plane of) or beyond (in front of) another face of another axis.
    fn cut(mut self, other: &Self, beyond: bool) -> Option<Self> {
        let k = other.axis;
        if k != self.axis {
            if other.up == beyond {
                self.low[k] = self.low[k].max(other.at);
            } else {
                self.high[k] = self.high[k].min(other.at);
            }
        }
        self.has_area().then_some(self)
    }

    fn gate(&self) -> Gate {
        let (k, i, j) = (self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3);
        let corner = |a: i32, b: i32| {
            let mut p = [0; 3];
            p[k] = self.at;
            p[i] = a;
            p[j] = b;
            Point::from(p)
        };
        let mut corners = vec![
            corner(self.low[i], self.low[j]),
            corner(self.high[i], self.low[j]),
            corner(self.high[i], self.high[j]),
            corner(self.low[i], self.high[j]),
        ];
        if !self.up {
            corners.reverse();
        }
        let mut normal = [0; 3];
        normal[k] = if self.up { 1 } else { -1 };
        let plane = Plane {
            normal,
            offset: i128::from(normal[k]) * i128::from(self.at),
        };
        Gate { corners, plane }
    }
}

/// A gate before it is cut for its partner.
#[derive(Clone, Debug)]
pub(super) enum Opening {
    /// A face of a box.
    Face(Face),
    /// A polygon.
    Polygon(Gate),
}

impl Opening {
    pub(super) fn gate(&self) -> Gate {
        match self {
            Self::Face(face) => face.gate(),
            Self::Polygon(gate) => gate.clone(),
        }
    }
}

/// The openings of something, by number; `None` where there is none.
pub(super) type Openings = Vec<Option<Opening>>;

/// Where lines come from.
#[derive(Clone, Debug)]
pub(super) struct Source {
    /// Whether the cell is a box.
    pub is_box: bool,
    /// The cell's box.
    pub bounds: Aabb,
    /// All gates, by number.
    pub openings: Openings,
    /// The corners of the box, or of all polygons.
    pub corners: Vec<Point>,
    /// The polygons that take no part.
    pub own: Range<u32>,
}

impl Source {
    /// The source of a cell; `None` if it is an object that the scene does not have.
    pub(super) fn new(scene: &Scene, cell: &ViewCell) -> Option<Self> {
        match cell.kind {
            CellKind::Box => Some(Self {
                is_box: true,
                bounds: cell.bounds,
                openings: faces(&cell.bounds, true),
                corners: cell.bounds.corners().to_vec(),
                own: 0..0,
            }),
            CellKind::Object(id) => {
                let own = scene.objects().get(id.index())?.polygons.clone();
                let mut openings = Vec::new();
                let mut corners = Vec::new();
                for polygon in own.clone().map(|i| scene.polygon(PolygonId(i))) {
                    openings.extend(both_ways(polygon.corners, polygon.plane));
                    corners.extend_from_slice(polygon.corners);
                }
                Some(Self {
                    is_box: false,
                    bounds: cell.bounds,
                    openings,
                    corners,
                    own,
                })
            }
        }
    }
}

/// The gates of a target, by number.
pub(super) fn target_openings(scene: &Scene, target: &Target) -> Openings {
    match *target {
        Target::Box(bounds) => faces(&bounds, false),
        Target::Polygon(id) => {
            let polygon = scene.polygon(id);
            both_ways(polygon.corners, polygon.plane).to_vec()
        }
    }
}

fn faces(bounds: &Aabb, outward: bool) -> Openings {
    (0..6)
        .map(|number| Face::of(bounds, number, outward).map(Opening::Face))
        .collect()
}

fn both_ways(corners: &[Point], plane: &Plane) -> [Option<Opening>; 2] {
    [Gate::along(corners, plane), Gate::against(corners, plane)]
        .map(|gate| Some(Opening::Polygon(gate)))
}

/// The two gates as lines use them, or `None` if no line leaves the first and then crosses the
/// second.
pub(super) fn gates_between(from: &Opening, to: &Opening) -> Option<(Gate, Gate)> {
    let (from, to) = if let (Opening::Face(a), Opening::Face(b)) = (from, to) {
        (a.cut(b, false)?.gate(), b.cut(a, true)?.gate())
    } else {
        (from.gate(), to.gate())
    };
    let exist = to.reaches(&from.plane, Sign::Positive) && from.reaches(&to.plane, Sign::Negative);
    exist.then_some((from, to))
}

#[cfg(test)]
mod tests {
    use super::{Face, Opening, faces, gates_between};
    use antumbra_kernel::{Aabb, Plane, Point, Sign};

    #[test]
    fn faces_turn_counter_clockwise_about_their_normals() {
        let bounds = Aabb::new(Point::new(-1, -2, -3), Point::new(4, 5, 6));
        for number in 0..6 {
            for outward in [true, false] {
                let gate = Face::of(&bounds, number, outward).expect("an area").gate();
                let c = &gate.corners;
                let turned = Plane::through(c[0], c[1], c[2]);
                for k in 0..3 {
                    assert_eq!(turned.normal[k].signum(), gate.plane.normal[k]);
                }
                assert!(c.iter().all(|&p| gate.plane.side(p) == Sign::Zero));
                let inside = gate.plane.side(Point::new(0, 0, 0));
                assert_eq!(inside.is_negative(), outward);
            }
        }
    }

    #[test]
    fn only_gates_that_face_each_other_have_lines() {
        let cell = Aabb::new(Point::new(0, 0, 0), Point::new(10, 10, 10));
        let target = Aabb::new(Point::new(20, 2, 2), Point::new(30, 30, 8));
        let (sources, targets) = (faces(&cell, true), faces(&target, false));
        let count = |s: &Option<Opening>| {
            targets
                .iter()
                .flatten()
                .filter(|t| gates_between(s.as_ref().expect("area"), t).is_some())
                .count()
        };
        // Through +x all faces but the far one and those that the whole cell lies behind can be
        // entered; through -x none.
        assert_eq!(count(&sources[0]), 0);
        assert!(count(&sources[1]) >= 1);
        let (a, b) = gates_between(
            sources[3].as_ref().expect("area"),
            targets[0].as_ref().expect("area"),
        )
        .expect("lines through +y into -x");
        // The target face is cut to what lies beyond y = 10.
        assert!(b.corners.iter().all(|p| p.y >= 10) && a.corners.len() == 4);
    }
}
