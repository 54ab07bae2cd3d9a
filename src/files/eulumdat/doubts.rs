//! What a file declares against what is in its table.

use super::PER_LM;
use crate::error::{Diagnostic, Kind};
use crate::files::candela::checks::two_integrals;
use crate::photometry::{Photometry, Web, flux};

/// Distance of the table's flux from lumens x light output ratio that is worth a warning: of real files all
/// but hand-written ones are within 4.4 %.
const RATIO_TOLERANCE: f64 = 0.05;

/// More lumens in the table than this for 1000 lm of the lamps are no error of measurement.
const MOST_PER_KLM: f64 = 1100.0;

/// Distance of the downward fraction, in points of 100, that is worth a warning: real files agree within 0.4.
const FRACTION_TOLERANCE: f64 = 1.0;

/// Compares, and warns.
pub(super) fn compare(photometry: &mut Photometry) {
    let web = &photometry.web;
    let grid = web.full_grid();
    let flux_lm = flux::trapezoid_lm(&grid);
    let Some(head) = photometry.eulumdat else { return };
    let mut doubts = Vec::new();
    let mut doubt = |found: String, required: &str, hint: &str| {
        doubts.push(Diagnostic::new(Kind::Range, found, required).hint(hint));
    };
    let ratio = head.light_output_ratio_percent;
    let lamps_lm = photometry.lamp_sets.get(photometry.lamp_set).map(|set| set.flux_lm);
    // A ratio of 0 is one that is not stated.
    let declared = lamps_lm.filter(|_| ratio > 0.0).map(|lm| lm * ratio / 100.0);
    let per_klm = flux_lm * PER_LM / lamps_lm.unwrap_or(PER_LM);
    let stated = if ratio > 0.0 { format!("LORL {ratio} %") } else { "no LORL".to_owned() };
    if flux_lm == 0.0 {
        doubt("a flux of 0 lm".to_owned(), "some intensity above 0", "the luminaire is dark");
    } else if per_klm > MOST_PER_KLM {
        let found = format!("{per_klm:.1} lm in the table for 1000 lm of the lamps ({stated})");
        let hint = "the table is used as it stands; are its values in candela, not in cd per 1000 lm?";
        doubt(found, "at most 1000 lm: no luminaire gives more than its lamps", hint);
    } else if let Some(lm) = declared.filter(|lm| (flux_lm / lm - 1.0).abs() > RATIO_TOLERANCE) {
        let found = format!("{stated}, which is {lm:.1} lm, for a table of {flux_lm:.1} lm");
        doubt(found, "agreement within 5 %", "the table is used");
    }
    let fraction = head.downward_fraction_percent;
    let in_table = 100.0 * downward_lm(web) / flux_lm;
    if fraction > 0.0 && (in_table - fraction).abs() > FRACTION_TOLERANCE {
        let found = format!("a downward fraction of {fraction} % for a table with {in_table:.1} %");
        doubt(found, "agreement within 1 point", "the table is used");
    }
    doubts.extend(two_integrals(flux_lm, flux::bilinear_lm(&grid)));
    photometry.flux_declared_lm = declared;
    photometry.warnings.append(&mut doubts);
}

/// The flux below gamma = 90, lm, by the trapezoid.
fn downward_lm(web: &Web) -> f64 {
    let mut vertical_deg: Vec<f64> = web.vertical_deg.iter().copied().filter(|&v| v <= 90.0).collect();
    let (last, end) = (vertical_deg.last().copied(), web.vertical_deg.last().copied());
    if last.is_some_and(|v| v < 90.0) && end.is_some_and(|v| v > 90.0) {
        vertical_deg.push(90.0);
    }
    if vertical_deg.len() < 2 {
        return 0.0;
    }
    let at = |&h: &f64| vertical_deg.iter().map(move |&v| web.intensity_cd(v, h)).collect::<Vec<_>>();
    let candela = web.horizontal_deg.iter().flat_map(at).collect();
    flux::trapezoid_lm(&Web { vertical_deg: vertical_deg.clone(), candela, ..web.clone() }.full_grid())
}
