//! The solver of the cell equation (paper, eq. 8) against an oracle that shares nothing with it: the
//! distribution function by Gauss-Legendre quadrature of the density, its root by Brent's method of the
//! `roots` crate.

use std::f64::consts::PI;

use caustix::math::solve::Solver;
use caustix::sample::angles::Row;
use caustix::sample::cell::Cell;
use roots::{SimpleConvergency, find_root_brent};

use crate::support::cells::Case;
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

/// A step that the default solver takes unseen, on Taylor's theorem alone, keeps the promise of all: |F(s) -
/// u| <= 2^-46, and the rounding of F itself, some units of 2^-52. Near a pole, where the density is far from
/// linear, and across edges of zero, where it rises steeply, such steps are long; the quadrature shares no
/// formula with the bound.
#[test]
fn every_solver_keeps_the_promise_of_2_to_minus_46() {
    let promise = 2f64.powi(-46) + 16.0 * f64::EPSILON;
    let corners = [[0.0, 0.0, 1.0, 1.0], [1.0, 1.0, 0.0, 0.0], [0.0, 1.0, 2.0, 0.5], [1.0, 0.7, 1e-6, 0.0]];
    let mut worst = [0.0f64; Solver::ALL.len()];
    for k in 0..60 {
        let width = 0.004 * 1.09f64.powi(k);
        for (from, corners) in
            [0.0, 0.3 * width, PI - width, 1.1].into_iter().flat_map(|f| corners.map(|c| (f, c)))
        {
            let case = Case::new(from, from + width, corners).unwrap();
            for i in 0..60 {
                let u = ((f64::from(i) + 0.5) / 60.0).powi(1 + i % 3);
                for (solver, worst) in Solver::ALL.into_iter().zip(&mut worst) {
                    *worst = worst.max(case.residual(case.cell.sample_theta(&case.row, u, solver).s, u));
                }
            }
        }
    }
    for (solver, worst) in Solver::ALL.into_iter().zip(worst) {
        println!("{}: worst {:.2} of the promise", solver.name(), worst / promise);
        assert!(worst <= promise, "{}: {:.2} of the promise", solver.name(), worst / promise);
    }
}
