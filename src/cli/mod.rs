//! The command line, one file a subcommand. Results go to stdout, progress and messages to stderr.

mod args;
mod deadline;
mod progress;
mod results;
mod picture;
mod render;
mod photometry;
mod check;
mod compare;
mod sample;
mod bsdf;

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::error::{ContextKind, ContextValue};
use clap::{Parser, Subcommand};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::outputs::check_outputs;
use crate::files::scene_toml::count::parse_count;
use crate::plot::drawing::Drawing;
use crate::run::Algorithm;
use crate::sequence::Sequence;

use args::{BsdfArgs, CheckArgs, PhotometryArgs, RenderArgs, SampleArgs};

/// Exit codes of the contract.
pub mod exit {
    /// Done.
    pub const DONE: u8 = 0;
    /// The input or the request is wrong.
    pub const WRONG: u8 = 1;
    /// Usage.
    pub const USAGE: u8 = 2;
    /// With --strict: a warning of severity "untrusted".
    pub const UNTRUSTED: u8 = 4;
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
    /// Check a scene: what can be known of it, and what a probe of a few thousand photons finds.
    Check(CheckArgs),
    /// Measure the error of every algorithm variant against a reference (without SCENE: the built-in scene).
    Compare(compare::CompareArgs),
    /// Sample directions of a photometric file, and judge them against its candela.
    Sample(SampleArgs),
    /// Say what a scattering table (BSDF) holds: kind, angles, albedo against incidence, reciprocity.
    Bsdf(BsdfArgs),
}

/// What is not built, and what there is instead.
const INSTEAD: [(&str, &str); 3] = [
    ("--error", "--photons N sets the effort; the summary and report.json tell the standard errors it gave"),
    ("--time", "--photons N sets the effort; Ctrl-C ends a run early and writes what there is"),
    (
        "--resume",
        "a run starts with its first photon; `caustix compare` goes on from the parts it has finished",
    ),
];

/// Adds to an unknown option of [`INSTEAD`] what there is instead.
fn with_hint(mut error: clap::Error) -> clap::Error {
    let Some(ContextValue::String(option)) = error.get(ContextKind::InvalidArg) else { return error };
    if let Some((_, instead)) = INSTEAD.iter().find(|(unbuilt, _)| unbuilt == option) {
        error.remove(ContextKind::SuggestedArg);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![(*instead).into()]));
    }
    error
}

/// The exit code of a subcommand, or why it failed.
type Done = Result<u8, Vec<Diagnostic>>;

/// Runs the command with the arguments of the process.
pub fn main() -> ExitCode {
    let parsed = Command::try_parse().and_then(|command| match command.subcommand {
        Some(subcommand) => Ok(subcommand),
        None => RenderArgs::try_parse_from(["caustix"]).map(Sub::Render),
    });
    let done = match parsed.map_err(with_hint) {
        Err(error) => {
            // Help and version are no errors; clap writes either to where it belongs.
            if !error.use_stderr() {
                printed(error.print());
            } else {
                let _printed = error.print();
            }
            Ok(if error.use_stderr() { exit::USAGE } else { exit::DONE })
        }
        Ok(Sub::Render(args)) => render::run(&args),
        Ok(Sub::Photometry(args)) => photometry::run(&args),
        Ok(Sub::Check(args)) => check::run(&args),
        Ok(Sub::Compare(args)) => compare::run(&args),
        Ok(Sub::Sample(args)) => sample::run(&args),
        Ok(Sub::Bsdf(args)) => bsdf::run(&args),
    };
    let code = done.unwrap_or_else(|errors| fail(&errors));
    ExitCode::from(if CUT.load(Ordering::Relaxed) { exit::WRONG } else { code })
}

/// Set where stdout did not take what was printed.
static CUT: AtomicBool = AtomicBool::new(false);

/// A line to stderr; a closed stderr is no reason to fail.
#[allow(clippy::print_stderr)]
fn say(line: &str) {
    let _written = writeln!(io::stderr(), "{line}");
}

/// Text to stdout. A reader that has gone away (a closed pipe) is no reason to fail; a full disk is, and is told once.
fn print(text: &str) {
    let mut out = io::stdout().lock();
    printed(out.write_all(text.as_bytes()).and_then(|()| out.flush()));
}

fn printed(outcome: io::Result<()>) {
    let Err(error) = outcome else { return };
    if error.kind() != io::ErrorKind::BrokenPipe && !CUT.swap(true, Ordering::Relaxed) {
        let found = format!("\"{error}\" while writing to stdout");
        let diagnostic = Diagnostic::new(Kind::Io, found, "a stdout that takes what is printed");
        say(&format!("error: {diagnostic}"));
    }
}

/// Says errors and gives the exit code for them.
fn fail(errors: &[Diagnostic]) -> u8 {
    for error in errors {
        say(&format!("error: {error}"));
    }
    if errors.iter().any(|e| e.kind() == Kind::Interrupted) { exit::INTERRUPTED } else { exit::WRONG }
}

/// Says warnings.
fn warn(warnings: &[Diagnostic]) {
    for warning in warnings {
        say(&format!("warning: {warning}"));
    }
}

/// What is wrong with an option: its name before what was found.
fn in_option(option: &str, error: &Diagnostic) -> Diagnostic {
    Diagnostic::new(error.kind(), format!("{option}{}", error.found()), error.required().to_string())
}

/// A count given on the command line.
fn count(option: &str, text: Option<&String>) -> Result<Option<u64>> {
    text.map(|t| parse_count(t).map_err(|e| in_option(&format!("{option} "), &e))).transpose()
}

/// A variant and a sequence given on the command line; `default` where no variant is.
fn algorithm(default: Algorithm, variant: Option<&String>, sequence: Option<&String>) -> Result<Algorithm> {
    let parse = |name: &String| Algorithm::parse(name).map_err(|e| in_option("--", &e));
    let mut algorithm = variant.map_or(Ok(default), parse)?;
    if let Some(name) = sequence {
        algorithm.sequence = Sequence::from_name(name).ok_or_else(|| {
            let names: Vec<_> = Sequence::ALL.iter().map(|s| s.name()).collect();
            let required = format!("one of: {}", names.join(", "));
            Diagnostic::new(Kind::Unknown, format!("--sequence {name}"), required)
        })?;
    }
    Ok(algorithm)
}

/// Writes a drawing of what a file holds where `--plot` asks for one; the ending of the name says as what.
fn plot(path: Option<&PathBuf>, of: &Path, drawing: impl FnOnce() -> Drawing) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    check_outputs(std::slice::from_ref(path), &[of.to_path_buf()])?;
    drawing().write(path).map_err(|e| if e.kind() == Kind::Range { in_option("--plot ", &e) } else { e })
}
