//! The camera of a frame.

/// A perspective camera in scene units, z up. Its frustum is the four side planes: there is no near
/// and no far plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: [f64; 3],
    /// Right, up and forward, orthonormal up to rounding.
    axes: [[f64; 3]; 3],
    /// Half width and half height of the view at distance one.
    half: [f64; 2],
}

/// Why some numbers are no camera.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// A number is NaN or infinite.
    #[error("the camera's {what} is not finite; check the numbers that come from the application")]
    NotFinite {
        /// Which one.
        what: &'static str,
    },
    /// The direction has no length.
    #[error("the camera looks nowhere: its direction is zero")]
    NoDirection,
    /// Up has no length, or is along the direction.
    #[error("the camera's up direction is zero or along its line of sight; choose another one")]
    NoUp,
    /// Not an angle of a pyramid.
    #[error(
        "a view {degrees} degrees high is no pyramid to compute with; choose an angle above 0.000001 and below 179.999999"
    )]
    NoAngle {
        /// What was given.
        degrees: f64,
    },
    /// Not a ratio.
    #[error("an aspect of {aspect} is not a positive width over height")]
    NoAspect {
        /// What was given.
        aspect: f64,
    },
}

impl Camera {
    /// A camera from where it is, a direction and an up direction (neither need be unit, nor need
    /// they be orthogonal), the full vertical angle in degrees, and width over height.
    ///
    /// # Errors
    /// If the numbers do not make a camera. Every camera that was made gives an answer.
    pub fn new(
        eye: [f64; 3],
        direction: [f64; 3],
        up: [f64; 3],
        fovy_degrees: f64,
        aspect: f64,
    ) -> Result<Self, CameraError> {
        for (what, v) in [("eye", eye), ("direction", direction), ("up", up)] {
            if v.iter().any(|c| !c.is_finite()) {
                return Err(CameraError::NotFinite { what });
            }
        }
        for (what, n) in [("angle", fovy_degrees), ("aspect", aspect)] {
            if !n.is_finite() {
                return Err(CameraError::NotFinite { what });
            }
        }
        let forward = unit(direction).ok_or(CameraError::NoDirection)?;
        let up = unit(up).ok_or(CameraError::NoUp)?;
        let right = cross(forward, up);
        if right.iter().map(|c| c * c).sum::<f64>() < 1e-18 {
            return Err(CameraError::NoUp);
        }
        let right = unit(right).ok_or(CameraError::NoUp)?;
        let tangent = (fovy_degrees.to_radians() / 2.0).tan();
        let angle = fovy_degrees > 0.0 && fovy_degrees < 180.0;
        // Bounded so that the edges of the frustum stay directions with usable digits.
        if !angle || !(1e-9..=1e9).contains(&tangent) {
            return Err(CameraError::NoAngle {
                degrees: fovy_degrees,
            });
        }
        let width = tangent * aspect;
        if !(1e-9..=1e9).contains(&width) {
            return Err(CameraError::NoAspect { aspect });
        }
        Ok(Self {
            eye,
            axes: [right, cross(right, forward), forward],
            half: [width, tangent],
        })
    }

    /// Where the camera is.
    #[must_use]
    pub fn eye(&self) -> [f64; 3] {
        self.eye
    }

    /// Right, up and forward.
    #[must_use]
    pub fn axes(&self) -> [[f64; 3]; 3] {
        self.axes
    }

    /// Half width and half height of the view at distance one.
    #[must_use]
    pub fn half_extents(&self) -> [f64; 2] {
        self.half
    }

    /// The edges of the frustum, in order around it: neighbors' products point inward.
    pub(super) fn edges(&self) -> [[f64; 3]; 4] {
        let [right, up, forward] = self.axes;
        let [w, h] = self.half;
        [(-w, -h), (-w, h), (w, h), (w, -h)]
            .map(|(x, y)| std::array::from_fn(|k| forward[k] + x * right[k] + y * up[k]))
    }
}

/// The direction of a vector; none if it has no length. Scaled first, so that nothing overflows.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let largest = v.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if largest == 0.0 {
        return None;
    }
    let v = v.map(|c| c / largest);
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    Some(v.map(|c| c / length))
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::{Camera, CameraError};

    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];

    #[test]
    fn numbers_that_are_no_camera_are_refused_by_name() {
        let make = |eye, direction, up, fov, aspect| Camera::new(eye, direction, up, fov, aspect);
        assert_eq!(
            make([f64::NAN, 0.0, 0.0], X, Z, 60.0, 1.0),
            Err(CameraError::NotFinite { what: "eye" })
        );
        let infinite = [f64::INFINITY, 0.0, 0.0];
        assert_eq!(
            make([0.0; 3], infinite, Z, 60.0, 1.0),
            Err(CameraError::NotFinite { what: "direction" })
        );
        assert_eq!(
            make([0.0; 3], X, Z, f64::NAN, 1.0),
            Err(CameraError::NotFinite { what: "angle" })
        );
        assert_eq!(
            make([0.0; 3], [0.0; 3], Z, 60.0, 1.0),
            Err(CameraError::NoDirection)
        );
        assert_eq!(
            make([0.0; 3], X, [0.0; 3], 60.0, 1.0),
            Err(CameraError::NoUp)
        );
        assert_eq!(make([0.0; 3], X, X, 60.0, 1.0), Err(CameraError::NoUp));
        for degrees in [0.0, -5.0, 180.0, 200.0, 1e-300] {
            assert_eq!(
                make([0.0; 3], X, Z, degrees, 1.0),
                Err(CameraError::NoAngle { degrees })
            );
        }
        for aspect in [0.0, -1.0, 1e300] {
            assert_eq!(
                make([0.0; 3], X, Z, 60.0, aspect),
                Err(CameraError::NoAspect { aspect })
            );
        }
    }

    #[test]
    fn axes_are_orthonormal_whatever_the_lengths() {
        let camera = Camera::new(
            [0.0; 3],
            [1e200, 2e200, 0.0],
            [0.0, 1e-200, 5e-200],
            60.0,
            1.5,
        )
        .expect("a camera");
        let axes = camera.axes();
        for i in 0..3 {
            for j in 0..3 {
                let dot: f64 = (0..3).map(|k| axes[i][k] * axes[j][k]).sum();
                assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }
}
