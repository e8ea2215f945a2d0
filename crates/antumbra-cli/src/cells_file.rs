//! View cells from a JSON file: `[{"name": "hall", "min": [0, 0, 0], "max": [4, 3, 2.5]}, ...]`.

use std::path::Path;

use antumbra_io::read_unpacked;
use antumbra_scene::NamedBox;
use serde_json::Value;

use crate::failure::Failure;
use crate::load::{SceneBox, read_failure};

/// Reads the boxes of a file, which may be gzip'd.
pub(crate) fn read(path: &Path) -> Result<Vec<NamedBox>, Failure> {
    let text = read_unpacked(path).map_err(|error| read_failure(&error))?;
    parse(&text).map_err(|fault| Failure::Content(format!("{}: {fault}", path.display())))
}

/// The box around all boxes.
pub(crate) fn hull(boxes: &[NamedBox]) -> Option<SceneBox> {
    boxes
        .iter()
        .map(|b| (b.min, b.max))
        .reduce(|(a, b), (c, d)| {
            (
                std::array::from_fn(|k| a[k].min(c[k])),
                std::array::from_fn(|k| b[k].max(d[k])),
            )
        })
}

const SHAPE: &str =
    r#"expected a list like [{"name": "hall", "min": [0, 0, 0], "max": [4, 3, 2.5]}]"#;

fn parse(text: &[u8]) -> Result<Vec<NamedBox>, String> {
    let value: Value = serde_json::from_slice(text).map_err(|error| {
        let (line, column) = (error.line(), error.column());
        format!("line {line}, column {column}: this is not JSON; {SHAPE}")
    })?;
    let items = value
        .as_array()
        .ok_or_else(|| format!("the file holds no list; {SHAPE}"))?;
    if items.is_empty() {
        return Err("the list is empty; give at least one box".to_owned());
    }
    items
        .iter()
        .enumerate()
        .map(|(i, item)| named_box(i, item))
        .collect()
}

fn named_box(index: usize, item: &Value) -> Result<NamedBox, String> {
    let name = match item.get("name") {
        None => index.to_string(),
        Some(name) => match name.as_str() {
            Some(name) => name.to_owned(),
            None => return Err(format!("box {index}: its name is {name}; give a text")),
        },
    };
    let corner = |key: &str| -> Result<[f64; 3], String> {
        let numbers: Option<Vec<f64>> = item
            .get(key)
            .and_then(Value::as_array)
            .and_then(|list| list.iter().map(Value::as_f64).collect());
        numbers
            .and_then(|n| n.try_into().ok())
            .ok_or_else(|| format!("box {index} ('{name}'): '{key}' is not three numbers; {SHAPE}"))
    };
    let (min, max) = (corner("min")?, corner("max")?);
    if let Some(k) = (0..3).find(|k| min[*k] >= max[*k]) {
        let axis = ["x", "y", "z"][k];
        return Err(format!(
            "box {index} ('{name}'): it has no extent along {axis} (from {} to {}); give min below max",
            min[k], max[k]
        ));
    }
    Ok(NamedBox { name, min, max })
}

#[cfg(test)]
mod tests {
    use super::{hull, parse};

    #[test]
    fn boxes_are_read_and_joined() {
        let text =
            br#"[{"name":"a","min":[0,0,0],"max":[1,2,3]},{"min":[-1,0,0],"max":[0.5,1,1]}]"#;
        let boxes = parse(text).expect("two boxes");
        assert_eq!((boxes[0].name.as_str(), boxes[1].name.as_str()), ("a", "1"));
        assert_eq!(hull(&boxes), Some(([-1.0, 0.0, 0.0], [1.0, 2.0, 3.0])));
    }

    #[test]
    fn faults_say_where_they_are() {
        let cases: [(&[u8], &str); 6] = [
            (b"[{", "line 1, column 2: this is not JSON"),
            (b"{}", "the file holds no list"),
            (b"[]", "the list is empty"),
            (
                b"[{\"min\":[0,0,0],\"max\":[1,1]}]",
                "box 0 ('0'): 'max' is not three numbers",
            ),
            (
                b"[{\"min\":[0,0,0],\"max\":[1,0,1]}]",
                "box 0 ('0'): it has no extent along y",
            ),
            (b"[{\"name\":7}]", "box 0: its name is 7"),
        ];
        for (text, start) in cases {
            let fault = parse(text).expect_err("a fault");
            assert!(fault.starts_with(start), "{fault}");
        }
    }
}
