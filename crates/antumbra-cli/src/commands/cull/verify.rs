//! `--verify`: an item buffer of each frame, against what was called visible.

use std::collections::BTreeMap;

use antumbra::cull::Camera;
use antumbra_scene::{ObjectId, Scene};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::picture::PixelOwners;

/// An object that was culled although pixels show it.
pub(super) struct WrongCull {
    pub frame: usize,
    pub object: u32,
    /// Column and row from the upper left.
    pub pixels: Vec<[u32; 2]>,
}

/// What the item buffers say.
#[derive(Default)]
pub(super) struct Verdict {
    /// Objects that have a pixel, summed over all frames, and by frame.
    pub truth: u64,
    pub by_frame: Vec<usize>,
    pub wrong: Vec<WrongCull>,
}

/// Renders all frames; `progress` is told of each.
pub(super) fn verify(
    scene: &Scene,
    open: &[ObjectId],
    cameras: &[Camera],
    visible: &[Vec<u32>],
    size: [usize; 2],
    progress: impl Fn() + Sync,
) -> Verdict {
    let corners: Vec<Vec<[f64; 3]>> = scene
        .polygons()
        .map(|p| {
            p.corners
                .iter()
                .map(|&c| scene.grid().to_scene(c))
                .collect()
        })
        .collect();
    let hides: Vec<bool> = scene
        .polygons()
        .map(|p| p.occludes && !open.contains(&p.object))
        .collect();
    let of_frame = |frame: usize| {
        let camera = &cameras[frame];
        let mut pixels = PixelOwners::new(size, camera.eye(), camera.axes(), camera.half_extents());
        for (i, corners) in corners.iter().enumerate() {
            if hides[i] {
                pixels.draw(corners);
            }
        }
        let mut owners: BTreeMap<u32, Vec<[u32; 2]>> = BTreeMap::new();
        let mut seen = vec![false; scene.objects().len()];
        for (polygon, corners) in scene.polygons().zip(&corners) {
            let object = polygon.object.0;
            let culled = visible[frame].binary_search(&object).is_err();
            pixels.credit(corners, |at| {
                seen[object as usize] = true;
                if culled {
                    owners.entry(object).or_default().push(at);
                }
            });
        }
        let truth = seen.iter().filter(|seen| **seen).count();
        progress();
        (truth, owners)
    };
    let frames: Vec<_> = (0..cameras.len()).into_par_iter().map(of_frame).collect();
    let mut verdict = Verdict::default();
    for (frame, (truth, owners)) in frames.into_iter().enumerate() {
        verdict.truth += truth as u64;
        verdict.by_frame.push(truth);
        for (object, mut pixels) in owners {
            pixels.sort_unstable();
            pixels.dedup();
            verdict.wrong.push(WrongCull {
                frame,
                object,
                pixels,
            });
        }
    }
    verdict
}

impl Verdict {
    /// For scripts.
    pub(super) fn json(&self, called: u64, size: [usize; 2], scene: &Scene) -> Value {
        let wrong: Vec<Value> = self
            .wrong
            .iter()
            .map(|w| {
                let name = &scene.object(ObjectId(w.object)).name;
                json!({
                    "frame": w.frame, "object": w.object, "name": name,
                    "pixels": w.pixels.len(), "at": w.pixels,
                })
            })
            .collect();
        json!({
            "size": size,
            "truth": self.truth,
            "visible": called,
            "ratio": called as f64 / (self.truth.max(1)) as f64,
            "truth_by_frame": self.by_frame,
            "wrong_culls": wrong,
        })
    }
}
