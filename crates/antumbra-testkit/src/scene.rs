//! Plain scenes for the oracles: polygons on the grid with the names of their objects.

use crate::determinant::sign;
use crate::rational::RationalPoint;
use crate::segment::height;

/// A convex planar polygon on the grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Polygon {
    /// The object it belongs to.
    pub object: String,
    /// At least three corners, in order, all in one plane.
    pub corners: Vec<[i64; 3]>,
    /// Whether it blocks lines.
    pub occludes: bool,
}

/// What one looks from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// The relative interior of a polygon, by its index.
    Polygon(usize),
    /// The open interior of a box.
    Cell {
        /// Smallest coordinates.
        min: [i64; 3],
        /// Largest coordinates; larger on every axis.
        max: [i64; 3],
    },
}

/// A source, a target polygon, and the polygons that may block between them.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The whole scene.
    pub polygons: &'a [Polygon],
    /// What one looks from.
    pub source: &'a Source,
    /// The polygon one looks at, by its index.
    pub target: usize,
}

impl<'a> View<'a> {
    /// The corners of the target.
    #[must_use]
    pub fn target_corners(&self) -> &'a [[i64; 3]] {
        &self.polygons[self.target].corners
    }

    /// Whether source and target polygon lie in one plane: they see each other edge-on at best, so
    /// the segments between them are no open set of lines (semantics 17).
    #[must_use]
    pub fn is_flat(&self) -> bool {
        match self.source {
            Source::Polygon(i) => coplanar(
                &self.polygons[*i].corners,
                &self.polygons[self.target].corners,
            ),
            Source::Cell { .. } => false,
        }
    }

    /// The polygons that may block: all occluders but source and target and what lies in the plane
    /// of either (semantics 5 and 6).
    pub fn blockers(&self) -> impl Iterator<Item = &'a [[i64; 3]]> {
        let source = match self.source {
            Source::Polygon(i) => Some(*i),
            Source::Cell { .. } => None,
        };
        let exempt = move |i: usize, other: usize| {
            i == other || coplanar(&self.polygons[i].corners, &self.polygons[other].corners)
        };
        let blocks = move |i: &usize| {
            self.polygons[*i].occludes
                && !exempt(*i, self.target)
                && !source.is_some_and(|source| exempt(*i, source))
        };
        (0..self.polygons.len())
            .filter(blocks)
            .map(|i| self.polygons[i].corners.as_slice())
    }
}

/// Whether all corners of one polygon lie in the plane of another.
#[must_use]
pub fn coplanar(polygon: &[[i64; 3]], other: &[[i64; 3]]) -> bool {
    polygon
        .iter()
        .all(|c| sign(&height(other, &RationalPoint::from_grid(*c))) == 0)
}

/// Whether a polygon meets a box, `open` or closed. Exact.
#[must_use]
pub fn meets_box(polygon: &[[i64; 3]], min: [i64; 3], max: [i64; 3], open: bool) -> bool {
    // Clip by the six half-spaces; what is left decides. For an open box a point strictly inside
    // every half-space is needed: the mean of the clipped polygon's corners is one if there is any.
    let mut rest: Vec<RationalPoint> = polygon
        .iter()
        .map(|c| RationalPoint::from_grid(*c))
        .collect();
    for axis in 0..3 {
        rest = clip(&rest, |p| {
            &p.numerators()[axis] - p.denominator() * min[axis]
        });
        rest = clip(&rest, |p| {
            p.denominator() * max[axis] - &p.numerators()[axis]
        });
    }
    if rest.is_empty() {
        return false;
    }
    let weights = vec![dashu_int::IBig::ONE; rest.len()];
    let mean = RationalPoint::mean(&rest.iter().collect::<Vec<_>>(), &weights);
    !open || inside_box(&mean, min, max)
}

/// Whether a point lies in the open box.
#[must_use]
pub fn inside_box(point: &RationalPoint, min: [i64; 3], max: [i64; 3]) -> bool {
    (0..3).all(|k| {
        let (n, d) = (&point.numerators()[k], point.denominator());
        sign(&(n - d * min[k])) > 0 && sign(&(d * max[k] - n)) > 0
    })
}

/// The part of a convex polygon where a function, linear over the denominator, is not negative.
pub(crate) fn clip(
    polygon: &[RationalPoint],
    value: impl Fn(&RationalPoint) -> dashu_int::IBig,
) -> Vec<RationalPoint> {
    let mut kept = Vec::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let (va, vb) = (value(a), value(b));
        if sign(&va) >= 0 {
            kept.push(a.clone());
        }
        if sign(&va) * sign(&vb) < 0 {
            // Values are scaled by their point's denominator, which is what the weights need.
            let weights = [-&vb * a.denominator(), &va * b.denominator()];
            kept.push(RationalPoint::mean(&[a, b], &weights));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::{Polygon, Source, View, coplanar, meets_box};

    #[test]
    fn boxes_are_met_exactly() {
        let (min, max) = ([0, 0, 0], [4, 4, 4]);
        let floor = [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]];
        assert!(meets_box(&floor, min, max, false) && !meets_box(&floor, min, max, true));
        let cut = floor.map(|[x, y, z]| [x, y, z + 1]);
        assert!(meets_box(&cut, min, max, true));
        // A triangle that passes the corner (4, 4, 4): x + y + z = 12 touches, 13 misses.
        let touch = [[12, 0, 0], [0, 12, 0], [0, 0, 12]];
        assert!(meets_box(&touch, min, max, false) && !meets_box(&touch, min, max, true));
        assert!(!meets_box(
            &[[13, 0, 0], [0, 13, 0], [0, 0, 13]],
            min,
            max,
            false
        ));
        assert!(meets_box(
            &[[11, 0, 0], [0, 11, 0], [0, 0, 11]],
            min,
            max,
            true
        ));
    }

    #[test]
    fn what_lies_in_the_plane_of_an_end_never_blocks() {
        let square = |z: i64, object: &str| Polygon {
            object: object.to_owned(),
            corners: vec![[0, 0, z], [4, 0, z], [4, 4, z], [0, 4, z]],
            occludes: true,
        };
        let polygons = [
            square(0, "a"),
            square(9, "b"),
            square(9, "c"),
            square(0, "d"),
            square(5, "e"),
        ];
        assert!(coplanar(&polygons[1].corners, &polygons[2].corners));
        let view = View {
            polygons: &polygons,
            source: &Source::Polygon(0),
            target: 1,
        };
        assert_eq!(
            view.blockers().collect::<Vec<_>>(),
            [polygons[4].corners.as_slice()]
        );
        let cell = Source::Cell {
            min: [0, 0, -4],
            max: [4, 4, 0],
        };
        let view = View {
            polygons: &polygons,
            source: &cell,
            target: 1,
        };
        assert_eq!(view.blockers().count(), 3);
    }
}
