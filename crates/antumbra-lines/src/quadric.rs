//! Does a cone of line space contain an open set of real lines?
//!
//! Real lines are the zeros of the Plücker quadric Q. A cone holds an open set of them exactly if
//! Q takes both strict signs in it. The decision looks at vertices, then at pairs of vertices,
//! then at 2-faces tight on three pairwise skew lines; `docs/notes/real-lines.md` has the proof.
//! Differs from [Teller92], which intersects edges only and misses cells whose real lines touch
//! no edge.
//! Float filters with proved bounds come first, exact integers decide where they cannot.

use antumbra_kernel::Sign;
use dashu_int::IBig;

use crate::cone::{Cone, Halfspace};
use crate::space::{PluckerSpace, VertexId, sign_of};

/// What is known of a cone's real lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RealLines {
    /// Q takes both strict signs: an open set of real lines is inside.
    Some,
    /// Q has one weak sign on the cone.
    None,
}

/// Decides whether the interior of a cone contains real lines. Exact; degree 30 in the worst case.
#[must_use]
pub fn real_lines(space: &mut PluckerSpace, cone: &Cone) -> RealLines {
    let vertices: Vec<VertexId> = cone.vertices().collect();
    let signs: Vec<Sign> = vertices
        .iter()
        .map(|&v| space.bilinear_sign(v, v))
        .collect();
    let mut positive = signs.iter().any(|s| s.is_positive());
    let mut negative = signs.iter().any(|s| s.is_negative());
    if positive && negative {
        return RealLines::Some;
    }
    // Vertex pairs: a pair of zeros of Q with a strict product gives that sign between them.
    let mut mixed = Vec::new();
    let mut pair_signs = (false, false);
    for i in 0..vertices.len() {
        for j in i + 1..vertices.len() {
            let b = space.bilinear_sign(vertices[i], vertices[j]);
            match b {
                Sign::Zero => continue,
                Sign::Positive => pair_signs.0 = true,
                Sign::Negative => pair_signs.1 = true,
            }
            if signs[i].is_zero() || signs[j].is_zero() {
                // Q(v_i + t v_j) = Q_i + t B (+ t^2 Q_j) takes the sign of B for large or small t.
                positive |= b.is_positive();
                negative |= b.is_negative();
            } else if b != signs[i] {
                mixed.push((i, j));
            }
        }
        if positive && negative {
            return RealLines::Some;
        }
    }
    // One weak sign of B on all pairs, Q included: Q has that weak sign on the whole cone.
    if !((positive || pair_signs.0) && (negative || pair_signs.1)) {
        return RealLines::None;
    }
    // Here Q has one strict sign at least somewhere, and the other one is missing so far.
    for (i, j) in mixed {
        if crosses_quadric(space, vertices[i], vertices[j]) {
            return RealLines::Some;
        }
    }
    if cone
        .faces_on_three()
        .iter()
        .any(|(three, others)| holds_conic(space, three, others))
    {
        return RealLines::Some;
    }
    RealLines::None
}

/// Whether the open edge between two vertices with the same strict sign of Q and the opposite sign
/// of B crosses the quadric: B^2 > 4 Q_i Q_j, with B = B(v_i, v_j) and Q = d . m.
fn crosses_quadric(space: &mut PluckerSpace, v: VertexId, w: VertexId) -> bool {
    loop {
        // B(v, v) is 2 Q(v), so the test is b^2 > q_v q_w; the errors of the three forms and the
        // rounding of their products bound the error of the difference.
        let ((b, e_b), (q_v, e_v), (q_w, e_w)) = (
            space.bilinear(v, w),
            space.bilinear(v, v),
            space.bilinear(w, w),
        );
        let lead = b * b - q_v * q_w;
        let rounding = (b * b + (q_v * q_w).abs()) * (1.0 / (1_u64 << 50) as f64);
        let error = 2.0 * b.abs() * e_b + e_b * e_b + q_v.abs() * e_w + q_w.abs() * e_v + e_v * e_w;
        let bound = 2.0 * (error + rounding);
        if lead > bound {
            return true;
        }
        if lead < -bound {
            return false;
        }
        let (first, second) = (space.sharpen(v), space.sharpen(w));
        if !(first || second) {
            break;
        }
    }
    let b = space.big_bilinear(v, w);
    let q = space.big_bilinear(v, v) * space.big_bilinear(w, w);
    &b * &b > q
}

