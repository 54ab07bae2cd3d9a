//! The statistical tools of the tests, on input of known quality: good input must pass, bad input must not.

use caustix::photometry::PhotometricType;
use caustix::sequence::{Points, independent::IndependentPoints, to_unit_f64};
use glam::DVec3;
use std::f64::consts::PI;

use crate::support::angles::Luminaire;
use crate::support::quadrature::{Gauss, adaptive};
use crate::support::statistics::{chi_square, kolmogorov_smirnov, kolmogorov_tail, sidak, z_test};

const N: u64 = 60_000;

fn uniforms(seed: u64) -> impl Iterator<Item = f64> {
    let points = IndependentPoints::new(seed, 0);
    (0..N).map(move |i| to_unit_f64(points.coordinate(i, 0)))
}

fn roll(faces: &[f64; 6], seed: u64) -> Vec<u64> {
    let mut counts = vec![0; 6];
    for u in uniforms(seed) {
        let mut rest = u;
        let face = faces.iter().position(|p| {
            rest -= p;
            rest < 0.0
        });
        counts[face.unwrap_or(5)] += 1;
    }
    counts
}

#[test]
fn chi_square_accepts_a_fair_die_and_refuses_a_loaded_one() {
    let fair = [1.0 / 6.0; 6];
    // Loaded by 5 % of a face: expected statistic 5 + 60000 * 2 * (1/120)^2 * 6 = 55, p of order 1e-10.
    let loaded =
        [1.0 / 6.0 + 1.0 / 120.0, 1.0 / 6.0 - 1.0 / 120.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0];
    let seeds = 1..=40;
    let level = sidak(0.01, 40);
    for seed in seeds {
        assert!(chi_square(&roll(&fair, seed), &fair).p_value > level, "{seed}");
        assert!(chi_square(&roll(&loaded, seed), &fair).p_value < 1e-3, "{seed}");
        assert!(chi_square(&roll(&loaded, seed), &loaded).p_value > level, "{seed}");
    }
}

#[test]
fn p_values_of_true_hypotheses_are_uniform() {
    // The tests of tests: 400 p-values of each kind, themselves under Kolmogorov-Smirnov.
    let fair = [1.0 / 6.0; 6];
    let chi: Vec<f64> = (0..400).map(|s| chi_square(&roll(&fair, 1000 + s), &fair).p_value).collect();
    let ks: Vec<f64> =
        (0..400).map(|s| kolmogorov_smirnov(uniforms(2000 + s).take(3000).collect()).p_value).collect();
    for (name, values) in [("chi-square", chi), ("Kolmogorov-Smirnov", ks)] {
        let p = kolmogorov_smirnov(values).p_value;
        println!("{name}: p-values uniform with p = {p:.3}");
        assert!(p > sidak(0.01, 2), "{name}: {p}");
    }
}

#[test]
fn chi_square_by_hand_pooling_and_forbidden_cells() {
    // Two cells 60 : 40 of 50 : 50: chi-square 4, one degree, p = erfc(sqrt 2) = 0.0455.
    let two = chi_square(&[60, 40], &[1.0, 1.0]);
    assert!((two.statistic - 4.0).abs() < 1e-12 && two.degrees == 1);
    assert!((two.p_value - 0.045_500_263_896_358_4).abs() < 1e-12);
    // 100 hits, expected 48, 2, 2, 48: the small ones wait for the last, so two pools, (48, 52).
    let pooled = chi_square(&[50, 0, 0, 50], &[24.0, 1.0, 1.0, 24.0]);
    assert!(pooled.degrees == 1);
    assert!((pooled.statistic - (4.0 / 48.0 + 4.0 / 52.0)).abs() < 1e-12);
    // What is left at the end joins the last pool.
    assert_eq!(chi_square(&[48, 48, 4], &[48.0, 48.0, 4.0]).degrees, 1);
    // A cell of probability zero is not a cell, but it must be empty.
    assert_eq!(chi_square(&[50, 0, 50], &[1.0, 0.0, 1.0]).p_value, 1.0);
    let refuted = chi_square(&[500, 1, 499], &[1.0, 0.0, 1.0]);
    assert_eq!((refuted.forbidden, refuted.p_value), (1, 0.0));
}

