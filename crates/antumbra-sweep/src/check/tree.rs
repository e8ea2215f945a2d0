//! Walks the tree of a pair of gates: cuts where it says so, and checks what its leaves say.

use std::ops::Range;

use antumbra_kernel::{Plane, Sign};
use antumbra_scene::{PolygonId, PolygonRef, Scene};

use super::cone::Trouble;
use super::ends::Gate;
use super::piece::Piece;
use super::rows::Hyperplane;
use crate::RowName;
use crate::proof::{Node, Tree};

/// The lines that a tree is about, and the rules for them.
pub(super) struct Question<'a> {
    pub scene: &'a Scene,
    /// The gate that lines leave.
    pub from: &'a Gate,
    /// The gate that they cross later.
    pub to: &'a Gate,
    /// Whether occluders in the plane of the first gate block.
    pub source_plane_blocks: bool,
    /// Polygons that take no part.
    pub absent: &'a Range<u32>,
    /// Whether pieces may be ignored.
    pub may_ignore: bool,
}

/// A part of the tree still to be walked.
struct Pending {
    /// `None` if it has no interior: then everything is true of it.
    piece: Option<Piece>,
    /// How many rows of the path lead to its parent.
    depth: usize,
    /// The last row of its path.
    last: Option<Hyperplane>,
}

/// Checks a tree.
///
/// # Errors
/// What is wrong, with the number of the node.
pub(super) fn check_tree(question: &Question<'_>, tree: &Tree) -> Result<(), String> {
    let starts = Piece::all_between(question.from, question.to)
        .map_err(|trouble| format!("the start cone cannot be built ({trouble:?})"))?;
    for start in starts {
        walk(question, tree, start)?;
    }
    Ok(())
}

fn walk(question: &Question<'_>, tree: &Tree, start: Piece) -> Result<(), String> {
    let mut nodes = tree.nodes.iter().enumerate();
    let mut path: Vec<Hyperplane> = Vec::new();
    let mut pending = vec![Pending {
        piece: Some(start),
        depth: 0,
        last: None,
    }];
    while let Some(Pending { piece, depth, last }) = pending.pop() {
        let Some((number, node)) = nodes.next() else {
            return Err(format!("the tree ends after {} nodes", tree.nodes.len()));
        };
        path.truncate(depth);
        path.extend(last);
        let Node::Split { row, negative } = *node else {
            if let Some(piece) = piece {
                check_leaf(question, node, &piece, &path)
                    .map_err(|what| format!("node {number}: {what}"))?;
            }
            continue;
        };
        let mut parts = [None, None];
        let mut rows = [None, None];
        if let Some(piece) = piece {
            let row = question
                .hyperplane(row)
                .map_err(|what| format!("node {number}: {what}"))?
                .turned(negative);
            parts = piece.cut(&row).map_err(|trouble| {
                format!("node {number}: the piece cannot be cut ({trouble:?})")
            })?;
            rows = [Some(row.clone()), Some(row.turned(true))];
        }
        let depth = path.len();
        for (piece, last) in parts.into_iter().zip(rows).rev() {
            pending.push(Pending { piece, depth, last });
        }
    }
    match nodes.next() {
        Some((number, _)) => Err(format!("node {number} is beyond the end of the tree")),
        None => Ok(()),
    }
}

fn check_leaf(
    question: &Question<'_>,
    node: &Node,
    piece: &Piece,
    path: &[Hyperplane],
) -> Result<(), String> {
    let tightest = || Piece::tightest(question.from, question.to, path);
    match *node {
        Node::Split { .. } => Ok(()),
        Node::Ignored if question.may_ignore => Ok(()),
        Node::Ignored => Err("a piece is ignored, but the bake was not allowed to".into()),
        Node::Imaginary => {
            if !piece.holds_real_lines() || settled(tightest(), |p| !p.holds_real_lines()) {
                Ok(())
            } else {
                Err("the piece is called imaginary but holds an open set of real lines".into())
            }
        }
        Node::Blocked { polygon, negative } => {
            let rows = question.blocked_rows(polygon, negative)?;
            for (row, name) in &rows {
                if !piece.within(row) && !settled(tightest(), |p| p.within(row)) {
                    let way = if negative { "against" } else { "along" };
                    return Err(format!(
                        "polygon {} is said to block all lines of the piece {way} its normal, but some pass outside {name}",
                        polygon.0
                    ));
                }
            }
            Ok(())
        }
    }
}

/// Whether the tightest piece has a property; without interior it has all.
fn settled(piece: Result<Option<Piece>, Trouble>, holds: impl Fn(&Piece) -> bool) -> bool {
    match piece {
        Ok(Some(piece)) => holds(&piece),
        Ok(None) => true,
        Err(_) => false,
    }
}

