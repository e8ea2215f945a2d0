//! Curves in panels side by side, as SVG.

use std::fmt::Write as _;

/// A named, colored line through points.
pub(crate) struct Curve {
    pub name: String,
    pub color: &'static str,
    pub points: Vec<[f64; 2]>,
}

/// One panel.
pub(crate) struct Panel {
    pub title: String,
    pub curves: Vec<Curve>,
}

/// What the axes of all panels say.
pub(crate) struct Axes {
    pub across: &'static str,
    pub up: &'static str,
    /// Whether equal ways across are equal factors.
    pub logarithmic: bool,
}

const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 240.0;
const LEFT: f64 = 60.0;
const TOP: f64 = 66.0;
const NEXT: f64 = WIDTH + 90.0;

/// The whole picture.
pub(crate) fn svg(title: &str, axes: &Axes, panels: &[Panel]) -> String {
    let w = LEFT + NEXT * panels.len() as f64 - 60.0;
    let h = TOP + HEIGHT + 56.0;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
         font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\">\n<title>{title}</title>\n\
         <rect width=\"{w}\" height=\"{h}\" fill=\"#fff\"/>\n\
         <text x=\"{LEFT}\" y=\"22\" font-size=\"15\">{title}</text>\n"
    );
    for (i, panel) in panels.iter().enumerate() {
        let left = LEFT + NEXT * i as f64;
        draw(&mut out, left, axes, panel);
    }
    out + "</svg>\n"
}

fn draw(out: &mut String, left: f64, axes: &Axes, panel: &Panel) {
    let place = |v: f64| if axes.logarithmic { v.ln() } else { v };
    let points = || panel.curves.iter().flat_map(|c| &c.points);
    let most = |k: usize| points().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
    let least = points().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let step = nice(most(1) / 5.0);
    let high = (most(1) / step).ceil() * step;
    let (from, to) = (place(least), place(most(0)));
    let x = |v: f64| left + WIDTH * (place(v) - from) / (to - from);
    let y = |v: f64| TOP + HEIGHT * (1.0 - v / high);
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "<text x=\"{left}\" y=\"{}\" font-weight=\"bold\">{}</text>\
         <text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
        TOP - 12.0,
        panel.title,
        left + WIDTH,
        TOP - 12.0,
        axes.up
    );
    for k in 0..=(high / step).round() as u32 {
        let value = f64::from(k) * step;
        let _ = writeln!(
            out,
            "<path d=\"M{left} {:.1}h{WIDTH}\" stroke=\"#ddd\"/>\
             <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            y(value),
            left - 6.0,
            y(value) + 4.0,
            short(value)
        );
    }
    let bottom = TOP + HEIGHT;
    for p in panel.curves.first().into_iter().flat_map(|c| &c.points) {
        let _ = writeln!(
            out,
            "<path d=\"M{:.1} {bottom}v4\" stroke=\"#333\"/>\
             <text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            x(p[0]),
            x(p[0]),
            bottom + 18.0,
            short(p[0])
        );
    }
    let _ = writeln!(
        out,
        "<path d=\"M{left} {TOP}V{bottom}h{WIDTH}\" fill=\"none\" stroke=\"#333\"/>\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
        left + WIDTH / 2.0,
        bottom + 40.0,
        axes.across
    );
    for (i, curve) in panel.curves.iter().enumerate() {
        let path: Vec<String> = curve
            .points
            .iter()
            .map(|p| format!("{:.1} {:.1}", x(p[0]), y(p[1])))
            .collect();
        let _ = writeln!(
            out,
            "<path d=\"M{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>",
            path.join(" L"),
            curve.color
        );
        // A key in the lower left corner, where all curves are far from zero.
        let at = bottom - 12.0 - 17.0 * (panel.curves.len() - 1 - i) as f64;
        let _ = writeln!(
            out,
            "<path d=\"M{} {:.1}h18\" stroke=\"{}\" stroke-width=\"2\"/><text x=\"{}\" y=\"{at:.1}\">{}</text>",
            left + 10.0,
            at - 4.0,
            curve.color,
            left + 34.0,
            curve.name
        );
    }
}

/// Without digits that say nothing.
fn short(value: f64) -> String {
    format!("{}", (value * 1e4).round() / 1e4)
}

/// A step of 1, 2 or 5 times a power of ten.
fn nice(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.max(1e-6).log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0];
    factors
        .into_iter()
        .find(|f| f * power >= step)
        .unwrap_or(10.0)
        * power
}
