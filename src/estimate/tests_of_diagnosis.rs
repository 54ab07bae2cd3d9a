//! Made-up counts of known rate, drift and shape.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::*;

/// Counts of eight replicates about a mean: deviations of the mean 0, s^2 = 12 / 7 times the square of `wide`, symmetric.
fn about(mean: u64, wide: u64) -> Vec<u64> {
    [-2, -1, -1, 0, 0, 1, 1, 2].map(|d| mean.saturating_add_signed(d * wide as i64)).to_vec()
}

/// The counts of later photons in another order: replicates' deviations are not those of the earlier ones.
fn turned(counts: &[u64], by: usize) -> Vec<u64> {
    let mut turned = counts.to_vec();
    turned.rotate_left(by);
    turned
}

/// Totals after each of these octaves.
fn cumulated(first: u64, octaves: &[Vec<u64>]) -> Counted {
    let mut totals = vec![0; octaves[0].len()];
    let mut photons = first;
    let mut levels = Vec::new();
    for octave in octaves {
        totals.iter_mut().zip(octave).for_each(|(total, n)| *total += n);
        levels.push((photons, totals.clone()));
        photons *= 2;
    }
    Counted { photons: photons / 2, on_receiver: totals, first: levels, is_once: true }
}

/// Octaves of 256, 256, 512 and 1024 photons of which a quarter arrives, each somewhat unlike the others.
fn healthy() -> Vec<Vec<u64>> {
    let widths = [(64, 4, 0), (64, 4, 3), (128, 5, 5), (256, 7, 6)];
    widths.map(|(mean, wide, by)| turned(&about(mean, wide), by)).to_vec()
}

fn judged(counted: &Counted) -> Judgement {
    let found = counted.diagnosis().unwrap();
    found.judgement(level(found.checks.len()))
}

#[test]
fn rates_and_their_errors_by_hand() {
    // Three levels: the slope is that between the outer ones, over two doublings. Its variance is that of the difference of two
    // logarithms that have the correlation 2^(-4 rate), psi'(7/2) / 4 each: psi'(7/2) = pi^2 / 2 - 4 (1 + 1/9 + 1/25).
    let trigamma = std::f64::consts::PI.powi(2) / 2.0 - 4.0 * (1.0 + 1.0 / 9.0 + 1.0 / 25.0);
    let levels = [(1 << 10, 0.08), (1 << 11, 0.05), (1 << 12, 0.08 / 8.0f64.sqrt())];
    let found = rate::rate(&levels, 8).unwrap();
    assert!((found.value - 0.75).abs() < 1e-14);
    let error = (trigamma / 4.0 * 2.0 * (1.0 - 1.0 / 8.0)).sqrt() / (2.0 * 2.0f64.ln());
    assert!((found.standard_error / error - 1.0).abs() < 1e-12);
    assert_eq!(found.photons, [1 << 10, 1 << 12]);
    // Judged as independent photons: correlation 1/4, Student's with 28 degrees.
    let error = (trigamma / 4.0 * 2.0 * (1.0 - 1.0 / 4.0)).sqrt() / (2.0 * 2.0f64.ln());
    let student = StudentsT::new(0.0, 1.0, 28.0).unwrap();
    assert!((found.chance - student.cdf(0.25 / error)).abs() < 1e-12);
    // An exact law over many levels, and of a power in which replicates cannot be told apart.
    let law =
        |power: f64| (4..20).map(|k| (1 << k, 3.0 * f64::from(1 << k).powf(-power))).collect::<Vec<_>>();
    for power in [0.1, 0.5, 0.97, 1.5] {
        assert!((rate::rate(&law(power), 8).unwrap().value - power).abs() < 1e-13);
    }
    assert!((rate::rate(&law(0.5), 8).unwrap().chance - 0.5).abs() < 1e-10);
    assert!(rate::rate(&law(0.5)[..2], 8).is_none() && rate::rate(&[(1, 0.0); 3], 8).is_none());
}

#[test]
fn drifts_and_merits_by_hand() {
    // Of 8 photons 4, then 4 more, which give 20 photons instead of 10 in the mean; the differences of four replicates are 10,
    // 14, 6, 10: mean 10, s^2 = 32 / 3, standard error sqrt(8 / 3).
    let first = vec![10, 10, 10, 10];
    let mut counted = Counted {
        photons: 8,
        on_receiver: vec![30, 34, 26, 30],
        first: vec![(2, vec![5; 4]), (4, first), (8, vec![30, 34, 26, 30])],
        is_once: false,
    };
    let drift = counted.diagnosis().unwrap().drift.unwrap();
    // 10 of 15 that half of the photons give in the mean.
    assert_eq!(drift.first_photons, 4);
    assert!((drift.relative - 10.0 / 15.0).abs() < 1e-14);
    assert!((drift.standard_error - (8.0f64 / 3.0).sqrt() / 15.0).abs() < 1e-14);
    let student = StudentsT::new(0.0, 1.0, 3.0).unwrap();
    assert!((drift.chance - 2.0 * student.sf(10.0 / (8.0f64 / 3.0).sqrt())).abs() < 1e-13);
    // Equal replicates are sure to one photon each: 10 +- 1 / 2.
    counted.on_receiver = vec![30; 4];
    let found = counted.diagnosis().unwrap();
    assert!((found.drift.unwrap().standard_error - 0.5 / 15.0).abs() < 1e-14);
    // 120 of 32 photons +- 1: figure of merit 120^2 / 32.
    assert!((found.merit.unwrap() - 450.0).abs() < 1e-11);
    // Of 6 photons, 4 against 2: 30 - 10 = 20 later ones stand for 40; 30 in all, 5 a photon; 10 later and 2.5 earlier.
    counted.photons = 6;
    let drift = counted.diagnosis().unwrap().drift.unwrap();
    assert!((drift.relative - 7.5 / 5.0).abs() < 1e-14);
    // A photon each, of which a later one counts twice.
    assert!((drift.standard_error - 0.5 * 2.0 / 4.0 / 5.0).abs() < 1e-14);
    // Less than a third at the first doubling that is kept: no drift is known.
    counted.first = vec![(8, vec![30; 4])];
    assert!(counted.diagnosis().unwrap().drift.is_none());
}

