//! Plücker coordinates of oriented lines, hyperplane rows, and the vertices of line space.
//!
//! After [Bittner02, 8.4]: a line through u and v is the point `(d; m)` with `d = v - u` and
//! `m = u x v`. The hyperplane of an edge has the row `(m; d)`, so that `row . point` is the side
//! of two lines, and the Plücker quadric is `Q = d . m`.
//! A float filter with its proved bound decides most sides; exact integers decide the rest.

use crate::{I256, I512, Int, Point, Sign};

/// A hyperplane of line space through the origin, as integer coefficients `(m; d)`.
///
/// For an edge between grid points the first three have 49 bits, the last three 25, so that both
/// convert to doubles without rounding.
pub type Row = [i64; 6];

/// The row of the oriented edge from `u` to `v`.
///
/// For a polygon whose corners turn counter-clockwise about its normal, a line that crosses it
/// along the normal has the rows of all edges positive, against the normal negative.
#[inline]
#[must_use]
pub fn edge_row(u: Point, v: Point) -> Row {
    let d = crate::sub(v, u);
    let m = crate::cross(u.to_i64(), v.to_i64());
    [m[0], m[1], m[2], d[0], d[1], d[2]]
}

/// The Plücker point `(d; m)` of the oriented line from `u` to `v`.
#[inline]
#[must_use]
pub fn line_through(u: Point, v: Point) -> [i64; 6] {
    let [m0, m1, m2, d0, d1, d2] = edge_row(u, v);
    [d0, d1, d2, m0, m1, m2]
}

/// The side of the line a->b on the oriented edge u->v: the sign of their Plücker product.
///
/// The same as orient3d(u, v, a, b). Degree 3, 77 bits, exact in 128-bit integers; a double filter
/// decides most calls. The filter's products are of integers below 2^25 and 2^50, each exact in
/// a double; three additions of terms below 2^76 err by less than 3 * 2^23 * 2 < 2^26 in all.
#[inline]
#[must_use]
pub fn side(u: Point, v: Point, a: Point, b: Point) -> Sign {
    let e = crate::sub(v, u);
    let n = crate::cross(crate::sub(a, u), crate::sub(b, u));
    let f = e[0] as f64 * n[0] as f64 + e[1] as f64 * n[1] as f64 + e[2] as f64 * n[2] as f64;
    const BOUND: f64 = (1_u64 << 28) as f64;
    if f > BOUND {
        return Sign::Positive;
    }
    if f < -BOUND {
        return Sign::Negative;
    }
    let exact = i128::from(e[0]) * i128::from(n[0])
        + i128::from(e[1]) * i128::from(n[1])
        + i128::from(e[2]) * i128::from(n[2]);
    Sign::of(exact)
}

