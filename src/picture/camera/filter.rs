//! Pixel filters: where in the picture a pixel's samples lie.
//!
//! Samples are drawn from the filter itself by inverse functions, so that all count the same: a pixel is the
//! mean of its samples. The densities are for those who bring light to the picture from the other end.

use std::f64::consts::PI;

use crate::math::trig::sin_cos;
use crate::scene::camera::Filter;

/// Standard deviation of the Gaussian, pixels.
const SIGMA: f64 = 0.5;
/// Where it is cut, pixels from the middle.
const CUT: f64 = 2.0;
/// exp(-CUT^2 / (2 SIGMA^2)) = e^-8: what is cut.
const BEYOND_CUT: f64 = 3.354_626_279_025_118_4e-4;

/// The offset from the pixel's middle, in pixels, for a point of the unit square.
#[inline]
pub fn offset(filter: Filter, u: [f64; 2]) -> [f64; 2] {
    match filter {
        Filter::Box => u.map(|u| u - 0.5),
        Filter::Tent => {
            u.map(|u| if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).sqrt() })
        }
        Filter::Gaussian => {
            let rest = 1.0 - u[0] * (1.0 - BEYOND_CUT);
            let radius = SIGMA * (-2.0 * libm::log(rest)).max(0.0).sqrt();
            let (sin, cos) = sin_cos(2.0 * PI * u[1]);
            [radius * cos, radius * sin]
        }
    }
}

/// Density of [`offset`], 1 / pixel^2: its integral over the picture is 1.
#[inline]
pub fn density(filter: Filter, offset: [f64; 2]) -> f64 {
    match filter {
        // Half open, so that every place belongs to one pixel.
        Filter::Box => offset.map(|d| f64::from(u8::from((-0.5..0.5).contains(&d)))).iter().product(),
        Filter::Tent => offset.map(|d| (1.0 - d.abs()).max(0.0)).iter().product(),
        Filter::Gaussian => {
            let square = offset[0] * offset[0] + offset[1] * offset[1];
            if square >= CUT * CUT {
                return 0.0;
            }
            let peak = 1.0 / (2.0 * PI * SIGMA * SIGMA * (1.0 - BEYOND_CUT));
            peak * libm::exp(-square / (2.0 * SIGMA * SIGMA))
        }
    }
}

/// How far a filter reaches from the middle along either axis, pixels.
pub const fn reach(filter: Filter) -> f64 {
    match filter {
        Filter::Box => 0.5,
        Filter::Tent => 1.0,
        Filter::Gaussian => CUT,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Filter; 3] = [Filter::Box, Filter::Tent, Filter::Gaussian];

    #[test]
    fn samples_have_the_moments_of_the_density() {
        // Variance along an axis: 1/12, 1/6, and sigma^2 (1 - 9 e^-8) / (1 - e^-8) (r^2 / 2 under the cut
        // Rayleigh law).
        let gauss = SIGMA * SIGMA * (1.0 - 9.0 * BEYOND_CUT) / (1.0 - BEYOND_CUT);
        for (filter, variance) in ALL.into_iter().zip([1.0 / 12.0, 1.0 / 6.0, gauss]) {
            let n = 512;
            let (mut m1, mut m2, mut cross) = (0.0, 0.0, 0.0);
            for i in 0..n {
                for j in 0..n {
                    let u = [(f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n)];
                    let [x, y] = offset(filter, u);
                    assert!(x.abs() <= reach(filter) && y.abs() <= reach(filter));
                    assert!(density(filter, [x, y]) > 0.0);
                    m1 += x;
                    m2 += x * x;
                    cross += x * y;
                }
            }
            let mean = |sum: f64| sum / f64::from(n * n);
            assert!(mean(m1).abs() < 1e-12 && mean(cross).abs() < 1e-12);
            assert!((mean(m2) / variance - 1.0).abs() < 1e-3, "{filter:?} {}", mean(m2) / variance);
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        for filter in ALL {
            let n = 2048;
            let h = 5.0 / f64::from(n);
            let at = |k: i32| (f64::from(k) + 0.5) * h - 2.5;
            let sum: f64 = (0..n)
                .flat_map(|i| (0..n).map(move |j| [at(i), at(j)]))
                .map(|p| density(filter, p))
                .sum::<f64>()
                * h
                * h;
            assert!((sum - 1.0).abs() < 2e-3, "{filter:?} {sum}");
        }
        assert!((BEYOND_CUT / (-8f64).exp() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_ends_of_the_unit_square_stay_inside() {
        let last = 1.0 - f64::EPSILON / 2.0;
        for filter in ALL {
            for u in [[0.0, 0.0], [last, 0.0], [0.0, last], [last, last]] {
                assert!(offset(filter, u).iter().all(|d| d.abs() <= reach(filter)));
            }
        }
    }
}
