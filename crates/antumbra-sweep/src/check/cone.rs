//! Convex cones of line space in both descriptions, and how a hyperplane cuts them.
//!
//! The double description method: extreme rays know the bounding hyperplanes they lie on, two
//! rays span an edge if no third one lies on all that they share, and a cut adds one ray for each
//! edge it crosses.

use antumbra_kernel::Sign;

use super::modular::Basis;
use super::numbers::Numbers;

/// Line space has six homogeneous coordinates; a facet has at least five extreme rays.
const FACET_RAYS: u32 = 5;
/// An edge lies on at least four hyperplanes.
const EDGE_ROWS: u32 = 4;
/// Tight rows are bits.
const MOST_ROWS: usize = 128;
/// Bakes stay below 200; this bounds the work that a hostile proof can cause.
const MOST_RAYS: usize = 4096;

/// Why a cone could not be computed with these numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trouble {
    /// The rows are too wide: take big integers.
    TooWide,
    /// More facets than a mask has bits, or far more rays than any bake needs.
    TooComplex,
    /// The rows leave a line free.
    NotPointed,
}

/// An extreme ray.
#[derive(Clone, Debug)]
pub(super) struct Ray<V> {
    pub vertex: V,
    /// Which rows of the cone are zero on it.
    pub tight: u128,
}

/// A pointed cone with interior.
#[derive(Clone, Debug)]
pub(super) struct Cone<N: Numbers> {
    /// Half-spaces; all that bound a facet and perhaps others.
    pub rows: Vec<N::Row>,
    /// All extreme rays.
    pub rays: Vec<Ray<N::Vertex>>,
}

/// How a hyperplane lies to a cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lie {
    Inside,
    Outside,
    Across,
}

impl<N: Numbers> Cone<N> {
    /// The cone of some half-spaces; `None` if it has no interior.
    pub(super) fn of(rows: &[N::Row]) -> Result<Option<Self>, Trouble> {
        let mut basis = Basis::default();
        let (first, others): (Vec<&N::Row>, Vec<&N::Row>) = rows
            .iter()
            .partition(|row| basis.rank() < 6 && basis.insert(N::residues(row)));
        let first: [&N::Row; 6] = first.try_into().map_err(|_| Trouble::NotPointed)?;
        if !fits::<N>(first.iter().copied()) {
            return Err(Trouble::TooWide);
        }
        let rays = (0..6)
            .map(|i| {
                let five = std::array::from_fn(|k| first[k + usize::from(k >= i)]);
                let vertex = N::meet(five);
                let vertex = match N::sign(first[i], &vertex) {
                    Sign::Negative => N::opposite(&vertex),
                    _ => vertex,
                };
                Ray {
                    vertex,
                    tight: 0b11_1111 & !(1 << i),
                }
            })
            .collect();
        let mut cone = Self {
            rows: first.into_iter().cloned().collect(),
            rays,
        };
        for row in others {
            match cone.keep_inside(row)? {
                Some(inside) => cone = inside,
                None => return Ok(None),
            }
        }
        Ok(Some(cone))
    }

    /// Whether a half-space contains the cone.
    pub(super) fn within(&self, row: &N::Row) -> bool {
        self.rows.contains(row)
            || self
                .rays
                .iter()
                .all(|ray| !N::sign(row, &ray.vertex).is_negative())
    }

    /// Whether a row can be added without leaving the range of the numbers.
    pub(super) fn has_room(&self, row: &N::Row) -> bool {
        fits::<N>(self.rows.iter().chain([row]))
    }

    /// The parts inside and outside a half-space; `None` for a part without interior.
    pub(super) fn cut(mut self, row: &N::Row) -> Result<[Option<Self>; 2], Trouble> {
        let signs = self.signs(row);
        match lie(&signs) {
            Lie::Inside => return Ok([Some(self), None]),
            Lie::Outside => return Ok([None, Some(self)]),
            Lie::Across => {}
        }
        let crossings = self.crossings(row, &signs)?;
        let mut outside = Self {
            rows: self.rows.clone(),
            rays: crossings.clone(),
        };
        outside.rows.push(N::complement(row));
        let mut inside = Self {
            rows: self.rows,
            rays: crossings,
        };
        inside.rows.push(row.clone());
        let bit = 1 << (inside.rows.len() - 1);
        for (mut ray, sign) in self.rays.drain(..).zip(signs) {
            match sign {
                Sign::Positive => inside.rays.push(ray),
                Sign::Negative => outside.rays.push(ray),
                Sign::Zero => {
                    ray.tight |= bit;
                    inside.rays.push(ray.clone());
                    outside.rays.push(ray);
                }
            }
        }
        inside.drop_redundant_rows();
        outside.drop_redundant_rows();
        Ok([Some(inside), Some(outside)])
    }

