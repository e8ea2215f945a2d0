//! Pieces of line space between two gates, with fixed-width or with big numbers.

use std::rc::Rc;

use antumbra_kernel::Sign;

use super::big::{Big, Wide};
use super::cone::{Cone, Cut, Ray, Trouble};
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
    Fast(Rc<Cone<Fast>>),
    /// In big integers.
    Big(Rc<Cone<Big>>),
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
                done => return Ok(done?.map(|cone| Self::Fast(Rc::new(cone)))),
            }
        }
        let rows: Vec<Wide> = rows.iter().map(Hyperplane::wide).collect();
        Ok(Cone::of(&rows)?.map(|cone| Self::Big(Rc::new(cone))))
    }

    /// The tightest piece: the convex hull of all lines between corners of the gates, cut by some
    /// rows. Slow; `Ok(None)` if it has no interior.
    pub(super) fn tightest(
        from: &Gate,
        to: &Gate,
        path: &[Hyperplane],
    ) -> Result<Option<Self>, Trouble> {
        // The facets of the hull are the extreme rays of the dual cone.
        let lines: Vec<Wide> = corner_lines(from, to)
            .into_iter()
            .map(|line| Wide::new(super::big::primitive(line)))
            .collect();
        let Some(dual) = Cone::<Big>::of(&lines)? else {
            return Err(Trouble::NotPointed);
        };
        let mut rows: Vec<Wide> = dual
            .rays
            .iter()
            .map(|ray| Wide::new(super::big::primitive((*ray.vertex.exact).clone())))
            .collect();
        if from.straddles(&to.plane) && to.straddles(&from.plane) {
            rows.push(Hyperplane::common_line(&from.plane, &to.plane).wide());
        }
        rows.extend(path.iter().map(Hyperplane::wide));
        Ok(Cone::of(&rows)?.map(|cone| Self::Big(Rc::new(cone))))
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
    pub(super) fn cut(&self, row: &Hyperplane) -> Result<[Option<Self>; 2], Trouble> {
        match (self, row) {
            (Self::Fast(cone), Hyperplane::Narrow(row)) => match cone.cut(row) {
                Err(Trouble::TooWide) => self.cut_wide(&Wide::new(Fast::wide(row))),
                done => Ok(self.parts(done?, Self::Fast)),
            },
            (Self::Fast(cone), Hyperplane::Wide(row)) => {
                let on = |side: Sign| {
                    let mut rays = cone.rays.iter();
                    rays.any(|ray| sign_at(row, &ray.vertex) == side)
                };
                match (on(Sign::Positive), on(Sign::Negative)) {
                    (_, false) => Ok([Some(self.clone()), None]),
                    (false, true) => Ok([None, Some(self.clone())]),
                    (true, true) => self.cut_wide(row),
                }
            }
            (Self::Big(_), row) => self.cut_wide(&row.wide()),
        }
    }

    fn cut_wide(&self, row: &Wide) -> Result<[Option<Self>; 2], Trouble> {
        let wide;
        let cone = match self {
            Self::Big(cone) => cone,
            Self::Fast(cone) => {
                wide = widened(cone);
                &wide
            }
        };
        Ok(self.parts(cone.cut(row)?, Self::Big))
    }

    fn parts<N: Numbers>(
        &self,
        cut: Cut<N>,
        piece: impl Fn(Rc<Cone<N>>) -> Self,
    ) -> [Option<Self>; 2] {
        match cut {
            Cut::Inside => [Some(self.clone()), None],
            Cut::Outside => [None, Some(self.clone())],
            Cut::Both(inside, outside) => [inside, outside].map(|cone| Some(piece(Rc::new(cone)))),
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
