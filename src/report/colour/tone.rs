//! From luminance to a picture on a screen: exposure, an optional shoulder, the screen's gamut.
//!
//! **Exposure** divides by the luminance of white. The automatic one is the log-average of the pixels that are not black,
//! put at 18 % of white (the "key" of Reinhard et al., "Photographic tone reproduction for digital images", SIGGRAPH 2002),
//! but never so little that the 90 % quantile comes above half of white. A logarithm feels a caustic a thousand times as bright
//! as its floor, or a lamp in view, only by the part of the picture that it covers, so they blacken nothing; the
//! quantile keeps a large dim background from burning out what is lit.
//!
//! **Filmic shoulder**: luminance y (white: 1) up to a = 0.4 stays, above it becomes a + (1 - a) t / (1 + t) with
//! t = (y - a) / (1 - a): slope 1 at a, never above 1, so that a caustic of 50 times white still shows its shape. Without it what is
//! above white is white. The channels are scaled together.
//!
//! **Gamut**: a colour whose channels leave [0, 1] is mixed with the grey of its own luminance until they do not; hue and
//! luminance stay.

use crate::scene::camera::{CameraSpec, Exposure};
use crate::surface::luminance;

use super::Colour;

/// Where the log-average comes to lie: reflectance of a photographer's grey card.
const KEY: f64 = 0.18;
/// The quantile that stays dark enough to leave room for highlights, and the part of white it may reach.
const BULK: (f64, f64) = (0.9, 0.5);
/// Luminance from which the shoulder rolls off, white being 1.
const SHOULDER: f64 = 0.4;

/// What becomes of a luminance on a screen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// Luminance of white, cd/m2; positive.
    pub white_cd_m2: f64,
    /// Whether highlights roll off.
    pub filmic: bool,
}

impl Tone {
    /// As a camera asks for it; `luminances`, cd/m2, are those of the picture.
    pub fn of_camera(spec: &CameraSpec, luminances: impl Iterator<Item = f64>) -> Self {
        let white_cd_m2 = match spec.exposure {
            Exposure::White(white) => white,
            Exposure::Auto => automatic_white(luminances),
        };
        Self { white_cd_m2, filmic: spec.filmic }
    }

    /// The colour on a screen, linear, of linear sRGB in cd/m2.
    pub fn display(&self, rgb_cd_m2: [f64; 3]) -> Colour {
        let rgb = rgb_cd_m2.map(|c| c / self.white_cd_m2);
        let y = luminance(rgb);
        if y.is_nan() || y <= 0.0 {
            return Colour::BLACK;
        }
        let shown = if self.filmic { shoulder(y) } else { y.min(1.0) };
        if !y.is_finite() {
            return Colour::WHITE;
        }
        Colour(into_gamut(rgb.map(|c| c * (shown / y)), shown).map(|c| c as f32))
    }
}

/// The stated rule, cd/m2; 1 for a picture without light. NaN and infinities are not looked at.
pub fn automatic_white(luminances: impl Iterator<Item = f64>) -> f64 {
    let mut lit: Vec<f64> = luminances.filter(|y| *y > 0.0 && y.is_finite()).collect();
    if lit.is_empty() {
        return 1.0;
    }
    let log_average = libm::exp(lit.iter().map(|y| libm::log(*y)).sum::<f64>() / lit.len() as f64);
    let (share, part) = BULK;
    let rank = ((share * lit.len() as f64) as usize).min(lit.len() - 1);
    let (_, bulk, _) = lit.select_nth_unstable_by(rank, f64::total_cmp);
    (log_average / KEY).max(*bulk / part).clamp(f64::MIN_POSITIVE, f64::MAX)
}

/// Identity up to [`SHOULDER`], then a hyperbola of the same slope that never reaches 1.
fn shoulder(y: f64) -> f64 {
    if y <= SHOULDER {
        return y;
    }
    let rest = 1.0 - SHOULDER;
    // 1 / (1 + 1 / t), so that infinity gives 1.
    SHOULDER + rest / (1.0 + rest / (y - SHOULDER))
}

