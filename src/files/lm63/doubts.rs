//! What a file declares against what is in its table.

use crate::error::{Diagnostic, Kind};
use crate::files::candela::checks::two_integrals;
use crate::files::excerpt::quoted;
use crate::photometry::{Photometry, flux};

/// Deviation of the declared from the integrated flux that is worth a warning: real files agree within 0.25 %.
const DECLARED_TOLERANCE: f64 = 3e-3;

/// More light than this times the lamps' own is no error of measurement.
const MOST_OF_LAMPS: f64 = 1.15;

/// Compares, and warns: an independent check that comes with the file.
pub(super) fn compare(photometry: &mut Photometry) {
    let grid = photometry.web.full_grid();
    let flux_lm = flux::trapezoid_lm(&grid);
    let mut doubts = Vec::new();
    let mut doubt = |found: String, required: &str, hint: &str| {
        let d = Diagnostic::new(Kind::Range, found, required);
        doubts.push(if hint.is_empty() { d } else { d.hint(hint) });
    };
    if flux_lm == 0.0 && photometry.multiplier > 0.0 {
        doubt("a flux of 0 lm".to_owned(), "some intensity above 0", "");
    }
    let key = "_TOTALLUMINAIRELUMENS";
    let label = photometry.labels.iter().find(|(k, _)| k.eq_ignore_ascii_case(key));
    let label = label
        .or_else(|| photometry.labels.iter().find(|(k, _)| k.eq_ignore_ascii_case(&key[1..])))
        .map(|(_, text)| text.trim())
        .filter(|text| !text.is_empty());
    let declared = label.and_then(lumens);
    if let (Some(text), None) = (label, declared) {
        let found = format!("[{key}] {}", quoted(text));
        doubt(found, "a number of lumens such as 4160.5", "it cannot be read, and is compared with nothing");
    }
    if let Some(declared) = declared.filter(|&lm| (flux_lm - lm).abs() > DECLARED_TOLERANCE * lm) {
        let found = format!("[{key}] {declared} for a table of {flux_lm:.1} lm");
        doubt(found, "agreement within 0.3 %", "the table is used");
    }
    if let Some(lamps_lm) = photometry.lamps_lm().filter(|&lm| flux_lm > MOST_OF_LAMPS * lm) {
        let (lamps, each) = (photometry.lamps, photometry.lumens_per_lamp.unwrap_or_default());
        let found = format!("{flux_lm:.1} lm in the table, out of lamps of {lamps} x {each} = {lamps_lm} lm");
        let hint = "lamp lumens scale nothing: the table is used; \
                    if it is in candela per 1000 lm, or absolute (-1), the file should say so";
        doubt(found, "at most 1.15 times the lumens of the lamps", hint);
    }
    doubts.extend(two_integrals(flux_lm, flux::bilinear_lm(&grid)));
    photometry.flux_declared_lm = declared;
    photometry.warnings.append(&mut doubts);
}

/// A declared flux: `4160.5`, `4,160.5`, with or without a unit behind it. Not `4.160,5` nor `4160,5`: a comma parts groups of
/// three digits here, and a number that was written by another rule would be off by a factor of 1000.
fn lumens(text: &str) -> Option<f64> {
    let word = text.split_whitespace().next()?;
    let word = word.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let (whole, fraction) = word.split_once('.').unwrap_or((word, ""));
    let mut groups = whole.split(',');
    let first = groups.next()?;
    let mut is_grouped = false;
    let in_threes = groups.all(|group| {
        is_grouped = true;
        group.len() == 3 && group.bytes().all(|c| c.is_ascii_digit())
    });
    if fraction.contains(',') || !in_threes || (is_grouped && !(1..=3).contains(&first.len())) {
        return None;
    }
    word.replace(',', "").parse::<f64>().ok().filter(|&lm| lm > 0.0 && lm.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declared_lumens_of_the_wild() {
        for (text, expected) in [
            ("4160", Some(4160.0)),
            ("4,160.5 lm", Some(4160.5)),
            ("1,234,567", Some(1_234_567.0)),
            ("4160lm", Some(4160.0)),
            ("4.160,0 lm", None),
            ("4160,5", None),
            ("4,16", None),
            ("41600,000", None),
            ("N.A.", None),
            ("-1", None),
            ("inf", None),
        ] {
            assert_eq!(lumens(text), expected, "{text}");
        }
    }
}
