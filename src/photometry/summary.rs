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
    /// Flux by the industry's trapezoid ([`flux::flux_lm`]), lm.
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
    /// Name of the symmetry ([`super::Symmetry::name`]).
    pub symmetry: &'static str,
    /// Shape and size of the luminous opening.
    pub luminous_opening: Opening,
    /// Full angle at 50 % of the principal plane's maximum ([`lobe_angle_deg`]); `None` for a dark plane.
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
