//! The store of one query: hyperplane rows and vertices of line space, with exact signs.
//!
//! A vertex is kept as the exact cofactors of its five rows and, beside them, as the same vector
//! rounded to doubles. A sign is decided by the doubles where their error bound allows it and by
//! the integers otherwise.

mod sign;
mod vertex;

use std::cell::OnceCell;
use std::collections::HashMap;

use antumbra_kernel::plucker::Row;
use antumbra_kernel::{I256, Sign};
use dashu_int::IBig;

use crate::cone::{Halfspace, RaySigns};

/// A hyperplane of a [`PluckerSpace`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RowId(pub(crate) u32);

/// A vertex of a [`PluckerSpace`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VertexId(pub(crate) u32);

#[derive(Clone, Debug)]
pub(crate) enum ExactRow {
    /// Edge rows of 49 + 25 bits, and caps that exceed them by 7 bits at most.
    Narrow(Row),
    /// Rows of common lines and caps: any width.
    Wide(Box<[IBig; 6]>),
}

#[derive(Clone, Debug)]
pub(crate) enum ExactVertex {
    /// On five narrow rows, at most two of them large: 195 + 14 bits, and 242 for a dot product
    /// with a row.
    Narrow([I256; 6]),
    /// Anything else.
    Wide(Box<[IBig; 6]>),
}

#[derive(Clone, Debug)]
struct RowData {
    rounded: [f64; 6],
    exact: ExactRow,
    /// Larger than an edge row, as caps are: at most two of these define a narrow vertex.
    large: bool,
    /// Sums of the magnitudes of the coefficients that meet directions and moments.
    size: [f64; 2],
}

fn size(rounded: &[f64; 6]) -> [f64; 2] {
    let sum = |k: usize| rounded[k].abs() + rounded[k + 1].abs() + rounded[k + 2].abs();
    [sum(0), sum(3)]
}

/// How a vertex came to be, so that its exact coordinates can wait until a sign needs them.
#[derive(Clone, Copy, Debug)]
struct Origin {
    /// Five independent rows that it lies on.
    rows: [RowId; 5],
    /// The ends of the edge that the last row cuts; the vertex is a positive combination of them.
    ends: [VertexId; 2],
}

#[derive(Clone, Debug)]
struct VertexData {
    rounded: [f64; 6],
    /// Bounds of the absolute errors of `rounded`, direction and moment apart; zero where it was
    /// rounded from the exact coordinates (then each is within a relative 2^-52).
    error: [f64; 2],
    /// The largest magnitudes of direction and moment in `rounded`.
    size: [f64; 2],
    exact: OnceCell<ExactVertex>,
    origin: Option<Origin>,
}

/// The largest magnitudes of direction and moment.
fn largest(v: &[f64; 6]) -> [f64; 2] {
    [0, 3].map(|k| v[k].abs().max(v[k + 1].abs()).max(v[k + 2].abs()))
}

/// Rows and vertices of one query. Rows that describe the same hyperplane are stored once.
#[derive(Clone, Debug, Default)]
pub struct PluckerSpace {
    rows: Vec<RowData>,
    by_row: HashMap<Row, u32, std::hash::BuildHasherDefault<RowHasher>>,
    vertices: Vec<VertexData>,
    exact_signs: u64,
    /// Memory of signs that are no longer needed.
    spare: Vec<Vec<Sign>>,
}

/// A multiplicative hash: rows are already well spread, and the order of a map is never used.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RowHasher(u64);

impl std::hash::Hasher for RowHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.write_u64(u64::from(b));
        }
    }
    fn write_u64(&mut self, v: u64) {
        self.0 = (self.0.rotate_left(5) ^ v).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 29;
    }
    fn write_i64(&mut self, v: i64) {
        self.write_u64(v as u64);
    }
    fn write_usize(&mut self, v: usize) {
        self.write_u64(v as u64);
    }
}

/// Edge rows stay below these magnitudes (moment, direction).
const EDGE: (i64, i64) = (1 << 48, 1 << 24);
/// Larger narrow rows stay below these.
const LARGE: (i64, i64) = (1 << 55, 1 << 31);

fn below(row: &Row, (moment, direction): (i64, i64)) -> bool {
    row[..3].iter().all(|c| c.abs() < moment) && row[3..].iter().all(|c| c.abs() < direction)
}

impl RowData {
    fn new(row: Row) -> Self {
        let exact = if below(&row, LARGE) {
            ExactRow::Narrow(row)
        } else {
            ExactRow::Wide(Box::new(row.map(IBig::from)))
        };
        Self {
            rounded: row.map(|c| c as f64),
            exact,
            large: !below(&row, EDGE),
            size: size(&row.map(|c| c as f64)),
        }
    }
}

