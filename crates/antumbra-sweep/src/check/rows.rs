//! Hyperplanes of line space as the certificate names them.

use antumbra_kernel::plucker::{Row, edge_row};
use antumbra_kernel::{Plane, Point, Sign};
use dashu_int::IBig;

use super::big::{Wide, dot, primitive, sign_of};
use super::fast::{FILTER, Fast, FastRow, FastVertex};
use super::numbers::Numbers;

/// A half-space with coefficients as wide as they must be.
#[derive(Clone, Debug)]
pub(super) enum Hyperplane {
    /// Machine integers.
    Narrow(FastRow),
    /// Big integers.
    Wide(Wide),
}

impl Hyperplane {
    /// The row of the edge from `u` to `v`.
    pub(super) fn edge(u: Point, v: Point) -> Self {
        Self::Narrow(FastRow::new(edge_row(u, v)))
    }

    /// The common line of two planes, positive where a line that crosses `other` along its normal
    /// does so in front of `base`; zero if the planes coincide.
    pub(super) fn common_line(base: &Plane, other: &Plane) -> Self {
        let (n, o) = (base.normal.map(i128::from), other.normal.map(i128::from));
        let (c, e) = (base.offset, other.offset);
        // Normals have 51 bits, so the direction fits; the moment may not.
        let term = |i: usize, j: usize| n[i] * o[j] - n[j] * o[i];
        let d = [term(1, 2), term(2, 0), term(0, 1)];
        let moment = |k: usize| n[k].checked_mul(e)?.checked_sub(o[k].checked_mul(c)?);
        if let (Some(x), Some(y), Some(z)) = (moment(0), moment(1), moment(2))
            && let Some(row) = narrow([x, y, z, d[0], d[1], d[2]])
        {
            return Self::Narrow(row);
        }
        let moment = |k: usize| IBig::from(n[k]) * IBig::from(e) - IBig::from(o[k]) * IBig::from(c);
        let row = [
            moment(0),
            moment(1),
            moment(2),
            IBig::from(d[0]),
            IBig::from(d[1]),
            IBig::from(d[2]),
        ];
        Self::of_big(primitive(row))
    }

    /// From big coefficients without a common factor.
    pub(super) fn of_big(row: [IBig; 6]) -> Self {
        let mut small = [0_i128; 6];
        for (to, from) in small.iter_mut().zip(&row) {
            match i128::try_from(from) {
                Ok(c) => *to = c,
                Err(_) => return Self::Wide(Wide::new(row)),
            }
        }
        match narrow(small) {
            Some(row) => Self::Narrow(row),
            None => Self::Wide(Wide::new(row)),
        }
    }

    /// The complement if `negative`.
    pub(super) fn turned(self, negative: bool) -> Self {
        match (negative, self) {
            (false, row) => row,
            (true, Self::Narrow(row)) => Self::Narrow(Fast::complement(&row)),
            (true, Self::Wide(row)) => Self::Wide(super::big::Big::complement(&row)),
        }
    }

    /// With big coefficients.
    pub(super) fn wide(&self) -> Wide {
        match self {
            Self::Narrow(row) => Wide::new(Fast::wide(row)),
            Self::Wide(row) => row.clone(),
        }
    }
}

/// The row divided by its greatest common divisor, if a fixed-width cone has room for it.
pub(super) fn narrow(row: [i128; 6]) -> Option<FastRow> {
    let mut divisor = 0_u128;
    // Directions first: they are shorter and often coprime.
    for k in [3, 4, 5, 0, 1, 2] {
        divisor = gcd(divisor, row[k].unsigned_abs());
        if divisor == 1 {
            break;
        }
    }
    let divisor = i128::try_from(divisor.max(1)).ok()?;
    let mut out: Row = [0; 6];
    for k in 0..6 {
        out[k] = i64::try_from(row[k] / divisor).ok()?;
    }
    let row = FastRow::new(out);
    (out.iter().all(|c| *c != i64::MIN) && Fast::excess(&row) <= Fast::ROOM).then_some(row)
}

fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The sign of a wide row at a fixed-width vertex, exact.
pub(super) fn sign_at(row: &Wide, vertex: &FastVertex) -> Sign {
    let mut sum = 0.0;
    let mut slack = 0.0;
    for (a, b) in row.approx().iter().zip(&vertex.approx) {
        sum += a * b;
        slack += (a * b).abs() * FILTER + 4.0 * b.abs();
    }
    if sum > slack {
        Sign::Positive
    } else if sum < -slack {
        Sign::Negative
    } else {
        sign_of(&dot(&row.exact, &vertex.wide()))
    }
}

#[cfg(test)]
mod tests {
    use super::{Hyperplane, sign_at};
    use crate::check::fast::{Fast, FastRow, FastVertex};
    use crate::check::numbers::Numbers;
    use antumbra_kernel::plucker::line_through;
    use antumbra_kernel::{I256, Plane, Point, Sign};

    fn sign(row: &Hyperplane, a: Point, b: Point) -> Sign {
        let line = FastVertex::new(line_through(a, b).map(I256::from_i64));
        let wide = sign_at(&row.wide(), &line);
        if let Hyperplane::Narrow(row) = row {
            assert_eq!(Fast::sign(row, &line), wide);
        }
        wide
    }

    #[test]
    fn a_common_line_tells_before_from_behind() {
        let p = Point::new;
        let base = Plane::through(p(0, 0, 0), p(1, 0, 0), p(0, 1, 0));
        let far = 8_000_000;
        // A steep plane through the x axis, and one with large coefficients.
        let steep = Plane::through(p(0, 0, 0), p(0, 1, 1), p(1, 0, 0));
        let odd = Plane::through(p(far, 3, -far), p(7, far, far), p(-far, 1 - far, 11));
        for (plane, wide) in [(steep, false), (odd, true), (odd.flipped(), true)] {
            let row = Hyperplane::common_line(&base, &plane);
            assert_eq!(matches!(row, Hyperplane::Wide(_)), wide);
            // Through each grid point of the plane along the normal, above and below the base.
            for s in 0..40_i32 {
                let (a, b) = (p(s * 1000 - 20_000, 13 * s, -far + 1), p(5, s, far - 7));
                let (x, y) = (plane.evaluate(a), plane.evaluate(b));
                if x >= 0 || y <= 0 {
                    continue;
                }
                // The height of the crossing, times a positive number.
                let z = i128::from(a.z) * y - i128::from(b.z) * x;
                assert_eq!(sign(&row, a, b), Sign::of(z));
            }
        }
    }

    #[test]
    fn equal_rows_are_recognised() {
        let row = |c| FastRow::new([c, 1, 2, 3, 4, 5]);
        assert!(row(1) == row(1) && row(1) != row(2));
    }
}
