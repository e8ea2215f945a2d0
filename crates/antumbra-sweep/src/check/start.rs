//! The cone that a tree starts from: half-spaces that hold for all real lines between two gates.
//!
//! All edge rows of both gates hold, and where each gate crosses the plane of the other, the row
//! of the planes' common line. They leave the common line itself free; two caps `+-t + mu w` close
//! the cone, where t is the row of a line between corners of both gates, w the sum of all edge
//! rows, and mu the smallest integer that keeps the cap non-negative on all lines between corners.
//! Every line between the gates is a positive combination of those lines, so the caps hold for it.

use antumbra_kernel::plucker::{Row, edge_row, line_through};
use antumbra_kernel::{Plane, Point, Sign};
use dashu_int::IBig;

use super::big::dot;
use super::ends::Gate;
use super::rows::{Hyperplane, narrow};

/// Rows of pointed cones that together hold all real lines between two gates.
pub(super) fn start_rows(from: &Gate, to: &Gate) -> Vec<Vec<Hyperplane>> {
    let edges = edge_rows(from, to);
    let mut rows: Vec<Hyperplane> = edges
        .iter()
        .map(|&row| Hyperplane::Narrow(super::fast::FastRow::new(row)))
        .collect();
    if from.straddles(&to.plane) && to.straddles(&from.plane) {
        rows.push(Hyperplane::common_line(&from.plane, &to.plane));
    }
    let Some(t) = transverse(from, to) else {
        return Vec::new();
    };
    let caps = caps(from, to, &t, &edges);
    if caps.is_empty() {
        // Any row that is not zero on the common line makes two pointed halves.
        let half = Hyperplane::Narrow(super::fast::FastRow::new(t));
        let with = |row: Hyperplane| rows.iter().cloned().chain([row]).collect();
        return vec![with(half.clone()), with(half.turned(true))];
    }
    rows.extend(caps);
    vec![rows]
}

/// The rows of the edges of both gates, but for those wholly in the part that no lines use: they
/// hold as well, but would only give the cone more facets.
fn edge_rows(from: &Gate, to: &Gate) -> Vec<Row> {
    let edges = |gate: &Gate, plane: &Plane, used: Sign| {
        let n = gate.corners.len();
        let edge = |i: usize| (gate.corners[i], gate.corners[(i + 1) % n]);
        let unused = |(u, v): (Point, Point)| {
            let (s, t) = (plane.side(u).times(used), plane.side(v).times(used));
            !s.is_positive() && !t.is_positive() && (s.is_negative() || t.is_negative())
        };
        (0..n)
            .map(edge)
            .filter(|&e| !unused(e))
            .map(|(u, v)| edge_row(u, v))
            .collect::<Vec<_>>()
    };
    [
        edges(from, &to.plane, Sign::Negative),
        edges(to, &from.plane, Sign::Positive),
    ]
    .concat()
}

/// The row of the line between the corners farthest from the plane of the other gate: not zero on
/// the planes' common line. `None` if no lines leave the first gate and cross the second.
fn transverse(from: &Gate, to: &Gate) -> Option<Row> {
    let a = from.corners.iter().min_by_key(|&&p| to.plane.evaluate(p))?;
    let b = to.corners.iter().max_by_key(|&&p| from.plane.evaluate(p))?;
    let off = to.plane.side(*a).is_negative() && from.plane.side(*b).is_positive();
    off.then(|| edge_row(*a, *b))
}

fn caps(from: &Gate, to: &Gate, t: &Row, edges: &[Row]) -> Vec<Hyperplane> {
    let mut w = [0_i64; 6];
    for row in edges {
        for k in 0..6 {
            w[k] += row[k];
        }
    }
    let multipliers = if from.straddles(&to.plane) || to.straddles(&from.plane) {
        clipped_multipliers(from, to, t, &w)
    } else {
        corner_multipliers(from, to, t, &w)
    };
    let mut room = 12;
    let mut out = Vec::new();
    let mut found: Vec<_> = [(1, multipliers[0]), (-1, multipliers[1])]
        .into_iter()
        .filter_map(|(sign, mu)| cap(t, &w, sign, mu?))
        .collect();
    found.sort_by_key(|(excess, _)| *excess);
    for (excess, row) in found {
        if excess <= room {
            room -= excess;
            out.push(Hyperplane::Narrow(row));
        }
    }
    out
}

