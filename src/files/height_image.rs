//! Heights from a grey picture.

use std::io::Cursor;

use image::{ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::HeightImage;

/// Most pixels of a picture.
const MOST_PIXELS: u64 = 1 << 26;

/// Heights from the bytes of a PNG of 8 or 16 bits: black is `low_m`, white `high_m` (m); colours count by their luma.
///
/// # Errors
/// Bytes that are no PNG, or one of more than 2^26 pixels. The diagnostic does not name the file.
pub fn parse(bytes: &[u8], [low_m, high_m]: [f64; 2]) -> Result<HeightImage> {
    let no_png = |e: ImageError| {
        Diagnostic::new(Kind::Syntax, format!("no readable PNG: {e}"), "a PNG of 8 or 16 bits")
    };
    let reader = || ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    // The size is asked for before anything is decoded.
    let (width, height) = reader().into_dimensions().map_err(no_png)?;
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        let found = format!("{width} x {height} pixels");
        return Err(Diagnostic::new(Kind::Limit, found, format!("at most {MOST_PIXELS} pixels")));
    }
    let mut reader = reader();
    let mut limits = Limits::default();
    limits.max_alloc = Some(16 * MOST_PIXELS);
    reader.limits(limits);
    let grey = reader.decode().map_err(no_png)?.into_luma16();
    let height_m = |&g: &u16| low_m + (high_m - low_m) * (f64::from(g) / 65535.0);
    Ok(HeightImage::new(width as usize, height as usize, grey.as_raw().iter().map(height_m).collect())?)
}

/// Whether a PNG holds its heights in 8 bits or fewer.
pub fn has_8_bits(bytes: &[u8]) -> bool {
    let decoder = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png).into_decoder();
    decoder.is_ok_and(|decoder| {
        let colour = decoder.color_type();
        colour.bytes_per_pixel() == colour.channel_count()
    })
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn pictures_of_8_and_16_bits_are_read_and_damaged_ones_refused() {
        let png = |picture: image::DynamicImage| {
            let mut bytes = Cursor::new(Vec::new());
            picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
            bytes.into_inner()
        };
        let grey = image::GrayImage::from_raw(3, 2, vec![0, 51, 255, 0, 0, 102]).unwrap();
        let h = parse(&png(grey.into()), [1.0, 2.0]).unwrap();
        assert_eq!(h.size(), [3, 2]);
        assert!((h.height_m(DVec2::new(0.5, 1.0)) - 1.2).abs() < 1e-15);
        assert!((h.height_m(DVec2::new(1.0, 0.0)) - 1.4).abs() < 1e-15);
        type Grey16 = image::ImageBuffer<image::Luma<u16>, Vec<u16>>;
        let bytes = png(Grey16::from_raw(2, 2, vec![0, 1, 2, 65535]).unwrap().into());
        let h = parse(&bytes, [0.0, 65.535]).unwrap();
        assert!((h.height_m(DVec2::new(1.0, 1.0)) - 0.001).abs() < 1e-15);
        for cut in 0..bytes.len() - 12 {
            assert_eq!(parse(&bytes[..cut], [0.0, 1.0]).unwrap_err().kind(), Kind::Syntax);
        }
    }
}
