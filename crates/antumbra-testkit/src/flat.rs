//! An oracle for the plane: rays and lines against segments, decided by [`orient2d`] alone.
//!
//! It shares no code with the engine. Rays go through a raster of the segments; floats choose the fields
//! that a ray visits, with room to spare, and integers decide what it hits.

use std::cmp::Ordering;

use dashu_int::IBig;

/// A point of the integer grid.
pub type GridPoint = [i64; 2];

/// Twice the signed area of a triangle; positive if `c` is left of the way from `a` to `b`.
#[must_use]
pub fn orient2d(a: GridPoint, b: GridPoint, c: GridPoint) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The first segment that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlatHit {
    /// Which segment.
    pub segment: usize,
    /// Where on the segment, as numerator and positive denominator below 2^53.
    pub at: [i64; 2],
    /// Where along the ray, as a fraction of the way to its second point.
    pub along: [i64; 2],
    /// Whether the ray starts on a segment, passes through an end or a crossing, or along one, before or at the hit:
    /// such rays are no witnesses of anything.
    pub grazes: bool,
}

/// Segments in a raster.
#[derive(Clone, Debug)]
pub struct FlatScene {
    segments: Vec<[GridPoint; 2]>,
    low: [f64; 2],
    size: f64,
    counts: [usize; 2],
    first: Vec<u32>,
    items: Vec<u32>,
}

impl FlatScene {
    /// Sorts segments into a raster of about as many fields.
    ///
    /// # Panics
    /// If there are none.
    #[must_use]
    pub fn new(segments: Vec<[GridPoint; 2]>) -> Self {
        let of = |k: usize| segments.iter().flatten().map(move |p| p[k] as f64);
        let low = [0, 1].map(|k| of(k).fold(f64::INFINITY, f64::min) - 1.0);
        let high = [0, 1].map(|k| of(k).fold(f64::NEG_INFINITY, f64::max) + 1.0);
        let area = (high[0] - low[0]) * (high[1] - low[1]);
        let longest = (high[0] - low[0]).max(high[1] - low[1]);
        let size = (area / segments.len() as f64).sqrt().max(longest / 2048.0);
        let counts = [0, 1].map(|k| ((high[k] - low[k]) / size) as usize + 1);
        let mut scene = Self {
            segments,
            low,
            size,
            counts,
            first: Vec::new(),
            items: Vec::new(),
        };
        let mut fields: Vec<Vec<u32>> = vec![Vec::new(); counts[0] * counts[1]];
        for (i, &[a, b]) in scene.segments.iter().enumerate() {
            scene.walk(a, b, true, |field| {
                fields[field].push(i as u32);
                true
            });
        }
        scene.first.push(0);
        for field in fields {
            scene.items.extend(field);
            scene.first.push(scene.items.len() as u32);
        }
        scene
    }

    /// The segments.
    #[must_use]
    pub fn segments(&self) -> &[[GridPoint; 2]] {
        &self.segments
    }

    fn index(&self, axis: usize, at: f64) -> usize {
        (((at - self.low[axis]) / self.size).max(0.0) as usize).min(self.counts[axis] - 1)
    }

    /// Visits the fields of a segment, or of a ray to the border, by columns or rows along its longer
    /// extent, until `visit` says no at the end of a column.
    fn walk(&self, a: GridPoint, b: GridPoint, ends: bool, mut visit: impl FnMut(usize) -> bool) {
        let (p, q) = (a.map(|v| v as f64), b.map(|v| v as f64));
        let d = [q[0] - p[0], q[1] - p[1]];
        let long = usize::from(d[1].abs() > d[0].abs());
        let short = 1 - long;
        let slope = if d[long] == 0.0 {
            0.0
        } else {
            d[short] / d[long]
        };
        let edge = |axis: usize, up: bool| {
            if up {
                self.low[axis] + self.size * self.counts[axis] as f64
            } else {
                self.low[axis]
            }
        };
        let stop = if ends {
            q[long]
        } else {
            edge(long, d[long] > 0.0)
        };
        let (from, to) = (self.index(long, p[long]), self.index(long, stop));
        let columns: Vec<usize> = if from <= to {
            (from..=to).collect()
        } else {
            (to..=from).rev().collect()
        };
        for column in columns {
            let left = self.low[long] + column as f64 * self.size - 1.0;
            let right = left + self.size + 2.0;
            let (near, far) = (p[long].min(stop), p[long].max(stop));
            let at = |v: f64| p[short] + slope * (v.clamp(near, far) - p[long]);
            let (u, v) = (at(left), at(right));
            let rows = self.index(short, u.min(v) - 2.0)..=self.index(short, u.max(v) + 2.0);
            let mut go_on = true;
            for row in rows {
                let field = if long == 0 {
                    row * self.counts[0] + column
                } else {
                    column * self.counts[0] + row
                };
                go_on &= visit(field);
            }
            if !go_on {
                return;
            }
        }
    }

