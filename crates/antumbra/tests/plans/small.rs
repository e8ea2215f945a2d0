//! Tiny scenes on a tiny lattice, where everything touches, crosses, overlaps and lines up.

use antumbra::plan::{
    BoxTest, CellShape, Plan, PlanCell, PlanInput, PlanOptions, PlanProof, PlanSegment, PlanView,
    SeeOptions, SweepOrder, check, look,
};
use antumbra_testkit::environment::long;
use antumbra_testkit::flat::{FlatScene, GridPoint};
use antumbra_testkit::random::Random;
use dashu_int::IBig;

use crate::rays::{confirm, first, grid, oracle, seen, shoot};

pub(crate) fn build(segments: &[[GridPoint; 2]], leaf: usize) -> Plan {
    build_within(40.0, segments, leaf)
}

/// A plan on whole numbers below a size.
pub(crate) fn build_within(size: f64, segments: &[[GridPoint; 2]], leaf: usize) -> Plan {
    let segments = segments.iter().enumerate().map(|(i, s)| PlanSegment {
        ends: s.map(|p| p.map(|v| v as f64)),
        class: 0,
        feature: i as u32,
    });
    let input = PlanInput {
        segments: segments.collect(),
        classes: vec![String::new()],
        ..PlanInput::default()
    };
    let options = PlanOptions {
        grid: Some(1.0),
        around: Some(([-size; 2], [size; 2])),
        leaf,
        ..PlanOptions::default()
    };
    Plan::build(&input, &options).expect("good input")
}

pub(crate) fn random_cell(random: &mut Random, size: i64, kind: usize) -> Vec<[f64; 2]> {
    let mut p = || {
        [
            random.integer(-size, size) as f64,
            random.integer(-size, size) as f64,
        ]
    };
    match kind {
        0 => vec![p()],
        1 => vec![p(), p()],
        2 => {
            let (a, b) = (p(), p());
            let (x, y) = (a[0].min(b[0]), a[1].min(b[1]));
            let (w, h) = ((a[0] - b[0]).abs() + 1.0, (a[1] - b[1]).abs() + 1.0);
            vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
        }
        _ => vec![p(), p(), p()],
    }
}

/// All ways to look must give the same fragments.
pub(crate) fn ways() -> Vec<SeeOptions> {
    let mut out = Vec::new();
    for order in [SweepOrder::Priority, SweepOrder::DepthFirst] {
        for test in [BoxTest::Exact, BoxTest::Conservative, BoxTest::Never] {
            for one_tree in [false, true] {
                out.push(SeeOptions {
                    order,
                    test,
                    one_tree,
                    ..SeeOptions::default()
                });
            }
        }
    }
    out
}

pub(crate) fn same(a: &PlanView, b: &PlanView) {
    let list = |v: &PlanView| -> Vec<_> {
        let f = v.fragments.iter();
        f.map(|f| {
            (
                f.piece,
                f.at[0].parts(),
                f.at[1].parts(),
                f.at[0].value().to_bits(),
            )
        })
        .collect()
    };
    let (a, b) = (list(a), list(b));
    assert_eq!(a.len(), b.len(), "{a:?}\n{b:?}");
    for (x, y) in a.iter().zip(&b) {
        assert_eq!((x.0, x.3), (y.0, y.3));
        let equal = |p: &(IBig, IBig), q: &(IBig, IBig)| &p.0 * &q.1 == &q.0 * &p.1;
        assert!(equal(&x.1, &y.1) && equal(&x.2, &y.2), "{x:?} {y:?}");
    }
}

/// Positive combinations of critical lines reach every face of the arrangement in time: what such a line
/// hits first must be listed there.
fn combine(
    plan: &Plan,
    scene: &FlatScene,
    view: &PlanView,
    random: &mut Random,
    tries: usize,
) -> usize {
    let cell: Vec<GridPoint> = view.cell.corners().iter().map(|&c| grid(c)).collect();
    let points: Vec<GridPoint> = scene
        .segments()
        .iter()
        .flatten()
        .chain(&cell)
        .copied()
        .collect();
    let seen = seen(view);
    let mut hits = 0;
    for _ in 0..tries {
        let mut line = [IBig::ZERO, IBig::ZERO, IBig::ZERO];
        for _ in 0..3 {
            let (u, v) = (
                points[random.index(points.len())],
                points[random.index(points.len())],
            );
            let weight = [1, 1, 1000][random.index(3)];
            let part = [u[1] - v[1], v[0] - u[0], u[0] * v[1] - u[1] * v[0]];
            for k in 0..3 {
                line[k] += part[k] * weight;
            }
        }
        let Ok(Some((piece, [n, d]))) = first(scene, &line, &view.cell) else {
            continue;
        };
        hits += 1;
        let listed = seen.get(&piece).is_some_and(|s| s.0);
        let inside = view.fragments.iter().any(|f| {
            let ((ln, ld), (hn, hd)) = (f.at[0].parts(), f.at[1].parts());
            f.piece.0 as usize == piece && ln * &d <= &n * ld && &n * hd <= hn * &d
        });
        assert!(
            listed || inside,
            "line {line:?} hits piece {piece} at {n}/{d}, which is not in {:?}\npieces {:?}\ncell {cell:?}",
            seen.get(&piece),
            plan.pieces()
        );
    }
    hits
}

