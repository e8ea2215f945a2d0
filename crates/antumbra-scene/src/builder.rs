//! From float input to an exact scene: snap once, repair, seal, merge, index.
//!
//! Object by object, and each object by these steps: vertices go to the grid and equal positions
//! become one ([`snap`]); faces become strictly convex planar patches ([`clean`]); the slits that
//! snapping opened between an edge and the vertices beside it are closed ([`seal`]); patches that
//! occur twice are dropped; coplanar neighbors are merged ([`merge`]) and what others cover is
//! dropped ([`cover`]). Nothing after the first
//! step changes the set of points that the occluders cover, except that slits are closed.

mod clean;
mod cover;
mod error;
mod fuse;
mod merge;
mod near;
mod plane;
mod seal;
mod snap;
mod triangulate;

use antumbra_kernel::{Aabb, Grid, Plane, Point};
use rayon::prelude::*;

pub use error::BuildError;
pub use fuse::{FusedOccluder, fuse_occluders};

use crate::input::{ObjectInput, OccluderPolicy, SceneInput};
use crate::kd::{KdHeuristic, KdTree, Shape};
use crate::report::{BuildReport, ObjectRepairs, RepairCounts};
use crate::scene::{Object, ObjectId, Scene};
use clean::{Cleaned, Patch};

/// Makes a [`Scene`] from a [`SceneInput`].
///
/// ```
/// use antumbra_scene::{ObjectInput, PartInput, SceneBuilder, SceneInput};
/// let wall = PartInput {
///     vertices: vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 2.5], [0.0, 0.0, 2.5]],
///     faces: [[0, 1, 2], [0, 2, 3]].into_iter().collect(),
///     ..Default::default()
/// };
/// let object = ObjectInput { name: Some("wall".into()), parts: vec![wall] };
/// let input = SceneInput { objects: vec![object], source_name: "example".into() };
/// let (scene, report) = SceneBuilder::new(input).build()?;
/// assert_eq!((report.faces, scene.polygon_count()), (2, 1));
/// # Ok::<(), antumbra_scene::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneBuilder {
    input: SceneInput,
    grid: Option<f64>,
    cells_box: Option<([f64; 3], [f64; 3])>,
    policy: OccluderPolicy,
    heuristic: KdHeuristic,
}

impl SceneBuilder {
    /// A builder with the finest grid that fits and the default occluder policy.
    #[must_use]
    pub fn new(input: SceneInput) -> Self {
        Self {
            input,
            grid: None,
            cells_box: None,
            policy: OccluderPolicy::Default,
            heuristic: KdHeuristic::SurfaceArea,
        }
    }

    /// Fixes the grid step in scene units, as comparisons between scenes need;
    /// `None` is the finest power of two that fits.
    #[must_use]
    pub fn grid(mut self, step: Option<f64>) -> Self {
        self.grid = step;
        self
    }

    /// A box in scene units (smallest and largest coordinates) that the grid must hold too,
    /// since view cells lie in it.
    #[must_use]
    pub fn cells_box(mut self, bounds: Option<([f64; 3], [f64; 3])>) -> Self {
        self.cells_box = bounds;
        self
    }

    /// Which parts are occluders.
    #[must_use]
    pub fn policy(mut self, policy: OccluderPolicy) -> Self {
        self.policy = policy;
        self
    }

    /// How the kD-tree chooses its splits.
    #[must_use]
    pub fn heuristic(mut self, heuristic: KdHeuristic) -> Self {
        self.heuristic = heuristic;
        self
    }

