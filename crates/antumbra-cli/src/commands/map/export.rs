//! The whole map as JSON: vertices, edges and faces by number, with owners and adjacency.

use antumbra::map::{Element, FaceKind, VertexKind, VisibilityMap};
use antumbra_scene::{PolygonId, Scene};
use serde_json::{Value, json};

/// All of a map. Polygons are numbered within their objects.
pub(super) fn export(scene: &Scene, map: &VisibilityMap) -> Value {
    let vertices: Vec<Value> = (0..map.vertices().len() as u32)
        .map(|v| vertex(scene, map, v))
        .collect();
    let edges: Vec<Value> = map
        .edges()
        .iter()
        .map(|edge| {
            json!({
                "vertices": edge.ends,
                "faces": edge.faces,
                "class": edge.class.name(),
                "near": edge.near.map(|e| element(scene, e)),
                "far": edge.far.map(|e| element(scene, e)),
            })
        })
        .collect();
    let faces: Vec<Value> = map
        .faces()
        .iter()
        .map(|face| {
            let kind = match face.kind {
                FaceKind::Polygon(_) => "polygon",
                FaceKind::Background => "background",
                FaceKind::Outside => "outside",
            };
            let list = |ids: &[PolygonId]| -> Vec<Value> {
                ids.iter().map(|&id| polygon(scene, id)).collect()
            };
            let borders: Vec<Vec<u32>> = face
                .borders
                .iter()
                .map(|&h| map.border(h).map(|h| h.0).collect())
                .collect();
            json!({
                "kind": kind,
                "polygon": face.polygon().map(|id| polygon(scene, id)),
                "joined": list(&face.joined),
                "coincident": list(&face.coincident),
                "measure": face.measure,
                "borders": borders,
            })
        })
        .collect();
    json!({
        "eye": map.eye(scene),
        "direction": map.direction(),
        "half_edges": "number of the edge times two, plus one against it; borders list half-edges",
        "vertices": vertices,
        "edges": edges,
        "faces": faces,
    })
}

fn vertex(scene: &Scene, map: &VisibilityMap, v: u32) -> Value {
    let vertex = &map.vertices()[v as usize];
    let edges: Vec<u32> = map.around(v).iter().map(|h| h.edge()).collect();
    let (kind, corner) = match vertex.kind {
        VertexKind::Scene {
            polygon: id,
            corner,
        } => {
            let place = scene
                .grid()
                .to_scene(scene.polygon(id).corners[corner as usize]);
            let mut value = polygon(scene, id);
            value["corner"] = json!(corner);
            value["at"] = json!(place);
            ("scene", Some(value))
        }
        VertexKind::Apparent => ("apparent", None),
        VertexKind::Frame => ("frame", None),
    };
    json!({"ray": vertex.ray, "kind": kind, "corner": corner, "edges": edges})
}

/// A polygon by its object and its number there.
pub(crate) fn polygon(scene: &Scene, id: PolygonId) -> Value {
    let object = scene.polygon(id).object;
    let first = scene.object(object).polygons.start;
    json!({"object": object.0, "polygon": id.0 - first})
}

/// An edge of a polygon, or its inside.
pub(crate) fn element(scene: &Scene, element: Element) -> Value {
    let mut value = polygon(scene, element.polygon);
    value["edge"] = json!(element.edge);
    value
}
