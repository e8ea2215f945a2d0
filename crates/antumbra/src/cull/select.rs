//! Which occluders a frame starts with, and in which order they are inserted.
//!
//! The quality of an occluder is its area-angle [Bittner02, 4.5], `A |N . V| / D^2` with the direction V
//! and the distance D of its middle.

use antumbra_kernel::{Aabb, Point};
use antumbra_scene::{FusedOccluder, Scene, fuse_occluders};
use rustc_hash::FxHashMap;

use super::bound::{dot, sub};
use super::faces::{Faces, Lines};
use super::hierarchy::Bounds;
use super::options::{CullOptions, Selection};

/// The potential occluders of a scene.
pub(super) struct Occluders {
    pub faces: Faces,
    pub bounds: Vec<Bounds>,
    /// The object of those that can be switched off.
    pub owners: Vec<Option<u32>>,
}

impl Occluders {
    /// The largest fused occluders, as far as the options let them be.
    pub(super) fn new(scene: &Scene, lines: &mut Lines, options: &CullOptions) -> Self {
        let fused = fuse_occluders(scene, |object| options.doors.contains(&object));
        let mut out = Self {
            faces: Faces::new(),
            bounds: Vec::new(),
            owners: Vec::new(),
        };
        for occluder in potential(scene, fused, options) {
            out.faces
                .push(lines, &occluder.corners, occluder.plane.normal);
            // Many corners make several faces.
            for face in out.owners.len() as u32..out.faces.len() as u32 {
                out.bounds.push(Bounds::around(out.faces.get(face).corners));
                out.owners.push(occluder.object.map(|o| o.0));
            }
        }
        out
    }

    /// In steradians, nearly.
    #[inline]
    pub(super) fn area_angle(&self, occluder: u32, eye: [f64; 3]) -> f64 {
        let d = sub(self.faces.middle(occluder), eye);
        let squared = dot(d, d);
        let facing = dot(self.faces.normal(occluder), d).abs();
        self.faces.area(occluder) * facing / (squared * squared.sqrt())
    }

    /// Whether the eye sees `other` on the far side of the plane of `pivot`, all of it.
    fn is_behind(&self, other: u32, pivot: u32, eye: [f64; 3]) -> bool {
        let face = self.faces.get(pivot);
        let side = |p: [f64; 3]| dot(face.normal, sub(p, face.corners[0]));
        let of_eye = side(eye).signum();
        // A grid step is more than rounding, and as good as nothing.
        self.faces
            .get(other)
            .corners
            .iter()
            .all(|&c| side(c) * of_eye < 1.0)
    }

    /// Sorts occluders front to back by an autopartition BSP: the first one parts the others, those
    /// that its plane splits stay on its near side. Splitting them would change nothing, since the tree
    /// merges late, closer occluders.
    pub(super) fn partition(&self, list: &mut [(f64, u32)], eye: [f64; 3]) {
        let mut rest = list;
        while rest.len() > 1 {
            let pivot = rest[0];
            let mut near = 0;
            for i in 1..rest.len() {
                if !self.is_behind(rest[i].1, pivot.1, eye) {
                    near += 1;
                    rest[1..].swap(near - 1, i - 1);
                }
            }
            // Pivot after the near ones.
            rest.swap(0, near);
            let (before, after) = rest.split_at_mut(near);
            self.partition(before, eye);
            rest = &mut after[1..];
        }
    }
}

/// The best of a list, in order; equal ones by number.
pub(super) fn keep_largest(list: &mut Vec<(f64, u32)>, count: usize) {
    let order = |a: &(f64, u32), b: &(f64, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    if count == 0 {
        list.clear();
    } else if list.len() > count {
        list.select_nth_unstable_by(count - 1, order);
        list.truncate(count);
    }
    list.sort_unstable_by(order);
}

/// The area of a potential occluder.
fn area(occluder: &FusedOccluder) -> f64 {
    let mut faces = Faces::new();
    let normal = occluder.plane.normal;
    faces.push(&mut Lines::default(), &occluder.corners, normal);
    (0..faces.len() as u32).map(|i| faces.area(i)).sum()
}

/// For each corner of the scene the largest face of the box of the smallest object that has it.
fn object_sizes(scene: &Scene) -> FxHashMap<Point, f64> {
    let mut boxes: Vec<Option<Aabb>> = vec![None; scene.objects().len()];
    for polygon in scene.polygons() {
        let of_object = &mut boxes[polygon.object.index()];
        let known = of_object.iter().flat_map(|b| [b.min, b.max]);
        *of_object = Aabb::around(polygon.corners.iter().copied().chain(known));
    }
    let size = |b: &Option<Aabb>| {
        b.map_or(0.0, |b| {
            let [x, y, z] = sub(b.max.to_f64(), b.min.to_f64());
            (x * y).max(y * z).max(z * x)
        })
    };
    let sizes: Vec<f64> = boxes.iter().map(size).collect();
    let mut of_corner = FxHashMap::default();
    for polygon in scene.polygons() {
        let size = sizes[polygon.object.index()];
        for &corner in polygon.corners {
            let smallest = of_corner.entry(corner).or_insert(size);
            *smallest = size.min(*smallest);
        }
    }
    of_corner
}

/// The largest occluders, in their order; those that are small on their own object left out.
fn potential(
    scene: &Scene,
    mut fused: Vec<FusedOccluder>,
    options: &CullOptions,
) -> Vec<FusedOccluder> {
    if options.potential_part > 0.0 {
        let sizes = object_sizes(scene);
        let of_corner = |p: &Point| sizes.get(p).copied().unwrap_or(0.0);
        fused.retain(|occluder| {
            let size = occluder.corners.iter().map(of_corner);
            area(occluder) >= options.potential_part * size.fold(f64::INFINITY, f64::min)
        });
    }
    let areas: Vec<f64> = fused.iter().map(area).collect();
    let mut sorted = areas.clone();
    sorted.sort_unstable_by(|a, b| b.total_cmp(a));
    let all: f64 = sorted.iter().sum();
    let mut sum = 0.0;
    let enough = sorted.iter().position(|a| {
        sum += a;
        sum >= all * options.potential_share
    });
    let last = enough
        .unwrap_or(usize::MAX)
        .min(options.potential.saturating_sub(1));
    let smallest = if options.potential == 0 {
        f64::INFINITY
    } else {
        sorted.get(last).copied().unwrap_or(0.0)
    };
    fused
        .into_iter()
        .zip(areas)
        .filter(|(_, area)| *area >= smallest)
        .map(|(occluder, _)| occluder)
        .collect()
}

impl Selection {
    /// Whether occluders are inserted while the hierarchy is swept.
    pub(super) fn sweeps(self) -> bool {
        matches!(self, Self::Sweep | Self::Region { sweep: true, .. })
    }
}
