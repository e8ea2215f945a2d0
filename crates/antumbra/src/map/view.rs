//! Where a map is seen from: a point and all its directions, a frustum, or parallel lines.

use antumbra_kernel::{Plane, Point, SnapError};
use antumbra_lines::ExactRay;
use antumbra_scene::{PolygonId, Scene};
use antumbra_sweep::occlusion::{
    ParallelView, PointView, Sweep, Twins, View, sweep, sweep_in_order,
};

use super::{MapOptions, VisibilityMap, build};

/// A view.
#[derive(Clone, Debug, PartialEq)]
pub enum Viewpoint {
    /// All directions from a point in scene units.
    Sphere([f64; 3]),
    /// The directions within a pyramid.
    Frustum {
        /// The viewpoint in scene units.
        eye: [f64; 3],
        /// The directions of the pyramid's edges, in order around it; of any length. They are
        /// rounded to 2^-20 of the longest component.
        edges: Vec<[f64; 3]>,
    },
    /// All lines of one direction, from before the scene.
    Parallel {
        /// Where the lines go. Rounded to a direction of integers below 1024 close to it.
        direction: [f64; 3],
    },
}

impl Viewpoint {
    /// A perspective camera: where it is, what it looks at, what is up, the full vertical angle in
    /// radians, and width over height.
    ///
    /// # Errors
    /// If the numbers do not make a camera.
    pub fn camera(
        eye: [f64; 3],
        toward: [f64; 3],
        up: [f64; 3],
        angle: f64,
        aspect: f64,
    ) -> Result<Self, MapError> {
        let [right, top, forward] = camera_axes(eye, toward, up)?;
        let fits = angle > 0.0 && angle < std::f64::consts::PI && aspect > 0.0;
        if !fits || !aspect.is_finite() {
            return Err(MapError::NoAngle {
                degrees: angle.to_degrees(),
            });
        }
        let h = (angle / 2.0).tan();
        let w = h * aspect;
        let edge = |x: f64, y: f64| std::array::from_fn(|k| forward[k] + x * right[k] + y * top[k]);
        // Seen from the eye these turn so that neighbors' products point inward.
        let edges = vec![edge(-w, -h), edge(-w, h), edge(w, h), edge(w, -h)];
        Ok(Self::Frustum { eye, edges })
    }
}

/// Right, up and forward of a camera, orthonormal.
///
/// # Errors
/// If two of the points coincide, or up is along the line of sight.
pub fn camera_axes(
    eye: [f64; 3],
    toward: [f64; 3],
    up: [f64; 3],
) -> Result<[[f64; 3]; 3], MapError> {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        (length > 0.0 && length.is_finite()).then(|| v.map(|c| c / length))
    };
    let forward = unit(std::array::from_fn(|k| toward[k] - eye[k]));
    let forward = forward.ok_or(MapError::NoDirection)?;
    let up = unit(up).ok_or(MapError::NoUp)?;
    let right = cross(forward, up);
    if right.iter().map(|c| c * c).sum::<f64>() < 1e-18 {
        return Err(MapError::NoUp);
    }
    let right = unit(right).ok_or(MapError::NoUp)?;
    Ok([right, cross(right, forward), forward])
}

/// Why there is no map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MapError {
    /// The viewpoint is not finite, or off the grid.
    #[error("the viewpoint cannot be used: {0}")]
    Snap(SnapError),
    /// Nothing to look along.
    #[error(
        "the view has no direction: the viewpoint and what it looks at must be different points, no farther apart than 1e150"
    )]
    NoDirection,
    /// Up is zero or along the line of sight.
    #[error("the view's up direction is zero or along the line of sight; choose another one")]
    NoUp,
    /// The angle of a camera, or its aspect.
    #[error(
        "a view {degrees} degrees high is not a pyramid; choose an angle between 0 and 180 and a positive aspect"
    )]
    NoAngle {
        /// What was given.
        degrees: f64,
    },
    /// The edges of a frustum.
    #[error("the directions of the frustum's edges do not bound a convex pyramid with an inside")]
    NoInside,
    /// Two neighboring corners of an area light are one point.
    #[error(
        "the light has no area on the grid: neighboring corners must be different points; move them apart or refine the grid"
    )]
    NoLight,
    /// The corners of an area light do not go round a convex quadrangle.
    #[error(
        "the corners of the light do not go round a convex quadrangle; give them in order around it"
    )]
    CrossedLight,
}

/// What a finished map remembers of its view.
#[derive(Clone, Copy, Debug)]
pub(super) enum Seen {
    Point(Point),
    /// The direction.
    Parallel([i32; 3]),
}

impl Seen {
    pub(super) fn eye(&self) -> Option<Point> {
        match self {
            Self::Point(eye) => Some(*eye),
            Self::Parallel(_) => None,
        }
    }

