//! Lines that lie over each other on paper: each is to be drawn once.
//!
//! On paper everything is rounded already; two lines are one where they are no farther apart than rounding
//! makes them.

use rustc_hash::FxHashMap;

/// The width of a square of the index, as a multiple of how far lines are apart that count as one.
const SQUARE: f64 = 400.0;

type Segment = [[f64; 2]; 2];

/// Segments that are drawn, and the squares of the paper that they cross.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    segments: Vec<Segment>,
    squares: FxHashMap<[i32; 2], Vec<u32>>,
    /// How far apart lines are that count as one.
    apart: f64,
}

impl Drawn {
    /// An empty paper.
    pub(super) fn new(apart: f64) -> Self {
        Self {
            segments: Vec::new(),
            squares: FxHashMap::default(),
            apart,
        }
    }

    /// Adds a segment.
    pub(super) fn add(&mut self, segment: Segment) {
        let number = self.segments.len() as u32;
        self.segments.push(segment);
        for square in self.crossed(segment) {
            self.squares.entry(square).or_default().push(number);
        }
    }

    /// The parts of a segment over which nothing is drawn yet, without crumbs.
    pub(super) fn uncovered(&self, segment: Segment) -> Vec<Segment> {
        let [a, b] = segment;
        let length = length(segment);
        let mut near: Vec<u32> = Vec::new();
        for square in self.crossed(segment) {
            near.extend(self.squares.get(&square).into_iter().flatten());
        }
        near.sort_unstable();
        near.dedup();
        let over = |&n: &u32| self.over(segment, length, self.segments[n as usize]);
        let mut covered: Vec<[f64; 2]> = near.iter().filter_map(over).collect();
        covered.sort_by(|s, t| s[0].total_cmp(&t[0]));
        let at = |s: f64| {
            let t = s / length;
            [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
        };
        let crumb = 2.0 * self.apart;
        let mut out = Vec::new();
        let mut from = 0.0_f64;
        for [low, high] in covered.into_iter().chain([[length, length]]) {
            if low - from > crumb || low - from >= length {
                out.push([at(from), at(low)]);
            }
            from = from.max(high);
        }
        out
    }

    /// The squares that a segment comes near to: row by row, or column by column if it is flat.
    fn crossed(&self, [a, b]: Segment) -> Vec<[i32; 2]> {
        let size = SQUARE * self.apart;
        let square = |c: f64| (c / size).floor() as i32;
        let axis = usize::from((b[1] - a[1]).abs() > (b[0] - a[0]).abs());
        let other = 1 - axis;
        let (a, b) = if a[axis] <= b[axis] { (a, b) } else { (b, a) };
        let slope = (b[other] - a[other]) / (b[axis] - a[axis]).max(f64::MIN_POSITIVE);
        let mut out = Vec::new();
        for i in square(a[axis] - self.apart)..=square(b[axis] + self.apart) {
            let [from, to] = [i, i + 1].map(|i| {
                let at = (f64::from(i) * size).clamp(a[axis], b[axis]);
                a[other] + (at - a[axis]) * slope
            });
            let (low, high) = (from.min(to) - self.apart, from.max(to) + self.apart);
            for j in square(low)..=square(high) {
                let mut place = [0; 2];
                (place[axis], place[other]) = (i, j);
                out.push(place);
            }
        }
        out
    }

    /// From where to where along a segment another one lies over it.
    fn over(&self, [a, b]: Segment, length: f64, other: Segment) -> Option<[f64; 2]> {
        let d = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        let [p, q] = other.map(|p| {
            let v = [p[0] - a[0], p[1] - a[1]];
            // Along, across.
            [v[0] * d[0] + v[1] * d[1], v[1] * d[0] - v[0] * d[1]]
        });
        let (p, q) = if p[0] <= q[0] { (p, q) } else { (q, p) };
        let (from, to) = (p[0].max(0.0), q[0].min(length));
        if from >= to {
            return None;
        }
        let across = |s: f64| p[1] + (s - p[0]) / (q[0] - p[0]) * (q[1] - p[1]);
        let near = across(from).abs() <= self.apart && across(to).abs() <= self.apart;
        near.then_some([from, to])
    }
}

fn length([a, b]: Segment) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

#[cfg(test)]
mod tests {
    use super::Drawn;

    #[test]
    fn what_is_drawn_is_not_drawn_again() {
        let mut drawn = Drawn::new(0.02);
        drawn.add([[0.0, 0.0], [10.0, 0.0]]);
        // Turned around, a little off.
        assert!(drawn.uncovered([[8.0, 0.01], [2.0, -0.01]]).is_empty());
        let rest = drawn.uncovered([[-5.0, 0.0], [15.0, 0.0]]);
        assert_eq!(
            rest,
            [[[-5.0, 0.0], [0.0, 0.0]], [[10.0, 0.0], [15.0, 0.0]]]
        );
        drawn.add([[10.0, 0.0], [20.0, 0.0]]);
        assert_eq!(
            drawn.uncovered([[-5.0, 0.0], [15.0, 0.0]]),
            [[[-5.0, 0.0], [0.0, 0.0]]]
        );
    }

    #[test]
    fn lines_beside_and_across_stay() {
        let mut drawn = Drawn::new(0.02);
        drawn.add([[0.0, 0.0], [10.0, 0.0]]);
        for other in [
            [[0.0, 0.1], [10.0, 0.1]],
            [[5.0, -5.0], [5.0, 5.0]],
            [[0.0, 0.0], [10.0, 0.1]],
            [[10.0, 0.0], [12.0, 0.0]],
        ] {
            assert_eq!(drawn.uncovered(other), [other]);
        }
        // Steep ones, on the border of two squares.
        drawn.add([[8.0, -20.0], [8.01, 40.0]]);
        assert!(drawn.uncovered([[7.995, 30.0], [7.995, -12.0]]).is_empty());
        assert_eq!(drawn.uncovered([[8.1, 30.0], [8.1, -12.0]]).len(), 1);
    }
}
