//! Lit and shadowed surfaces in perspective, with the light, outlines and the lines of a mesh.

use super::camera::Camera;
use super::color::{ACCENT, PAPER, Rgb, mix, shade};
use super::perspective::{SAMPLES, draw_line, shrink};
use super::raster::{ItemBuffer, NONE};
use super::vector::{V3, area_vector, dot, sub, unit};

/// A polygon to draw, in scene units.
#[derive(Clone, Debug)]
pub(crate) struct LitFace {
    /// At least three corners, planar and convex.
    pub corners: Vec<V3>,
    /// Its object; outlines are drawn between objects.
    pub object: u32,
    /// Whether light falls on it.
    pub lit: bool,
    /// One looks through it; it is not drawn.
    pub clear: bool,
}

/// The light itself.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Lamp {
    /// A point.
    Point(V3),
    /// A quadrangle.
    Area([V3; 4]),
}

/// What a picture shows.
#[derive(Clone, Debug)]
pub(crate) struct LightPicture {
    pub faces: Vec<LitFace>,
    /// Lines on faces, each with the number of its color.
    pub lines: Vec<(usize, [V3; 2])>,
    pub lamp: Lamp,
    pub eye: V3,
    /// Right, up and forward, orthonormal.
    pub axes: [V3; 3],
    /// The full vertical angle in radians.
    pub fov: f64,
    /// Width and height in pixels.
    pub size: [usize; 2],
}

/// Warm light, cool shadow.
const LIT: Rgb = [0.93, 0.86, 0.70];
const SHADOWED: Rgb = [0.10, 0.12, 0.20];
/// Lines by event.
const LINES: [Rgb; 3] = [[0.05, 0.10, 0.45], [0.68, 0.0, 0.07], [0.0, 0.30, 0.08]];

/// Renders the picture: rows of red, green and blue bytes, from the top.
pub(crate) fn light_picture(picture: &LightPicture) -> Vec<u8> {
    let size = picture.size.map(|n| n * SAMPLES);
    let camera = Camera::looking(
        picture.eye,
        picture.axes,
        picture.fov,
        size.map(|n| n as f64),
    );
    let mut buffer = ItemBuffer::new(size);
    for (face, i) in picture.faces.iter().zip(0..).filter(|(f, _)| !f.clear) {
        buffer.draw(&camera, &face.corners, i);
    }
    let looks: Vec<Look> = picture.faces.iter().map(|f| look(picture, f)).collect();
    let mut pixels = outlined(&looks, &buffer);
    for (color, ends) in &picture.lines {
        draw_line(
            &camera,
            &buffer,
            &mut pixels,
            *ends,
            LINES[color % LINES.len()],
            0.8,
        );
    }
    draw_lamp(picture, &camera, &buffer, &mut pixels);
    shrink(&pixels, picture.size)
}

struct Look {
    color: Rgb,
    normal: V3,
    object: u32,
}

fn look(picture: &LightPicture, face: &LitFace) -> Look {
    let normal = unit(area_vector(&face.corners));
    let toward = if dot(normal, sub(picture.eye, face.corners[0])) < 0.0 {
        normal.map(|c| -c)
    } else {
        normal
    };
    // A little shading by direction, so that edges show inside light and shadow as well.
    let soft = 0.5 * (1.0 + dot(toward, unit([-0.45, -0.65, 1.4]))) as f32;
    let plain = if face.lit { LIT } else { SHADOWED };
    Look {
        color: shade(plain, 0.75 + 0.25 * soft),
        normal: toward,
        object: face.object,
    }
}

/// Each sample in the color of its face; darker where objects or directions change.
fn outlined(looks: &[Look], buffer: &ItemBuffer) -> Vec<Rgb> {
    let [width, height] = buffer.size;
    let edge = |i: u32, j: u32| match (looks.get(i as usize), looks.get(j as usize)) {
        (None, None) => false,
        (Some(a), Some(b)) => a.object != b.object || dot(a.normal, b.normal) < 0.94,
        _ => true,
    };
    let mut pixels = Vec::with_capacity(width * height);
    for i in 0..width * height {
        let here = buffer.items[i];
        let plain = looks.get(here as usize).map_or(PAPER, |l| l.color);
        debug_assert!(here == NONE || (here as usize) < looks.len());
        let right = (i + 1) % width != 0 && edge(here, buffer.items[i + 1]);
        let below = i + width < width * height && edge(here, buffer.items[i + width]);
        pixels.push(if right || below {
            shade(plain, 0.4)
        } else {
            plain
        });
    }
    pixels
}

/// The lamp's outline, or a dot; faint where something is in front.
fn draw_lamp(picture: &LightPicture, camera: &Camera, buffer: &ItemBuffer, pixels: &mut [Rgb]) {
    match picture.lamp {
        Lamp::Area(corners) => {
            for k in 0..4 {
                let ends = [corners[k], corners[(k + 1) % 4]];
                draw_line(camera, buffer, pixels, ends, ACCENT, 1.4);
            }
        }
        Lamp::Point(at) => {
            if camera.in_front(at) <= 0.0 {
                return;
            }
            let [x, y, key] = camera.project(at);
            let [width, height] = buffer.size;
            let radius = 5.0 * SAMPLES as f64;
            for row in 0..height {
                for column in 0..width {
                    let (dx, dy) = (column as f64 + 0.5 - x, row as f64 + 0.5 - y);
                    if dx * dx + dy * dy <= radius * radius {
                        let i = row * width + column;
                        let free = key >= buffer.keys[i];
                        pixels[i] = mix(pixels[i], ACCENT, if free { 1.0 } else { 0.3 });
                    }
                }
            }
        }
    }
}
