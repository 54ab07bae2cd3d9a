//! sweep.md: what was swept and how, a table a figure, and how much smaller the errors of differences are.

use crate::lab::sweep::difference::Difference;
use crate::lab::sweep::results::Sweep;
use crate::report::numbers::{grouped, names, piped, printable, three_digits, with_error};

use super::unit;

/// Most rows of a table: beyond them sweep.csv is for programs.
const MOST_ROWS: usize = 400;

const WHY: &str = "The cells are too noisy for an extreme, or nothing arrives; `caustix render` says how many photons would do.";

const DIFFERENCES: &str = "
Differences are to the point one step less along the key, other keys being the same. Both scenes were traced by the same points of
the sequence (seed, replicates, photons), so what they have in common cancels, noise included; the error is that of the replicates'
differences. The ratio is the error that two independent runs would give to their difference, sqrt(a^2 + b^2), over this one; each
of R replicates' errors is itself known to one part in sqrt(2 (R - 1)), 27 % for eight. Extremes (`min`, `max`, `u0`) and evaluation
grids have no paired error. All digits are in sweep.csv.
";

/// The sweep as a Markdown document.
pub fn markdown(sweep: &Sweep) -> String {
    let mut out = opening(sweep);
    let (known, unknown): (Vec<usize>, Vec<usize>) =
        (0..sweep.shown.len()).partition(|shown| sweep.is_known(*shown));
    known.into_iter().for_each(|shown| out += &figure(sweep, shown));
    if !unknown.is_empty() {
        let told = names(unknown.into_iter().map(|shown| printable(&sweep.shown[shown])), usize::MAX);
        out += &format!("\nNot given at any point: {told}. {WHY}\n");
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
    let is_paired = |axis: usize| sweep.ratios(shown, axis).is_some();
    for axis in &stepped {
        let along = if axes.len() > 1 { format!(" along {}", code(&axes[*axis].key)) } else { String::new() };
        head.push(format!("difference{along}"));
        head.extend(is_paired(*axis).then(|| "ratio".to_owned()));
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
            let [difference, ratio] = of_difference(sweep.difference(point, shown, *axis), unit(name));
            cells.push(difference);
            cells.extend(is_paired(*axis).then_some(ratio));
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
        out += &format!("\n`-`: {WHY}\n");
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