    /// A point of a parallel line in grid steps, by its ray.
    pub(super) fn on_line(direction: [i32; 3], ray: [f64; 3]) -> [f64; 3] {
        let a = main_axis(direction);
        let d = f64::from(direction[a]);
        let mut p = [0.0; 3];
        p[(a + 1) % 3] = ray[0] / ray[2] / d;
        p[(a + 2) % 3] = ray[1] / ray[2] / d;
        p
    }

    /// Where a line meets a plane, in scene units.
    pub(super) fn meet(&self, scene: &Scene, ray: &ExactRay, plane: &Plane) -> [f64; 3] {
        let d = match *self {
            Self::Point(eye) => return scene.grid().to_scene_f64(meet_from(eye, ray, plane)),
            Self::Parallel(d) => d,
        };
        let from = Self::on_line(d, ray.to_f64());
        let n = plane.normal.map(|c| c as f64);
        let dot = |v: [f64; 3]| n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
        let along = d.map(f64::from);
        let t = (plane.offset as f64 - dot(from)) / dot(along);
        let p = std::array::from_fn(|k| from[k] + t * along[k]);
        scene.grid().to_scene_f64(p)
    }
}

/// Where a ray from a point meets a plane that does not hold the point, in grid steps. The way
/// there is within a relative error of 2^-50, however flat the ray meets the plane.
pub(crate) fn meet_from(eye: Point, ray: &ExactRay, plane: &Plane) -> [f64; 3] {
    let t = -(plane.evaluate(eye) as f64) / ray.dot(plane.normal);
    let (from, along) = (eye.to_f64(), ray.to_f64());
    std::array::from_fn(|k| from[k] + t * along[k])
}

pub(super) fn main_axis(direction: [i32; 3]) -> usize {
    let longest = (0..3).max_by_key(|&k| (direction[k].abs(), 2 - k));
    longest.unwrap_or_default()
}

/// The map of a view; over some polygons in an order, or over the whole scene by a sweep.
pub(super) fn map(
    scene: &Scene,
    twins: &Twins,
    viewpoint: &Viewpoint,
    options: &MapOptions,
    order: Option<&[PolygonId]>,
) -> Result<VisibilityMap, MapError> {
    let snap = |eye: &[f64; 3]| scene.grid().snap(*eye).map_err(MapError::Snap);
    match viewpoint {
        Viewpoint::Sphere(eye) => {
            let eye = snap(eye)?;
            let swept = swept(scene, twins, PointView::sphere(eye), options, order);
            Ok(build::build(scene, twins, swept, Seen::Point(eye), options))
        }
        Viewpoint::Frustum { eye, edges } => {
            let eye = snap(eye)?;
            let edges: Vec<[i64; 3]> = edges.iter().map(rounded).collect();
            let view = PointView::frustum(eye, &edges).ok_or(MapError::NoInside)?;
            let swept = swept(scene, twins, view, options, order);
            Ok(build::build(scene, twins, swept, Seen::Point(eye), options))
        }
        Viewpoint::Parallel { direction } => {
            let direction = small_direction(direction).ok_or(MapError::NoDirection)?;
            let view = ParallelView::new(direction, &scene.bounds());
            let view = view.ok_or(MapError::NoDirection)?;
            let swept = swept(scene, twins, view, options, order);
            let seen = Seen::Parallel(direction);
            Ok(build::build(scene, twins, swept, seen, options))
        }
    }
}

fn swept<V: View>(
    scene: &Scene,
    twins: &Twins,
    view: V,
    options: &MapOptions,
    order: Option<&[PolygonId]>,
) -> Sweep<V> {
    match order {
        Some(order) => sweep_in_order(scene, view, order),
        None => sweep(scene, twins, view, &options.sweep),
    }
}

/// A direction in integers, the longest component 2^20.
fn rounded(v: &[f64; 3]) -> [i64; 3] {
    let longest = v.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    v.map(|c| {
        let scaled = c / longest * f64::from(1 << 20);
        // Not a number becomes zero, and such a frustum has no inside.
        scaled.round() as i64
    })
}

/// The closest direction of integers below 1024: every length of the longest component is tried.
fn small_direction(v: &[f64; 3]) -> Option<[i32; 3]> {
    let longest = v.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if !(longest > 0.0 && longest.is_finite()) {
        return None;
    }
    let v = v.map(|c| c / longest);
    let error = |n: i32| -> f64 {
        v.iter()
            .map(|c| {
                let scaled = c * f64::from(n);
                ((scaled - scaled.round()) / f64::from(n)).powi(2)
            })
            .sum()
    };
    let best = (1..ParallelView::LIMIT).min_by(|&m, &n| error(m).total_cmp(&error(n)))?;
    Some(v.map(|c| (c * f64::from(best)).round() as i32))
}
