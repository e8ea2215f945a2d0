//! Walks the tree of a pair of gates: cuts where it says so, and checks what its leaves say.

use std::cell::OnceCell;
use std::ops::Range;

use antumbra_kernel::{I256, Plane, Sign};
use antumbra_scene::{PolygonId, PolygonRef, Scene};

use super::cone::Trouble;
use super::ends::Gate;
use super::piece::{Piece, hull};
use super::rows::Hyperplane;
use crate::proof::{Node, RowName, Tree};

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

/// Checks a tree.
///
/// # Errors
/// What is wrong, with the number of the node.
pub(super) fn check_tree(question: &Question<'_>, tree: &Tree) -> Result<(), String> {
    let starts = Piece::all_between(question.from, question.to)
        .map_err(|trouble| format!("the start cone cannot be built ({trouble:?})"))?;
    let hull = OnceCell::new();
    for start in starts {
        Walk {
            question,
            hull: &hull,
        }
        .tree(tree, start)?;
    }
    Ok(())
}

struct Walk<'a> {
    question: &'a Question<'a>,
    /// The facets of the lines' hull, once they are needed.
    hull: &'a OnceCell<Result<Vec<Hyperplane>, Trouble>>,
}

impl Walk<'_> {
    fn tree(&self, tree: &Tree, start: Piece) -> Result<(), String> {
        let mut nodes = tree.nodes.iter().enumerate();
        // Pieces without interior are `None`: everything is true of them.
        let mut pending = vec![Some(start)];
        while let Some(piece) = pending.pop() {
            let Some((number, node)) = nodes.next() else {
                return Err(format!("the tree ends after {} nodes", tree.nodes.len()));
            };
            let at_node = |what| format!("node {number}: {what}");
            match (node, piece) {
                (Node::Split { .. }, None) => pending.extend([None, None]),
                (_, None) => {}
                (&Node::Split { row, negative }, Some(piece)) => {
                    let row = self.question.hyperplane(row).map_err(at_node)?;
                    let [inside, outside] = piece
                        .cut(&row.turned(negative))
                        .map_err(|trouble| format!("the piece cannot be cut ({trouble:?})"))
                        .map_err(at_node)?;
                    pending.extend([outside, inside]);
                }
                (leaf, Some(piece)) => self.leaf(leaf, piece).map_err(at_node)?,
            }
        }
        match nodes.next() {
            Some((number, _)) => Err(format!("node {number} is beyond the end of the tree")),
            None => Ok(()),
        }
    }

    fn leaf(&self, node: &Node, piece: Piece) -> Result<(), String> {
        match *node {
            Node::Split { .. } => Ok(()),
            Node::Ignored if self.question.may_ignore => Ok(()),
            Node::Ignored => Err("a piece is ignored, but the bake was not allowed to".into()),
            Node::Imaginary => {
                if self.settled(piece, |p| !p.holds_real_lines()) {
                    Ok(())
                } else {
                    Err("the piece is called imaginary but holds an open set of real lines".into())
                }
            }
            Node::Blocked { polygon, negative } => {
                let rows = self.question.blocked_rows(polygon, negative)?;
                let Some((_, name)) = rows.iter().find(|(row, _)| !piece.within(row)) else {
                    return Ok(());
                };
                if real_lines_within(piece, rows.iter().map(|(row, _)| row)) {
                    return Ok(());
                }
                let way = if negative { "against" } else { "along" };
                Err(format!(
                    "polygon {} is said to block all lines of the piece {way} its normal, but some pass outside {name}",
                    polygon.0
                ))
            }
        }
    }

    /// Whether a piece has a property, if need be after it was cut by all facets of the hull of
    /// lines.
    fn settled(&self, mut piece: Piece, holds: impl Fn(&Piece) -> bool) -> bool {
        if holds(&piece) {
            return true;
        }
        let question = self.question;
        let hull = self.hull.get_or_init(|| hull(question.from, question.to));
        for facet in hull.iter().flatten() {
            match piece.cut(facet) {
                Ok([Some(inside), _]) => piece = inside,
                Ok([None, _]) => return true,
                Err(_) => return false,
            }
        }
        holds(&piece)
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

    pub(super) fn hyperplane(&self, name: RowName) -> Result<Hyperplane, String> {
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
    pub(super) fn blocked_rows(
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
        if !in_source_plane && !lies_between(polygon, &self.from.plane, &self.to.plane) {
            return Err(format!(
                "polygon {id} has no part both in front of the source gate and before the target gate"
            ));
        }
        if !self.to.reaches(polygon.plane, go_to) {
            return Err(format!(
                "no line to the target gate crosses polygon {id} in this direction"
            ));
        }
        Ok(())
    }
}

/// Whether a polygon has a point strictly in front of one plane and strictly behind another.
///
/// Corners on both wanted sides may exist without such a point; then the edges that are left out
/// bound nothing, and the other rows say nothing about the polygon.
fn lies_between(polygon: &PolygonRef<'_>, front_of: &Plane, behind: &Plane) -> bool {
    let values: Vec<(i128, i128)> = polygon
        .corners
        .iter()
        .map(|&p| (front_of.evaluate(p), -behind.evaluate(p)))
        .collect();
    let next = values.iter().cycle().skip(1);
    values.iter().any(|&(f, _)| f > 0)
        && values.iter().zip(next).any(|(&(f, g), &(h, k))| {
            // The part in front of the first plane is spanned by its corners there and by the
            // points where its edges cross the plane.
            let crosses = f.signum() * h.signum() < 0;
            let weighted = |a: i128, b: i128| I256::product_i128(a.abs(), b);
            f >= 0 && g > 0 || crosses && (weighted(h, g) + weighted(f, k)).sign().is_positive()
        })
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

/// Whether all real lines of a piece satisfy some rows. A row may fail on imaginary points, which
/// depend on the caps that were chosen: the part outside of it must hold no real line.
fn real_lines_within<'a>(mut piece: Piece, rows: impl Iterator<Item = &'a Hyperplane>) -> bool {
    for row in rows {
        if piece.within(row) {
            continue;
        }
        let Ok([inside, outside]) = piece.cut(row) else {
            return false;
        };
        if outside.is_some_and(|part| part.holds_real_lines()) {
            return false;
        }
        match inside {
            Some(part) => piece = part,
            None => return true,
        }
    }
    true
}
