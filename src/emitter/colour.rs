//! The colour of light: linear sRGB (primaries of ITU-R BT.709) of luminance 1.
//!
//! A colour says in which proportions the channels share the luminous flux that an emitter's flux in lumens stands for, so its
//! luminance is 1 whatever it is: a red lamp of 100 lm and a blue one of 100 lm give the same lux.

use crate::error::Invalid;
use crate::error::invalid::Interval;
use crate::surface::luminance;

/// Temperatures of a black body, K: the range that Krystek states.
pub const CCT_K: Interval =
    Interval { low: 1000.0, high: 15_000.0, words: "a colour temperature from 1000 to 15000 K" };

/// Parts of light, in any one unit.
pub const CHANNEL: Interval = Interval { low: 0.0, high: 1e9, words: "a part of light from 0 to 1e9" };

/// CIE 1931 XYZ to linear sRGB: the inverse of the matrix of BT.709's primaries and D65, (0.3127, 0.3290).
const RGB_OF_XYZ: [[f64; 3]; 3] = [
    [3.240_969_941_904_521, -1.537_383_177_570_093, -0.498_610_760_293_003],
    [-0.969_243_636_280_880, 1.875_967_501_507_721, 0.041_555_057_407_176],
    [0.055_630_079_696_993, -0.203_976_958_888_977, 1.056_971_514_242_879],
];

/// The colour of an emitter's light, with luminance 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Colour([f64; 3]);

impl Default for Colour {
    fn default() -> Self {
        Self::WHITE
    }
}

impl Colour {
    /// The channels alike, which is D65.
    pub const WHITE: Self = Self([1.0; 3]);

    /// The colour of these parts of light, in any one unit.
    ///
    /// # Errors
    /// A part that is negative, beyond 1e9 or not a number; black.
    pub fn new(rgb: [f64; 3]) -> Result<Self, Invalid> {
        for part in rgb {
            CHANNEL.check("colour", part)?;
        }
        let largest = rgb.into_iter().fold(0.0, f64::max);
        if largest == 0.0 {
            return Err(Invalid::Content {
                what: "colour",
                found: "colour = [0, 0, 0]".into(),
                required: "a colour that is not black: flux_lm says how bright it is".into(),
            });
        }
        if rgb == [rgb[0]; 3] {
            return Ok(Self::WHITE); // The sum below would round.
        }
        let scaled = rgb.map(|c| c / largest);
        let y = luminance(scaled);
        Ok(Self(scaled.map(|c| c / y)))
    }

    /// The colour of a black body of this temperature, and whether a channel was negative (blue below about 1900 K, which no
    /// sRGB colour is as red as) and is 0 instead.
    ///
    /// # Errors
    /// A temperature outside `CCT_K`.
    pub fn black_body(cct_k: f64) -> Result<(Self, bool), Invalid> {
        CCT_K.check("cct_k", cct_k)?;
        let [x, y] = planckian_xy(cct_k);
        let xyz = [x / y, 1.0, (1.0 - x - y) / y];
        let rgb = RGB_OF_XYZ.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]);
        let clipped = rgb.iter().any(|c| *c < 0.0);
        Ok((Self::new(rgb.map(|c| c.max(0.0)))?, clipped))
    }

    /// Linear sRGB.
    #[inline]
    pub const fn channels(self) -> [f64; 3] {
        self.0
    }
}

