//! The lines that leave a convex cell of the plane, by the edge through which they leave.
//!
//! After [Bittner02, 6.4 and 6.5.2]. The lines that leave through an edge from a to b of a
//! counter-clockwise cell have a on their right and b on their left: a lune of line space, bounded by two
//! hyperplanes. What an occluder blocks of them is a cone with three or four facets, or two such cones if
//! lines pass the occluder both ways. An occluder that lies along the edge blocks all lines through a
//! part of it; that part is taken out of the edge, and what is left are the *windows* of the cell.

use antumbra_kernel::{Point2, Rect, crossing2d, line2d, orient2d};
use antumbra_lines::{
    Cone3, Corner3, Facet, Half, Leaf, LineSpace, Occluder, OcclusionTree, Plane3, PlaneLines,
    Ray3, SegmentOccluder, Visibility, Wall, facet,
};
use antumbra_scene::plan::{CellShape, Plan};

use super::distance;
use super::line::PlanLine;
use super::sweep::{Blocker, Source};
use crate::occlusion::BoxTest;

/// A part of a cell's edge through which lines leave; the cell is on the left of the way from a to b.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// On the right of the lines.
    pub a: Point2,
    /// On their left.
    pub b: Point2,
}

impl Window {
    /// How far a point is beyond the window's line: positive outside the cell. 51 bits.
    #[inline]
    #[must_use]
    pub fn beyond(&self, p: Point2) -> i64 {
        -orient2d(self.a, self.b, p)
    }

    /// Whether the box around the window holds a point.
    fn spans(&self, p: Point2) -> bool {
        let between = |a: i32, b: i32, v: i32| a.min(b) <= v && v <= a.max(b);
        between(self.a.x, self.b.x, p.x) && between(self.a.y, self.b.y, p.y)
    }
}

/// The facets of a window's lune belong to the problem and need no node.
const FRAME: Wall = Wall(u32::MAX - 1);

/// All lines that leave a cell.
#[derive(Clone, Debug)]
pub(super) struct RegionLines {
    space: PlaneLines,
    cell: CellShape,
    bounds: Rect,
    windows: Vec<Window>,
    /// The hyperplanes of a and b.
    frames: Vec<[Plane3; 2]>,
    one_tree: bool,
    /// For each window, the ends of segments inside the cell that lie on it: they block no open set, but no witness
    /// may pass them.
    pub(super) grazing: Vec<Vec<Point2>>,
}

impl RegionLines {
    /// The lines that leave a region or a segment, in one tree or one for each window.
    #[must_use]
    pub(super) fn new(plan: &Plan, cell: CellShape, one_tree: bool) -> Self {
        let windows = windows(plan, &cell);
        let mut space = PlaneLines::new();
        let frames = windows
            .iter()
            .map(|w| [space.point(w.a), space.point(w.b)])
            .collect();
        Self {
            space,
            bounds: cell.bounds(),
            cell,
            grazing: vec![Vec::new(); windows.len()],
            windows,
            frames,
            one_tree,
        }
    }

    /// The windows.
    #[must_use]
    pub(super) fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// The point of a hyperplane.
    pub(super) fn point_of(&self, plane: Plane3) -> [i128; 3] {
        self.space.point_of(plane)
    }

    /// The tree of a window.
    #[must_use]
    pub(super) fn tree_of(&self, window: usize) -> usize {
        if self.one_tree { 0 } else { window }
    }

    /// The lune of a window in two pointed cones, cut by the first hyperplane of its tree whose point is
    /// outside; none if there is no such hyperplane, and then nothing is blocked.
    pub(super) fn roots(&mut self, window: usize, tree: &OcclusionTree<Plane3>) -> Vec<Cone3> {
        let [a, b] = self.frames[window];
        // The edge's own line, from a to b, has the outside on its right.
        let edge = self.space.meet(a, b);
        let outside = tree
            .nodes()
            .iter()
            .map(|n| n.plane)
            .find(|&p| self.space.sign(p, &edge).is_negative());
        let Some(p) = outside else {
            return Vec::new();
        };
        [Half::Positive, Half::Negative]
            .map(|side| self.triangle(window, facet(p, side)))
            .into()
    }

    /// The lines of a window that have a point outside on one side. It must be strictly outside.
    fn triangle(&mut self, window: usize, outer: Facet<Plane3>) -> Cone3 {
        let [a, b] = self.frames[window];
        let wall = if self.one_tree { Wall::NONE } else { FRAME };
        let frame = |plane, side| Facet { plane, side, wall };
        let (a, b) = (frame(a, Half::Negative), frame(b, Half::Positive));
        // With inward rows -a, b, p: det = -orient(a, b, p), positive outside; with -p it turns.
        if outer.side == Half::Positive {
            self.space.cone_of(&[a, b, outer])
        } else {
            self.space.cone_of(&[b, a, outer])
        }
    }

