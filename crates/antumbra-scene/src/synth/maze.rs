//! A maze of furnished rooms under one roof.

use super::SplitMix64;
use super::furniture::Piece;
use super::shape::{Place, Shape, number_names};
use super::wall::{Opening, Wall};
use crate::SceneInput;

/// Distance of neighboring walls, in metres.
const PITCH: f64 = 6.0;
const HEIGHT: f64 = 3.0;
const THICK: f64 = 0.2;
/// Width and height of the passages.
const PASSAGE: [f64; 2] = [1.6, 2.2];
/// How many of the walls that a spanning tree leaves closed are opened as well.
const LOOPS: f64 = 0.15;

/// The parameters of [`maze`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MazeParams {
    /// Rooms along each side.
    pub rooms: u32,
    /// Pieces of furniture a room, at most 9.
    pub furniture: u32,
    /// What chance depends on.
    pub seed: u64,
}

/// A maze: `rooms` x `rooms` rooms of 6 m, after the scene `big-7` of \[Bittner02, 4.8\].
///
/// Passages of 1.6 m follow a random spanning tree, so every room can be reached; one in seven of the
/// other walls has a passage too. Rooms hold chairs, tables, shelves, cabinets, sofas and bins on a
/// raster of 3 x 3 places. Every wall and every piece is an object; floor and ceiling are one each.
#[must_use]
pub fn maze(params: &MazeParams) -> SceneInput {
    let mut rng = SplitMix64::new(params.seed);
    let n = params.rooms;
    let side = f64::from(n) * PITCH;
    let mut objects = Vec::new();
    for (name, z) in [("slab", -0.3), ("roof", HEIGHT)] {
        let (min, max) = ([-THICK, -THICK, z], [side + THICK, side + THICK, z + 0.3]);
        objects.push(Shape::fixed("slab").block(min, max).object(name));
    }
    for (name, min, max) in [
        (
            "wall-south",
            [-THICK, -THICK, 0.0],
            [side + THICK, 0.0, HEIGHT],
        ),
        (
            "wall-north",
            [-THICK, side, 0.0],
            [side + THICK, side + THICK, HEIGHT],
        ),
        ("wall-west", [-THICK, 0.0, 0.0], [0.0, side, HEIGHT]),
        ("wall-east", [side, 0.0, 0.0], [side + THICK, side, HEIGHT]),
    ] {
        objects.push(Shape::fixed("wall").block(min, max).object(name));
    }
    let open = passages(n, &mut rng);
    for (i, &[west, south]) in open.iter().enumerate() {
        let (column, row) = (i as u32 % n.max(1), i as u32 / n.max(1));
        let (x, y) = (f64::from(column) * PITCH, f64::from(row) * PITCH);
        // Walls meet at the corners of rooms: the one along x runs through, the other fits between.
        if row > 0 {
            let place = Place::new([x, y - THICK / 2.0, 0.0], 0.0);
            objects.push(inner_wall(place, PITCH, south, &mut rng).object("wall-x"));
        }
        if column > 0 {
            let (low, high) = (
                f64::from(u8::from(row > 0)),
                f64::from(u8::from(row + 1 < n)),
            );
            let place = Place::new([x + THICK / 2.0, y + low * THICK / 2.0, 0.0], 90.0);
            let length = PITCH - (low + high) * THICK / 2.0;
            objects.push(inner_wall(place, length, west, &mut rng).object("wall-y"));
        }
        furnish(&mut objects, [x, y], params.furniture.min(9), &mut rng);
    }
    let source_name = format!(
        "maze --rooms {} --furniture {} --seed {}",
        params.rooms, params.furniture, params.seed
    );
    let mut scene = SceneInput {
        objects,
        source_name,
    };
    number_names(&mut scene);
    scene
}

/// A wall between two rooms, with or without a passage somewhere in it.
fn inner_wall(place: Place, length: f64, open: bool, rng: &mut SplitMix64) -> Shape {
    let [width, height] = PASSAGE;
    let start = rng.range(0.5, length - 0.5 - width);
    let opening = [Opening {
        along: [start, start + width],
        height: [0.0, height],
    }];
    let openings = if open { &opening[..] } else { &[] };
    Wall {
        place,
        length,
        thickness: THICK,
        height: HEIGHT,
        openings,
    }
    .shape()
}

