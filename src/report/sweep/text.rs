//! The sweep for a terminal: what each figure ranges over, and how much smaller the errors of its differences are.

use std::fmt::Write;

use crate::lab::sweep::results::Sweep;
use crate::report::numbers::{digits, grouped, printable, three_digits, written};

use super::unit;

/// What was found, a line a figure and key.
pub fn text(sweep: &Sweep) -> String {
    written(|out| {
        writeln!(out, "scene      {}", printable(&sweep.scene_name))?;
        let (points, finished) = (sweep.grid.points(), sweep.finished());
        let all = if finished < points { format!(" of {}", grouped(points as u64)) } else { String::new() };
        writeln!(out, "points     {}{all}", grouped(finished as u64))?;
        for axis in sweep.grid.axes() {
            let ends = match axis.values.as_slice() {
                [one] => one.shown.clone(),
                [first, .., last] => {
                    format!("{} values from {} to {}", axis.values.len(), first.shown, last.shown)
                }
                [] => String::new(),
            };
            writeln!(out, "           {}: {}", printable(&axis.key), printable(&ends))?;
        }
        writeln!(out, "tracing    {}", sweep.tracing)?;
        sweep.notes.iter().try_for_each(|note| writeln!(out, "note       {}", printable(note)))?;
        let width = sweep.shown.iter().map(|name| name.chars().count()).max().unwrap_or(0).max(6);
        writeln!(
            out,
            "\n{:<width$}  {:>12} {:>12}     error of a difference, independent / paired",
            "figure", "least", "greatest"
        )?;
        for (shown, name) in sweep.shown.iter().enumerate() {
            let [least, most] = ends(sweep, shown).map(|end| end.map_or("-".to_owned(), digits));
            let ratio = |axis| {
                let ratios = sweep.ratios(shown, axis)?;
                let [low, middle, high] = [ratios.least, ratios.median, ratios.most].map(three_digits);
                let along = printable(&sweep.grid.axes()[axis].key);
                Some(format!("{middle} ({low} to {high}) along {along}"))
            };
            let ratios: Vec<String> = sweep.stepped_axes().into_iter().filter_map(ratio).collect();
            let ratios = if ratios.is_empty() { "-".to_owned() } else { ratios.join("; ") };
            writeln!(out, "{:<width$}  {least:>12} {most:>12} {:<2}  {ratios}", printable(name), unit(name))?;
        }
        Ok(())
    })
}

/// The least and the greatest value of a figure.
fn ends(sweep: &Sweep, shown: usize) -> [Option<f64>; 2] {
    let values = || (0..sweep.points.len()).filter_map(|point| sweep.figure(point, shown)?.value);
    [values().min_by(f64::total_cmp), values().max_by(f64::total_cmp)]
}
