//! The panels as one SVG; each panel is a small image with a pixel a lattice point.

use antumbra_kernel::Sign;
use base64::Engine;

use crate::lattice::SIZE;

/// One predicate in one arithmetic.
pub(crate) struct Panel {
    /// The arithmetic.
    pub(crate) name: &'static str,
    /// A sign a lattice point, row by row from the top.
    pub(crate) signs: Vec<Sign>,
    /// How many of them are wrong.
    pub(crate) wrong: usize,
}

/// Negative, zero, positive.
const PALETTE: [[u8; 3]; 3] = [[0x3b, 0x6e, 0xa5], [0x22, 0x22, 0x22], [0xf0, 0xb4, 0x4c]];
/// How large a panel is drawn, and what is left around it.
const SIDE: usize = 2 * SIZE as usize;
const GAP: usize = 16;
const LABEL: usize = 40;

/// The figure: a row of panels for each predicate.
pub(crate) fn svg(rows: &[(&str, [Panel; 3])]) -> String {
    let (width, pitch) = (3 * SIDE + 4 * GAP, SIDE + LABEL + GAP);
    let height = rows.len() * pitch + GAP / 2 + 24;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\">\n  \
         <title>A sign in floats and in exact integers, over neighboring grid points</title>\n  \
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    for (r, (title, panels)) in rows.iter().enumerate() {
        let top = r * pitch + GAP / 2;
        out += &text(
            GAP,
            top + 14,
            "#222222",
            &format!("{title}, {SIZE} x {SIZE} points"),
            "bold",
        );
        for (c, panel) in panels.iter().enumerate() {
            let left = GAP + c * (SIDE + GAP);
            let label = format!("{}: {} wrong", panel.name, panel.wrong);
            out += &text(left, top + 32, "#555555", &label, "normal");
            out += &image(left, top + LABEL, &panel.signs);
        }
    }
    let legend = ["negative", "zero: the lines meet", "positive"];
    for (k, word) in legend.iter().enumerate() {
        let left = GAP + k * 110 + if k == 2 { 50 } else { 0 };
        let (y, [red, green, blue]) = (height - 24, PALETTE[k]);
        out += &format!(
            "  <rect x=\"{left}\" y=\"{y}\" width=\"12\" height=\"12\" \
             fill=\"#{red:02x}{green:02x}{blue:02x}\"/>\n"
        );
        out += &text(left + 18, y + 10, "#222222", word, "normal");
    }
    out + "</svg>\n"
}

fn text(x: usize, y: usize, fill: &str, words: &str, weight: &str) -> String {
    format!("  <text x=\"{x}\" y=\"{y}\" fill=\"{fill}\" font-weight=\"{weight}\">{words}</text>\n")
}

fn image(x: usize, y: usize, signs: &[Sign]) -> String {
    let data = base64::engine::general_purpose::STANDARD.encode(png(signs));
    format!(
        "  <image x=\"{x}\" y=\"{y}\" width=\"{SIDE}\" height=\"{SIDE}\" image-rendering=\"pixelated\" \
         href=\"data:image/png;base64,{data}\"/>\n"
    )
}

/// Each lattice point as a square of pixels, so that no viewer has to enlarge it.
fn png(signs: &[Sign]) -> Vec<u8> {
    let (size, scale) = (SIZE as usize, SIDE / SIZE as usize);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIDE as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Two);
    encoder.set_palette(PALETTE.concat());
    encoder.set_compression(png::Compression::High);
    let index = |sign: Sign| match sign {
        Sign::Negative => 0_u8,
        Sign::Zero => 1,
        Sign::Positive => 2,
    };
    let pixels: Vec<u8> = (0..SIDE * SIDE)
        .map(|k| index(signs[k / SIDE / scale * size + k % SIDE / scale]))
        .collect();
    let packed: Vec<u8> = pixels
        .chunks(4)
        .map(|four| four.iter().fold(0, |byte, p| byte << 2 | p))
        .collect();
    let written = encoder
        .write_header()
        .and_then(|mut w| w.write_image_data(&packed));
    written.expect("a vector takes all bytes");
    bytes
}