/// For each room, whether there is a passage to the room at its west and at its south.
fn passages(n: u32, rng: &mut SplitMix64) -> Vec<[bool; 2]> {
    let mut open = vec![[false; 2]; (n * n) as usize];
    let mut visited = vec![false; (n * n) as usize];
    let mut path: Vec<[u32; 2]> = Vec::new();
    if n > 0 {
        visited[0] = true;
        path.push([0, 0]);
    }
    // Depth first; a dead end goes one step back.
    while let Some(&[x, y]) = path.last() {
        let next: Vec<[u32; 2]> = [(1, 0), (-1, 0), (0, 1), (0, -1)]
            .into_iter()
            .filter_map(|(dx, dy)| Some([x.checked_add_signed(dx)?, y.checked_add_signed(dy)?]))
            .filter(|&[x, y]| x < n && y < n && !visited[(y * n + x) as usize])
            .collect();
        let Some(&[u, v]) = next.get(rng.below(next.len() as u32) as usize) else {
            path.pop();
            continue;
        };
        // The passage belongs to the room that is farther east or north.
        open[(y.max(v) * n + x.max(u)) as usize][usize::from(u == x)] = true;
        visited[(v * n + u) as usize] = true;
        path.push([u, v]);
    }
    for sides in &mut open {
        for side in sides {
            *side |= rng.chance(LOOPS);
        }
    }
    open
}

/// Fills a room: each piece gets a place of its own on a raster that keeps clear of the walls.
fn furnish(
    objects: &mut Vec<crate::ObjectInput>,
    [x, y]: [f64; 2],
    count: u32,
    rng: &mut SplitMix64,
) {
    const KINDS: [Piece; 8] = [
        Piece::Chair,
        Piece::Chair,
        Piece::Table,
        Piece::Table,
        Piece::Shelf,
        Piece::Cabinet,
        Piece::Sofa,
        Piece::Bin,
    ];
    let mut free: Vec<u32> = (0..9).collect();
    for _ in 0..count {
        let spot = free.swap_remove(rng.below(free.len() as u32) as usize);
        let piece = KINDS[rng.below(8) as usize];
        // Sofas and tables are longer than a place is wide: they stay parallel to the raster's rows.
        let turns = if matches!(piece, Piece::Sofa | Piece::Table) {
            2
        } else {
            4
        };
        let degrees = f64::from(rng.below(turns) * (360 / turns));
        let at = |i: u32, start: f64| start + 1.2 + 1.8 * f64::from(i);
        objects.push(piece.at(Place::new([at(spot % 3, x), at(spot / 3, y), 0.0], degrees)));
    }
}

#[cfg(test)]
mod tests {
    use super::{MazeParams, SplitMix64, maze, passages};

    #[test]
    fn every_room_can_be_reached() {
        let n = 7;
        let open = passages(n, &mut SplitMix64::new(3));
        let mut group: Vec<usize> = (0..(n * n) as usize).collect();
        for _ in 0..n * n {
            for i in 0..group.len() {
                for (k, back) in [1, n as usize].into_iter().enumerate() {
                    if open[i][k] && i >= back && (k == 1 || i % n as usize > 0) {
                        let low = group[i].min(group[i - back]);
                        (group[i], group[i - back]) = (low, low);
                    }
                }
            }
        }
        assert!(group.iter().all(|&g| g == 0));
    }

    #[test]
    fn counts_and_seeds() {
        let params = MazeParams {
            rooms: 3,
            furniture: 5,
            seed: 1,
        };
        let scene = maze(&params);
        // Two slabs, four outer walls, twelve inner ones, nine rooms of five pieces.
        assert_eq!(scene.objects.len(), 2 + 4 + 12 + 45);
        assert_eq!(scene, maze(&params));
        assert_ne!(scene, maze(&MazeParams { seed: 2, ..params }));
        assert_eq!(maze(&MazeParams { rooms: 0, ..params }).objects.len(), 6);
    }
}
