//! What `plan` says: JSON for scripts, GeoJSON for maps, a sentence for people.

use std::time::Instant;

use antumbra::kernel::Point2;
use antumbra::plan::{
    Accuracy, Fragment, Funnel, Isovist, Plan, PlanInput, PlanLine, PlanView, Ratio, Seen, Sight,
};
use antumbra_io::plan::Projection;
use serde_json::{Map, Value, json};

use super::PlanArgs;
use super::cells::NamedCell;
use crate::failure::Failure;
use crate::output::{counted, seconds};

fn accuracy(a: Accuracy) -> &'static str {
    match a {
        Accuracy::Exact => "exact",
        Accuracy::Conservative => "conservative",
        Accuracy::AggressiveBelow(_) => "aggressive",
    }
}

/// The keys of one cell.
fn cell(args: &PlanArgs, plan: &Plan, seen: &Seen, area: Option<&Isovist>) -> Map<String, Value> {
    let visible: Vec<Value> = seen
        .segments
        .iter()
        .map(|s| {
            let mut entry = json!({"id": s.segment.0, "fragments": s.fragments});
            if s.touching {
                entry["touching"] = json!(true);
            }
            entry
        })
        .collect();
    let mut out = Map::new();
    out.insert("visible".to_owned(), json!(visible));
    out.insert("accuracy".to_owned(), json!(accuracy(seen.accuracy)));
    out.insert("tree_nodes".to_owned(), json!(seen.work.tree_nodes));
    out.insert("blockers".to_owned(), json!(seen.work.blockers));
    out.insert("kd_nodes_tested".to_owned(), json!(seen.work.nodes_tested));
    if args.second_pass {
        let nodes = seen.parts.iter().flat_map(|v| &v.visible_nodes);
        let boxes: Vec<[[f64; 2]; 2]> = nodes
            .map(|&n| {
                let b = plan.kd().nodes()[n as usize].bounds;
                [plan.to_scene(b.min), plan.to_scene(b.max)]
            })
            .collect();
        let reclassified: usize = seen.parts.iter().map(|v| v.reclassified.len()).sum();
        out.insert("visible_kd_nodes".to_owned(), json!(boxes));
        out.insert("reclassified_kd_leaves".to_owned(), json!(reclassified));
    }
    if let Some(area) = area {
        let isovist = json!({"area": area.area, "perimeter": area.perimeter, "depth": area.depth,
            "open": area.open, "polygons": area.polygons});
        out.insert("isovist".to_owned(), isovist);
    }
    if args.witnesses {
        let lines = seen
            .parts
            .iter()
            .flat_map(|v| v.fragments.iter().map(move |f| (v, f)));
        let lines: Vec<Value> = lines.map(|(v, f)| witness(plan, v, f)).collect();
        out.insert("witnesses".to_owned(), json!(lines));
    }
    out
}

/// A line that sees a fragment: from the edge of the cell to the segment, and exactly as `a x + b y + c` in grid
/// steps from the grid's origin.
fn witness(plan: &Plan, view: &PlanView, f: &Fragment) -> Value {
    let to = meet(&f.witness, plan.pieces()[f.piece.0 as usize]);
    let from = match view.windows.get(f.window as usize) {
        Some(w) => meet(&f.witness, [w.a, w.b]),
        None => view.cell.corners()[0].to_f64(),
    };
    let ids: Vec<u32> = plan.owners(f.piece).iter().map(|o| o.segment.0).collect();
    let line = f.witness.big().map(|c| c.to_string());
    json!({"ids": ids, "from": plan.to_scene_f64(from), "to": plan.to_scene_f64(to), "line": line})
}

/// Where a line meets a segment, rounded once; the first end if it runs along it.
pub(super) fn meet(line: &PlanLine, segment: [Point2; 2]) -> [f64; 2] {
    let place = Ratio::on_segment(segment, line).unwrap_or(Ratio::ZERO);
    place.point_on(segment)
}

