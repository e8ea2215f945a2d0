//! Checks what a cell of the plane sees, from coordinates alone, in big integers.
//!
//! *Visible*: the witness of a fragment leaves through its window, meets the piece within the fragment, and no
//! occluder shares a point with it between. *Hidden*: all lines from a window to a segment, or to a box of
//! segments, are cut by the points of the window's tree; for every part with an interior, the occluder that
//! the tree names meets all its lines beyond the window and before the target. A part that the tree gives
//! to the target itself has to meet it within a fragment that is claimed.

mod cone;
mod hull;

use antumbra_kernel::{Point2, orient2d};
use dashu_int::IBig;

use crate::proof::{PlanProof, PlanProofChild, PlanProofFragment, PlanProofTree};
use cone::{Cone, Line, Side, at, crossing};
use hull::Hull;

/// What was checked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlanCheck {
    /// Fragments whose witness was confirmed.
    pub visible_checked: u64,
    /// Pieces that were confirmed to be hidden but for their fragments.
    pub hidden_checked: u64,
    /// What failed, in words; empty if the certificate holds.
    pub failed: Vec<String>,
}

/// Checks a certificate against the pieces of a plan and whether they block.
#[must_use]
pub fn check_plan(pieces: &[[Point2; 2]], blocks: &[bool], proof: &PlanProof) -> PlanCheck {
    let mut checker = Checker {
        pieces,
        blocks,
        proof,
        hull: Hull::new(pieces),
        report: PlanCheck::default(),
    };
    checker.windows();
    checker.touching();
    for fragment in &proof.fragments {
        match checker.witness(fragment) {
            Ok(()) => checker.report.visible_checked += 1,
            Err(why) => checker.fail(format!("fragment of piece {}: {why}", fragment.piece)),
        }
    }
    checker.hidden();
    checker.report
}

struct Checker<'p> {
    pieces: &'p [[Point2; 2]],
    blocks: &'p [bool],
    proof: &'p PlanProof,
    hull: Hull,
    report: PlanCheck,
}

