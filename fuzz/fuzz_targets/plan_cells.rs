//! Reads any text as view cells, and puts them on the grid of a small plan.
#![no_main]

use antumbra_io::plan::{PlanReadOptions, parse_cells, parse_plan};
use antumbra_scene::plan::{Plan, PlanCell, PlanOptions};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let Ok(cells) = parse_cells(text, None) else {
        return;
    };
    let walls = b"0 0 10 0\n10 0 10 10\n10 10 0 10\n0 10 0 0\n4 4 6 4\n";
    let input = parse_plan(walls, "room.seg", &PlanReadOptions::default()).expect("a room");
    let options = PlanOptions {
        grid: Some(0.25),
        ..PlanOptions::default()
    };
    let plan = Plan::build(&input, &options).expect("a room");
    for cell in cells.iter().filter(|c| c.outline.len() < 100) {
        if let Ok(made) = PlanCell::new(&plan, &cell.outline) {
            assert!(!made.parts.is_empty());
        }
    }
});
