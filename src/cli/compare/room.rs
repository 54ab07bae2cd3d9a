//! Sequences side by side in a scene with `[compare]`, photons reflected a fixed number of times.

use std::sync::atomic::Ordering;

use crate::cli::kept::{Kept, command_line, scene_key};
use crate::cli::progress::{INTERRUPTED, processor_time};
use crate::cli::start::thread_pool;
use crate::cli::{Done, exit};
use crate::error::{Diagnostic, Kind, Result};
use crate::lab::room::measure::measure;
use crate::lab::room::{Measurement, Options, RoomStudy, Task};
use crate::report::room::{csv, deviations_csv, markdown, text};
use crate::scene::Scene;

use super::{CompareArgs, seeds};

/// What a study writes.
const FILES: [&str; 3] = ["compare.csv", "compare.md", "deviations.csv"];

/// Runs the study; the exit code.
pub fn run(args: &CompareArgs, scene: &Scene) -> Done {
    refuse_what_has_no_meaning(args)?;
    let options = Options::new(Options::paper_ladder(args.full), seeds(args)?)?;
    let kept = Kept::start(args.order(scene, &FILES), options.photons())?;
    let pool = thread_pool(args.threads)?;
    let mut measurements = Vec::new();
    for task in options.tasks() {
        kept.progress.phase(task.to_string());
        match pool.install(|| measurement(scene, &task, &kept)) {
            Ok(measurement) => measurements.extend(measurement),
            Err(e) if e.kind() == Kind::Interrupted => break,
            Err(e) => return Err(e.into()),
        }
    }
    kept.progress.clear();
    if INTERRUPTED.load(Ordering::Relaxed) {
        let (done, all) = (measurements.len(), options.tasks().len());
        return Ok(kept.interrupted(&format!("{done} of {all} measurements are done")));
    }
    let study = RoomStudy::new(scene, &options, &measurements)?;
    let [table, told, deviations] = FILES;
    let files = [
        (table, csv(&study)),
        (told, markdown(&study, &command_line())),
        (deviations, deviations_csv(&study)),
    ];
    let is_whole = kept.write(scene, &files, &text(&study))?;
    Ok(if is_whole { exit::DONE } else { exit::WRONG })
}

/// The numbers of photons and the sequences of this study are the paper's.
fn refuse_what_has_no_meaning(args: &CompareArgs) -> Result<()> {
    let given = [
        ("--photons", args.photons.is_some()),
        ("--variants", !args.variants.is_empty()),
        ("--reference-photons", args.reference_photons.is_some()),
        ("--cells", !args.cells.is_empty()),
        ("--from", args.from.is_some()),
    ];
    match given.iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((option, _)) => Err(Diagnostic::new(
            Kind::Range,
            format!("{option} with a scene that has [compare]"),
            "--full, --seeds or --seed: sequences and numbers of photons are fixed there",
        )),
    }
}

fn measurement(scene: &Scene, task: &Task, kept: &Kept) -> Result<Option<Measurement>> {
    let key = format!("{}\nroom: {task}", scene_key(scene));
    kept.part("room", &key, task.photons, |progress| {
        measure(scene, task, processor_time, &INTERRUPTED, progress).map(Some)
    })
}
