//! Pictures of plans, in the manner of [Bittner02, Figures 6.1, 6.11 and 6.12]: the cell in blue, visible
//! fragments in red, extremal lines in yellow, culled kD nodes in gray; and blockers in line space.

use std::fmt::Write as _;

use antumbra::plan::{Isovist, Plan, PlanView, Seen};

use super::report::meet;

/// Width of a picture in pixels.
const WIDTH: f64 = 1200.0;

/// From grid steps to paper, y down.
struct Paper {
    low: [f64; 2],
    high: [f64; 2],
    scale: f64,
    y_down: bool,
}

impl Paper {
    fn new(low: [f64; 2], high: [f64; 2]) -> Self {
        let margin = ((high[0] - low[0]).max(high[1] - low[1]) * 0.02).max(1.0);
        let low = low.map(|v| v - margin);
        let high = high.map(|v| v + margin);
        Self {
            low,
            high,
            scale: WIDTH / (high[0] - low[0]),
            y_down: false,
        }
    }

    fn at(&self, p: [f64; 2]) -> String {
        let x = (p[0] - self.low[0]) * self.scale;
        let y = if self.y_down {
            p[1] - self.low[1]
        } else {
            self.high[1] - p[1]
        };
        let y = y * self.scale;
        format!("{x:.2} {y:.2}")
    }

    fn open(&self, title: &str) -> String {
        let height = (self.high[1] - self.low[1]) * self.scale;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height:.2}\" \
             viewBox=\"0 0 {WIDTH} {height:.2}\">\n<title>{title}</title>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
        )
    }
}

/// A path of many strokes or filled outlines of one kind.
fn layer(svg: &mut String, id: &str, style: &str, data: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(svg, "<path id=\"{id}\" {style} d=\"{data}\"/>");
}

fn outline(paper: &Paper, points: &[[f64; 2]]) -> String {
    let words: Vec<String> = points.iter().map(|&p| paper.at(p)).collect();
    format!("M{} Z ", words.join(" L"))
}

/// The plan with what is seen of it.
pub(super) fn plan(plan: &Plan, seen: &[Seen], areas: &[Isovist], y_down: bool) -> String {
    let bounds = plan.bounds();
    let cells = || seen.iter().flat_map(|s| &s.parts);
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    let corners = bounds.iter().flat_map(|b| [b.min, b.max]);
    for p in corners.chain(cells().flat_map(|v| v.cell.corners().to_vec())) {
        let p = p.to_f64();
        low = [0, 1].map(|k| low[k].min(p[k]));
        high = [0, 1].map(|k| high[k].max(p[k]));
    }
    let paper = Paper {
        y_down,
        ..Paper::new(low, high)
    };
    let mut svg = paper.open("What a cell sees of a plan");
    let (mut lines, mut red, mut blue) = (String::new(), String::new(), String::new());
    let boxes = |nodes: Vec<u32>| -> String {
        let bounds = nodes
            .into_iter()
            .map(|i| plan.kd().nodes()[i as usize].bounds);
        let outlines = bounds.map(|b| outline(&paper, &b.corners().map(|c| c.to_f64())));
        outlines.collect()
    };
    let [culled, again] = hidden_from_all(plan, cells()).map(boxes);
    for view in cells() {
        extremal(&paper, plan, view, &mut lines);
        let point = |piece: usize, t: f64| {
            let [p, q] = plan.pieces()[piece].map(|p| p.to_f64());
            [0, 1].map(|k| p[k] + t * (q[k] - p[k]))
        };
        let whole = view.touching.iter().map(|id| (id.0 as usize, 0.0, 1.0));
        let parts = view.fragments.iter();
        let parts = parts.map(|f| (f.piece.0 as usize, f.at[0].value(), f.at[1].value()));
        for (piece, from, to) in whole.chain(parts) {
            let _ = write!(
                red,
                "M{} L{} ",
                paper.at(point(piece, from)),
                paper.at(point(piece, to))
            );
        }
        let mut corners: Vec<[f64; 2]> = view.cell.corners().iter().map(|c| c.to_f64()).collect();
        if let [[x, y]] = corners[..] {
            // A point is drawn as a diamond of a few pixels.
            let r = 4.0 / paper.scale;
            corners = vec![[x - r, y], [x, y - r], [x + r, y], [x, y + r]];
        }
        blue += &outline(&paper, &corners);
    }
    let mut walls = String::new();
    for piece in plan.pieces() {
        let [p, q] = piece.map(|p| paper.at(p.to_f64()));
        let _ = write!(walls, "M{p} L{q} ");
    }
    layer(
        &mut svg,
        "culled",
        "fill=\"#e4e4e4\" stroke=\"#d2d2d2\" stroke-width=\"0.3\"",
        &culled,
    );
    let style = "fill=\"#cfe8c9\" stroke=\"#a9cfa0\" stroke-width=\"0.3\"";
    layer(&mut svg, "reclassified", style, &again);
    let mut seen_area = String::new();
    for ring in areas.iter().flat_map(|a| &a.polygons).flatten() {
        let steps: Vec<[f64; 2]> = ring.iter().map(|&p| plan.to_grid_f64(p)).collect();
        seen_area += &outline(&paper, &steps);
    }
    let style = "fill=\"#fff2b8\" fill-rule=\"evenodd\" stroke=\"none\"";
    layer(&mut svg, "isovist", style, &seen_area);
    layer(
        &mut svg,
        "extremal-lines",
        "fill=\"none\" stroke=\"#e8b800\" stroke-width=\"0.35\"",
        &lines,
    );
    layer(
        &mut svg,
        "walls",
        "fill=\"none\" stroke=\"#4a4a4a\" stroke-width=\"0.5\"",
        &walls,
    );
    let style = "fill=\"none\" stroke=\"#d00000\" stroke-width=\"1.6\" stroke-linecap=\"round\"";
    layer(&mut svg, "visible", style, &red);
    let style = "fill=\"#3060d0\" fill-opacity=\"0.45\" stroke=\"#2040a0\" stroke-width=\"1.6\" stroke-linejoin=\"round\"";
    layer(&mut svg, "cell", style, &blue);
    svg += "</svg>\n";
    svg
}

