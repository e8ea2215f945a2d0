//! From a swept occlusion tree to a map: cells, walls, classes, dissolving, chains.

use std::collections::BTreeSet;

use antumbra_kernel::{Plane, Point};
use antumbra_lines::{Cone3, ExactRay, Leaf, LineSpace as _, Occluder, Ray3, Space3};
use antumbra_scene::{PolygonId, PolygonRef, Scene};
use antumbra_sweep::occlusion::{Sweep, Twins, View};

use super::angle::{flat_area, solid_angle, unit};
use super::cells::Cells;
use super::classify::{Classifier, EdgeClass, Label};
use super::mesh::{Mesh, merge_cells};
use super::view::{Seen, main_axis, meet_from};
use super::walls::{OUTSIDE, Walls};
use super::{
    Dissolve, FaceKind, HalfEdge, MapEdge, MapFace, MapOptions, MapVertex, MapWork, VertexKind,
    VisibilityMap,
};

pub(super) fn build<V: View<Space = Space3>>(
    scene: &Scene,
    twins: &Twins,
    mut sweep: Sweep<V>,
    seen: Seen,
    options: &MapOptions,
) -> VisibilityMap {
    let mut cells = Cells::of(&mut sweep);
    let mut space = std::mem::take(sweep.view.space());
    let mut walls = Walls::of(&cells, &space);
    walls.split_crossings(&mut cells, &mut space);
    let mesh = Mesh::of(&cells, &walls);
    let classifier = Classifier {
        scene,
        sweep: &sweep,
        cells: &cells,
        walls: &walls,
        crease: options.crease.cos(),
    };
    let labels = classifier.all(&space);
    let dissolved: Vec<bool> = labels
        .iter()
        .map(|label| dissolves(scene, label, options.dissolve))
        .collect();
    let mut assembly = Assembly {
        scene,
        cells: &cells,
        walls: &walls,
        origin: &mesh.origin,
        next: mesh.without(&dissolved),
        labels: &labels,
        dissolved: &dissolved,
        faces_of: merge_cells(cells.len(), &walls, &dissolved),
    };
    let faces = assembly.faces(&sweep, &seen);
    let mut map = assembly.chains(faces);
    name_vertices(&mut map, &assembly, &classifier, &space, &seen);
    map.view = seen;
    let [blocked, open, outside] = sweep.tree.leaf_counts();
    map.work = MapWork {
        sweep: sweep.work,
        tree_nodes: sweep.tree.nodes().len(),
        tree_leaves: blocked + open + outside,
        exact_signs: space.exact_signs(),
    };
    *sweep.view.space() = space;
    coincident(
        scene,
        twins,
        &mut sweep,
        &cells,
        &assembly.faces_of.0,
        &mut map,
    );
    map
}

/// The box around the part of a polygon that a cell shows, with a grid step to spare: the corners lie
/// on the polygon, so they are off by 2^-24 steps at most.
fn shown_box(
    space: &Space3,
    eye: Point,
    cells: &Cells,
    cell: usize,
    plane: &Plane,
) -> [[f64; 3]; 2] {
    let corners = cells
        .range(cell)
        .map(|c| meet_from(eye, &space.exact(cells.ray(c)), plane));
    corners.fold([[f64::MAX; 3], [f64::MIN; 3]], |[low, high], p| {
        let low = std::array::from_fn(|k| low[k].min(p[k] - 1.0));
        [low, std::array::from_fn(|k| high[k].max(p[k] + 1.0))]
    })
}

fn apart([low, high]: [[f64; 3]; 2], polygon: &PolygonRef<'_>) -> bool {
    (0..3).any(|k| {
        let mut at = polygon.corners.iter().map(|c| c.to_f64()[k]);
        at.clone().all(|c| c < low[k]) || at.all(|c| c > high[k])
    })
}

fn dissolves(scene: &Scene, label: &Label, dissolve: Dissolve) -> bool {
    let one_object = || match (label.near, label.far) {
        (Some(a), Some(b)) => scene.polygon(a.polygon).object == scene.polygon(b.polygon).object,
        _ => false,
    };
    match label.class {
        EdgeClass::Bsp => dissolve >= Dissolve::Bsp,
        EdgeClass::Flat => dissolve >= Dissolve::Flat && one_object(),
        _ => false,
    }
}

