//! `caustix render`: trace a scene, write its maps, say what was found.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::warning::{Severity, Warning};
use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::{make_directory, write_bytes};
use crate::files::scene_toml::{self, RunDefaults};
use crate::picture::{AnyPicture, Picture, Watch, picture_of_saved, trace_picture, warnings as seen_wrong};
use crate::plot;
use crate::report::camera::CameraReport;
use crate::report::json::{Report, json};
use crate::report::numbers::grouped;
use crate::report::ply::write_ply;
use crate::report::saved::SavedReport;
use crate::report::statistics::ReceiverStatistics;
use crate::report::{maps, text};
use crate::run::{Outcome, Plan, Settings, StoppedBy, trace};
use crate::scene::Scene;
use crate::scene::receiver::Receiver;

use super::args::MAX_THREADS;
use super::progress::{INTERRUPTED, catch_interrupts, progress_bar};
use super::{Done, RenderArgs, algorithm, count, exit, picture, print, say, warn};

/// What the directory of a run is for.
pub(super) const FOR_RESULTS: &str = "a directory for the results";

/// Reads and builds a scene; without a path the built-in one.
pub(super) fn load(path: Option<&Path>) -> std::result::Result<(Scene, RunDefaults), Vec<Diagnostic>> {
    let file = match path {
        Some(path) => scene_toml::read(path)?,
        None => scene_toml::built_in()?,
    };
    let run = file.run;
    Ok((file.build()?, run))
}

/// Runs the subcommand; the exit code.
pub(super) fn run(args: &RenderArgs) -> Done {
    let started = Instant::now();
    let (scene, run) = load(args.scene.as_deref())?;
    warn(&scene.warnings);
    scene.found.iter().for_each(say_found);
    picture::check(args, &scene)?;
    let asked = count("--photons", args.photons.as_ref())?.or(run.photons);
    let plan = plan(args, &run, asked)?;
    if let Some(map) = &args.map {
        catch_interrupts();
        return seen_again(args, map, &scene, &plan, started);
    }
    // Before tracing, not after: a directory that cannot be made should cost nobody an hour.
    make_directory(&args.output, FOR_RESULTS)?;
    say_rounding(asked, &plan);
    catch_interrupts();
    let (outcome, picture) = traced(args, &scene, &plan)?;
    let unseen = picture.as_ref().map_or(0, |picture| picture.summary().pixels_unseen);
    let interrupted = outcome.stopped_by == StoppedBy::Interrupt;
    let directory = beside_earlier(&args.output, interrupted || unseen > 0, |photons| {
        photons > outcome.photons || (unseen > 0 && photons == outcome.photons)
    })?;
    let receivers = scene.receivers.iter().enumerate();
    let statistics: Vec<_> = receivers.map(|(i, r)| ReceiverStatistics::new(&outcome, r, i)).collect();
    // A file that cannot be written must not cost the others: its error is told at the end.
    let (mut files, mut unwritten) = (Vec::new(), Vec::new());
    for (receiver, s) in scene.receivers.iter().zip(&statistics) {
        let written = write_receiver(&directory, &scene, &outcome, receiver, s);
        files.push(written.map_err(|e| unwritten.push(e)).unwrap_or_default());
    }
    let mut camera = None;
    if let (Some(spec), Some(picture)) = (&scene.camera, &picture) {
        let written = picture::write(&directory, &scene, &plan, spec, picture);
        camera = written.map_err(|e| unwritten.push(e)).ok();
        // Of a whole run: part of one would not be what the settings say.
        match &args.save_map {
            Some(path) if outcome.stopped_by == StoppedBy::Photons => {
                unwritten.extend(picture::save(path, picture).err());
            }
            Some(_) => say("caustix: interrupted, so the photons are not saved"),
            None => {}
        }
    }
    let total_s = started.elapsed().as_secs_f64();
    let mut report = Report::new(&scene, &outcome, &statistics, &files, total_s);
    report.see(camera, picture.as_ref().map_or(Vec::new(), |picture| seen_wrong(&scene, picture.summary())));
    unwritten.extend(write_report(&directory, &report).err());
    if !args.quiet {
        print(&text::summary(&scene, &outcome, &statistics, &files, total_s));
        print(&report.camera.as_ref().map_or(String::new(), CameraReport::text));
        print(&format!("written to {}\n", directory.display()));
    }
    // What was known before is said before.
    let said = |warning: &&Warning| warning.code == "scene" || scene.found.contains(warning);
    report.warnings.iter().filter(|warning| !said(warning)).for_each(say_found);
    if !unwritten.is_empty() {
        return Err(unwritten);
    }
    if interrupted {
        say(&format!(
            "caustix: interrupted after {} of {} photons; what there is was written to {}",
            grouped(outcome.photons),
            grouped(plan.photons()),
            directory.display()
        ));
        return Ok(exit::INTERRUPTED);
    }
    let seen = seen_wholly(unseen, &directory);
    Ok(strictly(args.strict, seen, &report.warnings))
}

