//! Measured plans, offices and cities: rays, witnesses, certificates, and what others measured.

use antumbra::plan::{
    Plan, PlanCell, PlanOptions, SeeOptions, SweepOrder, check, look, see, see_all,
};
use antumbra_io::plan::{PlanReadOptions, parse_cells, read_plan};
use antumbra_testkit::environment::{data, long, skip};
use antumbra_testkit::random::Random;

use crate::rays::{confirm, oracle, shoot};
use crate::small::same;

fn plan(name: &str, options: &PlanOptions) -> Option<Plan> {
    let Some(path) = data().map(|d| d.join(name)) else {
        skip("no measured data");
        return None;
    };
    let input = read_plan(&path, &PlanReadOptions::default()).expect("a good file");
    Some(Plan::build(&input, options).expect("a good plan"))
}

/// A random box of a given size within the plan.
fn some_box(plan: &Plan, size: f64, random: &mut Random) -> Vec<[f64; 2]> {
    let b = plan.bounds().expect("pieces");
    let (low, high) = (plan.to_scene(b.min), plan.to_scene(b.max));
    let at = |k: usize, u: f64| low[k] + (high[k] - low[k]) * (0.15 + 0.7 * u);
    let (x, y) = (at(0, random.unit()), at(1, random.unit()));
    vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]]
}

/// Rays from cells of several sizes; in the long run ten million a plan.
fn rays_agree(name: &str, sizes: &[f64]) {
    let Some(plan) = plan(name, &PlanOptions::default()) else {
        return;
    };
    let scene = oracle(&plan);
    let mut random = Random::new(name.len() as u64);
    let rays = if long() { 10_000_000 } else { 20_000 } / (2 * sizes.len());
    let mut hits = 0;
    for _ in 0..2 {
        for &size in sizes {
            let outline = some_box(&plan, size, &mut random);
            let cell = PlanCell::new(&plan, &outline).expect("a cell");
            let view = look(&plan, &cell.parts[0], &SeeOptions::default());
            let point = PlanCell::new(&plan, &outline[..1]).expect("a point");
            hits += shoot(&plan, &scene, &view, rays, &mut random);
            confirm(&scene, &view);
            let from_point = look(&plan, &point.parts[0], &SeeOptions::default());
            hits += shoot(&plan, &scene, &from_point, rays / 10, &mut random);
            same(
                &view,
                &look(
                    &plan,
                    &cell.parts[0],
                    &SeeOptions {
                        order: SweepOrder::DepthFirst,
                        one_tree: true,
                        ..SeeOptions::default()
                    },
                ),
            );
        }
    }
    assert!(hits * 10 > rays, "{name}: only {hits} hits");
}

#[test]
fn rays_in_a_real_office() {
    for floor in ["gf", "1", "2", "3", "4", "5", "6"] {
        rays_agree(
            &format!("plans/westport_house_{floor}.geojson"),
            &[0.5, 4.0],
        );
    }
    rays_agree("plans/cad_office_walls.geojson", &[0.5, 4.0]);
}

#[test]
fn rays_among_furniture() {
    rays_agree("plans/cad_office_furnished.geojson.gz", &[1.0]);
}

#[test]
fn rays_in_cities() {
    rays_agree("city/linz_1km2.geojson.gz", &[5.0, 60.0]);
    rays_agree("city/vienna_blocks_2d.geojson.gz", &[5.0, 60.0]);
    if long() {
        rays_agree("city/linz_8km2.geojson.gz", &[5.0, 60.0]);
        rays_agree("city/linz_25km2.geojson.gz", &[5.0, 60.0]);
        rays_agree("city/linz_full.geojson.gz", &[5.0, 60.0]);
    }
}

fn cell_56(plan: &Plan) -> PlanCell {
    let path = data()
        .expect("data")
        .join("city/linz_8km2_viewcells.geojson");
    let text = std::fs::read_to_string(path).expect("cells");
    let cells = parse_cells(&text, None).expect("good cells");
    PlanCell::new(plan, &cells[56].outline).expect("a cell")
}

/// Ten thousand sampled points of this street see 316 segments; the region sees no fewer.
#[test]
fn a_street_sees_what_sampling_saw_and_its_certificate_holds() {
    let Some(plan) = plan("city/linz_8km2.geojson.gz", &PlanOptions::default()) else {
        return;
    };
    let cell = cell_56(&plan);
    let options = SeeOptions {
        proof: true,
        ..SeeOptions::default()
    };
    let seen = see(&plan, &cell, &options);
    assert!(seen.segments.len() >= 316, "{}", seen.segments.len());
    let proof = seen.parts[0].proof.as_ref().expect("asked for");
    let report = check(&plan, proof);
    assert_eq!(report.failed, Vec::<String>::new());
    assert_eq!(report.hidden_checked as usize, plan.pieces().len());
    confirm(&oracle(&plan), &seen.parts[0]);
}

/// What points of a cell see is part of what the cell sees.
#[test]
fn from_point_answers_are_subsets() {
    let Some(plan) = plan("city/linz_1km2.geojson.gz", &PlanOptions::default()) else {
        return;
    };
    let mut random = Random::new(8);
    let (x, y) = (447_300.0, 5_350_100.0);
    let cell = PlanCell::new(
        &plan,
        &[[x, y], [x + 40.0, y], [x + 40.0, y + 12.0], [x, y + 12.0]],
    );
    let seen = see(&plan, &cell.expect("a cell"), &SeeOptions::default());
    let points: Vec<PlanCell> = (0..if long() { 10_000 } else { 300 })
        .map(|_| {
            let p = [x + 40.0 * random.unit(), y + 12.0 * random.unit()];
            PlanCell::new(&plan, &[p]).expect("a point")
        })
        .collect();
    for view in see_all(&plan, &points, &SeeOptions::default()) {
        for s in &view.segments {
            let all = seen.segments.iter().find(|t| t.segment == s.segment);
            let all = all.unwrap_or_else(|| panic!("{:?} is seen from a point only", s.segment));
            for f in &s.fragments {
                assert!(all.fragments.iter().any(|g| g[0] <= f[0] && f[1] <= g[1]));
            }
        }
    }
}
