//! Exact lines through two finely placed points, and how they cross polygons.
//!
//! A witness must be checkable by anyone, so it is a pair of points with dyadic coordinates in
//! steps of 2^-16 grid units (40 bits). All signs below are exact in 128- or 256-bit integers:
//! sides have 107 bits, plane evaluations 94, products of two evaluations 188.

use std::cmp::Ordering;
use std::ops::ControlFlow;

use antumbra_kernel::plucker::edge_row;
use antumbra_kernel::{Aabb, I256, Plane, Point, Sign};
use antumbra_scene::{PolygonId, PolygonRef};

use crate::caster::{Caster, Segment};
use crate::verdict::{FINE_BITS, FinePoint};

/// How a line meets a closed polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meeting {
    /// Not at all.
    Miss,
    /// In its interior, along (positive) or against the normal.
    Cross(Sign),
    /// On its boundary, or inside its plane.
    Touch,
}

/// An oriented line through two different fine points.
#[derive(Clone, Copy, Debug)]
pub struct FineLine {
    pub(crate) u: FinePoint,
    pub(crate) v: FinePoint,
    d: [i128; 3],
    m: [i128; 3],
}

/// A position along a line: `p / (p - q)` of the way, from a plane's values at both points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    p: i128,
    q: i128,
}

impl Position {
    /// The first point of the line.
    pub(crate) const START: Self = Self { p: 0, q: -1 };
    /// The second point of the line.
    pub(crate) const END: Self = Self { p: 1, q: 0 };

    /// Where a linear function with these values at both points is zero; they differ.
    pub(crate) fn new(p: i128, q: i128) -> Self {
        Self { p, q }
    }

    /// Exact comparison along the line.
    pub(crate) fn compare(&self, other: &Self) -> Ordering {
        // p/(p-q) against r/(r-s): both denominators brought to positive signs.
        let (a, b) = (self.p, self.p - self.q);
        let (c, d) = (other.p, other.p - other.q);
        let lead = I256::product_i128(a, d) - I256::product_i128(c, b);
        let sign = if (b < 0) == (d < 0) {
            lead.sign()
        } else {
            lead.sign().flip()
        };
        match sign {
            Sign::Negative => Ordering::Less,
            Sign::Zero => Ordering::Equal,
            Sign::Positive => Ordering::Greater,
        }
    }

    /// Rounded, for output.
    pub(crate) fn to_f64(self) -> f64 {
        self.p as f64 / (self.p - self.q) as f64
    }
}

impl FineLine {
    /// The line from u to v; `None` if the points coincide.
    #[must_use]
    pub fn new(u: FinePoint, v: FinePoint) -> Option<Self> {
        let (a, b) = (u.0.map(i128::from), v.0.map(i128::from));
        let d = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let m = [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ];
        (u != v).then_some(Self { u, v, d, m })
    }

    /// Where the line crosses a plane, rounded to fractional grid coordinates for output; `None`
    /// if it is parallel to the plane.
    #[must_use]
    pub fn at_plane(&self, plane: &Plane) -> Option<[f64; 3]> {
        let t = self.position(plane)?.to_f64();
        let (u, v) = (self.u.to_f64(), self.v.to_f64());
        Some(std::array::from_fn(|k| u[k] + t * (v[k] - u[k])))
    }

    /// The side of an edge: the row's moment part meets the direction, which is short of one
    /// scale factor, hence the shift.
    fn side(&self, a: Point, b: Point) -> Sign {
        let r = edge_row(a, b);
        let moment: i128 = (0..3).map(|k| i128::from(r[k]) * self.d[k]).sum();
        let direction: i128 = (0..3).map(|k| i128::from(r[3 + k]) * self.m[k]).sum();
        Sign::of((moment << FINE_BITS) + direction)
    }

    /// A plane's values at both points.
    pub(crate) fn evaluate(&self, plane: &Plane) -> (i128, i128) {
        let at = |p: &FinePoint| {
            (0..3)
                .map(|k| i128::from(plane.normal[k]) * i128::from(p.0[k]))
                .sum::<i128>()
                - (plane.offset << FINE_BITS)
        };
        (at(&self.u), at(&self.v))
    }

    /// Where the line crosses a plane; `None` if it is parallel to it.
    pub(crate) fn position(&self, plane: &Plane) -> Option<Position> {
        let (p, q) = self.evaluate(plane);
        (p != q).then_some(Position { p, q })
    }

    /// How the whole line meets a convex polygon.
    pub(crate) fn meeting(&self, corners: &[Point], plane: &Plane) -> Meeting {
        let (p, q) = self.evaluate(plane);
        if p == q {
            return if p == 0 {
                Meeting::Touch
            } else {
                Meeting::Miss
            };
        }
        let direction = if q > p {
            Sign::Positive
        } else {
            Sign::Negative
        };
        let mut touch = false;
        for i in 0..corners.len() {
            match self
                .side(corners[i], corners[(i + 1) % corners.len()])
                .times(direction)
            {
                Sign::Negative => return Meeting::Miss,
                Sign::Zero => touch = true,
                Sign::Positive => {}
            }
        }
        if touch {
            Meeting::Touch
        } else {
            Meeting::Cross(direction)
        }
    }

