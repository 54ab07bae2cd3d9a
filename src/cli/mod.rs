//! The command line, one file a subcommand. Results go to stdout, progress and messages to stderr.

pub mod bsdf;
pub mod check;
pub mod compare;
mod compare_room;
pub mod photometry;
mod picture;
mod progress;
pub mod render;
pub mod sample;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use crate::error::{Diagnostic, Kind};
use crate::files::scene_toml::count::parse_count;
use crate::run::MAX_REPLICATES;

/// Exit codes of the contract.
pub mod exit {
    /// Done.
    pub const DONE: u8 = 0;
    /// The input or the request is wrong.
    pub const WRONG: u8 = 1;
    /// Usage.
    pub const USAGE: u8 = 2;
    /// Interrupted; what there is was written.
    pub const INTERRUPTED: u8 = 130;
}

/// Photons from photometric files through glass, water and mirrors: illuminance maps in lux, and the error of every
/// number.
#[derive(Debug, Parser)]
#[command(
    name = "caustix",
    version,
    about,
    after_help = "Without a command the built-in scene is rendered into ./caustix-out/, as by `caustix render`."
)]
struct Command {
    #[command(subcommand)]
    subcommand: Option<Sub>,
}

#[derive(Debug, Subcommand)]
enum Sub {
    /// Trace a scene and write its illuminance maps (without SCENE: the built-in scene).
    Render(RenderArgs),
    /// Say what a photometric file (IES LM-63) holds: flux, maximum, angles, symmetry.
    Photometry(PhotometryArgs),
    /// Check a scene without tracing it.
    Check(CheckArgs),
    /// Measure the error of every algorithm variant against a reference (without SCENE: the built-in scene).
    Compare(compare::CompareArgs),
    /// Sample directions of a photometric file, and judge them against its candela.
    Sample(SampleArgs),
    /// Say what a scattering table (BSDF) holds: kind, angles, albedo against incidence, reciprocity.
    Bsdf(BsdfArgs),
}

/// Arguments of `caustix render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Scene file; the built-in scene if absent.
    pub scene: Option<PathBuf>,
    /// Directory for the results; made if it is not there.
    #[arg(short = 'o', long = "output", value_name = "DIR", default_value = "caustix-out")]
    pub output: PathBuf,
    /// Photons in all, like 4_456_448, 4.5e6 or 2^22 [default: the scene's, else 2^22].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub photons: Option<String>,
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
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = whole::<u32, 1, { render::MAX_THREADS as u64 }>)]
    pub threads: Option<u32>,
    /// Save the photons that the scene's camera sees, for other views of the same light.
    #[arg(long, value_name = "FILE", conflicts_with = "map")]
    pub save_map: Option<PathBuf>,
    /// Trace nothing: the camera's picture of photons saved by --save-map under the same settings.
    #[arg(long, value_name = "FILE")]
    pub map: Option<PathBuf>,
    /// Not available yet.
    #[arg(long, value_name = "PERCENT", hide = true)]
    pub error: Option<String>,
    /// Not available yet.
    #[arg(long, value_name = "SECONDS", hide = true)]
    pub time: Option<String>,
    /// Not available yet.
    #[arg(long, hide = true)]
    pub resume: bool,
    /// No progress bar and no summary.
    #[arg(long)]
    pub quiet: bool,
}

impl Default for RenderArgs {
    fn default() -> Self {
        Self {
            scene: None,
            output: PathBuf::from("caustix-out"),
            photons: None,
            variant: None,
            sequence: None,
            seed: None,
            replicates: None,
            threads: None,
            save_map: None,
            map: None,
            error: None,
            time: None,
            resume: false,
            quiet: false,
        }
    }
}

/// Arguments of `caustix photometry`.
#[derive(Debug, Args)]
pub struct PhotometryArgs {
    /// Photometric file (IES LM-63).
    pub file: PathBuf,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
    /// Write a polar candela diagram (.svg or .png).
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
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
    /// Photometric file (IES LM-63).
    pub file: PathBuf,
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
}

/// Runs the command with the arguments of the process.
pub fn main() -> ExitCode {
    let command = match Command::try_parse() {
        Ok(command) => command,
        Err(error) => {
            // Help and version are no errors; clap writes either to where it belongs.
            let code = if error.use_stderr() { exit::USAGE } else { exit::DONE };
            let _printed = error.print();
            return ExitCode::from(code);
        }
    };
    let code = match command.subcommand {
        None => render::run(&RenderArgs::default()),
        Some(Sub::Render(args)) => render::run(&args),
        Some(Sub::Photometry(args)) => photometry::run(&args),
        Some(Sub::Check(args)) => check::run(&args),
        Some(Sub::Compare(args)) => compare::run(&args),
        Some(Sub::Sample(args)) => sample::run(&args),
        Some(Sub::Bsdf(args)) => bsdf::run(&args),
    };
    ExitCode::from(code)
}

/// Says that something of the contract is not built yet.
fn not_available(what: &str) -> u8 {
    say(&format!("caustix: {what} is not available yet"));
    exit::USAGE
}

/// A line to stderr; a closed stderr is no reason to fail.
#[allow(clippy::print_stderr)]
fn say(line: &str) {
    use std::io::Write;
    let _written = writeln!(std::io::stderr(), "{line}");
}

/// Text to stdout. A reader that has gone away (a closed pipe) is no reason to fail.
fn print(text: &str) {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    let _written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Says errors and gives the exit code for them.
fn fail(errors: &[Diagnostic]) -> u8 {
    for error in errors {
        say(&format!("error: {error}"));
    }
    exit::WRONG
}

/// Says warnings.
fn warn(warnings: &[Diagnostic]) {
    for warning in warnings {
        say(&format!("warning: {warning}"));
    }
}

/// A whole number given on the command line; `LOW` and `HIGH` are for the message, and are enforced where the number is
/// used. clap puts the option and the text before the message.
fn whole<T: TryFrom<u64>, const LOW: u64, const HIGH: u64>(text: &str) -> Result<T, String> {
    let value = text.parse::<u64>().ok().and_then(|n| T::try_from(n).ok());
    value.ok_or_else(|| format!("required: a whole number from {LOW} to {HIGH}"))
}

/// A count given on the command line.
fn count(option: &str, text: Option<&String>) -> Result<Option<u64>, Diagnostic> {
    text.map(|t| parse_count(t)).transpose().map_err(|e| {
        Diagnostic::new(Kind::Range, format!("{option} {}", e.found()), e.required().to_string())
    })
}
