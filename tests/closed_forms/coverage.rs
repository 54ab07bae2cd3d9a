//! How often a 95 % interval contains the exact value: over many seeds, for a total and for cells of any number of hits. The
//! example `coverage` does the same over 10,000 seeds (docs/TRUST.md).

use caustix::sequence::Sequence;
use statrs::distribution::{Binomial, DiscreteCDF};

use crate::support::coverage::{Covers, ball, measure, plate};
use crate::support::judge::SIGNIFICANCE;
use crate::support::statistics::z_test;

const SEEDS: u64 = 400;
const PHOTONS: (u64, u32) = (512, 8);

/// Totals and cells of at least 30 hits: 95 %, both sides. Others: not less.
fn assert_covered(covers: &Covers) {
    let tried = covers.totals.share() * SEEDS as f64;
    let (totals, binomial) = (tried.round() as u64, Binomial::new(0.95, SEEDS).unwrap());
    let tail = binomial.cdf(totals).min(binomial.sf(totals.saturating_sub(1)));
    assert!(2.0 * tail > SIGNIFICANCE, "totals: {totals} of {SEEDS}");
    let [bright, others @ ..] = &covers.cells;
    let z = (bright.share() - 0.95) / bright.error();
    assert!(z_test(z) > SIGNIFICANCE, "z = {z}");
    for cover in others.iter().filter(|cover| cover.is_tried()) {
        assert!(cover.share() >= 0.95 - 3.0 * cover.error(), "{}", cover.share());
    }
}

#[test]
fn ninety_five_percent_intervals_contain_the_exact_value_95_percent_of_the_time() {
    for sequence in [Sequence::SobolOwen, Sequence::Independent] {
        let covers = measure(&plate(), sequence, PHOTONS, 1000..1000 + SEEDS);
        assert!(covers.empty > SEEDS, "the scene has cells without hits");
        assert_covered(&covers);
    }
}

#[test]
fn totals_of_many_reflections_are_covered_too() {
    // With all survivals on one coordinate to the end, a total would be skewed by the life of the last photon: 87 % at a
    // reflectance of a half.
    for reflectance in [0.3, 0.5, 0.8] {
        assert_covered(&measure(&ball(reflectance), Sequence::SobolOwen, PHOTONS, 2000..2000 + SEEDS));
    }
}
