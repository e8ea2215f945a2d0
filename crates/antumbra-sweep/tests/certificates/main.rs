//! Certificates made by hand: the checker accepts what is right, and each kind of damage fails.

mod entries;

use antumbra_kernel::{Aabb, Point};
use antumbra_scene::{
    CellKind, Faces, ObjectId, ObjectInput, PartInput, PolygonId, Scene, SceneBuilder, SceneInput,
    ViewCell,
};
use antumbra_sweep::{
    Accuracy, CellProof, CheckReport, Claim, GateProof, Node, Reason, RowName, Target, Tree,
    VisibleEntry, check_cell,
};

const LEFT: u32 = 0;
const RIGHT: u32 = 1;
const BEHIND: u32 = 2;
const FRONT: u32 = 3;
const ASIDE: u32 = 4;
const PATCH: u32 = 5;
const POLE: u32 = 6;
const FIN: u32 = 7;

/// A cell of half width 10 between a wall of two halves at y = 50 and things at y = -100.
fn scene() -> Scene {
    let wall = |x0: f64, x1: f64| {
        vec![
            [x0, 50.0, -300.0],
            [x1, 50.0, -300.0],
            [x1, 50.0, 300.0],
            [x0, 50.0, 300.0],
        ]
    };
    let polygons = [
        wall(-300.0, 0.0),
        wall(0.0, 300.0),
        vec![[-8.0, 100.0, -9.0], [9.0, 100.0, -7.0], [1.0, 100.0, 8.0]],
        vec![
            [-50.0, -100.0, -50.0],
            [50.0, -100.0, -50.0],
            [0.0, -100.0, 50.0],
        ],
        vec![
            [-200.0, 100.0, 0.0],
            [-190.0, 110.0, 0.0],
            [-195.0, 105.0, 9.0],
        ],
        // In the plane of the cell's +x face, touching it.
        vec![[10.0, -5.0, -5.0], [10.0, 5.0, -5.0], [10.0, 0.0, 5.0]],
        // Its tip touches the y axis.
        vec![[0.0, -50.0, 0.0], [-4.0, -50.0, -9.0], [4.0, -50.0, -9.0]],
        // Edge-on for lines along y.
        vec![
            [3.0, -40.0, -3.0],
            [3.0, -60.0, -3.0],
            [3.0, -60.0, 2.0],
            [3.0, -40.0, 2.0],
        ],
    ];
    let objects = polygons
        .into_iter()
        .map(|vertices| {
            let mut faces = Faces::default();
            faces.push(&(0..vertices.len() as u32).collect::<Vec<_>>());
            let part = PartInput {
                vertices,
                faces,
                ..Default::default()
            };
            ObjectInput {
                name: None,
                parts: vec![part],
            }
        })
        .collect();
    let input = SceneInput {
        objects,
        source_name: "by hand".into(),
    };
    let scene = SceneBuilder::new(input)
        .grid(Some(1.0))
        .cells_box(Some(([-1000.0; 3], [1000.0; 3])))
        .build()
        .expect("a good scene")
        .0;
    assert_eq!(
        (scene.grid().origin(), scene.polygon_count()),
        ([0.0; 3], 8)
    );
    scene
}

fn cell() -> ViewCell {
    ViewCell {
        name: "c".into(),
        bounds: Aabb::new(Point::new(-10, -10, -10), Point::new(10, 10, 10)),
        kind: CellKind::Box,
    }
}

/// A report in which everything but some objects is left as unknown.
fn check(
    scene: &Scene,
    visible: &[VisibleEntry],
    hidden: &[u32],
    accuracy: Accuracy,
    proof: &[u8],
) -> CheckReport {
    let unknown: Vec<ObjectId> = (0..scene.objects().len() as u32)
        .filter(|id| !hidden.contains(id) && visible.iter().all(|v| v.object.0 != *id))
        .map(ObjectId)
        .collect();
    check_cell(scene, &cell(), visible, &unknown, accuracy, proof)
}

fn claim_report(scene: &Scene, hidden: u32, claims: Vec<Claim>) -> CheckReport {
    let proof = CellProof { claims }.to_bytes();
    check(scene, &[], &[hidden], Accuracy::Exact, &proof)
}

fn accepted(report: &CheckReport) -> bool {
    report.failed.is_empty()
}

fn fails(report: &CheckReport, what: &str) {
    assert!(
        report.failed.iter().any(|f| f.contains(what)),
        "not found: {what}; {:?}",
        report.failed
    );
}

