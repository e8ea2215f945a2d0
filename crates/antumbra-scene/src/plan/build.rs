//! From segments of a file to pieces on the grid.
//!
//! After [Hob99]: a corner that lies within a grid step of a foreign segment is put into it, so that
//! snapping opens no crack; but only if one of the two was moved by snapping, so that input on the
//! grid stays as it is. A corner that lies exactly on a segment splits it, which makes segments that
//! overlap coincide piece by piece. Segments that merely cross stay whole: their crossing is named by
//! them, never rounded.

use antumbra_kernel::{Grid, LIMIT, Point2};

use super::kd::PlanKd;
use super::near::{Nearness, Raster, nearness};
use super::{Owner, Plan, PlanInput, PlanReport, SegmentId, along};
use crate::OccluderPolicy;

/// How to build a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanOptions {
    /// The grid step in scene units; the finest power of two that fits if there is none.
    pub grid: Option<f64>,
    /// A box that the grid must hold beside the plan: that of the view cells.
    pub around: Option<([f64; 2], [f64; 2])>,
    /// Which classes block the view.
    pub policy: OccluderPolicy,
    /// About how many pieces a leaf of the kD-tree holds at most.
    pub leaf: usize,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            grid: None,
            around: None,
            policy: OccluderPolicy::Default,
            leaf: 4,
        }
    }
}

/// Why a plan could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// There is no segment.
    #[error("there are no segments: give a plan with at least one line")]
    Empty,
    /// A coordinate is not a number.
    #[error(
        "segment {segment} has the end ({}, {}), but coordinates must be finite: repair or remove it",
        found[0], found[1]
    )]
    NotFinite {
        /// Which one.
        segment: usize,
        /// The end as found.
        found: [f64; 2],
    },
    /// Plan and cells do not fit the grid.
    #[error(
        "plan and cells are {extent} wide, but a grid of {step} holds only {reach}: use a step of {fits} or more"
    )]
    TooWide {
        /// How wide they are.
        extent: f64,
        /// The step that was asked for.
        step: f64,
        /// How much it holds.
        reach: f64,
        /// A step that would do.
        fits: f64,
    },
}

impl Plan {
    /// Snaps the segments of a plan, splits them at the corners on them, merges what coincides, and
    /// builds the kD-tree. `O(n log n)` for evenly spread segments.
    ///
    /// # Errors
    /// If there are no segments, a coordinate is not finite, or the plan does not fit the grid.
    pub fn build(input: &PlanInput, options: &PlanOptions) -> Result<Self, PlanError> {
        let grid = grid_for(input, options)?;
        let occludes: Vec<bool> = input
            .classes
            .iter()
            .map(|c| options.policy.occludes(Some(c), false))
            .collect();
        let mut report = PlanReport::default();
        let snapped = snap(input, &grid, &mut report)?;
        let chains = chains(&snapped, &mut report);
        let mut parts: Vec<Part> = Vec::with_capacity(snapped.len());
        for (i, s) in snapped.iter().enumerate() {
            let class = input.segments[i].class as usize;
            let occludes = occludes.get(class).copied().unwrap_or(true);
            push_parts(&mut parts, i as u32, s, &chains[i], occludes);
        }
        parts.sort_unstable_by_key(|p| (p.ends, p.owner.segment, p.order));
        Ok(assemble(
            parts,
            grid,
            input.segments.len(),
            options.leaf,
            report,
        ))
    }
}

impl Plan {
    /// How many segments of the input it was built from have no length on its grid, but would have one on the finest
    /// that fits the plan alone: what far cells cost.
    #[must_use]
    pub fn lost_to_cells(&self, input: &PlanInput) -> usize {
        let Ok(alone) = grid_for(input, &PlanOptions::default()) else {
            return 0;
        };
        let has_length = |segment: SegmentId| {
            let ends = input.segments.get(segment.0 as usize).map(|s| s.ends);
            ends.is_some_and(|ends| {
                let [a, b] = ends.map(|[x, y]| alone.snap([x, y, 0.0]).ok());
                a != b
            })
        };
        let points = self.points().iter();
        points.filter(|(segment, _)| has_length(*segment)).count()
    }
}

