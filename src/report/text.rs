//! The printed summary of a run, for a lighting engineer.

use std::fmt::{Result, Write};

use crate::estimate::extremes::Interval;
use crate::run::pilot::{CELL_ERROR, is_at_bound};
use crate::run::{Estimate, Outcome, Reached, StoppedBy};
use crate::scene::Scene;

use super::numbers::{digits, grouped, percent, rounded, with_error, written};
use super::statistics::{GridStatistics, ReceiverStatistics};
use super::uniformity::Uniformity;
use super::unknown::why_no_error;

/// The summary: what was run, every receiver, where the flux went, how good it is and how long it took.
pub fn summary(
    scene: &Scene,
    outcome: &Outcome,
    statistics: &[ReceiverStatistics],
    files: &[Vec<String>],
    total_s: f64,
) -> String {
    written(|out| {
        let (plan, photons, replicates) = (&outcome.plan, outcome.photons, outcome.replicates);
        let each = grouped(photons / u64::from(replicates.max(1)));
        let (variant, sequence) = (plan.algorithm().variant.name(), plan.algorithm().sequence.name());
        writeln!(out, "scene      {}", scene.identity.name)?;
        let plural = if replicates == 1 { "" } else { "s" };
        writeln!(
            out,
            "photons    {} = {replicates} replicate{plural} x {each}; {variant}, {sequence}, seed {}",
            grouped(photons),
            plan.seed()
        )?;
        if outcome.stopped_by == StoppedBy::Interrupt {
            let asked = grouped(plan.photons());
            writeln!(out, "           stopped by an interrupt; {asked} photons were asked for")?;
        }
        write_end(out, outcome)?;
        for ((receiver, s), files) in scene.receivers.iter().zip(statistics).zip(files) {
            write_receiver(out, &receiver.name, s, files)?;
        }
        write_ledger(out, scene, outcome)?;
        if let Some(why) = why_no_error(outcome) {
            writeln!(out, "\nno standard errors: {why}")?;
        }
        let census = &outcome.census;
        let speed = grouped((photons as f64 / outcome.trace_s.max(f64::MIN_POSITIVE)) as u64);
        writeln!(
            out,
            "\ntime       {:.2} s tracing ({speed} photons/s), {total_s:.2} s in all; {:.2} coordinates a photon, at most {}",
            outcome.trace_s,
            census.dimension_mean(),
            census.dimension_max
        )?;
        let exceptions = &census.exceptions;
        let [corrected, skipped, below] =
            [exceptions.corrected(), exceptions.skipped_crossings, exceptions.below_horizon];
        if corrected + skipped > 0 {
            let (kept, repeated) = (grouped(corrected), grouped(skipped));
            writeln!(
                out,
                "exceptions {kept} directions kept on their side of a facet, {repeated} repeated crossings skipped"
            )?;
        }
        if below > 0 {
            let below = grouped(below);
            writeln!(out, "horizon    {below} photons sent below it by scattering tables, absorbed there")?;
        }
        Ok(())
    })
}

/// What ended a run that had something else to reach than its photons.
fn write_end(out: &mut String, outcome: &Outcome) -> Result {
    let why = match (outcome.stopped_by, &outcome.reached) {
        (StoppedBy::Error, _) => "the error is reached",
        (StoppedBy::Time, _) => "the time is over",
        (_, Some(_)) => "all photons are traced",
        (_, None) => return Ok(()),
    };
    let Some(Reached { of, asked, error }) = &outcome.reached else {
        return writeln!(out, "stopped    {why}");
    };
    let error = error.map_or("not known".into(), |error| format!("{} %", percent(error)));
    writeln!(
        out,
        "stopped    {why}: standard error of {} {error}, {} % asked for",
        of.name(),
        percent(*asked)
    )
}