fn covered(target: Target, by: u32) -> Vec<Claim> {
    let reason = Reason::Covered {
        polygon: PolygonId(by),
    };
    vec![Claim { target, reason }]
}

fn cuboid(min: [i32; 3], max: [i32; 3]) -> Target {
    Target::Box(Aabb::new(Point::from(min), Point::from(max)))
}

#[test]
fn one_occluder_covers() {
    let scene = scene();
    let aside = Target::Polygon(PolygonId(ASIDE));
    let report = claim_report(&scene, ASIDE, covered(aside, LEFT));
    assert_eq!(
        (report.hidden_checked, report.failed.len()),
        (1, 0),
        "{:?}",
        report.failed
    );
    fails(
        &claim_report(&scene, ASIDE, covered(aside, RIGHT)),
        "outside its edge",
    );
    fails(
        &claim_report(&scene, ASIDE, covered(aside, POLE)),
        "does not separate",
    );
    fails(
        &claim_report(&scene, ASIDE, covered(aside, 99)),
        "no polygon 99",
    );
    fails(
        &claim_report(&scene, ASIDE, Vec::new()),
        "object 4 \"4\" is listed neither",
    );
    // A claim about something else does not help.
    let other = covered(cuboid([-195, 100, 0], [-190, 105, 5]), LEFT);
    fails(
        &claim_report(&scene, ASIDE, other),
        "no valid claim hides its polygon 4",
    );
    // An enclosing box does; one that reaches the occluder's plane does not.
    let around = covered(cuboid([-200, 51, 0], [-190, 110, 9]), LEFT);
    assert!(accepted(&claim_report(&scene, ASIDE, around)));
    let flush = covered(cuboid([-200, 50, 0], [-190, 110, 9]), LEFT);
    fails(&claim_report(&scene, ASIDE, flush), "not strictly behind");
    let through = covered(cuboid([-200, 49, 0], [-190, 110, 9]), LEFT);
    fails(&claim_report(&scene, ASIDE, through), "does not separate");
}

/// The claim that both halves of the wall hide what is behind, cut at their common edge.
fn two_halves(scene: &Scene, target: Target) -> Claim {
    let corners = scene.polygon(PolygonId(LEFT)).corners;
    let n = corners.len();
    let edge = (0..n)
        .find(|&i| corners[i].x == 0 && corners[(i + 1) % n].x == 0)
        .expect("the halves share an edge");
    let normal = scene.polygon(PolygonId(LEFT)).plane.normal;
    let negative = normal[1] < 0;
    let blocked = |polygon| Node::Blocked {
        polygon: PolygonId(polygon),
        negative,
    };
    let row = RowName::Edge {
        polygon: PolygonId(LEFT),
        edge: edge as u32,
    };
    let nodes = vec![Node::Split { row, negative }, blocked(LEFT), blocked(RIGHT)];
    let number = match target {
        Target::Box(_) => 2,
        Target::Polygon(id) => u32::from(scene.polygon(id).plane.normal[1] < 0),
    };
    let gate = GateProof {
        source: 3,
        target: number,
        tree: Tree { nodes },
    };
    Claim {
        target,
        reason: Reason::Gates(vec![gate]),
    }
}

fn targets() -> [Target; 2] {
    [
        Target::Polygon(PolygonId(BEHIND)),
        cuboid([-10, 90, -10], [10, 120, 10]),
    ]
}

#[test]
fn two_occluders_hide_together() {
    let scene = scene();
    for target in targets() {
        let report = claim_report(&scene, BEHIND, vec![two_halves(&scene, target)]);
        assert_eq!(
            (report.hidden_checked, report.failed.len()),
            (1, 0),
            "{:?}",
            report.failed
        );
    }
}

/// A right claim with something changed in its only gate.
fn damaged(scene: &Scene, target: Target, change: impl Fn(&mut GateProof)) -> CheckReport {
    let mut claim = two_halves(scene, target);
    let Reason::Gates(gates) = &mut claim.reason else {
        unreachable!("made of gates");
    };
    change(&mut gates[0]);
    claim_report(scene, BEHIND, vec![claim])
}

