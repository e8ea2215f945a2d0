//! Real lines sampled from a Plücker cone, in doubles.

use antumbra_lines::{Cone, PluckerSpace};

use crate::random::Random;

/// Draws lines from one cone.
pub(crate) struct Sampler {
    rays: Vec<[f64; 6]>,
    /// Factors that give all rays directions of like length, so that a sum of them lies in the
    /// middle in space and not only in Plücker space.
    balance: Vec<f64>,
    /// Memory for the weights of one point.
    weights: Vec<f64>,
}

/// The Plücker quadric, twice: d . m + m . d.
fn quadric(v: &[f64; 6]) -> f64 {
    2.0 * (v[0] * v[3] + v[1] * v[4] + v[2] * v[5])
}

fn bilinear(v: &[f64; 6], w: &[f64; 6]) -> f64 {
    (0..6).map(|k| v[k] * w[(k + 3) % 6]).sum()
}

/// The bilinear form and a bound of its rounding error (see the filter of the exact signs).
fn bounded(v: &[f64; 6], w: &[f64; 6]) -> (f64, f64) {
    let mut sum = 0.0;
    let mut magnitude = 0.0;
    for k in 0..6 {
        let t = v[k] * w[(k + 3) % 6];
        sum += t;
        magnitude += t.abs();
    }
    (sum, magnitude * (1.0 / (1_u64 << 47) as f64))
}

fn norm(v: &[f64; 6]) -> f64 {
    v.iter().fold(0.0, |m, c| m.max(c.abs()))
}

impl Sampler {
    pub(crate) fn new(space: &PluckerSpace, cone: &Cone) -> Self {
        let rays: Vec<[f64; 6]> = cone.vertices().map(|v| *space.rounded_vertex(v)).collect();
        let lengths: Vec<f64> = rays
            .iter()
            .map(|r| r[0].abs().max(r[1].abs()).max(r[2].abs()))
            .collect();
        let longest = lengths.iter().fold(0.0, |m: f64, &l| m.max(l));
        // Rays with next to no direction are imaginary: they keep a bounded factor.
        let balance = lengths
            .iter()
            .map(|&l| longest / l.max(longest / (1_u64 << 40) as f64))
            .collect();
        let weights = vec![0.0; rays.len().next_multiple_of(2)];
        Self {
            rays,
            balance,
            weights,
        }
    }

    /// A random point of the cone; a higher `spread` stays closer to single rays, an odd one
    /// balances their directions.
    fn point(&mut self, rng: &mut Random, spread: u32) -> [f64; 6] {
        const UNIT: f64 = 1.0 / (1_u64 << 31) as f64;
        // Two weights from one random number: two billion values are enough.
        for pair in self.weights.chunks_exact_mut(2) {
            let bits = rng.bits();
            pair[0] = f64::from((bits as u32 >> 1) as i32) * UNIT + 1e-3;
            pair[1] = f64::from((bits >> 33) as i32) * UNIT + 1e-3;
        }
        for _ in 0..spread / 2 {
            self.weights.iter_mut().for_each(|w| *w *= *w);
        }
        if spread % 2 == 1 {
            let balance = self.balance.iter();
            self.weights
                .iter_mut()
                .zip(balance)
                .for_each(|(w, b)| *w *= b);
        }
        let mut out = [0.0; 6];
        for (&w, ray) in self.weights.iter().zip(&self.rays) {
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

    /// A few lines of a cone whose real lines are hard to hit: starts from points of either sign
    /// on edges and moves them inside as far as the sign allows.
    pub(crate) fn persist(
        &mut self,
        rng: &mut Random,
        count: usize,
        out: &mut Vec<([f64; 3], [f64; 3])>,
    ) {
        let (positive, negative) = self.anchors();
        if positive.is_empty() || negative.is_empty() {
            return;
        }
        for i in 0..count {
            let a = self.move_inside(&positive[i % positive.len()], 1.0, rng);
            let b = self.move_inside(&negative[i % negative.len()], -1.0, rng);
            if let (Some(a), Some(b)) = (a, b) {
                out.push(root(&a, &b));
            }
        }
    }

    /// Points with a strict sign of the quadric, on vertices and on segments between them.
    fn anchors(&self) -> (Vec<[f64; 6]>, Vec<[f64; 6]>) {
        const FEW: usize = 6;
        let mut positive = Vec::new();
        let mut negative = Vec::new();
        let mut put = |p: [f64; 6]| {
            let (q, bound) = bounded(&p, &p);
            if q > bound && positive.len() < FEW {
                positive.push(p);
            } else if q < -bound && negative.len() < FEW {
                negative.push(p);
            }
            positive.len() == FEW && negative.len() == FEW
        };
        for ray in &self.rays {
            put(*ray);
        }
        for (i, v) in self.rays.iter().enumerate() {
            for w in &self.rays[i + 1..] {
                let (b, error) = bounded(v, w);
                if b.abs() <= error {
                    continue;
                }
                // Q(v + t w) = Q_v + t B + t^2 Q_w is extreme at t = -B / (2 Q_w).
                for (v, w) in [(v, w), (w, v)] {
                    let qw = quadric(w) / 2.0;
                    let t = if qw * b < 0.0 { -b / (2.0 * qw) } else { 1.0 };
                    if put(std::array::from_fn(|k| v[k] + t * w[k])) {
                        return (positive, negative);
                    }
                }
            }
        }
        (positive, negative)
    }

    /// Moves a point towards a random inner one, as far as the quadric keeps its sign.
    fn move_inside(&mut self, p: &[f64; 6], sign: f64, rng: &mut Random) -> Option<[f64; 6]> {
        let spread = (rng.bits() % 4) as u32;
        let mut inner = self.point(rng, spread);
        let scale = norm(p) / norm(&inner);
        inner = inner.map(|c| c * scale);
        let mut step = 0.5;
        for _ in 0..60 {
            let moved: [f64; 6] = std::array::from_fn(|k| p[k] + step * inner[k]);
            if quadric(&moved) * sign > 0.0 {
                return Some(moved);
            }
            step *= 0.35;
        }
        None
    }

    /// The real lines on all segments between two rays: the extremal lines and some more.
    pub(crate) fn extremal(&self) -> Vec<([f64; 3], [f64; 3])> {
        let mut out = Vec::new();
        for (i, v) in self.rays.iter().enumerate() {
            let q = quadric(v);
            if bounded(v, v).0.abs() <= bounded(v, v).1 {
                out.push(([v[0], v[1], v[2]], [v[3], v[4], v[5]]));
            }
            for w in &self.rays[i + 1..] {
                let r = quadric(w);
                if q > 0.0 && r < 0.0 {
                    out.push(root(v, w));
                } else if q < 0.0 && r > 0.0 {
                    out.push(root(w, v));
                }
            }
        }
        out
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
            let p = self.point(rng, (i % 6) as u32);
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
