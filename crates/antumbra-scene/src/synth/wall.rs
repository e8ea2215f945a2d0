//! Straight walls with openings for doors and windows.

use super::shape::{Place, Shape};

/// An opening in a wall: where it is along the wall, and from which height to which.
#[derive(Clone, Copy, Debug)]
pub(super) struct Opening {
    /// Begin and end along the wall, measured from its start.
    pub along: [f64; 2],
    /// Lower and upper edge. An opening whose lower edge is the foot of the wall is a doorway.
    pub height: [f64; 2],
}

/// A wall in its local frame: `x` from 0 to `length`, `y` from 0 to `thickness`, `z` from 0 to
/// `height`, with at most one opening in each stretch of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall<'a> {
    pub place: Place,
    pub length: f64,
    pub thickness: f64,
    pub height: f64,
    /// In order along the wall, not overlapping, each strictly inside its length.
    pub openings: &'a [Opening],
}

impl Wall<'_> {
    /// All faces of the wall, those of its openings included.
    pub(super) fn shape(&self) -> Shape {
        let (t, h) = (self.thickness, self.height);
        let mut shape = Shape::new("wall", self.place).faces([0.0; 3], [self.length, t, h], "-x+x");
        let mut from = 0.0;
        for opening in self.openings {
            let ([a, b], [low, high]) = (opening.along, opening.height);
            shape = shape.faces([from, 0.0, 0.0], [a, t, h], "-y+y-z+z");
            // The reveals look into the opening, so they are the outside of the boxes around it.
            if low > 0.0 {
                shape = shape.faces([a, 0.0, 0.0], [b, t, low], "-y+y-z+z");
            }
            if high < h {
                shape = shape.faces([a, 0.0, high], [b, t, h], "-y+y-z+z");
            }
            shape = shape.faces([from, 0.0, low], [a, t, high], "+x");
            shape = shape.faces([b, 0.0, low], [self.length, t, high], "-x");
            from = b;
        }
        shape.faces([from, 0.0, 0.0], [self.length, t, h], "-y+y-z+z")
    }

    /// A pane or a closed leaf that fills an opening, in the middle of the wall.
    pub(super) fn filling(&self, opening: &Opening, class: &str, thickness: f64) -> Shape {
        let ([a, b], [low, high]) = (opening.along, opening.height);
        let y = (self.thickness - thickness) / 2.0;
        Shape::new(class, self.place).block([a, y, low], [b, y + thickness, high])
    }
}

#[cfg(test)]
mod tests {
    use super::{Opening, Place, Wall};

    #[test]
    fn the_area_of_a_wall_closes_around_its_openings() {
        let openings = [
            Opening {
                along: [1.0, 2.0],
                height: [0.0, 2.0],
            },
            Opening {
                along: [3.0, 4.0],
                height: [1.0, 2.0],
            },
        ];
        let wall = Wall {
            place: Place::new([0.0; 3], 0.0),
            length: 5.0,
            thickness: 0.5,
            height: 3.0,
            openings: &openings,
        };
        let object = wall.shape().object("wall");
        let part = &object.parts[0];
        // The sum of the area vectors of a closed surface is zero; the sum of the areas is known.
        let mut sum = [0.0; 3];
        let mut area = 0.0;
        for face in part.faces.iter() {
            let p = |i: usize| part.vertices[face[i] as usize];
            let u: [f64; 3] = std::array::from_fn(|k| p(2)[k] - p(0)[k]);
            let v: [f64; 3] = std::array::from_fn(|k| p(3)[k] - p(1)[k]);
            for (k, total) in sum.iter_mut().enumerate() {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let n = (u[i] * v[j] - u[j] * v[i]) / 2.0;
                *total += n;
                area += n.abs();
            }
        }
        assert!(sum.iter().all(|s| s.abs() < 1e-12), "{sum:?}");
        let sides = 2.0 * (15.0 - 2.0 - 1.0);
        let rim = 2.0 * 3.0 * 0.5 + (5.0 + 4.0) * 0.5;
        let reveals = (2.0 + 2.0 + 1.0 + 4.0) * 0.5;
        assert!((area - sides - rim - reveals).abs() < 1e-9, "{area}");
    }
}
