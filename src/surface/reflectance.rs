//! The reflected part of the flux, in one channel or three.
//!
//! Scene text: `reflectance = 0.7`, or `reflectance = [r, g, b]`, each 0 to 1.

use crate::units::LUMINANCE_OF_RGB;

/// Parts of the flux that are reflected, by channel, and the part of white light's luminous flux that they make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflectance {
    luminous: f64,
    rgb: [f64; 3],
}

impl Reflectance {
    /// The same part of every channel, 0 to 1.
    pub const fn grey(part: f64) -> Self {
        Self { luminous: part, rgb: [part; 3] }
    }

    /// Parts of red, green and blue, each 0 to 1.
    pub fn rgb([r, g, b]: [f64; 3]) -> Self {
        if r == g && g == b {
            return Self::grey(r); // The sum below would round.
        }
        Self { luminous: luminance([r, g, b]), rgb: [r, g, b] }
    }

    /// Part of the luminous flux of white light.
    #[inline]
    pub const fn luminous(&self) -> f64 {
        self.luminous
    }

    /// Parts by channel.
    #[inline]
    pub const fn by_channel(&self) -> [f64; 3] {
        self.rgb
    }

    /// Whether channels differ.
    pub fn is_coloured(&self) -> bool {
        self.rgb[0] != self.rgb[1] || self.rgb[1] != self.rgb[2]
    }
}

/// 0.2126 R + 0.7152 G + 0.0722 B.
#[inline]
pub fn luminance(rgb: [f64; 3]) -> f64 {
    LUMINANCE_OF_RGB[0] * rgb[0] + LUMINANCE_OF_RGB[1] * rgb[1] + LUMINANCE_OF_RGB[2] * rgb[2]
}

/// The same of a light in one channel, which is its luminance, or in three of linear sRGB.
#[inline(always)]
pub fn luminance_of<const C: usize>(channels: &[f64; C]) -> f64 {
    match channels.as_slice() {
        &[r, g, b] => luminance([r, g, b]),
        one => one[0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_channels_are_grey_to_the_last_bit() {
        for part in [0.0, 0.1, 0.7, 1.0] {
            let r = Reflectance::rgb([part; 3]);
            assert_eq!(r, Reflectance::grey(part));
            assert_eq!(r.luminous(), part);
            assert!(!r.is_coloured());
        }
    }

    #[test]
    fn green_is_brightest() {
        let part = |rgb| Reflectance::rgb(rgb).luminous();
        assert_eq!(part([0.0, 1.0, 0.0]), 0.7152);
        assert_eq!(part([1.0, 0.0, 0.0]), 0.2126);
        assert_eq!(part([0.0, 0.0, 1.0]), 0.0722);
        assert!((luminance([1.0; 3]) - 1.0).abs() <= f64::EPSILON);
        assert!(Reflectance::rgb([0.5, 0.5, 0.4]).is_coloured());
    }
}
