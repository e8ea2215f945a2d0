//! A small seeded generator of random numbers, the same on every machine.

/// SplitMix64: one word of state, good enough to choose test inputs.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A generator; equal seeds give equal sequences.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// An integer in the closed range `low..=high`; the bias is below 2^-32 for ranges below 2^32.
    ///
    /// # Panics
    /// If the range is empty.
    pub fn integer(&mut self, low: i64, high: i64) -> i64 {
        assert!(low <= high, "an empty range: {low} to {high}");
        let size = (i128::from(high) - i128::from(low) + 1) as u128;
        (i128::from(low) + ((u128::from(self.bits()) * size) >> 64) as i128) as i64
    }

    /// A number in `0.0..1.0`.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// An index below `count`.
    ///
    /// # Panics
    /// If `count` is zero.
    pub fn index(&mut self, count: usize) -> usize {
        self.integer(0, count as i64 - 1) as usize
    }

    /// Puts a slice into random order.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.index(i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Random;

    #[test]
    fn ranges_are_closed_and_sequences_repeat() {
        let mut random = Random::new(7);
        let drawn: Vec<i64> = (0..200).map(|_| random.integer(-1, 1)).collect();
        for value in -1..=1 {
            assert!(drawn.contains(&value));
        }
        assert!(drawn.iter().all(|v| (-1..=1).contains(v)));
        let mut again = Random::new(7);
        assert!(drawn.iter().all(|v| *v == again.integer(-1, 1)));
        assert_eq!(random.integer(i64::MIN, i64::MIN), i64::MIN);
    }
}
