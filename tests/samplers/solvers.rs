//! Every solver of the cell equation over every family of METHOD 3 and 8, the residual by quadrature; and
//! tables at their extremes, sampled and inverted.

use std::f64::consts::PI;

use caustix::files::photometric;
use caustix::math::solve::Solver;
use caustix::sample::grid::Grid;
use caustix::sequence::hash::mix64;
use caustix::sequence::to_unit_f64;

use crate::support::cells::{Case, Method, SOLVED, Score, families, of_table, uniforms};
use crate::support::data;
use crate::support::given::of_grid;
use crate::support::sphere_table::SphereTable;

const TWO_TO_64: f64 = 18_446_744_073_709_551_616.0;

#[test]
fn no_solver_fails_in_any_family() {
    for solver in Solver::ALL {
        let mut all = Score::default();
        for family in families() {
            let score = Score::of(Method::Own(solver), &family.cases);
            assert_eq!(score.failures, 0, "{} fails in {}", solver.name(), family.name);
            all.join(&score);
        }
        println!(
            "{}: {} solves, worst {:.1e}, {:.2} evaluations, at most {}",
            solver.name(),
            all.solves,
            all.worst,
            all.mean_evaluations(),
            all.most_evaluations
        );
        assert!(all.worst <= SOLVED);
        // Twelve steps of the method and a bisection of 53 bits; Ridder's method halves with every second
        // evaluation.
        assert!(all.most_evaluations <= 12 + 53, "{} used {}", solver.name(), all.most_evaluations);
    }
}

#[test]
fn the_default_needs_few_evaluations() {
    let mut all = Score::default();
    families().iter().for_each(|f| all.join(&Score::of(Method::Own(Solver::DEFAULT), &f.cases)));
    // The prototype's quadratic start with plain Newton steps needed 2.8.
    assert!(all.mean_evaluations() <= 2.0, "{}", all.mean_evaluations());
    for file in ["wavy_glass.ies", "spot.ies", "headlamp_a.ies", "floodlight_b.ies"] {
        let web = photometric::read(data::own_file(file)).unwrap().web;
        let cases: Vec<Case> = of_table(&web).into_iter().map(|(case, _)| case).collect();
        for solver in Solver::ALL {
            let score = Score::of(Method::Own(solver), &cases);
            assert_eq!(score.failures, 0, "{file}: {}", solver.name());
            println!("{file}: {} {:.2} evaluations", solver.name(), score.mean_evaluations());
            assert!(solver != Solver::DEFAULT || score.mean_evaluations() <= 1.5, "{file}");
        }
    }
}

/// The families are hard: what has no bracket, or the paper's equation as printed, fails in them.
#[test]
fn unguarded_methods_fail_where_the_solvers_do_not() {
    let failures =
        |method: Method| -> u64 { families().iter().map(|f| Score::of(method, &f.cases).failures).sum() };
    assert!(failures(Method::UnguardedSecant) > 100);
    assert!(failures(Method::UnguardedNewton) > 100);
    assert!(failures(Method::AsPrinted) > 10_000);
}

/// Sine and cosine belong to the angle that is returned, also where the last step was taken unseen.
#[test]
fn sine_and_cosine_are_those_of_the_angle() {
    for family in families() {
        for (k, case) in family.cases.iter().enumerate() {
            for (u, solver) in uniforms(k as u64).into_iter().flat_map(|u| Solver::ALL.map(|s| (u, s))) {
                let polar = case.cell.sample_theta(&case.row, u, solver);
                let (sin, cos) = case.row.theta.sin_cos();
                let (sin_s, cos_s) = polar.s.sin_cos();
                let off = (polar.sin - (sin * cos_s + cos * sin_s)).abs();
                let off = off.max((polar.cos - (cos * cos_s - sin * sin_s)).abs());
                assert!(off <= 1e-15, "{}, {}, u {u}: {off:e}", family.name, solver.name());
            }
        }
    }
}

#[test]
fn what_is_not_a_number_stays_in_the_cell() {
    for family in families() {
        for (case, solver) in family.cases.iter().flat_map(|c| Solver::ALL.map(|s| (c, s))) {
            for u in [f64::NAN, -1.0, 2.0, f64::INFINITY, f64::NEG_INFINITY] {
                let polar = case.cell.sample_theta(&case.row, u, solver);
                assert!((0.0..=case.row.width).contains(&polar.s), "{} u {u}: {polar:?}", solver.name());
            }
        }
    }
}

