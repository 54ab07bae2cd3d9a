//! How an error falls with the number of photons: error = c N^rate, by least squares on logarithms.
//!
//! Every seed gives a slope of its own; the rate is their mean and its standard error their spread over the
//! root of their number. The errors of one seed at several N share points, so the residuals about one line
//! would say less than there is to say; they are used only where there is a single seed.

use std::collections::BTreeSet;

use super::norms::{mean_and_variance, root_mean_square};

/// An error at a number of photons.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Photons.
    pub photons: u64,
    /// Error, as a fraction.
    pub error: f64,
}

/// Where the standard error of a rate comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uncertainty {
    /// From the slopes of several seeds.
    Seeds,
    /// One seed: from the residuals about its line, with two degrees of freedom less than there are levels.
    Residuals,
    /// One seed and two levels: nothing to tell it from.
    Unknown,
}

/// error = c N^rate over a measured range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// The exponent of N.
    pub rate: f64,
    /// Its standard error, where `uncertainty` is not [`Uncertainty::Unknown`].
    pub rate_standard_error: Option<f64>,
    /// Where that comes from.
    pub uncertainty: Uncertainty,
    /// Fewest and most photons that were measured; the law is extrapolated beyond.
    pub measured: [u64; 2],
    /// Mean of ln N over the levels the law goes through the middle of, and mean of ln error there.
    centre: [f64; 2],
}

/// A number from a law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// The number.
    pub value: f64,
    /// Whether it is for an N outside the measured range.
    pub extrapolated: bool,
}

impl Law {
    /// The law of errors measured with one or several seeds, each at two or more numbers of photons. The
    /// levels of a seed may stand in any order. It goes through the middle, in logarithms, of the root mean
    /// squares over the seeds.
    ///
    /// A seed's errors that are not positive and finite have no logarithm: they are left out, and so is what
    /// is not [`fitted`]. `None` when no seed has two levels.
    pub fn fit(seeds: &[Vec<Level>]) -> Option<Self> {
        let usable = |level: &&Level| level.photons > 0 && level.error > 0.0 && level.error.is_finite();
        let mut chosen: Vec<Vec<Level>> =
            seeds.iter().map(|levels| levels.iter().filter(usable).copied().collect()).collect();
        let measured = distinct(chosen.iter().flatten().map(|l| l.photons));
        let used = fitted(&measured);
        chosen.iter_mut().for_each(|levels| levels.retain(|l| used.contains(&l.photons)));
        let (slopes, errors): (Vec<f64>, Vec<Option<f64>>) =
            chosen.iter().filter_map(|levels| slope(levels)).unzip();
        let (rate, variance) = mean_and_variance(&slopes);
        let (rate_standard_error, uncertainty) = match (variance, *errors.first()?) {
            (Some(variance), _) => (Some((variance / slopes.len() as f64).sqrt()), Uncertainty::Seeds),
            (None, Some(error)) => (Some(error), Uncertainty::Residuals),
            (None, None) => (None, Uncertainty::Unknown),
        };
        // The middle of the levels: means of ln N and of ln (root mean square over the seeds).
        let mut centre = [0.0; 2];
        for &n in &used {
            let same = chosen.iter().flatten().filter(|l| l.photons == n);
            centre[0] += libm::log(n as f64);
            centre[1] += libm::log(root_mean_square(&same.map(|l| l.error).collect::<Vec<f64>>()));
        }
        let centre = centre.map(|sum| sum / used.len() as f64);
        let measured = [*measured.first()?, *measured.last()?];
        Some(Self { rate, rate_standard_error, uncertainty, measured, centre })
    }

    /// The error at a number of photons, which need not be whole.
    pub fn error_at(&self, photons: f64) -> Prediction {
        let value = libm::exp(self.centre[1] + self.rate * (libm::log(photons) - self.centre[0]));
        Prediction { value, extrapolated: !self.covers(photons) }
    }

    /// The photons that an error takes; `None` if the error does not fall, or they are more than any count.
    pub fn photons_for(&self, error: f64) -> Option<Prediction> {
        if !(self.rate < 0.0 && error > 0.0) {
            return None;
        }
        let value = libm::exp(self.centre[0] + (libm::log(error) - self.centre[1]) / self.rate);
        value.is_finite().then_some(Prediction { value, extrapolated: !self.covers(value) })
    }

    /// The CPU time in seconds that an error takes at this speed.
    pub fn time_for(&self, error: f64, photons_per_cpu_s: f64) -> Option<Prediction> {
        let photons = self.photons_for(error)?;
        let value = photons.value / photons_per_cpu_s;
        value.is_finite().then_some(Prediction { value, ..photons })
    }

    fn covers(&self, photons: f64) -> bool {
        // The last measured N itself, computed from an error or a time, may come out a rounding beyond.
        let slack = 1e-9;
        let [least, most] = self.measured.map(|n| n as f64);
        photons >= least * (1.0 - slack) && photons <= most * (1.0 + slack)
    }
}

/// The slope of the line through ln error over ln N by least squares, and its standard error where that is known; `None` through
/// fewer than two different N.
fn slope(levels: &[Level]) -> Option<(f64, Option<f64>)> {
    let points: Vec<[f64; 2]> =
        levels.iter().map(|l| [libm::log(l.photons as f64), libm::log(l.error)]).collect();
    let n = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let xx: f64 = points.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
    if points.len() < 2 || xx <= 0.0 {
        return None;
    }
    let slope = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>() / xx;
    let residual = |p: &[f64; 2]| p[1] - y - slope * (p[0] - x);
    let squares: f64 = points.iter().map(|p| residual(p) * residual(p)).sum();
    let slope_error = (points.len() > 2).then(|| (squares / (n - 2.0) / xx).sqrt());
    Some((slope, slope_error))
}

