//! Visible entries and labels: every witness is decided exactly.

use antumbra_scene::{CellKind, ObjectId, PolygonId};
use antumbra_sweep::{
    Accuracy, CellProof, CheckReport, Claim, FinePoint, Reason, Target, VisibleEntry, Witness,
    check_cell,
};

use super::{BEHIND, FIN, FRONT, PATCH, accepted, cell, check, claim_report, fails, scene};

fn fine(p: [f64; 3]) -> FinePoint {
    FinePoint::round(p)
}

fn seen(object: u32, gate: u32, from: [f64; 3], through: [f64; 3]) -> CheckReport {
    let witness = Witness {
        from: fine(from),
        through: fine(through),
        polygon: PolygonId(object),
        source: gate,
    };
    let entry = VisibleEntry {
        object: ObjectId(object),
        touching: false,
        witness: Some(witness),
    };
    check(
        &scene(),
        &[entry],
        &[],
        Accuracy::Exact,
        &CellProof::default().to_bytes(),
    )
}

#[test]
fn witnesses_are_checked_exactly() {
    let step = 1.0 / 65536.0;
    let good = seen(FRONT, 2, [0.0, -10.0, 5.0], [0.0, -100.0, 5.0]);
    assert_eq!(
        (good.visible_checked, good.failed.len()),
        (1, 0),
        "{:?}",
        good.failed
    );
    // The second point need not lie on the polygon.
    assert!(accepted(&seen(
        FRONT,
        2,
        [0.0, -10.0, 5.0],
        [0.0, -11.0, 5.0]
    )));

    let front = |from, through| seen(FRONT, 2, from, through);
    // The tip of the pole touches the y axis; one step beside it is free.
    fails(
        &front([0.0, -10.0, 0.0], [0.0, -100.0, 0.0]),
        "polygon 6 is in the way",
    );
    assert!(accepted(&front([0.0, -10.0, step], [0.0, -100.0, step])));
    // The fin is stopped in its plane as far as it reaches, borders included.
    fails(
        &front([3.0, -10.0, 1.0], [3.0, -100.0, 1.0]),
        "polygon 7 is in the way",
    );
    fails(
        &front([3.0, -10.0, 2.0], [3.0, -100.0, 2.0]),
        "polygon 7 is in the way",
    );
    assert!(accepted(&front(
        [3.0, -10.0, 2.0 + step],
        [3.0, -100.0, 2.0 + step]
    )));
    // On the gate's edge, inside the cell, on the polygon's edge, beside it, backwards.
    fails(
        &front([10.0, -10.0, 5.0], [0.0, -100.0, 5.0]),
        "interior of source gate 2",
    );
    fails(
        &front([0.0, -9.0, 5.0], [0.0, -100.0, 5.0]),
        "not on source gate 2",
    );
    fails(
        &front([0.0, -10.0, 5.0], [0.0, -100.0, 50.0]),
        "interior of polygon 3",
    );
    fails(
        &front([0.0, -10.0, 5.0], [0.0, -100.0, 60.0]),
        "interior of polygon 3",
    );
    fails(
        &front([0.0, -10.0, 5.0], [0.0, 100.0, 5.0]),
        "interior of source gate 2",
    );
    fails(&front([0.0, -10.0, 5.0], [0.0, -10.0, 5.0]), "coincide");
    fails(
        &seen(FRONT, 9, [0.0, -10.0, 5.0], [0.0, -100.0, 5.0]),
        "no source gate 9",
    );
    // Through the wall, and through the seam of its halves.
    fails(
        &seen(BEHIND, 3, [1.0, 10.0, 0.0], [1.0, 100.0, 0.0]),
        "is in the way",
    );
    fails(
        &seen(BEHIND, 3, [0.0, 10.0, 0.0], [0.0, 100.0, 0.0]),
        "is in the way",
    );
    // The polygon lies behind the source.
    fails(
        &seen(FRONT, 3, [0.0, 10.0, 5.0], [0.0, 100.0, 5.0]),
        "does not come after",
    );
}

#[test]
fn other_entries_are_checked() {
    let scene = scene();
    let none = CellProof::default().to_bytes();
    let entry = |object, touching, witness| VisibleEntry {
        object: ObjectId(object),
        touching,
        witness,
    };
    let report = |entry| check(&scene, &[entry], &[], Accuracy::Exact, &none);
    assert!(accepted(&report(entry(PATCH, true, None))));
    fails(&report(entry(FRONT, true, None)), "does not touch");
    fails(&report(entry(FRONT, false, None)), "no witness");
    fails(&report(entry(50, true, None)), "not in the scene");
    let witness = Witness {
        from: fine([0.0, -10.0, 5.0]),
        through: fine([0.0, -100.0, 5.0]),
        polygon: PolygonId(FRONT),
        source: 2,
    };
    fails(&report(entry(FIN, false, Some(witness))), "not its own");
    let stranger = check_cell(&scene, &cell(), &[], &[ObjectId(8)], Accuracy::Exact, &none);
    fails(&stranger, "unknown object 8");
    // No line leaves the cell and reaches a polygon in the plane of its face, but it touches.
    let claim = Claim {
        target: Target::Polygon(PolygonId(PATCH)),
        reason: Reason::Gates(Vec::new()),
    };
    fails(
        &claim_report(&scene, PATCH, vec![claim]),
        "touches the cell but is not listed",
    );
}

#[test]
fn an_entered_cell_is_not_exact() {
    let scene = scene();
    let mut cell = cell();
    cell.bounds.max.y = 51;
    let all: Vec<ObjectId> = (0..8).map(ObjectId).collect();
    let none = CellProof::default().to_bytes();
    let report = |accuracy| check_cell(&scene, &cell, &[], &all, accuracy, &none);
    fails(&report(Accuracy::Exact), "labelled exact");
    assert!(accepted(&report(Accuracy::Conservative)));
    cell.kind = CellKind::Object(ObjectId(8));
    let report = check_cell(&scene, &cell, &[], &all, Accuracy::Exact, &none);
    fails(&report, "source object is not in the scene");
}
