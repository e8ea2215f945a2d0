//! Plans against an oracle and measured data.
use antumbra::plan::*;
use antumbra_io::plan::*;
use antumbra_testkit::environment::data;
use std::time::Instant;

fn cell_of(path: &str, id: usize) -> Vec<[f64; 2]> {
    let text = std::fs::read_to_string(data().unwrap().join(path)).unwrap();
    parse_cells(&text, None).unwrap()[id].outline.clone()
}

#[test]
fn speed() {
    let run = |file: &str, outline: &[[f64; 2]], options: &ViewOptions| {
        let t = Instant::now();
        let input = read_plan(&data().unwrap().join(file), &PlanReadOptions::default()).unwrap();
        let read = t.elapsed();
        let t = Instant::now();
        let plan = Plan::build(&input, &PlanOptions::default()).unwrap();
        let built = t.elapsed();
        let cell = PlanCell::new(&plan, outline).unwrap();
        let mut best = f64::INFINITY;
        let mut view = None;
        for _ in 0..5 {
            let t = Instant::now();
            view = Some(look(&plan, &cell.parts[0], options));
            best = best.min(t.elapsed().as_secs_f64());
        }
        let v = view.unwrap();
        let mut ids: Vec<u32> = v
            .fragments
            .iter()
            .map(|f| f.piece.0)
            .chain(v.touching.iter().map(|p| p.0))
            .collect();
        ids.dedup();
        println!(
            "{file}: read {read:?} build {built:?} look {:.2} ms; segments {} pieces {} kd {} windows {} visible {} fragments {} touching {} {:?} {:?} report sealed {} touching {}",
            best * 1e3,
            plan.segment_count(),
            plan.pieces().len(),
            plan.kd().nodes().len(),
            v.windows.len(),
            ids.len(),
            v.fragments.len(),
            v.touching.len(),
            v.accuracy,
            v.work,
            plan.report().sealed,
            plan.report().touching
        );
    };
    let c56 = cell_of("city/linz_8km2_viewcells.geojson", 56);
    let o = ViewOptions {
        test: BoxTest::Exact,
        ..ViewOptions::default()
    };
    run("city/linz_25km2.geojson.gz", &c56, &o);
    run(
        "city/linz_25km2.geojson.gz",
        &c56,
        &ViewOptions {
            order: SweepOrder::DepthFirst,
            ..o
        },
    );
    run(
        "city/linz_25km2.geojson.gz",
        &c56,
        &ViewOptions {
            test: BoxTest::Exact,
            ..o
        },
    );
    run("city/linz_full.geojson.gz", &c56, &o);
    // 0.2 % of 25 km2: 50,000 m2: 224 m square
    let (x, y) = (447100.0, 5349900.0);
    let sq = |x: f64, y: f64, w: f64| vec![[x, y], [x + w, y], [x + w, y + w], [x, y + w]];
    run("city/linz_25km2.geojson.gz", &sq(x, y, 224.0), &o);
    run("plans/cad_office_furnished.seg", &sq(27.0, 12.0, 4.0), &o);
    run("plans/cad_office_walls.seg", &sq(27.0, 12.0, 4.0), &o);
}