    /// Builds the scene, with a report of every repair.
    ///
    /// The same input gives the same scene for any number of threads.
    ///
    /// # Errors
    /// If a coordinate is not finite, an index is out of range, nothing has an area, or the grid
    /// cannot hold scene and cells.
    pub fn build(self) -> Result<(Scene, BuildReport), BuildError> {
        let Self {
            input,
            grid,
            cells_box,
            policy,
            heuristic,
        } = self;
        let faces = input
            .objects
            .iter()
            .flat_map(|o| &o.parts)
            .map(|part| part.faces.len())
            .sum();
        let nothing = |step| BuildError::NoTriangles {
            scene: input.source_name.clone(),
            objects: input.objects.len(),
            faces,
            step,
        };
        let bounds = snap::checked_bounds(&input)?.ok_or_else(|| nothing(None))?;
        let bounds = with_cells(bounds, cells_box)?;
        let grid = snap::choose_grid(&input.source_name, bounds, grid)?;

        // Chunks so small that large objects spread over the threads, and so large that many
        // small ones share their memory.
        let chunk = (input.objects.len() / 256).max(1);
        let batches: Vec<Batch> = input
            .objects
            .par_chunks(chunk)
            .map(|objects| Batch::build(objects, &grid, &policy))
            .collect();
        let (scene, report) = assemble(&input, grid, heuristic, batches)?;
        if scene.polygon_count() == 0 {
            return Err(nothing(Some(scene.grid().step())));
        }
        Ok((scene, BuildReport { faces, ..report }))
    }
}

/// The union of the scene's box and that of the cells.
fn with_cells(
    bounds: snap::FloatBox,
    cells: Option<snap::FloatBox>,
) -> Result<snap::FloatBox, BuildError> {
    let Some((min, max)) = cells else {
        return Ok(bounds);
    };
    if !(0..3).all(|k| min[k].is_finite() && max[k].is_finite() && min[k] <= max[k]) {
        return Err(BuildError::BadCellsBox { min, max });
    }
    let low = std::array::from_fn(|k| bounds.0[k].min(min[k]));
    let high = std::array::from_fn(|k| bounds.1[k].max(max[k]));
    Ok((low, high))
}

/// The polygons of some consecutive objects.
#[derive(Default)]
struct Batch {
    corners: Vec<Point>,
    /// Where each polygon ends in `corners`.
    ends: Vec<usize>,
    planes: Vec<Plane>,
    occludes: Vec<bool>,
    /// For each object: how many polygons are its own, and what was repaired.
    objects: Vec<(usize, RepairCounts)>,
    squared_movement: f64,
}

impl Batch {
    fn build(objects: &[ObjectInput], grid: &Grid, policy: &OccluderPolicy) -> Self {
        let mut batch = Self::default();
        let mut welder = snap::Welder::default();
        for object in objects {
            welder.clear();
            let (patches, counts) = object_patches(object, grid, policy, &mut welder);
            for patch in &patches {
                batch
                    .corners
                    .extend(patch.corners.iter().map(|&c| welder.points[c as usize]));
                batch.ends.push(batch.corners.len());
                batch.planes.push(patch.plane);
                batch.occludes.push(patch.occludes);
            }
            batch.objects.push((patches.len(), counts));
        }
        batch.squared_movement = welder.squared_movement;
        batch
    }
}

/// All steps for one object.
fn object_patches(
    object: &ObjectInput,
    grid: &Grid,
    policy: &OccluderPolicy,
    welder: &mut snap::Welder,
) -> (Vec<Patch>, RepairCounts) {
    let mut counts = RepairCounts::default();
    let mut patches = Vec::new();
    let mut corners = Vec::new();
    for part in &object.parts {
        let occludes = policy.occludes(part.class.as_deref(), part.translucent);
        for face in part.faces.iter() {
            corners.clear();
            corners.extend(
                face.iter()
                    .map(|&i| welder.weld(grid, part.vertices[i as usize])),
            );
            match clean::clean(&welder.points, &corners, occludes, &mut patches) {
                Cleaned::Kept => {}
                Cleaned::Degenerate => counts.degenerate += 1,
                Cleaned::Triangulated => counts.triangulated += 1,
            }
        }
    }
    if patches.len() < 2 {
        return (patches, counts);
    }
    counts.duplicate = drop_duplicates(&mut patches);
    let sealed = seal::seal(&welder.points, &mut patches);
    counts.inserted = sealed.vertices;
    counts.sealing = sealed.triangles;
    let (merged, covered) = merge::merge(&welder.points, patches);
    counts.covered = covered;
    (merged, counts)
}