pub(super) fn seen(
    args: &PlanArgs,
    plan: &Plan,
    outlines: &[NamedCell],
    (seen, areas): (&[Seen], &[Isovist]),
    result: &mut Map<String, Value>,
) -> String {
    if args.cells.is_none() {
        let one = &seen[0];
        result.extend(cell(args, plan, one, areas.first()));
        let fragments: usize = one.segments.iter().map(|s| s.fragments.len()).sum();
        return format!(
            "{} of {} visible in {} ({}), {}",
            one.segments.len(),
            counted(plan.segment_count(), "segment", "segments"),
            counted(fragments, "fragment", "fragments"),
            accuracy(one.accuracy),
            counted(one.work.tree_nodes as usize, "tree node", "tree nodes")
        );
    }
    let cells: Vec<Value> = outlines
        .iter()
        .zip(seen)
        .enumerate()
        .map(|(i, (named, one))| {
            let mut entry = cell(args, plan, one, areas.get(i));
            entry.insert("id".to_owned(), id_value(&named.id));
            Value::Object(entry)
        })
        .collect();
    let total: usize = seen.iter().map(|s| s.segments.len()).sum();
    let mean = total as f64 / seen.len().max(1) as f64;
    let nodes: u64 = seen.iter().map(|s| s.work.tree_nodes).sum();
    result.insert("cells".to_owned(), json!(cells));
    result.insert("visible_mean".to_owned(), json!(mean));
    result.insert("tree_nodes".to_owned(), json!(nodes));
    format!(
        "{} {mean:.1} of {} on average",
        counted(seen.len(), "cell sees", "cells see"),
        counted(plan.segment_count(), "segment", "segments")
    )
}

/// What else was asked for, in words.
pub(super) fn asked(args: &PlanArgs, seen: &[Seen], areas: &[Isovist]) -> String {
    let parts = || seen.iter().flat_map(|s| &s.parts);
    let mut text = String::new();
    match areas {
        [] => {}
        [one] => {
            let (area, perimeter) = (one.area, one.perimeter);
            text += &format!("; isovist of area {area:.3} and perimeter {perimeter:.3}");
        }
        many => text += &format!("; {} isovists", many.len()),
    }
    if args.witnesses {
        let lines = parts().map(|v| v.fragments.len()).sum();
        text += &format!("; {}", counted(lines, "witness", "witnesses"));
    }
    if args.second_pass {
        let hidden = parts().map(|v| v.reclassified.len()).sum();
        let leaves = counted(hidden, "opened kD leaf", "opened kD leaves");
        let found = if hidden == 1 { "is" } else { "are" };
        text += &format!("; {leaves} {found} hidden after all");
    }
    text
}

/// Numbers stay numbers.
fn id_value(id: &str) -> Value {
    id.parse::<i64>().map_or_else(|_| json!(id), |n| json!(n))
}

/// What checking found.
pub(super) struct Checked {
    /// For people.
    pub text: String,
    /// A verdict that does not hold is a bug worth an exit code.
    pub failure: Option<Failure>,
}

/// Checks all certificates.
pub(super) fn check(plan: &Plan, seen: &[Seen], result: &mut Map<String, Value>) -> Checked {
    let start = Instant::now();
    let proofs: Vec<_> = seen
        .iter()
        .flat_map(|s| &s.parts)
        .filter_map(|v| v.proof.as_ref())
        .collect();
    let (mut visible, mut hidden, mut failures) = (0, 0, Vec::new());
    for proof in &proofs {
        let report = antumbra::plan::check(plan, proof);
        visible += report.visible_checked;
        hidden += report.hidden_checked;
        failures.extend(report.failed);
    }
    let parts: usize = seen.iter().map(|s| s.parts.len()).sum();
    let points = parts - proofs.len();
    result.insert(
        "check".to_owned(),
        json!({"visible_checked": visible, "hidden_checked": hidden, "unchecked_points": points,
            "failed": failures.len(), "failures": failures, "seconds": seconds(start.elapsed())}),
    );
    let failure = failures.first().map(|why| {
        let failed = counted(failures.len(), "verdict does", "verdicts do");
        Failure::Content(format!(
            "{failed} not hold ({why}); please report this with the plan and the cell"
        ))
    });
    let verdicts = visible + hidden;
    let mut text = String::new();
    if verdicts > 0 || !failures.is_empty() {
        text += &match (failures.len(), verdicts) {
            (0, 1) => "; checked: the only verdict holds".to_owned(),
            (0, n) => format!("; checked: all {n} verdicts hold"),
            (failed, n) => format!("; checked: {n} verdicts hold, {failed} failed"),
        };
    }
    if points > 0 {
        let cells = counted(points, "point has", "points have");
        text += &format!("; {cells} no certificate to check");
    }
    Checked { text, failure }
}

/// Whether each cell sees another one.
pub(super) fn sights(
    batch: bool,
    outlines: &[NamedCell],
    sights: &[Option<Sight>],
    result: &mut Map<String, Value>,
) -> String {
    if let (false, [one]) = (batch, sights) {
        result.extend(sight(one.as_ref()));
        let text = match one {
            None => "the cells do not see each other",
            Some(Sight::Touching) => "the cells touch",
            Some(Sight::Line(_)) => "the cells see each other",
        };
        return text.to_owned();
    }
    let cells = outlines.iter().zip(sights).map(|(named, one)| {
        let mut entry = sight(one.as_ref());
        entry.insert("id".to_owned(), id_value(&named.id));
        Value::Object(entry)
    });
    result.insert("cells".to_owned(), cells.collect());
    let seeing = sights.iter().flatten().count();
    result.insert("visible".to_owned(), json!(seeing));
    let all = counted(sights.len(), "cell", "cells");
    let see = if seeing == 1 { "sees" } else { "see" };
    format!("{seeing} of {all} {see} the other cell")
}

