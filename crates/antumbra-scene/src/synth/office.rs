//! Single furnished rooms with an area light: the offices of the ordering paper.

use super::furniture::Piece::{self, Cabinet, Chair, Monitor, Picture, Shelf, Table};
use super::shape::{Place, Shape, number_names};
use crate::SceneInput;

/// Which office; the numbers of polygons are those of \[Chry96, Table 1\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OfficeKind {
    /// 139 polygons: one desk.
    Office1,
    /// 211 polygons: the same with visitors' chairs, a screen and pictures.
    Office2,
    /// 333 polygons: two desks.
    Office3,
    /// 751 polygons: six workplaces and a meeting table.
    Office4,
    /// 751 polygons: as `Office4`, with everything that stands free turned a little.
    Office4Star,
}

impl OfficeKind {
    /// All kinds, smallest first.
    pub const ALL: [Self; 5] = [
        Self::Office1,
        Self::Office2,
        Self::Office3,
        Self::Office4,
        Self::Office4Star,
    ];

    /// The name used on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Office1 => "office1",
            Self::Office2 => "office2",
            Self::Office3 => "office3",
            Self::Office4 => "office4",
            Self::Office4Star => "office4star",
        }
    }
}

/// A piece of furniture, where it stands, and by how many degrees it is turned.
type Item = (Piece, f64, f64, f64);

/// A furnished room with the object `light` near its ceiling.
///
/// The paper gives the numbers of polygons and little else; sizes and furniture are ours: rooms of
/// 4 x 5 m (`office1`, `office2`), 6 x 5 m and 10 x 8 m, 2.8 m high; floor, ceiling and walls are
/// one face each; the light is a square of 1 m, 10 cm under the ceiling, and faces down.
#[must_use]
pub fn office(kind: OfficeKind) -> SceneInput {
    let [width, depth] = match kind {
        OfficeKind::Office1 | OfficeKind::Office2 => [4.0, 5.0],
        OfficeKind::Office3 => [6.0, 5.0],
        OfficeKind::Office4 | OfficeKind::Office4Star => [10.0, 8.0],
    };
    let mut objects = room(width, depth, HEIGHT);
    objects.push(Piece::Light.at(Place::new([width / 2.0, depth / 2.0, HEIGHT - 0.1], 0.0)));
    let items = match kind {
        OfficeKind::Office1 => SMALL[..7].to_vec(),
        OfficeKind::Office2 => SMALL.to_vec(),
        OfficeKind::Office3 => MEDIUM.to_vec(),
        OfficeKind::Office4 | OfficeKind::Office4Star => large(),
    };
    for (i, (piece, x, y, degrees)) in items.into_iter().enumerate() {
        let slant = if kind == OfficeKind::Office4Star && piece.stands_free() {
            // Turns between -15 and 15 degrees that do not repeat soon.
            (i * 37 % 31) as f64 - 15.0
        } else {
            0.0
        };
        objects.push(piece.at(Place::new([x, y, 0.0], degrees + slant)));
    }
    let mut scene = SceneInput {
        objects,
        source_name: format!("office --kind {}", kind.name()),
    };
    number_names(&mut scene);
    scene
}

const HEIGHT: f64 = 2.8;

/// Six inward faces, each an object of its own.
fn room(width: f64, depth: f64, height: f64) -> Vec<crate::ObjectInput> {
    let (w, d, h) = (width, depth, height);
    let face = |class: &str, name: &str, corners| Shape::fixed(class).quad(corners).object(name);
    let [a, b, c, e] = [[0.0, 0.0], [w, 0.0], [w, d], [0.0, d]];
    let wall = |name: &str, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]| {
        face(
            "wall",
            name,
            [[x0, y0, 0.0], [x0, y0, h], [x1, y1, h], [x1, y1, 0.0]],
        )
    };
    vec![
        face("slab", "floor", [a, b, c, e].map(|[x, y]| [x, y, 0.0])),
        face("slab", "ceiling", [a, e, c, b].map(|[x, y]| [x, y, h])),
        wall("wall-south", a, b),
        wall("wall-east", b, c),
        wall("wall-north", c, e),
        wall("wall-west", e, a),
    ]
}

