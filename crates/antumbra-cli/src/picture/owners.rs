//! An item buffer in which coincident surfaces share their pixels.

use super::camera::Camera;
use super::raster::scan;
use super::vector::{V3, area_vector, dot, sub};

/// Surfaces whose nearness differs by less than this share coincide; far more than rounding, far less
/// than any gap of a model.
const SAME: f64 = 1e-9;

/// First all that hides is drawn, then whoever is as near as what was drawn gets the pixel.
pub(crate) struct PixelOwners {
    size: [usize; 2],
    camera: Camera,
    eye: V3,
    axes: [V3; 3],
    /// Half width and half height at distance one.
    half: [f64; 2],
    keys: Vec<f64>,
}

impl PixelOwners {
    /// A view from an eye; `half` is half its width and height at distance one.
    pub(crate) fn new(size: [usize; 2], eye: V3, axes: [V3; 3], half: [f64; 2]) -> Self {
        let [w, h] = size.map(|n| n as f64);
        Self {
            size,
            camera: Camera::at(eye, axes, h / 2.0 / half[1], [w / 2.0, h / 2.0]),
            eye,
            axes,
            half,
            keys: vec![f64::NEG_INFINITY; size[0] * size[1]],
        }
    }

    /// Draws a convex polygon that hides what is behind it.
    pub(crate) fn draw(&mut self, corners: &[V3]) {
        let key = self.nearness(corners);
        let (width, keys) = (self.size[0], &mut self.keys);
        scan(self.size, &self.camera, corners, |i, _| {
            keys[i] = keys[i].max(key(i % width, i / width));
        });
    }

    /// Calls `owner` with column and row of each pixel that shows a polygon, some of them twice.
    pub(crate) fn credit(&self, corners: &[V3], mut owner: impl FnMut([u32; 2])) {
        let key = self.nearness(corners);
        let width = self.size[0];
        scan(self.size, &self.camera, corners, |i, _| {
            let nearest = self.keys[i];
            let key = key(i % width, i / width);
            if key >= nearest - SAME * nearest.abs() || nearest == f64::NEG_INFINITY {
                owner([(i % width) as u32, (i / width) as u32]);
            }
        });
    }

    /// How near a polygon is in each pixel: from its plane, not from its projected corners, which may
    /// be so far outside the picture that their digits do not suffice.
    fn nearness(&self, corners: &[V3]) -> impl Fn(usize, usize) -> f64 + use<> {
        let normal = area_vector(corners);
        let distance = dot(normal, sub(corners[0], self.eye));
        let [right, up, forward] = self.axes.map(|axis| dot(normal, axis) / distance);
        let [w, h] = self.size.map(|n| n as f64);
        let [x, y] = [self.half[0] * right, self.half[1] * up];
        move |column, row| {
            let s = (2.0 * column as f64 + 1.0) / w - 1.0;
            let t = 1.0 - (2.0 * row as f64 + 1.0) / h;
            forward + s * x + t * y
        }
    }
}

#[cfg(test)]
mod tests {
    use super::PixelOwners;

    #[test]
    fn coincident_surfaces_share_and_hidden_ones_get_nothing() {
        let axes = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
        let mut pixels = PixelOwners::new([32, 32], [0.0; 3], axes, [1.0, 1.0]);
        let square = |x: f64, s: f64| [[x, -s, -s], [x, s, -s], [x, s, s], [x, -s, s]];
        let count = |pixels: &PixelOwners, x, s| {
            // A pixel on the diagonal comes twice.
            let mut seen = std::collections::BTreeSet::new();
            pixels.credit(&square(x, s), |at| {
                seen.insert(at);
            });
            seen.len()
        };
        assert_eq!(count(&pixels, 2.0, 1.0), 256, "nothing hides anything yet");
        pixels.draw(&square(2.0, 1.0));
        assert_eq!(count(&pixels, 2.0, 1.0), 256);
        assert_eq!(count(&pixels, 2.0, 0.5), 64, "coincident");
        assert_eq!(count(&pixels, 3.0, 1.0), 0, "behind");
        assert_eq!(count(&pixels, 4.0, 4.0), 1024 - 256, "around");
    }
}