    /// What a ray from one point through another meets first, other than at its start. Exact.
    #[must_use]
    pub fn first_hit(&self, from: GridPoint, through: GridPoint) -> Option<FlatHit> {
        let mut best: Option<FlatHit> = None;
        let mut grazed: Option<[i64; 2]> = None;
        let long = usize::from((through[1] - from[1]).abs() > (through[0] - from[0]).abs());
        self.walk(from, through, false, |field| {
            let range = self.first[field] as usize..self.first[field + 1] as usize;
            for &i in &self.items[range] {
                let Some((hit, graze)) = meet(self.segments[i as usize], from, through) else {
                    continue;
                };
                if graze {
                    if grazed.is_none_or(|g| compare(hit.1, g).is_lt()) {
                        grazed = Some(hit.1);
                    }
                } else if best.is_none_or(|b| compare(hit.1, b.along).is_le()) {
                    // A crossing of two segments belongs to neither.
                    if let Some(b) = best
                        && b.segment != i as usize
                        && compare(hit.1, b.along).is_eq()
                        && grazed.is_none_or(|g| compare(hit.1, g).is_lt())
                    {
                        grazed = Some(hit.1);
                    }
                    best = Some(FlatHit {
                        segment: i as usize,
                        at: hit.0,
                        along: hit.1,
                        grazes: false,
                    });
                }
            }
            // Go on while the hit may lie beyond this column.
            let Some(b) = best else { return true };
            let t = b.along[0] as f64 / b.along[1] as f64;
            let reached = from[long] as f64 + t * (through[long] - from[long]) as f64;
            let column = if long == 0 {
                field % self.counts[0]
            } else {
                field / self.counts[0]
            };
            let edge = self.low[long] + column as f64 * self.size;
            if through[long] > from[long] {
                reached > edge + self.size - 4.0
            } else {
                reached < edge + 4.0
            }
        });
        let mut best = best?;
        best.grazes = grazed.is_some_and(|g| compare(g, best.along).is_le());
        Some(best)
    }
}

fn compare(a: [i64; 2], b: [i64; 2]) -> Ordering {
    let wide = |v: i64| i128::from(v);
    (wide(a[0]) * wide(b[1])).cmp(&(wide(b[0]) * wide(a[1])))
}

/// Where a segment and a ray meet: along the segment and along the ray; and whether they only graze.
#[allow(
    clippy::type_complexity,
    reason = "two fractions and a flag, used once"
)]
fn meet(
    [c, d]: [GridPoint; 2],
    p: GridPoint,
    q: GridPoint,
) -> Option<(([i64; 2], [i64; 2]), bool)> {
    let (sc, sd) = (orient2d(p, q, c), orient2d(p, q, d));
    if (sc > 0 && sd > 0) || (sc < 0 && sd < 0) {
        return None;
    }
    if sc == 0 && sd == 0 {
        // Along the ray: it grazes from the nearer end that is not behind the start.
        let along = |x: GridPoint| (x[0] - p[0]) * (q[0] - p[0]) + (x[1] - p[1]) * (q[1] - p[1]);
        let length = along(q);
        let (near, far) = (along(c).min(along(d)), along(c).max(along(d)));
        return (far >= 0).then_some((([0, 1], [near.max(0), length]), true));
    }
    let (sp, sq) = (orient2d(c, d, p), orient2d(c, d, q));
    let (mut n, mut m) = (sp, sp - sq);
    if m < 0 {
        (n, m) = (-n, -m);
    }
    if n < 0 {
        return None;
    }
    let (mut t, mut e) = (sc, sc - sd);
    if e < 0 {
        (t, e) = (-t, -e);
    }
    Some((([t, e], [n, m]), n == 0 || sc == 0 || sd == 0))
}

