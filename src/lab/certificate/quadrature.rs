//! Gauss-Legendre quadrature: the certificate's own route to an integral, by values and not by
//! antiderivatives.

/// Nodes and weights of the Gauss-Legendre rule on [0, 1], exact for polynomials of degree 23. Along a polar angle sin(theta)
/// times a linear function over half a turn, the widest row there can be, is integrated to 1e-15 of its value.
pub const GAUSS: [(f64, f64); 12] = [
    (0.009_219_682_876_640_378, 0.023_587_668_193_255_917),
    (0.047_941_371_814_762_6, 0.053_469_662_997_659_28),
    (0.115_048_662_902_847_65, 0.080_039_164_271_673_17),
    (0.206_341_022_856_691_26, 0.101_583_713_361_532_92),
    (0.316_084_250_500_909_94, 0.116_746_268_269_177_39),
    (0.437_383_295_744_265_54, 0.124_573_522_906_701_44),
    (0.562_616_704_255_734_4, 0.124_573_522_906_701_44),
    (0.683_915_749_499_090_1, 0.116_746_268_269_177_39),
    (0.793_658_977_143_308_7, 0.101_583_713_361_532_92),
    (0.884_951_337_097_152_3, 0.080_039_164_271_673_17),
    (0.952_058_628_185_237_5, 0.053_469_662_997_659_28),
    (0.990_780_317_123_359_6, 0.023_587_668_193_255_917),
];

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
    use std::f64::consts::PI;

    use super::*;

    fn integrate(a: f64, width: f64, f: impl Fn(f64) -> f64) -> f64 {
        width * GAUSS.iter().map(|(x, w)| w * f(a + x * width)).sum::<f64>()
    }

    /// The Legendre polynomial of the rule's degree and its derivative, -1 < x < 1.
    fn legendre(x: f64) -> (f64, f64) {
        let (mut before, mut value) = (1.0, x);
        for k in 2..=GAUSS.len() {
            let k = k as f64;
            (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
        }
        (value, GAUSS.len() as f64 * (x * value - before) / (x * x - 1.0))
    }

    /// Nodes are the roots of the Legendre polynomial, by Newton's method from Tricomi's starting values.
    #[test]
    fn the_table_is_that_of_the_polynomials_roots() {
        for (i, pair) in GAUSS.into_iter().enumerate() {
            let mut x = -libm::cos(PI * (i as f64 + 0.75) / (GAUSS.len() as f64 + 0.5));
            for _ in 0..6 {
                let (value, slope) = legendre(x);
                x -= value / slope;
            }
            let (_, slope) = legendre(x);
            assert_eq!(pair, (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)));
        }
    }

    #[test]
    fn polynomials_up_to_degree_23_are_exact() {
        for degree in 0..=23 {
            let got = integrate(0.0, 2.0, |x| x.powi(degree));
            let exact = 2f64.powi(degree + 1) / f64::from(degree + 1);
            assert!((got / exact - 1.0).abs() < 1e-14, "{degree}: {got} {exact}");
        }
        // And no further: the first error of the rule, (12!)^4 / (25 (24!)^2) on [0, 1], is there.
        let got = integrate(0.0, 1.0, |x| x.powi(24));
        assert!((0.04 - got) > 1e-17 && (0.04 - got) < 1e-14);
    }

    #[test]
    fn the_widest_row_is_integrated() {
        assert!((integrate(0.0, PI, libm::sin) - 2.0).abs() < 4e-15);
        assert!((integrate(0.0, PI, |t| t * libm::sin(t)) - PI).abs() < 8e-15);
    }

    #[test]
    fn two_points_integrate_cubics() {
        for (degree, exact) in [(0, 1.0), (1, 0.5), (2, 1.0 / 3.0), (3, 0.25)] {
            let got = 0.5 * TWO_POINT.iter().map(|x| x.powi(degree)).sum::<f64>();
            assert!((got - exact).abs() < 1e-15, "{degree}: {got}");
        }
    }
}
