//! The printed summary of a run, for a lighting engineer.

use std::fmt::Write;

use crate::run::{Outcome, StoppedBy};
use crate::scene::Scene;

use super::numbers::{digits, grouped, rounded, with_error, written};
use super::statistics::{ReceiverStatistics, why_no_error};

/// The summary: what was run, every receiver, where the flux went, how good it is and how long it took.
pub fn summary(
    scene: &Scene,
    outcome: &Outcome,
    statistics: &[ReceiverStatistics],
    files: &[Vec<String>],
    total_s: f64,
) -> String {
    written(|out| {
        let plan = &outcome.plan;
        writeln!(out, "scene      {}", scene.identity.name)?;
        writeln!(
            out,
            "photons    {} = {} replicates x {}; {}, {}, seed {}",
            grouped(outcome.photons),
            outcome.replicates,
            grouped(outcome.photons / u64::from(outcome.replicates.max(1))),
            plan.algorithm().variant.name(),
            plan.algorithm().sequence.name(),
            plan.seed()
        )?;
        if outcome.stopped_by == StoppedBy::Interrupt {
            writeln!(
                out,
                "           stopped by an interrupt; {} photons were asked for",
                grouped(plan.photons())
            )?;
        }
        for ((receiver, s), files) in scene.receivers.iter().zip(statistics).zip(files) {
            write_receiver(out, &receiver.name, s, files)?;
        }
        write_ledger(out, scene, outcome)?;
        if let Some(why) = why_no_error(outcome) {
            writeln!(out, "\nno standard errors: {why}")?;
        }
        writeln!(
            out,
            "\ntime       {:.2} s tracing ({} photons/s), {:.2} s in all; {:.2} coordinates a photon, at most {}",
            outcome.trace_s,
            grouped((outcome.photons as f64 / outcome.trace_s.max(f64::MIN_POSITIVE)) as u64),
            total_s,
            outcome.census.dimension_mean(),
            outcome.census.dimension_max
        )?;
        let exceptions = &outcome.census.exceptions;
        if exceptions.corrected_directions + exceptions.skipped_crossings > 0 {
            writeln!(
                out,
                "exceptions {} directions kept on their side of a facet, {} repeated crossings skipped",
                grouped(exceptions.corrected_directions),
                grouped(exceptions.skipped_crossings)
            )?;
        }
        if exceptions.below_horizon > 0 {
            writeln!(
                out,
                "horizon    {} photons sent below it by scattering tables, absorbed there",
                grouped(exceptions.below_horizon)
            )?;
        }
        Ok(())
    })
}

fn write_receiver(
    out: &mut String,
    name: &str,
    s: &ReceiverStatistics,
    files: &[String],
) -> std::fmt::Result {
    writeln!(out, "\nreceiver \"{name}\": {} cells, {} m2", grouped(s.cells as u64), digits(s.area_m2))?;
    writeln!(out, "  flux         {}", with_error(s.flux_lm, s.flux_standard_error_lm, "lm"))?;
    let mean_error = s.flux_standard_error_lm.map(|e| e / s.area_m2);
    writeln!(out, "  illuminance  mean {}", with_error(s.mean_lx, mean_error, "lx"))?;
    writeln!(out, "               min {} lx, max {} lx", digits(s.min_lx), digits(s.max_lx))?;
    match s.uniformity_u0 {
        Some(u0) => writeln!(out, "  uniformity   U0 = min/mean = {u0:.3}")?,
        None => writeln!(out, "  uniformity   none: no light arrives")?,
    }
    if let Some(nrms) = s.expected_nrms {
        writeln!(
            out,
            "  error        a cell is off by {} % of the mean (root mean square)",
            rounded(100.0 * nrms, 3)
        )?;
    }
    if !files.is_empty() {
        writeln!(out, "  files        {}", files.join(", "))?;
    }
    Ok(())
}

fn write_ledger(out: &mut String, scene: &Scene, outcome: &Outcome) -> std::fmt::Result {
    let surfaces = scene.geometry.surfaces();
    let emitted = scene.emitters.flux_lm();
    let width = surfaces.iter().map(|s| s.name.chars().count() + 14).max().unwrap_or(0).max(22);
    writeln!(out, "\nwhere the light went")?;
    writeln!(out, "  {:<width$} {:>12} lm", "emitted", digits(emitted))?;
    let mut line = |label: String, e: crate::run::Estimate| {
        let share = 100.0 * e.value / emitted;
        let error = e.standard_error.map_or(String::new(), |se| format!(" +- {}", rounded(se, 2)));
        writeln!(out, "  {label:<width$} {:>12} lm{error}  ({share:.2} %)", digits(e.value))
    };
    for (i, surface) in surfaces.iter().enumerate() {
        if outcome.ledger.absorbed[i] > 0 {
            line(format!("absorbed by {}", surface.name), outcome.absorbed_lm(i))?;
        }
    }
    line("escaped".into(), outcome.escaped_lm())?;
    if outcome.ledger.killed > 0 {
        line("killed (endless walks)".into(), outcome.killed_lm())?;
    }
    writeln!(
        out,
        "  balance: {} photons emitted, {} ended",
        grouped(outcome.ledger.total_emitted()),
        grouped(outcome.ledger.total_ended())
    )
}