/// Which of these numbers of photons a law is fitted to: the powers of two, if there are two or more of them.
/// Other N cost a net part of its evenness, and belong to another law.
pub(crate) fn fitted(ladder: &[u64]) -> Vec<u64> {
    let powers: Vec<u64> = ladder.iter().copied().filter(|n| n.is_power_of_two()).collect();
    if powers.len() >= 2 { powers } else { ladder.to_vec() }
}

/// The different numbers among these, rising.
pub(crate) fn distinct(numbers: impl Iterator<Item = u64>) -> Vec<u64> {
    numbers.collect::<BTreeSet<_>>().into_iter().collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn levels(ladder: &[u64], error: impl Fn(f64) -> f64) -> Vec<Level> {
        ladder.iter().map(|&n| Level { photons: n, error: error(n as f64) }).collect()
    }

    #[test]
    fn an_exact_law_is_found_and_predicts() {
        let seeds = vec![levels(&[1 << 10, 1 << 12, 1 << 14], |n| 3.0 * n.powf(-0.75)); 4];
        let law = Law::fit(&seeds).unwrap();
        assert!((law.rate + 0.75).abs() < 1e-13);
        assert!(law.rate_standard_error.unwrap() < 1e-13);
        assert_eq!((law.uncertainty, law.measured), (Uncertainty::Seeds, [1 << 10, 1 << 14]));
        for (n, extrapolated) in [(1 << 9, true), (1 << 10, false), (1 << 14, false), (1 << 20, true)] {
            let expected = 3.0 * f64::from(n).powf(-0.75);
            let error = law.error_at(f64::from(n));
            assert!((error.value / expected - 1.0).abs() < 1e-12);
            assert_eq!(error.extrapolated, extrapolated);
            let photons = law.photons_for(expected).unwrap();
            assert!((photons.value / f64::from(n) - 1.0).abs() < 1e-12);
            assert_eq!(photons.extrapolated, extrapolated);
        }
        // 3 N^-0.75 = 0.003 at N = 10^4; at 2000 photons a second that takes 5 s.
        assert!((law.time_for(0.003, 2000.0).unwrap().value - 5.0).abs() < 1e-11);
    }

    #[test]
    fn slopes_and_their_spread_are_those_computed_by_hand() {
        // Slopes -1/2 and -1 between two levels: mean -3/4, standard error |difference| / 2.
        let seeds = [vec![(4, 1.0), (16, 0.5)], vec![(4, 1.0), (16, 0.25)]]
            .map(|s| s.into_iter().map(|(photons, error)| Level { photons, error }).collect::<Vec<_>>());
        let law = Law::fit(&seeds).unwrap();
        assert!((law.rate + 0.75).abs() < 1e-15);
        assert!((law.rate_standard_error.unwrap() - 0.25).abs() < 1e-15);
        // The line goes through the middle of (4, 1) and (16, sqrt((0.25 + 0.0625) / 2)).
        let middle = libm::exp(0.5 * libm::log(0.156_25_f64.sqrt()));
        assert!((law.error_at(8.0).value - middle).abs() < 1e-14);
    }

    #[test]
    fn one_seed_is_judged_by_its_residuals() {
        // ln error / ln 2 = 0, -1, -1 at ln N / ln 2 = 0, 1, 2: slope -1/2, residuals +-1/6, 1/3, variance
        // 1/6, xx 2.
        let seed = [(1, 1.0), (2, 0.5), (4, 0.5)].map(|(photons, error)| Level { photons, error }).to_vec();
        let law = Law::fit(std::slice::from_ref(&seed)).unwrap();
        assert!((law.rate + 0.5).abs() < 1e-15);
        assert!((law.rate_standard_error.unwrap() - (1.0_f64 / 12.0).sqrt()).abs() < 1e-15);
        assert_eq!(law.uncertainty, Uncertainty::Residuals);
        let two = Law::fit(&[seed[..2].to_vec()]).unwrap();
        assert_eq!((two.rate_standard_error, two.uncertainty), (None, Uncertainty::Unknown));
    }

    #[test]
    fn what_has_no_slope_gives_no_law() {
        let level = |photons, error| Level { photons, error };
        assert_eq!(Law::fit(&[]), None);
        assert_eq!(Law::fit(&[vec![level(8, 0.1)], vec![level(8, 0.2)]]), None);
        assert_eq!(Law::fit(&[vec![level(8, 0.1), level(16, 0.0), level(32, f64::NAN)]]), None);
        // A rising error: no number of photons is enough.
        let rising = Law::fit(&[vec![level(8, 0.1), level(16, 0.2)]]).unwrap();
        assert_eq!(rising.photons_for(0.01), None);
    }

    #[test]
    fn numbers_that_are_no_powers_of_two_belong_to_the_range_not_to_the_law() {
        let mut seed = levels(&[1 << 16, 1 << 18], |n| n.powf(-0.75));
        seed.push(Level { photons: 400_000, error: 1.0 });
        let law = Law::fit(&[seed]).unwrap();
        assert!((law.rate + 0.75).abs() < 1e-14);
        assert_eq!(law.measured, [1 << 16, 400_000]);
        // Without two powers of two everything counts.
        let law = Law::fit(&[levels(&[1000, 1024, 3000], |n| n.powf(-0.6))]).unwrap();
        assert!((law.rate + 0.6).abs() < 1e-14);
    }
}
