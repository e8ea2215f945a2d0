//! Snapping opens no cracks: rooms off the grid, and a house against the same house without
//! thin sets of lines.

use antumbra::region::{Accuracy, BakeOptions, Baker};
use antumbra::scene::{
    CellSpec, NamedBox, ObjectInput, PartInput, Scene, SceneBuilder, SceneInput, make_cells,
};
use antumbra_testkit::environment::long;
use antumbra_testkit::random::Random;

use crate::scenes::{measured, note};

/// A box of quads, each cut into two triangles.
fn hull(name: &str, min: [f64; 3], max: [f64; 3]) -> ObjectInput {
    let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { max[k] } else { min[k] });
    let sides: [[u32; 4]; 6] = [
        [0, 2, 6, 4],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 3, 7, 6],
        [0, 1, 3, 2],
        [4, 5, 7, 6],
    ];
    let part = PartInput {
        vertices: (0..8).map(corner).collect(),
        faces: sides
            .iter()
            .flat_map(|s| [[s[0], s[1], s[2]], [s[0], s[2], s[3]]])
            .collect(),
        ..PartInput::default()
    };
    ObjectInput {
        name: Some(name.to_owned()),
        parts: vec![part],
    }
}

/// The sides of a box as objects of their own, without thickness or with it.
fn walls(min: [f64; 3], max: [f64; 3], thick: f64) -> Vec<ObjectInput> {
    let mut objects = Vec::new();
    for k in 0..3 {
        for (name, at) in [("low", min[k] - thick), ("high", max[k])] {
            let (mut low, mut high) = (min.map(|c| c - thick), max.map(|c| c + thick));
            low[k] = at;
            high[k] = at + thick;
            if thick == 0.0 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let corner = |u: f64, v: f64| {
                    let mut p = low;
                    (p[i], p[j]) = (u, v);
                    p
                };
                let vertices = vec![
                    corner(low[i], low[j]),
                    corner(high[i], low[j]),
                    corner(high[i], high[j]),
                    corner(low[i], high[j]),
                ];
                let part = PartInput {
                    vertices,
                    faces: [[0, 1, 2], [0, 2, 3]].into_iter().collect(),
                    ..PartInput::default()
                };
                objects.push(ObjectInput {
                    name: Some(format!("{name}{k}")),
                    parts: vec![part],
                });
            } else {
                objects.push(hull(&format!("{name}{k}"), low, high));
            }
        }
    }
    objects
}

/// A room with things outside, at coordinates that no binary grid holds.
fn room(min: [f64; 3], max: [f64; 3], thick: f64, random: &mut Random) -> Scene {
    let mut objects = walls(min, max, thick);
    for i in 0..12 {
        let k = random.index(3);
        let mut low: [f64; 3] = std::array::from_fn(|k| min[k] + (max[k] - min[k]) * random.unit());
        low[k] = if i % 2 == 0 {
            max[k] + thick + 0.37
        } else {
            min[k] - thick - 1.91
        };
        objects.push(hull(&format!("outside{i}"), low, low.map(|c| c + 0.83)));
    }
    let input = SceneInput {
        objects,
        source_name: "room".to_owned(),
    };
    let (scene, _) = SceneBuilder::new(input).build().expect("a good scene");
    scene
}

fn seen_outside(scene: &Scene, min: [f64; 3], max: [f64; 3]) -> (usize, Accuracy) {
    let spec = CellSpec::Boxes(vec![NamedBox {
        name: "room".to_owned(),
        min,
        max,
    }]);
    let cell = make_cells(scene, &spec).expect("a cell").remove(0);
    let result = Baker::new(scene).bake_cell(&cell, &BakeOptions::default());
    assert!(result.unknown.is_empty());
    let outside = result
        .visible
        .iter()
        .filter(|e| scene.object(e.object).name.starts_with("out"));
    (outside.count(), result.accuracy)
}

/// A box with coordinates in thirds of a millimetre, which no binary grid holds, or in 1/64.
fn some_box(unit: f64, random: &mut Random) -> ([f64; 3], [f64; 3]) {
    let mut length = |most: f64| ((random.unit() * most) / unit).round() * unit;
    let min: [f64; 3] = std::array::from_fn(|_| length(7.0));
    let max = std::array::from_fn(|k| min[k] + 2.0 + length(5.0));
    (min, max)
}

#[test]
fn a_room_flush_with_its_walls_does_not_see_through_them() {
    let mut random = Random::new(4);
    for round in 0..if long() { 60 } else { 8 } {
        let (off, on) = (1e-3 / 3.0, 1.0 / 64.0);
        for (unit, thick) in [(off, 0.2), (off, 0.0), (on, 0.25), (on, 0.0)] {
            let (min, max) = some_box(unit, &mut random);
            let scene = room(min, max, thick, &mut random);
            let (outside, accuracy) = seen_outside(&scene, min, max);
            let about =
                format!("round {round}: {min:?} to {max:?}, walls of {thick}, {accuracy:?}");
            assert_eq!(outside, 0, "{about}");
            assert_eq!(accuracy, Accuracy::Exact, "{about}");
        }
    }
}

#[test]
fn a_room_from_a_file_of_narrow_floats_is_still_flush() {
    // Files hold coordinates as 32-bit floats, lists of cells as decimals.
    let mut random = Random::new(5);
    for _ in 0..if long() { 60 } else { 8 } {
        let (min, max) = some_box(1e-3 / 3.0, &mut random);
        let narrow = |p: [f64; 3]| p.map(|c| f64::from(c as f32));
        let scene = room(narrow(min), narrow(max), 0.0, &mut random);
        let (outside, _) = seen_outside(&scene, min, max);
        assert_eq!(outside, 0, "{min:?} to {max:?}");
    }
}

#[test]
fn a_cell_that_reaches_through_a_wall_says_so() {
    // Two steps beyond a wall without thickness a cell sees what is behind it.
    let mut random = Random::new(6);
    for _ in 0..8 {
        let (min, max) = some_box(1e-3 / 3.0, &mut random);
        let scene = room(min, max, 0.0, &mut random);
        let beyond = 2.0 * scene.grid().step();
        let (outside, accuracy) = seen_outside(&scene, min, max.map(|c| c + beyond));
        assert!(outside > 0);
        assert_eq!(accuracy, Accuracy::Conservative);
    }
}

#[test]
fn a_house_sees_no_more_through_cracks() {
    let Some(place) = measured("duplex", 2.0) else {
        return;
    };
    let baker = Baker::new(&place.scene);
    let cells = place.some_cells(if long() { usize::MAX } else { 3 }, 21);
    let ignoring = BakeOptions {
        ignore_below: Some(1e-4),
        ..BakeOptions::default()
    };
    let (mut exact, mut thick) = (0, 0);
    for cell in &cells {
        let count = |options: &BakeOptions| {
            let result = baker.bake_cell(cell, options);
            assert!(result.unknown.is_empty(), "cell {}", cell.name);
            result.visible.len()
        };
        exact += count(&BakeOptions::default());
        thick += count(&ignoring);
    }
    let more = 100.0 * (exact as f64 / thick as f64 - 1.0);
    note(&format!(
        "duplex, {} cells: {exact} visible, {thick} without sets below 0.1 mrad: {more:.2} % more",
        cells.len()
    ));
    assert!(exact >= thick, "ignoring lines reveals");
    assert!(more <= 3.0, "{more:.2} % more");
}