impl PluckerSpace {
    /// An empty space.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets all rows and vertices, keeping the memory.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.by_row.clear();
        self.vertices.clear();
    }

    pub(crate) fn ray_signs(&mut self, count: usize) -> RaySigns {
        RaySigns::within(self.spare.pop().unwrap_or_default(), count)
    }

    /// Keeps the memory of signs for others.
    pub fn discard(&mut self, signs: RaySigns) {
        self.spare.push(signs.into_memory());
    }

    /// How many signs the doubles could not decide so far.
    #[must_use]
    pub fn exact_signs(&self) -> u64 {
        self.exact_signs
    }

    /// The side of a hyperplane where `sign * row` is positive; `negative` asks for the other side.
    pub fn halfspace(&mut self, row: &Row, negative: bool) -> Halfspace {
        let (id, flipped) = self.intern(row);
        Halfspace {
            row: id,
            negative: negative != flipped,
        }
    }

    /// The hyperplane with an integer row, and whether it is stored with the opposite sign.
    ///
    /// The row is made primitive first, so that edges on a common line share a hyperplane.
    ///
    /// # Panics
    /// In debug builds, if the row is zero.
    pub fn intern(&mut self, row: &Row) -> (RowId, bool) {
        debug_assert!(row.iter().any(|&c| c != 0), "a zero row is no hyperplane");
        let g = row.iter().fold(0_u64, |g, &c| gcd(g, c.unsigned_abs()));
        let lead_negative = row.iter().find(|&&c| c != 0).is_some_and(|&c| c < 0);
        let divisor = if lead_negative { -(g as i64) } else { g as i64 };
        let key: Row = if divisor == 1 {
            *row
        } else {
            row.map(|c| c / divisor)
        };
        if let Some(&id) = self.by_row.get(&key) {
            return (RowId(id), lead_negative);
        }
        let id = self.rows.len() as u32;
        self.rows.push(RowData::new(key));
        self.by_row.insert(key, id);
        (RowId(id), lead_negative)
    }

    /// The positive side of a hyperplane with a row of any width.
    pub fn intern_wide(&mut self, row: [IBig; 6]) -> Halfspace {
        let small: Option<Vec<i64>> = row.iter().map(|c| i64::try_from(c).ok()).collect();
        if let Some(small) = small {
            let row: Row = std::array::from_fn(|k| small[k]);
            let (id, negative) = self.intern(&row);
            return Halfspace { row: id, negative };
        }
        let id = RowId(self.rows.len() as u32);
        let rounded: [f64; 6] = std::array::from_fn(|k| row[k].to_f64().value());
        self.rows.push(RowData {
            rounded,
            exact: ExactRow::Wide(Box::new(row)),
            large: true,
            size: size(&rounded),
        });
        Halfspace {
            row: id,
            negative: false,
        }
    }

    /// The row as doubles; each coefficient within a relative 2^-53.
    #[inline]
    #[must_use]
    pub fn rounded_row(&self, row: RowId) -> &[f64; 6] {
        &self.rows[row.0 as usize].rounded
    }

    /// The vertex as doubles, scaled so that its largest coordinate is about 1; each coordinate
    /// within a relative 2^-52.
    #[inline]
    #[must_use]
    pub fn rounded_vertex(&self, vertex: VertexId) -> &[f64; 6] {
        &self.vertices[vertex.0 as usize].rounded
    }

    pub(crate) fn exact_row(&self, row: RowId) -> &ExactRow {
        &self.rows[row.0 as usize].exact
    }

    /// The exact coordinates, computed now if no sign has needed them yet.
    pub(crate) fn exact_vertex(&self, vertex: VertexId) -> &ExactVertex {
        let data = &self.vertices[vertex.0 as usize];
        data.exact.get_or_init(|| match data.origin {
            Some(origin) => self.compute(data, origin),
            None => unreachable!("a vertex without an origin is pushed with its coordinates"),
        })
    }

    /// The coordinates of a vertex as big integers.
    #[must_use]
    pub fn big_vertex(&self, vertex: VertexId) -> [IBig; 6] {
        match self.exact_vertex(vertex) {
            ExactVertex::Narrow(v) => v.map(|c| big(&c)),
            ExactVertex::Wide(v) => (**v).clone(),
        }
    }

    /// The coefficients of a row as big integers.
    #[must_use]
    pub fn big_row(&self, row: RowId) -> [IBig; 6] {
        match self.exact_row(row) {
            ExactRow::Narrow(v) => v.map(IBig::from),
            ExactRow::Wide(v) => (**v).clone(),
        }
    }
}

fn gcd(mut a: u64, mut b: u64) -> u64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

pub(crate) fn sign_of(v: &IBig) -> Sign {
    Sign::of_ordering(v.cmp(&IBig::ZERO))
}

pub(crate) fn big(v: &I256) -> IBig {
    let negative = v.is_negative();
    let m = if negative { -*v } else { *v };
    let out = m
        .limbs()
        .iter()
        .rev()
        .fold(IBig::ZERO, |out, &l| (out << 64) + IBig::from(l));
    if negative { -out } else { out }
}
