//! Frames as CSV, and as a chart of cost and visible objects.

use std::fmt::Write;

use super::Frame;

/// One line a frame.
pub(super) fn csv(frames: &[Frame], truth: Option<&[usize]>) -> String {
    let mut out = String::from(
        "frame,seconds,visible,truth,node_tests,nodes_skipped,item_tests,polygon_tests,\
         occluders_tried,occluders,tree_nodes,tree_steps,tree_visits\n",
    );
    for (i, frame) in frames.iter().enumerate() {
        let truth = truth.map_or(String::new(), |t| t[i].to_string());
        let w = &frame.work;
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{i},{:.9},{},{truth},{},{},{},{},{},{},{},{},{}",
            frame.seconds,
            frame.visible.len(),
            w.node_tests,
            w.nodes_skipped,
            w.item_tests,
            w.polygon_tests,
            w.occluders_tried,
            w.occluders,
            w.tree_nodes,
            w.tree_steps,
            w.tree_visits
        );
    }
    out
}

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 220.0;
const LEFT: f64 = 64.0;

/// Two panels, one below the other.
pub(super) fn svg(title: &str, frames: &[Frame], truth: Option<&[usize]>) -> String {
    let times: Vec<f64> = frames.iter().map(|f| f.seconds * 1e3).collect();
    let visible: Vec<f64> = frames.iter().map(|f| f.visible.len() as f64).collect();
    let truth: Option<Vec<f64>> = truth.map(|t| t.iter().map(|&n| n as f64).collect());
    let (w, h) = (LEFT + WIDTH + 24.0, 2.0 * HEIGHT + 170.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" \
         font-family=\"sans-serif\" font-size=\"13\" fill=\"#333\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"{LEFT}\" y=\"26\" font-size=\"16\">{}</text>\n",
        escaped(title)
    );
    panel(
        &mut out,
        60.0,
        "milliseconds a frame",
        &[(&times, "#2563a8", "culling")],
    );
    let mut lines: Vec<(&[f64], &str, &str)> = vec![(&visible, "#c2410c", "called visible")];
    if let Some(truth) = &truth {
        lines.push((truth, "#111", "in the item buffer"));
    }
    panel(&mut out, 60.0 + HEIGHT + 55.0, "objects", &lines);
    out.push_str("</svg>\n");
    out
}

fn panel(out: &mut String, top: f64, what: &str, lines: &[(&[f64], &str, &str)]) {
    let highest = lines
        .iter()
        .flat_map(|(values, ..)| values.iter())
        .fold(0.0_f64, |m, v| m.max(*v));
    let step = nice(highest / 4.0);
    let limit = ((highest / step).ceil() * step).max(step);
    let y = |v: f64| top + HEIGHT * (1.0 - v / limit);
    let _ = writeln!(out, "<text x=\"{LEFT}\" y=\"{}\">{what}</text>", top - 10.0);
    let mut tick = 0.0;
    while tick <= limit * 1.0001 {
        let at = y(tick);
        let label = (tick * 1e6).round() / 1e6;
        let _ = writeln!(
            out,
            "<path d=\"M{LEFT} {at:.1}h{WIDTH}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{:.1}\" \
             text-anchor=\"end\">{label}</text>",
            LEFT - 8.0,
            at + 4.0
        );
        tick += step;
    }
    let count = lines.first().map_or(0, |l| l.0.len());
    let x = |i: usize| LEFT + WIDTH * i as f64 / (count.max(2) - 1) as f64;
    for (k, (values, color, name)) in lines.iter().enumerate() {
        // A single frame is a level line.
        let alone = (values.len() == 1).then_some((1, &values[0]));
        let points: Vec<String> = values
            .iter()
            .enumerate()
            .chain(alone)
            .map(|(i, v)| format!("{:.1},{:.1}", x(i), y(*v)))
            .collect();
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"end\" fill=\"{color}\">{name}</text>",
            points.join(" "),
            LEFT + WIDTH - 150.0 * k as f64,
            top - 10.0
        );
    }
    let last = count.saturating_sub(1);
    let foot = top + HEIGHT + 18.0;
    let _ = writeln!(
        out,
        "<text x=\"{LEFT}\" y=\"{foot}\">frame 0</text><text x=\"{}\" y=\"{foot}\" \
         text-anchor=\"end\">{last}</text>",
        LEFT + WIDTH
    );
}

/// A step of 1, 2 or 5 times a power of ten.
fn nice(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.max(1e-6).log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|f| f * power >= step)
        .unwrap_or(10.0);
    factor * power
}

pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
