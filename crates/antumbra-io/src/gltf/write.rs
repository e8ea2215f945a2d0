//! Writes GLB files.

use std::collections::HashMap;

use antumbra_scene::{ObjectInput, PartInput, SceneInput};
use serde::Serialize;
use serde_json::{Value, json};

use super::container::{BINARY_CHUNK, JSON_CHUNK, MAGIC};

/// Whether objects of one shape share a mesh and differ by their node's translation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Instancing {
    /// Every object has its own mesh.
    Never,
    /// Only where that moves no vertex: all coordinates read back exactly as given.
    #[default]
    WhenExact,
    /// Wherever the shapes are equal once rounded to single precision.
    Always,
}

/// How to write a GLB file.
#[derive(Clone, Debug, Default)]
pub struct GlbOptions {
    /// Whether equal shapes share a mesh.
    pub instancing: Instancing,
    /// Kept in the file as `asset.extras`, for example the parameters of a generated scene.
    pub metadata: Option<Value>,
}

/// A scene as a GLB file, turned to Y-up: node `i` is object `i`.
///
/// Classes become material names, translucent parts get the alpha mode `BLEND`. Faces with more
/// than three corners are cut into fans, so they should be convex. glTF stores positions in
/// single precision: a coordinate with more than 24 significant bits is rounded, the same way
/// wherever it occurs, so that shared corners stay shared. An object without faces becomes a
/// single point, so that it keeps its id. The same scene gives the same bytes.
///
/// ```
/// # use antumbra_scene::{Faces, ObjectInput, PartInput, SceneInput};
/// use antumbra_io::{GlbOptions, ReadOptions, parse_scene, write_glb};
/// let part = PartInput {
///     class: Some("wall".into()),
///     vertices: vec![[0.0, 0.0, 0.5], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
///     faces: Faces::from_iter([[0, 1, 2]]),
///     ..PartInput::default()
/// };
/// let object = ObjectInput { name: Some("a".into()), parts: vec![part] };
/// let scene = SceneInput { objects: vec![object], source_name: "a.glb".into() };
/// let bytes = write_glb(&scene, &GlbOptions::default());
/// let again = parse_scene(&bytes, "a.glb", &ReadOptions::default(), &mut |uri| {
///     Err(std::io::Error::other(uri.to_owned()))
/// });
/// assert_eq!(again.unwrap(), scene);
/// ```
#[must_use]
pub fn write_glb(scene: &SceneInput, options: &GlbOptions) -> Vec<u8> {
    let mut writer = Writer::default();
    let shapes: Vec<Shape> = scene
        .objects
        .iter()
        .map(|object| Shape::of(object, options.instancing))
        .collect();
    let mut uses: HashMap<&Shape, usize> = HashMap::new();
    for shape in &shapes {
        *uses.entry(shape).or_default() += 1;
    }
    let mut meshes: HashMap<&Shape, usize> = HashMap::new();
    let mut nodes = Vec::new();
    for (object, shape) in scene.objects.iter().zip(&shapes) {
        let mut translation = None;
        let shared =
            uses.get(shape).is_some_and(|n| *n > 1) && options.instancing != Instancing::Never;
        let mesh = if shared {
            translation = Some(up_y(anchor(object))).filter(|t| *t != [0.0; 3]);
            *meshes.entry(shape).or_insert_with(|| writer.mesh(shape))
        } else {
            writer.mesh(&Shape::at(object, [0.0; 3]))
        };
        nodes.push(NodeText {
            name: object.name.as_deref(),
            translation,
            mesh,
        });
    }
    writer.finish(nodes, options.metadata.as_ref())
}

/// What two objects must have in common to share a mesh: everything but their place.
#[derive(PartialEq, Eq, Hash)]
struct Shape {
    parts: Vec<ShapePart>,
    /// Tells apart shapes that must not be shared.
    own: Option<[u64; 3]>,
}

