//! The paper's norm: root mean square, over the area, of the distance of two colours.

/// sqrt( sum A d^2 / sum A ), d the Euclidean distance of two radiances [r, g, b] of a cell of area A, both in units of the
/// greatest channel of any cell of `better`, so that this lies in [0, 1] as the paper's do. NaN without light.
pub fn deviation(areas_m2: &[f64], estimate: &[[f64; 3]], better: &[[f64; 3]]) -> f64 {
    let greatest = better.iter().flatten().copied().fold(0.0, f64::max);
    let mut squares = 0.0;
    for ((area, a), b) in areas_m2.iter().zip(estimate).zip(better) {
        let d2: f64 = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum();
        squares += area * d2;
    }
    (squares / areas_m2.iter().sum::<f64>()).sqrt() / greatest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn norm_is_the_one_computed_by_hand() {
        // Greatest 10: differences (0.1, 0.2, 0.2) -> d = 0.3 on area 1; (0, 0, 0.4) on area 3.
        let better = [[10.0, 2.0, 3.0], [1.0, 1.0, 1.0]];
        let estimate = [[11.0, 4.0, 1.0], [1.0, 1.0, 5.0]];
        let expected = ((0.09 + 3.0 * 0.16) / 4.0f64).sqrt();
        assert!((deviation(&[1.0, 3.0], &estimate, &better) - expected).abs() < 1e-15);
        // Any unit of radiance and of area gives the same.
        let scaled = |m: &[[f64; 3]]| m.iter().map(|c| c.map(|x| 8.0 * x)).collect::<Vec<_>>();
        let other = deviation(&[0.5, 1.5], &scaled(&estimate), &scaled(&better));
        assert!((other - expected).abs() < 1e-15);
        assert_eq!(deviation(&[1.0, 3.0], &better, &better), 0.0);
    }
}
