//! `caustix compare` on a scene with [compare]: sequences side by side, photons reflected a fixed number of times.

use std::sync::atomic::Ordering;

use crate::error::{Diagnostic, Kind};
use crate::files::parts::Parts;
use crate::lab::room::measure::{Measurement, Task, measure};
use crate::lab::room::{Options, RoomStudy};
use crate::report::room::{text, write_files};
use crate::scene::Scene;

use super::compare::{CompareArgs, command_line, found, scene_key, seeds};
use super::progress::{INTERRUPTED, Progress, catch_interrupts};
use super::render::{make_directory, thread_pool};
use super::{exit, print, say};

/// Runs the study; the exit code.
pub(super) fn compare(args: &CompareArgs, scene: &Scene) -> Result<u8, Vec<Diagnostic>> {
    let one = |e: Diagnostic| vec![e];
    refuse_what_has_no_meaning(args).map_err(one)?;
    let options = seeds(args).and_then(|seeds| Options::new(Options::paper_ladder(args.full), seeds));
    let options = options.map_err(one)?;
    make_directory(&args.output).map_err(one)?;
    catch_interrupts();
    let pool = thread_pool(args.threads).map_err(one)?;
    let progress = Progress::new(args.quiet, options.photons());
    let parts = Parts::new(args.output.join("parts"));
    let mut measurements = Vec::new();
    for task in options.tasks() {
        progress.say(task.to_string());
        match pool.install(|| measurement(scene, &task, &parts, &progress)) {
            Ok(measurement) => measurements.push(measurement),
            Err(e) if e.kind() == Kind::Interrupted => break,
            Err(e) => return Err(vec![e]),
        }
    }
    progress.finish();
    if INTERRUPTED.load(Ordering::Relaxed) {
        say(&format!(
            "caustix: interrupted; {} of {} measurements are done. The same command goes on from the parts in {}",
            measurements.len(),
            options.tasks().len(),
            parts.directory().display()
        ));
        return Ok(exit::INTERRUPTED);
    }
    let study = RoomStudy::new(scene, &options, &measurements).map_err(one)?;
    let (_, errors) = write_files(&study, &command_line(), &args.output);
    if !args.quiet {
        print(&text(&study));
        print(&format!("written to {}\n", args.output.display()));
    }
    if errors.is_empty() { Ok(exit::DONE) } else { Err(errors) }
}

/// The numbers of photons and the sequences of this study are the paper's.
fn refuse_what_has_no_meaning(args: &CompareArgs) -> Result<(), Diagnostic> {
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

fn measurement(
    scene: &Scene,
    task: &Task,
    parts: &Parts,
    progress: &Progress,
) -> Result<Measurement, Diagnostic> {
    let key = format!("{}\nroom: {task}", scene_key(scene));
    let kept = found(parts, progress, "room", &key);
    if let Some(kept) = kept.and_then(|bytes| serde_json::from_slice::<Measurement>(&bytes).ok()) {
        progress.add(task.photons);
        return Ok(kept);
    }
    let measured = measure(scene, task, &INTERRUPTED, &|n| progress.add(n))?;
    let bytes = serde_json::to_vec(&measured).map_err(|e| {
        Diagnostic::new(Kind::Io, format!("\"{e}\" while writing a measurement"), "a measurement as text")
    })?;
    parts.store("room", &key, &bytes)?;
    Ok(measured)
}
