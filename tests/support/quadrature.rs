//! Gauss-Legendre and adaptive quadrature, means over cells, bracketed roots: the tests' own numbers, none of the library's.

use std::f64::consts::PI;

/// A Gauss-Legendre rule on [-1, 1]: exact for polynomials of degree 2 n - 1.
#[derive(Debug, Clone)]
pub struct Gauss {
    nodes: Vec<f64>,
    weights: Vec<f64>,
}

impl Gauss {
    /// The rule of n nodes: roots of the Legendre polynomial by Newton from Chebyshev-like starts.
    pub fn new(n: usize) -> Self {
        let (mut nodes, mut weights) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for i in 0..n {
            let mut x = -(PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..8 {
                let (p, dp) = legendre(n, x);
                x -= p / dp;
                slope = legendre(n, x).1;
            }
            nodes.push(x);
            weights.push(2.0 / ((1.0 - x * x) * slope * slope));
        }
        Self { nodes, weights }
    }

    /// Integral of f over [a, b].
    pub fn integrate(&self, a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        half * self.nodes.iter().zip(&self.weights).map(|(x, w)| w * f(middle + half * x)).sum::<f64>()
    }

    /// (x, weight) of the rule on [a, b].
    pub fn points(&self, a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        self.nodes.iter().zip(&self.weights).map(move |(x, w)| (middle + half * x, half * w))
    }

    /// Integral over consecutive panels between these edges.
    pub fn over_panels(&self, edges: &[f64], mut f: impl FnMut(f64) -> f64) -> f64 {
        edges.windows(2).map(|e| self.integrate(e[0], e[1], &mut f)).sum()
    }
}

/// (P_n(x), P_n'(x)).
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
    }
    (p, n as f64 * (x * p - before) / (x * x - 1.0))
}

/// Adaptive integral of f over [a, b]: a panel is halved until two halves and the whole (10 nodes each) agree to
/// `tolerance`, shared out among the halves, or the depth is used up.
pub fn adaptive(a: f64, b: f64, tolerance: f64, f: &impl Fn(f64) -> f64) -> f64 {
    let rule = Gauss::new(10);
    halve(&rule, (a, b), rule.integrate(a, b, f), tolerance, 40, f)
}

fn halve(
    rule: &Gauss,
    (a, b): (f64, f64),
    whole: f64,
    tolerance: f64,
    depth: u32,
    f: &impl Fn(f64) -> f64,
) -> f64 {
    let middle = 0.5 * (a + b);
    let (left, right) = (rule.integrate(a, middle, f), rule.integrate(middle, b, f));
    if depth == 0 || (left + right - whole).abs() <= tolerance {
        return left + right;
    }
    halve(rule, (a, middle), left, 0.5 * tolerance, depth - 1, f)
        + halve(rule, (middle, b), right, 0.5 * tolerance, depth - 1, f)
}

/// A composite rule on [0, 1]: `panels` panels of the 4-point rule.
pub fn composite(panels: usize) -> Vec<(f64, f64)> {
    let rule: Vec<(f64, f64)> = Gauss::new(4).points(0.0, 1.0).collect();
    let width = 1.0 / panels as f64;
    (0..panels).flat_map(|p| rule.iter().map(move |(x, w)| ((p as f64 + x) * width, w * width))).collect()
}

/// Means of `f(u, v)` over nu x nv equal cells of the unit square, in the order of a receiver: row 0 at the top (v = 1).
pub fn cell_means(nu: usize, nv: usize, panels: usize, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let rule = composite(panels);
    let mut means = Vec::with_capacity(nu * nv);
    for row in 0..nv {
        let v0 = (nv - 1 - row) as f64;
        for column in 0..nu {
            let mut sum = 0.0;
            for (y, wy) in &rule {
                for (x, wx) in &rule {
                    sum += wx * wy * f((column as f64 + x) / nu as f64, (v0 + y) / nv as f64);
                }
            }
            means.push(sum);
        }
    }
    means
}

/// The root of an increasing function between `low` and `high`, by bisection to the last bit.
pub fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if f(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
