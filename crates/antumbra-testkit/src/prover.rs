//! Looks for a proof that a target is hidden: bisection until one screen stops every vertex pair.
//!
//! From first principles. Let S and T be convex, weakly on opposite sides of the plane of a convex
//! polygon O, neither of them in it. A segment from p in S to q in T meets the plane in the mean of p
//! and q weighted by the distances of q and p. So its point is a mean of the points of the segments
//! between vertices, and if those all lie in O, all segments from S to T are stopped by O.
//!
//! That it finds no proof proves nothing: thin places may need more than bisection.

use dashu_int::IBig;

use crate::determinant::sign;
use crate::plane::{covers, hull};
use crate::rational::RationalPoint;
use crate::scene::{Source, View, coplanar, meets_box};
use crate::segment::{Contact, contact, height};

/// The size of a proof that was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Proof {
    /// Pairs of pieces that one screen separates.
    pub leaves: usize,
    /// Bisections on the longest path.
    pub depth: usize,
}

/// Searches for a proof that no segment from source to target is free, with at most `budget`
/// pairs of pieces.
#[must_use]
pub fn prove(view: &View<'_>, budget: usize) -> Option<Proof> {
    if view.is_flat() {
        return Some(Proof::default());
    }
    let screens = screens(view);
    let mut left = budget;
    let mut proof = Proof::default();
    let mut last = 0;
    let mut stack: Vec<(Piece, Piece, usize)> = Vec::new();
    for s in source_pieces(view) {
        for t in fan(view.target_corners()) {
            stack.push((s.clone(), t, 0));
        }
    }
    while let Some((s, t, depth)) = stack.pop() {
        left = left.checked_sub(1)?;
        proof.depth = proof.depth.max(depth);
        // The screen that served last is the likeliest to serve again.
        let mut order = (last..screens.len()).chain(0..last);
        if let Some(stopped) = order.find(|i| stops(&screens[*i], &s, &t)) {
            last = stopped;
            proof.leaves += 1;
            continue;
        }
        let halves = if s.size() >= t.size() {
            let [a, b] = s.bisect();
            [(a, t.clone()), (b, t)]
        } else {
            let [a, b] = t.bisect();
            [(s.clone(), a), (s, b)]
        };
        stack.extend(halves.map(|(s, t)| (s, t, depth + 1)));
    }
    Some(proof)
}

/// Every blocker, and the hull of coplanar blockers where they cover it without a gap.
fn screens(view: &View<'_>) -> Vec<Vec<[i64; 3]>> {
    let outside = |p: &&[[i64; 3]]| match view.source {
        Source::Polygon(_) => true,
        // What blocks only outside of the cell is not convex; leave it to the reader.
        Source::Cell { min, max } => !meets_box(p, *min, *max, true),
    };
    let blockers: Vec<&[[i64; 3]]> = view.blockers().filter(outside).collect();
    let mut screens: Vec<Vec<[i64; 3]>> = Vec::new();
    let mut grouped = vec![false; blockers.len()];
    for i in 0..blockers.len() {
        if grouped[i] {
            continue;
        }
        let mut group: Vec<&[[i64; 3]]> = Vec::new();
        for j in i..blockers.len() {
            if coplanar(blockers[j], blockers[i]) {
                grouped[j] = true;
                group.push(blockers[j]);
            }
        }
        let all: Vec<[i64; 3]> = group.iter().flat_map(|p| p.iter().copied()).collect();
        if let Some(union) = hull(&all).filter(|h| group.len() > 1 && covers(&group, h)) {
            screens.push(union);
        }
    }
    screens.extend(blockers.iter().map(|p| p.to_vec()));
    screens
}

/// Whether a screen stops every segment between two pieces.
fn stops(screen: &[[i64; 3]], s: &Piece, t: &Piece) -> bool {
    let sides = |piece: &Piece| -> Vec<i8> {
        piece
            .vertices
            .iter()
            .map(|v| sign(&height(screen, v)))
            .collect()
    };
    let (hs, ht) = (sides(s), sides(t));
    let apart = [1_i8, -1].iter().any(|side| {
        hs.iter().all(|h| h * side >= 0)
            && ht.iter().all(|h| h * side <= 0)
            && hs.iter().any(|h| *h != 0)
            && ht.iter().any(|h| *h != 0)
    });
    apart
        && s.vertices.iter().zip(&hs).all(|(p, hp)| {
            t.vertices.iter().zip(&ht).all(|(q, hq)| {
                // Two vertices in the plane carry no weight.
                (*hp == 0 && *hq == 0) || contact(p, q, screen) != Contact::Miss
            })
        })
}

/// A convex piece of source or target: a triangle, or the eight corners of a box.
#[derive(Clone, Debug)]
struct Piece {
    vertices: Vec<RationalPoint>,
}