pub(super) fn say_found(warning: &Warning) {
    say(&format!("warning: {warning}"));
}

/// The exit code, or with --strict that of a number which is wrong.
pub(super) fn strictly<'a>(is_strict: bool, done: u8, said: impl IntoIterator<Item = &'a Warning>) -> u8 {
    let is_untrusted = said.into_iter().any(|warning| warning.severity == Severity::Untrusted);
    if done == exit::DONE && is_strict && is_untrusted { exit::UNTRUSTED } else { done }
}

/// Writes the files of one receiver; their names. Files written before one that cannot be stay.
fn write_receiver(
    directory: &Path,
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
    s: &ReceiverStatistics,
) -> Result<Vec<String>> {
    let names = ["exr", "png", "csv", "ply"].map(|ending| format!("{}.{ending}", receiver.name));
    let [exr, png, csv, ply] = names.each_ref().map(|name| directory.join(name));
    maps::write_exr(&exr, scene, outcome, receiver, s)?;
    let written = [
        true,
        plot::maps::write_png(&png, outcome, receiver, s)?,
        maps::write_csv(&csv, scene, receiver, s)?,
        write_ply(&ply, scene, outcome, receiver, s)?,
    ];
    Ok(names.into_iter().zip(written).filter_map(|(name, written)| written.then_some(name)).collect())
}

/// The exit code of a picture of which an interrupt left so many pixels unseen.
fn seen_wholly(unseen: u64, directory: &Path) -> u8 {
    if unseen == 0 {
        return exit::DONE;
    }
    say(&format!(
        "caustix: interrupted with {} pixels of the picture to go, which are black; it was written to {}",
        grouped(unseen),
        directory.display()
    ));
    exit::INTERRUPTED
}

/// The command line where it speaks, else the scene's [run], else the defaults.
fn plan(args: &RenderArgs, run: &RunDefaults, photons: Option<u64>) -> Result<Plan> {
    let mut settings = Settings { photons, ..Settings::default() };
    settings.algorithm = algorithm(settings.algorithm, args.variant.as_ref(), args.sequence.as_ref())?;
    settings.seed = args.seed.or(run.seed).unwrap_or(settings.seed);
    // A scene's replicates yield to a sequence that can have only one; the command line's do not.
    let of_scene = run.replicates.filter(|_| settings.algorithm.sequence.is_randomised());
    settings.replicates = args.replicates.or(of_scene);
    Plan::new(&settings)
}

fn say_rounding(asked: Option<u64>, plan: &Plan) {
    if let Some(asked) = asked.filter(|n| *n != plan.photons()) {
        let (traced, asked, replicates) = (grouped(plan.photons()), grouped(asked), plan.replicates());
        say(&format!("caustix: {traced} photons instead of {asked}: {replicates} replicates of equal size"));
    }
}

