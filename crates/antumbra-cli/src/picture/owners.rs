//! An item buffer in which coincident surfaces share their pixels.

use super::camera::Camera;
use super::raster::scan;
use super::vector::{V3, area_vector, dot, sub};

/// Surfaces whose nearness differs by less than this share coincide; far more than rounding, far less
/// than any gap of a model.
const SAME: f64 = 1e-9;

/// Planes whose coefficients differ by less than this share coincide: two that only cross where a pixel
/// looks do not share it.
const COPLANAR: f64 = 1e-6;

/// First all that hides is drawn, then whoever lies on the surface that was drawn gets the pixel.
pub(crate) struct PixelOwners {
    size: [usize; 2],
    camera: Camera,
    eye: V3,
    axes: [V3; 3],
    /// Half width and half height at distance one.
    half: [f64; 2],
    keys: Vec<f64>,
    /// The number of the plane that was drawn.
    drawn: Vec<u32>,
    planes: Vec<V3>,
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
            drawn: vec![0; size[0] * size[1]],
            planes: Vec::new(),
        }
    }

    /// Draws a convex polygon that hides what is behind it.
    pub(crate) fn draw(&mut self, corners: &[V3]) {
        let plane = self.plane(corners);
        let key = self.nearness(plane);
        let number = self.planes.len() as u32;
        self.planes.push(plane);
        let (width, keys, drawn) = (self.size[0], &mut self.keys, &mut self.drawn);
        scan(self.size, &self.camera, corners, |i, _| {
            let key = key(i % width, i / width);
            if key > keys[i] {
                keys[i] = key;
                drawn[i] = number;
            }
        });
    }

    /// Calls `owner` with column and row of each pixel that shows a polygon, some of them twice.
    pub(crate) fn credit(&self, corners: &[V3], mut owner: impl FnMut([u32; 2])) {
        let plane = self.plane(corners);
        let key = self.nearness(plane);
        let width = self.size[0];
        scan(self.size, &self.camera, corners, |i, _| {
            let nearest = self.keys[i];
            let key = key(i % width, i / width);
            let shown = nearest == f64::NEG_INFINITY
                || key > nearest + SAME * nearest.abs()
                || key >= nearest - SAME * nearest.abs()
                    && coplanar(plane, self.planes[self.drawn[i] as usize]);
            if shown {
                owner([(i % width) as u32, (i / width) as u32]);
            }
        });
    }

    /// The plane of a polygon: how near it is to the right, above and straight ahead.
    fn plane(&self, corners: &[V3]) -> V3 {
        let normal = area_vector(corners);
        let distance = dot(normal, sub(corners[0], self.eye));
        self.axes.map(|axis| dot(normal, axis) / distance)
    }

    /// How near a polygon is in each pixel: from its plane, not from its projected corners, which may
    /// be so far outside the picture that their digits do not suffice.
    fn nearness(&self, [right, up, forward]: V3) -> impl Fn(usize, usize) -> f64 + use<> {
        let [w, h] = self.size.map(|n| n as f64);
        let [x, y] = [self.half[0] * right, self.half[1] * up];
        move |column, row| {
            let s = (2.0 * column as f64 + 1.0) / w - 1.0;
            let t = 1.0 - (2.0 * row as f64 + 1.0) / h;
            forward + s * x + t * y
        }
    }
}

fn coplanar(a: V3, b: V3) -> bool {
    let size = a.iter().fold(0.0_f64, |size, c| size.max(c.abs()));
    (0..3).all(|k| (a[k] - b[k]).abs() <= COPLANAR * size)
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

    #[test]
    fn what_only_touches_from_behind_gets_nothing() {
        let axes = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
        // An odd number of rows: the middle one looks along z = 0.
        let mut pixels = PixelOwners::new([33, 33], [0.0; 3], axes, [1.0, 1.0]);
        pixels.draw(&[
            [2.0, -1.0, -1.0],
            [2.0, 1.0, -1.0],
            [2.0, 1.0, 1.0],
            [2.0, -1.0, 1.0],
        ]);
        let fin = [[2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [3.0, 0.0, 0.5]];
        let mut seen = 0;
        pixels.credit(&fin, |_| seen += 1);
        assert_eq!(seen, 0);
    }
}
