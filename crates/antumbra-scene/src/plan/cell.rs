//! View cells of plans: convex polygons, segments and points on the grid.
//!
//! A convex cell snaps outwards, so that what was asked for is inside, but never past a wall that it
//! stands on: a corner near a wall goes to the grid point nearest to it on the cell's side. Any other
//! polygon is cut into convex parts, which share the cuts exactly; its corners snap to nearest.
//! Floats choose grid points; all else is integers.

mod convex;

use antumbra_kernel::{LIMIT, Point2, Rect, orient2d};

use super::{Plan, along};
use convex::{convex_parts, hull};

/// A convex source of lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CellShape {
    /// One point.
    Point(Point2),
    /// The segment between two distinct points.
    Segment([Point2; 2]),
    /// A strictly convex polygon, counter-clockwise.
    Region(Vec<Point2>),
}

impl CellShape {
    /// The corners; one for a point, two for a segment.
    #[must_use]
    pub fn corners(&self) -> &[Point2] {
        match self {
            Self::Point(p) => std::slice::from_ref(p),
            Self::Segment(ends) => ends,
            Self::Region(corners) => corners,
        }
    }

    /// The smallest box around it.
    #[must_use]
    pub fn bounds(&self) -> Rect {
        let [first, ..] = self.corners() else {
            return Rect {
                min: Point2::default(),
                max: Point2::default(),
            };
        };
        Rect::around(self.corners().iter().copied()).unwrap_or(Rect {
            min: *first,
            max: *first,
        })
    }

    /// Whether the closed cell and a closed segment share a point. Exact.
    #[must_use]
    pub fn meets_segment(&self, piece: [Point2; 2]) -> bool {
        self.parted(&piece).is_none() && !self.beside(piece)
    }

    /// Whether the closed cell and a closed box share a point. Exact.
    #[must_use]
    pub fn meets_rect(&self, rect: &Rect) -> bool {
        match self {
            Self::Point(p) => rect.meets_segment([*p, *p]),
            Self::Segment(ends) => rect.meets_segment(*ends),
            Self::Region(_) => {
                self.bounds().touches(rect) && self.parted(&rect.corners()).is_none()
            }
        }
    }

    /// Whether two closed cells share a point. Exact.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Point(p), _) => other.meets_segment([*p, *p]),
            (_, Self::Point(p)) => self.meets_segment([*p, *p]),
            (Self::Segment(s), _) => other.meets_segment(*s),
            (_, Self::Segment(s)) => self.meets_segment(*s),
            _ => {
                self.bounds().touches(&other.bounds())
                    && self.parted(other.corners()).is_none()
                    && other.parted(self.corners()).is_none()
            }
        }
    }

    /// Whether a segment meets the open interior of a region. Exact.
    #[must_use]
    pub fn enters(&self, [a, b]: [Point2; 2]) -> bool {
        let Self::Region(corners) = self else {
            return false;
        };
        let outside = |(p, q): (Point2, Point2)| orient2d(p, q, a) <= 0 && orient2d(p, q, b) <= 0;
        if edges(corners).any(outside) {
            return false;
        }
        let sides = || corners.iter().map(|&c| orient2d(a, b, c).signum());
        !(sides().all(|s| s >= 0) || sides().all(|s| s <= 0))
    }

    /// An edge that has all points strictly outside. For a segment, one of the perpendicular ends
    /// never parts, so only its two sides are asked.
    fn parted(&self, points: &[Point2]) -> Option<usize> {
        let corners = self.corners();
        if corners.len() < 2 {
            return None;
        }
        edges(corners).position(|(p, q)| points.iter().all(|&c| orient2d(p, q, c) < 0))
    }

    /// Whether the line of a piece, or an end of it, parts it from the cell.
    fn beside(&self, piece: [Point2; 2]) -> bool {
        let corners = self.corners();
        let sides = || corners.iter().map(|&c| orient2d(piece[0], piece[1], c));
        if sides().all(|s| s > 0) || sides().all(|s| s < 0) {
            return true;
        }
        match Rect::around(piece) {
            // Collinear with all of a point or a segment: their extents decide.
            Some(around) => !around.touches(&self.bounds()),
            None => true,
        }
    }
}

/// The edges of a closed polygon.
fn edges(corners: &[Point2]) -> impl Iterator<Item = (Point2, Point2)> + '_ {
    let next = corners.iter().cycle().skip(1);
    corners.iter().copied().zip(next.copied())
}

/// A view cell: one convex shape, or the parts of a polygon that is not convex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanCell {
    /// The parts.
    pub parts: Vec<CellShape>,
}

