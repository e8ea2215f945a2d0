//! Hidden lines: what is left of the scene's feature edges when the seen parts are taken away.
//!
//! Edges are compared on their line in space: edges of several polygons that overlap there are one. An edge
//! along which exactly two polygons of an object go on smoothly is no feature, nor one inside a flat face: all
//! polygons along it lie in one plane, in which another polygon goes on on both sides. Which parts lie on one line
//! or in one plane is exact; where the seen parts end is rounded, like everything that is drawn.

use std::collections::BTreeMap;

use antumbra_kernel::{Aabb, Plane, Point, cross, sub};
use antumbra_scene::{ObjectId, PolygonId, Scene};
use rustc_hash::FxHashMap;

use super::VisibilityMap;
use super::drawing::place;

/// A line in space: its primitive direction, the first non-zero component positive, and its moment.
type Line = ([i64; 3], [i64; 3]);

/// An edge on its line: from, to (as multiples of the direction), and the polygon.
struct Span {
    ends: [f64; 2],
    polygon: PolygonId,
}

#[derive(Default)]
struct OnLine {
    /// A point of the line and the place it has there.
    origin: Option<(Point, f64)>,
    spans: BTreeMap<ObjectId, Vec<Span>>,
    seen: Vec<[f64; 2]>,
}

/// Shortest part that counts, as a share of its edge: the ends of seen parts are rounded.
const SHORTEST: f64 = 1e-9;

/// The hidden parts of all feature edges, in scene units. They may lie outside the view.
pub(super) fn segments(
    map: &VisibilityMap,
    scene: &Scene,
    crease: f64,
) -> Vec<(ObjectId, [[f64; 3]; 2])> {
    let mut lines: BTreeMap<Line, OnLine> = BTreeMap::new();
    for polygon in scene.polygons().filter(|p| p.occludes) {
        let n = polygon.corners.len();
        for i in 0..n {
            let (u, v) = (polygon.corners[i], polygon.corners[(i + 1) % n]);
            let line = line_of(u, v);
            let ends = ordered([along(&line, u), along(&line, v)]);
            let entry = lines.entry(line).or_default();
            entry.origin.get_or_insert((u, along(&line, u)));
            let spans = entry.spans.entry(polygon.object).or_default();
            spans.push(Span {
                ends,
                polygon: polygon.id,
            });
        }
    }
    add_seen(map, scene, &mut lines);
    let flat = FlatFaces::new(scene);
    let mut out = Vec::new();
    for (line, on) in &lines {
        let Some((origin, at)) = on.origin else {
            continue;
        };
        let point = |t: f64| -> [f64; 3] {
            let p = place(scene, origin);
            std::array::from_fn(|k| p[k] + (t - at) * line.0[k] as f64 * scene.grid().step())
        };
        let mut taken = merged(on.seen.clone());
        let origin = origin.to_f64();
        let in_steps = |t: f64| std::array::from_fn(|k| origin[k] + (t - at) * line.0[k] as f64);
        for (&object, spans) in &on.spans {
            let features = features(scene, spans, crease).into_iter();
            let features = features.flat_map(|part| {
                let covers = |s: &&Span| s.ends[0] <= part[0] && part[1] <= s.ends[1];
                let along = on.spans.values().flatten().filter(covers);
                let inside = flat.inside(scene, along.map(|s| s.polygon), part.map(in_steps));
                let length = part[1] - part[0];
                let inside = inside.map(|ends| ends.map(|t| part[0] + t * length));
                without(part, &merged(inside.collect()))
            });
            for part in merged(features.collect()) {
                let hidden = without(part, &taken);
                out.extend(hidden.into_iter().map(|h| (object, h.map(point))));
                taken = merged([taken, vec![part]].concat());
            }
        }
    }
    out
}

/// A plane: its primitive normal, the first non-zero component positive, and its offset.
type Flat = ([i64; 3], i128);

/// The polygons of each plane, with their boxes.
struct FlatFaces {
    by_plane: FxHashMap<Flat, Vec<(Aabb, PolygonId)>>,
}