impl Question<'_> {
    fn polygon(&self, id: PolygonId) -> Result<PolygonRef<'_>, String> {
        if id.index() < self.scene.polygon_count() {
            Ok(self.scene.polygon(id))
        } else {
            Err(format!("the scene has no polygon {}", id.0))
        }
    }

    fn hyperplane(&self, name: RowName) -> Result<Hyperplane, String> {
        match name {
            RowName::Edge { polygon, edge } => {
                let corners = self.polygon(polygon)?.corners;
                let i = edge as usize;
                match corners.get(i) {
                    Some(&u) => Ok(Hyperplane::edge(u, corners[(i + 1) % corners.len()])),
                    None => Err(format!("polygon {} has no edge {edge}", polygon.0)),
                }
            }
            RowName::SourceLine { polygon } => {
                let plane = self.polygon(polygon)?.plane;
                Ok(Hyperplane::common_line(&self.from.plane, plane))
            }
            RowName::TargetLine { polygon } => {
                let plane = self.polygon(polygon)?.plane;
                Ok(Hyperplane::common_line(&self.to.plane.flipped(), plane))
            }
            RowName::Chord { from, to } => {
                let corner = |gate: &Gate, i: u32| gate.corners.get(i as usize).copied();
                match (corner(self.from, from), corner(self.to, to)) {
                    (Some(a), Some(b)) => Ok(Hyperplane::edge(a, b)),
                    _ => Err(format!("the gates have no corners {from} and {to}")),
                }
            }
        }
    }

    /// The rows that make all lines of a piece cross an occluder in a direction, with what they
    /// are, or why it cannot block.
    fn blocked_rows(
        &self,
        id: PolygonId,
        negative: bool,
    ) -> Result<Vec<(Hyperplane, String)>, String> {
        let polygon = self.polygon(id)?;
        let before_target = self.to.plane.flipped();
        let in_front = sides(&polygon, &self.from.plane);
        let before = sides(&polygon, &before_target);
        self.may_block(&polygon, negative, &in_front, &before)?;

        let mut rows = Vec::new();
        let n = polygon.corners.len();
        for i in 0..n {
            let j = (i + 1) % n;
            if wholly_behind(in_front[i], in_front[j]) || wholly_behind(before[i], before[j]) {
                continue;
            }
            let row = Hyperplane::edge(polygon.corners[i], polygon.corners[j]);
            rows.push((row.turned(negative), format!("its edge {i}")));
        }
        for (sides, gate, base, name) in [
            (&in_front, self.from, &self.from.plane, "its source line"),
            (&before, self.to, &before_target, "its target line"),
        ] {
            if on_both_sides(sides) && gate.straddles(polygon.plane) {
                let row = Hyperplane::common_line(base, polygon.plane);
                rows.push((row.turned(negative), name.into()));
            }
        }
        Ok(rows)
    }

    fn may_block(
        &self,
        polygon: &PolygonRef<'_>,
        negative: bool,
        in_front: &[Sign],
        before: &[Sign],
    ) -> Result<(), String> {
        let id = polygon.id.0;
        if !polygon.occludes || self.absent.contains(&id) {
            return Err(format!("polygon {id} is no occluder of this cell"));
        }
        if before.iter().all(|s| s.is_zero()) {
            return Err(format!("polygon {id} lies in the plane of the target gate"));
        }
        let in_source_plane = in_front.iter().all(|s| s.is_zero());
        let (come_from, go_to) = if negative {
            (Sign::Positive, Sign::Negative)
        } else {
            (Sign::Negative, Sign::Positive)
        };
        if in_source_plane {
            let along = normals_agree(polygon.plane, &self.from.plane);
            if !self.source_plane_blocks || along == negative {
                return Err(format!(
                    "polygon {id} lies in the plane of the source gate and does not block there"
                ));
            }
        } else if !in_front.contains(&Sign::Positive) {
            return Err(format!("polygon {id} lies behind the source gate"));
        } else if !self.from.reaches(polygon.plane, come_from) {
            return Err(format!(
                "no line from the source gate crosses polygon {id} in this direction"
            ));
        }
        if !before.contains(&Sign::Positive) {
            return Err(format!("polygon {id} lies beyond the target gate"));
        }
        if !self.to.reaches(polygon.plane, go_to) {
            return Err(format!(
                "no line to the target gate crosses polygon {id} in this direction"
            ));
        }
        Ok(())
    }
}

fn sides(polygon: &PolygonRef<'_>, plane: &Plane) -> Vec<Sign> {
    polygon.corners.iter().map(|&p| plane.side(p)).collect()
}

/// Whether an edge has both ends on the unwanted side or in the plane, but not both in it.
fn wholly_behind(a: Sign, b: Sign) -> bool {
    !a.is_positive() && !b.is_positive() && (a.is_negative() || b.is_negative())
}

fn on_both_sides(sides: &[Sign]) -> bool {
    sides.contains(&Sign::Positive) && sides.contains(&Sign::Negative)
}

fn normals_agree(a: &Plane, b: &Plane) -> bool {
    (0..3)
        .map(|k| i128::from(a.normal[k]) * i128::from(b.normal[k]))
        .sum::<i128>()
        > 0
}
