//! The visibility map: faces, edges and vertices of a view, with all adjacency and their owners.
//!
//! After [Bittner02, ch. 5]. A view is the whole sphere of directions around a point, a frustum, or
//! parallel lines. What is seen is decided exactly for the snapped scene; only the directions, angles
//! and areas that are handed out are rounded.
//!
//! ```
//! use antumbra::map::{MapOptions, Mapper, Viewpoint};
//! use antumbra::scene::{Faces, ObjectInput, PartInput, SceneBuilder, SceneInput};
//!
//! // A square of two triangles above the viewpoint.
//! let mut faces = Faces::default();
//! faces.push(&[0, 1, 2]);
//! faces.push(&[0, 2, 3]);
//! let vertices = vec![[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]];
//! let parts = vec![PartInput { vertices, faces, ..PartInput::default() }];
//! let objects = vec![ObjectInput { name: Some("lid".into()), parts }];
//! let input = SceneInput { objects, source_name: "lid".into() };
//! let (scene, _) = SceneBuilder::new(input).grid(Some(0.125)).build()?;
//!
//! let map = Mapper::new(&scene).map(&Viewpoint::Sphere([0.0; 3]), &MapOptions::default())?;
//! // The square is one face, the rest of the sphere is background.
//! assert_eq!((map.vertices().len(), map.edges().len(), map.faces().len()), (4, 4, 2));
//! let lid = map.faces().iter().find(|f| f.polygon().is_some()).expect("it is seen");
//! assert!((lid.measure - 4.0 * std::f64::consts::PI / 6.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod angle;
mod build;
mod cells;
mod check;
mod classify;
pub mod drawing;
mod hidden;
mod mesh;
mod overlap;
mod view;
mod walls;

use antumbra_scene::{ObjectId, PolygonId, Scene};
use antumbra_sweep::occlusion::{SweepOptions, SweepWork, Twins};

pub use antumbra_sweep::occlusion;
pub use classify::{EdgeClass, Element};
pub(crate) use view::meet_from;
pub use view::{MapError, Viewpoint, camera_axes};

/// Which edges are removed from a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Dissolve {
    /// None: the cells of the occlusion tree as they are.
    Nothing,
    /// The cuts of the occlusion tree. What is left does not depend on how the tree grew.
    #[default]
    Bsp,
    /// Flat edges within an object, too: a smooth or plane surface is one face.
    Flat,
}

/// How to make a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapOptions {
    /// Polygons that meet at a smaller angle than this, in radians, are joined by a *flat* edge; 0
    /// for coplanar ones only.
    pub crease: f64,
    /// What is removed.
    pub dissolve: Dissolve,
    /// How the scene is swept; the result after dissolving does not depend on it.
    pub sweep: SweepOptions,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            crease: 15.0_f64.to_radians(),
            dissolve: Dissolve::default(),
            sweep: SweepOptions::default(),
        }
    }
}

/// What a vertex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum VertexKind {
    /// A corner of a polygon of the scene.
    Scene {
        /// The polygon; of several the smallest.
        polygon: PolygonId,
        /// Its corner.
        corner: u32,
    },
    /// Where edges only seem to meet, or polygons cross.
    Apparent,
    /// On the border of the view, or of the octants of an undissolved map.
    Frame,
}

/// A vertex of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapVertex {
    /// The direction from the viewpoint, of length one; in a parallel view a point of the line, in
    /// scene units. Rounded.
    pub ray: [f64; 3],
    /// What it is.
    pub kind: VertexKind,
}

/// An edge of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MapEdge {
    /// The vertices at its ends.
    pub ends: [u32; 2],
    /// The face whose border runs along the edge, and the one whose border runs against it.
    pub faces: [u32; 2],
    /// The class.
    pub class: EdgeClass,
    /// What it is a part of; of a shadow the nearer polygon, else the smaller one.
    pub near: Option<Element>,
    /// The other polygon: of a shadow the one behind; `None` for a silhouette.
    pub far: Option<Element>,
}

