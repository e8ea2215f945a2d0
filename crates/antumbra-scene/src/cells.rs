//! View cells: the convex regions from which visibility is asked.
//!
//! Cells are snapped outwards, so that a cell on the grid contains the cell asked for: lower
//! bounds go down, upper bounds go up, and neighbors in a regular grid overlap by one grid step at
//! most, never leaving a slit between them. The exception are rooms: a face less than one grid step
//! from the plane of an occluding polygon goes to that plane, so that a cell flush with its walls
//! stays flush with them and does not see through walls without thickness. What such a cell does
//! not contain of the cell asked for is less than one step thick and behind that plane.

mod auto;
mod flush;
mod spec;

use antumbra_kernel::{Aabb, LIMIT, Point};
use flush::Walls;

use crate::{ObjectId, Scene};

pub use spec::{CellSpec, CellSpecError, NamedBox};

/// A view cell on the grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewCell {
    /// Its name: `x_y_z` in a regular grid (indices from the minimum), else as given.
    pub name: String,
    /// Its closed box in grid steps: snapped outwards, or to a wall less than one step away.
    pub bounds: Aabb,
    /// What the source is.
    pub kind: CellKind,
}

/// What visibility is asked from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CellKind {
    /// The open interior of the box.
    Box,
    /// The polygons of this object; they take no other part. The box is that of the object, and
    /// may be flat.
    Object(ObjectId),
}

/// No request makes more cells than this.
pub const MAX_CELLS: usize = 1 << 20;

/// Why no cells could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CellError {
    /// A cell size that is zero, negative or not finite.
    #[error("a cell size of {0} is impossible: give a positive number of scene units")]
    BadSize(f64),
    /// A regular grid with too many cells.
    #[error(
        "cells of size {size} would be {count:.0}, more than {MAX_CELLS}: choose a larger size"
    )]
    TooMany {
        /// The size asked for.
        size: f64,
        /// How many cells there would be.
        count: f64,
    },
    /// A list of boxes without an entry.
    #[error("there is no box in the list of view cells: give at least one")]
    NoBoxes,
    /// A box with a coordinate that is NaN or infinite.
    #[error(
        "view cell \"{name}\" goes from ({}, {}, {}) to ({}, {}, {}), but coordinates must be finite",
        min[0], min[1], min[2], max[0], max[1], max[2]
    )]
    NotFinite {
        /// Its name.
        name: String,
        /// Its smallest coordinates as given.
        min: [f64; 3],
        /// Its largest coordinates as given.
        max: [f64; 3],
    },
    /// A box without volume, or with minimum and maximum exchanged.
    #[error(
        "view cell \"{name}\" goes from {min} to {max} along {axis}: a cell needs a size above \
         zero along every axis, with min < max"
    )]
    NoVolume {
        /// Its name.
        name: String,
        /// The axis along which it has no size.
        axis: char,
        /// Its smallest coordinate there.
        min: f64,
        /// Its largest coordinate there.
        max: f64,
    },
    /// A box outside the grid of the scene.
    #[error(
        "view cell \"{name}\" lies outside the grid, which reaches {reach} around the middle of the \
         scene: build the scene with a grid that holds the cells too"
    )]
    OutsideGrid {
        /// Its name.
        name: String,
        /// How far the grid reaches from its origin, in scene units.
        reach: f64,
    },
    /// There is no object of that name.
    #[error("there is no object \"{name}\" in the scene{}", suggest(close, *objects))]
    UnknownObject {
        /// The name asked for.
        name: String,
        /// Names that resemble it, best first.
        close: Vec<String>,
        /// How many objects there are; their ids are below that.
        objects: usize,
    },
    /// The object has no polygon to look from.
    #[error("object \"{name}\" has no polygons, so nothing can be seen from it: choose another")]
    EmptyObject {
        /// Its name.
        name: String,
    },
}

fn suggest(close: &[String], objects: usize) -> String {
    match close {
        [] => format!(": give the name of one of its {objects} objects, or an id below {objects}"),
        _ => format!(": did you mean \"{}\"?", close.join("\" or \"")),
    }
}

