//! The union of tiles, exactly.
//!
//! No arrangement is made. On each line that bounds a tile it is asked which intervals of it have covered ground on their
//! left, and which on their right: an interval with one and not the other bounds the union. A tile covers at most
//! three intervals of a line, whose ends are crossings with the tile's own lines. So every corner has the name of two lines,
//! corners on one line are put in order by determinants of three lines, and what is rounded at the end
//! are coordinates, each once, to about the nearest double.

mod along;
mod graph;
mod lines;

use super::tiles::Tile;
use along::Along;
use graph::Graph;
use lines::{Lines, SignedLine};

/// A polygon in grid steps: an outline counter-clockwise, then holes.
pub type Outlines = Vec<Vec<[f64; 2]>>;

/// The union of some tiles, as polygons whose interiors are connected. What has no width is left out.
#[must_use]
pub fn union(tiles: &[Tile]) -> Vec<Outlines> {
    let mut lines = Lines::default();
    let tiles: Vec<Signed> = tiles.iter().map(|t| Signed::new(t, &mut lines)).collect();
    let mut owners = vec![Vec::new(); lines.all.len()];
    for (i, tile) in tiles.iter().enumerate() {
        for s in tile.halves.iter().chain(&tile.fan) {
            owners[s.line].push(i);
        }
    }
    let mut edges = Vec::new();
    for (line, owners) in owners.iter().enumerate() {
        Along {
            lines: &lines,
            line,
        }
        .edges(&tiles, owners, &mut edges);
    }
    Graph::new(&lines, edges).polygons()
}

/// A tile by numbers of lines.
struct Signed {
    halves: Vec<SignedLine>,
    fan: Vec<SignedLine>,
    bounds: [[f64; 2]; 2],
}

impl Signed {
    fn new(tile: &Tile, lines: &mut Lines) -> Self {
        Self {
            halves: tile.halves.iter().map(|l| lines.insert(l)).collect(),
            fan: tile.fan.iter().map(|l| lines.insert(l)).collect(),
            bounds: tile.bounds,
        }
    }
}
