//! Gauss-Legendre quadrature: the certificate's own route to an integral, by values and not by
//! antiderivatives.

use std::f64::consts::PI;

/// Nodes of the rule along a polar angle. sin(theta) times a linear function over half a turn, the widest row
/// there can be, is integrated to 1e-15 of its value.
pub const NODES: usize = 12;

/// The Gauss-Legendre rule of [`NODES`] nodes on [0, 1]: exact for polynomials of degree 23.
#[derive(Debug, Clone)]
pub struct Gauss {
    nodes: [f64; NODES],
    weights: [f64; NODES],
}

impl Gauss {
    /// Nodes are the roots of the Legendre polynomial, by Newton's method from Tricomi's starting values.
    pub fn new() -> Self {
        let (mut nodes, mut weights) = ([0.0; NODES], [0.0; NODES]);
        for (i, (node, weight)) in nodes.iter_mut().zip(&mut weights).enumerate() {
            let mut x = -libm::cos(PI * (i as f64 + 0.75) / (NODES as f64 + 0.5));
            // Quadratic convergence from an error below 1e-3: four steps reach the last bit, two more cost
            // nothing.
            for _ in 0..6 {
                let (value, slope) = legendre(x);
                x -= value / slope;
            }
            let (_, slope) = legendre(x);
            *node = 0.5 * (1.0 + x);
            *weight = 1.0 / ((1.0 - x * x) * slope * slope);
        }
        Self { nodes, weights }
    }

    /// Nodes with their weights.
    #[inline]
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.nodes.iter().copied().zip(self.weights.iter().copied())
    }
}

/// The Legendre polynomial of degree [`NODES`] and its derivative, -1 < x < 1.
fn legendre(x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for k in 2..=NODES {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    (value, NODES as f64 * (x * value - before) / (x * x - 1.0))
}

/// The two nodes of the two-point rule on [0, 1], 1/2 -+ 1/sqrt(12); their weights are 1/2. Exact for cubics.
pub const TWO_POINT: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// The values at the fraction t of an interval of the two linear functions that are 1 at one of [`TWO_POINT`]
/// and 0 at the other.
pub fn at_nodes(t: f64) -> [f64; 2] {
    let [near, far] = TWO_POINT;
    [(far - t) / (far - near), (t - near) / (far - near)]
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Gauss {
        fn integrate(&self, a: f64, width: f64, f: impl Fn(f64) -> f64) -> f64 {
            width * self.points().map(|(x, w)| w * f(a + x * width)).sum::<f64>()
        }
    }

    #[test]
    fn polynomials_up_to_degree_23_are_exact() {
        let rule = Gauss::new();
        for degree in 0..=23 {
            let got = rule.integrate(0.0, 2.0, |x| x.powi(degree));
            let exact = 2f64.powi(degree + 1) / f64::from(degree + 1);
            assert!((got / exact - 1.0).abs() < 1e-14, "{degree}: {got} {exact}");
        }
        // And no further: the first error of the rule, (12!)^4 / (25 (24!)^2) on [0, 1], is there.
        let got = rule.integrate(0.0, 1.0, |x| x.powi(24));
        assert!((0.04 - got) > 1e-17 && (0.04 - got) < 1e-14);
    }

    #[test]
    fn the_widest_row_is_integrated() {
        let rule = Gauss::new();
        assert!((rule.integrate(0.0, PI, libm::sin) - 2.0).abs() < 4e-15);
        assert!((rule.integrate(0.0, PI, |t| t * libm::sin(t)) - PI).abs() < 8e-15);
    }

    #[test]
    fn two_points_integrate_cubics() {
        for (degree, exact) in [(0, 1.0), (1, 0.5), (2, 1.0 / 3.0), (3, 0.25)] {
            let got = 0.5 * TWO_POINT.iter().map(|x| x.powi(degree)).sum::<f64>();
            assert!((got - exact).abs() < 1e-15, "{degree}: {got}");
        }
    }
}