/// The first seven items are `office1`, all are `office2`.
const SMALL: [Item; 14] = [
    (Table, 2.0, 3.2, 0.0),
    (Chair, 2.0, 2.55, 0.0),
    (Chair, 2.0, 3.85, 180.0),
    (Shelf, 3.8, 1.5, 270.0),
    (Cabinet, 0.27, 1.0, 90.0),
    (Cabinet, 0.27, 2.0, 90.0),
    (Cabinet, 0.27, 4.2, 90.0),
    (Chair, 2.9, 0.5, 0.0),
    (Chair, 1.2, 0.5, 0.0),
    (Monitor, 1.8, 3.3, 0.0),
    (Picture, 2.0, 4.98, 0.0),
    (Picture, 0.02, 3.1, 90.0),
    (Picture, 3.98, 3.4, 270.0),
    (Picture, 2.0, 0.02, 180.0),
];

const MEDIUM: [Item; 21] = [
    (Table, 1.8, 3.2, 0.0),
    (Chair, 1.8, 2.55, 0.0),
    (Chair, 1.8, 3.85, 180.0),
    (Table, 4.2, 3.2, 0.0),
    (Chair, 4.2, 2.55, 0.0),
    (Chair, 4.2, 3.85, 180.0),
    (Monitor, 1.6, 3.3, 0.0),
    (Chair, 2.2, 0.5, 0.0),
    (Chair, 3.8, 0.5, 0.0),
    (Shelf, 5.8, 1.2, 270.0),
    (Shelf, 5.8, 2.4, 270.0),
    (Cabinet, 0.27, 0.9, 90.0),
    (Cabinet, 0.27, 1.8, 90.0),
    (Cabinet, 0.27, 4.3, 90.0),
    (Cabinet, 5.5, 4.73, 0.0),
    (Picture, 1.8, 4.98, 0.0),
    (Picture, 4.2, 4.98, 0.0),
    (Picture, 0.02, 3.0, 90.0),
    (Picture, 5.98, 3.7, 270.0),
    (Picture, 2.2, 0.02, 180.0),
    (Picture, 3.8, 0.02, 180.0),
];

/// Six workplaces with a chair on both sides, a meeting table with five chairs, and the rest.
fn large() -> Vec<Item> {
    let mut items = Vec::new();
    for y in [4.0, 6.6] {
        for x in [1.6, 4.2, 6.8] {
            items.extend([
                (Table, x, y, 0.0),
                (Chair, x, y - 0.65, 0.0),
                (Chair, x, y + 0.65, 180.0),
            ]);
        }
    }
    items.extend([
        (Table, 3.0, 1.5, 0.0),
        (Chair, 2.6, 0.85, 0.0),
        (Chair, 3.4, 0.85, 0.0),
        (Chair, 2.6, 2.15, 180.0),
        (Chair, 3.4, 2.15, 180.0),
        (Chair, 4.1, 1.5, 90.0),
        (Monitor, 4.1, 4.1, 0.0),
        (Shelf, 9.8, 2.0, 270.0),
        (Shelf, 9.8, 3.2, 270.0),
        (Cabinet, 9.7, 4.5, 270.0),
        (Cabinet, 9.7, 5.5, 270.0),
        (Cabinet, 0.27, 1.2, 90.0),
        (Cabinet, 0.27, 2.2, 90.0),
        (Picture, 1.6, 7.98, 0.0),
        (Picture, 4.2, 7.98, 0.0),
        (Picture, 6.8, 7.98, 0.0),
        (Picture, 0.02, 4.0, 90.0),
        (Picture, 9.98, 6.6, 270.0),
        (Picture, 3.0, 0.02, 180.0),
    ]);
    items
}

#[cfg(test)]
mod tests {
    use super::{OfficeKind, office};
    use crate::synth::face_count;

    #[test]
    fn polygon_counts_are_those_of_the_paper() {
        let counts = OfficeKind::ALL.map(|kind| face_count(&office(kind)));
        assert_eq!(counts, [139, 211, 333, 751, 751]);
    }

    #[test]
    fn everything_is_inside_the_room() {
        for kind in OfficeKind::ALL {
            let scene = office(kind);
            let floor = &scene.objects[0].parts[0].vertices;
            for object in &scene.objects {
                for p in &object.parts[0].vertices {
                    let inside = (0.0..=floor[2][0]).contains(&p[0])
                        && (0.0..=floor[2][1]).contains(&p[1])
                        && (0.0..=2.8).contains(&p[2]);
                    assert!(inside, "{kind:?} {:?} {p:?}", object.name);
                }
            }
        }
    }

    #[test]
    fn names_are_unique_and_the_star_is_turned() {
        let scene = office(OfficeKind::Office4);
        let mut names: Vec<_> = scene
            .objects
            .iter()
            .filter_map(|o| o.name.clone())
            .collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), scene.objects.len());
        let star = office(OfficeKind::Office4Star);
        assert_eq!(scene.objects[0], star.objects[0]);
        assert_ne!(scene.objects[8], star.objects[8]);
    }
}
