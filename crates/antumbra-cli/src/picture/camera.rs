//! Where the pictures are taken from.

use super::vector::{V3, cross, dot, lerp, sub, unit};

/// A projection to the screen: x to the right, y down, both in pixels, and a key that is larger the
/// nearer a point is. All three are affine along straight lines of the screen.
#[derive(Clone, Debug)]
pub(super) struct Camera {
    eye: V3,
    /// Right, up and forward.
    axes: [V3; 3],
    /// Pixels for each unit at distance one (perspective) or everywhere (parallel).
    scale: f64,
    center: [f64; 2],
    parallel: bool,
    /// How near a point may come.
    near: f64,
}

/// How near a point may come to a perspective camera, as a share of the distance to its target.
const NEAR: f64 = 1e-3;
/// The same in scene units for a given eye, which may be close to a wall: nearer ones are not drawn,
/// since their images are too large for doubles.
const NEAREST: f64 = 1e-6;

impl Camera {
    /// Looks straight down, with y up, one pixel for `1 / scale` units, a point at a place.
    pub(super) fn top(point: [f64; 2], scale: f64, [x, y]: [f64; 2]) -> Self {
        Self {
            eye: [point[0], point[1], 0.0],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
            scale,
            center: [x, y],
            parallel: true,
            near: NEAR,
        }
    }

    /// Looks from a point along the last of three axes (right, up, forward), with a full vertical
    /// angle in radians.
    pub(super) fn looking(eye: V3, axes: [V3; 3], fov: f64, size: [f64; 2]) -> Self {
        let scale = size[1] / 2.0 / (fov / 2.0).tan();
        Self::at(eye, axes, scale, [size[0] / 2.0, size[1] / 2.0])
    }

    /// Looks from an eye along orthonormal axes (right, up, forward), with so many pixels for each unit
    /// at distance one, and a point of the screen straight ahead.
    pub(super) fn at(eye: V3, axes: [V3; 3], scale: f64, center: [f64; 2]) -> Self {
        Self {
            eye,
            axes,
            scale,
            center,
            parallel: false,
            near: NEAREST,
        }
    }

    /// Looks along a direction so that some points just fit the frame; `margin` is the free share.
    pub(super) fn framing(points: &[V3], direction: V3, size: [f64; 2], margin: f64) -> Self {
        let forward = unit(direction);
        let right = unit(cross(forward, [0.0, 0.0, 1.0]));
        let up = cross(right, forward);
        let bound = |k: usize, start: f64, pick: fn(f64, f64) -> f64| {
            points.iter().map(|p| p[k]).fold(start, pick)
        };
        let min: V3 = std::array::from_fn(|k| bound(k, f64::MAX, f64::min));
        let max: V3 = std::array::from_fn(|k| bound(k, f64::MIN, f64::max));
        let middle = lerp(min, max, 0.5);
        // A vertical field of view of 32 degrees keeps verticals nearly parallel.
        let scale = size[1] / 2.0 / 16.0_f64.to_radians().tan();
        let room = [0, 1].map(|k| size[k] / 2.0 * (1.0 - margin) / scale);
        let corners: Vec<V3> = points
            .iter()
            .map(|p| sub(*p, middle))
            .map(|p| [dot(p, right), dot(p, up), dot(p, forward)])
            .collect();
        // The smallest distance at which all points are inside, re-centered a few times because
        // near points spread more than far ones.
        let mut shift = [0.0; 2];
        let mut distance = 0.0_f64;
        for _ in 0..12 {
            distance = 1e-9;
            for p in &corners {
                for k in 0..2 {
                    distance = distance.max((p[k] - shift[k]).abs() / room[k] - p[2]);
                }
            }
            for k in 0..2 {
                let on_screen = |p: &V3| (p[k] - shift[k]) / (distance + p[2]);
                let low = corners.iter().map(on_screen).fold(f64::MAX, f64::min);
                let high = corners.iter().map(on_screen).fold(f64::MIN, f64::max);
                shift[k] += (low + high) / 2.0 * distance;
            }
        }
        let eye = std::array::from_fn(|k| {
            middle[k] + shift[0] * right[k] + shift[1] * up[k] - distance * forward[k]
        });
        Self {
            eye,
            axes: [right, up, forward],
            scale,
            center: [size[0] / 2.0, size[1] / 2.0],
            parallel: false,
            near: NEAR,
        }
    }

    /// The direction from the camera to a point.
    pub(super) fn ray(&self, p: V3) -> V3 {
        if self.parallel {
            self.axes[2]
        } else {
            sub(p, self.eye)
        }
    }

    /// A point's distance along the viewing direction, minus the nearest allowed one.
    pub(super) fn in_front(&self, p: V3) -> f64 {
        if self.parallel {
            1.0
        } else {
            dot(sub(p, self.eye), self.axes[2]) - self.near
        }
    }

    /// The screen position and nearness of a point in front.
    pub(super) fn project(&self, p: V3) -> V3 {
        let q = sub(p, self.eye);
        let [x, y, depth] = self.axes.map(|axis| dot(q, axis));
        let (s, key) = if self.parallel {
            (self.scale, -depth)
        } else {
            (self.scale / depth, 1.0 / depth)
        };
        [self.center[0] + s * x, self.center[1] - s * y, key]
    }
}

#[cfg(test)]
mod tests {
    use super::Camera;

    #[test]
    fn the_points_fill_the_frame() {
        let (min, max) = ([0.0, 0.0, 0.0], [20.0, 10.0, 3.0]);
        let corner =
            |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { max[k] } else { min[k] });
        let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
        let camera = Camera::framing(&corners, [1.0, 2.0, -1.5], [800.0, 500.0], 0.1);
        let mut low = [f64::MAX; 2];
        let mut high = [f64::MIN; 2];
        for p in corners {
            assert!(camera.in_front(p) > 0.0);
            let q = camera.project(p);
            for k in 0..2 {
                low[k] = low[k].min(q[k]);
                high[k] = high[k].max(q[k]);
            }
        }
        assert!(low[0] > 39.0 && high[0] < 761.0 && low[1] > 24.0 && high[1] < 476.0);
        // One of the two directions is used up.
        assert!(low[0] < 45.0 || low[1] < 30.0, "{low:?} {high:?}");
    }
}
