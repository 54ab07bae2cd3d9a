//! Grey pictures as PNG.

use png::{BitDepth, ColorType, Encoder};

/// A picture of 8 bits a pixel, rows from the top.
pub fn grey_8(size: [u32; 2], pixels: &[u8]) -> Vec<u8> {
    grey(size, BitDepth::Eight, pixels)
}

/// One of 16 bits a pixel.
pub fn grey_16(size: [u32; 2], pixels: &[u16]) -> Vec<u8> {
    let bytes: Vec<u8> = pixels.iter().flat_map(|p| p.to_be_bytes()).collect();
    grey(size, BitDepth::Sixteen, &bytes)
}

fn grey(size: [u32; 2], depth: BitDepth, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    bytes
}
