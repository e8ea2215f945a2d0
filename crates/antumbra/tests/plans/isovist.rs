//! The area that a cell sees: its form, its measures, and its points against what sees the cell.

use std::collections::HashSet;

use antumbra::plan::{
    Isovist, Plan, PlanCell, PlanInput, PlanOptions, PlanSegment, isovist, mutual,
};
use antumbra_sweep::plan::{Outlines, Tile, frame, tiles, union};
use antumbra_testkit::environment::long;
use antumbra_testkit::flat::{GridPoint, orient2d};
use antumbra_testkit::random::Random;

use crate::rays::grid;
use crate::small::{build, build_within, random_cell};

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

fn plan(segments: &[[[f64; 2]; 2]], options: &PlanOptions) -> Plan {
    let segments = segments.iter().map(|&ends| PlanSegment {
        ends,
        class: 0,
        feature: 0,
    });
    let input = PlanInput {
        segments: segments.collect(),
        classes: vec![String::new()],
        ..PlanInput::default()
    };
    Plan::build(&input, options).expect("good input")
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 0.01, "{found} for {expected}");
}

/// On several grids: what tempts to look behind the wall is a tile that is next to nothing wide.
#[test]
fn a_thin_tile_does_not_open_the_view_behind_a_wall() {
    let walls = [
        [[11.0, 17.0], [39.0, 39.0]],
        [[19.0, 24.0], [28.0, 24.0]],
        [[24.0, 12.0], [0.0, 37.0]],
    ];
    let triangle = [[11.0, 17.0], [26.0, 13.0], [17.0, 6.0]];
    for grid in [0.001, 1.0 / 2048.0, 1.0 / 65_536.0] {
        let options = PlanOptions {
            grid: Some(grid),
            around: Some(([0.0; 2], [40.0; 2])),
            ..PlanOptions::default()
        };
        let plan = plan(&walls, &options);
        let cell = PlanCell::new(&plan, &triangle).expect("a cell");
        let area = isovist(&plan, &cell);
        assert_eq!(
            holds(&area, [25.0, 26.0]),
            Some(false),
            "behind the second wall"
        );
        assert_eq!(holds(&area, [25.0, 23.0]), Some(true));
        // The margin of the box is whole steps wide; the triangle behind the wall has 30 square units.
        assert!((area.area - 882.05).abs() < 0.1, "{}", area.area);
        form(&area.polygons);
    }
}

#[test]
fn the_view_from_a_point_has_no_slit() {
    let plan = build_within(4000.0, &[[[0, 200], [0, 300]]], 1);
    let cell = PlanCell::new(&plan, &[[1200.0, 1000.0]]).expect("a point");
    let area = isovist(&plan, &cell);
    form(&area.polygons);
    // The box is 1200 by 800, and 19 wider on all sides; the wall's shadow is a quadrangle beyond it.
    assert_eq!(area.polygons[0][0].len(), 8);
    let shadow = [200.0 - 19.0 * 8.0 / 12.0, 300.0 - 19.0 * 7.0 / 12.0];
    let sides = [0, 1].map(|k| 19.0_f64.hypot([200.0, 300.0][k] - shadow[k]));
    let gap = shadow[1] - shadow[0];
    near(
        area.perimeter,
        2.0 * (1238.0 + 838.0) - gap + 100.0 + sides[0] + sides[1],
    );
    near(area.area, 1238.0 * 838.0 - 19.0 * (gap + 100.0) / 2.0);
}

/// However a cell is cut into convex parts, there is one box, and segments without length are in it.
#[test]
fn the_box_is_around_the_plan_and_all_of_the_cell() {
    let options = PlanOptions {
        grid: Some(1.0),
        around: Some(([-1000.0; 2], [1000.0; 2])),
        ..PlanOptions::default()
    };
    let plan = plan(&[[[0.0, 0.0], [10.0, 0.0]], [[500.0; 2]; 2]], &options);
    let angle = [
        [100.0, 100.0],
        [400.0, 100.0],
        [400.0, 200.0],
        [200.0, 200.0],
        [200.0, 640.0],
        [100.0, 640.0],
    ];
    let cell = PlanCell::new(&plan, &angle).expect("a cell");
    assert!(cell.parts.len() > 1);
    let area = isovist(&plan, &cell);
    form(&area.polygons);
    let ring = &area.polygons[0][0];
    for corner in [[511.0, -11.0], [511.0, 651.0], [-11.0, 651.0]] {
        assert!(ring.contains(&corner), "{ring:?}");
    }
    near(area.depth, 261.0_f64.hypot(381.0));
}

