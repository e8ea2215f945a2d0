//! Real lines sampled from a Plücker cone, in doubles.

use antumbra_lines::{Cone, PluckerSpace};

use crate::random::Random;

/// Draws lines from one cone.
pub(crate) struct Sampler {
    rays: Vec<[f64; 6]>,
}

/// The Plücker quadric, twice: d . m + m . d.
fn quadric(v: &[f64; 6]) -> f64 {
    2.0 * (v[0] * v[3] + v[1] * v[4] + v[2] * v[5])
}

fn bilinear(v: &[f64; 6], w: &[f64; 6]) -> f64 {
    (0..6).map(|k| v[k] * w[(k + 3) % 6]).sum()
}

impl Sampler {
    pub(crate) fn new(space: &PluckerSpace, cone: &Cone) -> Self {
        Self {
            rays: cone.vertices().map(|v| *space.rounded_vertex(v)).collect(),
        }
    }

    /// A random point of the cone; a higher `spread` stays closer to single rays.
    fn point(&self, rng: &mut Random, spread: u32) -> [f64; 6] {
        let mut out = [0.0; 6];
        for ray in &self.rays {
            let mut w = rng.unit() + 1e-3;
            for _ in 0..spread {
                w *= w;
            }
            for k in 0..6 {
                out[k] += w * ray[k];
            }
        }
        out
    }

    /// Up to `count` real lines, as directions and moments.
    pub(crate) fn lines(
        &mut self,
        rng: &mut Random,
        count: usize,
        out: &mut Vec<([f64; 3], [f64; 3])>,
    ) {
        self.draw(rng, count, count * 3 + 12, out);
    }

    /// A few lines of a cone that is known to hold some, with much more patience.
    pub(crate) fn persist(&mut self, rng: &mut Random, out: &mut Vec<([f64; 3], [f64; 3])>) {
        self.draw(rng, 4, 4000, out);
    }

    fn draw(
        &mut self,
        rng: &mut Random,
        count: usize,
        tries: usize,
        out: &mut Vec<([f64; 3], [f64; 3])>,
    ) {
        let mut positive: Option<[f64; 6]> = None;
        let mut negative: Option<[f64; 6]> = None;
        for i in 0..tries {
            if out.len() >= count {
                return;
            }
            let p = self.point(rng, (i % 4) as u32);
            let q = quadric(&p);
            if q >= 0.0 {
                positive = Some(p);
            } else {
                negative = Some(p);
            }
            if let (Some(a), Some(b)) = (&positive, &negative) {
                out.push(root(a, b));
                // The older one is replaced by chance, so that lines do not share an end.
                if rng.bits() & 1 == 0 {
                    positive = None
                } else {
                    negative = None
                }
            }
        }
    }
}

/// The real line on the segment between a point with Q >= 0 and one with Q < 0.
fn root(a: &[f64; 6], b: &[f64; 6]) -> ([f64; 3], [f64; 3]) {
    // Q(a + t (b - a)) = qa (1-t)^2 + 2 B t (1-t) + qb t^2, halved consistently.
    let (qa, qb, m) = (quadric(a) / 2.0, quadric(b) / 2.0, bilinear(a, b) / 2.0);
    let (c2, c1, c0) = (qa - 2.0 * m + qb, 2.0 * (m - qa), qa);
    let disc = (c1 * c1 - 4.0 * c2 * c0).max(0.0).sqrt();
    let q = -0.5 * (c1 + if c1 >= 0.0 { disc } else { -disc });
    let candidates = [
        if c2 == 0.0 { f64::NAN } else { q / c2 },
        if q == 0.0 { f64::NAN } else { c0 / q },
    ];
    let t = candidates
        .into_iter()
        .find(|t| (0.0..=1.0).contains(t))
        .unwrap_or(0.5);
    let v: [f64; 6] = std::array::from_fn(|k| a[k] + t * (b[k] - a[k]));
    ([v[0], v[1], v[2]], [v[3], v[4], v[5]])
}