/// What is seen in a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceKind {
    /// A polygon; of several the smallest.
    Polygon(PolygonId),
    /// Nothing.
    Background,
    /// What is not in the view.
    Outside,
}

/// A face of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFace {
    /// What is seen.
    pub kind: FaceKind,
    /// Polygons that flat edges joined to this face, without the first; by number.
    pub joined: Vec<PolygonId>,
    /// Polygons of the same plane that are seen here as well, at least in part; by number.
    pub coincident: Vec<PolygonId>,
    /// The solid angle in steradians; in a parallel view the area of the image in square scene
    /// units. Zero outside. Rounded.
    pub measure: f64,
    /// A half-edge of each border; none if the face is the whole view.
    pub borders: Vec<HalfEdge>,
}

impl MapFace {
    /// The polygon that owns the face, if there is one.
    #[must_use]
    pub fn polygon(&self) -> Option<PolygonId> {
        match self.kind {
            FaceKind::Polygon(id) => Some(id),
            FaceKind::Background | FaceKind::Outside => None,
        }
    }
}

/// An edge in one direction: edge number times two, plus one against the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HalfEdge(pub u32);

impl HalfEdge {
    /// The number of the edge.
    #[must_use]
    pub fn edge(self) -> u32 {
        self.0 / 2
    }

    /// The same edge in the other direction.
    #[must_use]
    pub fn twin(self) -> Self {
        Self(self.0 ^ 1)
    }
}

/// Counts of a map and of the work it took; they do not depend on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapWork {
    /// The sweep.
    pub sweep: SweepWork,
    /// Nodes of the occlusion tree.
    pub tree_nodes: usize,
    /// Leaves of the occlusion tree.
    pub tree_leaves: usize,
    /// Signs that the filters left to integers.
    pub exact_signs: u64,
}

/// The visibility map of a view.
#[derive(Clone, Debug)]
pub struct VisibilityMap {
    vertices: Vec<MapVertex>,
    edges: Vec<MapEdge>,
    faces: Vec<MapFace>,
    /// The half-edge after each one, around its face.
    next: Vec<HalfEdge>,
    /// Half-edges that start at each vertex: `out[first_out[v]..first_out[v + 1]]`.
    out: Vec<HalfEdge>,
    first_out: Vec<u32>,
    exact: Vec<antumbra_lines::ExactRay>,
    view: view::Seen,
    work: MapWork,
}

impl VisibilityMap {
    /// All vertices.
    #[must_use]
    pub fn vertices(&self) -> &[MapVertex] {
        &self.vertices
    }

    /// All edges.
    #[must_use]
    pub fn edges(&self) -> &[MapEdge] {
        &self.edges
    }

    /// All faces.
    #[must_use]
    pub fn faces(&self) -> &[MapFace] {
        &self.faces
    }

    /// The vertex where a half-edge starts.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[must_use]
    pub fn origin(&self, half: HalfEdge) -> u32 {
        self.edges[half.edge() as usize].ends[(half.0 % 2) as usize]
    }

    /// The face on whose border a half-edge lies.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[must_use]
    pub fn face(&self, half: HalfEdge) -> u32 {
        self.edges[half.edge() as usize].faces[(half.0 % 2) as usize]
    }

    /// The half-edge after one, around its face.
    ///
    /// # Panics
    /// If there is no such half-edge.
    #[must_use]
    pub fn next(&self, half: HalfEdge) -> HalfEdge {
        self.next[half.0 as usize]
    }

    /// The border that a half-edge belongs to, starting there.
    pub fn border(&self, start: HalfEdge) -> impl Iterator<Item = HalfEdge> {
        let rest = std::iter::successors(Some(self.next(start)), |&h| Some(self.next(h)));
        std::iter::once(start).chain(rest.take_while(move |&h| h != start))
    }

    /// The half-edges that start at a vertex, in order around it.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[must_use]
    pub fn around(&self, vertex: u32) -> &[HalfEdge] {
        let v = vertex as usize;
        &self.out[self.first_out[v] as usize..self.first_out[v + 1] as usize]
    }

