//! Skewness and kurtosis over replicates, and how often normal numbers have as much.

use super::chance::above;

/// A moment of the replicates' shape.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Moment {
    /// Unbiased for normal numbers, for which it is 0 in the mean.
    pub value: f64,
    /// Its standard error for normal numbers, exact.
    pub standard_error: f64,
    /// How often as many normal numbers have as much: of skewness to either side, of kurtosis above; `None` for so few that the
    /// transformations to normal numbers do not hold.
    pub chance: Option<f64>,
}

/// Fewest numbers whose skewness is judged (D'Agostino 1970), and whose kurtosis is (Anscombe and Glynn 1983).
const FEWEST: [u32; 2] = [8, 20];

/// Means of the second, third and fourth powers of n times the deviations from the mean; `None` where all numbers are equal.
fn central(numbers: &[u64]) -> Option<[f64; 3]> {
    let (n, sum) = (numbers.len() as i128, numbers.iter().map(|c| i128::from(*c)).sum::<i128>());
    let mut sums = [0.0; 3];
    for count in numbers {
        // Exact, so nothing cancels.
        let d = (n * i128::from(*count) - sum) as f64;
        sums[0] += d * d;
        sums[1] += d * d * d;
        sums[2] += d * d * d * d;
    }
    (sums[0] > 0.0).then(|| sums.map(|s| s / n as f64))
}

/// Skewness G1 = g1 sqrt(n (n - 1)) / (n - 2), g1 = m3 / m2^(3/2) (Joanes and Gill 1998); `None` for fewer than 3 numbers and for
/// equal ones.
pub fn skewness(numbers: &[u64]) -> Option<Moment> {
    let [m2, m3, _] = central(numbers).filter(|_| numbers.len() >= 3)?;
    let n = numbers.len() as f64;
    let g1 = m3 / (m2 * m2.sqrt());
    let value = g1 * (n * (n - 1.0)).sqrt() / (n - 2.0);
    let standard_error = (6.0 * n * (n - 1.0) / ((n - 2.0) * (n + 1.0) * (n + 3.0))).sqrt();
    let is_judged = numbers.len() >= FEWEST[0] as usize;
    Some(Moment { value, standard_error, chance: is_judged.then(|| 2.0 * above(z_of_skewness(g1, n).abs())) })
}

/// The normal number that a skewness g1 of n normal numbers stands for (D'Agostino 1970, Johnson's S_U curve).
fn z_of_skewness(g1: f64, n: f64) -> f64 {
    let y = g1 * ((n + 1.0) * (n + 3.0) / (6.0 * (n - 2.0))).sqrt();
    let b2 = 3.0 * (n * n + 27.0 * n - 70.0) * (n + 1.0) * (n + 3.0)
        / ((n - 2.0) * (n + 5.0) * (n + 7.0) * (n + 9.0));
    let w2 = (2.0 * (b2 - 1.0)).sqrt() - 1.0;
    let delta = 1.0 / libm::log(w2.sqrt()).sqrt();
    let alpha = (2.0 / (w2 - 1.0)).sqrt();
    delta * libm::asinh(y / alpha)
}

/// Excess kurtosis G2 = (n - 1) ((n + 1) g2 + 6) / ((n - 2) (n - 3)), g2 = m4 / m2^2 - 3 (Joanes and Gill 1998); `None` for fewer
/// than 4 numbers and for equal ones.
pub fn kurtosis(numbers: &[u64]) -> Option<Moment> {
    let [m2, _, m4] = central(numbers).filter(|_| numbers.len() >= 4)?;
    let n = numbers.len() as f64;
    let g2 = m4 / (m2 * m2) - 3.0;
    let value = (n - 1.0) * ((n + 1.0) * g2 + 6.0) / ((n - 2.0) * (n - 3.0));
    let square = 24.0 * n * (n - 1.0) * (n - 1.0) / ((n - 3.0) * (n - 2.0) * (n + 3.0) * (n + 5.0));
    let is_judged = numbers.len() >= FEWEST[1] as usize;
    Some(Moment {
        value,
        standard_error: square.sqrt(),
        chance: is_judged.then(|| above(z_of_kurtosis(g2, n))),
    })
}

/// The normal number that a kurtosis g2 of n normal numbers stands for (Anscombe and Glynn 1983).
fn z_of_kurtosis(g2: f64, n: f64) -> f64 {
    let mean = 3.0 * (n - 1.0) / (n + 1.0);
    let variance = 24.0 * n * (n - 2.0) * (n - 3.0) / ((n + 1.0) * (n + 1.0) * (n + 3.0) * (n + 5.0));
    let x = (g2 + 3.0 - mean) / variance.sqrt();
    let skew = 6.0 * (n * n - 5.0 * n + 2.0) / ((n + 7.0) * (n + 9.0))
        * (6.0 * (n + 3.0) * (n + 5.0) / (n * (n - 2.0) * (n - 3.0))).sqrt();
    let a = 6.0 + 8.0 / skew * (2.0 / skew + (1.0 + 4.0 / (skew * skew)).sqrt());
    let v = 2.0 / (9.0 * a);
    // The denominator is below 0 far on the light side alone.
    let quotient = (1.0 - 2.0 / a) / (1.0 + x * (2.0 / (a - 4.0)).sqrt());
    ((1.0 - v) - libm::cbrt(quotient)) / v.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_by_hand() {
        // 0, 0, 0, 4: mean 1, m2 = 3, m3 = 6, m4 = 21. g1 = 6 / sqrt(27) = 2 / sqrt(3), G1 = g1 sqrt(12) / 2 = 2.
        // g2 = 21 / 9 - 3 = -2 / 3, G2 = 3 (5 g2 + 6) / 2 = 4.
        let four = [0, 0, 0, 4];
        let (skew, kurt) = (skewness(&four).unwrap(), kurtosis(&four).unwrap());
        assert!((skew.value - 2.0).abs() < 1e-14 && (kurt.value - 4.0).abs() < 1e-14);
        // sqrt(6 4 3 / (2 5 7)) and sqrt(24 4 9 / (1 2 7 9)).
        assert!((skew.standard_error - (36.0f64 / 35.0).sqrt()).abs() < 1e-15);
        assert!((kurt.standard_error - (48.0f64 / 7.0).sqrt()).abs() < 1e-14);
        assert_eq!((skew.chance, kurt.chance), (None, None));
        // The same light on a thousand million photons more.
        let many = four.map(|n| n + (1 << 47));
        assert_eq!((skewness(&many), kurtosis(&many)), (Some(skew), Some(kurt)));
        // Two moments that need more numbers, or different ones.
        assert!(skewness(&[1, 2]).is_none() && kurtosis(&[1, 2, 4]).is_none());
        assert!(skewness(&[7; 9]).is_none() && kurtosis(&[7; 9]).is_none());
    }

    #[test]
    fn chances_are_those_of_the_published_transformations() {
        // scipy's documentation: skewtest([2, 8, 0, 4, 1, 9, 9, 0]) has z = 0.446263..., p = 0.655406...;
        // kurtosistest(range(20)) has z = -1.705810..., of which above are 1 - 0.0880433... / 2.
        let skew = skewness(&[2, 8, 0, 4, 1, 9, 9, 0]).unwrap();
        assert!((skew.chance.unwrap() - 0.655_406_663_127_545_9).abs() < 1e-12);
        let numbers: Vec<u64> = (0..20).collect();
        let kurt = kurtosis(&numbers).unwrap();
        assert!((kurt.chance.unwrap() - (1.0 - 0.088_043_383_325_283_48 / 2.0)).abs() < 1e-12);
    }
}
