//! Does a see b? Oracles, certificates and laws on small scenes.

use antumbra::region::{Accuracy, Baker, check_cell};
use antumbra::scene::{CellKind, ObjectId, PolygonId, Scene, ViewCell};
use antumbra_kernel::Point;
use antumbra_sweep::{Caster, PointVerdict, Surface, Verdict, Witness};
use antumbra_testkit::corpus::{Case, Expect};
use antumbra_testkit::laws::{GridMotion, reordered, with_occluder};
use antumbra_testkit::prover::prove;
use antumbra_testkit::random::Random;
use antumbra_testkit::rational::RationalPoint;
use antumbra_testkit::sampler::find;
use antumbra_testkit::scene::{Source, View};
use antumbra_testkit::segment::{Contact, contact};

use crate::judge::{Judge, id};
use crate::small::{Small, build, cut_up, for_all, object, seeded, unrepaired};

/// Tries of the sampler for each pair of polygons.
const TRIES: usize = 60;
/// Pairs of pieces that a proof by bisection may look at.
const PIECES: usize = 60;
/// Points of the source from which a hidden target is looked for exactly.
const EYES: usize = 6;

/// What the engine says about a and b, with its witness if there is one.
fn decide(
    scene: &Scene,
    from: ObjectId,
    to: ObjectId,
    seed: u64,
) -> Result<(Expect, Option<Witness>), String> {
    let result = Baker::new(scene).pair(Surface::Object(from), Surface::Object(to), &seeded(seed));
    match result.verdict {
        Verdict::Visible { witness, .. } => Ok((Expect::Visible, Some(witness))),
        Verdict::Unknown => Err(format!("unknown: {:?}", result.work)),
        Verdict::Hidden(proof) => {
            let others: Vec<ObjectId> = (0..scene.objects().len() as u32)
                .map(ObjectId)
                .filter(|&o| o != from && o != to)
                .collect();
            let kind = CellKind::Object(from);
            let cell = ViewCell {
                name: "pair".into(),
                bounds: scene.bounds(),
                kind,
            };
            let report = check_cell(scene, &cell, &[], &others, Accuracy::Exact, &proof);
            // A pair may touch and be hidden all the same; a cell sees what it touches.
            match report
                .failed
                .iter()
                .find(|f| !f.contains("touches the cell"))
            {
                Some(why) => Err(format!("the checker refuses the proof: {why}")),
                None => Ok((Expect::Hidden, None)),
            }
        }
    }
}

/// The verdict about a case; none if the scene has lost one of the two.
fn verdict(case: &Case, from: &str, to: &str, seed: u64) -> Result<Option<Expect>, String> {
    let scene = build(case);
    let (Some(from), Some(to)) = (object(&scene, from), object(&scene, to)) else {
        return Ok(None);
    };
    decide(&scene, from, to, seed).map(|(expect, _)| Some(expect))
}

fn same(what: &str, case: &Case, seed: u64, expect: Expect) -> Result<(), String> {
    let context = |e: String| format!("{what}: {e}");
    match verdict(case, "a", "b", seed).map_err(context)? {
        Some(other) if other != expect => Err(format!("{what}: {expect:?} became {other:?}")),
        _ => Ok(()),
    }
}

/// Grid points inside a polygon: random means of its corners, rounded, if they are in its plane.
fn eyes<'a>(corners: &'a [[i64; 3]], random: &'a mut Random) -> impl Iterator<Item = Point> + 'a {
    (0..EYES).filter_map(move |_| {
        let weights: Vec<i64> = corners.iter().map(|_| random.integer(1, 64)).collect();
        let total: i64 = weights.iter().sum();
        let at: [i64; 3] = std::array::from_fn(|k| {
            let sum: i64 = corners.iter().zip(&weights).map(|(c, w)| c[k] * w).sum();
            sum.div_euclid(total)
        });
        let p = RationalPoint::from_grid(at);
        let flat = antumbra_testkit::segment::height(corners, &p) == dashu_int::IBig::ZERO;
        let inside = flat && antumbra_testkit::segment::strictly_inside(&p, corners);
        inside.then(|| Point::from(at.map(|c| c as i32)))
    })
}