struct Assembly<'a> {
    scene: &'a Scene,
    cells: &'a Cells,
    walls: &'a Walls,
    origin: &'a [u32],
    /// Next half-edge among those that stay.
    next: Vec<u32>,
    labels: &'a [Label],
    dissolved: &'a [bool],
    /// The face of each cell and, last, of the outside; how many.
    faces_of: (Vec<u32>, u32),
}

impl Assembly<'_> {
    fn face_of_cell(&self, cell: u32) -> u32 {
        let place = if cell == OUTSIDE {
            self.cells.len() as u32
        } else {
            cell
        };
        self.faces_of.0[place as usize]
    }

    fn face_of(&self, half: u32) -> u32 {
        let cells = self.walls.segments[half as usize / 2].cells;
        self.face_of_cell(cells[(half % 2) as usize])
    }

    /// All faces with owners and measures, still without borders.
    fn faces<V: View<Space = Space3>>(&self, sweep: &Sweep<V>, seen: &Seen) -> Vec<MapFace> {
        let outside = MapFace {
            kind: FaceKind::Outside,
            joined: Vec::new(),
            coincident: Vec::new(),
            measure: 0.0,
            borders: Vec::new(),
        };
        let mut faces = vec![outside; self.faces_of.1 as usize];
        let mut rays = Vec::new();
        for cell in 0..self.cells.len() {
            rays.clear();
            let corners = self.cells.range(cell).map(|c| self.cells.ray(c).rounded());
            rays.extend(corners);
            let face = &mut faces[self.faces_of.0[cell] as usize];
            face.measure += match seen {
                Seen::Point(_) => solid_angle(&rays),
                Seen::Parallel(_) => flat_area(&rays),
            };
            match self.cells.leaves[cell] {
                Leaf::Blocked(Occluder(i)) => own(face, sweep.polygons[i as usize]),
                Leaf::Open | Leaf::Outside => face.kind = FaceKind::Background,
            }
        }
        let scale = match seen {
            Seen::Point(_) => 1.0,
            Seen::Parallel(d) => {
                // The image is (x, y) / d_a on the plane across the main axis.
                let length = d.iter().map(|&c| f64::from(c).powi(2)).sum::<f64>().sqrt();
                let main = f64::from(d[main_axis(*d)].abs());
                self.scene.grid().step().powi(2) / (main * length)
            }
        };
        for face in &mut faces {
            face.measure *= scale;
            face.joined.sort_unstable();
            face.joined.dedup();
        }
        faces
    }

    /// Whether the vertex is inside a straight edge: two half-edges leave it, which agree in all.
    fn passes(&self, half: u32) -> bool {
        let after = self.next[half as usize];
        let back = self.next[(after ^ 1) as usize];
        // Around a vertex of two edges: after `half` comes `after`, and after its twin, `half`'s twin.
        if back != half ^ 1 || after == half ^ 1 {
            return false;
        }
        let (s, t) = (half as usize / 2, after as usize / 2);
        let (a, b) = (&self.labels[s], &self.labels[t]);
        let same_far = match a.class {
            EdgeClass::Shadow => true,
            EdgeClass::Frame => self.walls.segments[s].wall == self.walls.segments[t].wall,
            _ => a.far == b.far,
        };
        a.class == b.class
            && a.near == b.near
            && same_far
            && self.face_of(half) == self.face_of(after)
            && self.face_of(half ^ 1) == self.face_of(after ^ 1)
    }

    /// The edges that stay, straight runs joined, and the vertices at their ends.
    fn chains(&mut self, faces: Vec<MapFace>) -> VisibilityMap {
        let n = self.next.len();
        let mut edges: Vec<MapEdge> = Vec::new();
        // First and last segment's half-edge of each edge, in its own direction.
        let mut spans: Vec<[u32; 2]> = Vec::new();
        let mut number = vec![u32::MAX; n];
        let mut vertex = vec![u32::MAX; self.walls.rays.len()];
        let mut rays = Vec::new();
        for segment in 0..n as u32 / 2 {
            if self.dissolved[segment as usize] || number[2 * segment as usize] != u32::MAX {
                continue;
            }
            let mut start = 2 * segment + 1;
            while self.passes(start) {
                start = self.next[start as usize];
            }
            start ^= 1;
            let edge = edges.len() as u32;
            let mut end = start;
            number[end as usize] = 2 * edge;
            while self.passes(end) {
                end = self.next[end as usize];
                number[end as usize] = 2 * edge;
                number[(end ^ 1) as usize] = 2 * edge + 1;
            }
            number[(start ^ 1) as usize] = 2 * edge + 1;
            number[(end ^ 1) as usize] = 2 * edge + 1;
            let mut name = |half: u32| {
                let slot = &mut vertex[self.origin[half as usize] as usize];
                if *slot == u32::MAX {
                    *slot = rays.len() as u32;
                    rays.push(self.origin[half as usize]);
                }
                *slot
            };
            let label = &self.labels[segment as usize];
            edges.push(MapEdge {
                ends: [name(start), name(end ^ 1)],
                faces: [self.face_of(start), self.face_of(start ^ 1)],
                class: label.class,
                near: label.near,
                far: label.far,
            });
            spans.push([start, end]);
        }
        let next = spans
            .iter()
            .flat_map(|&[start, end]| [self.next[end as usize], self.next[(start ^ 1) as usize]])
            .map(|h| HalfEdge(number[h as usize]))
            .collect();
        finish(edges, faces, next, rays)
    }
}

