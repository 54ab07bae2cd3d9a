//! What is said beside the numbers, alike on the terminal and in the file: the settings, warnings, footnotes.

use crate::lab::study::fit::Uncertainty;
use crate::lab::study::results::{BASELINE, ReferenceUsed, Study};
use crate::lab::study::table::{REFERENCE_MARGIN, Table};
use crate::report::numbers::{grouped, list, three_digits};

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
    list(study.grids.iter().enumerate().map(on))
}

/// The seeds, in words.
pub fn seeds(study: &Study) -> String {
    let seeds = list(study.seeds.iter().map(u64::to_string));
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
    let mut warnings = limits(study, table);
    if study.reference.factor < LEAST_FACTOR {
        warnings.push(format!(
            "the reference has {} x the photons of the largest N, less than {LEAST_FACTOR}",
            three_digits(study.reference.factor)
        ));
    }
    if study.baseline().is_none() {
        warnings.push(format!("without the variant {BASELINE} there are no ratios"));
    }
    let ladder = table.ladder();
    if ladder.len() == 1 {
        let without = "no rate, no ratio at equal time and no time to 1 %";
        warnings.push(format!("one number of photons gives {without}"));
    }
    if !ladder.is_empty() && !ladder.contains(&study.asked_photons) {
        let asked = grouped(study.asked_photons);
        warnings.push(format!(
            "no run with the {asked} photons asked for is finished; tables show the largest N"
        ));
    }
    if study.seeds.len() == 1 {
        warnings.push("one seed says nothing about the spread of an error".to_owned());
    }
    warnings.extend(study.warnings.iter().cloned());
    warnings
}

/// For every variant and grid, where the reference limits its error.
fn limits(study: &Study, table: &Table) -> Vec<String> {
    let mut warnings = Vec::new();
    for (v, variant) in study.variants.iter().enumerate() {
        for (g, grid) in study.grids.iter().enumerate() {
            let limited =
                table.rows.iter().filter(|r| (r.variant, r.grid) == (v, g) && r.limited_by_reference);
            let at = list(limited.map(|r| grouped(r.photons)));
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
    let mut notes = Vec::new();
    let trends = || table.trends.iter().flatten();
    if table.rows.iter().any(|r| r.limited_by_reference) {
        notes.push(format!(
            "{} limited by the reference: less than {REFERENCE_MARGIN} x its own error, or a rate fitted to such errors",
            marks.limited
        ));
    }
    let extrapolated = table.rows.iter().filter_map(|r| r.ratio_equal_time).any(|p| p.extrapolated)
        || trends().filter_map(|t| t.time_to_target).any(|p| p.extrapolated);
    if extrapolated {
        notes.push(format!(
            "{} extrapolated by the fitted law beyond the numbers of photons measured",
            marks.extrapolated
        ));
    }
    if trends().filter_map(|t| t.law).any(|law| law.uncertainty == Uncertainty::Residuals) {
        notes.push(format!(
            "{} one seed: the standard error is that of the residuals about the line, not a spread over seeds",
            marks.one_seed
        ));
    }
    notes
}
