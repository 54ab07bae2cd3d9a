//! compare.csv: one row per variant, number of photons and grid.

use crate::lab::study::results::Study;
use crate::lab::study::table::Table;

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
            number(Some(row.errors.relative_rms)),
            number(Some(row.errors.nrms)),
            number(Some(row.errors.relative_l1)),
            number(row.nrms_spread),
            number(table.photons_per_cpu_s[row.variant]),
            number(Some(row.coordinates)),
            number(rate),
            number(row.ratio_equal_n),
            number(row.ratio_equal_time.map(|ratio| ratio.value)),
        ];
        out.push_str(&fields.join(","));
        out.push('\n');
    }
    out
}

/// The shortest decimal that reads back as the same number.
fn number(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map_or(String::new(), |v| format!("{v}"))
}

/// RFC 4180: quotes around a field that needs them, doubled inside.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
