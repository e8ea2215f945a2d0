//! Does a cone hold an open set of real lines?
//!
//! Real lines are the points where the quadric `Q = d . m` vanishes, so the question is whether Q
//! takes both strict signs. A sign shows at a vertex, on an edge, or inside a 2-face whose three
//! skew tight lines have transversals strictly inside it; see "When does a cell contain a real
//! line" in the design.

use antumbra_kernel::Sign;
use dashu_int::IBig;

use super::big::{dot, form, sign_of};
use super::cone::{Cone, bits};
use super::numbers::Numbers;

/// Exact: true if and only if Q takes both strict signs on the cone.
pub(super) fn holds_real_lines<N: Numbers>(cone: &Cone<N>) -> bool {
    let values: Vec<N::Form> = cone.rays.iter().map(|r| N::quadric(&r.vertex)).collect();
    let signs: Vec<Sign> = values.iter().map(N::form_sign).collect();
    let shown = |sign: Sign| signs.contains(&sign);
    if shown(Sign::Positive) && shown(Sign::Negative) {
        return true;
    }
    let mut pairs: [Vec<(usize, usize)>; 2] = [Vec::new(), Vec::new()];
    for i in 0..signs.len() {
        for j in 0..i {
            match N::bilinear_sign(&cone.rays[i].vertex, &cone.rays[j].vertex) {
                Sign::Positive => pairs[0].push((i, j)),
                Sign::Negative => pairs[1].push((i, j)),
                Sign::Zero => {}
            }
        }
    }
    [Sign::Positive, Sign::Negative]
        .into_iter()
        .zip(&pairs)
        // One weak sign on all pairs is one weak sign on all combinations.
        .all(|(sign, pairs)| {
            shown(sign) || !pairs.is_empty() && takes(cone, &values, &signs, pairs)
        })
}

/// Whether Q takes a sign that no vertex has, given the pairs whose bilinear form has that sign.
fn takes<N: Numbers>(
    cone: &Cone<N>,
    values: &[N::Form],
    signs: &[Sign],
    pairs: &[(usize, usize)],
) -> bool {
    let on_edge = pairs.iter().any(|&(i, j)| {
        signs[i].is_zero() || signs[j].is_zero() || {
            let b = N::bilinear(&cone.rays[i].vertex, &cone.rays[j].vertex);
            N::crosses(&b, &values[i], &values[j])
        }
    });
    on_edge || pairs.iter().any(|&(i, j)| in_a_face(cone, i, j))
}

/// Whether a 2-face at two rays has a transversal of its three lines strictly inside.
fn in_a_face<N: Numbers>(cone: &Cone<N>, i: usize, j: usize) -> bool {
    let tight: Vec<usize> = bits(cone.rays[i].tight & cone.rays[j].tight).collect();
    for (a, &x) in tight.iter().enumerate() {
        for (b, &y) in tight.iter().enumerate().skip(a + 1) {
            for &z in &tight[b + 1..] {
                let lines = [x, y, z].map(|k| N::wide(&cone.rows[k]));
                if pairwise_skew(&lines) && conic_inside(cone, &lines, 1 << x | 1 << y | 1 << z) {
                    return true;
                }
            }
        }
    }
    false
}

/// Whether three rows are real lines and pairwise skew.
fn pairwise_skew(lines: &[[IBig; 6]; 3]) -> bool {
    (0..3).all(|k| {
        form(&lines[k], &lines[k]) == IBig::ZERO
            && form(&lines[k], &lines[(k + 1) % 3]) != IBig::ZERO
    })
}

/// Whether a transversal of three skew lines lies strictly inside the face they are tight on.
///
/// If one does, Q takes both signs beside it. If Q has one weak sign on the face's boundary, then
/// all transversals are inside or none is, but for points where their conic touches the boundary;
/// at most two for each row.
fn conic_inside<N: Numbers>(cone: &Cone<N>, lines: &[[IBig; 6]; 3], three: u128) -> bool {
    let face = cone.rays.iter().filter(|r| r.tight & three == three);
    let (count, full) = face.fold((0, u128::MAX), |(n, full), r| (n + 1, full & r.tight));
    if count < 3 {
        return false;
    }
    let rows: Vec<(bool, [IBig; 6])> = (0..cone.rows.len())
        .map(|k| (full >> k & 1 == 1, N::wide(&cone.rows[k])))
        .collect();
    // A line at infinity has no finite points to start from; then another one serves.
    let Some(base) = (0..3).find(|&k| lines[k][3..].iter().any(|c| *c != IBig::ZERO)) else {
        return true;
    };
    let (e, f, g) = (&lines[base], &lines[(base + 1) % 3], &lines[(base + 2) % 3]);
    for step in 0..=2 * rows.len() as i64 {
        let transversal = transversal(&point_on(e, step), f, g);
        let mut sides = [false; 2];
        let mut doubtful = false;
        for (in_face, row) in &rows {
            match (in_face, sign_of(&dot(row, &transversal))) {
                (true, Sign::Zero) => {}
                // More rows are tight than three lines allow: a lower face.
                (true, _) => return false,
                (false, Sign::Zero) => doubtful = true,
                (false, Sign::Positive) => sides[0] = true,
                (false, Sign::Negative) => sides[1] = true,
            }
        }
        match (sides, doubtful) {
            ([true, true], _) => return false,
            (_, true) => {}
            (_, false) => return true,
        }
    }
    // Undecided: not accepted as empty.
    true
}

