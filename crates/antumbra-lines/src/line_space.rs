//! What a line space has to offer so that an occlusion tree can be built in it.
//!
//! After [Bittner02, 3.3]: an oriented line is a point, a set of lines a convex piece, an edge of an
//! occluder a hyperplane. The tree, the sweep and the tests are written once, over this trait.

use std::fmt::Debug;

use antumbra_kernel::Sign;

/// One of the two sides of a hyperplane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Half {
    /// Where the hyperplane's row is negative.
    Negative,
    /// Where it is positive.
    Positive,
}

impl Half {
    /// The other side.
    #[inline]
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Positive => Self::Negative,
        }
    }

    /// 0 for negative, 1 for positive.
    #[inline]
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// The sign that the row has inside this half.
    #[inline]
    #[must_use]
    pub fn sign(self) -> Sign {
        match self {
            Self::Negative => Sign::Negative,
            Self::Positive => Sign::Positive,
        }
    }
}

/// Where an open piece lies with respect to a hyperplane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Position {
    /// On one side only; its border may touch the hyperplane.
    In(Half),
    /// On both sides.
    Both,
}

/// Names a facet of a piece by the node of a tree whose hyperplane it lies on, so that pieces on
/// both sides find each other, and known borders are not inserted again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Wall(pub u32);

impl Wall {
    /// The facet lies on no hyperplane that the piece was cut by.
    pub const NONE: Self = Self(u32::MAX);

    /// Whether the facet is still new.
    #[inline]
    #[must_use]
    pub fn is_none(self) -> bool {
        self == Self::NONE
    }
}

/// A facet of a piece: its hyperplane, the side on which the piece lies, and its wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet<P> {
    /// The hyperplane.
    pub plane: P,
    /// On which side of it the piece lies.
    pub side: Half,
    /// Which cut it comes from.
    pub wall: Wall,
}

/// A piece cut by a hyperplane.
#[derive(Clone, Debug)]
pub enum Cut<T> {
    /// The piece lies on one side and stays whole.
    Whole(Half, T),
    /// The two parts, negative first; both have an interior.
    Parts([T; 2]),
}

/// The number of an occluder in a line space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Occluder(pub u32);

/// How two occluders lie in depth along all lines of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order<P> {
    /// The new one is nowhere in front.
    Behind,
    /// The new one is nowhere behind.
    InFront,
    /// They change places at a hyperplane, which is that of their common line; the new one is in
    /// front on this side.
    Crossing(P, Half),
}

/// A space of lines in which convex pieces are cut by hyperplanes, exactly.
///
/// Pieces are closed convex cones with an interior. The laws that every space keeps are written in
/// `tests/laws`: a cut leaves each ray in a part, parts lie on their sides and touch along the cut,
/// and the order of cuts does not matter.
pub trait LineSpace {
    /// A hyperplane by name.
    type Plane: Copy + Eq + Debug;
    /// An extreme ray of a piece.
    type Ray: Clone + Debug + 'static;
    /// A convex set of lines with an interior.
    type Piece: Clone + Debug + 'static;

    /// On which side of a hyperplane a ray lies. Exact.
    fn sign(&self, plane: Self::Plane, ray: &Self::Ray) -> Sign;

    /// The extreme rays of a piece.
    fn rays<'p>(&self, piece: &'p Self::Piece) -> impl Iterator<Item = &'p Self::Ray> + 'p;

    /// The facets of a piece.
    fn facets(&self, piece: &Self::Piece) -> impl Iterator<Item = Facet<Self::Plane>>;

    /// Cuts a piece by a hyperplane. The new facets, and a facet of the whole piece that lies in
    /// the hyperplane, get the wall.
    fn cut(&mut self, piece: Self::Piece, plane: Self::Plane, wall: Wall) -> Cut<Self::Piece>;

    /// Takes back the memory of a piece that is no longer needed.
    fn discard(&mut self, piece: Self::Piece) {
        drop(piece);
    }

    /// Where a piece lies with respect to a hyperplane. Exact.
    fn position(&self, piece: &Self::Piece, plane: Self::Plane) -> Position {
        let mut seen = None;
        for ray in self.rays(piece) {
            let half = match self.sign(plane, ray) {
                Sign::Zero => continue,
                Sign::Negative => Half::Negative,
                Sign::Positive => Half::Positive,
            };
            match seen {
                Some(other) if other != half => return Position::Both,
                _ => seen = Some(half),
            }
        }
        // A piece has an interior, so some ray is off the hyperplane.
        Position::In(seen.unwrap_or(Half::Positive))
    }
}

/// A line space that knows occluders and their depth order.
pub trait DepthSpace: LineSpace {
    /// Which of two occluders comes first on the lines of a piece that meets both. Exact; of two
    /// in one plane the one with the smaller key is in front.
    fn order(&mut self, piece: &Self::Piece, new: Occluder, old: Occluder) -> Order<Self::Plane>;
}
