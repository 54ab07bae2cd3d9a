//! Heights from a grey picture.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, DecodingError, Limits, Transformations};

use crate::error::words::limit;
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::HeightImage;

/// Most pixels of a picture.
pub const MOST_PIXELS: u64 = 1 << 26;

/// Luminances of the primaries of sRGB (IEC 61966-2-1): what red, green and blue count in a luma.
const LUMA: [f32; 3] = [0.21264784, 0.7151792, 0.07217304];

/// Columns and rows that the head of a PNG tells.
///
/// # Errors
/// Bytes that are no PNG. The diagnostic does not name the file.
pub fn size(bytes: &[u8]) -> Result<[u64; 2]> {
    let (width, height) = Decoder::new(Cursor::new(bytes)).read_header_info().map_err(no_png)?.size();
    Ok([width.into(), height.into()])
}

fn no_png(e: DecodingError) -> Diagnostic {
    Diagnostic::new(Kind::Syntax, format!("no readable PNG: {e}"), "a PNG of 8 or 16 bits")
}

/// Heights from the bytes of a PNG of 8 or 16 bits: black is `low_m`, white `high_m` (m); colours count by their luma.
///
/// # Errors
/// Bytes that are no PNG, or one of more than 2^26 pixels. The diagnostic does not name the file.
pub fn parse(bytes: &[u8], [low_m, high_m]: [f64; 2]) -> Result<HeightImage> {
    let mut decoder =
        Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: 16 * MOST_PIXELS as usize });
    // The size is asked for before anything is decoded.
    let (width, height) = decoder.read_header_info().map_err(no_png)?.size();
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        let found = format!("{width} x {height} pixels");
        return Err(Diagnostic::new(Kind::Limit, found, format!("at most {} pixels", limit(MOST_PIXELS))));
    }
    // Palettes become colours, and samples of 1, 2 or 4 bits bytes.
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(no_png)?;
    let size = reader.output_buffer_size().ok_or(DecodingError::LimitsExceeded).map_err(no_png)?;
    let mut samples = vec![0; size];
    reader.next_frame(&mut samples).map_err(no_png)?;
    let (colour, depth) = reader.output_color_type();
    let sample_bytes = if depth == BitDepth::Sixteen { 2 } else { 1 };
    let grey = |pixel: &[u8]| match colour {
        ColorType::Rgb | ColorType::Rgba => luma(pixel.chunks_exact(sample_bytes).map(share)),
        _ => of_65535(&pixel[..sample_bytes]),
    };
    let pixels = samples.chunks_exact(sample_bytes * colour.samples());
    let height_m = |pixel| low_m + (high_m - low_m) * (f64::from(grey(pixel)) / 65535.0);
    Ok(HeightImage::new(width as usize, height as usize, pixels.map(height_m).collect())?)
}

/// A sample of one byte or two as a share of 65535: a byte twice, since 65535 = 255 * 257.
fn of_65535(sample: &[u8]) -> u16 {
    u16::from_be_bytes([sample[0], sample[sample.len() - 1]])
}

/// The same, as a share of 1.
fn share(sample: &[u8]) -> f32 {
    match *sample {
        [byte] => f32::from(byte) * (1.0 / 255.0),
        _ => f32::from(of_65535(sample)) * (1.0 / 65535.0),
    }
}

/// The luma of red, green and blue (what follows them does not count), as a share of 65535.
fn luma(rgb: impl Iterator<Item = f32>) -> u16 {
    (rgb.zip(LUMA).fold(0.0, |sum, (share, weight)| sum + share * weight) * 65535.0).round() as u16
}

/// Whether a PNG holds its heights in 8 bits or fewer.
pub fn has_8_bits(bytes: &[u8]) -> bool {
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.read_header_info().is_ok_and(|info| info.bit_depth != BitDepth::Sixteen)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    fn png(size: [u32; 2], colour: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        if colour == ColorType::Indexed {
            encoder.set_palette(&[0, 0, 0, 255, 255, 255][..]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    #[test]
    fn pictures_of_8_and_16_bits_are_read_and_damaged_ones_refused() {
        let bytes = png([3, 2], ColorType::Grayscale, BitDepth::Eight, &[0, 51, 255, 0, 0, 102]);
        let h = parse(&bytes, [1.0, 2.0]).unwrap();
        assert!(has_8_bits(&bytes));
        assert_eq!(h.size(), [3, 2]);
        assert!((h.height_m(DVec2::new(0.5, 1.0)) - 1.2).abs() < 1e-15);
        assert!((h.height_m(DVec2::new(1.0, 0.0)) - 1.4).abs() < 1e-15);
        let bytes = png([2, 2], ColorType::Grayscale, BitDepth::Sixteen, &[0, 0, 0, 1, 0, 2, 255, 255]);
        let h = parse(&bytes, [0.0, 65.535]).unwrap();
        assert!(!has_8_bits(&bytes));
        assert!((h.height_m(DVec2::new(1.0, 1.0)) - 0.001).abs() < 1e-15);
        for cut in 0..bytes.len() - 12 {
            assert_eq!(parse(&bytes[..cut], [0.0, 1.0]).unwrap_err().kind(), Kind::Syntax);
        }
    }

    #[test]
    fn colours_count_by_their_luma_whatever_the_samples() {
        use BitDepth::{Eight, One, Sixteen};
        use ColorType::{GrayscaleAlpha, Indexed, Rgb, Rgba};
        let heights = |colour, depth, data: &[u8]| {
            // Two rows alike.
            let h = parse(&png([2, 2], colour, depth, &[data, data].concat()), [0.0, 1.0]).unwrap();
            [0.0, 1.0].map(|u| h.height_m(DVec2::new(u, 0.5)))
        };
        // Red and half of green with blue, by the weights of IEC 61966-2-1 as it rounds them: 0.2126, 0.7152, 0.0722.
        let luma = [0.2126, (0.7152 * 128.0 + 0.0722 * 255.0) / 255.0];
        for [got, wanted] in [
            heights(Rgb, Eight, &[255, 0, 0, 0, 128, 255]),
            heights(Rgba, Eight, &[255, 0, 0, 9, 0, 128, 255, 0]),
            heights(Rgb, Sixteen, &[255, 255, 0, 0, 0, 0, 0, 0, 128, 128, 255, 255]),
        ]
        .into_iter()
        .flat_map(|h| [[h[0], luma[0]], [h[1], luma[1]]])
        {
            assert!((got - wanted).abs() < 1e-4, "{got} for {wanted}");
        }
        // Opacity does not count, and a palette is its colours: white, then black.
        assert_eq!(heights(GrayscaleAlpha, Eight, &[51, 0, 102, 255]), [0.2, 0.4]);
        let [white, black] = heights(Indexed, One, &[0b1000_0000]);
        assert!((white - 1.0).abs() < 1e-4 && black == 0.0, "{white}");
    }
}
