//! Fixed-width signed integers for exact signs: no heap, no rounding.
//!
//! Two's complement in `N` limbs of 64 bits, least significant first. Widths are proved per
//! predicate (see the table in `docs/notes/arithmetic.md`), so the operations wrap silently in
//! release builds and the callers' bounds guarantee that they never do.
//! Conversion to a double feeds filters only.

use crate::Sign;

/// A signed integer of `64 * N` bits.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub struct Int<const N: usize>([u64; N]);

/// 256 bits: vertices of five edge rows (195 bits) and their dot products with a row (221 bits).
pub type I256 = Int<4>;
/// 512 bits: the Plücker quadric and bilinear form at such vertices (371 bits).
pub type I512 = Int<8>;

impl<const N: usize> Int<N> {
    /// Zero.
    pub const ZERO: Self = Self([0; N]);

    /// The limbs, least significant first, two's complement.
    #[inline]
    #[must_use]
    pub fn limbs(&self) -> &[u64; N] {
        &self.0
    }

    /// From a 64-bit integer.
    #[inline]
    #[must_use]
    pub fn from_i64(v: i64) -> Self {
        let mut limbs = [(v >> 63) as u64; N];
        limbs[0] = v as u64;
        Self(limbs)
    }

    /// From a 128-bit integer; `N` is at least 2.
    #[inline]
    #[must_use]
    pub fn from_i128(v: i128) -> Self {
        let mut limbs = [(v >> 127) as u64; N];
        limbs[0] = v as u64;
        limbs[1] = (v >> 64) as u64;
        Self(limbs)
    }

    /// The same value in another width; the caller guarantees that it fits.
    #[inline]
    #[must_use]
    pub fn resize<const M: usize>(&self) -> Int<M> {
        let fill = if self.is_negative() { u64::MAX } else { 0 };
        let mut limbs = [fill; M];
        let shared = if N < M { N } else { M };
        limbs[..shared].copy_from_slice(&self.0[..shared]);
        Int(limbs)
    }

    /// Whether the value is below zero.
    #[inline]
    #[must_use]
    pub fn is_negative(&self) -> bool {
        self.0[N - 1] >> 63 == 1
    }

    /// The sign.
    #[inline]
    #[must_use]
    pub fn sign(&self) -> Sign {
        if self.is_negative() {
            Sign::Negative
        } else if self.0.iter().all(|&l| l == 0) {
            Sign::Zero
        } else {
            Sign::Positive
        }
    }

    /// The product of two values, sign-extended into `N` limbs.
    #[inline]
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let mut out = [0_u64; N];
        for i in 0..N {
            let mut carry = 0_u64;
            for j in 0..N - i {
                let t = u128::from(self.0[i]) * u128::from(other.0[j])
                    + u128::from(out[i + j])
                    + u128::from(carry);
                out[i + j] = t as u64;
                carry = (t >> 64) as u64;
            }
        }
        Self(out)
    }

    /// The product with a 64-bit integer.
    // Signs are random where this is used, so they are mended without a branch: a negative factor
    // read as unsigned is 2^64 too large.
    #[inline]
    #[must_use]
    pub fn times_i64(&self, other: i64) -> Self {
        let (factor, mask) = (other as u64, (other >> 63) as u64);
        let mut out = [0_u64; N];
        let mut carry = 0_u64;
        for i in 0..N {
            let t = u128::from(self.0[i]) * u128::from(factor) + u128::from(carry);
            out[i] = t as u64;
            carry = (t >> 64) as u64;
        }
        let mut borrow = false;
        for i in 1..N {
            let (a, c1) = out[i].overflowing_sub(self.0[i - 1] & mask);
            let (b, c2) = a.overflowing_sub(u64::from(borrow));
            out[i] = b;
            borrow = c1 | c2;
        }
        Self(out)
    }

    /// The product of two 128-bit integers; `N` is at least 3, and with 3 the caller guarantees
    /// that it fits.
    #[inline]
    #[must_use]
    pub fn product_i128(a: i128, b: i128) -> Self {
        let (x0, x1) = (a as u64, (a >> 64) as u64);
        let (y0, y1) = (b as u64, (b >> 64) as u64);
        let low = u128::from(x0) * u128::from(y0);
        let mid_a = u128::from(x0) * u128::from(y1);
        let mid_b = u128::from(x1) * u128::from(y0);
        let high = u128::from(x1) * u128::from(y1);
        let mid = (low >> 64) + u128::from(mid_a as u64) + u128::from(mid_b as u64);
        let top = high
            .wrapping_add(mid_a >> 64)
            .wrapping_add(mid_b >> 64)
            .wrapping_add(mid >> 64)
            // A negative factor was read 2^128 too large.
            .wrapping_sub((b & (a >> 127)) as u128)
            .wrapping_sub((a & (b >> 127)) as u128);
        let mut limbs = [((top as i128) >> 127) as u64; N];
        limbs[0] = low as u64;
        limbs[1] = mid as u64;
        limbs[2] = top as u64;
        if N > 3 {
            limbs[3] = (top >> 64) as u64;
        }
        Self(limbs)
    }

    /// The number of bits of the magnitude.
    #[must_use]
    pub fn bits(&self) -> u32 {
        let m = if self.is_negative() { -*self } else { *self };
        for i in (0..N).rev() {
            if m.0[i] != 0 {
                return 64 * i as u32 + 64 - m.0[i].leading_zeros();
            }
        }
        0
    }

    /// The value divided by `2^exponent`, rounded: relative error below 2^-52.
    ///
    /// Only filters and output use it.
    #[inline]
    #[must_use]
    pub fn to_f64_scaled(&self, exponent: i32) -> f64 {
        let negative = self.is_negative();
        let m = if negative { -*self } else { *self };
        let mut top = N - 1;
        while top > 0 && m.0[top] == 0 {
            top -= 1;
        }
        // 128 leading bits hold at least 65 significant ones, enough for a correctly truncated
        // double; the conversion below rounds once more.
        let head = if top == 0 {
            u128::from(m.0[0])
        } else {
            u128::from(m.0[top]) << 64 | u128::from(m.0[top - 1])
        };
        let shift = if top == 0 { 0 } else { 64 * (top as i32 - 1) } - exponent;
        let value = head as f64 * pow2(shift);
        if negative { -value } else { value }
    }
}

