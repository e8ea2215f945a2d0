//! Looks for a free segment between a source and a target: random first, then close past the edges
//! of occluders. What it finds is exact; that it finds nothing proves nothing.

use dashu_int::IBig;

use crate::determinant::sign;
use crate::random::Random;
use crate::rational::RationalPoint;
use crate::scene::{Source, View, inside_box};
use crate::segment::{Contact, contact, height, strictly_inside};

/// A segment from source to target.
pub type Segment = [RationalPoint; 2];

/// Why a segment is no witness.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It does not start in the interior of the source.
    Start,
    /// It does not end in the relative interior of the target.
    End,
    /// Source and target polygon lie in one plane, and so does every segment between them.
    InOnePlane,
    /// It meets an occluder, named by its corners.
    Blocked(Vec<[i64; 3]>),
}

/// Whether a segment proves the target visible: it runs from the interior of the source to the
/// interior of the target and meets no blocker. Then a whole neighborhood of it is free.
///
/// # Errors
/// What is wrong with it.
pub fn check(view: &View<'_>, segment: &Segment) -> Result<(), Refusal> {
    let [from, to] = segment;
    if view.is_flat() {
        return Err(Refusal::InOnePlane);
    }
    let starts = match view.source {
        Source::Polygon(i) => within(from, &view.polygons[*i].corners),
        Source::Cell { min, max } => inside_box(from, *min, *max),
    };
    if !starts {
        return Err(Refusal::Start);
    }
    if !within(to, view.target_corners()) {
        return Err(Refusal::End);
    }
    match first_blocker(view, segment) {
        None => Ok(()),
        Some(polygon) => Err(Refusal::Blocked(polygon.to_vec())),
    }
}

/// Searches for a witness with a number of random segments, half of them past edges.
pub fn find(view: &View<'_>, tries: usize, random: &mut Random) -> Option<Segment> {
    let blockers: Vec<&[[i64; 3]]> = view.blockers().collect();
    for attempt in 0..tries {
        let from = point_of_source(view, random);
        let to = if attempt % 2 == 0 || blockers.is_empty() {
            Some(point_of_polygon(view.target_corners(), random))
        } else {
            let past = near_an_edge(blockers[random.index(blockers.len())], random);
            project(&from, &past, view.target_corners())
        };
        let Some(to) = to else { continue };
        let segment = [from, to];
        if check(view, &segment).is_ok() {
            return Some(segment);
        }
    }
    None
}

fn first_blocker<'a>(view: &View<'a>, [from, to]: &Segment) -> Option<&'a [[i64; 3]]> {
    // Points in the open cell block nothing, so the way begins where the segment leaves the cell.
    let start = match view.source {
        Source::Polygon(_) => from.clone(),
        Source::Cell { min, max } => exit(from, to, *min, *max),
    };
    view.blockers()
        .find(|polygon| contact(&start, to, polygon) != Contact::Miss)
}

fn within(point: &RationalPoint, polygon: &[[i64; 3]]) -> bool {
    sign(&height(polygon, point)) == 0 && strictly_inside(point, polygon)
}

/// Where a segment that starts in the open box meets its boundary; its end if that is inside.
fn exit(from: &RationalPoint, to: &RationalPoint, min: [i64; 3], max: [i64; 3]) -> RationalPoint {
    let mut end = to.clone();
    for axis in 0..3 {
        for (bound, direction) in [(min[axis], 1), (max[axis], -1)] {
            let value = |p: &RationalPoint| {
                (&p.numerators()[axis] - p.denominator() * bound) * IBig::from(direction)
            };
            let (a, b) = (value(from), value(&end));
            if sign(&b) < 0 {
                let weights = [-b * from.denominator(), a * end.denominator()];
                end = RationalPoint::mean(&[from, &end], &weights);
            }
        }
    }
    end
}

fn point_of_source(view: &View<'_>, random: &mut Random) -> RationalPoint {
    match view.source {
        Source::Polygon(i) => point_of_polygon(&view.polygons[*i].corners, random),
        Source::Cell { min, max } => {
            let parts = 1_i64 << 12;
            let mut coordinate = |k: usize| {
                // Often next to a face, where the view is widest.
                let part = match random.index(4) {
                    0 => 1,
                    1 => parts - 1,
                    _ => random.integer(1, parts - 1),
                };
                IBig::from(min[k]) * IBig::from(parts - part)
                    + IBig::from(max[k]) * IBig::from(part)
            };
            let numerators = [coordinate(0), coordinate(1), coordinate(2)];
            RationalPoint::new(numerators, IBig::from(parts))
        }
    }
}

