//! Convex hulls, and simple polygons cut into convex parts: ears, merged where they stay convex.

use antumbra_kernel::{Point2, Rect, orient2d};

/// The corners of the convex hull, counter-clockwise, without collinear ones.
pub(super) fn hull(points: &[Point2]) -> Vec<Point2> {
    let mut sorted = points.to_vec();
    sorted.sort_unstable();
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let half = |points: &mut dyn Iterator<Item = Point2>| {
        let mut chain: Vec<Point2> = Vec::new();
        for p in points {
            while chain.len() > 1
                && orient2d(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut sorted.iter().copied());
    lower.extend(half(&mut sorted.iter().rev().copied()));
    lower
}

/// Two edges of a closed outline that share a point and should not. Quadratic.
pub(super) fn self_contact(ring: &[Point2]) -> Option<(usize, usize)> {
    let n = ring.len();
    let edge = |i: usize| [ring[i], ring[(i + 1) % n]];
    for i in 0..n {
        for j in i + 1..n {
            let (e, f) = (edge(i), edge(j));
            let contact = if j == i + 1 {
                // Neighbors share a corner; they must not run back over each other.
                folds(e[0], e[1], f[1])
            } else if i == 0 && j == n - 1 {
                folds(f[0], f[1], e[1])
            } else {
                meet(e, f)
            };
            if contact {
                return Some((i, j));
            }
        }
    }
    None
}

/// Whether the way from a over b to c turns straight back.
fn folds(a: Point2, b: Point2, c: Point2) -> bool {
    let toward = |p: Point2, q: Point2| (i64::from(q.x - p.x), i64::from(q.y - p.y));
    let (u, v) = (toward(a, b), toward(b, c));
    orient2d(a, b, c) == 0 && u.0 * v.0 + u.1 * v.1 < 0
}

fn meet(e: [Point2; 2], f: [Point2; 2]) -> bool {
    let apart = |[a, b]: [Point2; 2], [c, d]: [Point2; 2]| {
        let (s, t) = (orient2d(a, b, c).signum(), orient2d(a, b, d).signum());
        s * t > 0
    };
    let boxes = Rect::around(e).zip(Rect::around(f));
    boxes.is_some_and(|(a, b)| a.touches(&b)) && !apart(e, f) && !apart(f, e)
}

/// Cuts a simple polygon into convex parts, counter-clockwise, strictly convex.
pub(super) fn convex_parts(ring: &[Point2]) -> Vec<Vec<Point2>> {
    let mut ring = ring.to_vec();
    let origin = ring[0];
    let area: i128 = ring
        .windows(2)
        .map(|w| i128::from(orient2d(origin, w[0], w[1])))
        .sum();
    if area < 0 {
        ring.reverse();
    }
    let mut parts: Vec<Vec<Point2>> = Vec::new();
    for ear in ears(ring) {
        // An ear shares an edge with parts cut before and after; one convex union is enough.
        let joined = parts.iter_mut().rev().take(8).any(|part| join(part, ear));
        if !joined {
            parts.push(ear.to_vec());
        }
    }
    parts.iter().map(|part| hull(part)).collect()
}

fn ears(mut ring: Vec<Point2>) -> Vec<[Point2; 3]> {
    let mut out = Vec::with_capacity(ring.len());
    while ring.len() >= 3 {
        let n = ring.len();
        let corner = |i: usize| [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]];
        let Some(i) = (0..n).find(|&i| is_ear(&ring, corner(i))) else {
            // A simple polygon always has an ear or a flat corner.
            break;
        };
        let [a, b, c] = corner(i);
        if orient2d(a, b, c) > 0 {
            out.push([a, b, c]);
        }
        ring.remove(i);
    }
    out
}

fn is_ear(ring: &[Point2], [a, b, c]: [Point2; 3]) -> bool {
    let turn = orient2d(a, b, c);
    if turn == 0 {
        return true;
    }
    let inside =
        |p: Point2| orient2d(a, b, p) >= 0 && orient2d(b, c, p) >= 0 && orient2d(c, a, p) >= 0;
    turn > 0 && ring.iter().all(|&p| [a, b, c].contains(&p) || !inside(p))
}

/// Adds a triangle to a convex part if they share an edge and their union is convex.
fn join(part: &mut Vec<Point2>, ear: [Point2; 3]) -> bool {
    let n = part.len();
    for i in 0..n {
        for k in 0..3 {
            let shared = part[i] == ear[(k + 1) % 3] && part[(i + 1) % n] == ear[k];
            if !shared {
                continue;
            }
            let tip = ear[(k + 2) % 3];
            let mut union = part.clone();
            union.insert(i + 1, tip);
            let m = union.len();
            let convex =
                (0..m).all(|j| orient2d(union[j], union[(j + 1) % m], union[(j + 2) % m]) >= 0);
            if convex {
                *part = union;
                return true;
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::{convex_parts, hull, self_contact};
    use antumbra_kernel::{Point2, orient2d};

    fn ring(points: &[(i32, i32)]) -> Vec<Point2> {
        points.iter().map(|&(x, y)| Point2::new(x, y)).collect()
    }

    fn area(ring: &[Point2]) -> i64 {
        (1..ring.len() - 1)
            .map(|i| orient2d(ring[0], ring[i], ring[i + 1]))
            .sum()
    }

    #[test]
    fn parts_are_convex_and_fill_the_polygon() {
        let l = ring(&[(0, 0), (8, 0), (8, 3), (3, 3), (3, 9), (0, 9)]);
        let comb = ring(&[
            (0, 0),
            (9, 0),
            (9, 5),
            (8, 5),
            (8, 1),
            (6, 1),
            (6, 7),
            (4, 1),
            (2, 1),
            (1, 5),
            (0, 5),
        ]);
        for outline in [l.clone(), comb.clone(), comb.into_iter().rev().collect()] {
            assert_eq!(self_contact(&outline), None);
            let parts = convex_parts(&outline);
            assert!(
                parts
                    .iter()
                    .all(|p| hull(p).len() == p.len() && area(p) > 0)
            );
            let sum: i64 = parts.iter().map(|p| area(p)).sum();
            assert_eq!(sum, area(&outline).abs());
            assert!(parts.len() < outline.len() - 2);
        }
        assert_eq!(convex_parts(&l).len(), 2);
    }

    #[test]
    fn outlines_that_meet_themselves_are_found() {
        let bow = ring(&[(0, 0), (4, 4), (4, 0), (0, 4)]);
        assert_eq!(self_contact(&bow), Some((0, 2)));
        let spike = ring(&[(0, 0), (4, 0), (6, 0), (4, 0), (4, 4)]);
        assert!(self_contact(&spike).is_some());
    }
}
