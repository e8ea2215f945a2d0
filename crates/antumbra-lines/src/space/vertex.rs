//! New vertices: where five rows meet, rounded to doubles for filters first, exact when a sign asks for it.

use std::cell::OnceCell;

use antumbra_kernel::plucker;
use dashu_int::IBig;

use super::{
    ExactRow, ExactVertex, Origin, PluckerSpace, RowId, VertexData, VertexId, largest, sign_of,
};

impl PluckerSpace {
    pub(super) fn compute(&self, data: &VertexData, origin: Origin) -> ExactVertex {
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
