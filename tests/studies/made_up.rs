//! Made-up studies whose laws are known.

use caustix::lab::study::norms::Errors;
use caustix::lab::study::results::{Account, ReferenceUsed, Run, Study, VariantResult};

/// A number of [0, 1) for an index (SplitMix64's finaliser).
pub fn uniform(index: u64) -> f64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// About normal, mean 0, deviation 1: twelve uniforms less six.
pub fn normal(index: u64) -> f64 {
    (0..12).map(|i| uniform(12 * index + i)).sum::<f64>() - 6.0
}

pub const ASKED: u64 = 4_456_448;
pub const GRIDS: [u32; 3] = [48, 128, 256];

/// nRMS = `at_asked` on 48 x 48 cells at N = [`ASKED`], (N / ASKED)^rate of it elsewhere, 3 and 7 times on finer grids.
pub struct Law {
    pub name: &'static str,
    pub at_asked: f64,
    pub rate: f64,
    pub cpu_s_per_photon: f64,
}

pub const LAWS: [Law; 4] = [
    Law { name: "mc", at_asked: 0.025, rate: -0.5, cpu_s_per_photon: 1e-6 },
    Law { name: "qmc", at_asked: 0.0105, rate: -0.6, cpu_s_per_photon: 1e-6 },
    Law { name: "qmc-inverse", at_asked: 0.0046, rate: -0.7, cpu_s_per_photon: 1.25e-6 },
    Law { name: "qmc-inverse-reuse", at_asked: 0.0033, rate: -0.75, cpu_s_per_photon: 1.25e-6 },
];

pub fn grid_factor(grid: usize) -> f64 {
    [1.0, 3.0, 7.0][grid]
}

/// The laws with so much noise, relative, on every error.
pub fn study(ladder: &[u64], seeds: u64, noise: f64) -> Study {
    let variant = |(v, law): (usize, &Law)| {
        let run = |seed: u64, photons: u64| {
            let errors = (0..GRIDS.len()).map(|grid| {
                let shaken = 1.0
                    + noise
                        * normal((v as u64 * 1000 + seed) * 1000 + photons.ilog2() as u64 * 4 + grid as u64);
                let nrms = law.at_asked
                    * grid_factor(grid)
                    * (photons as f64 / ASKED as f64).powf(law.rate)
                    * shaken;
                Errors { relative_rms: 0.5 * nrms, nrms, relative_l1: 0.25 * nrms }
            });
            Run {
                seed,
                photons,
                cpu_s: law.cpu_s_per_photon * photons as f64,
                coordinates_mean: [8.2, 8.2, 5.0, 3.0][v],
                coordinates_max: [131, 131, 9, 5][v],
                errors: errors.collect(),
            }
        };
        VariantResult {
            name: law.name.into(),
            description: "rejection, retries from the next coordinates".into(),
            runs: (1..=seeds).flat_map(|seed| ladder.iter().map(move |&n| run(seed, n))).collect(),
            account: Some(Account { by_event: 8.2, equation_4: 6.9, equation_6: 3.9 }),
        }
    };
    let largest = ladder.iter().copied().max().unwrap_or(1);
    Study {
        caustix_version: "0.1.0".into(),
        scene_name: "wavy_glass".into(),
        scene_sha256: "0123456789abcdef".into(),
        built_in: true,
        command: "caustix compare --photons 4_456_448".into(),
        receivers: vec!["plate".into()],
        grids: GRIDS.into(),
        asked_photons: ASKED,
        ladder: ladder.into(),
        seeds: (1..=seeds).collect(),
        threads: 2,
        reference: ReferenceUsed {
            photons: 100 * largest,
            replicates: 16,
            sequence: "halton-rotation".into(),
            emission_map: "directions uniform in solid angle, weighted by intensity".into(),
            seed: 20_011,
            own_nrms: vec![0.000_16, 0.000_44, 0.000_9],
            factor: 100.0,
        },
        variants: LAWS.iter().enumerate().map(variant).collect(),
        warnings: vec![],
    }
}

pub fn ladder() -> Vec<u64> {
    let mut ladder: Vec<u64> = (14..=22).map(|k| 1 << k).collect();
    ladder.push(ASKED);
    ladder
}
