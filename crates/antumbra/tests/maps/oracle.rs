//! First hits by big integers, and convex cells read back from a map: shares nothing with the engine.

use antumbra::kernel::Point;
use antumbra::map::{FaceKind, VisibilityMap};
use antumbra::scene::{PolygonId, Scene};
use dashu_int::IBig;

/// A direction in big integers.
pub(crate) type Direction = [IBig; 3];

/// The occluders of a scene as seen from a point.
pub(crate) struct FirstHits {
    polygons: Vec<Seen>,
}

struct Seen {
    id: PolygonId,
    /// A cap of directions around the polygon: its axis, and the cosine of a slightly larger radius.
    axis: [f64; 3],
    cosine: f64,
    corners: Vec<[i128; 3]>,
    normal: [i128; 3],
    /// `normal . (corner - eye)`.
    distance: i128,
}

impl FirstHits {
    pub(crate) fn new(scene: &Scene, eye: Point) -> Self {
        let polygons = scene.polygons().filter(|p| p.occludes).filter_map(|p| {
            let e = eye.to_i64().map(i128::from);
            let corners: Vec<[i128; 3]> = p
                .corners
                .iter()
                .map(|c| {
                    let c = c.to_i64().map(i128::from);
                    [c[0] - e[0], c[1] - e[1], c[2] - e[2]]
                })
                .collect();
            let (a, b, c) = (corners[0], corners[1], corners[2]);
            let sub = |p: [i128; 3], q: [i128; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
            let normal = cross(sub(b, a), sub(c, a));
            let distance = (0..3).map(|k| normal[k] * a[k]).sum::<i128>();
            if distance == 0 {
                return None;
            }
            let units: Vec<[f64; 3]> = corners.iter().map(|c| unit(c.map(|v| v as f64))).collect();
            let sum = units
                .iter()
                .fold([0.0; 3], |s, u| [s[0] + u[0], s[1] + u[1], s[2] + u[2]]);
            let axis = unit(sum);
            let cosine = units.iter().map(|u| dot(*u, axis)).fold(1.0, f64::min);
            // A cap larger than half the sphere is the whole sphere.
            let cosine = if cosine > 1e-3 { cosine - 1e-9 } else { -2.0 };
            Some(Seen {
                id: p.id,
                axis,
                cosine,
                corners,
                normal,
                distance,
            })
        });
        Self {
            polygons: polygons.collect(),
        }
    }

    /// All polygons that come first along a direction, by number; none if nothing is met. Exact.
    pub(crate) fn along(&self, direction: &Direction) -> Vec<PolygonId> {
        let rounded = unit(direction.clone().map(|c| c.to_f64().value()));
        let mut best: Option<(IBig, IBig)> = None;
        let mut first = Vec::new();
        for polygon in &self.polygons {
            if dot(rounded, polygon.axis) < polygon.cosine {
                continue;
            }
            let Some((num, den)) = polygon.meets(direction) else {
                continue;
            };
            // Distances num / den with positive den.
            let order = best
                .as_ref()
                .map(|(n, d)| (&num * d).cmp(&(n * &den)))
                .unwrap_or(std::cmp::Ordering::Less);
            if order.is_lt() {
                first.clear();
                best = Some((num, den));
            }
            if order.is_le() {
                first.push(polygon.id);
            }
        }
        first.sort_unstable();
        first
    }
}

impl Seen {
    /// How far along a direction the closed polygon is met, as a fraction.
    fn meets(&self, d: &Direction) -> Option<(IBig, IBig)> {
        let mut along = big_dot(&self.normal, d);
        let mut distance = IBig::from(self.distance);
        let turn = if distance < IBig::ZERO { -1 } else { 1 };
        along *= IBig::from(turn);
        distance *= IBig::from(turn);
        if along <= IBig::ZERO {
            return None;
        }
        let n = self.corners.len();
        let inside = (0..n).all(|i| {
            let row = cross(self.corners[i], self.corners[(i + 1) % n]);
            big_dot(&row, d) * IBig::from(turn) >= IBig::ZERO
        });
        inside.then_some((distance, along))
    }
}

/// A convex cell of an undissolved map.
pub(crate) struct Cell {
    /// Who is seen; `None` for the background.
    pub owner: Option<PolygonId>,
    /// Its vertices in order.
    pub vertices: Vec<u32>,
}

/// The cells of an undissolved map.
pub(crate) fn cells(map: &VisibilityMap) -> Vec<Cell> {
    let inside = map.faces().iter().filter(|f| f.kind != FaceKind::Outside);
    inside
        .map(|face| {
            assert_eq!(face.borders.len(), 1, "a convex cell has one border");
            let border = map.border(face.borders[0]);
            Cell {
                owner: face.polygon(),
                vertices: border.map(|h| map.origin(h)).collect(),
            }
        })
        .collect()
}

/// The exact directions of all vertices of a map.
pub(crate) fn directions(map: &VisibilityMap) -> Vec<Direction> {
    (0..map.vertices().len() as u32)
        .map(|v| {
            map.exact_direction(v)
                .map(|text| text.parse().expect("a decimal number"))
        })
        .collect()
}

/// Checks directions inside every cell, right beside each of its edges and vertices (2^-40 of the
/// way, of vertices scaled to like length), against first hits. Of more than `most` directions, about
/// that many spread over the cells. Returns how many were checked.
pub(crate) fn check_beside(map: &VisibilityMap, hits: &FirstHits, most: usize) -> usize {
    use dashu_int::ops::BitTest;
    let longest = |d: &Direction| d.iter().map(BitTest::bit_len).max().unwrap_or(0);
    let rays = directions(map);
    let size = rays.iter().map(longest).max().unwrap_or(0);
    let rays: Vec<Direction> = rays
        .into_iter()
        .map(|d| {
            let shift = size - longest(&d);
            d.map(|c| c << shift)
        })
        .collect();
    let sum = |parts: &[&Direction]| -> Direction {
        std::array::from_fn(|k| parts.iter().map(|d| d[k].clone()).sum())
    };
    let mut checked = 0;
    let cells = cells(map);
    let expected: usize = cells.iter().map(|c| 2 * c.vertices.len() + 1).sum();
    for cell in cells.iter().step_by(1 + expected / most) {
        let corners: Vec<&Direction> = cell.vertices.iter().map(|&v| &rays[v as usize]).collect();
        let center = sum(&corners);
        let n = corners.len();
        let mut beside = vec![center.clone()];
        for i in 0..n {
            let edge = sum(&[corners[i], corners[(i + 1) % n]]);
            for border in [&edge, corners[i]] {
                let far: Direction = border.clone().map(|c| c << 40);
                beside.push(sum(&[&far, &center]));
            }
        }
        for direction in beside {
            let first = hits.along(&direction);
            assert_eq!(
                first.first().copied(),
                cell.owner,
                "along {direction:?} come {first:?} first"
            );
            checked += 1;
        }
    }
    checked
}

fn big_dot(row: &[i128; 3], d: &Direction) -> IBig {
    (0..3).map(|k| IBig::from(row[k]) * &d[k]).sum()
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn unit(v: [f64; 3]) -> [f64; 3] {
    let largest = v.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    let v = v.map(|c| c / largest);
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}
