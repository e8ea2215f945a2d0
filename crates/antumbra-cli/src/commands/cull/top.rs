//! The cells of the hierarchy as one frame classified them, seen from above [Bittner02, Figure 4.17].

use std::fmt::Write;

use antumbra::cull::{Camera, Cell, CellState, Culler};
use antumbra_scene::Scene;

use super::chart::escaped;

const KINDS: [(CellState, &str, &str); 5] = [
    (
        CellState::Outside,
        "#bfe3bf",
        "outside the view, or not asked",
    ),
    (CellState::Invisible, "#1e3a70", "invisible"),
    (
        CellState::Propagated,
        "#7fb2e5",
        "invisible by its neighbors",
    ),
    (CellState::Partial, "#ffffff", "may be seen"),
    (CellState::Full, "#f6d94c", "nothing in the way"),
];

/// Draws the cells at the height of the eye over the walls of the scene that are cut there.
pub(super) fn svg(scene: &Scene, culler: &Culler, camera: &Camera, title: &str) -> String {
    let bounds = scene.bounds();
    let (low, high) = (
        scene.grid().to_scene(bounds.min),
        scene.grid().to_scene(bounds.max),
    );
    let eye = camera.eye();
    let height = eye[2].clamp(low[2], high[2]);
    let (min, max) = (
        [low[0].min(eye[0]), low[1].min(eye[1])],
        [high[0].max(eye[0]), high[1].max(eye[1])],
    );
    let scale = 900.0 / (max[0] - min[0]).max(max[1] - min[1]).max(1e-9);
    let x = |v: f64| 20.0 + (v - min[0]) * scale;
    let y = |v: f64| 50.0 + (max[1] - v) * scale;
    let (w, h) = (
        40.0 + (max[0] - min[0]) * scale,
        190.0 + (max[1] - min[1]) * scale,
    );
    let w = w.max(420.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w:.0} {h:.0}\" \
         font-family=\"sans-serif\" font-size=\"13\" fill=\"#333\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"20\" y=\"28\" font-size=\"16\">{}</text>\n<g stroke=\"#0003\" stroke-width=\"0.4\">\n",
        escaped(title)
    );
    let cut = |c: &Cell| c.min[2] <= height && height <= c.max[2];
    for cell in culler.cells().filter(cut) {
        let color = KINDS
            .iter()
            .find(|k| k.0 == cell.state)
            .map_or("#f0f", |k| k.1);
        let _ = writeln!(
            out,
            "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"{color}\"/>",
            x(cell.min[0]),
            y(cell.max[1]),
            (cell.max[0] - cell.min[0]) * scale,
            (cell.max[1] - cell.min[1]) * scale
        );
    }
    out.push_str("</g>\n");
    let mut walls = String::new();
    for polygon in scene.polygons().filter(|p| p.occludes) {
        let corners: Vec<[f64; 3]> = polygon
            .corners
            .iter()
            .map(|&c| scene.grid().to_scene(c))
            .collect();
        let mut ends = Vec::new();
        for (i, a) in corners.iter().enumerate() {
            let b = &corners[(i + 1) % corners.len()];
            if (a[2] > height) != (b[2] > height) {
                let t = (height - a[2]) / (b[2] - a[2]);
                ends.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
            }
        }
        if let [a, b] = ends[..] {
            let _ = write!(
                walls,
                "M{:.1} {:.1}L{:.1} {:.1}",
                x(a[0]),
                y(a[1]),
                x(b[0]),
                y(b[1])
            );
        }
    }
    if !walls.is_empty() {
        let _ = writeln!(
            out,
            "<path fill=\"none\" stroke=\"#111\" stroke-width=\"1.2\" d=\"{walls}\"/>"
        );
    }
    view(&mut out, camera, [x(eye[0]), y(eye[1])]);
    for (i, (_, color, name)) in KINDS.iter().enumerate() {
        let at = h - 110.0 + 20.0 * i as f64;
        let _ = writeln!(
            out,
            "<rect x=\"20\" y=\"{:.1}\" width=\"14\" height=\"14\" fill=\"{color}\" stroke=\"#888\"/>\
             <text x=\"42\" y=\"{:.1}\">{name}</text>",
            at,
            at + 12.0
        );
    }
    out.push_str("</svg>\n");
    out
}

/// The eye and the sides of its view.
fn view(out: &mut String, camera: &Camera, [x, y]: [f64; 2]) {
    let [right, _, forward] = camera.axes();
    let w = camera.half_extents()[0];
    let side = |s: f64| {
        let d = [0, 1].map(|k| forward[k] + s * w * right[k]);
        let length = d[0].hypot(d[1]).max(1e-9);
        [x + 70.0 * d[0] / length, y - 70.0 * d[1] / length]
    };
    let (a, b) = (side(-1.0), side(1.0));
    let _ = writeln!(
        out,
        "<path d=\"M{:.1} {:.1}L{x:.1} {y:.1}L{:.1} {:.1}\" fill=\"none\" stroke=\"#d61f1f\" \
         stroke-width=\"2\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"#d61f1f\"/>",
        a[0], a[1], b[0], b[1]
    );
}
