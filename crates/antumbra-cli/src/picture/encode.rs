//! Pixels as a PNG file.

/// Encodes rows of red, green and blue bytes.
pub(crate) fn png(
    [width, height]: [usize; 2],
    pixels: &[u8],
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::png;

    #[test]
    fn a_picture_has_the_png_signature() {
        let bytes = png([2, 1], &[255, 0, 0, 0, 0, 255]).expect("two pixels");
        assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n"));
        assert!(png([2, 2], &[0; 3]).is_err());
    }
}
