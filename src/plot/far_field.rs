//! The polar diagram of a far field.

use crate::report::far_field::FarFieldStatistics;
use crate::report::numbers::{digits, with_error};
use crate::scene::far_field::FarField;

use super::candela::curves;
use super::drawing::Drawing;
use super::polar::PolarPlot;

/// The planes C0-C180 and C90-C270 of its table; one curve where both are the same.
pub fn drawing(field: &FarField, s: &FarFieldStatistics) -> Drawing {
    let flux = with_error(s.flux_lm, s.flux_standard_error_lm, "lm");
    let max = with_error(s.max_candela.value, s.max_candela.standard_error, "cd");
    let [beam, across] =
        s.beam_angle_deg.map(|angle| angle.map_or("none".into(), |a| digits(a.value) + "\u{b0}"));
    let footer = vec![format!("flux {flux}"), format!("maximum {max}, beam angle {beam} and {across}")];
    PolarPlot { title: field.name.clone(), curves: curves(&s.web), footer }.drawing()
}
