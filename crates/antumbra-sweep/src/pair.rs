//! Does one polygon or object see another? The region engine asked about a single target.

use std::ops::Range;

use antumbra_scene::{ObjectId, PolygonId, Scene};

use crate::region::{BakeOptions, Baker};
use crate::search::Work;
use crate::verdict::Witness;

/// A polygon or a whole object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// One polygon.
    Polygon(PolygonId),
    /// All polygons of an object; it sees, and is seen, if one of them does or is.
    Object(ObjectId),
}

impl Surface {
    /// Its polygons.
    #[must_use]
    pub fn polygons(self, scene: &Scene) -> Range<u32> {
        match self {
            Self::Polygon(PolygonId(p)) => p..p + 1,
            Self::Object(id) => scene.object(id).polygons.clone(),
        }
    }
}

/// The answer about a pair.
///
/// There is no conversion to `bool`: only `Hidden` may be culled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// An open set of segments from source to target is free.
    Visible {
        /// One of them.
        witness: Witness,
        /// Whether no occluder blocks any line between the two.
        fully: bool,
    },
    /// No open set of segments is free; the certificate's bytes (see
    /// `docs/formats/certificates.md`, source = the source's polygons).
    Hidden(Vec<u8>),
    /// Stopped by a budget or cancelled.
    Unknown,
}

/// A verdict and the work it took.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairResult {
    /// The verdict.
    pub verdict: Verdict,
    /// What was done.
    pub work: Work,
}

impl Baker<'_> {
    /// Decides whether `from` sees `to`. Occluders coplanar with the source or target polygon do
    /// not hide it; the source's other polygons make no difference. Exact, one thread.
    ///
    /// # Examples
    /// ```
    /// use antumbra_scene::{Faces, ObjectId, ObjectInput, PartInput, SceneBuilder, SceneInput};
    /// use antumbra_sweep::{BakeOptions, Baker, Surface, Verdict};
    ///
    /// let square = |name: &str, z: f64, half: f64| {
    ///     let mut faces = Faces::default();
    ///     faces.push(&[0, 1, 2, 3]);
    ///     let vertices = vec![[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
    ///     ObjectInput {
    ///         name: Some(name.into()),
    ///         parts: vec![PartInput { class: None, translucent: false, vertices, faces }],
    ///     }
    /// };
    /// let objects = vec![square("a", 0.0, 1.0), square("wall", 1.0, 9.0), square("b", 2.0, 1.0)];
    /// let input = SceneInput { objects, source_name: "doc".into() };
    /// let (scene, _) = SceneBuilder::new(input).build()?;
    /// let (a, b) = (Surface::Object(ObjectId(0)), Surface::Object(ObjectId(2)));
    /// let result = Baker::new(&scene).pair(a, b, &BakeOptions::default());
    /// assert!(matches!(result.verdict, Verdict::Hidden(_)));
    /// # Ok::<(), antumbra_scene::BuildError>(())
    /// ```
    #[must_use]
    pub fn pair(&self, from: Surface, to: Surface, options: &BakeOptions) -> PairResult {
        self.decide_pair(from.polygons(self.scene()), to, options)
    }
}
