//! What is kept of one pixel from pass to pass.

use std::io::{self, Read};

use crate::math::varint::take_real;
use crate::picture::gather::ErrorSums;

/// Sets that a pixel's samples are divided into: their spread is the error of the eye's sampling.
pub const SETS: u32 = 4;

/// The sums of a pixel, cd/m2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PixelSums<const C: usize> {
    /// Luminance by channel.
    pub value: [f64; C],
    /// Luminance that each set of samples makes; its spread needs no more digits.
    pub by_set: [f32; SETS as usize],
    /// Error and bias of what photons make.
    pub error: ErrorSums<C>,
}

impl<const C: usize> PixelSums<C> {
    pub(crate) const NOTHING: Self =
        Self { value: [0.0; C], by_set: [0.0; SETS as usize], error: ErrorSums::NOTHING };

    /// A pixel that an interrupt left unseen: black, its error and bias unknown.
    pub(crate) const UNSEEN: Self = Self { error: ErrorSums::UNKNOWN, ..Self::NOTHING };

    /// All of its numbers, for [`Self::read`].
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> + use<C> {
        self.value.into_iter().chain(self.by_set.map(f64::from)).chain(self.error.numbers())
    }

    /// Reads what [`Self::numbers`] gave.
    ///
    /// # Errors
    /// Those of the reader.
    pub(crate) fn read(from: &mut dyn Read) -> io::Result<Self> {
        let mut sums = Self::NOTHING;
        sums.value.iter_mut().try_for_each(|value| take_real(from).map(|x| *value = x))?;
        sums.by_set.iter_mut().try_for_each(|value| take_real(from).map(|x| *value = x as f32))?;
        sums.error = ErrorSums::read(from)?;
        Ok(sums)
    }

    /// Square of the standard error of the luminance: that of the photons for these samples and that of the
    /// samples for these photons. NaN where a single replicate or a single set says nothing.
    pub(crate) fn variance(&self, replicates: u32, sets: u32) -> f64 {
        let s = f64::from(sets);
        // The value is the sum over replicates, the mean over sets.
        let of_eye = if sets < 2 {
            f64::NAN
        } else {
            let sets = &self.by_set[..sets as usize];
            let mean = sets.iter().map(|x| f64::from(*x)).sum::<f64>() / s;
            sets.iter().map(|x| (f64::from(*x) - mean).powi(2)).sum::<f64>() / (s * (s - 1.0))
        };
        self.error.variance(replicates) + of_eye
    }

    /// Takes everything so far for this many times as bright.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.value = self.value.map(|v| v * factor);
        self.by_set = self.by_set.map(|v| (f64::from(v) * factor) as f32);
        self.error.scale(factor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::gather::Gathered;

    fn gathered(by_replicate: &[f64]) -> Gathered<1> {
        let mut gathered = Gathered::new(by_replicate.len());
        gathered.by_replicate.copy_from_slice(by_replicate);
        gathered.value = [by_replicate.iter().sum()];
        gathered
    }

    #[test]
    fn the_error_is_that_of_replicates_and_of_sets() {
        let mut sums = PixelSums::<1>::NOTHING;
        // Replicate 0 comes in two parts, 1 + 2; samples count one half.
        sums.error.add(&gathered(&[2.0]), 0.5, 0..1, false);
        sums.error.add(&gathered(&[4.0]), 0.5, 0..1, true);
        sums.error.add(&gathered(&[0.0, 10.0, 8.0]), 0.5, 1..3, true);
        sums.by_set = [11.0, 12.0, 13.0, 12.0];
        // Sum of three with variance 1: 3. Mean of four with variance 2/3: 1/6.
        assert!((sums.variance(3, 4) - (3.0 + 1.0 / 6.0)).abs() < 1e-14);
        assert!(sums.variance(1, 4).is_nan() && sums.variance(3, 1).is_nan());
        assert_eq!(PixelSums::<1>::NOTHING.variance(0, 4), 0.0);
        let mut only_open = PixelSums::<1>::NOTHING;
        only_open.error.add(&gathered(&[0.5]), 1.0, 0..1, false);
        assert!(only_open.variance(0, 4).is_nan() && PixelSums::<1>::UNSEEN.variance(3, 4).is_nan());
        assert_eq!(only_open.error.take_open(), [0.5]);
        assert_eq!(only_open.variance(0, 4), 0.0);
        sums.error.sparse_square = 1.0;
        let before = sums.variance(3, 4);
        assert!((before - (4.0 + 1.0 / 6.0)).abs() < 1e-14);
        sums.scale(2.0);
        assert!((sums.variance(3, 4) - 4.0 * before).abs() < 1e-13);
    }
}
