//! Small plans whose answers are known.

use antumbra::plan::{Accuracy, Plan, PlanCell, SeeOptions, Seen, see};
use antumbra_testkit::flat::GridPoint;

use crate::small::{build, build_within};

fn seen(plan: &Plan, outline: &[[f64; 2]]) -> Seen {
    let cell = PlanCell::new(plan, outline).expect("a good cell");
    see(plan, &cell, &SeeOptions::default())
}

/// All ways to write an outline: from every corner, both ways round.
fn writings(outline: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let mut out = Vec::new();
    let mut ring = outline.to_vec();
    for _ in 0..2 {
        for _ in 0..ring.len() {
            ring.rotate_left(1);
            out.push(ring.clone());
        }
        ring.reverse();
    }
    out
}

/// Whether a wall is inside an L does not depend on where the L is cut.
#[test]
fn cells_are_entered_as_a_whole() {
    let outline = [
        [0., 0.],
        [2., 0.],
        [2., 1.],
        [1., 1.],
        [1., 2.],
        [0., 2.],
        [0., 1.],
    ];
    let cases: [(GridPoint, GridPoint, Accuracy); 9] = [
        // Along possible cuts.
        ([0, 1], [1, 1], Accuracy::Conservative),
        ([1, 1], [0, 0], Accuracy::Conservative),
        ([-1, 1], [3, 1], Accuracy::Conservative),
        ([1, 0], [1, 1], Accuracy::Conservative),
        ([0, 2], [1, 1], Accuracy::Conservative),
        // Along the outline, and up to it.
        ([1, 1], [2, 1], Accuracy::Exact),
        ([1, 2], [1, 1], Accuracy::Exact),
        ([1, 1], [2, 2], Accuracy::Exact),
        ([0, 3], [3, 0], Accuracy::Exact),
    ];
    for (a, b, accuracy) in cases {
        let plan = build(&[[a, b]], 4);
        for outline in writings(&outline) {
            let found = seen(&plan, &outline).accuracy;
            assert_eq!(found, accuracy, "{a:?} {b:?} {outline:?}");
        }
    }
    let plan = build(&[[[0, 2], [1, 3]]], 4);
    let outline = [[0., 2.], [3., 2.], [3., 3.], [1., 3.], [1., 4.], [0., 4.]];
    for outline in writings(&outline) {
        assert_eq!(seen(&plan, &outline).accuracy, Accuracy::Conservative);
    }
}

/// Ends on segments that a corner splits: a third of one half is a sixth of the whole.
#[test]
fn ends_are_the_doubles_nearest_to_their_fractions() {
    let square = |x: f64, y: f64| [[x, y], [x + 3., y], [x + 3., y + 3.], [x, y + 3.]];
    let plan = build(&[[[3, 0], [3, 3]], [[4, 5], [3, 1]]], 4);
    let found = seen(&plan, &square(5., 5.));
    assert_eq!(found.segments[0].fragments, [[0., 1. / 3.], [2. / 3., 1.]]);
    let walls = [
        [[6, 5], [6, 5]],
        [[6, 1], [5, 0]],
        [[5, 0], [3, 4]],
        [[5, 0], [2, 1]],
        [[6, 0], [1, 0]],
    ];
    let plan = build(&walls, 4);
    let ends = [
        ([0., 2.], [2. / 5., 1.]),
        ([1., 4.], [11. / 15., 1.]),
        ([7., 4.], [0., 1. / 15.]),
        ([7., 5.], [0., 1. / 20.]),
        ([7., 6.], [0., 1. / 25.]),
    ];
    for (eye, fragment) in ends {
        let found = seen(&plan, &[eye]);
        let last = found.segments.iter().find(|s| s.segment.0 == 4);
        assert_eq!(last.expect("seen").fragments, [fragment], "{eye:?}");
    }
}

/// A gap of 3e-20 of a segment is a gap, though doubles cannot show it.
#[test]
fn fragments_end_where_fractions_say() {
    const FAR: i64 = 8_388_000;
    let walls = [
        [[-FAR, -FAR], [-FAR, 1 - FAR]],
        [[-1, 0], [-1, 1]],
        [[-2_796_000, 0], [1, 1]],
        [[-FAR, -1], [1, FAR - 1]],
    ];
    let plan = build_within(FAR as f64, &walls, 4);
    let found = seen(&plan, &[[0., 8_388_000.], [0., 2_396_571.]]);
    let two = found
        .segments
        .iter()
        .find(|s| s.segment.0 == 2)
        .expect("seen");
    let [[start, left], [right, end]] = two.fragments[..] else {
        panic!("{:?}", two.fragments);
    };
    assert_eq!([start, end], [0., 1.]);
    assert!(left <= right && right - left < 1e-15);
}
