//! A furnished office floor: rooms with doors and windows along a corridor.

use super::SplitMix64;
use super::furniture::Piece::{self, Bin, Cabinet, Chair, Monitor, Picture, Shelf, Sofa, Table};
use super::shape::{Place, Shape, number_names};
use super::wall::{Opening, Wall};
use crate::SceneInput;

/// Rooms on each side of the corridor.
const ROOMS: u32 = 5;
/// Distance of neighboring partition walls, axis to axis.
const PITCH: f64 = 4.0;
const DEPTH: f64 = 5.0;
const CORRIDOR: f64 = 2.0;
const HEIGHT: f64 = 2.8;
const THICK: f64 = 0.2;
const THIN: f64 = 0.1;
const DOOR: [f64; 2] = [0.0, 2.1];
const WINDOW: [f64; 2] = [0.9, 2.2];
/// Where the eyes of people who stand or walk are.
const EYES: [f64; 2] = [1.5, 1.75];

/// A generated floor and the places in it where people stand.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorPlan {
    /// The geometry.
    pub scene: SceneInput,
    /// Named boxes (lower and upper corner) at eye level, one a room and four along the corridor.
    /// No polygon meets the interior of one, so their results are exact.
    pub places: Vec<(String, [f64; 3], [f64; 3])>,
}

/// A furnished floor: five rooms on each side of a corridor, after \[TS92\].
///
/// The floor measures 20.4 m by 12.8 m. Walls are solid and closed at every joint; windows are
/// translucent panes; each door is either a leaf that closes its doorway or a leaf turned into the
/// room. Furniture, doors and pictures depend on the seed. Every wall, pane, leaf and piece of
/// furniture is an object.
#[must_use]
pub fn floor(seed: u64) -> FloorPlan {
    let mut rng = SplitMix64::new(seed);
    let length = f64::from(ROOMS) * PITCH;
    let half = CORRIDOR / 2.0 + THIN;
    let outer = half + DEPTH + THICK;
    let mut plan = FloorPlan {
        scene: SceneInput {
            objects: Vec::new(),
            source_name: format!("floor --seed {seed}"),
        },
        places: Vec::new(),
    };
    let objects = &mut plan.scene.objects;
    for (name, z) in [("slab", -0.3), ("roof", HEIGHT)] {
        let (min, max) = ([-THICK, -outer, z], [length + THICK, outer, z + 0.3]);
        objects.push(Shape::fixed("slab").block(min, max).object(name));
    }
    gable(
        objects,
        "west",
        Place::new([0.0, -outer, 0.0], 90.0),
        2.0 * outer,
    );
    gable(
        objects,
        "east",
        Place::new([length, outer, 0.0], 270.0),
        2.0 * outer,
    );
    for i in 0..ROOMS {
        let x = (f64::from(i) + 0.5) * PITCH;
        room(
            &mut plan,
            &format!("n{i}"),
            Place::new([x, half, 0.0], 0.0),
            i,
            &mut rng,
        );
        room(
            &mut plan,
            &format!("s{i}"),
            Place::new([x, -half, 0.0], 180.0),
            ROOMS - 1 - i,
            &mut rng,
        );
    }
    for i in 0..4 {
        let x = f64::from(i) * length / 4.0;
        let y = CORRIDOR / 2.0 - 0.1;
        let (from, to) = (x + 0.1, x + length / 4.0 - 0.1);
        plan.places.push((
            format!("corridor-{i}"),
            [from, -y, EYES[0]],
            [to, y, EYES[1]],
        ));
    }
    number_names(&mut plan.scene);
    plan
}

/// A wall at one end of the floor, with a window at the end of the corridor.
fn gable(objects: &mut Vec<crate::ObjectInput>, name: &str, place: Place, length: f64) {
    let middle = length / 2.0;
    let openings = [Opening {
        along: [middle - 0.6, middle + 0.6],
        height: WINDOW,
    }];
    let wall = Wall {
        place,
        length,
        thickness: THICK,
        height: HEIGHT,
        openings: &openings,
    };
    objects.push(wall.shape().object(format!("wall-{name}")));
    let pane = wall.filling(&openings[0], "glass", 0.02).translucent();
    objects.push(pane.object(format!("window-{name}")));
}

