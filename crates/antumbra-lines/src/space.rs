//! The store of one query: hyperplane rows and vertices of line space, with exact signs.
//!
//! A vertex is kept as the exact cofactors of its five rows and, beside them, as the same vector
//! rounded to doubles. A sign is decided by the doubles where their error bound allows it and by
//! the integers otherwise.

use std::cell::OnceCell;
use std::collections::HashMap;

use antumbra_kernel::plucker::{self, Row};
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

    fn compute(&self, data: &VertexData, origin: Origin) -> ExactVertex {
        let Some(exact) = self.meet(origin.rows) else {
            return self.combination(origin.rows[4], origin.ends);
        };
        // The cofactors are known up to their sign; the rounded vertex has a coordinate that is
        // certain, since its error was bounded when it was accepted.
        let surest = (0..6)
            .max_by(|&i, &j| {
                let trust =
                    |k: usize| data.rounded[k].abs() / data.error[k / 3].max(f64::MIN_POSITIVE);
                trust(i).total_cmp(&trust(j))
            })
            .unwrap_or(0);
        self.oriented(exact, origin, Some((surest, data.rounded[surest] < 0.0)))
    }

    /// The positive combination of two vertices on both sides of a row that lies on the row.
    pub(crate) fn combination(&self, row: RowId, [p, n]: [VertexId; 2]) -> ExactVertex {
        let abs = |v: IBig| if sign_of(&v).is_negative() { -v } else { v };
        let (wp, wn) = (abs(self.exact_dot(row, n)), abs(self.exact_dot(row, p)));
        let (vp, vn) = (self.big_vertex(p), self.big_vertex(n));
        ExactVertex::Wide(Box::new(std::array::from_fn(|k| {
            &vp[k] * &wp + &vn[k] * &wn
        })))
    }

    /// Replaces a vertex's doubles by the exact coordinates, rounded. False if they were already.
    pub(crate) fn sharpen(&mut self, vertex: VertexId) -> bool {
        if self.vertices[vertex.0 as usize].error == [0.0; 2] {
            return false;
        }
        let rounded = round_vertex(self.exact_vertex(vertex));
        let data = &mut self.vertices[vertex.0 as usize];
        data.rounded = rounded;
        data.size = largest(&rounded);
        data.error = [0.0; 2];
        true
    }

    /// The rounded dot product of a row and a vertex, and a bound of its error.
    ///
    /// Six terms, each factor within 2^-52 of the truth, err by less than 2^-48 of the sum of their
    /// magnitudes (2 * 2^-52 for the factors, 2^-53 for each product, 5 * 2^-53 for the additions:
    /// below 2^-49; the sum of magnitudes is itself rounded). What the vertex errs beyond that is
    /// multiplied by the row's coefficients; the factor 1.01 covers the rounding of the bound.
    #[inline]
    fn dot(&self, row: RowId, vertex: VertexId) -> (f64, f64) {
        let row = &self.rows[row.0 as usize];
        let data = &self.vertices[vertex.0 as usize];
        let mut sum = 0.0;
        let mut magnitude = 0.0;
        for k in 0..6 {
            let t = row.rounded[k] * data.rounded[k];
            sum += t;
            magnitude += t.abs();
        }
        let beyond = row.size[0] * data.error[0] + row.size[1] * data.error[1];
        (sum, magnitude * FILTER + beyond * 1.01)
    }

    /// The rounded dot product and a bound of its error that is quick to find: in the bound of
    /// [`PluckerSpace::dot`] the coordinates of the vertex are replaced by the largest ones.
    #[inline]
    fn dot_coarse(&self, row: RowId, vertex: VertexId) -> (f64, f64) {
        let row = &self.rows[row.0 as usize];
        let data = &self.vertices[vertex.0 as usize];
        let (r, v) = (&row.rounded, &data.rounded);
        let sum = r[0] * v[0] + r[1] * v[1] + r[2] * v[2] + r[3] * v[3] + r[4] * v[4] + r[5] * v[5];
        let part = |k: usize| row.size[k] * (data.size[k] * FILTER + data.error[k]);
        (sum, (part(0) + part(1)) * 1.01)
    }

    /// Adds the vertex in which a row cuts the edge between two vertices, p where the row is
    /// positive up to `sign`, n where it is negative; `rows` are five independent rows it lies on.
    ///
    /// In doubles first: w = l p + (1 - l) n with l = s_n / (s_p + s_n) from the rounded products
    /// s. If both are four times their error bounds e, l errs by less than
    /// 2 l (1 - l) (e_p / s_p + e_n / s_n) + 2^-50; that times the distance of p and n, the ends'
    /// own errors, and 2^-50 of the size for the rounding bound the error of w. Where the bound is
    /// not far below the size, the exact coordinates are computed at once.
    pub(crate) fn cut_edge(&mut self, rows: [RowId; 5], p: VertexId, n: VertexId) -> VertexId {
        const TINY: f64 = 1.0 / (1_u64 << 50) as f64;
        const TRUSTED: f64 = 1.0 / (1_u64 << 20) as f64;
        let origin = Origin { rows, ends: [p, n] };
        let ((sp, ep), (sn, en)) = (self.dot(rows[4], p), self.dot(rows[4], n));
        let (sp, sn) = (sp.abs(), sn.abs());
        let (a, b) = (&self.vertices[p.0 as usize], &self.vertices[n.0 as usize]);
        let l = sn / (sp + sn);
        let off = 2.0 * l * (1.0 - l) * (ep / sp + en / sn) + TINY;
        let rounded: [f64; 6] =
            std::array::from_fn(|k| l * a.rounded[k] + (1.0 - l) * b.rounded[k]);
        let mut error = [0.0; 2];
        let mut trusted = sp > 4.0 * ep && sn > 4.0 * en;
        let sizes = largest(&rounded);
        for part in 0..2 {
            let (la, lb, lw) = (a.size[part], b.size[part], sizes[part]);
            let own = |e: f64, size: f64| e + size * TINY;
            error[part] = (l * own(a.error[part], la)
                + (1.0 - l) * own(b.error[part], lb)
                + off * (la + lb)
                + la.max(lb) * TINY)
                * 1.01;
            trusted &= error[part] < TRUSTED * lw;
        }
        if trusted {
            return self.push_rounded(rounded, error, origin);
        }
        let certain = (0..6).find(|&k| rounded[k].abs() > 2.0 * error[k / 3]);
        let certain = certain
            .filter(|_| sp > 4.0 * ep && sn > 4.0 * en)
            .map(|k| (k, rounded[k] < 0.0));
        if let Some((rounded, error)) = certain.and_then(|known| self.meet_rounded(rows, known))
            && (0..2).all(|part| error[part] < TRUSTED * largest(&rounded)[part])
        {
            return self.push_rounded(rounded, error, origin);
        }
        let exact = match self.meet(rows) {
            Some(exact) => self.oriented(exact, origin, certain),
            None => self.combination(rows[4], origin.ends),
        };
        self.push_vertex(exact)
    }

    fn push_rounded(&mut self, rounded: [f64; 6], error: [f64; 2], origin: Origin) -> VertexId {
        self.vertices.push(VertexData {
            rounded,
            error,
            size: largest(&rounded),
            exact: OnceCell::new(),
            origin: Some(origin),
        });
        VertexId((self.vertices.len() - 1) as u32)
    }

    /// The vertex on five rows in doubles, scaled, with bounds of the errors of direction and
    /// moment; one coordinate's sign is known. `None` where doubles do not tell that sign.
    fn meet_rounded(
        &self,
        rows: [RowId; 5],
        (k, negative): (usize, bool),
    ) -> Option<([f64; 6], [f64; 2])> {
        let data = rows.map(|r| &self.rows[r.0 as usize]);
        if data.iter().any(|r| r.large) {
            return None;
        }
        let (v, error) = plucker::cofactors_rounded(data.map(|r| &r.rounded));
        if v[k].abs() <= error[k] {
            return None;
        }
        let [directions, moments] = largest(&v);
        // A power of two, so that nothing is rounded.
        let exponent = (directions.max(moments).to_bits() >> 52) as i64 - 1023;
        let scale = f64::from_bits(((1023 - exponent) as u64) << 52);
        let factor = if (v[k] < 0.0) == negative {
            scale
        } else {
            -scale
        };
        let [e, f] = largest(&error);
        Some((v.map(|c| c * factor), [e * scale, f * scale]))
    }

    /// Gives cofactors the sign of the positive combination that they are: by a coordinate whose
    /// sign is known, else by the combination itself.
    fn oriented(
        &self,
        exact: ExactVertex,
        origin: Origin,
        known: Option<(usize, bool)>,
    ) -> ExactVertex {
        let sign = |v: &ExactVertex, k: usize| match v {
            ExactVertex::Narrow(v) => v[k].sign(),
            ExactVertex::Wide(v) => sign_of(&v[k]),
        };
        let (k, negative) = known.unwrap_or_else(|| {
            let reference = self.combination(origin.rows[4], origin.ends);
            let k = (0..6)
                .find(|&k| !sign(&reference, k).is_zero())
                .unwrap_or(0);
            (k, sign(&reference, k).is_negative())
        });
        if sign(&exact, k).is_negative() == negative {
            exact
        } else {
            negated(exact)
        }
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

    /// The sign of `row . vertex`: by doubles where their error bound allows it, else exact.
    #[inline]
    #[must_use]
    pub fn sign(&mut self, row: RowId, vertex: VertexId) -> Sign {
        let (sum, bound) = self.dot_coarse(row, vertex);
        if sum.abs() > bound {
            return Sign::of(sum);
        }
        self.careful_sign(row, vertex)
    }

    fn careful_sign(&mut self, row: RowId, vertex: VertexId) -> Sign {
        loop {
            let (sum, bound) = self.dot(row, vertex);
            if sum > bound {
                return Sign::Positive;
            }
            if sum < -bound {
                return Sign::Negative;
            }
            if !self.sharpen(vertex) {
                break;
            }
        }
        self.exact_signs += 1;
        self.exact_sign(row, vertex)
    }

    #[cold]
    fn exact_sign(&self, row: RowId, vertex: VertexId) -> Sign {
        if let (ExactRow::Narrow(h), ExactVertex::Narrow(v)) =
            (self.exact_row(row), self.exact_vertex(vertex))
        {
            return plucker::dot(h, v).sign();
        }
        sign_of(&self.exact_dot(row, vertex))
    }

    /// `row . vertex` as a big integer.
    #[must_use]
    pub fn exact_dot(&self, row: RowId, vertex: VertexId) -> IBig {
        let h = self.big_row(row);
        let v = self.big_vertex(vertex);
        h.iter().zip(&v).map(|(a, b)| a * b).sum()
    }

    /// The sign of the bilinear form of two vertices; of twice the quadric if they are the same.
    ///
    /// Filter as in [`PluckerSpace::sign`].
    #[must_use]
    pub fn bilinear_sign(&mut self, v: VertexId, w: VertexId) -> Sign {
        let (sum, bound) = self.bilinear_coarse(v, w);
        if sum.abs() > bound {
            return Sign::of(sum);
        }
        loop {
            let (sum, bound) = self.bilinear(v, w);
            if sum > bound {
                return Sign::Positive;
            }
            if sum < -bound {
                return Sign::Negative;
            }
            let (first, second) = (self.sharpen(v), self.sharpen(w));
            if !(first || second) {
                break;
            }
        }
        self.exact_signs += 1;
        if let (ExactVertex::Narrow(a), ExactVertex::Narrow(b)) =
            (self.exact_vertex(v), self.exact_vertex(w))
        {
            return plucker::bilinear(a, b).sign();
        }
        sign_of(&self.big_bilinear(v, w))
    }

    /// The rounded bilinear form of two vertices and a bound of its error that is quick to find:
    /// every magnitude in the bound of [`PluckerSpace::bilinear`] is replaced by the largest of its
    /// kind, and there are three of each.
    fn bilinear_coarse(&self, v: VertexId, w: VertexId) -> (f64, f64) {
        let (a, b) = (&self.vertices[v.0 as usize], &self.vertices[w.0 as usize]);
        let (x, y) = (&a.rounded, &b.rounded);
        let sum = x[0] * y[3] + x[1] * y[4] + x[2] * y[5] + x[3] * y[0] + x[4] * y[1] + x[5] * y[2];
        let part = |k: usize| {
            let (s, t) = (a.size[k], b.size[1 - k]);
            let (e, f) = (a.error[k], b.error[1 - k]);
            s * t * FILTER + s * f + (t + f) * e
        };
        (sum, (part(0) + part(1)) * 3.03)
    }

    /// The rounded bilinear form of two vertices and a bound of its error (see [`PluckerSpace::dot`]).
    pub(crate) fn bilinear(&self, v: VertexId, w: VertexId) -> (f64, f64) {
        let (a, b) = (&self.vertices[v.0 as usize], &self.vertices[w.0 as usize]);
        let mut sum = 0.0;
        let mut magnitude = 0.0;
        let mut beyond = 0.0;
        for k in 0..6 {
            let j = (k + 3) % 6;
            let t = a.rounded[k] * b.rounded[j];
            let (ea, eb) = (a.error[k / 3], b.error[j / 3]);
            sum += t;
            magnitude += t.abs();
            beyond += a.rounded[k].abs() * eb + b.rounded[j].abs() * ea + ea * eb;
        }
        (sum, magnitude * FILTER + beyond * 1.01)
    }

    /// The bilinear form of two vertices as a big integer.
    #[must_use]
    pub fn big_bilinear(&self, v: VertexId, w: VertexId) -> IBig {
        let (a, b) = (self.big_vertex(v), self.big_vertex(w));
        (0..6).map(|k| &a[k] * &b[(k + 3) % 6]).sum()
    }

    /// The vertex on five independent rows, its sign still open; `None` if they are dependent.
    pub(crate) fn meet(&self, rows: [RowId; 5]) -> Option<ExactVertex> {
        let narrow = rows.map(|r| match self.exact_row(r) {
            ExactRow::Narrow(n) => Some(n),
            ExactRow::Wide(_) => None,
        });
        let large = rows
            .iter()
            .filter(|r| self.rows[r.0 as usize].large)
            .count();
        if let [Some(a), Some(b), Some(c), Some(d), Some(e)] = narrow
            && large <= 2
        {
            let v = plucker::cofactors([a, b, c, d, e]);
            return v
                .iter()
                .any(|c| !c.sign().is_zero())
                .then_some(ExactVertex::Narrow(v));
        }
        let big: Vec<[IBig; 6]> = rows.iter().map(|&r| self.big_row(r)).collect();
        let v: [IBig; 6] = std::array::from_fn(|j| {
            let minor: Vec<Vec<IBig>> = big
                .iter()
                .map(|r| (0..6).filter(|&k| k != j).map(|k| r[k].clone()).collect())
                .collect();
            let d = determinant(minor);
            if j % 2 == 0 { d } else { -d }
        });
        v.iter()
            .any(|c| *c != IBig::ZERO)
            .then(|| ExactVertex::Wide(Box::new(v)))
    }

    pub(crate) fn push_vertex(&mut self, exact: ExactVertex) -> VertexId {
        let rounded = round_vertex(&exact);
        let exact = OnceCell::from(exact);
        self.vertices.push(VertexData {
            rounded,
            error: [0.0; 2],
            size: largest(&rounded),
            exact,
            origin: None,
        });
        VertexId((self.vertices.len() - 1) as u32)
    }

    /// Turns a vertex that was pushed with its coordinates into its opposite.
    pub(crate) fn negate_vertex(&mut self, vertex: VertexId) {
        let data = &mut self.vertices[vertex.0 as usize];
        data.rounded = data.rounded.map(|c| -c);
        if let Some(exact) = data.exact.take() {
            data.exact = OnceCell::from(negated(exact));
        }
    }
}

