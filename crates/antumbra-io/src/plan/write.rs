//! Plans as plain text and as GeoJSON.

use std::fmt::Write as _;

use antumbra_scene::plan::PlanInput;
use serde_json::{Value, json};

/// Plain plan text: a segment a line, its class behind it; `comment` goes to the first line.
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
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{a} {b} {c} {d} {class}");
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
