//! The printed summary of a run, for a lighting engineer.

use std::fmt::Write;

use crate::run::{Outcome, StoppedBy};
use crate::scene::Scene;

use super::json::why_no_error;
use super::statistics::ReceiverStatistics;

/// The summary: what was run, every receiver, where the flux went, how good it is and how long it took.
pub fn summary(
    scene: &Scene,
    outcome: &Outcome,
    statistics: &[ReceiverStatistics],
    files: &[Vec<String>],
    total_s: f64,
) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _infallible = write_all(&mut out, scene, outcome, statistics, files, total_s);
    out
}

fn write_all(
    out: &mut String,
    scene: &Scene,
    outcome: &Outcome,
    statistics: &[ReceiverStatistics],
    files: &[Vec<String>],
    total_s: f64,
) -> std::fmt::Result {
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
        write_receiver(out, &receiver.name, receiver.cells.len(), s, files)?;
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
    let exceptions = outcome.census.exceptions;
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
}

fn write_receiver(
    out: &mut String,
    name: &str,
    cells: usize,
    s: &ReceiverStatistics,
    files: &[String],
) -> std::fmt::Result {
    writeln!(out, "\nreceiver \"{name}\": {} cells, {} m2", grouped(cells as u64), digits(s.area_m2))?;
    writeln!(out, "  flux         {}", with_error(s.flux_lm.value, s.flux_lm.standard_error, "lm"))?;
    let mean_error = s.flux_lm.standard_error.map(|e| e / s.area_m2);
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

/// A number with its error, rounded to two digits of the error.
pub fn with_error(value: f64, error: Option<f64>, unit: &str) -> String {
    match error {
        Some(e) if e > 0.0 && value != 0.0 => {
            let magnitude = libm::floor(libm::log10(value.abs().max(e)));
            if !(-5.0..9.0).contains(&magnitude) {
                // So many digits that two of the error show, both numbers in one power of ten.
                let power = libm::exp10(magnitude);
                let decimals = (1.0 + magnitude - libm::floor(libm::log10(e))).clamp(0.0, 12.0) as usize;
                let (v, s) = (value / power, e / power);
                let percent = rounded(100.0 * e / value.abs(), 2);
                return format!("({v:.decimals$} +- {s:.decimals$})e{magnitude} {unit} ({percent} %)");
            }
            // Decimals so that two digits of the error show.
            let decimals = (1.0 - libm::floor(libm::log10(e))).clamp(0.0, 12.0) as usize;
            format!("{value:.decimals$} +- {e:.decimals$} {unit} ({} %)", rounded(100.0 * e / value.abs(), 2))
        }
        Some(_) => format!("{} +- 0 {unit}", digits(value)),
        None => format!("{} {unit}", digits(value)),
    }
}

/// Five significant digits without exponents where a person would write none.
pub fn digits(value: f64) -> String {
    rounded(value, 5)
}

/// So many significant digits, without exponents where a person would write none.
pub fn rounded(value: f64, significant: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = libm::floor(libm::log10(value.abs()));
    if !(-5.0..9.0).contains(&magnitude) {
        return format!("{value:.*e}", significant.saturating_sub(1));
    }
    let decimals = (significant as f64 - 1.0 - magnitude).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// Digits in groups of three.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(' ');
        }
        out.push(c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(grouped(4_456_448), "4 456 448");
        assert_eq!(grouped(12), "12");
        assert_eq!(digits(0.0), "0");
        assert_eq!(digits(1234.5678), "1234.6");
        assert_eq!(digits(0.012_345_6), "0.012346");
        assert_eq!(digits(1e-9), "1.0000e-9");
        assert_eq!(digits(4.0), "4");
        assert_eq!(rounded(0.008_836_9, 2), "0.0088");
        assert_eq!(rounded(18.733, 3), "18.7");
        assert_eq!(with_error(123.456, Some(0.0123), "lm"), "123.456 +- 0.012 lm (0.01 %)");
        assert_eq!(with_error(5.0, None, "lx"), "5 lx");
        assert_eq!(with_error(1.479_27e-10, Some(3.52e-14), "lx"), "(1.47927 +- 0.00035)e-10 lx (0.024 %)");
        assert_eq!(with_error(2.530_35e14, Some(1.26e12), "lx"), "(2.530 +- 0.013)e14 lx (0.5 %)");
    }
}