#[test]
fn damaged_trees_fail() {
    let scene = scene();
    for target in targets() {
        let node =
            |at: usize, node: Node| damaged(&scene, target, |gate| gate.tree.nodes[at] = node);
        let turned = |at: usize| {
            damaged(&scene, target, |gate| match &mut gate.tree.nodes[at] {
                Node::Split { negative, .. } | Node::Blocked { negative, .. } => *negative ^= true,
                _ => {}
            })
        };
        fails(&turned(0), "some pass outside its edge");
        fails(&turned(1), "in this direction");
        fails(&turned(2), "in this direction");
        fails(&node(1, Node::Imaginary), "holds an open set of real lines");
        fails(&node(2, Node::Imaginary), "holds an open set of real lines");
        fails(&node(1, Node::Ignored), "was not allowed");
        let blocked = |polygon| Node::Blocked {
            polygon: PolygonId(polygon),
            negative: false,
        };
        fails(
            &node(1, blocked(FRONT)),
            "node 1: polygon 3 lies behind the source gate",
        );
        fails(&node(1, blocked(77)), "no polygon 77");
        let swapped = damaged(&scene, target, |gate| gate.tree.nodes.swap(1, 2));
        fails(&swapped, "some pass outside its edge");
        let short = damaged(&scene, target, |gate| {
            gate.tree.nodes.remove(0);
            gate.tree.nodes.truncate(1);
        });
        fails(&short, "some pass outside its edge");
        // Dropped and repeated nodes shift everything behind them.
        fails(
            &damaged(&scene, target, |g| g.tree.nodes.truncate(2)),
            "of the certificate",
        );
        let again = damaged(&scene, target, |g| g.tree.nodes.push(Node::Imaginary));
        fails(&again, "of the certificate");
        let edge = |edge| Node::Split {
            row: RowName::Edge {
                polygon: PolygonId(LEFT),
                edge,
            },
            negative: false,
        };
        fails(&node(0, edge(4)), "has no edge 4");
        let chord = RowName::Chord { from: 9, to: 0 };
        fails(
            &node(
                0,
                Node::Split {
                    row: chord,
                    negative: false,
                },
            ),
            "no corners 9 and 0",
        );
        let flat = RowName::SourceLine {
            polygon: PolygonId(RIGHT),
        };
        fails(
            &node(
                0,
                Node::Split {
                    row: flat,
                    negative: true,
                },
            ),
            "outside",
        );
    }
}

#[test]
fn damaged_gates_fail() {
    let scene = scene();
    for target in targets() {
        fails(
            &damaged(&scene, target, |g| g.source = 0),
            "no tree for them",
        );
        fails(
            &damaged(&scene, target, |g| g.source = 6),
            "no source gate 6",
        );
        fails(
            &damaged(&scene, target, |g| g.target = 7),
            "no target gate 7",
        );
        let claim = Claim {
            target,
            reason: Reason::Gates(Vec::new()),
        };
        fails(
            &claim_report(&scene, BEHIND, vec![claim]),
            "no tree for them",
        );
    }
    let gates = |target| {
        vec![Claim {
            target,
            reason: Reason::Gates(Vec::new()),
        }]
    };
    // Lines could start inside these boxes.
    for max in [[20, 200, 20], [10, 200, 10]] {
        let around = gates(cuboid([-10, -10, -10], max));
        fails(&claim_report(&scene, BEHIND, around), "meets the cell");
    }
    let beside = gates(cuboid([-10, 10, -10], [10, 200, 10]));
    fails(&claim_report(&scene, BEHIND, beside), "meets the cell");
    // Beyond the wall the same tree holds, before it not.
    let near = two_halves(&scene, cuboid([-10, 40, -10], [10, 120, 10]));
    fails(
        &claim_report(&scene, BEHIND, vec![near]),
        "beyond the target gate",
    );
    let mut unknown = two_halves(&scene, Target::Polygon(PolygonId(BEHIND)));
    unknown.target = Target::Polygon(PolygonId(99));
    let report = claim_report(&scene, BEHIND, vec![unknown]);
    fails(&report, "no polygon 99");
}

#[test]
fn ignoring_must_be_allowed() {
    let scene = scene();
    let mut claim = two_halves(&scene, Target::Polygon(PolygonId(BEHIND)));
    if let Reason::Gates(gates) = &mut claim.reason {
        gates[0].tree.nodes[2] = Node::Ignored;
    }
    let proof = CellProof {
        claims: vec![claim],
    }
    .to_bytes();
    let report = |accuracy| check(&scene, &[], &[BEHIND], accuracy, &proof);
    assert!(accepted(&report(Accuracy::AggressiveBelow(0.1))));
    fails(&report(Accuracy::Conservative), "was not allowed");
}

