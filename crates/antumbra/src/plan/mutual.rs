//! Whether cells of the plane see each other.

use antumbra_scene::plan::{CellShape, Plan, PlanCell};
use antumbra_sweep::plan::{Sight, sights};
use rayon::prelude::*;

/// How two cells see each other; `None` if walls block all open sets of lines between them. Exact.
#[must_use]
pub fn mutual(plan: &Plan, one: &PlanCell, other: &PlanCell) -> Option<Sight> {
    first_sights(plan, one, std::slice::from_ref(&other)).remove(0)
}

/// Which of some cells see which, row by row; every cell sees itself. One sweep for each cell, in parallel.
#[must_use]
pub fn mutual_matrix(plan: &Plan, cells: &[PlanCell]) -> Vec<Vec<bool>> {
    let n = cells.len();
    let upper: Vec<Vec<bool>> = (0..n)
        .into_par_iter()
        .map(|i| {
            let others: Vec<&PlanCell> = cells[i + 1..].iter().collect();
            let sights = first_sights(plan, &cells[i], &others);
            sights.iter().map(Option::is_some).collect()
        })
        .collect();
    let at = |i: usize, j: usize| i == j || upper[i.min(j)][i.max(j) - i.min(j) - 1];
    (0..n).map(|i| (0..n).map(|j| at(i, j)).collect()).collect()
}

/// For each of some cells the first way in which it is seen from another one.
fn first_sights(plan: &Plan, from: &PlanCell, to: &[&PlanCell]) -> Vec<Option<Sight>> {
    let mut found: Vec<Option<Sight>> = vec![None; to.len()];
    for part in &from.parts {
        let (owners, targets): (Vec<usize>, Vec<CellShape>) = to
            .iter()
            .enumerate()
            .filter(|&(i, _)| found[i].is_none())
            .flat_map(|(i, cell)| cell.parts.iter().map(move |p| (i, p.clone())))
            .unzip();
        for (i, sight) in owners.into_iter().zip(sights(plan, part, &targets)) {
            if found[i].is_none() {
                found[i] = sight;
            }
        }
    }
    found
}
