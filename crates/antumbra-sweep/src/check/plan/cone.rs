//! Lines and convex sets of lines of the plane in big integers.
//!
//! A line is `a x + b y + c`, a point a homogeneous triple, and their product is positive if the point is on the
//! line's left. A set of lines is bounded by points that all its lines have on one side; its extreme lines run
//! through two successive ones.

use antumbra_kernel::Point2;
use dashu_int::IBig;

type Triple = [IBig; 3];

/// On which side of a line a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    On,
    Right,
}

fn sign(v: &IBig) -> i8 {
    i8::from(*v > IBig::ZERO) - i8::from(*v < IBig::ZERO)
}

fn dot(a: &Triple, b: &Triple) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &Triple, b: &Triple) -> Triple {
    let m = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [m(1, 2), m(2, 0), m(0, 1)]
}

fn point(p: Point2) -> Triple {
    [IBig::from(p.x), IBig::from(p.y), IBig::ONE]
}

/// Where the lines of two segments cross.
pub(super) fn crossing([a, b]: [Point2; 2], [p, q]: [Point2; 2]) -> Triple {
    cross(&cross(&point(a), &point(b)), &cross(&point(p), &point(q)))
}

/// The value of a line at a point.
pub(super) fn at(line: &Triple, p: Point2) -> IBig {
    &line[0] * p.x + &line[1] * p.y + &line[2]
}

/// A place along a line: a fraction with a positive denominator.
pub(super) struct Place(IBig, IBig);

impl Place {
    pub(super) fn before(&self, other: &Self) -> bool {
        &self.0 * &other.1 < &other.0 * &self.1
    }
}

/// One line.
pub(super) struct Line<'l> {
    big: &'l Triple,
    small: Option<[i128; 3]>,
}

impl<'l> Line<'l> {
    pub(super) fn new(big: &'l Triple) -> Self {
        let parts: Vec<i128> = big.iter().filter_map(|c| i128::try_from(c).ok()).collect();
        let small = <[i128; 3]>::try_from(parts).ok();
        Self {
            big,
            // With coordinates below 2^23 nothing overflows.
            small: small.filter(|l| l.iter().all(|c| c.unsigned_abs() < 1 << 100)),
        }
    }

    pub(super) fn side(&self, p: Point2) -> Side {
        let s = match &self.small {
            Some(l) => (l[0] * i128::from(p.x) + l[1] * i128::from(p.y) + l[2]).signum() as i8,
            None => sign(&at(self.big, p)),
        };
        match s {
            1 => Side::Left,
            0 => Side::On,
            _ => Side::Right,
        }
    }

    /// Whether the line meets the hull of some points.
    pub(super) fn crosses(&self, points: &[Point2]) -> bool {
        let first = self.side(points[0]);
        first == Side::On || points.iter().any(|&p| self.side(p) != first)
    }

    /// How far along its direction (b, -a) a point of the line lies.
    fn along(&self, p: Point2) -> IBig {
        &self.big[1] * p.x - &self.big[0] * p.y
    }

    /// Where it crosses a segment that it does not run along.
    pub(super) fn place(&self, [c, d]: [Point2; 2]) -> Place {
        let (u, v) = (at(self.big, c), at(self.big, d));
        let w = &v - &u;
        let n = v * self.along(c) - u * self.along(d);
        if w < IBig::ZERO {
            Place(-n, -w)
        } else {
            Place(n, w)
        }
    }

    /// Whether it shares a point with a segment from one place to another, ends included.
    pub(super) fn meets_between(&self, piece: [Point2; 2], from: &Place, to: &Place) -> bool {
        let [c, d] = piece;
        let (s, t) = (self.side(c), self.side(d));
        if s == t && s != Side::On {
            return false;
        }
        if s == Side::On && t == Side::On {
            let (c, d) = (
                Place(self.along(c), IBig::ONE),
                Place(self.along(d), IBig::ONE),
            );
            let (near, far) = if c.before(&d) { (c, d) } else { (d, c) };
            return !far.before(from) && !to.before(&near);
        }
        let at = self.place(piece);
        !at.before(from) && !to.before(&at)
    }
}

/// Lines that have each of some points on a given side: a pointed cone with an interior.
#[derive(Clone)]
pub(super) struct Cone {
    /// Points turned so that inside is positive, in turning order.
    facets: Vec<Triple>,
}

fn negated(t: &Triple) -> Triple {
    [-&t[0], -&t[1], -&t[2]]
}

impl Cone {
    /// The lines that leave through a window and pass between the ends of a segment that does not meet it, in both
    /// directions; each with the ends on their left and on their right.
    pub(super) fn between([a, b]: [Point2; 2], [p, q]: [Point2; 2]) -> Vec<(Self, Point2, Point2)> {
        use antumbra_kernel::orient2d;
        let outside = |x: Point2| orient2d(a, b, x) < 0;
        let (c, d) = if outside(p) { (p, q) } else { (q, p) };
        if !outside(c) {
            return Vec::new();
        }
        let b_end = b;
        let (na, b) = (negated(&point(a)), point(b));
        let (pc, pd) = (point(c), point(d));
        // det(-a, b, c) is positive for a point c outside.
        let with_left = Self {
            facets: vec![na.clone(), b.clone(), pc.clone()],
        };
        let with_right = Self {
            facets: vec![b, na, negated(&pc)],
        };
        let mut out = Vec::new();
        if !outside(d) {
            // The segment passes beside the window, which the lines have between it and the outer end: only those with
            // the outer end on the other side meet it beyond.
            let source_left = orient2d(c, d, a).max(orient2d(c, d, b_end)) > 0;
            return if source_left {
                vec![(with_right, d, c)]
            } else {
                vec![(with_left, c, d)]
            };
        }
        let [right, _] = with_left.cut(&pd);
        out.extend(right.map(|cone| (cone, c, d)));
        let [_, left] = with_right.cut(&pd);
        out.extend(left.map(|cone| (cone, d, c)));
        out
    }

