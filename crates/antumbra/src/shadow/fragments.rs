//! A point light: every polygon is sent down the occlusion tree of the light.
//!
//! After [Bittner02, 5.7]. The map itself knows the lit parts only; the same walk over the tree that
//! makes its cells gives both parts of a polygon, also of one that does not occlude.

use antumbra_kernel::Point;
use antumbra_lines::{Child, Cone3, Cut, Half, Leaf, LineSpace as _, Occluder, Slot, Space3, Wall};
use antumbra_scene::{PolygonRef, Scene};
use antumbra_sweep::occlusion::{PointView, Sweep, SweepOptions, View as _, sweep};

use super::{Fragment, Lighting, Shadows};
use crate::map::{MapError, Mapper, meet_from};

/// The lit and shadowed fragments of all polygons for a point light, which is snapped to the grid.
///
/// Polygons are lit on both sides; coincident ones do not shade each other; those that do not occlude
/// are lit and shaded, but cast no shadow. Cuts that separate nothing are undone. Expected cost: the
/// map, and for every polygon a way down its tree.
///
/// # Errors
/// If the light is not finite or off the grid.
pub fn point_light(mapper: &Mapper<'_>, light: [f64; 3]) -> Result<Shadows, MapError> {
    let scene = mapper.scene();
    let light = scene.grid().snap(light).map_err(MapError::Snap)?;
    let view = PointView::sphere(light);
    let mut caster = Caster {
        scene,
        light,
        sweep: sweep(scene, mapper.twins(), view, &SweepOptions::default()),
    };
    let mut fragments = Vec::new();
    for polygon in scene.polygons() {
        caster.polygon(&polygon, &mut fragments);
    }
    Ok(Shadows { light, fragments })
}

struct Caster<'a> {
    scene: &'a Scene,
    light: Point,
    sweep: Sweep<PointView>,
}

/// What is left to do for a polygon.
enum Step {
    /// Cut a piece along the tree below a child.
    Visit(Child, Cone3),
    /// All fragments since a number are those of one piece.
    Join(usize, Cone3),
}

impl Caster<'_> {
    fn polygon(&mut self, polygon: &PolygonRef<'_>, out: &mut Vec<Fragment>) {
        let whole = |lighting| Fragment {
            polygon: polygon.id,
            lighting,
            corners: polygon
                .corners
                .iter()
                .map(|&c| self.scene.grid().to_scene(c))
                .collect(),
        };
        let mark = self.sweep.view.mark();
        let Some((cone, receiver)) = self.sweep.view.occluder(polygon) else {
            out.push(whole(Lighting::EdgeOn));
            return;
        };
        let parts = self.parts(polygon, cone, receiver);
        match &parts[..] {
            [(lighting, _)] => out.push(whole(*lighting)),
            _ => {
                let fragment = |(lighting, cone): &(Lighting, Cone3)| Fragment {
                    polygon: polygon.id,
                    lighting: *lighting,
                    corners: self.corners(polygon, cone),
                };
                out.extend(parts.iter().map(fragment));
            }
        }
        let space = self.sweep.view.space();
        parts.into_iter().for_each(|(_, cone)| space.discard(cone));
        self.sweep.view.rewind(mark);
    }

    /// The pieces of a polygon's cone, lit or shadowed; one if it is the same all over.
    fn parts(
        &mut self,
        polygon: &PolygonRef<'_>,
        cone: Cone3,
        receiver: Occluder,
    ) -> Vec<(Lighting, Cone3)> {
        let Sweep {
            view,
            tree,
            polygons,
            ..
        } = &mut self.sweep;
        let space = view.space();
        let mut parts: Vec<(Lighting, Cone3)> = Vec::new();
        let mut steps = vec![Step::Visit(tree.child(Slot::Root), cone)];
        while let Some(step) = steps.pop() {
            match step {
                Step::Visit(Child::Node(node), piece) => {
                    let node_of = tree.nodes()[node as usize];
                    let whole = piece.clone();
                    match space.cut(piece, node_of.plane, Wall(node)) {
                        Cut::Whole(half, piece) => {
                            space.discard(whole);
                            steps.push(Step::Visit(node_of.children[half.index()], piece));
                        }
                        Cut::Parts([negative, positive]) => {
                            steps.push(Step::Join(parts.len(), whole));
                            steps.push(Step::Visit(node_of.children[1], positive));
                            steps.push(Step::Visit(node_of.children[0], negative));
                        }
                    }
                }
                Step::Visit(Child::Leaf(Leaf::Blocked(old)), piece) => {
                    let plane = self.scene.polygon(polygons[old.0 as usize]).plane;
                    if plane == polygon.plane {
                        parts.push((Lighting::Lit, piece));
                    } else {
                        compare(space, piece, receiver, old, &mut parts);
                    }
                }
                Step::Visit(Child::Leaf(Leaf::Open | Leaf::Outside), piece) => {
                    parts.push((Lighting::Lit, piece));
                }
                Step::Join(first, whole) => {
                    let lighting = parts[first].0;
                    if parts[first..].iter().all(|part| part.0 == lighting) {
                        parts.truncate(first);
                        parts.push((lighting, whole));
                    }
                }
            }
        }
        parts
    }

    /// The corners of a part in scene units.
    fn corners(&self, polygon: &PolygonRef<'_>, cone: &Cone3) -> Vec<[f64; 3]> {
        let space = self.sweep.view.space_ref();
        let at = |ray| {
            let p = meet_from(self.light, &space.exact(ray), polygon.plane);
            self.scene.grid().to_scene_f64(p)
        };
        let mut corners: Vec<[f64; 3]> = space.rays(cone).map(at).collect();
        // Cones turn about the way from the light.
        if polygon.plane.side(self.light).is_positive() {
            corners.reverse();
        }
        corners
    }
}

/// Lit where the receiver is in front of what blocks the leaf, shadowed where it is behind.
fn compare(
    space: &mut Space3,
    piece: Cone3,
    receiver: Occluder,
    old: Occluder,
    parts: &mut Vec<(Lighting, Cone3)>,
) {
    let signs = piece
        .corners
        .iter()
        .map(|c| space.nearer(receiver, old, &c.ray));
    let found = signs.fold([false; 2], |[front, behind], s| {
        [front || s.is_positive(), behind || s.is_negative()]
    });
    let lighting = |half| match half {
        Half::Positive => Lighting::Lit,
        Half::Negative => Lighting::Shadowed,
    };
    if found == [true, true] {
        let plane = space.common_plane(receiver, old);
        match space.cut(piece, plane, Wall::NONE) {
            Cut::Whole(half, piece) => parts.push((lighting(half), piece)),
            Cut::Parts([behind, front]) => {
                parts.push((Lighting::Shadowed, behind));
                parts.push((Lighting::Lit, front));
            }
        }
    } else {
        let half = if found[0] {
            Half::Positive
        } else {
            Half::Negative
        };
        parts.push((lighting(half), piece));
    }
}