impl FlatFaces {
    fn new(scene: &Scene) -> Self {
        let mut by_plane: FxHashMap<Flat, Vec<(Aabb, PolygonId)>> = FxHashMap::default();
        for polygon in scene.polygons().filter(|p| p.occludes) {
            if let Some(around) = Aabb::around(polygon.corners.iter().copied()) {
                let plane = flat_of(polygon.plane);
                by_plane
                    .entry(plane)
                    .or_default()
                    .push((around, polygon.id));
            }
        }
        Self { by_plane }
    }

    /// The parts of a segment, from 0 to 1, that lie inside other polygons of the plane in which all polygons
    /// along it lie; none if they lie in several.
    fn inside<'a>(
        &'a self,
        scene: &'a Scene,
        mut along: impl Iterator<Item = PolygonId>,
        segment: [[f64; 3]; 2],
    ) -> impl Iterator<Item = [f64; 2]> + 'a {
        let plane = |id: PolygonId| flat_of(scene.polygon(id).plane);
        let first = along.next().map(plane);
        let flat = first.filter(|first| along.all(|id| plane(id) == *first));
        let there = flat.and_then(|flat| Some((flat.0, self.by_plane.get(&flat)?)));
        there.into_iter().flat_map(move |(normal, there)| {
            let near = there.iter().filter(move |(around, _)| {
                let (low, high) = (around.min.to_f64(), around.max.to_f64());
                let [a, b] = segment;
                (0..3).all(|k| low[k] <= a[k].max(b[k]) && a[k].min(b[k]) <= high[k])
            });
            near.filter_map(move |(_, id)| within(scene.polygon(*id).corners, normal, segment))
        })
    }
}

fn flat_of(plane: &Plane) -> Flat {
    let n = plane.normal;
    let common = n.iter().fold(0, |g, &c| gcd(g, c.unsigned_abs())).max(1) as i64;
    let first = n.iter().copied().find(|&c| c != 0).unwrap_or(1).signum();
    let scale = common * first;
    (n.map(|c| c / scale), plane.offset / i128::from(scale))
}

/// From where to where, from 0 to 1, a segment in a convex polygon's plane lies inside of it: farther from its edges
/// than rounding.
fn within(corners: &[Point], normal: [i64; 3], segment: [[f64; 3]; 2]) -> Option<[f64; 2]> {
    // Without the axis along which the plane is seen best.
    let axis = (0..3)
        .max_by_key(|&k| normal[k].unsigned_abs())
        .unwrap_or(2);
    let flat = |p: [f64; 3]| [p[(axis + 1) % 3], p[(axis + 2) % 3]];
    let corners: Vec<[f64; 2]> = corners.iter().map(|c| flat(c.to_f64())).collect();
    let side = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| {
        let d = [b[0] - a[0], b[1] - a[1]];
        (d[0] * (p[1] - a[1]) - d[1] * (p[0] - a[0])) / d[0].hypot(d[1]).max(1.0)
    };
    let next = |i: usize| corners[(i + 1) % corners.len()];
    let around: f64 = (1..corners.len())
        .map(|i| side(corners[0], corners[i], next(i)))
        .sum();
    let ends = segment.map(flat);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let mut sides = Vec::with_capacity(corners.len());
    for (i, &corner) in corners.iter().enumerate() {
        let [s, t] = ends.map(|p| side(corner, next(i), p) * around.signum());
        sides.push([s, t]);
        if s < 0.0 && t < 0.0 {
            return None;
        }
        let cut = s / (s - t);
        if s < 0.0 {
            enter = enter.max(cut);
        } else if t < 0.0 {
            leave = leave.min(cut);
        }
    }
    let middle = (enter + leave) / 2.0;
    let inside = sides.iter().all(|[s, t]| s + middle * (t - s) > 0.5);
    (enter < leave && inside).then_some([enter, leave])
}

