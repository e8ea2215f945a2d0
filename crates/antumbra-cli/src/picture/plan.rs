//! The plan: a top view as SVG, with the cut drawn as architects do.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::camera::Camera;
use super::color::{self, ACCENT, PAPER, Rgb, mix, shade};
use super::raster::{ItemBuffer, NONE};
use super::section::{Piece, loops, open};
use super::vector::{V3, area_vector, dot};
use super::{Shown, Subject};

/// Width of the drawing area in pixels; tall scenes are narrower.
const WIDTH: f64 = 1400.0;
const HEIGHT: f64 = 1000.0;
const MARGIN: f64 = 24.0;
/// Height of the strip with caption, legend and scale.
const STRIP: f64 = 56.0;

/// Draws the plan of a subject.
pub(crate) fn plan(subject: &Subject) -> String {
    let remains = open(subject);
    let [min, max] = subject.focus();
    let pad = 0.02 * (max[0] - min[0]).max(max[1] - min[1]).max(1e-9);
    let (left, top) = (min[0] - pad, max[1] + pad);
    let [w, h] = [max[0] - min[0] + 2.0 * pad, max[1] - min[1] + 2.0 * pad];
    let scale = (WIDTH / w).min(HEIGHT / h);
    let camera = Camera::top([left, top], scale, [MARGIN, MARGIN]);
    let frame = [w * scale, h * scale];

    let mut svg = header(subject, frame);
    let palette = subject.palette();
    areas(subject, &palette, &remains.pieces, &camera, frame, &mut svg);
    sheets(subject, &palette, &remains.pieces, &camera, &mut svg);
    cuts(&palette, &remains.lines, &camera, &mut svg);
    cell(subject, &camera, &mut svg);
    svg.push_str("</g>\n");
    legend(subject, frame, scale, &mut svg);
    svg.push_str("</svg>\n");
    svg
}

fn header(subject: &Subject, [w, h]: [f64; 2]) -> String {
    let (width, height) = (w.max(640.0) + 2.0 * MARGIN, h + 2.0 * MARGIN + STRIP);
    let mut svg = String::new();
    // Writing to a string cannot fail.
    let _ = write!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"Helvetica, Arial, sans-serif\" \
         font-size=\"14\">\n<title>{}</title>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n\
         <clipPath id=\"frame\"><rect x=\"{MARGIN}\" y=\"{MARGIN}\" width=\"{w:.2}\" \
         height=\"{h:.2}\"/></clipPath>\n\
         <g clip-path=\"url(#frame)\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n",
        escape(&subject.caption),
        color::hex(PAPER),
    );
    svg
}

/// What is seen from above, lowest first.
fn areas(
    subject: &Subject,
    palette: &[Rgb],
    pieces: &[Piece],
    camera: &Camera,
    frame: [f64; 2],
    svg: &mut String,
) {
    let size = frame.map(|n| (n + 2.0 * MARGIN).ceil() as usize);
    let mut buffer = ItemBuffer::new(size);
    let solid_to_see = |p: &Piece| !p.clear && subject.shown[p.object as usize] != Shown::Source;
    for (i, piece) in pieces.iter().enumerate().filter(|(_, p)| solid_to_see(p)) {
        buffer.draw(camera, &piece.corners, i as u32);
    }
    let seen: BTreeSet<u32> = buffer
        .items
        .iter()
        .copied()
        .filter(|i| *i != NONE)
        .collect();
    let top = |p: &Piece| p.corners.iter().map(|c| c[2]).fold(f64::MIN, f64::max);
    // The inside of a solid that was cut open belongs under its section, not into the plan.
    let inside = |p: &Piece| p.solid && area_vector(&p.corners)[2] < 0.0;
    let mut shown: Vec<&Piece> = seen
        .into_iter()
        .map(|i| &pieces[i as usize])
        .filter(|p| !inside(p))
        .collect();
    shown.sort_by(|a, b| top(a).total_cmp(&top(b)));
    for piece in shown {
        let base = palette[piece.object as usize];
        let n = area_vector(&piece.corners);
        let slope = (n[2].abs() / dot(n, n).sqrt()) as f32;
        let paint = shade(base, 0.8 + 0.2 * slope);
        let _ = writeln!(
            svg,
            "<path d=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"0.6\"/>",
            path(&piece.corners, camera, true),
            color::hex(paint),
            color::hex(shade(paint, 0.55)),
        );
    }
}

