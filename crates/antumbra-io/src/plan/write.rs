//! Plans as plain text and as GeoJSON.

use std::fmt::Write as _;

use antumbra_scene::plan::PlanInput;
use serde_json::{Value, json};

use super::text::is_number;

/// Plain plan text: a segment a line, its class behind it (`_7` for a class `7`, lest it reads as a number); `comment` goes to the first line.
#[must_use]
pub fn write_seg(plan: &PlanInput, comment: &str) -> String {
    let mut out = format!("# {}\n", comment.replace(['\n', '\r'], " "));
    for s in &plan.segments {
        let [[a, b], [c, d]] = s.ends;
        // Words cannot hold spaces or signs of comments.
        let class = plan
            .classes
            .get(s.class as usize)
            .map_or("", String::as_str);
        let class = class.replace([' ', '\t', '\n', '\r', ',', '#'], "_");
        let mark = if is_number(&class) { "_" } else { "" };
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{a} {b} {c} {d} {mark}{class}");
    }
    out.replace(" \n", "\n")
}

/// GeoJSON: a line a segment; its class as property `class`, `metadata` as a foreign member. Coordinates are
/// lengths, which is said by naming an origin.
#[must_use]
pub fn write_geojson(plan: &PlanInput, metadata: &Value) -> String {
    let features: Vec<Value> = plan
        .segments
        .iter()
        .map(|s| {
            let class = plan
                .classes
                .get(s.class as usize)
                .map_or("", String::as_str);
            json!({"type": "Feature", "properties": {"class": class},
                "geometry": {"type": "LineString", "coordinates": s.ends}})
        })
        .collect();
    json!({"type": "FeatureCollection", "metadata": metadata, "origin": [0, 0], "features": features})
        .to_string()
}

#[cfg(test)]
mod tests {
    use antumbra_scene::plan::{PlanInput, PlanSegment};

    use super::super::{PlanReadOptions, parse_plan};
    use super::write_seg;

    /// Layers of drawings are often numbers, which plain text would take for a coordinate too many.
    #[test]
    fn every_class_comes_back_as_a_word() {
        let mut plan = PlanInput::default();
        for name in ["", "0", "-1.5e3", "wall 7", "nan"] {
            let class = plan.class(name);
            let ends = [[0.0, 0.5], [1.0, 2.0]];
            plan.segments.push(PlanSegment {
                ends,
                class,
                feature: 0,
            });
        }
        let text = write_seg(&plan, "classes");
        let read = parse_plan(text.as_bytes(), "a.seg", &PlanReadOptions::default());
        let read = read.expect("what was written");
        assert_eq!(read.classes, ["", "_0", "_-1.5e3", "wall_7", "nan"]);
    }
}