    /// The part inside a half-space only.
    pub(super) fn keep_inside(mut self, row: &N::Row) -> Result<Option<Self>, Trouble> {
        let signs = self.signs(row);
        match lie(&signs) {
            Lie::Inside => return Ok(Some(self)),
            Lie::Outside => return Ok(None),
            Lie::Across => {}
        }
        let crossings = self.crossings(row, &signs)?;
        let bit = 1 << self.rows.len();
        self.rows.push(row.clone());
        for (ray, sign) in self.rays.iter_mut().zip(&signs) {
            if sign.is_zero() {
                ray.tight |= bit;
            }
        }
        let mut signs = signs.into_iter();
        self.rays.retain(|_| signs.next() != Some(Sign::Negative));
        self.rays.extend(crossings);
        self.drop_redundant_rows();
        Ok(Some(self))
    }

    fn signs(&self, row: &N::Row) -> Vec<Sign> {
        let on = |ray: &Ray<N::Vertex>| N::sign(row, &ray.vertex);
        self.rays.iter().map(on).collect()
    }

    /// The new rays: one on each edge that a hyperplane crosses.
    fn crossings(&self, row: &N::Row, signs: &[Sign]) -> Result<Vec<Ray<N::Vertex>>, Trouble> {
        if !self.has_room(row) {
            return Err(Trouble::TooWide);
        }
        if self.rows.len() == MOST_ROWS {
            return Err(Trouble::TooComplex);
        }
        let mut out = Vec::new();
        for (i, p) in self.rays.iter().enumerate() {
            if !signs[i].is_positive() {
                continue;
            }
            for (j, n) in self.rays.iter().enumerate() {
                if signs[j].is_negative() && self.adjacent(i, j) {
                    if self.rays.len() + out.len() == MOST_RAYS {
                        return Err(Trouble::TooComplex);
                    }
                    out.push(self.crossing(p.tight & n.tight, row)?);
                }
            }
        }
        Ok(out)
    }

    /// Whether two rays span an edge.
    pub(super) fn adjacent(&self, i: usize, j: usize) -> bool {
        let (a, b) = (self.rays[i].tight, self.rays[j].tight);
        let common = a & b;
        let count = common.count_ones();
        if count < EDGE_ROWS {
            return false;
        }
        // At a simple vertex any four rows are independent: they bound an edge.
        if a.count_ones() == EDGE_ROWS + 1 || b.count_ones() == EDGE_ROWS + 1 {
            return true;
        }
        self.rays
            .iter()
            .enumerate()
            .all(|(k, ray)| k == i || k == j || ray.tight & common != common)
    }

    /// Where a hyperplane meets the edge on which some rows are tight.
    fn crossing(&self, common: u128, row: &N::Row) -> Result<Ray<N::Vertex>, Trouble> {
        let four = self.independent(common)?;
        let vertex = N::meet([four[0], four[1], four[2], four[3], row]);
        // Every row that is not tight on the edge is positive in its interior.
        let other = (!common).trailing_zeros() as usize;
        let witness = self.rows.get(other).ok_or(Trouble::NotPointed)?;
        let vertex = match N::sign(witness, &vertex) {
            Sign::Positive => vertex,
            Sign::Negative => N::opposite(&vertex),
            Sign::Zero => return Err(Trouble::NotPointed),
        };
        Ok(Ray {
            vertex,
            tight: common | 1 << self.rows.len(),
        })
    }

    /// Four independent rows of a set of rank four.
    fn independent(&self, set: u128) -> Result<[&N::Row; 4], Trouble> {
        let mut found = Vec::with_capacity(4);
        if set.count_ones() == EDGE_ROWS {
            found.extend(bits(set).map(|k| &self.rows[k]));
        } else {
            let mut basis = Basis::default();
            for k in bits(set) {
                if found.len() < 4 && basis.insert(N::residues(&self.rows[k])) {
                    found.push(&self.rows[k]);
                }
            }
        }
        found.try_into().map_err(|_| Trouble::NotPointed)
    }

    /// Drops rows that bound no facet.
    fn drop_redundant_rows(&mut self) {
        let mut counts = [0_u32; MOST_ROWS];
        for ray in &self.rays {
            bits(ray.tight).for_each(|k| counts[k] += 1);
        }
        let rows = self.rows.len();
        if counts[..rows].iter().all(|&n| n >= FACET_RAYS) {
            return;
        }
        let mut place = [MOST_ROWS; MOST_ROWS];
        let facets = (0..rows).filter(|&k| counts[k] >= FACET_RAYS);
        for (kept, k) in facets.enumerate() {
            place[k] = kept;
        }
        for ray in &mut self.rays {
            ray.tight = bits(ray.tight)
                .filter(|&k| place[k] < MOST_ROWS)
                .fold(0, |mask, k| mask | 1 << place[k]);
        }
        let mut number = 0..;
        self.rows.retain(|_| {
            number
                .next()
                .is_some_and(|k: usize| counts[k] >= FACET_RAYS)
        });
    }
}

/// Whether any five of some rows stay within the range of the numbers.
fn fits<'a, N: Numbers>(rows: impl Iterator<Item = &'a N::Row>) -> bool
where
    N::Row: 'a,
{
    let mut largest = [0; 5];
    for row in rows {
        let mut excess = N::excess(row);
        for place in &mut largest {
            if excess > *place {
                std::mem::swap(place, &mut excess);
            }
        }
    }
    largest.iter().sum::<u32>() <= N::ROOM
}