/// The nodes that were culled for every view, the highest ones; and the leaves that a second pass found hidden where
/// culling did not, and that no view sees.
fn hidden_from_all<'v>(plan: &Plan, views: impl Iterator<Item = &'v PlanView>) -> [Vec<u32>; 2] {
    let nodes = plan.kd().nodes();
    // For how many views a node was culled, and for how many it is hidden at least since the second pass.
    let mut counts = vec![[0_u32; 2]; nodes.len()];
    let mut all = 0;
    for view in views {
        all += 1;
        for &i in &view.culled {
            counts[i as usize][0] += 1;
        }
        for &i in &view.reclassified {
            counts[i as usize][1] += 1;
        }
    }
    let (mut culled, mut again) = (Vec::new(), Vec::new());
    let mut stack = if nodes.is_empty() {
        Vec::new()
    } else {
        vec![(0_u32, 0)]
    };
    while let Some((i, above)) = stack.pop() {
        let [here, second] = counts[i as usize];
        let count = above + here;
        if count == all {
            culled.push(i);
        } else if let Some(children) = nodes[i as usize].children() {
            stack.extend(children.map(|child| (child, count)));
        } else if count + second == all {
            again.push(i);
        }
    }
    culled.sort_unstable();
    again.sort_unstable();
    [culled, again]
}

/// The extremal lines of the funnels, from the cell to what they see.
fn extremal(paper: &Paper, plan: &Plan, view: &PlanView, out: &mut String) {
    for f in &view.funnels {
        let target = plan.pieces()[f.piece.0 as usize];
        for line in &f.lines {
            let from = match view.windows.get(f.window as usize) {
                Some(w) => meet(line, [w.a, w.b]),
                None => view.cell.corners()[0].to_f64(),
            };
            let _ = write!(
                out,
                "M{} L{} ",
                paper.at(from),
                paper.at(meet(line, target))
            );
        }
    }
}

/// The funnels of one cell as polygons of line space: each extremal line is the point (a, b, c) on a sphere around
/// the middle of the cell, drawn by its direction and its distance from the middle.
pub(super) fn line_space(seen: &[Seen]) -> String {
    let paper = Paper::new([-180.0, -60.0], [180.0, 60.0]);
    let mut svg =
        paper.open("Funnels in line space: direction against distance from the middle of the cell");
    let views = || seen.iter().flat_map(|s| &s.parts);
    // Of a cell in parts, all lines are measured from the middle of the whole.
    let corners = || views().flat_map(|v| v.cell.corners()).map(|c| c.to_f64());
    let low = [0, 1].map(|k| corners().fold(f64::INFINITY, |m, p| m.min(p[k])));
    let high = [0, 1].map(|k| corners().fold(f64::NEG_INFINITY, |m, p| m.max(p[k])));
    let middle = [0, 1].map(|k| (low[k] + high[k]) / 2.0);
    let radius = ((high[0] - low[0]).hypot(high[1] - low[1]) / 2.0).max(1.0);
    for view in views() {
        for (i, f) in view.funnels.iter().enumerate() {
            let mut points: Vec<[f64; 2]> = Vec::new();
            for line in &f.lines {
                let [a, b, c] = line.rounded();
                let length = a.hypot(b);
                let distance = (a * middle[0] + b * middle[1] + c) / length / radius;
                let mut angle = (-a).atan2(b).to_degrees();
                // Turn all to the same side of the cut at 180 degrees.
                if let Some(first) = points.first() {
                    let turns = ((first[0] - angle) / 360.0).round();
                    angle += 360.0 * turns;
                }
                points.push([angle, distance * 55.0]);
            }
            let hue = (f.piece.0.wrapping_mul(2_654_435_761) >> 8) % 360;
            let style =
                format!("fill=\"hsl({hue} 65% 70%)\" stroke=\"#303030\" stroke-width=\"0.25\"");
            layer(
                &mut svg,
                &format!("funnel-{i}"),
                &style,
                &outline(&paper, &points),
            );
        }
    }
    svg += "</svg>\n";
    svg
}
