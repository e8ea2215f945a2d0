//! Placeholder until rays are there.
use antumbra_scene::{ObjectId, PolygonId, Scene};

/// Where a ray ends.
#[derive(Clone, Copy, Debug)]
pub struct RayHit {
    /// The object.
    pub object: ObjectId,
    /// The polygon.
    pub polygon: PolygonId,
    /// Where.
    pub at: [f64; 3],
}

/// The answer.
#[derive(Clone, Debug)]
pub struct RayAnswer {
    /// The first hit.
    pub hit: Option<RayHit>,
    /// Free stretches.
    pub free: Vec<[[f64; 3]; 2]>,
}

/// Placeholder: nothing is hit.
///
/// # Errors
/// Never.
pub fn ray(
    _scene: &Scene,
    from: [f64; 3],
    to: [f64; 3],
) -> Result<RayAnswer, std::convert::Infallible> {
    Ok(RayAnswer {
        hit: None,
        free: vec![[from, to]],
    })
}
