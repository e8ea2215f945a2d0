//! The two predicates over a lattice of grid points, in floats and in exact integers.
//!
//! Both stand where a building puts its geometry: long edges along a corridor, nearly parallel,
//! and a sight line that touches all of them.

use std::ops::{Add, Mul, Sub};

use antumbra_kernel::{Point, Sign, plucker};

/// Lattice points along each side of a panel.
pub(crate) const SIZE: i32 = 96;

/// A predicate whose last point runs over a lattice of neighboring grid points.
pub(crate) struct Lattice {
    /// What is asked.
    pub(crate) title: &'static str,
    /// The oriented edges; the second point of the first one is replaced by the lattice point.
    pub(crate) edges: Vec<[Point; 2]>,
}

impl Lattice {
    /// The side of two lines, a polynomial of degree 3.
    pub(crate) fn two_lines() -> Self {
        let touch = Point::new(1_203_400, 2_500_000, 700_000);
        let along = [3, 2, 0];
        Self {
            title: "side of two lines: degree 3",
            edges: vec![
                through(touch, [1_180_000, 850_000, 5_000], 3, 2),
                through(touch, along, 1_500_000, 1_200_000),
            ],
        }
    }

    /// A vertex of line space, the point on five edge rows, against the row of a sixth edge: the
    /// determinant of six rows, a polynomial of degree 9.
    pub(crate) fn corridor() -> Self {
        let along = [3, 2, 0];
        let at = |t: i32| {
            let [x, y, z] = along.map(|c| c * t);
            Point::new(x - 2_000_000, y + 1_000_000, z + 400_000)
        };
        let edges = [
            (100_000, [300_012, 199_970, 5], 6, 9),
            (300_000, [299_999, 199_990, -4], 7, 8),
            (550_000, [299_991, 200_010, 3], 9, 6),
            (800_000, [300_009, 200_020, -2], 5, 9),
            (1_000_000, [299_982, 199_990, 6], 8, 7),
            (1_200_000, [299_998, 199_980, -7], 6, 4),
        ];
        Self {
            title: "vertex of five edges against a sixth: degree 9",
            edges: edges
                .iter()
                .map(|&(t, d, back, ahead)| through(at(t), d, back, ahead))
                .collect(),
        }
    }

    /// The edges with the lattice point in place; the middle of the lattice is a true zero.
    pub(crate) fn at(&self, i: i32, j: i32) -> Vec<[Point; 2]> {
        let mut edges = self.edges.clone();
        let end = &mut edges[0][1];
        *end = Point::new(end.x + i - SIZE / 2, end.y + j - SIZE / 2, end.z);
        edges
    }

    /// The sign by the kernel.
    pub(crate) fn exact(&self, i: i32, j: i32) -> Sign {
        match self.at(i, j).as_slice() {
            [line, edge] => plucker::side(edge[0], edge[1], line[0], line[1]),
            edges => {
                let rows: Vec<_> = edges
                    .iter()
                    .map(|e| plucker::edge_row(e[0], e[1]))
                    .collect();
                let vertex = plucker::cofactors([&rows[0], &rows[1], &rows[2], &rows[3], &rows[4]]);
                plucker::dot(&rows[5], &vertex).sign()
            }
        }
    }

    /// The sign by the same formulas in floats.
    pub(crate) fn naive<T: Float>(&self, i: i32, j: i32) -> Sign {
        // The last row first: so the expansion has the sign of the cofactors, and the lattice
        // point is in all of its products.
        let rows: Vec<[T; 6]> = self
            .at(i, j)
            .iter()
            .rev()
            .map(|e| row(e[0], e[1]))
            .collect();
        let value = match rows.as_slice() {
            [line, edge] => sum((0..6).map(|k| edge[k] * line[(k + 3) % 6])),
            rows => determinant(rows, &[0, 1, 2, 3, 4, 5]),
        };
        match value.partial_cmp(&T::from(0.0)) {
            Some(std::cmp::Ordering::Greater) => Sign::Positive,
            Some(std::cmp::Ordering::Less) => Sign::Negative,
            _ => Sign::Zero,
        }
    }
}

/// What the naive formulas need of a number.
pub(crate) trait Float:
    Copy + PartialOrd + From<f32> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
}
impl Float for f32 {}
impl Float for f64 {}

/// The edge through a point along a direction, so long behind it and so long ahead.
fn through(p: Point, d: [i32; 3], back: i32, ahead: i32) -> [Point; 2] {
    let at = |t: i32| Point::new(p.x + d[0] * t, p.y + d[1] * t, p.z + d[2] * t);
    [at(-back), at(ahead)]
}