/// One room: its wall to the corridor, its outer wall, one partition, its door and its furniture.
///
/// In the frame of the room the corridor is at `y < 0`, the window at `y = DEPTH`, and `x` runs from
/// `-PITCH / 2` to `PITCH / 2`. `order` counts rooms in that direction; all but the first have a
/// partition on their lower side.
fn room(plan: &mut FloorPlan, name: &str, place: Place, order: u32, rng: &mut SplitMix64) {
    let objects = &mut plan.scene.objects;
    let here = |x: f64, y: f64, degrees: f64| place.then(&Place::new([x, y, 0.0], degrees));
    let start = -PITCH / 2.0;
    // The door is near one partition or the other; its leaf hangs on that side.
    let door_left = rng.chance(0.5);
    let along = if door_left {
        [0.3, 1.2]
    } else {
        [PITCH - 1.2, PITCH - 0.3]
    };
    let door = [Opening {
        along,
        height: DOOR,
    }];
    let front = Wall {
        place: here(start, -THIN, 0.0),
        length: PITCH,
        thickness: THIN,
        height: HEIGHT,
        openings: &door,
    };
    objects.push(front.shape().object(format!("wall-{name}-corridor")));
    let window = [Opening {
        along: [0.8, PITCH - 0.8],
        height: WINDOW,
    }];
    let back = Wall {
        place: here(start, DEPTH, 0.0),
        thickness: THICK,
        openings: &window,
        ..front
    };
    objects.push(back.shape().object(format!("wall-{name}-outer")));
    let pane = back.filling(&window[0], "glass", 0.02).translucent();
    objects.push(pane.object(format!("window-{name}")));
    if order > 0 {
        let wall = Wall {
            place: here(start + THIN / 2.0, 0.0, 90.0),
            length: DEPTH,
            openings: &[],
            ..front
        };
        objects.push(wall.shape().object(format!("wall-{name}-side")));
    }
    let leaf = if rng.chance(0.7) {
        // Hung on the inner face of the wall and turned by a right angle.
        let hinge = start + if door_left { along[0] } else { along[1] };
        let x = if door_left {
            [hinge - 0.04, hinge]
        } else {
            [hinge, hinge + 0.04]
        };
        Shape::new("door", place).block([x[0], 0.0, 0.02], [x[1], 0.9, 2.08])
    } else {
        front.filling(&door[0], "door", 0.04)
    };
    objects.push(leaf.object(format!("door-{name}")));
    let layouts: [&[(Piece, f64, f64, f64)]; 4] = [&SINGLE, &DOUBLE, &MEETING, &LOUNGE];
    for &(piece, x, y, degrees) in layouts[rng.below(4) as usize] {
        // A chair is never quite straight.
        let slant = if piece == Chair {
            rng.range(-20.0, 20.0)
        } else {
            0.0
        };
        objects.push(piece.at(here(x, y, degrees + slant)));
    }
    let (a, b) = (
        place.apply([-1.55, 0.95, EYES[0]]),
        place.apply([1.55, DEPTH - 0.1, EYES[1]]),
    );
    let min = std::array::from_fn(|k| a[k].min(b[k]));
    let max = std::array::from_fn(|k| a[k].max(b[k]));
    plan.places.push((format!("room-{name}"), min, max));
}

// Furniture keeps clear of the first meter behind the door, and below eye level except along the
// side walls.
const SINGLE: [(Piece, f64, f64, f64); 9] = [
    (Table, 0.0, 3.4, 180.0),
    (Chair, 0.0, 4.1, 180.0),
    (Chair, 0.3, 2.7, 0.0),
    (Monitor, 0.3, 3.3, 180.0),
    (Shelf, 1.75, 1.8, 270.0),
    (Shelf, 1.75, 2.9, 270.0),
    (Cabinet, -1.6, 2.0, 90.0),
    (Bin, 1.0, 3.6, 0.0),
    (Picture, -1.92, 3.2, 90.0),
];
const DOUBLE: [(Piece, f64, f64, f64); 9] = [
    (Table, -1.1, 3.0, 270.0),
    (Chair, -0.45, 3.0, 90.0),
    (Table, 1.1, 3.0, 90.0),
    (Chair, 0.45, 3.0, 270.0),
    (Monitor, -1.3, 3.1, 270.0),
    (Monitor, 1.3, 2.9, 90.0),
    (Cabinet, -1.6, 1.6, 90.0),
    (Cabinet, 1.6, 1.6, 270.0),
    (Bin, 0.0, 4.5, 0.0),
];
const MEETING: [(Piece, f64, f64, f64); 8] = [
    (Table, 0.0, 2.8, 90.0),
    (Chair, -0.65, 2.4, 270.0),
    (Chair, -0.65, 3.2, 270.0),
    (Chair, 0.65, 2.4, 90.0),
    (Chair, 0.65, 3.2, 90.0),
    (Chair, 0.0, 3.95, 180.0),
    (Picture, 1.92, 2.8, 270.0),
    (Picture, -1.92, 2.8, 90.0),
];
const LOUNGE: [(Piece, f64, f64, f64); 6] = [
    (Sofa, -1.3, 2.6, 90.0),
    (Sofa, 0.3, 4.3, 0.0),
    (Shelf, 1.75, 2.0, 270.0),
    (Cabinet, 1.6, 3.2, 270.0),
    (Bin, 1.6, 4.2, 0.0),
    (Picture, -1.92, 2.6, 90.0),
];

#[cfg(test)]
mod tests {
    use super::floor;
    use crate::synth::face_count;

    #[test]
    fn a_floor_is_furnished_and_deterministic() {
        let plan = floor(1);
        assert_eq!(plan, floor(1));
        assert_ne!(plan, floor(2));
        assert_eq!(plan.places.len(), 14);
        let faces = face_count(&plan.scene);
        assert!((1500..4000).contains(&faces), "{faces}");
        assert!(plan.scene.objects.len() > 120);
    }

    #[test]
    fn no_vertex_is_inside_a_place() {
        for seed in 0..20 {
            let plan = floor(seed);
            for (name, min, max) in &plan.places {
                assert!((0..3).all(|k| min[k] < max[k]));
                for object in &plan.scene.objects {
                    let part = &object.parts[0];
                    for face in part.faces.iter() {
                        let apart = (0..3).any(|k| {
                            let c = || face.iter().map(|&i| part.vertices[i as usize][k]);
                            c().all(|x| x <= min[k]) || c().all(|x| x >= max[k])
                        });
                        assert!(apart, "seed {seed}: {:?} meets {name}", object.name);
                    }
                }
            }
        }
    }
}
