//! The experiment of S. Heinrich and A. Keller, "Quasi-Monte Carlo Methods in Computer Graphics, Part II: The
//! Radiance Equation" (Kaiserslautern, 1994), section 5: how well do point sequences find the light that
//! arrives at every triangle of a closed diffuse scene after at most M reflections?
//!
//! Every photon carries a weight per channel through exactly M reflections, without roulette, on 2 M + 4
//! coordinates; at each of its M + 1 arrivals the weight is added to the triangle ([`measure()`]). A number
//! of photons is compared with a larger one of the same sequence, and the largest of the sequences with each
//! other ([`tables`]), in the paper's norm.

pub mod measure;
pub mod tables;

use crate::error::{Diagnostic, Kind, Result};
use crate::lab::study::cells::areas_m2;
use crate::scene::Scene;
use crate::sequence::Sequence;

pub use measure::{Measurement, Task};
pub use tables::{Row, Value};

/// The sequences that are compared: the paper's four, and Sobol'.
pub const SEQUENCES: [Sequence; 5] =
    [Sequence::Independent, Sequence::Halton, Sequence::HaltonFaure, Sequence::Hammersley, Sequence::Sobol];

/// What is measured.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    pub(crate) ladder: Vec<u64>,
    pub(crate) seeds: Vec<u64>,
}

impl Options {
    /// Numbers of photons, rising, at least two; seeds of the random sequence, at least one (the others have
    /// none).
    ///
    /// # Errors
    /// Numbers that do not rise, fewer than two; no seed.
    pub fn new(ladder: Vec<u64>, seeds: Vec<u64>) -> Result<Self> {
        if ladder.len() < 2 || !ladder.is_sorted_by(|a, b| a < b) || seeds.is_empty() {
            let found = format!("photons {ladder:?} and seeds {seeds:?}");
            let required = "two or more rising numbers of photons, and a seed";
            return Err(Diagnostic::new(Kind::Range, found, required));
        }
        Ok(Self { ladder, seeds })
    }

    /// 10^4, 10^5 and 10^6 photons, in full also 10^7, as in the paper.
    pub fn paper_ladder(full: bool) -> Vec<u64> {
        (4..if full { 8 } else { 7 }).map(|power| 10u64.pow(power)).collect()
    }

    fn seeds_of(&self, sequence: Sequence) -> &[u64] {
        if sequence.is_randomised() { &self.seeds } else { &[0] }
    }

    /// Everything that is to be measured, the quickest first.
    pub fn tasks(&self) -> Vec<Task> {
        let of = |photons, sequence| {
            self.seeds_of(sequence).iter().map(move |&seed| Task { sequence, seed, photons })
        };
        let of_all = |&photons: &u64| SEQUENCES.into_iter().flat_map(move |sequence| of(photons, sequence));
        self.ladder.iter().flat_map(of_all).collect()
    }

    /// Photons of all tasks.
    pub fn photons(&self) -> u64 {
        self.tasks().iter().map(|t| t.photons).sum()
    }
}

/// Measurements of one sequence with one seed, one for each number of photons of the ladder.
pub type Ladder = Vec<Measurement>;

/// Everything measured.
#[derive(Debug, Clone, PartialEq)]
pub struct RoomStudy {
    /// The scene file's path as given.
    pub scene_name: String,
    /// SHA-256 of its text.
    pub scene_sha256: String,
    /// Reflections of every photon, M.
    pub reflections: u32,
    /// Areas of the receivers' cells, m2: one receiver after another.
    pub areas_m2: Vec<f64>,
    /// What was asked for.
    pub options: Options,
    /// By sequence, in the order of [`SEQUENCES`], then by seed.
    runs: Vec<Vec<Ladder>>,
}

impl RoomStudy {
    /// The study of these measurements ([`measure()`] of each of [`Options::tasks`]), in any order.
    ///
    /// # Errors
    /// A scene without `[compare]`; a task without a measurement, or with one of another number of cells.
    pub fn new(scene: &Scene, options: &Options, measurements: &[Measurement]) -> Result<Self> {
        let areas_m2 = areas_m2(&scene.receivers);
        let find = |task: Task| {
            let found = measurements.iter().find(|m| m.is_of(&task) && m.radiance.len() == areas_m2.len());
            found.cloned().ok_or_else(|| {
                Diagnostic::new(Kind::Missing, format!("no measurement of {task}"), "one of every task")
            })
        };
        let ladder = |sequence, seed| -> Result<Ladder> {
            options.ladder.iter().map(|&photons| find(Task { sequence, seed, photons })).collect()
        };
        let of_sequence = |sequence: Sequence| {
            options.seeds_of(sequence).iter().map(|&seed| ladder(sequence, seed)).collect::<Result<_>>()
        };
        Ok(Self {
            scene_name: scene.identity.name.clone(),
            scene_sha256: scene.identity.sha256.clone(),
            reflections: measure::reflections(scene)?,
            runs: SEQUENCES.into_iter().map(of_sequence).collect::<Result<_>>()?,
            areas_m2,
            options: options.clone(),
        })
    }

    /// The measurements of a sequence of [`SEQUENCES`], by seed.
    pub fn runs(&self, sequence: usize) -> &[Ladder] {
        &self.runs[sequence]
    }

    /// Whether in every measurement no photon left the scene.
    pub fn is_closed(&self) -> bool {
        self.runs.iter().flatten().flatten().all(|m| m.escaped == 0)
    }
}