fn own(face: &mut MapFace, polygon: PolygonId) {
    match face.kind {
        FaceKind::Polygon(id) if id == polygon => {}
        FaceKind::Polygon(id) => {
            face.kind = FaceKind::Polygon(id.min(polygon));
            face.joined.push(id.max(polygon));
        }
        _ => face.kind = FaceKind::Polygon(polygon),
    }
}

/// Links vertices and faces to their half-edges. `rays` holds, for each vertex, its number among
/// the vertices of the walls; vertices get their rays later.
fn finish(
    edges: Vec<MapEdge>,
    mut faces: Vec<MapFace>,
    next: Vec<HalfEdge>,
    rays: Vec<u32>,
) -> VisibilityMap {
    let mut visited = vec![false; next.len()];
    for h in 0..next.len() as u32 {
        if visited[h as usize] {
            continue;
        }
        let face = edges[h as usize / 2].faces[(h % 2) as usize];
        faces[face as usize].borders.push(HalfEdge(h));
        let mut at = h;
        while !visited[at as usize] {
            visited[at as usize] = true;
            at = next[at as usize].0;
        }
    }
    let mut first_half = vec![u32::MAX; rays.len()];
    for (edge, e) in edges.iter().zip(0..) {
        for (k, v) in edge.ends.into_iter().enumerate() {
            let slot = &mut first_half[v as usize];
            *slot = (*slot).min(2 * e + k as u32);
        }
    }
    let (mut out, mut first_out) = (Vec::with_capacity(next.len()), vec![0]);
    for &start in &first_half {
        let mut h = start;
        loop {
            out.push(HalfEdge(h));
            h = next[(h ^ 1) as usize].0;
            if h == start {
                break;
            }
        }
        first_out.push(out.len() as u32);
    }
    let vertices = rays
        .iter()
        .map(|&v| MapVertex {
            ray: [f64::from(v), 0.0, 0.0],
            kind: VertexKind::Apparent,
        })
        .collect();
    VisibilityMap {
        vertices,
        edges,
        faces,
        next,
        out,
        first_out,
        exact: Vec::new(),
        view: Seen::Parallel([0; 3]),
        work: MapWork::default(),
    }
}

