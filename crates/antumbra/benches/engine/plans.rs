//! What cells see of cities, offices and random segments, in the plane.

use antumbra::plan::{Plan, PlanCell, PlanInput, PlanOptions, SeeOptions, check, see};
use antumbra::scene::synth::{SegmentParams, random_segments};
use antumbra_io::plan::{PlanReadOptions, parse_cells, read_plan};
use antumbra_testkit::environment::{data, skip};
use criterion::Criterion;

fn square(x: f64, y: f64, side: f64) -> Vec<[f64; 2]> {
    vec![[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
}

fn street() -> Option<Vec<[f64; 2]>> {
    let path = data()?.join("city/linz_8km2_viewcells.geojson");
    let text = std::fs::read_to_string(path).ok()?;
    Some(parse_cells(&text, None).ok()?.remove(56).outline)
}

fn read(name: &str) -> Option<PlanInput> {
    let path = data().map(|d| d.join(name));
    let read = path.and_then(|p| read_plan(&p, &PlanReadOptions::default()).ok());
    if read.is_none() {
        skip(&format!("{name} is absent"));
    }
    read
}

/// Streets and a hall of a city, a furnished office, random segments.
pub(crate) fn cells(c: &mut Criterion) {
    let mut cities = vec![("city/linz_25km2.geojson.gz", "a street")];
    cities.push(("city/linz_full.geojson.gz", "a street"));
    if let Some(street) = street() {
        for (name, place) in cities {
            if let Some(input) = read(name) {
                build(c, name, &input);
                view(c, &format!("{name}, {place}"), &input, &street, 300);
            }
        }
    }
    if let Some(input) = read("city/linz_25km2.geojson.gz") {
        let outline = square(447_100.0, 5_349_900.0, 224.0);
        view(c, "linz_25km2, 0.2 % of the area", &input, &outline, 2000);
    }
    if let Some(input) = read("plans/cad_office_furnished.seg") {
        let outline = square(27.0, 12.0, 4.0);
        view(c, "a furnished office, 4 x 4 m", &input, &outline, 1000);
    }
    let thousand = random_segments(&SegmentParams::new(1000, 1));
    view(
        c,
        "1000 random segments, 5.1 %",
        &thousand,
        &square(40.0, 40.0, 22.6),
        300,
    );
    let many = random_segments(&SegmentParams::new(20_000, 1));
    view(
        c,
        "20000 random segments, 3.4 %",
        &many,
        &square(40.0, 40.0, 18.4),
        1500,
    );
    view(
        c,
        "20000 random segments, 0.21 %",
        &many,
        &square(40.0, 40.0, 4.6),
        200,
    );
}

fn build(c: &mut Criterion, name: &str, input: &PlanInput) {
    let options = PlanOptions::default();
    let mut group = c.benchmark_group("plans");
    group.bench_function(format!("{name}, build"), |b| {
        b.iter(|| Plan::build(input, &options));
    });
    group.finish();
}

/// Confirms the certificate of a view, then times the view.
fn view(c: &mut Criterion, name: &str, input: &PlanInput, outline: &[[f64; 2]], least: usize) {
    let plan = Plan::build(input, &PlanOptions::default()).expect("a good plan");
    let cell = PlanCell::new(&plan, outline).expect("a cell");
    let options = SeeOptions {
        proof: true,
        ..SeeOptions::default()
    };
    let seen = see(&plan, &cell, &options);
    assert!(
        seen.segments.len() >= least,
        "{name}: {} seen",
        seen.segments.len()
    );
    let proof = seen.parts[0].proof.as_ref().expect("asked for");
    let report = check(&plan, proof);
    assert!(report.failed.is_empty(), "{name}: {}", report.failed[0]);
    let mut group = c.benchmark_group("plans");
    group.bench_function(name, |b| {
        b.iter(|| see(&plan, &cell, &SeeOptions::default()))
    });
    group.finish();
}
