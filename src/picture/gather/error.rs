//! Standard error and bias of a pixel's light from photons, from what is gathered pass by pass.
//!
//! Error: the spread of the replicates' sums, R s^2 (METHOD 7), and what places with hardly a photon owe.
//! Bias: the difference between the two bandwidths.

use std::io::{self, Read};
use std::ops::Range;

use crate::math::varint::take_real;
use crate::surface::luminance_of;

use super::BIAS_PER_DIFFERENCE;
use super::gathered::Gathered;

/// What is kept of the photons of a pixel from pass to pass, to tell the error and bias of its luminance;
/// cd/m2 and its square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorSums<const C: usize> {
    /// Luminance at the second bandwidth less that at the first, signed: what is too dark in one pass may be
    /// too bright in another.
    pub difference: f64,
    /// Bound on the k-NN bias ([`Gathered::nearest_bias`]).
    pub nearest_bias: f64,
    /// Square of the standard error owed to places with hardly a photon, whose spread says nothing.
    pub sparse_square: f64,
    /// Of the luminance that each finished replicate makes: sum, and sum of squares.
    photons: f64,
    photons_square: f64,
    /// What the photons of the replicate that is not finished make, by channel.
    open: [f64; C],
}

impl<const C: usize> ErrorSums<C> {
    /// No pass yet.
    pub const NOTHING: Self = Self {
        difference: 0.0,
        nearest_bias: 0.0,
        sparse_square: 0.0,
        photons: 0.0,
        photons_square: 0.0,
        open: [0.0; C],
    };

    /// Error and bias that nobody knows: NaN.
    pub const UNKNOWN: Self = Self { nearest_bias: f64::NAN, sparse_square: f64::NAN, ..Self::NOTHING };

    /// Adds what was gathered in a pass over photons of these replicates, each sample counting `of_sample`.
    /// Where the pass does not finish its replicate, a later pass goes on with it.
    pub fn add(&mut self, gathered: &Gathered<C>, of_sample: f64, replicates: Range<u32>, finishes: bool) {
        self.difference += (luminance_of(&gathered.second) - luminance_of(&gathered.value)) * of_sample;
        self.nearest_bias += gathered.nearest_bias * of_sample;
        self.sparse_square += (gathered.sparse * of_sample).powi(2);
        if !finishes {
            (0..C).for_each(|c| self.open[c] += gathered.value[c] * of_sample);
            return;
        }
        for replicate in replicates {
            let all = luminance_of(&self.open) + gathered.by_replicate[replicate as usize] * of_sample;
            self.photons += all;
            self.photons_square += all * all;
            self.open = [0.0; C];
        }
    }

    /// All of its numbers, for [`Self::read`].
    pub fn numbers(&self) -> impl Iterator<Item = f64> + use<C> {
        let Self { difference, nearest_bias, sparse_square, photons, photons_square, open } = *self;
        [difference, nearest_bias, sparse_square, photons, photons_square].into_iter().chain(open)
    }

    /// Reads what [`Self::numbers`] gave.
    ///
    /// # Errors
    /// Those of the reader.
    pub fn read(from: &mut dyn Read) -> io::Result<Self> {
        let mut read = Self::NOTHING;
        let Self { difference, nearest_bias, sparse_square, photons, photons_square, open } = &mut read;
        let all = [difference, nearest_bias, sparse_square, photons, photons_square];
        all.into_iter().chain(open).try_for_each(|number| take_real(from).map(|x| *number = x))?;
        Ok(read)
    }

    /// Takes out what the replicate that is not finished made, by channel.
    pub fn take_open(&mut self) -> [f64; C] {
        std::mem::replace(&mut self.open, [0.0; C])
    }

    /// Square of the standard error of the luminance, given the bandwidth, after so many whole replicates;
    /// NaN where a single one says nothing.
    pub fn variance(&self, replicates: u32) -> f64 {
        let r = f64::from(replicates);
        let of_photons = match replicates {
            0 if self.open == [0.0; C] => 0.0,
            0 | 1 => f64::NAN,
            _ => (r * self.photons_square - self.photons * self.photons).max(0.0) / (r - 1.0),
        };
        of_photons + self.sparse_square
    }

    /// Estimated size of the bias of the luminance.
    pub fn bias(&self) -> f64 {
        self.difference.abs() * BIAS_PER_DIFFERENCE + self.nearest_bias
    }

    /// Takes all photons so far for this many times their flux.
    pub fn scale(&mut self, factor: f64) {
        self.open = self.open.map(|v| v * factor);
        for sum in [&mut self.difference, &mut self.nearest_bias, &mut self.photons] {
            *sum *= factor;
        }
        for square in [&mut self.photons_square, &mut self.sparse_square] {
            *square *= factor * factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bias_is_the_difference_of_all_passes_and_what_neighbours_owe() {
        let mut sums = ErrorSums::<1>::NOTHING;
        let pass = |value, second, nearest_bias, sparse| {
            let mut gathered = Gathered::<1>::new(1);
            (gathered.value, gathered.second) = ([value], [second]);
            (gathered.nearest_bias, gathered.sparse) = (nearest_bias, sparse);
            gathered
        };
        sums.add(&pass(10.0, 7.0, 1.0, 3.0), 0.5, 0..1, true);
        assert!((sums.bias() - (1.5 * BIAS_PER_DIFFERENCE + 0.5)).abs() < 1e-14);
        // What one pass sees too dark and the other too bright cancels; what neighbours owe does not.
        sums.add(&pass(10.0, 13.0, 1.0, 4.0), 0.5, 0..1, true);
        assert_eq!(sums.bias(), 1.0);
        assert_eq!(sums.sparse_square, 1.5 * 1.5 + 2.0 * 2.0);
        assert!(ErrorSums::<3>::UNKNOWN.bias().is_nan() && ErrorSums::<3>::UNKNOWN.variance(4).is_nan());
    }
}