/// Chromaticity CIE 1931 (x, y) of a black body of this temperature, [`CCT_K`]: Krystek, "An algorithm to calculate
/// correlated colour temperature", Color Research and Application 10(1), 1985, 38-40. It stays within 0.0005 of the integral of
/// Planck's law over the CIE's table.
fn planckian_xy(cct_k: f64) -> [f64; 2] {
    let t = cct_k;
    let u = (0.860_117_757 + 1.541_182_54e-4 * t + 1.286_412_12e-7 * t * t)
        / (1.0 + 8.424_202_35e-4 * t + 7.081_451_63e-7 * t * t);
    let v = (0.317_398_726 + 4.228_062_45e-5 * t + 4.204_816_91e-8 * t * t)
        / (1.0 - 2.897_418_16e-5 * t + 1.614_560_53e-7 * t * t);
    // CIE 1960 (u, v) to (x, y).
    let scale = 2.0 * u - 8.0 * v + 4.0;
    [3.0 * u / scale, 2.0 * v / scale]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_bodies_have_the_chromaticities_of_the_cie_s_table() {
        // Planck's law with c2 = 1.438776877e-2 m K, summed over the CIE 1931 2 degree observer at 1 nm, 360 to 830 nm;
        // 2855.5 K is illuminant A: (0.44757, 0.40744), ISO 11664-2.
        for (cct_k, x, y) in [
            (1000.0, 0.65275, 0.34446),
            (1500.0, 0.58572, 0.39312),
            (2700.0, 0.45986, 0.41060),
            (2855.5, 0.44757, 0.40744),
            (4000.0, 0.38044, 0.37675),
            (6500.0, 0.31353, 0.32363),
            (10_000.0, 0.28063, 0.28829),
            (15_000.0, 0.26371, 0.26728),
        ] {
            let [a, b] = planckian_xy(cct_k);
            assert!((a - x).hypot(b - y) < 5e-4, "{cct_k} K: {a} {b}");
        }
    }

    #[test]
    fn xyz_of_white_and_of_the_primaries() {
        let rgb = |x: f64, y: f64| {
            let xyz = [x / y, 1.0, (1.0 - x - y) / y];
            RGB_OF_XYZ.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
        };
        for c in rgb(0.3127, 0.3290) {
            assert!((c - 1.0).abs() < 1e-4, "{c}");
        }
        for (channel, x, y) in [(0, 0.64, 0.33), (1, 0.30, 0.60), (2, 0.15, 0.06)] {
            let c = rgb(x, y);
            let expected = 1.0 / crate::units::LUMINANCE_OF_RGB[channel];
            for (k, value) in c.into_iter().enumerate() {
                let wanted = if k == channel { expected } else { 0.0 };
                assert!((value - wanted).abs() < 2e-3 * expected, "{x} {y}: {c:?}");
            }
        }
    }

    #[test]
    fn colours_have_luminance_one_and_warm_light_is_warm() {
        for cct_k in [1000.0, 1800.0, 2700.0, 6500.0, 15_000.0] {
            let (colour, clipped) = Colour::black_body(cct_k).unwrap();
            let rgb = colour.channels();
            assert!((luminance(rgb) - 1.0).abs() < 1e-14);
            assert_eq!(clipped, cct_k < 1900.0, "{cct_k} K: {rgb:?}");
        }
        let rgb = |cct_k| Colour::black_body(cct_k).unwrap().0.channels();
        let (warm, cold) = (rgb(2700.0), rgb(10_000.0));
        assert!(warm[0] > warm[1] && warm[1] > warm[2] && warm[2] > 0.0, "{warm:?}");
        assert!(cold[2] > cold[1] && cold[1] > cold[0], "{cold:?}");
        for (i, c) in rgb(6504.0).into_iter().enumerate() {
            assert!((c - 1.0).abs() < 0.06, "channel {i}: {c}");
        }
    }

    #[test]
    fn any_scale_is_the_same_colour_and_equal_channels_are_white_to_the_bit() {
        let channels = |rgb| Colour::new(rgb).unwrap().channels();
        assert_eq!(Colour::new([0.1; 3]), Ok(Colour::WHITE));
        assert_eq!(channels([2.0, 0.5, 1.0]), channels([2e-300, 0.5e-300, 1e-300]));
        assert_eq!(channels([1.0, 0.0, 0.0]), [1.0 / 0.2126, 0.0, 0.0]);
    }
}