    fn ray(&self, i: usize) -> Triple {
        let n = self.facets.len();
        cross(&self.facets[(i + n - 1) % n], &self.facets[i])
    }

    fn rays(&self) -> impl Iterator<Item = Triple> + '_ {
        (0..self.facets.len()).map(|i| self.ray(i))
    }

    /// The parts with the point on the right of the lines, and on their left, if they have an interior.
    pub(super) fn cut(self, p: &Triple) -> [Option<Self>; 2] {
        let n = self.facets.len();
        let signs: Vec<i8> = self.rays().map(|r| sign(&dot(p, &r))).collect();
        let (left, right) = (signs.contains(&1), signs.contains(&-1));
        match (right, left) {
            (true, false) => return [Some(self), None],
            (false, _) => return [None, Some(self)],
            _ => {}
        }
        let part = |keep: i8| {
            let row = if keep > 0 { p.clone() } else { negated(p) };
            let mut facets = Vec::with_capacity(n + 1);
            for i in 0..n {
                let (here, next) = (signs[i], signs[(i + 1) % n]);
                // Facet i runs from ray i to ray i + 1.
                if here == keep || next == keep {
                    facets.push(self.facets[i].clone());
                }
                // Where the part ends, the cut goes on.
                if here == keep && next != keep {
                    facets.push(row.clone());
                }
            }
            Self { facets }
        };
        [Some(part(-1)), Some(part(1))]
    }

    /// Whether all lines meet an occluder after a window and not behind a target.
    pub(super) fn blocked_by(
        &self,
        [c, d]: [Point2; 2],
        [a, b]: [Point2; 2],
        target: &[Point2],
    ) -> bool {
        let rays: Vec<Triple> = self.rays().collect();
        let passes = |left: Point2, right: Point2| {
            rays.iter()
                .all(|r| at(r, left) >= IBig::ZERO && at(r, right) <= IBig::ZERO)
        };
        let (left, right) = if passes(c, d) {
            (c, d)
        } else if passes(d, c) {
            (d, c)
        } else {
            return false;
        };
        let line = |p: Point2, q: Point2| cross(&point(p), &point(q));
        let (own, edge) = (line(left, right), line(a, b));
        // Where a line meets the occluder's line, with a positive weight.
        let hits: Vec<Triple> = rays
            .iter()
            .map(|r| cross(r, &own))
            .filter(|x| x.iter().any(|c| *c != IBig::ZERO))
            .collect();
        let weights: Vec<i8> = hits.iter().map(|x| sign(&x[2])).collect();
        if weights.contains(&1) && weights.contains(&-1) {
            return false;
        }
        let turn = if weights.contains(&-1) { -1 } else { 1 };
        let side = |l: &Triple, x: &Triple| sign(&dot(l, x)) * turn;
        // Outside is on the right of the way from a to b.
        if hits.iter().any(|x| side(&edge, x) > 0) {
            return false;
        }
        // The far side of a segment is on the left of the way from its left to its right end.
        let depth = |p: &Point2| antumbra_kernel::orient2d(left, right, *p);
        let &[p, q] = target else {
            // Strictly: the occluder itself may be in the box.
            return target.iter().all(|p| depth(p) > 0);
        };
        if depth(&p) >= 0 && depth(&q) >= 0 {
            return true;
        }
        let crosses = |left: Point2, right: Point2| {
            rays.iter()
                .all(|r| at(r, left) >= IBig::ZERO && at(r, right) <= IBig::ZERO)
        };
        let (l, r) = if crosses(p, q) { (p, q) } else { (q, p) };
        let far = line(l, r);
        hits.iter().all(|x| side(&far, x) <= 0)
    }

    /// From where to where the lines meet a segment that they all cross; `None` if they do not tell.
    pub(super) fn span_on(&self, [p, q]: [Point2; 2]) -> Option<[(IBig, IBig); 2]> {
        let mut out: Option<[(IBig, IBig); 2]> = None;
        let less = |a: &(IBig, IBig), b: &(IBig, IBig)| &a.0 * &b.1 < &b.0 * &a.1;
        for r in self.rays() {
            let (u, v) = (at(&r, p), at(&r, q));
            let d = &u - &v;
            if d == IBig::ZERO {
                continue;
            }
            let t = if d < IBig::ZERO { (-u, -d) } else { (u, d) };
            match &mut out {
                None => out = Some([t.clone(), t]),
                Some([low, high]) => {
                    if less(&t, low) {
                        *low = t;
                    } else if less(high, &t) {
                        *high = t;
                    }
                }
            }
        }
        out
    }
}
