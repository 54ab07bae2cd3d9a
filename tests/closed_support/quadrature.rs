//! Gauss-Legendre quadrature and bracketed roots: the tests' own numbers, none of the library's.

/// Nodes and weights of the n-point rule on [0, 1], by Newton's method on the Legendre polynomial.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut p0, mut p1) = (1.0, x);
                for k in 2..=n {
                    let k = k as f64;
                    (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
                }
                slope = n as f64 * (x * p1 - p0) / (x * x - 1.0);
                x -= p1 / slope;
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// A composite rule on [0, 1]: `panels` panels of the 4-point rule.
pub fn composite(panels: usize) -> Vec<(f64, f64)> {
    let rule = gauss_legendre(4);
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
