//! The grid of a scene, and the vertices of an object on it, each position once.

use antumbra_kernel::{Grid, LIMIT, Point};
use rustc_hash::FxHashMap;

use super::error::BuildError;
use crate::input::{PartInput, SceneInput};

/// A box in scene units.
pub(crate) type FloatBox = ([f64; 3], [f64; 3]);

/// Checks every vertex and index, and returns the box around all vertices that faces use.
pub(crate) fn checked_bounds(input: &SceneInput) -> Result<Option<FloatBox>, BuildError> {
    let mut bounds: Option<FloatBox> = None;
    for (id, object) in input.objects.iter().enumerate() {
        for (number, part) in object.parts.iter().enumerate() {
            let place = || {
                let name = object
                    .name
                    .as_deref()
                    .map_or(String::new(), |n| format!(" \"{n}\""));
                let part = if object.parts.len() > 1 {
                    format!(", part {number}")
                } else {
                    String::new()
                };
                format!("object {id}{name}{part}")
            };
            check_vertices(part).map_err(|vertex| BuildError::NotFinite {
                scene: input.source_name.clone(),
                object: place(),
                vertex,
                found: part.vertices[vertex],
            })?;
            for (face, corners) in part.faces.iter().enumerate() {
                for &index in corners {
                    let Some(p) = part.vertices.get(index as usize) else {
                        return Err(BuildError::IndexOutOfRange {
                            scene: input.source_name.clone(),
                            object: place(),
                            face,
                            index,
                            vertices: part.vertices.len(),
                        });
                    };
                    let (min, max) = bounds.get_or_insert((*p, *p));
                    for k in 0..3 {
                        min[k] = min[k].min(p[k]);
                        max[k] = max[k].max(p[k]);
                    }
                }
            }
        }
    }
    Ok(bounds)
}

/// The first vertex that is not finite, as an error.
fn check_vertices(part: &PartInput) -> Result<(), usize> {
    match part
        .vertices
        .iter()
        .position(|p| p.iter().any(|c| !c.is_finite()))
    {
        Some(vertex) => Err(vertex),
        None => Ok(()),
    }
}

/// The grid for a box: the finest power of two that fits, or the step asked for, centered.
pub(crate) fn choose_grid(
    scene: &str,
    (min, max): FloatBox,
    step: Option<f64>,
) -> Result<Grid, BuildError> {
    let impossible = || BuildError::BadGrid {
        step: step.unwrap_or(f64::NAN),
    };
    let finest = Grid::fitting(min, max).ok_or_else(impossible)?;
    let Some(step) = step else { return Ok(finest) };
    if !(step.is_finite() && step > 0.0) {
        return Err(impossible());
    }
    let half = (0..3)
        .map(|k| max[k] / 2.0 - min[k] / 2.0)
        .fold(0.0, f64::max);
    // As in the finest grid, room is kept on each side for outward rounding.
    let room = f64::from(LIMIT - 4);
    if half / step > room {
        return Err(BuildError::TooWide {
            scene: scene.to_owned(),
            extent: 2.0 * half,
            step,
            reach: 2.0 * room * step,
            fits: finest.step(),
        });
    }
    // A multiple of the step, so that scenes with other extents share the raster.
    let origin = std::array::from_fn(|k| ((min[k] / 2.0 + max[k] / 2.0) / step).round() * step);
    Grid::new(origin, step).ok_or_else(impossible)
}

/// Objects with few vertices look positions up one by one.
const FEW: usize = 16;

/// The vertices of one object on the grid, each position once, numbered in order of first use.
#[derive(Default)]
pub(crate) struct Welder {
    /// The positions.
    pub(crate) points: Vec<Point>,
    numbers: FxHashMap<Point, u32>,
    /// The largest squared distance a vertex was moved, in scene units.
    pub(crate) squared_movement: f64,
}

impl Welder {
    /// Forgets all vertices, for the next object; the largest movement is kept.
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.numbers.clear();
    }

    /// The number of the grid point nearest to a scene point.
    ///
    /// The grid was chosen to hold all points; one outside is put on its border.
    pub(crate) fn weld(&mut self, grid: &Grid, position: [f64; 3]) -> u32 {
        let p = nearest(grid, position);
        let back = grid.to_scene(p);
        let squared = (0..3).map(|k| (back[k] - position[k]).powi(2)).sum();
        self.squared_movement = self.squared_movement.max(squared);
        if self.points.len() <= FEW {
            if let Some(i) = self.points.iter().position(|&q| q == p) {
                return i as u32;
            }
        } else if let Some(&i) = self.numbers.get(&p) {
            return i;
        }
        let number = self.points.len() as u32;
        self.points.push(p);
        if self.points.len() == FEW + 1 {
            self.numbers
                .extend(self.points.iter().enumerate().map(|(i, &q)| (q, i as u32)));
        } else if self.points.len() > FEW {
            self.numbers.insert(p, number);
        }
        number
    }
}

fn nearest(grid: &Grid, position: [f64; 3]) -> Point {
    grid.snap(position).unwrap_or_else(|_| {
        let end = f64::from(LIMIT - 1);
        Point::from(
            grid.to_grid_f64(position)
                .map(|c| c.round().clamp(-end, end) as i32),
        )
    })
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Grid;

    use super::{BuildError, Welder, choose_grid};

    #[test]
    fn a_step_that_is_too_fine_names_one_that_fits() {
        let bounds = ([0.0; 3], [20_000.0, 1.0, 1.0]);
        let Err(BuildError::TooWide { fits, .. }) = choose_grid("city", bounds, Some(0.001)) else {
            panic!("20 km do not fit a millimeter grid");
        };
        assert!(choose_grid("city", bounds, Some(fits)).is_ok());
        assert!(choose_grid("city", bounds, Some(fits / 2.0)).is_err());
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                choose_grid("city", bounds, Some(bad)),
                Err(BuildError::BadGrid { .. })
            ));
        }
    }

    #[test]
    fn one_step_gives_one_raster() {
        let a = choose_grid("a", ([0.0; 3], [7.3, 2.0, 3.0]), Some(0.25)).expect("fits");
        let b = choose_grid("b", ([-3.0; 3], [17.3, 2.0, 30.0]), Some(0.25)).expect("fits");
        for k in 0..3 {
            assert_eq!((a.origin()[k] - b.origin()[k]) % 0.25, 0.0);
        }
    }

    #[test]
    fn equal_positions_are_one_vertex() {
        let grid = Grid::new([0.0; 3], 1.0).expect("valid");
        let mut welder = Welder::default();
        for round in 0..2 {
            for i in 0..100_u32 {
                assert_eq!(
                    welder.weld(&grid, [f64::from(i), 0.2, 0.0]),
                    i,
                    "round {round}"
                );
            }
        }
        assert!((welder.squared_movement.sqrt() - 0.2).abs() < 1e-12);
    }
}
