//! `caustix render`: trace a scene, write its maps, say what was found.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::folder::LOCK;
use crate::files::outputs::check_outputs;
use crate::files::run_state::STATE;
use crate::files::scene_toml::{self, RunDefaults};
use crate::files::set::Set;
use crate::picture::{AnyPicture, Picture, Watch, picture_of_saved, trace_picture, warnings as seen_wrong};
use crate::report::saved::SavedReport;
use crate::report::vouched::vouching;
use crate::run::replicates::is_together;
use crate::run::{Outcome, Plan, choose_cells, trace};
use crate::scene::Scene;
use crate::scene::receiver::Receiver;

use super::args::MAX_THREADS;
use super::long::{self, Asked};
use super::misuse::a_folder;
use super::progress::{INTERRUPTED, Progress, catch_interrupts};
use super::written::{REPORT, Told, beside_earlier, endings, say_found, seen_wholly, strictly};
use super::{Done, RenderArgs, exit, far_field, part, picture, print, results, say, warn, written};

/// Reads and builds a scene, from its own folder alone if it is confined to that; without a path the built-in one.
pub(super) fn load(
    path: Option<&Path>,
    confine: bool,
    quiet: bool,
) -> std::result::Result<(Scene, RunDefaults), Vec<Diagnostic>> {
    let name = path.map_or("the built-in scene".into(), |path| path.display().to_string());
    let progress = Progress::new(quiet, &format!("reading {name}"), 0);
    let loaded = load_in_phases(path, confine, || progress.phase(format!("building {name}")));
    progress.clear();
    loaded
}

fn load_in_phases(
    path: Option<&Path>,
    confine: bool,
    building: impl FnOnce(),
) -> std::result::Result<(Scene, RunDefaults), Vec<Diagnostic>> {
    let file = match path {
        Some(path) if path.is_dir() => return Err(a_folder(path, "a scene file (TOML)").into()),
        Some(path) if confine => scene_toml::read_confined(path)?,
        Some(path) => scene_toml::read(path)?,
        None => scene_toml::built_in()?,
    };
    let run = file.run;
    building();
    Ok((file.build()?, run))
}

/// Runs the subcommand; the exit code.
pub(super) fn run(args: &RenderArgs) -> Done {
    let started = Instant::now();
    let (mut scene, run) = load(args.scene.as_deref(), args.confine, args.quiet)?;
    warn(&scene.warnings);
    scene.found.iter().for_each(say_found);
    picture::check(args, &scene)?;
    let asked = Asked::new(args, run, started)?;
    asked.check_camera(&scene)?;
    if let Some(part) = asked.part {
        return part::run(args, &asked, scene, part);
    }
    if let Some(map) = &args.map {
        catch_interrupts();
        return seen_again(args, map, &scene, &asked.plan(None)?.0, started);
    }
    // Told before anything is made.
    asked.plan(None)?;
    catch_interrupts();
    // Before tracing, not after: a directory that cannot be made should cost nobody an hour.
    let folder = results::take(&args.output)?;
    let inputs = results::inputs(args.scene.as_deref(), &scene);
    check_outputs(&outputs(args, &scene), &inputs)?;
    let state = args.output.join(STATE);
    let saved = if args.resume { long::found(&state)? } else { None };
    let (plan, goal) = asked.plan(saved.as_ref().map(|saved| &saved.head))?;
    asked.say_rounding(&plan);
    let pool = thread_pool(args.threads)?;
    match &saved {
        Some(saved) => saved.head.divide(&mut scene),
        None => {
            let progress = Progress::new(args.quiet, "choosing cells", 0);
            let plan = asked.plan_of_cells(&plan)?;
            pool.install(|| choose_cells(&mut scene, &plan, &INTERRUPTED))?;
            progress.clear();
        }
    }
    if let Some(error) = &goal.error {
        error.check(&scene, &plan)?;
    }
    let (outcome, picture) = if scene.camera.is_none() && is_together(&scene, &plan) {
        let job = long::Job { scene: &scene, plan, goal, state: &state, part_of: None, quiet: args.quiet };
        (pool.install(|| job.traced(saved.as_ref()))?, None)
    } else {
        if args.resume {
            let why = long::why_no_state(&scene);
            say(&format!("caustix: {why}, so it keeps no state: this one starts with its first photon"));
        }
        traced(args, &scene, &plan, &pool)?
    };
    let told = Told {
        folder: &folder,
        output: &args.output,
        inputs,
        save_map: args.save_map.as_deref(),
        started,
        diagnose: args.diagnose,
        quiet: args.quiet,
        strict: args.strict,
    };
    pool.install(|| written::write(&told, &scene, &outcome, picture.as_ref()))
}

/// Every file that a run is to write.
fn outputs(args: &RenderArgs, scene: &Scene) -> Vec<PathBuf> {
    files_of(scene, &args.output, args.map.is_none()).chain(args.save_map.clone()).collect()
}