fn grid(table: &SphereTable) -> Grid {
    Grid::new(&table.polar, &table.azimuth, &table.values).unwrap()
}

/// Samples every solver at spread and at extreme coordinates and inverts by quadrature: u1 comes back to a
/// part of 1e-9 of itself, allowing for what the solver's tolerance and the rounding of an angle are worth in
/// u1.
fn check(name: &str, table: &SphereTable) {
    let grid = grid(table);
    assert!((grid.integral() / table.total() - 1.0).abs() < 1e-12, "{name}");
    let coordinates = (0..4000).map(|i| mix64(2 * i)).chain([0, 1, 1 << 20, 1 << 63, u64::MAX - 1, u64::MAX]);
    for (i, u1) in coordinates.enumerate() {
        let u2 = mix64(2 * i as u64 + 1);
        for solver in Solver::ALL {
            let context = || format!("{name}, {}, u1 {u1}", solver.name());
            let point = of_grid(&grid, u1, u2, solver);
            assert!((point.direction.length() - 1.0).abs() < 1e-14, "{}", context());
            let [v1, v2] = table.by_cell(point.theta, point.phi);
            let density = table.density(point.theta, point.phi);
            assert!(
                (grid.value(point.theta, point.phi) / grid.integral() - density).abs() <= 1e-11 * density
            );
            // One unit of theta (2^-51) and of phi (2^-50) moves u1 by the density times the width of the
            // turn.
            let rounding = 2f64.powi(-51) * density * point.theta.sin() * 2.0 * PI + 2f64.powi(-45);
            let off = (v1 - u1 as f64 / TWO_TO_64).abs();
            assert!(off <= 1e-9 * (u1 as f64 / TWO_TO_64) + rounding, "{}: {off:e} {rounding:e}", context());
            assert!((v2 - to_unit_f64(u2)).abs() <= 1e-9, "{}: {v2} for {u2}", context());
        }
    }
}

#[test]
fn tables_at_their_extremes_invert_for_every_solver() {
    let whole =
        |rows, columns, f: fn(usize, usize) -> f64| SphereTable::over_the_sphere([rows, columns], 0.0, f);
    check("one cell, the sphere", &whole(1, 1, |i, j| (1 + i + 2 * j) as f64));
    let narrow = SphereTable::new(vec![1.0, 1.0 + 1e-6], vec![0.0, 1.0], vec![1.0, 2.0, 3.0, 0.0]);
    assert!(grid(&narrow).choice().is_single());
    check("the largest", &whole(720, 360, |i, j| f64::from((i * 31 + (j % 360) * 17) as u32 % 997) + 1.0));
    check("twelve decades", &whole(36, 24, |i, j| 10f64.powi(((i * 5 + (j % 24) * 7) % 13) as i32 - 12)));
}

/// All but one cell zero: the four cells around one node are as few as a bilinear table over the sphere can
/// have, and a corner of the table belongs to a single one.
#[test]
fn one_cell_among_zeros_is_found_by_every_solver() {
    let lit = |at: (usize, usize)| {
        SphereTable::over_the_sphere([18, 12], 0.0, |i, j| if (i, j) == at { 1.0 } else { 0.0 })
    };
    let (pole, inner) = (lit((0, 0)), grid(&lit((9, 0))));
    for solver in Solver::ALL {
        for i in 0..2000u64 {
            let (u1, u2) = (mix64(i), mix64(!i));
            let at_pole = of_grid(&grid(&pole), u1, u2, solver);
            assert!(at_pole.theta <= PI / 18.0 && at_pole.phi <= PI / 6.0, "{at_pole:?}");
            // A cell whose two ends have no density: the near one for the sine, the far one for the table.
            let [v1, _] = pole.by_cell(at_pole.theta, at_pole.phi);
            assert!((v1 - to_unit_f64(u1)).abs() < 1e-13, "{}: {v1} {u1}", solver.name());
            let around = of_grid(&inner, u1, u2, solver);
            // The edges as the table has them; a sum of edge and in-cell angle is rounded once.
            let edges = PI * 8.0 / 18.0..=PI * 10.0 / 18.0 * (1.0 + f64::EPSILON);
            assert!(edges.contains(&around.theta) && around.phi <= PI / 6.0, "{around:?}");
        }
    }
}
