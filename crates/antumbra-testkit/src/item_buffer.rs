//! A picture whose pixels hold owners: what is seen first, and whoever coincides with it.

use std::collections::BTreeMap;

use crate::ray_caster::RayCaster;

/// A pinhole camera in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands.
    pub eye: [f64; 3],
    /// The point in the middle of the picture.
    pub toward: [f64; 3],
    /// A direction that is up in the picture; need not be orthogonal.
    pub up: [f64; 3],
    /// The full vertical angle in degrees.
    pub angle: f64,
    /// Width and height in pixels.
    pub size: [usize; 2],
}

impl Camera {
    /// The direction through the middle of a pixel, not of length one.
    #[must_use]
    pub fn through(&self, column: usize, row: usize) -> [f64; 3] {
        Rays::of(self).through(column, row)
    }
}

/// For each pixel the owners seen through its middle, sorted; row by row from the top.
#[derive(Clone, Debug)]
pub struct ItemBuffer {
    size: [usize; 2],
    owners: Vec<Vec<u32>>,
}

impl ItemBuffer {
    /// Shoots one ray through the middle of each pixel.
    ///
    /// Surfaces within `tolerance` (relative to the distance) behind the first one count as
    /// coincident with it: each owner gets the pixel.
    #[must_use]
    pub fn render(caster: &RayCaster, camera: &Camera, tolerance: f64) -> Self {
        let rays = Rays::of(camera);
        let [width, height] = camera.size;
        let seen = |i: usize| {
            let direction = rays.through(i % width, i / width);
            let hits = caster.hits(camera.eye, direction, (0.0, f64::INFINITY));
            let Some(first) = hits.first() else {
                return Vec::new();
            };
            let limit = first.t * (1.0 + tolerance);
            let mut owners: Vec<u32> = hits
                .iter()
                .take_while(|h| h.t <= limit)
                .map(|h| h.owner)
                .collect();
            owners.sort_unstable();
            owners.dedup();
            owners
        };
        Self {
            size: camera.size,
            owners: (0..width * height).map(seen).collect(),
        }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The owners of a pixel; none if it shows the background.
    ///
    /// # Panics
    /// If there is no such pixel.
    #[must_use]
    pub fn pixel(&self, column: usize, row: usize) -> &[u32] {
        &self.owners[row * self.size[0] + column]
    }

    /// How many pixels each owner has; a pixel with several owners counts for each of them.
    #[must_use]
    pub fn counts(&self) -> BTreeMap<u32, usize> {
        let mut counts = BTreeMap::new();
        for owner in self.owners.iter().flatten() {
            *counts.entry(*owner).or_insert(0) += 1;
        }
        counts
    }
}

struct Rays {
    corner: [f64; 3],
    right: [f64; 3],
    down: [f64; 3],
}

impl Rays {
    fn of(camera: &Camera) -> Self {
        let forward = normalized(std::array::from_fn(|k| camera.toward[k] - camera.eye[k]));
        let right = normalized(cross(forward, camera.up));
        let down = cross(forward, right);
        let [width, height] = camera.size.map(|n| n as f64);
        let pixel = 2.0 * (camera.angle.to_radians() / 2.0).tan() / height;
        let corner = std::array::from_fn(|k| {
            forward[k]
                - pixel * (width - 1.0) / 2.0 * right[k]
                - pixel * (height - 1.0) / 2.0 * down[k]
        });
        Self {
            corner,
            right: right.map(|c| c * pixel),
            down: down.map(|c| c * pixel),
        }
    }

    fn through(&self, column: usize, row: usize) -> [f64; 3] {
        let (x, y) = (column as f64, row as f64);
        std::array::from_fn(|k| self.corner[k] + x * self.right[k] + y * self.down[k])
    }
}

fn cross(u: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]
}

fn normalized(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
    v.map(|c| c / length)
}

#[cfg(test)]
mod tests {
    use super::{Camera, ItemBuffer};
    use crate::ray_caster::{RayCaster, Triangle};

    #[test]
    fn halves_go_to_their_owners_and_coincident_surfaces_share() {
        // Left half near, right half twice: two owners in one place.
        let quad = |x0: f64, x1: f64, y: f64, owner: u32| {
            let (a, b, c, d) = ([x0, y, -9.0], [x1, y, -9.0], [x1, y, 9.0], [x0, y, 9.0]);
            [[a, b, c], [a, c, d]].map(|corners| Triangle { corners, owner })
        };
        let mut triangles = Vec::new();
        for (x0, x1, y, owner) in [
            (-9.0, 0.0, 5.0, 7),
            (0.0, 9.0, 6.0, 1),
            (0.0, 9.0, 6.0, 2),
            (-9.0, 9.0, 8.0, 3),
        ] {
            triangles.extend(quad(x0, x1, y, owner));
        }
        let camera = Camera {
            eye: [0.0; 3],
            toward: [0.0, 1.0, 0.0],
            up: [0.0, 0.0, 1.0],
            angle: 60.0,
            size: [40, 30],
        };
        let buffer = ItemBuffer::render(&RayCaster::new(triangles), &camera, 1e-9);
        assert_eq!(buffer.pixel(0, 0), [7]);
        assert_eq!(buffer.pixel(39, 29), [1, 2]);
        let counts = buffer.counts();
        assert_eq!((counts.get(&7), counts.get(&1)), (Some(&600), Some(&600)));
        assert_eq!((counts.get(&2), counts.get(&3)), (Some(&600), None));
        assert_eq!(buffer.size(), [40, 30]);
    }
}
