//! A real line of a cone that is too thin for doubles: by big integers, as close to the quadric
//! as asked.
//!
//! The exact decision about real lines found points where Q has either sign; here they are moved
//! into the interior and the segment between them is bisected. What comes out lies strictly inside
//! the cone and next to a real line. Costs milliseconds; rarely needed.

use antumbra_kernel::Sign;
use dashu_int::IBig;
use dashu_int::ops::BitTest;

use crate::cone::Cone;
use crate::quadric::inside_conic;
use crate::space::{PluckerSpace, VertexId, sign_of};

type Vector = [IBig; 6];

/// A point strictly inside a cone, within about `2^-bits` of the Plücker quadric relative to its
/// size. `weight` gives positive numbers that choose among the interior points. `None` if the cone
/// has no real lines.
pub fn nearly_real(
    space: &mut PluckerSpace,
    cone: &Cone,
    bits: usize,
    mut weight: impl FnMut() -> u32,
) -> Option<Vector> {
    let vertices: Vec<VertexId> = cone.vertices().collect();
    let points: Vec<Vector> = vertices
        .iter()
        .map(|&v| level(space.big_vertex(v)))
        .collect();
    let inner = points.iter().fold(Vector::default(), |sum, p| {
        let w = IBig::from(weight().max(1));
        std::array::from_fn(|k| &sum[k] + &w * &p[k])
    });
    let start = |wanted| {
        anchor(&points, wanted).or_else(|| {
            let p = level(inside_conic(space, cone)?);
            (sign_of(&form(&p, &p)) == wanted).then_some(p)
        })
    };
    let plus = move_inside(start(Sign::Positive)?, &inner, Sign::Positive)?;
    let minus = move_inside(start(Sign::Negative)?, &inner, Sign::Negative)?;
    let (mut a, mut b) = like_sized(plus, minus);
    for _ in 0..bits {
        let middle: Vector = std::array::from_fn(|k| &a[k] + &b[k]);
        if sign_of(&form(&middle, &middle)).is_negative() {
            (a, b) = (a.map(|c| c << 1), middle);
        } else {
            (a, b) = (middle, b.map(|c| c << 1));
        }
    }
    Some(std::array::from_fn(|k| &a[k] + &b[k]))
}

/// Twice the bilinear form's quadric: B(v, w), with B(v, v) = 2 Q(v).
fn form(v: &Vector, w: &Vector) -> IBig {
    (0..6).map(|k| &v[k] * &w[(k + 3) % 6]).sum()
}

/// Scaled by a power of two so that all vectors have like sizes, at least 400 bits.
fn level(v: Vector) -> Vector {
    const SIZE: usize = 400;
    let size = v.iter().map(BitTest::bit_len).max().unwrap_or(0);
    let shift = SIZE.saturating_sub(size);
    v.map(|c| c << shift)
}

/// Two vectors scaled by powers of two to like sizes, so that every halving between them counts.
fn like_sized(a: Vector, b: Vector) -> (Vector, Vector) {
    let size = |v: &Vector| v.iter().map(BitTest::bit_len).max().unwrap_or(0);
    let (s, t) = (size(&a), size(&b));
    let raise = |v: Vector, by: usize| v.map(|c| c << by);
    (raise(a, t.saturating_sub(s)), raise(b, s.saturating_sub(t)))
}

/// A point of the closed cone where Q has a sign: a vertex, or a point between two; of all these
/// the one where Q is largest for its size, since it can be moved farthest.
fn anchor(points: &[Vector], wanted: Sign) -> Option<Vector> {
    let own: Vec<IBig> = points.iter().map(|p| form(p, p)).collect();
    let mut best: Option<(isize, Vector)> = None;
    let mut offer = |p: Vector| {
        let q = form(&p, &p);
        if sign_of(&q) == wanted {
            let bits = |part: &[IBig]| part.iter().map(BitTest::bit_len).max().unwrap_or(0);
            let merit = q.bit_len() as isize - (bits(&p[..3]) + bits(&p[3..])) as isize;
            if best.as_ref().is_none_or(|b| merit > b.0) {
                best = Some((merit, p));
            }
        }
    };
    for i in 0..points.len() {
        if sign_of(&own[i]) == wanted {
            offer(points[i].clone());
        }
        for j in 0..points.len() {
            if i == j || sign_of(&own[i]) == wanted || sign_of(&own[j]) == wanted {
                continue;
            }
            let b = form(&points[i], &points[j]);
            if sign_of(&b) != wanted {
                continue;
            }
            // form(x v_i + y v_j) = x^2 o_i + 2 x y b + y^2 o_j, best at x : y = |o_j| : |b|
            // where o_j is not zero; where both are, in the middle; else y outweighs what o_i
            // takes away.
            let size = |v: &IBig| if *v < IBig::ZERO { -v } else { v.clone() };
            let (x, y) = match (own[i] == IBig::ZERO, own[j] == IBig::ZERO) {
                (true, true) => (IBig::ONE, IBig::ONE),
                (false, true) => (size(&b), size(&own[i])),
                (_, false) => (size(&own[j]), size(&b)),
            };
            offer(std::array::from_fn(|k| {
                &x * &points[i][k] + &y * &points[j][k]
            }));
        }
    }
    best.map(|b| b.1)
}

/// A point strictly inside, towards `inner`, where Q still has the sign.
fn move_inside(p: Vector, inner: &Vector, wanted: Sign) -> Option<Vector> {
    let size = |v: &Vector| v.iter().map(BitTest::bit_len).max().unwrap_or(0);
    let gap = size(inner).saturating_sub(size(&p));
    let p = p.map(|c| c << gap);
    let raise = size(&p).saturating_sub(size(inner));
    let inner: Vector = std::array::from_fn(|k| inner[k].clone() << raise);
    (0..1200_usize).step_by(6).find_map(|shift| {
        let moved: Vector = std::array::from_fn(|k| (p[k].clone() << shift) + &inner[k]);
        (sign_of(&form(&moved, &moved)) == wanted).then_some(moved)
    })
}