/// Makes the view cells that a specification describes for a scene.
///
/// * [`CellSpec::Grid`]: cubes from the minimum of the scene's box, all that meet the box, with x
///   varying fastest, then y, then z. A cube that would meet it by no more than one grid step (the
///   rounding of the box itself) is left out, and its neighbor holds the step.
/// * [`CellSpec::Boxes`]: one cell a box, in order.
/// * [`CellSpec::Object`]: one cell, from the polygons of the object of that name or decimal id.
/// * [`CellSpec::Auto`]: at most 512 cubes over free space. Free space is found above
///   surfaces one can stand on: polygons whose normal is within 45 degrees of the vertical. A cube
///   is kept if the box of such a polygon meets it or the cube below it; where there is no such
///   surface, if the box of any polygon meets it. The cubes are as small as the limit allows and
///   cut off at the scene's box. A cube inside a solid may be among them.
///
/// # Errors
/// If the size, a box or the name is unusable; see [`CellError`].
///
/// ```
/// use antumbra_scene::{CellSpec, ObjectInput, PartInput, SceneBuilder, SceneInput, make_cells};
/// let floor = PartInput {
///     vertices: vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 3.0, 0.0], [0.0, 3.0, 2.0]],
///     faces: [[0, 1, 2], [0, 2, 3]].into_iter().collect(),
///     ..Default::default()
/// };
/// let object = ObjectInput { name: Some("floor".into()), parts: vec![floor] };
/// let input = SceneInput { objects: vec![object], source_name: "example".into() };
/// let (scene, _) = SceneBuilder::new(input).build()?;
/// let cells = make_cells(&scene, &"grid:2".parse::<CellSpec>()?)?;
/// assert_eq!(cells.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["0_0_0", "1_0_0", "0_1_0", "1_1_0"]);
/// assert!(make_cells(&scene, &"object:flor".parse()?).unwrap_err().to_string().contains("did you mean \"floor\""));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn make_cells(scene: &Scene, spec: &CellSpec) -> Result<Vec<ViewCell>, CellError> {
    match spec {
        CellSpec::Grid(size) => grid_cells(scene, *size),
        CellSpec::Boxes(boxes) if boxes.is_empty() => Err(CellError::NoBoxes),
        CellSpec::Boxes(boxes) => {
            let walls = Walls::of(scene);
            boxes.iter().map(|b| box_cell(scene, &walls, b)).collect()
        }
        CellSpec::Object(name) => object_cell(scene, name).map(|cell| vec![cell]),
        CellSpec::Auto => Ok(auto::cells(scene)),
    }
}

fn grid_cells(scene: &Scene, size: f64) -> Result<Vec<ViewCell>, CellError> {
    if !(size.is_finite() && size > 0.0) {
        return Err(CellError::BadSize(size));
    }
    let steps = size / scene.grid().step();
    let bounds = scene.bounds();
    // What sticks out by one step is rounding, no cube of its own.
    let counts = bounds
        .extent()
        .map(|e| ((e - 1).max(1) as f64 / steps).ceil().max(1.0));
    let count = counts[0] * counts[1] * counts[2];
    if count > MAX_CELLS as f64 {
        return Err(CellError::TooMany { size, count });
    }
    let counts = counts.map(|c| c as usize);
    let walls = Walls::of(scene);
    let spans: [Vec<(i32, i32)>; 3] = std::array::from_fn(|k| {
        let (min, max) = (bounds.min.to_array()[k], bounds.max.to_array()[k]);
        let at = |i: usize| f64::from(min) + steps * i as f64;
        (0..counts[k])
            .map(|i| {
                let (low, high) = walls.span(k, at(i), at(i + 1));
                let last = i + 1 == counts[k];
                (low, if last { high.max(max) } else { high })
            })
            .collect()
    });
    let mut cells = Vec::with_capacity(counts.iter().product());
    for (z, sz) in spans[2].iter().enumerate() {
        for (y, sy) in spans[1].iter().enumerate() {
            for (x, sx) in spans[0].iter().enumerate() {
                let bounds = Aabb {
                    min: Point::new(sx.0, sy.0, sz.0),
                    max: Point::new(sx.1, sy.1, sz.1),
                };
                cells.push(ViewCell {
                    name: format!("{x}_{y}_{z}"),
                    bounds,
                    kind: CellKind::Box,
                });
            }
        }
    }
    Ok(cells)
}

fn box_cell(scene: &Scene, walls: &Walls, given: &NamedBox) -> Result<ViewCell, CellError> {
    let NamedBox { name, min, max } = given;
    if min.iter().chain(max).any(|c| !c.is_finite()) {
        return Err(CellError::NotFinite {
            name: name.clone(),
            min: *min,
            max: *max,
        });
    }
    if let Some(k) = (0..3).find(|&k| min[k] >= max[k]) {
        let axis = ['x', 'y', 'z'][k];
        return Err(CellError::NoVolume {
            name: name.clone(),
            axis,
            min: min[k],
            max: max[k],
        });
    }
    let grid = scene.grid();
    let (low, high) = (grid.to_grid_f64(*min), grid.to_grid_f64(*max));
    let reach = f64::from(LIMIT);
    if (0..3).any(|k| low[k].floor() <= -reach || high[k].ceil() >= reach) {
        return Err(CellError::OutsideGrid {
            name: name.clone(),
            reach: reach * grid.step(),
        });
    }
    let spans = [0, 1, 2].map(|k| walls.span(k, low[k], high[k]));
    Ok(ViewCell {
        name: name.clone(),
        bounds: Aabb {
            min: Point::from(spans.map(|span| span.0)),
            max: Point::from(spans.map(|span| span.1)),
        },
        kind: CellKind::Box,
    })
}

fn object_cell(scene: &Scene, name: &str) -> Result<ViewCell, CellError> {
    let id = scene
        .find_object(name)
        .ok_or_else(|| CellError::UnknownObject {
            name: name.to_owned(),
            close: spec::close_names(
                name,
                scene.objects().iter().map(|object| object.name.as_str()),
            ),
            objects: scene.objects().len(),
        })?;
    let name = scene.object(id).name.clone();
    match scene.object_bounds(id) {
        Some(bounds) => Ok(ViewCell {
            name,
            bounds,
            kind: CellKind::Object(id),
        }),
        None => Err(CellError::EmptyObject { name }),
    }
}

