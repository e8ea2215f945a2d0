//! Edges of the union, linked to polygons.

use std::cmp::Ordering;

use dashu_int::IBig;
use rustc_hash::FxHashMap;

use super::Outlines;
use super::lines::Lines;

/// An interval of a line that has the union on its left and none of it on its right.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) line: usize,
    /// Whether it runs in the line's direction.
    pub(super) forward: bool,
    /// The lines that cross at its start and at its end.
    pub(super) ends: [usize; 2],
}

/// The border of the union: edges between corners.
pub(super) struct Graph<'l> {
    lines: &'l Lines,
    edges: Vec<Edge>,
    /// The corners at which an edge starts and ends.
    corners: Vec<[usize; 2]>,
    places: Vec<[f64; 2]>,
    /// The edges that leave a corner.
    leaving: Vec<Vec<usize>>,
}

impl<'l> Graph<'l> {
    pub(super) fn new(lines: &'l Lines, edges: Vec<Edge>) -> Self {
        let mut ids: FxHashMap<[IBig; 3], usize> = FxHashMap::default();
        let mut places = Vec::new();
        let mut corner = |l: usize, m: usize| {
            *ids.entry(lines.corner(l, m))
                .or_insert_with_key(|[x, y, w]| {
                    let w = w.to_f64().value();
                    places.push([x.to_f64().value() / w, y.to_f64().value() / w]);
                    places.len() - 1
                })
        };
        let corners: Vec<[usize; 2]> = edges
            .iter()
            .map(|e| e.ends.map(|m| corner(e.line, m)))
            .collect();
        let mut leaving = vec![Vec::new(); places.len()];
        for (e, ends) in corners.iter().enumerate() {
            leaving[ends[0]].push(e);
        }
        Self {
            lines,
            edges,
            corners,
            places,
            leaving,
        }
    }

    /// The direction of an edge in doubles.
    fn direction(&self, e: usize) -> [f64; 2] {
        let Edge { line, forward, .. } = self.edges[e];
        let [a, b, _] = self.lines.all[line].unit;
        if forward { [b, -a] } else { [-b, a] }
    }

    /// The sign of the turn from one edge to another.
    fn turn(&self, e: usize, f: usize) -> i8 {
        let (e, f) = (self.edges[e], self.edges[f]);
        let turn = self.lines.turn(e.line, f.line);
        if e.forward == f.forward { turn } else { -turn }
    }

    /// The angle by which one turns from an edge to the next, its sign exact.
    fn angle(&self, e: usize, f: usize) -> f64 {
        let ([ux, uy], [vx, vy]) = (self.direction(e), self.direction(f));
        let sine = (ux * vy - uy * vx).abs() * f64::from(self.turn(e, f));
        sine.atan2(ux * vx + uy * vy)
    }

    /// Whether from an edge that arrives one turns further to the left on one edge than on another. Exact.
    fn more_left(&self, arriving: usize, one: usize, other: usize) -> bool {
        let rank = |e: usize| match self.turn(arriving, e) {
            1 => 2,
            -1 => 0,
            _ => i8::from(self.edges[e].forward == self.edges[arriving].forward),
        };
        match rank(one).cmp(&rank(other)) {
            Ordering::Equal => self.turn(one, other) < 0,
            order => order.is_gt(),
        }
    }

    /// The polygons that the edges bound.
    pub(super) fn polygons(&mut self) -> Vec<Outlines> {
        let mut outer = Vec::new();
        let mut holes = Vec::new();
        for first in 0..self.edges.len() {
            let ends = self.corners[first];
            if !self.leaving[ends[0]].contains(&first) {
                continue;
            }
            let way = self.trace(first);
            for ring in self.simple(way) {
                let n = ring.len();
                let turns: f64 = (0..n).map(|i| self.angle(ring[i], ring[(i + 1) % n])).sum();
                let outline = self.outline(&ring);
                if outline.len() > 2 {
                    if turns > 0.0 { &mut outer } else { &mut holes }.push(outline);
                }
            }
        }
        nest(outer, holes)
    }

    /// A closed way along edges with the same piece of the union on its left; takes them out.
    fn trace(&mut self, first: usize) -> Vec<usize> {
        let mut way = vec![first];
        let start = self.corners[first][0];
        self.leaving[start].retain(|&e| e != first);
        let mut edge = first;
        loop {
            let here = self.corners[edge][1];
            let next = self.leaving[here].iter().copied().reduce(|best, e| {
                if self.more_left(edge, e, best) {
                    e
                } else {
                    best
                }
            });
            // At the start, the first edge is one of the choices, too.
            let next = match next {
                Some(next) if here != start || self.more_left(edge, next, first) => next,
                _ => return way,
            };
            self.leaving[here].retain(|&e| e != next);
            way.push(next);
            edge = next;
        }
    }

    /// A closed way in closed ways that pass no corner twice.
    fn simple(&self, way: Vec<usize>) -> Vec<Vec<usize>> {
        let mut out = Vec::new();
        let mut open: Vec<usize> = Vec::new();
        for e in way {
            open.push(e);
            let end = self.corners[e][1];
            if let Some(from) = open.iter().rposition(|&f| self.corners[f][0] == end) {
                out.push(open.split_off(from));
            }
        }
        out
    }

    /// The corners of a ring, those that were rounded to one place once.
    fn outline(&self, ring: &[usize]) -> Vec<[f64; 2]> {
        let mut out: Vec<[f64; 2]> = ring
            .iter()
            .map(|&e| self.places[self.corners[e][0]])
            .collect();
        out.dedup();
        while out.len() > 1 && out.first() == out.last() {
            out.pop();
        }
        out
    }
}

/// Outlines with their holes.
fn nest(outer: Vec<Vec<[f64; 2]>>, holes: Vec<Vec<[f64; 2]>>) -> Vec<Outlines> {
    let mut out: Vec<Outlines> = outer.into_iter().map(|ring| vec![ring]).collect();
    for hole in holes {
        // The middle of an edge: corners may lie on an outline.
        let middle = [0, 1].map(|k| (hole[0][k] + hole[1][k]) / 2.0);
        let around = (0..out.len())
            .filter(|&i| out.len() == 1 || winds(&out[i][0], middle))
            .min_by(|&i, &j| area(&out[i][0]).total_cmp(&area(&out[j][0])));
        if let Some(i) = around {
            out[i].push(hole);
        }
    }
    out
}

/// Whether a ring goes around a point.
fn winds(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        if (a[1] > y) != (b[1] > y) {
            inside ^= x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]);
        }
    }
    inside
}

/// The area of a ring, positive if it is counter-clockwise.
fn area(ring: &[[f64; 2]]) -> f64 {
    let n = ring.len();
    let o = ring[0];
    let twice = (1..n).map(|i| {
        let (p, q) = (ring[i], ring[(i + 1) % n]);
        (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0])
    });
    twice.sum::<f64>() / 2.0
}