/// A snapped segment.
struct Snapped {
    ends: [Point2; 2],
    moved: [bool; 2],
}

/// A piece of one owner.
struct Part {
    ends: [Point2; 2],
    owner: Owner,
    /// Where it comes along its owner: one that turns back may own a piece twice.
    order: u32,
    occludes: bool,
}

fn grid_for(input: &PlanInput, options: &PlanOptions) -> Result<Grid, PlanError> {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for (i, segment) in input.segments.iter().enumerate() {
        for end in segment.ends {
            if !end.iter().all(|c| c.is_finite()) {
                return Err(PlanError::NotFinite {
                    segment: i,
                    found: end,
                });
            }
            for k in 0..2 {
                low[k] = low[k].min(end[k]);
                high[k] = high[k].max(end[k]);
            }
        }
    }
    if input.segments.is_empty() {
        return Err(PlanError::Empty);
    }
    if let Some((min, max)) = options.around {
        for k in 0..2 {
            low[k] = low[k].min(min[k]);
            high[k] = high[k].max(max[k]);
        }
    }
    let ([x0, y0], [x1, y1]) = (low, high);
    let extent = (x1 - x0).max(y1 - y0);
    let too_wide = |step: f64, fits: f64| PlanError::TooWide {
        extent,
        step,
        reach: 2.0 * step * f64::from(LIMIT),
        fits,
    };
    let finest = Grid::fitting([x0, y0, 0.0], [x1, y1, 0.0])
        .ok_or_else(|| too_wide(options.grid.unwrap_or(1.0), extent / f64::from(LIMIT)))?;
    let Some(step) = options.grid else {
        return Ok(finest);
    };
    // Multiples of the step stay multiples of it, wherever the plan lies.
    let origin = [(x0, x1), (y0, y1)].map(|(a, b)| ((a / 2.0 + b / 2.0) / step).round() * step);
    let half = (0..2).map(|k| (high[k] - origin[k]).max(origin[k] - low[k]));
    let fits = half.fold(0.0, f64::max) / step <= f64::from(LIMIT - 4);
    Grid::new([origin[0], origin[1], 0.0], step)
        .filter(|_| fits)
        .ok_or_else(|| too_wide(step, finest.step()))
}

fn snap(
    input: &PlanInput,
    grid: &Grid,
    report: &mut PlanReport,
) -> Result<Vec<Snapped>, PlanError> {
    let (origin, step) = (grid.origin(), grid.step());
    let mut worst = 0.0_f64;
    let mut out = Vec::with_capacity(input.segments.len());
    for (i, segment) in input.segments.iter().enumerate() {
        let mut ends = [Point2::default(); 2];
        let mut moved = [false; 2];
        for (k, end) in segment.ends.iter().enumerate() {
            let t: [f64; 2] = std::array::from_fn(|j| (end[j] - origin[j]) / step);
            let r = t.map(f64::round);
            if !r.iter().all(|c| c.abs() < f64::from(LIMIT - 2)) {
                return Err(PlanError::NotFinite {
                    segment: i,
                    found: *end,
                });
            }
            ends[k] = Point2::new(r[0] as i32, r[1] as i32);
            moved[k] = t != r;
            worst = worst.max((t[0] - r[0]).hypot(t[1] - r[1]));
        }
        if ends[0] == ends[1] {
            report.points.push((SegmentId(i as u32), ends[0]));
        }
        out.push(Snapped { ends, moved });
    }
    report.moved = worst * step;
    Ok(out)
}

