//! Pixels: luminance, standard error, bias; and the sums that they come from.

use crate::error::{Diagnostic, Kind, Result};
use crate::picture::gather::density::BIAS_PER_DIFFERENCE;
use crate::surface::luminance_of;

/// A finished picture. `C` channels: 1 (luminance) or 3 (linear sRGB whose Y is luminance), cd/m2.
#[derive(Debug, Clone, PartialEq)]
pub struct Film<const C: usize> {
    /// Columns and rows.
    pub pixels: [u32; 2],
    /// Row by row from the top left.
    pub value: Vec<[f64; C]>,
    /// Standard error of the luminance, cd/m2; NaN where there is none.
    pub standard_error: Vec<f64>,
    /// Estimated bias of the luminance, cd/m2.
    pub bias: Vec<f64>,
}

/// Most bytes that a picture and its sums may take while it is made.
pub const MOST_PICTURE_BYTES: u64 = 1 << 30;

impl<const C: usize> Film<C> {
    /// Bytes that a picture of so many columns and rows takes while it is made: its sums and itself.
    pub fn memory_bytes(pixels: [u32; 2]) -> u64 {
        let padded = pixels.map(|n| u64::from(n).div_ceil(u64::from(TILE)) * u64::from(TILE));
        let of_sums = size_of::<PixelSums<C>>() as u64;
        let of_film = (size_of::<[f64; C]>() + 2 * size_of::<f64>()) as u64;
        let number = u128::from(padded[0]) * u128::from(padded[1]);
        u64::try_from(number * u128::from(of_sums + of_film)).unwrap_or(u64::MAX)
    }

    /// Whether a picture of so many columns and rows can be made.
    ///
    /// # Errors
    /// One without pixels; one that takes more than [`MOST_PICTURE_BYTES`].
    pub fn check_memory(pixels: [u32; 2]) -> Result<()> {
        check_memory(pixels, Self::memory_bytes(pixels))
    }
}

/// Whether a picture of so many columns and rows can be made that takes so many bytes.
///
/// # Errors
/// One without pixels; one that takes more than [`MOST_PICTURE_BYTES`].
pub(crate) fn check_memory(pixels: [u32; 2], bytes: u64) -> Result<()> {
    if bytes <= MOST_PICTURE_BYTES && bytes > 0 {
        return Ok(());
    }
    let [columns, rows] = pixels;
    let mib = |bytes: u64| bytes.div_ceil(1 << 20);
    Err(Diagnostic::new(
        Kind::Limit,
        format!("a picture of {columns} x {rows} pixels, which takes {} MiB", mib(bytes)),
        format!("at least one pixel, and at most {} MiB", mib(MOST_PICTURE_BYTES)),
    )
    .hint("fewer pixels; several cameras of a part of the view each make a larger picture"))
}

/// Columns and rows of a tile: what one task renders.
pub const TILE: u32 = 16;
pub(crate) const TILE_PIXELS: usize = (TILE * TILE) as usize;

/// Sets that a pixel's samples are divided into: their spread is the error of the eye's sampling.
pub const SETS: u32 = 4;

/// What is kept of a pixel from pass to pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PixelSums<const C: usize> {
    /// Luminance by channel.
    pub value: [f64; C],
    /// Luminance at the second bandwidth less that at the first, signed: what is too dark in one pass may be too bright in
    /// another.
    pub difference: f64,
    /// Bias of the luminance that bandwidths don't tell.
    pub further_bias: f64,
    /// Luminance that each set of samples makes; its spread needs no more digits.
    pub by_set: [f32; SETS as usize],
    /// Of the luminance that each finished replicate's photons make: sum, and sum of squares.
    pub photons: f64,
    pub photons_square: f64,
    /// What the photons of the replicate that is not finished make, by channel.
    pub open: [f64; C],
    /// Square of the standard error owed to places with hardly a photon, whose spread says nothing.
    pub sparse_square: f64,
}

impl<const C: usize> PixelSums<C> {
    pub(crate) const NOTHING: Self = Self {
        value: [0.0; C],
        difference: 0.0,
        further_bias: 0.0,
        by_set: [0.0; SETS as usize],
        photons: 0.0,
        photons_square: 0.0,
        open: [0.0; C],
        sparse_square: 0.0,
    };

    /// A pixel that an interrupt left unseen: black, its error and bias unknown.
    pub(crate) const UNSEEN: Self = Self { further_bias: f64::NAN, sparse_square: f64::NAN, ..Self::NOTHING };

    /// A part of a replicate's photons makes this, by channel.
    pub(crate) fn add_part(&mut self, part: [f64; C]) {
        (0..C).for_each(|c| self.open[c] += part[c]);
    }

