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
    /// The layers, lowest first.
    pub layers: Vec<Layer>,
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
/// the classes of its layer and its element and the attributes `data-object` and `data-name`.
#[must_use]
pub fn write_svg(drawing: &Drawing) -> String {
    let [width, height] = drawing.size;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\">\n<title>{}</title>\n<style>\n\
         path {{ fill: none; stroke: #1c1c1c; stroke-linecap: round; stroke-linejoin: round }}\n",
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

/// Four decimals at most, no trailing zeros.
fn short(v: f64) -> String {
    let text = format!("{v:.4}");
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

/// Writes a drawing as DXF (R12, text): a layer a layer, a polyline a line, y up. The object's name
/// stands before each polyline as a comment (group 999), since R12 has no place for it.
#[must_use]
pub fn write_dxf(drawing: &Drawing) -> String {
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
            let name: String = line.name.chars().filter(|c| !c.is_control()).collect();
            pair(999, &format!("object {} {name}", line.object));
            pair(0, "POLYLINE");
            pair(8, &layer.name);
            pair(66, "1");
            pair(70, if closed { "1" } else { "0" });
            for [x, y] in points {
                pair(0, "VERTEX");
                pair(8, &layer.name);
                pair(10, &short(*x));
                pair(20, &short(drawing.size[1] - y));
            }
            pair(0, "SEQEND");
            pair(8, &layer.name);
        }
    }
    pair(0, "ENDSEC");
    pair(0, "EOF");
    dxf
}

#[cfg(test)]
mod tests {
    use super::{Drawing, Layer, Line, write_dxf, write_svg};

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
        assert_eq!((count("TABLE"), count("ENDTAB")), (2, 2));
        assert_eq!(
            (count("POLYLINE"), count("SEQEND"), count("VERTEX")),
            (2, 2, 5)
        );
        assert_eq!(lines.last(), Some(&"EOF"));
        // y is up.
        assert!(dxf.contains(" 10\n1.5\n 20\n7.75\n"));
    }
}
