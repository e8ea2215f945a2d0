//! Sampled lines as segments between the two gates, in doubles.

use antumbra_kernel::Plane;
use antumbra_lines::{Cone, Gate, nearly_real};
use dashu_int::IBig;

use super::{Question, Searcher};
use crate::bundle::Bundle;
use crate::caster::Segment;
use crate::random::Random;

impl Searcher {
    /// A few real lines of a thin cone, found by big integers.
    pub(super) fn thin_segments(
        &mut self,
        question: &Question<'_>,
        cone: &Cone,
        rng: &mut Random,
    ) -> Bundle {
        const LINES: usize = 4;
        const BITS: usize = 160;
        let mut segment = || {
            let weight = || 1 + (rng.bits() >> 48) as u32;
            let line = nearly_real(&mut self.space, cone, BITS, weight)?;
            let from = meet_plane_exactly(&line, &question.from.plane)?;
            let to = meet_plane_exactly(&line, &question.to.plane)?;
            Some(Segment::new(from, to))
        };
        let mut bundle = Bundle::new();
        for _ in 0..LINES {
            if let Some(segment) = segment() {
                bundle.push(segment);
            }
        }
        bundle
    }
}

/// The part of a sampled line between the two gates' planes, in doubles.
pub(super) fn between_gates(
    d: &[f64; 3],
    m: &[f64; 3],
    question: &Question<'_>,
) -> Option<Segment> {
    let p = meet_plane(d, m, question.from)?;
    let q = meet_plane(d, m, question.to)?;
    let ok = p
        .iter()
        .chain(&q)
        .all(|c| c.is_finite() && c.abs() < f64::from(antumbra_kernel::LIMIT));
    ok.then(|| Segment::new(p, q))
}

/// Where a line by big integers crosses a plane, rounded once.
fn meet_plane_exactly(line: &[IBig; 6], plane: &Plane) -> Option<[f64; 3]> {
    let n = plane.normal.map(IBig::from);
    let [d0, d1, d2, m0, m1, m2] = line;
    let (d, m) = ([d0, d1, d2], [m0, m1, m2]);
    let along: IBig = (0..3).map(|k| &n[k] * d[k]).sum();
    if along == IBig::ZERO {
        return None;
    }
    let c = IBig::from(plane.offset);
    const FRACTION: usize = 48;
    Some(std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let numerator: IBig = &c * d[k] + &n[i] * m[j] - &n[j] * m[i];
        ((numerator << FRACTION) / &along).to_f64().value() / (1_u64 << FRACTION) as f64
    }))
}

fn meet_plane(d: &[f64; 3], m: &[f64; 3], gate: &Gate) -> Option<[f64; 3]> {
    let n = gate.plane.normal.map(|c| c as f64);
    let along = crate::caster::dot(n, *d);
    if along == 0.0 {
        return None;
    }
    let c = gate.plane.offset as f64;
    let nxm = crate::caster::cross(n, *m);
    let mut p: [f64; 3] = std::array::from_fn(|k| (c * d[k] + nxm[k]) / along);
    // On an axis-parallel plane the coordinate is known exactly.
    for k in 0..3 {
        if n[(k + 1) % 3] == 0.0 && n[(k + 2) % 3] == 0.0 {
            p[k] = f64::from(gate.corners[0].to_array()[k]);
        }
    }
    Some(p)
}
