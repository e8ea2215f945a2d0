//! Segments of classes that block nothing: they are in no tree, and still seen in part.

use antumbra::plan::{
    CellShape, Plan, PlanCell, PlanInput, PlanOptions, PlanSegment, SeeOptions, look, see,
};
use antumbra::scene::OccluderPolicy;
use antumbra_testkit::environment::long;
use antumbra_testkit::flat::GridPoint;
use antumbra_testkit::random::Random;

use crate::small::{certificate, random_cell, same, ways};

/// A plan of walls, and of glass, which does not block.
fn build(segments: &[([GridPoint; 2], bool)], leaf: usize) -> Plan {
    let segments = segments.iter().map(|&(ends, wall)| PlanSegment {
        ends: ends.map(|p| p.map(|v| v as f64)),
        class: u32::from(wall),
        feature: 0,
    });
    let input = PlanInput {
        segments: segments.collect(),
        classes: vec!["glass".to_owned(), "wall".to_owned()],
        ..PlanInput::default()
    };
    let options = PlanOptions {
        grid: Some(1.0),
        around: Some(([-40.0; 2], [40.0; 2])),
        policy: OccluderPolicy::Only(vec!["wall".to_owned()]),
        leaf,
    };
    Plan::build(&input, &options).expect("good input")
}

/// A wall crosses a pane: what is seen of the pane ends there, on lines on which the wall is in front of one part
/// of it and behind the other.
#[test]
fn certificates_hold_where_a_wall_crosses_glass() {
    let plan = build(&[([[0, 4], [2, 3]], true), ([[1, 2], [1, 4]], false)], 1);
    let cell = PlanCell::new(&plan, &[[1.0, 1.0], [2.0, 1.0]]).expect("a good cell");
    let seen = see(&plan, &cell, &SeeOptions::default());
    assert_eq!(seen.segments[1].fragments, [[0.0, 0.75]]);
    certificate(&plan, &cell.parts[0], &mut Random::new(1));
}

#[test]
fn certificates_of_walls_and_glass_hold_and_altered_ones_do_not() {
    let mut random = Random::new(21);
    let mut panes = 0;
    for scene in 0..if long() { 6000 } else { 600 } {
        let size = [2, 3, 5][random.index(3)];
        let mut p = || [random.integer(-size, size), random.integer(-size, size)];
        let ends: Vec<[GridPoint; 2]> = (0..9).map(|_| [p(), p()]).collect();
        let segments: Vec<_> = ends.iter().map(|&e| (e, random.index(2) == 0)).collect();
        if ends.iter().all(|s| s[0] == s[1]) {
            continue;
        }
        let plan = build(&segments, 1);
        let outline = random_cell(&mut random, size, 1 + scene % 3);
        let Ok(cell) = PlanCell::new(&plan, &outline) else {
            continue;
        };
        for shape in &cell.parts {
            let view = look(&plan, shape, &SeeOptions::default());
            panes += view
                .fragments
                .iter()
                .filter(|f| !plan.occludes(f.piece))
                .count();
            certificate(&plan, shape, &mut random);
            if matches!(shape, CellShape::Region(_)) {
                for way in ways() {
                    same(&view, &look(&plan, shape, &way));
                }
            }
        }
    }
    assert!(panes > 1000, "only {panes} fragments of panes");
}
