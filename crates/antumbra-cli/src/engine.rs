//! Between the engine's results and the container's records.

use antumbra::region::{Accuracy as Found, CellResult};
use antumbra_io::pvs::{
    Accuracy, CellRecord, PvsCell, PvsCellKind, PvsHeader, VisibleRecord, WitnessRecord,
};
use antumbra_scene::{CellKind, Scene, ViewCell};

use crate::recipe::{Recipe, scene_hash};

/// What a bake of these cells writes into its file besides the results.
pub(crate) fn header(
    scene: &Scene,
    cells: &[ViewCell],
    recipe: &Recipe,
    proofs: bool,
) -> PvsHeader {
    PvsHeader {
        scene_hash: scene_hash(scene),
        grid: *scene.grid(),
        options: recipe.to_text(),
        proofs,
        objects: scene.objects().iter().map(|o| o.name.clone()).collect(),
        planes: scene.polygons().map(|p| spanning(p.corners)).collect(),
        cells: cells
            .iter()
            .map(|cell| PvsCell {
                name: cell.name.clone(),
                bounds: cell.bounds,
                kind: match cell.kind {
                    CellKind::Box => PvsCellKind::Box,
                    CellKind::Object(id) => PvsCellKind::Object(id.0),
                },
            })
            .collect(),
    }
}

/// Three corners of a polygon that are not collinear.
fn spanning(corners: &[antumbra::kernel::Point]) -> [[i32; 3]; 3] {
    use antumbra::kernel::{cross, sub};
    let (a, b) = (corners[0], corners[1]);
    let apart = |c: &&antumbra::kernel::Point| cross(sub(b, a), sub(**c, a)) != [0; 3];
    let c = corners[2..].iter().find(apart).unwrap_or(&corners[2]);
    [a, b, *c].map(|p| [p.x, p.y, p.z])
}

/// A result as it is stored.
pub(crate) fn record(result: &CellResult) -> CellRecord {
    let visible = result.visible.iter().map(|entry| VisibleRecord {
        object: entry.object.0,
        witness: entry.witness.map(|w| WitnessRecord {
            polygon: w.polygon.0,
            source: w.source,
            from: w.from.0,
            through: w.through.0,
        }),
    });
    CellRecord {
        accuracy: match result.accuracy {
            Found::Exact => Accuracy::Exact,
            Found::Conservative => Accuracy::Conservative,
            Found::AggressiveBelow(angle) => Accuracy::AggressiveBelow(angle),
        },
        visible: visible.collect(),
        unknown: result.unknown.iter().map(|id| id.0).collect(),
    }
}