/// The corners put into each segment, in order along it.
fn chains(snapped: &[Snapped], report: &mut PlanReport) -> Vec<Vec<Point2>> {
    let mut corners: Vec<(Point2, bool)> = snapped
        .iter()
        .flat_map(|s| [(s.ends[0], s.moved[0]), (s.ends[1], s.moved[1])])
        .collect();
    // Moved corners first, so that one that moved is what remains of equal ones.
    corners.sort_unstable_by_key(|&(p, moved)| (p, !moved));
    corners.dedup_by_key(|c| c.0);
    let points: Vec<Point2> = corners.iter().map(|c| c.0).collect();
    let raster = Raster::new(&points);
    snapped
        .iter()
        .map(|s| chain(s, &corners, &raster, report))
        .collect()
}

fn chain(
    s: &Snapped,
    corners: &[(Point2, bool)],
    raster: &Raster,
    report: &mut PlanReport,
) -> Vec<Point2> {
    let mut on = Vec::new();
    let mut sealed = 0;
    if s.ends[0] == s.ends[1] {
        return on;
    }
    let segment_moved = s.moved[0] || s.moved[1];
    raster.near(s.ends, |i| {
        let (corner, moved) = corners[i as usize];
        match nearness(s.ends, corner) {
            Nearness::On => on.push(corner),
            Nearness::Close if moved || segment_moved => {
                sealed += 1;
                on.push(corner);
            }
            Nearness::Close | Nearness::Apart => {}
        }
    });
    report.touching += on.len() - sealed;
    report.sealed += sealed;
    sort_along(&mut on, s.ends);
    if sealed > 0 {
        split_bent(&mut on, s.ends, corners, raster);
    }
    on
}

/// After a corner was put in, the pieces run elsewhere: corners exactly on them split them, too.
fn split_bent(
    chain: &mut Vec<Point2>,
    ends: [Point2; 2],
    corners: &[(Point2, bool)],
    raster: &Raster,
) {
    let mut out = Vec::with_capacity(chain.len());
    let mut from = ends[0];
    for &to in chain.iter().chain([&ends[1]]) {
        let mut on = Vec::new();
        raster.near([from, to], |i| {
            let corner = corners[i as usize].0;
            if nearness([from, to], corner) == Nearness::On {
                on.push(corner);
            }
        });
        sort_along(&mut on, [from, to]);
        out.extend(on);
        out.push(to);
        from = to;
    }
    out.pop();
    *chain = out;
}

fn sort_along(points: &mut Vec<Point2>, ends: [Point2; 2]) {
    points.sort_unstable_by_key(|&p| (along(ends, p), p));
    points.dedup();
}

fn push_parts(parts: &mut Vec<Part>, id: u32, s: &Snapped, chain: &[Point2], occludes: bool) {
    let [start, end] = s.ends;
    if start == end {
        return;
    }
    let whole = along(s.ends, end);
    // Corners put in from the side may lie beyond the ends.
    let at = |p: Point2| along(s.ends, p).clamp(0, whole);
    let mut from = start;
    for (order, &to) in chain.iter().chain([&end]).enumerate() {
        let (mut ends, mut t) = ([from, to], [at(from), at(to)]);
        if to < from {
            ends.reverse();
            t.reverse();
        }
        let owner = Owner {
            segment: SegmentId(id),
            at: t,
            whole,
        };
        parts.push(Part {
            ends,
            owner,
            order: order as u32,
            occludes,
        });
        from = to;
    }
}

