//! The structured and random scenes of [Bittner02, 8.14].

use antumbra::region::{BakeOptions, Baker, CellResult};
use antumbra::scene::synth::{LayerParams, LayerPattern, TriangleParams, layers, random_triangles};
use antumbra::scene::{CellSpec, Scene, SceneBuilder, SceneInput, ViewCell, make_cells};
use criterion::Criterion;

fn prepare(input: SceneInput) -> (Scene, ViewCell) {
    let (scene, _) = SceneBuilder::new(input)
        .build()
        .expect("generated scenes are sound");
    let cells = make_cells(&scene, &CellSpec::Object("source".to_owned()));
    let cell = cells.expect("generated scenes have a source").remove(0);
    (scene, cell)
}

fn bake(baker: &Baker<'_>, cell: &ViewCell) -> CellResult {
    let result = baker.bake_cell(cell, &BakeOptions::default());
    assert!(result.unknown.is_empty(), "everything is decided");
    result
}

/// The scene and the kD-tree of 1,000 walls: 400,000 quads.
pub(crate) fn build(c: &mut Criterion) {
    let input = layers(&LayerParams {
        pattern: LayerPattern::Walls,
        layers: 1000,
        source_area: 2.0,
    });
    let mut group = c.benchmark_group("build");
    group.bench_function("400000 quads", |b| {
        b.iter_batched(
            || input.clone(),
            |input| {
                let (scene, _) = SceneBuilder::new(input).build().expect("sound");
                assert_eq!(scene.polygon_count(), 400_001);
                scene
            },
            criterion::BatchSize::PerIteration,
        );
    });
    group.finish();
}

/// Walls (S1-S3) and chessboards (S4-S6), and walls of many layers.
pub(crate) fn layered(c: &mut Criterion) {
    let mut group = c.benchmark_group("layers");
    let walls = LayerPattern::Walls;
    let boards = LayerPattern::Chessboard;
    let cases = [
        ("S1 walls 20", walls, 20, 2.0),
        ("S2 walls 20", walls, 20, 50.0),
        ("S3 walls 20", walls, 20, 200.0),
        ("S1 walls 100", walls, 100, 2.0),
        ("S1 walls 1000", walls, 1000, 2.0),
        ("S4 chessboard 20", boards, 20, 2.0),
        ("S5 chessboard 20", boards, 20, 50.0),
        ("S6 chessboard 20", boards, 20, 200.0),
    ];
    for (name, pattern, count, source_area) in cases {
        let params = LayerParams {
            pattern,
            layers: count,
            source_area,
        };
        let (scene, cell) = prepare(layers(&params));
        let baker = Baker::new(&scene);
        let seen = bake(&baker, &cell).visible.len();
        match pattern {
            LayerPattern::Walls => assert_eq!(seen, 400, "exactly the first wall"),
            LayerPattern::Chessboard => assert!(seen > 200, "more than the first board"),
        }
        group.bench_function(name, |b| b.iter(|| bake(&baker, &cell)));
    }
    group.finish();
}

/// Random triangles R9 with 10,000 triangles.
pub(crate) fn triangles(c: &mut Criterion) {
    let params = TriangleParams {
        count: 10_000,
        area: 12.5,
        source_area: 200.0,
        seed: 1,
    };
    let (scene, cell) = prepare(random_triangles(&params));
    let baker = Baker::new(&scene);
    let seen = bake(&baker, &cell).visible.len();
    assert!(seen > 100, "a source in front of a cloud sees its surface");
    let mut group = c.benchmark_group("random triangles");
    group.bench_function("R9 10000", |b| b.iter(|| bake(&baker, &cell)));
    group.finish();
}
