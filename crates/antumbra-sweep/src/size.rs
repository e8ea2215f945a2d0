//! The size of a set of lines, for those who ask to ignore small ones.
//!
//! After [Bittner02, 8.7.2]: an estimate of the smallest angle that the set spans, seen from the
//! center of the source. For each edge that bounds the set, take the extremal line farthest from
//! it, and the angle of their distance at the center; the size is the smallest of these angles.
//! Differs in taking the real lines on all segments between rays of the cone, a superset of the
//! extremal lines that lies in the same closed cone, so that no face lattice is needed.

use antumbra_lines::{Cone, Gate, PluckerSpace};

use crate::caster::{cross, dot};
use crate::sample::Sampler;

/// Whether the size of a cone's set of lines is below an angle in radians. An estimate in doubles,
/// used only where the user asked for it.
pub(crate) fn size_below(
    space: &PluckerSpace,
    cone: &Cone,
    sampler: &Sampler,
    source: &Gate,
    angle: f64,
) -> bool {
    let lines = sampler.extremal();
    if lines.is_empty() {
        return true;
    }
    let n = source.corners.len() as f64;
    let center: [f64; 3] = std::array::from_fn(|k| {
        source
            .corners
            .iter()
            .map(|p| f64::from(p.to_array()[k]))
            .sum::<f64>()
            / n
    });
    cone.halfspaces().any(|h| {
        let row = space.rounded_row(h.row);
        let (m, d) = ([row[0], row[1], row[2]], [row[3], row[4], row[5]]);
        let (md, size) = (dot(m, d), dot(d, d).sqrt() * dot(m, m).sqrt());
        // Caps are no lines: they do not bound the set of real lines.
        if size == 0.0 || md.abs() > 1e-9 * size {
            return false;
        }
        let widest = lines
            .iter()
            .map(|(e, w)| angle_between((&d, &m), (e, w), &center))
            .fold(0.0, f64::max);
        widest < angle
    })
}

/// The angle that the shortest segment between two lines spans at a point.
fn angle_between(
    (d, m): (&[f64; 3], &[f64; 3]),
    (e, w): (&[f64; 3], &[f64; 3]),
    center: &[f64; 3],
) -> f64 {
    let n = cross(*d, *e);
    let sin = dot(n, n).sqrt();
    let side = (dot(*d, *w) + dot(*m, *e)).abs();
    // The point of the first line next to the other: where it meets the plane of the other and n.
    let plane = cross(*e, n);
    let along = dot(plane, *d);
    if sin == 0.0 || along == 0.0 {
        return f64::INFINITY;
    }
    // A point q of the other line is e x w / e.e (its foot); the plane's offset is plane . q.
    let foot = cross(*e, *w);
    let offset = dot(plane, foot) / dot(*e, *e);
    let pxm = cross(plane, *m);
    let p: [f64; 3] = std::array::from_fn(|k| (offset * d[k] + pxm[k]) / along);
    let distance = side / sin;
    let to: [f64; 3] = std::array::from_fn(|k| p[k] - center[k]);
    (distance / dot(to, to).sqrt().max(f64::MIN_POSITIVE)).atan()
}
