//! The sign of an exact quantity: the only thing a predicate ever returns.

/// The sign of an exactly known number.
///
/// There is deliberately no conversion to `bool`: every caller has to say what happens on zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(i8)]
pub enum Sign {
    /// Less than zero.
    Negative = -1,
    /// Exactly zero.
    Zero = 0,
    /// Greater than zero.
    Positive = 1,
}

impl Sign {
    /// The sign of a machine integer.
    ///
    /// ```
    /// use antumbra_kernel::Sign;
    /// assert_eq!(Sign::of(-3_i128), Sign::Negative);
    /// ```
    #[inline]
    #[must_use]
    pub fn of<T: PartialOrd + Default>(value: T) -> Self {
        let zero = T::default();
        if value > zero {
            Self::Positive
        } else if value < zero {
            Self::Negative
        } else {
            Self::Zero
        }
    }

    /// The sign of a number from its comparison with zero.
    #[inline]
    #[must_use]
    pub fn of_ordering(ordering: std::cmp::Ordering) -> Self {
        match ordering {
            std::cmp::Ordering::Less => Self::Negative,
            std::cmp::Ordering::Equal => Self::Zero,
            std::cmp::Ordering::Greater => Self::Positive,
        }
    }

    /// The opposite sign.
    #[inline]
    #[must_use]
    pub fn flip(self) -> Self {
        match self {
            Self::Negative => Self::Positive,
            Self::Zero => Self::Zero,
            Self::Positive => Self::Negative,
        }
    }

    /// The sign of a product of two numbers with these signs.
    #[inline]
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        match other {
            Self::Negative => self.flip(),
            Self::Zero => Self::Zero,
            Self::Positive => self,
        }
    }

    /// Whether the number is greater than zero.
    #[inline]
    #[must_use]
    pub fn is_positive(self) -> bool {
        self == Self::Positive
    }

    /// Whether the number is less than zero.
    #[inline]
    #[must_use]
    pub fn is_negative(self) -> bool {
        self == Self::Negative
    }

    /// Whether the number is exactly zero.
    #[inline]
    #[must_use]
    pub fn is_zero(self) -> bool {
        self == Self::Zero
    }

    /// `-1`, `0` or `1`.
    #[inline]
    #[must_use]
    pub fn to_i8(self) -> i8 {
        self as i8
    }
}

#[cfg(test)]
mod tests {
    use super::Sign;

    #[test]
    fn products_follow_the_rule_of_signs() {
        for a in [-2_i64, 0, 5] {
            for b in [-7_i64, 0, 3] {
                assert_eq!(Sign::of(a).times(Sign::of(b)), Sign::of(a * b));
            }
            assert_eq!(Sign::of(a).flip(), Sign::of(-a));
        }
    }
}
