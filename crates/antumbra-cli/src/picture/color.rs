//! Colors: a hue for each visible object, greys for the rest, one accent for the cell.

/// A color as linear red, green and blue from 0 to 1.
pub(super) type Rgb = [f32; 3];

/// The accent of the cell and of source polygons.
pub(super) const ACCENT: Rgb = [0.68, 0.0, 0.07];
/// Paper.
pub(super) const PAPER: Rgb = [0.97, 0.97, 0.965];

/// The color of a visible object. Neighbors in number get hues a golden angle apart; `calm` from 0
/// to 1 makes it paler, for floors and walls that would drown what stands on them.
pub(super) fn visible(object: u32, calm: f64) -> Rgb {
    const GOLDEN: f64 = 2.399_963_229_728_653;
    let hue = f64::from(object) * GOLDEN + 4.3;
    // Three lightnesses keep hues apart that come close again.
    let lightness = [0.70, 0.77, 0.64][(object % 3) as usize];
    oklch(
        lightness + calm * (0.90 - lightness),
        0.115 - 0.075 * calm,
        hue,
    )
}

/// The color of a hidden object.
pub(super) fn hidden() -> Rgb {
    oklch(0.82, 0.0, 0.0)
}

/// A color scaled in brightness.
pub(super) fn shade(color: Rgb, factor: f32) -> Rgb {
    color.map(|c| c * factor)
}

/// A mixture: `t = 1` is all `b`.
pub(super) fn mix(a: Rgb, b: Rgb, t: f32) -> Rgb {
    std::array::from_fn(|k| a[k] + t * (b[k] - a[k]))
}

/// As bytes in the sRGB encoding.
pub(super) fn bytes(color: Rgb) -> [u8; 3] {
    color.map(|c| {
        let c = c.clamp(0.0, 1.0);
        let s = if c <= 0.003_130_8 {
            12.92 * c
        } else {
            1.055 * c.powf(1.0 / 2.4) - 0.055
        };
        (s * 255.0).round() as u8
    })
}

/// As `#rrggbb`.
pub(super) fn hex(color: Rgb) -> String {
    let [r, g, b] = bytes(color);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A color by perceived lightness, chroma and hue (Ottosson's Oklab), clipped to sRGB.
fn oklch(lightness: f64, chroma: f64, hue: f64) -> Rgb {
    let (a, b) = (chroma * hue.cos(), chroma * hue.sin());
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
    .map(|c| c.clamp(0.0, 1.0) as f32)
}

#[cfg(test)]
mod tests {
    use super::{hex, hidden, visible};

    #[test]
    fn neighbors_differ_and_grey_is_grey() {
        for i in 0..200 {
            assert_ne!(hex(visible(i, 0.0)), hex(visible(i + 1, 0.0)));
        }
        let grey = hex(hidden());
        assert_eq!(grey[1..3], grey[3..5]);
    }
}
