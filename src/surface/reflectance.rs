//! The reflected part of the flux, in one channel or three.
//!
//! Scene text: `reflectance = 0.7`, or `reflectance = [r, g, b]`, each 0 to 1.

use crate::error::Invalid;
use crate::error::invalid::Interval;
use crate::units::LUMINANCE_OF_RGB;

/// Parts of the flux that are reflected, by channel, and the part of white light's luminous flux that they
/// make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reflectance {
    luminous: f64,
    rgb: [f64; 3],
}

/// Reflected parts.
pub const REFLECTANCE: Interval = Interval { low: 0.0, high: 1.0, words: "a reflectance from 0 to 1" };

impl Reflectance {
    /// The same part of every channel.
    ///
    /// # Errors
    /// A part that is not from 0 to 1.
    pub fn new(part: f64) -> Result<Self, Invalid> {
        Self::rgb([part; 3])
    }

    /// Parts of red, green and blue.
    ///
    /// # Errors
    /// Parts that are not from 0 to 1.
    pub fn rgb(rgb: [f64; 3]) -> Result<Self, Invalid> {
        Self::named("reflectance", rgb, &REFLECTANCE)
    }

    /// Those of a parameter of another name.
    pub(super) fn named(what: &'static str, rgb: [f64; 3], range: &Interval) -> Result<Self, Invalid> {
        for part in rgb {
            range.check(what, part)?;
        }
        let [r, g, b] = rgb;
        // The sum would round.
        let luminous = if r == g && g == b { r } else { luminance(rgb) };
        Ok(Self { luminous, rgb })
    }

    /// The albedo of a table, which was checked when the table was laid out.
    #[inline]
    pub(super) fn of_table(albedo: f64) -> Self {
        Self { luminous: albedo, rgb: [albedo; 3] }
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
            let r = Reflectance::rgb([part; 3]).unwrap();
            assert_eq!(r, Reflectance::of_table(part));
            assert_eq!(r.luminous(), part);
            assert!(!r.is_coloured());
        }
    }

    #[test]
    fn green_is_brightest() {
        let part = |rgb| Reflectance::rgb(rgb).unwrap().luminous();
        assert_eq!(part([0.0, 1.0, 0.0]), 0.7152);
        assert_eq!(part([1.0, 0.0, 0.0]), 0.2126);
        assert_eq!(part([0.0, 0.0, 1.0]), 0.0722);
        assert!((luminance([1.0; 3]) - 1.0).abs() <= f64::EPSILON);
        assert!(Reflectance::rgb([0.5, 0.5, 0.4]).unwrap().is_coloured());
    }

    #[test]
    fn what_is_no_part_of_a_flux_is_refused() {
        for part in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, -1e-300, 1.0 + f64::EPSILON, 1e300] {
            assert!(Reflectance::new(part).is_err(), "{part}");
            for channel in 0..3 {
                let mut rgb = [0.5; 3];
                rgb[channel] = part;
                let refused = Reflectance::rgb(rgb).unwrap_err();
                assert!(
                    matches!(refused, Invalid::Number { what: "reflectance", value, .. } if !(value == 0.5))
                );
            }
        }
        assert!(
            Reflectance::new(0.0).is_ok() && Reflectance::new(1.0).is_ok() && Reflectance::new(-0.0).is_ok()
        );
    }
}
