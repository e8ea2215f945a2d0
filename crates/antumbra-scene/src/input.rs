//! What a reader hands over: named objects of parts with float vertices, before any snapping.
//!
//! Readers fill these types and check nothing but their own file format; every check of the
//! content (finite coordinates, indices in range) is made by the scene builder, which can name
//! object and vertex.

/// A scene as read from a file, in Z-up scene units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneInput {
    /// The objects; their order gives the zero-based [`crate::ObjectId`]s.
    pub objects: Vec<ObjectInput>,
    /// Where the scene comes from, for messages: a file name, or the name of a generator.
    pub source_name: String,
}

impl SceneInput {
    /// The classes of all parts, each once, in order; parts without a class have none.
    #[must_use]
    pub fn classes(&self) -> Vec<String> {
        let parts = self.objects.iter().flat_map(|o| &o.parts);
        let mut classes: Vec<String> = parts.filter_map(|p| p.class.clone()).collect();
        classes.sort_unstable();
        classes.dedup();
        classes
    }
}

/// An object as read: a name and any number of parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectInput {
    /// The name in the file, if it has one. Need not be unique.
    pub name: Option<String>,
    /// The parts. An object without parts still counts and keeps its id.
    pub parts: Vec<PartInput>,
}

/// A part of an object: faces of one material over a vertex list of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartInput {
    /// The class that occluder policies refer to: the `class` entry of the extras, or the
    /// material's name.
    pub class: Option<String>,
    /// Whether the material lets light through (alpha mode `BLEND` or `MASK`).
    pub translucent: bool,
    /// Positions in scene units, Z-up.
    pub vertices: Vec<[f64; 3]>,
    /// The faces, as indices into `vertices`.
    pub faces: Faces,
}

/// A flat list of faces, each a run of at least three vertex indices.
///
/// ```
/// use antumbra_scene::Faces;
/// let mut faces = Faces::default();
/// faces.push(&[0, 1, 2]);
/// faces.push(&[2, 3, 4, 5]);
/// assert_eq!(faces.len(), 2);
/// assert_eq!(faces.iter().map(<[u32]>::len).collect::<Vec<_>>(), [3, 4]);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Faces {
    corners: Vec<u32>,
    /// `ends[i]` is where face `i` ends in `corners`.
    ends: Vec<u32>,
}

impl Faces {
    /// An empty list with room for a number of faces and corners.
    #[must_use]
    pub fn with_capacity(faces: usize, corners: usize) -> Self {
        Self {
            corners: Vec::with_capacity(corners),
            ends: Vec::with_capacity(faces),
        }
    }

    /// Appends a face. The builder drops (and reports) a face with fewer than three corners.
    pub fn push(&mut self, corners: &[u32]) {
        self.corners.extend_from_slice(corners);
        self.ends.push(self.corners.len() as u32);
    }

    /// The faces in order, each as its vertex indices.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.ends.len()).map(|i| {
            let first = if i == 0 { 0 } else { self.ends[i - 1] as usize };
            &self.corners[first..self.ends[i] as usize]
        })
    }

    /// How many faces there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }
}

impl FromIterator<[u32; 3]> for Faces {
    /// A list of triangles.
    fn from_iter<I: IntoIterator<Item = [u32; 3]>>(triangles: I) -> Self {
        let mut faces = Self::default();
        for triangle in triangles {
            faces.push(&triangle);
        }
        faces
    }
}

/// Which polygons are occluders. Ignoring an occluder is always safe: what it would have hidden
/// stays visible.
///
/// A part without a class has the empty class `""`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum OccluderPolicy {
    /// Every part blocks, except translucent ones.
    #[default]
    Default,
    /// Only parts of these classes block (also translucent ones: they were asked for by name).
    Only(Vec<String>),
    /// As [`OccluderPolicy::Default`], but parts of these classes do not block either.
    Except(Vec<String>),
}

impl OccluderPolicy {
    /// Whether a part with this class and material occludes. Classes are compared without case.
    ///
    /// ```
    /// use antumbra_scene::OccluderPolicy;
    /// let policy = OccluderPolicy::Except(vec!["Door".into()]);
    /// assert!(policy.occludes(Some("wall"), false));
    /// assert!(!policy.occludes(Some("DOOR"), false));
    /// assert!(!policy.occludes(Some("wall"), true));
    /// ```
    #[must_use]
    pub fn occludes(&self, class: Option<&str>, translucent: bool) -> bool {
        let class = class.unwrap_or("").to_lowercase();
        let listed = |names: &[String]| names.iter().any(|name| name.to_lowercase() == class);
        match self {
            Self::Default => !translucent,
            Self::Only(names) => listed(names),
            Self::Except(names) => !translucent && !listed(names),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Faces, OccluderPolicy};

    #[test]
    fn faces_keep_their_order_and_lengths() {
        let mut faces = Faces::with_capacity(2, 8);
        assert!(faces.is_empty());
        faces.push(&[0, 1, 2]);
        faces.push(&[]);
        faces.push(&[3, 4, 5, 6, 7]);
        let lists: Vec<&[u32]> = faces.iter().collect();
        assert_eq!(lists, [&[0, 1, 2][..], &[], &[3, 4, 5, 6, 7]]);
        assert_eq!(
            Faces::from_iter([[0, 1, 2]]).iter().next(),
            Some(&[0, 1, 2][..])
        );
    }

    #[test]
    fn policies_compare_without_case() {
        let only = OccluderPolicy::Only(vec!["Wall".into()]);
        assert!(only.occludes(Some("WALL"), false) && only.occludes(Some("wall"), true));
        assert!(!only.occludes(Some("slab"), false) && !only.occludes(None, false));
        assert!(OccluderPolicy::Default.occludes(None, false));
        assert!(!OccluderPolicy::Default.occludes(Some("wall"), true));
        assert!(OccluderPolicy::Except(vec!["ÖL".into()]).occludes(Some("wall"), false));
        assert!(!OccluderPolicy::Except(vec!["ÖL".into()]).occludes(Some("öl"), false));
    }
}
