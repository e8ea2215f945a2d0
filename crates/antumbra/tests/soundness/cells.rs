//! What does a cell see? Oracles, certificates and laws on small scenes.

use std::collections::BTreeSet;

use antumbra::region::{Accuracy, BakeOptions, Baker, CellResult, check_cell};
use antumbra::scene::{CellKind, ObjectId, Scene, ViewCell};
use antumbra_kernel::Point;
use antumbra_sweep::{Caster, PointVerdict, Surface, Verdict};
use antumbra_testkit::corpus::{Case, From};
use antumbra_testkit::laws::{GridMotion, reordered};
use antumbra_testkit::prover::prove;
use antumbra_testkit::random::Random;
use antumbra_testkit::sampler::find;
use antumbra_testkit::scene::{Polygon, Source, View};

use crate::judge::{Judge, id};
use crate::small::{Small, build, cell, cut_up, for_all, object, seeded, unrepaired};

const TRIES: usize = 40;
const PIECES: usize = 40;
const EYES: usize = 4;

/// Bakes a cell and believes nothing: no unknowns, certificates that hold, entries that are right.
fn bake(scene: &Scene, judge: &Judge, cell: &ViewCell, seed: u64) -> Result<CellResult, String> {
    let result = Baker::new(scene).bake_cell(cell, &seeded(seed));
    if !result.unknown.is_empty() {
        return Err(format!("unknown {:?}: {:?}", result.unknown, result.work));
    }
    let CellResult {
        visible,
        unknown,
        accuracy,
        proof,
        ..
    } = &result;
    let report = check_cell(scene, cell, visible, unknown, *accuracy, proof);
    if let Some(why) = report.failed.first() {
        return Err(format!("the checker refuses the result: {why}"));
    }
    judge.check_entries(scene, cell, visible)?;
    let entered = cell.kind == CellKind::Box && judge.entered(cell);
    if entered != (result.accuracy == Accuracy::Conservative) {
        return Err(format!("labelled {:?}, entered {entered}", result.accuracy));
    }
    Ok(result)
}

fn names(scene: &Scene, result: &CellResult) -> BTreeSet<String> {
    result
        .visible
        .iter()
        .map(|e| scene.object(e.object).name.clone())
        .collect()
}

/// The visible names of a case, for a box.
fn seen(case: &Case, bounds: [[i64; 3]; 2], seed: u64) -> Result<BTreeSet<String>, String> {
    let scene = build(case);
    let judge = Judge::new(&scene);
    bake(&scene, &judge, &cell(bounds), seed).map(|r| names(&scene, &r))
}

fn against_oracles(small: &Small) -> Result<(), String> {
    let scene = build(&small.case);
    let judge = Judge::new(&scene);
    let cell = cell(small.cell);
    let result = bake(&scene, &judge, &cell, small.seed)?;
    let [min, max] = small.cell;
    let mut random = Random::new(small.seed);
    let caster = Caster::new(&scene);
    let source = Source::Cell { min, max };
    for i in 0..scene.objects().len() as u32 {
        let object = ObjectId(i);
        let entry = result.visible.iter().find(|e| e.object == object);
        let view = |target| View {
            polygons: judge.polygons(),
            source: &source,
            target,
        };
        let targets: Vec<usize> = judge.polygons_of(object).collect();
        match entry {
            Some(entry) if entry.touching => {}
            Some(_) => {
                if targets.iter().all(|&t| prove(&view(t), PIECES).is_some()) {
                    return Err(format!("object {i} is called visible, but proved hidden"));
                }
            }
            None => {
                for &target in &targets {
                    if let Some([from, to]) = find(&view(target), TRIES, &mut random) {
                        return Err(format!("object {i} is hidden, but {from} to {to} is free"));
                    }
                    for _ in 0..EYES {
                        let inside = |k: usize| (min[k] + 1, max[k] - 1);
                        if (0..3).any(|k| inside(k).0 > inside(k).1) {
                            break;
                        }
                        let at: [i64; 3] =
                            std::array::from_fn(|k| random.integer(inside(k).0, inside(k).1));
                        let eye = Point::from(at.map(|c| c as i32));
                        if let PointVerdict::Visible { at, .. } = caster.point_sees(eye, id(target))
                        {
                            return Err(format!("object {i} is hidden, but {eye:?} sees {at:?}"));
                        }
                    }
                }
            }
        }
    }
    Ok(())
}