/// `2^e` by assembling the bits; exact for normal exponents, saturating outside.
#[inline]
fn pow2(e: i32) -> f64 {
    let biased = (e + 1023).clamp(0, 2046) as u64;
    f64::from_bits(biased << 52)
}

impl<const N: usize> std::ops::Add for Int<N> {
    type Output = Self;
    // A carry is the union of two carries that exclude each other.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline]
    fn add(self, other: Self) -> Self {
        let mut out = [0_u64; N];
        let mut carry = false;
        for i in 0..N {
            let (a, c1) = self.0[i].overflowing_add(other.0[i]);
            let (b, c2) = a.overflowing_add(u64::from(carry));
            out[i] = b;
            carry = c1 | c2;
        }
        Self(out)
    }
}

impl<const N: usize> std::ops::Neg for Int<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        let mut out = [0_u64; N];
        let mut carry = true;
        for i in 0..N {
            let (a, c) = (!self.0[i]).overflowing_add(u64::from(carry));
            out[i] = a;
            carry = c;
        }
        Self(out)
    }
}

impl<const N: usize> std::ops::Sub for Int<N> {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline]
    fn sub(self, other: Self) -> Self {
        let mut out = [0_u64; N];
        let mut borrow = false;
        for i in 0..N {
            let (a, c1) = self.0[i].overflowing_sub(other.0[i]);
            let (b, c2) = a.overflowing_sub(u64::from(borrow));
            out[i] = b;
            borrow = c1 | c2;
        }
        Self(out)
    }
}

#[cfg(test)]
mod tests {
    use super::{I256, I512, Int};
    use crate::Sign;
    use dashu_int::IBig;

    fn big<const N: usize>(v: &Int<N>) -> IBig {
        let negative = v.is_negative();
        let m = if negative { -*v } else { *v };
        let mut out = IBig::ZERO;
        for &l in m.limbs().iter().rev() {
            out = (out << 64) + IBig::from(l);
        }
        if negative { -out } else { out }
    }

    fn samples() -> Vec<i128> {
        let mut out = vec![
            0,
            1,
            -1,
            i128::from(i64::MAX),
            i128::from(i64::MIN),
            1 << 100,
            -(1 << 100),
        ];
        let mut state = 88_172_645_463_325_252_u64;
        for k in 0..40 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let v = (i128::from(state as i64) << (k % 50)) + i128::from(state >> 3);
            out.push(v);
            out.push(-v);
        }
        out
    }

    #[test]
    fn ring_operations_agree_with_big_integers() {
        for &a in &samples() {
            for &b in &samples() {
                let (x, y) = (I256::from_i128(a), I256::from_i128(b));
                assert_eq!(big(&(x + y)), IBig::from(a) + IBig::from(b));
                assert_eq!(big(&(x - y)), IBig::from(a) - IBig::from(b));
                assert_eq!(big(&x.times(&y)), IBig::from(a) * IBig::from(b));
                assert_eq!(
                    big(&I256::product_i128(a, b)),
                    IBig::from(a) * IBig::from(b)
                );
                assert_eq!(
                    big(&x.times_i64(b as i64)),
                    IBig::from(a) * IBig::from(b as i64)
                );
                let wide = I512::product_i128(a, b).times(&I512::from_i128(a));
                assert_eq!(big(&wide), IBig::from(a) * IBig::from(b) * IBig::from(a));
                assert_eq!(big(&x.resize::<8>()), IBig::from(a));
            }
        }
    }

    #[test]
    fn conversion_to_double_stays_within_its_bound() {
        for &a in &samples() {
            let x = I256::from_i128(a).times_i64(1 << 62).times_i64(1 << 40);
            let expected = a as f64 * 2_f64.powi(102 - 60);
            let got = x.to_f64_scaled(60);
            assert!(
                (got - expected).abs() <= expected.abs() * 2_f64.powi(-52),
                "{a}"
            );
            assert_eq!(x.sign(), Sign::of(a));
        }
    }
}
