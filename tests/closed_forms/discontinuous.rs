//! How fast quasi-Monte Carlo converges where the integrand jumps, as theory says and the fitted slopes show.
//!
//! L. Szirmay-Kalos, "Monte-Carlo global illumination methods", eqs. 7.4 to 7.6: a jump across a surface in s dimensions
//! crosses N^((s-1)/s) of N cells, inside which points are as good as random, so the error falls as N^-(1/2 + 1/(2 s)):
//! N^-3/4 in the plane, N^-2/3 in space, between N^-1/2 of Monte Carlo and nearly N^-1 of a smooth integrand.
//!
//! The integrands are f2 = a (x + y) + (1 - 2 a) [x + y > 1] and f3 = a (x + y + z) + (1 - 3 a) [x + y + z > 3/2]. Both
//! jumps halve the cube by symmetry, so the integrals are a + (1 - 2 a) / 2 and 3 a / 2 + (1 - 3 a) / 2: 1/2 for any a.

use caustix::sequence::other::OtherPoints;
use caustix::sequence::{Points, Sequence, to_unit_f64};

const RANDOMISATIONS: u64 = 64;
/// Sizes 2^6 to 2^18.
const EXPONENTS: std::ops::RangeInclusive<u32> = 6..=18;

/// An integrand: dimensions s, share a of the smooth part.
#[derive(Clone, Copy)]
struct Integrand {
    s: u32,
    a: f64,
}

impl Integrand {
    fn at(self, u: &[f64; 3]) -> f64 {
        let sum: f64 = u[..self.s as usize].iter().sum();
        let s = f64::from(self.s);
        self.a * sum + (1.0 - s * self.a) * f64::from(u8::from(2.0 * sum > s))
    }
}

/// Squared errors of the mean: one row a randomisation, one column a size. All sizes are first parts of one stretch.
fn squared_errors(sequence: Sequence, integrands: &[Integrand]) -> Vec<Vec<Vec<f64>>> {
    let mut errors = vec![Vec::new(); integrands.len()];
    for seed in 0..RANDOMISATIONS {
        let points = OtherPoints::new(sequence, 1000 + seed, 0, None).unwrap();
        let mut sums = vec![0.0; integrands.len()];
        let mut rows = vec![Vec::new(); integrands.len()];
        let mut next = 0;
        for exponent in EXPONENTS {
            let end = 1u64 << exponent;
            for i in next..end {
                let u = [0, 1, 2].map(|c| to_unit_f64(points.coordinate(i, c)));
                for (sum, f) in sums.iter_mut().zip(integrands) {
                    *sum += f.at(&u);
                }
            }
            next = end;
            for (row, sum) in rows.iter_mut().zip(&sums) {
                row.push((sum / end as f64 - 0.5).powi(2));
            }
        }
        for (all, row) in errors.iter_mut().zip(rows) {
            all.push(row);
        }
    }
    errors
}

/// Least-squares slope of log RMS error against log N over all rows but the one left out.
fn slope(errors: &[Vec<f64>], without: Option<usize>) -> f64 {
    let log_n: Vec<f64> = EXPONENTS.map(f64::from).collect();
    let rows = errors.iter().enumerate().filter(|(k, _)| Some(*k) != without);
    let mut sums = vec![0.0; log_n.len()];
    rows.for_each(|(_, row)| sums.iter_mut().zip(row).for_each(|(s, e)| *s += e));
    let mean = log_n.iter().sum::<f64>() / log_n.len() as f64;
    let spread: f64 = log_n.iter().map(|x| (x - mean).powi(2)).sum();
    // A constant factor, the number of rows among them, does not change a slope.
    log_n.iter().zip(&sums).map(|(x, s)| (x - mean) * 0.5 * s.log2()).sum::<f64>() / spread
}

/// The slope and its standard error by the jackknife over randomisations, which sees that the sizes share their points.
fn slope_with_error(errors: &[Vec<f64>]) -> (f64, f64) {
    let left: Vec<f64> = (0..errors.len()).map(|k| slope(errors, Some(k))).collect();
    let n = left.len() as f64;
    let mean = left.iter().sum::<f64>() / n;
    let variance = left.iter().map(|s| (s - mean).powi(2)).sum::<f64>() * (n - 1.0) / n;
    (slope(errors, None), variance.sqrt())
}

/// What theory says of a slope.
#[derive(Clone, Copy)]
enum Theory {
    /// This slope.
    Is(f64),
    /// No flatter than this.
    AtMost(f64),
}

/// Slope of log N / N between the least and the greatest N: what a sum of functions of one coordinate has at worst under
/// Halton points, each coordinate of which has discrepancy O(log N / N).
fn slope_of_log_n_by_n() -> f64 {
    let (least, greatest) = (f64::from(*EXPONENTS.start()), f64::from(*EXPONENTS.end()));
    (greatest / least).log2() / (greatest - least) - 1.0
}

/// Fits the slopes of a sequence for all four integrands, prints them, and holds them against theory: with twelve slopes in
/// all, 3.9 standard errors are a chance of 1e-3 of any false alarm.
fn check(sequence: Sequence, jump: impl Fn(f64) -> Theory, smooth: Theory) {
    let integrands = [
        Integrand { s: 2, a: 0.0 },
        Integrand { s: 2, a: 0.5 },
        Integrand { s: 3, a: 0.0 },
        Integrand { s: 3, a: 1.0 / 3.0 },
    ];
    for (f, errors) in integrands.iter().zip(squared_errors(sequence, &integrands)) {
        let (slope, error) = slope_with_error(&errors);
        let (name, s) = (sequence.name(), f64::from(f.s));
        println!("{name:<16} s = {s}, a = {:.2}: slope {slope:.3} +- {error:.3}", f.a);
        assert!(error > 0.0 && error < 0.03, "{name}: {error}");
        match if f.a == 0.0 { jump(s) } else { smooth } {
            Theory::Is(theory) => assert!((slope - theory).abs() < 3.9 * error, "{name}: {theory}"),
            Theory::AtMost(bound) => assert!(slope + 3.9 * error < bound, "{name}: {bound}"),
        }
    }
}

#[test]
fn monte_carlo_gains_a_root_whatever_the_integrand() {
    check(Sequence::Independent, |_| Theory::Is(-0.5), Theory::Is(-0.5));
}

#[test]
fn halton_points_lose_at_a_jump() {
    let bound = Theory::AtMost(slope_of_log_n_by_n());
    check(Sequence::HaltonRotation, |s| Theory::Is(-0.5 - 0.5 / s), bound);
}

#[test]
fn scrambled_sobol_points_lose_at_a_jump_and_gain_half_an_order_where_it_is_smooth() {
    // N^-3/2 for smooth integrands: A. B. Owen, Ann. Statist. 25 (1997) 1541-1562.
    check(Sequence::SobolOwen, |s| Theory::Is(-0.5 - 0.5 / s), Theory::Is(-1.5));
}
