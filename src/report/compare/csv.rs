//! compare.csv: one row per variant, number of photons and grid.

use crate::lab::study::results::Study;
use crate::lab::study::table::Table;
use crate::report::numbers::bare;

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
        let fields = [
            quoted(&study.variants[row.variant].name),
            row.photons.to_string(),
            study.grids[row.grid].to_string(),
            bare(Some(row.errors.relative_rms)),
            bare(Some(row.errors.nrms)),
            bare(Some(row.errors.relative_l1)),
            bare(row.nrms_spread),
            bare(table.photons_per_cpu_s[row.variant]),
            bare(Some(row.coordinates)),
            bare(rate),
            bare(row.ratio_equal_n),
            bare(row.ratio_equal_time.map(|ratio| ratio.value)),
        ];
        out.push_str(&fields.join(","));
        out.push('\n');
    }
    out
}

/// RFC 4180: quotes around a field that needs them, doubled inside.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
