//! Layers of quads, seen from an object: exactly the first wall.

use std::time::Instant;

use antumbra::region::{Accuracy, BakeOptions, Baker, check_cell};
use antumbra::scene::synth::{LayerParams, LayerPattern, layers};
use antumbra::scene::{CellSpec, Scene, SceneBuilder, ViewCell, make_cells};
use antumbra_testkit::environment::long;

use crate::judge::Judge;
use crate::scenes::note;

fn layered(pattern: LayerPattern, layers_count: u32, source_area: f64) -> (Scene, ViewCell) {
    let params = LayerParams {
        pattern,
        layers: layers_count,
        source_area,
    };
    let (scene, _) = SceneBuilder::new(layers(&params))
        .build()
        .expect("a good scene");
    let spec = CellSpec::Object("source".to_owned());
    let cell = make_cells(&scene, &spec).expect("the source").remove(0);
    (scene, cell)
}

#[test]
fn exactly_the_first_wall_is_seen() {
    let all = [
        (20, 2.0),
        (20, 50.0),
        (100, 2.0),
        (1000, 2.0),
        (1000, 200.0),
    ];
    for &(count, area) in if long() { &all[..] } else { &all[..1] } {
        let (scene, cell) = layered(LayerPattern::Walls, count, area);
        let start = Instant::now();
        let result = Baker::new(&scene).bake_cell(&cell, &BakeOptions::default());
        note(&format!(
            "{count} walls: {:.3} s",
            start.elapsed().as_secs_f64()
        ));
        assert!(result.unknown.is_empty() && result.accuracy == Accuracy::Exact);
        let seen: Vec<&str> = result
            .visible
            .iter()
            .map(|e| scene.object(e.object).name.as_str())
            .collect();
        assert_eq!(seen.len(), 400, "{count} layers, source {area} m2");
        assert!(seen.iter().all(|name| name.starts_with("0-")), "{seen:?}");
        let report = check_cell(
            &scene,
            &cell,
            &result.visible,
            &result.unknown,
            result.accuracy,
            &result.proof,
        );
        assert!(report.failed.is_empty(), "{}", report.failed[0]);
        assert_eq!(report.hidden_checked, u64::from(count - 1) * 400);
        if count <= 100 {
            let followed = Judge::new(&scene).check_entries(&scene, &cell, &result.visible);
            assert_eq!(followed, Ok(400));
        }
    }
}

#[test]
fn two_chessboards_leave_a_gap() {
    // What is behind the boards is seen between them, at a slant, though no hole lines up.
    let (scene, cell) = layered(LayerPattern::Chessboard, 2, 50.0);
    let result = Baker::new(&scene).bake_cell(&cell, &BakeOptions::default());
    let judge = Judge::new(&scene);
    judge
        .check_entries(&scene, &cell, &result.visible)
        .unwrap_or_else(|e| panic!("{e}"));
    assert!(result.unknown.is_empty());
    let first = result
        .visible
        .iter()
        .filter(|e| scene.object(e.object).name.starts_with("0-"));
    assert_eq!(first.count(), 200);
    assert!(
        result.visible.len() > 200,
        "the second board is seen through the first"
    );
}