/// Drops patches with the corners of an earlier one; of equal ones, one that occludes is kept.
/// Returns how many were dropped.
fn drop_duplicates(patches: &mut Vec<Patch>) -> usize {
    if all_differ(patches) {
        return 0;
    }
    let sorted: Vec<Vec<u32>> = patches
        .iter()
        .map(|patch| {
            // Strictly convex polygons with the same corners are the same polygon.
            let mut corners = patch.corners.clone();
            corners.sort_unstable();
            corners
        })
        .collect();
    let mut order: Vec<usize> = (0..patches.len()).collect();
    order.sort_unstable_by(|&i, &j| {
        let key = |k: usize| (&sorted[k], !patches[k].occludes, k);
        key(i).cmp(&key(j))
    });
    let mut keep = vec![true; patches.len()];
    for pair in order
        .windows(2)
        .filter(|pair| sorted[pair[0]] == sorted[pair[1]])
    {
        keep[pair[1]] = false;
    }
    let before = patches.len();
    let mut keep = keep.into_iter();
    patches.retain(|_| keep.next().unwrap_or(true));
    before - patches.len()
}

/// A quick test: different sums of corners mean different corners.
fn all_differ(patches: &[Patch]) -> bool {
    let mut sums: Vec<u64> = patches
        .iter()
        .map(|patch| patch.corners.iter().map(|&c| u64::from(c).pow(2)).sum())
        .collect();
    sums.sort_unstable();
    sums.windows(2).all(|w| w[0] != w[1])
}

/// Puts the batches into one arena and builds the kD-tree over it.
fn assemble(
    input: &SceneInput,
    grid: Grid,
    heuristic: KdHeuristic,
    batches: Vec<Batch>,
) -> Result<(Scene, BuildReport), BuildError> {
    let corner_count = batches.iter().map(|b| b.corners.len()).sum::<usize>();
    if u32::try_from(corner_count).is_err() {
        return Err(BuildError::TooLarge {
            scene: input.source_name.clone(),
            corners: corner_count,
        });
    }
    let polygon_count = batches.iter().map(|b| b.planes.len()).sum();
    let mut report = BuildReport {
        grid_step: grid.step(),
        objects: input.objects.len(),
        polygons: polygon_count,
        ..BuildReport::default()
    };
    let mut objects = Vec::with_capacity(input.objects.len());
    let mut corners = Vec::with_capacity(corner_count);
    let mut first = Vec::with_capacity(polygon_count + 1);
    let mut planes = Vec::with_capacity(polygon_count);
    let mut owners = Vec::with_capacity(polygon_count);
    let mut occludes = Vec::with_capacity(polygon_count);
    let mut squared_movement = 0.0_f64;
    for batch in batches {
        first.extend(batch.ends.iter().scan(0, |start, &end| {
            let here = corners.len() + *start;
            *start = end;
            Some(here as u32)
        }));
        corners.extend(batch.corners);
        planes.extend(batch.planes);
        occludes.extend(batch.occludes);
        squared_movement = squared_movement.max(batch.squared_movement);
        for (count, counts) in batch.objects {
            let id = ObjectId(objects.len() as u32);
            let given = &input.objects[id.index()];
            let name = given.name.clone().unwrap_or_else(|| id.0.to_string());
            if !counts.is_empty() {
                report.repairs.push(ObjectRepairs {
                    object: id,
                    name: name.clone(),
                    counts,
                });
            }
            let start = owners.len() as u32;
            owners.resize(owners.len() + count, id);
            let class = given.parts.first().and_then(|part| part.class.clone());
            objects.push(Object {
                name,
                class,
                polygons: start..owners.len() as u32,
            });
        }
    }
    first.push(corners.len() as u32);
    report.occluders = occludes.iter().filter(|o| **o).count();
    report.largest_movement = squared_movement.sqrt();
    let boxes: Vec<Aabb> = first
        .windows(2)
        .map(|w| {
            let polygon = &corners[w[0] as usize..w[1] as usize];
            polygon[1..].iter().fold(
                Aabb {
                    min: polygon[0],
                    max: polygon[0],
                },
                |b, &p| b.with(p),
            )
        })
        .collect();
    let shape = |i: u32| {
        let i = i as usize;
        Some(Shape {
            corners: &corners[first[i] as usize..first[i + 1] as usize],
            plane: &planes[i],
        })
    };
    let kd = KdTree::build(&boxes, shape, heuristic);
    let bounds = kd.bounds();
    Ok((
        Scene {
            grid,
            objects,
            corners,
            first,
            planes,
            owners,
            occludes,
            bounds,
            kd,
        },
        report,
    ))
}
