//! Pictures: of a baked cell a plan as SVG and a perspective view as PNG; of a light what it reaches.
//!
//! Visible objects are in color, hidden ones grey, the cell is marked. If there is a roof above
//! the cell, everything above the cell is cut away, so that one looks inside.

mod camera;
mod color;
mod encode;
mod facing;
mod light;
mod owners;
mod perspective;
mod plan;
mod raster;
mod section;
mod vector;

pub(crate) use encode::png;
pub(crate) use light::{Lamp, LightPicture, LitFace, light_picture};
pub(crate) use owners::PixelOwners;
pub(crate) use perspective::{PerspectiveOptions, perspective};
pub(crate) use plan::plan;

/// How an object is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shown {
    /// In a color of its own.
    Visible,
    /// Grey.
    Hidden,
    /// As the marker: it is what one looks from.
    Source,
}

/// A polygon to draw, in scene units.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    /// At least three corners, planar and convex, counter-clockwise about the front.
    pub corners: Vec<[f64; 3]>,
    /// Index into [`Subject::shown`].
    pub object: u32,
    /// One looks through it.
    pub clear: bool,
}

/// What a picture shows.
#[derive(Clone, Debug)]
pub(crate) struct Subject {
    /// All polygons; those of an object are consecutive.
    pub faces: Vec<Face>,
    /// For each object, how it is drawn.
    pub shown: Vec<Shown>,
    /// The lower and upper corner of the cell's box.
    pub cell: [[f64; 3]; 2],
    /// One line about it, for the caption.
    pub caption: String,
}

impl Subject {
    /// The box around the cell and all that is visible from it.
    fn focus(&self) -> [[f64; 3]; 2] {
        let [mut min, mut max] = self.cell;
        for face in &self.faces {
            if self.shown[face.object as usize] != Shown::Hidden {
                for p in &face.corners {
                    for k in 0..3 {
                        min[k] = min[k].min(p[k]);
                        max[k] = max[k].max(p[k]);
                    }
                }
            }
        }
        [min, max]
    }

    /// The color of each object.
    fn palette(&self) -> Vec<color::Rgb> {
        let [min, max] = self.focus();
        let ground = ((max[0] - min[0]) * (max[1] - min[1])).max(f64::MIN_POSITIVE);
        let mut largest = vec![0.0_f64; self.shown.len()];
        for face in &self.faces {
            let n = vector::area_vector(&face.corners);
            let area = vector::dot(n, n).sqrt() / 2.0;
            let entry = &mut largest[face.object as usize];
            *entry = entry.max(area);
        }
        let paint = |(i, shown): (usize, &Shown)| match shown {
            // A face as large as a tenth of the ground is background.
            Shown::Visible => color::visible(
                i as u32,
                ((largest[i] / ground - 0.03) / 0.07).clamp(0.0, 1.0),
            ),
            Shown::Hidden => color::hidden(),
            Shown::Source => color::ACCENT,
        };
        self.shown.iter().enumerate().map(paint).collect()
    }

    fn count(&self, shown: Shown) -> usize {
        self.shown.iter().filter(|s| **s == shown).count()
    }
}
