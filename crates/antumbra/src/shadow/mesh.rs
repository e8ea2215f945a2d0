//! The approximate discontinuity mesh of a quadrangle of light, from the maps of its corners.
//!
//! After [Bittner02, 5.7]. The shadow edges of the four maps, put on the polygons behind them, are
//! exact discontinuities: planes through a corner of the light and an edge of the scene. The others are
//! swept by an edge of the light. Where the maps of its two ends have the same vertex with the
//! same shadow edges on the same polygon, the light's edge moves that vertex from one place to the
//! other: along a straight line if it is a corner of the scene (a plane through the light's edge and
//! the corner), else along a conic (three edges), of which the chord is taken.

use std::collections::BTreeMap;

use antumbra_kernel::Point;
use antumbra_scene::{PolygonId, Scene};

use crate::map::{
    EdgeClass, Element, MapError, MapOptions, Mapper, VertexKind, Viewpoint, VisibilityMap,
};

/// What makes a discontinuity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Event {
    /// A corner of the light and an edge of the scene. Exact but for rounding.
    LightCorner,
    /// An edge of the light and a corner of the scene: on the line of the discontinuity; its ends
    /// are seen from the ends of the light's edge, what is between may be hidden in part.
    LightEdge,
    /// An edge of the light and two edges of the scene: the chord of a conic.
    ThreeEdges,
}

impl Event {
    /// All events.
    pub const ALL: [Self; 3] = [Self::LightCorner, Self::LightEdge, Self::ThreeEdges];

    /// The name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::LightCorner => "light-corner",
            Self::LightEdge => "light-edge",
            Self::ThreeEdges => "three-edges",
        }
    }
}

/// A straight piece of the mesh, on a polygon.
#[derive(Clone, Debug, PartialEq)]
pub struct Discontinuity {
    /// The polygon it lies on.
    pub polygon: PolygonId,
    /// What makes it.
    pub event: Event,
    /// The corners of the light by number: one, or the two ends of the light's edge.
    pub light: Vec<u32>,
    /// The edges of the scene that cast it; of a corner of the scene, those that meet there.
    pub cast_by: Vec<Element>,
    /// From where to where, in scene units. Rounded.
    pub ends: [[f64; 3]; 2],
}

/// The discontinuities of all polygons.
#[derive(Clone, Debug)]
pub struct DiscontinuityMesh {
    /// The corners of the light on the grid, in scene units.
    pub light: [[f64; 3]; 4],
    /// All pieces: those of the corners of the light in order, then those of its edges.
    pub pieces: Vec<Discontinuity>,
}

/// The approximate discontinuity mesh of a light with four corners in order: four maps, and a match
/// of their vertices.
///
/// Approximate: what only points inside the light see is not found, and conics are chords.
///
/// # Errors
/// If a corner is not finite or off the grid, two neighbors are one point of the grid, or the corners do
/// not go round a convex quadrangle. A fourth corner may be off the plane of the others.
pub fn area_light(
    mapper: &Mapper<'_>,
    corners: [[f64; 3]; 4],
) -> Result<DiscontinuityMesh, MapError> {
    let scene = mapper.scene();
    let mut points = [[0_i128; 3]; 4];
    let mut light = [[0.0; 3]; 4];
    for (k, corner) in corners.into_iter().enumerate() {
        let point = scene.grid().snap(corner).map_err(MapError::Snap)?;
        points[k] = point.to_i64().map(i128::from);
        light[k] = scene.grid().to_scene(point);
    }
    if (0..4).any(|k| light[k] == light[(k + 1) % 4]) {
        return Err(MapError::NoLight);
    }
    if !goes_round(points) {
        return Err(MapError::CrossedLight);
    }
    let mut pieces = Vec::new();
    let mut marks = Vec::new();
    for (corner, k) in light.iter().zip(0..) {
        let map = mapper.map(&Viewpoint::Sphere(*corner), &MapOptions::default())?;
        shadow_edges(scene, &map, k, &mut pieces);
        marks.push(vertices(scene, &map));
    }
    for k in 0..4 {
        let next = (k + 1) % 4;
        for (key, here) in &marks[k] {
            let Some(there) = marks[next].get(key) else {
                continue;
            };
            let ends = [here.at, there.at];
            // A corner of the scene on the receiver itself does not move.
            if ends[0] != ends[1] {
                pieces.push(Discontinuity {
                    polygon: key.0,
                    event: match key.1 {
                        Mark::Corner(_) => Event::LightEdge,
                        Mark::Edges(_) => Event::ThreeEdges,
                    },
                    light: vec![k as u32, next as u32],
                    cast_by: here.cast_by.clone(),
                    ends,
                });
            }
        }
    }
    Ok(DiscontinuityMesh { light, pieces })
}

