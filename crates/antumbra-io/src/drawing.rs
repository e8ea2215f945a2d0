//! Drawings of lines: SVG for screens and plotters, DXF for CAD.
//!
//! A drawing is a list of layers; each line knows the element that it belongs to. Both writers are
//! deterministic and write what they are given, without a decision of their own.

use std::fmt::Write as _;

/// Lines on paper: x to the right, y down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The title; may be empty.
    pub title: String,
    /// Width and height in paper units.
    pub size: [f64; 2],
    /// The scale, if it is the same everywhere; DXF is in scene units then.
    pub scale: Option<Scale>,
    /// The layers, lowest first.
    pub layers: Vec<Layer>,
}

/// How a drawing lies in the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// How many paper units a scene unit is.
    pub units: f64,
    /// Where the origin of the scene is on paper.
    pub origin: [f64; 2],
}

/// Lines of one kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// The name: letters, digits and hyphens.
    pub name: String,
    /// Line width in paper units.
    pub width: f64,
    /// Whether the lines are dashed.
    pub dashed: bool,
    /// The lines.
    pub lines: Vec<Line>,
}

/// A line of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// The number of the object it belongs to.
    pub object: u32,
    /// The object's name.
    pub name: String,
    /// The object's class; empty if it has none.
    pub class: String,
    /// Its points; at least two. Closed if it ends where it starts.
    pub points: Vec<[f64; 2]>,
}

