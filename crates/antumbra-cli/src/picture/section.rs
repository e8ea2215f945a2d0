//! The cut: everything above the cell is taken away if there is a roof above it.

use super::facing::facing;
use super::vector::{V3, clip};
use super::{Face, Shown, Subject};

/// A face after the cut.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub corners: Vec<V3>,
    pub object: u32,
    pub clear: bool,
    /// Belongs to a closed surface whose faces point outwards.
    pub solid: bool,
}

/// What is left of a subject below the cut, and where the cut went through.
#[derive(Clone, Debug)]
pub(super) struct Remains {
    pub pieces: Vec<Piece>,
    /// The height of the cut, if there is one.
    pub cut: Option<f64>,
    /// Lines of the cut: object, solid or not, begin and end.
    pub lines: Vec<(u32, bool, [V3; 2])>,
}

/// Cuts a subject open above its cell if that is needed to see inside.
pub(super) fn open(subject: &Subject) -> Remains {
    let cut = has_roof(subject).then(|| {
        let [min, max] = subject.cell;
        // A hair above the cell's top, so that faces in that plane go away, too.
        max[2] + (max[2] - min[2]).max(1e-6) * 1e-3
    });
    let facing = facing(subject);
    let mut remains = Remains {
        pieces: Vec::new(),
        cut,
        lines: Vec::new(),
    };
    for (face, reversed) in subject.faces.iter().zip(&facing.reversed) {
        let solid = facing.solid[face.object as usize];
        let source = subject.shown[face.object as usize] == Shown::Source;
        let mut corners = face.corners.clone();
        if *reversed {
            corners.reverse();
        }
        if let (Some(z), false) = (cut, source) {
            corners = clip(&corners, |p| z - p[2]);
            let is_on_cut = |p: &V3| (p[2] - z).abs() <= 1e-9 * (1.0 + z.abs());
            let on_cut: Vec<V3> = corners.iter().copied().filter(is_on_cut).collect();
            let from_above = face.corners.iter().any(|p| p[2] > z);
            if let ([a, b], true) = (&on_cut[..], from_above) {
                remains.lines.push((face.object, solid, [*a, *b]));
            }
        }
        if corners.len() >= 3 {
            let Face { object, clear, .. } = *face;
            remains.pieces.push(Piece {
                corners,
                object,
                clear,
                solid,
            });
        }
    }
    remains
}

/// Whether most of the cell has something above it.
fn has_roof(subject: &Subject) -> bool {
    let [min, max] = subject.cell;
    let at = |k: usize, t: f64| min[k] + t * (max[k] - min[k]);
    let samples = [
        (0.5, 0.5),
        (0.25, 0.3),
        (0.75, 0.3),
        (0.3, 0.7),
        (0.7, 0.75),
    ];
    let covered = |x: f64, y: f64| {
        subject.faces.iter().filter(|f| !f.clear).any(|f| {
            let above = f.corners.iter().all(|p| p[2] >= max[2]);
            above && subject.shown[f.object as usize] != Shown::Source && encloses(&f.corners, x, y)
        })
    };
    samples
        .iter()
        .filter(|(s, t)| covered(at(0, *s), at(1, *t)))
        .count()
        > samples.len() / 2
}

/// Whether a polygon covers a point, seen from above.
fn encloses(corners: &[V3], x: f64, y: f64) -> bool {
    let mut inside = false;
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            inside = !inside;
        }
    }
    inside
}

/// Chains lines into closed loops; lines that fit nowhere are left out.
pub(super) fn loops(lines: &[[V3; 2]]) -> Vec<Vec<[f64; 2]>> {
    let key = |p: &V3| [(p[0] * 1e4).round() as i64, (p[1] * 1e4).round() as i64];
    let mut at = std::collections::BTreeMap::<[i64; 2], Vec<usize>>::new();
    for (i, line) in lines.iter().enumerate() {
        for p in line {
            at.entry(key(p)).or_default().push(i);
        }
    }
    let mut used = vec![false; lines.len()];
    let mut loops = Vec::new();
    for first in 0..lines.len() {
        if std::mem::replace(&mut used[first], true) {
            continue;
        }
        let [start, mut here] = lines[first];
        let mut path = vec![[start[0], start[1]]];
        while key(&here) != key(&start) {
            path.push([here[0], here[1]]);
            let next = at
                .get(&key(&here))
                .and_then(|l| l.iter().find(|&&i| !used[i]));
            let Some(&next) = next else { break };
            used[next] = true;
            let [a, b] = lines[next];
            here = if key(&a) == key(&here) { b } else { a };
        }
        if key(&here) == key(&start) && path.len() >= 3 {
            loops.push(path);
        }
    }
    loops
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::{Face, Shown, Subject};
    use super::{loops, open};

    /// A box with outward faces.
    pub(in super::super) fn block(min: [f64; 3], max: [f64; 3], object: u32) -> Vec<Face> {
        let p = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { max[k] } else { min[k] });
        [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ]
        .map(|f| Face {
            corners: f.map(p).to_vec(),
            object,
            clear: false,
        })
        .to_vec()
    }

    fn subject(faces: Vec<Face>, objects: usize) -> Subject {
        let cell = [[0.0, 0.0, 1.0], [1.0, 1.0, 2.0]];
        Subject {
            faces,
            shown: vec![Shown::Visible; objects],
            cell,
            caption: String::new(),
        }
    }

    #[test]
    fn without_a_roof_nothing_is_cut() {
        let s = subject(block([2.0, 0.0, 0.0], [3.0, 1.0, 3.0], 0), 1);
        let remains = open(&s);
        assert!(remains.cut.is_none() && remains.lines.is_empty());
        assert!(remains.pieces.len() == 6 && remains.pieces.iter().all(|p| p.solid));
    }

    #[test]
    fn a_roof_is_taken_off_and_walls_are_sectioned() {
        let mut faces = block([2.0, 0.0, 0.0], [3.0, 1.0, 3.0], 0);
        faces.extend(block([-1.0, -1.0, 2.5], [3.0, 2.0, 3.0], 1));
        let remains = open(&subject(faces, 2));
        assert!(remains.cut.is_some());
        assert!(remains.pieces.iter().all(|p| p.object == 0));
        let lines: Vec<_> = remains.lines.iter().map(|l| l.2).collect();
        let loops = loops(&lines);
        assert_eq!(loops.len(), 1);
        assert_eq!(loops[0].len(), 4);
    }
}
