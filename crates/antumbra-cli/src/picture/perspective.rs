//! The perspective view: a z-buffer rendering, shaded by normal, with outlines and the cell's frame.

use super::camera::Camera;
use super::color::{self, ACCENT, PAPER, Rgb, mix, shade};
use super::raster::{ItemBuffer, NONE, is_nearer, scan};
use super::section::{Piece, Remains, open};
use super::vector::{V3, area_vector, cross, dot, lerp, sub, unit};
use super::{Shown, Subject};

/// How to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PerspectiveOptions {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Compass direction of the camera as seen from the scene, in degrees counter-clockwise from
    /// `+x`; chosen by the scene if not given.
    pub azimuth: Option<f64>,
    /// How high the camera stands, in degrees; chosen by the scene if not given.
    pub elevation: Option<f64>,
}

impl Default for PerspectiveOptions {
    fn default() -> Self {
        Self {
            size: [1600, 1000],
            azimuth: None,
            elevation: None,
        }
    }
}

/// Pixels are computed as squares of this many samples a side.
pub(super) const SAMPLES: usize = 2;

/// Renders the view: rows of red, green and blue bytes, from the top.
pub(crate) fn perspective(subject: &Subject, options: &PerspectiveOptions) -> Vec<u8> {
    let remains = open(subject);
    let size = options.size.map(|n| n * SAMPLES);
    let camera = aim(subject, &remains, options, size);
    let pieces: Vec<&Piece> = remains
        .pieces
        .iter()
        .filter(|piece| {
            // With the roof off, walls of a single sheet that turn their back are taken away, too.
            let dropped = remains.cut.is_some()
                && !piece.solid
                && subject.shown[piece.object as usize] != Shown::Source
                && faces_away(&camera, piece);
            !dropped
        })
        .collect();
    let mut buffer = ItemBuffer::new(size);
    for (i, piece) in pieces.iter().enumerate().filter(|(_, p)| !p.clear) {
        buffer.draw(&camera, &piece.corners, i as u32);
    }
    let palette = subject.palette();
    let mut pixels = resolve(&palette, &camera, &pieces, &buffer);
    blend_clear(&palette, &camera, &pieces, &buffer, &mut pixels);
    draw_cell(subject, &camera, &buffer, &mut pixels);
    shrink(&pixels, options.size)
}

/// The camera: from the side that shows most, framing what is visible.
fn aim(
    subject: &Subject,
    remains: &Remains,
    options: &PerspectiveOptions,
    size: [usize; 2],
) -> Camera {
    let cut = remains.cut.is_some();
    // A source polygon that looks sideways is seen over its shoulder.
    let normal = subject
        .faces
        .iter()
        .find(|f| subject.shown[f.object as usize] == Shown::Source)
        .map(|f| unit(area_vector(&f.corners)));
    let behind = match normal {
        Some([x, y, _]) if x.hypot(y) > 0.5 => (-y).atan2(-x).to_degrees() - 40.0,
        _ => -115.0,
    };
    let azimuth = options.azimuth.unwrap_or(behind).to_radians();
    let elevation = options
        .elevation
        .unwrap_or(if cut { 52.0 } else { 28.0 })
        .clamp(-89.0, 89.0)
        .to_radians();
    let direction = [
        -azimuth.cos() * elevation.cos(),
        -azimuth.sin() * elevation.cos(),
        -elevation.sin(),
    ];
    let mut points: Vec<V3> = (0..8).map(|i| corner(subject.cell, i)).collect();
    let visible = |p: &&Piece| subject.shown[p.object as usize] != Shown::Hidden;
    points.extend(
        remains
            .pieces
            .iter()
            .filter(visible)
            .flat_map(|p| p.corners.iter().copied()),
    );
    Camera::framing(&points, direction, size.map(|n| n as f64), 0.06)
}

fn faces_away(camera: &Camera, piece: &Piece) -> bool {
    dot(area_vector(&piece.corners), camera.ray(piece.corners[0])) > 0.0
}

/// The color of a polygon as lit: a soft light from above and the left of the camera.
fn lit(palette: &[Rgb], camera: &Camera, piece: &Piece) -> Rgb {
    let base = palette[piece.object as usize];
    let away = faces_away(camera, piece);
    if away && piece.solid {
        // The inside of a solid that was cut open: drawn flat, it looks like the cut itself.
        return shade(mix(base, [0.2, 0.2, 0.22], 0.55), 0.45);
    }
    let normal = unit(area_vector(&piece.corners)).map(|c| if away { -c } else { c });
    let light = 0.5 * (1.0 + dot(normal, unit([-0.45, -0.65, 1.4])));
    shade(base, (0.42 + 0.62 * light) as f32)
}

