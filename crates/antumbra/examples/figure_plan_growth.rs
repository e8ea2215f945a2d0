//! Draws how the occlusion trees of a plan grow: 10,000 random segments, coarse and fine kD-trees, both orders
//! of the sweep. After [Bittner02, Figure 6.12-(a)].
#![allow(clippy::print_stdout, reason = "says where the figure is")]

use std::fmt::Write as _;

use antumbra::plan::{Plan, PlanCell, PlanOptions, SeeOptions, SweepOrder, see};
use antumbra::scene::synth::{SegmentParams, random_segments};

type Curve = (&'static str, &'static str, Vec<(u64, u64)>);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let curves = [
        (
            "A: 50 a leaf, depth first",
            "#b03030",
            50,
            SweepOrder::DepthFirst,
        ),
        (
            "B: 50 a leaf, by distance",
            "#d09020",
            50,
            SweepOrder::Priority,
        ),
        (
            "C: 5 a leaf, depth first",
            "#3060b0",
            5,
            SweepOrder::DepthFirst,
        ),
        (
            "D: 5 a leaf, by distance",
            "#308040",
            5,
            SweepOrder::Priority,
        ),
    ];
    let mut drawn: Vec<Curve> = Vec::new();
    for (name, color, leaf, order) in curves {
        let growth = grow(leaf, order)?;
        let last = growth.last().copied().unwrap_or_default();
        println!("{name}: {} blockers, {} nodes", last.0, last.1);
        drawn.push((name, color, growth));
    }
    let path = "docs/figures/plan-growth.svg";
    std::fs::write(path, svg(&drawn))?;
    println!("{path}");
    Ok(())
}

/// Blockers and nodes after each insertion.
fn grow(leaf: usize, order: SweepOrder) -> Result<Vec<(u64, u64)>, Box<dyn std::error::Error>> {
    let input = random_segments(&SegmentParams::new(10_000, 1));
    let options = PlanOptions {
        leaf,
        ..PlanOptions::default()
    };
    let plan = Plan::build(&input, &options)?;
    let cell = PlanCell::new(
        &plan,
        &[[45.0, 45.0], [55.0, 45.0], [55.0, 55.0], [45.0, 55.0]],
    )?;
    let options = SeeOptions {
        order,
        growth: true,
        ..SeeOptions::default()
    };
    let mut seen = see(&plan, &cell, &options);
    Ok(seen.parts.remove(0).growth)
}

fn svg(curves: &[Curve]) -> String {
    let most = |f: fn(&(u64, u64)) -> u64| {
        let all = curves.iter().flat_map(|c| c.2.iter().map(f));
        all.max().unwrap_or(1).max(1) as f64
    };
    let (blockers, nodes) = (most(|p| p.0), most(|p| p.1));
    let x = |v: f64| 60.0 + v / blockers * 500.0;
    let y = |v: f64| 330.0 - v / nodes * 300.0;
    let mut out = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"600\" height=\"380\" viewBox=\"0 0 600 380\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<title>Growth of occlusion trees</title>\n\
         <rect width=\"600\" height=\"380\" fill=\"#ffffff\"/>\n\
         <path d=\"M60 30 V330 H560\" fill=\"none\" stroke=\"#404040\"/>\n",
    );
    // Writing to a string cannot fail.
    for k in 0..=4 {
        let (b, n) = (blockers * f64::from(k) / 4.0, nodes * f64::from(k) / 4.0);
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"346\" text-anchor=\"middle\">{b:.0}</text>\
             <text x=\"54\" y=\"{:.1}\" text-anchor=\"end\">{n:.0}</text>",
            x(b),
            y(n) + 4.0
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"310\" y=\"368\" text-anchor=\"middle\">blocker polygons</text>\
         <text x=\"64\" y=\"22\">nodes of the occlusion trees</text>"
    );
    for (i, (name, color, points)) in curves.iter().enumerate() {
        let step = (points.len() / 400).max(1);
        let last = points.last();
        let path: Vec<String> = points
            .iter()
            .step_by(step)
            .chain(last)
            .map(|p| format!("{:.1} {:.1}", x(p.0 as f64), y(p.1 as f64)))
            .collect();
        let _ = writeln!(
            out,
            "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>\
             <text x=\"90\" y=\"{}\" fill=\"{color}\">{name}</text>",
            path.join(" L"),
            60 + 18 * i
        );
    }
    out + "</svg>\n"
}
