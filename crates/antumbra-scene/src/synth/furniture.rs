//! Pieces of furniture, each one object with a fixed number of faces.
//!
//! The local origin is the middle of the footprint on the floor; what a person uses (the front of
//! a shelf, the side of a desk one sits at) points to `-y`. Legs have no face on the floor.

use super::shape::{Place, Shape};
use crate::ObjectInput;

/// What can stand in a room or hang on its walls. The number is the count of faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Piece {
    /// 22: a top on four legs, 1.6 m by 0.8 m.
    Table,
    /// 28: seat, back and four legs; one sits looking to `+y`.
    Chair,
    /// 36: two sides and four boards, 1 m wide, 1.8 m high, open to both sides.
    Shelf,
    /// 6: 0.8 m wide, 1.2 m high.
    Cabinet,
    /// 12: a screen on its foot, at the height of a table top.
    Monitor,
    /// 24: seat, back and two arms, 1.8 m wide.
    Sofa,
    /// 5: an open box on the floor.
    Bin,
    /// 1: a sheet on a wall, at eye level.
    Picture,
    /// 1: a square of 1 m that shines down.
    Light,
}

impl Piece {
    /// The object, at a place.
    pub(super) fn at(self, place: Place) -> ObjectInput {
        match self {
            Self::Table => legs(Shape::new("furniture", place), [0.77, 0.37], 0.06, 0.72)
                .block([-0.8, -0.4, 0.72], [0.8, 0.4, 0.75])
                .object("table"),
            Self::Chair => legs(Shape::new("furniture", place), [0.21, 0.21], 0.04, 0.43)
                .block([-0.22, -0.22, 0.43], [0.22, 0.22, 0.46])
                .block([-0.22, -0.22, 0.46], [0.22, -0.19, 0.9])
                .object("chair"),
            Self::Shelf => [0.1, 0.66, 1.22, 1.77]
                .into_iter()
                .fold(Shape::new("furniture", place), |s, z| {
                    s.block([-0.47, -0.15, z], [0.47, 0.15, z + 0.03])
                })
                .block([-0.5, -0.15, 0.0], [-0.47, 0.15, 1.8])
                .block([0.47, -0.15, 0.0], [0.5, 0.15, 1.8])
                .object("shelf"),
            Self::Cabinet => Shape::new("furniture", place)
                .block([-0.4, -0.22, 0.0], [0.4, 0.22, 1.2])
                .object("cabinet"),
            Self::Monitor => Shape::new("device", place)
                .block([-0.1, -0.08, 0.75], [0.1, 0.08, 0.85])
                .block([-0.28, -0.02, 0.85], [0.28, 0.02, 1.2])
                .object("monitor"),
            Self::Sofa => Shape::new("furniture", place)
                .block([-0.75, -0.4, 0.0], [0.75, 0.25, 0.42])
                .block([-0.75, 0.25, 0.0], [0.75, 0.4, 0.8])
                .block([-0.9, -0.4, 0.0], [-0.75, 0.4, 0.6])
                .block([0.75, -0.4, 0.0], [0.9, 0.4, 0.6])
                .object("sofa"),
            Self::Bin => Shape::new("furniture", place)
                .faces([-0.15, -0.15, 0.0], [0.15, 0.15, 0.35], "-x+x-y+y-z")
                .object("bin"),
            Self::Picture => Shape::new("picture", place)
                .quad([
                    [-0.4, 0.0, 1.3],
                    [0.4, 0.0, 1.3],
                    [0.4, 0.0, 1.9],
                    [-0.4, 0.0, 1.9],
                ])
                .object("picture"),
            Self::Light => Shape::new("light", place)
                .quad([
                    [-0.5, -0.5, 0.0],
                    [-0.5, 0.5, 0.0],
                    [0.5, 0.5, 0.0],
                    [0.5, -0.5, 0.0],
                ])
                .object("light"),
        }
    }

    /// Whether it stands free in the room, so that it may be turned a little.
    pub(super) fn stands_free(self) -> bool {
        matches!(self, Self::Table | Self::Chair | Self::Monitor)
    }
}

/// Four square legs whose outer corners are at `(+-reach, +-reach)`: sixteen faces.
fn legs(mut shape: Shape, [x, y]: [f64; 2], width: f64, height: f64) -> Shape {
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let span = |s: f64, outer: f64| {
            let (a, b) = (s * outer, s * (outer - width));
            if a < b { [a, b] } else { [b, a] }
        };
        let ([x0, x1], [y0, y1]) = (span(sx, x), span(sy, y));
        shape = shape.faces([x0, y0, 0.0], [x1, y1, height], "-x+x-y+y");
    }
    shape
}

#[cfg(test)]
mod tests {
    use super::{Piece, Place};

    #[test]
    fn pieces_have_the_faces_they_promise() {
        let counts = [
            (Piece::Table, 22),
            (Piece::Chair, 28),
            (Piece::Shelf, 36),
            (Piece::Cabinet, 6),
            (Piece::Monitor, 12),
            (Piece::Sofa, 24),
            (Piece::Bin, 5),
            (Piece::Picture, 1),
            (Piece::Light, 1),
        ];
        for (piece, count) in counts {
            let object = piece.at(Place::new([1.0, 2.0, 0.0], 90.0));
            assert_eq!(object.parts[0].faces.len(), count, "{piece:?}");
        }
    }
}
