//! Visibility along one line: the first hit and the maximal free segments, exactly.

use antumbra_kernel::SnapError;
use antumbra_scene::{ObjectId, PolygonId, Scene};
use antumbra_sweep::Caster;

/// Where a segment first meets an occluder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// The object.
    pub object: ObjectId,
    /// The polygon; of coincident ones the smallest.
    pub polygon: PolygonId,
    /// Where, in scene units (rounded).
    pub at: [f64; 3],
}

/// What a segment meets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayAnswer {
    /// The first occluder on the way; touching counts.
    pub hit: Option<RayHit>,
    /// The maximal free parts, in scene units (rounded). None if both ends are one grid point.
    pub free: Vec<[[f64; 3]; 2]>,
}

/// Follows the segment between two points in scene units, both snapped to the grid. The order
/// along the segment is exact.
///
/// # Errors
/// If a point is not finite or off the scene's grid.
pub fn ray(scene: &Scene, from: [f64; 3], to: [f64; 3]) -> Result<RayAnswer, SnapError> {
    let grid = scene.grid();
    let (u, v) = (grid.snap(from)?, grid.snap(to)?);
    let Some(trace) = Caster::new(scene).trace(u, v) else {
        return Ok(RayAnswer::default());
    };
    let (a, b) = (grid.to_scene(u), grid.to_scene(v));
    let at = |t: f64| -> [f64; 3] { std::array::from_fn(|k| a[k] + t * (b[k] - a[k])) };
    let hit = trace.hits.first().map(|h| RayHit {
        object: scene.polygon(h.polygon).object,
        polygon: h.polygon,
        at: at(h.at),
    });
    Ok(RayAnswer {
        hit,
        free: trace.free.iter().map(|&[s, t]| [at(s), at(t)]).collect(),
    })
}
