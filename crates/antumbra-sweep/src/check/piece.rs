//! Pieces of line space between two gates, with fixed-width or with big numbers.

use antumbra_kernel::Sign;

use super::big::{Big, Wide, primitive};
use super::cone::{Cone, Ray, Trouble};
use super::ends::Gate;
use super::fast::{Fast, FastRow};
use super::numbers::Numbers;
use super::real::holds_real_lines;
use super::rows::{Hyperplane, sign_at};
use super::start::{corner_lines, start_rows};

/// A cone with interior.
#[derive(Clone, Debug)]
pub(super) enum Piece {
    /// In fixed widths.
    Fast(Cone<Fast>),
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
        let narrow: Option<Vec<FastRow>> = rows
            .iter()
            .map(|row| match row {
                Hyperplane::Narrow(row) => Some(row.clone()),
                Hyperplane::Wide(_) => None,
            })
            .collect();
        if let Some(rows) = narrow {
            match Cone::of(&rows) {
                Err(Trouble::TooWide) => {}
                done => return Ok(done?.map(Self::Fast)),
            }
        }
        let rows: Vec<Wide> = rows.iter().map(Hyperplane::wide).collect();
        Ok(Cone::of(&rows)?.map(Self::Big))
    }

    /// Whether a half-space contains the piece.
    pub(super) fn within(&self, row: &Hyperplane) -> bool {
        match (self, row) {
            (Self::Fast(cone), Hyperplane::Narrow(row)) => cone.within(row),
            (Self::Fast(cone), Hyperplane::Wide(row)) => cone
                .rays
                .iter()
                .all(|ray| !sign_at(row, &ray.vertex).is_negative()),
            (Self::Big(cone), row) => cone.within(&row.wide()),
        }
    }

    /// The parts inside and outside a half-space; `None` for a part without interior.
    pub(super) fn cut(self, row: &Hyperplane) -> Result<[Option<Self>; 2], Trouble> {
        match (self, row) {
            (Self::Fast(cone), Hyperplane::Narrow(row)) if cone.has_room(row) => {
                Ok(cone.cut(row)?.map(|part| part.map(Self::Fast)))
            }
            (Self::Fast(cone), row) => {
                let wide = row.wide();
                let on = |side: Sign| {
                    let mut rays = cone.rays.iter();
                    rays.any(|ray| sign_at(&wide, &ray.vertex) == side)
                };
                match (on(Sign::Positive), on(Sign::Negative)) {
                    (_, false) => Ok([Some(Self::Fast(cone)), None]),
                    (false, true) => Ok([None, Some(Self::Fast(cone))]),
                    (true, true) => Self::Big(widened(&cone)).cut(row),
                }
            }
            (Self::Big(cone), row) => Ok(cone.cut(&row.wide())?.map(|part| part.map(Self::Big))),
        }
    }

    /// Whether an open set of real lines is in the piece.
    pub(super) fn holds_real_lines(&self) -> bool {
        match self {
            Self::Fast(cone) => holds_real_lines(cone),
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

/// The same cone in big integers.
pub(super) fn widened(cone: &Cone<Fast>) -> Cone<Big> {
    Cone {
        rows: cone.rows.iter().map(|r| Wide::new(Fast::wide(r))).collect(),
        rays: cone
            .rays
            .iter()
            .map(|ray| Ray {
                vertex: Wide::new(ray.vertex.wide()),
                tight: ray.tight,
            })
            .collect(),
    }
}
