//! The start polytope: all lines from one convex polygon to another, as half-spaces.
//!
//! After [Bittner02, 8.7]: the edges of both polygons, plus *caps* that make the cone pointed.
//! Edge rows alone never are: the common line of the two planes meets every edge line. The caps
//! here are integer rows `+-t + mu w` that are non-negative on every real line between the
//! polygons (see `docs/notes/start-polytope.md`), so they remove imaginary lines only.

use antumbra_kernel::plucker::edge_row;
use antumbra_kernel::{Plane, Point, Sign};
use dashu_int::IBig;

use crate::cone::{ConeError, Halfspace};
use crate::space::{PluckerSpace, sign_of};

/// A convex polygon together with the direction in which lines cross it.
#[derive(Clone, Debug)]
pub struct Gate {
    /// Corners, counter-clockwise about the plane's normal.
    pub corners: Vec<Point>,
    /// The polygon's plane; lines cross it along the normal.
    pub plane: Plane,
}

impl Gate {
    /// The same polygon crossed the other way.
    #[must_use]
    pub fn flipped(&self) -> Self {
        let mut corners = self.corners.clone();
        corners.reverse();
        Self {
            corners,
            plane: self.plane.flipped(),
        }
    }

    /// The edges in order.
    pub fn edges(&self) -> impl Iterator<Item = (Point, Point)> + '_ {
        let n = self.corners.len();
        (0..n).map(move |i| (self.corners[i], self.corners[(i + 1) % n]))
    }
}

/// The half-spaces of a start polytope.
#[derive(Clone, Debug)]
pub struct Start {
    /// All of them hold for every line between the gates.
    pub halfspaces: Vec<Halfspace>,
    /// Where the gates share a stretch of the common line of their planes, no cap exists and the
    /// half-spaces contain a whole line. Cutting by this hyperplane leaves two pointed cones.
    pub chord: Option<Chord>,
}

/// The line from a corner of the source gate to a corner of the target gate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chord {
    /// The positive side of its hyperplane.
    pub halfspace: Halfspace,
    /// Number of the source gate's corner.
    pub from: u32,
    /// Number of the target gate's corner.
    pub to: u32,
}

/// A point with homogeneous integer coordinates, `w > 0`.
type Homogeneous = ([IBig; 3], IBig);

/// The half-spaces of all lines that leave `from` along its normal and then cross `to` along its
/// normal.
///
/// Polygons may cross each other's planes: only the part of `to` in front of `from` and the part
/// of `from` behind `to` counts, and a row for the common line is added where both cross.
///
/// # Errors
/// [`ConeError::Flat`] if there is no such line with both crossings in the open sides.
pub fn start_halfspaces(
    space: &mut PluckerSpace,
    from: &Gate,
    to: &Gate,
) -> Result<Start, ConeError> {
    let to_sides: Vec<Sign> = to.corners.iter().map(|&p| from.plane.side(p)).collect();
    let from_sides: Vec<Sign> = from
        .corners
        .iter()
        .map(|&p| to.plane.side(p).flip())
        .collect();
    let (far_index, far) = most(&to.corners, |p| from.plane.evaluate(p)).ok_or(ConeError::Flat)?;
    let (near_index, near) =
        most(&from.corners, |p| -to.plane.evaluate(p)).ok_or(ConeError::Flat)?;
    if !from.plane.side(far).is_positive() || !to.plane.side(near).is_negative() {
        return Err(ConeError::Flat);
    }
    let from_crossed = from_sides.iter().any(|s| s.is_negative());
    let to_crossed = to_sides.iter().any(|s| s.is_negative());
    let from_rows = kept_edges(from, &from_sides);
    let to_rows = kept_edges(to, &to_sides);

    let mut halfspaces = Vec::with_capacity(from_rows.len() + to_rows.len() + 3);
    for row in from_rows.iter().chain(&to_rows) {
        halfspaces.push(space.halfspace(row, false));
    }
    if from_crossed && to_crossed {
        halfspaces.push(common_line(space, &from.plane, &to.plane, near, far));
    }
    let w: [i64; 6] = std::array::from_fn(|k| from_rows.iter().chain(&to_rows).map(|r| r[k]).sum());
    let t = edge_row(near, far);
    let caps = if from_crossed || to_crossed {
        let a = clip(&from.corners, &to.plane.flipped());
        let b = clip(&to.corners, &from.plane);
        wide_caps(&a, &b, &t, &w)
    } else {
        narrow_caps(&from.corners, &to.corners, &t, &w).unwrap_or_else(|| {
            let lift = |c: &[Point]| -> Vec<Homogeneous> {
                c.iter()
                    .map(|p| (p.to_i64().map(IBig::from), IBig::ONE))
                    .collect()
            };
            wide_caps(&lift(&from.corners), &lift(&to.corners), &t, &w)
        })
    };
    let chord = caps.is_empty().then(|| Chord {
        halfspace: space.halfspace(&t, false),
        from: near_index,
        to: far_index,
    });
    for cap in caps {
        halfspaces.push(space.intern_wide(cap));
    }
    Ok(Start { halfspaces, chord })
}

/// The row of the common line of two planes, signed so that the line near -> far is inside.
///
/// Degree (4, 5) in the coordinates, (2, 3) if one plane is axis-parallel.
pub fn common_line(
    space: &mut PluckerSpace,
    first: &Plane,
    second: &Plane,
    near: Point,
    far: Point,
) -> Halfspace {
    let row = common_line_row(first, second);
    let h = space.intern_wide(row.clone());
    let line = antumbra_kernel::plucker::line_through(near, far);
    let value: IBig = (0..6).map(|k| &row[k] * IBig::from(line[k])).sum();
    if sign_of(&value).is_negative() {
        h.opposite()
    } else {
        h
    }
}

