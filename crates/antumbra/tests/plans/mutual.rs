//! Whether cells see each other, and the area that a cell sees, against the oracle and against each other.

use antumbra::plan::{CellShape, Isovist, Plan, PlanCell, Sight, isovist, mutual, mutual_matrix};
use antumbra_kernel::Point2;
use antumbra_testkit::environment::long;
use antumbra_testkit::flat::{FlatScene, GridPoint, orient2d};
use antumbra_testkit::random::Random;

use crate::rays::{first, grid, inside};
use crate::small::{build, build_within, random_cell};

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

/// Whether an isovist holds a point, by its winding; `None` if the point is next to its border.
fn holds(area: &Isovist, [x, y]: [f64; 2]) -> Option<bool> {
    let mut winding = 0;
    for ring in area.polygons.iter().flatten() {
        for (i, a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let turn = dx * (y - a[1]) - dy * (x - a[0]);
            let t = ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy);
            let t = t.clamp(0.0, 1.0);
            if (a[0] + t * dx - x).hypot(a[1] + t * dy - y) < 0.01 {
                return None;
            }
            if (a[1] <= y) != (b[1] <= y) && (turn > 0.0) == (dy > 0.0) {
                winding += if dy > 0.0 { 1 } else { -1 };
            }
        }
    }
    Some(winding != 0)
}

/// A point that is in line with no two corners lies in the isovist of a cell if the two see each other, and only then.
#[test]
fn isovists_hold_the_points_that_are_seen() {
    const SCALE: i64 = 101;
    let mut random = Random::new(22);
    let (mut seen, mut hidden) = (0, 0);
    for scene in 0..if long() { 4000 } else { 250 } {
        let size = [3, 5, 9][random.index(3)];
        let count = 1 + random.index(9);
        let mut p = || [0; 2].map(|_| SCALE * random.integer(-size, size));
        let mut segments: Vec<[GridPoint; 2]> = (0..count).map(|_| [p(), p()]).collect();
        let far = 12 * SCALE;
        segments.push([[-far, far], [far, far]]);
        segments.push([[-far, -far], [far, -far]]);
        let plan = build_within(4000.0, &segments, 1);
        let outline = random_cell(&mut random, size, scene % 4);
        let outline: Vec<[f64; 2]> = outline
            .iter()
            .map(|p| p.map(|v| v * SCALE as f64))
            .collect();
        let cell = PlanCell::new(&plan, &outline).expect("a cell");
        let area = isovist(&plan, &cell);
        let corners = cell.parts.iter().flat_map(|p| p.corners().to_vec());
        let ends: Vec<GridPoint> = plan
            .pieces()
            .iter()
            .flatten()
            .copied()
            .chain(corners)
            .map(grid)
            .collect();
        for _ in 0..40 {
            let place = [0; 2].map(|_| random.integer(-far, far));
            let in_line =
                |u: &GridPoint| ends.iter().any(|&v| *u != v && orient2d(*u, v, place) == 0);
            let place_f64 = place.map(|v| v as f64);
            let Some(held) = holds(&area, place_f64).filter(|_| !ends.iter().any(in_line)) else {
                continue;
            };
            let point = PlanCell::new(&plan, &[place_f64]).expect("a point");
            let sight = mutual(&plan, &cell, &point);
            assert_eq!(
                held,
                sight.is_some(),
                "{place:?} and {:?}, {segments:?}",
                cell.parts
            );
            seen += usize::from(held);
            hidden += usize::from(!held);
        }
    }
    assert!(seen > 1000 && hidden > 1000, "{seen} {hidden}");
}