/// Upright polygons that are no part of a solid: lines, hidden ones first.
fn sheets(subject: &Subject, palette: &[Rgb], pieces: &[Piece], camera: &Camera, svg: &mut String) {
    let mut lines = BTreeMap::<String, (bool, u32)>::new();
    for piece in pieces.iter().filter(|p| !p.solid && !p.clear) {
        let n = area_vector(&piece.corners);
        let upright = n[2].abs() <= 1e-6 * dot(n, n).sqrt();
        if upright && subject.shown[piece.object as usize] != Shown::Source {
            let visible = subject.shown[piece.object as usize] == Shown::Visible;
            let along = |p: &V3| n[0] * p[1] - n[1] * p[0];
            let first = piece
                .corners
                .iter()
                .copied()
                .min_by(|a, b| along(a).total_cmp(&along(b)));
            let last = piece
                .corners
                .iter()
                .copied()
                .max_by(|a, b| along(a).total_cmp(&along(b)));
            if let (Some(a), Some(b)) = (first, last) {
                let entry = lines.entry(path(&[a, b], camera, false));
                let entry = entry.or_insert((visible, piece.object));
                if visible && !entry.0 {
                    *entry = (true, piece.object);
                }
            }
        }
    }
    let mut order: Vec<_> = lines.iter().collect();
    order.sort_by_key(|(_, (visible, _))| *visible);
    for (d, (visible, object)) in order {
        let _ = writeln!(
            svg,
            "<path d=\"{d}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>",
            color::hex(shade(palette[*object as usize], 0.7)),
            if *visible { 2.5 } else { 1.0 },
        );
    }
}

/// The section: solids filled, single sheets as thick lines.
fn cuts(palette: &[Rgb], lines: &[(u32, bool, [V3; 2])], camera: &Camera, svg: &mut String) {
    let mut by_object = BTreeMap::<u32, (bool, Vec<[V3; 2]>)>::new();
    for &(object, solid, line) in lines {
        by_object
            .entry(object)
            .or_insert_with(|| (solid, Vec::new()))
            .1
            .push(line);
    }
    for (object, (solid, lines)) in by_object {
        let dark = mix(shade(palette[object as usize], 0.55), [0.03; 3], 0.25);
        if solid {
            let d: String = loops(&lines)
                .iter()
                .map(|l| {
                    path(
                        &l.iter().map(|p| [p[0], p[1], 0.0]).collect::<Vec<_>>(),
                        camera,
                        true,
                    )
                })
                .collect();
            let _ = writeln!(
                svg,
                "<path d=\"{d}\" fill=\"{}\" fill-rule=\"evenodd\" stroke=\"{}\" \
                 stroke-width=\"1.2\"/>",
                color::hex(dark),
                color::hex(shade(dark, 0.5)),
            );
        } else {
            let d: String = lines.iter().map(|l| path(l, camera, false)).collect();
            let _ = writeln!(
                svg,
                "<path d=\"{d}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2.5\"/>",
                color::hex(dark),
            );
        }
    }
}

