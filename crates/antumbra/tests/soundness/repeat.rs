//! The same bytes again: across runs, and on one thread and on two.

use antumbra::region::{BakeOptions, Baker, VisibleEntry};
use antumbra::scene::{ObjectId, ViewCell};
use rayon::prelude::*;

use crate::scenes::{Place, office_floor, triangles};

type Bytes = (Vec<VisibleEntry>, Vec<ObjectId>, Vec<u8>);

fn bake(baker: &Baker<'_>, cell: &ViewCell) -> Bytes {
    let result = baker.bake_cell(cell, &BakeOptions::default());
    (result.visible, result.unknown, result.proof)
}

fn on_threads(threads: usize, place: &Place, cells: &[&ViewCell]) -> Vec<Bytes> {
    let baker = Baker::new(&place.scene);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a pool of threads");
    pool.install(|| cells.par_iter().map(|cell| bake(&baker, cell)).collect())
}

#[test]
fn threads_and_runs_change_no_byte() {
    for place in [office_floor(3.0), triangles(150, 12.0)] {
        let cells = place.some_cells(2, 1);
        let once = on_threads(1, &place, &cells);
        assert!(
            once.iter()
                .any(|(visible, _, proof)| !visible.is_empty() && proof.len() > 100)
        );
        assert!(
            once == on_threads(2, &place, &cells),
            "{}: two threads",
            place.name
        );
        // Nor does the order, or what was baked before.
        let baker = Baker::new(&place.scene);
        for (cell, first) in cells.iter().zip(&once).rev() {
            assert!(
                *first == bake(&baker, cell),
                "{}: cell {}",
                place.name,
                cell.name
            );
        }
    }
}
