//! The numbers of a study, from made-up studies whose laws and ratios are known.

use caustix::lab::study::fit::Uncertainty;
use caustix::lab::study::norms::Errors;
use caustix::lab::study::table::Table;

use crate::made_up::{ASKED, GRIDS, LAWS, grid_factor, ladder, study};

fn close(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 1e-12
}

#[test]
fn rates_are_found_within_their_standard_errors() {
    let table = Table::new(&study(&ladder(), 8, 0.05));
    let mut squares = 0.0;
    for (v, law) in LAWS.iter().enumerate() {
        for trend in &table.trends[v] {
            let found = trend.law.unwrap();
            let standard_error = found.rate_standard_error.unwrap();
            let z = (found.rate - law.rate) / standard_error;
            squares += z * z;
            assert_eq!(found.uncertainty, Uncertainty::Seeds);
            // Noise of 5 % on nine levels an octave apart: 0.05 / sqrt(60 ln(2)^2) a seed, over sqrt(8).
            let expected = 0.05 / (60.0_f64.sqrt() * std::f64::consts::LN_2) / 8.0_f64.sqrt();
            assert!(
                standard_error > 0.3 * expected && standard_error < 2.0 * expected,
                "{standard_error} {expected}"
            );
            // Student's t with 7 degrees passes 5.9 once in 1700, here among 12.
            assert!(z.abs() < 5.9, "{} {z}", law.name);
        }
    }
    // Twelve t-variables of 7 degrees: their squares' mean is 7/5 with deviation 0.9.
    assert!((0.3..4.1).contains(&(squares / 12.0)), "{}", squares / 12.0);
}

#[test]
fn ratios_are_those_computed_by_hand() {
    let table = Table::new(&study(&ladder(), 2, 0.0));
    for (v, law) in LAWS.iter().enumerate() {
        for (g, _) in GRIDS.iter().enumerate() {
            let row = table.row(v, ASKED, g).unwrap();
            assert!(close(row.errors.nrms, law.at_asked * grid_factor(g)));
            assert!(close(row.errors.relative_rms, 0.5 * row.errors.nrms));
            assert!(close(row.errors.relative_l1, 0.25 * row.errors.nrms));
            assert!(row.nrms_spread.unwrap() < 1e-15);
            assert!(close(row.ratio_equal_n.unwrap(), 0.025 / law.at_asked));
            // In its time mc traces so many times the photons, at the rate -1/2.
            let more = law.cpu_s_per_photon / LAWS[0].cpu_s_per_photon;
            let at_equal_time = row.ratio_equal_time.unwrap();
            assert!(close(at_equal_time.value, 0.025 / law.at_asked / more.sqrt()), "{at_equal_time:?}");
            assert_eq!(at_equal_time.extrapolated, more > 1.0, "mc was not measured beyond the N asked for");
            assert!(close(table.photons_per_cpu_s[v].unwrap(), 1.0 / law.cpu_s_per_photon));
            // e = 1 % at N = ASKED (e0 / 1 %)^(1 / -rate).
            let photons = ASKED as f64 * (row.errors.nrms / 0.01).powf(-1.0 / law.rate);
            let time = table.trends[v][g].time_to_target.unwrap();
            assert!(close(time.value, photons * law.cpu_s_per_photon), "{time:?}");
            assert_eq!(time.extrapolated, photons > ASKED as f64);
        }
    }
    // At 2^20, qmc-inverse-reuse takes the time of 1.25 x 2^20 photons of mc: measured, not extrapolated.
    let row = table.row(3, 1 << 20, 0).unwrap();
    assert!(!row.ratio_equal_time.unwrap().extrapolated);
}

#[test]
fn errors_over_seeds_are_root_mean_squares_and_their_spread() {
    let mut study = study(&[1 << 20], 2, 0.0);
    for (run, nrms) in study.variants[0].runs.iter_mut().zip([0.03, 0.04]) {
        run.errors[0] = Errors { relative_rms: 2.0 * nrms, nrms, relative_l1: nrms };
        run.cpu_s = 100.0 * nrms;
        run.coordinates_mean = 200.0 * nrms;
    }
    let table = Table::new(&study);
    let row = table.row(0, 1 << 20, 0).unwrap();
    assert!(close(row.errors.nrms, 0.001_25_f64.sqrt()));
    assert!(close(row.errors.relative_rms, 2.0 * 0.001_25_f64.sqrt()));
    assert!(close(row.errors.relative_l1, 0.035));
    assert!(close(row.nrms_spread.unwrap(), 0.01 / 2.0_f64.sqrt()));
    assert!(close(row.cpu_s, 3.5) && close(row.coordinates, 7.0));
}

#[test]
fn the_asked_number_is_measured_but_no_part_of_the_law() {
    let mut study = study(&ladder(), 3, 0.0);
    for run in study.variants[3].runs.iter_mut().filter(|run| run.photons == ASKED) {
        run.errors[0].nrms *= 1.09;
    }
    let table = Table::new(&study);
    assert!((table.trends[3][0].law.unwrap().rate + 0.75).abs() < 1e-12);
    assert!(close(table.row(3, ASKED, 0).unwrap().errors.nrms, 1.09 * 0.0033));
}
