//! What a run found: its files in the folder of the results, and what is said of them.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::warning::{Severity, Warning};
use crate::error::{Diagnostic, Result};
use crate::files::bytes::read_capped;
use crate::files::folder::Folder;
use crate::files::outputs::entry;
use crate::files::set::Set;
use crate::picture::{AnyPicture, warnings as seen_wrong};
use crate::plot;
use crate::report::camera::CameraReport;
use crate::report::far_field::FarFieldStatistics;
use crate::report::json::Report;
use crate::report::numbers::{grouped, percent};
use crate::report::ply::write_ply;
use crate::report::spot::SpotStatistics;
use crate::report::statistics::ReceiverStatistics;
use crate::report::vouched::vouching;
use crate::report::vtp::write_vtp;
use crate::report::{maps, text};
use crate::run::{Outcome, StoppedBy};
use crate::scene::Scene;
use crate::scene::receiver::{Cells, Receiver};

use super::progress::Progress;
use super::{Done, exit, far_field, picture, print, results, say};

/// The list of a run's files.
pub const REPORT: &str = "report.json";
/// Largest one of an earlier run that is looked at.
const MOST_REPORT_BYTES: u64 = 1 << 30;

/// Where and how a run is told.
pub struct Told<'a> {
    /// The folder of its results.
    pub folder: &'a Folder,
    /// The same as it was typed.
    pub output: &'a Path,
    /// Files that the scene was read from.
    pub inputs: Vec<PathBuf>,
    /// Where its photons are saved.
    pub save_map: Option<&'a Path>,
    /// When the command began.
    pub started: Instant,
    /// What replicates and doublings say is told, too.
    pub diagnose: bool,
    /// No summary.
    pub quiet: bool,
    /// Exit with another code where a number is wrong.
    pub strict: bool,
}

/// Writes the results of a run, and says what was found; the exit code.
///
/// # Errors
/// A folder that cannot be written to.
pub fn write(told: &Told<'_>, scene: &Scene, outcome: &Outcome, picture: Option<&AnyPicture>) -> Done {
    let plan = &outcome.plan;
    let unseen = picture.map_or(0, |picture| picture.summary().pixels_unseen);
    let interrupted = outcome.stopped_by == StoppedBy::Interrupt;
    let beside = beside_earlier(told.folder, interrupted || unseen > 0, |photons| {
        photons > outcome.photons || (unseen > 0 && photons == outcome.photons)
    })?;
    let folder = beside.as_ref().unwrap_or(told.folder);
    let receivers = scene.receivers.iter().enumerate();
    let statistics: Vec<_> = receivers.map(|(i, r)| ReceiverStatistics::new(outcome, r, i)).collect();
    let mut set = Set::new(folder, REPORT)?;
    let progress = Progress::new(told.quiet, "writing", 0);
    let mut files = Vec::new();
    for (receiver, s) in scene.receivers.iter().zip(&statistics) {
        files.push(write_receiver(&mut set, scene, outcome, receiver, s));
    }
    let far_fields: Vec<_> =
        (0..scene.far_fields.len()).map(|i| FarFieldStatistics::new(scene, outcome, i)).collect();
    let fields = scene.far_fields.iter().zip(&far_fields);
    let (far_field_files, of_far_fields): (Vec<_>, Vec<_>) =
        fields.map(|(field, s)| far_field::write(&mut set, scene, outcome, field, s)).unzip();
    let mut camera = None;
    let mut unsaved = None;
    if let (Some(spec), Some(picture)) = (&scene.camera, picture) {
        camera = Some(picture::write(&mut set, scene, plan, spec, picture));
        // Of a whole run: part of one would not be what the settings say.
        match told.save_map {
            Some(path) if !interrupted => unsaved = save_map(&mut set, told.output, path, picture),
            Some(_) => progress.suspend(|| say("caustix: interrupted, so the photons are not saved")),
            None => {}
        }
    }
    let total_s = told.started.elapsed().as_secs_f64();
    let mut report = Report::new(scene, outcome, &statistics, &files, total_s);
    report.add_far_fields(scene, &far_fields, &far_field_files, of_far_fields.concat());
    report.see(camera, picture.map_or(Vec::new(), |picture| seen_wrong(scene, picture.summary())));
    let mut written = set.finish(|files| vouching(&report, files));
    progress.clear();
    written.errors.extend(unsaved);
    results::tell(folder, &written, &told.inputs);
    if !told.quiet {
        print(&text::summary(scene, outcome, &statistics, &files, total_s));
        report.far_fields.iter().zip(&scene.far_fields).for_each(|(of, field)| print(&of.text(field)));
        print(&report.camera.as_ref().map_or(String::new(), CameraReport::text));
    }
    if told.diagnose {
        print(&report.diagnosis_text());
    }
    if !told.quiet {
        print(&results::written_to(folder, &written));
    }
    // What was known before is said before.
    let said = |warning: &&Warning| warning.code == "scene" || scene.found.contains(warning);
    report.warnings.iter().filter(|warning| !said(warning)).for_each(say_found);
    let ended = say_end(outcome, &written.directory);
    if !written.errors.is_empty() {
        return Ok(exit::WRONG);
    }
    if ended != exit::DONE {
        return Ok(ended);
    }
    let seen = seen_wholly(unseen, &written.directory);
    Ok(strictly(told.strict, seen, &report.warnings))
}

