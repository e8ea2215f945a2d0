//! View cells over free space, without being told where it is.
//!
//! People and cameras are where one can stand: above floors, stairs, streets and terrain. So the
//! cells are cubes of a regular grid that contain, or lie directly on a cube that contains, a
//! surface nearer to horizontal than to vertical. Polygons are taken by their boxes. Which side
//! of a surface is solid is not asked, since models are seldom closed.

use antumbra_kernel::{Aabb, Point};

use super::{CellKind, ViewCell};
use crate::{PolygonRef, Scene};

/// No more cells than this.
const MOST: usize = 512;

/// Numbers of cubes along the longest side of the scene, tried in order.
const DIVISIONS: [i64; 19] = [
    64, 54, 46, 39, 33, 28, 24, 20, 17, 14, 12, 10, 8, 6, 5, 4, 3, 2, 1,
];

/// The cells of the finest division that keeps within the limit.
pub(super) fn cells(scene: &Scene) -> Vec<ViewCell> {
    let walkable: Vec<Aabb> = scene
        .polygons()
        .filter(is_walkable)
        .map(|p| p.bounds())
        .collect();
    let longest = scene
        .bounds()
        .extent()
        .into_iter()
        .max()
        .unwrap_or(0)
        .max(1);
    let mut kept = Vec::new();
    for division in DIVISIONS {
        let cubes = Cubes::new(scene.bounds(), (longest + division - 1) / division);
        let marks = if walkable.is_empty() {
            cubes.marked(scene.polygons().map(|p| p.bounds()), 0)
        } else {
            cubes.marked(walkable.iter().copied(), 1)
        };
        kept = cubes.cells(&marks);
        if kept.len() <= MOST {
            break;
        }
    }
    kept
}

/// Whether the normal is within 45 degrees of the vertical; exact.
fn is_walkable(polygon: &PolygonRef<'_>) -> bool {
    let [x, y, z] = polygon.plane.normal.map(|n| i128::from(n) * i128::from(n));
    x + y <= z
}

/// A regular grid of cubes from the minimum of a box.
struct Cubes {
    bounds: Aabb,
    size: i64,
    counts: [usize; 3],
}

impl Cubes {
    fn new(bounds: Aabb, size: i64) -> Self {
        let counts = bounds
            .extent()
            .map(|e| ((e + size - 1) / size).max(1) as usize);
        Self {
            bounds,
            size,
            counts,
        }
    }

    /// Marks the cubes that a box meets, and so many layers above them.
    fn marked(&self, boxes: impl Iterator<Item = Aabb>, above: usize) -> Vec<bool> {
        let mut marks = vec![false; self.counts.iter().product()];
        for b in boxes {
            let [x, y, z] = std::array::from_fn(|k| {
                let from = i64::from(self.bounds.min.to_array()[k]);
                let at = |c: i32| ((i64::from(c) - from) / self.size) as usize;
                let last = self.counts[k] - 1;
                let high = at(b.max.to_array()[k]) + if k == 2 { above } else { 0 };
                (at(b.min.to_array()[k]).min(last), high.min(last))
            });
            for k in z.0..=z.1 {
                for j in y.0..=y.1 {
                    let row = (k * self.counts[1] + j) * self.counts[0];
                    marks[row + x.0..=row + x.1].fill(true);
                }
            }
        }
        marks
    }

    /// The marked cubes as cells, cut off at the box.
    fn cells(&self, marks: &[bool]) -> Vec<ViewCell> {
        let [nx, ny, _] = self.counts;
        let (min, max) = (self.bounds.min.to_i64(), self.bounds.max.to_i64());
        let marked = (0..marks.len()).filter(|&i| marks[i]);
        marked
            .map(|i| {
                let at = [i % nx, i / nx % ny, i / (nx * ny)];
                let low: [i64; 3] = std::array::from_fn(|k| min[k] + at[k] as i64 * self.size);
                // A flat box still gets cells with an interior.
                let high: [i64; 3] =
                    std::array::from_fn(|k| (low[k] + self.size).min(max[k].max(low[k] + 1)));
                let bounds = Aabb {
                    min: point(low),
                    max: point(high),
                };
                let name = format!("{}_{}_{}", at[0], at[1], at[2]);
                ViewCell {
                    name,
                    bounds,
                    kind: CellKind::Box,
                }
            })
            .collect()
    }
}

fn point(coordinates: [i64; 3]) -> Point {
    Point::from(coordinates.map(|c| c as i32))
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::{Aabb, Point};

    use super::Cubes;

    #[test]
    fn a_floor_marks_its_cubes_and_those_on_it() {
        let bounds = Aabb::new(Point::new(0, 0, 0), Point::new(40, 20, 30));
        let cubes = Cubes::new(bounds, 10);
        assert_eq!(cubes.counts, [4, 2, 3]);
        let floor = Aabb::new(Point::new(2, 2, 1), Point::new(15, 5, 1));
        let names = |above| {
            let cells = cubes.cells(&cubes.marked([floor].into_iter(), above));
            cells.into_iter().map(|c| c.name).collect::<Vec<_>>()
        };
        assert_eq!(names(0), ["0_0_0", "1_0_0"]);
        assert_eq!(names(1), ["0_0_0", "1_0_0", "0_0_1", "1_0_1"]);
    }

    #[test]
    fn a_flat_scene_gets_solid_cells() {
        let bounds = Aabb::new(Point::new(0, 0, 5), Point::new(9, 9, 5));
        let cubes = Cubes::new(bounds, 4);
        for cell in cubes.cells(&cubes.marked([bounds].into_iter(), 1)) {
            assert!(cell.bounds.extent().iter().all(|&e| e >= 1));
        }
    }
}
