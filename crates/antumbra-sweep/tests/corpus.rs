//! The corpus through the 3D engine: every expected verdict, under grid motions, reorderings and
//! reversals, with every certificate checked.

use antumbra_kernel::{Aabb, Rounding};
use antumbra_scene::{
    CellKind, Faces, ObjectId, ObjectInput, OccluderPolicy, PartInput, Scene, SceneBuilder,
    SceneInput, ViewCell,
};
use antumbra_sweep::{Accuracy, BakeOptions, Baker, Surface, Verdict, check_cell};
use antumbra_testkit::corpus::{Case, Expect, From, Query, load};
use antumbra_testkit::environment::long;
use antumbra_testkit::laws::{GridMotion, reordered, reversed, subdivided};
use antumbra_testkit::random::Random;

/// The corpus scene on a grid of step 1, so that nothing moves.
fn build(case: &Case) -> Scene {
    let objects = case
        .objects()
        .into_iter()
        .map(|name| {
            let parts = case
                .polygons_of(name)
                .map(|i| {
                    let polygon = &case.polygons[i];
                    let mut faces = Faces::default();
                    faces.push(&(0..polygon.corners.len() as u32).collect::<Vec<_>>());
                    let vertices = polygon
                        .corners
                        .iter()
                        .map(|c| c.map(|v| v as f64))
                        .collect();
                    PartInput {
                        class: None,
                        translucent: !polygon.occludes,
                        vertices,
                        faces,
                    }
                })
                .collect();
            ObjectInput {
                name: Some(name.to_owned()),
                parts,
            }
        })
        .collect();
    let input = SceneInput {
        objects,
        source_name: case.name.clone(),
    };
    let (scene, _) = SceneBuilder::new(input)
        .grid(Some(1.0))
        .policy(OccluderPolicy::Default)
        .build()
        .unwrap_or_else(|e| panic!("{}: {e}", case.name));
    scene
        .sanity_check()
        .unwrap_or_else(|e| panic!("{}: {e}", case.name));
    scene
}

fn object(scene: &Scene, name: &str) -> ObjectId {
    let found = scene.objects().iter().position(|o| o.name == name);
    ObjectId(found.expect("the corpus loader checked names") as u32)
}

fn cell(scene: &Scene, name: &str, min: [i64; 3], max: [i64; 3]) -> ViewCell {
    let snap = |c: [i64; 3]| {
        scene
            .grid()
            .snap_with(c.map(|v| v as f64), [Rounding::Nearest; 3])
            .expect("the corpus stays on the grid")
    };
    ViewCell {
        name: name.to_owned(),
        bounds: Aabb::new(snap(min), snap(max)),
        kind: CellKind::Box,
    }
}

/// What the engine says about a query, in the corpus's words, and why that is wrong, if it is.
fn judge(scene: &Scene, case: &Case, query: &Query, seed: u64) -> Result<(), String> {
    let baker = Baker::new(scene);
    let options = BakeOptions {
        seed,
        ..BakeOptions::default()
    };
    let target = object(scene, &query.to);
    let seen = match &query.from {
        From::Object(name) => {
            let from = object(scene, name);
            let result = baker.pair(Surface::Object(from), Surface::Object(target), &options);
            match result.verdict {
                Verdict::Visible { .. } => Expect::Visible,
                Verdict::Hidden(proof) => {
                    let others: Vec<ObjectId> = (0..scene.objects().len() as u32)
                        .map(ObjectId)
                        .filter(|&o| o != target && o != from)
                        .collect();
                    let bounds = scene.bounds();
                    let cell = ViewCell {
                        name: "pair".into(),
                        bounds,
                        kind: CellKind::Object(from),
                    };
                    let report = check_cell(scene, &cell, &[], &others, Accuracy::Exact, &proof);
                    // A pair may touch and be hidden all the same; a cell sees what it touches.
                    let fault = report
                        .failed
                        .iter()
                        .find(|f| !f.contains("touches the cell"));
                    if let Some(why) = fault {
                        return Err(format!("the checker refuses the proof: {why}"));
                    }
                    Expect::Hidden
                }
                Verdict::Unknown => return Err(format!("unknown: {:?}", result.work)),
            }
        }
        From::Cell { min, max } => {
            let cell = cell(scene, &case.name, *min, *max);
            let result = baker.bake_cell(&cell, &options);
            let report = check_cell(
                scene,
                &cell,
                &result.visible,
                &result.unknown,
                result.accuracy,
                &result.proof,
            );
            if let Some(why) = report.failed.first() {
                return Err(format!("the checker refuses the result: {why}"));
            }
            if result.unknown.contains(&target) {
                return Err(format!("unknown: {:?}", result.work));
            }
            let conservative = result.accuracy == Accuracy::Conservative;
            if conservative != query.conservative {
                return Err(format!("labelled {:?}", result.accuracy));
            }
            match result.visible.iter().find(|e| e.object == target) {
                Some(entry) if entry.touching != query.touching => {
                    return Err(format!("touching is {}", entry.touching));
                }
                Some(_) => Expect::Visible,
                None => Expect::Hidden,
            }
        }
    };
    if seen == query.expect {
        Ok(())
    } else {
        Err(format!("called {seen:?}"))
    }
}

fn run(cases: &[Case], variant: &str, failures: &mut Vec<String>) -> usize {
    let mut count = 0;
    for case in cases {
        let scene = build(case);
        for (i, query) in case.queries.iter().enumerate() {
            count += 1;
            if let Err(why) = judge(&scene, case, query, 1 + i as u64) {
                failures.push(format!(
                    "{} ({variant}), query {i} to {}: expected {:?}, {why}",
                    case.name, query.to, query.expect
                ));
            }
        }
    }
    count
}

fn report(failures: &[String], count: usize) {
    assert!(count > 0);
    assert!(
        failures.is_empty(),
        "{} of {count} verdicts:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

#[test]
fn every_verdict_of_the_corpus_holds() {
    let mut failures = Vec::new();
    let count = run(&load(), "as written", &mut failures);
    report(&failures, count);
}

#[test]
fn grid_motions_change_no_verdict() {
    let motions = GridMotion::all();
    let step = if long() { 1 } else { 9 };
    let (mut failures, mut count) = (Vec::new(), 0);
    for motion in motions.iter().skip(1).step_by(step) {
        let moved: Vec<Case> = load().iter().map(|c| motion.apply_case(c)).collect();
        count += run(&moved, &format!("{motion:?}"), &mut failures);
    }
    report(&failures, count);
}

#[test]
fn order_orientation_and_subdivision_change_no_verdict() {
    let mut random = Random::new(5);
    let mut failures = Vec::new();
    let shuffled: Vec<Case> = load().iter().map(|c| reordered(c, &mut random)).collect();
    let mut count = run(&shuffled, "reordered", &mut failures);
    let turned: Vec<Case> = load().iter().map(reversed).collect();
    count += run(&turned, "reversed", &mut failures);
    let cut: Vec<Case> = load().iter().map(subdivided).collect();
    count += run(&cut, "subdivided", &mut failures);
    report(&failures, count);
}
