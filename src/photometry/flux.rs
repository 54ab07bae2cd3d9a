//! Luminous flux of a web: the industry's trapezoid, and the exact integral of the bilinear table.
//!
//! The two differ by less than a per cent for most tables, by more where a beam is narrow for the steps of its angles.
//! The first is the number on data sheets (AGi32 Photometric
//! Toolbox); the second is what photons carry that are emitted by bilinear interpolation.

use super::FullGrid;

/// Flux in lm of `value x multiplier` over an unfolded grid, as the lighting industry integrates it: over V the mean of
/// neighbouring candela times the exact solid angle between them (C: cos V1 - cos V2; A: sin V2 - sin V1; B: the same over
/// H), over the other angle the trapezoid. No ballast factor, no field 12.
pub fn trapezoid_lm(grid: &FullGrid) -> f64 {
    sum_bands(grid, |low, high| {
        let (mid, half) = middle(low, high);
        // (cos low - cos high) / 2, without its cancellation.
        let weight = libm::sin(mid) * libm::sin(half);
        (weight, weight)
    })
}

/// A band between two neighbouring polar angles as the trapezoid sees it: one mean intensity over its solid angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Its polar angles, rad.
    pub polar_rad: [f64; 2],
    /// Mean of its two rows, each integrated around the axis, cd rad.
    pub around: f64,
}

impl Band {
    /// Flux of its part between two polar angles, lm: mean intensity x exact solid angle. The parts of a band add up to it.
    pub fn between_lm(&self, from_rad: f64, to_rad: f64) -> f64 {
        let (low, high) = (from_rad.max(self.polar_rad[0]), to_rad.min(self.polar_rad[1]));
        if low >= high {
            return 0.0;
        }
        let (mid, half) = middle(low, high);
        2.0 * self.around * libm::sin(mid) * libm::sin(half)
    }
}

/// The bands of a grid: what [`trapezoid_lm`] adds up.
pub fn bands(grid: &FullGrid) -> Vec<Band> {
    let rows = rows(grid);
    let bands = rows.windows(2).zip(grid.polar_rad.windows(2));
    bands
        .map(|(row, polar)| Band { polar_rad: [polar[0], polar[1]], around: 0.5 * (row[0] + row[1]) })
        .collect()
}

/// The integral of the bilinear interpolant times sin(polar) over an unfolded grid, lm: closed form, to rounding.
pub fn bilinear_lm(grid: &FullGrid) -> f64 {
    sum_bands(grid, node_weights)
}

/// Integrals of sin(polar) against the two hat functions of a band: `(low node, high node)`, both positive.
///
/// With m the middle, h half the width and s = polar - m: the even part is sin m sin h, the odd part
/// cos m (sin h - h cos h) / h; neither loses digits in narrow bands or at a pole.
pub fn node_weights(low: f64, high: f64) -> (f64, f64) {
    let (mid, half) = middle(low, high);
    let even = libm::sin(mid) * libm::sin(half);
    let odd = libm::cos(mid) * sin_minus_x_cos(half) / half;
    (even - odd, even + odd)
}

fn middle(low: f64, high: f64) -> (f64, f64) {
    (0.5 * (low + high), 0.5 * (high - low))
}

/// sin x - x cos x, by its series x^3/3 - x^5/30 + ... where the difference would cancel.
fn sin_minus_x_cos(x: f64) -> f64 {
    // At the border the direct form has lost two bits; below it eight terms leave less than half an ulp.
    const BORDER: f64 = 1.0;
    if x > BORDER {
        return libm::sin(x) - x * libm::cos(x);
    }
    let x2 = x * x;
    // Terms (-1)^(k+1) 2k x^(2k+1) / (2k+1)!, each from the one before.
    let mut term = x * x2 / 3.0;
    let mut sum = term;
    for k in 2..=10 {
        let k = f64::from(k);
        term *= -x2 / ((2.0 * k - 2.0) * (2.0 * k + 1.0));
        sum += term;
    }
    sum
}

