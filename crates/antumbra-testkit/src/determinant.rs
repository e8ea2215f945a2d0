//! Every predicate's value by naive expansion over big integers, for arbitrary 64-bit input.
//!
//! Signs of orientation are stated in words at each function; compare signs with care.

use dashu_int::IBig;

/// A line in Plücker coordinates (d; m): direction, then moment.
pub type Row = [IBig; 6];

/// The sign of a big integer: -1, 0 or 1.
#[must_use]
pub fn sign(value: &IBig) -> i8 {
    match value.cmp(&IBig::ZERO) {
        std::cmp::Ordering::Less => -1,
        std::cmp::Ordering::Equal => 0,
        std::cmp::Ordering::Greater => 1,
    }
}

/// The determinant of a square matrix, by expansion along the first row.
///
/// # Panics
/// If the matrix is not square.
#[must_use]
pub fn determinant(matrix: &[Vec<IBig>]) -> IBig {
    let n = matrix.len();
    assert!(
        matrix.iter().all(|row| row.len() == n),
        "the matrix is not square"
    );
    if n == 0 {
        return IBig::ONE;
    }
    let mut sum = IBig::ZERO;
    for column in 0..n {
        let term = &matrix[0][column] * determinant(&minor(&matrix[1..], column));
        if column % 2 == 0 {
            sum += term;
        } else {
            sum -= term;
        }
    }
    sum
}

fn minor(rows: &[Vec<IBig>], without: usize) -> Vec<Vec<IBig>> {
    let pick = |row: &Vec<IBig>| {
        let kept = row.iter().enumerate().filter(|(k, _)| *k != without);
        kept.map(|(_, value)| value.clone()).collect()
    };
    rows.iter().map(pick).collect()
}

/// Six times the signed volume of the tetrahedron: `det(b - a, c - a, d - a)`.
///
/// Positive if `d` lies where the right-hand normal of the triangle a, b, c points.
#[must_use]
pub fn orient3d(a: [i64; 3], b: [i64; 3], c: [i64; 3], d: [i64; 3]) -> IBig {
    let row = |p: [i64; 3]| {
        (0..3)
            .map(|k| IBig::from(p[k]) - IBig::from(a[k]))
            .collect()
    };
    determinant(&[row(b), row(c), row(d)])
}

/// Twice the signed area of a triangle in the plane; positive if it turns left.
#[must_use]
pub fn orient2d(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> IBig {
    let row = |p: [i64; 2]| {
        (0..2)
            .map(|k| IBig::from(p[k]) - IBig::from(a[k]))
            .collect()
    };
    determinant(&[row(b), row(c)])
}

/// The Plücker coordinates of the line from `u` to `v`: d = v - u, m = u x v.
#[must_use]
pub fn plucker(u: [i64; 3], v: [i64; 3]) -> Row {
    let (p, q) = (u.map(IBig::from), v.map(IBig::from));
    let moment = |i: usize, j: usize| &p[i] * &q[j] - &p[j] * &q[i];
    [
        &q[0] - &p[0],
        &q[1] - &p[1],
        &q[2] - &p[2],
        moment(1, 2),
        moment(2, 0),
        moment(0, 1),
    ]
}

/// The coefficients of the hyperplane of all lines that meet `line`: (m; d).
#[must_use]
pub fn coefficients(line: &Row) -> Row {
    std::array::from_fn(|k| line[(k + 3) % 6].clone())
}

/// The side of two lines, `d_a . m_b + d_b . m_a`.
///
/// For lines a = uv and b = pq it equals `orient3d(u, v, p, q)`.
#[must_use]
pub fn side(a: &Row, b: &Row) -> IBig {
    dot(a, &coefficients(b))
}

/// The Plücker quadric, `d . m`: zero for real lines; half of `side(a, a)`.
#[must_use]
pub fn quadric(a: &Row) -> IBig {
    (0..3).map(|k| &a[k] * &a[k + 3]).sum()
}

/// The plain dot product of two rows.
#[must_use]
pub fn dot(a: &Row, b: &Row) -> IBig {
    (0..6).map(|k| &a[k] * &b[k]).sum()
}

/// The point on five hyperplanes: the six signed 5x5 minors of their rows, so that the dot product
/// with a sixth row is the determinant of all six with the sixth row on top.
#[must_use]
pub fn cofactors(rows: &[Row; 5]) -> Row {
    let rows: Vec<Vec<IBig>> = rows.iter().map(|r| r.to_vec()).collect();
    std::array::from_fn(|k| {
        let value = determinant(&minor(&rows, k));
        if k % 2 == 0 { value } else { -value }
    })
}

/// The determinant of six rows.
#[must_use]
pub fn determinant6(rows: &[Row; 6]) -> IBig {
    determinant(&rows.iter().map(|r| r.to_vec()).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use dashu_int::IBig;

    use super::{
        coefficients, cofactors, determinant6, dot, orient2d, orient3d, plucker, quadric, side,
        sign,
    };
    use crate::points::Points;

    #[test]
    fn conventions_are_what_the_text_says() {
        let (o, x, y, z) = ([0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]);
        assert_eq!(orient3d(o, x, y, z), IBig::ONE);
        assert_eq!(orient2d([0, 0], [1, 0], [0, 1]), IBig::ONE);
        assert_eq!(sign(&orient3d(o, y, x, z)), -1);
        assert_eq!(plucker(x, y).map(|c| sign(&c)), [-1, 1, 0, 0, 0, 1]);
    }

    #[test]
    fn side_is_a_volume_and_lines_are_real() {
        let mut points = Points::new(1);
        for _ in 0..300 {
            let [u, v, p, q] = std::array::from_fn(|_| points.any());
            let (a, b) = (plucker(u, v), plucker(p, q));
            assert_eq!(side(&a, &b), orient3d(u, v, p, q));
            assert_eq!(side(&a, &b), side(&b, &a));
            assert_eq!(quadric(&a), IBig::ZERO);
            assert_eq!(side(&a, &a), IBig::ZERO);
        }
    }

    #[test]
    fn a_vertex_lies_on_its_five_hyperplanes() {
        let mut points = Points::new(2);
        for _ in 0..20 {
            let mut row = || coefficients(&plucker(points.any(), points.any()));
            let rows: [_; 5] = std::array::from_fn(|_| row());
            let sixth = row();
            let vertex = cofactors(&rows);
            assert!(rows.iter().all(|r| dot(r, &vertex) == IBig::ZERO));
            let [a, b, c, d, e] = rows;
            assert_eq!(dot(&sixth, &vertex), determinant6(&[sixth, a, b, c, d, e]));
        }
    }

    #[test]
    fn any_64_bit_input_is_welcome() {
        let (low, high) = (i64::MIN, i64::MAX);
        let volume = orient3d(
            [low; 3],
            [high, low, low],
            [low, high, low],
            [low, low, high],
        );
        let edge = IBig::from(high) - IBig::from(low);
        assert_eq!(volume, &edge * &edge * &edge);
    }
}