    /// The segment in doubles, for traversal.
    pub(crate) fn segment(&self) -> Segment {
        Segment::new(self.u.to_f64(), self.v.to_f64())
    }
}

/// What may block a line between its source and its target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Between<'a> {
    /// The plane the line leaves, along its normal.
    pub source: &'a Plane,
    /// Whether polygons in the source plane block (cells: yes; polygons: no).
    pub source_plane_blocks: bool,
    /// The plane the line arrives at.
    pub target: &'a Plane,
    /// A polygon range that takes no part (the source object of a bake).
    pub absent: &'a std::ops::Range<u32>,
}

impl Between<'_> {
    pub(crate) fn takes_part(&self, caster: &Caster<'_>, id: PolygonId) -> bool {
        caster.occludes(id) && !self.absent.contains(&id.0)
    }
}

/// Whether all corners lie in a plane.
pub(crate) fn lies_in(polygon: &PolygonRef<'_>, plane: &Plane) -> bool {
    polygon.corners.iter().all(|&p| plane.side(p).is_zero())
}

/// The first polygon found that blocks or touches the line strictly between source and target
/// (or in the source plane where that blocks); `None` proves that an open set of lines around
/// this one is free, provided it crosses source and target in their interiors.
///
/// Exact: the traversal is conservative, every candidate is decided by integers.
pub(crate) fn obstacle(
    caster: &Caster<'_>,
    line: &FineLine,
    between: &Between<'_>,
) -> Option<PolygonId> {
    let (Some(start), Some(end)) = (line.position(between.source), line.position(between.target))
    else {
        return None;
    };
    let segment = line.segment();
    let mut found = None;
    // One grid step of slack is far above the rounding of 40-bit coordinates in doubles.
    let margin = 1e-9;
    let range = (start.to_f64() - margin, end.to_f64() + margin);
    caster.visit(&segment, range, 1.0, |items, _, _| {
        for &id in items {
            if between.takes_part(caster, id) && near(caster, id, &segment) {
                let polygon = caster.scene().polygon(id);
                if blocks(line, &polygon, between, &start, &end) {
                    found = Some(id);
                    return ControlFlow::Break(());
                }
            }
        }
        ControlFlow::Continue(())
    });
    found
}

/// A double filter: false only if some side is certainly outside.
///
/// Rows are exact, the segment's 40-bit coordinates too; its moment and the six products round by
/// less than 2^-50 of their magnitudes in all, and the bound used is 2^-44.
fn near(caster: &Caster<'_>, id: PolygonId, s: &Segment) -> bool {
    let reach = s
        .from
        .iter()
        .chain(&s.step)
        .fold(1.0_f64, |r, c| r.max(c.abs()));
    let along = dot_abs(caster.normal(id), s.step);
    if along.0.abs() <= along.1 * BOUND {
        return true;
    }
    let m = crate::caster::cross(s.from, s.step);
    for r in caster.rows(id) {
        let mut sum = 0.0;
        let mut magnitude = 0.0;
        for k in 0..3 {
            let (a, b) = (r[k] * s.step[k], r[3 + k] * m[k]);
            sum += a + b;
            magnitude += a.abs() + r[3 + k].abs() * reach * reach * 2.0;
        }
        let side = if along.0 > 0.0 { sum } else { -sum };
        if side < -magnitude * BOUND {
            return false;
        }
    }
    true
}

const BOUND: f64 = 1.0 / (1_u64 << 44) as f64;

fn dot_abs(a: [f64; 3], b: [f64; 3]) -> (f64, f64) {
    let t = [a[0] * b[0], a[1] * b[1], a[2] * b[2]];
    (t[0] + t[1] + t[2], t[0].abs() + t[1].abs() + t[2].abs())
}

fn blocks(
    line: &FineLine,
    polygon: &PolygonRef<'_>,
    between: &Between<'_>,
    start: &Position,
    end: &Position,
) -> bool {
    if line.meeting(polygon.corners, polygon.plane) == Meeting::Miss {
        return false;
    }
    let Some(at) = line.position(polygon.plane) else {
        // The line runs inside the polygon's plane: refuse it unless the polygon is out of range.
        return touches_range(line, polygon, start, end);
    };
    match at.compare(start) {
        Ordering::Less => return false,
        Ordering::Equal => {
            return between.source_plane_blocks || !lies_in(polygon, between.source);
        }
        Ordering::Greater => {}
    }
    match at.compare(end) {
        Ordering::Greater => false,
        Ordering::Less => true,
        Ordering::Equal => !lies_in(polygon, between.target),
    }
}

/// Whether a polygon whose plane holds the line may meet the segment: by its bounding box,
/// generously.
fn touches_range(
    line: &FineLine,
    polygon: &PolygonRef<'_>,
    start: &Position,
    end: &Position,
) -> bool {
    let s = line.segment();
    let (a, b) = (s.at(start.to_f64()), s.at(end.to_f64()));
    let bounds: Aabb = polygon.bounds();
    let (lo, hi) = (bounds.min.to_f64(), bounds.max.to_f64());
    (0..3).all(|k| a[k].min(b[k]) <= hi[k] + 1.0 && a[k].max(b[k]) >= lo[k] - 1.0)
}