/// Says where a run ended before it had what was asked for; the exit code.
fn say_end(outcome: &Outcome, directory: &Path) -> u8 {
    let shown = directory.display();
    if outcome.stopped_by == StoppedBy::Interrupt {
        say(&format!(
            "caustix: interrupted after {} of {} photons; what there is was written to {shown}",
            grouped(outcome.photons),
            grouped(outcome.plan.photons()),
        ));
        return exit::INTERRUPTED;
    }
    let Some(reached) = outcome.reached.filter(|reached| !reached.is_met()) else { return exit::DONE };
    let why =
        if outcome.stopped_by == StoppedBy::Time { "the time is over" } else { "all photons are traced" };
    let error = reached.error.map_or("of unknown size".into(), |error| format!("{} %", percent(error)));
    say(&format!(
        "caustix: {why}, and the error of {} is {error}, not the {} % that were asked for; what there is was written to {shown}, \
         and --resume with more photons or time goes on from there",
        reached.of.name(),
        percent(reached.asked),
    ));
    exit::UNMET
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

pub fn say_found(warning: &Warning) {
    say(&format!("warning: {warning}"));
}

/// The exit code, or with --strict that of a number which is wrong.
pub fn strictly<'a>(is_strict: bool, done: u8, said: impl IntoIterator<Item = &'a Warning>) -> u8 {
    let is_untrusted = said.into_iter().any(|warning| warning.severity == Severity::Untrusted);
    if done == exit::DONE && is_strict && is_untrusted { exit::UNTRUSTED } else { done }
}

/// What is written of a spot.
const SPOT_ENDINGS: [&str; 4] = ["encircled.csv", "encircled.svg", "sections.csv", "sections.svg"];

/// What is written of a receiver, by the endings of the files.
pub fn endings(receiver: &Receiver) -> Vec<&'static str> {
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
pub fn seen_wholly(unseen: u64, directory: &Path) -> u8 {
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

/// The folder `interrupted` beside results of `more` photons, which interrupted ones would replace; `None` where there are none.
pub fn beside_earlier(
    folder: &Folder,
    interrupted: bool,
    more: impl Fn(u64) -> bool,
) -> Result<Option<Folder>> {
    let earlier = || {
        let text = read_capped(&folder.path().join(REPORT), MOST_REPORT_BYTES).ok()?;
        serde_json::from_slice::<serde_json::Value>(&text).ok()?.get("photons")?.as_u64()
    };
    if !interrupted || !earlier().is_some_and(more) {
        return Ok(None);
    }
    results::take(&folder.path().join("interrupted")).map(Some)
}
