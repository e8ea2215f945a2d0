//! Which corners lie on, or within a grid step of, which segments.
//!
//! Corners are sorted into a raster, and each segment walks the fields that it may pass. Floats
//! find the fields, with two grid steps to spare; integers decide.

use antumbra_kernel::{Point2, Rect};

/// Corners of the plane, each once, in a raster.
pub(super) struct Raster {
    origin: [f64; 2],
    size: f64,
    counts: [usize; 2],
    first: Vec<u32>,
    corners: Vec<u32>,
}

impl Raster {
    /// Sorts the corners into about as many fields.
    pub(super) fn new(corners: &[Point2]) -> Self {
        let bounds = Rect::around(corners.iter().copied());
        let (min, max) = bounds.map_or(([0.0; 2], [0.0; 2]), |b| (b.min.to_f64(), b.max.to_f64()));
        let area = (max[0] - min[0] + 1.0) * (max[1] - min[1] + 1.0);
        let longest = (max[0] - min[0]).max(max[1] - min[1]) + 1.0;
        let size = (area / (corners.len().max(1) as f64))
            .sqrt()
            .max(longest / 4096.0)
            .max(4.0);
        let counts = [0, 1].map(|k| ((max[k] - min[k]) / size) as usize + 1);
        let mut raster = Self {
            origin: min,
            size,
            counts,
            first: vec![0; counts[0] * counts[1] + 1],
            corners: vec![0; corners.len()],
        };
        let fields: Vec<usize> = corners.iter().map(|&c| raster.field_of(c)).collect();
        for &field in &fields {
            raster.first[field + 1] += 1;
        }
        for i in 1..raster.first.len() {
            raster.first[i] += raster.first[i - 1];
        }
        let mut next = raster.first.clone();
        for (corner, &field) in fields.iter().enumerate() {
            raster.corners[next[field] as usize] = corner as u32;
            next[field] += 1;
        }
        raster
    }

    fn index(&self, axis: usize, at: f64) -> usize {
        let i = ((at - self.origin[axis]) / self.size).max(0.0) as usize;
        i.min(self.counts[axis] - 1)
    }

    fn field_of(&self, p: Point2) -> usize {
        let p = p.to_f64();
        self.index(1, p[1]) * self.counts[0] + self.index(0, p[0])
    }

    /// Visits all corners that may be within a grid step of a segment, and some others.
    pub(super) fn near(&self, [a, b]: [Point2; 2], mut visit: impl FnMut(u32)) {
        let (a, b) = (a.to_f64(), b.to_f64());
        let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
        let rows = self.index(1, low[1] - REACH)..=self.index(1, high[1] + REACH);
        let rise = high[1] - low[1];
        for row in rows {
            let bottom = self.origin[1] + row as f64 * self.size - REACH;
            let top = bottom + self.size + 2.0 * REACH;
            let x_at = |y: f64| {
                if rise == 0.0 {
                    low[0]
                } else {
                    low[0] + (high[0] - low[0]) * ((y - low[1]) / rise).clamp(0.0, 1.0)
                }
            };
            let (mut left, mut right) = (x_at(bottom), x_at(top));
            if rise == 0.0 {
                right = high[0];
            }
            if left > right {
                std::mem::swap(&mut left, &mut right);
            }
            let columns = self.index(0, left - REACH)..=self.index(0, right + REACH);
            let field = row * self.counts[0];
            let range = self.first[field + columns.start()]..self.first[field + columns.end() + 1];
            for &corner in &self.corners[range.start as usize..range.end as usize] {
                visit(corner);
            }
        }
    }
}

/// One grid step, and one against rounding.
const REACH: f64 = 2.0;

/// How a corner lies to a segment that does not end there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Nearness {
    Apart,
    /// Exactly on it.
    On,
    /// Not on it, but within one step on both axes.
    Close,
}

/// Decides it exactly.
pub(super) fn nearness(segment: [Point2; 2], corner: Point2) -> Nearness {
    if segment.contains(&corner) {
        return Nearness::Apart;
    }
    let point = Rect {
        min: corner,
        max: corner,
    };
    if point.meets_segment(segment) {
        return Nearness::On;
    }
    // Corners stay off the outermost steps of the grid, so the box fits it.
    let around = Rect {
        min: Point2::new(corner.x - 1, corner.y - 1),
        max: Point2::new(corner.x + 1, corner.y + 1),
    };
    if around.meets_segment(segment) {
        Nearness::Close
    } else {
        Nearness::Apart
    }
}
