//! The solver of the cell equation (paper, eq. 8) against an oracle that shares nothing with it: the distribution function by
//! Gauss-Legendre quadrature of the density, its root by Brent's method of the `roots` crate.

use caustix::math::solve::Solver;
use caustix::sample::angles::Row;
use caustix::sample::cell::Cell;
use roots::{SimpleConvergency, find_root_brent};

use crate::support::quadrature::Gauss;

/// Corners A1, A2 (near edge) and B1, B2.
const CORNERS: [[f64; 4]; 7] = [
    [1.0, 1.0, 1.0, 1.0],
    [1.0, 1.2, 0.3, 0.1],
    [0.0, 0.0, 1.0, 2.0],
    [3.0, 1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [1e-12, 1e-12, 1.0, 1.0],
];

/// Edges in degrees: inner rows, both poles, wide rows, the sphere in one row, a narrow one.
const ROWS: [(f64, f64); 9] = [
    (0.0, 2.5),
    (2.5, 5.0),
    (42.5, 45.0),
    (87.5, 92.5),
    (177.5, 180.0),
    (0.0, 90.0),
    (60.0, 180.0),
    (0.0, 180.0),
    (30.0, 30.001),
];

/// Integral of the marginal density over [0, x width], as a part of the whole.
fn distribution(rule: &Gauss, theta1: f64, width: f64, corners: [f64; 4], x: f64) -> f64 {
    let (a, b) = (corners[0] + corners[1], corners[2] + corners[3]);
    let density = |t: f64| (a * (1.0 - t) + b * t) * (theta1 + t * width).sin().max(0.0);
    let panels = |to: f64| -> f64 {
        (0..4).map(|k| rule.integrate(to * f64::from(k) / 4.0, to * f64::from(k + 1) / 4.0, density)).sum()
    };
    panels(x) / panels(1.0)
}

#[test]
fn roots_agree_with_brents_method_on_the_quadrature() {
    let rule = Gauss::new(12);
    let (mut compared, mut given_up, mut worst) = (0, 0, 0.0f64);
    for (from, to) in ROWS {
        let (theta1, theta2) = (from.to_radians(), to.to_radians());
        let row = Row::new(theta1, theta2);
        for corners in CORNERS {
            let cell = Cell::new(&row, corners).unwrap();
            for k in 1..100 {
                let u = f64::from(k) / 100.0;
                let f = |x: f64| distribution(&rule, theta1, row.width, corners, x) - u;
                let mut stop = SimpleConvergency { eps: 1e-14, max_iter: 200 };
                match find_root_brent(0.0, 1.0, f, &mut stop) {
                    Ok(x) => {
                        for solver in Solver::ALL {
                            let off = (cell.sample_theta(&row, u, solver).s / row.width - x).abs();
                            let name = solver.name();
                            assert!(off <= 1e-10, "{name}, row {from}..{to}, {corners:?}, u {u}: {off:e}");
                            worst = worst.max(off);
                        }
                        compared += 1;
                    }
                    Err(_) => given_up += 1,
                }
            }
        }
    }
    println!("{compared} roots compared, worst {worst:.1e} of the width; Brent gave up on {given_up}");
    assert!(compared > 6000, "{compared}");
}
