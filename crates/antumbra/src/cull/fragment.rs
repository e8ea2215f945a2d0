//! Pieces of polygons and outlines of boxes on their way through the occlusion tree.
//!
//! A fragment is a convex polygon whose vertices know what they came from, so that one that lies on a
//! plane of the tree is recognized exactly. How wrong a vertex can be is said in [`super::bound`].

use super::bound::{TAU, size};

/// An edge that a plane of the tree has made: this bit and the number of the node.
pub(super) const WALL: u32 = 1 << 31;
/// The edge of a box: no line of the scene.
pub(super) const NO_EDGE: u32 = u32::MAX;
/// The makers of a corner.
pub(super) const CORNER: [u32; 2] = [NO_EDGE; 2];
/// The most corners of a fragment.
pub(super) const MAX_CORNERS: usize = 48;
#[derive(Clone, Copy)]
pub(super) struct Vertex {
    pub p: [f64; 3],
    /// Half the width of the doubtful zone.
    pub zone: f64,
    /// The edge that starts here: its number in the polygon, or a wall.
    pub edge: u32,
    /// The edge and the node that met here; no edges for a corner, which is given.
    pub from: [u32; 2],
}

impl Vertex {
    pub(super) const NONE: Self = Self {
        p: [0.0; 3],
        zone: 0.0,
        edge: NO_EDGE,
        from: CORNER,
    };
}

pub(super) const POSITIVE: i8 = 1;
pub(super) const NEGATIVE: i8 = -1;
pub(super) const ON: i8 = 0;
pub(super) const DOUBTFUL: i8 = 2;

/// A box around a point, relative to the eye.
#[derive(Clone, Copy)]
pub(super) struct Block {
    pub center: [f64; 3],
    pub half: [f64; 3],
}

impl Block {
    /// How far it reaches from its center along a direction, times the direction's length.
    #[inline]
    pub(super) fn reach(&self, direction: [f64; 3]) -> f64 {
        direction[0].abs() * self.half[0]
            + direction[1].abs() * self.half[1]
            + direction[2].abs() * self.half[2]
    }

    pub(super) fn zone(&self) -> f64 {
        TAU * (size(self.center) + size(self.half))
    }
}

/// The part of a fragment on one side of a plane, with all of the doubtful zone; returns how many
/// vertices that are.
#[inline]
pub(super) fn clip<const SIDE: i8>(
    old: &[Vertex],
    sides: &[f64],
    signs: &[i8],
    wall: u32,
    out: &mut [Vertex],
) -> usize {
    let sign = f64::from(SIDE);
    let n = old.len();
    let mut count = 0;
    let mut push = |v: Vertex| {
        out[count] = v;
        count += 1;
    };
    let cut = |kept: usize, lost: usize, maker: u32, edge: u32| {
        let (v, w) = (&old[kept], &old[lost]);
        let (f, g) = (sign * sides[kept] + v.zone, sign * sides[lost] + w.zone);
        let t = f / (f - g);
        Vertex {
            p: std::array::from_fn(|k| v.p[k] + t * (w.p[k] - v.p[k])),
            zone: v.zone.max(w.zone),
            edge,
            from: [maker, wall],
        }
    };
    for i in 0..n {
        let j = if i + 1 == n { 0 } else { i + 1 };
        let (v, w) = (signs[i], signs[j]);
        let edge = old[i].edge;
        if v == -SIDE {
            if w != -SIDE && w != ON {
                push(cut(j, i, edge, edge));
            }
        } else if w == -SIDE && v != ON {
            push(old[i]);
            push(cut(i, j, edge, wall));
        } else if v == ON && (w == -SIDE || w == ON) {
            push(Vertex {
                edge: wall,
                ..old[i]
            });
        } else {
            push(old[i]);
        }
    }
    count
}

/// The outline of a box as it is seen from the origin, in order; returns how many corners it has,
/// none from inside.
pub(super) fn outline(block: &Block, out: &mut [Vertex]) -> usize {
    // For each axis: eye below, within or above the box.
    let place = |k: usize| {
        let (c, h) = (block.center[k], block.half[k]);
        if c - h > 0.0 {
            1
        } else if c + h < 0.0 {
            2
        } else {
            0
        }
    };
    let code = place(0) + 3 * place(1) + 9 * place(2);
    let zone = block.zone();
    let corners = outline_of(code);
    for (&corner, v) in corners.iter().zip(out) {
        let p = std::array::from_fn(|k| {
            let h = block.half[k];
            block.center[k] + if corner >> k & 1 == 1 { h } else { -h }
        });
        *v = Vertex {
            p,
            zone,
            edge: NO_EDGE,
            from: CORNER,
        };
    }
    corners.len()
}

/// Corners of a box by number (bit k is the upper side of axis k): its outline by the place of the
/// eye, one digit of base 3 an axis: 1 below, 2 above.
fn outline_of(code: usize) -> &'static [u8] {
    const TABLE: [&[u8]; 27] = [
        &[],
        &[0, 4, 6, 2],
        &[1, 3, 7, 5],
        &[0, 1, 5, 4],
        &[0, 1, 5, 4, 6, 2],
        &[0, 1, 3, 7, 5, 4],
        &[2, 6, 7, 3],
        &[0, 4, 6, 7, 3, 2],
        &[1, 3, 2, 6, 7, 5],
        &[0, 2, 3, 1],
        &[0, 4, 6, 2, 3, 1],
        &[0, 2, 3, 7, 5, 1],
        &[0, 2, 3, 1, 5, 4],
        &[1, 5, 4, 6, 2, 3],
        &[0, 2, 3, 7, 5, 4],
        &[0, 2, 6, 7, 3, 1],
        &[0, 4, 6, 7, 3, 1],
        &[0, 2, 6, 7, 5, 1],
        &[4, 5, 7, 6],
        &[0, 4, 5, 7, 6, 2],
        &[1, 3, 7, 6, 4, 5],
        &[0, 1, 5, 7, 6, 4],
        &[0, 1, 5, 7, 6, 2],
        &[0, 1, 3, 7, 6, 4],
        &[2, 6, 4, 5, 7, 3],
        &[0, 4, 5, 7, 3, 2],
        &[1, 3, 2, 6, 4, 5],
    ];
    TABLE[code]
}
