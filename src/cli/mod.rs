//! The command line, one file a subcommand. Results go to stdout, progress and messages to stderr.

mod args;
mod asked;
mod deadline;
mod far_field;
mod forecast;
mod long;
mod kept;
mod misuse;
mod progress;
mod results;
mod part;
mod picture;
mod written;
mod ranks;
#[cfg(feature = "mpi")]
mod mpi;
mod render;
mod start;
mod photometry;
mod check;
mod compare;
mod sample;
mod sweep;
mod shell;
mod bsdf;

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Parser, Subcommand};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::outputs::check_outputs;
use crate::files::scene_toml::count::parse_count;
use crate::files::scene_toml::document::MOST_ERRORS;
use crate::files::suggest;
use crate::plot::drawing::Drawing;
use crate::run::share::Post;
use crate::run::{Algorithm, Variant};
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
    /// Stopped before the error that was asked for was reached; what there is was written.
    pub const UNMET: u8 = 3;
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
    /// Trace a scene and write its illuminance maps, far fields and picture (without SCENE: the built-in scene).
    Render(RenderArgs),
    /// Say what a photometric file (IES LM-63, EULUMDAT) holds: flux, maximum, angles, symmetry.
    Photometry(PhotometryArgs),
    /// Check a scene: what can be known of it, and what a probe of a few thousand photons finds.
    Check(CheckArgs),
    /// Measure the error of every algorithm variant against a reference (without SCENE: the built-in scene).
    Compare(compare::CompareArgs),
    /// Add up the parts of a run (`render --part K/N`) to the results of the whole.
    Merge(part::MergeArgs),
    /// Trace a grid of scenes by common random numbers: what a value of the scene changes, with the error of every difference.
    Sweep(sweep::SweepArgs),
    /// Sample directions of a photometric file, and judge them against its candela.
    Sample(SampleArgs),
    /// Say what a scattering table (BSDF) holds: kind, angles, albedo against incidence, reciprocity.
    Bsdf(BsdfArgs),
    /// Print a script that completes the command's words: of bash, zsh, fish, elvish or powershell.
    Completions(shell::CompletionsArgs),
    /// Print the manual page, in roff: `caustix man | man -l -`.
    Man,
}

/// The exit code of a subcommand, or why it failed.
type Done = Result<u8, Vec<Diagnostic>>;

/// Runs the command with the arguments of the process.
pub fn main() -> ExitCode {
    #[cfg(feature = "mpi")]
    match mpi::Ranks::started() {
        Ok(ranks) => run(ranks.as_ref().map(|ranks| ranks as &dyn Post).filter(|post| post.size() > 1)),
        Err(error) => ExitCode::from(fail(None, &[error])),
    }
    #[cfg(not(feature = "mpi"))]
    run(None)
}

/// Runs the command, where `post` is to the other processes that run it, too.
fn run(post: Option<&dyn Post>) -> ExitCode {
    let parsed = Command::try_parse().and_then(|command| match command.subcommand {
        Some(subcommand) => Ok(subcommand),
        None => RenderArgs::try_parse_from(["caustix"]).map(Sub::Render),
    });
    let post = match (post, &parsed) {
        (None, _) => None,
        (Some(post), Ok(Sub::Render(args))) if post.rank() > 0 => return ranks::follow(args, post),
        (Some(post), _) if post.rank() > 0 => return ExitCode::SUCCESS,
        (Some(post), _) => Some(ranks::Leader(post)),
    };
    let post = post.as_ref().map(|leader| leader.0);
    let scene = match &parsed {
        Ok(Sub::Render(RenderArgs { scene, .. }) | Sub::Check(CheckArgs { scene, .. })) => scene.clone(),
        Ok(Sub::Compare(compare::CompareArgs { scene, .. })) => scene.clone(),
        Ok(Sub::Sweep(sweep::SweepArgs { scene, .. })) => scene.clone(),
        _ => None,
    };
    let done = match parsed {
        Err(error) => {
            let of_file = misuse::of_file(&error);
            let error = misuse::with_tip(error);
            // Help and version are no errors; clap writes either to where it belongs.
            if let Some(diagnostic) = of_file {
                say(&format!("error: {diagnostic}"));
            } else if !error.use_stderr() {
                printed(error.print());
            } else {
                let _printed = error.print();
            }
            Ok(if error.use_stderr() { exit::USAGE } else { exit::DONE })
        }
        Ok(Sub::Render(args)) => render::run(&args, post),
        Ok(_) if post.is_some() => Err(ranks::for_one().into()),
        Ok(Sub::Photometry(args)) => photometry::run(&args),
        Ok(Sub::Check(args)) => check::run(&args),
        Ok(Sub::Compare(args)) => compare::run(&args),
        Ok(Sub::Merge(args)) => part::merge(&args),
        Ok(Sub::Sweep(args)) => sweep::run(&args),
        Ok(Sub::Sample(args)) => sample::run(&args),
        Ok(Sub::Bsdf(args)) => bsdf::run(&args),
        Ok(Sub::Completions(args)) => shell::completions(&args),
        Ok(Sub::Man) => shell::man(),
    };
    let code = done.unwrap_or_else(|errors| fail(scene.as_deref(), &errors));
    ExitCode::from(if CUT.load(Ordering::Relaxed) { exit::WRONG } else { code })
}

