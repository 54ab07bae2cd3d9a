//! What a run says of itself, where it is known what it should say. The example `healthy` does the same over more seeds and
//! scenes (docs/METHOD.md, section 10).

use caustix::sequence::Sequence;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

use crate::support::healthy::{doubted, figures, mean, of_seeds, plate, plates, rates};
use crate::support::judge::SIGNIFICANCE;
use crate::support::scenes::run;
use crate::support::statistics::z_test;

const SEEDS: u64 = 2000;

#[test]
fn one_healthy_run_in_100_is_doubted_at_most() {
    for (sequence, seeds) in [(Sequence::Independent, 5000), (Sequence::SobolOwen, 15_000)] {
        let runs = of_seeds(&plates(), sequence, (1 << 10, 8), seeds..seeds + SEEDS);
        assert!(runs.iter().flatten().all(|of| of.verdict != "unknown"));
        assert!(runs.iter().all(|of| of.iter().any(|receiver| receiver.rate.is_some())));
        let doubted = doubted(&runs) as u64;
        let chance = Binomial::new(0.01, SEEDS).unwrap().sf(doubted.saturating_sub(1));
        assert!(chance > SIGNIFICANCE, "{sequence:?}: {doubted} of {SEEDS}");
        // In half of all runs later photons give more.
        let more = runs.iter().filter(|of| of[0].drift.unwrap()[0] > 0.0).count() as f64;
        let of = runs.iter().filter(|of| of[0].drift.unwrap()[0] != 0.0).count() as f64;
        assert!(z_test((more - of / 2.0) / (of / 4.0).sqrt()) > SIGNIFICANCE, "{more} of {of}");
    }
}

#[test]
fn rates_are_those_that_theory_has_and_their_errors_hold() {
    // Independent photons: 0.5. Scrambled nets on a discontinuity along a curve in two coordinates: 1/2 + 1/4 (He and Wang 2015).
    let runs = of_seeds(&plate(1.7), Sequence::Independent, (1 << 12, 8), 0..400);
    let [independent, errors] = rates(&runs);
    let [rate, error] = mean(&independent);
    assert!(z_test((rate - 0.5) / error) > SIGNIFICANCE, "{rate} +- {error}");
    // Their spread is the error that they are given: chi-square, of all but normal numbers.
    let square = independent.iter().zip(&errors).map(|(r, e)| ((r - rate) / e).powi(2)).sum::<f64>();
    let chi = ChiSquared::new(independent.len() as f64 - 1.0).unwrap();
    assert!(chi.sf(square).min(chi.cdf(square)) > SIGNIFICANCE, "{square} of {}", independent.len());
    let ratio: Vec<f64> = runs.iter().flatten().filter_map(|of| of.ratio).map(f64::recip).collect();
    let [ratio, error] = mean(&ratio);
    assert!(z_test((ratio - 1.0) / error) > SIGNIFICANCE, "{ratio} +- {error}");

    let [nets, _] = rates(&of_seeds(&plate(1.7), Sequence::SobolOwen, (1 << 13, 8), 0..100));
    let [rate, error] = mean(&nets);
    assert!((rate - 0.75).abs() < 0.05 && error < 0.02, "{rate} +- {error}");
}

#[test]
fn of_few_photons_and_of_points_made_for_their_number_less_is_said() {
    let scene = plate(0.02);
    let told = &figures(&scene, &run(&scene, Sequence::SobolOwen, 1 << 10, 8, 3))[0];
    assert_eq!(told.verdict, "unknown");
    assert!(told.says.starts_with("too few photons to tell"), "{}", told.says);
    let scene = plate(1.7);
    let told = &figures(&scene, &run(&scene, Sequence::LatticeRotation, 1 << 10, 8, 3))[0];
    assert!(told.rate.is_none() && told.drift.is_none() && told.verdict != "unknown", "{told:?}");
    assert!(figures(&scene, &run(&scene, Sequence::SobolOwen, 1 << 10, 1, 3)).is_empty());
}
