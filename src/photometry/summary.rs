//! What a lighting engineer asks of a photometric file, in one record.

use super::beam::{BEAM_SHARE, FIELD_SHARE, lobe_angle_deg};
use super::{Photometry, flux};
use serde::Serialize;

/// The record of `caustix photometry --json`.
///
/// `flux_lm` and `max_candela` count value x multiplier only; the other two fluxes say in their names what they add.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// `IES LM-63`.
    pub format: &'static str,
    /// Year of the edition whose rules were applied; `1986` when the file has no version line.
    pub revision: &'static str,
    /// `A`, `B` or `C`.
    pub photometric_type: &'static str,
    /// Flux by the industry's trapezoid (`flux::flux_lm`), lm.
    pub flux_lm: f64,
    /// `flux_lm` times ballast factor, and times field 12 in 1986 and 1991, lm.
    pub flux_with_factors_lm: f64,
    /// The bilinear table integrated exactly, with those factors, lm: what a renderer emits.
    pub flux_emitted_lm: f64,
    /// `[_TOTALLUMINAIRELUMENS]`, lm.
    pub flux_declared_lm: Option<f64>,
    /// Largest intensity, cd.
    pub max_candela: f64,
    /// Where it is; of equal ones the first in the file.
    pub max_at: Direction,
    /// Number of stored vertical angles.
    pub vertical_angles: usize,
    /// Number of stored horizontal angles.
    pub horizontal_angles: usize,
    /// Name of the symmetry (`Symmetry::name`).
    pub symmetry: &'static str,
    /// Shape and size of the luminous opening.
    pub luminous_opening: Opening,
    /// Full angle at 50 % of the principal plane's maximum (`lobe_angle_deg`); `None` for a dark plane.
    pub beam_angle_deg: Option<f64>,
    /// Full angle at 10 %.
    pub field_angle_deg: Option<f64>,
    /// Input power, W; 0 where the file does not know it.
    pub input_watts: f64,
    /// `flux_with_factors_lm` per watt of input; `None` without a power.
    pub efficacy_lm_w: Option<f64>,
    /// What was tolerated.
    pub warnings: Vec<String>,
}

/// A direction in the file's angles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Direction {
    /// V, degrees.
    pub vertical_deg: f64,
    /// H, degrees.
    pub horizontal_deg: f64,
}

/// Luminous opening in a summary.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Opening {
    /// Name of the shape.
    pub shape: &'static str,
    /// Width, length, height of the bounding box, m.
    pub size_m: [f64; 3],
}

impl Summary {
    /// Integrates, searches and counts.
    pub fn new(photometry: &Photometry) -> Self {
        let web = &photometry.web;
        let grid = web.full_grid();
        let flux_lm = flux::trapezoid_lm(&grid);
        let flux_with_factors_lm = flux_lm * photometry.factor();
        let max = web.max_intensity();
        let watts = photometry.input_watts;
        Self {
            format: "IES LM-63",
            revision: photometry.revision.name(),
            photometric_type: web.photometric_type.name(),
            flux_lm,
            flux_with_factors_lm,
            flux_emitted_lm: flux::bilinear_lm(&grid) * photometry.factor(),
            flux_declared_lm: photometry.flux_declared_lm,
            max_candela: max.intensity_cd,
            max_at: Direction { vertical_deg: max.vertical_deg, horizontal_deg: max.horizontal_deg },
            vertical_angles: web.vertical_deg.len(),
            horizontal_angles: web.horizontal_deg.len(),
            symmetry: web.symmetry().name(),
            luminous_opening: Opening {
                shape: photometry.opening.shape.name(),
                size_m: photometry.opening.size_m,
            },
            beam_angle_deg: lobe_angle_deg(web, BEAM_SHARE),
            field_angle_deg: lobe_angle_deg(web, FIELD_SHARE),
            input_watts: watts,
            efficacy_lm_w: (watts > 0.0).then(|| flux_with_factors_lm / watts),
            warnings: photometry.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::lm63;

    const SMALL: &str = "IESNA91\nTILT=NONE\n1 -1 2 3 1 1 2 0 0 0\n0.5 0.9 10\n0 40 90\n0\n100 0 0\n";

    #[test]
    fn the_record_has_the_keys_of_the_interface_and_no_others() {
        let summary = Summary::new(&lm63::parse(SMALL.as_bytes(), "small.ies").unwrap());
        let json = serde_json::to_value(&summary).unwrap();
        let mut keys: Vec<&str> = json.as_object().unwrap().keys().map(String::as_str).collect();
        keys.sort_unstable();
        let mut expected = [
            "format",
            "revision",
            "photometric_type",
            "flux_lm",
            "flux_with_factors_lm",
            "flux_emitted_lm",
            "flux_declared_lm",
            "max_candela",
            "max_at",
            "vertical_angles",
            "horizontal_angles",
            "symmetry",
            "luminous_opening",
            "beam_angle_deg",
            "field_angle_deg",
            "input_watts",
            "efficacy_lm_w",
            "warnings",
        ];
        expected.sort_unstable();
        assert_eq!(keys, expected);
        assert!(json["max_at"]["vertical_deg"].is_number() && json["max_at"]["horizontal_deg"].is_number());
        assert!(json["luminous_opening"]["shape"].is_string());
        assert_eq!(json["luminous_opening"]["size_m"].as_array().unwrap().len(), 3);
    }

    #[test]
    fn fluxes_count_what_their_names_say() {
        let summary = Summary::new(&lm63::parse(SMALL.as_bytes(), "small.ies").unwrap());
        // A cone of 200 cd falling linearly to 0 at 40 degrees. Trapezoid: 2 pi 100 (1 - cos 40); exact:
        // 2 pi 200 Int (1 - t/T) sin t dt = 2 pi 200 (1 - sin T / T).
        let edge = 40f64.to_radians();
        let trapezoid = std::f64::consts::TAU * 100.0 * (1.0 - edge.cos());
        let exact = std::f64::consts::TAU * 200.0 * (1.0 - edge.sin() / edge) * 0.45;
        assert!((summary.flux_lm - trapezoid).abs() < 1e-12 * trapezoid);
        assert!((summary.flux_with_factors_lm - 0.45 * trapezoid).abs() < 1e-12 * trapezoid);
        assert!((summary.flux_emitted_lm - exact).abs() < 1e-12 * exact);
        assert_eq!((summary.max_candela, summary.beam_angle_deg), (200.0, Some(40.0)));
        assert_eq!(summary.efficacy_lm_w, Some(summary.flux_with_factors_lm / 10.0));
    }
}
