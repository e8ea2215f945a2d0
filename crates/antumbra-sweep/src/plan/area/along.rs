//! Intervals of one line, and which of them tiles cover.

use std::cmp::Ordering;

use dashu_int::IBig;

use super::Signed;
use super::graph::Edge;
use super::lines::{CLEAR, Lines, SignedLine, sign};

/// A place on a line: where another line crosses it, or an end at infinity.
#[derive(Clone, Copy, Debug)]
struct Stop {
    line: usize,
    /// The way along the line, and how far it may be wrong.
    at: f64,
    error: f64,
}

const NONE: usize = usize::MAX;

type Span = [Stop; 2];

const WHOLE: Span = [
    Stop {
        line: NONE,
        at: f64::NEG_INFINITY,
        error: 0.0,
    },
    Stop {
        line: NONE,
        at: f64::INFINITY,
        error: 0.0,
    },
];

/// How another line meets a line.
enum Crossing {
    /// Nowhere: all of the line has this sign.
    Parallel(i8),
    /// There; whether its sign is positive beyond.
    At(Stop, bool),
}

/// All tiles, from one on and back from it in turn: neighbors of a tree overlap most.
fn nearest_first(tiles: &[Signed], first: usize) -> impl Iterator<Item = &Signed> {
    let (before, after) = tiles.split_at(first);
    let longer = before.len().max(after.len());
    let pair = move |k: usize| {
        [
            after.get(k),
            before.len().checked_sub(k + 1).map(|i| &before[i]),
        ]
    };
    (0..longer).flat_map(pair).flatten()
}

/// About where some intervals of a line are.
struct Reach {
    ends: [[f64; 2]; 2],
    /// How far that may be wrong.
    margin: f64,
}

impl Reach {
    fn new<'s>(along: &Along<'_>, spans: impl Iterator<Item = &'s Span>) -> Option<Self> {
        let mut whole: Option<[f64; 2]> = None;
        // Coordinates and values are right to 2^-24 steps.
        let mut margin = 1.0 / (1 << 20) as f64;
        for &[from, to] in spans {
            let [low, high] = whole.unwrap_or([from.at, to.at]);
            whole = Some([low.min(from.at), high.max(to.at)]);
            margin = margin.max(2.0 * from.error.max(to.error));
        }
        let ends = whole?.map(|at| along.point(at));
        Some(Self { ends, margin })
    }

    /// Whether a tile covers nothing here; `false` says nothing.
    fn misses(&self, lines: &Lines, tile: &Signed) -> bool {
        let [p, q] = self.ends;
        let beside = |k: usize| {
            let [low, high] = [0, 1].map(|i| tile.bounds[i][k]);
            p[k].min(q[k]) - self.margin > high || p[k].max(q[k]) + self.margin < low
        };
        if beside(0) || beside(1) {
            return true;
        }
        let side = |l: &SignedLine| {
            let [a, b, c] = lines.all[l.line].unit;
            let values = self.ends.map(|p| a * p[0] + b * p[1] + c);
            let values = if l.turned { values.map(|v| -v) } else { values };
            let positive = values.iter().all(|&v| v > self.margin);
            let negative = values.iter().all(|&v| v < -self.margin);
            i8::from(positive) - i8::from(negative)
        };
        if tile.halves.iter().any(|l| side(l) < 0) {
            return true;
        }
        let mut fan = tile.fan.iter().map(side);
        match fan.next() {
            None | Some(0) => false,
            Some(first) => fan.all(|s| s == first),
        }
    }
}

/// A line (a, b, c), in the direction (b, -a), which has its positive side on the left.
pub(super) struct Along<'l> {
    pub(super) lines: &'l Lines,
    pub(super) line: usize,
}