#[derive(PartialEq, Eq, Hash)]
struct ShapePart {
    class: Option<String>,
    translucent: bool,
    /// Y-up positions, as the bits of single-precision floats.
    positions: Vec<[u32; 3]>,
    corners: Vec<u32>,
}

impl Shape {
    /// The shape about the object's anchor, marked with the anchor if it may not be shared.
    fn of(object: &ObjectInput, instancing: Instancing) -> Self {
        let anchor = anchor(object);
        let mut shape = Self::at(object, anchor);
        let exact = || {
            let vertices = object.parts.iter().flat_map(|part| &part.vertices);
            vertices
                .into_iter()
                .all(|v| (0..3).all(|k| f64::from((v[k] - anchor[k]) as f32) + anchor[k] == v[k]))
        };
        let shareable = match instancing {
            Instancing::Never => false,
            Instancing::WhenExact => exact(),
            Instancing::Always => true,
        };
        if !shareable {
            shape.own = Some(anchor.map(f64::to_bits));
        }
        shape
    }

    fn at(object: &ObjectInput, anchor: [f64; 3]) -> Self {
        let part = |part: &PartInput| {
            let local = |v: &[f64; 3]| up_y([v[0] - anchor[0], v[1] - anchor[1], v[2] - anchor[2]]);
            ShapePart {
                class: part.class.clone(),
                translucent: part.translucent,
                // Adding zero turns -0.0 into 0.0, so that equal shapes have equal bits.
                positions: part
                    .vertices
                    .iter()
                    .map(|v| local(v).map(|c| (c as f32 + 0.0).to_bits()))
                    .collect(),
                corners: triangles(part),
            }
        };
        let parts = object
            .parts
            .iter()
            .map(part)
            .filter(|part| !part.corners.is_empty())
            .collect();
        Self { parts, own: None }
    }
}

/// The middle of an object's box; the origin if it has no vertices.
fn anchor(object: &ObjectInput) -> [f64; 3] {
    let vertices = || object.parts.iter().flat_map(|part| &part.vertices);
    std::array::from_fn(|k| {
        let low = vertices().map(|v| v[k]).reduce(f64::min).unwrap_or(0.0);
        let high = vertices().map(|v| v[k]).reduce(f64::max).unwrap_or(0.0);
        low / 2.0 + high / 2.0 + 0.0
    })
}

/// The inverse of the turn to Z-up. Adding zero turns -0.0 into 0.0.
fn up_y([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x + 0.0, z + 0.0, -y + 0.0]
}

fn triangles(part: &PartInput) -> Vec<u32> {
    let mut corners = Vec::new();
    for face in part.faces.iter() {
        for i in 2..face.len() {
            corners.extend([face[0], face[i - 1], face[i]]);
        }
    }
    corners
}

/// There may be very many nodes, so they are written from this and not from JSON values.
#[derive(Serialize)]
struct NodeText<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    translation: Option<[f64; 3]>,
    mesh: usize,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct DocumentText<'a> {
    asset: Value,
    scene: usize,
    scenes: Value,
    nodes: Vec<NodeText<'a>>,
    meshes: Vec<Value>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    materials: Vec<Value>,
    accessors: Vec<Value>,
    buffer_views: Vec<Value>,
    buffers: Value,
}

#[derive(Default)]
struct Writer {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    material_ids: HashMap<(Option<String>, bool), usize>,
}

impl Writer {
    fn mesh(&mut self, shape: &Shape) -> usize {
        let mut primitives: Vec<Value> = shape
            .parts
            .iter()
            .map(|part| self.primitive(part))
            .collect();
        if primitives.is_empty() {
            // A mesh needs a primitive; a point blocks nothing.
            let point = self.positions(&[[0; 3]]);
            primitives.push(json!({"attributes": {"POSITION": point}, "mode": 0}));
        }
        self.meshes.push(json!({ "primitives": primitives }));
        self.meshes.len() - 1
    }