fn keeps_laws(small: &Small) -> Result<(), String> {
    let Small {
        case,
        cell: bounds,
        seed,
        ..
    } = small;
    let case = &unrepaired(case);
    let expect = seen(case, *bounds, *seed)?;
    let same = |what: &str, other: Result<BTreeSet<String>, String>| match other {
        Err(e) => Err(format!("{what}: {e}")),
        Ok(other) if other != expect => Err(format!("{what}: {expect:?} became {other:?}")),
        Ok(_) => Ok(()),
    };
    let mut random = Random::new(*seed);
    same("another seed", seen(case, *bounds, seed.wrapping_add(1)))?;
    same(
        "reordered",
        seen(&reordered(case, &mut random), *bounds, *seed),
    )?;

    let motions = GridMotion::all();
    let motion = motions[random.index(motions.len())];
    let mut moved = case.clone();
    moved.queries[0].from = From::Cell {
        min: bounds[0],
        max: bounds[1],
    };
    let moved = motion.apply_case(&moved);
    if let From::Cell { min, max } = moved.queries[0].from {
        same(&format!("{motion:?}"), seen(&moved, [min, max], *seed))?;
    }

    // A smaller cell sees less.
    let inner = std::array::from_fn(|k| {
        let a = random.integer(bounds[0][k], bounds[1][k] - 1);
        (a, random.integer(a + 1, bounds[1][k]))
    });
    let inner: [(i64, i64); 3] = inner;
    let inner = [inner.map(|i| i.0), inner.map(|i| i.1)];
    let less = seen(case, inner, *seed).map_err(|e| format!("cell {inner:?}: {e}"))?;
    if !less.is_subset(&expect) {
        return Err(format!(
            "{less:?} from {inner:?}, but {expect:?} from around it"
        ));
    }

    // One occluder more hides, and reveals nothing.
    let mut more = case.clone();
    more.polygons.push(Polygon {
        object: "added".to_owned(),
        corners: small.extra.clone(),
        occludes: true,
    });
    let mut rest = seen(&more, *bounds, *seed).map_err(|e| format!("occluder added: {e}"))?;
    rest.remove("added");
    if !rest.is_subset(&expect) {
        return Err(format!("occluder added: {expect:?} became {rest:?}"));
    }

    // Pieces hide what the whole hid.
    let pieces = seen(&cut_up(case), *bounds, *seed).map_err(|e| format!("cut up: {e}"))?;
    for name in ["a", "b"] {
        if pieces.contains(name) != expect.contains(name) {
            return Err(format!("cut up: {name} was {}", expect.contains(name)));
        }
    }

    let scene = build(case);
    let options = BakeOptions {
        proofs: false,
        ..seeded(*seed)
    };
    let bare = Baker::new(&scene).bake_cell(&cell(*bounds), &options);
    same("without proofs", Ok(names(&scene, &bare)))
}

/// An object as a cell sees what it sees in pairs.
fn objects_as_cells(small: &Small) -> Result<(), String> {
    let scene = build(&small.case);
    let judge = Judge::new(&scene);
    let Some(source) = object(&scene, "a") else {
        return Ok(());
    };
    let Some(bounds) = scene.object_bounds(source) else {
        return Ok(());
    };
    let kind = CellKind::Object(source);
    let cell = ViewCell {
        name: "a".to_owned(),
        bounds,
        kind,
    };
    let result = bake(&scene, &judge, &cell, small.seed)?;
    let baker = Baker::new(&scene);
    for i in 0..scene.objects().len() as u32 {
        let object = ObjectId(i);
        let entry = result.visible.iter().find(|e| e.object == object);
        if object == source || entry.is_some_and(|e| e.touching) {
            continue;
        }
        let (from, to) = (Surface::Object(source), Surface::Object(object));
        let answer = baker.pair(from, to, &seeded(small.seed)).verdict;
        let visible = match answer {
            Verdict::Visible { .. } => true,
            Verdict::Hidden(_) => false,
            Verdict::Unknown => return Err(format!("unknown: pair to object {i}")),
        };
        if visible != entry.is_some() {
            return Err(format!(
                "object {i} as a pair: {visible}, from the cell: {entry:?}"
            ));
        }
    }
    Ok(())
}

#[test]
fn oracles_and_checker_agree_about_cells() {
    for_all(8, (200, 15_000), against_oracles);
}

#[test]
fn crowded_cells_agree_too() {
    for_all(24, (40, 3_000), against_oracles);
}

#[test]
fn laws_hold_for_cells() {
    for_all(8, (100, 6_000), keeps_laws);
}

#[test]
fn objects_as_cells_see_what_they_see_in_pairs() {
    for_all(8, (150, 8_000), objects_as_cells);
}