/// The integral of each row around the axis, by the trapezoid, cd rad.
fn rows(grid: &FullGrid) -> Vec<f64> {
    let along_azimuth = |row: &[f64]| -> f64 {
        let cells = row.windows(2).zip(grid.azimuth_rad.windows(2));
        cells.map(|(c, a)| 0.5 * (c[0] + c[1]) * (a[1] - a[0])).sum()
    };
    grid.intensity_cd.chunks_exact(grid.azimuth_rad.len().max(1)).map(along_azimuth).collect()
}

/// Sum over the cells of a grid; `weights(low, high)` are the polar weights of a band's two rows.
fn sum_bands(grid: &FullGrid, weights: impl Fn(f64, f64) -> (f64, f64)) -> f64 {
    let rows = rows(grid);
    let bands = rows.windows(2).zip(grid.polar_rad.windows(2));
    bands
        .map(|(row, polar)| {
            let (low, high) = weights(polar[0], polar[1]);
            low * row[0] + high * row[1]
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::super::PhotometricType::{A, B, C};
    use super::super::Web;
    use super::*;
    use std::f64::consts::PI;

    /// Nodes and weights of 20-point Gauss-Legendre on [-1, 1], by Newton on the recurrence.
    fn gauss(n: usize) -> Vec<(f64, f64)> {
        let legendre = |x: f64| {
            let (mut p0, mut p1) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
            }
            (p1, n as f64 * (x * p1 - p0) / (x * x - 1.0))
        };
        (0..n)
            .map(|i| {
                let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
                for _ in 0..20 {
                    let (p, d) = legendre(x);
                    x -= p / d;
                }
                let d = legendre(x).1;
                (x, 2.0 / ((1.0 - x * x) * d * d))
            })
            .collect()
    }

    /// Integral of intensity_cd over one type's solid angle by quadrature in degrees, cell by cell of the given breaks.
    fn quadrature(web: &Web, v_breaks: &[f64], h_breaks: &[f64]) -> f64 {
        let rule = gauss(20);
        let mut sum = 0.0;
        for v in v_breaks.windows(2) {
            for h in h_breaks.windows(2) {
                for &(x, wx) in &rule {
                    for &(y, wy) in &rule {
                        let vertical = 0.5 * (v[0] + v[1]) + 0.5 * (v[1] - v[0]) * x;
                        let horizontal = 0.5 * (h[0] + h[1]) + 0.5 * (h[1] - h[0]) * y;
                        let density = match web.photometric_type {
                            C => vertical.to_radians().sin(),
                            A => vertical.to_radians().cos(),
                            B => horizontal.to_radians().cos(),
                        };
                        let area = (0.5 * (v[1] - v[0])).to_radians() * (0.5 * (h[1] - h[0])).to_radians();
                        sum += wx * wy * area * density * web.intensity_cd(vertical, horizontal);
                    }
                }
            }
        }
        sum
    }

    fn uneven(n: usize) -> Vec<f64> {
        (0..n).map(|i| ((i * 7919 + 13) % 101) as f64 + 0.5).collect()
    }

    #[test]
    fn exact_integral_equals_gauss_quadrature() {
        for (t, v, h, v_breaks, h_breaks) in [
            (C, vec![0.0, 3.0, 60.0, 180.0], vec![0.0], None, vec![0.0, 360.0]),
            (
                C,
                vec![0.0, 1e-3, 60.0, 90.0],
                vec![0.0, 40.0, 90.0],
                None,
                vec![0.0, 40.0, 90.0, 140.0, 180.0, 220.0, 270.0, 320.0, 360.0],
            ),
            (C, vec![10.0, 90.0, 140.0], vec![0.0, 100.0, 250.0], None, vec![0.0, 100.0, 250.0, 360.0]),
            (A, vec![-90.0, -10.0, 45.0, 90.0], vec![-80.0, 0.0, 70.0], None, vec![-80.0, 0.0, 70.0]),
            (B, vec![-90.0, -10.0, 45.0, 90.0], vec![-80.0, 0.0, 90.0], None, vec![-80.0, 0.0, 90.0]),
            (
                B,
                vec![0.0, 10.0, 45.0],
                vec![0.0, 90.0],
                Some(vec![-45.0, -10.0, 0.0, 10.0, 45.0]),
                vec![-90.0, 0.0, 90.0],
            ),
        ] {
            let web = Web::new(t, v.clone(), h.clone(), uneven(v.len() * h.len())).unwrap();
            let expected = quadrature(&web, &v_breaks.unwrap_or(v), &h_breaks);
            let got = bilinear_lm(&web.full_grid());
            assert!((got - expected).abs() <= 1e-13 * expected, "{t:?} {h:?}: {got} {expected}");
        }
    }

    #[test]
    fn closed_forms() {
        let v: Vec<f64> = (0..=36).map(|i| f64::from(i) * 2.5).collect();
        let ones = Web::new(C, vec![0.0, 180.0], vec![0.0], vec![1.0; 2]).unwrap();
        assert!((trapezoid_lm(&ones.full_grid()) - 4.0 * PI).abs() < 1e-14);
        assert!((bilinear_lm(&ones.full_grid()) - 4.0 * PI).abs() < 1e-14);
        for t in [A, B] {
            let half = Web::new(t, vec![-90.0, 90.0], vec![-90.0, 90.0], vec![1.0; 4]).unwrap();
            assert!((trapezoid_lm(&half.full_grid()) - 2.0 * PI).abs() < 1e-14, "type {t:?}: half a sphere");
        }
        // The trapezoid is exact for I0 cos V: pi I0.
        let cosine =
            Web::new(C, v.clone(), vec![0.0], v.iter().map(|v| v.to_radians().cos()).collect()).unwrap();
        assert!((trapezoid_lm(&cosine.full_grid()) - PI).abs() < 1e-14);
        // I = 1 - V/pi over the sphere, linear in V: 2 pi Int (1 - t/pi) sin t dt = 2 pi.
        let linear = Web::new(C, vec![0.0, 180.0], vec![0.0], vec![1.0, 0.0]).unwrap();
        assert!((bilinear_lm(&linear.full_grid()) - 2.0 * PI).abs() < 1e-14);
    }

    #[test]
    fn narrow_bands_keep_their_digits() {
        let near = |got: f64, exact: f64| (got - exact).abs() <= 4e-15 * exact;
        for width in [1e-12, 1e-9, 1e-6, 1e-3, 1e-2] {
            // At the pole, by the power series of both integrals (the next term is below 1e-17 of the sum).
            let w2: f64 = width * width;
            let high_exact = w2 * (1.0 / 3.0 - w2 * (1.0 / 30.0 - w2 * (1.0 / 840.0)));
            let low_exact = w2 * (1.0 / 6.0 - w2 * (1.0 / 120.0 - w2 * (1.0 / 5040.0)));
            let (low, high) = node_weights(0.0, width);
            assert!(
                near(low, low_exact) && near(high, high_exact),
                "{width}: {low} {low_exact} {high} {high_exact}"
            );
            // Away from it a band of width w about m has 2 sin m sin(w/2), split almost evenly.
            let (from, to) = (1.0, 1.0 + width);
            let (mid, width) = (0.5 * (from + to), to - from);
            let (low, high) = node_weights(from, to);
            let total = mid.sin() * width * (1.0 - width * width / 24.0 * (1.0 - width * width / 80.0));
            assert!(near(low + high, total), "{width}: {} {total}", low + high);
            let tilt = mid.cos() * width * width / 6.0;
            assert!(
                (high - low - tilt).abs() <= 1e-15 * total + 1e-4 * tilt,
                "{width}: {} {tilt}",
                high - low
            );
        }
        for width in [0.5f64, 1.0, 1.9, 2.1, 3.0] {
            let (low, high) = node_weights(0.0, width);
            let exact = (width.sin() - width * width.cos()) / width;
            assert!((high - exact).abs() <= 1e-14 && (low - (1.0 - width.cos() - exact)).abs() <= 1e-14);
        }
    }
}