fn assemble(
    parts: Vec<Part>,
    grid: Grid,
    segments: usize,
    leaf: usize,
    mut report: PlanReport,
) -> Plan {
    let (mut ends, mut occludes, mut first_owner): (Vec<[Point2; 2]>, Vec<bool>, Vec<u32>) =
        Default::default();
    let mut owners = Vec::with_capacity(parts.len());
    for part in parts {
        if ends.last() != Some(&part.ends) {
            ends.push(part.ends);
            occludes.push(false);
            first_owner.push(owners.len() as u32);
        }
        // A piece blocks if one of its owners does.
        if let Some(last) = occludes.last_mut() {
            *last |= part.occludes;
        }
        owners.push(part.owner);
    }
    first_owner.push(owners.len() as u32);
    report.shared = first_owner.windows(2).filter(|w| w[1] - w[0] > 1).count();
    let kd = PlanKd::build(&ends, leaf);
    Plan {
        grid,
        segments,
        ends,
        occludes,
        owners,
        first_owner,
        kd,
        report,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{PieceId, Plan, PlanInput, PlanSegment};
    use super::PlanOptions;
    use antumbra_kernel::Point2;

    fn plan(segments: &[[f64; 4]], grid: f64) -> Plan {
        let segments = segments.iter().enumerate().map(|(i, s)| PlanSegment {
            ends: [[s[0], s[1]], [s[2], s[3]]],
            class: 0,
            feature: i as u32,
        });
        let input = PlanInput {
            segments: segments.collect(),
            classes: vec![String::new()],
            ..PlanInput::default()
        };
        let options = PlanOptions {
            grid: Some(grid),
            ..PlanOptions::default()
        };
        Plan::build(&input, &options).expect("good input")
    }

    #[test]
    fn overlapping_segments_share_pieces() {
        let p = plan(
            &[[-4., 0., 2., 0.], [4., 0., -2., 0.], [1., 1., 1., 1.]],
            1.0,
        );
        assert_eq!(p.pieces().len(), 3);
        let owners = |i| -> Vec<(u32, [i64; 2], i64)> {
            let list = p.owners(PieceId(i)).iter();
            list.map(|o| (o.segment.0, o.at, o.whole)).collect()
        };
        assert_eq!(owners(0), [(0, [0, 12], 36)]);
        assert_eq!(owners(1), [(0, [12, 36], 36), (1, [36, 12], 36)]);
        assert_eq!(owners(2), [(1, [12, 0], 36)]);
        assert_eq!(p.report().points.len(), 1);
        assert_eq!(p.report().shared, 1);
    }

    #[test]
    fn input_on_the_grid_stays_as_it_is_and_other_input_gets_no_cracks() {
        // The corner is a tenth of a step beside the segment, but nothing was moved.
        let p = plan(&[[-5., 0., 5., 1.], [-4., 0., -4., 9.]], 1.0);
        assert_eq!(p.pieces().len(), 2);
        assert_eq!(p.report().moved, 0.0);
        // Here the corner was on the segment before both were snapped.
        let p = plan(&[[-5., 0.3, 5., 3.3], [-1.0, 1.5, -4., 9.]], 1.0);
        assert_eq!(p.report().sealed, 1);
        assert_eq!(p.pieces().len(), 3);
        let degree = |c: &Point2| p.pieces().iter().filter(|e| e.contains(c)).count();
        assert!(p.pieces().iter().flatten().any(|c| degree(c) == 3));
    }

    #[test]
    fn the_order_of_the_input_does_not_matter() {
        let mut segments = vec![
            [0., 0., 9., 3.],
            [3., 1., 3., 8.],
            [9., 3., 0., 0.],
            [2., 7., 8., -4.],
        ];
        let one = plan(&segments, 0.7);
        segments.reverse();
        let two = plan(&segments, 0.7);
        assert_eq!(one.pieces(), two.pieces());
        assert_eq!(one.kd().nodes(), two.kd().nodes());
    }

    #[test]
    fn what_cannot_be_built_is_named() {
        let input = PlanInput::default();
        let error = Plan::build(&input, &PlanOptions::default()).expect_err("empty");
        assert!(error.to_string().contains("no segments"));
        let wide = PlanInput {
            segments: vec![PlanSegment {
                ends: [[0.0, 0.0], [1e9, 0.0]],
                class: 0,
                feature: 0,
            }],
            ..PlanInput::default()
        };
        let options = PlanOptions {
            grid: Some(1.0),
            ..PlanOptions::default()
        };
        let error = Plan::build(&wide, &options).expect_err("too wide");
        assert!(
            error.to_string().contains("use a step of 64 or more"),
            "{error}"
        );
    }
}