/// The point of line space on five hyperplanes: the six signed 5x5 cofactors of their rows.
///
/// The result is orthogonal to each row, zero exactly if the rows are dependent, and determined up
/// to its sign by the order of the rows. Degree 9, at most 195 bits for edge rows.
/// Laplace expansion by the three moment columns and the three direction columns.
#[must_use]
pub fn cofactors(rows: [&Row; 5]) -> [I256; 6] {
    // 2x2 minors of moment columns (99 bits) and direction columns (51 bits) for each row pair.
    let mut m2 = [[0_i128; 3]; 10];
    let mut d2 = [[0_i64; 3]; 10];
    for (p, &(i, j)) in PAIRS.iter().enumerate() {
        let (a, b) = (rows[i], rows[j]);
        for (k, &(c, e)) in COLUMN_PAIRS.iter().enumerate() {
            m2[p][k] = i128::from(a[c]) * i128::from(b[e]) - i128::from(a[e]) * i128::from(b[c]);
            d2[p][k] = a[3 + c] * b[3 + e] - a[3 + e] * b[3 + c];
        }
    }
    // Two moments and three directions take at most 189 bits, large rows included; three moments
    // and two directions 213.
    let mut dropped_moment = [Int::<3>::ZERO; 3];
    let mut dropped_direction = [I256::ZERO; 3];
    for (p, &(t, tail, sign)) in COMPLEMENTS.iter().enumerate() {
        let first = rows[t];
        // 3x3 minors of the complementary rows, expanded by their first row, with the Laplace sign.
        let d3 = i128::from(first[3]) * i128::from(d2[tail][0])
            - i128::from(first[4]) * i128::from(d2[tail][1])
            + i128::from(first[5]) * i128::from(d2[tail][2]);
        let d3 = if sign > 0 { d3 } else { -d3 };
        let m3 = Int::<3>::from_i128(m2[tail][0]).times_i64(first[0])
            - Int::<3>::from_i128(m2[tail][1]).times_i64(first[1])
            + Int::<3>::from_i128(m2[tail][2]).times_i64(first[2]);
        let m3 = m3.resize::<4>();
        for k in 0..3 {
            // Dropping a moment column leaves the pair k of moments and all directions.
            dropped_moment[k] = dropped_moment[k] + Int::<3>::product_i128(m2[p][k], d3);
            // Dropping a direction column leaves all moments and the pair k of directions.
            let d = if sign > 0 { d2[p][k] } else { -d2[p][k] };
            dropped_direction[k] = dropped_direction[k] + m3.times_i64(d);
        }
    }
    let [a, b, c] = dropped_moment.map(|v| v.resize::<4>());
    let [d, e, f] = dropped_direction;
    // Column pairs (1,2), (0,2), (0,1) are left when columns 0, 1, 2 are dropped.
    // The cofactor of column j has the sign (-1)^j; moving the pair of moments in front of the
    // three directions costs nothing, moving three moments in front of a pair of directions neither.
    [a, -b, c, -d, e, -f]
}

/// The cofactors in doubles, and bounds of their absolute errors.
///
/// The coefficients must be exact in doubles. Every term of a cofactor passes 18 roundings (five
/// in a 3x3 minor, two in a 2x2 minor, one in their product, ten in the sum of products), each
/// within a relative 2^-53 of a value that is bounded by the sum of the terms' magnitudes; that
/// sum is rounded as often. 2^-48 of it covers both. Products of five coefficients below 2^55
/// neither overflow nor, being integers, underflow.
#[must_use]
pub fn cofactors_rounded(rows: [&[f64; 6]; 5]) -> ([f64; 6], [f64; 6]) {
    const FILTER: f64 = 1.0 / (1_u64 << 48) as f64;
    let mut m2 = [[0.0; 3]; 10];
    let mut d2 = [[0.0; 3]; 10];
    let mut m2_size = [[0.0; 3]; 10];
    let mut d2_size = [[0.0; 3]; 10];
    for (p, &(i, j)) in PAIRS.iter().enumerate() {
        let (a, b) = (rows[i], rows[j]);
        for (k, &(c, e)) in COLUMN_PAIRS.iter().enumerate() {
            let (x, y) = (a[c] * b[e], a[e] * b[c]);
            m2[p][k] = x - y;
            m2_size[p][k] = x.abs() + y.abs();
            let (x, y) = (a[3 + c] * b[3 + e], a[3 + e] * b[3 + c]);
            d2[p][k] = x - y;
            d2_size[p][k] = x.abs() + y.abs();
        }
    }
    let mut out = [0.0; 6];
    let mut size = [0.0; 6];
    for (p, &(t, tail, sign)) in COMPLEMENTS.iter().enumerate() {
        let r = rows[t];
        let (d, m) = (&d2[tail], &m2[tail]);
        let d3 = r[3] * d[0] - r[4] * d[1] + r[5] * d[2];
        let m3 = r[0] * m[0] - r[1] * m[1] + r[2] * m[2];
        let (d, m) = (&d2_size[tail], &m2_size[tail]);
        let d3_size = r[3].abs() * d[0] + r[4].abs() * d[1] + r[5].abs() * d[2];
        let m3_size = r[0].abs() * m[0] + r[1].abs() * m[1] + r[2].abs() * m[2];
        let sign = f64::from(sign);
        for k in 0..3 {
            out[k] += m2[p][k] * (sign * d3);
            out[3 + k] += d2[p][k] * (sign * m3);
            size[k] += m2_size[p][k] * d3_size;
            size[3 + k] += d2_size[p][k] * m3_size;
        }
    }
    let [a, b, c, d, e, f] = out;
    ([a, -b, c, -d, e, -f], size.map(|s| s * FILTER))
}

