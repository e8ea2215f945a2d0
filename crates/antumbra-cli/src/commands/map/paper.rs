//! A map on paper: layers by class, lines with their elements.

use antumbra::map::EdgeClass;
use antumbra::map::VisibilityMap;
use antumbra::map::drawing::{Projection, Stroke, hidden_strokes, strokes};
use antumbra_io::drawing::{Drawing, Layer, Line, Scale};
use antumbra_scene::Scene;

use super::MapArgs;
use crate::failure::Failure;

/// Smallest distance on paper, in pixels.
const RESOLUTION: f64 = 0.01;
/// The free share around a parallel view.
const MARGIN: f64 = 0.04;

pub(super) fn draw(args: &MapArgs, scene: &Scene, map: &VisibilityMap) -> Result<Drawing, Failure> {
    let size = args.size.map(|n| n as f64);
    let projection = projection(args, scene, map, size)?;
    let crease = args.crease.to_radians();
    let mut layers = Vec::new();
    let mut visible = Vec::new();
    for (class, width) in [
        (EdgeClass::Flat, 0.4),
        (EdgeClass::Corner, 0.8),
        (EdgeClass::Intersection, 0.8),
        (EdgeClass::Shadow, 1.2),
        (EdgeClass::Silhouette, 1.6),
    ] {
        if class == EdgeClass::Flat && !args.flat {
            continue;
        }
        let lines = strokes(map, scene, &projection, &[class], RESOLUTION);
        if args.hidden {
            visible.extend_from_slice(&lines);
        }
        layers.push(layer(scene, class.name(), width, false, lines));
    }
    if args.hidden {
        let paper = (size, RESOLUTION);
        let lines = hidden_strokes(map, scene, &projection, crease, paper, &visible);
        // Lowest.
        layers.insert(0, layer(scene, "hidden", 0.5, true, lines));
    }
    let name = args.scene.scene.file_stem().unwrap_or_default();
    let scale = args.ortho.then(|| Scale {
        units: projection.scale(),
        origin: projection.point([0.0; 3]),
    });
    Ok(Drawing {
        title: name.to_string_lossy().into_owned(),
        size,
        scale,
        layers,
    })
}

fn projection(
    args: &MapArgs,
    scene: &Scene,
    map: &VisibilityMap,
    size: [f64; 2],
) -> Result<Projection, Failure> {
    let (eye, up) = (args.eye.0, args.up_is.0);
    let to = args.to.map_or(eye, |p| p.0);
    let center = size.map(|n| n / 2.0);
    let usage = |e: antumbra::map::MapError| Failure::Usage(e.to_string());
    let Some(direction) = map.direction() else {
        // The viewpoint that was used is the one on the grid.
        let snapped = map.eye(scene).unwrap_or(eye);
        let to = std::array::from_fn(|k| to[k] + snapped[k] - eye[k]);
        let scale = size[1] / 2.0 / (args.fov.to_radians() / 2.0).tan();
        let projection = Projection::new(snapped, to, up, false).map_err(usage)?;
        return Ok(projection.on_paper(scale, center));
    };
    // Along the direction that was used, so that all points of a line fall together.
    let to = std::array::from_fn(|k| eye[k] + f64::from(direction[k]));
    let unscaled = Projection::new(eye, to, up, true).map_err(usage)?;
    let corners = scene
        .bounds()
        .corners()
        .map(|p| unscaled.point(scene.grid().to_scene(p)));
    let bound = |k: usize, start: f64, pick: fn(f64, f64) -> f64| {
        corners.iter().map(|p| p[k]).fold(start, pick)
    };
    let low = [0, 1].map(|k| bound(k, f64::MAX, f64::min));
    let high = [0, 1].map(|k| bound(k, f64::MIN, f64::max));
    let extent = |k: usize| (high[k] - low[k]).max(f64::MIN_POSITIVE);
    let scale = (1.0 - MARGIN) * (size[0] / extent(0)).min(size[1] / extent(1));
    let middle = [0, 1].map(|k| (low[k] + high[k]) / 2.0);
    let center = [0, 1].map(|k| center[k] - scale * middle[k]);
    Ok(unscaled.on_paper(scale, center))
}

fn layer(scene: &Scene, name: &str, width: f64, dashed: bool, strokes: Vec<Stroke>) -> Layer {
    let lines = strokes.into_iter().map(|stroke| {
        let object = scene.object(stroke.object);
        Line {
            object: stroke.object.0,
            name: object.name.clone(),
            class: object.class.clone().unwrap_or_default(),
            points: stroke.points,
        }
    });
    Layer {
        name: name.to_owned(),
        width,
        dashed,
        lines: lines.collect(),
    }
}
