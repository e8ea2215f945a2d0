//! Hard shadows: which parts of every polygon a point light reaches, and where shadows of an area
//! light begin and end, nearly.
//!
//! A point light lights what it sees: the occlusion tree of its [visibility map](crate::map) cuts every
//! polygon of the scene into lit and shadowed fragments. Which fragments there are is exact for the
//! snapped scene; only their corners are rounded, when they are handed out.
//!
//! ```
//! use antumbra::map::Mapper;
//! use antumbra::scene::{Faces, ObjectInput, PartInput, SceneBuilder, SceneInput};
//! use antumbra::shadow::{Lighting, point_light};
//!
//! // A lid of 2 x 2 halfway between the light and a floor of 8 x 8: its shadow is 4 x 4.
//! let square = |half: f64, z: f64| {
//!     let mut faces = Faces::default();
//!     faces.push(&[0, 1, 2, 3]);
//!     let vertices = vec![[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
//!     ObjectInput { name: None, parts: vec![PartInput { vertices, faces, ..PartInput::default() }] }
//! };
//! let objects = vec![square(4.0, 0.0), square(1.0, 2.0)];
//! let input = SceneInput { objects, source_name: "lid".into() };
//! let (scene, _) = SceneBuilder::new(input).grid(Some(0.125)).build()?;
//!
//! let shadows = point_light(&Mapper::new(&scene), [0.0, 0.0, 4.0])?;
//! assert_eq!(shadows.area(Lighting::Shadowed), 16.0);
//! assert_eq!(shadows.area(Lighting::Lit), 64.0 - 16.0 + 4.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod fragments;
mod mesh;

use antumbra_kernel::Point;
use antumbra_scene::{PolygonId, Scene};

pub use fragments::point_light;
pub use mesh::{Discontinuity, DiscontinuityMesh, Event, area_light};

/// What a light does to a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Lighting {
    /// The light reaches it, from either side: polygons are two-sided.
    Lit,
    /// An occluder is in between.
    Shadowed,
    /// The light lies in the polygon's plane: no open set of lines reaches it.
    EdgeOn,
}

impl Lighting {
    /// The name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lit => "lit",
            Self::Shadowed => "shadowed",
            Self::EdgeOn => "edge-on",
        }
    }
}

/// A convex part of a polygon that is lit, or not, as a whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    /// The polygon.
    pub polygon: PolygonId,
    /// What the light does.
    pub lighting: Lighting,
    /// Its corners in scene units, turning as those of the polygon. Rounded, unless the fragment is
    /// the whole polygon.
    pub corners: Vec<[f64; 3]>,
}

impl Fragment {
    /// The area in square scene units.
    #[must_use]
    pub fn area(&self) -> f64 {
        let minus =
            |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| p[k] - self.corners[0][k]) };
        let sum = self.corners[1..].windows(2).fold([0.0; 3], |sum, pair| {
            let (a, b) = (minus(pair[0]), minus(pair[1]));
            let m = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
            [sum[0] + m(1, 2), sum[1] + m(2, 0), sum[2] + m(0, 1)]
        });
        sum.iter().map(|c| c * c).sum::<f64>().sqrt() / 2.0
    }
}

/// Every polygon of a scene, cut into fragments by a point light.
#[derive(Clone, Debug)]
pub struct Shadows {
    light: Point,
    fragments: Vec<Fragment>,
}

impl Shadows {
    /// All fragments, by polygon; those of a polygon cover it without overlap.
    #[must_use]
    pub fn fragments(&self) -> &[Fragment] {
        &self.fragments
    }

    /// The light on the grid, in scene units.
    #[must_use]
    pub fn light(&self, scene: &Scene) -> [f64; 3] {
        scene.grid().to_scene(self.light)
    }

    /// The sum of the areas of all fragments of a kind, in square scene units.
    #[must_use]
    pub fn area(&self, lighting: Lighting) -> f64 {
        let of_kind = self.fragments.iter().filter(|f| f.lighting == lighting);
        of_kind
            .map(Fragment::area)
            .fold(0.0, |sum, area| sum + area)
    }
}
