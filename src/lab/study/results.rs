//! What a study measured, as plain data: written, read back and shown, nothing computed. [`super::table`]
//! draws from it what is reported.

use serde::{Deserialize, Serialize};

use super::norms::Errors;

/// The variant that others are compared with.
pub const BASELINE: &str = "mc";

/// The paper's four algorithms: the name of the variant here, and how much less error than Monte Carlo the
/// paper gives (METHOD 6) for a scene like the built-in one at 4 456 448 photons.
pub const PAPER_RATIOS: [(&str, f64); 4] =
    [("mc", 1.0), ("qmc", 1.59), ("qmc-inverse", 1.93), ("qmc-inverse-reuse", 2.19)];

/// One scene under several algorithm variants. Interrupted ones may lack runs: tables show what is there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// Version of the program.
    pub caustix_version: String,
    /// The scene's name or path.
    pub scene_name: String,
    /// SHA-256 of the scene file.
    pub scene_sha256: String,
    /// Whether it is the built-in scene, the one that the paper's figures stand beside.
    pub built_in: bool,
    /// The command that makes this study.
    pub command: String,
    /// Receivers whose cells the errors go over, all together.
    pub receivers: Vec<String>,
    /// Cells along each side of a receiver, one grid after another.
    pub grids: Vec<u32>,
    /// Photons that were asked for.
    pub asked_photons: u64,
    /// Numbers of photons, rising: powers of two, and the number asked for.
    pub ladder: Vec<u64>,
    /// Seeds of every variant.
    pub seeds: Vec<u64>,
    /// Threads.
    pub threads: usize,
    /// What errors are measured against.
    pub reference: ReferenceUsed,
    /// The variants, in the order of the tables.
    pub variants: Vec<VariantResult>,
    /// What else is to be said about the scene or the study.
    pub warnings: Vec<String>,
}

/// The map that stands for the truth, and its own error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReferenceUsed {
    /// Photons of all replicates.
    pub photons: u64,
    /// Replicates; its own error comes from their spread.
    pub replicates: u32,
    /// Its point sequence.
    pub sequence: String,
    /// How its directions are drawn from the points.
    pub emission_map: String,
    /// Its seed.
    pub seed: u64,
    /// Its own nRMS on every grid ([`super::reference::Reference::own_nrms`]).
    pub own_nrms: Vec<f64>,
    /// Its photons over the largest N of the ladder.
    pub factor: f64,
}

/// Everything measured of one variant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VariantResult {
    /// Its name.
    pub name: String,
    /// Sequence, rejection and its retries or solver, and whether coordinates are used again.
    pub description: String,
    /// One point set a run, in any order.
    pub runs: Vec<Run>,
    /// What its coordinates should be, where that was counted.
    pub account: Option<Account>,
}

/// One set of N points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Its seed.
    pub seed: u64,
    /// N.
    pub photons: u64,
    /// CPU time over all threads, s.
    pub cpu_s: f64,
    /// Coordinates a photon used, on average.
    pub coordinates_mean: f64,
    /// Most coordinates that a photon used.
    pub coordinates_max: u64,
    /// Errors against the reference, one entry a grid.
    pub errors: Vec<Errors>,
}

/// Coordinates a photon from other counts than the one measured (METHOD 1), on average.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Account {
    /// Counted event by event.
    pub by_event: f64,
    /// The paper's equation (4), without reuse.
    pub equation_4: f64,
    /// The paper's equation (6), with reuse.
    pub equation_6: f64,
}

impl Study {
    /// Index of the variant that others are compared with, if it is among them.
    pub fn baseline(&self) -> Option<usize> {
        self.variants.iter().position(|v| v.name == BASELINE)
    }

    /// How much less error than Monte Carlo the paper gives for a variant; only for the built-in scene.
    pub fn paper_ratio(&self, variant: &str) -> Option<f64> {
        PAPER_RATIOS.iter().find(|(name, _)| self.built_in && *name == variant).map(|(_, ratio)| *ratio)
    }

    /// Whether the paper says something about any of the variants.
    pub fn is_of_paper(&self) -> bool {
        self.variants.iter().any(|v| self.paper_ratio(&v.name).is_some())
    }
}
