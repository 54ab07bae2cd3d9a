//! `caustix render`: trace a scene, write its maps, say what was found.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::warning::{Severity, Warning};
use crate::error::{Diagnostic, Kind, Result};
use crate::files::bytes::read_capped;
use crate::files::folder::{Folder, LOCK};
use crate::files::outputs::{check_outputs, entry};
use crate::files::scene_toml::{self, RunDefaults};
use crate::files::set::Set;
use crate::picture::{AnyPicture, Picture, Watch, picture_of_saved, trace_picture, warnings as seen_wrong};
use crate::plot;
use crate::report::camera::CameraReport;
use crate::report::far_field::FarFieldStatistics;
use crate::report::json::Report;
use crate::report::numbers::grouped;
use crate::report::ply::write_ply;
use crate::report::saved::SavedReport;
use crate::report::spot::SpotStatistics;
use crate::report::statistics::ReceiverStatistics;
use crate::report::vouched::vouching;
use crate::report::vtp::write_vtp;
use crate::report::{maps, text};
use crate::run::{Outcome, Plan, Settings, StoppedBy, choose_cells, trace};
use crate::scene::Scene;
use crate::scene::receiver::{Cells, Receiver};

use super::args::MAX_THREADS;
use super::misuse::a_folder;
use super::progress::{INTERRUPTED, Progress, catch_interrupts};
use super::{Done, RenderArgs, algorithm, count, exit, far_field, picture, print, results, say, warn};

/// The list of a run's files.
const REPORT: &str = "report.json";
/// Largest one of an earlier run that is looked at.
const MOST_REPORT_BYTES: u64 = 1 << 30;

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
    let asked = count("--photons", args.photons.as_ref())?.or(run.photons);
    let plan = plan(args, &run, asked)?;
    catch_interrupts();
    if let Some(map) = &args.map {
        return seen_again(args, map, &scene, &plan, started);
    }
    // Before tracing, not after: a directory that cannot be made should cost nobody an hour.
    let folder = results::take(&args.output)?;
    let inputs = results::inputs(args.scene.as_deref(), &scene);
    check_outputs(&outputs(args, &scene), &inputs)?;
    say_rounding(asked, &plan);
    let pool = thread_pool(args.threads)?;
    let progress = Progress::new(args.quiet, "choosing cells", 0);
    pool.install(|| choose_cells(&mut scene, &plan, &INTERRUPTED))?;
    progress.clear();
    let (outcome, picture) = traced(args, &scene, &plan, &pool)?;
    let unseen = picture.as_ref().map_or(0, |picture| picture.summary().pixels_unseen);
    let interrupted = outcome.stopped_by == StoppedBy::Interrupt;
    let beside = beside_earlier(&folder, interrupted || unseen > 0, |photons| {
        photons > outcome.photons || (unseen > 0 && photons == outcome.photons)
    })?;
    let folder = beside.as_ref().unwrap_or(&folder);
    let receivers = scene.receivers.iter().enumerate();
    let statistics: Vec<_> = receivers.map(|(i, r)| ReceiverStatistics::new(&outcome, r, i)).collect();
    let mut set = Set::new(folder, REPORT)?;
    let progress = Progress::new(args.quiet, "writing", 0);
    let mut files = Vec::new();
    for (receiver, s) in scene.receivers.iter().zip(&statistics) {
        files.push(write_receiver(&mut set, &scene, &outcome, receiver, s));
    }
    let far_fields: Vec<_> = pool.install(|| {
        (0..scene.far_fields.len()).map(|i| FarFieldStatistics::new(&scene, &outcome, i)).collect()
    });
    let fields = scene.far_fields.iter().zip(&far_fields);
    let (far_field_files, of_far_fields): (Vec<_>, Vec<_>) =
        fields.map(|(field, s)| far_field::write(&mut set, &scene, &outcome, field, s)).unzip();
    let mut camera = None;
    let mut unsaved = None;
    if let (Some(spec), Some(picture)) = (&scene.camera, &picture) {
        camera = Some(picture::write(&mut set, &scene, &plan, spec, picture));
        // Of a whole run: part of one would not be what the settings say.
        match &args.save_map {
            Some(path) if !interrupted => unsaved = save_map(&mut set, &args.output, path, picture),
            Some(_) => progress.suspend(|| say("caustix: interrupted, so the photons are not saved")),
            None => {}
        }
    }
    let total_s = started.elapsed().as_secs_f64();
    let mut report = Report::new(&scene, &outcome, &statistics, &files, total_s);
    report.add_far_fields(&scene, &far_fields, &far_field_files, of_far_fields.concat());
    report.see(camera, picture.as_ref().map_or(Vec::new(), |picture| seen_wrong(&scene, picture.summary())));
    let mut written = set.finish(|files| vouching(&report, files));
    progress.clear();
    written.errors.extend(unsaved);
    results::tell(folder, &written, &inputs);
    if !args.quiet {
        print(&text::summary(&scene, &outcome, &statistics, &files, total_s));
        report.far_fields.iter().zip(&scene.far_fields).for_each(|(of, field)| print(&of.text(field)));
        print(&report.camera.as_ref().map_or(String::new(), CameraReport::text));
        print(&results::written_to(folder, &written));
    }
    // What was known before is said before.
    let said = |warning: &&Warning| warning.code == "scene" || scene.found.contains(warning);
    report.warnings.iter().filter(|warning| !said(warning)).for_each(say_found);
    let shown = written.directory.display();
    if interrupted {
        say(&format!(
            "caustix: interrupted after {} of {} photons; what there is was written to {shown}",
            grouped(outcome.photons),
            grouped(plan.photons()),
        ));
    }
    if !written.errors.is_empty() {
        return Ok(exit::WRONG);
    }
    if interrupted {
        return Ok(exit::INTERRUPTED);
    }
    let seen = seen_wholly(unseen, &written.directory);
    Ok(strictly(args.strict, seen, &report.warnings))
}