#[cfg(test)]
mod tests {
    use super::{CellError, CellKind, CellSpec, NamedBox, make_cells};
    use crate::{ObjectInput, PartInput, Scene, SceneBuilder, SceneInput};

    /// Two horizontal squares of a given side, one 3 above the other, and an empty object.
    fn rooms(side: f64) -> Scene {
        let level = |z: f64| PartInput {
            vertices: vec![
                [0.1, 0.1, z],
                [0.1 + side, 0.1, z],
                [0.1 + side, 0.1 + side, z],
                [0.1, 0.1 + side, z],
            ],
            faces: [[0, 1, 2], [0, 2, 3]].into_iter().collect(),
            ..PartInput::default()
        };
        let object = |name: &str, parts| ObjectInput {
            name: Some(name.into()),
            parts,
        };
        let objects = vec![
            object("ground floor", vec![level(0.1)]),
            object("upper floor", vec![level(3.1)]),
            ObjectInput::default(),
        ];
        SceneBuilder::new(SceneInput {
            objects,
            source_name: "rooms".into(),
        })
        .cells_box(Some(([-9.0; 3], [9.0; 3])))
        .build()
        .expect("valid")
        .0
    }

    #[test]
    fn cubes_cover_the_box_without_slits_and_without_spare_layers() {
        let scene = rooms(8.0);
        let cells = make_cells(&scene, &CellSpec::Grid(0.5)).expect("cells");
        assert_eq!(cells.len(), 16 * 16 * 6);
        assert_eq!(
            (cells[1].name.as_str(), cells[16].name.as_str()),
            ("1_0_0", "0_1_0")
        );
        let union = cells
            .iter()
            .map(|c| c.bounds)
            .reduce(antumbra_kernel::Aabb::union)
            .expect("some");
        assert!(union.contains(&scene.bounds()));
        for pair in cells[..16].windows(2) {
            let overlap = pair[0].bounds.max.x - pair[1].bounds.min.x;
            assert!((0..=1).contains(&overlap));
        }
        assert_eq!(
            make_cells(&scene, &CellSpec::Grid(100.0))
                .expect("cells")
                .len(),
            1
        );
    }

    #[test]
    fn bad_sizes_and_boxes_are_named() {
        let scene = rooms(8.0);
        for size in [0.0, -1.0, f64::NAN] {
            assert!(matches!(
                make_cells(&scene, &CellSpec::Grid(size)),
                Err(CellError::BadSize(_))
            ));
        }
        assert!(matches!(
            make_cells(&scene, &CellSpec::Grid(1e-6)),
            Err(CellError::TooMany { .. })
        ));
        let one = |min, max| {
            make_cells(
                &scene,
                &CellSpec::Boxes(vec![NamedBox {
                    name: "hall".into(),
                    min,
                    max,
                }]),
            )
        };
        let flat = one([0.0; 3], [1.0, 0.0, 1.0])
            .expect_err("flat")
            .to_string();
        assert!(
            flat.contains("\"hall\"") && flat.contains("along y"),
            "{flat}"
        );
        assert!(matches!(
            one([0.0; 3], [f64::NAN; 3]),
            Err(CellError::NotFinite { .. })
        ));
        assert!(matches!(
            one([0.0; 3], [1e9; 3]),
            Err(CellError::OutsideGrid { .. })
        ));
        assert_eq!(
            make_cells(&scene, &CellSpec::Boxes(vec![])),
            Err(CellError::NoBoxes)
        );
        let cells = one([0.1; 3], [0.1 + 1e-12; 3]).expect("thin");
        assert!(cells[0].bounds.extent().iter().all(|&e| e >= 1));
    }

    #[test]
    fn objects_are_found_by_name_or_id() {
        let scene = rooms(8.0);
        let cell = |name: &str| make_cells(&scene, &CellSpec::Object(name.into()));
        let by_name = cell("upper floor").expect("found");
        assert_eq!(by_name, cell("1").expect("found"));
        assert!(matches!(by_name[0].kind, CellKind::Object(id) if id.0 == 1));
        assert_eq!(by_name[0].bounds.extent()[2], 0);
        assert!(matches!(cell("2"), Err(CellError::EmptyObject { .. })));
        let Err(CellError::UnknownObject { close, .. }) = cell("uper flor") else {
            panic!("unknown")
        };
        assert_eq!(close, ["upper floor"]);
    }

    #[test]
    fn free_space_lies_on_floors() {
        let scene = rooms(8.0);
        let cells = make_cells(&scene, &CellSpec::Auto).expect("cells");
        assert!(!cells.is_empty() && cells.len() <= 512);
        for cell in &cells {
            assert!(cell.bounds.extent().iter().all(|&e| e > 0), "{cell:?}");
            assert!(scene.bounds().contains(&cell.bounds));
        }
        let flat = rooms(8.0);
        assert_eq!(make_cells(&flat, &CellSpec::Auto), Ok(cells));
    }
}
