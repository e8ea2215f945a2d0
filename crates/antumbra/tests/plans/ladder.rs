//! The dimension ladder: a plan, extruded to the height of the cell, has the same verdicts in space.

use antumbra::plan::{Accuracy, PlanCell, SeeOptions, see};
use antumbra::region::{BakeOptions, Baker};
use antumbra::scene::{
    CellSpec, Faces, NamedBox, ObjectInput, PartInput, SceneBuilder, SceneInput, make_cells,
};
use antumbra_testkit::environment::long;
use antumbra_testkit::flat::GridPoint;
use antumbra_testkit::random::Random;

use crate::small::build;

const HEIGHT: f64 = 8.0;

fn extruded(segments: &[[GridPoint; 2]]) -> SceneInput {
    let object = |s: &[GridPoint; 2]| {
        let [p, q] = s.map(|p| p.map(|v| v as f64));
        let mut faces = Faces::default();
        faces.push(&[0, 1, 2, 3]);
        ObjectInput {
            name: None,
            parts: vec![PartInput {
                vertices: vec![
                    [p[0], p[1], 0.0],
                    [q[0], q[1], 0.0],
                    [q[0], q[1], HEIGHT],
                    [p[0], p[1], HEIGHT],
                ],
                faces,
                ..PartInput::default()
            }],
        }
    };
    SceneInput {
        objects: segments.iter().map(object).collect(),
        ..SceneInput::default()
    }
}

#[test]
fn extruded_plans_get_the_same_verdicts_in_space() {
    let mut random = Random::new(5);
    let (mut seen_count, mut hidden_count) = (0, 0);
    for _ in 0..if long() { 400 } else { 40 } {
        let mut p = || [random.integer(-12, 12), random.integer(-12, 12)];
        let mut segments: Vec<[GridPoint; 2]> = (0..9).map(|_| [p(), p()]).collect();
        segments.retain(|s| s[0] != s[1]);
        let (x, y) = (random.integer(-12, 8), random.integer(-12, 8));
        let (w, h) = (random.integer(1, 4), random.integer(1, 4));
        let (low, high) = ([x as f64, y as f64], [(x + w) as f64, (y + h) as f64]);
        let plan = build(&segments, 2);
        let outline = [low, [high[0], low[1]], high, [low[0], high[1]]];
        let cell = PlanCell::new(&plan, &outline).expect("a cell");
        let flat = see(&plan, &cell, &SeeOptions::default());
        let boxed = NamedBox {
            name: "cell".to_owned(),
            min: [low[0], low[1], 0.0],
            max: [high[0], high[1], HEIGHT],
        };
        let (scene, _) = SceneBuilder::new(extruded(&segments))
            .grid(Some(1.0))
            .cells_box(Some((boxed.min, boxed.max)))
            .build()
            .expect("a good scene");
        let cell = make_cells(&scene, &CellSpec::Boxes(vec![boxed]))
            .expect("a cell")
            .remove(0);
        let deep = Baker::new(&scene).bake_cell(&cell, &BakeOptions::default());
        assert!(deep.unknown.is_empty());
        // In space only a part of what enters the cell is used, or none of it: then more is seen there.
        if flat.accuracy != Accuracy::Exact {
            continue;
        }
        let flat: Vec<u32> = flat.segments.iter().map(|s| s.segment.0).collect();
        let deep: Vec<u32> = deep.visible.iter().map(|e| e.object.0).collect();
        assert_eq!(flat, deep, "{segments:?} from {outline:?}");
        seen_count += flat.len();
        hidden_count += segments.len() - flat.len();
    }
    assert!(
        seen_count > 50 && hidden_count > 10,
        "{seen_count} {hidden_count}"
    );
}