fn cap(t: &Row, w: &Row, sign: i128, mu: i128) -> Option<(u32, super::fast::FastRow)> {
    let mut row = [0_i128; 6];
    for k in 0..6 {
        row[k] = mu
            .checked_mul(i128::from(w[k]))?
            .checked_add(sign * i128::from(t[k]))?;
    }
    let row = narrow(row)?;
    Some((
        <super::fast::Fast as super::numbers::Numbers>::excess(&row),
        row,
    ))
}

/// The smallest `mu >= 0` with `+t + mu w >= 0` and with `-t + mu w >= 0` on all lines between
/// corners; `None` where there is none.
fn corner_multipliers(from: &Gate, to: &Gate, t: &Row, w: &Row) -> [Option<i128>; 2] {
    let mut mu = [Some(0_i128); 2];
    for &a in &from.corners {
        for &b in &to.corners {
            let line = line_through(a, b);
            let value = |row: &Row| -> i128 {
                (0..6)
                    .map(|k| i128::from(row[k]) * i128::from(line[k]))
                    .sum()
            };
            let (t, w) = (value(t), value(w));
            for (mu, need) in mu.iter_mut().zip([-t, t]) {
                if need > 0 {
                    *mu = mu.filter(|_| w > 0).map(|m| m.max((need - 1) / w + 1));
                }
            }
        }
    }
    mu
}

/// The same for gates that cross a plane: the corners are those of the parts that lines use.
fn clipped_multipliers(from: &Gate, to: &Gate, t: &Row, w: &Row) -> [Option<i128>; 2] {
    let (t, w) = (t.map(IBig::from), w.map(IBig::from));
    let mut mu = [Some(IBig::ZERO), Some(IBig::ZERO)];
    for line in corner_lines(from, to) {
        let (t, w) = (dot(&t, &line), dot(&w, &line));
        for (mu, need) in mu.iter_mut().zip([-&t, t.clone()]) {
            if need > IBig::ZERO {
                *mu = mu
                    .take()
                    .filter(|_| w > IBig::ZERO)
                    .map(|m| m.max((&need - IBig::ONE) / &w + IBig::ONE));
            }
        }
    }
    mu.map(|mu| mu.and_then(|m| i128::try_from(m).ok()))
}

/// The lines between the corners of the parts of both gates that lines use: the source behind
/// the target's plane, the target in front of the source's.
pub(super) fn corner_lines(from: &Gate, to: &Gate) -> Vec<[IBig; 6]> {
    let (a, b) = (
        clip(&from.corners, &to.plane, Sign::Negative),
        clip(&to.corners, &from.plane, Sign::Positive),
    );
    let mut out = Vec::new();
    for (p, u) in &a {
        for (q, v) in &b {
            let d: [IBig; 3] = std::array::from_fn(|k| u * &q[k] - v * &p[k]);
            let term = |i: usize, j: usize| &p[i] * &q[j] - &p[j] * &q[i];
            let [x, y, z] = d;
            out.push([x, y, z, term(1, 2), term(2, 0), term(0, 1)]);
        }
    }
    out
}

/// The homogeneous corners of the part of a convex polygon on one closed side of a plane.
fn clip(corners: &[Point], plane: &Plane, side: Sign) -> Vec<([IBig; 3], IBig)> {
    let n = corners.len();
    let values: Vec<i128> = corners.iter().map(|&p| plane.evaluate(p)).collect();
    let mut out = Vec::new();
    for i in 0..n {
        let (u, v) = (corners[i].to_i64(), corners[(i + 1) % n].to_i64());
        let (x, y) = (values[i], values[(i + 1) % n]);
        if Sign::of(x).times(side) != Sign::Negative {
            out.push((u.map(IBig::from), IBig::ONE));
        }
        if Sign::of(x).times(Sign::of(y)).is_negative() {
            let (x, y) = (IBig::from(x.abs()), IBig::from(y.abs()));
            let p = std::array::from_fn(|k| &y * IBig::from(u[k]) + &x * IBig::from(v[k]));
            out.push((p, x + y));
        }
    }
    out
}
