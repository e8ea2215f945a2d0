//! Where to split: the surface-area heuristic, binned in large nodes and exact in small ones, and
//! the minimal-split heuristic of [Bittner02, 4.2].
//!
//! All costs are integers, so the tree is the same on every machine.

use antumbra_kernel::{Aabb, Point};

use super::meets::Shape;
use super::{KdNode, KdTree, cut};
use crate::PolygonId;

/// How a [`KdTree`] chooses its splits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum KdHeuristic {
    /// The least sum of surface area times number of polygons over both children (MacDonald and
    /// Booth).
    #[default]
    SurfaceArea,
    /// Along the longest side of the box, near its middle: the boundary of a polygon at which the
    /// fewest polygons straddle.
    MinimalSplit,
}

/// A node with no more polygons is not split.
const LEAF: usize = 4;
/// What a node costs, in polygons: a visibility test of a box is about that of its front faces.
/// With 1 the trees of two office models had half as many leaves again for 15 % more expected
/// nodes and 15 % fewer expected polygons; with 4 leaves grew to 7 polygons. With 2 they hold 4
/// to 7, and each polygon is listed 3 times.
const NODE: i128 = 2;
/// A node with more polygons is split even where the heuristic sees no gain, a few times on a way.
const CROWD: usize = 12;
/// How often a way may be split without gain.
const PATIENCE: u8 = 3;
/// Nodes with no more polygons are swept exactly.
const EXACT: usize = 96;
/// Bins along an axis for larger nodes.
const BINS: usize = 32;

/// In which children a box belongs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    pub(super) lower: bool,
    pub(super) upper: bool,
}

/// The rule of [`super`]: lower if something lies strictly below or all is in the plane, upper if
/// something lies strictly above.
#[inline]
pub(super) fn sides(b: &Aabb, axis: usize, at: i32) -> Sides {
    let (min, max) = (b.min.to_array()[axis], b.max.to_array()[axis]);
    Sides {
        lower: min < at || max <= at,
        upper: max > at,
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Split {
    cost: i128,
    axis: usize,
    at: i32,
}

pub(super) fn build<'a>(
    boxes: &[Aabb],
    shapes: impl Fn(u32) -> Option<Shape<'a>>,
    heuristic: KdHeuristic,
) -> KdTree {
    let origin = Point::new(0, 0, 0);
    let bounds = boxes.iter().copied().reduce(Aabb::union).unwrap_or(Aabb {
        min: origin,
        max: origin,
    });
    let deepest = 8 + 2 * boxes.len().max(1).ilog2();
    let nodes = Vec::with_capacity(boxes.len() / 2 + 1);
    let items = Vec::with_capacity(boxes.len() * 2);
    let mut builder = Builder {
        boxes,
        shapes,
        heuristic,
        nodes,
        items,
    };
    builder.node(bounds, (0..boxes.len() as u32).collect(), deepest, PATIENCE);
    KdTree {
        bounds,
        nodes: builder.nodes,
        items: builder.items,
    }
}

struct Builder<'b, F> {
    boxes: &'b [Aabb],
    shapes: F,
    heuristic: KdHeuristic,
    nodes: Vec<KdNode>,
    items: Vec<PolygonId>,
}

