//! Lines that lie over each other on paper: each is to be drawn once.
//!
//! On paper everything is rounded already; two lines are one where they are no farther apart than rounding
//! makes them.

/// How many classes of directions there are.
const DIRECTIONS: usize = 180;

type Segment = [[f64; 2]; 2];

/// Segments that are drawn, by direction.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    by_direction: Vec<Vec<Segment>>,
    /// How far apart lines are that count as one.
    apart: f64,
}

impl Drawn {
    /// An empty paper.
    pub(super) fn new(apart: f64) -> Self {
        Self {
            by_direction: vec![Vec::new(); DIRECTIONS],
            apart,
        }
    }

    /// Adds a segment.
    pub(super) fn add(&mut self, segment: Segment) {
        for class in self.classes(segment) {
            self.by_direction[class].push(segment);
        }
    }

    /// The parts of a segment over which nothing is drawn yet, without crumbs.
    pub(super) fn uncovered(&self, segment: Segment) -> Vec<Segment> {
        let [a, b] = segment;
        let length = length(segment);
        let mut covered: Vec<[f64; 2]> = Vec::new();
        for class in self.classes(segment) {
            let here = &self.by_direction[class];
            covered.extend(here.iter().filter_map(|&s| self.over(segment, length, s)));
        }
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

    /// The directions that a segment may have, as far as rounding can turn it.
    fn classes(&self, [a, b]: Segment) -> Vec<usize> {
        let turn = (b[1] - a[1]).atan2(b[0] - a[0]);
        let slack = 2.0 * self.apart / length([a, b]).max(self.apart);
        let step = std::f64::consts::PI / DIRECTIONS as f64;
        let class = |angle: f64| (angle / step).floor() as i64;
        let (low, high) = (class(turn - slack), class(turn + slack));
        let count = (high - low + 1).min(DIRECTIONS as i64);
        (low..low + count)
            .map(|c| c.rem_euclid(DIRECTIONS as i64) as usize)
            .collect()
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
        // Steep ones, whose directions are the first and the last class.
        drawn.add([[0.0, 0.0], [-10.0, -0.01]]);
        assert!(drawn.uncovered([[-9.0, 0.0], [-1.0, 0.0]]).is_empty());
    }
}