/// The cell, and the polygons of a source object.
fn cell(subject: &Subject, camera: &Camera, svg: &mut String) {
    let accent = color::hex(ACCENT);
    for face in &subject.faces {
        if subject.shown[face.object as usize] == Shown::Source {
            let d = path(&face.corners, camera, true);
            let _ = writeln!(
                svg,
                "<path d=\"{d}\" fill=\"{accent}\" fill-opacity=\"0.5\" stroke=\"{accent}\" \
                 stroke-width=\"3\"/>"
            );
        }
    }
    let [min, max] = subject.cell;
    let [[x0, y1, _], [x1, y0, _]] = [camera.project(min), camera.project(max)];
    let _ = writeln!(
        svg,
        "<rect x=\"{x0:.2}\" y=\"{y0:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"{accent}\" \
         fill-opacity=\"0.16\" stroke=\"{accent}\" stroke-width=\"2.5\"/>",
        x1 - x0,
        y1 - y0,
    );
}

/// Caption, colors, and a bar of a round length.
fn legend(subject: &Subject, [w, h]: [f64; 2], scale: f64, svg: &mut String) {
    let y = h + 2.0 * MARGIN + 8.0;
    let accent = color::hex(ACCENT);
    let _ = write!(
        svg,
        "<text x=\"{MARGIN}\" y=\"{y:.0}\" font-weight=\"bold\" fill=\"#222\">{}</text>\n\
         <g transform=\"translate({MARGIN} {:.0})\" fill=\"#333\">\n\
         <rect y=\"-11\" width=\"12\" height=\"12\" fill=\"{accent}\" fill-opacity=\"0.16\" \
         stroke=\"{accent}\" stroke-width=\"2\"/><text x=\"20\">view cell</text>\n",
        escape(&subject.caption),
        y + 24.0,
    );
    for k in 0..3_u32 {
        let fill = color::hex(color::visible(k, 0.0));
        let x = 110 + 8 * k;
        let _ = write!(
            svg,
            "<rect x=\"{x}\" y=\"-11\" width=\"8\" height=\"12\" fill=\"{fill}\"/>"
        );
    }
    let _ = write!(
        svg,
        "<text x=\"142\">visible ({})</text>\n\
         <rect x=\"250\" y=\"-11\" width=\"24\" height=\"12\" fill=\"{}\"/>\
         <text x=\"282\">hidden ({})</text>\n</g>\n",
        subject.count(Shown::Visible),
        color::hex(color::hidden()),
        subject.count(Shown::Hidden),
    );
    let length = round_length(160.0 / scale);
    let (x1, x0) = (
        w.max(640.0) + MARGIN,
        w.max(640.0) + MARGIN - length * scale,
    );
    let _ = write!(
        svg,
        "<path d=\"M{x0:.2} {:.2}v8h{:.2}v-8\" fill=\"none\" stroke=\"#222\" \
         stroke-width=\"1.5\"/>\n<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"middle\" \
         fill=\"#222\">{length} scene units</text>\n",
        y + 16.0,
        x1 - x0,
        (x0 + x1) / 2.0,
        y + 12.0,
    );
}

/// The largest of 1, 2, 5 times a power of ten that is not above a length.
fn round_length(limit: f64) -> f64 {
    let power = 10_f64.powf(limit.log10().floor());
    [5.0, 2.0, 1.0]
        .map(|f| f * power)
        .into_iter()
        .find(|l| *l <= limit)
        .unwrap_or(power)
}

/// SVG path data of a polygon or a line.
fn path(points: &[V3], camera: &Camera, closed: bool) -> String {
    let mut d = String::new();
    for (i, p) in points.iter().enumerate() {
        let [x, y, _] = camera.project(*p);
        let _ = write!(d, "{}{x:.2} {y:.2}", if i == 0 { 'M' } else { 'L' });
    }
    if closed {
        d.push('Z');
    }
    d
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::{escape, round_length};

    #[test]
    fn scale_bars_are_round() {
        for (limit, length) in [(7.3, 5.0), (2.0, 2.0), (19.9, 10.0), (0.034, 0.02)] {
            assert!((round_length(limit) - length).abs() < 1e-12);
        }
        assert_eq!(escape("a<b & c"), "a&lt;b &amp; c");
    }
}