#[test]
fn damaged_bytes_fail() {
    let scene = scene();
    let claim = two_halves(&scene, Target::Polygon(PolygonId(BEHIND)));
    let good = CellProof {
        claims: vec![claim],
    }
    .to_bytes();
    let report = |bytes: &[u8]| check(&scene, &[], &[BEHIND], Accuracy::Exact, bytes);
    assert!(accepted(&report(&good)));
    for at in 0..good.len() {
        assert!(!accepted(&report(&good[..at])), "{at} bytes");
        for bit in 0..8 {
            let mut bytes = good.clone();
            bytes[at] ^= 1 << bit;
            assert!(!accepted(&report(&bytes)), "byte {at}, bit {bit}");
        }
    }
}

fn triangle_scene(triangles: &[[[f64; 3]; 3]]) -> Scene {
    let objects = triangles
        .iter()
        .map(|t| {
            let part = PartInput {
                vertices: t.to_vec(),
                faces: [[0, 1, 2]].into_iter().collect(),
                ..Default::default()
            };
            ObjectInput {
                name: None,
                parts: vec![part],
            }
        })
        .collect();
    let input = SceneInput {
        objects,
        source_name: "by hand".into(),
    };
    let (scene, _) = SceneBuilder::new(input)
        .grid(Some(1.0))
        .build()
        .expect("a good scene");
    scene
}

/// From S to R some lines pass O and some do not, though one edge of O has them all outside: its
/// plane does not separate them.
#[test]
fn without_separation_nothing_is_covered() {
    let triangles = [
        [[-3.0, 5.0, 0.0], [1.0, -4.0, 0.0], [3.0, 3.0, 0.0]],
        [[-5.0, -3.0, 10.0], [-1.0, 5.0, 10.0], [-1.0, 3.0, 10.0]],
        [[0.0, -1.0, 5.0], [0.0, 1.0, 5.0], [0.0, 0.0, 6.0]],
    ];
    let scene = triangle_scene(&triangles);
    let bounds = scene.object_bounds(ObjectId(0)).expect("a polygon");
    let cell = ViewCell {
        name: "s".into(),
        bounds,
        kind: CellKind::Object(ObjectId(0)),
    };
    let claims = covered(Target::Polygon(PolygonId(1)), 2);
    let proof = CellProof { claims }.to_bytes();
    let report = check_cell(&scene, &cell, &[], &[ObjectId(2)], Accuracy::Exact, &proof);
    fails(&report, "does not separate");
}

/// The occluder has a corner in front of the source's plane and one before the target's, but no
/// part between both. The rows that are left then hold for all lines, and none meets it.
#[test]
fn an_occluder_without_a_part_in_between_blocks_nothing() {
    let scene = triangle_scene(&[
        [
            [3987.0, 95.0, 2291.0],
            [3997.0, 95.0, 2321.0],
            [3987.0, 105.0, 2431.0],
        ],
        [
            [-2752.0, 3581.0, 4155.0],
            [-2733.0, 3581.0, 4158.0],
            [-2752.0, 3600.0, 4176.0],
        ],
        [
            [-6000.0, -5000.0, -5000.0],
            [2000.0, 0.0, -6000.0],
            [-2000.0, -2000.0, -3000.0],
        ],
    ]);
    let bounds = scene.object_bounds(ObjectId(0)).expect("a polygon");
    let cell = ViewCell {
        name: "s".into(),
        bounds,
        kind: CellKind::Object(ObjectId(0)),
    };
    let mut found = 0;
    for negative in [false, true] {
        let polygon = PolygonId(2);
        let gate = |n: u32| GateProof {
            source: n / 2,
            target: n % 2,
            tree: Tree {
                nodes: vec![Node::Blocked { polygon, negative }],
            },
        };
        let target = Target::Polygon(PolygonId(1));
        let reason = Reason::Gates((0..4).map(gate).collect());
        let claims = vec![Claim { target, reason }];
        let proof = CellProof { claims }.to_bytes();
        let report = check_cell(&scene, &cell, &[], &[ObjectId(2)], Accuracy::Exact, &proof);
        assert_eq!(report.hidden_checked, 0);
        found += report
            .failed
            .iter()
            .filter(|f| f.contains("has no part"))
            .count();
    }
    assert!(found > 0);
}
