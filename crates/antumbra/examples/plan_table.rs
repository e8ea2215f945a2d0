//! Prints a table of plans, cells and kD-trees: the counts and times of [Bittner02, Table 6.1], for measured
//! plans (a folder is the argument) and for random segments.
#![allow(clippy::print_stdout, reason = "prints a table")]

use std::path::Path;
use std::time::Instant;

use antumbra::plan::{Plan, PlanCell, PlanInput, PlanOptions, SeeOptions, see};
use antumbra::scene::synth::{SegmentParams, random_segments};
use antumbra_io::plan::{PlanReadOptions, read_plan};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "| plan | segments | kD nodes | cell % | tested kD nodes % | blockers | tree nodes | visible % | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    if let Some(folder) = std::env::args().nth(1) {
        let read =
            |name: &str| read_plan(&Path::new(&folder).join(name), &PlanReadOptions::default());
        let city = read("city/linz_25km2.geojson.gz")?;
        for share in [0.017, 0.21, 0.64] {
            row(
                "linz_25km2",
                &city,
                4,
                share,
                25e6,
                [447_100.0, 5_349_900.0],
            )?;
        }
        let office = read("plans/cad_office_walls.seg")?;
        for (leaf, share) in [(16, 2.5), (4, 2.5), (4, 6.0)] {
            row(
                "cad_office_walls",
                &office,
                leaf,
                share,
                59.0 * 29.0,
                [29.0, 13.0],
            )?;
        }
    }
    let thousand = random_segments(&SegmentParams::new(1000, 1));
    for leaf in [50, 5] {
        row("random", &thousand, leaf, 5.1, 1e4, [50.0, 50.0])?;
    }
    let many = random_segments(&SegmentParams::new(20_000, 1));
    for share in [0.21, 3.4] {
        row("random", &many, 5, share, 1e4, [50.0, 50.0])?;
    }
    Ok(())
}

/// A square cell of a share of the area around a middle.
fn row(
    name: &str,
    input: &PlanInput,
    leaf: usize,
    share: f64,
    area: f64,
    [x, y]: [f64; 2],
) -> Result<(), Box<dyn std::error::Error>> {
    let options = PlanOptions {
        leaf,
        ..PlanOptions::default()
    };
    let plan = Plan::build(input, &options)?;
    let half = (area * share / 100.0).sqrt() / 2.0;
    let outline = [
        [x - half, y - half],
        [x + half, y - half],
        [x + half, y + half],
        [x - half, y + half],
    ];
    let cell = PlanCell::new(&plan, &outline)?;
    let mut best = f64::INFINITY;
    let mut seen = see(&plan, &cell, &SeeOptions::default());
    for _ in 0..7 {
        let start = Instant::now();
        seen = see(&plan, &cell, &SeeOptions::default());
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
    }
    let nodes = plan.kd().nodes().len();
    let part = |n: usize, of: usize| 100.0 * n as f64 / of as f64;
    println!(
        "| {name} | {} | {nodes} | {share} | {:.2} | {} | {} | {:.2} | {best:.1} |",
        plan.segment_count(),
        part(seen.work.nodes_tested as usize, nodes),
        seen.work.blockers,
        seen.work.tree_nodes,
        part(seen.segments.len(), plan.segment_count()),
    );
    Ok(())
}
