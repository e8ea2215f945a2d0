//! Lines by number, and the signs of their determinants.

use dashu_int::IBig;
use dashu_int::ops::Gcd;
use rustc_hash::FxHashMap;

use super::super::line::PlanLine;

/// A line, without its direction.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// The first coefficient that is not zero is positive; no common divisor.
    pub(super) exact: PlanLine,
    /// Coefficients below 2^27, 2^27 and 2^52, if they are: their determinants fit 128 bits.
    narrow: Option<[i64; 3]>,
    /// The coefficients with a normal of length one, to 2^-51 of the coordinates' size.
    pub(super) unit: [f64; 3],
}

/// All lines of the tiles, each once.
#[derive(Default)]
pub(super) struct Lines {
    pub(super) all: Vec<Line>,
    ids: FxHashMap<PlanLine, usize>,
}

impl Lines {
    /// The number of a line, and whether it was turned around.
    pub(super) fn insert(&mut self, line: &PlanLine) -> SignedLine {
        let (exact, turned) = primitive(line);
        let all = &mut self.all;
        let line = *self.ids.entry(exact).or_insert_with_key(|exact| {
            all.push(Line::new(exact.clone()));
            all.len() - 1
        });
        SignedLine { line, turned }
    }

    /// The sign of the turn from one line's direction to another's.
    pub(super) fn turn(&self, l: usize, m: usize) -> i8 {
        let (l, m) = (&self.all[l], &self.all[m]);
        let value = l.unit[0] * m.unit[1] - l.unit[1] * m.unit[0];
        if value.abs() > CLEAR {
            return if value > 0.0 { 1 } else { -1 };
        }
        if let (Some(l), Some(m)) = (l.narrow, m.narrow) {
            let (l, m) = (l.map(i128::from), m.map(i128::from));
            return (l[0] * m[1] - l[1] * m[0]).signum() as i8;
        }
        let (l, m) = (l.exact.big(), m.exact.big());
        sign(&(&l[0] * &m[1] - &l[1] * &m[0]))
    }

    /// The sign of the determinant of three lines.
    pub(super) fn determinant(&self, [l, m, n]: [usize; 3]) -> i8 {
        let [l, m, n] = [l, m, n].map(|k| &self.all[k]);
        if let (Some(l), Some(m), Some(n)) = (l.narrow, m.narrow, n.narrow) {
            let [l, m, n] = [l, m, n].map(|r| r.map(i128::from));
            let minor = |i: usize, j: usize| l[i] * m[j] - l[j] * m[i];
            let value = minor(1, 2) * n[0] + minor(2, 0) * n[1] + minor(0, 1) * n[2];
            return value.signum() as i8;
        }
        let [x, y, w] = cross(&l.exact.big(), &m.exact.big());
        let n = n.exact.big();
        sign(&(x * &n[0] + y * &n[1] + w * &n[2]))
    }

    /// Where two lines meet: homogeneous, without common divisor, the weight positive.
    pub(super) fn corner(&self, l: usize, m: usize) -> [IBig; 3] {
        let p = cross(&self.all[l].exact.big(), &self.all[m].exact.big());
        let common = common_divisor(&p[2], [&p[0], &p[1]]);
        let divisor = if p[2] < IBig::ZERO { -common } else { common };
        p.map(|c| c / &divisor)
    }
}

/// Sines above this are right in sign, and to a thousandth, if they are made of unit normals.
pub(super) const CLEAR: f64 = 1.0 / (1_u64 << 40) as f64;

pub(super) fn sign(v: &IBig) -> i8 {
    i8::from(*v > IBig::ZERO) - i8::from(*v < IBig::ZERO)
}

fn cross(l: &[IBig; 3], m: &[IBig; 3]) -> [IBig; 3] {
    let minor = |i: usize, j: usize| &l[i] * &m[j] - &l[j] * &m[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// The greatest common divisor of a number that is not zero and two others.
fn common_divisor(first: &IBig, [second, third]: [&IBig; 2]) -> IBig {
    let common = IBig::from(first.gcd(second));
    IBig::from((&common).gcd(third))
}

/// A line divided by its common divisor, the first coefficient that is not zero positive; and whether that turned it around.
fn primitive(line: &PlanLine) -> (PlanLine, bool) {
    if let PlanLine::Small(l) = line {
        let [a, b, c] = l.map(i64::unsigned_abs);
        let common = i128::from(a.gcd(b).gcd(c));
        let turned = l[0] < 0 || (l[0] == 0 && l[1] < 0);
        let divisor = if turned { -common } else { common };
        // A quotient may be 2^63 only if it was -2^63 before.
        let reduced = l.map(|c| i64::try_from(i128::from(c) / divisor));
        if let [Ok(a), Ok(b), Ok(c)] = reduced {
            return (PlanLine::Small([a, b, c]), turned);
        }
    }
    let l = line.big();
    let turned = l[0] < IBig::ZERO || (l[0] == IBig::ZERO && l[1] < IBig::ZERO);
    let k = usize::from(l[0] == IBig::ZERO);
    let common = common_divisor(&l[k], [&l[1 - k], &l[2]]);
    let divisor = if turned { -common } else { common };
    (PlanLine::new(l.map(|c| c / &divisor)), turned)
}

impl Line {
    fn new(exact: PlanLine) -> Self {
        let [a, b, c] = exact.rounded();
        let length = a.hypot(b);
        let below = |c: i64, bits: u32| c.unsigned_abs() < 1 << bits;
        let narrow = match exact {
            PlanLine::Small(l) => {
                Some(l).filter(|&[a, b, c]| below(a, 27) && below(b, 27) && below(c, 52))
            }
            PlanLine::Big(_) => None,
        };
        Self {
            exact,
            narrow,
            unit: [a / length, b / length, c / length],
        }
    }
}

/// A line with a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct SignedLine {
    pub(super) line: usize,
    pub(super) turned: bool,
}

impl SignedLine {
    pub(super) fn reversed(self) -> Self {
        Self {
            turned: !self.turned,
            ..self
        }
    }
}
