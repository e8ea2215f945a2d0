//! Which rows are linearly independent? Elimination modulo the prime 2^61 - 1: rows independent
//! there are independent over the integers.

const PRIME: u64 = (1 << 61) - 1;

/// A residue of a machine integer.
pub(super) fn residue(v: i64) -> u64 {
    i128::from(v).rem_euclid(i128::from(PRIME)) as u64
}

/// The prime, for other integer types.
pub(super) const fn prime() -> u64 {
    PRIME
}

fn product(a: u64, b: u64) -> u64 {
    let t = u128::from(a) * u128::from(b);
    let folded = (t as u64 & PRIME) + (t >> 61) as u64;
    if folded >= PRIME {
        folded - PRIME
    } else {
        folded
    }
}

fn difference(a: u64, b: u64) -> u64 {
    if a >= b { a - b } else { a + PRIME - b }
}

/// Rows found independent so far, in echelon form.
#[derive(Clone, Debug, Default)]
pub(super) struct Basis {
    rows: [([u64; 6], usize); 6],
    rank: usize,
}

impl Basis {
    /// Adds a row; false (and no change) if it depends on the others.
    pub(super) fn insert(&mut self, mut row: [u64; 6]) -> bool {
        for (b, pivot) in &self.rows[..self.rank] {
            let (f, g) = (row[*pivot], b[*pivot]);
            if f != 0 {
                for k in 0..6 {
                    row[k] = difference(product(row[k], g), product(f, b[k]));
                }
            }
        }
        let Some(pivot) = row.iter().position(|&c| c != 0) else {
            return false;
        };
        self.rows[self.rank] = (row, pivot);
        self.rank += 1;
        true
    }

    /// How many rows there are.
    pub(super) fn rank(&self) -> usize {
        self.rank
    }
}

#[cfg(test)]
mod tests {
    use super::{Basis, residue};

    #[test]
    fn dependent_rows_are_found() {
        let mut basis = Basis::default();
        let row = |c: [i64; 6]| c.map(residue);
        assert!(basis.insert(row([1, 2, 3, 4, 5, -6])));
        assert!(basis.insert(row([0, 0, -7, 1, 2, 3])));
        assert!(!basis.insert(row([-2, -4, 8, -10, -14, 6])));
        assert!(basis.insert(row([0, 0, 0, 0, 0, -1])));
        assert_eq!(basis.rank(), 3);
    }
}
