//! Seeded maps of known uniformity.

use super::*;

/// Numbers in [0, 1) of SplitMix64.
struct Numbers(u64);

impl Numbers {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A count of this mean and as much variance: a rounded normal where it is large, a product of uniforms where not.
    fn count(&mut self, mean: f64) -> u64 {
        if mean > 50.0 {
            let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
            let normal = radius * (std::f64::consts::TAU * self.uniform()).cos();
            return (mean + mean.sqrt() * normal).round().max(0.0) as u64;
        }
        let (end, mut product, mut count) = ((-mean).exp(), self.uniform(), 0);
        while product > end {
            product *= self.uniform();
            count += 1;
        }
        count
    }
}

/// A map of `replicates` replicates of these expected counts.
fn extremes(expected: &[f64], replicates: u32, seed: u64) -> Result<Extremes, Unknown> {
    let mut numbers = Numbers(seed.wrapping_mul(0xd134_2543_de82_ef95));
    let (mut cells, mut total) = (Moments::new(expected.len()), Moments::new(1));
    for _ in 0..replicates {
        let counts: Vec<u64> =
            expected.iter().map(|mean| numbers.count(mean / f64::from(replicates))).collect();
        total.absorb(std::iter::once(counts.iter().sum()));
        cells.absorb(counts.into_iter());
    }
    let error_of_sum =
        crate::estimate::replicates::standard_error_of_total(total.sum[0], total.square[0], replicates);
    Map { cells: &cells, areas_m2: &[0.25], error_of_sum, replicates }.extremes()
}

fn flat_but_one(cells: usize, photons: f64, one: f64) -> Vec<f64> {
    (0..cells).map(|cell| if cell == 3 { one * photons } else { photons }).collect()
}

/// Two maps with one dark cell, two flat ones, two too noisy: over 1000 seeds the intervals cover the truth in at least
/// 94 %, are at most 0.1 wide, and are not given where cells are noise.
#[test]
fn intervals_cover_the_truth_of_six_maps() {
    let maps = [
        ("dark", flat_but_one(50, 12_000.0, 0.6), true),
        ("shadow", flat_but_one(64, 9_000.0, 0.05), true),
        ("flat", flat_but_one(50, 7_500.0, 1.0), true),
        ("flat, many", flat_but_one(1024, 14_000.0, 1.0), true),
        ("noise", flat_but_one(1024, 40.0, 1.0), false),
        ("noise with a dark cell", flat_but_one(1024, 300.0, 0.6), false),
    ];
    for (name, expected, is_known) in maps {
        let mean = expected.iter().sum::<f64>() / expected.len() as f64;
        let least = expected.iter().copied().fold(f64::INFINITY, f64::min);
        let most = expected.iter().copied().fold(0.0, f64::max);
        let truth = [least / mean, least / most, 4.0 * least, 4.0 * most];
        let (mut covered, mut given, mut widest) = ([0; 4], 0, 0.0f64);
        for seed in 0..1000 {
            let Ok(found) = extremes(&expected, 8, seed) else { continue };
            given += 1;
            let intervals = [found.u0, found.ud, found.minimum, found.maximum];
            for ((covered, truth), i) in covered.iter_mut().zip(truth).zip(intervals) {
                *covered += usize::from(i.low <= truth && truth <= i.high);
                assert!(i.low <= i.value && i.value <= i.high, "{name}: {i:?}");
            }
            widest = widest.max(found.u0.high - found.u0.low);
        }
        assert_eq!(given > 0, is_known, "{name}: {given} given");
        assert!(!is_known || given > 950, "{name}: {given} given");
        assert!(
            covered.iter().all(|n| *n as f64 >= 0.94 * f64::from(given)),
            "{name}: {covered:?} of {given}"
        );
        assert!(widest <= 0.1, "{name}: {widest}");
    }
}

/// The grid that a refusal names does do, and one of twice the cells does not.
#[test]
fn the_grid_that_is_named_would_do() {
    for (cells, photons) in [(4096, 300.0), (262_144, 2.0), (10_000, 20.0)] {
        let Err(Unknown::Noisy { cells: Some(fewer), more, error, bound, .. }) =
            extremes(&flat_but_one(cells, photons, 1.0), 8, 5)
        else {
            panic!("{cells} cells of {photons} photons are noisy");
        };
        let each = cells as f64 * photons / fewer as f64;
        let known =
            (0..20).filter(|seed| extremes(&flat_but_one(fewer as usize, each, 1.0), 8, *seed).is_ok());
        assert!(known.count() == 20, "{fewer} cells");
        assert!(extremes(&flat_but_one(2 * fewer as usize, each / 2.0, 1.0), 8, 7).is_err());
        assert!((more - 1.2 * (error / bound).powi(2)).abs() < 1e-9 * more);
    }
    // 60 photons are no map.
    let few = extremes(&flat_but_one(4, 15.0, 1.0), 8, 1);
    assert!(matches!(few, Err(Unknown::Noisy { cells: None, .. })), "{few:?}");
}

#[test]
fn what_has_no_uniformity_says_so() {
    assert_eq!(extremes(&[1e6, 1e6], 1, 1), Err(Unknown::OneReplicate));
    assert_eq!(extremes(&[1e6], 8, 1), Err(Unknown::OneCell));
    assert_eq!(extremes(&[0.0; 4], 8, 1), Err(Unknown::Dark));
}

/// By hand: counts 100 000 and 100 100 (half 49 900, 50 120), the other cell twice that. The darkest cell is the same in
/// both halves, so its value is that of all.
#[test]
fn one_dark_cell_keeps_its_own_value() {
    let mut cells = Moments::new(2);
    let counts = [[50_000, 100_000], [50_400, 100_200], [49_800, 99_900], [50_200, 100_300]];
    counts.iter().for_each(|counts| cells.absorb(counts.iter().copied()));
    let map = Map { cells: &cells, areas_m2: &[2.0], error_of_sum: Some(600.8), replicates: 4 };
    let found = map.extremes().unwrap();
    // 200 400 photons on 2 m2; s^2 = 66 666.7, R s^2 = 266 667, above counting's 200 400.
    assert_eq!(found.minimum.value, 100_200.0);
    assert!((found.minimum.standard_error - 0.5 * 266_666.666_667f64.sqrt()).abs() < 1e-6);
    assert!((found.minimum.low - (100_200.0 - 3.182_446 * found.minimum.standard_error)).abs() < 1e-6);
    // 200 400 of a mean of 300 400 and of a maximum of 400 400.
    assert!((found.u0.value - 200_400.0 / 300_400.0).abs() < 1e-12);
    assert!((found.ud.value - 200_400.0 / 400_400.0).abs() < 1e-12);
}

/// The quantiles of the tables.
#[test]
fn students_quantiles() {
    for (degrees, t) in [(1, 12.7062), (4, 2.7764), (5, 2.5706), (7, 2.3646), (15, 2.1314), (120, 1.9799)] {
        assert!((student(degrees) - t).abs() < 1.1e-4, "{degrees}: {}", student(degrees));
    }
}
