//! Plans: scenes of line segments in the plane, on the grid.
//!
//! A plan is built once from the segments of a file. What the file gives as one segment may become
//! several *pieces* (where a corner lies on it, or was moved off it by snapping), and segments that
//! coincide share a piece; so every piece lists its owners. Pieces are sorted by their coordinates:
//! nothing later depends on the order of the input.

mod build;
mod cell;
mod kd;
mod near;

use antumbra_kernel::{Grid, Point2, Rect};

pub use build::{PlanError, PlanOptions};
pub use cell::{CellShape, PlanCell, PlanCellError};
pub use kd::{PlanKd, PlanNode};

/// A segment as a file gives it, in scene units.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanSegment {
    /// Its ends.
    pub ends: [[f64; 2]; 2],
    /// Index of its class in [`PlanInput::classes`].
    pub class: u32,
    /// The feature, element or entity it comes from.
    pub feature: u32,
}

/// A plan as a file gives it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanInput {
    /// The segments; their order gives the ids.
    pub segments: Vec<PlanSegment>,
    /// Names of classes or layers; those of unnamed ones are empty.
    pub classes: Vec<String>,
    /// Names of features; empty where there is none.
    pub features: Vec<String>,
    /// Whether y runs down in the file, as in SVG; only pictures care.
    pub y_down: bool,
    /// The longitude and latitude around which it was projected to metres, if it was.
    pub projected_around: Option<[f64; 2]>,
    /// The `crs` member of GeoJSON, as JSON, if the file has one.
    pub crs: Option<String>,
    /// Notes of the reader for people: what was projected or left out.
    pub notes: Vec<String>,
}

impl PlanInput {
    /// The index of a class, added if it is new.
    pub fn class(&mut self, name: &str) -> u32 {
        let found = self.classes.iter().position(|c| c == name);
        let index = found.unwrap_or_else(|| {
            self.classes.push(name.to_owned());
            self.classes.len() - 1
        });
        index as u32
    }
}

/// Number of an input segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SegmentId(pub u32);

/// Number of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PieceId(pub u32);

/// A segment that a piece belongs to, and where on it the piece lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Owner {
    /// The input segment.
    pub segment: SegmentId,
    /// How far along that segment the piece's ends are, of [`Owner::whole`]: exact, and 0 and all of it at the
    /// segment's own ends.
    pub at: [i64; 2],
    /// The whole segment in the same measure: its squared length, below 2^50.
    pub whole: i64,
}

/// How far along the way from a to b a point is, times the length of the way.
fn along([a, b]: [Point2; 2], p: Point2) -> i64 {
    let ([ax, ay], [bx, by], [px, py]) = (a.to_i64(), b.to_i64(), p.to_i64());
    (px - ax) * (bx - ax) + (py - ay) * (by - ay)
}

/// What was done to the segments of a plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanReport {
    /// Segments whose ends coincide on the grid, and where: they block no open set of lines.
    pub points: Vec<(SegmentId, Point2)>,
    /// Pieces that more than one segment owns.
    pub shared: usize,
    /// Corners put into foreign segments that they touch.
    pub touching: usize,
    /// Corners put into foreign segments less than a grid step away, lest snapping opens a crack.
    pub sealed: usize,
    /// The largest distance that an end moved when it was snapped, in scene units.
    pub moved: f64,
}

/// A plan on the grid.
#[derive(Clone, Debug)]
pub struct Plan {
    grid: Grid,
    segments: usize,
    ends: Vec<[Point2; 2]>,
    occludes: Vec<bool>,
    owners: Vec<Owner>,
    first_owner: Vec<u32>,
    kd: PlanKd,
    report: PlanReport,
}

impl Plan {
    /// The grid.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// How many segments the input has, whatever became of them.
    #[must_use]
    pub fn segment_count(&self) -> usize {
        self.segments
    }

    /// The ends of all pieces, the smaller end first; sorted.
    #[must_use]
    pub fn pieces(&self) -> &[[Point2; 2]] {
        &self.ends
    }

    /// Whether a piece blocks the view.
    ///
    /// # Panics
    /// If there is no such piece.
    #[inline]
    #[must_use]
    pub fn occludes(&self, piece: PieceId) -> bool {
        self.occludes[piece.0 as usize]
    }

    /// The segments that a piece belongs to, by number.
    ///
    /// # Panics
    /// If there is no such piece.
    #[must_use]
    pub fn owners(&self, piece: PieceId) -> &[Owner] {
        let i = piece.0 as usize;
        &self.owners[self.first_owner[i] as usize..self.first_owner[i + 1] as usize]
    }

    /// The kD-tree over the pieces.
    #[must_use]
    pub fn kd(&self) -> &PlanKd {
        &self.kd
    }

    /// The box around all pieces; `None` if there are none.
    #[must_use]
    pub fn bounds(&self) -> Option<Rect> {
        (!self.ends.is_empty()).then(|| self.kd.nodes()[0].bounds)
    }

    /// The segments that are points on the grid.
    #[must_use]
    pub fn points(&self) -> &[(SegmentId, Point2)] {
        &self.report.points
    }

    /// What was done to the input.
    #[must_use]
    pub fn report(&self) -> &PlanReport {
        &self.report
    }

    /// The scene coordinates of a point, for output.
    #[must_use]
    pub fn to_scene(&self, p: Point2) -> [f64; 2] {
        self.to_scene_f64(p.to_f64())
    }

    /// The scene coordinates of a position in fractional grid steps, for output.
    #[must_use]
    pub fn to_scene_f64(&self, p: [f64; 2]) -> [f64; 2] {
        let [x, y, _] = self.grid.to_scene_f64([p[0], p[1], 0.0]);
        [x, y]
    }

    /// Fractional grid coordinates of a scene point, for pictures.
    #[must_use]
    pub fn to_grid_f64(&self, p: [f64; 2]) -> [f64; 2] {
        let [x, y, _] = self.grid.to_grid_f64([p[0], p[1], 0.0]);
        [x, y]
    }

    /// All pieces that meet a closed box, each once, sorted.
    #[must_use]
    pub fn pieces_in(&self, bounds: &Rect) -> Vec<PieceId> {
        let mut found = Vec::new();
        let mut stack = vec![0_u32];
        while let Some(index) = stack.pop() {
            let Some(node) = self.kd.nodes().get(index as usize) else {
                continue;
            };
            if !node.bounds.touches(bounds) {
                continue;
            }
            match node.children() {
                Some(children) => stack.extend(children),
                None => found.extend(
                    self.kd
                        .items(node)
                        .iter()
                        .filter(|p| bounds.meets_segment(self.ends[p.0 as usize])),
                ),
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}