/// Colors each sample and draws outlines where neighbors differ in object or direction.
fn resolve(palette: &[Rgb], camera: &Camera, pieces: &[&Piece], buffer: &ItemBuffer) -> Vec<Rgb> {
    struct Look {
        color: Rgb,
        normal: V3,
        object: u32,
        cut: bool,
    }
    let looks: Vec<Look> = pieces
        .iter()
        .map(|p| {
            let away = faces_away(camera, p);
            Look {
                color: lit(palette, camera, p),
                normal: unit(area_vector(&p.corners)).map(|c| if away { -c } else { c }),
                object: p.object,
                cut: away && p.solid,
            }
        })
        .collect();
    let edge = |i: u32, j: u32| match (looks.get(i as usize), looks.get(j as usize)) {
        (None, None) => false,
        (Some(a), Some(b)) => {
            a.object != b.object || a.cut != b.cut || (!a.cut && dot(a.normal, b.normal) < 0.94)
        }
        _ => true,
    };
    let [width, height] = buffer.size;
    let mut pixels = Vec::with_capacity(width * height);
    for row in 0..height {
        for column in 0..width {
            let here = buffer.items[row * width + column];
            let plain = if here == NONE {
                PAPER
            } else {
                looks[here as usize].color
            };
            let outlined = [(1, 0), (0, 1)].into_iter().any(|(dx, dy)| {
                let (x, y) = (column + dx, row + dy);
                x < width && y < height && edge(here, buffer.items[y * width + x])
            });
            pixels.push(if outlined { shade(plain, 0.38) } else { plain });
        }
    }
    pixels
}

/// Panes: a tint over what is behind.
fn blend_clear(
    palette: &[Rgb],
    camera: &Camera,
    pieces: &[&Piece],
    buffer: &ItemBuffer,
    pixels: &mut [Rgb],
) {
    for piece in pieces
        .iter()
        .filter(|p| p.clear && !(p.solid && faces_away(camera, p)))
    {
        let tint = lit(palette, camera, piece);
        scan(buffer.size, camera, &piece.corners, |i, key| {
            if is_nearer(key, buffer.keys[i]) {
                pixels[i] = mix(pixels[i], tint, 0.35);
            }
        });
    }
}

/// The twelve edges of the cell, faint where something is in front of them.
fn draw_cell(subject: &Subject, camera: &Camera, buffer: &ItemBuffer, pixels: &mut [Rgb]) {
    for (i, j) in (0..8)
        .flat_map(|i| [1, 2, 4].map(|bit| (i, i | bit)))
        .filter(|(i, j)| i != j)
    {
        draw_line(
            camera,
            buffer,
            pixels,
            [i, j].map(|i| corner(subject.cell, i)),
            ACCENT,
            1.4,
        );
    }
}

/// A corner of a box; the bits of its number say which.
fn corner([min, max]: [V3; 2], i: usize) -> V3 {
    std::array::from_fn(|k| if i >> k & 1 == 1 { max[k] } else { min[k] })
}

/// A line in a color, its half width in pixels; faint where something is in front of it.
pub(super) fn draw_line(
    camera: &Camera,
    buffer: &ItemBuffer,
    pixels: &mut [Rgb],
    [a, b]: [V3; 2],
    color: Rgb,
    half_width: f64,
) {
    // A ribbon that faces the camera, as wide as the line.
    let radius = half_width * SAMPLES as f64;
    if camera.in_front(a) <= 0.0 || camera.in_front(b) <= 0.0 {
        return;
    }
    let (p, q) = (camera.project(a), camera.project(b));
    let along = sub(q, p);
    let length = along[0].hypot(along[1]);
    if length < 1e-6 {
        return;
    }
    let across = unit(cross([along[0], along[1], 0.0], [0.0, 0.0, 1.0]));
    let [width, height] = buffer.size;
    let mut seen = std::collections::BTreeSet::new();
    let steps = (2.0 * length).ceil().min(1e5) as usize;
    for s in 0..=steps {
        let at = lerp(p, q, s as f64 / steps as f64);
        let reach = radius.ceil() as i64 * 2;
        for t in -reach..=reach {
            let offset = t as f64 / 2.0;
            if offset.abs() > radius {
                continue;
            }
            let (x, y) = (at[0] + across[0] * offset, at[1] + across[1] * offset);
            if x < 0.0 || y < 0.0 || x >= width as f64 || y >= height as f64 {
                continue;
            }
            let i = y as usize * width + x as usize;
            if seen.insert(i) {
                // Lines on a surface count as in front of it.
                let free = at[2] * (1.0 + 2e-3) >= buffer.keys[i];
                pixels[i] = mix(pixels[i], color, if free { 1.0 } else { 0.3 });
            }
        }
    }
}

/// Averages the samples of each pixel.
pub(super) fn shrink(samples: &[Rgb], [width, height]: [usize; 2]) -> Vec<u8> {
    let mut out = Vec::with_capacity(width * height * 3);
    for row in 0..height {
        for column in 0..width {
            let mut sum = [0.0; 3];
            for i in 0..SAMPLES * SAMPLES {
                let (x, y) = (column * SAMPLES + i % SAMPLES, row * SAMPLES + i / SAMPLES);
                let sample = samples[y * width * SAMPLES + x];
                sum = std::array::from_fn(|k| sum[k] + sample[k]);
            }
            out.extend(color::bytes(
                sum.map(|c: f32| c / (SAMPLES * SAMPLES) as f32),
            ));
        }
    }
    out
}