fn negated(vertex: ExactVertex) -> ExactVertex {
    match vertex {
        ExactVertex::Narrow(v) => ExactVertex::Narrow(v.map(|c| -c)),
        ExactVertex::Wide(v) => ExactVertex::Wide(Box::new(v.map(|c| -c))),
    }
}

/// Relative error bound of the filters, proved at [`PluckerSpace::dot`].
const FILTER: f64 = 1.0 / (1_u64 << 48) as f64;

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

fn round_vertex(exact: &ExactVertex) -> [f64; 6] {
    match exact {
        ExactVertex::Narrow(v) => {
            let e = v.iter().map(|c| c.bits()).max().unwrap_or(0) as i32;
            v.map(|c| c.to_f64_scaled(e))
        }
        ExactVertex::Wide(v) => {
            use dashu_int::ops::BitTest;
            let e = v.iter().map(BitTest::bit_len).max().unwrap_or(0);
            std::array::from_fn(|k| {
                // The 100 leading bits of each coordinate on its own: a relative error below 2^-52
                // as long as coordinates differ by fewer than 900 bits, far beyond any width here.
                let shift = v[k].bit_len().saturating_sub(100);
                (v[k].clone() >> shift).to_f64().value() * 2_f64.powi(shift as i32 - e as i32)
            })
        }
    }
}

/// The determinant of a square matrix of big integers (Bareiss elimination).
fn determinant(mut m: Vec<Vec<IBig>>) -> IBig {
    let n = m.len();
    let mut previous = IBig::ONE;
    let mut negative = false;
    for k in 0..n - 1 {
        if m[k][k] == IBig::ZERO {
            let Some(swap) = (k + 1..n).find(|&i| m[i][k] != IBig::ZERO) else {
                return IBig::ZERO;
            };
            m.swap(k, swap);
            negative = !negative;
        }
        for i in k + 1..n {
            for j in k + 1..n {
                m[i][j] = (&m[i][j] * &m[k][k] - &m[i][k] * &m[k][j]) / &previous;
            }
        }
        previous = m[k][k].clone();
    }
    let d = m[n - 1][n - 1].clone();
    if negative { -d } else { d }
}