/// Notes on each line which parts of it the map shows.
fn add_seen(map: &VisibilityMap, scene: &Scene, lines: &mut BTreeMap<Line, OnLine>) {
    for edge in map.edges() {
        for element in [edge.near, edge.far].into_iter().flatten() {
            let Some(k) = element.edge else { continue };
            let corners = scene.polygon(element.polygon).corners;
            let k = k as usize;
            let line = line_of(corners[k], corners[(k + 1) % corners.len()]);
            let Some(on) = lines.get_mut(&line) else {
                continue;
            };
            let Some((origin, at)) = on.origin else {
                continue;
            };
            let (p, d) = (place(scene, origin), line.0.map(|c| c as f64));
            let size = d.iter().map(|c| c * c).sum::<f64>() * scene.grid().step();
            let ends = edge.ends.map(|v| {
                let q = map.point_on(scene, v, element.polygon);
                at + (0..3).map(|i| (q[i] - p[i]) * d[i]).sum::<f64>() / size
            });
            on.seen.push(ordered(ends));
        }
    }
}

fn line_of(u: Point, v: Point) -> Line {
    let d = sub(v, u);
    let common = d.iter().fold(0, |g, &c| gcd(g, c.unsigned_abs())) as i64;
    let first = d.iter().copied().find(|&c| c != 0).unwrap_or(1).signum();
    let d = d.map(|c| c / common * first);
    (d, cross(u.to_i64(), d))
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The place of a point on a line, as a multiple of its direction from some point of it.
fn along(line: &Line, p: Point) -> f64 {
    let k = (0..3).find(|&k| line.0[k] != 0).unwrap_or(0);
    p.to_i64()[k] as f64 / line.0[k] as f64
}

fn ordered([a, b]: [f64; 2]) -> [f64; 2] {
    if a <= b { [a, b] } else { [b, a] }
}

/// The parts of one object's edges on a line that are features.
fn features(scene: &Scene, spans: &[Span], crease: f64) -> Vec<[f64; 2]> {
    let mut cuts: Vec<f64> = spans.iter().flat_map(|s| s.ends).collect();
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let parts = cuts.windows(2).filter(|w| {
        let covers = |s: &&Span| s.ends[0] <= w[0] && w[1] <= s.ends[1];
        let over: Vec<PolygonId> = spans.iter().filter(covers).map(|s| s.polygon).collect();
        match over[..] {
            [] => false,
            [a, b] => !smooth(scene, a, b, crease),
            _ => true,
        }
    });
    parts.map(|w| [w[0], w[1]]).collect()
}

fn smooth(scene: &Scene, a: PolygonId, b: PolygonId, crease: f64) -> bool {
    let [p, q] = [a, b].map(|id| scene.polygon(id).plane.normal.map(|c| c as f64));
    let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    dot(p, q).abs() >= crease.cos() * (dot(p, p) * dot(q, q)).sqrt()
}

/// Sorted, overlapping ones joined.
fn merged(mut parts: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut out: Vec<[f64; 2]> = Vec::new();
    for part in parts {
        match out.last_mut() {
            Some(last) if part[0] <= last[1] => last[1] = last[1].max(part[1]),
            _ => out.push(part),
        }
    }
    out
}

/// What sorted, disjoint parts leave of one.
fn without(part: [f64; 2], taken: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let shortest = SHORTEST * (part[1] - part[0]);
    let mut out = Vec::new();
    let mut from = part[0];
    for t in taken.iter().filter(|t| t[1] > part[0] && t[0] < part[1]) {
        if t[0] - from > shortest {
            out.push([from, t[0]]);
        }
        from = from.max(t[1]);
    }
    if part[1] - from > shortest {
        out.push([from, part[1]]);
    }
    out
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Point;

    use super::{line_of, merged, without};

    #[test]
    fn parts_of_a_line() {
        let (a, b, c) = (
            Point::new(1, 2, 3),
            Point::new(3, 6, 3),
            Point::new(2, 4, 3),
        );
        assert_eq!(line_of(a, b), line_of(b, c));
        assert_ne!(line_of(a, b), line_of(a, Point::new(3, 6, 4)));
        let taken = merged(vec![[4.0, 5.0], [0.0, 1.0], [0.5, 2.0]]);
        assert_eq!(taken, [[0.0, 2.0], [4.0, 5.0]]);
        assert_eq!(without([1.0, 6.0], &taken), [[2.0, 4.0], [5.0, 6.0]]);
        assert!(without([0.0, 2.0], &taken).is_empty());
    }
}