#[test]
fn variance_is_compared_with_that_of_independent_photons() {
    // 8 x 2048 photons, of which 1024 x 4 arrive: N p (1 - p) = 3072. One photon more and one less: 2 x 8 / 7.
    let mut on = vec![512; 8];
    (on[0], on[1]) = (513, 511);
    let counted = Counted { photons: 2048, on_receiver: on, first: Vec::new(), is_once: true };
    let found = counted.diagnosis().unwrap();
    assert!((found.against_independent.unwrap() - 3072.0 / (16.0 / 7.0)).abs() < 1e-9);
    assert!(Counted { is_once: false, ..counted }.diagnosis().unwrap().against_independent.is_none());
}

#[test]
fn what_is_as_it_should_be_is_not_doubted() {
    let found = cumulated(256, &healthy()).diagnosis().unwrap();
    let faults: Vec<Fault> = found.checks.iter().map(|check| check.fault).collect();
    assert_eq!(faults, [Fault::Drifts, Fault::Slow, Fault::Scatters, Fault::Skewed]);
    assert_eq!(judged(&cumulated(256, &healthy())), Judgement::Sound);
    assert_eq!(found.trend.len(), 4);
    assert_eq!((found.trend[3].photons, found.trend[3].share), (2048, 0.25));
}

#[test]
fn every_fault_is_found_by_itself() {
    let doubt = |octaves: &[Vec<u64>]| judged(&cumulated(256, octaves));
    // Later photons give a tenth more than those before.
    let mut octaves = healthy();
    octaves[3].iter_mut().for_each(|n| *n += 26);
    assert_eq!(doubt(&octaves), Judgement::Doubtful(vec![Fault::Drifts]));
    // Every octave has the same deviations: the relative error stays as it is, and at the end it is still less than that of
    // independent photons.
    let octaves = [1, 1, 2, 4, 8, 16, 32, 64].map(|n| about(1000 * n, n));
    assert_eq!(judged(&cumulated(1 << 12, &octaves)), Judgement::Doubtful(vec![Fault::Slow]));
    // All deviations five times as wide: 25 times the variance, in which the rate and halves are as they were.
    let widths = [(64, 20, 0), (64, 20, 3), (128, 25, 5), (256, 35, 6)];
    let octaves = widths.map(|(mean, wide, by)| turned(&about(mean, wide), by));
    assert_eq!(doubt(&octaves), Judgement::Doubtful(vec![Fault::Scatters]));
    // One replicate has 64 more than the others.
    let widths = [(64, 1, 0, 16), (64, 1, 3, 10), (128, 2, 5, 14), (256, 2, 6, 24)];
    let octaves = widths.map(|(mean, wide, by, more)| {
        let mut octave = turned(&about(mean, wide), by);
        octave[2] += more;
        octave
    });
    assert_eq!(doubt(&octaves), Judgement::Doubtful(vec![Fault::Skewed]));
    // Two of 24 are far off, one to each side.
    let mut on: Vec<u64> = [about(512, 4), about(512, 4), about(512, 4)].concat();
    (on[3], on[4]) = (572, 452);
    let counted = Counted { photons: 2048, on_receiver: on, first: Vec::new(), is_once: false };
    assert_eq!(judged(&counted), Judgement::Doubtful(vec![Fault::HeavyTailed]));
}

#[test]
fn too_little_is_said_to_be_too_little() {
    let of = |on: &[u64]| {
        let counted = Counted { photons: 2048, on_receiver: on.to_vec(), first: Vec::new(), is_once: false };
        counted.diagnosis().map(|found| found.judgement(level(found.checks.len())))
    };
    assert_eq!(of(&[1000]), None);
    assert_eq!(of(&[1000, 1000]), Some(Judgement::FewReplicates));
    assert_eq!(of(&[12, 12, 13, 12, 12, 13, 12, 13]), Some(Judgement::FewPhotons));
    assert_eq!(of(&[1000, 1010, 990, 1005]), Some(Judgement::Unchecked));
    assert_eq!(of(&about(500, 4)), Some(Judgement::Sound));
    // A dark receiver has nothing that could be infinite.
    let dark = Counted { photons: 16, on_receiver: vec![0; 8], first: vec![(8, vec![0; 8])], is_once: true };
    let found = dark.diagnosis().unwrap();
    assert_eq!((found.merit, found.drift, found.rate), (None, None, None));
    assert_eq!(found.trend[0].relative_error, None);
}

#[test]
fn levels_of_several_checks_are_sidaks() {
    assert!((level(1) - 0.01).abs() < 1e-15);
    assert!(((1.0 - level(20)).powi(20) - 0.99).abs() < 1e-14);
}
