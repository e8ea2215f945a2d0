//! Coplanar polygons that overlap: they share what is seen of them, and the smallest id owns it.

use std::collections::HashMap;

use antumbra_kernel::{Plane, Point};
use antumbra_scene::{PolygonId, PolygonRef, Scene};

/// For each polygon, the occluders of its plane whose interiors overlap its own.
#[derive(Clone, Debug, Default)]
pub struct Twins {
    /// Where the list of a polygon starts and ends; only polygons with twins are here.
    ranges: HashMap<PolygonId, (u32, u32)>,
    twins: Vec<PolygonId>,
}

impl Twins {
    /// Finds all pairs among the occluders of a scene. `n log n` where few polygons of one plane have
    /// overlapping extents.
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Self {
        let mut groups: HashMap<Plane, Vec<PolygonId>> = HashMap::new();
        for polygon in scene.polygons().filter(|p| p.occludes) {
            groups.entry(*polygon.plane).or_default().push(polygon.id);
        }
        let mut pairs = Vec::new();
        for group in groups.values().filter(|g| g.len() > 1) {
            overlaps(scene, group, &mut pairs);
        }
        pairs.sort_unstable();
        let mut out = Self::default();
        for (id, twin) in pairs {
            let at = out.twins.len() as u32;
            out.twins.push(twin);
            out.ranges.entry(id).or_insert((at, at)).1 = at + 1;
        }
        out
    }

    /// The twins of a polygon, by number.
    #[must_use]
    pub fn of(&self, id: PolygonId) -> &[PolygonId] {
        let range = self.ranges.get(&id);
        range.map_or(&[], |&(first, end)| {
            &self.twins[first as usize..end as usize]
        })
    }
}

/// The projection of a plane along the longest axis of its normal.
fn axes(plane: &Plane) -> (usize, usize) {
    let longest = (0..3)
        .max_by_key(|&k| plane.normal[k].abs())
        .unwrap_or_default();
    ((longest + 1) % 3, (longest + 2) % 3)
}

/// All ordered pairs of a group whose interiors overlap: a sweep along one axis, then exactly.
fn overlaps(scene: &Scene, group: &[PolygonId], pairs: &mut Vec<(PolygonId, PolygonId)>) {
    let (u, v) = axes(scene.polygon(group[0]).plane);
    let mut spans: Vec<([i32; 2], PolygonId)> = group
        .iter()
        .map(|&id| {
            let b = scene.polygon(id).bounds();
            ([b.min.to_array()[u], b.max.to_array()[u]], id)
        })
        .collect();
    spans.sort_unstable();
    for (i, &([_, end], a)) in spans.iter().enumerate() {
        for &(_, b) in spans[i + 1..].iter().take_while(|(s, _)| s[0] < end) {
            let (p, q) = (scene.polygon(a), scene.polygon(b));
            if !separated(&p, &q, u, v) && !separated(&q, &p, u, v) {
                pairs.extend([(a, b), (b, a)]);
            }
        }
    }
}

/// Whether an edge of `p` has all of `q` on its outer side or on its line.
fn separated(p: &PolygonRef<'_>, q: &PolygonRef<'_>, u: usize, v: usize) -> bool {
    let turn = p.plane.normal[3 - u - v].signum();
    let n = p.corners.len();
    let at = |c: Point| (c.to_i64()[u], c.to_i64()[v]);
    (0..n).any(|i| {
        let (a, b) = (at(p.corners[i]), at(p.corners[(i + 1) % n]));
        q.corners.iter().all(|&c| {
            let c = at(c);
            let cross = (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0);
            cross.signum() * turn <= 0
        })
    })
}
