//! Pixels: luminance, standard error, bias; and the sums that they come from.

use std::io::{self, Read, Write};

use crate::error::{Diagnostic, Kind, Result};
use crate::math::varint::{expect, put, put_reals, take_up_to};

use super::pixel::{PixelSums, SETS};

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

/// A picture in the making: passes add to it ([`crate::picture::camera::render()`]), [`Self::finish`] makes
/// the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Sums<const C: usize> {
    /// Columns and rows.
    pub pixels: [u32; 2],
    /// Tile by tile, each row by row; tiles at the right and lower end are whole, too.
    pub(crate) tiles: Vec<PixelSums<C>>,
    /// Replicates whose photons are all in.
    pub replicates: u32,
    /// Sets of samples that there are.
    pub(crate) sets: u32,
}

impl<const C: usize> Sums<C> {
    /// Nothing yet, of so many columns and rows.
    ///
    /// # Errors
    /// One that takes more than [`MOST_PICTURE_BYTES`].
    pub fn new(pixels: [u32; 2]) -> Result<Self> {
        check_memory(pixels, Film::<C>::memory_bytes(pixels))?;
        let [across, down] = pixels.map(|n| n.div_ceil(TILE) as usize);
        let tiles = vec![PixelSums::NOTHING; across * down * TILE_PIXELS];
        Ok(Self { pixels, tiles, replicates: 0, sets: 0 })
    }

    /// Tiles that there are.
    pub fn tile_count(&self) -> usize {
        self.tiles.len() / TILE_PIXELS
    }

    /// Writes the sums, to the bit.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        put(out, [self.tiles.len() as u64, self.replicates.into(), self.sets.into()])?;
        for tile in self.tiles.chunks(TILE_PIXELS) {
            put_reals(out, tile.iter().flat_map(PixelSums::numbers))?;
        }
        Ok(())
    }

    /// Takes sums that were written in the place of these.
    ///
    /// # Errors
    /// Those of the reader; sums of another picture.
    pub fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        expect(from, self.tiles.len() as u64, "pixels")?;
        self.replicates = take_up_to(from, u32::MAX.into(), "replicates")? as u32;
        self.sets = take_up_to(from, SETS.into(), "sets of samples")? as u32;
        self.tiles.iter_mut().try_for_each(|sums| PixelSums::read(from).map(|read| *sums = read))
    }

    /// Takes everything so far for this many times as bright: photons, where a run ended with fewer than it
    /// was to have.
    pub fn scale(&mut self, factor: f64) {
        self.tiles.iter_mut().for_each(|sums| sums.scale(factor));
    }

    /// Takes back what the parts of a replicate that is not finished made of the picture: they are of a part
    /// of the emitters' directions, not a sample of them.
    pub fn drop_unfinished(&mut self) {
        for sums in &mut self.tiles {
            let open = sums.error.take_open();
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

    /// Estimated size of the bias of a pixel's luminance, cd/m2: the mean of what the two bandwidths say of
    /// the 3 x 3 pixels about it. A pixel's own says nothing where the difference of the bandwidths changes
    /// its sign, and has more noise.
    fn bias(&self, column: u32, row: u32) -> f64 {
        let own = self.at(column, row).error.bias();
        if own.is_nan() {
            return own;
        }
        let about = |at: u32, of: u32| at.saturating_sub(1)..of.min(at + 2);
        let (mut sum, mut number) = (0.0, 0.0);
        for row in about(row, self.pixels[1]) {
            for column in about(column, self.pixels[0]) {
                let bias = self.at(column, row).error.bias();
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
    use crate::picture::gather::{BIAS_PER_DIFFERENCE, Gathered};

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
                sums.tiles[row * TILE as usize + column].error.difference = difference;
            }
        }
        sums.tiles[TILE as usize + 1].error.nearest_bias = 0.25;
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
    fn tiles_become_rows_and_unfinished_light_is_taken_back() {
        let pixels = [40, 20];
        let mut sums = Sums::<3>::new(pixels).unwrap();
        for (i, pixel) in sums.tiles.iter_mut().enumerate() {
            let corner = Sums::<3>::corner(pixels, i / TILE_PIXELS);
            let k = (i % TILE_PIXELS) as u32;
            let [column, row] = [corner[0] + k % TILE, corner[1] + k / TILE];
            pixel.value = [f64::from(1000 * row + column), 1.0, 2.0];
            let mut part = Gathered::new(1);
            part.value = [0.5, 0.25, 0.125];
            pixel.error.add(&part, 2.0, 0..1, false);
        }
        let value = |film: &Film<3>, [column, row]: [u32; 2]| film.value[(row * 40 + column) as usize];
        let film = sums.finish();
        assert_eq!(film.value.len(), 800);
        for [column, row] in [[0, 0], [15, 15], [16, 0], [39, 19], [17, 16], [0, 16]] {
            assert_eq!(value(&film, [column, row])[0], f64::from(1000 * row + column));
        }
        sums.drop_unfinished();
        assert_eq!(value(&sums.finish(), [3, 2]), [2003.0 - 1.0, 0.5, 1.75]);
        sums.drop_unfinished();
        sums.scale(2.0);
        assert_eq!(value(&sums.finish(), [3, 2]), [4004.0, 1.0, 3.5]);
    }
}