/// Mixed with the grey of its luminance `y`, 0 to 1, until no channel leaves [0, 1].
fn into_gamut(rgb: [f64; 3], y: f64) -> [f64; 3] {
    let mut share: f64 = 1.0;
    for c in rgb {
        if c > 1.0 {
            share = share.min((1.0 - y) / (c - y));
        } else if c < 0.0 {
            share = share.min(y / (y - c));
        }
    }
    rgb.map(|c| (y + (c - y) * share).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn tone(filmic: bool) -> Tone {
        Tone { white_cd_m2: 200.0, filmic }
    }

    #[test]
    fn greys_are_the_standard_s() {
        // IEC 61966-2-1: 0.5 of white is 188 of 255, 0.18 is 118, 0.0018 (below the straight part's end) is 6.
        for (part, code) in [(1.0, 255), (0.5, 188), (0.18, 118), (0.0018, 6), (0.0, 0)] {
            assert_eq!(tone(false).display([200.0 * part; 3]).to_srgb(), [code; 3]);
        }
        assert_eq!(tone(false).display([f64::NAN; 3]), Colour::BLACK);
        assert_eq!(tone(false).display([-1.0; 3]), Colour::BLACK);
        for filmic in [false, true] {
            assert_eq!(tone(filmic).display([f64::INFINITY; 3]).to_srgb(), [255; 3]);
        }
    }

    #[test]
    fn a_uniform_picture_is_as_bright_as_a_grey_card_and_its_unit_does_not_matter() {
        for y in [1e-6, 1.0, 3e7] {
            let white = automatic_white(std::iter::repeat_n(y, 1000));
            assert!((y / white / 0.18 - 1.0).abs() < 1e-12, "{y}");
        }
        assert_eq!(automatic_white([0.0, f64::NAN, -1.0].into_iter()), 1.0);
    }

    /// What the floor becomes, as a code, in a picture of (luminance, part).
    fn floor(parts: &[(f64, usize)]) -> u8 {
        let pixels = parts.iter().flat_map(|(y, n)| std::iter::repeat_n(*y, *n));
        Tone { white_cd_m2: automatic_white(pixels), filmic: false }.display([1.0; 3]).to_srgb()[0]
    }

    #[test]
    fn bright_small_regions_do_not_blacken_the_rest_and_dim_large_ones_do_not_burn_it() {
        let mid = 80..=200;
        assert!(mid.contains(&floor(&[(1.0, 1000)])));
        assert!(mid.contains(&floor(&[(1.0, 970), (50.0, 30)])), "a caustic");
        assert!(mid.contains(&floor(&[(1.0, 970), (1e5, 30)])), "a lamp in view");
        assert!(mid.contains(&floor(&[(1.0, 200), (1e-3, 800)])), "a dim surrounding");
        assert!(mid.contains(&floor(&[(1.0, 200), (0.0, 800)])), "a black surrounding");
        assert!(mid.contains(&floor(&[(1.0, 700), (0.02, 250), (30.0, 50)])), "shadow and caustic");
    }

    #[test]
    fn the_shoulder_rises_and_stays_below_white_with_no_kink() {
        let mut last = 0.0;
        for i in 1..2000 {
            let y = 0.01 * f64::from(i);
            let shown = shoulder(y);
            assert!(shown > last && shown < 1.0, "{y}");
            last = shown;
        }
        assert_eq!(shoulder(0.39), 0.39);
        let slope = (shoulder(SHOULDER + 1e-6) - shoulder(SHOULDER)) / 1e-6;
        assert!((slope - 1.0).abs() < 1e-5, "{slope}");
    }

    #[test]
    fn colours_out_of_gamut_keep_luminance_and_hue() {
        let red = [300.0, 20.0, 10.0];
        let y = luminance(red) / 200.0;
        let shown = tone(false).display(red).0.map(f64::from);
        assert!((luminance(shown) - y).abs() < 1e-6, "{shown:?}");
        assert!((shown[0] - 1.0).abs() < 1e-6);
        // Mixed with grey: the differences of channels keep their ratio.
        let ratio = (shown[1] - shown[2]) / (shown[0] - shown[2]);
        assert!((ratio - 10.0 / 290.0).abs() < 1e-6, "{ratio}");
        let below = tone(false).display([100.0, 100.0, -20.0]).0;
        assert!(below.iter().all(|c| (0.0..=1.0).contains(c)));
    }

    #[test]
    fn a_camera_s_own_exposure_is_taken() {
        let mut spec = CameraSpec::pinhole(DVec3::ZERO, DVec3::Y, DVec3::Z, 40.0, [1, 1]);
        spec.exposure = Exposure::White(12.5);
        assert_eq!(Tone::of_camera(&spec, [1e9].into_iter()).white_cd_m2, 12.5);
        spec.exposure = Exposure::Auto;
        assert!((Tone::of_camera(&spec, [9.0].into_iter()).white_cd_m2 / 50.0 - 1.0).abs() < 1e-12);
    }
}
