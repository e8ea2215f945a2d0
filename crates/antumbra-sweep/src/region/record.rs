//! What trying has paid so far, by the number of objects at stake.
//!
//! In clouds of loose polygons hardly any box is hidden although most of what is in it is hard to
//! see; proofs of boxes are then wasted, and objects are better asked one by one.

/// Tries and successes in classes by the binary logarithm of the number of objects.
#[derive(Clone, Debug, Default)]
pub(super) struct Record {
    classes: [(u32, u32); 32],
}

impl Record {
    /// Tries before a class is judged.
    const ENOUGH: u32 = 24;
    /// One success in so many tries pays, times the number of objects that it hides.
    const WORTH: u32 = 16;

    /// Whether another try pays.
    pub(super) fn pay(&self, class: usize) -> bool {
        let (tries, successes) = self.classes[class.min(31)];
        tries < Self::ENOUGH
            || (u64::from(successes) * u64::from(Self::WORTH)) << class >= u64::from(tries)
    }

    pub(super) fn note(&mut self, class: usize, success: bool) {
        let (tries, successes) = &mut self.classes[class.min(31)];
        *tries += 1;
        *successes += u32::from(success);
    }
}

#[cfg(test)]
mod tests {
    use super::Record;

    #[test]
    fn what_never_succeeds_is_given_up_for_its_class_alone() {
        let mut record = Record::default();
        for _ in 0..Record::ENOUGH {
            assert!(record.pay(2));
            record.note(2, false);
        }
        assert!(!record.pay(2));
        assert!(record.pay(1) && record.pay(3));
    }

    #[test]
    fn what_succeeds_now_and_then_goes_on() {
        let mut record = Record::default();
        for i in 0..200 {
            assert!(record.pay(1));
            record.note(1, i % 20 == 0);
        }
    }
}
