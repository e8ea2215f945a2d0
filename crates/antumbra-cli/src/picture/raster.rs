//! A z-buffer: for each pixel the nearest polygon.

use super::camera::Camera;
use super::vector::{V3, clip};

/// No polygon.
pub(super) const NONE: u32 = u32::MAX;

/// Calls `paint` with index and nearness of each pixel whose middle a convex polygon covers.
pub(super) fn scan(
    size: [usize; 2],
    camera: &Camera,
    corners: &[V3],
    mut paint: impl FnMut(usize, f64),
) {
    let in_front = clip(corners, |p| camera.in_front(p));
    if in_front.len() < 3 {
        return;
    }
    let points: Vec<V3> = in_front.into_iter().map(|p| camera.project(p)).collect();
    for pair in points[1..].windows(2) {
        triangle(size, [points[0], pair[0], pair[1]], &mut paint);
    }
}

fn triangle([width, height]: [usize; 2], [a, b, c]: [V3; 3], paint: &mut impl FnMut(usize, f64)) {
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area.abs() < 1e-12 {
        return;
    }
    // The nearness is an affine function of the pixel.
    let kx = ((b[2] - a[2]) * (c[1] - a[1]) - (c[2] - a[2]) * (b[1] - a[1])) / area;
    let ky = ((c[2] - a[2]) * (b[0] - a[0]) - (b[2] - a[2]) * (c[0] - a[0])) / area;
    // Pixels whose middles lie between two coordinates.
    let pixels = |low: f64, high: f64, n: usize| {
        let end = (high - 0.5).floor() + 1.0;
        ((low - 0.5).ceil().clamp(0.0, n as f64) as usize)..(end.clamp(0.0, n as f64) as usize)
    };
    let low = a[1].min(b[1]).min(c[1]);
    let high = a[1].max(b[1]).max(c[1]);
    for row in pixels(low, high, height) {
        let y = row as f64 + 0.5;
        let (mut left, mut right) = (f64::MAX, f64::MIN);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if (p[1] <= y) != (q[1] <= y) {
                let x = p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
                left = left.min(x);
                right = right.max(x);
            }
        }
        for column in pixels(left, right, width) {
            let x = column as f64 + 0.5;
            paint(
                row * width + column,
                a[2] + kx * (x - a[0]) + ky * (y - a[1]),
            );
        }
    }
}

/// For each pixel, the nearest polygon and how near it is.
pub(super) struct ItemBuffer {
    pub size: [usize; 2],
    pub items: Vec<u32>,
    pub keys: Vec<f64>,
}

impl ItemBuffer {
    pub(super) fn new(size: [usize; 2]) -> Self {
        let n = size[0] * size[1];
        Self {
            size,
            items: vec![NONE; n],
            keys: vec![f64::NEG_INFINITY; n],
        }
    }

    /// Draws a convex polygon. What is equally near stays, so that coplanar polygons do not flicker.
    pub(super) fn draw(&mut self, camera: &Camera, corners: &[V3], item: u32) {
        scan(self.size, camera, corners, |i, key| {
            if is_nearer(key, self.keys[i]) {
                self.keys[i] = key;
                self.items[i] = item;
            }
        });
    }
}

/// Whether a key is nearer than another by more than rounding.
pub(super) fn is_nearer(key: f64, than: f64) -> bool {
    key > than + 1e-7 * key.abs()
}

#[cfg(test)]
mod tests {
    use super::{Camera, ItemBuffer};

    #[test]
    fn the_nearest_polygon_wins_and_pixels_are_covered_once() {
        let camera = Camera::top([0.0, 10.0], 1.0, [0.0, 0.0]);
        let mut buffer = ItemBuffer::new([10, 10]);
        let square = |z: f64, s: f64| [[0.0, 0.0, z], [s, 0.0, z], [s, s, z], [0.0, s, z]];
        buffer.draw(&camera, &square(2.0, 4.0), 1);
        buffer.draw(&camera, &square(1.0, 6.0), 2);
        let count = |item| buffer.items.iter().filter(|i| **i == item).count();
        assert_eq!((count(1), count(2)), (16, 20));
        // The origin is at the lower left.
        assert_eq!(buffer.items[90], 1);
    }
}