/// Writes a drawing as SVG: a group a layer with the layer's name as id and class, a path a line with
/// the classes of its layer and its element and the attributes `data-object` and `data-name`; the
/// scale, if there is one, as `data-scale` of the root.
#[must_use]
pub fn write_svg(drawing: &Drawing) -> String {
    let [width, height] = drawing.size;
    let scale = drawing
        .scale
        .map(|s| format!(" data-scale=\"{}\"", s.units));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\"{}>\n<title>{}</title>\n<style>\n\
         path {{ fill: none; stroke: #1c1c1c; stroke-linecap: round; stroke-linejoin: round }}\n",
        scale.unwrap_or_default(),
        escape(&drawing.title)
    );
    for layer in &drawing.layers {
        let dash = if layer.dashed {
            format!(
                "; stroke-dasharray: {} {}",
                3.0 * layer.width,
                3.0 * layer.width
            )
        } else {
            String::new()
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            svg,
            ".{} {{ stroke-width: {}{dash} }}",
            layer.name, layer.width
        );
    }
    svg.push_str("</style>\n");
    for layer in &drawing.layers {
        let name = &layer.name;
        let _ = writeln!(svg, "<g id=\"{name}\" class=\"layer\">");
        for line in &layer.lines {
            let class = css(&line.class);
            let _ = writeln!(
                svg,
                "<path class=\"{name}{}{class}\" data-object=\"{}\" data-name=\"{}\" d=\"{}\"/>",
                if class.is_empty() { "" } else { " element-" },
                line.object,
                escape(&line.name),
                path(&line.points)
            );
        }
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

fn path(points: &[[f64; 2]]) -> String {
    let closed = points.len() > 3 && points.first() == points.last();
    let open = if closed {
        &points[..points.len() - 1]
    } else {
        points
    };
    let mut d = String::new();
    for (i, [x, y]) in open.iter().enumerate() {
        let command = if i == 0 { "M" } else { " L" };
        let _ = write!(d, "{command}{} {}", short(*x), short(*y));
    }
    if closed {
        d.push_str(" Z");
    }
    d
}

/// Four decimals at most.
fn short(v: f64) -> String {
    decimal(v, 4)
}

/// So many decimals at most, no trailing zeros.
fn decimal(v: f64, decimals: usize) -> String {
    let text = format!("{v:.decimals$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// As a CSS class: lower case, other characters than letters and digits become hyphens.
fn css(class: &str) -> String {
    let one = |c: char| if c.is_alphanumeric() { c } else { '-' };
    class.to_lowercase().chars().map(one).collect()
}

fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Not allowed in XML at all.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Who has written the extended data of a polyline.
const APPLICATION: &str = "ANTUMBRA";
/// The longest string of extended data, in bytes.
const LONGEST: usize = 255;

/// Writes a drawing as DXF (R12, text): a layer a layer, a polyline a line, y up; in scene units if the
/// drawing has a scale, and where they are in the scene. Each polyline has the object's number and name as extended data of the
/// application `ANTUMBRA`.
#[must_use]
pub fn write_dxf(drawing: &Drawing) -> String {
    let Scale { units, origin } = drawing.scale.unwrap_or(Scale {
        units: 1.0,
        origin: [0.0, drawing.size[1]],
    });
    let mut dxf = String::new();
    let mut pair = |code: u32, value: &str| {
        let _ = write!(dxf, "{code:>3}\n{value}\n");
    };
    for (code, value) in [
        (0, "SECTION"),
        (2, "HEADER"),
        (9, "$ACADVER"),
        (1, "AC1009"),
    ] {
        pair(code, value);
    }
    for (code, value) in [(0, "ENDSEC"), (0, "SECTION"), (2, "TABLES")] {
        pair(code, value);
    }
    for (code, value) in [(0, "TABLE"), (2, "LTYPE"), (70, "2")] {
        pair(code, value);
    }
    for (name, text, dashes) in [
        ("CONTINUOUS", "Solid", &[][..]),
        ("DASHED", "- - -", &["2", "-2"]),
    ] {
        pair(0, "LTYPE");
        pair(2, name);
        pair(70, "64");
        pair(3, text);
        pair(72, "65");
        pair(73, &dashes.len().to_string());
        pair(40, if dashes.is_empty() { "0" } else { "4" });
        dashes.iter().for_each(|dash| pair(49, dash));
    }
    pair(0, "ENDTAB");
    pair(0, "TABLE");
    pair(2, "LAYER");
    pair(70, &drawing.layers.len().to_string());
    for layer in &drawing.layers {
        pair(0, "LAYER");
        pair(2, &layer.name);
        pair(70, "64");
        pair(62, "7");
        pair(6, if layer.dashed { "DASHED" } else { "CONTINUOUS" });
    }
    for (code, value) in [
        (0, "ENDTAB"),
        (0, "TABLE"),
        (2, "APPID"),
        (70, "1"),
        (0, "APPID"),
        (2, APPLICATION),
        (70, "0"),
        (0, "ENDTAB"),
        (0, "ENDSEC"),
        (0, "SECTION"),
        (2, "ENTITIES"),
    ] {
        pair(code, value);
    }
    for layer in &drawing.layers {
        for line in &layer.lines {
            let closed = line.points.len() > 3 && line.points.first() == line.points.last();
            let points = &line.points[..line.points.len() - usize::from(closed)];
            pair(0, "POLYLINE");
            pair(8, &layer.name);
            pair(66, "1");
            pair(70, if closed { "1" } else { "0" });
            pair(1001, APPLICATION);
            pair(1071, &line.object.to_string());
            pair(1000, &extended(&line.name));
            for [x, y] in points {
                pair(0, "VERTEX");
                pair(8, &layer.name);
                pair(10, &decimal((x - origin[0]) / units, 6));
                pair(20, &decimal((origin[1] - y) / units, 6));
            }
            pair(0, "SEQEND");
            pair(8, &layer.name);
        }
    }
    pair(0, "ENDSEC");
    pair(0, "EOF");
    dxf
}

/// A name as a string of extended data; what is not ASCII by its number, as DXF has it.
fn extended(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars().filter(|c| !c.is_control()) {
        let more = if c.is_ascii() {
            c.to_string()
        } else {
            format!("\\U+{:04X}", u32::from(c))
        };
        if text.len() + more.len() > LONGEST {
            break;
        }
        text.push_str(&more);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{Drawing, Layer, Line, Scale, write_dxf, write_svg};

    fn drawing() -> Drawing {
        let line = |points: &[[f64; 2]]| Line {
            object: 7,
            name: "a \"b\" <c>\n".into(),
            class: "Outer Wall".into(),
            points: points.to_vec(),
        };
        Drawing {
            title: "t & u".into(),
            size: [20.0, 10.0],
            scale: None,
            layers: vec![Layer {
                name: "shadow".into(),
                width: 0.5,
                dashed: true,
                lines: vec![
                    line(&[[0.0, 0.0], [1.5, 2.25]]),
                    line(&[[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 0.0]]),
                ],
            }],
        }
    }

    #[test]
    fn svg_links_each_path_to_its_element() {
        let svg = write_svg(&drawing());
        assert!(svg.contains("<g id=\"shadow\" class=\"layer\">"));
        assert!(svg.contains(
            "<path class=\"shadow element-outer-wall\" data-object=\"7\" \
             data-name=\"a &quot;b&quot; &lt;c&gt; \" d=\"M0 0 L1.5 2.25\"/>"
        ));
        assert!(svg.contains("d=\"M0 0 L4 0 L4 3 Z\""));
        assert!(svg.contains("<title>t &amp; u</title>") && svg.contains("dasharray: 1.5 1.5"));
    }

    #[test]
    fn dxf_comes_in_pairs_and_closes_what_it_opens() {
        let dxf = write_dxf(&drawing());
        let lines: Vec<&str> = dxf.lines().collect();
        assert_eq!(lines.len() % 2, 0);
        assert!(
            lines
                .iter()
                .step_by(2)
                .all(|code| code.trim().parse::<u32>().is_ok())
        );
        let count = |what: &str| {
            lines
                .iter()
                .skip(1)
                .step_by(2)
                .filter(|v| **v == what)
                .count()
        };
        assert_eq!((count("SECTION"), count("ENDSEC")), (3, 3));
        assert_eq!((count("TABLE"), count("ENDTAB")), (3, 3));
        assert_eq!(
            (count("POLYLINE"), count("SEQEND"), count("VERTEX")),
            (2, 2, 5)
        );
        assert_eq!(lines.last(), Some(&"EOF"));
        // y is up.
        assert!(dxf.contains(" 10\n1.5\n 20\n7.75\n"));
        assert!(dxf.contains("1001\nANTUMBRA\n1071\n7\n1000\na \"b\" <c>\n"));
    }

    #[test]
    fn with_a_scale_dxf_is_in_scene_units() {
        let mut drawing = drawing();
        drawing.scale = Some(Scale {
            units: 2.0,
            origin: [1.0, 4.0],
        });
        assert!(write_dxf(&drawing).contains(" 10\n0.25\n 20\n0.875\n"));
        let svg = write_svg(&drawing);
        assert!(svg.contains("viewBox=\"0 0 20 10\" data-scale=\"2\">"));
        assert!(svg.contains("L1.5 2.25"));
    }

    #[test]
    fn names_fit_into_extended_data() {
        assert_eq!(super::extended("wall\n7"), "wall7");
        assert_eq!(super::extended("Tür"), "T\\U+00FCr");
        assert_eq!(super::extended(&"ä".repeat(300)).len(), 36 * 7);
    }
}
