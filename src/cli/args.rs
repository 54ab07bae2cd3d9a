//! The arguments of the subcommands.

use std::path::PathBuf;

use clap::{Args, Parser};

use crate::files::eulumdat::MAX_LAMP_SETS;
use crate::run::MAX_REPLICATES;

/// Most threads that can be asked for; starting more takes longer than tracing.
pub const MAX_THREADS: u32 = 1024;

/// Arguments of `caustix render`; by itself the command without a subcommand.
#[derive(Debug, Parser)]
pub struct RenderArgs {
    /// Scene file; the built-in scene if absent.
    pub scene: Option<PathBuf>,
    /// Directory for the results; made if it is not there.
    #[arg(short = 'o', long = "output", value_name = "DIR", default_value = "caustix-out")]
    pub output: PathBuf,
    /// Photons in all, like 4_456_448, 4.5e6 or 2^22 [default: the scene's, else 2^22].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub photons: Option<String>,
    /// Stop when this relative standard error (one sigma) is reached, in percent, like 1 or 0.5%; --photons is then the most
    /// [default: 2^38], and there are 32 replicates unless others are asked for. Exit with 3 where it is not reached.
    #[arg(long, value_name = "PERCENT", allow_hyphen_values = true, conflicts_with = "map")]
    pub error: Option<String>,
    /// What --error is of: cells (root mean square by area, relative to the mean; the default), flux, mean or max. Of several
    /// receivers all are to reach it.
    #[arg(long, value_name = "WHAT", requires = "error")]
    pub error_of: Option<String>,
    /// Stop after this time, like 90 (seconds), 10min or 1.5h, counted from the start of the command.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, conflicts_with = "map")]
    pub time: Option<String>,
    /// Go on from the state that an earlier run left in DIR (run.state); with more --photons or --replicates these are added.
    #[arg(long, conflicts_with = "map")]
    pub resume: bool,
    /// Trace the Kth of N parts of the run alone, into DIR/part-K.state; `caustix merge` adds the parts up.
    #[arg(long, value_name = "K/N", allow_hyphen_values = true, conflicts_with = "map")]
    pub part: Option<String>,
    /// Algorithm variant: mc, qmc, qmc-inverse or qmc-inverse-reuse (default); mc and qmc reject inside
    /// the table's cell; mc:table against its maximum, mc:next-point the same with retries from the next point.
    #[arg(long, value_name = "V")]
    pub variant: Option<String>,
    /// Point sequence: sobol-owen (default), sobol, sobol-shift, independent, halton, halton-faure, hammersley, lattice, weyl or
    /// kronecker, the last six also with "-rotation" for a seed; jittered, latin-hypercube.
    #[arg(long, value_name = "S")]
    pub sequence: Option<String>,
    /// Seed of the randomisation [default: the scene's, else 1].
    #[arg(long, value_name = "K", allow_hyphen_values = true, value_parser = whole::<u64, 0, { u64::MAX }>)]
    pub seed: Option<u64>,
    /// Independent replicates, from which the standard errors come [default: the scene's, else 8].
    #[arg(long, value_name = "R", allow_hyphen_values = true, value_parser = whole::<u32, 1, { MAX_REPLICATES as u64 }>)]
    pub replicates: Option<u32>,
    /// Threads [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = whole::<u32, 1, { MAX_THREADS as u64 }>)]
    pub threads: Option<u32>,
    /// Save the photons that the scene's camera sees, for other views of the same light.
    #[arg(long, value_name = "FILE", conflicts_with = "map")]
    pub save_map: Option<PathBuf>,
    /// Trace nothing: the camera's picture of photons saved by --save-map under the same settings.
    #[arg(long, value_name = "FILE")]
    pub map: Option<PathBuf>,
    /// Read files at or below the scene's folder alone, links followed: for scenes from strangers.
    #[arg(long)]
    pub confine: bool,
    /// Exit with 4 where a warning says that a number is wrong (severity "untrusted").
    #[arg(long)]
    pub strict: bool,
    /// Print what replicates and doublings say of each receiver: how the error falls, whether the estimate drifts, how replicates
    /// scatter, and a verdict.
    #[arg(long, conflicts_with_all = ["map", "part"])]
    pub diagnose: bool,
    /// No progress bar and no summary.
    #[arg(long)]
    pub quiet: bool,
}