fn lie(signs: &[Sign]) -> Lie {
    if !signs.contains(&Sign::Negative) {
        Lie::Inside
    } else if !signs.contains(&Sign::Positive) {
        Lie::Outside
    } else {
        Lie::Across
    }
}

/// The numbers of the bits that are set.
pub(super) fn bits(mut set: u128) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let k = set.trailing_zeros() as usize;
        (set != 0).then(|| {
            set &= set - 1;
            k
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::big::{Big, Wide};
    use super::super::fast::{Fast, FastRow};
    use super::{Cone, Numbers, Trouble, bits};
    use antumbra_kernel::Sign;

    struct Random(u64);

    impl Random {
        fn row(&mut self, range: i64) -> [i64; 6] {
            std::array::from_fn(|_| {
                self.0 ^= self.0 << 13;
                self.0 ^= self.0 >> 7;
                self.0 ^= self.0 << 17;
                (self.0 >> 20) as i64 % (2 * range + 1) - range
            })
        }
    }

    /// Every ray is non-negative on all rows, zero exactly on its tight ones, and those have rank
    /// five; no ray occurs twice.
    fn sanity<N: Numbers>(cone: &Cone<N>) {
        for ray in &cone.rays {
            let mut basis = super::Basis::default();
            for (k, row) in cone.rows.iter().enumerate() {
                let sign = N::sign(row, &ray.vertex);
                assert!(!sign.is_negative());
                assert_eq!(sign.is_zero(), ray.tight >> k & 1 == 1);
            }
            for k in bits(ray.tight) {
                basis.insert(N::residues(&cone.rows[k]));
            }
            assert_eq!(basis.rank(), 5);
        }
        for (i, ray) in cone.rays.iter().enumerate() {
            assert!(cone.rays[..i].iter().all(|other| other.tight != ray.tight));
        }
    }

    #[test]
    fn cuts_keep_both_descriptions_in_step() {
        let mut random = Random(77);
        let mut both = 0;
        for round in 0..60 {
            // Few values make degenerate cones.
            let range = [1, 2, 1 << 20][round % 3];
            let rows: Vec<FastRow> = (0..9)
                .map(|_| {
                    let mut row = random.row(range);
                    // All hold strictly at one point.
                    row[0] = 1 + row[1..].iter().map(|c| c.abs()).sum::<i64>() / 2;
                    FastRow::new(row)
                })
                .collect();
            let Ok(Some(mut cone)) = Cone::<Fast>::of(&rows) else {
                continue;
            };
            sanity(&cone);
            let wide: Vec<Wide> = rows.iter().map(|r| Wide::new(Fast::wide_row(r))).collect();
            let big = Cone::<Big>::of(&wide).expect("pointed").expect("interior");
            assert_eq!(
                (big.rays.len(), big.rows.len()),
                (cone.rays.len(), cone.rows.len())
            );
            sanity(&big);
            for _ in 0..6 {
                let row = FastRow::new(random.row(range));
                let kept = cone.clone().keep_inside(&row).expect("room");
                match cone.clone().cut(&row).expect("room") {
                    [Some(inside), Some(outside)] => {
                        sanity(&inside);
                        sanity(&outside);
                        assert!(inside.within(&row) && !outside.within(&row));
                        let on = |c: &Cone<Fast>| {
                            let zero = |v| Fast::sign(&row, v) == Sign::Zero;
                            c.rays.iter().filter(|r| zero(&r.vertex)).count()
                        };
                        assert_eq!(on(&inside), on(&outside));
                        let kept = kept.expect("an inside");
                        sanity(&kept);
                        assert_eq!(kept.rays.len(), inside.rays.len());
                        both += 1;
                        cone = if both % 2 == 0 { inside } else { outside };
                    }
                    [Some(inside), None] => assert!(inside.within(&row) && kept.is_some()),
                    [None, _] => {
                        assert!(cone.within(&Fast::complement(&row)) && kept.is_none());
                    }
                }
            }
        }
        assert!(both > 100, "{both}");
    }

    #[test]
    fn rows_of_lower_rank_and_wide_rows_are_refused() {
        let mut random = Random(5);
        let rows: Vec<FastRow> = (0..5).map(|_| FastRow::new(random.row(9))).collect();
        assert_eq!(Cone::<Fast>::of(&rows).err(), Some(Trouble::NotPointed));
        let unit = |k| {
            let mut row = [0; 6];
            row[k] = 1;
            FastRow::new(row)
        };
        let rows: Vec<FastRow> = (0..6).map(unit).collect();
        let cone = Cone::<Fast>::of(&rows).expect("pointed").expect("interior");
        let row = FastRow::new([1, -1, 0, 0, 0, 1 << 40]);
        assert_eq!(cone.cut(&row).err(), Some(Trouble::TooWide));
        let never: Vec<FastRow> = (0..6).map(unit).chain([FastRow::new([-1; 6])]).collect();
        assert!(Cone::<Fast>::of(&never).expect("pointed").is_none());
    }
}