/// The row `(m; d)` of the common line of two planes.
#[must_use]
pub fn common_line_row(first: &Plane, second: &Plane) -> [IBig; 6] {
    let (n, k) = (first.normal.map(IBig::from), second.normal.map(IBig::from));
    let (c, e) = (IBig::from(first.offset), IBig::from(second.offset));
    let d = [
        &n[1] * &k[2] - &n[2] * &k[1],
        &n[2] * &k[0] - &n[0] * &k[2],
        &n[0] * &k[1] - &n[1] * &k[0],
    ];
    let m: [IBig; 3] = std::array::from_fn(|i| &n[i] * &e - &k[i] * &c);
    let [m0, m1, m2] = m;
    let [d0, d1, d2] = d;
    [m0, m1, m2, d0, d1, d2]
}

fn most(corners: &[Point], value: impl Fn(Point) -> i128) -> Option<(u32, Point)> {
    let key = |&(_, &p): &(usize, &Point)| (value(p), std::cmp::Reverse(p));
    let (index, point) = corners.iter().enumerate().max_by_key(key)?;
    Some((index as u32, *point))
}

/// The rows of the edges that are not wholly on the unwanted side.
fn kept_edges(gate: &Gate, sides: &[Sign]) -> Vec<[i64; 6]> {
    let n = gate.corners.len();
    (0..n)
        .filter(|&i| {
            let (s, t) = (sides[i], sides[(i + 1) % n]);
            s.is_positive() || t.is_positive() || (s.is_zero() && t.is_zero())
        })
        .map(|i| edge_row(gate.corners[i], gate.corners[(i + 1) % n]))
        .collect()
}

/// The caps in 128-bit integers; `None` on overflow.
fn narrow_caps(a: &[Point], b: &[Point], t: &[i64; 6], w: &[i64; 6]) -> Option<Vec<[IBig; 6]>> {
    let mut mu = [Some(0_i128), Some(0_i128)];
    for &p in a {
        for &q in b {
            let line = antumbra_kernel::plucker::line_through(p, q);
            let dot = |r: &[i64; 6]| {
                (0..6)
                    .map(|k| i128::from(r[k]) * i128::from(line[k]))
                    .sum::<i128>()
            };
            let (along, inward) = (dot(t), dot(w));
            for (mu, value) in mu.iter_mut().zip([along, -along]) {
                let Some(m) = *mu else { continue };
                if value < 0 {
                    *mu = (inward > 0).then(|| m.max((-value + inward - 1) / inward));
                }
            }
        }
    }
    let mut caps = Vec::with_capacity(2);
    for (mu, sign) in mu.iter().zip([1_i128, -1]) {
        if let Some(mu) = mu {
            let mut cap = Vec::with_capacity(6);
            for k in 0..6 {
                let c = mu
                    .checked_mul(i128::from(w[k]))?
                    .checked_add(sign * i128::from(t[k]))?;
                cap.push(IBig::from(c));
            }
            caps.push(cap.try_into().ok()?);
        }
    }
    Some(caps)
}

fn wide_caps(a: &[Homogeneous], b: &[Homogeneous], t: &[i64; 6], w: &[i64; 6]) -> Vec<[IBig; 6]> {
    let mut mu = [Some(IBig::ZERO), Some(IBig::ZERO)];
    for (p, pw) in a {
        for (q, qw) in b {
            let d: [IBig; 3] = std::array::from_fn(|k| pw * &q[k] - qw * &p[k]);
            let m = [
                &p[1] * &q[2] - &p[2] * &q[1],
                &p[2] * &q[0] - &p[0] * &q[2],
                &p[0] * &q[1] - &p[1] * &q[0],
            ];
            let dot = |r: &[i64; 6]| -> IBig {
                (0..3)
                    .map(|k| IBig::from(r[k]) * &d[k] + IBig::from(r[k + 3]) * &m[k])
                    .sum()
            };
            let (along, inward) = (dot(t), dot(w));
            for (mu, value) in mu.iter_mut().zip([along.clone(), -along]) {
                let Some(m) = mu.clone() else { continue };
                if sign_of(&value).is_negative() {
                    *mu = sign_of(&inward).is_positive().then(|| {
                        let needed = (-value + &inward - IBig::ONE) / &inward;
                        if needed > m { needed } else { m }
                    });
                }
            }
        }
    }
    mu.into_iter()
        .zip([1_i64, -1])
        .filter_map(|(mu, sign)| {
            let mu = mu?;
            Some(std::array::from_fn(|k| {
                &mu * IBig::from(w[k]) + IBig::from(sign * t[k])
            }))
        })
        .collect()
}

/// The corners of the part of a polygon on the positive side of a plane.
fn clip(corners: &[Point], plane: &Plane) -> Vec<Homogeneous> {
    let n = corners.len();
    let mut out = Vec::with_capacity(n + 1);
    for i in 0..n {
        let (p, q) = (corners[i], corners[(i + 1) % n]);
        let (s, t) = (plane.evaluate(p), plane.evaluate(q));
        if s >= 0 {
            out.push((p.to_i64().map(IBig::from), IBig::ONE));
        }
        if (s > 0 && t < 0) || (s < 0 && t > 0) {
            let (ws, wt) = (IBig::from(t.abs()), IBig::from(s.abs()));
            let (pc, qc) = (p.to_i64(), q.to_i64());
            let x = std::array::from_fn(|k| &ws * IBig::from(pc[k]) + &wt * IBig::from(qc[k]));
            out.push((x, ws + wt));
        }
    }
    out
}