    /// A replicate's photons, or the last part of them, make this luminance.
    pub(crate) fn add_replicate(&mut self, luminance: f64) {
        let all = luminance_of(&self.open) + luminance;
        self.photons += all;
        self.photons_square += all * all;
        self.open = [0.0; C];
    }

    /// Square of the standard error of the luminance; NaN where a single replicate or a single sample says nothing.
    fn variance(&self, replicates: u32, sets: u32) -> f64 {
        let (r, s) = (f64::from(replicates), f64::from(sets));
        // The value is the sum over replicates, the mean over sets.
        let of_photons = match replicates {
            0 if self.open == [0.0; C] => 0.0,
            0 | 1 => f64::NAN,
            _ => (r * self.photons_square - self.photons * self.photons).max(0.0) / (r - 1.0),
        };
        let of_eye = if sets < 2 {
            f64::NAN
        } else {
            let sets = &self.by_set[..sets as usize];
            let mean = sets.iter().map(|x| f64::from(*x)).sum::<f64>() / s;
            sets.iter().map(|x| (f64::from(*x) - mean).powi(2)).sum::<f64>() / (s * (s - 1.0))
        };
        of_photons + self.sparse_square + of_eye
    }

    /// What the bandwidths say of the bias.
    fn bias(&self) -> f64 {
        self.difference.abs() * BIAS_PER_DIFFERENCE + self.further_bias
    }

    fn scale(&mut self, factor: f64) {
        self.value = self.value.map(|v| v * factor);
        self.by_set = self.by_set.map(|v| (f64::from(v) * factor) as f32);
        self.open = self.open.map(|v| v * factor);
        for sum in [&mut self.difference, &mut self.further_bias, &mut self.photons] {
            *sum *= factor;
        }
        for square in [&mut self.photons_square, &mut self.sparse_square] {
            *square *= factor * factor;
        }
    }
}

/// A picture in the making: passes add to it ([`crate::picture::camera::render()`]), [`Self::finish`] makes the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Sums<const C: usize> {
    pixels: [u32; 2],
    /// Tile by tile, each row by row; tiles at the right and lower end are whole, too.
    pub(crate) tiles: Vec<PixelSums<C>>,
    /// Replicates whose photons are all in.
    pub(crate) replicates: u32,
    /// Sets of samples that there are.
    pub(crate) sets: u32,
}

impl<const C: usize> Sums<C> {
    /// Nothing yet, of so many columns and rows.
    ///
    /// # Errors
    /// Those of [`Film::check_memory`].
    pub fn new(pixels: [u32; 2]) -> Result<Self> {
        Film::<C>::check_memory(pixels)?;
        let [across, down] = pixels.map(|n| n.div_ceil(TILE) as usize);
        let tiles = vec![PixelSums::NOTHING; across * down * TILE_PIXELS];
        Ok(Self { pixels, tiles, replicates: 0, sets: 0 })
    }

    /// Columns and rows.
    pub fn pixels(&self) -> [u32; 2] {
        self.pixels
    }

    /// Replicates whose photons are all in.
    pub fn replicates(&self) -> u32 {
        self.replicates
    }

    /// Takes everything so far for this many times as bright: photons, where a run ended with fewer than it was to have.
    pub fn scale(&mut self, factor: f64) {
        self.tiles.iter_mut().for_each(|sums| sums.scale(factor));
    }

    /// Takes back what the parts of a replicate that is not finished made of the picture: they are of a part of the emitters'
    /// directions, not a sample of them.
    pub fn drop_unfinished(&mut self) {
        for sums in &mut self.tiles {
            let open = std::mem::replace(&mut sums.open, [0.0; C]);
            (0..C).for_each(|c| sums.value[c] -= open[c]);
        }
    }

    /// Column and row of the first pixel of a tile.
    pub(crate) fn corner(pixels: [u32; 2], tile: usize) -> [u32; 2] {
        let across = pixels[0].div_ceil(TILE) as usize;
        [(tile % across) as u32 * TILE, (tile / across) as u32 * TILE]
    }

    fn at(&self, column: u32, row: u32) -> &PixelSums<C> {
        let across = self.pixels[0].div_ceil(TILE);
        let tile = (row / TILE * across + column / TILE) as usize;
        &self.tiles[tile * TILE_PIXELS + (row % TILE * TILE + column % TILE) as usize]
    }

