//! Fragments and meshes as files and as things to draw.

use antumbra::shadow::{DiscontinuityMesh, Event, Fragment, Lighting, Shadows};
use antumbra_scene::{ObjectInput, PartInput, Scene, SceneInput};
use serde_json::{Value, json};

use crate::commands::map::{element, polygon};
use crate::picture::LitFace;

/// All fragments. Polygons are numbered within their objects.
pub(super) fn fragments(scene: &Scene, shadows: &Shadows) -> Value {
    let fragments: Vec<Value> = shadows
        .fragments()
        .iter()
        .map(|fragment| {
            let mut value = polygon(scene, fragment.polygon);
            value["lighting"] = json!(fragment.lighting.name());
            value["corners"] = json!(fragment.corners);
            value
        })
        .collect();
    json!({"light": shadows.light(scene), "fragments": fragments})
}

/// All pieces of a mesh.
pub(super) fn mesh(scene: &Scene, mesh: &DiscontinuityMesh) -> Value {
    let edges: Vec<Value> = mesh
        .pieces
        .iter()
        .map(|piece| {
            let cast_by: Vec<Value> = piece.cast_by.iter().map(|e| element(scene, *e)).collect();
            let mut value = polygon(scene, piece.polygon);
            value["event"] = json!(piece.event.name());
            value["light"] = json!(piece.light);
            value["cast_by"] = json!(cast_by);
            value["from"] = json!(piece.ends[0]);
            value["to"] = json!(piece.ends[1]);
            value
        })
        .collect();
    json!({"light": mesh.light, "accuracy": "approximate", "edges": edges})
}

/// The scene with the same objects, each of lit and shadowed parts by material.
pub(super) fn lit_scene(scene: &Scene, shadows: &Shadows) -> SceneInput {
    let mut objects: Vec<ObjectInput> = scene
        .objects()
        .iter()
        .map(|object| ObjectInput {
            name: Some(object.name.clone()),
            parts: Vec::new(),
        })
        .collect();
    for fragment in shadows.fragments() {
        let polygon = scene.polygon(fragment.polygon);
        let parts = &mut objects[polygon.object.index()].parts;
        let (class, translucent) = (fragment.lighting.name(), !polygon.occludes);
        let fits =
            |p: &&mut PartInput| p.class.as_deref() == Some(class) && p.translucent == translucent;
        match parts.iter_mut().find(fits) {
            Some(part) => add(part, fragment),
            None => {
                let mut part = PartInput {
                    class: Some(class.to_owned()),
                    translucent,
                    ..PartInput::default()
                };
                add(&mut part, fragment);
                parts.push(part);
            }
        }
    }
    SceneInput {
        objects,
        source_name: "shadows".to_owned(),
    }
}

fn add(part: &mut PartInput, fragment: &Fragment) {
    let first = part.vertices.len() as u32;
    part.vertices.extend_from_slice(&fragment.corners);
    let corners: Vec<u32> = (first..part.vertices.len() as u32).collect();
    part.faces.push(&corners);
}

/// Fragments to draw.
pub(super) fn faces(scene: &Scene, shadows: &Shadows) -> Vec<LitFace> {
    shadows
        .fragments()
        .iter()
        .map(|fragment| LitFace {
            corners: fragment.corners.clone(),
            object: scene.polygon(fragment.polygon).object.0,
            lit: fragment.lighting == Lighting::Lit,
            clear: !scene.polygon(fragment.polygon).occludes,
        })
        .collect()
}

/// Polygons to draw under a mesh.
pub(super) fn plain_faces(scene: &Scene) -> Vec<LitFace> {
    scene
        .polygons()
        .map(|polygon| LitFace {
            corners: polygon
                .corners
                .iter()
                .map(|&c| scene.grid().to_scene(c))
                .collect(),
            object: polygon.object.0,
            lit: true,
            clear: !polygon.occludes,
        })
        .collect()
}

/// Lines to draw, each with the number of its event.
pub(super) fn lines(mesh: &DiscontinuityMesh) -> Vec<(usize, [[f64; 3]; 2])> {
    let number = |event| Event::ALL.iter().position(|e| *e == event).unwrap_or(0);
    mesh.pieces
        .iter()
        .map(|p| (number(p.event), p.ends))
        .collect()
}