fn source_pieces(view: &View<'_>) -> Vec<Piece> {
    match view.source {
        Source::Polygon(i) => fan(&view.polygons[*i].corners),
        Source::Cell { min, max } => {
            // Bit k of the index chooses the upper end of axis k.
            let corner =
                |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { max[k] } else { min[k] });
            vec![Piece {
                vertices: (0..8)
                    .map(|i| RationalPoint::from_grid(corner(i)))
                    .collect(),
            }]
        }
    }
}

fn fan(polygon: &[[i64; 3]]) -> Vec<Piece> {
    let triangle = |pair: &[[i64; 3]]| Piece {
        vertices: [polygon[0], pair[0], pair[1]]
            .map(RationalPoint::from_grid)
            .to_vec(),
    };
    let flat = |p: &Piece| {
        let [a, b, c] = [0, 1, 2].map(|i| p.vertices[i].numerators().clone());
        let u: [IBig; 3] = std::array::from_fn(|k| &b[k] - &a[k]);
        let v: [IBig; 3] = std::array::from_fn(|k| &c[k] - &a[k]);
        (0..3).all(|k| &u[(k + 1) % 3] * &v[(k + 2) % 3] == &u[(k + 2) % 3] * &v[(k + 1) % 3])
    };
    polygon[1..]
        .windows(2)
        .map(triangle)
        .filter(|p| !flat(p))
        .collect()
}

impl Piece {
    /// The length of its longest edge; a float, since it only steers the search.
    fn size(&self) -> f64 {
        let (i, j) = self.longest();
        length(&self.vertices[i], &self.vertices[j])
    }

    fn longest(&self) -> (usize, usize) {
        let edges: &[(usize, usize)] = if self.vertices.len() == 3 {
            &[(0, 1), (1, 2), (2, 0)]
        } else {
            &[(0, 1), (0, 2), (0, 4)]
        };
        let long = |&(i, j): &(usize, usize)| length(&self.vertices[i], &self.vertices[j]);
        let better = |a: &&(usize, usize), b: &&(usize, usize)| long(a).total_cmp(&long(b));
        *edges.iter().max_by(better).unwrap_or(&(0, 1))
    }

    fn bisect(&self) -> [Self; 2] {
        let (i, j) = self.longest();
        let (mut first, mut second) = (self.clone(), self.clone());
        if self.vertices.len() == 3 {
            let middle = self.vertices[i].midpoint(&self.vertices[j]);
            first.vertices[j] = middle.clone();
            second.vertices[i] = middle;
        } else {
            for low in (0..8).filter(|v| v & j == 0) {
                let middle = self.vertices[low].midpoint(&self.vertices[low | j]);
                first.vertices[low | j] = middle.clone();
                second.vertices[low] = middle;
            }
        }
        [first, second]
    }
}

fn length(a: &RationalPoint, b: &RationalPoint) -> f64 {
    let (a, b) = (a.to_f64(), b.to_f64());
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::prove;
    use crate::scene::{Polygon, Source, View};

    fn square(x: [i64; 2], y: [i64; 2], z: i64) -> Polygon {
        let corners = vec![
            [x[0], y[0], z],
            [x[1], y[0], z],
            [x[1], y[1], z],
            [x[0], y[1], z],
        ];
        Polygon {
            object: String::new(),
            corners,
            occludes: true,
        }
    }

    fn provable(between: Vec<Polygon>) -> bool {
        let mut polygons = vec![square([0, 8], [0, 8], 0), square([0, 8], [0, 8], 16)];
        polygons.extend(between);
        let view = View {
            polygons: &polygons,
            source: &Source::Polygon(0),
            target: 1,
        };
        prove(&view, 3000).is_some()
    }

    #[test]
    fn one_snug_screen_is_enough_and_one_unit_less_is_not() {
        assert!(provable(vec![square([0, 8], [0, 8], 8)]));
        assert!(!provable(vec![square([1, 8], [0, 8], 8)]));
        assert!(!provable(Vec::new()));
    }

    #[test]
    fn coplanar_screens_join_and_staggered_ones_are_bisected() {
        assert!(provable(vec![
            square([0, 4], [0, 8], 8),
            square([4, 8], [0, 8], 8)
        ]));
        assert!(!provable(vec![
            square([0, 4], [0, 8], 8),
            square([5, 8], [0, 8], 8)
        ]));
        // At different heights, overlapping by more than the lines can lean.
        assert!(provable(vec![
            square([0, 6], [0, 8], 7),
            square([2, 8], [0, 8], 8)
        ]));
    }

    #[test]
    fn a_floor_hides_what_is_below_from_a_cell_that_stands_on_it() {
        let polygons = [square([-9, 9], [-9, 9], 0), square([-2, 2], [-2, 2], -4)];
        let source = Source::Cell {
            min: [-4, -4, 0],
            max: [4, 4, 4],
        };
        let view = View {
            polygons: &polygons,
            source: &source,
            target: 1,
        };
        assert!(prove(&view, 10).is_some());
    }
}
