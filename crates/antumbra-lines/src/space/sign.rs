//! Signs of rows and of the quadric at vertices: doubles first, then integers.

use antumbra_kernel::{Sign, plucker};
use dashu_int::IBig;

use super::{ExactRow, ExactVertex, PluckerSpace, RowId, VertexId, sign_of};

/// Relative error bound of the filters, proved at [`PluckerSpace::dot`].
const FILTER: f64 = 1.0 / (1_u64 << 48) as f64;

impl PluckerSpace {
    /// The rounded dot product of a row and a vertex, and a bound of its error.
    ///
    /// Six terms, each factor within 2^-52 of the truth, err by less than 2^-48 of the sum of their
    /// magnitudes (2 * 2^-52 for the factors, 2^-53 for each product, 5 * 2^-53 for the additions:
    /// below 2^-49; the sum of magnitudes is itself rounded). What the vertex errs beyond that is
    /// multiplied by the row's coefficients; the factor 1.01 covers the rounding of the bound.
    #[inline]
    pub(super) fn dot(&self, row: RowId, vertex: VertexId) -> (f64, f64) {
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
}