/// Row pairs (i, j) with i < j.
const PAIRS: [(usize, usize); 10] = [
    (0, 1),
    (0, 2),
    (0, 3),
    (0, 4),
    (1, 2),
    (1, 3),
    (1, 4),
    (2, 3),
    (2, 4),
    (3, 4),
];

/// Column pairs left when column 0, 1 or 2 of a triple is dropped.
const COLUMN_PAIRS: [(usize, usize); 3] = [(1, 2), (0, 2), (0, 1)];

/// For each pair: the first row of the complementary triple, the index of the other two as a
/// pair, and the Laplace sign (-1)^(i + j + 1) of the pair among five rows.
const COMPLEMENTS: [(usize, usize, i32); 10] = [
    (2, 9, 1),
    (1, 9, -1),
    (1, 8, 1),
    (1, 7, -1),
    (0, 9, 1),
    (0, 8, -1),
    (0, 7, 1),
    (0, 6, 1),
    (0, 5, -1),
    (0, 4, 1),
];

/// `row . point` for a vertex of line space, exact: 221 bits.
#[inline]
#[must_use]
pub fn dot(row: &Row, point: &[I256; 6]) -> I256 {
    let mut sum = point[0].times_i64(row[0]);
    for k in 1..6 {
        sum = sum + point[k].times_i64(row[k]);
    }
    sum
}

/// The bilinear form `B(v, w) = d_v . m_w + m_v . d_w` of two vertices, exact: 371 bits.
#[must_use]
pub fn bilinear(v: &[I256; 6], w: &[I256; 6]) -> I512 {
    let mut sum = I512::ZERO;
    for k in 0..6 {
        sum = sum + v[k].resize::<8>().times(&w[(k + 3) % 6].resize::<8>());
    }
    sum
}

