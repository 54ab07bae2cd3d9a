//! How the error falls with the number of photons.

use super::chance::farther;

/// error = c n^-rate, by least squares on logarithms.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Rate {
    /// The power; 0.5 of independent photons.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Photons of a replicate, from the first to the last level.
    pub photons: [u64; 2],
    /// How often independent photons have a power as small or smaller.
    pub chance: f64,
}

/// Fewest levels of a fit.
const FEWEST_LEVELS: usize = 3;
/// Powers that the treatment of neighbouring levels is for: those of independent photons and of nets of smooth light.
const POWERS: [f64; 2] = [0.5, 1.5];

/// The rate of errors, by photons of a replicate, each twice those before, from the spread of so many replicates; `None` for
/// fewer than three levels.
///
/// A standard error s of R replicates has the variance psi'((R - 1) / 2) / 4 in its logarithm, the same at every level, so all have
/// the same weight. Levels share photons. Where the parts of the larger one are exchangeable, as those of independent photons
/// and of a scrambled net are, the means at both have the correlation rho = s_large / s_small, and the logarithms of their
/// standard errors rho^2 = 2^(-2 rate) a doubling. The error of the slope is that of such numbers; `chance` is for a rate of 0.5.
pub fn rate(levels: &[(u64, f64)], replicates: u32) -> Option<Rate> {
    if levels.len() < FEWEST_LEVELS || levels.iter().any(|(_, error)| *error <= 0.0) {
        return None;
    }
    let x: Vec<f64> = levels.iter().map(|(n, _)| libm::log(*n as f64)).collect();
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let xx: f64 = x.iter().map(|x| (x - mean) * (x - mean)).sum();
    let weights: Vec<f64> = x.iter().map(|x| (x - mean) / xx).collect();
    let value = -weights.iter().zip(levels).map(|(w, (_, error))| w * libm::log(*error)).sum::<f64>();
    let variance = trigamma(0.5 * f64::from(replicates.max(2) - 1)) / 4.0;
    let error_of = |power: f64| {
        let shared = |a: &f64, b: &f64| libm::exp(-2.0 * power * (a - b).abs());
        let pairs = x
            .iter()
            .zip(&weights)
            .flat_map(|(a, v)| x.iter().zip(&weights).map(move |(b, w)| v * w * shared(a, b)));
        (variance * pairs.sum::<f64>()).sqrt()
    };
    Some(Rate {
        value,
        standard_error: error_of(value.clamp(POWERS[0], POWERS[1])),
        photons: [levels[0].0, levels[levels.len() - 1].0],
        chance: below_half(value, error_of(0.5), replicates),
    })
}

/// How often a rate of 0.5 with this error comes out as small or smaller. Logarithms of chi-square numbers have longer tails than
/// normal ones; Student's with four times the degrees of a spread are at least as long (measured from 4 replicates and 3 levels on).
fn below_half(rate: f64, error: f64, replicates: u32) -> f64 {
    let t = (0.5 - rate) / error;
    let both = farther(t, 4 * (replicates.max(2) - 1));
    if t > 0.0 { 0.5 * both } else { 1.0 - 0.5 * both }
}

/// The derivative of the digamma function: recurrence and asymptotic series (Abramowitz and Stegun 6.4.6, 6.4.12).
fn trigamma(x: f64) -> f64 {
    let (mut x, mut sum) = (x, 0.0);
    while x < 16.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let y = 1.0 / (x * x);
    sum + (1.0 + 0.5 / x + y * (1.0 / 6.0 - y * (1.0 / 30.0 - y * (1.0 / 42.0 - y / 30.0)))) / x
}
