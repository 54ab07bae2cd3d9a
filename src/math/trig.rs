//! Sines and cosines that agree between machines, and their differences without cancellation.
//!
//! Beyond half a radian the `libm` crate is used; up to it, Taylor polynomials whose remainder is below 2^-55: cells of
//! tables are rarely wider, and a polynomial costs a fraction of a library call.

/// Largest argument of the polynomials.
const SMALL: f64 = 0.5;
/// Largest argument for which five terms do: the next one, z^5 / 11!, is below 2^-64. Wider than a cell of 2.5
/// degrees.
const TINY: f64 = 1.0 / 16.0;

/// sin s, 1 - cos s, and the two first-moment integrals of the cell equation (METHOD, eq. 8), for s >= 0.
#[derive(Debug, Clone, Copy, Default)]
pub struct InCell {
    /// sin s = integral of cos x over [0, s].
    pub sin: f64,
    /// 1 - cos s = integral of sin x over [0, s].
    pub versine: f64,
    /// s sin s - (1 - cos s) = integral of x cos x over [0, s].
    pub moment_cos: f64,
    /// sin s - s cos s = integral of x sin x over [0, s].
    pub moment_sin: f64,
}

impl InCell {
    /// All four at s >= 0, each to a few units in the last place however small s is.
    #[inline(always)]
    pub fn at(s: f64) -> Self {
        if s <= TINY {
            Self::series::<5>(s)
        } else if s <= SMALL {
            Self::series::<8>(s)
        } else {
            let (half_sin, half_cos) = libm::sincos(0.5 * s);
            let sin = 2.0 * half_sin * half_cos;
            let versine = 2.0 * half_sin * half_sin;
            Self { sin, versine, moment_cos: s * sin - versine, moment_sin: sin - s * (1.0 - versine) }
        }
    }

    /// The Taylor series to `N` terms.
    #[inline(always)]
    fn series<const N: usize>(s: f64) -> Self {
        let z = s * s;
        Self {
            sin: s * horner::<N>(&SIN_OVER_S, z),
            versine: z * horner::<N>(&VERSINE_OVER_Z, z),
            moment_cos: z * horner::<N>(&MOMENT_COS_OVER_Z, z),
            moment_sin: s * z * horner::<N>(&MOMENT_SIN_OVER_S3, z),
        }
    }
}

/// (sin x, cos x) for any finite x.
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if x.abs() <= SMALL {
        let z = x * x;
        (x * horner::<8>(&SIN_OVER_S, z), 1.0 - z * horner::<8>(&VERSINE_OVER_Z, z))
    } else {
        libm::sincos(x)
    }
}

const SIN_OVER_S: [f64; 8] = taylor(1, false);
const VERSINE_OVER_Z: [f64; 8] = taylor(2, false);
const MOMENT_COS_OVER_Z: [f64; 8] = taylor(2, true);
const MOMENT_SIN_OVER_S3: [f64; 8] = taylor(3, true);

/// Coefficients of the Taylor series about 0, in z = s^2 <= 1/4, cut where the next term is below 2^-55 of the first:
/// (-1)^k / n!, n = 2 k + first; of a moment times n - 1.
const fn taylor(first: u64, is_moment: bool) -> [f64; 8] {
    let (mut series, mut factorial, mut counted) = ([0.0; 8], 1, 1);
    let mut k = 0;
    while k < series.len() {
        let n = 2 * k as u64 + first;
        while counted < n {
            counted += 1;
            factorial *= counted;
        }
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        series[k] = sign * (if is_moment { n - 1 } else { 1 }) as f64 / factorial as f64;
        k += 1;
    }
    series
}

/// The first `N` terms of a series in z.
#[inline(always)]
fn horner<const N: usize>(coefficients: &[f64; 8], z: f64) -> f64 {
    coefficients[..N].iter().rev().fold(0.0, |sum, c| sum * z + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Composite Gauss-Legendre of order 5 over [0, s]: an independent value of the integrals.
    fn integrate(s: f64, f: impl Fn(f64) -> f64) -> f64 {
        const X: [f64; 3] = [0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
        const W: [f64; 3] = [0.568_888_888_888_888_9, 0.478_628_670_499_366_47, 0.236_926_885_056_189_08];
        let panels = 16;
        let h = s / f64::from(panels) / 2.0;
        (0..panels)
            .map(|p| {
                let middle = h * f64::from(2 * p + 1);
                h * (W[0] * f(middle)
                    + W[1] * (f(middle - h * X[1]) + f(middle + h * X[1]))
                    + W[2] * (f(middle - h * X[2]) + f(middle + h * X[2])))
            })
            .sum()
    }

    #[test]
    fn integrals_agree_with_quadrature_from_tiny_to_pi() {
        for s in [1e-12, 1e-9, 1e-3, 0.04, 0.3, 0.499, 0.501, 1.0, 2.0, std::f64::consts::PI] {
            let c = InCell::at(s);
            for (value, expected) in [
                (c.sin, integrate(s, f64::cos)),
                (c.versine, integrate(s, f64::sin)),
                (c.moment_cos, integrate(s, |x| x * x.cos())),
                (c.moment_sin, integrate(s, |x| x * x.sin())),
            ] {
                assert!(
                    (value - expected).abs() <= 4e-15 * expected.abs().max(s * s * s),
                    "s {s}: {value} {expected}"
                );
            }
        }
    }

    #[test]
    fn the_seam_is_continuous() {
        let (below, above) = (InCell::at(SMALL), InCell::at(SMALL + 1e-16));
        assert!((below.moment_sin - above.moment_sin).abs() < 3e-16);
        assert!((below.moment_cos - above.moment_cos).abs() < 3e-16);
    }

    #[test]
    fn sin_cos_matches_libm() {
        for i in -400..400 {
            let x = f64::from(i) * 0.01;
            let (s, c) = sin_cos(x);
            assert!(
                (s - libm::sin(x)).abs() <= 2.0 * f64::EPSILON * s.abs() && (c - libm::cos(x)).abs() <= 3e-16
            );
        }
    }
}
