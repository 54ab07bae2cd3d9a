//! PNG files of 8-bit sRGB.

use std::io;
use std::path::Path;

use ::png::{BitDepth, ColorType, Compression, Encoder, Filter};

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
        let mut encoder = Encoder::new(writer, width, height);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Fast);
        encoder.set_filter(Filter::Adaptive);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes)?;
        Ok(writer.finish()?)
    })
}

/// Width, height and pixels of a file of 8-bit sRGB.
#[cfg(test)]
pub fn read_rgb8(path: &Path) -> ([usize; 2], Vec<u8>) {
    let file = io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = ::png::Decoder::new(file).read_info().unwrap();
    assert_eq!(reader.output_color_type(), (ColorType::Rgb, BitDepth::Eight));
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    let (width, height) = reader.info().size();
    ([width as usize, height as usize], bytes)
}
