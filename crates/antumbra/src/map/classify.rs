//! What an edge of the view is: silhouette, shadow, corner, flat, intersection, or nothing but a cut.
//!
//! After [Bittner02, 5.6.3]. Each decision but the crease angle is exact: who is nearer at both ends,
//! and which edge of a polygon the segment lies on.

use antumbra_kernel::Sign;
use antumbra_lines::{Leaf, LineSpace as _, Occluder, Ray3, Space3};
use antumbra_scene::{PolygonId, Scene};
use antumbra_sweep::occlusion::{Sides as _, Sweep, View};

use super::cells::Cells;
use super::walls::{OUTSIDE, Segment, Walls};

/// The class of an edge [Bittner02, 5.6.3].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EdgeClass {
    /// A polygon against the background.
    Silhouette,
    /// A depth discontinuity: the nearer polygon ends, the farther one goes on behind it.
    Shadow,
    /// Two polygons that meet along the edge and form an angle above the crease angle.
    Corner,
    /// Two polygons that meet along the edge and go on smoothly.
    Flat,
    /// Two polygons that cross each other; the edge lies inside both.
    Intersection,
    /// A cut of the occlusion tree: the same on both sides.
    Bsp,
    /// The border of the view.
    Frame,
}

impl EdgeClass {
    /// All classes, in the order of drawing layers.
    pub const ALL: [Self; 7] = [
        Self::Silhouette,
        Self::Shadow,
        Self::Corner,
        Self::Flat,
        Self::Intersection,
        Self::Bsp,
        Self::Frame,
    ];

    /// The name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Silhouette => "silhouette",
            Self::Shadow => "shadow",
            Self::Corner => "corner",
            Self::Flat => "flat",
            Self::Intersection => "intersection",
            Self::Bsp => "bsp",
            Self::Frame => "frame",
        }
    }
}

/// What an edge is a part of: an edge of a polygon, or the inside of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Element {
    /// The polygon.
    pub polygon: PolygonId,
    /// Its edge, from the corner of this number to the next; `None` for the inside.
    pub edge: Option<u32>,
}

/// A classified segment: the nearer (or smaller) element first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Label {
    pub(super) class: EdgeClass,
    pub(super) near: Option<Element>,
    pub(super) far: Option<Element>,
    /// Whether the nearer polygon is that of the segment's second cell.
    pub(super) swapped: bool,
}

impl Label {
    fn plain(class: EdgeClass) -> Self {
        Self {
            class,
            near: None,
            far: None,
            swapped: false,
        }
    }
}

pub(super) struct Classifier<'a, V: View<Space = Space3>> {
    pub(super) scene: &'a Scene,
    pub(super) sweep: &'a Sweep<V>,
    pub(super) cells: &'a Cells,
    pub(super) walls: &'a Walls,
    /// The cosine of the crease angle.
    pub(super) crease: f64,
}

impl<V: View<Space = Space3>> Classifier<'_, V> {
    pub(super) fn all(&self, space: &Space3) -> Vec<Label> {
        let segments = self.walls.segments.iter();
        segments.map(|s| self.label(space, s)).collect()
    }

    fn label(&self, space: &Space3, segment: &Segment) -> Label {
        if segment.cells[1] == OUTSIDE {
            return Label::plain(EdgeClass::Frame);
        }
        let leaf = |i: usize| self.cells.leaves[segment.cells[i] as usize];
        let ends = [segment.from, segment.to].map(|c| self.cells.ray(c));
        match (leaf(0), leaf(1)) {
            (a, b) if a == b => Label::plain(EdgeClass::Bsp),
            (Leaf::Blocked(a), Leaf::Blocked(b)) => {
                self.between(space, [a, b], segment.nearer, ends)
            }
            (Leaf::Blocked(a), _) => self.silhouette(space, a, ends, false),
            (_, Leaf::Blocked(b)) => self.silhouette(space, b, ends, true),
            _ => Label::plain(EdgeClass::Frame),
        }
    }

    fn silhouette(&self, space: &Space3, of: Occluder, ends: [&Ray3; 2], swapped: bool) -> Label {
        Label {
            class: EdgeClass::Silhouette,
            near: Some(self.element(space, of, ends)),
            far: None,
            swapped,
        }
    }

    fn between(
        &self,
        space: &Space3,
        [a, b]: [Occluder; 2],
        [from, to]: [Sign; 2],
        ends: [&Ray3; 2],
    ) -> Label {
        let sign = if from.is_zero() { to } else { from };
        if sign == Sign::Zero {
            return self.contact(space, a, b, ends);
        }
        let swapped = sign.is_negative();
        let (near, far) = if swapped { (b, a) } else { (a, b) };
        Label {
            class: EdgeClass::Shadow,
            near: Some(self.element(space, near, ends)),
            far: Some(Element {
                polygon: self.polygon(far),
                edge: None,
            }),
            swapped,
        }
    }

    /// Two polygons that meet along the segment.
    fn contact(&self, space: &Space3, a: Occluder, b: Occluder, ends: [&Ray3; 2]) -> Label {
        let (mut near, mut far) = (self.element(space, a, ends), self.element(space, b, ends));
        let swapped = far.polygon < near.polygon;
        if swapped {
            std::mem::swap(&mut near, &mut far);
        }
        let class = if near.edge.is_none() && far.edge.is_none() {
            EdgeClass::Intersection
        } else if self.is_smooth(near.polygon, far.polygon) {
            EdgeClass::Flat
        } else {
            EdgeClass::Corner
        };
        Label {
            class,
            near: Some(near),
            far: Some(far),
            swapped,
        }
    }

    /// Whether two planes, both seen from the source, differ by less than the crease angle. Polygons
    /// of one plane always do.
    fn is_smooth(&self, a: PolygonId, b: PolygonId) -> bool {
        let (p, q) = (self.scene.polygon(a).plane, self.scene.polygon(b).plane);
        if p == q {
            return true;
        }
        let sides = self.sweep.view.sides();
        let turn = f64::from(sides.away(p).to_i8() * sides.away(q).to_i8());
        let (m, n) = (p.normal.map(|c| c as f64), q.normal.map(|c| c as f64));
        let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        turn * dot(m, n) >= self.crease * (dot(m, m) * dot(n, n)).sqrt()
    }

    fn polygon(&self, occluder: Occluder) -> PolygonId {
        self.sweep.polygons[occluder.0 as usize]
    }

    /// The edge of an occluder that a segment lies on. At most one does.
    fn element(&self, space: &Space3, of: Occluder, ends: [&Ray3; 2]) -> Element {
        let polygon = self.polygon(of);
        let n = self.scene.polygon(polygon).corners.len();
        let edge = (0..n).find(|&k| {
            let plane = self.sweep.view.edge_plane(of, k);
            ends.iter().all(|ray| space.sign(plane, ray).is_zero())
        });
        Element {
            polygon,
            edge: edge.map(|k| k as u32),
        }
    }

    /// The corner of a polygon that a ray on its edge meets, if it meets one.
    pub(super) fn corner(
        &self,
        space: &Space3,
        of: Occluder,
        edge: u32,
        ray: &Ray3,
    ) -> Option<u32> {
        let n = self.scene.polygon(self.polygon(of)).corners.len() as u32;
        let on = |k: u32| {
            let plane = self.sweep.view.edge_plane(of, k as usize);
            space.sign(plane, ray).is_zero()
        };
        if on((edge + n - 1) % n) {
            Some(edge)
        } else if on((edge + 1) % n) {
            Some((edge + 1) % n)
        } else {
            None
        }
    }
}