/// A homogeneous point of the line with a row `(m; d)`, another one for each step.
fn point_on(row: &[IBig; 6], step: i64) -> ([IBig; 3], IBig) {
    let (m, d) = halves(row);
    let square: IBig = d.iter().map(|c| c * c).sum();
    let foot = cross(&d, &m);
    let along = IBig::from(step);
    (std::array::from_fn(|k| &foot[k] + &d[k] * &along), square)
}

/// The line `(d; m)` through a homogeneous point that meets two others.
fn transversal(point: &([IBig; 3], IBig), f: &[IBig; 6], g: &[IBig; 6]) -> [IBig; 6] {
    let plane = |row: &[IBig; 6]| {
        let (m, d) = halves(row);
        let turn = cross(&point.0, &d);
        let normal: [IBig; 3] = std::array::from_fn(|k| &m[k] * &point.1 - &turn[k]);
        let offset: IBig = (0..3).map(|k| &m[k] * &point.0[k]).sum();
        (normal, offset)
    };
    let ((n, c), (o, e)) = (plane(f), plane(g));
    let d = cross(&n, &o);
    let m: [IBig; 3] = std::array::from_fn(|k| &n[k] * &e - &o[k] * &c);
    let ([d0, d1, d2], [m0, m1, m2]) = (d, m);
    [d0, d1, d2, m0, m1, m2]
}

fn halves(row: &[IBig; 6]) -> ([IBig; 3], [IBig; 3]) {
    (
        std::array::from_fn(|k| row[k].clone()),
        std::array::from_fn(|k| row[3 + k].clone()),
    )
}

fn cross(a: &[IBig; 3], b: &[IBig; 3]) -> [IBig; 3] {
    let term = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [term(1, 2), term(2, 0), term(0, 1)]
}

#[cfg(test)]
mod tests {
    use super::super::ends::Gate;
    use super::super::fast::{Fast, FastRow};
    use super::super::piece::Piece;
    use super::*;
    use antumbra_kernel::plucker::edge_row;
    use antumbra_kernel::{Plane, Point};

    fn square(half: i32, z: i32) -> Gate {
        let p = |x, y| Point::new(x, y, z);
        let corners = vec![
            p(-half, -half),
            p(half, -half),
            p(half, half),
            p(-half, half),
        ];
        let plane = Plane::through(corners[0], corners[1], corners[2]);
        Gate { corners, plane }
    }

    fn start(from: &Gate, to: &Gate) -> Cone<Fast> {
        let pieces = Piece::all_between(from, to).expect("small rows");
        match &pieces[..] {
            [Piece::Fast(cone)] => cone.clone(),
            other => panic!("{} pieces", other.len()),
        }
    }

    #[test]
    fn two_squares_see_each_other() {
        let cone = start(&square(4000, -1000), &square(4000, 1000));
        assert_eq!(cone.rows.len(), 10);
        assert!(holds_real_lines(&cone));
    }

    /// The cells between two squares and lines through (a, -1000) and (J a, +1000), J the quarter
    /// turn.
    fn cells() -> Vec<Cone<Fast>> {
        let mut cells = vec![start(&square(4000, -1000), &square(4000, 1000))];
        for (x, y) in [(30, 20), (500, 0), (-300, 400), (-200, -450)] {
            let row = edge_row(Point::new(x, y, -1000), Point::new(-y, x, 1000));
            let cut = |cell: Cone<Fast>| cell.cut(&FastRow::new(row)).expect("small rows");
            cells = cells.into_iter().flat_map(cut).flatten().collect();
        }
        cells
    }

    /// The cell of 54 vertices, all with Q > 0, where no edge shows that real lines fill it.
    #[test]
    fn a_conic_inside_a_face_is_found() {
        let mut cells = cells();
        cells.retain(|cell| {
            let positive = |v| Fast::form_sign(&Fast::quadric(v)).is_positive();
            cell.rays.iter().all(|r| positive(&r.vertex))
        });
        let [cell] = &cells[..] else {
            panic!("{} cells", cells.len());
        };
        assert_eq!(cell.rays.len(), 54);
        assert!(holds_real_lines(cell));
        let mut conics = 0;
        for (i, p) in cell.rays.iter().enumerate() {
            for (j, q) in cell.rays.iter().enumerate().take(i) {
                let b = Fast::bilinear(&p.vertex, &q.vertex);
                let (v, w) = (Fast::quadric(&p.vertex), Fast::quadric(&q.vertex));
                let shows = b.is_negative() && Fast::crosses(&b, &v, &w);
                assert!(!shows || !cell.adjacent(i, j));
                conics += u32::from(in_a_face(cell, i, j));
            }
        }
        assert!(conics > 0);
    }

    #[test]
    fn big_numbers_agree() {
        for cell in cells() {
            let wide = super::super::piece::widened(&cell);
            assert_eq!(holds_real_lines(&cell), holds_real_lines(&wide));
        }
    }

    #[test]
    fn transversals_meet_all_three_lines() {
        let row = |a: [i32; 3], b: [i32; 3]| edge_row(a.into(), b.into()).map(IBig::from);
        let e = row([1, 2, 3], [4, 4, 9]);
        let (f, g) = (row([0, 5, 1], [-3, 2, 2]), row([7, 7, 0], [1, 0, -8]));
        for step in -3..4 {
            let t = transversal(&point_on(&e, step), &f, &g);
            assert!(t.iter().any(|c| *c != IBig::ZERO));
            assert_eq!(form(&t, &t), IBig::ZERO);
            for line in [&e, &f, &g] {
                assert_eq!(dot(line, &t), IBig::ZERO);
            }
        }
    }
}
