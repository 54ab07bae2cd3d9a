//! `caustix sweep`: scenes of a grid of values by common random numbers, and the differences of neighbours.

mod scenes;

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::Args;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::suggest;
use crate::lab::sweep::figures::{PointFigures, names};
use crate::lab::sweep::grid::Grid;
use crate::plot::sweep::drawing;
use crate::report::numbers::grouped;
use crate::report::sweep::{csv, markdown, text};
use crate::run::{MAX_REPLICATES, Plan, StoppedBy, trace};
use crate::scene::Scene;

use super::args::{MAX_THREADS, whole};
use super::kept::{Kept, Order};
use super::progress::INTERRUPTED;
use super::start::thread_pool;
use super::{Done, exit};
use scenes::{Checked, Scenes};

/// What a sweep writes.
const FILES: [&str; 3] = ["sweep.csv", "sweep.md", "sweep.svg"];

/// Arguments of `caustix sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// Scene file; the built-in scene if absent.
    pub scene: Option<PathBuf>,
    /// A key of the scene and what it takes: emitter.lamp.position[2]=1:3:0.5, material.glass.ior=1.5,1.52 or
    /// surface.ball.material=glass,water. Several keys make a grid of all combinations.
    #[arg(long = "set", value_name = "KEY=VALUES", required = true, allow_hyphen_values = true)]
    pub sets: Vec<String>,
    /// What is shown, like floor.flux_lm,floor.min_lx,absorbed.wall_lm [default: flux, mean, maximum and U0 of every receiver,
    /// flux of every far field, escaped flux].
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    pub of: Vec<String>,
    /// Directory for the results and, in `parts/`, for what is finished: the same command goes on from there.
    #[arg(short = 'o', long = "output", value_name = "DIR", default_value = "caustix-out")]
    pub output: PathBuf,
    /// Photons of each point, like 4_456_448, 4.5e6 or 2^22 [default: the scene's, else 2^22].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub photons: Option<String>,
    /// Algorithm variant, as for `render` [default: qmc-inverse, whose differences have smaller errors].
    #[arg(long, value_name = "V")]
    pub variant: Option<String>,
    /// Point sequence, as for `render` [default: the variant's].
    #[arg(long, value_name = "S")]
    pub sequence: Option<String>,
    /// Seed of the randomisation, the same at every point [default: the scene's, else 1].
    #[arg(long, value_name = "K", allow_hyphen_values = true, value_parser = whole::<u64, 0, { u64::MAX }>)]
    pub seed: Option<u64>,
    /// Independent replicates, from which the standard errors come [default: the scene's, else 8].
    #[arg(long, value_name = "R", allow_hyphen_values = true, value_parser = whole::<u32, 1, { MAX_REPLICATES as u64 }>)]
    pub replicates: Option<u32>,
    /// Threads [default: all cores]. The results do not depend on it.
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
pub(super) fn run(args: &SweepArgs) -> Done {
    let grid = Grid::parse(&args.sets)?;
    refuse_both(args, &grid)?;
    let pool = thread_pool(args.threads)?;
    let mut scenes = Scenes::open(args, &grid)?;
    // Before tracing, not after: a value that is wrong at the last point should cost nobody an hour.
    let shown = chosen(&args.of, &scenes.first()?.0)?;
    pool.install(|| scenes.fix_cells())?;
    let checked = scenes.check(&shown)?;
    let photons = checked.iter().map(|point| point.plan.photons()).fold(0, u64::saturating_add);
    let inputs = scenes.inputs(&checked);
    let order = Order { output: &args.output, quiet: args.quiet, inputs, list: "sweep.json", files: &FILES };
    let kept = Kept::start(order, photons)?;
    let mut points = Vec::new();
    for (at, point) in checked.iter().enumerate() {
        kept.progress.phase(format!("point {} of {}", at + 1, grouped(checked.len() as u64)));
        match pool.install(|| traced(&scenes, &kept, at, point))? {
            Some(figures) => points.push(Some(figures)),
            None => break,
        }
    }
    kept.progress.clear();
    let finished = points.len();
    points.resize(checked.len(), None);
    let sweep = scenes.results(shown, &checked, points);
    let mut is_whole = true;
    if finished > 0 {
        let [table, told, plot] = FILES;
        let files = [(table, csv(&sweep)), (told, markdown(&sweep)), (plot, drawing(&sweep).to_svg())];
        is_whole = kept.write(&scenes.original, &files, &text(&sweep))?;
    }
    let is_interrupted = INTERRUPTED.load(Ordering::Relaxed) && finished < sweep.points.len();
    Ok(match (is_whole, is_interrupted, finished) {
        (false, ..) => exit::WRONG,
        (_, false, _) => exit::DONE,
        (_, true, 0) => kept.interrupted("no point was finished"),
        (_, true, _) => {
            let all = grouped(sweep.points.len() as u64);
            kept.interrupted(&format!(
                "the {} of {all} points finished by then are in the table",
                grouped(finished as u64)
            ))
        }
    })
}

