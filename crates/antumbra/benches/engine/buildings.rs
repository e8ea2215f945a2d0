//! Cells of real buildings.

use std::sync::atomic::{AtomicUsize, Ordering};

use antumbra::region::{BakeOptions, Baker, CellResult, check_cell};
use antumbra::scene::{CellSpec, SceneBuilder, ViewCell, make_cells};
use antumbra_io::read_scene;
use antumbra_testkit::environment::{data, skip};
use criterion::Criterion;

/// Every 29th cell of `grid:2`: baking and checking.
pub(crate) fn cells(c: &mut Criterion) {
    for name in ["duplex", "kit_institute"] {
        let path = data().map(|d| d.join(format!("walk/{name}.glb")));
        let Some(input) = path.and_then(|p| read_scene(&p).ok()) else {
            skip(&format!("walk/{name}.glb is absent"));
            continue;
        };
        let spec = CellSpec::Grid(2.0);
        let (scene, _) = SceneBuilder::new(input).build().expect("a sound building");
        let cells = make_cells(&scene, &spec).expect("a grid of cells");
        let some: Vec<&ViewCell> = cells.iter().step_by(cells.len() / 12).collect();
        let baker = Baker::new(&scene);
        let bake = |cell: &ViewCell| baker.bake_cell(cell, &BakeOptions::default());
        let results: Vec<_> = some.iter().map(|cell| bake(cell)).collect();
        let check = |i: usize| {
            let r = &results[i];
            check_cell(
                &scene, some[i], &r.visible, &r.unknown, r.accuracy, &r.proof,
            )
        };
        for (i, result) in results.iter().enumerate() {
            assert!(
                result.unknown.is_empty(),
                "{name}: cell {} is undecided",
                some[i].name
            );
            assert!(check(i).failed.is_empty(), "{name}: {:?}", check(i).failed);
        }
        let mut group = c.benchmark_group(format!("cells/{name}"));
        group.bench_function(format!("bake {}", some.len()), |b| {
            b.iter(|| {
                some.iter()
                    .map(|cell| bake(cell).visible.len())
                    .sum::<usize>()
            });
        });
        group.bench_function(format!("bake {} by two threads", some.len()), |b| {
            b.iter(|| two_threads(&some, &bake));
        });
        group.bench_function(format!("check {}", some.len()), |b| {
            b.iter(|| {
                (0..some.len())
                    .map(|i| check(i).hidden_checked)
                    .sum::<u64>()
            });
        });
        group.finish();
    }
}

/// Bakes cells by two threads, each taking the next cell that is left.
fn two_threads(cells: &[&ViewCell], bake: &(impl Fn(&ViewCell) -> CellResult + Sync)) {
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(cell) = cells.get(next.fetch_add(1, Ordering::Relaxed)) {
                    std::hint::black_box(bake(cell));
                }
            });
        }
    });
}