    fn primitive(&mut self, part: &ShapePart) -> Value {
        let positions = self.positions(&part.positions);
        let mut bytes = Vec::new();
        // The largest index of a type is not allowed: it means "restart".
        let short = part.positions.len() < usize::from(u16::MAX);
        for corner in &part.corners {
            match u16::try_from(*corner) {
                Ok(corner) if short => bytes.extend(corner.to_le_bytes()),
                _ => bytes.extend(corner.to_le_bytes()),
            }
        }
        let view = self.view(&bytes, 34963);
        let indices = self.accessor(json!({
            "bufferView": view,
            "componentType": if short { 5123 } else { 5125 },
            "count": part.corners.len(),
            "type": "SCALAR",
        }));
        let mut primitive = json!({"attributes": {"POSITION": positions}, "indices": indices});
        if part.class.is_some() || part.translucent {
            primitive["material"] = json!(self.material(part));
        }
        primitive
    }

    fn positions(&mut self, positions: &[[u32; 3]]) -> usize {
        let bytes: Vec<u8> = positions
            .iter()
            .flatten()
            .flat_map(|c| c.to_le_bytes())
            .collect();
        let view = self.view(&bytes, 34962);
        let bound = |pick: fn(f32, f32) -> f32| -> [f32; 3] {
            std::array::from_fn(|k| {
                positions
                    .iter()
                    .map(|p| f32::from_bits(p[k]))
                    .reduce(pick)
                    .unwrap_or(0.0)
            })
        };
        self.accessor(json!({
            "bufferView": view,
            "componentType": 5126,
            "count": positions.len(),
            "type": "VEC3",
            "min": bound(f32::min),
            "max": bound(f32::max),
        }))
    }

    fn material(&mut self, part: &ShapePart) -> usize {
        let key = (part.class.clone(), part.translucent);
        if let Some(id) = self.material_ids.get(&key) {
            return *id;
        }
        let mut material = json!({"doubleSided": true});
        if let Some(name) = &part.class {
            material["name"] = json!(name);
        }
        if part.translucent {
            material["alphaMode"] = json!("BLEND");
        }
        self.materials.push(material);
        self.material_ids.insert(key, self.materials.len() - 1);
        self.materials.len() - 1
    }

    fn view(&mut self, bytes: &[u8], target: u32) -> usize {
        let offset = self.binary.len();
        self.binary.extend(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.push(json!({
            "buffer": 0, "byteOffset": offset, "byteLength": bytes.len(), "target": target,
        }));
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn finish(self, nodes: Vec<NodeText<'_>>, metadata: Option<&Value>) -> Vec<u8> {
        let mut asset =
            json!({"version": "2.0", "generator": concat!("antumbra ", env!("CARGO_PKG_VERSION"))});
        if let Some(metadata) = metadata {
            asset["extras"] = metadata.clone();
        }
        let mut text = if nodes.is_empty() {
            json!({ "asset": asset }).to_string().into_bytes()
        } else {
            let document = DocumentText {
                asset,
                scene: 0,
                scenes: json!([{"nodes": (0..nodes.len()).collect::<Vec<_>>()}]),
                nodes,
                meshes: self.meshes,
                materials: self.materials,
                accessors: self.accessors,
                buffer_views: self.views,
                buffers: json!([{"byteLength": self.binary.len()}]),
            };
            // Plain numbers, text and lists: this cannot fail, and an empty document is refused.
            serde_json::to_vec(&document).unwrap_or_default()
        };
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut chunks = vec![(JSON_CHUNK, text)];
        if !self.binary.is_empty() {
            chunks.push((BINARY_CHUNK, self.binary));
        }
        let total = 12 + chunks.iter().map(|(_, data)| 8 + data.len()).sum::<usize>();
        let mut out = Vec::with_capacity(total);
        out.extend(MAGIC);
        out.extend(2_u32.to_le_bytes());
        out.extend((total as u32).to_le_bytes());
        for (kind, data) in chunks {
            out.extend((data.len() as u32).to_le_bytes());
            out.extend(kind.to_le_bytes());
            out.extend(data);
        }
        out
    }
}
