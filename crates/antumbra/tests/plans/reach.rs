//! A reach leaves out pieces that are beyond it as a whole, whatever the kD-tree, and nothing that is nearer.

use antumbra::plan::{Accuracy, PieceId, PlanCell, PlanView, SeeOptions, look};
use antumbra_testkit::random::Random;

use crate::small::{build, random_cell, same};

fn fragments(view: &PlanView, piece: PieceId) -> Vec<[f64; 2]> {
    let of = view.fragments.iter().filter(|f| f.piece == piece);
    of.map(|f| [f.at[0].value(), f.at[1].value()]).collect()
}

#[test]
fn what_is_within_reach_is_seen_as_without_one() {
    let mut random = Random::new(11);
    let (mut left_out, mut exact, mut longer) = (0, 0, 0);
    for round in 0..400 {
        // Every other scene is of short segments, which seldom go on beyond the reach.
        let size = if round % 8 < 4 { 20 } else { 3 };
        let mut segment = || {
            let middle = [0; 2].map(|_| random.integer(-20 + size / 2, 20 - size / 2));
            [0; 2].map(|_| middle.map(|m| (m + random.integer(-size, size)).clamp(-20, 20)))
        };
        let segments: Vec<_> = (0..8).map(|_| segment()).collect();
        let outline = random_cell(&mut random, 6, round % 4);
        let reach = random.integer(1, 16) as u64;
        let plans = [1, 3, 100].map(|leaf| build(&segments, leaf));
        let views = plans.each_ref().map(|plan| {
            let cell = PlanCell::new(plan, &outline).expect("a good cell");
            let options = SeeOptions {
                reach: Some(reach),
                ..SeeOptions::default()
            };
            let all = look(plan, &cell.parts[0], &SeeOptions::default());
            (look(plan, &cell.parts[0], &options), all)
        });
        for (near, _) in &views[1..] {
            same(near, &views[0].0);
        }
        let (near, all) = &views[0];
        let from = near.cell.bounds();
        for (i, &ends) in plans[0].pieces().iter().enumerate() {
            let piece = PieceId(i as u32);
            let (cut, whole) = (fragments(near, piece), fragments(all, piece));
            if from.is_beyond(reach, ends) {
                assert!(cut.is_empty(), "{segments:?} {outline:?} {reach}");
                left_out += usize::from(!whole.is_empty());
                continue;
            }
            let held = |f: &[f64; 2]| cut.iter().any(|c| c[0] <= f[0] && f[1] <= c[1]);
            assert!(whole.iter().all(held), "{segments:?} {outline:?} {reach}");
            longer += usize::from(cut != whole);
            if near.accuracy == Accuracy::Exact {
                assert_eq!(cut, whole, "{segments:?} {outline:?} {reach}");
                exact += 1;
            }
        }
    }
    assert!(
        left_out > 100 && exact > 50 && longer > 10,
        "{left_out} {exact} {longer}"
    );
}