/// Every file that a run is to write.
fn outputs(args: &RenderArgs, scene: &Scene) -> Vec<PathBuf> {
    let of_receiver = |receiver: &Receiver| {
        let endings = endings(receiver).into_iter();
        endings.map(|ending| format!("{}.{ending}", receiver.name)).collect::<Vec<_>>()
    };
    let of_fields = scene.far_fields.iter().filter(|_| args.map.is_none()).flat_map(far_field::files);
    let of_camera = scene.camera.iter().flat_map(|spec| picture::files(spec));
    // A --map gives no maps of receivers.
    let of_receivers = scene.receivers.iter().filter(|_| args.map.is_none()).flat_map(of_receiver);
    let names = of_receivers.chain(of_fields).chain(of_camera).chain([REPORT.to_string(), LOCK.to_string()]);
    names.map(|name| args.output.join(name)).chain(args.save_map.clone()).collect()
}

/// Saves the photons: in the folder of the results as one of them, elsewhere by themselves; what went wrong there.
fn save_map(set: &mut Set<'_>, output: &Path, path: &Path, picture: &AnyPicture) -> Option<Diagnostic> {
    let name = path.file_name().and_then(|name| name.to_str());
    match name.filter(|name| entry(&output.join(name)) == entry(path)) {
        Some(name) => {
            set.add(name, |path| picture::save(path, picture).map(|()| true));
            None
        }
        None => picture::save(path, picture).err(),
    }
}

pub(super) fn say_found(warning: &Warning) {
    say(&format!("warning: {warning}"));
}

/// The exit code, or with --strict that of a number which is wrong.
pub(super) fn strictly<'a>(is_strict: bool, done: u8, said: impl IntoIterator<Item = &'a Warning>) -> u8 {
    let is_untrusted = said.into_iter().any(|warning| warning.severity == Severity::Untrusted);
    if done == exit::DONE && is_strict && is_untrusted { exit::UNTRUSTED } else { done }
}

/// What is written of a spot.
const SPOT_ENDINGS: [&str; 4] = ["encircled.csv", "encircled.svg", "sections.csv", "sections.svg"];

/// What is written of a receiver, by the endings of the files.
fn endings(receiver: &Receiver) -> Vec<&'static str> {
    let of_cells: &[_] = match receiver.cells {
        Cells::Grid { .. } if maps::has_csv(receiver) => &["exr", "png", "csv"],
        Cells::Grid { .. } => &["exr", "png"],
        Cells::Faces { .. } => &["exr", "csv", "ply", "vtp"],
    };
    let of_grid = receiver.grid.map(|_| "grid.csv");
    let of_spot = receiver.spot.iter().flat_map(|_| SPOT_ENDINGS);
    of_cells.iter().copied().chain(of_grid).chain(of_spot).collect()
}

/// Makes the files of one receiver; the names of those that could be.
fn write_receiver(
    set: &mut Set<'_>,
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
    s: &ReceiverStatistics,
) -> Vec<String> {
    let mut made = Vec::new();
    for ending in endings(receiver) {
        let name = format!("{}.{ending}", receiver.name);
        let is_made = set.add(&name, |path| match ending {
            "exr" => maps::write_exr(path, scene, outcome, receiver, s).map(|()| true),
            "png" => plot::maps::write_png(path, scene, outcome, receiver, s),
            "csv" => maps::write_csv(path, scene, receiver, s),
            "grid.csv" => maps::write_grid_csv(path, scene, receiver, s),
            ending if SPOT_ENDINGS.contains(&ending) => match &s.spot {
                Some(spot) => write_spot(path, ending, &receiver.name, spot),
                None => Ok(false),
            },
            "ply" => write_ply(path, scene, outcome, receiver, s),
            _ => write_vtp(path, scene, outcome, receiver, s),
        });
        made.extend(is_made.then_some(name));
    }
    made
}

/// A table or a drawing of a spot; false, and no file, where it has no figures.
fn write_spot(path: &Path, ending: &str, name: &str, spot: &SpotStatistics) -> Result<bool> {
    let Some(figures) = &spot.figures else { return Ok(false) };
    match ending {
        "encircled.csv" => figures.write_encircled_csv(path),
        "encircled.svg" => plot::spot::encircled(name, figures).write(path),
        "sections.csv" => figures.write_sections_csv(path),
        _ => plot::spot::sections(name, figures).write(path),
    }
    .map(|()| true)
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

/// The folder `interrupted` beside results of `more` photons, which interrupted ones would replace; `None` where there are none.
fn beside_earlier(folder: &Folder, interrupted: bool, more: impl Fn(u64) -> bool) -> Result<Option<Folder>> {
    let earlier = || {
        let text = read_capped(&folder.path().join(REPORT), MOST_REPORT_BYTES).ok()?;
        serde_json::from_slice::<serde_json::Value>(&text).ok()?.get("photons")?.as_u64()
    };
    if !interrupted || !earlier().is_some_and(more) {
        return Ok(None);
    }
    results::take(&folder.path().join("interrupted")).map(Some)
}
