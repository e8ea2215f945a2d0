//! From a document and its buffers to a scene.

use std::collections::HashMap;

use antumbra_scene::{ObjectInput, PartInput, SceneInput};

use super::buffers::Buffers;
use super::container;
use super::document::{Document, Node};
use super::mesh;
use super::nodes::{Transform, placements};
use crate::error::{CornerCount, Damage, Place};
use crate::read::{Resolver, Up};

pub(crate) fn read_glb(bytes: &[u8], resolve: &mut Resolver<'_>) -> Result<SceneInput, Damage> {
    let (json, binary) = container::split(bytes)?;
    read(json, binary, resolve)
}

pub(crate) fn read_gltf(bytes: &[u8], resolve: &mut Resolver<'_>) -> Result<SceneInput, Damage> {
    read(bytes, None, resolve)
}

fn read(
    json: &[u8],
    binary: Option<&[u8]>,
    resolve: &mut Resolver<'_>,
) -> Result<SceneInput, Damage> {
    let document = Document::parse(json)?;
    let placed = placements(&document)?;
    let mut resolve = |uri: &str| resolve(uri);
    let mut buffers = Buffers::new(&document, binary, &mut resolve);
    let mut meshes: HashMap<usize, Vec<PartInput>> = HashMap::new();
    let mut total = CornerCount::default();
    let mut scene = SceneInput::default();
    for (index, node) in document.nodes.iter().enumerate() {
        let Some(mesh) = node.mesh else { continue };
        let place = Place::Item {
            list: "node",
            index: index as u64,
        };
        if mesh >= document.meshes.len() {
            let found = format!(
                "mesh {mesh} does not exist, there are {}",
                document.meshes.len()
            );
            return Err(Damage::broken(place, found));
        }
        // A node outside the scene keeps its number but shows nothing.
        let parts = match &placed[index] {
            None => Vec::new(),
            Some(transform) => {
                let parts = match meshes.entry(mesh) {
                    std::collections::hash_map::Entry::Occupied(entry) => entry.into_mut(),
                    std::collections::hash_map::Entry::Vacant(entry) => {
                        entry.insert(mesh::parts(&mut buffers, mesh)?)
                    }
                };
                let class = class(node, &document, mesh);
                for part in parts.iter() {
                    total.add(part.faces.len() * 3)?;
                }
                let placed = parts
                    .iter()
                    .map(|part| instance(part, class.as_deref(), transform, &place));
                placed.collect::<Result<_, _>>()?
            }
        };
        scene.objects.push(ObjectInput {
            name: node.name.clone(),
            parts,
        });
    }
    Ok(scene)
}

/// The class that the extras of the node, or else of the mesh, give to all parts.
fn class(node: &Node, document: &Document, mesh: usize) -> Option<String> {
    mesh::class_of(node.extras.as_ref())
        .or_else(|| mesh::class_of(document.meshes[mesh].extras.as_ref()))
}

/// A part of a mesh, put where its node stands, and turned to Z-up.
fn instance(
    part: &PartInput,
    class: Option<&str>,
    transform: &Transform,
    place: &Place,
) -> Result<PartInput, Damage> {
    let mut vertices = Vec::with_capacity(part.vertices.len());
    for vertex in &part.vertices {
        let moved = transform.apply(*vertex);
        if moved.iter().any(|c| !c.is_finite()) {
            return Err(Damage::broken(
                place.clone(),
                "its transform moves a vertex beyond all finite numbers",
            ));
        }
        vertices.push(Up::Y.turn(moved));
    }
    Ok(PartInput {
        class: class.map(str::to_owned).or_else(|| part.class.clone()),
        translucent: part.translucent,
        vertices,
        faces: part.faces.clone(),
    })
}
