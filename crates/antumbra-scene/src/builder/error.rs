//! Why a scene could not be built: sentences that name the object, the place, what was found and
//! what to do.

/// Why [`crate::SceneBuilder::build`] refused its input.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// A coordinate is NaN or infinite.
    #[error(
        "{scene}: {object}: vertex {vertex} is ({}, {}, {}), but coordinates must be finite: \
         repair the vertex or remove the object",
        found[0], found[1], found[2]
    )]
    NotFinite {
        /// Name of the source.
        scene: String,
        /// Which object (and part).
        object: String,
        /// Which vertex of that part, from zero.
        vertex: usize,
        /// The coordinates as found.
        found: [f64; 3],
    },
    /// A face refers to a vertex that is not there.
    #[error(
        "{scene}: {object}: face {face} refers to vertex {index}, but there are only {vertices} \
         vertices (numbered from 0): the file is damaged, export it again"
    )]
    IndexOutOfRange {
        /// Name of the source.
        scene: String,
        /// Which object (and part).
        object: String,
        /// Which face of that part, from zero.
        face: usize,
        /// The index as found.
        index: u32,
        /// How many vertices the part has.
        vertices: usize,
    },
    /// There is nothing to see: no face at all, or none that survives snapping.
    #[error(
        "{scene}: no triangles: of {faces} faces in {objects} objects none has an area{}: a scene \
         needs at least one polygon", on_grid(*step)
    )]
    NoTriangles {
        /// Name of the source.
        scene: String,
        /// How many objects were given.
        objects: usize,
        /// How many faces were given; all of them were degenerate.
        faces: usize,
        /// The step of the grid they were snapped to, if it came to that.
        step: Option<f64>,
    },
    /// The scene does not fit the grid that was asked for.
    #[error(
        "{scene}: scene and cells are {extent} wide, but a grid of {step} holds only {reach}: \
         use a step of {fits} or more"
    )]
    TooWide {
        /// Name of the source.
        scene: String,
        /// The largest extent of scene and cells, in scene units.
        extent: f64,
        /// The step asked for.
        step: f64,
        /// The largest extent the grid can hold.
        reach: f64,
        /// The smallest power of two that would do.
        fits: f64,
    },
    /// The grid step is not a positive finite number.
    #[error("a grid step of {step} is impossible: give a positive number of scene units")]
    BadGrid {
        /// The step asked for.
        step: f64,
    },
    /// The box of the view cells is not finite or inverted.
    #[error(
        "the box of the view cells, ({}, {}, {}) to ({}, {}, {}), is not a finite box with \
         min <= max: correct the cells",
        min[0], min[1], min[2], max[0], max[1], max[2]
    )]
    BadCellsBox {
        /// Smallest coordinates as given.
        min: [f64; 3],
        /// Largest coordinates as given.
        max: [f64; 3],
    },
    /// More polygons or corners than 32-bit numbers can count.
    #[error(
        "{scene}: {corners} polygon corners are more than the {} a scene can hold: split the scene",
        u32::MAX
    )]
    TooLarge {
        /// Name of the source.
        scene: String,
        /// How many corners there would be.
        corners: usize,
    },
}

fn on_grid(step: Option<f64>) -> String {
    step.map_or(String::new(), |step| {
        let step = if (1e-6..1e9).contains(&step) {
            step.to_string()
        } else {
            format!("{step:e}")
        };
        format!(
            " on a grid of step {step}, which has to hold the scene and where it is looked at from; if \
             the scene is larger than that, look from nearer by or give a finer grid"
        )
    })
}