/// The camera's picture of saved photons, and nothing else.
fn seen_again(args: &RenderArgs, map: &Path, scene: &Scene, plan: &Plan, started: Instant) -> Done {
    let Some(spec) = &scene.camera else { return Ok(exit::DONE) };
    let picture = if scene.is_coloured() {
        AnyPicture::Rgb(of_saved(args, map, scene, plan)?)
    } else {
        AnyPicture::Grey(of_saved(args, map, scene, plan)?)
    };
    let unseen = picture.summary().pixels_unseen;
    let directory = beside_earlier(&args.output, unseen > 0, |_| true)?;
    let camera = picture::write(&directory, scene, plan, spec, &picture)?;
    let said = seen_wrong(scene, picture.summary());
    let report = SavedReport::new(scene, plan, map, (camera, &said), started.elapsed().as_secs_f64());
    write_report(&directory, &report)?;
    said.iter().for_each(say_found);
    if !args.quiet {
        let (name, map) = (&scene.identity.name, map.display());
        print(&format!("scene      {name}\nphotons    those saved in {map}; "));
        print("none were traced, so receivers have no maps\n");
        print(&report.camera.text());
        print(&format!("written to {}\n", directory.display()));
    }
    let seen = seen_wholly(unseen, &directory);
    Ok(strictly(args.strict, seen, said.iter().chain(&scene.found)))
}

/// The picture of photons from a file.
fn of_saved<const C: usize>(args: &RenderArgs, map: &Path, scene: &Scene, plan: &Plan) -> Result<Picture<C>> {
    let pool = thread_pool(args.threads)?;
    // A map that is refused leaves no directory behind.
    let saved = picture::read(map, scene, plan)?;
    make_directory(&args.output, FOR_RESULTS)?;
    let watch = Watch { interrupt: &INTERRUPTED, photons: &|_| {}, camera: &|_| {} };
    pool.install(|| picture_of_saved(scene, plan, saved, watch))
}

fn traced(args: &RenderArgs, scene: &Scene, plan: &Plan) -> Result<(Outcome, Option<AnyPicture>)> {
    let pool = thread_pool(args.threads)?;
    let progress = progress_bar(args.quiet, plan.photons());
    progress.set_message("tracing");
    // The camera may have been at work before: photons are traced pass by pass.
    let photons = |photons| {
        progress.set_message("tracing");
        progress.inc(photons);
    };
    let outcome = pool.install(|| {
        if scene.camera.is_none() {
            return Ok((trace(scene, plan, &INTERRUPTED, &photons)?, None));
        }
        let watch =
            Watch { interrupt: &INTERRUPTED, photons: &photons, camera: &|_| progress.set_message("camera") };
        let (outcome, picture) = trace_picture(scene, plan, args.save_map.is_some(), watch)?;
        Ok((outcome, Some(picture)))
    });
    progress.finish_and_clear();
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

/// The directory that was asked for, but for interrupted results that would replace those of `more` photons there: they go
/// into `interrupted/` beside them.
fn beside_earlier(output: &Path, interrupted: bool, more: impl Fn(u64) -> bool) -> Result<PathBuf> {
    let earlier = || {
        let text = std::fs::read_to_string(output.join("report.json")).ok()?;
        serde_json::from_str::<serde_json::Value>(&text).ok()?.get("photons")?.as_u64()
    };
    if !interrupted || !earlier().is_some_and(more) {
        return Ok(output.to_path_buf());
    }
    let beside = output.join("interrupted");
    make_directory(&beside, FOR_RESULTS)?;
    Ok(beside)
}

fn write_report(directory: &Path, report: &impl serde::Serialize) -> Result<()> {
    let path = directory.join("report.json");
    let text = json(report).map_err(|e| e.in_file(&path))?;
    write_bytes(&path, text.as_bytes())
}