/// What an oriented line `a x + b y + c` meets first once it has left a convex cell: the segment and where on
/// it. Brute force; big integers compare. `Err` says what it touches before, so that it proves nothing.
///
/// # Errors
/// If the line misses the open cell, or runs through an end of a segment, or along one, before.
pub fn first_on_line(
    segments: &[[GridPoint; 2]],
    line: &[IBig; 3],
    cell: &[GridPoint],
) -> Result<Option<(usize, [IBig; 2])>, String> {
    let small: Option<[i128; 3]> = {
        let parts: Vec<i128> = line.iter().filter_map(|c| i128::try_from(c).ok()).collect();
        parts.try_into().ok()
    };
    let small = small.filter(|l: &[i128; 3]| l.iter().all(|c| c.unsigned_abs() < 1 << 90));
    let side = |p: GridPoint| -> i8 {
        if let Some(l) = small {
            let v = l[0] * i128::from(p[0]) + l[1] * i128::from(p[1]) + l[2];
            return v.signum() as i8;
        }
        let v: IBig = &line[0] * p[0] + &line[1] * p[1] + &line[2];
        i8::from(v > IBig::ZERO) - i8::from(v < IBig::ZERO)
    };
    let value = |p: GridPoint| -> IBig { &line[0] * p[0] + &line[1] * p[1] + &line[2] };
    // Where the line meets a segment: a homogeneous place along its direction (b, -a).
    let place = |c: GridPoint, d: GridPoint| -> [IBig; 2] {
        let (u, v) = (value(c), value(d));
        let along = |p: GridPoint| -> IBig { &line[1] * p[0] - &line[0] * p[1] };
        // The point (v c - u d) / (v - u).
        let w = &v - &u;
        let n = &v * along(c) - &u * along(d);
        if w < IBig::ZERO { [-n, -w] } else { [n, w] }
    };
    let before = |a: &[IBig; 2], b: &[IBig; 2]| &a[0] * &b[1] < &b[0] * &a[1];
    let n = cell.len();
    let mut exit: Option<[IBig; 2]> = None;
    let mut sides = [false; 2];
    for i in 0..n {
        let (c, d) = (cell[i], cell[(i + 1) % n]);
        sides[0] |= side(c) > 0;
        sides[1] |= side(c) < 0;
        if side(c) * side(d) < 0 || (side(c) == 0) != (side(d) == 0) {
            let at = place(c, d);
            if exit.as_ref().is_none_or(|e| before(e, &at)) {
                exit = Some(at);
            }
        }
    }
    let exit = exit
        .filter(|_| sides == [true; 2])
        .ok_or("the line misses the open cell")?;
    let mut best: Option<(usize, [IBig; 2])> = None;
    let mut touched: Option<([IBig; 2], usize)> = None;
    for (i, &[c, d]) in segments.iter().enumerate() {
        let (s, t) = (side(c), side(d));
        if s * t > 0 {
            continue;
        }
        if s == 0 && t == 0 {
            // Along it: touched where it begins, or at the exit.
            let along = |p: GridPoint| [&line[1] * p[0] - &line[0] * p[1], IBig::ONE];
            let (mut near, mut far) = (along(c), along(d));
            if before(&far, &near) {
                std::mem::swap(&mut near, &mut far);
            }
            if !before(&far, &exit) && touched.as_ref().is_none_or(|(b, _)| before(&near, b)) {
                touched = Some((near, i));
            }
            continue;
        }
        let at = place(c, d);
        if before(&at, &exit) {
            continue;
        }
        if s == 0 || t == 0 {
            if touched.as_ref().is_none_or(|(b, _)| before(&at, b)) {
                touched = Some((at, i));
            }
        } else if best.as_ref().is_none_or(|(_, b)| !before(b, &at)) {
            // A crossing of two segments belongs to neither.
            if let Some((_, b)) = &best
                && !before(&at, b)
                && touched.as_ref().is_none_or(|(t, _)| before(&at, t))
            {
                touched = Some((at.clone(), i));
            }
            best = Some((i, at));
        }
    }
    if let Some((at, i)) = touched
        && best.as_ref().is_none_or(|(_, b)| !before(b, &at))
    {
        return Err(format!("the line touches segment {i} without crossing it"));
    }
    Ok(best.map(|(i, _)| {
        let [c, d] = segments[i];
        let (u, v) = (value(c), value(d));
        let w = &u - &v;
        (i, if w < IBig::ZERO { [-u, -w] } else { [u, w] })
    }))
}

#[cfg(test)]
mod tests {
    use super::{FlatScene, first_on_line};
    use crate::random::Random;
    use dashu_int::IBig;

    #[test]
    fn the_raster_hides_nothing() {
        let mut random = Random::new(2);
        let mut p = || [random.integer(-900, 900), random.integer(-900, 900)];
        let segments: Vec<_> = (0..60).map(|_| [p(), p()]).collect();
        let scene = FlatScene::new(segments.clone());
        let mut hits = 0;
        for _ in 0..3000 {
            let (from, through) = (p(), p());
            let found = scene.first_hit(from, through);
            let all = segments
                .iter()
                .enumerate()
                .filter_map(|(i, &s)| super::meet(s, from, through).map(|m| (i, m)));
            let nearest = all
                .filter(|(_, m)| !m.1)
                .min_by(|a, b| super::compare(a.1.0.1, b.1.0.1));
            assert_eq!(found.map(|h| h.segment), nearest.map(|n| n.0));
            hits += usize::from(found.is_some());
        }
        assert!(hits > 2000);
    }

    #[test]
    fn a_line_meets_what_is_first_beyond_the_cell() {
        let cell = [[0, 0], [4, 0], [4, 4], [0, 4]];
        let segments = [[[1, 1], [3, 1]], [[9, 0], [9, 9]], [[6, -9], [6, 9]]];
        // The x axis at y = 2, to the right: (uy - vy, vx - ux, ...) = (0, 1, -2).
        let line = |a: i64, b: i64, c: i64| [a, b, c].map(IBig::from);
        let hit = first_on_line(&segments, &line(0, 1, -2), &cell).expect("a witness");
        assert_eq!(hit.map(|h| h.0), Some(2));
        let up = first_on_line(&segments, &line(-1, 0, 2), &cell).expect("a witness");
        assert_eq!(up, None);
        assert!(first_on_line(&segments, &line(0, 1, -9), &cell).is_err());
        // What it touches first counts, whatever crosses it in one point farther away.
        let segments = [
            [[4, 2], [6, 9]],
            [[8, 0], [10, 4]],
            [[10, 0], [8, 4]],
            [[7, -9], [7, 9]],
        ];
        assert!(first_on_line(&segments, &line(0, 1, -2), &cell).is_err());
    }
}
