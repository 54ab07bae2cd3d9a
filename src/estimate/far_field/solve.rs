//! The node values of a table: M c = b, and the same where no value may be negative.

use super::mass::Mass;

/// Rounds of the search for the nodes that are 0, at most: it takes about ten.
const MOST_ROUNDS: usize = 200;
/// Rounds without fewer nodes in the wrong before nodes change one by one (Portugal, Judice and Vicente, "A comparison of
/// block pivoting and interior-point algorithms for linear least squares problems with nonnegative variables", 1994).
const PATIENCE: usize = 5;
/// Steps of conjugate gradients, at most. M scaled by its diagonal has a condition number of about 9, so each of them halves
/// the error.
const MOST_STEPS: usize = 400;
/// Residual at which they end, of the right side's.
const RESIDUAL: f64 = 1e-15;

/// c with M c = b.
pub fn solve(mass: &Mass, b: &[f64]) -> Vec<f64> {
    let free: Vec<bool> = (0..mass.entries()).map(|entry| mass.is_node(entry)).collect();
    solve_free(mass, &mass.diagonal(), b, &free)
}

/// The same in the entries that are free, the others 0: by conjugate gradients, scaled by the diagonal.
fn solve_free(mass: &Mass, diagonal: &[f64], b: &[f64], free: &[bool]) -> Vec<f64> {
    let scaled = |r: &[f64]| -> Vec<f64> {
        (0..r.len()).map(|i| if free[i] { r[i] / diagonal[i] } else { 0.0 }).collect()
    };
    let mut x = vec![0.0; b.len()];
    let mut r: Vec<f64> = (0..b.len()).map(|i| if free[i] { b[i] } else { 0.0 }).collect();
    let mut z = scaled(&r);
    let mut p = z.clone();
    let mut rz = dot(&r, &z);
    let end = RESIDUAL * RESIDUAL * rz;
    for _ in 0..MOST_STEPS {
        if rz <= end {
            break;
        }
        let q = mass.apply(&p);
        let step = rz / dot(&p, &q);
        for i in 0..x.len() {
            x[i] += step * p[i];
            if free[i] {
                r[i] -= step * q[i];
            }
        }
        z = scaled(&r);
        let before = std::mem::replace(&mut rz, dot(&r, &z));
        let onward = rz / before;
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + onward * *p);
    }
    x
}

/// c >= 0 that minimises c'Mc - 2b'c with sum c_j m_j = sum b_j, m_j the integral of hat j (METHOD 8); the number of
/// nodes held at 0 that would be negative else. A sum of 0 gives zeros.
///
/// Where the nodes of F are free and the others 0, c solves M c = b + l m in F, and l makes the sum right. Nodes where that
/// c is negative leave F, others at which the gradient is negative join it, until there are none.
pub fn solve_positive(mass: &Mass, b: &[f64]) -> (Vec<f64>, usize) {
    let (diagonal, m) = (mass.diagonal(), mass.solid_angles_sr());
    let sum: f64 = b.iter().sum();
    let mut free: Vec<bool> = (0..mass.entries()).map(|entry| mass.is_node(entry)).collect();
    let nodes = free.iter().filter(|f| **f).count();
    if sum <= 0.0 {
        return (vec![0.0; mass.entries()], 0);
    }
    // A value or a gradient this far on the wrong side is rounding.
    let largest =
        b.iter().zip(&diagonal).filter(|(_, d)| **d > 0.0).map(|(b, d)| b.abs() / d).fold(0.0, f64::max);
    let noise = 1e-12 * largest;
    let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
    let mut c = Vec::new();
    for _ in 0..MOST_ROUNDS {
        let (y, z) = (solve_free(mass, &diagonal, b, &free), solve_free(mass, &diagonal, &m, &free));
        let lambda = (sum - dot(&m, &y)) / dot(&m, &z);
        c = y.iter().zip(&z).map(|(y, z)| y + lambda * z).collect::<Vec<f64>>();
        let mc = mass.apply(&c);
        let gradient = |i: usize| (mc[i] - b[i] - lambda * m[i]) / diagonal[i];
        let is_wrong =
            |i: &usize| mass.is_node(*i) && if free[*i] { c[*i] < -noise } else { gradient(*i) < -noise };
        let wrong: Vec<usize> = (0..c.len()).filter(is_wrong).collect();
        if wrong.is_empty() {
            break;
        }
        if wrong.len() < fewest {
            (fewest, patience) = (wrong.len(), PATIENCE);
        } else {
            patience = patience.saturating_sub(1);
        }
        let changed = if patience > 0 { &wrong[..] } else { &wrong[wrong.len() - 1..] };
        changed.iter().for_each(|&i| free[i] = !free[i]);
    }
    c.iter_mut().for_each(|c| *c = c.max(0.0));
    (c, nodes - free.iter().filter(|f| **f).count())
}

/// The sum of products.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::nodes::Nodes;

    fn mass() -> Mass {
        let gamma_deg = (0..=18).map(|i| 10.0 * f64::from(i)).collect();
        Mass::new(&Nodes { gamma_deg, c_deg: (0..8).map(|i| 45.0 * f64::from(i)).collect() })
    }

    /// A beam that is narrow for the grid: all on two nodes, and noise elsewhere.
    fn narrow(mass: &Mass) -> Vec<f64> {
        let mut b = vec![0.0; mass.entries()];
        (b[0], b[8], b[9]) = (1.0, 0.3, 0.1);
        b[60] = 1e-3;
        b
    }

    #[test]
    fn a_table_comes_back() {
        let mass = mass();
        let c: Vec<f64> = (0..mass.entries())
            .map(|i| if mass.is_node(i) { 1.0 + ((i * 37) % 11) as f64 } else { 0.0 })
            .collect();
        let again = solve(&mass, &mass.apply(&c));
        for (a, b) in again.iter().zip(&c) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }

    /// The conditions of Karush, Kuhn and Tucker, which only the minimum meets.
    #[test]
    fn positive_values_are_the_minimum_and_keep_the_flux() {
        let mass = mass();
        let b = narrow(&mass);
        let free = solve(&mass, &b);
        assert!(free.iter().any(|c| *c < -0.1), "a beam this narrow overshoots");
        let (c, held) = solve_positive(&mass, &b);
        let m = mass.solid_angles_sr();
        assert!((dot(&c, &m) - 1.401).abs() < 1e-13, "{}", dot(&c, &m));
        assert!(held > 5 && c.iter().all(|c| *c >= 0.0), "{held}");
        let mc = mass.apply(&c);
        // Of a positive node (M c - b) / m is the multiplier, of one at 0 it is no less.
        let ratio = |i: usize| (mc[i] - b[i]) / m[i];
        let positive: Vec<usize> = (0..c.len()).filter(|i| c[*i] > 1e-9).collect();
        let lambda = ratio(positive[0]);
        assert!(positive.iter().all(|i| (ratio(*i) - lambda).abs() < 1e-9));
        let at_zero = (0..c.len()).filter(|i| mass.is_node(*i) && c[*i] <= 1e-9);
        assert!(at_zero.into_iter().all(|i| ratio(i) > lambda - 1e-9));
    }

    #[test]
    fn nothing_gives_nothing_and_what_is_positive_stays() {
        let mass = mass();
        assert_eq!(solve_positive(&mass, &vec![0.0; mass.entries()]), (vec![0.0; mass.entries()], 0));
        let c: Vec<f64> = (0..mass.entries()).map(|i| f64::from(u8::from(mass.is_node(i)))).collect();
        let (again, held) = solve_positive(&mass, &mass.apply(&c));
        assert!(held == 0 && again.iter().zip(&c).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