/// Every file that the results of a scene are; `traced`: with those of its receivers and far fields.
pub(super) fn files_of<'a>(
    scene: &'a Scene,
    output: &'a Path,
    traced: bool,
) -> impl Iterator<Item = PathBuf> + 'a {
    let of_receiver = |receiver: &'a Receiver| {
        let endings = endings(receiver).into_iter();
        endings.map(|ending| format!("{}.{ending}", receiver.name))
    };
    let of_receivers = scene.receivers.iter().filter(move |_| traced).flat_map(of_receiver);
    let of_fields = scene.far_fields.iter().filter(move |_| traced).flat_map(far_field::files);
    let of_camera = scene.camera.iter().flat_map(|spec| picture::files(spec));
    let names =
        of_receivers.chain(of_fields).chain(of_camera).chain([REPORT, LOCK, STATE].map(str::to_string));
    names.map(|name| output.join(name))
}

/// The camera's picture of saved photons, and nothing else.
fn seen_again(args: &RenderArgs, map: &Path, scene: &Scene, plan: &Plan, started: Instant) -> Done {
    let Some(spec) = &scene.camera else { return Ok(exit::DONE) };
    let mut inputs = results::inputs(args.scene.as_deref(), scene);
    inputs.push(map.to_path_buf());
    let folder = results::take(&args.output)?;
    check_outputs(&outputs(args, scene), &inputs)?;
    let picture = if scene.is_coloured() {
        AnyPicture::Rgb(of_saved(args, map, scene, plan)?)
    } else {
        AnyPicture::Grey(of_saved(args, map, scene, plan)?)
    };
    let unseen = picture.summary().pixels_unseen;
    let beside = beside_earlier(&folder, unseen > 0, |_| true)?;
    let folder = beside.as_ref().unwrap_or(&folder);
    let mut set = Set::new(folder, REPORT)?;
    let camera = picture::write(&mut set, scene, plan, spec, &picture);
    let said = seen_wrong(scene, picture.summary());
    let report = SavedReport::new(scene, plan, map, (camera, &said), started.elapsed().as_secs_f64());
    let written = set.finish(|files| vouching(&report, files));
    said.iter().for_each(say_found);
    results::tell(folder, &written, &inputs);
    if !args.quiet {
        let (name, map) = (&scene.identity.name, map.display());
        print(&format!("scene      {name}\nphotons    those saved in {map}; "));
        print("none were traced, so receivers and far fields have no files\n");
        print(&report.camera.text());
        print(&results::written_to(folder, &written));
    }
    if !written.errors.is_empty() {
        return Ok(exit::WRONG);
    }
    let seen = seen_wholly(unseen, &written.directory);
    Ok(strictly(args.strict, seen, said.iter().chain(&scene.found)))
}

/// The picture of photons from a file.
fn of_saved<const C: usize>(args: &RenderArgs, map: &Path, scene: &Scene, plan: &Plan) -> Result<Picture<C>> {
    let pool = thread_pool(args.threads)?;
    let progress = Progress::new(args.quiet, &format!("reading {}", map.display()), 0);
    let saved = picture::read(map, scene, plan)?;
    let watch = Watch { interrupt: &INTERRUPTED, photons: &|_| {}, camera: &|share| progress.picture(share) };
    let picture = pool.install(|| picture_of_saved(scene, plan, saved, watch));
    progress.clear();
    picture
}

fn traced(
    args: &RenderArgs,
    scene: &Scene,
    plan: &Plan,
    pool: &rayon::ThreadPool,
) -> Result<(Outcome, Option<AnyPicture>)> {
    let progress = Progress::new(args.quiet, "tracing", plan.photons());
    let photons = |photons| progress.inc(photons);
    let outcome = pool.install(|| {
        if scene.camera.is_none() {
            return Ok((trace(scene, plan, &INTERRUPTED, &photons)?, None));
        }
        let watch =
            Watch { interrupt: &INTERRUPTED, photons: &photons, camera: &|share| progress.picture(share) };
        let (outcome, picture) = trace_picture(scene, plan, args.save_map.is_some(), watch)?;
        Ok((outcome, Some(picture)))
    });
    progress.clear();
    outcome
}

/// The threads that are asked for, all cores where none are.
pub(super) fn thread_pool(threads: Option<u32>) -> Result<rayon::ThreadPool> {
    if let Some(threads) = threads.filter(|t| !(1..=MAX_THREADS).contains(t)) {
        let found = format!("--threads {threads}");
        return Err(Diagnostic::new(Kind::Range, found, format!("1 to {MAX_THREADS} threads")));
    }
    let threads = threads.unwrap_or(0);
    rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build().map_err(|e| {
        Diagnostic::new(Kind::Limit, format!("{threads} threads: {e}"), "threads that can be started")
    })
}