/// Whether a 2-face that is tight on three pairwise skew lines contains its whole conic strictly
/// inside all other half-spaces. Rational: one transversal of the three lines is tested, since
/// edges that cross the quadric were excluded before.
fn holds_conic(space: &PluckerSpace, three: &[Halfspace; 3], others: &[Halfspace]) -> bool {
    let rows: Vec<[IBig; 6]> = three.iter().map(|h| space.big_row(h.row)).collect();
    let skew = |a: &[IBig; 6], b: &[IBig; 6]| {
        let s: IBig = (0..6).map(|k| &a[k] * &b[(k + 3) % 6]).sum();
        s != IBig::ZERO
    };
    let real = |r: &[IBig; 6]| (0..3).map(|k| &r[k] * &r[k + 3]).sum::<IBig>() == IBig::ZERO;
    if !(rows.iter().all(real)
        && skew(&rows[0], &rows[1])
        && skew(&rows[0], &rows[2])
        && skew(&rows[1], &rows[2]))
    {
        return false;
    }
    // At most two transversals of the regulus meet another line, unless it lies on the quadric
    // surface of the three; so one try more than twice the number of rows finds a generic one.
    for step in 0..2 * others.len() as i64 + 2 {
        if let Some(side) = generic_transversal(space, &rows, others, step) {
            return side.is_some();
        }
    }
    // Never reached by the count above; in doubt, lines are taken to be real.
    true
}

/// A transversal of three lines, oriented into some half-spaces: the outer option tells whether
/// it lies on none of them, the inner one whether it lies strictly inside all.
fn generic_transversal(
    space: &PluckerSpace,
    rows: &[[IBig; 6]],
    others: &[Halfspace],
    step: i64,
) -> Option<Option<[IBig; 6]>> {
    let line = transversal(rows, step)?;
    let signs: Vec<Sign> = others
        .iter()
        .map(|h| {
            let row = space.big_row(h.row);
            let s = sign_of(&(0..6).map(|k| &row[k] * &line[k]).sum());
            if h.negative { s.flip() } else { s }
        })
        .collect();
    if signs.iter().any(|s| s.is_zero()) {
        return None;
    }
    if signs.iter().all(|s| s.is_positive()) {
        return Some(Some(line));
    }
    let backwards = signs.iter().all(|s| s.is_negative());
    Some(backwards.then(|| line.map(|c| -c)))
}

/// A point inside a conic of real lines that lies wholly inside a 2-face of a cone: there Q has the
/// sign that it has on no vertex. The sum of two lines of a regulus, which are skew.
pub(crate) fn inside_conic(space: &PluckerSpace, cone: &Cone) -> Option<[IBig; 6]> {
    cone.faces_on_three().iter().find_map(|(three, others)| {
        if !holds_conic(space, three, others) {
            return None;
        }
        let rows: Vec<[IBig; 6]> = three.iter().map(|h| space.big_row(h.row)).collect();
        let mut lines = (0..4 * others.len() as i64 + 4)
            .filter_map(|step| generic_transversal(space, &rows, others, step)?);
        let (a, b) = (lines.next()?, lines.next()?);
        Some(std::array::from_fn(|k| &a[k] + &b[k]))
    })
}

/// The line through an integer point of the first line that meets the other two.
fn transversal(rows: &[[IBig; 6]], step: i64) -> Option<[IBig; 6]> {
    // A row is (m; d). Points of the first line: p0 + t d, p0 = (d x m) / (d . d), homogeneous.
    let moment = |r: &[IBig; 6]| [r[0].clone(), r[1].clone(), r[2].clone()];
    let direction = |r: &[IBig; 6]| [r[3].clone(), r[4].clone(), r[5].clone()];
    let (m, d) = (moment(&rows[0]), direction(&rows[0]));
    let w = dot3(&d, &d);
    if w == IBig::ZERO {
        return None;
    }
    let foot = cross3(&d, &m);
    let t = IBig::from(if step % 2 == 0 {
        step / 2
    } else {
        -(step / 2) - 1
    });
    let p: [IBig; 3] = std::array::from_fn(|k| &foot[k] + &t * &d[k] * &w);
    // The plane of p / w and a line (d; m): normal w m - p x d, offset p . m.
    let plane = |r: &[IBig; 6]| {
        let (m, d) = (moment(r), direction(r));
        let pxd = cross3(&p, &d);
        let n: [IBig; 3] = std::array::from_fn(|k| &w * &m[k] - &pxd[k]);
        (n, dot3(&p, &m))
    };
    let ((n1, c1), (n2, c2)) = (plane(&rows[1]), plane(&rows[2]));
    let dir = cross3(&n1, &n2);
    if dir.iter().all(|c| *c == IBig::ZERO) {
        return None;
    }
    let mom: [IBig; 3] = std::array::from_fn(|k| &n1[k] * &c2 - &n2[k] * &c1);
    let line: [IBig; 6] = std::array::from_fn(|k| {
        if k < 3 {
            dir[k].clone()
        } else {
            mom[k - 3].clone()
        }
    });
    debug_assert!(
        rows.iter()
            .all(|r| (0..6).map(|k| &r[k] * &line[k]).sum::<IBig>() == IBig::ZERO),
        "a transversal meets its three lines"
    );
    Some(line)
}

fn dot3(a: &[IBig; 3], b: &[IBig; 3]) -> IBig {
    (0..3).map(|k| &a[k] * &b[k]).sum()
}

fn cross3(a: &[IBig; 3], b: &[IBig; 3]) -> [IBig; 3] {
    [
        &a[1] * &b[2] - &a[2] * &b[1],
        &a[2] * &b[0] - &a[0] * &b[2],
        &a[0] * &b[1] - &a[1] * &b[0],
    ]
}
