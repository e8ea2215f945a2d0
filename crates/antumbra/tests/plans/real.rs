//! Measured plans, offices and cities: rays, witnesses, certificates, and what others measured.

use antumbra::plan::{
    BoxTest, CellShape, Fragment, PieceId, Plan, PlanCell, PlanInput, PlanOptions, PlanView,
    SeeOptions, Seen, SweepOrder, check, look, see, see_all,
};
use antumbra_io::plan::{PlanReadOptions, parse_cells, read_plan};
use antumbra_kernel::{Point2, Rect, orient2d};
use antumbra_testkit::environment::{data, long, skip};
use antumbra_testkit::random::Random;

use crate::rays::{confirm, oracle, shoot};

fn plan(name: &str, options: &PlanOptions) -> Option<Plan> {
    let Some(path) = data().map(|d| d.join(name)) else {
        skip("no measured data");
        return None;
    };
    let input = read_plan(&path, &PlanReadOptions::default()).expect("a good file");
    Some(Plan::build(&input, options).expect("a good plan"))
}

/// A random box of a given size within the plan, in grid steps.
fn some_box(plan: &Plan, size: f64, random: &mut Random) -> [Point2; 2] {
    let b = plan.bounds().expect("pieces");
    let side = (size / plan.grid().step()) as i64;
    let at = |low: i32, high: i32, random: &mut Random| {
        let (low, high) = (i64::from(low), i64::from(high));
        let margin = (high - low) / 7;
        random.integer(low + margin, high - margin)
    };
    let x = at(b.min.x, b.max.x, random);
    let y = at(b.min.y, b.max.y, random);
    [[x, y], [x + side, y + side]].map(|[x, y]| Point2::new(x as i32, y as i32))
}

fn is_free(plan: &Plan, [min, max]: [Point2; 2]) -> bool {
    let inner = Rect {
        min: Point2::new(min.x + 1, min.y + 1),
        max: Point2::new(max.x - 1, max.y - 1),
    };
    plan.pieces_in(&inner).is_empty()
}

fn outline(plan: &Plan, [low, high]: [Point2; 2]) -> Vec<[f64; 2]> {
    let [[x, y], [u, v]] = [plan.to_scene(low), plan.to_scene(high)];
    vec![[x, y], [u, y], [u, v], [x, v]]
}

/// What must hold of every plan: rays from cells of several sizes find nothing that is called hidden, ten million of
/// them in the long run; witnesses are confirmed; what points of the cells see is part of what the cells see, ten
/// thousand in the long run; the answers depend on nothing but the plan and the cell.
fn all_holds(name: &str, sizes: &[f64]) {
    let Some(path) = data().map(|d| d.join(name)) else {
        skip("no measured data");
        return;
    };
    let input = read_plan(&path, &PlanReadOptions::default()).expect("a good file");
    let plan = Plan::build(&input, &PlanOptions::default()).expect("a good plan");
    let scene = oracle(&plan);
    let mut random = Random::new(name.len() as u64);
    let (rays, points) = if long() {
        (10_000_000, 10_000)
    } else {
        (20_000, 40)
    };
    let cells = 2 * sizes.len();
    let mut hits = 0;
    let mut outlines = Vec::new();
    for (i, &size) in sizes.iter().chain(sizes).enumerate() {
        // The cells of the first round hold walls or not, those of the second one hold none if there is room.
        let mut corners = some_box(&plan, size, &mut random);
        for _ in 0..if i < sizes.len() { 0 } else { 1000 } {
            if is_free(&plan, corners) {
                break;
            }
            corners = some_box(&plan, size, &mut random);
        }
        outlines.push(outline(&plan, corners));
        let cell = PlanCell::new(&plan, &outlines[outlines.len() - 1]).expect("a cell");
        let view = look(&plan, &cell.parts[0], &SeeOptions::default());
        hits += shoot(&plan, &scene, &view, rays / cells, &mut random);
        confirm(&scene, &view);
        let eye = CellShape::Point(corners[0]);
        let from_point = look(&plan, &eye, &SeeOptions::default());
        hits += shoot(&plan, &scene, &from_point, rays / cells / 10, &mut random);
        confirm(&scene, &from_point);
        points_see_no_more(&plan, &view, points / cells, &mut random);
    }
    assert!(hits * 10 > rays, "{name}: only {hits} hits");
    nothing_else_matters(&input, &plan, &outlines, &mut random);
}

/// Points strictly inside a region see a part of what it sees.
fn points_see_no_more(plan: &Plan, region: &PlanView, count: usize, random: &mut Random) {
    let bounds = region.cell.bounds();
    let at = |low: i32, high: i32, random: &mut Random| {
        random.integer(i64::from(low) + 1, i64::from(high) - 1) as i32
    };
    for _ in 0..count {
        let x = at(bounds.min.x, bounds.max.x, random);
        let y = at(bounds.min.y, bounds.max.y, random);
        let eye = CellShape::Point(Point2::new(x, y));
        let view = look(plan, &eye, &SeeOptions::default());
        let touches = |id| region.touching.binary_search(id).is_ok();
        assert!(view.touching.iter().all(touches));
        for f in &view.fragments {
            // They are sorted by piece.
            let first = region.fragments.partition_point(|g| g.piece < f.piece);
            let of_piece = || {
                let rest = region.fragments[first..].iter();
                rest.take_while(|g| g.piece == f.piece)
            };
            let holds = |g: &Fragment| g.at[0] <= f.at[0] && f.at[1] <= g.at[1];
            assert!(
                touches(&f.piece) || of_piece().any(holds),
                "{eye:?} sees {f:?}, the cell around it only {:?}",
                of_piece().collect::<Vec<_>>()
            );
        }
    }
}

