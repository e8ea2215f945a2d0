//! From a point to its cell: a hierarchy of boxes, stored as it is used.
//!
//! Nodes stand in preorder: the left child of an inner node follows it, the right one is named.
//! A leaf names a run of cells. The order is fixed by the cells alone, so equal cells give equal
//! bytes. Built once by median splits: the depth is at most 32 for any number of cells.

use antumbra_kernel::{Aabb, Point};

use super::cells::Row;
use super::model::PvsCellKind;
use crate::bytes::Cursor;

/// Cells in a leaf at most. Two or four made no difference to the time of a lookup.
const LEAF: usize = 4;
const NODE: usize = 32;
const DEEPEST: usize = 48;

/// The stored hierarchy, checked once when a file is opened.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shape {
    nodes: usize,
    items: usize,
}

/// Encodes the hierarchy over the boxes among some cells.
pub(super) fn encode(cells: &[(Aabb, PvsCellKind)]) -> Vec<u8> {
    let mut order: Vec<u32> = (0..cells.len() as u32)
        .filter(|i| cells[*i as usize].1 == PvsCellKind::Box)
        .collect();
    let mut nodes = Vec::new();
    if !order.is_empty() {
        build(cells, &mut order, 0, &mut nodes);
    }
    let mut out = ((nodes.len() / NODE) as u32).to_le_bytes().to_vec();
    out.extend((order.len() as u32).to_le_bytes());
    out.extend(nodes);
    out.extend(order.iter().flat_map(|i| i.to_le_bytes()));
    out
}

fn build(cells: &[(Aabb, PvsCellKind)], order: &mut [u32], first: u32, nodes: &mut Vec<u8>) {
    let bounds = |i: u32| cells[i as usize].0;
    let all = order.iter().map(|i| bounds(*i)).reduce(Aabb::union);
    let Some(all) = all else { return };
    let at = nodes.len();
    for c in [all.min, all.max].into_iter().flat_map(Point::to_array) {
        nodes.extend(c.to_le_bytes());
    }
    if order.len() <= LEAF {
        order.sort_unstable();
        nodes.extend(first.to_le_bytes());
        nodes.extend((order.len() as u32).to_le_bytes());
        return;
    }
    let extent = all.extent();
    let axis = (0..3).max_by_key(|k| (extent[*k], 2 - *k)).unwrap_or(0);
    order.sort_unstable_by_key(|i| (bounds(*i).center_doubled()[axis], *i));
    let middle = order.len() / 2;
    let (left, right) = order.split_at_mut(middle);
    nodes.extend([0; 8]);
    build(cells, left, first, nodes);
    let right_node = ((nodes.len()) / NODE) as u32;
    nodes[at + 24..at + 28].copy_from_slice(&right_node.to_le_bytes());
    build(cells, right, first + middle as u32, nodes);
}

/// Checks that the bytes are one tree over each box cell once, so that a lookup always ends.
pub(super) fn check(bytes: &[u8], rows: &[Row]) -> Option<Shape> {
    let mut cursor = Cursor::new(bytes);
    let shape = Shape {
        nodes: cursor.u32()? as usize,
        items: cursor.u32()? as usize,
    };
    let size = shape
        .nodes
        .checked_mul(NODE)?
        .checked_add(shape.items.checked_mul(4)?)?;
    let boxes = rows
        .iter()
        .filter(|row| row.kind == PvsCellKind::Box)
        .count();
    if cursor.remaining() != size || shape.items != boxes {
        return None;
    }
    // In preorder, the next node met must be the next one stored.
    let (mut next_node, mut next_item) = (0, 0);
    let mut open = if shape.nodes > 0 {
        vec![(0_usize, 0_usize)]
    } else {
        Vec::new()
    };
    while let Some((index, depth)) = open.pop() {
        if index != next_node || index >= shape.nodes || depth > DEEPEST {
            return None;
        }
        next_node += 1;
        let node = Node::read(bytes, index)?;
        if node.count == 0 {
            open.push((node.link as usize, depth + 1));
            open.push((index + 1, depth + 1));
            continue;
        }
        if node.link as usize != next_item {
            return None;
        }
        next_item = next_item
            .checked_add(node.count as usize)
            .filter(|n| *n <= shape.items)?;
    }
    let mut seen = vec![false; rows.len()];
    for i in 0..shape.items {
        let cell = shape.item(bytes, i)? as usize;
        let is_box = rows.get(cell)?.kind == PvsCellKind::Box;
        if !is_box || std::mem::replace(&mut seen[cell], true) {
            return None;
        }
    }
    (next_node == shape.nodes && next_item == shape.items).then_some(shape)
}

struct Node {
    min: [i32; 3],
    max: [i32; 3],
    /// The right child, or the first item of a leaf.
    link: u32,
    /// Zero for an inner node.
    count: u32,
}

impl Node {
    fn read(bytes: &[u8], index: usize) -> Option<Self> {
        let mut cursor = Cursor::new(bytes.get(8 + NODE * index..)?);
        let mut three = || Some([cursor.i32()?, cursor.i32()?, cursor.i32()?]);
        Some(Self {
            min: three()?,
            max: three()?,
            link: cursor.u32()?,
            count: cursor.u32()?,
        })
    }

    fn contains(&self, p: [i32; 3]) -> bool {
        (0..3).all(|k| self.min[k] <= p[k] && p[k] <= self.max[k])
    }
}

impl Shape {
    fn item(self, bytes: &[u8], index: usize) -> Option<u32> {
        Cursor::new(bytes.get(8 + NODE * self.nodes + 4 * index..)?).u32()
    }

    /// The first of the cells whose closed box contains a grid point.
    pub(super) fn find(self, bytes: &[u8], rows: &[Row], p: Point) -> Option<u32> {
        let point = p.to_array();
        let mut best: Option<u32> = None;
        let mut open = [0_usize; DEEPEST + 2];
        let mut top = usize::from(self.nodes > 0);
        while top > 0 {
            top -= 1;
            let index = open[top];
            let node = Node::read(bytes, index)?;
            if !node.contains(point) {
                continue;
            }
            if node.count == 0 {
                open[top] = node.link as usize;
                open[top + 1] = index + 1;
                top += 2;
                continue;
            }
            for i in 0..node.count as usize {
                let cell = self.item(bytes, node.link as usize + i)?;
                let bounds = rows[cell as usize].bounds;
                if bounds.contains(&Aabb { min: p, max: p }) && best.is_none_or(|b| cell < b) {
                    best = Some(cell);
                }
            }
        }
        best
    }
}
