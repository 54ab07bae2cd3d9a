//! Sums of 128 bits that any number of threads add to, in any order, with the same result.

use std::sync::atomic::{AtomicU64, Ordering};

/// A sum of 128 bits.
#[derive(Debug, Default)]
pub struct WideSum {
    low: AtomicU64,
    high: AtomicU64,
}

impl WideSum {
    /// Adds this much. Of every carry out of the lower half exactly one addition is told, so the sum is exact
    /// whatever the order.
    #[inline]
    pub fn add(&self, amount: u128) {
        let (low, mut high) = (amount as u64, (amount >> 64) as u64);
        let before = self.low.fetch_add(low, Ordering::Relaxed);
        high += u64::from(before.checked_add(low).is_none());
        if high > 0 {
            self.high.fetch_add(high, Ordering::Relaxed);
        }
    }

    /// The sum, which is zero again.
    pub fn take(&mut self) -> u128 {
        let (low, high) = (std::mem::take(self.low.get_mut()), std::mem::take(self.high.get_mut()));
        u128::from(high) << 64 | u128::from(low)
    }

    /// The sum, once nothing is added any more.
    pub fn get(&self) -> u128 {
        u128::from(self.high.load(Ordering::Relaxed)) << 64 | u128::from(self.low.load(Ordering::Relaxed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_carry_into_the_upper_half_whatever_the_order() {
        let amounts = [u128::from(u64::MAX), 1, 1 << 70, (1 << 64) - 5, 12, u128::from(u64::MAX) * 3];
        let expected: u128 = amounts.iter().sum();
        for start in 0..amounts.len() {
            let mut sum = WideSum::default();
            for k in 0..amounts.len() {
                sum.add(amounts[(start + k) % amounts.len()]);
            }
            assert_eq!(sum.get(), expected);
            assert_eq!((sum.take(), sum.get()), (expected, 0));
        }
    }

    #[test]
    fn threads_lose_no_carry() {
        let mut sum = WideSum::default();
        let amount = u128::from(u64::MAX) - 12345;
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| (0..10_000).for_each(|_| sum.add(amount)));
            }
        });
        assert_eq!(sum.take(), 40_000 * amount);
    }
}
