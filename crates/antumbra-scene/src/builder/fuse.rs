//! Occluders for real-time culling: coplanar neighbors of *different* objects become one polygon.
//!
//! A wall is many elements of many triangles. What hides is their union, so the exact merge of the
//! builder is applied again across objects: the union of the polygons of a plane, as a set of
//! points, never changes. [Bittner02, 9.2.2] asks for such a synthesis of occluders.

use antumbra_kernel::{Plane, Point};
use rustc_hash::FxHashMap;

use super::clean::Patch;
use super::merge::merge;
use crate::{ObjectId, Scene};

/// A convex planar polygon that covers nothing that the scene does not cover.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FusedOccluder {
    /// At least three corners in order, exactly coplanar and strictly convex.
    pub corners: Vec<Point>,
    /// The canonical plane, as of [`crate::PolygonRef::plane`].
    pub plane: Plane,
    /// The object if it was asked to be kept apart, else none: several objects may have a part.
    pub object: Option<ObjectId>,
}

/// Merges the occluding polygons of a scene across objects; what `apart` names is merged only with
/// polygons of the same object, so that it can be switched off.
///
/// Exact, deterministic; expected time proportional to the polygons, times a logarithm.
#[must_use]
pub fn fuse_occluders(scene: &Scene, apart: impl Fn(ObjectId) -> bool) -> Vec<FusedOccluder> {
    let mut numbers: FxHashMap<Point, u32> = FxHashMap::default();
    let mut points: Vec<Point> = Vec::new();
    let mut shared: Vec<Patch> = Vec::new();
    let mut alone: Vec<(ObjectId, Vec<Patch>)> = Vec::new();
    for polygon in scene.polygons().filter(|p| p.occludes) {
        let corners = polygon.corners.iter().map(|&p| {
            *numbers.entry(p).or_insert_with(|| {
                points.push(p);
                points.len() as u32 - 1
            })
        });
        let patch = Patch {
            corners: corners.collect(),
            plane: *polygon.plane,
            occludes: true,
        };
        if !apart(polygon.object) {
            shared.push(patch);
            continue;
        }
        // The polygons of an object are consecutive.
        match alone.last_mut() {
            Some((object, patches)) if *object == polygon.object => patches.push(patch),
            _ => alone.push((polygon.object, vec![patch])),
        }
    }
    let groups = std::iter::once((None, shared))
        .chain(alone.into_iter().map(|(object, list)| (Some(object), list)));
    let mut fused = Vec::new();
    for (object, patches) in groups {
        let (merged, _) = merge(&points, patches);
        fused.extend(merged.into_iter().map(|patch| FusedOccluder {
            corners: patch.corners.iter().map(|&i| points[i as usize]).collect(),
            plane: patch.plane,
            object,
        }));
    }
    fused
}
