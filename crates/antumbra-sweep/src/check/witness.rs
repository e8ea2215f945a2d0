//! Witnesses: lines of sight through two points, in integers.
//!
//! Points count 2^-16 grid steps and may lie a little off the grid: 41 bits. Sides have 110 bits,
//! values at planes 96, products of two of those 192.

use antumbra_kernel::plucker::edge_row;
use antumbra_kernel::{Aabb, I256, Plane, Point, Sign};
use antumbra_scene::{KdNode, PolygonId, PolygonRef, Scene};
use dashu_int::IBig;

use super::ends::{Gate, Source};
use crate::verdict::FinePoint;
use crate::verdict::Witness;

const FINE_BITS: u32 = 16;
const FINE_STEPS: f64 = (1_u32 << FINE_BITS) as f64;
const REACH: i64 = 1 << 40;

/// Checks a witness for a polygon of an object.
///
/// # Errors
/// What is wrong with it.
pub(super) fn check_witness(
    scene: &Scene,
    source: &Source,
    witness: &Witness,
) -> Result<(), String> {
    let id = witness.polygon;
    let Some(Some(opening)) = source.openings.get(witness.source as usize) else {
        return Err(format!("there is no source gate {}", witness.source));
    };
    let gate = opening.gate();
    let line = Line::new(witness.from, witness.through)
        .ok_or("its points coincide or lie off the grid")?;
    if source.is_box && line.evaluate(&gate.plane).0 != 0 {
        return Err(format!(
            "its first point is not on source gate {}",
            witness.source
        ));
    }
    if line.crossing(&gate.corners, &gate.plane) != Crossing::Inside(Sign::Positive) {
        return Err(format!(
            "it does not leave through the interior of source gate {}",
            witness.source
        ));
    }
    let polygon = scene.polygon(id);
    if !matches!(
        line.crossing(polygon.corners, polygon.plane),
        Crossing::Inside(_)
    ) {
        return Err(format!(
            "it does not cross the interior of polygon {}",
            id.0
        ));
    }
    let (start, end) = (line.position(&gate.plane), line.position(polygon.plane));
    if !start.is_before(&end) {
        return Err(format!("polygon {} does not come after the source", id.0));
    }
    let sight = Sight {
        line,
        start,
        end,
        gate: &gate,
        target: polygon,
    };
    match sight.obstacle(scene, source) {
        None => Ok(()),
        Some(other) => Err(format!("polygon {} is in the way", other.0)),
    }
}

/// An oriented line through two fine points.
struct Line {
    u: [i64; 3],
    v: [i64; 3],
    d: [i128; 3],
    m: [i128; 3],
}

/// How a line meets a closed convex polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Crossing {
    /// It misses it.
    Miss,
    /// It crosses the open interior, along (positive) or against the normal.
    Inside(Sign),
    /// It crosses the boundary.
    Boundary,
    /// It is parallel to the plane, or lies in it.
    Parallel,
}

/// The fraction `p / (p - q)` of the way from u to v, as a fraction with positive denominator.
#[derive(Clone, Copy)]
struct Position {
    above: i128,
    below: i128,
}

impl Position {
    fn is_before(&self, other: &Self) -> bool {
        self.compare(other).is_negative()
    }

    fn compare(&self, other: &Self) -> Sign {
        (I256::product_i128(self.above, other.below) - I256::product_i128(other.above, self.below))
            .sign()
    }

    fn approximate(&self) -> f64 {
        self.above as f64 / self.below as f64
    }
}

impl Line {
    fn new(from: FinePoint, through: FinePoint) -> Option<Self> {
        let (u, v) = (from.0, through.0);
        if u == v || u.iter().chain(&v).any(|c| !(-REACH..=REACH).contains(c)) {
            return None;
        }
        let (a, b) = (u.map(i128::from), v.map(i128::from));
        let term = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
        Some(Self {
            u,
            v,
            d: [b[0] - a[0], b[1] - a[1], b[2] - a[2]],
            m: [term(1, 2), term(2, 0), term(0, 1)],
        })
    }