fn write_receiver(out: &mut String, name: &str, s: &ReceiverStatistics, files: &[String]) -> Result {
    writeln!(out, "\nreceiver \"{name}\": {} cells, {} m2", grouped(s.cells as u64), digits(s.area_m2))?;
    if let Some([nu, nv]) = s.cells_by_pilot {
        let aim = match is_at_bound([nu, nv]) {
            Some(bound) => format!("as {bound} that it chooses"),
            None => format!("for an error of about {} %", rounded(100.0 * CELL_ERROR, 2)),
        };
        writeln!(
            out,
            "  cells        {nu} x {nv}, chosen by a pilot run {aim}; `cells = [{nu}, {nv}]` keeps them"
        )?;
    }
    writeln!(out, "  flux         {}", with_error(s.flux_lm, s.flux_standard_error_lm, "lm"))?;
    let mean_error = s.flux_standard_error_lm.map(|e| e / s.area_m2);
    writeln!(out, "  illuminance  mean {}", with_error(s.mean_lx, mean_error, "lx"))?;
    write_extremes(out, s)?;
    if let Some(spot) = &s.spot {
        out.push_str(&spot.text());
    }
    if let Some(nrms) = s.expected_nrms {
        let nrms = rounded(100.0 * nrms, 3);
        writeln!(out, "  error        a cell is off by {nrms} % of the mean (root mean square)")?;
    }
    if !files.is_empty() {
        writeln!(out, "  files        {}", files.join(", "))?;
    }
    Ok(())
}

/// Extremes as intervals, or why there are none.
fn write_uniformity(out: &mut String, of: &Uniformity) -> Result {
    let Uniformity { u0: Some(u0), ud: Some(ud), minimum: Some(minimum), maximum: Some(maximum), .. } = of
    else {
        let why = of.reason.as_deref().unwrap_or("no light arrives");
        return writeln!(out, "  uniformity   not known: {why}");
    };
    let lx = |i: &Interval| format!("{} lx ({} to {})", digits(i.value), digits(i.low), digits(i.high));
    let share = |i: &Interval| format!("{:.3} ({:.3} to {:.3})", i.value, i.low, i.high);
    writeln!(out, "               min {}, max {}", lx(minimum), lx(maximum))?;
    writeln!(out, "  uniformity   U0 = min/mean = {}, Ud = min/max = {}; 95 %", share(u0), share(ud))
}

/// Extremes of the cells and of the evaluation grid. Where they are not known the cells' are noise, and said to be.
fn write_extremes(out: &mut String, s: &ReceiverStatistics) -> Result {
    if s.uniformity.u0.is_none() {
        let [least, most] = [s.min_lx, s.max_lx].map(digits);
        writeln!(out, "               cells from {least} to {most} lx, noise included")?;
    }
    write_uniformity(out, &s.uniformity)?;
    if let Some(grid) = &s.grid {
        let mean = with_error(grid.mean_lx, grid.mean_standard_error_lx, "lx");
        let GridStatistics { nu, nv, border_m, .. } = grid;
        let border = if *border_m > 0.0 { format!(" without {border_m} m of border") } else { String::new() };
        writeln!(out, "  grid         {nu} x {nv} cells{border}, values are their means: mean {mean}")?;
        write_uniformity(out, &grid.uniformity)?;
    }
    Ok(())
}

fn write_ledger(out: &mut String, scene: &Scene, outcome: &Outcome) -> Result {
    let surfaces = scene.geometry.surfaces();
    let emitted = scene.emitters.flux_lm();
    let width = surfaces.iter().map(|s| s.name.chars().count() + 14).max().unwrap_or(0).max(22);
    writeln!(out, "\nwhere the light went")?;
    writeln!(out, "  {:<width$} {:>12} lm", "emitted", digits(emitted))?;
    let mut line = |label: String, e: Estimate| {
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
    if outcome.ledger.total_trapped() > 0 {
        line("trapped in clear bodies".into(), outcome.trapped_lm())?;
    }
    let [emitted, ended] = [outcome.ledger.total_emitted(), outcome.ledger.total_ended()].map(grouped);
    writeln!(out, "  balance: {emitted} photons emitted, {ended} ended")
}
