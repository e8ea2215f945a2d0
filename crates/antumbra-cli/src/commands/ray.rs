//! `antumbra ray`: visibility along a line, exactly.

use antumbra::ray::ray;
use clap::Args;
use serde_json::json;

use crate::cli::Global;
use crate::failure::Failure;
use crate::load::{SceneArgs, load};
use crate::values::PointArg;

/// Options of `ray`.
#[derive(Args, Debug)]
#[command(after_help = "Example:\n  antumbra ray house.glb --from -1,2,1.6 --to 8,2,1.6 --json")]
pub(crate) struct RayArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Where the line starts, in scene units (z up)
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    from: PointArg,
    /// Where it ends
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    to: PointArg,
}

/// Prints the first hit and the free stretches.
pub(crate) fn run(args: &RayArgs, global: &Global) -> Result<(), Failure> {
    let (from, to) = (args.from.0, args.to.0);
    let hull = (
        std::array::from_fn(|k| from[k].min(to[k])),
        std::array::from_fn(|k| from[k].max(to[k])),
    );
    let loaded = load(&args.scene, global, Some(hull))?;
    let scene = &loaded.scene;
    let answer = ray(scene, from, to).map_err(|e| Failure::Content(e.to_string()))?;
    let hit = answer.hit.as_ref().map(|hit| {
        let first = scene.object(hit.object).polygons.start;
        json!({"object": hit.object.0, "name": scene.object(hit.object).name,
            "polygon": hit.polygon.0 - first, "at": hit.at})
    });
    let text = match &hit {
        None => "free: nothing is hit".to_owned(),
        Some(hit) => format!(
            "hits object {} ({}) at {}",
            hit["object"], hit["name"], hit["at"]
        ),
    };
    let result = json!({"hit": hit, "free": answer.free});
    let stretches = answer
        .free
        .iter()
        .map(|[a, b]| format!("\nfree from {a:?} to {b:?}"));
    let text = text + &stretches.collect::<String>();
    global.output().result(&result, &text)
}