/// Why a cell was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanCellError {
    /// It has no corner.
    #[error("the cell has no corners: give at least one point")]
    Empty,
    /// A coordinate is not a number.
    #[error("corner {corner} of the cell is ({}, {}): coordinates must be finite", found[0], found[1])]
    NotFinite {
        /// Which corner.
        corner: usize,
        /// As found.
        found: [f64; 2],
    },
    /// A corner lies off the grid.
    #[error(
        "corner {corner} of the cell, ({}, {}), is off the grid: choose a coarser grid", found[0], found[1]
    )]
    OffGrid {
        /// Which corner.
        corner: usize,
        /// As found.
        found: [f64; 2],
    },
    /// The outline crosses or touches itself.
    #[error(
        "the outline of the cell meets itself at edges {first} and {second}: give a simple polygon"
    )]
    Crossing {
        /// One edge; edge k starts at corner k.
        first: usize,
        /// The other one.
        second: usize,
    },
    /// It has more corners than can be cut into convex parts in reasonable time.
    #[error("the cell has {0} corners and is not convex: at most 2000 are supported, simplify it")]
    TooManyCorners(usize),
}

const MOST_CORNERS: usize = 2000;

impl PlanCell {
    /// The cell with an outline in scene units: a polygon (its last corner may repeat the first), a
    /// segment or a point. Collinear corners make a segment.
    ///
    /// # Errors
    /// If there is no corner, one is not finite or off the grid, or the outline meets itself.
    pub fn new(plan: &Plan, outline: &[[f64; 2]]) -> Result<Self, PlanCellError> {
        let mut given = fractional(plan, outline)?;
        given.dedup();
        while given.len() > 1 && given.first() == given.last() {
            given.pop();
        }
        let nearest: Vec<Point2> = given.iter().map(|&t| rounded(t)).collect();
        let shell = hull(&nearest);
        let shape = match shell.len() {
            0 => return Err(PlanCellError::Empty),
            1 => CellShape::Point(shell[0]),
            2 => CellShape::Segment([shell[0], shell[1]]),
            _ if is_convex(&nearest) => CellShape::Region(outwards(plan, &given)),
            _ => {
                let parts = non_convex(&nearest)?;
                return Ok(Self { parts });
            }
        };
        Ok(Self { parts: vec![shape] })
    }

    /// Whether a segment meets the open interior of the whole cell: that of a part, or a cut between two. Exact.
    #[must_use]
    pub fn enters(&self, piece: [Point2; 2]) -> bool {
        self.parts.iter().any(|part| part.enters(piece)) || self.runs_along_a_cut(piece)
    }

    /// Whether parts lie on both sides of some stretch of a segment.
    fn runs_along_a_cut(&self, [a, b]: [Point2; 2]) -> bool {
        let end = along([a, b], b);
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for part in &self.parts {
            let CellShape::Region(corners) = part else {
                continue;
            };
            for (p, q) in edges(corners) {
                if orient2d(a, b, p) != 0 || orient2d(a, b, q) != 0 {
                    continue;
                }
                // Parts are on the left of their edges.
                let (s, t) = (along([a, b], p), along([a, b], q));
                if s < t {
                    left.push([s.max(0), t.min(end)]);
                } else {
                    right.push([t.max(0), s.min(end)]);
                }
            }
        }
        let overlap = |l: &[i64; 2], r: &[i64; 2]| l[0].max(r[0]) < l[1].min(r[1]);
        left.iter().any(|l| right.iter().any(|r| overlap(l, r)))
    }
}