/// The answer does not depend on the order of the input, the kD-tree, the sweep, the number of trees or threads.
fn nothing_else_matters(
    input: &PlanInput,
    plan: &Plan,
    outlines: &[Vec<[f64; 2]>],
    random: &mut Random,
) {
    let mut order: Vec<u32> = (0..input.segments.len() as u32).collect();
    random.shuffle(&mut order);
    let segments = order.iter().map(|&i| input.segments[i as usize].clone());
    let shuffled = PlanInput {
        segments: segments.collect(),
        ..input.clone()
    };
    let options = PlanOptions {
        leaf: 20,
        ..PlanOptions::default()
    };
    let again = Plan::build(&shuffled, &options).expect("a good plan");
    assert_eq!(again.pieces(), plan.pieces());
    assert_ne!(again.kd().nodes().len(), plan.kd().nodes().len());
    let cells = |plan: &Plan| -> Vec<PlanCell> {
        let made = outlines.iter().map(|o| PlanCell::new(plan, o));
        made.map(|c| c.expect("a cell")).collect()
    };
    let here = cells(plan);
    let usual: Vec<Seen> = here
        .iter()
        .map(|c| see(plan, c, &SeeOptions::default()))
        .collect();
    let same = |other: &[Seen]| {
        for (a, b) in usual.iter().zip(other) {
            assert!(a.segments == b.segments, "{:?}", a.parts[0].cell);
        }
    };
    same(&see_all(plan, &here, &SeeOptions::default()));
    for (order, test, one_tree) in [
        (SweepOrder::DepthFirst, BoxTest::Exact, true),
        (SweepOrder::Priority, BoxTest::Conservative, false),
    ] {
        let options = SeeOptions {
            order,
            test,
            one_tree,
            ..SeeOptions::default()
        };
        same(&see_all(plan, &here, &options));
    }
    let mut renamed = see_all(&again, &cells(&again), &SeeOptions::default());
    for seen in &mut renamed {
        for s in &mut seen.segments {
            s.segment.0 = order[s.segment.0 as usize];
        }
        seen.segments.sort_by_key(|s| s.segment);
    }
    same(&renamed);
}

#[test]
fn all_holds_in_a_real_office() {
    for floor in ["gf", "1", "2", "3", "4", "5", "6"] {
        all_holds(
            &format!("plans/westport_house_{floor}.geojson"),
            &[0.5, 4.0],
        );
    }
    all_holds("plans/cad_office_walls.geojson", &[0.5, 4.0]);
}

#[test]
fn all_holds_among_furniture() {
    all_holds("plans/cad_office_furnished.geojson.gz", &[1.0]);
}

#[test]
fn all_holds_in_linz() {
    all_holds("city/linz_1km2.geojson.gz", &[5.0, 60.0]);
}

#[test]
fn all_holds_in_vienna() {
    all_holds("city/vienna_blocks_2d.geojson.gz", &[5.0, 60.0]);
}

#[test]
fn all_holds_in_more_of_linz() {
    if !long() {
        skip("ANTUMBRA_LONG is not set");
        return;
    }
    all_holds("city/linz_8km2.geojson.gz", &[5.0, 60.0]);
    all_holds("city/linz_25km2.geojson.gz", &[5.0, 60.0]);
}

#[test]
fn all_holds_in_all_of_linz() {
    if !long() {
        skip("ANTUMBRA_LONG is not set");
        return;
    }
    all_holds("city/linz_full.geojson.gz", &[5.0, 60.0]);
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

/// On a grid of 2 mm, as large cities need, the street sees two segments less. Both are 10 cm long, 200 m away or more, and seen
/// almost edge-on: their lines, which pass a corner of the street by less than a meter, turn by half a degree when their
/// ends are snapped, and leave the whole street behind them.
#[test]
fn a_coarser_grid_turns_short_segments_away() {
    let fine = PlanOptions::default();
    let coarse = PlanOptions {
        grid: Some(1.0 / 512.0),
        ..PlanOptions::default()
    };
    let views = [fine, coarse].map(|options| {
        let plan = plan("city/linz_8km2.geojson.gz", &options)?;
        let cell = cell_56(&plan);
        let seen = see(&plan, &cell, &SeeOptions::default());
        Some((plan, cell, seen))
    });
    let [Some((fine, cell, all)), Some((coarse, coarse_cell, seen))] = views else {
        return;
    };
    let ids = |seen: &Seen| -> Vec<_> { seen.segments.iter().map(|s| s.segment).collect() };
    let (all, seen) = (ids(&all), ids(&seen));
    let missing: Vec<_> = all.iter().filter(|id| !seen.contains(id)).collect();
    assert_eq!((all.len(), seen.len(), missing.len()), (316, 314, 2));
    // Whether the line of a segment has corners of the cell on both of its sides.
    let passes = |plan: &Plan, cell: &PlanCell, id| {
        let mut pieces = (0..plan.pieces().len() as u32).map(PieceId);
        let owned = |p: &PieceId| plan.owners(*p).iter().any(|o| o.segment == id);
        let [a, b] = plan.pieces()[pieces.find(owned).expect("a piece").0 as usize];
        let corners = cell.parts[0].corners().iter();
        let sides: Vec<i64> = corners.map(|&c| orient2d(a, b, c).signum()).collect();
        sides.contains(&1) && sides.contains(&-1)
    };
    for &id in missing {
        assert!(passes(&fine, &cell, id) && !passes(&coarse, &coarse_cell, id));
    }
}