    /// The lines of a window that pass between two points, the first on their left. One of them is
    /// strictly outside; one that is not may be anywhere on its hyperplane's far side.
    fn between(
        &mut self,
        window: usize,
        left: (Plane3, bool),
        right: (Plane3, bool),
    ) -> Option<Cone3> {
        let (left, left_outside) = left;
        let (right, _) = right;
        let (first, second) = if left_outside {
            (facet(left, Half::Positive), facet(right, Half::Negative))
        } else {
            (facet(right, Half::Negative), facet(left, Half::Positive))
        };
        let cone = self.triangle(window, first);
        self.keep(cone, second)
    }

    /// The part of a cone inside a half-space.
    fn keep(&mut self, cone: Cone3, half: Facet<Plane3>) -> Option<Cone3> {
        use antumbra_lines::Cut;
        match self.space.cut(cone, half.plane, Wall::NONE) {
            Cut::Whole(side, cone) if side == half.side => Some(cone),
            Cut::Whole(_, cone) => {
                self.space.discard(cone);
                None
            }
            Cut::Parts(parts) => {
                let [negative, positive] = parts;
                let (keep, drop) = match half.side {
                    Half::Negative => (negative, positive),
                    Half::Positive => (positive, negative),
                };
                self.space.discard(drop);
                Some(keep)
            }
        }
    }

    /// What a segment blocks of a window's lines: of all, or of those with one end on their left.
    fn block(
        &mut self,
        window: usize,
        [p, q]: [Point2; 2],
        key: u32,
        only: Option<Point2>,
        out: &mut Vec<Blocker<Cone3>>,
    ) {
        let w = self.windows[window];
        let (op, oq) = (w.beyond(p), w.beyond(q));
        if op <= 0 && oq <= 0 {
            if key >= SegmentOccluder::SIDE {
                return;
            }
            let on = [(p, op), (q, oq)]
                .into_iter()
                .filter(|e| e.1 == 0 && w.spans(e.0));
            self.grazing[window].extend(on.map(|e| e.0));
            return;
        }
        // c is strictly outside; d is, too, or on the window's line, or inside.
        let (c, d, od) = if op > 0 { (p, q, oq) } else { (q, p, op) };
        let (sa, sb) = (orient2d(c, d, w.a), orient2d(c, d, w.b));
        // A source on the left of the way from c to d has d on the left of its lines.
        let from_left = sa > 0 || sb > 0;
        let from_right = sa < 0 || sb < 0;
        let both = from_left && from_right;
        let plane_c = self.space.point(c);
        let far = if od >= 0 {
            Some(self.space.point(d))
        } else if both {
            // The segment enters through the window: what is outside ends in their crossing.
            let k = crossing2d([c, d], [w.a, w.b]);
            Some(self.space.crossing(k))
        } else {
            // It enters beside the window, whose lines never pass that end.
            None
        };
        for left in [false, true] {
            let other = only.is_some_and(|p| p != if left { c } else { d });
            if other || !(if left { from_right } else { from_left }) {
                continue;
            }
            // `left`: c is on the left of the lines.
            let cone = match far {
                Some(far) => {
                    let (near, far) = ((plane_c, true), (far, false));
                    if left {
                        self.between(window, near, far)
                    } else {
                        self.between(window, far, near)
                    }
                }
                None => {
                    let side = if left { Half::Positive } else { Half::Negative };
                    Some(self.triangle(window, facet(plane_c, side)))
                }
            };
            let Some(piece) = cone else { continue };
            let (left, right) = if left { (c, d) } else { (d, c) };
            let occluder = self.space.occluder(SegmentOccluder { left, right, key });
            out.push(Blocker {
                tree: self.tree_of(window),
                window,
                piece,
                occluder,
                range: distance::range([w.a, w.b], [c, d]),
            });
        }
    }

    /// Whether a box may be seen through a window: without splitting, by the four tangents
    /// [Bittner02, 6.5.4].
    fn seen_through(&mut self, window: usize, tree: &OcclusionTree<Plane3>, bounds: &Rect) -> bool {
        let w = self.windows[window];
        let corners = bounds.corners();
        let beyond = corners.map(|c| w.beyond(c));
        if beyond.iter().all(|&o| o <= 0) {
            return false;
        }
        let Some(cone) = self.hull(window, &corners, &beyond) else {
            return true;
        };
        let space = &self.space;
        let near = (0..4).map(|k| {
            let side = [corners[k], corners[(k + 1) % 4]];
            distance::range([w.a, w.b], side).near
        });
        let near = near.min().unwrap_or(0);
        let hidden = |old| behind(space, old, &corners);
        let state = tree.test_without_splitting_at(space, &cone, near, hidden);
        self.space.discard(cone);
        state != Visibility::Invisible
    }