/// Outlines are counter-clockwise and holes are not; no ring passes a corner twice, no edge is passed both ways, and
/// polygons hang together, if only by corners.
fn form(polygons: &[Outlines]) {
    let mut passed = HashSet::new();
    let bits = |p: [f64; 2]| p.map(f64::to_bits);
    for rings in polygons {
        for (k, ring) in rings.iter().enumerate() {
            let corners: HashSet<_> = ring.iter().map(|&p| bits(p)).collect();
            assert_eq!(corners.len(), ring.len(), "{ring:?}");
            assert!(if k == 0 {
                turning(ring) > 0.0
            } else {
                turning(ring) < 0.0
            });
            let next = |i: usize| ring[(i + 1) % ring.len()];
            passed.extend((0..ring.len()).map(|i| [bits(ring[i]), bits(next(i))]));
        }
    }
    assert!(
        passed.iter().all(|&[p, q]| !passed.contains(&[q, p])),
        "a slit in {polygons:?}"
    );
    let corners = |rings: &Outlines| rings.iter().flatten().map(|&p| bits(p)).collect();
    let mut apart: Vec<HashSet<_>> = polygons.iter().map(corners).collect();
    let mut whole = apart.pop().expect("a polygon");
    while let Some(i) = apart.iter().position(|c| !c.is_disjoint(&whole)) {
        whole.extend(apart.swap_remove(i));
    }
    assert!(apart.is_empty(), "several pieces: {polygons:?}");
}

/// Twice the area of a ring.
fn turning(ring: &[[f64; 2]]) -> f64 {
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    let [x, y] = ring[0];
    pairs
        .map(|(p, q)| (p[0] - x) * (q[1] - y) - (p[1] - y) * (q[0] - x))
        .sum()
}

fn area_of(polygons: &[Outlines]) -> f64 {
    polygons
        .iter()
        .flatten()
        .map(|ring| turning(ring) / 2.0)
        .sum()
}

/// The union of the tiles of a convex cell: its form; no larger than they are together, no smaller than each, and what is
/// added twice changes nothing. The tiles of a point do not overlap.
#[test]
fn tiles_make_one_area() {
    let mut random = Random::new(23);
    let mut overlapped = 0;
    for scene in 0..if long() { 20_000 } else { 1500 } {
        let size = [3, 5, 9, 40][random.index(4)];
        let count = 1 + random.index(9);
        let mut p = || [0; 2].map(|_| random.integer(-size, size));
        let segments: Vec<[GridPoint; 2]> = (0..count).map(|_| [p(), p()]).collect();
        let plan = build(&segments, 1);
        let outline = random_cell(&mut random, size, scene % 4);
        let cell = PlanCell::new(&plan, &outline).expect("a cell");
        let part = &cell.parts[0];
        let mut all = tiles(&plan, part, &frame(&plan, &cell.parts));
        all.extend(Tile::region(part));
        let polygons = union(&all);
        form(&polygons);
        let whole = area_of(&polygons);
        let each: Vec<f64> = all
            .iter()
            .map(|t| area_of(&union(std::slice::from_ref(t))))
            .collect();
        let sum: f64 = each.iter().sum();
        assert!(whole < sum * (1.0 + 1e-9), "{segments:?} {part:?}");
        assert!(
            each.iter()
                .all(|&one| 0.0 < one && one < whole * (1.0 + 1e-9))
        );
        if outline.len() == 1 {
            assert!((whole - sum).abs() < 1e-9 * sum, "{segments:?} {part:?}");
        } else {
            overlapped += usize::from(whole < sum * 0.999);
        }
        all.extend(all.clone().into_iter().rev());
        assert!((area_of(&union(&all)) - whole).abs() < 1e-9 * whole);
    }
    assert!(overlapped > 300, "{overlapped}");
}

/// The same place on other grids, as in a list with other cells, looks the same up to what snapping moves.
#[test]
fn an_isovist_does_not_depend_on_the_rest_of_a_list() {
    let mut random = Random::new(24);
    for scene in 0..if long() { 5000 } else { 400 } {
        let count = 1 + random.index(9);
        let mut p = || [0; 2].map(|_| random.integer(0, 40) as f64);
        let segments: Vec<[[f64; 2]; 2]> = (0..count).map(|_| [p(), p()]).collect();
        let outline: Vec<[f64; 2]> = random_cell(&mut random, 20, scene % 4)
            .into_iter()
            .map(|p| p.map(|v| v + 20.0))
            .collect();
        let found = [[-5.0, 45.0], [-40.0, 90.0], [0.0, 131.0]].map(|[low, high]| {
            let options = PlanOptions {
                around: Some(([low; 2], [high; 2])),
                ..PlanOptions::default()
            };
            let plan = plan(&segments, &options);
            let cell = PlanCell::new(&plan, &outline).expect("a cell");
            isovist(&plan, &cell)
        });
        for other in &found[1..] {
            let same = |a: f64, b: f64| (a - b).abs() < 0.02;
            assert!(
                same(found[0].area, other.area) && same(found[0].perimeter, other.perimeter),
                "{segments:?} {outline:?}: {} {}",
                found[0].area,
                other.area
            );
        }
    }
}