/// An option that would hide what is swept.
fn refuse_both(args: &SweepArgs, grid: &Grid) -> Result<()> {
    let given = [
        ("--photons", "run.photons", args.photons.is_some()),
        ("--seed", "run.seed", args.seed.is_some()),
        ("--replicates", "run.replicates", args.replicates.is_some()),
    ];
    let is_swept = |key: &str| grid.axes().iter().any(|axis| axis.key == key);
    match given.iter().find(|(_, key, given)| *given && is_swept(key)) {
        None => Ok(()),
        Some((option, key, _)) => {
            let found = format!("{option} beside --set {key}");
            Err(Diagnostic::new(Kind::Range, found, "one of them: the option would be taken at every point"))
        }
    }
}

/// Names of the figures that are shown.
fn chosen(of: &[String], scene: &Scene) -> Result<Vec<String>> {
    let all = names(scene);
    let known: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    let mut chosen: Vec<String> = Vec::new();
    for name in of.iter().map(|name| name.trim()) {
        if !known.contains(&name) {
            let error = Diagnostic::new(
                Kind::Unknown,
                format!("--of {name}"),
                format!("one of: {}", known.join(", ")),
            );
            return Err(suggest::hinted(error, name, &known, '`'));
        }
        if chosen.iter().any(|known| known == name) {
            return Err(Diagnostic::new(Kind::Range, format!("--of {name} twice"), "every figure once"));
        }
        chosen.push(name.to_owned());
    }
    if chosen.is_empty() {
        chosen = all.into_iter().filter(|(_, is_default)| *is_default).map(|(name, _)| name).collect();
    }
    Ok(chosen)
}

/// What is found at a point, kept or traced; `None` after an interrupt.
fn traced(scenes: &Scenes<'_>, kept: &Kept, at: usize, point: &Checked) -> Result<Option<PointFigures>> {
    kept.part("point", &point.key, point.plan.photons(), |progress| {
        if INTERRUPTED.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let (scene, _) = scenes.scene(at).map_err(first_of)?;
        outcome_of(&scene, &point.plan, progress)
    })
}

fn outcome_of(scene: &Scene, plan: &Plan, progress: &(dyn Fn(u64) + Sync)) -> Result<Option<PointFigures>> {
    match trace(scene, plan, &INTERRUPTED, progress) {
        Ok(outcome) if outcome.stopped_by == StoppedBy::Interrupt => Ok(None),
        Ok(outcome) => Ok(Some(PointFigures::new(scene, &outcome))),
        Err(error) if error.kind() == Kind::Interrupted => Ok(None),
        Err(error) => Err(error),
    }
}

/// A scene that could be built a moment ago: what is wrong now is a file that has changed.
fn first_of(errors: Vec<Diagnostic>) -> Diagnostic {
    let changed =
        || Diagnostic::new(Kind::Io, "a scene that cannot be built any more", "files that stay as they are");
    errors.into_iter().next().unwrap_or_else(changed)
}