/// Fractional grid coordinates.
fn fractional(plan: &Plan, outline: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, PlanCellError> {
    let one = |(corner, &found): (usize, &[f64; 2])| {
        if !found.iter().all(|c| c.is_finite()) {
            return Err(PlanCellError::NotFinite { corner, found });
        }
        let [x, y, _] = plan.grid().to_grid_f64([found[0], found[1], 0.0]);
        let room = f64::from(LIMIT - 8);
        if x.abs() > room || y.abs() > room {
            return Err(PlanCellError::OffGrid { corner, found });
        }
        Ok([x, y])
    };
    outline.iter().enumerate().map(one).collect()
}

fn rounded(t: [f64; 2]) -> Point2 {
    Point2::new(t[0].round() as i32, t[1].round() as i32)
}

/// Whether a closed outline turns one way only and once around.
fn is_convex(outline: &[Point2]) -> bool {
    let mut ring = outline.to_vec();
    ring.dedup();
    let n = ring.len();
    let turns = || (0..n).map(|i| orient2d(ring[i], ring[(i + 1) % n], ring[(i + 2) % n]).signum());
    let one_way = turns().all(|t| t >= 0) || turns().all(|t| t <= 0);
    // Once around: the x coordinates rise once and fall once.
    let rises = |i: usize| {
        let (a, b) = (ring[i % n], ring[(i + 1) % n]);
        a < b
    };
    one_way && (0..n).filter(|&i| rises(i) != rises(i + 1)).count() == 2
}

/// The convex outline on the grid that holds a given one, apart from walls that it stands on.
fn outwards(plan: &Plan, given: &[[f64; 2]]) -> Vec<Point2> {
    let n = given.len();
    let middle = [0, 1].map(|k| given.iter().map(|t| t[k]).sum::<f64>() / n as f64);
    let walled: Vec<Option<Point2>> = given
        .iter()
        .map(|&t| at_wall(plan, t, rounded(middle)))
        .collect();
    let free: Vec<[f64; 2]> = given
        .iter()
        .zip(&walled)
        .filter_map(|(&t, wall)| wall.is_none().then_some(t))
        .collect();
    for attempt in 0..5 {
        let corner = |i: usize| walled[i].unwrap_or_else(|| pushed(given, middle, i, attempt));
        let shell = hull(&(0..n).map(corner).collect::<Vec<_>>());
        if shell.len() >= 3 && free.iter().all(|&t| holds(&shell, t)) {
            return shell;
        }
    }
    let mut points: Vec<Point2> = walled.iter().flatten().copied().collect();
    for t in free {
        for x in [t[0].floor(), t[0].ceil()] {
            points.extend([t[1].floor(), t[1].ceil()].map(|y| Point2::new(x as i32, y as i32)));
        }
    }
    hull(&points)
}

/// Where corner i goes: away from the middle by less than a step on each axis at the first attempt, which is all
/// that boxes need; then along both of its edges' normals, a little farther each time.
fn pushed(given: &[[f64; 2]], middle: [f64; 2], i: usize, attempt: u32) -> Point2 {
    let n = given.len();
    let t = given[i];
    if attempt == 0 {
        let away = |k: usize| {
            if t[k] > middle[k] {
                t[k].ceil()
            } else {
                t[k].floor()
            }
        };
        return Point2::new(away(0) as i32, away(1) as i32);
    }
    let mut out = t;
    for (p, q) in [(given[(i + n - 1) % n], t), (t, given[(i + 1) % n])] {
        let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
        let outward = (middle[0] - p[0]) * dy - (middle[1] - p[1]) * dx;
        let length = dx.hypot(dy).copysign(-outward) / (0.25 + 0.5 * f64::from(attempt));
        if length != 0.0 {
            out = [out[0] + dy / length, out[1] - dx / length];
        }
    }
    rounded(out)
}

/// Whether a convex outline holds a point, given to 2^-32 of a step.
fn holds(shell: &[Point2], t: [f64; 2]) -> bool {
    let fine = |v: f64| (v * 4_294_967_296.0).round() as i128;
    let whole = |v: i32| i128::from(v) << 32;
    edges(shell).all(|(p, q)| {
        let (dx, dy) = (i128::from(q.x - p.x), i128::from(q.y - p.y));
        dx * (fine(t[1]) - whole(p.y)) - dy * (fine(t[0]) - whole(p.x)) >= 0
    })
}

/// Where a corner goes that has walls within a step: the nearest grid point around it that is on the
/// same side of all of them as the middle of the cell. `None` if there are no walls.
fn at_wall(plan: &Plan, t: [f64; 2], middle: Point2) -> Option<Point2> {
    let (low, high) = (t.map(f64::floor), t.map(f64::ceil));
    let p = |x: f64, y: f64| Point2::new(x as i32, y as i32);
    let around = Rect {
        min: p(low[0] - 1.0, low[1] - 1.0),
        max: p(high[0] + 1.0, high[1] + 1.0),
    };
    let walls: Vec<[Point2; 2]> = plan
        .pieces_in(&around)
        .into_iter()
        .filter(|&id| plan.occludes(id))
        .map(|id| plan.pieces()[id.0 as usize])
        .collect();
    if walls.is_empty() {
        return None;
    }
    let inside = |q: Point2| {
        walls.iter().all(|&[a, b]| {
            let (here, there) = (orient2d(a, b, q).signum(), orient2d(a, b, middle).signum());
            here * there >= 0
        })
    };
    let distance = |q: Point2| (f64::from(q.x) - t[0]).hypot(f64::from(q.y) - t[1]);
    let corners = [low[0], high[0]].map(|x| [low[1], high[1]].map(|y| p(x, y)));
    let best = corners
        .into_iter()
        .flatten()
        .filter(|&q| inside(q))
        .min_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
    Some(best.unwrap_or_else(|| rounded(t)))
}

fn non_convex(outline: &[Point2]) -> Result<Vec<CellShape>, PlanCellError> {
    let mut ring = outline.to_vec();
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    if ring.len() > MOST_CORNERS {
        return Err(PlanCellError::TooManyCorners(ring.len()));
    }
    if let Some((first, second)) = convex::self_contact(&ring) {
        return Err(PlanCellError::Crossing { first, second });
    }
    Ok(convex_parts(&ring)
        .into_iter()
        .map(CellShape::Region)
        .collect())
}