/// Gives vertices their directions and kinds.
fn name_vertices<V: View<Space = Space3>>(
    map: &mut VisibilityMap,
    assembly: &Assembly<'_>,
    classifier: &Classifier<'_, V>,
    space: &Space3,
    seen: &Seen,
) {
    let mut occluder_of = vec![None; classifier.scene.polygon_count()];
    for (&id, i) in classifier.sweep.polygons.iter().zip(0..) {
        occluder_of[id.0 as usize] = Some(Occluder(i));
    }
    let rays: Vec<&Ray3> = map
        .vertices
        .iter()
        .map(|v| assembly.cells.ray(assembly.walls.rays[v.ray[0] as usize]))
        .collect();
    let kinds: Vec<VertexKind> = (0..rays.len() as u32)
        .map(|v| {
            let mut kind = VertexKind::Frame;
            for half in map.around(v) {
                let edge = &map.edges[half.edge() as usize];
                if !matches!(edge.class, EdgeClass::Frame | EdgeClass::Bsp) {
                    kind = kind.min(VertexKind::Apparent);
                }
                for element in [edge.near, edge.far].into_iter().flatten() {
                    let Some(k) = element.edge else { continue };
                    let Some(of) = occluder_of[element.polygon.0 as usize] else {
                        continue;
                    };
                    if let Some(corner) = classifier.corner(space, of, k, rays[v as usize]) {
                        let polygon = element.polygon;
                        kind = kind.min(VertexKind::Scene { polygon, corner });
                    }
                }
            }
            kind
        })
        .collect();
    let exact: Vec<ExactRay> = rays.iter().map(|ray| space.exact(ray)).collect();
    for ((vertex, kind), ray) in map.vertices.iter_mut().zip(kinds).zip(&exact) {
        vertex.kind = kind;
        vertex.ray = match seen {
            Seen::Point(_) => unit(ray.to_f64()),
            Seen::Parallel(d) => {
                let p = Seen::on_line(*d, ray.to_f64());
                classifier.scene.grid().to_scene_f64(p)
            }
        };
    }
    map.exact = exact;
}

/// Lists in each face the coplanar polygons that are seen there as well.
fn coincident<V: View<Space = Space3>>(
    scene: &Scene,
    twins: &Twins,
    sweep: &mut Sweep<V>,
    cells: &Cells,
    face_of: &[u32],
    map: &mut VisibilityMap,
) {
    let mut found: BTreeSet<(u32, PolygonId)> = BTreeSet::new();
    for cell in 0..cells.len() {
        let Leaf::Blocked(Occluder(i)) = cells.leaves[cell] else {
            continue;
        };
        let owner = sweep.polygons[i as usize];
        if twins.of(owner).is_empty() {
            continue;
        }
        let plane = scene.polygon(owner).plane;
        let space = sweep.view.space();
        let shown = map
            .view
            .eye()
            .map(|eye| shown_box(space, eye, cells, cell, plane));
        for &twin in twins.of(owner) {
            let pair = (face_of[cell], twin);
            if twin < owner || found.contains(&pair) {
                continue;
            }
            if shown.is_some_and(|shown| apart(shown, &scene.polygon(twin))) {
                continue;
            }
            let mark = sweep.view.mark();
            if let Some((cone, _)) = sweep.view.occluder(&scene.polygon(twin)) {
                let space = sweep.view.space();
                if overlap(space, &cone, cells, cell) {
                    found.insert(pair);
                }
            }
            sweep.view.rewind(mark);
        }
    }
    for (face, twin) in found {
        map.faces[face as usize].coincident.push(twin);
    }
}

/// Whether a cone and a cell have a common inside: no facet of one separates them.
fn overlap(space: &Space3, cone: &Cone3, cells: &Cells, cell: usize) -> bool {
    let corners = &cells.corners[cells.first[cell] as usize..cells.first[cell + 1] as usize];
    let separates = |facets: &[antumbra_lines::Corner3], rays: &[antumbra_lines::Corner3]| {
        facets.iter().any(|f| {
            let inside = f.side.sign();
            rays.iter().all(|r| space.sign(f.plane, &r.ray) != inside)
        })
    };
    !separates(&cone.corners, corners) && !separates(corners, &cone.corners)
}
