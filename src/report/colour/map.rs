//! The false colours: dark blue over magenta and orange to pale yellow.
//!
//! Designed for this program in Oklab (B. Ottosson, "A perceptual color space for image processing", 2020): lightness
//! rises from 0.10 to 0.97, hue turns once from blue to yellow, chroma follows the sRGB gamut, and the knots lie at
//! equal Euclidean steps. Equal steps in lux therefore look about equal, also in grey and to colour-blind readers.

use super::Colour;
use super::scale::Axis;

/// Oklab L, a, b at equal steps of the scale.
const KNOTS: [[f64; 3]; 25] = [
    [0.1000, 0.0006, -0.0063],
    [0.1385, 0.0045, -0.0320],
    [0.1721, 0.0122, -0.0630],
    [0.2033, 0.0241, -0.0941],
    [0.2441, 0.0397, -0.1100],
    [0.2842, 0.0606, -0.1203],
    [0.3231, 0.0858, -0.1229],
    [0.3602, 0.1128, -0.1165],
    [0.3954, 0.1389, -0.1012],
    [0.4290, 0.1612, -0.0782],
    [0.4621, 0.1781, -0.0503],
    [0.4953, 0.1896, -0.0200],
    [0.5286, 0.1968, 0.0116],
    [0.5619, 0.2008, 0.0438],
    [0.5954, 0.1992, 0.0757],
    [0.6297, 0.1816, 0.1011],
    [0.6632, 0.1533, 0.1161],
    [0.6982, 0.1245, 0.1262],
    [0.7348, 0.0965, 0.1324],
    [0.7727, 0.0697, 0.1346],
    [0.8118, 0.0447, 0.1346],
    [0.8515, 0.0211, 0.1297],
    [0.8896, 0.0018, 0.1124],
    [0.9268, -0.0088, 0.0868],
    [0.9700, -0.0149, 0.0714],
];

/// The colour of a value on a scale; grey for one that does not exist (NaN, infinity).
pub fn value_colour(value: f64, axis: &Axis) -> Colour {
    if value.is_finite() { colour(axis.place(value)) } else { Colour::grey(160) }
}

/// The colour at `t` of the scale, 0 at its foot and 1 at its top; beyond it stays at the end.
pub fn colour(t: f64) -> Colour {
    oklab_to_linear_srgb(oklab(t))
}

/// Perceived lightness at `t`, 0 black to 1 white.
pub fn lightness(t: f64) -> f64 {
    oklab(t)[0]
}

/// Catmull-Rom interpolation of the knots: smooth, and through each of them.
fn oklab(t: f64) -> [f64; 3] {
    let last = KNOTS.len() - 1;
    // NaN goes to the foot; `value_colour` shows that there is none.
    let x = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) * last as f64 };
    let cell = (x as usize).min(last - 1);
    let f = x - cell as f64;
    let knots = [cell.saturating_sub(1), cell, cell + 1, (cell + 2).min(last)].map(|k| KNOTS[k]);
    std::array::from_fn(|i| {
        let [p0, p1, p2, p3] = knots.map(|knot| knot[i]);
        let quadratic = 2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3;
        let cubic = 3.0 * (p1 - p2) + p3 - p0;
        p1 + 0.5 * f * (p2 - p0 + f * (quadratic + f * cubic))
    })
}

/// Ottosson's matrices (2020), Oklab to linear sRGB.
fn oklab_to_linear_srgb([lightness, a, b]: [f64; 3]) -> Colour {
    let cube = |x: f64| x * x * x;
    let l = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let m = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let s = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b);
    Colour([
        (4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s) as f32,
        (-1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s) as f32,
        (-0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s) as f32,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CIE L* from the relative luminance of linear sRGB (IEC 61966-2-1): independent of Oklab.
    fn cie_lightness(t: f64) -> f64 {
        let [r, g, b] = colour(t).0.map(f64::from);
        let y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        if y > 216.0 / 24389.0 { 116.0 * y.cbrt() - 16.0 } else { y * 24389.0 / 27.0 }
    }

    #[test]
    fn lightness_rises_everywhere_by_both_measures() {
        for i in 0..1000 {
            let (low, high) = (i as f64 / 1000.0, (i + 1) as f64 / 1000.0);
            assert!(lightness(high) > lightness(low), "Oklab at {low}");
            assert!(cie_lightness(high) > cie_lightness(low), "CIE L* at {low}");
        }
        assert!(cie_lightness(0.0) < 3.0 && cie_lightness(1.0) > 93.0);
    }

    #[test]
    fn every_colour_is_in_the_gamut() {
        for i in 0..=1000 {
            for channel in colour(i as f64 / 1000.0).0 {
                assert!((0.0..=1.0).contains(&channel), "{channel} at {i}");
            }
        }
    }

    #[test]
    fn equal_steps_look_alike() {
        let steps: Vec<f64> = (0..100)
            .map(|i| {
                let (p, q) = (oklab(i as f64 / 100.0), oklab((i + 1) as f64 / 100.0));
                p.iter().zip(q).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
            })
            .collect();
        let mean = steps.iter().sum::<f64>() / 100.0;
        for (i, step) in steps.iter().enumerate() {
            assert!((0.6..1.4).contains(&(step / mean)), "step {i} is {} of the mean", step / mean);
        }
    }

    #[test]
    fn ends_hold_and_nan_does_no_harm() {
        assert_eq!(colour(-3.0), colour(0.0));
        assert_eq!(colour(f64::INFINITY), colour(1.0));
        assert_eq!(colour(f64::NAN), colour(0.0));
    }
}
