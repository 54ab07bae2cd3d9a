//! PNG files of 8-bit sRGB.

use std::io;
use std::path::Path;

use ::image::codecs::png::PngEncoder;
use ::image::{ExtendedColorType, ImageEncoder};

use crate::error::Result;
use crate::files::atomic::write_atomically;

/// Writes `width` x `height` pixels of red, green and blue, rows from the top; the same pixels give the same bytes.
///
/// # Errors
/// [`crate::error::Kind::Io`] with the path, also where the bytes are not those of so many pixels; an older file of that
/// name then stands as it was.
pub fn write_rgb8(path: impl AsRef<Path>, width: usize, height: usize, bytes: &[u8]) -> Result<()> {
    write_atomically(path, |writer| {
        let too_wide = |_| io::Error::other("the picture is too large for a PNG");
        let width = u32::try_from(width).map_err(too_wide)?;
        let height = u32::try_from(height).map_err(too_wide)?;
        if bytes.len() as u64 != 3 * u64::from(width) * u64::from(height) {
            return Err(io::Error::other("the picture's bytes do not fit its sides"));
        }
        PngEncoder::new(writer)
            .write_image(bytes, width, height, ExtendedColorType::Rgb8)
            .map_err(io::Error::other)
    })
}
