//! Quads and boxes: what synthetic scenes are made of.

use crate::{ObjectInput, PartInput, SceneInput};

/// A place on the floor: where the local origin of a piece of furniture goes, and how it is turned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    at: [f64; 3],
    cos: f64,
    sin: f64,
}

impl Place {
    /// At a point, turned counter-clockwise (seen from above) by an angle in degrees.
    pub(super) fn new(at: [f64; 3], degrees: f64) -> Self {
        // Quarter turns are exact, so that axis-parallel scenes stay axis-parallel.
        let (sin, cos) = match degrees.rem_euclid(360.0) {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            d => d.to_radians().sin_cos(),
        };
        Self { at, cos, sin }
    }

    /// The place that `local` is, seen from this one.
    pub(super) fn then(&self, local: &Self) -> Self {
        Self {
            at: self.apply(local.at),
            cos: self.cos * local.cos - self.sin * local.sin,
            sin: self.sin * local.cos + self.cos * local.sin,
        }
    }

    /// Where a local point is in the scene.
    pub(super) fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.at;
        [
            a + self.cos * x - self.sin * y,
            b + self.sin * x + self.cos * y,
            c + z,
        ]
    }
}

/// An object under construction: faces of one class, placed as a whole.
#[derive(Debug)]
pub(super) struct Shape {
    place: Place,
    part: PartInput,
}

impl Shape {
    /// An empty shape whose coordinates are relative to a place.
    pub(super) fn new(class: &str, place: Place) -> Self {
        let part = PartInput {
            class: Some(class.to_owned()),
            ..PartInput::default()
        };
        Self { place, part }
    }

    /// An empty shape in scene coordinates.
    pub(super) fn fixed(class: &str) -> Self {
        Self::new(class, Place::new([0.0; 3], 0.0))
    }

    /// Lets light through.
    pub(super) fn translucent(mut self) -> Self {
        self.part.translucent = true;
        self
    }

    /// Adds a quad, its corners counter-clockwise seen from its front.
    pub(super) fn quad(mut self, corners: [[f64; 3]; 4]) -> Self {
        let n = self.part.vertices.len() as u32;
        self.part
            .vertices
            .extend(corners.map(|p| self.place.apply(p)));
        self.part.faces.push(&[n, n + 1, n + 2, n + 3]);
        self
    }

    /// Adds a box with all its six faces, which point outwards.
    pub(super) fn block(self, min: [f64; 3], max: [f64; 3]) -> Self {
        self.faces(min, max, "-x+x-y+y-z+z")
    }

    /// Adds some faces of a box, named by their outward direction, as in `"-x+z"`.
    pub(super) fn faces(mut self, min: [f64; 3], max: [f64; 3], which: &str) -> Self {
        let ([a, b, c], [d, e, f]) = (min, max);
        let n = self.part.vertices.len() as u32;
        let corners = [
            [a, b, c],
            [d, b, c],
            [d, e, c],
            [a, e, c],
            [a, b, f],
            [d, b, f],
            [d, e, f],
            [a, e, f],
        ];
        self.part
            .vertices
            .extend(corners.map(|p| self.place.apply(p)));
        let all: [(&str, [u32; 4]); 6] = [
            ("-x", [0, 4, 7, 3]),
            ("+x", [1, 2, 6, 5]),
            ("-y", [0, 1, 5, 4]),
            ("+y", [3, 7, 6, 2]),
            ("-z", [0, 3, 2, 1]),
            ("+z", [4, 5, 6, 7]),
        ];
        for (_, face) in all.iter().filter(|(name, _)| which.contains(name)) {
            self.part.faces.push(&face.map(|i| i + n));
        }
        self
    }

    /// The finished object.
    pub(super) fn object(self, name: impl Into<String>) -> ObjectInput {
        ObjectInput {
            name: Some(name.into()),
            parts: vec![self.part],
        }
    }
}

/// A square in the plane `x = at` that faces `+x`, given its center in y and z and half its side.
pub(super) fn square_facing_x(name: &str, at: f64, [y, z]: [f64; 2], half: f64) -> ObjectInput {
    Shape::fixed(name)
        .quad([
            [at, y - half, z - half],
            [at, y + half, z - half],
            [at, y + half, z + half],
            [at, y - half, z + half],
        ])
        .object(name)
}

/// Names a list of objects `desk-0`, `desk-1`, ... where several share a name, in order.
pub(super) fn number_names(scene: &mut SceneInput) {
    let mut seen = std::collections::BTreeMap::<String, u32>::new();
    for name in scene.objects.iter().filter_map(|o| o.name.as_ref()) {
        *seen.entry(name.clone()).or_default() += 1;
    }
    seen.retain(|_, n| *n > 1);
    let mut next = std::collections::BTreeMap::<String, u32>::new();
    for name in scene.objects.iter_mut().filter_map(|o| o.name.as_mut()) {
        if seen.contains_key(name) {
            let n = next.entry(name.clone()).or_default();
            let numbered = format!("{name}-{n}");
            *n += 1;
            *name = numbered;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Place, Shape, square_facing_x};

    #[test]
    fn the_faces_of_a_block_point_outwards() {
        let object = Shape::new("box", Place::new([5.0, 6.0, 7.0], 30.0))
            .block([-1.0; 3], [1.0; 3])
            .object("box");
        let part = &object.parts[0];
        assert_eq!(part.faces.len(), 6);
        for face in part.faces.iter() {
            let p = |i: usize| part.vertices[face[i] as usize];
            let (a, b, c) = (p(0), p(1), p(2));
            let u: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
            let v: [f64; 3] = std::array::from_fn(|k| c[k] - a[k]);
            let out = [a[0] - 5.0, a[1] - 6.0, a[2] - 7.0];
            let n = [
                u[1] * v[2] - u[2] * v[1],
                u[2] * v[0] - u[0] * v[2],
                u[0] * v[1] - u[1] * v[0],
            ];
            assert!((0..3).map(|k| n[k] * out[k]).sum::<f64>() > 0.0);
        }
    }

    #[test]
    fn the_square_faces_plus_x() {
        let square = square_facing_x("s", 1.0, [0.0, 0.0], 2.0);
        let p = &square.parts[0].vertices;
        let (u, v) = (
            [p[1][1] - p[0][1], p[1][2] - p[0][2]],
            [p[2][1] - p[0][1], p[2][2] - p[0][2]],
        );
        assert!(u[0] * v[1] - u[1] * v[0] > 0.0);
    }
}