    /// The side of the line on an oriented edge.
    fn side(&self, a: Point, b: Point) -> Sign {
        let row = edge_row(a, b).map(i128::from);
        let moment: i128 = (0..3).map(|k| row[k] * self.d[k]).sum();
        let direction: i128 = (0..3).map(|k| row[3 + k] * self.m[k]).sum();
        // The line's moment is quadratic in fine steps, its direction linear.
        Sign::of((moment << FINE_BITS) + direction)
    }

    /// A plane's values at both points.
    fn evaluate(&self, plane: &Plane) -> (i128, i128) {
        let n = plane.normal.map(i128::from);
        let at = |p: &[i64; 3]| {
            (0..3).map(|k| n[k] * i128::from(p[k])).sum::<i128>() - (plane.offset << FINE_BITS)
        };
        (at(&self.u), at(&self.v))
    }

    /// Where the line crosses a plane that it is not parallel to.
    fn position(&self, plane: &Plane) -> Position {
        let (p, q) = self.evaluate(plane);
        let sign = (p - q).signum();
        Position {
            above: p * sign,
            below: (p - q) * sign,
        }
    }

    fn crossing(&self, corners: &[Point], plane: &Plane) -> Crossing {
        let (p, q) = self.evaluate(plane);
        let way = Sign::of(q - p);
        if way.is_zero() {
            return Crossing::Parallel;
        }
        let n = corners.len();
        let mut boundary = false;
        for i in 0..n {
            match self.side(corners[i], corners[(i + 1) % n]).times(way) {
                Sign::Negative => return Crossing::Miss,
                Sign::Zero => boundary = true,
                Sign::Positive => {}
            }
        }
        if boundary {
            Crossing::Boundary
        } else {
            Crossing::Inside(way)
        }
    }
}

/// The segment between a source gate and a polygon.
struct Sight<'a> {
    line: Line,
    start: Position,
    end: Position,
    gate: &'a Gate,
    target: PolygonRef<'a>,
}