    /// One line, from the middle of the window to the middle of the box: most boxes that are seen are
    /// seen there.
    fn middle_seen(&mut self, window: usize, tree: &OcclusionTree<Plane3>, bounds: &Rect) -> bool {
        let w = self.windows[window];
        let sum = |p: Point2, q: Point2| {
            let (p, q) = (p.to_i64(), q.to_i64());
            [p[0] + q[0], p[1] + q[1], 2]
        };
        let target = sum(bounds.min, bounds.max);
        let line = line2d(w.a, w.b);
        let value: i128 = (0..3)
            .map(|k| i128::from(line[k]) * i128::from(target[k]))
            .sum();
        if value >= 0 {
            return false;
        }
        let from = self.space.passing(sum(w.a, w.b));
        let to = self.space.passing(target);
        let ray = self.space.meet(from, to);
        match tree.leaf_at(&self.space, &ray) {
            Leaf::Open => true,
            Leaf::Outside => false,
            Leaf::Blocked(old) => !behind(&self.space, old, &bounds.corners()),
        }
    }

    /// The convex hull of a window's lines that meet a box beyond it: by its rays only, which is all
    /// that a test without splitting reads. `None` if the box surrounds the window.
    fn hull(&mut self, window: usize, corners: &[Point2; 4], beyond: &[i64; 4]) -> Option<Cone3> {
        let w = self.windows[window];
        let [a, b] = self.frames[window];
        // Where the box reaches over the window's line, lines as flat as the line itself meet it.
        let (mut over_left, mut over_right) = (false, false);
        for (i, &c) in corners.iter().enumerate().filter(|&(i, _)| beyond[i] <= 0) {
            for (j, &d) in corners.iter().enumerate() {
                if beyond[j] <= 0 || (i + 2) % 4 == j {
                    continue;
                }
                // A source on the left of the way in has the inner corner on the left of its lines.
                let (sa, sb) = (orient2d(d, c, w.a), orient2d(d, c, w.b));
                over_left |= sa > 0 || sb > 0;
                over_right |= sa < 0 || sb < 0;
            }
        }
        if over_left && over_right {
            return None;
        }
        let mut rays = Vec::with_capacity(4);
        for (from, plane) in [(w.a, a), (w.b, b)] {
            for left in [true, false] {
                if left && over_left || !left && over_right {
                    continue;
                }
                let mut best: Option<Point2> = None;
                for (i, &c) in corners.iter().enumerate() {
                    if beyond[i] <= 0 {
                        continue;
                    }
                    let turns = |b: Point2| {
                        let s = orient2d(from, b, c);
                        if left { s > 0 } else { s < 0 }
                    };
                    if best.is_none_or(turns) {
                        best = Some(c);
                    }
                }
                let [x, y] = best?.to_i64();
                let to = self.space.passing([x, y, 1]);
                rays.push(self.space.meet(plane, to));
            }
        }
        if over_left || over_right {
            // On the left there are lines toward b along the edge, on the right toward a.
            rays.push(if over_left {
                self.space.meet(a, b)
            } else {
                self.space.meet(b, a)
            });
        }
        Some(Cone3 {
            corners: rays
                .into_iter()
                .map(|ray| Corner3 {
                    ray,
                    plane: a,
                    side: Half::Positive,
                    wall: Wall::NONE,
                })
                .collect(),
        })
    }

    /// Exactly, whether a box could be seen through a window: by the lines that enter it through its
    /// sides that face the window.
    fn seen_exactly(&mut self, window: usize, tree: &OcclusionTree<Plane3>, bounds: &Rect) -> bool {
        let corners = bounds.corners();
        let mut sides = Vec::new();
        for k in 0..4 {
            let side = [corners[k], corners[(k + 1) % 4]];
            let w = self.windows[window];
            // The box is on the left of each side: lines enter where the window is on the right.
            let facing = [w.a, w.b]
                .iter()
                .any(|&p| orient2d(side[0], side[1], p) < 0);
            if facing && side[0] != side[1] {
                // Lines that enter have the first corner on their left.
                self.block(
                    window,
                    side,
                    SegmentOccluder::SIDE,
                    Some(side[0]),
                    &mut sides,
                );
            }
        }
        let mut seen = false;
        for Blocker {
            piece,
            occluder,
            range,
            ..
        } in sides
        {
            if seen {
                self.space.discard(piece);
                continue;
            }
            let state = tree.test_at(&mut self.space, piece, occluder, range.near);
            seen = state != Visibility::Invisible;
        }
        seen
    }
}

