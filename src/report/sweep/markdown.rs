//! sweep.md: what was swept and how, a table a figure, and how much smaller the errors of differences are.

use crate::lab::sweep::difference::Difference;
use crate::lab::sweep::results::Sweep;
use crate::report::numbers::{grouped, names, piped, printable, three_digits, with_error};

use super::unit;

/// Most rows of a table: beyond them sweep.csv is for programs.
const MOST_ROWS: usize = 400;

const DIFFERENCES: &str = "\nDifferences are to the point one step less along the key, other keys being the same. Both scenes were traced by \
                           the same points (seed, replicates, photons), so what they have in common cancels, noise included; the error is \
                           that of the replicates' differences. The ratio is the error that two independent runs would give to their \
                           difference, sqrt(a^2 + b^2), over this one. Extremes (`min`, `max`, `u0`) have no paired error. All digits are in \
                           sweep.csv.\n";

/// The sweep as a Markdown document.
pub fn markdown(sweep: &Sweep) -> String {
    let mut out = opening(sweep);
    for shown in 0..sweep.shown.len() {
        out += &figure(sweep, shown);
    }
    if !sweep.stepped_axes().is_empty() {
        out += &ratios(sweep);
        out += DIFFERENCES;
    }
    let warnings = sweep.warnings();
    if !warnings.is_empty() {
        out += "\n## Warnings\n\n";
    }
    for (point, text, count) in warnings {
        let more = match count {
            1 => String::new(),
            _ => format!(" (one of {count} points)"),
        };
        out += &format!("- At `{}`{more}: {}\n", printable(&sweep.grid.told(point)), printable(text));
    }
    out
}

fn opening(sweep: &Sweep) -> String {
    let scene = printable(&sweep.scene_name);
    let (points, finished) = (sweep.grid.points(), sweep.finished());
    let of_all =
        if finished < points { format!("{finished} of {points}, interrupted") } else { points.to_string() };
    let mut out = format!(
        "# Sweep of {scene}\n\n    {}\n\n- Scene: {scene}, SHA-256 `{}`; caustix {}\n- Points: {of_all}\n",
        printable(&sweep.command),
        sweep.scene_sha256,
        env!("CARGO_PKG_VERSION"),
    );
    for axis in sweep.grid.axes() {
        let values = names(axis.values.iter().map(|value| &value.shown), 12);
        out += &format!("- `{}`: {}\n", printable(&axis.key), printable(&values));
    }
    out += &format!("- Tracing: {}\n", sweep.tracing);
    for note in &sweep.notes {
        out += &format!("- {}\n", printable(note));
    }
    out
}

/// The table of one figure.
fn figure(sweep: &Sweep, shown: usize) -> String {
    let name = &sweep.shown[shown];
    let (axes, stepped) = (sweep.grid.axes(), sweep.stepped_axes());
    let mut head: Vec<String> = axes.iter().map(|axis| code(&axis.key)).collect();
    head.push(printable(name));
    for axis in &stepped {
        let along = if axes.len() > 1 { format!(" along {}", code(&axes[*axis].key)) } else { String::new() };
        head.extend([format!("difference{along}"), "ratio".to_owned()]);
    }
    let mut out = format!("\n## {}\n\n", printable(name));
    out += &piped(&head);
    out += &format!("|{}\n", "---|".repeat(head.len()));
    let finished: Vec<usize> = (0..sweep.points.len()).filter(|p| sweep.points[*p].is_some()).collect();
    for &point in finished.iter().take(MOST_ROWS) {
        let mut cells: Vec<String> = sweep.grid.values(point).map(|(_, v)| printable(&v.shown)).collect();
        let figure = sweep.figure(point, shown);
        cells.push(
            figure.and_then(|f| f.value).map_or("-".to_owned(), |value| {
                told(value, figure.and_then(|f| f.standard_error), unit(name))
            }),
        );
        for axis in &stepped {
            cells.extend(of_difference(sweep.difference(point, shown, *axis), unit(name)));
        }
        out += &piped(&cells);
    }
    if finished.len() > MOST_ROWS {
        out += &format!(
            "\nThe first {MOST_ROWS} of {} points; all are in sweep.csv.\n",
            grouped(finished.len() as u64)
        );
    }
    if finished.iter().any(|point| sweep.figure(*point, shown).is_none_or(|f| f.value.is_none())) {
        out += "\nA figure is not given where its cells are too noisy for it, or nothing arrives; `caustix render` says why.\n";
    }
    out
}

fn of_difference(difference: Option<Difference>, unit: &str) -> [String; 2] {
    let Some(difference) = difference else { return ["", ""].map(str::to_owned) };
    let ratio = difference.ratio().map_or("-".to_owned(), three_digits);
    [told(difference.value, difference.standard_error, unit), ratio]
}

/// How much smaller the errors of differences are.
fn ratios(sweep: &Sweep) -> String {
    let mut out = "\n## Independent over paired error of a difference\n\n".to_owned();
    out += &piped(["figure", "along", "differences", "least", "median", "greatest"]);
    out += &format!("|{}\n", "---|".repeat(6));
    for (shown, name) in sweep.shown.iter().enumerate() {
        for axis in sweep.stepped_axes() {
            let Some(ratios) = sweep.ratios(shown, axis) else { continue };
            let key = code(&sweep.grid.axes()[axis].key);
            let [least, median, most] = [ratios.least, ratios.median, ratios.most].map(three_digits);
            out += &piped([printable(name), key, ratios.count.to_string(), least, median, most]);
        }
    }
    out
}

/// A number with its error.
fn told(value: f64, error: Option<f64>, unit: &str) -> String {
    with_error(value, error, unit).replace("  ", " ").trim_end().to_owned()
}

fn code(text: &str) -> String {
    format!("`{}`", printable(text))
}