/// After a second pass every visible piece is in a leaf below a visible node.
fn second_pass(plan: &Plan, shape: &CellShape) {
    let options = SeeOptions {
        second_pass: true,
        test: BoxTest::Conservative,
        ..SeeOptions::default()
    };
    let view = look(plan, shape, &options);
    let mut below = view.visible_nodes.clone();
    let mut listed = Vec::new();
    while let Some(index) = below.pop() {
        let node = &plan.kd().nodes()[index as usize];
        assert!(!view.reclassified.contains(&index));
        below.extend(node.children().into_iter().flatten());
        listed.extend(plan.kd().items(node));
    }
    assert!(view.fragments.iter().all(|f| listed.contains(&f.piece)));
}

/// The certificate holds, and altered ones do not.
pub(crate) fn certificate(plan: &Plan, shape: &CellShape, random: &mut Random) {
    let options = SeeOptions {
        proof: true,
        one_tree: random.index(2) == 0,
        ..SeeOptions::default()
    };
    let Some(proof) = look(plan, shape, &options).proof else {
        assert!(matches!(shape, CellShape::Point(_)));
        return;
    };
    let report = check(plan, &proof);
    assert!(
        report.failed.is_empty(),
        "{:?}\n{:?}\n{proof:?}",
        report.failed,
        plan.pieces()
    );
    assert_eq!(report.visible_checked as usize, proof.fragments.len());
    if proof.fragments.is_empty() {
        return;
    }
    let refuse = |altered: &PlanProof, what: &str| {
        let report = check(plan, altered);
        assert!(
            !report.failed.is_empty(),
            "{what} went unnoticed: {altered:?}"
        );
    };
    let i = random.index(proof.fragments.len());
    let mut altered = proof.clone();
    let gone = altered.fragments.remove(i);
    if !proof.touching.contains(&gone.piece) {
        refuse(&altered, "a missing fragment");
    }
    let mut altered = proof.clone();
    altered.fragments[i].line = proof.fragments[i].line.clone().map(|c| -c);
    refuse(&altered, "a line turned round");
    let mut altered = proof.clone();
    altered.windows.remove(proof.fragments[i].window as usize);
    refuse(&altered, "a missing window");
}

#[test]
fn tiny_scenes_agree_with_the_oracle_and_with_themselves() {
    small_scenes(11, if long() { 6000 } else { 400 }, 1);
}

/// The same shapes over the whole grid, a step or none away from touching, crossing and lining up.
#[test]
fn scenes_as_large_as_the_grid_agree_with_the_oracle() {
    small_scenes(12, if long() { 6000 } else { 400 }, 900_000);
}

/// Lattices of a few points, `scale` steps from one to the next, give or take a step if that is more than one.
fn small_scenes(seed: u64, scenes: usize, scale: i64) {
    let mut random = Random::new(seed);
    let mut hits = 0;
    for scene in 0..scenes {
        let size = [2, 3, 5, 9][random.index(4)];
        let count = 1 + random.index(9);
        let stray = i64::from(scale > 1);
        let place = |random: &mut Random, v: i64| v * scale + random.integer(-stray, stray);
        let p = |random: &mut Random| {
            let p = [random.integer(-size, size), random.integer(-size, size)];
            p.map(|v| place(random, v))
        };
        let segments: Vec<[GridPoint; 2]> = (0..count)
            .map(|_| [p(&mut random), p(&mut random)])
            .collect();
        if segments.iter().all(|s| s[0] == s[1]) {
            continue;
        }
        let within = (40 * scale).min(8_300_000) as f64;
        let plan = build_within(within, &segments, 1);
        let outline: Vec<[f64; 2]> = random_cell(&mut random, size, scene % 4)
            .iter()
            .map(|p| p.map(|v| place(&mut random, v as i64).min(8_300_000) as f64))
            .collect();
        // A box whose corners strayed may meet itself.
        let Ok(cell) = PlanCell::new(&plan, &outline) else {
            continue;
        };
        let oracle = oracle(&plan);
        for shape in &cell.parts {
            let view = look(&plan, shape, &SeeOptions::default());
            confirm(&oracle, &view);
            certificate(&plan, shape, &mut random);
            second_pass(&plan, shape);
            hits += shoot(&plan, &oracle, &view, 60, &mut random);
            if !matches!(shape, CellShape::Point(_)) {
                hits += combine(&plan, &oracle, &view, &mut random, 150);
            }
            for way in ways() {
                same(&view, &look(&plan, shape, &way));
            }
            let mut shuffled = segments.clone();
            random.shuffle(&mut shuffled);
            let again = build_within(within, &shuffled, 3);
            assert_eq!(again.pieces(), plan.pieces());
            same(&view, &look(&again, shape, &SeeOptions::default()));
        }
    }
    assert!(hits > scenes * 20, "only {hits} hits");
}