/// Set where stdout did not take what was printed.
static CUT: AtomicBool = AtomicBool::new(false);

/// Set where this process is one of several and another one speaks.
static MUTE: AtomicBool = AtomicBool::new(false);

/// A line to stderr; a closed stderr is no reason to fail.
#[allow(clippy::print_stderr)]
fn say(line: &str) {
    if MUTE.load(Ordering::Relaxed) {
        return;
    }
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

/// Says errors, after a line that counts them if they are several, and gives the exit code for them.
fn fail(scene: Option<&Path>, errors: &[Diagnostic]) -> u8 {
    if errors.len() > 1 {
        let number = if errors.len() > MOST_ERRORS {
            format!("more than {MOST_ERRORS}")
        } else {
            errors.len().to_string()
        };
        let scene = scene.map_or("the scene".into(), |path| path.display().to_string());
        say(&format!("error: {scene} cannot be rendered: {number} mistakes"));
    }
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
    let named =
        Diagnostic::new(error.kind(), format!("{option}{}", error.found()), error.required().to_string());
    match error.advice() {
        Some(hint) => named.hint(hint),
        None => named,
    }
}

/// A count given on the command line.
fn count(option: &str, text: Option<&String>) -> Result<Option<u64>> {
    text.map(|t| parse_count(t).map_err(|e| in_option(&format!("{option} "), &e))).transpose()
}

/// A variant and a sequence given on the command line; `default` where no variant is.
fn algorithm(default: Algorithm, variant: Option<&String>, sequence: Option<&String>) -> Result<Algorithm> {
    let parse = |name: &String| {
        let hinted = |e: Diagnostic| match Sequence::from_name(name) {
            Some(_) => e.hint(format!("a sequence is given as `--sequence {name}`")),
            None => suggest::hinted(e, name, &Variant::ALL.map(Variant::name), '`'),
        };
        Algorithm::parse(name).map_err(|e| hinted(in_option("--", &e)))
    };
    let mut algorithm = variant.map_or(Ok(default), parse)?;
    if let Some(name) = sequence {
        algorithm.sequence = Sequence::from_name(name).ok_or_else(|| {
            let names: Vec<_> = Sequence::ALL.iter().map(|s| s.name()).collect();
            let required = format!("one of: {}", names.join(", "));
            let error = Diagnostic::new(Kind::Unknown, format!("--sequence {name}"), required);
            suggest::hinted(error, name, &names, '`')
        })?;
    }
    Ok(algorithm)
}

/// Writes a drawing of what a file holds where an option asks for one; the ending of the name says as what.
fn plot(path: Option<&PathBuf>, option: &str, of: &Path, drawing: impl FnOnce() -> Drawing) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    check_outputs(std::slice::from_ref(path), &[of.to_path_buf()])?;
    let named =
        |e: Diagnostic| if e.kind() == Kind::Range { in_option(&format!("{option} "), &e) } else { e };
    drawing().write(path).map_err(named)
}