#[test]
fn kolmogorov_smirnov_accepts_uniform_and_refuses_shifted_values() {
    for seed in 1..=20 {
        let good: Vec<f64> = uniforms(seed).collect();
        let shifted = good.iter().map(|u| (u + 0.02).min(1.0)).collect();
        let curved = good.iter().map(|u| u.powf(1.05)).collect();
        assert!(kolmogorov_smirnov(good).p_value > sidak(0.01, 20), "{seed}");
        assert!(kolmogorov_smirnov(shifted).p_value < 1e-10, "{seed}");
        assert!(kolmogorov_smirnov(curved).p_value < 1e-6, "{seed}");
    }
    // By hand: 0.2 and 0.9 against the uniform: largest step distance 0.4 (0.9 - 1/2).
    assert!((kolmogorov_smirnov(vec![0.9, 0.2]).distance - 0.4).abs() < 1e-15);
    // Published critical values of the Kolmogorov distribution (Smirnov 1948): 5 % at 1.3581, 1 % at 1.6276, and
    // the value at 1, 0.26999967...; the two series meet.
    assert!((kolmogorov_tail(1.358_098_6) - 0.05).abs() < 1e-7);
    assert!((kolmogorov_tail(1.627_623_6) - 0.01).abs() < 1e-7);
    assert!((kolmogorov_tail(1.0) - 0.269_999_671_677_3).abs() < 1e-9);
    assert!((kolmogorov_tail(1.18 - 1e-12) - kolmogorov_tail(1.18 + 1e-12)).abs() < 1e-10);
}

#[test]
fn z_and_sidak_by_hand() {
    assert!((z_test(1.959_963_984_540_054) - 0.05).abs() < 1e-12);
    assert!((z_test(-2.575_829_303_548_901) - 0.01).abs() < 1e-12);
    assert_eq!(z_test(0.0), 1.0);
    // 1 - 0.95^(1/10) = 0.005116..., 1 - 0.99^(1/200) = 5.02504e-5; one test needs no correction.
    assert!((sidak(0.05, 10) - 0.005_116_196_891_823_74).abs() < 1e-15);
    assert!((sidak(0.01, 200) - (1.0 - 0.99f64.powf(0.005))).abs() < 1e-15);
    assert!((sidak(0.05, 1) - 0.05).abs() < 1e-17);
}

#[test]
fn quadrature_is_exact_for_polynomials_and_finds_a_spike() {
    for n in 1..=12usize {
        let degree = 2 * n as i32 - 1;
        let exact = (2f64.powi(degree + 1) - 1.0) / f64::from(degree + 1);
        let got = Gauss::new(n).integrate(1.0, 2.0, |x| x.powi(degree));
        assert!((got / exact - 1.0).abs() < 1e-13, "{n}: {got} {exact}");
        // One degree more is not exact: the rule has not more nodes than it says.
        let exact = (2f64.powi(degree + 2) - 1.0) / f64::from(degree + 2);
        assert!(
            n > 6 || (Gauss::new(n).integrate(1.0, 2.0, |x| x.powi(degree + 1)) / exact - 1.0).abs() > 1e-13
        );
    }
    let lorentz = |x: f64| 1e-3 / (x * x + 1e-6);
    let exact = 2.0 * (1e3f64).atan();
    assert!((adaptive(-1.0, 1.0, 1e-12, &lorentz) - exact).abs() < 1e-11);
    assert!((Gauss::new(10).integrate(-1.0, 1.0, lorentz) - exact).abs() > 0.1, "one panel cannot see it");
    assert!((adaptive(0.0, PI, 1e-13, &f64::sin) - 2.0).abs() < 1e-13);
}

#[test]
fn directions_and_angles_are_inverse_to_each_other() {
    let frame = Luminaire::new(DVec3::new(0.3, -0.7, -0.5), DVec3::new(0.1, 0.2, 1.0));
    let wrap = |difference: f64| (difference + 180.0).rem_euclid(360.0) - 180.0;
    for (kind, v_range) in [
        (PhotometricType::C, [5.0, 30.0, 90.0, 170.0]),
        (PhotometricType::A, [-80.0, -5.0, 20.0, 60.0]),
        (PhotometricType::B, [-150.0, -5.0, 20.0, 170.0]),
    ] {
        for v in v_range {
            for h in [-80.0, -10.0, 25.0, 70.0] {
                let (v2, h2) = frame.angles_deg(kind, frame.direction(kind, v, h));
                assert!(
                    wrap(v2 - v).abs() < 1e-12 && wrap(h2 - h).abs() < 1e-12,
                    "{kind:?} {v} {h}: {v2} {h2}"
                );
            }
        }
    }
}