impl Checker<'_> {
    fn fail(&mut self, why: String) {
        if self.report.failed.len() < 100 {
            self.report.failed.push(why);
        }
    }

    fn edges(&self) -> Vec<[Point2; 2]> {
        let cell = &self.proof.cell;
        let n = cell.len();
        (0..n).map(|i| [cell[i], cell[(i + 1) % n]]).collect()
    }

    /// Windows and occluders along the edges must cover each edge of the cell.
    fn windows(&mut self) {
        let edges = self.edges();
        let n = edges.len();
        let turns = |i: usize| orient2d(edges[i][0], edges[i][1], edges[(i + 1) % n][1]);
        if n < 2 || (n > 2 && (0..n).any(|i| turns(i) <= 0)) {
            self.fail("the cell is not strictly convex and counter-clockwise".to_owned());
            return;
        }
        for (i, &[a, b]) in edges.iter().enumerate() {
            let place = |p: Point2| along([a, b], p);
            let windows = self.proof.windows.iter().map(|w| w.0);
            let windows = windows.filter(|[p, q]| place(*p) < place(*q));
            let walls = self.pieces.iter().zip(self.blocks);
            let walls = walls
                .filter(|(_, blocks)| **blocks && n > 2)
                .map(|(p, _)| *p);
            let mut spans: Vec<(i64, i64)> = windows
                .chain(walls)
                .filter(|[p, q]| orient2d(a, b, *p) == 0 && orient2d(a, b, *q) == 0)
                .map(|[p, q]| (place(p).min(place(q)), place(p).max(place(q))))
                .collect();
            spans.sort_unstable();
            let reached = spans
                .iter()
                .fold(0, |r, s| if s.0 <= r { r.max(s.1) } else { r });
            if reached < place(b) {
                self.fail(format!(
                    "edge {i} of the cell is not covered by windows and walls"
                ));
            }
        }
    }

    fn touching(&mut self) {
        let proof = self.proof;
        for &id in &proof.touching {
            let ok = self
                .pieces
                .get(id as usize)
                .is_some_and(|&p| self.meets_cell(&p));
            if !ok {
                self.fail(format!("piece {id} does not touch the cell"));
            }
        }
    }

    /// Whether the hull of some points, a segment or a box, meets the closed cell; in doubt yes.
    fn meets_cell(&self, points: &[Point2]) -> bool {
        let cell = &self.proof.cell;
        let parted = |[p, q]: [Point2; 2]| points.iter().all(|&c| orient2d(p, q, c) < 0);
        if self.edges().into_iter().any(parted) {
            return false;
        }
        let n = points.len();
        let beside = |i: usize| {
            let (p, q) = (points[i], points[(i + 1) % n]);
            let sides = || cell.iter().map(|&c| orient2d(p, q, c));
            (n == 2 && sides().all(|s| s > 0)) || sides().all(|s| s < 0)
        };
        if (0..n).any(beside) {
            return false;
        }
        let span = |k: usize, points: &[Point2]| {
            let of = points.iter().map(move |p| if k == 0 { p.x } else { p.y });
            (of.clone().min().unwrap_or(0), of.max().unwrap_or(0))
        };
        (0..2).all(|k| {
            let ((a, b), (c, d)) = (span(k, points), span(k, cell));
            a <= d && c <= b
        })
    }

    fn witness(&self, f: &PlanProofFragment) -> Result<(), String> {
        let target = *self
            .pieces
            .get(f.piece as usize)
            .ok_or("there is no such piece")?;
        let window = self.proof.windows.get(f.window as usize);
        let ([a, b], _) = window.ok_or("there is no such window")?;
        let line = Line::new(&f.line);
        if !(line.side(*a) == Side::Right && line.side(*b) == Side::Left) {
            return Err("the line does not leave through its window".to_owned());
        }
        let (p, q) = (at(&f.line, target[0]), at(&f.line, target[1]));
        if (p > IBig::ZERO) == (q > IBig::ZERO) || p == IBig::ZERO || q == IBig::ZERO {
            return Err("the line does not cross the piece".to_owned());
        }
        let (mut n, mut d) = (p.clone(), &p - &q);
        if d < IBig::ZERO {
            (n, d) = (-n, -d);
        }
        let [(ln, ld), (hn, hd)] = &f.at;
        if *ld <= IBig::ZERO || *hd <= IBig::ZERO || ln * &d > &n * ld || &n * hd > hn * &d {
            return Err("the line meets the piece outside of the fragment".to_owned());
        }
        // Places along the line, larger is farther.
        let exit = line.place([*a, *b]);
        let end = line.place(target);
        if !exit.before(&end) {
            return Err("the piece is not beyond the window".to_owned());
        }
        let mut blocked = None;
        self.hull.visit(
            |corners| line.crosses(corners),
            |id| {
                if id == f.piece || !self.blocks[id as usize] || blocked.is_some() {
                    return;
                }
                let piece = self.pieces[id as usize];
                // What lies along a segment does not hide anything from it.
                let flush =
                    self.proof.cell.len() == 2 && piece.iter().all(|&p| orient2d(*a, *b, p) == 0);
                if flush {
                    return;
                }
                if line.meets_between(piece, &exit, &end) {
                    blocked = Some(id);
                }
            },
        );
        match blocked {
            Some(id) => Err(format!("piece {id} is on the way of the line")),
            None => Ok(()),
        }
    }

    /// Everything that is not claimed to be visible must be hidden: whole boxes, if they are.
    fn hidden(&mut self) {
        let hull = std::mem::take(&mut self.hull);
        let mut stack = vec![hull.root()];
        while let Some(node) = stack.pop() {
            let corners = hull.corners(node);
            if !self.meets_cell(&corners) && self.box_is_hidden(&corners) {
                self.report.hidden_checked += hull.count(node) as u64;
                continue;
            }
            match hull.children(node) {
                Some(children) => stack.extend(children),
                None => {
                    for &id in hull.items(node) {
                        self.piece(id);
                    }
                }
            }
        }
        self.hull = hull;
    }

    fn box_is_hidden(&self, corners: &[Point2; 4]) -> bool {
        self.proof.windows.iter().all(|(window, tree)| {
            (0..4).all(|k| {
                let side = [corners[k], corners[(k + 1) % 4]];
                if side[0] == side[1] {
                    return true;
                }
                let cones = Cone::between(*window, side);
                cones.into_iter().all(|(cone, left, right)| {
                    let enters = corners.iter().all(|&c| orient2d(left, right, c) >= 0);
                    !enters || self.hidden_lines(tree, cone, *window, corners, None)
                })
            })
        })
    }

    fn piece(&mut self, id: u32) {
        let piece = self.pieces[id as usize];
        if self.meets_cell(&piece) {
            if !self.proof.touching.contains(&id) {
                self.fail(format!("piece {id} touches the cell and is not listed"));
            }
            return;
        }
        let proof = self.proof;
        let hidden = proof.windows.iter().all(|(window, tree)| {
            Cone::between(*window, piece)
                .into_iter()
                .all(|(cone, ..)| self.hidden_lines(tree, cone, *window, &piece, Some(id)))
        });
        if hidden {
            self.report.hidden_checked += 1;
        } else {
            self.fail(format!("piece {id} is not hidden outside of its fragments"));
        }
    }

    /// Whether all lines of a cone are blocked before the target: a piece, or a box.
    fn hidden_lines(
        &self,
        tree: &PlanProofTree,
        cone: Cone,
        window: [Point2; 2],
        target: &[Point2],
        piece: Option<u32>,
    ) -> bool {
        let mut stack = vec![(tree.root, cone)];
        while let Some((child, cone)) = stack.pop() {
            let ok = match child {
                PlanProofChild::Node(index) => {
                    let Some(node) = tree.nodes.get(index as usize) else {
                        return false;
                    };
                    let later = |c: &PlanProofChild| match c {
                        PlanProofChild::Node(next) => *next > index,
                        _ => true,
                    };
                    if !node.children.iter().all(later) {
                        return false;
                    }
                    let [right, left] = cone.cut(&node.point.map(IBig::from));
                    stack.extend(right.map(|c| (node.children[0], c)));
                    stack.extend(left.map(|c| (node.children[1], c)));
                    true
                }
                PlanProofChild::Blocked(k) if Some(k) != piece => {
                    self.hidden_behind(k, &cone, window, target, piece)
                }
                _ => piece.is_some_and(|id| self.within_fragments(id, &cone)),
            };
            if !ok {
                return false;
            }
        }
        true
    }

    /// Whether an occluder is in front of a target on all lines of a cone, but for what is claimed to be seen.
    fn hidden_behind(
        &self,
        k: u32,
        cone: &Cone,
        window: [Point2; 2],
        target: &[Point2],
        piece: Option<u32>,
    ) -> bool {
        let seen = |cone: &Cone| piece.is_some_and(|id| self.within_fragments(id, cone));
        if seen(cone) {
            return true;
        }
        if self.blocks.get(k as usize) != Some(&true) {
            return false;
        }
        let own = self.pieces[k as usize];
        if cone.blocked_by(own, window, target) {
            return true;
        }
        // A piece that blocks nothing cuts no tree: where the occluder crosses it, the two change places.
        let &[p, q] = target else { return false };
        let parts = cone.clone().cut(&crossing(own, [p, q]));
        let mut parts = parts.iter().flatten();
        parts.all(|part| seen(part) || part.blocked_by(own, window, target))
    }

    fn within_fragments(&self, id: u32, cone: &Cone) -> bool {
        let Some([low, high]) = cone.span_on(self.pieces[id as usize]) else {
            return true;
        };
        let fragments = &self.proof.fragments;
        let first = fragments.partition_point(|f| f.piece < id);
        let own = fragments[first..].iter().take_while(|f| f.piece == id);
        let at_most = |a: &(IBig, IBig), b: &(IBig, IBig)| &a.0 * &b.1 <= &b.0 * &a.1;
        own.into_iter()
            .any(|f| at_most(&f.at[0], &low) && at_most(&high, &f.at[1]))
    }
}

fn along([a, b]: [Point2; 2], p: Point2) -> i64 {
    let ([ax, ay], [bx, by], [px, py]) = (a.to_i64(), b.to_i64(), p.to_i64());
    (px - ax) * (bx - ax) + (py - ay) * (by - ay)
}