impl Along<'_> {
    /// The edges of the union on this line.
    pub(super) fn edges(&self, tiles: &[Signed], owners: &[usize], out: &mut Vec<Edge>) {
        let own = |left| {
            let mut spans = Vec::new();
            for &i in owners {
                self.cover(&tiles[i], left, &mut spans);
            }
            self.merge(spans)
        };
        let (left, right) = (own(true), own(false));
        let minus = |from: &[Span], what: &[Span]| {
            let mut rest = from.to_vec();
            what.iter().for_each(|cut| self.subtract(&mut rest, cut));
            rest
        };
        let (mut on_left, mut on_right) = (minus(&left, &right), minus(&right, &left));
        let Some(reach) = Reach::new(self, on_left.iter().chain(&on_right)) else {
            return;
        };
        let mut spans = Vec::new();
        for tile in nearest_first(tiles, owners[0]).filter(|t| !reach.misses(self.lines, t)) {
            if on_left.is_empty() && on_right.is_empty() {
                return;
            }
            for (rest, left) in [(&mut on_left, false), (&mut on_right, true)] {
                if !rest.is_empty() {
                    spans.clear();
                    self.cover(tile, left, &mut spans);
                    spans.iter().for_each(|cut| self.subtract(rest, cut));
                }
            }
        }
        for (rest, forward) in [(on_left, true), (on_right, false)] {
            out.extend(rest.iter().map(|&[from, to]| {
                let ends = [from.line, to.line];
                let line = self.line;
                Edge {
                    line,
                    forward,
                    ends: if forward { ends } else { [ends[1], ends[0]] },
                }
            }));
        }
    }

    /// The point at a way along the line.
    fn point(&self, at: f64) -> [f64; 2] {
        let [a, b, c] = self.lines.all[self.line].unit;
        [-a * c + at * b, -b * c - at * a]
    }

    /// Adds the intervals that have the inside of a tile on one side.
    fn cover(&self, tile: &Signed, left: bool, out: &mut Vec<Span>) {
        let mut whole = WHOLE;
        if !tile
            .halves
            .iter()
            .all(|&half| self.clip(&mut whole, half, left))
        {
            return;
        }
        let from = out.len();
        out.push(whole);
        if tile.fan.is_empty() {
            return;
        }
        for reverse in [false, true] {
            // Where no line of the funnel passes, since it is on the same side of all.
            let mut outside = whole;
            let missed = tile.fan.iter().all(|&l| {
                let half = if reverse { l.reversed() } else { l };
                self.clip(&mut outside, half, left)
            });
            if missed {
                let mut rest = out.split_off(from);
                self.subtract(&mut rest, &outside);
                out.append(&mut rest);
            }
        }
    }

    /// Keeps of an interval what is on the left of a line; whether that is anything.
    fn clip(&self, span: &mut Span, half: SignedLine, left: bool) -> bool {
        if half.line == self.line {
            return left != half.turned;
        }
        match self.crossing(half.line) {
            Crossing::Parallel(sign) => (sign > 0) != half.turned,
            Crossing::At(stop, rising) => {
                if rising != half.turned {
                    if self.order(&stop, &span[0]).is_gt() {
                        span[0] = stop;
                    }
                } else if self.order(&stop, &span[1]).is_lt() {
                    span[1] = stop;
                }
                self.order(&span[0], &span[1]).is_lt()
            }
        }
    }

    fn crossing(&self, other: usize) -> Crossing {
        let (l, m) = (&self.lines.all[self.line], &self.lines.all[other]);
        let turn = l.unit[0] * m.unit[1] - l.unit[1] * m.unit[0];
        let foot = [-l.unit[0] * l.unit[2], -l.unit[1] * l.unit[2]];
        let value = m.unit[0] * foot[0] + m.unit[1] * foot[1] + m.unit[2];
        if turn.abs() > CLEAR {
            let at = value / turn;
            // Units are right to 2^-50, the value at the foot to 2^-24 steps.
            let error = (1.0 / (1 << 23) as f64 + at.abs() / (1_u64 << 48) as f64) / turn.abs();
            let line = other;
            return Crossing::At(Stop { line, at, error }, turn < 0.0);
        }
        match self.lines.turn(self.line, other) {
            0 => Crossing::Parallel(self.side(other)),
            sign => {
                let at = value / turn;
                let at = if at.is_nan() { 0.0 } else { at };
                let stop = Stop {
                    line: other,
                    at,
                    error: f64::INFINITY,
                };
                Crossing::At(stop, sign < 0)
            }
        }
    }

    /// The sign of a parallel line at this one.
    fn side(&self, other: usize) -> i8 {
        let [l, m] = [self.line, other].map(|k| self.lines.all[k].exact.big());
        // The first of the two coefficients that is not zero is positive.
        let k = usize::from(l[0] == IBig::ZERO);
        sign(&(&m[2] * &l[k] - &m[k] * &l[2]))
    }

    /// The order of two places.
    fn order(&self, a: &Stop, b: &Stop) -> Ordering {
        if a.line == b.line && a.line != NONE {
            return Ordering::Equal;
        }
        if a.line == NONE || b.line == NONE || (a.at - b.at).abs() > a.error + b.error {
            // An end at infinity is beyond all crossings, however wrong these are.
            let key = |s: &Stop| {
                if s.line == NONE {
                    s.at
                } else {
                    s.at.clamp(f64::MIN, f64::MAX)
                }
            };
            return key(a).total_cmp(&key(b));
        }
        let lines = self.lines;
        let value = lines.determinant([self.line, a.line, b.line]);
        let turns = lines.turn(self.line, a.line) * lines.turn(self.line, b.line);
        // The value of b's line where a is; with the sign of how it grows, how far a is beyond b.
        (-value * turns).cmp(&0)
    }

    /// Disjoint intervals in order, from any.
    fn merge(&self, mut spans: Vec<Span>) -> Vec<Span> {
        spans.sort_by(|a, b| self.order(&a[0], &b[0]));
        let mut out: Vec<Span> = Vec::with_capacity(spans.len());
        for span in spans {
            match out.last_mut() {
                Some(last) if self.order(&span[0], &last[1]).is_le() => {
                    if self.order(&span[1], &last[1]).is_gt() {
                        last[1] = span[1];
                    }
                }
                _ => out.push(span),
            }
        }
        out
    }

    /// Takes an interval out of disjoint ones.
    fn subtract(&self, spans: &mut Vec<Span>, cut: &Span) {
        let mut i = 0;
        while i < spans.len() {
            let span = spans[i];
            let apart =
                self.order(&cut[1], &span[0]).is_le() || self.order(&span[1], &cut[0]).is_le();
            if apart {
                i += 1;
                continue;
            }
            let before = self.order(&span[0], &cut[0]).is_lt();
            let after = self.order(&cut[1], &span[1]).is_lt();
            match (before, after) {
                (false, false) => {
                    spans.remove(i);
                    continue;
                }
                (true, false) => spans[i][1] = cut[0],
                (false, true) => spans[i][0] = cut[1],
                (true, true) => {
                    spans[i][1] = cut[0];
                    spans.insert(i + 1, [cut[1], span[1]]);
                    i += 1;
                }
            }
            i += 1;
        }
    }
}
