//! The L2-star discrepancy of points of the unit square, and what it is for random points.
//!
//! T^2 is the integral over (x, y) of (share of the points in [0, x) x [0, y), less x y)^2. Warnock (1972):
//!
//! T^2 = 1/9 - 1/(2 N) sum_i (1 - x_i^2)(1 - y_i^2) + 1/N^2 sum_ij (1 - max(x_i, x_j))(1 - max(y_i, y_j)).
//!
//! The double sum is taken in N log N steps: points in the order of x, the sums over the earlier ones from a
//! Fenwick tree over the ranks of y.
//!
//! Of N random points N T^2 has the mean 5/36 exactly, and converges to the integral of a squared Gaussian
//! process with covariance min(x, x') min(y, y') - x x' y y' ([`random_tail`]).

use std::f64::consts::PI;

/// N T^2 of random points in the mean: 1/4 - 1/9.
pub const RANDOM_MEAN: f64 = 5.0 / 36.0;

/// T^2, the squared L2-star discrepancy; the points are reordered. 0 for no points.
pub fn squared_l2_star(points: &mut [[f64; 2]]) -> f64 {
    let n = points.len();
    if n == 0 {
        return 0.0;
    }
    points.sort_unstable_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
    let mut order: Vec<u32> = (0..n as u32).collect();
    order.sort_unstable_by(|i, j| points[*i as usize][1].total_cmp(&points[*j as usize][1]).then(i.cmp(j)));
    let mut rank = vec![0u32; n];
    for (at, point) in order.iter().enumerate() {
        rank[*point as usize] = at as u32;
    }
    let (mut single, mut pairs) = (Sum::default(), Sum::default());
    let mut earlier = Fenwick(vec![(0, Sum::default()); n + 1]);
    let mut above = Sum::default();
    for (i, [x, y]) in points.iter().enumerate() {
        let (count, sum) = earlier.below(rank[i]);
        // Earlier points of lower y meet this one at (x, y), those of higher y at (x, their own y).
        let partners = count as f64 * (1.0 - y) + (above.value() - sum);
        pairs.add((1.0 - x) * (2.0 * partners + (1.0 - y)));
        single.add((1.0 - x * x) * (1.0 - y * y));
        earlier.insert(rank[i], 1.0 - y);
        above.add(1.0 - y);
    }
    let n = n as f64;
    // T^2 of a good set is far below the three terms: their sums are compensated, and what rounding leaves
    // below 0 is 0.
    (1.0 / 9.0 - single.value() / (2.0 * n) + pairs.value() / (n * n)).max(0.0)
}

/// A sum with Neumaier's compensation.
#[derive(Debug, Clone, Copy, Default)]
struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    fn add(&mut self, x: f64) {
        let sum = self.sum + x;
        self.lost += if self.sum.abs() >= x.abs() { (self.sum - sum) + x } else { (x - sum) + self.sum };
        self.sum = sum;
    }

    fn value(&self) -> f64 {
        self.sum + self.lost
    }
}

/// Counts and sums over ranks below a given one, in log N steps (Fenwick 1994).
struct Fenwick(Vec<(u32, Sum)>);

impl Fenwick {
    fn insert(&mut self, rank: u32, value: f64) {
        let mut at = rank as usize + 1;
        while at < self.0.len() {
            self.0[at].0 += 1;
            self.0[at].1.add(value);
            at += at & at.wrapping_neg();
        }
    }

    fn below(&self, rank: u32) -> (u32, f64) {
        let (mut count, mut sum, mut at) = (0, 0.0, rank as usize);
        while at > 0 {
            count += self.0[at].0;
            sum += self.0[at].1.value();
            at -= at & at.wrapping_neg();
        }
        (count, sum)
    }
}

/// Eigenvalues of min(x, x') on the unit interval that are kept; what their products leave of the mean, 5 %,
/// is taken as a constant, for its variance is below 1e-4 of the whole.
const EIGENVALUES: usize = 16;

/// P(N T^2 > w) for many random points.
///
/// With l_j = 1 / ((j - 1/2)^2 pi^2) and L_jk = l_j l_k the operator of the covariance is diag(L) - v v^T,
/// v_jk = +-2 L_jk, and the characteristic function of the limit is det(1 - 2 i t (diag(L) - v v^T))^(-1/2);
/// it is inverted by the sum of Davies (1973).
pub fn random_tail(w: f64) -> f64 {
    let axis: Vec<f64> = (0..EIGENVALUES).map(|j| 1.0 / ((j as f64 + 0.5) * PI).powi(2)).collect();
    let products: Vec<f64> = axis.iter().flat_map(|a| axis.iter().map(move |b| a * b)).collect();
    // The trace is 1/4 less v.v, and v.v is 1/9.
    let kept: f64 = products.iter().map(|l| l - 4.0 * l * l).sum();
    let w = w - (RANDOM_MEAN - kept);
    if w <= 0.0 {
        return 1.0;
    }
    // Aliases of the sum lie 2 pi / step away: more than the law reaches on either side.
    let step = 2.0 * PI / (w + 6.0);
    let mut sum = 0.0;
    for k in 0..100_000 {
        let t = (f64::from(k) + 0.5) * step;
        let (log_modulus, phase) = characteristic(&products, t);
        if log_modulus < -32.0 {
            break; // Below 2e-14.
        }
        sum += libm::exp(log_modulus) * libm::sin(phase - t * w) / (PI * (f64::from(k) + 0.5));
    }
    (0.5 + sum).clamp(0.0, 1.0)
}