impl<'a, F: Fn(u32) -> Option<Shape<'a>>> Builder<'_, F> {
    /// Appends the subtree over some polygons and returns its root.
    fn node(&mut self, bounds: Aabb, list: Vec<u32>, depth_left: u32, patience: u8) -> u32 {
        let index = self.nodes.len() as u32;
        let leaf = KdNode::Leaf {
            first: self.items.len() as u32,
            count: list.len() as u32,
        };
        self.nodes.push(leaf);
        let (split, patience) = match self.choose(&bounds, &list, depth_left, patience) {
            Some(choice) => choice,
            None => {
                self.items.extend(list.into_iter().map(PolygonId));
                return index;
            }
        };
        let Split { axis, at, .. } = split;
        let mut below = Vec::with_capacity(list.len() / 2 + 1);
        let mut above = Vec::with_capacity(list.len() / 2 + 1);
        let (low, high) = cut(bounds, axis, at);
        for &i in &list {
            let side = sides(&self.boxes[i as usize], axis, at);
            // Only one that straddles can miss a child: others are there with all they had here.
            let shape = if side.lower && side.upper {
                (self.shapes)(i)
            } else {
                None
            };
            if side.lower && shape.is_none_or(|shape| shape.meets(&low)) {
                below.push(i);
            }
            if side.upper && shape.is_none_or(|shape| shape.meets(&high)) {
                above.push(i);
            }
        }
        // Free the list before going down: a way holds one list a level otherwise.
        drop(list);
        let lower = self.node(low, below, depth_left - 1, patience);
        let upper = self.node(high, above, depth_left - 1, patience);
        self.nodes[index as usize] = KdNode::Inner {
            axis: axis as u8,
            at,
            lower,
            upper,
        };
        index
    }

    /// The split of a node and the patience left, or `None` for a leaf.
    fn choose(
        &self,
        bounds: &Aabb,
        list: &[u32],
        depth_left: u32,
        patience: u8,
    ) -> Option<(Split, u8)> {
        let n = list.len();
        if n <= LEAF || depth_left == 0 {
            return None;
        }
        let clipped = |i: u32, k: usize| {
            let b = &self.boxes[i as usize];
            let (low, high) = (bounds.min.to_array()[k], bounds.max.to_array()[k]);
            (b.min.to_array()[k].max(low), b.max.to_array()[k].min(high))
        };
        let spans = |k: usize| list.iter().map(move |&i| clipped(i, k));
        if self.heuristic == KdHeuristic::MinimalSplit {
            let extent = bounds.extent();
            let axis = (0..3).max_by_key(|&k| (extent[k], 2 - k)).unwrap_or(0);
            let (split, straddling) = minimal_split(bounds, axis, n, spans(axis))?;
            // Where much straddles, polygons would be listed again and again.
            let patience = if straddling * 8 > n {
                patience.checked_sub(1)?
            } else {
                patience
            };
            return Some((split, patience));
        }
        let best = if n <= EXACT {
            (0..3).filter_map(|k| sweep(bounds, k, n, spans(k))).min()
        } else {
            (0..3).filter_map(|k| bin(bounds, k, n, spans(k))).min()
        }?;
        let as_leaf = area(bounds) * n as i128;
        if best.cost + NODE * area(bounds) < as_leaf {
            Some((best, patience))
        } else if n > CROWD && 2 * best.cost < 3 * as_leaf {
            Some((best, patience.checked_sub(1)?))
        } else {
            None
        }
    }
}

/// Half the surface of a box.
fn area(b: &Aabb) -> i128 {
    let [x, y, z] = b.extent().map(i128::from);
    x * y + y * z + z * x
}

/// The cost of a cut that leaves so many polygons below and above it; `None` if it separates
/// nothing.
fn cost(
    bounds: &Aabb,
    axis: usize,
    at: i32,
    n: usize,
    below: usize,
    above: usize,
) -> Option<Split> {
    let useless = (below == n && above == n)
        || (below == n && above == 0 && at >= bounds.max.to_array()[axis])
        || (above == n && at <= bounds.min.to_array()[axis]);
    if useless {
        return None;
    }
    let (low, high) = cut(*bounds, axis, at);
    let cost = area(&low) * below as i128 + area(&high) * above as i128;
    Some(Split { cost, axis, at })
}

/// The best of all boundaries of the polygons, exactly counted.
fn sweep(
    bounds: &Aabb,
    axis: usize,
    n: usize,
    spans: impl Iterator<Item = (i32, i32)>,
) -> Option<Split> {
    let counts = Counts::new(n, spans);
    let (mut below, mut ended, mut flat) = (0, 0, 0);
    let mut best = None;
    for at in counts.boundaries() {
        let up_to = |list: &[i32], from: usize, limit: i32| {
            from + list[from..].iter().take_while(|&&x| x <= limit).count()
        };
        // As `Counts::below` and `above` say, but walking along.
        below = up_to(&counts.lows, below, at - 1);
        ended = up_to(&counts.highs, ended, at);
        let flats = up_to(&counts.flats, flat, at - 1);
        flat = up_to(&counts.flats, flats, at);
        let split = cost(bounds, axis, at, n, below + flat - flats, n - ended);
        best = [best, split].into_iter().flatten().min();
    }
    best
}