/// The row `(m; d)` of an edge. Grid points have 24 bits: scaled to the unit box they are exact in
/// both widths, so all that is lost is lost by the arithmetic.
fn row<T: Float>(u: Point, v: Point) -> [T; 6] {
    let unit = |p: Point| p.to_array().map(|c| T::from(c as f32 / (1 << 23) as f32));
    let (u, v) = (unit(u), unit(v));
    [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
        v[0] - u[0],
        v[1] - u[1],
        v[2] - u[2],
    ]
}

/// Laplace's expansion by the first row.
fn determinant<T: Float>(rows: &[[T; 6]], columns: &[usize]) -> T {
    let [first, rest @ ..] = rows else {
        return T::from(1.0);
    };
    sum(columns.iter().enumerate().map(|(k, &c)| {
        let others: Vec<usize> = columns.iter().copied().filter(|&o| o != c).collect();
        let sign = T::from(if k % 2 == 0 { 1.0 } else { -1.0 });
        sign * first[c] * determinant(rest, &others)
    }))
}

fn sum<T: Float>(terms: impl Iterator<Item = T>) -> T {
    terms.fold(T::from(0.0), |a, b| a + b)
}

#[cfg(test)]
mod tests {
    use super::{Lattice, SIZE};
    use antumbra_kernel::Sign;
    use dashu_int::IBig;

    /// The determinant of the defining rows by big integers, by the same expansion and no other code.
    fn oracle(lattice: &Lattice, i: i32, j: i32) -> Sign {
        let rows: Vec<Vec<IBig>> = lattice
            .at(i, j)
            .iter()
            .map(|&[u, v]| big_row(u, v))
            .collect();
        let value = match rows.as_slice() {
            [line, edge] => (0..6).map(|k| &edge[k] * &line[(k + 3) % 6]).sum(),
            rows => -big_determinant(rows, &[0, 1, 2, 3, 4, 5]),
        };
        match value.cmp(&IBig::ZERO) {
            std::cmp::Ordering::Greater => Sign::Positive,
            std::cmp::Ordering::Less => Sign::Negative,
            std::cmp::Ordering::Equal => Sign::Zero,
        }
    }

    fn big_row(u: antumbra_kernel::Point, v: antumbra_kernel::Point) -> Vec<IBig> {
        let (u, v) = (u.to_array().map(IBig::from), v.to_array().map(IBig::from));
        let cross = |a: usize, b: usize| &u[a] * &v[b] - &u[b] * &v[a];
        let moment = [cross(1, 2), cross(2, 0), cross(0, 1)];
        moment
            .into_iter()
            .chain((0..3).map(|k| &v[k] - &u[k]))
            .collect()
    }

    fn big_determinant(rows: &[Vec<IBig>], columns: &[usize]) -> IBig {
        let [first, rest @ ..] = rows else {
            return IBig::ONE;
        };
        columns.iter().enumerate().fold(IBig::ZERO, |sum, (k, &c)| {
            let others: Vec<usize> = columns.iter().copied().filter(|&o| o != c).collect();
            let term = &first[c] * big_determinant(rest, &others);
            if k % 2 == 0 { sum + term } else { sum - term }
        })
    }

    #[test]
    fn exact_signs_are_those_of_big_integers_and_naive_ones_are_not() {
        for (lattice, doubles_fail) in [(Lattice::two_lines(), false), (Lattice::corridor(), true)]
        {
            let (mut zeros, mut single, mut double) = (0, 0, 0);
            for (i, j) in (0..SIZE).flat_map(|i| (0..SIZE).map(move |j| (i, j))) {
                let sign = oracle(&lattice, i, j);
                assert_eq!(lattice.exact(i, j), sign, "{} at {i}, {j}", lattice.title);
                zeros += i32::from(sign.is_zero());
                single += i32::from(lattice.naive::<f32>(i, j) != sign);
                let wide = lattice.naive::<f64>(i, j);
                double += i32::from(wide != sign);
                assert!(doubles_fail || wide == sign || sign.is_zero());
            }
            assert!(zeros > SIZE / 4, "the line of true zeros crosses the panel");
            assert!(
                single > SIZE * SIZE / 10,
                "{single} wrong of {}",
                SIZE * SIZE
            );
            assert_eq!(double > SIZE * SIZE / 10, doubles_fail, "{double} wrong");
        }
    }
}
