//! The options that shape a bake, as the canonical text that is stored with its result.

use antumbra_scene::Scene;
use serde_json::{Map, Value, json};

use crate::load::{ReadingArgs, SceneBox, UpArg};

/// Everything besides the scene's file and the cells that decides what a bake yields.
///
/// No path, time or thread count is part of it: equal recipes give equal bytes. With the scene's
/// file it is enough to rebuild the scene as it was baked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Recipe {
    /// How the cells were asked for: `auto`, `grid:2`, `object:lamp` or `boxes`.
    pub cells: String,
    /// The box around cells that were given as boxes; it takes part in the choice of the grid.
    pub cells_box: Option<SceneBox>,
    /// The grid step, if it was given.
    pub grid: Option<f64>,
    /// Sets of lines below this angle in radians count as blocked.
    pub ignore_below: Option<f64>,
    /// The budget, if there is one.
    pub max_splits: Option<u64>,
    /// How the scene's file was understood.
    pub reading: ReadingArgs,
    /// The seed of the sampling.
    pub seed: u64,
}

impl Recipe {
    /// The canonical text: JSON with its keys in alphabetical order, defaults left out.
    pub(crate) fn to_text(&self) -> String {
        let mut map = Map::new();
        map.insert("cells".into(), json!(self.cells));
        let mut put = |key: &str, value: Option<Value>| {
            if let Some(value) = value {
                map.insert(key.into(), value);
            }
        };
        let list = |names: &[String]| (!names.is_empty()).then(|| json!(names));
        put(
            "cells_box",
            self.cells_box.map(|(min, max)| json!([min, max])),
        );
        put("grid", self.grid.map(|g| json!(g)));
        put("ignore_below", self.ignore_below.map(|a| json!(a)));
        put("max_splits", self.max_splits.map(|n| json!(n)));
        put("occluders", list(&self.reading.occluders));
        put("seed", Some(json!(self.seed)));
        put("transparent", list(&self.reading.transparent));
        put("up", (self.reading.up == UpArg::Y).then(|| json!("y")));
        Value::Object(map).to_string()
    }

    /// Reads the canonical text; `None` if it is none.
    pub(crate) fn from_text(text: &str) -> Option<Self> {
        let value: Value = serde_json::from_str(text).ok()?;
        let list = |key: &str| -> Option<Vec<String>> {
            let Some(items) = value.get(key) else {
                return Some(Vec::new());
            };
            items
                .as_array()?
                .iter()
                .map(|i| Some(i.as_str()?.to_owned()))
                .collect()
        };
        let point = |value: &Value| -> Option<[f64; 3]> {
            let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
            numbers?.try_into().ok()
        };
        let cells_box = match value.get("cells_box") {
            None => None,
            Some(both) => Some((point(both.get(0)?)?, point(both.get(1)?)?)),
        };
        Some(Self {
            cells: value.get("cells")?.as_str()?.to_owned(),
            cells_box,
            grid: value.get("grid").and_then(Value::as_f64),
            ignore_below: value.get("ignore_below").and_then(Value::as_f64),
            max_splits: value.get("max_splits").and_then(Value::as_u64),
            reading: ReadingArgs {
                up: if value.get("up").is_some() {
                    UpArg::Y
                } else {
                    UpArg::Z
                },
                occluders: list("occluders")?,
                transparent: list("transparent")?,
            },
            seed: value.get("seed")?.as_u64()?,
        })
    }
}

/// A hash of everything in a snapped scene that takes part in a bake.
pub(crate) fn scene_hash(scene: &Scene) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    let grid = scene.grid();
    for number in grid.origin().into_iter().chain([grid.step()]) {
        hasher.update(&number.to_bits().to_le_bytes());
    }
    for object in scene.objects() {
        hasher.update(&(object.name.len() as u64).to_le_bytes());
        hasher.update(object.name.as_bytes());
        hasher.update(&object.polygons.end.to_le_bytes());
    }
    for polygon in scene.polygons() {
        hasher.update(&[u8::from(polygon.occludes)]);
        hasher.update(&(polygon.corners.len() as u64).to_le_bytes());
        for corner in polygon.corners {
            for c in [corner.x, corner.y, corner.z] {
                hasher.update(&c.to_le_bytes());
            }
        }
    }
    *hasher.finalize().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::{ReadingArgs, Recipe, UpArg};

    #[test]
    fn recipes_survive_their_text() {
        let plain = Recipe {
            cells: "grid:2".into(),
            cells_box: None,
            grid: None,
            ignore_below: None,
            max_splits: None,
            reading: ReadingArgs::default(),
            seed: 1,
        };
        assert_eq!(plain.to_text(), r#"{"cells":"grid:2","seed":1}"#);
        assert_eq!(Recipe::from_text(&plain.to_text()), Some(plain.clone()));
        let rich = Recipe {
            cells: "boxes".into(),
            cells_box: Some(([-0.1, 1e-9, 3.0], [0.30000000000000004, 5.0, 6.0])),
            grid: Some(0.001),
            ignore_below: Some(1e-4),
            max_splits: Some(1000),
            reading: ReadingArgs {
                up: UpArg::Y,
                occluders: vec!["a b".into(), "\"".into()],
                transparent: Vec::new(),
            },
            seed: u64::MAX,
        };
        assert_eq!(Recipe::from_text(&rich.to_text()), Some(rich));
        assert_eq!(Recipe::from_text("cells=grid:2"), None);
    }
}
