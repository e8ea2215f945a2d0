//! Half-edges: the borders of cells as cycles, and what is left when edges are dissolved.

use antumbra_lines::Half;

use super::cells::Cells;
use super::walls::{OUTSIDE, Walls};

/// A planar subdivision by half-edges: number `2 e` runs along segment `e`, `2 e + 1` against it.
pub(super) struct Mesh {
    pub(super) next: Vec<u32>,
    /// Where each half-edge starts.
    pub(super) origin: Vec<u32>,
}

const UNSET: u32 = u32::MAX;

impl Mesh {
    /// The borders of all cells, and of the outside if there is one.
    pub(super) fn of(cells: &Cells, walls: &Walls) -> Self {
        let n = walls.segments.len() * 2;
        let mut next = vec![UNSET; n];
        let mut previous = vec![UNSET; n];
        let mut origin = vec![0; n];
        for (segment, e) in walls.segments.iter().zip(0..) {
            origin[2 * e] = walls.vertex[segment.from as usize];
            origin[2 * e + 1] = walls.vertex[segment.to as usize];
        }
        let mut cycle = Vec::new();
        for cell in 0..cells.len() {
            cycle.clear();
            for corner in cells.range(cell) {
                let (first, count) = walls.along[corner as usize];
                let forward = walls.segments[first as usize].cells[0] == cell as u32;
                let facet = cells.corners[corner as usize];
                debug_assert!(forward == (facet.side == Half::Positive) || count == 1);
                if forward {
                    cycle.extend((first..first + count).map(|e| 2 * e));
                } else {
                    cycle.extend((first..first + count).rev().map(|e| 2 * e + 1));
                }
            }
            for (i, &h) in cycle.iter().enumerate() {
                let after = cycle[(i + 1) % cycle.len()];
                next[h as usize] = after;
                previous[after as usize] = h;
            }
        }
        close_outside(&mut next, &previous);
        Self { next, origin }
    }

    /// Skips dissolved segments: the borders of what is left.
    pub(super) fn without(&self, dissolved: &[bool]) -> Vec<u32> {
        let gone = |h: u32| dissolved[h as usize / 2];
        (0..self.next.len() as u32)
            .map(|h| {
                let mut after = self.next[h as usize];
                while !gone(h) && gone(after) {
                    after = self.next[(after ^ 1) as usize];
                }
                after
            })
            .collect()
    }
}

/// Links the half-edges beyond the frame: around a vertex until the next one outside is met.
fn close_outside(next: &mut [u32], previous: &[u32]) {
    for h in 0..next.len() as u32 {
        if next[h as usize] != UNSET {
            continue;
        }
        let mut inside = h ^ 1;
        loop {
            let turned = previous[inside as usize];
            // `previous` is unset for what lies outside only.
            if previous[(turned ^ 1) as usize] == UNSET {
                next[h as usize] = turned ^ 1;
                break;
            }
            inside = turned ^ 1;
        }
    }
}

/// Numbers the sets of cells that are left when segments are dissolved; the outside is a set, too.
/// Returned with the number of sets; sets are numbered by their smallest cell.
pub(super) fn merge_cells(cells: usize, walls: &Walls, dissolved: &[bool]) -> (Vec<u32>, u32) {
    let mut parent: Vec<u32> = (0..=cells as u32).collect();
    let place = |cell: u32| if cell == OUTSIDE { cells as u32 } else { cell };
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    for (segment, _) in walls.segments.iter().zip(dissolved).filter(|(_, d)| **d) {
        let [a, b] = segment.cells.map(place);
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b) as usize] = a.min(b);
    }
    let has_outside = walls.segments.iter().any(|s| s.cells[1] == OUTSIDE);
    let mut number = vec![UNSET; cells + 1];
    let mut count = 0;
    for i in 0..(cells + usize::from(has_outside)) as u32 {
        let r = root(&mut parent, i) as usize;
        if number[r] == UNSET {
            number[r] = count;
            count += 1;
        }
        number[i as usize] = number[r];
    }
    (number, count)
}