/// Whether a box lies behind an occluder, or on its line.
fn behind(space: &PlaneLines, old: Occluder, corners: &[Point2; 4]) -> bool {
    let segment = space.segment(old);
    corners.iter().all(|&c| segment.depth(c) >= 0)
}

impl Source for RegionLines {
    type Space = PlaneLines;

    fn space(&mut self) -> &mut PlaneLines {
        &mut self.space
    }

    fn tree_count(&self) -> usize {
        if self.one_tree { 1 } else { self.windows.len() }
    }

    fn bounds(&self) -> Rect {
        self.bounds
    }

    fn meets_rect(&self, rect: &Rect) -> bool {
        self.cell.meets_rect(rect)
    }

    fn blockers(&mut self, piece: [Point2; 2], key: u32, out: &mut Vec<Blocker<Cone3>>) {
        for window in 0..self.windows.len() {
            self.block(window, piece, key, None, out);
        }
    }

    fn occluder_count(&self) -> usize {
        self.space.occluder_count()
    }

    fn forget(&mut self, from: usize) {
        self.space.forget(Occluder(from as u32));
    }

    fn sees(&mut self, trees: &[OcclusionTree<Plane3>], bounds: &Rect, test: BoxTest) -> bool {
        (0..self.windows.len()).any(|window| {
            let tree = &trees[self.tree_of(window)];
            let mark = self.space.mark();
            let middle = self.middle_seen(window, tree, bounds);
            self.space.rewind(mark);
            if middle {
                return true;
            }
            if test == BoxTest::Exact {
                let count = self.space.occluder_count();
                let seen = self.seen_exactly(window, tree, bounds);
                self.space.forget(Occluder(count as u32));
                return seen;
            }
            let seen = self.seen_through(window, tree, bounds);
            self.space.rewind(mark);
            seen
        })
    }

    fn line(&self, ray: &Ray3) -> PlanLine {
        PlanLine::of_small(ray.rounded())
            .unwrap_or_else(|| PlanLine::of_ray(&self.space.exact(ray)))
    }

    fn is_behind(&self, occluder: Occluder, points: &[Point2]) -> bool {
        let segment = self.space.segment(occluder);
        points.iter().all(|&p| segment.depth(p) >= 0)
    }

    fn segment(&self, occluder: Occluder) -> &SegmentOccluder {
        self.space.segment(occluder)
    }
}

/// The parts of the cell's edges along which no occluder lies.
pub(super) fn windows(plan: &Plan, cell: &CellShape) -> Vec<Window> {
    let corners = cell.corners();
    let n = corners.len();
    let mut out = Vec::with_capacity(n);
    for k in 0..n {
        let (a, b) = (corners[k], corners[(k + 1) % n]);
        // Nothing in line with a segment blocks lines that cross it.
        if n == 2 {
            out.push(Window { a, b });
            continue;
        }
        open_parts(plan, a, b, &mut out);
    }
    out
}

fn open_parts(plan: &Plan, a: Point2, b: Point2, out: &mut Vec<Window>) {
    let Some(around) = Rect::around([a, b]) else {
        return;
    };
    let along = |p: Point2| {
        let ([ax, ay], [bx, by], [px, py]) = (a.to_i64(), b.to_i64(), p.to_i64());
        (px - ax) * (bx - ax) + (py - ay) * (by - ay)
    };
    let mut flush: Vec<[(i64, Point2); 2]> = plan
        .pieces_in(&around)
        .into_iter()
        .filter(|&id| plan.occludes(id))
        .map(|id| plan.pieces()[id.0 as usize])
        .filter(|ends| ends.iter().all(|&p| orient2d(a, b, p) == 0))
        .map(|[p, q]| {
            let (p, q) = ((along(p), p), (along(q), q));
            if p.0 <= q.0 { [p, q] } else { [q, p] }
        })
        .collect();
    flush.sort_unstable_by_key(|f| f[0].0);
    let mut from = (0, a);
    let end = (along(b), b);
    for [start, stop] in flush {
        if start.0 > from.0 {
            let to = if start.0 < end.0 { start } else { end };
            if from.0 < to.0 {
                out.push(Window { a: from.1, b: to.1 });
            }
        }
        if stop.0 > from.0 {
            from = stop;
        }
    }
    if from.0 < end.0 {
        out.push(Window { a: from.1, b });
    }
}
