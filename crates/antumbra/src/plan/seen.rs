//! From views of convex parts to the segments of the input.

use antumbra_scene::plan::{Plan, PlanCell, SegmentId};
use antumbra_sweep::Accuracy;
use antumbra_sweep::plan::{Fragment, PlanView, PlanWork, Ratio, ViewOptions, look};
use rayon::prelude::*;

/// What a cell sees.
#[derive(Clone, Debug)]
pub struct Seen {
    /// The visible segments, by number.
    pub segments: Vec<SeenSegment>,
    /// The views of the cell's convex parts.
    pub parts: Vec<PlanView>,
    /// Exact, or conservative if an occluder meets the open interior of the whole cell.
    pub accuracy: Accuracy,
    /// What was done for all parts.
    pub work: PlanWork,
}

/// A visible segment.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenSegment {
    /// Its number in the input.
    pub segment: SegmentId,
    /// Whether it meets the closed cell: then it is visible whole.
    pub touching: bool,
    /// The maximal visible intervals, from 0 to 1 along the input segment, each end the nearest double.
    pub fragments: Vec<[f64; 2]>,
}

/// Looks from a cell. The answer does not depend on the options, the order of the input or threads; of a
/// cell that is not convex it is the union of what its parts see.
#[must_use]
pub fn see(plan: &Plan, cell: &PlanCell, options: &ViewOptions) -> Seen {
    let parts: Vec<PlanView> = cell
        .parts
        .iter()
        .map(|part| look(plan, part, options))
        .collect();
    let entered = parts.iter().flat_map(|v| &v.touching).any(|&id| {
        // One convex part has asked already.
        parts.len() > 1 && plan.occludes(id) && cell.enters(plan.pieces()[id.0 as usize])
    });
    let exact = !entered && parts.iter().all(|v| v.accuracy == Accuracy::Exact);
    let mut work = PlanWork::default();
    for part in &parts {
        work.add(&part.work);
    }
    Seen {
        segments: segments(plan, &parts),
        accuracy: if exact {
            Accuracy::Exact
        } else {
            Accuracy::Conservative
        },
        parts,
        work,
    }
}

/// Looks from many cells in parallel; answers in the order of the cells.
#[must_use]
pub fn see_all(plan: &Plan, cells: &[PlanCell], options: &ViewOptions) -> Vec<Seen> {
    cells.par_iter().map(|c| see(plan, c, options)).collect()
}

/// An interval of an owner.
struct Span {
    segment: SegmentId,
    at: [Ratio; 2],
    touching: bool,
}

fn segments(plan: &Plan, parts: &[PlanView]) -> Vec<SeenSegment> {
    let mut spans = Vec::new();
    for view in parts {
        for &piece in &view.touching {
            spans.extend(plan.owners(piece).iter().map(|o| Span {
                segment: o.segment,
                at: [Ratio::ZERO, Ratio::ONE],
                touching: true,
            }));
        }
        for f in &view.fragments {
            spans.extend(owned(plan, f));
        }
    }
    spans.extend(points_inside(plan, parts));
    spans.sort_by(|a, b| {
        (a.segment, !a.touching)
            .cmp(&(b.segment, !b.touching))
            .then_with(|| a.at[0].cmp(&b.at[0]))
    });
    let mut out: Vec<SeenSegment> = Vec::new();
    // Where the last fragment ends: doubles would close gaps that they do not show.
    let mut reached = Ratio::ZERO;
    for span in spans {
        let [from, to] = span.at;
        let fragment = [from.value(), to.value()];
        match out.last_mut() {
            Some(last) if last.segment == span.segment => {
                if from > reached {
                    last.fragments.push(fragment);
                } else if to <= reached {
                    continue;
                } else if let Some(end) = last.fragments.last_mut() {
                    end[1] = fragment[1];
                }
            }
            _ => out.push(SeenSegment {
                segment: span.segment,
                touching: span.touching,
                fragments: vec![fragment],
            }),
        }
        reached = to;
    }
    out
}

/// A fragment as intervals of the segments that own its piece.
fn owned<'p>(plan: &'p Plan, f: &'p Fragment) -> impl Iterator<Item = Span> + 'p {
    plan.owners(f.piece).iter().map(|o| {
        let [low, high] = &f.at;
        let places = if o.at[0] <= o.at[1] {
            [low, high]
        } else {
            [high, low]
        };
        Span {
            segment: o.segment,
            at: places.map(|r| r.between(o.at, o.whole)),
            touching: false,
        }
    })
}

/// Segments that are points on the grid are visible if they lie in the closed cell.
fn points_inside<'p>(plan: &'p Plan, parts: &'p [PlanView]) -> impl Iterator<Item = Span> + 'p {
    plan.points()
        .iter()
        .filter(|(_, p)| parts.iter().any(|v| v.cell.meets_segment([*p, *p])))
        .map(|&(segment, _)| Span {
            segment,
            at: [Ratio::ZERO, Ratio::ONE],
            touching: true,
        })
}