/// Arguments of `caustix photometry`.
#[derive(Debug, Args)]
pub struct PhotometryArgs {
    /// Photometric files (IES LM-63, EULUMDAT): one in full, several in a row each.
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Of the lamp sets of an EULUMDAT file the one of this number, from 1 [default: the first].
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole::<usize, 1, { MAX_LAMP_SETS as u64 }>)]
    pub lamp_set: Option<usize>,
    /// As JSON; of several files an array.
    #[arg(long)]
    pub json: bool,
    /// As CSV: the candela table of one file, a row each of several.
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    /// Write a polar candela diagram (.svg or .png).
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write a diagram of lines of equal intensity (.svg or .png).
    #[arg(long, value_name = "FILE")]
    pub iso: Option<PathBuf>,
    /// Show and table intensities in candela per 1000 lm of the lamps, or of the luminaire in absolute photometry.
    #[arg(long)]
    pub per_klm: bool,
    /// Write the luminaire as another file: ies (LM-63-2002), ies2019 or ldt (EULUMDAT).
    #[arg(long, value_name = "FORMAT", requires = "output")]
    pub to: Option<String>,
    /// The file that --to writes.
    #[arg(short = 'o', long = "output", value_name = "FILE", requires = "to")]
    pub output: Option<PathBuf>,
    /// Scale what --to writes to this flux, lm (by the trapezoid of the lighting industry).
    #[arg(long, value_name = "LM", allow_hyphen_values = true, requires = "to")]
    pub flux: Option<f64>,
    /// Turn what --to writes about its axis: what was at H comes to H + DEG.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, requires = "to")]
    pub turn: Option<f64>,
}

/// Arguments of `caustix bsdf`.
#[derive(Debug, Args)]
pub struct BsdfArgs {
    /// Scattering table: caustix text, Zemax/Radiant .bsdf, MERL or Klems XML.
    pub file: PathBuf,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
    /// Write a polar diagram of the plane of incidence (.svg or .png).
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
}

/// Arguments of `caustix sample`.
#[derive(Debug, Args)]
pub struct SampleArgs {
    /// Photometric file (IES LM-63, EULUMDAT).
    pub file: PathBuf,
    /// Of the lamp sets of an EULUMDAT file the one of this number, from 1 [default: the first].
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole::<usize, 1, { MAX_LAMP_SETS as u64 }>)]
    pub lamp_set: Option<usize>,
    /// Directions to sample, like 1e6 or 2^20.
    #[arg(short = 'n', value_name = "N", allow_hyphen_values = true)]
    pub samples: String,
    /// Algorithm variant, as for `render` [default: qmc-inverse-reuse].
    #[arg(long, value_name = "V")]
    pub variant: Option<String>,
    /// Point sequence [default: the variant's].
    #[arg(long, value_name = "S")]
    pub sequence: Option<String>,
    /// Seed of the randomisation.
    #[arg(long, value_name = "K", default_value = "1", allow_hyphen_values = true, value_parser = whole::<u64, 0, { u64::MAX }>)]
    pub seed: u64,
    /// Write the directions as CSV: the file's own angles, the unit vector of a lamp that hangs, coordinates used.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `caustix check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// Scene file; the built-in scene if absent.
    pub scene: Option<PathBuf>,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
    /// Read files at or below the scene's folder alone, links followed: for scenes from strangers.
    #[arg(long)]
    pub confine: bool,
    /// Exit with 4 where a warning says that a number would be wrong (severity "untrusted").
    #[arg(long)]
    pub strict: bool,
}

/// A whole number given on the command line; `LOW` and `HIGH` are for the message, and are enforced where the number is
/// used. clap puts the option and the text before the message.
pub fn whole<T: TryFrom<u64>, const LOW: u64, const HIGH: u64>(text: &str) -> Result<T, String> {
    let value = text.parse::<u64>().ok().and_then(|n| T::try_from(n).ok());
    let high = if HIGH == u64::MAX { "2^64 - 1".to_string() } else { HIGH.to_string() };
    value.ok_or_else(|| format!("required: a whole number from {LOW} to {high}"))
}
