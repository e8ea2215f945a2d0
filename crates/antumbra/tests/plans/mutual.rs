//! Whether cells see each other, against the oracle.

use antumbra::plan::{CellShape, Plan, PlanCell, Sight, mutual, mutual_matrix};
use antumbra_kernel::Point2;
use antumbra_testkit::environment::long;
use antumbra_testkit::flat::{FlatScene, GridPoint, orient2d};
use antumbra_testkit::random::Random;

use crate::rays::{first, grid, inside};
use crate::small::{build, random_cell};

/// Whether two closed segments share a point.
fn meet([a, b]: [GridPoint; 2], [c, d]: [GridPoint; 2]) -> bool {
    let apart = |p: GridPoint, q: GridPoint, u: GridPoint, v: GridPoint| {
        orient2d(p, q, u).signum() * orient2d(p, q, v).signum() > 0
    };
    let boxes =
        (0..2).all(|k| a[k].min(b[k]) <= c[k].max(d[k]) && c[k].min(d[k]) <= a[k].max(b[k]));
    boxes && !apart(a, b, c, d) && !apart(c, d, a, b)
}

/// A line from one cell to another meets nothing between them.
fn confirm(plan: &Plan, sight: &Sight, from: &CellShape, to: &CellShape) {
    let Sight::Line(line) = sight else {
        assert!(from.meets(to));
        return;
    };
    assert!(!from.meets(to));
    if let (CellShape::Point(_), _) | (_, CellShape::Point(_)) = (from, to) {
        return;
    }
    let corners: Vec<GridPoint> = to.corners().iter().map(|&c| grid(c)).collect();
    let n = corners.len();
    let sides = if n == 2 { 1 } else { n };
    let along =
        |s: &[GridPoint; 2]| n == 2 && s.iter().all(|&p| orient2d(corners[0], corners[1], p) == 0);
    let hits_wall = |walls: &[[Point2; 2]]| {
        let walls = walls.iter().map(|e| e.map(grid));
        let mut all: Vec<[GridPoint; 2]> = walls.filter(|s| !along(s)).collect();
        let count = all.len();
        all.extend((0..sides).map(|k| [corners[k], corners[(k + 1) % n]]));
        let hit = first(&FlatScene::new(all), &line.big(), from)?;
        Ok::<bool, String>(hit.expect("it gets there").0 < count)
    };
    let blocked = hits_wall(plan.pieces()).or_else(|_| {
        // It gets there where a wall does, too.
        let walls = plan.pieces().iter().copied();
        let before: Vec<[Point2; 2]> = walls.filter(|&e| !to.meets_segment(e)).collect();
        hits_wall(&before)
    });
    assert_eq!(blocked, Ok(false), "{from:?} {to:?} {:?}", plan.pieces());
}

/// Whether some of many lines between points of two cells meet nothing. Cells on one line see each other along that
/// line alone, which does not count, unless both are points.
fn sampled(plan: &Plan, from: &CellShape, to: &CellShape, random: &mut Random) -> bool {
    let corners = from.corners().iter().chain(to.corners());
    let all: Vec<GridPoint> = corners.map(|&c| grid(c)).collect();
    if all.len() == 3 || all.len() == 4 {
        let flat = |u: &GridPoint| {
            all.iter()
                .all(|&v| all.iter().all(|&w| orient2d(*u, v, w) == 0))
        };
        if all.iter().all(flat) {
            return false;
        }
    }
    (0..40).any(|_| {
        let (Some(p), Some(q)) = (inside(from, random), inside(to, random)) else {
            return false;
        };
        let mut pieces = plan.pieces().iter();
        pieces.all(|e| !meet(e.map(grid), [p, q]))
    })
}

#[test]
fn sights_are_mutual_and_no_line_is_missed() {
    let mut random = Random::new(21);
    let (mut seen, mut hidden) = (0, 0);
    for scene in 0..if long() { 20_000 } else { 1500 } {
        let size = [2, 3, 5, 9][random.index(4)];
        let count = 1 + random.index(9);
        let mut p = || [random.integer(-size, size), random.integer(-size, size)];
        let mut segments: Vec<[GridPoint; 2]> = (0..count).map(|_| [p(), p()]).collect();
        segments.push([[-30, 30], [30, 30]]);
        let plan = build(&segments, 1);
        let cell = |random: &mut Random, kind: usize| {
            PlanCell::new(&plan, &random_cell(random, size, kind)).expect("a cell")
        };
        let one = cell(&mut random, scene % 4);
        let other = cell(&mut random, (scene / 4) % 4);
        let (there, back) = (mutual(&plan, &one, &other), mutual(&plan, &other, &one));
        let (from, to) = (&one.parts[0], &other.parts[0]);
        assert_eq!(
            there.is_some(),
            back.is_some(),
            "{segments:?} {from:?} {to:?}"
        );
        let matrix = mutual_matrix(&plan, &[one.clone(), other.clone()]);
        assert_eq!(matrix[0][1], there.is_some());
        match (&there, &back) {
            (Some(there), Some(back)) => {
                seen += 1;
                confirm(&plan, there, from, to);
                confirm(&plan, back, to, from);
            }
            _ => {
                hidden += 1;
                assert!(
                    !sampled(&plan, from, to, &mut random),
                    "{segments:?} {from:?} {to:?}"
                );
            }
        }
    }
    assert!(seen > 500 && hidden > 100, "{seen} {hidden}");
}
