//! Meshes: primitives to lists of triangles.

use antumbra_scene::{Faces, PartInput};
use serde_json::Value;

use super::accessor;
use super::buffers::Buffers;
use super::document::Primitive;
use crate::error::{Damage, Place};

/// The parts of a mesh in its own coordinates, one for each primitive with triangles.
pub(super) fn parts(buffers: &mut Buffers<'_, '_>, mesh: usize) -> Result<Vec<PartInput>, Damage> {
    let primitives = &buffers.document.meshes[mesh].primitives;
    let mut parts = Vec::new();
    for (i, primitive) in primitives.iter().enumerate() {
        let place = Place::Primitive {
            mesh: mesh as u64,
            primitive: i as u64,
        };
        parts.extend(part(buffers, primitive, &place)?);
    }
    Ok(parts)
}

/// The `class` entry of some extras, if it is text or a number.
pub(super) fn class_of(extras: Option<&Value>) -> Option<String> {
    match extras?.get("class")? {
        Value::String(class) => Some(class.clone()),
        Value::Number(class) => Some(class.to_string()),
        _ => None,
    }
}

fn part(
    buffers: &mut Buffers<'_, '_>,
    primitive: &Primitive,
    place: &Place,
) -> Result<Option<PartInput>, Damage> {
    let triangles: fn(&[u32]) -> Faces = match primitive.mode.unwrap_or(4) {
        0..=3 => return Ok(None),
        4 => list,
        5 => strip,
        6 => fan,
        mode => {
            return Err(Damage::broken(
                place.clone(),
                format!("mode {mode} does not exist"),
            ));
        }
    };
    let Some(positions) = primitive.attributes.get("POSITION") else {
        return Ok(None);
    };
    let vertices = accessor::positions(buffers, *positions, place)?;
    let order = match primitive.indices {
        Some(indices) => {
            let order = accessor::indices(buffers, indices, place)?;
            if let Some(at) = order.iter().position(|v| *v as usize >= vertices.len()) {
                let found = format!(
                    "entry {at} is vertex {}, but there are {} in accessor {positions}",
                    order[at],
                    vertices.len()
                );
                return Err(Damage::broken(
                    Place::Item {
                        list: "accessor",
                        index: indices as u64,
                    },
                    found,
                ));
            }
            order
        }
        None => (0..vertices.len() as u32).collect(),
    };
    if primitive.mode.unwrap_or(4) == 4 && order.len() % 3 != 0 {
        let found = format!(
            "a list of triangles with {} corners, which is no multiple of 3",
            order.len()
        );
        return Err(Damage::broken(place.clone(), found));
    }
    let faces = triangles(&order);
    if faces.is_empty() {
        return Ok(None);
    }
    let material = match primitive.material {
        None => None,
        Some(index) => {
            let materials = &buffers.document.materials;
            Some(materials.get(index).ok_or_else(|| {
                let found = format!(
                    "material {index} does not exist, there are {}",
                    materials.len()
                );
                Damage::broken(place.clone(), found)
            })?)
        }
    };
    Ok(Some(PartInput {
        class: material.and_then(|m| m.name.clone()),
        translucent: material.is_some_and(super::document::Material::is_translucent),
        vertices,
        faces,
    }))
}

fn list(order: &[u32]) -> Faces {
    order.as_chunks::<3>().0.iter().copied().collect()
}

/// Every other triangle of a strip is turned, so that all face the same way.
fn strip(order: &[u32]) -> Faces {
    let turn = |(i, w): (usize, &[u32])| {
        if i % 2 == 0 {
            [w[0], w[1], w[2]]
        } else {
            [w[1], w[0], w[2]]
        }
    };
    order.windows(3).enumerate().map(turn).collect()
}

fn fan(order: &[u32]) -> Faces {
    let Some((&hub, rim)) = order.split_first() else {
        return Faces::default();
    };
    rim.windows(2).map(|w| [hub, w[0], w[1]]).collect()
}
