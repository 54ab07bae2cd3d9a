//! Colours of numbers, as plain mathematics: sRGB, the false colours, scales with round marks, exposure of a picture.

pub mod map;
pub mod scale;
pub mod tone;

use std::sync::OnceLock;

/// A colour in linear light, sRGB primaries, nominally 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Colour(pub [f32; 3]);

impl Colour {
    /// White.
    pub const WHITE: Self = Self([1.0; 3]);
    /// Black.
    pub const BLACK: Self = Self([0.0; 3]);

    /// The colour of an 8-bit sRGB triple.
    pub fn srgb(red: u8, green: u8, blue: u8) -> Self {
        Self([red, green, blue].map(|c| srgb_to_linear(f64::from(c) / 255.0) as f32))
    }

    /// A grey of this 8-bit sRGB value.
    pub fn grey(value: u8) -> Self {
        Self::srgb(value, value, value)
    }

    /// The nearest 8-bit sRGB triple.
    pub fn to_srgb(self) -> [u8; 3] {
        self.0.map(encode)
    }
}

/// sRGB transfer function, IEC 61966-2-1: encoded value to linear light.
fn srgb_to_linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// 8-bit code of a linear value: the number of code boundaries at or below it.
fn encode(linear: f32) -> u8 {
    static BOUNDARIES: OnceLock<[f32; 255]> = OnceLock::new();
    let boundaries =
        BOUNDARIES.get_or_init(|| std::array::from_fn(|i| srgb_to_linear((i as f64 + 0.5) / 255.0) as f32));
    boundaries.partition_point(|&boundary| boundary <= linear) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_round_trip_and_are_nearest() {
        for code in 0..=255 {
            assert_eq!(Colour::grey(code).to_srgb(), [code; 3]);
        }
        // IEC 61966-2-1: linear 0.5 is 187.516 of 255, linear 0.0031308 is 10.31.
        assert_eq!(encode(0.5), 188);
        assert_eq!(encode(0.003_130_8), 10);
        assert_eq!((encode(-1.0), encode(2.0), encode(f32::NAN)), (0, 255, 0));
    }
}
