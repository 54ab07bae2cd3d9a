//! `caustix render --part K/N` and `caustix merge`: one run on many machines.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;

use crate::error::words::names;
use crate::error::{Diagnostic, Kind, Result};
use crate::files::folder::Folder;
use crate::files::outputs::check_outputs;
use crate::files::run_state::{self, Head, STATE, Saved};
use crate::files::scene_toml;
use crate::picture::part::AnyPhotons;
use crate::picture::{AnyPicture, Watch};
use crate::report::numbers::grouped;
use crate::run::kept::is_together;
use crate::run::replicates::{Course, Unkept};
use crate::run::together::{Together, Watched};
use crate::run::{Goal, Plan, StoppedBy, choose_cells};
use crate::scene::Scene;

use super::args::{MAX_THREADS, whole};
use super::asked::Asked;
use super::long::{self, Job};
use super::progress::{INTERRUPTED, Progress, catch_interrupts};
use super::start::{files_of, load, thread_pool};
use super::written::{Told, say_found};
use super::{Done, RenderArgs, exit, print, results, say, warn, written};

/// Arguments of `caustix merge`.
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// States of all parts of one run, as `caustix render --part K/N` wrote them, in any order.
    #[arg(required = true, value_name = "STATE")]
    pub states: Vec<PathBuf>,
    /// Directory for the results; made if it is not there.
    #[arg(short = 'o', long = "output", value_name = "DIR", default_value = "caustix-out")]
    pub output: PathBuf,
    /// The scene file, where it does not lie as the states name it.
    #[arg(long, value_name = "SCENE")]
    pub scene: Option<PathBuf>,
    /// Read files at or below the scene's folder alone, links followed: for scenes from strangers.
    #[arg(long)]
    pub confine: bool,
    /// Threads [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = whole::<u32, 1, { MAX_THREADS as u64 }>)]
    pub threads: Option<u32>,
    /// Exit with 4 where a warning says that a number is wrong (severity "untrusted").
    #[arg(long)]
    pub strict: bool,
    /// Print what replicates and doublings say of each receiver.
    #[arg(long)]
    pub diagnose: bool,
    /// No progress bar and no summary.
    #[arg(long)]
    pub quiet: bool,
}

/// Traces a part of a run, and writes its state; the exit code.
pub fn run(args: &RenderArgs, asked: &Asked<'_>, mut scene: Scene, part: [u32; 2]) -> Done {
    let [k, of] = part;
    let name = format!("part-{k}.state");
    let state = args.output.join(&name);
    catch_interrupts();
    let _folder =
        Folder::take_part(&args.output, &format!(".caustix-part-{k}.lock"), "a directory for the results")?;
    check_outputs(std::slice::from_ref(&state), &results::inputs(args.scene.as_deref(), &scene))?;
    let saved = if args.resume { long::found(&state, args.quiet)? } else { None };
    let (plan, _) = asked.plan(saved.as_ref().map(|saved| &saved.head))?;
    asked.say_rounding(&plan);
    check(&scene, &plan, saved.as_ref(), part)?;
    let pool = thread_pool(args.threads)?;
    match &saved {
        Some(saved) => saved.head.divide(&mut scene),
        None => pool.install(|| choose_cells(&mut scene, &plan, &INTERRUPTED))?,
    }
    let job = Job {
        scene: &scene,
        plan,
        goal: Goal::default(),
        state: &state,
        part_of: Some(part),
        quiet: args.quiet,
    };
    let outcome = pool.install(|| job.traced(saved.as_ref()))?;
    if outcome.stopped_by == StoppedBy::Interrupt {
        say(&format!(
            "caustix: interrupted; the same command with --resume goes on from {}",
            state.display()
        ));
        return Ok(exit::INTERRUPTED);
    }
    if Saved::open(&state).is_err() {
        return Ok(exit::WRONG);
    }
    if !args.quiet {
        let [photons, all] = [outcome.photons, plan.photons()].map(grouped);
        print(&format!("part {k} of {of}: {photons} of {all} photons, written to {}\n", state.display()));
        print(&format!("`caustix merge` makes the results of all {of} parts\n"));
    }
    Ok(exit::DONE)
}

/// That a run can be done in parts, and that a state is of this part.
fn check(scene: &Scene, plan: &Plan, saved: Option<&Saved>, [k, of]: [u32; 2]) -> Result<()> {
    let refuse = |found: String, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
    let algorithm = plan.algorithm();
    if algorithm.sampling().skips_points() || algorithm.sequence.needs_number() {
        let required = "a variant whose photons are numbered as its points are, of a sequence that is not made for its number";
        return refuse(format!("a part of a run by {}", algorithm.name()), required);
    }
    if !is_together(scene, plan) {
        let required =
            "fewer cells or replicates: at most 2^27 counters in all, so that parts can be added up";
        return refuse(format!("a part of {} replicates of maps that large", plan.replicates()), required);
    }
    if u64::from(of) > plan.photons_per_replicate() {
        let found = format!("{of} parts of replicates of {} photons", plan.photons_per_replicate());
        return refuse(found, "at most as many parts as a replicate has photons");
    }
    let Some(saved) = saved else { return Ok(()) };
    if saved.head.part_of != Some([k, of]) {
        let found = saved.head.part_of.map_or("a whole run".into(), |[k, of]| format!("part {k} of {of}"));
        let error: Result<()> = refuse(format!("the state of {found}"), &format!("one of part {k} of {of}"));
        return error.map_err(|e| e.hint("another folder, or without --resume").in_file(saved.path()));
    }
    saved.head.check_part(plan).map_err(|e| e.in_file(saved.path()))
}

