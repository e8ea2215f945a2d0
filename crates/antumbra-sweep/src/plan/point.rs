//! The lines that leave a point of the plane: the same sweep in a space of one dimension.

use antumbra_kernel::{Point2, Rect, orient2d};
use antumbra_lines::{
    Direction, Leaf, Occluder, OcclusionTree, Pencil, Ray2, SegmentOccluder, Visibility, Wedge,
};

use dashu_int::IBig;

use super::distance;
use super::line::PlanLine;
use super::sweep::{Blocker, Source};
use crate::occlusion::BoxTest;

/// All lines that leave a point.
#[derive(Clone, Debug)]
pub(super) struct PointLines {
    space: Pencil,
    /// Points of segments that are seen edge-on: they block no open set, but no witness may run along them.
    pub(super) grazing: Vec<Point2>,
}

impl PointLines {
    /// The lines from a point.
    #[must_use]
    pub(super) fn new(eye: Point2) -> Self {
        Self {
            space: Pencil::new(eye),
            grazing: Vec::new(),
        }
    }

    fn away(&self, p: Point2) -> [i64; 2] {
        let ([x, y], [ex, ey]) = (p.to_i64(), self.space.eye().to_i64());
        [x - ex, y - ey]
    }

    /// All directions in four quarters.
    pub(super) fn roots(&mut self) -> Vec<Wedge> {
        let quarters = [[1, 0], [0, 1], [-1, 0], [0, -1]];
        (0..4)
            .map(|k| self.space.wedge(quarters[k], quarters[(k + 1) % 4]))
            .collect()
    }

    /// The wedge around a convex outline that does not hold the eye; `None` if it is seen edge-on.
    fn around(&mut self, corners: &[Point2]) -> Option<Wedge> {
        let eye = self.space.eye();
        let extreme = |left: bool| {
            corners.iter().copied().reduce(|best, c| {
                let s = orient2d(eye, best, c);
                if (left && s > 0) || (!left && s < 0) {
                    c
                } else {
                    best
                }
            })
        };
        let (right, left) = (extreme(false)?, extreme(true)?);
        (orient2d(eye, right, left) > 0).then(|| {
            let (right, left) = (self.away(right), self.away(left));
            self.space.wedge(right, left)
        })
    }
}

impl Source for PointLines {
    type Space = Pencil;

    fn space(&mut self) -> &mut Pencil {
        &mut self.space
    }

    fn tree_count(&self) -> usize {
        1
    }

    fn bounds(&self) -> Rect {
        let eye = self.space.eye();
        Rect { min: eye, max: eye }
    }

    fn meets_rect(&self, rect: &Rect) -> bool {
        rect.touches(&self.bounds())
    }

    fn blockers(&mut self, [p, q]: [Point2; 2], key: u32, out: &mut Vec<Blocker<Wedge>>) {
        let side = orient2d(self.space.eye(), p, q);
        // A segment seen edge-on, or with the eye on it, blocks no open set of lines.
        if side == 0 {
            let other = if p == self.space.eye() { q } else { p };
            self.grazing.push(other);
            return;
        }
        let (right, left) = if side > 0 { (p, q) } else { (q, p) };
        let piece = {
            let (r, l) = (self.away(right), self.away(left));
            self.space.wedge(r, l)
        };
        let occluder = self.space.occluder(SegmentOccluder { left, right, key });
        out.push(Blocker {
            tree: 0,
            window: 0,
            piece,
            occluder,
            range: distance::range([self.space.eye(); 2], [p, q]),
        });
    }

    fn occluder_count(&self) -> usize {
        self.space.filled().1
    }

    fn forget(&mut self, from: usize) {
        let (directions, _) = self.space.filled();
        self.space.rewind((directions, from));
    }

    fn sees(&mut self, trees: &[OcclusionTree<Direction>], bounds: &Rect, test: BoxTest) -> bool {
        let corners = bounds.corners();
        let filled = self.space.filled();
        let Some(wedge) = self.around(&corners) else {
            // A flat box seen edge-on: no open set of lines meets it.
            return false;
        };
        let behind = |space: &Pencil, old: Occluder| {
            let segment = space.segment(old);
            corners.iter().all(|&c| segment.depth(c) >= 0)
        };
        let eye = self.space.eye().to_i64();
        let middle = [
            i64::from(bounds.min.x) + i64::from(bounds.max.x) - 2 * eye[0],
            i64::from(bounds.min.y) + i64::from(bounds.max.y) - 2 * eye[1],
        ];
        let seen = match trees[0].leaf_at(&self.space, &self.space.ray(middle)) {
            Leaf::Open => true,
            Leaf::Outside => false,
            Leaf::Blocked(old) => !behind(&self.space, old),
        };
        let near = (0..4).map(|k| {
            let side = [corners[k], corners[(k + 1) % 4]];
            distance::range([self.space.eye(); 2], side).near
        });
        let near = near.min().unwrap_or(0);
        let state = if seen {
            Visibility::Partial
        } else if test == BoxTest::Exact {
            trees[0].test_region_at(&mut self.space, wedge, near, |space, _, old| {
                if behind(space, old) {
                    Visibility::Invisible
                } else {
                    Visibility::Partial
                }
            })
        } else {
            trees[0].test_without_splitting_at(&self.space, &wedge, near, |old| {
                behind(&self.space, old)
            })
        };
        self.space.rewind(filled);
        state != Visibility::Invisible
    }

    fn line(&self, ray: &Ray2) -> PlanLine {
        let [ex, ey] = self.space.eye().to_i64().map(i128::from);
        let [dx, dy] = ray.exact;
        PlanLine::new([-dy, dx, ex * dy - ey * dx].map(IBig::from))
    }

    fn is_behind(&self, occluder: Occluder, points: &[Point2]) -> bool {
        let segment = self.space.segment(occluder);
        points.iter().all(|&p| segment.depth(p) >= 0)
    }

    fn segment(&self, occluder: Occluder) -> &SegmentOccluder {
        self.space.segment(occluder)
    }
}
