//! A few segments side by side, tested against one polygon at a time.

use antumbra_scene::PolygonId;

use crate::caster::{Caster, Segment, dot};

/// Segments in a bundle at most.
pub(crate) const LANES: usize = 6;

/// Up to [`LANES`] segments, their lines' coordinates in columns.
#[derive(Clone, Debug)]
pub(crate) struct Bundle {
    count: usize,
    segments: [Segment; LANES],
    /// Direction and moment of the lines, coordinate by coordinate.
    columns: [[f64; LANES]; 6],
}

impl Bundle {
    /// No segments.
    pub(crate) fn new() -> Self {
        Self {
            count: 0,
            segments: [Segment::new([0.0; 3], [0.0; 3]); LANES],
            columns: [[0.0; LANES]; 6],
        }
    }

    /// Adds a segment; those beyond [`LANES`] are dropped.
    pub(crate) fn push(&mut self, segment: Segment) {
        let lane = self.count;
        if lane < LANES {
            for k in 0..3 {
                self.columns[k][lane] = segment.step[k];
                self.columns[3 + k][lane] = segment.moment[k];
            }
            self.segments[lane] = segment;
            self.count += 1;
        }
    }

    pub(crate) fn segments(&self) -> &[Segment] {
        &self.segments[..self.count]
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Visits the segments whose lines cross a polygon (touching counts), with the parameter of
    /// the crossing: what [`Caster::crossing`] says of each, for all at once.
    #[inline]
    pub(crate) fn for_each_crossing(
        &self,
        caster: &Caster<'_>,
        id: PolygonId,
        mut visitor: impl FnMut(usize, f64),
    ) {
        let n = caster.normal(id);
        let c = &self.columns;
        let mut along = [0.0; LANES];
        for (l, a) in along.iter_mut().enumerate() {
            *a = n[0] * c[0][l] + n[1] * c[1][l] + n[2] * c[2][l];
        }
        // A line misses where its side on an edge and its direction through the plane differ.
        let mut worst = [0.0; LANES];
        for r in caster.rows(id) {
            for l in 0..LANES {
                let side = r[0] * c[0][l]
                    + r[1] * c[1][l]
                    + r[2] * c[2][l]
                    + r[3] * c[3][l]
                    + r[4] * c[4][l]
                    + r[5] * c[5][l];
                let product = side * along[l];
                worst[l] = if product < worst[l] {
                    product
                } else {
                    worst[l]
                };
            }
        }
        for (l, s) in self.segments().iter().enumerate() {
            if worst[l] == 0.0 && along[l] != 0.0 {
                visitor(l, (caster.offset(id) - dot(n, s.from)) / along[l]);
            }
        }
    }
}