/// Runs `caustix merge`; the exit code.
pub fn merge(args: &MergeArgs) -> Done {
    let started = Instant::now();
    let saved = args.states.iter().map(|path| Saved::open(path)).collect::<Result<Vec<_>>>()?;
    check_parts(&saved)?;
    let head = &saved[0].head;
    let path = args.scene.clone().or_else(|| (!is_built_in(&head.scene)).then(|| PathBuf::from(&head.scene)));
    let (mut scene, _) = load(path.as_deref(), args.confine, args.quiet)?;
    warn(&scene.warnings);
    scene.found.iter().for_each(say_found);
    let plan = Plan::new(&head.settings()?)?;
    head.check(&scene, &plan).map_err(|e| e.in_file(saved[0].path()))?;
    saved.iter().try_for_each(|part| part.head.check_part(&plan).map_err(|e| e.in_file(part.path())))?;
    head.divide(&mut scene);
    if !is_together(&scene, &plan) {
        let found = format!(
            "the state of {} replicates, whose maps do not fit into memory together",
            plan.replicates()
        );
        return Err(Diagnostic::new(Kind::Limit, found, "the state of a part of a run")
            .in_file(saved[0].path())
            .into());
    }
    catch_interrupts();
    let folder = results::take(&args.output)?;
    let mut inputs = results::inputs(path.as_deref(), &scene);
    inputs.extend(args.states.iter().cloned());
    let state = args.output.join(STATE);
    check_outputs(&files_of(&scene, &args.output, true).collect::<Vec<_>>(), &inputs)?;
    let pool = thread_pool(args.threads)?;
    let progress = Progress::new(args.quiet, "adding parts", 0);
    let mut course = Course::new(Together::new(&scene, &plan)?);
    let mut photons = scene.camera.as_ref().map(|_| AnyPhotons::new(&scene)).transpose()?;
    for part in &saved {
        part.add_to(&mut course.run, photons.as_mut())?;
        course.trace_s += part.head.trace_s();
    }
    course.run.whole();
    progress.clear();
    match &photons {
        None => run_state::write(&state, &Head::of(&course, None, None), |out| course.run.write(out))?,
        // Nothing can be added to a picture.
        Some(_) => run_state::remove(&state),
    }
    let told = Told {
        folder: &folder,
        output: &args.output,
        inputs,
        save_map: None,
        started,
        diagnose: args.diagnose,
        quiet: args.quiet,
        strict: args.strict,
    };
    pool.install(|| {
        let watched = Watched { interrupt: &INTERRUPTED, progress: &|_| {} };
        let mut outcome = course.run(Goal::default(), watched, &mut Unkept)?;
        let picture = photons.map(|photons| seen(photons, &scene, &plan, args.quiet)).transpose()?;
        if picture.is_some() {
            // A run in one piece traces the replicates of a picture in turn, and does not know.
            outcome.doublings.clear();
        }
        written::write(&told, &scene, &outcome, picture.as_ref())
    })
}

/// The picture of the photons of all parts.
fn seen(photons: AnyPhotons, scene: &Scene, plan: &Plan, quiet: bool) -> Result<AnyPicture> {
    let progress = Progress::new(quiet, "camera", 0);
    let watch = Watch { interrupt: &INTERRUPTED, photons: &|_| {}, camera: &|share| progress.picture(share) };
    let picture = photons.picture(scene, plan, watch);
    progress.clear();
    picture
}

fn is_built_in(name: &str) -> bool {
    name == scene_toml::BUILT_IN
}

/// That states are all parts of one run, each once and whole.
fn check_parts(saved: &[Saved]) -> Result<()> {
    let (first, rest) =
        saved.split_first().ok_or_else(|| Diagnostic::new(Kind::Missing, "no states", "at least one"))?;
    for other in rest {
        first.head.check_same_run(&other.head).map_err(|e| e.in_file(other.path()))?;
    }
    let of = first.head.part_of.map_or(1, |[_, of]| of);
    let number = |saved: &Saved| saved.head.part_of.map_or(1, |[k, _]| k);
    for (i, part) in saved.iter().enumerate() {
        if let Some(twin) = saved[..i].iter().find(|twin| number(twin) == number(part)) {
            let found = format!("part {} of {of}, which {} is, too", number(part), twin.path().display());
            return Err(Diagnostic::new(Kind::Range, found, "each part once").in_file(part.path()));
        }
        if !part.head.is_done() {
            let (k, (_, done)) = (number(part), part.head.photons());
            let found = format!(
                "part {k} of {of} after {} photons of each replicate: it is not finished",
                grouped(done)
            );
            let hint = format!("`caustix render --part {k}/{of} --resume` finishes it");
            return Err(Diagnostic::new(Kind::Range, found, "finished parts")
                .hint(hint)
                .in_file(part.path()));
        }
    }
    let missing: Vec<String> =
        (1..=of).filter(|k| !saved.iter().any(|part| number(part) == *k)).map(|k| k.to_string()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let found = format!("{} of {of} parts: missing {}", saved.len(), names(&missing, 16));
    Err(Diagnostic::new(Kind::Missing, found, format!("all {of} parts of the run")))
}