    /// Estimated size of the bias of a pixel's luminance, cd/m2: the mean of what the two bandwidths say of the 3 x 3 pixels about
    /// it. A pixel's own says nothing where the difference of the bandwidths changes its sign, and has more noise.
    fn bias(&self, column: u32, row: u32) -> f64 {
        let own = self.at(column, row).bias();
        if own.is_nan() {
            return own;
        }
        let about = |at: u32, of: u32| at.saturating_sub(1)..of.min(at + 2);
        let (mut sum, mut number) = (0.0, 0.0);
        for row in about(row, self.pixels[1]) {
            for column in about(column, self.pixels[0]) {
                let bias = self.at(column, row).bias();
                // What an interrupt left unseen says nothing.
                if bias.is_finite() {
                    sum += bias;
                    number += 1.0;
                }
            }
        }
        sum / number
    }

    /// The picture of all passes so far.
    ///
    /// Standard error^2 = spread of the replicates' sums + spread of the sets of samples: that of the photons for these samples,
    /// and that of the samples for these photons. Where there is hardly a photon the densities say what they owe.
    pub fn finish(&self) -> Film<C> {
        let [columns, rows] = self.pixels;
        let number = columns as usize * rows as usize;
        let mut film = Film {
            pixels: self.pixels,
            value: Vec::with_capacity(number),
            standard_error: Vec::with_capacity(number),
            bias: Vec::with_capacity(number),
        };
        for row in 0..rows {
            for column in 0..columns {
                let sums = self.at(column, row);
                film.value.push(sums.value);
                film.standard_error.push(sums.variance(self.replicates, self.sets).sqrt());
                film.bias.push(self.bias(column, row));
            }
        }
        film
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_told_before_it_is_taken() {
        assert!(Sums::<1>::new([1, 1]).is_ok());
        assert!(Sums::<3>::new([1920, 1080]).is_ok());
        for pixels in [[8192, 8192], [u32::MAX, u32::MAX], [0, 5]] {
            let error = Sums::<3>::new(pixels).unwrap_err();
            assert_eq!(error.kind(), Kind::Limit);
        }
        assert!(Sums::<1>::new([8192, 8192]).unwrap_err().to_string().contains("MiB"));
    }

    #[test]
    fn a_pixel_s_bias_is_the_mean_of_what_the_nine_about_it_say() {
        let mut sums = Sums::<1>::new([3, 2]).unwrap();
        for (row, differences) in [[1.0, -2.0, 0.0], [0.5, 0.0, 4.0]].into_iter().enumerate() {
            for (column, difference) in differences.into_iter().enumerate() {
                sums.tiles[row * TILE as usize + column].difference = difference;
            }
        }
        sums.tiles[TILE as usize + 1].further_bias = 0.25;
        let of = |difference: f64, number: f64| (difference * BIAS_PER_DIFFERENCE + 0.25) / number;
        // At either side four count, in the middle all six.
        let [left, middle, right] = [of(3.5, 4.0), of(7.5, 6.0), of(6.0, 4.0)];
        let exact = [left, middle, right, left, middle, right];
        let bias = sums.finish().bias;
        assert!(
            bias.iter().zip(exact).all(|(b, exact)| (b / exact - 1.0).abs() < 1e-14),
            "{bias:?} {exact:?}"
        );
        sums.tiles[0] = PixelSums::UNSEEN;
        let unseen = sums.finish().bias;
        assert!(unseen[0].is_nan() && (unseen[3] / of(2.5, 3.0) - 1.0).abs() < 1e-14, "{unseen:?}");
    }

    #[test]
    fn the_error_is_that_of_replicates_and_of_sets() {
        let mut sums = PixelSums::<1>::NOTHING;
        sums.add_part([1.0]);
        for rest in [2.0, 5.0, 4.0] {
            sums.add_replicate(rest);
        }
        sums.by_set = [11.0, 12.0, 13.0, 12.0];
        // Sum of three with variance 1: 3. Mean of four with variance 2/3: 1/6.
        assert!((sums.variance(3, 4) - (3.0 + 1.0 / 6.0)).abs() < 1e-14);
        assert!(sums.variance(1, 4).is_nan() && sums.variance(3, 1).is_nan());
        assert_eq!(PixelSums::<1>::NOTHING.variance(0, 4), 0.0);
        let mut only_open = PixelSums::<1>::NOTHING;
        only_open.add_part([0.5]);
        assert!(only_open.variance(0, 4).is_nan() && PixelSums::<1>::UNSEEN.variance(3, 4).is_nan());
        sums.sparse_square = 1.0;
        let before = sums.variance(3, 4);
        sums.scale(2.0);
        assert!((sums.variance(3, 4) - 4.0 * before).abs() < 1e-13);
    }
}