/// A point of the relative interior, sometimes very close to the border.
fn point_of_polygon(polygon: &[[i64; 3]], random: &mut Random) -> RationalPoint {
    let corners: Vec<RationalPoint> = polygon
        .iter()
        .map(|c| RationalPoint::from_grid(*c))
        .collect();
    let mut weight = || {
        let largest = 1 << random.integer(1, 20);
        IBig::from(random.integer(1, largest))
    };
    let weights: Vec<IBig> = corners.iter().map(|_| weight()).collect();
    RationalPoint::mean(&corners.iter().collect::<Vec<_>>(), &weights)
}

/// A point at any order of distance from an edge of a polygon.
fn near_an_edge(polygon: &[[i64; 3]], random: &mut Random) -> RationalPoint {
    let i = random.index(polygon.len());
    let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
    let part = random.integer(0, 256);
    // Offsets from 1/4096 of a grid step up to the length of the edge.
    let length = (0..3)
        .map(|k| a[k].abs_diff(b[k]))
        .max()
        .unwrap_or(0)
        .max(1);
    let largest = 12 + i64::from(length.ilog2()) + 1;
    let reach = 1_i64 << random.integer(0, largest).min(40);
    let mut coordinate = |k: usize| {
        let on_edge =
            i128::from(a[k]) * i128::from(256 - part) + i128::from(b[k]) * i128::from(part);
        IBig::from(on_edge * 16) + IBig::from(random.integer(-reach, reach))
    };
    RationalPoint::new(
        [coordinate(0), coordinate(1), coordinate(2)],
        IBig::from(4096),
    )
}

/// Where the ray from one point through another meets the plane of a polygon.
fn project(
    from: &RationalPoint,
    through: &RationalPoint,
    polygon: &[[i64; 3]],
) -> Option<RationalPoint> {
    let (start, then) = (height(polygon, from), height(polygon, through));
    let bottom = &start * through.denominator() - &then * from.denominator();
    if sign(&bottom) == 0 || sign(&bottom) != sign(&start) {
        return None;
    }
    let at = |k: usize| &start * &through.numerators()[k] - &then * &from.numerators()[k];
    Some(RationalPoint::new([at(0), at(1), at(2)], bottom))
}

#[cfg(test)]
mod tests {
    use super::{Refusal, check, find};
    use crate::random::Random;
    use crate::rational::RationalPoint;
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

    #[test]
    fn a_slit_one_unit_wide_is_found_and_none_is_not() {
        let mut polygons = vec![
            square([0, 1000], [0, 1000], 0),
            square([0, 1000], [0, 1000], 2000),
            square([-2000, 500], [-2000, 2000], 1000),
            square([501, 2000], [-2000, 2000], 1000),
        ];
        let source = Source::Polygon(0);
        let mut random = Random::new(1);
        let view = View {
            polygons: &polygons,
            source: &source,
            target: 1,
        };
        let found = find(&view, 20_000, &mut random).expect("a slit");
        assert_eq!(check(&view, &found), Ok(()));
        polygons[3] = square([500, 2000], [-2000, 2000], 1000);
        let view = View {
            polygons: &polygons,
            source: &source,
            target: 1,
        };
        assert_eq!(find(&view, 2000, &mut random), None);
        assert!(matches!(check(&view, &found), Err(Refusal::Blocked(_))));
    }

    #[test]
    fn inside_the_cell_nothing_blocks_but_its_boundary_does() {
        let source = Source::Cell {
            min: [0, 0, 0],
            max: [8, 8, 8],
        };
        let segment = |z: i64| [[4, 4, 1], [4, 4, z]].map(RationalPoint::from_grid);
        for (at, free) in [(4, true), (8, false), (10, false)] {
            let polygons = [square([0, 8], [0, 8], 20), square([0, 8], [0, 8], at)];
            let view = View {
                polygons: &polygons,
                source: &source,
                target: 0,
            };
            assert_eq!(check(&view, &segment(20)).is_ok(), free, "{at}");
            assert_eq!(check(&view, &segment(19)), Err(Refusal::End));
        }
    }
}
