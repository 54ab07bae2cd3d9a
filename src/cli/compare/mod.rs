//! `caustix compare`: the error of every algorithm variant against a reference; of sequences side by side where the scene has
//! `[compare]`.

mod room;
mod study;

use std::path::PathBuf;

use clap::Args;

use crate::error::{Diagnostic, Kind, Result};

use crate::lab::study::cells::MOST_CELLS;
use crate::scene::Scene;

use super::args::{MAX_THREADS, whole};
use super::kept::Order;
use super::start::load;
use super::{Done, results, warn};

/// Most point sets of a variant.
const MOST_SEEDS: u32 = 1024;

/// Arguments of `caustix compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Scene file; the built-in scene if absent.
    pub scene: Option<PathBuf>,
    /// Directory for the results and, in `parts/`, for what is finished: the same command goes on from there.
    #[arg(short = 'o', long = "output", value_name = "DIR", default_value = "caustix-out")]
    pub output: PathBuf,
    /// Photons of the largest run of each variant and seed [default: 2^20].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub photons: Option<String>,
    /// Variants, like mc,qmc,qmc:table,qmc-inverse-reuse:halton [default: the paper's four].
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    pub variants: Vec<String>,
    /// Photons of the reference [default: 100 times N].
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    pub reference_photons: Option<String>,
    /// Cells along each side of the grids that errors are measured on [default: 48,128,256].
    #[arg(long, value_name = "K,K,...", value_delimiter = ',', allow_hyphen_values = true, value_parser = whole::<u32, 1, { MOST_CELLS as u64 }>)]
    pub cells: Vec<u32>,
    /// More variants: every form of rejection, other solvers and sequences. In a scene with `[compare]`: 10^7 photons.
    #[arg(long)]
    pub full: bool,
    /// The least number of photons of which errors are taken; from there powers of two up to N [default: N / 256].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub from: Option<String>,
    /// Point sets of each variant.
    #[arg(long, value_name = "S", default_value = "4", allow_hyphen_values = true, value_parser = whole::<u32, 1, { MOST_SEEDS as u64 }>)]
    pub seeds: u32,
    /// The first seed; the others follow it.
    #[arg(long, value_name = "K", default_value = "1", allow_hyphen_values = true, value_parser = whole::<u64, 0, { u64::MAX }>)]
    pub seed: u64,
    /// Threads [default: all cores]. The errors do not depend on it.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = whole::<u32, 1, { MAX_THREADS as u64 }>)]
    pub threads: Option<u32>,
    /// Read files at or below the scene's folder alone, links followed: for scenes from strangers.
    #[arg(long)]
    pub confine: bool,
    /// No progress bar and no table.
    #[arg(long)]
    pub quiet: bool,
}

/// Runs the subcommand; the exit code.
pub(super) fn run(args: &CompareArgs) -> Done {
    let (scene, _) = load(args.scene.as_deref(), args.confine, args.quiet)?;
    warn(&scene.warnings);
    if scene.compared_reflections.is_some() { room::run(args, &scene) } else { study::run(args, &scene) }
}

impl CompareArgs {
    /// What a study of these files is given and writes.
    fn order<'a>(&'a self, scene: &Scene, files: &'a [&'a str]) -> Order<'a> {
        let inputs = results::inputs(self.scene.as_deref(), scene);
        Order { output: &self.output, quiet: self.quiet, inputs, list: "compare.json", files }
    }
}

/// The seeds asked for.
fn seeds(args: &CompareArgs) -> Result<Vec<u64>> {
    if !(1..=MOST_SEEDS).contains(&args.seeds) {
        let found = format!("--seeds {}", args.seeds);
        return Err(Diagnostic::new(Kind::Range, found, format!("1 to {MOST_SEEDS} seeds")));
    }
    Ok((0..u64::from(args.seeds)).map(|k| args.seed.wrapping_add(k)).collect())
}
