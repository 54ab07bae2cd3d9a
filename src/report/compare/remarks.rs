//! What is said beside the numbers, alike on the terminal and in the file: the settings, warnings, footnotes.

use crate::lab::study::fit::Uncertainty;
use crate::lab::study::results::{BASELINE, ReferenceUsed, Study};
use crate::lab::study::table::{REFERENCE_MARGIN, Table};
use crate::report::numbers::{grouped, names, three_digits};

use super::numbers::Marks;

/// Below so many times the photons of the largest N, a reference is said to be small.
const LEAST_FACTOR: f64 = 100.0;

/// "48 x 48".
pub fn cells(grid: u32) -> String {
    format!("{grid} x {grid}")
}

/// What the errors are measured against.
pub fn reference(study: &Study) -> String {
    let ReferenceUsed { photons, replicates, sequence, emission_map, seed, factor, .. } = &study.reference;
    let (photons, factor) = (grouped(*photons), three_digits(*factor));
    format!(
        "{photons} photons, {factor} x the largest N, in {replicates} replicates; sequence {sequence}, {emission_map}, \
         seed {seed}"
    )
}

/// The reference's own nRMS on every grid.
pub fn own_errors(study: &Study) -> String {
    let on = |(g, grid): (usize, &u32)| {
        let own = study.reference.own_nrms.get(g).copied().filter(|own| own.is_finite());
        let own = own.map_or("unknown".to_owned(), |own| format!("{} %", three_digits(100.0 * own)));
        format!("{own} on {} cells", cells(*grid))
    };
    names(study.grids.iter().enumerate().map(on), usize::MAX)
}

/// The seeds, in words.
pub fn seeds(study: &Study) -> String {
    let seeds = names(study.seeds.iter().map(u64::to_string), usize::MAX);
    match study.seeds.len() {
        1 => format!("one seed ({seeds})"),
        several => format!("{several} seeds ({seeds})"),
    }
}

/// The N that tables are for: the one asked for, or the largest there is if an interrupted study lacks that.
pub fn shown_photons(study: &Study, table: &Table) -> Option<u64> {
    let ladder = table.ladder();
    if ladder.contains(&study.asked_photons) { Some(study.asked_photons) } else { ladder.last().copied() }
}

/// Everything to be warned of: first what the numbers say about themselves, then what the study was told.
pub fn warnings(study: &Study, table: &Table) -> Vec<String> {
    let (factor, ladder, asked) = (study.reference.factor, table.ladder(), study.asked_photons);
    let lacks_asked = !ladder.is_empty() && !ladder.contains(&asked);
    let of_study = [
        (factor < LEAST_FACTOR).then(|| {
            let factor = three_digits(factor);
            format!("the reference has {factor} x the photons of the largest N, less than {LEAST_FACTOR}")
        }),
        study.baseline().is_none().then(|| format!("without the variant {BASELINE} there are no ratios")),
        (ladder.len() == 1).then(|| {
            "one number of photons gives no rate, no ratio at equal time and no time to 1 %".to_owned()
        }),
        lacks_asked.then(|| {
            let asked = grouped(asked);
            format!("no run with the {asked} photons asked for is finished; tables show the largest N")
        }),
        (study.seeds.len() == 1).then(|| "one seed says nothing about the spread of an error".to_owned()),
    ];
    let of_study = of_study.into_iter().flatten();
    limits(study, table).into_iter().chain(of_study).chain(study.warnings.iter().cloned()).collect()
}

/// For every variant and grid, where the reference limits its error.
fn limits(study: &Study, table: &Table) -> Vec<String> {
    let mut warnings = Vec::new();
    for (v, variant) in study.variants.iter().enumerate() {
        for (g, grid) in study.grids.iter().enumerate() {
            let limited =
                table.rows.iter().filter(|r| (r.variant, r.grid) == (v, g) && r.limited_by_reference);
            let at = names(limited.map(|r| grouped(r.photons)), usize::MAX);
            if !at.is_empty() {
                let (name, cells) = (&variant.name, cells(*grid));
                warnings.push(format!(
                    "{name} on {cells} cells: the error at N = {at} is less than {REFERENCE_MARGIN} x the reference's \
                     own and limited by it, and so is what follows from it"
                ));
            }
        }
    }
    warnings
}

/// What the marks mean, for those that a table can carry.
pub fn footnotes(table: &Table, marks: &Marks) -> Vec<String> {
    let trends = || table.trends.iter().flatten();
    let predictions = table.rows.iter().filter_map(|r| r.ratio_equal_time);
    let mut predictions = predictions.chain(trends().filter_map(|t| t.time_to_target));
    let mut laws = trends().filter_map(|t| t.law);
    let of_marks = [
        (
            table.rows.iter().any(|r| r.limited_by_reference),
            marks.limited,
            format!(
                "limited by the reference: less than {REFERENCE_MARGIN} x its own error, or a rate fitted to such errors"
            ),
        ),
        (
            predictions.any(|p| p.extrapolated),
            marks.extrapolated,
            "extrapolated by the fitted law beyond the numbers of photons measured".to_owned(),
        ),
        (
            laws.any(|law| law.uncertainty == Uncertainty::Residuals),
            marks.one_seed,
            "one seed: the standard error is that of the residuals about the line, not a spread over seeds"
                .to_owned(),
        ),
    ];
    let carried = of_marks.into_iter().filter(|(is_carried, ..)| *is_carried);
    carried.map(|(_, mark, meaning)| format!("{mark} {meaning}")).collect()
}
