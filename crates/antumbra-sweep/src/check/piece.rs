//! Pieces of line space between two gates, in the narrowest numbers that hold them.

use super::big::{Big, Wide, primitive};
use super::cone::{Cone, Ray, Trouble};
use super::ends::Gate;
use super::fast::{Fast, FastRow};
use super::middle::{Middle, MiddleRow, MiddleVertex, middle_sign};
use super::numbers::Numbers;
use super::real::holds_real_lines;
use super::rows::Hyperplane;
use super::start::{corner_lines, start_rows};

/// A cone with interior.
#[derive(Clone, Debug)]
pub(super) enum Piece {
    /// In fixed widths.
    Fast(Cone<Fast>),
    /// In twice the width.
    Middle(Cone<Middle>),
    /// In big integers.
    Big(Cone<Big>),
}

impl Piece {
    /// Pieces that together hold all lines from one gate through another.
    pub(super) fn all_between(from: &Gate, to: &Gate) -> Result<Vec<Self>, Trouble> {
        let mut out = Vec::new();
        for rows in start_rows(from, to) {
            out.extend(Self::of(&rows)?);
        }
        Ok(out)
    }

    /// The piece of some half-spaces; `None` if it has no interior.
    fn of(rows: &[Hyperplane]) -> Result<Option<Self>, Trouble> {
        let narrow: Option<Vec<FastRow>> = rows.iter().map(|r| r.narrow().cloned()).collect();
        if let Some(rows) = narrow {
            match Cone::of(&rows) {
                Err(Trouble::TooWide) => {}
                done => return Ok(done?.map(Self::Fast)),
            }
        }
        let middle: Option<Vec<MiddleRow>> = rows.iter().map(Hyperplane::middle).collect();
        if let Some(rows) = middle {
            match Cone::of(&rows) {
                Err(Trouble::TooWide) => {}
                done => return Ok(done?.map(Self::Middle)),
            }
        }
        let rows: Vec<Wide> = rows.iter().map(Hyperplane::wide).collect();
        Ok(Cone::of(&rows)?.map(Self::Big))
    }

    /// Whether a half-space contains the piece.
    pub(super) fn within(&self, row: &Hyperplane) -> bool {
        match (self, row) {
            (Self::Fast(cone), Hyperplane::Narrow(row)) => cone.within(row),
            (Self::Fast(cone), Hyperplane::Middle(row)) => {
                let mut rays = cone.rays.iter();
                rays.all(|ray| !middle_sign(row, &ray.vertex).is_negative())
            }
            (Self::Fast(cone), row) => row.holds_on(cone),
            (Self::Middle(cone), row) => match row.middle() {
                Some(row) => cone.within(&row),
                None => row.holds_on(cone),
            },
            (Self::Big(cone), row) => cone.within(&row.wide()),
        }
    }

    /// The parts inside and outside a half-space; `None` for a part without interior.
    pub(super) fn cut(self, row: &Hyperplane) -> Result<[Option<Self>; 2], Trouble> {
        match &self {
            Self::Fast(cone) if row.narrow().is_some_and(|r| cone.has_room(r)) => {}
            Self::Middle(cone) if row.middle().is_some_and(|r| cone.has_room(&r)) => {}
            Self::Big(_) => {}
            // Numbers must get wider if the row really cuts.
            _ if self.within(row) => return Ok([Some(self), None]),
            _ if self.within(&row.clone().turned(true)) => return Ok([None, Some(self)]),
            Self::Fast(cone) => return Self::Middle(doubled(cone)).cut(row),
            Self::Middle(cone) => return Self::Big(widened(cone)).cut(row),
        }
        let parts = match self {
            Self::Fast(cone) => match row.narrow() {
                Some(row) => cone.cut(row)?.map(|part| part.map(Self::Fast)),
                None => return Err(Trouble::TooWide),
            },
            Self::Middle(cone) => match row.middle() {
                Some(row) => cone.cut(&row)?.map(|part| part.map(Self::Middle)),
                None => return Err(Trouble::TooWide),
            },
            Self::Big(cone) => cone.cut(&row.wide())?.map(|part| part.map(Self::Big)),
        };
        Ok(parts)
    }

    /// Whether an open set of real lines is in the piece.
    pub(super) fn holds_real_lines(&self) -> bool {
        match self {
            Self::Fast(cone) => holds_real_lines(cone),
            Self::Middle(cone) => holds_real_lines(cone),
            Self::Big(cone) => holds_real_lines(cone),
        }
    }
}

/// The half-spaces that bound the convex hull of all lines between corners of two gates: the
/// smallest convex cone that holds all real lines between them. Slow.
pub(super) fn hull(from: &Gate, to: &Gate) -> Result<Vec<Hyperplane>, Trouble> {
    // Facets are the extreme rays of the dual cone.
    let lines: Vec<Wide> = corner_lines(from, to)
        .into_iter()
        .map(|line| Wide::new(primitive(line)))
        .collect();
    let dual = Cone::<Big>::of(&lines)?.ok_or(Trouble::NotPointed)?;
    Ok(dual
        .rays
        .iter()
        .map(|ray| Hyperplane::of_big(primitive((*ray.vertex.exact).clone())))
        .collect())
}

/// The same cone in twice the width.
pub(super) fn doubled(cone: &Cone<Fast>) -> Cone<Middle> {
    Cone {
        rows: cone.rows.iter().map(MiddleRow::of).collect(),
        rays: cone
            .rays
            .iter()
            .map(|ray| Ray {
                vertex: MiddleVertex::of(&ray.vertex),
                tight: ray.tight,
            })
            .collect(),
    }
}

/// The same cone in big integers.
pub(super) fn widened<N: Numbers>(cone: &Cone<N>) -> Cone<Big> {
    Cone {
        rows: cone
            .rows
            .iter()
            .map(|row| Wide::new(N::wide_row(row)))
            .collect(),
        rays: cone
            .rays
            .iter()
            .map(|ray| Ray {
                vertex: Wide::new(N::wide_vertex(&ray.vertex)),
                tight: ray.tight,
            })
            .collect(),
    }
}
