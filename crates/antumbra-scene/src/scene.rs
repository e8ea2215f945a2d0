//! The scene: named objects made of convex planar polygons on the integer grid.

use std::ops::Range;

use antumbra_kernel::{Aabb, Grid, Plane, Point};

use crate::kd::KdTree;

mod check;

/// The number of an object, zero-based in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u32);

/// The number of a polygon of a scene; the polygons of an object are consecutive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PolygonId(pub u32);

impl ObjectId {
    /// The number as an index.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl PolygonId {
    /// The number as an index.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A set of polygons with one name: the unit of every potentially visible set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Object {
    /// The name in the file, or the decimal id where the file has none. Need not be unique.
    pub name: String,
    /// The class of its first part, as written in the file. Parts may differ: whether a polygon
    /// is an occluder is said by [`PolygonRef::occludes`].
    pub class: Option<String>,
    /// Its polygons, as a range of [`PolygonId`]s; may be empty.
    pub polygons: Range<u32>,
}

/// A closed, convex, planar polygon of the scene, seen in place.
#[derive(Clone, Copy, Debug)]
pub struct PolygonRef<'a> {
    /// Its number.
    pub id: PolygonId,
    /// The object it belongs to.
    pub object: ObjectId,
    /// At least three corners in order, exactly coplanar and strictly convex.
    pub corners: &'a [Point],
    /// Its plane; the corners turn counter-clockwise about the normal. The normal is primitive and
    /// its first non-zero component positive: polygons are coplanar if and only if their planes
    /// are equal.
    pub plane: &'a Plane,
    /// Whether it is an occluder.
    pub occludes: bool,
}

impl PolygonRef<'_> {
    /// The smallest box around the polygon.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let first = self.corners[0];
        self.corners[1..].iter().fold(
            Aabb {
                min: first,
                max: first,
            },
            |b, &p| b.with(p),
        )
    }
}

/// An immutable snapped scene with its kD-tree. Made by [`crate::SceneBuilder`].
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) grid: Grid,
    pub(crate) objects: Vec<Object>,
    pub(crate) corners: Vec<Point>,
    /// `corners[first[i]..first[i + 1]]` are the corners of polygon `i`.
    pub(crate) first: Vec<u32>,
    pub(crate) planes: Vec<Plane>,
    pub(crate) owners: Vec<ObjectId>,
    pub(crate) occludes: Vec<bool>,
    pub(crate) bounds: Aabb,
    pub(crate) kd: KdTree,
}

impl Scene {
    /// The grid all coordinates refer to.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// All objects; index = [`ObjectId`].
    #[must_use]
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// One object.
    #[must_use]
    pub fn object(&self, id: ObjectId) -> &Object {
        &self.objects[id.index()]
    }

    /// How many polygons there are.
    #[must_use]
    pub fn polygon_count(&self) -> usize {
        self.planes.len()
    }

    /// One polygon.
    ///
    /// # Panics
    /// If the scene has no such polygon.
    #[inline]
    #[must_use]
    pub fn polygon(&self, id: PolygonId) -> PolygonRef<'_> {
        let i = id.index();
        let object = self.owners[i];
        PolygonRef {
            id,
            object,
            corners: &self.corners[self.first[i] as usize..self.first[i + 1] as usize],
            plane: &self.planes[i],
            occludes: self.occludes[i],
        }
    }

    /// All polygons in order.
    pub fn polygons(&self) -> impl Iterator<Item = PolygonRef<'_>> {
        (0..self.planes.len()).map(|i| self.polygon(PolygonId(i as u32)))
    }

    /// The smallest box around all polygons (a point at the origin if there are none).
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The spatial hierarchy over all polygons.
    #[must_use]
    pub fn kd(&self) -> &KdTree {
        &self.kd
    }

    /// The polygons of an object.
    ///
    /// # Panics
    /// If the scene has no such object.
    pub fn polygons_of(&self, id: ObjectId) -> impl Iterator<Item = PolygonRef<'_>> {
        self.objects[id.index()]
            .polygons
            .clone()
            .map(|i| self.polygon(PolygonId(i)))
    }

    /// The smallest box around the polygons of an object; `None` if it has none.
    ///
    /// # Panics
    /// If the scene has no such object.
    #[must_use]
    pub fn object_bounds(&self, id: ObjectId) -> Option<Aabb> {
        self.polygons_of(id)
            .map(|polygon| polygon.bounds())
            .reduce(Aabb::union)
    }

    /// The object with a name, or with this decimal id; of several with one name the first.
    /// A name goes before an id.
    #[must_use]
    pub fn find_object(&self, name: &str) -> Option<ObjectId> {
        let by_name = self.objects.iter().position(|object| object.name == name);
        let by_id = || {
            name.parse::<usize>()
                .ok()
                .filter(|&i| i < self.objects.len())
        };
        by_name.or_else(by_id).map(|i| ObjectId(i as u32))
    }

    /// Checks every invariant of a scene and says which one is broken.
    ///
    /// # Errors
    /// The first violation found, as a sentence: a polygon that is not planar, not strictly convex
    /// or not counter-clockwise about a canonical normal, inconsistent ranges, a polygon missing
    /// from a leaf of the kD-tree, or a wrong box.
    pub fn sanity_check(&self) -> Result<(), String> {
        check::check(self)
    }
}