/// Logarithm of the modulus, and phase, of the characteristic function at t.
fn characteristic(products: &[f64], t: f64) -> (f64, f64) {
    // 1 / (1 - i x) = (1 + i x) / (1 + x^2), x = 2 t L.
    let (mut log_modulus, mut phase, mut re, mut im) = (0.0, 0.0, 1.0, 0.0);
    for l in products {
        let x = 2.0 * t * l;
        let square = 1.0 + x * x;
        log_modulus -= 0.25 * libm::log(square);
        phase += 0.5 * libm::atan(x);
        // The rank-one term, 1 + 2 i t v^T (1 - 2 i t L)^-1 v.
        let weight = 8.0 * t * l * l / square;
        re -= weight * x;
        im += weight;
    }
    // Its argument stays within a right angle, for the eigenvalues of the difference interlace those of L.
    log_modulus -= 0.25 * libm::log(re * re + im * im);
    phase -= 0.5 * libm::atan2(im, re);
    (log_modulus, phase)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::hash::mix64;
    use crate::sequence::to_unit_f64;

    fn random(n: u64, seed: u64) -> Vec<[f64; 2]> {
        let u = |i: u64| to_unit_f64(mix64(mix64(seed) ^ i));
        (0..n).map(|i| [u(2 * i), u(2 * i + 1)]).collect()
    }

    #[test]
    fn one_point_and_warnocks_double_sum() {
        // One point at the origin: the integral of (1 - x y)^2 is 1 - 2/4 + 1/9.
        let one = squared_l2_star(&mut [[0.0, 0.0]]);
        assert!((one - 11.0 / 18.0).abs() < 1e-15, "{one}");
        assert_eq!(squared_l2_star(&mut []), 0.0);
        let mut points = random(300, 5);
        points.extend([[0.5, 0.25], [0.5, 0.25], [0.5, 0.75], [0.125, 0.25], [0.0, 1.0]]); // Equal coordinates.
        let n = points.len() as f64;
        let mut expected = 1.0 / 9.0;
        for p in &points {
            expected -= (1.0 - p[0] * p[0]) * (1.0 - p[1] * p[1]) / (2.0 * n);
            for q in &points {
                expected += (1.0 - p[0].max(q[0])) * (1.0 - p[1].max(q[1])) / (n * n);
            }
        }
        let got = squared_l2_star(&mut points);
        assert!((got - expected).abs() < 1e-14, "{got} {expected}");
    }

    #[test]
    fn random_points_have_the_tail_of_the_limit() {
        // 4000 sets of 200 points: the share beyond each quantile within 4.5 sigma of what the limit says.
        let sets = 4000;
        let mut values: Vec<f64> =
            (0..sets).map(|seed| 200.0 * squared_l2_star(&mut random(200, seed))).collect();
        values.sort_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / sets as f64;
        // Standard deviation of the limit: sqrt(2 (1/36 - 2 (2/15)^2 + 1/81)).
        let deviation = (2.0f64 * (1.0 / 36.0 - 8.0 / 225.0 + 1.0 / 81.0)).sqrt();
        assert!((mean - RANDOM_MEAN).abs() < 4.5 * deviation / (sets as f64).sqrt(), "{mean}");
        for share in [0.9, 0.5, 0.1, 0.01] {
            let at = ((1.0 - share) * sets as f64) as usize;
            let tail = random_tail(values[at]);
            let sigma = (share * (1.0 - share) / sets as f64).sqrt();
            assert!((tail - share).abs() < 4.5 * sigma, "{share}: {tail}");
        }
    }

    #[test]
    fn tail_has_the_mean_and_variance_of_the_limit_and_ends() {
        // Mean = integral of the tail, second moment = integral of 2 w tail; Simpson over x, w = x^2.
        let (steps, h) = (120, 1.0 / 60.0);
        let (mut mean, mut second) = (0.0, 0.0);
        for i in 0..=steps {
            let weight = if i == 0 || i == steps {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            };
            let x = f64::from(i) * h;
            let tail = weight * h / 3.0 * 2.0 * x * random_tail(x * x);
            mean += tail;
            second += 2.0 * x * x * tail;
        }
        assert!((mean - RANDOM_MEAN).abs() < 1e-4, "{mean}");
        let variance = 2.0 * (1.0 / 36.0 - 8.0 / 225.0 + 1.0 / 81.0);
        assert!((second - mean * mean - variance).abs() < 1e-4, "{}", second - mean * mean);
        assert!(random_tail(1e-3) > 0.999_999 && random_tail(4.0) < 1e-6 && random_tail(1e6) < 1e-12);
    }

    #[test]
    fn a_lattice_is_far_better_than_random_points() {
        let n = 987u64; // Fibonacci: 610 / 987.
        let mut points: Vec<[f64; 2]> =
            (0..n).map(|i| [i as f64 / n as f64, (610 * i % n) as f64 / n as f64]).collect();
        let scaled = n as f64 * squared_l2_star(&mut points);
        assert!(scaled < 0.05 * RANDOM_MEAN, "{scaled}");
    }
}