/// The Plücker quadric `Q(v) = d . m`, exact: 370 bits. Zero exactly on real lines.
#[must_use]
pub fn quadric(v: &[I256; 6]) -> I512 {
    let mut sum = I512::ZERO;
    for k in 0..3 {
        sum = sum + v[k].resize::<8>().times(&v[k + 3].resize::<8>());
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::{
        Row, bilinear, cofactors, cofactors_rounded, dot, edge_row, line_through, quadric, side,
    };
    use crate::{I256, LIMIT, Point, Sign};
    use dashu_int::IBig;

    /// A double that is an integer.
    fn exact_big(v: f64) -> IBig {
        IBig::try_from(v).expect("cofactors are integers")
    }

    struct Random(u64);

    impl Random {
        fn next(&mut self) -> u64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            self.0
        }
        fn coordinate(&mut self, kind: u32) -> i32 {
            let m = LIMIT - 1;
            match kind {
                0 => (self.next() % (2 * m as u64 + 1)) as i32 - m,
                1 => [-m, m, m - 1, 1 - m][(self.next() % 4) as usize],
                _ => (self.next() % 5) as i32 - 2,
            }
        }
        fn point(&mut self, kind: u32) -> Point {
            Point::new(
                self.coordinate(kind),
                self.coordinate(kind),
                self.coordinate(kind),
            )
        }
    }

    fn det(m: &[Vec<IBig>]) -> IBig {
        if m.len() == 1 {
            return m[0][0].clone();
        }
        let mut sum = IBig::ZERO;
        for (c, x) in m[0].iter().enumerate() {
            let minor: Vec<Vec<IBig>> = m[1..]
                .iter()
                .map(|r| {
                    r.iter()
                        .enumerate()
                        .filter(|(k, _)| *k != c)
                        .map(|(_, v)| v.clone())
                        .collect()
                })
                .collect();
            let term = x * det(&minor);
            if c % 2 == 0 { sum += term } else { sum -= term }
        }
        sum
    }

    fn big(v: &I256) -> IBig {
        let m = if v.is_negative() { -*v } else { *v };
        let mut out = IBig::ZERO;
        for &l in m.limbs().iter().rev() {
            out = (out << 64) + IBig::from(l);
        }
        if v.is_negative() { -out } else { out }
    }

    #[test]
    fn cofactors_agree_with_big_integers_and_stay_within_their_bound() {
        let mut rng = Random(42);
        for kind in 0..3 {
            for _ in 0..60 {
                let rows: [Row; 5] =
                    std::array::from_fn(|_| edge_row(rng.point(kind), rng.point(kind)));
                let v = cofactors([&rows[0], &rows[1], &rows[2], &rows[3], &rows[4]]);
                for (j, coordinate) in v.iter().enumerate() {
                    let m: Vec<Vec<IBig>> = rows
                        .iter()
                        .map(|r| {
                            (0..6)
                                .filter(|k| *k != j)
                                .map(|k| IBig::from(r[k]))
                                .collect()
                        })
                        .collect();
                    let expected = if j % 2 == 0 { det(&m) } else { -det(&m) };
                    assert_eq!(big(coordinate), expected);
                    assert!(coordinate.bits() <= 195);
                }
                assert!(rows.iter().all(|r| dot(r, &v).sign().is_zero()));
                let doubles = rows.map(|r| r.map(|c| c as f64));
                let (rounded, error) = cofactors_rounded(std::array::from_fn(|i| &doubles[i]));
                for k in 0..6 {
                    let off = big(&v[k]) - exact_big(rounded[k]);
                    let off = if off < IBig::ZERO { -off } else { off };
                    assert!(off <= exact_big(error[k].ceil()));
                }
            }
        }
    }

    #[test]
    fn side_agrees_with_the_plucker_product() {
        let mut rng = Random(7);
        for kind in 0..3 {
            for _ in 0..3000 {
                let p: [Point; 4] = std::array::from_fn(|_| rng.point(kind));
                let row = edge_row(p[0], p[1]);
                let line = line_through(p[2], p[3]);
                let product: i128 = (0..6)
                    .map(|k| i128::from(row[k]) * i128::from(line[k]))
                    .sum();
                assert_eq!(side(p[0], p[1], p[2], p[3]), Sign::of(product));
                assert_eq!(side(p[2], p[3], p[0], p[1]), Sign::of(product));
            }
        }
    }

    #[test]
    fn real_lines_lie_on_the_quadric() {
        let mut rng = Random(9);
        for _ in 0..200 {
            let l = line_through(rng.point(0), rng.point(0)).map(I256::from_i64);
            let k = line_through(rng.point(1), rng.point(0)).map(I256::from_i64);
            assert!(quadric(&l).sign().is_zero());
            assert_eq!(bilinear(&l, &k).sign(), bilinear(&k, &l).sign());
        }
    }

    #[test]
    fn a_line_along_the_normal_has_positive_sides() {
        let corners = [
            Point::new(0, 0, 0),
            Point::new(4, 0, 0),
            Point::new(0, 4, 0),
        ];
        for i in 0..3 {
            let s = side(
                corners[i],
                corners[(i + 1) % 3],
                Point::new(1, 1, -1),
                Point::new(1, 1, 1),
            );
            assert_eq!(s, Sign::Positive);
        }
    }
}