/// The best of some boundaries: for each border of two bins the last end before it and the first
/// start after it, with counts that are exact but for what lies between border and boundary.
fn bin(
    bounds: &Aabb,
    axis: usize,
    n: usize,
    spans: impl Iterator<Item = (i32, i32)>,
) -> Option<Split> {
    let low = i64::from(bounds.min.to_array()[axis]);
    let width = i64::from(bounds.max.to_array()[axis]) - low + 1;
    // A reciprocal in fixed point: monotone, and below BINS since (width - 1) / width < 1.
    let scale = ((BINS as i64) << 32) / width;
    let bin = |x: i32| (((i64::from(x) - low) * scale) >> 32) as usize;
    let (mut starts, mut ends) = ([0_usize; BINS], [0_usize; BINS]);
    let (mut first_start, mut last_end) = ([i32::MAX; BINS], [i32::MIN; BINS]);
    for (a, b) in spans {
        let (i, j) = (bin(a), bin(b));
        starts[i] += 1;
        ends[j] += 1;
        first_start[i] = first_start[i].min(a);
        last_end[j] = last_end[j].max(b);
    }
    for i in 1..BINS {
        last_end[i] = last_end[i].max(last_end[i - 1]);
        let k = BINS - 1 - i;
        first_start[k] = first_start[k].min(first_start[k + 1]);
    }
    let (mut below, mut ended) = (0, 0);
    let mut best = None;
    for border in 0..BINS - 1 {
        below += starts[border];
        ended += ends[border];
        for at in [last_end[border], first_start[border + 1]] {
            // A boundary on the border of the box is not counted exactly: polygons flat in it all
            // go to one child, and the same cut would look good again and again.
            if at <= bounds.min.to_array()[axis] || at >= bounds.max.to_array()[axis] {
                continue;
            }
            let split = cost(bounds, axis, at, n, below, n - ended);
            best = [best, split].into_iter().flatten().min();
        }
    }
    best
}

/// Among the boundaries within a quarter of the extent around the middle, the one at which the
/// fewest polygons straddle, or the middle itself. Returned with the number that straddle.
fn minimal_split(
    bounds: &Aabb,
    axis: usize,
    n: usize,
    spans: impl Iterator<Item = (i32, i32)>,
) -> Option<(Split, usize)> {
    let middle = bounds.center_doubled()[axis].div_euclid(2) as i32;
    let reach = (bounds.extent()[axis] / 4) as i32;
    let (bottom, top) = (bounds.min.to_array()[axis], bounds.max.to_array()[axis]);
    let counts = Counts::new(n, spans);
    let mut candidates = counts.boundaries();
    candidates.retain(|at| (at - middle).abs() <= reach);
    candidates.push(middle);
    let (straddling, _, at) = candidates
        .into_iter()
        .filter(|&at| bottom < at && at < top)
        .map(|at| {
            (
                counts.below(at) + counts.above(at) - n,
                (at - middle).abs(),
                at,
            )
        })
        .min()?;
    cost(bounds, axis, at, n, counts.below(at), counts.above(at)).map(|split| (split, straddling))
}

/// The extents of the polygons along one axis, sorted, to count on which side of a plane they lie.
struct Counts {
    lows: Vec<i32>,
    highs: Vec<i32>,
    flats: Vec<i32>,
}

impl Counts {
    fn new(n: usize, spans: impl Iterator<Item = (i32, i32)>) -> Self {
        let mut counts = Self {
            lows: Vec::with_capacity(n),
            highs: Vec::with_capacity(n),
            flats: Vec::new(),
        };
        for (low, high) in spans {
            counts.lows.push(low);
            counts.highs.push(high);
            if low == high {
                counts.flats.push(low);
            }
        }
        counts.lows.sort_unstable();
        counts.highs.sort_unstable();
        counts.flats.sort_unstable();
        counts
    }

    /// All ends of extents, each once, ascending.
    fn boundaries(&self) -> Vec<i32> {
        let (mut lows, mut highs) = (self.lows.as_slice(), self.highs.as_slice());
        let mut all = Vec::with_capacity(lows.len() + highs.len());
        // A polygon begins before it ends, so the lows are exhausted first.
        while let [low, later @ ..] = lows {
            let next = match highs {
                [high, later @ ..] if high < low => {
                    highs = later;
                    *high
                }
                _ => {
                    lows = later;
                    *low
                }
            };
            all.push(next);
        }
        all.extend_from_slice(highs);
        all.dedup();
        all
    }

    /// How many go to the lower child of a cut.
    fn below(&self, at: i32) -> usize {
        let level =
            self.flats.partition_point(|&f| f <= at) - self.flats.partition_point(|&f| f < at);
        self.lows.partition_point(|&low| low < at) + level
    }

    /// How many go to the upper child of a cut.
    fn above(&self, at: i32) -> usize {
        self.highs.len() - self.highs.partition_point(|&high| high <= at)
    }
}
