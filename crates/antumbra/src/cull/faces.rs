//! Polygons as the tree wants them: corners as doubles, a number for the line of each edge.

use antumbra_kernel::{Point, cross, sub};
use rustc_hash::FxHashMap;

use super::bound::parts;
use super::tree::{Face, MAX_OCCLUDER_CORNERS};

/// Gives each line of the scene a number: edges of different polygons that lie on one line share it.
#[derive(Default)]
pub(super) struct Lines {
    numbers: FxHashMap<[i64; 6], u32>,
}

impl Lines {
    /// The number of the line through two grid points. Exact: a primitive direction whose first
    /// component is positive (25 bits), and the moment about the origin (50 bits).
    fn number(&mut self, a: Point, b: Point) -> u32 {
        let mut d = sub(b, a);
        let divisor = gcd(gcd(d[0], d[1]), d[2]).max(1);
        let first = d.iter().copied().find(|&c| c != 0).unwrap_or(1);
        d = d.map(|c| c / divisor * first.signum());
        let m = cross(a.to_i64(), d);
        let next = self.numbers.len() as u32;
        *self
            .numbers
            .entry([d[0], d[1], d[2], m[0], m[1], m[2]])
            .or_insert(next)
    }
}

fn gcd(a: i64, b: i64) -> i64 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

struct Head {
    /// Its corners and lines.
    first: u32,
    end: u32,
    normal: [f64; 3],
    parts: [[f64; 3]; 2],
}

/// A list of convex polygons with at most [`MAX_OCCLUDER_CORNERS`] corners.
#[derive(Default)]
pub(super) struct Faces {
    corners: Vec<[f64; 3]>,
    lines: Vec<u32>,
    heads: Vec<Head>,
    areas: Vec<f64>,
    middles: Vec<[f64; 3]>,
}

impl Faces {
    pub(super) fn new() -> Self {
        Self::default()
    }

    pub(super) fn len(&self) -> usize {
        self.heads.len()
    }

    /// Appends a convex polygon that turns counter-clockwise about a normal; cut into several along
    /// diagonals if it has many corners.
    pub(super) fn push(&mut self, lines: &mut Lines, corners: &[Point], normal: [i64; 3]) {
        let mut rest = corners;
        let mut piece = Vec::with_capacity(MAX_OCCLUDER_CORNERS);
        while rest.len() > 1 {
            let take = rest.len().min(MAX_OCCLUDER_CORNERS - 1);
            piece.clear();
            if rest.len() < corners.len() {
                piece.push(corners[0]);
            }
            piece.extend_from_slice(&rest[..take]);
            self.push_piece(lines, &piece, normal);
            rest = &rest[take - 1..];
        }
    }

    fn push_piece(&mut self, lines: &mut Lines, corners: &[Point], normal: [i64; 3]) {
        let n = corners.len();
        let (parts, first) = (parts(normal), self.corners.len() as u32);
        let normal = normal.map(|c| c as f64);
        let length = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
        let normal = normal.map(|c| c / length);
        let mut area = 0.0;
        let mut middle = [0.0; 3];
        for (i, &p) in corners.iter().enumerate() {
            let q = corners[(i + 1) % n];
            self.lines.push(lines.number(p, q));
            let p = p.to_f64();
            self.corners.push(p);
            for k in 0..3 {
                middle[k] += p[k] / n as f64;
            }
        }
        for i in 1..n - 1 {
            let fan = cross(sub(corners[i], corners[0]), sub(corners[i + 1], corners[0]));
            area += (0..3).map(|k| fan[k] as f64 * normal[k]).sum::<f64>() / 2.0;
        }
        self.heads.push(Head {
            first,
            end: self.corners.len() as u32,
            normal,
            parts,
        });
        self.areas.push(area);
        self.middles.push(middle);
    }

    pub(super) fn get(&self, i: u32) -> Face<'_> {
        let head = &self.heads[i as usize];
        let range = head.first as usize..head.end as usize;
        Face {
            corners: &self.corners[range.clone()],
            lines: &self.lines[range],
            normal: head.normal,
            parts: head.parts,
        }
    }

    pub(super) fn normal(&self, i: u32) -> [f64; 3] {
        self.heads[i as usize].normal
    }

    /// In square grid steps.
    pub(super) fn area(&self, i: u32) -> f64 {
        self.areas[i as usize]
    }

    pub(super) fn middle(&self, i: u32) -> [f64; 3] {
        self.middles[i as usize]
    }
}

#[cfg(test)]
mod tests {
    use antumbra_kernel::Point;

    use super::{Faces, Lines};

    #[test]
    fn edges_on_one_line_share_its_number() {
        let p = |x, y| Point::new(x, y, 7);
        let (mut lines, mut faces) = (Lines::default(), Faces::new());
        faces.push(&mut lines, &[p(0, 0), p(4, 0), p(4, 4), p(0, 4)], [0, 0, 1]);
        faces.push(
            &mut lines,
            &[p(6, 4), p(10, 4), p(10, 8), p(6, 8)],
            [0, 0, 1],
        );
        let (a, b) = (faces.get(0), faces.get(1));
        assert_eq!(a.lines[2], b.lines[0]);
        assert_eq!(a.lines.iter().filter(|l| b.lines.contains(l)).count(), 1);
        assert_eq!((faces.area(0), faces.middle(1)), (16.0, [8.0, 6.0, 7.0]));
    }

    #[test]
    fn a_disc_is_cut_along_diagonals_and_keeps_its_area() {
        // On a parabola, so strictly convex.
        let corners: Vec<Point> = (0..100).map(|i| Point::new(i, i * i, 0)).collect();
        let (mut lines, mut faces) = (Lines::default(), Faces::new());
        faces.push(&mut lines, &corners, [0, 0, 1]);
        assert!(faces.len() > 4);
        let area: f64 = (0..faces.len() as u32).map(|i| faces.area(i)).sum();
        let exact: i64 = (1..99_i64).map(|i| i * (i + 1) / 2).sum();
        assert_eq!(area, exact as f64);
        // Pieces meet along diagonals, which share their lines.
        let (a, b) = (faces.get(0), faces.get(1));
        assert!(a.lines.iter().any(|l| b.lines.contains(l)));
    }
}
