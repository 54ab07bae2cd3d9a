//! compare.csv: one row per variant, number of photons and grid.

use crate::lab::study::norms::Errors;
use crate::lab::study::results::Study;
use crate::lab::study::table::Table;
use crate::report::numbers::{bare, quoted};

/// The columns; names are a contract.
pub const HEADER: &str = "variant,photons,cells,relative_rms,nrms,relative_l1,nrms_spread,photons_per_s,coordinates,\
                          rate,ratio_equal_n,ratio_equal_time";

/// The table as text: errors as fractions, every number with all its digits, unknown ones empty.
///
/// `cells` is the number along a side; `photons_per_s` is per CPU second, `rate` the exponent of N, both the same in all
/// rows they belong to; the ratios are `mc`'s nRMS over the row's.
pub fn csv(study: &Study, table: &Table) -> String {
    let mut out = format!("{HEADER}\n");
    for row in &table.rows {
        let rate = table.trends[row.variant][row.grid].law.map(|law| law.rate);
        let name = quoted(&study.variants[row.variant].name);
        let (photons, cells) = (row.photons, study.grids[row.grid]);
        let Errors { relative_rms, nrms, relative_l1 } = row.errors;
        let numbers = [relative_rms, nrms, relative_l1].map(Some).into_iter().chain([
            row.nrms_spread,
            table.photons_per_cpu_s[row.variant],
            Some(row.coordinates),
            rate,
            row.ratio_equal_n,
            row.ratio_equal_time.map(|ratio| ratio.value),
        ]);
        let numbers: Vec<String> = numbers.map(bare).collect();
        out += &format!("{name},{photons},{cells},{}\n", numbers.join(","));
    }
    out
}