    /// The direction of a vertex as integers without a common factor (decimal): equal for equal
    /// directions, whatever they were constructed from. In a parallel view the line (x, y, 1).
    ///
    /// # Panics
    /// If there is no such vertex.
    #[must_use]
    pub fn exact_direction(&self, vertex: u32) -> [String; 3] {
        antumbra_lines::primitive(&self.exact[vertex as usize]).map(|c| c.to_string())
    }

    /// Where the line of a vertex meets the plane of a polygon, in scene units. Rounded.
    ///
    /// # Panics
    /// If there is no such vertex or polygon.
    #[must_use]
    pub fn point_on(&self, scene: &Scene, vertex: u32, polygon: PolygonId) -> [f64; 3] {
        let ray = &self.exact[vertex as usize];
        self.view.meet(scene, ray, scene.polygon(polygon).plane)
    }

    /// The viewpoint on the grid, in scene units; `None` in a parallel view.
    #[must_use]
    pub fn eye(&self, scene: &Scene) -> Option<[f64; 3]> {
        self.view.eye().map(|e| scene.grid().to_scene(e))
    }

    /// Where the lines of a parallel view go: the direction of integers that was used.
    #[must_use]
    pub fn direction(&self) -> Option<[i32; 3]> {
        match self.view {
            view::Seen::Parallel(direction) => Some(direction),
            view::Seen::Point(_) => None,
        }
    }

    /// The solid angle (or area) of each object that is seen, by object. Sums of faces.
    #[must_use]
    pub fn object_measures(&self, scene: &Scene) -> Vec<(ObjectId, f64)> {
        let mut sums = std::collections::BTreeMap::new();
        for face in &self.faces {
            if let Some(id) = face.polygon() {
                *sums.entry(scene.polygon(id).object).or_insert(0.0) += face.measure;
            }
        }
        sums.into_iter().collect()
    }

    /// What it took.
    #[must_use]
    pub fn work(&self) -> &MapWork {
        &self.work
    }

    /// Checks every invariant: half-edges and vertices agree, borders close, every component is
    /// planar and Euler's relation V - E + F = C + 1 holds.
    ///
    /// # Errors
    /// The first violation found, as a sentence.
    pub fn sanity_check(&self) -> Result<(), String> {
        check::check(self)
    }
}

/// A scene prepared for maps; serves any number of views, from any number of threads.
#[derive(Clone, Debug)]
pub struct Mapper<'a> {
    scene: &'a Scene,
    twins: Twins,
}

impl<'a> Mapper<'a> {
    /// Prepares a scene: finds coplanar polygons that overlap. `n log n`.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            twins: Twins::of_scene(scene),
        }
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    pub(crate) fn twins(&self) -> &Twins {
        &self.twins
    }

    /// The visibility map of a view. The viewpoint is snapped to the grid; a polygon in whose plane
    /// it lies blocks no open set of lines and is not seen. Expected cost grows with what is seen.
    ///
    /// # Errors
    /// If the view is not finite, off the grid, or has no inside.
    pub fn map(
        &self,
        viewpoint: &Viewpoint,
        options: &MapOptions,
    ) -> Result<VisibilityMap, MapError> {
        view::map(self.scene, &self.twins, viewpoint, options, None)
    }

    /// As [`Mapper::map`] over some polygons only, inserted in a given order, without kD-tree and box
    /// tests. Dissolved, the map depends on which polygons there are, not on their order.
    ///
    /// # Errors
    /// As [`Mapper::map`].
    ///
    /// # Panics
    /// If the scene has no such polygon.
    pub fn map_in_order(
        &self,
        viewpoint: &Viewpoint,
        order: &[PolygonId],
        options: &MapOptions,
    ) -> Result<VisibilityMap, MapError> {
        view::map(self.scene, &self.twins, viewpoint, options, Some(order))
    }
}