fn against_oracles(small: &Small) -> Result<(), String> {
    let scene = build(&small.case);
    let (Some(a), Some(b)) = (object(&scene, "a"), object(&scene, "b")) else {
        return Ok(());
    };
    let judge = Judge::new(&scene);
    let (expect, witness) = decide(&scene, a, b, small.seed)?;
    if let Some(witness) = witness {
        let source = scene.object(a).polygons.start + witness.source / 2;
        let (start, segment) = judge.sight_from(a, source, &witness)?;
        judge
            .proves(start, &segment, witness.polygon.index())
            .map_err(|why| format!("called visible by a witness that fails: {why}"))?;
        let mut proved = true;
        for (i, j) in pairs(&judge, a, b) {
            let source = Source::Polygon(i);
            let view = View {
                polygons: judge.polygons(),
                source: &source,
                target: j,
            };
            proved &= prove(&view, PIECES).is_some();
        }
        return if proved {
            Err("called visible, but proved hidden".to_owned())
        } else {
            Ok(())
        };
    }
    let mut random = Random::new(small.seed);
    let caster = Caster::new(&scene);
    for (i, j) in pairs(&judge, a, b) {
        let source = Source::Polygon(i);
        let view = View {
            polygons: judge.polygons(),
            source: &source,
            target: j,
        };
        if let Some([from, to]) = find(&view, TRIES, &mut random) {
            return Err(format!(
                "called {expect:?}, but from {from} to {to} is free"
            ));
        }
        for eye in eyes(&judge.polygons()[i].corners, &mut random) {
            if let PointVerdict::Visible { at, .. } = caster.point_sees(eye, id(j)) {
                return Err(format!("called {expect:?}, but {eye:?} sees {at:?}"));
            }
        }
    }
    Ok(())
}

fn pairs(judge: &Judge, a: ObjectId, b: ObjectId) -> Vec<(usize, usize)> {
    let of = |o| judge.polygons_of(o).collect::<Vec<usize>>();
    let (from, to) = (of(a), of(b));
    from.iter()
        .flat_map(|&i| to.iter().map(move |&j| (i, j)))
        .collect()
}

fn keeps_laws(small: &Small) -> Result<(), String> {
    let Small { case, seed, .. } = small;
    let case = &unrepaired(case);
    let Some(expect) = verdict(case, "a", "b", *seed)? else {
        return Ok(());
    };
    let mut random = Random::new(*seed);
    match verdict(case, "b", "a", *seed).map_err(|e| format!("reversed: {e}"))? {
        Some(other) if other != expect => {
            return Err(format!("reversed: {expect:?} became {other:?}"));
        }
        _ => {}
    }
    same("another seed", case, seed.wrapping_add(1), expect)?;
    let motions = GridMotion::all();
    let motion = motions[random.index(motions.len())];
    same(
        &format!("{motion:?}"),
        &motion.apply_case(case),
        *seed,
        expect,
    )?;
    same("reordered", &reordered(case, &mut random), *seed, expect)?;
    same("cut up", &cut_up(case), *seed, expect)?;
    if expect == Expect::Hidden {
        same(
            "occluder added",
            &with_occluder(case, small.extra.clone()),
            *seed,
            expect,
        )?;
    } else {
        let others: Vec<usize> = (0..case.polygons.len())
            .filter(|&i| case.polygons[i].object.starts_with('o'))
            .collect();
        if !others.is_empty() {
            let mut less = case.clone();
            less.polygons.remove(others[random.index(others.len())]);
            same("occluder removed", &less, *seed, expect)?;
        }
    }
    Ok(())
}

/// A single line between grid points, against the rational oracle.
fn traces(small: &Small) -> Result<(), String> {
    let scene = build(&small.case);
    let judge = Judge::new(&scene);
    let [from, to] = small.cell;
    let point = |c: [i64; 3]| Point::from(c.map(|v| v as i32));
    let trace = Caster::new(&scene)
        .trace(point(from), point(to))
        .ok_or("no trace")?;
    let ends = [from, to].map(RationalPoint::from_grid);
    for (i, polygon) in judge.polygons().iter().enumerate() {
        let met = match contact(&ends[0], &ends[1], &polygon.corners) {
            Contact::Miss => None,
            Contact::Touch { t } | Contact::Cross { t } => Some(t.to_f64()),
        };
        let said = trace
            .hits
            .iter()
            .find(|h| h.polygon == PolygonId(i as u32))
            .map(|h| h.at);
        let agrees = match (met.filter(|_| polygon.occludes), said) {
            (None, None) => true,
            (Some(s), Some(t)) => (s - t).abs() < 1e-9,
            _ => false,
        };
        if !agrees {
            return Err(format!(
                "polygon {i} is met at {met:?}, but {said:?} is said"
            ));
        }
    }
    Ok(())
}

#[test]
fn oracles_and_checker_agree_about_pairs() {
    for_all(7, (300, 20_000), against_oracles);
}

#[test]
fn crowded_pairs_agree_too() {
    for_all(24, (60, 4_000), against_oracles);
}

#[test]
fn laws_hold_for_pairs() {
    for_all(7, (150, 10_000), keeps_laws);
}

#[test]
fn single_lines_meet_what_the_oracle_meets() {
    for_all(12, (300, 20_000), traces);
}
