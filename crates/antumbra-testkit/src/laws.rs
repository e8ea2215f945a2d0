//! Laws that hold for every scene, as changes of a corpus case that must keep its answers.
//!
//! | law | change | answers |
//! |---|---|---|
//! | motion | one of the 48 symmetries of the grid | all the same |
//! | order | polygons in another order, corners turned or reversed | all the same |
//! | symmetry | source and target of a pair exchanged | all the same |
//! | subdivision | an occluder cut along a diagonal | all the same |
//! | monotony | an occluder added | *hidden* stays *hidden* |

use crate::corpus::{Case, Expect, From};
use crate::random::Random;
use crate::rational::RationalPoint;
use crate::scene::Polygon;

/// A symmetry of the grid: a permutation of the axes and a sign for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridMotion {
    /// Output axis `k` is input axis `axes[k]` ...
    axes: [usize; 3],
    /// ... times `signs[k]`.
    signs: [i64; 3],
}

impl GridMotion {
    /// The motion that moves nothing.
    pub const IDENTITY: Self = Self {
        axes: [0, 1, 2],
        signs: [1; 3],
    };

    /// All 48 motions: 24 turns, and 24 that also mirror. The identity comes first.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let orders = [
            [0, 1, 2],
            [1, 2, 0],
            [2, 0, 1],
            [0, 2, 1],
            [2, 1, 0],
            [1, 0, 2],
        ];
        let signs =
            (0..8).map(|bits| std::array::from_fn(|k| if bits >> k & 1 == 1 { -1 } else { 1 }));
        let signs: Vec<[i64; 3]> = signs.collect();
        let with = |axes| signs.iter().map(move |s| Self { axes, signs: *s });
        orders.into_iter().flat_map(with).collect()
    }

    /// Where a grid point goes.
    #[must_use]
    pub fn apply(&self, point: [i64; 3]) -> [i64; 3] {
        std::array::from_fn(|k| self.signs[k] * point[self.axes[k]])
    }

    /// Whether it is a mirror motion (its determinant is -1).
    #[must_use]
    pub fn mirrors(&self) -> bool {
        let odd = [[0, 2, 1], [2, 1, 0], [1, 0, 2]].contains(&self.axes);
        odd != (self.signs.iter().product::<i64>() < 0)
    }

    /// The motion that does `self` first and `next` then.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            axes: next.axes.map(|axis| self.axes[axis]),
            signs: std::array::from_fn(|k| next.signs[k] * self.signs[next.axes[k]]),
        }
    }

    fn apply_rational(&self, point: &RationalPoint) -> RationalPoint {
        let n = point.numerators();
        let numerators = std::array::from_fn(|k| &n[self.axes[k]] * self.signs[k]);
        RationalPoint::new(numerators, point.denominator().clone())
    }

    /// A whole case, moved.
    #[must_use]
    pub fn apply_case(&self, case: &Case) -> Case {
        let mut moved = case.clone();
        for corner in moved.polygons.iter_mut().flat_map(|p| p.corners.iter_mut()) {
            *corner = self.apply(*corner);
        }
        for query in &mut moved.queries {
            if let From::Cell { min, max } = &mut query.from {
                let (a, b) = (self.apply(*min), self.apply(*max));
                *min = std::array::from_fn(|k| a[k].min(b[k]));
                *max = std::array::from_fn(|k| a[k].max(b[k]));
            }
            if let Some(segment) = &mut query.witness {
                *segment = [0, 1].map(|i| self.apply_rational(&segment[i]));
            }
        }
        moved
    }
}

/// The same scene with its polygons in random order, the corners of each turned and, half of the
/// time, reversed. Ids of objects change with the order; names do not.
#[must_use]
pub fn reordered(case: &Case, random: &mut Random) -> Case {
    let mut other = case.clone();
    random.shuffle(&mut other.polygons);
    for polygon in &mut other.polygons {
        let turn = random.index(polygon.corners.len());
        polygon.corners.rotate_left(turn);
        if random.index(2) == 0 {
            polygon.corners.reverse();
        }
    }
    other
}

/// The same scene with source and target of every pair exchanged; queries from cells are dropped.
#[must_use]
pub fn reversed(case: &Case) -> Case {
    let mut other = case.clone();
    other.queries.retain(|q| matches!(q.from, From::Object(_)));
    for query in &mut other.queries {
        if let From::Object(from) = &mut query.from {
            std::mem::swap(from, &mut query.to);
        }
        if let Some(segment) = &mut query.witness {
            segment.reverse();
        }
    }
    other
}

/// The same scene with every polygon cut into triangles along diagonals from its first corner.
#[must_use]
pub fn subdivided(case: &Case) -> Case {
    let mut other = case.clone();
    let area = |c: &[[i64; 3]]| {
        crate::segment::normal(c)
            .iter()
            .any(|c| *c != dashu_int::IBig::ZERO)
    };
    let cut = |p: &Polygon| -> Vec<Polygon> {
        let fan = p.corners[1..]
            .windows(2)
            .map(|pair| vec![p.corners[0], pair[0], pair[1]]);
        fan.filter(|c| area(c))
            .map(|corners| Polygon {
                corners,
                ..p.clone()
            })
            .collect()
    };
    other.polygons = case.polygons.iter().flat_map(cut).collect();
    // A witness may end on the new diagonal, which is no interior point.
    other.queries.iter_mut().for_each(|q| q.witness = None);
    other
}

/// The same scene with one more occluder; only the queries that must stay hidden are kept.
#[must_use]
pub fn with_occluder(case: &Case, corners: Vec<[i64; 3]>) -> Case {
    let mut other = case.clone();
    other.queries.retain(|q| q.expect == Expect::Hidden);
    other.polygons.push(Polygon {
        object: "added".to_owned(),
        corners,
        occludes: true,
    });
    other
}

#[cfg(test)]
mod tests {
    use super::GridMotion;

    #[test]
    fn the_motions_are_the_group_of_the_cube() {
        let all = GridMotion::all();
        let distinct = |m: &GridMotion| all.iter().filter(|o| *o == m).count() == 1;
        assert!(all.len() == 48 && all.iter().all(distinct));
        assert_eq!(all[0], GridMotion::IDENTITY);
        assert_eq!(all.iter().filter(|m| m.mirrors()).count(), 24);
        for a in &all {
            for b in &all {
                let both = a.then(b);
                assert_eq!(both.apply([1, 2, 3]), b.apply(a.apply([1, 2, 3])));
                assert_eq!(both.mirrors(), a.mirrors() != b.mirrors());
            }
            assert!(all.iter().any(|b| a.then(b) == GridMotion::IDENTITY));
        }
    }

    #[test]
    fn mirroring_is_the_sign_of_a_volume() {
        for m in GridMotion::all() {
            let [x, y, z] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|p| m.apply(p));
            let volume = crate::determinant::orient3d([0; 3], x, y, z);
            assert_eq!(crate::determinant::sign(&volume) < 0, m.mirrors());
        }
    }
}