/// Whether four points follow each other around a quadrangle: all turn the same way, or go straight on.
fn goes_round(points: [[i128; 3]; 4]) -> bool {
    let sub = |a: [i128; 3], b: [i128; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let turn = |k: usize| {
        let [a, b, c] = [k, k + 1, k + 2].map(|i| points[i % 4]);
        let (u, v) = (sub(b, a), sub(c, b));
        [
            u[1] * v[2] - u[2] * v[1],
            u[2] * v[0] - u[0] * v[2],
            u[0] * v[1] - u[1] * v[0],
        ]
    };
    let turns = [0, 1, 2, 3].map(turn);
    let all: [i128; 3] = std::array::from_fn(|k| turns.iter().map(|t| t[k]).sum());
    let along = |t: &[i128; 3]| (0..3).map(|k| t[k] * all[k]).sum::<i128>();
    all != [0; 3] && turns.iter().all(|t| along(t) >= 0)
}

/// The shadow edges of a map on the polygons behind them.
fn shadow_edges(scene: &Scene, map: &VisibilityMap, corner: u32, out: &mut Vec<Discontinuity>) {
    for edge in map.edges().iter().filter(|e| e.class == EdgeClass::Shadow) {
        let (Some(near), Some(far)) = (edge.near, edge.far) else {
            continue;
        };
        let ends = edge.ends.map(|v| map.point_on(scene, v, far.polygon));
        out.push(Discontinuity {
            polygon: far.polygon,
            event: Event::LightCorner,
            light: vec![corner],
            cast_by: vec![near],
            ends,
        });
    }
}

/// What casts the shadow of a vertex, in terms of the scene: the same from any corner of the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Mark {
    /// A corner of the scene.
    Corner([i32; 3]),
    /// Two edges of the scene that seem to cross, each with its smaller end first.
    Edges([[[i32; 3]; 2]; 2]),
}

struct Shadow {
    at: [f64; 3],
    cast_by: Vec<Element>,
}

/// The shadows of the vertices of a map on the polygons behind.
fn vertices(scene: &Scene, map: &VisibilityMap) -> BTreeMap<(PolygonId, Mark), Shadow> {
    let mut out = BTreeMap::new();
    for v in 0..map.vertices().len() as u32 {
        let mut on: BTreeMap<PolygonId, Vec<Element>> = BTreeMap::new();
        for half in map.around(v) {
            let edge = &map.edges()[half.edge() as usize];
            if let (EdgeClass::Shadow, Some(near), Some(far)) = (edge.class, edge.near, edge.far) {
                on.entry(far.polygon).or_default().push(near);
            }
        }
        for (polygon, mut cast_by) in on {
            cast_by.sort_unstable();
            let kind = map.vertices()[v as usize].kind;
            if let Some(mark) = mark(scene, kind, &cast_by) {
                let at = map.point_on(scene, v, polygon);
                out.entry((polygon, mark)).or_insert(Shadow { at, cast_by });
            }
        }
    }
    out
}

fn mark(scene: &Scene, kind: VertexKind, cast_by: &[Element]) -> Option<Mark> {
    let edges = cast_by.iter().filter_map(|e| segment(scene, *e));
    let mut edges: Vec<[Point; 2]> = edges.collect();
    if edges.len() != cast_by.len() {
        return None;
    }
    if let VertexKind::Scene { polygon, corner } = kind {
        let corner = scene.polygon(polygon).corners[corner as usize];
        if edges.iter().all(|e| e.contains(&corner)) {
            return Some(Mark::Corner(corner.to_array()));
        }
    }
    edges.sort_unstable_by_key(|e| e.map(Point::to_array));
    edges.dedup();
    match edges[..] {
        [a, b] => Some(Mark::Edges([a, b].map(|e| e.map(Point::to_array)))),
        _ => None,
    }
}

/// The ends of an edge of the scene, the smaller first.
fn segment(scene: &Scene, element: Element) -> Option<[Point; 2]> {
    let corners = scene.polygon(element.polygon).corners;
    let k = element.edge? as usize;
    let mut ends = [corners[k], corners[(k + 1) % corners.len()]];
    ends.sort_unstable_by_key(|p| p.to_array());
    Some(ends)
}
