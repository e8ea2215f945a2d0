//! Camera paths: text, also gzip'd, `#` comments, one camera a line.

use std::path::Path;

use antumbra::cull::Camera;
use antumbra_io::read_unpacked;

use crate::failure::Failure;
use crate::load::read_failure;

/// Reads a path: `ex ey ez dx dy dz ux uy uz fovy` a line, the full vertical angle in degrees;
/// direction and up need be neither unit nor orthogonal.
pub(super) fn read(path: &Path, aspect: f64) -> Result<Vec<Camera>, Failure> {
    let bytes = read_unpacked(path).map_err(|error| read_failure(&error))?;
    let wrong = |line: usize, text: String| {
        Failure::Content(format!("{}, line {line}: {text}", path.display()))
    };
    let Ok(text) = std::str::from_utf8(&bytes) else {
        return Err(Failure::Content(format!(
            "{}: not a text file; a camera path has ten numbers a line",
            path.display()
        )));
    };
    let mut cameras = Vec::new();
    // Some editors put a mark before the text.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.len() != 10 {
            return Err(wrong(
                i + 1,
                format!(
                    "{} values found, ten expected: eye, direction and up (three each), then the \
                     vertical angle in degrees",
                    words.len()
                ),
            ));
        }
        let mut n = [0.0; 10];
        for (number, word) in n.iter_mut().zip(&words) {
            *number = word
                .parse()
                .map_err(|_| wrong(i + 1, format!("`{word}` is not a number")))?;
        }
        let [ex, ey, ez, dx, dy, dz, ux, uy, uz, angle] = n;
        let camera = Camera::new([ex, ey, ez], [dx, dy, dz], [ux, uy, uz], angle, aspect);
        cameras.push(camera.map_err(|error| wrong(i + 1, error.to_string()))?);
    }
    if cameras.is_empty() {
        return Err(Failure::Content(format!(
            "{}: no camera found; write one a line: ex ey ez dx dy dz ux uy uz fovy",
            path.display()
        )));
    }
    Ok(cameras)
}
