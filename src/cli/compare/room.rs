//! Sequences side by side in a scene with `[compare]`, photons reflected a fixed number of times.

use std::sync::atomic::Ordering;

use indicatif::ProgressBar;

use crate::cli::progress::{INTERRUPTED, catch_interrupts, processor_time, progress_bar};
use crate::cli::render::{make_directory, thread_pool};
use crate::cli::{Done, exit, print, say};
use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_each;
use crate::files::parts::Parts;
use crate::lab::room::measure::measure;
use crate::lab::room::{Measurement, Options, RoomStudy, Task};
use crate::report::room::{csv, deviations_csv, markdown, text};
use crate::scene::Scene;

use super::parts::{command_line, found_json, scene_key, store_json};
use super::{CompareArgs, seeds};

/// Runs the study; the exit code.
pub fn run(args: &CompareArgs, scene: &Scene) -> Done {
    refuse_what_has_no_meaning(args)?;
    let options = Options::new(Options::paper_ladder(args.full), seeds(args)?)?;
    make_directory(&args.output)?;
    catch_interrupts();
    let pool = thread_pool(args.threads)?;
    let progress = progress_bar(args.quiet, options.photons());
    let parts = Parts::new(args.output.join("parts"));
    let mut measurements = Vec::new();
    for task in options.tasks() {
        progress.set_message(task.to_string());
        match pool.install(|| measurement(scene, &task, &parts, &progress)) {
            Ok(measurement) => measurements.push(measurement),
            Err(e) if e.kind() == Kind::Interrupted => break,
            Err(e) => return Err(e.into()),
        }
    }
    progress.finish_and_clear();
    if INTERRUPTED.load(Ordering::Relaxed) {
        say(&format!(
            "caustix: interrupted; {} of {} measurements are done. The same command goes on from the parts in {}",
            measurements.len(),
            options.tasks().len(),
            parts.directory().display()
        ));
        return Ok(exit::INTERRUPTED);
    }
    let study = RoomStudy::new(scene, &options, &measurements)?;
    let (_, errors) = write_each(
        &args.output,
        &[
            ("compare.csv", csv(&study)),
            ("compare.md", markdown(&study, &command_line())),
            ("deviations.csv", deviations_csv(&study)),
        ],
    );
    if !args.quiet {
        print(&text(&study));
        print(&format!("written to {}\n", args.output.display()));
    }
    if errors.is_empty() { Ok(exit::DONE) } else { Err(errors.into()) }
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

fn measurement(scene: &Scene, task: &Task, parts: &Parts, progress: &ProgressBar) -> Result<Measurement> {
    let key = format!("{}\nroom: {task}", scene_key(scene));
    if let Some(kept) = found_json(parts, progress, "room", &key) {
        progress.inc(task.photons);
        return Ok(kept);
    }
    let measured = measure(scene, task, processor_time, &INTERRUPTED, &|n| progress.inc(n))?;
    store_json(parts, "room", &key, &measured)?;
    Ok(measured)
}