/// The keys of one verdict.
fn sight(sight: Option<&Sight>) -> Map<String, Value> {
    let mut out = Map::new();
    let verdict = if sight.is_some() { "visible" } else { "hidden" };
    out.insert("verdict".to_owned(), json!(verdict));
    if let Some(Sight::Line(line)) = sight {
        let line = line.big().map(|c| c.to_string());
        out.insert("line".to_owned(), json!(line));
    }
    out
}

/// The visible fragments as a feature each.
pub(super) fn geojson(
    input: &PlanInput,
    outlines: &[NamedCell],
    seen: &[Seen],
    areas: &[Isovist],
) -> Value {
    // Degrees again, if degrees were projected.
    let projection = input.projected_around.map(Projection::around);
    let place = |p: [f64; 2]| projection.map_or(p, |projection| projection.undo(p));
    let mut features = Vec::new();
    for (named, one) in outlines.iter().zip(seen) {
        for s in &one.segments {
            let segment = &input.segments[s.segment.0 as usize];
            let [p, q] = segment.ends;
            let at = |t: f64| place([0, 1].map(|k| p[k] + t * (q[k] - p[k])));
            let lines: Vec<[[f64; 2]; 2]> =
                s.fragments.iter().map(|f| [at(f[0]), at(f[1])]).collect();
            features.push(json!({
                "type": "Feature",
                "properties": {
                    "cell": id_value(&named.id),
                    "segment": s.segment.0,
                    "class": input.classes[segment.class as usize],
                    "feature": segment.feature,
                    "fragments": s.fragments,
                },
                "geometry": {"type": "MultiLineString", "coordinates": lines},
            }));
        }
    }
    for (named, area) in outlines.iter().zip(areas) {
        // Rings of GeoJSON repeat their first point.
        let mut polygons = area.polygons.clone();
        for ring in polygons.iter_mut().flatten() {
            ring.iter_mut().for_each(|p| *p = place(*p));
            ring.extend(ring.first().copied());
        }
        features.push(json!({
            "type": "Feature",
            "properties": {"cell": id_value(&named.id), "isovist": true, "area": area.area,
                "perimeter": area.perimeter, "depth": area.depth, "open": area.open},
            "geometry": {"type": "MultiPolygon", "coordinates": polygons},
        }));
    }
    let mut out = json!({"type": "FeatureCollection", "features": features});
    // The coordinates are those of the input, and so is what they mean.
    if let Some(crs) = input.crs.as_ref().and_then(|c| c.parse().ok()) {
        out["crs"] = crs;
    }
    out
}

/// The funnels: which part of a segment is seen through which part of a cell's edge, and their extremal lines.
pub(super) fn funnels(plan: &Plan, outlines: &[NamedCell], seen: &[Seen]) -> Value {
    let cells = outlines.iter().zip(seen).map(|(named, one)| {
        let funnels: Vec<Value> = one
            .parts
            .iter()
            .flat_map(|view| view.funnels.iter().map(move |f| funnel(plan, view, f)))
            .collect();
        json!({"id": id_value(&named.id), "funnels": funnels})
    });
    json!({"cells": cells.collect::<Vec<_>>()})
}

fn funnel(plan: &Plan, view: &PlanView, f: &Funnel) -> Value {
    let target = plan.pieces()[f.piece.0 as usize];
    let ids: Vec<u32> = plan.owners(f.piece).iter().map(|o| o.segment.0).collect();
    let window = view.windows.get(f.window as usize);
    let ends = |line: &PlanLine| {
        let from = match window {
            Some(w) => meet(line, [w.a, w.b]),
            None => view.cell.corners()[0].to_f64(),
        };
        json!([
            plan.to_scene_f64(from),
            plan.to_scene_f64(meet(line, target))
        ])
    };
    let lines: Vec<Value> = f.lines.iter().map(ends).collect();
    let exact: Vec<[String; 3]> = f
        .lines
        .iter()
        .map(|l| l.big().map(|c| c.to_string()))
        .collect();
    let edge = window.map(|w| [plan.to_scene(w.a), plan.to_scene(w.b)]);
    let span = [0, 1].map(|k| plan.to_scene_f64(f.at[k].point_on(target)));
    json!({"ids": ids, "window": edge, "sees": span, "extremal_lines": lines, "exact": exact})
}