impl Sight<'_> {
    /// Some occluder that meets the segment.
    fn obstacle(&self, scene: &Scene, source: &Source) -> Option<PolygonId> {
        let (a, b) = (self.at(&self.start), self.at(&self.end));
        let box_meets = |bounds: &Aabb| segment_near(a, b, bounds);
        let kd = scene.kd();
        let mut stack = vec![(0_usize, kd.bounds())];
        while let Some((node, bounds)) = stack.pop() {
            if !box_meets(&bounds) {
                continue;
            }
            match kd.nodes().get(node) {
                None => {}
                Some(&KdNode::Inner {
                    axis,
                    at,
                    lower,
                    upper,
                }) => {
                    let k = usize::from(axis);
                    let (mut top, mut bottom) = (bounds.max.to_array(), bounds.min.to_array());
                    top[k] = top[k].min(at);
                    bottom[k] = bottom[k].max(at);
                    let (top, bottom) = (Point::from(top), Point::from(bottom));
                    stack.push((
                        upper as usize,
                        Aabb {
                            min: bottom,
                            ..bounds
                        },
                    ));
                    stack.push((lower as usize, Aabb { max: top, ..bounds }));
                }
                Some(&KdNode::Leaf { first, count }) => {
                    for &id in kd.leaf_items(first, count) {
                        let polygon = scene.polygon(id);
                        let takes_part = polygon.occludes && !source.own.contains(&id.0);
                        if takes_part
                            && box_meets(&polygon.bounds())
                            && self.blocked_by(&polygon, source.is_box)
                        {
                            return Some(id);
                        }
                    }
                }
            }
        }
        None
    }

    /// A rounded point of the line: off by far less than half a grid step where it is on the grid.
    fn at(&self, position: &Position) -> [f64; 3] {
        let t = position.approximate();
        std::array::from_fn(|k| (self.line.u[k] as f64 + t * self.line.d[k] as f64) / FINE_STEPS)
    }

    /// Whether an occluder meets the closed segment, apart from those in the target's plane and,
    /// unless they block, those in the gate's.
    fn blocked_by(&self, polygon: &PolygonRef<'_>, source_plane_blocks: bool) -> bool {
        let line = &self.line;
        let meets = match line.crossing(polygon.corners, polygon.plane) {
            Crossing::Miss => false,
            Crossing::Parallel => {
                line.evaluate(polygon.plane).0 == 0 && self.passes_in_plane(polygon)
            }
            Crossing::Inside(_) | Crossing::Boundary => {
                let at = line.position(polygon.plane);
                !at.is_before(&self.start) && !self.end.is_before(&at)
            }
        };
        meets
            && !lies_in(polygon, self.target.plane)
            && (source_plane_blocks || !lies_in(polygon, &self.gate.plane))
    }

    /// Whether the segment meets a polygon in whose plane it lies.
    fn passes_in_plane(&self, polygon: &PolygonRef<'_>) -> bool {
        // The part of the line inside all edges, as fractions with positive denominators.
        let big = |p: &Position| (IBig::from(p.above), IBig::from(p.below));
        let (mut low, mut high) = (big(&self.start), big(&self.end));
        let n = polygon.plane.normal.map(IBig::from);
        let count = polygon.corners.len();
        for i in 0..count {
            let a = polygon.corners[i].to_i64();
            let b = polygon.corners[(i + 1) % count].to_i64();
            let e: [IBig; 3] = std::array::from_fn(|k| IBig::from(b[k] - a[k]));
            let term = |i: usize, j: usize| &n[i] * &e[j] - &n[j] * &e[i];
            let inward = [term(1, 2), term(2, 0), term(0, 1)];
            let value = |p: &[i64; 3]| -> IBig {
                (0..3)
                    .map(|k| &inward[k] * IBig::from(p[k] - (a[k] << FINE_BITS)))
                    .sum()
            };
            let (p, q) = (value(&self.line.u), value(&self.line.v));
            // Inside where p + t (q - p) >= 0.
            if p == q {
                if p < IBig::ZERO {
                    return false;
                }
            } else if q > p {
                let bound = (-&p, q - p);
                if less(&low, &bound) {
                    low = bound;
                }
            } else {
                let bound = (p.clone(), p - q);
                if less(&bound, &high) {
                    high = bound;
                }
            }
        }
        !less(&high, &low)
    }
}

fn less(a: &(IBig, IBig), b: &(IBig, IBig)) -> bool {
    &a.0 * &b.1 < &b.0 * &a.1
}

fn lies_in(polygon: &PolygonRef<'_>, plane: &Plane) -> bool {
    polygon.corners.iter().all(|&p| plane.side(p).is_zero())
}

/// Whether a segment may come within a grid step of a box: false only if an axis separates them
/// by more, which rounding (below 2^-20 steps) cannot feign.
fn segment_near(a: [f64; 3], b: [f64; 3], bounds: &Aabb) -> bool {
    let (low, high) = (bounds.min.to_f64(), bounds.max.to_f64());
    let mut half = [0.0; 3];
    let mut reach = [0.0; 3];
    let mut offset = [0.0; 3];
    for k in 0..3 {
        half[k] = (b[k] - a[k]) / 2.0;
        reach[k] = (high[k] - low[k]) / 2.0 + 1.0;
        offset[k] = (a[k] + b[k]) / 2.0 - (high[k] + low[k]) / 2.0;
        if offset[k].abs() > reach[k] + half[k].abs() {
            return false;
        }
    }
    (0..3).all(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let turn = half[i] * offset[j] - half[j] * offset[i];
        turn.abs() <= reach[i] * half[j].abs() + reach[j] * half[i].abs()
    })
}
