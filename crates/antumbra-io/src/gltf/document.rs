//! The parts of a glTF document that a scene is made of. Everything else is skipped unread.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

use crate::error::{Damage, Place};

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    asset: Option<Asset>,
    pub(super) scene: Option<usize>,
    #[serde(default)]
    pub(super) scenes: Vec<Scene>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    #[serde(default)]
    pub(super) materials: Vec<Material>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    extensions_used: Vec<String>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
struct Asset {
    version: String,
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub(super) nodes: Vec<usize>,
}

#[derive(Deserialize)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) mesh: Option<usize>,
    #[serde(default)]
    pub(super) children: Vec<usize>,
    /// Column by column.
    pub(super) matrix: Option<Box<[f64; 16]>>,
    pub(super) translation: Option<[f64; 3]>,
    /// A quaternion, real part last.
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) extras: Option<Value>,
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    #[serde(default)]
    pub(super) primitives: Vec<Primitive>,
    pub(super) extras: Option<Value>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    #[serde(default)]
    pub(super) attributes: BTreeMap<String, usize>,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    pub(super) mode: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) name: Option<String>,
    alpha_mode: Option<String>,
}

impl Material {
    pub(super) fn is_translucent(&self) -> bool {
        matches!(self.alpha_mode.as_deref(), Some("BLEND" | "MASK"))
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: u64,
}

/// Extensions that hide geometry from a reader that does not know them, and the way out.
const GEOMETRY_EXTENSIONS: [&str; 3] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "EXT_mesh_gpu_instancing",
];

impl Document {
    pub(super) fn parse(json: &[u8]) -> Result<Self, Damage> {
        let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
        let document: Self = serde_json::from_slice(json).map_err(|error| {
            let place = Place::Json {
                line: error.line(),
                column: error.column(),
            };
            if error.is_data() && !looks_like_gltf(json) {
                return not_gltf();
            }
            let text = error.to_string();
            let what = text.split(" at line ").next().unwrap_or(&text);
            Damage::broken(place, what)
        })?;
        let asset = document.asset.as_ref().ok_or_else(not_gltf)?;
        if !asset.version.starts_with("2.") {
            return Err(Damage::new(
                Place::Whole,
                format!("this is glTF version {:?}", asset.version),
                "convert it to glTF 2.0",
            ));
        }
        // Instancing changes what there is even when a file calls it optional; compressed data
        // that is optional has a plain copy.
        let hidden = |name: &&&str| {
            let has = |list: &[String]| list.iter().any(|entry| entry == **name);
            has(&document.extensions_required)
                || (**name == "EXT_mesh_gpu_instancing" && has(&document.extensions_used))
        };
        if let Some(name) = GEOMETRY_EXTENSIONS.iter().find(hidden) {
            return Err(Damage::new(
                Place::Whole,
                format!("the geometry needs the extension {name}, which is not supported"),
                "export the scene without compression and with plain instances",
            ));
        }
        Ok(document)
    }
}

fn looks_like_gltf(json: &[u8]) -> bool {
    json.windows(7).any(|w| w == b"\"asset\"")
}

fn not_gltf() -> Damage {
    Damage::new(
        Place::Whole,
        "this is JSON, but not glTF: it has no \"asset\" entry",
        "give a glTF, GLB, OBJ, PLY or STL file",
    )
}
