//! What a study says: errors over seeds, rates, ratios to Monte Carlo at equal N and at equal CPU time.

use super::fit::{Law, Level, Prediction, distinct, fitted};
use super::norms::Errors;
use super::results::{Run, Study};

/// An error of less than so many times the reference's own says as much about the reference.
pub const REFERENCE_MARGIN: f64 = 3.0;

/// The error that "time to 1 %" is about.
pub const TARGET_ERROR: f64 = 0.01;

/// Everything derived from a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// By variant, photons (rising), grid.
    pub rows: Vec<Row>,
    /// By variant, grid.
    pub trends: Vec<Vec<Trend>>,
    /// By variant: photons a CPU second, the median over the runs with the largest N.
    pub photons_per_cpu_s: Vec<Option<f64>>,
}

/// One variant at one number of photons on one grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Index of the variant.
    pub variant: usize,
    /// N.
    pub photons: u64,
    /// Index of the grid.
    pub grid: usize,
    /// Over the seeds: root mean square of `relative_rms` and `nrms`, mean of `relative_l1`.
    pub errors: Errors,
    /// Standard deviation of nRMS over the seeds; `None` for one seed.
    pub nrms_spread: Option<f64>,
    /// CPU time of a run, s, the median over the seeds.
    pub cpu_s: f64,
    /// Coordinates a photon, the mean over the seeds.
    pub coordinates: f64,
    /// nRMS of `mc` at this N over this nRMS.
    pub ratio_equal_n: Option<f64>,
    /// nRMS of `mc` after this CPU time, by its fitted law, over this nRMS.
    pub ratio_equal_time: Option<Prediction>,
    /// Whether nRMS is less than [`REFERENCE_MARGIN`] times the reference's own, or that is unknown.
    pub limited_by_reference: bool,
}

/// How the error of one variant falls on one grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    /// The law of nRMS; `None` where fewer than two numbers of photons were measured.
    pub law: Option<Law>,
    /// CPU time to [`TARGET_ERROR`], s.
    pub time_to_target: Option<Prediction>,
    /// Whether any of the errors that the law is fitted to is limited by the reference.
    pub limited_by_reference: bool,
}

impl Table {
    /// All rows and trends of a study.
    pub fn new(study: &Study) -> Self {
        let photons_per_cpu_s: Vec<Option<f64>> = study.variants.iter().map(|v| speed(&v.runs)).collect();
        let variants = || 0..study.variants.len();
        let mut rows: Vec<Row> = variants().flat_map(|variant| rows_of_variant(study, variant)).collect();
        let on_grid = |v: usize, grid: usize| trend(study, &rows, v, grid, photons_per_cpu_s[v]);
        let trends_of = |v: usize| (0..study.grids.len()).map(|grid| on_grid(v, grid)).collect();
        let trends: Vec<Vec<Trend>> = variants().map(trends_of).collect();
        if let Some(baseline) = study.baseline() {
            compare_with(baseline, &mut rows, &trends, photons_per_cpu_s[baseline]);
        }
        Self { rows, trends, photons_per_cpu_s }
    }

    /// The row of a variant, a number of photons and a grid.
    pub fn row(&self, variant: usize, photons: u64, grid: usize) -> Option<&Row> {
        self.rows.iter().find(|r| (r.variant, r.photons, r.grid) == (variant, photons, grid))
    }

    /// Every number of photons that some variant was run with, rising.
    pub fn ladder(&self) -> Vec<u64> {
        distinct(self.rows.iter().map(|r| r.photons))
    }
}

/// Rows without ratios.
fn rows_of_variant(study: &Study, variant: usize) -> Vec<Row> {
    let runs = &study.variants[variant].runs;
    let mut rows = Vec::new();
    for photons in distinct(runs.iter().map(|run| run.photons)) {
        let same: Vec<&Run> = runs.iter().filter(|run| run.photons == photons).collect();
        let n = same.len() as f64;
        for grid in 0..study.grids.len() {
            let errors: Vec<Errors> = same.iter().filter_map(|run| run.errors.get(grid).copied()).collect();
            if errors.is_empty() {
                continue;
            }
            let (errors, nrms_spread) = Errors::over_seeds(&errors);
            rows.push(Row {
                variant,
                photons,
                grid,
                errors,
                nrms_spread,
                cpu_s: median(same.iter().map(|run| run.cpu_s).collect()),
                coordinates: same.iter().map(|run| run.coordinates_mean).sum::<f64>() / n,
                ratio_equal_n: None,
                ratio_equal_time: None,
                limited_by_reference: is_limited(study, grid, errors.nrms),
            });
        }
    }
    rows
}

fn is_limited(study: &Study, grid: usize, nrms: f64) -> bool {
    // An unknown error of the reference, NaN included, limits everything.
    !study.reference.own_nrms.get(grid).is_some_and(|own| nrms >= REFERENCE_MARGIN * own)
}

fn trend(study: &Study, rows: &[Row], variant: usize, grid: usize, speed: Option<f64>) -> Trend {
    let runs = &study.variants[variant].runs;
    let levels_of = |seed: u64| -> Vec<Level> {
        runs.iter()
            .filter(|run| run.seed == seed)
            .filter_map(|run| Some(Level { photons: run.photons, error: run.errors.get(grid)?.nrms }))
            .collect()
    };
    let seeds = distinct(runs.iter().map(|run| run.seed));
    let law = Law::fit(&seeds.into_iter().map(levels_of).collect::<Vec<_>>());
    let time_to_target = law.and_then(|law| law.time_for(TARGET_ERROR, speed?));
    let own: Vec<&Row> = rows.iter().filter(|r| (r.variant, r.grid) == (variant, grid)).collect();
    let used = fitted(&own.iter().map(|r| r.photons).collect::<Vec<u64>>());
    let limited_by_reference = own.iter().any(|r| used.contains(&r.photons) && r.limited_by_reference);
    Trend { law, time_to_target, limited_by_reference }
}

fn compare_with(baseline: usize, rows: &mut [Row], trends: &[Vec<Trend>], speed: Option<f64>) {
    let measured: Vec<Row> = rows.iter().filter(|r| r.variant == baseline).cloned().collect();
    for row in rows {
        let own = row.errors.nrms;
        let ratio = |error: f64| Some(error / own).filter(|r| r.is_finite());
        let mut same = measured.iter().filter(|r| (r.photons, r.grid) == (row.photons, row.grid));
        row.ratio_equal_n = same.next().and_then(|r| ratio(r.errors.nrms));
        row.ratio_equal_time = if row.variant == baseline {
            // Its own time gives its own error: no law is needed to know that.
            ratio(own).map(|value| Prediction { value, extrapolated: false })
        } else {
            trends[baseline][row.grid].law.and_then(|law| {
                let then = law.error_at(row.cpu_s * speed?);
                ratio(then.value).map(|value| Prediction { value, ..then })
            })
        };
    }
}

fn speed(runs: &[Run]) -> Option<f64> {
    let largest = runs.iter().map(|run| run.photons).max()?;
    let same = runs.iter().filter(|run| run.photons == largest);
    let value = median(same.map(|run| run.photons as f64 / run.cpu_s).collect());
    (value > 0.0 && value.is_finite()).then_some(value)
}

/// The middle value, or the mean of the two middle ones; NaN of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n if n.is_multiple_of(2) => 0.5 * (values[n / 2 - 1] + values[n / 2]),
        n => values[n / 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_those_computed_by_hand() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 9.0]), 3.0);
        assert!(median(vec![]).is_nan());
    }
}
