//! Draws what rounding does to a sign: two predicates over a lattice of neighboring grid points, in
//! floats of two widths and in exact integers.
//!
//! After the pictures of [Kettner08]; theirs are of orient2d over neighboring doubles.
#![allow(clippy::print_stdout, reason = "says where the figure is")]

mod drawing;
mod lattice;

use antumbra_kernel::Sign;
use drawing::Panel;
use lattice::{Lattice, SIZE};

fn main() -> std::io::Result<()> {
    let rows = [Lattice::two_lines(), Lattice::corridor()].map(|lattice| {
        let exact = signs(|i, j| lattice.exact(i, j));
        let panel = |name, signs: Vec<Sign>| {
            let wrong = signs.iter().zip(&exact).filter(|(a, b)| a != b).count();
            Panel { name, signs, wrong }
        };
        let panels = [
            panel("32-bit floats", signs(|i, j| lattice.naive::<f32>(i, j))),
            panel("64-bit floats", signs(|i, j| lattice.naive::<f64>(i, j))),
            panel("exact", exact.clone()),
        ];
        (lattice.title, panels)
    });
    let path = "docs/figures/naive-and-exact.svg";
    std::fs::create_dir_all("docs/figures")?;
    std::fs::write(path, drawing::svg(&rows))?;
    for (title, panels) in &rows {
        for Panel { name, wrong, .. } in panels {
            println!("{title}, {name}: {wrong} of {} signs wrong", SIZE * SIZE);
        }
    }
    println!("{path}");
    Ok(())
}

/// The signs over the lattice, row by row from the top.
fn signs(sign: impl Fn(i32, i32) -> Sign) -> Vec<Sign> {
    let cells = (0..SIZE).rev().flat_map(|j| (0..SIZE).map(move |i| (i, j)));
    cells.map(|(i, j)| sign(i, j)).collect()
}
