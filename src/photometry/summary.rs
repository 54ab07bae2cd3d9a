//! What a lighting engineer asks of a photometric file, in one record.

use super::beam::{BEAM_SHARE, FIELD_SHARE, lobe_angle_across_deg, lobe_angle_deg};
use super::{DataSheet, EulumdatHead, LampSet, Photometry, Revision, Tilt, TiltTable, flux};
use serde::Serialize;

/// The record of `caustix photometry --json`.
///
/// `flux_lm` and `max_candela` count value x multiplier only; the other two fluxes say in their names what they add.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The file, as the caller named it.
    pub file: String,
    /// `IES LM-63` or `EULUMDAT`.
    pub format: &'static str,
    /// Year of the edition whose rules were applied; `1986` when the file has no version line, `None` for EULUMDAT.
    pub revision: Option<&'static str>,
    /// `A`, `B` or `C`.
    pub photometric_type: &'static str,
    /// Flux by the industry's trapezoid (`flux::trapezoid_lm`), lm.
    pub flux_lm: f64,
    /// `flux_lm` times ballast factor, field 12 in 1986 and 1991, and the tilt table's factor at 0 degrees, lm.
    pub flux_with_factors_lm: f64,
    /// The bilinear table integrated exactly, with those factors, lm: what a renderer emits.
    pub flux_emitted_lm: f64,
    /// `flux_emitted_lm / flux_with_factors_lm - 1`: how far the two integrals of one table are apart; `None` in the dark.
    pub flux_emitted_relative: Option<f64>,
    /// `[_TOTALLUMINAIRELUMENS]`, or of EULUMDAT lumens of the lamp set x light output ratio, lm; `None` also where it cannot be
    /// read, which `warnings` says.
    pub flux_declared_lm: Option<f64>,
    /// Number of lamps.
    pub lamps: f64,
    /// Lumens per lamp; `None` for absolute photometry.
    pub lumens_per_lamp: Option<f64>,
    /// Their product, lm; `None` for absolute photometry, and where it is 0.
    pub lamps_lm: Option<f64>,
    /// `flux_lm / lamps_lm`.
    pub light_output_ratio: Option<f64>,
    /// The lamp sets of EULUMDAT; not in the record where there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lamp_sets: Vec<LampSet>,
    /// The one that was taken, from 1; not in the record where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lamp_set: Option<usize>,
    /// What only EULUMDAT says; not in the record of LM-63.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eulumdat: Option<EulumdatHead>,
    /// Candela multiplier, which is in all fluxes and intensities.
    pub multiplier: f64,
    /// Ballast factor.
    pub ballast_factor: f64,
    /// Field 12 as written: a factor in 1986 and 1991, later reserved, and a code in 2019.
    pub field12: String,
    /// Lamp tilt.
    pub tilt: TiltRecord,
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
    /// The beam angle in the plane across: C90-C270 (type C) or H = 0 (types A and B).
    pub beam_angle_across_deg: Option<f64>,
    /// The field angle there.
    pub field_angle_across_deg: Option<f64>,
    /// Input power, W; 0 where the file does not know it.
    pub input_watts: f64,
    /// `flux_with_factors_lm` per watt of input; `None` without a power.
    pub efficacy_lm_w: Option<f64>,
    /// Zones, flux code, further angles, luminances.
    #[serde(flatten)]
    pub sheet: DataSheet,
    /// Labels in the order of the file.
    pub labels: Vec<Label>,
    /// What was tolerated.
    pub warnings: Vec<String>,
}

/// One label of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Label {
    /// Keyword without brackets; empty for a free line.
    pub keyword: String,
    /// Text; line feeds where `[MORE]` continued it.
    pub text: String,
}

/// What a file says about lamp tilt. Its factor at 0 degrees is in the fluxes with factors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TiltRecord {
    /// `none`, `include` or `file`.
    pub kind: &'static str,
    /// The name of the tilt file.
    pub file: Option<String>,
    /// Lamp-to-luminaire geometry: 1, 2 or 3; `None` without a table, or where its file was not read.
    pub geometry: Option<u32>,
    /// Mounting angles, degrees.
    pub angles_deg: Vec<f64>,
    /// Factors at those angles.
    pub factors: Vec<f64>,
}

impl TiltRecord {
    fn new(tilt: &Tilt) -> Self {
        let (kind, file, table) = match tilt {
            Tilt::None => ("none", None, None),
            Tilt::Include(table) => ("include", None, Some(table)),
            Tilt::File { name, table } => ("file", Some(name.clone()), table.as_ref()),
        };
        let list = |of: fn(&TiltTable) -> &Vec<f64>| table.map(|t| of(t).clone()).unwrap_or_default();
        Self {
            kind,
            file,
            geometry: table.map(|t| t.geometry),
            angles_deg: list(|t| &t.angles_deg),
            factors: list(|t| &t.factors),
        }
    }
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
    /// EULUMDAT: luminous heights towards C0, C90, C180 and C270, m; not in the record of LM-63.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heights_m: Option<[f64; 4]>,
}

impl Summary {
    /// Integrates, searches and counts.
    pub fn new(photometry: &Photometry) -> Self {
        let web = &photometry.web;
        let grid = web.full_grid();
        let flux_lm = flux::trapezoid_lm(&grid);
        let flux_with_factors_lm = flux_lm * photometry.factor();
        let flux_emitted_lm = flux::bilinear_lm(&grid) * photometry.factor();
        let lamps_lm = photometry.lamps_lm();
        let max = web.max_intensity();
        let watts = photometry.input_watts;
        Self {
            file: photometry.file.clone(),
            format: photometry.format.name(),
            revision: photometry.format.revision().map(Revision::name),
            photometric_type: web.photometric_type.name(),
            flux_lm,
            flux_with_factors_lm,
            flux_emitted_lm,
            flux_emitted_relative: (flux_with_factors_lm > 0.0)
                .then(|| flux_emitted_lm / flux_with_factors_lm - 1.0),
            flux_declared_lm: photometry.flux_declared_lm,
            lamps: photometry.lamps,
            lumens_per_lamp: photometry.lumens_per_lamp,
            lamps_lm,
            light_output_ratio: lamps_lm.map(|lm| flux_lm / lm),
            lamp_sets: photometry.lamp_sets.clone(),
            lamp_set: (!photometry.lamp_sets.is_empty()).then_some(photometry.lamp_set + 1),
            eulumdat: photometry.eulumdat,
            multiplier: photometry.multiplier,
            ballast_factor: photometry.ballast_factor,
            field12: photometry.field12_text.clone(),
            tilt: TiltRecord::new(&photometry.tilt),
            max_candela: max.intensity_cd,
            max_at: Direction { vertical_deg: max.vertical_deg, horizontal_deg: max.horizontal_deg },
            vertical_angles: web.vertical_deg.len(),
            horizontal_angles: web.horizontal_deg.len(),
            symmetry: web.symmetry().name(),
            luminous_opening: Opening {
                shape: photometry.opening.shape.name(),
                size_m: photometry.opening.size_m,
                heights_m: photometry.opening.heights_m,
            },
            beam_angle_deg: lobe_angle_deg(web, BEAM_SHARE),
            field_angle_deg: lobe_angle_deg(web, FIELD_SHARE),
            beam_angle_across_deg: lobe_angle_across_deg(web, BEAM_SHARE),
            field_angle_across_deg: lobe_angle_across_deg(web, FIELD_SHARE),
            input_watts: watts,
            efficacy_lm_w: (watts > 0.0).then(|| flux_with_factors_lm / watts),
            sheet: DataSheet::new(photometry, flux_lm),
            labels: photometry
                .labels
                .iter()
                .map(|(keyword, text)| Label { keyword: keyword.clone(), text: text.clone() })
                .collect(),
            warnings: photometry.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::photometric;

    const SMALL: &str = "IESNA91\nTILT=NONE\n1 -1 2 3 1 1 2 0 0 0\n0.5 0.9 10\n0 40 90\n0\n100 0 0\n";

    #[test]
    fn the_record_has_the_keys_of_the_interface_and_no_others() {
        let summary = Summary::new(&photometric::parse(SMALL.as_bytes(), "small.ies").unwrap());
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
            "file",
            "flux_emitted_relative",
            "lamps",
            "lumens_per_lamp",
            "lamps_lm",
            "light_output_ratio",
            "multiplier",
            "ballast_factor",
            "field12",
            "tilt",
            "beam_angle_across_deg",
            "field_angle_across_deg",
            "labels",
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
            "flux_downward_lm",
            "flux_upward_lm",
            "downward_percent",
            "zonal_lumens",
            "cie_flux_code",
            "beam_angle_at_max_deg",
            "field_angle_at_max_deg",
            "nema_type",
            "max_candela_per_klm",
            "luminance",
            "absent",
            "warnings",
        ];
        expected.sort_unstable();
        assert_eq!(keys, expected);
        assert!(json["max_at"]["vertical_deg"].is_number() && json["max_at"]["horizontal_deg"].is_number());
        assert!(json["luminous_opening"]["shape"].is_string());
        assert_eq!(json["luminous_opening"]["size_m"].as_array().unwrap().len(), 3);
    }

    #[test]
    fn what_is_not_given_says_why() {
        let of = |text: &str| {
            serde_json::to_value(Summary::new(&photometric::parse(text.as_bytes(), "x.ies").unwrap()))
                .unwrap()
        };
        let cone = of(SMALL);
        let keys = |json: &serde_json::Value| {
            json["absent"].as_object().unwrap().keys().cloned().collect::<Vec<_>>()
        };
        assert_eq!(keys(&cone), ["luminance"]);
        // 200 cd of a cone of 147.01 lm, absolute: 1360.45 cd/klm; 72 degrees of field are type 5; all of it goes down.
        assert!(
            (cone["max_candela_per_klm"].as_f64().unwrap() - 2e5 / cone["flux_lm"].as_f64().unwrap()).abs()
                < 1e-9
        );
        assert_eq!(cone["nema_type"]["types"], serde_json::json!([5, 5]));
        assert_eq!(cone["downward_percent"], 100.0);
        assert_eq!(cone["flux_downward_lm"], cone["flux_lm"]);
        let flood = of("IESNA:LM-63-2002\nTILT=NONE\n1 0 1 2 2 2 2 1 1 0\n1 1 0\n-90 90\n-90 90\n0 0 0 0\n");
        let dark = [
            "beam_angle_at_max_deg",
            "cie_flux_code",
            "downward_percent",
            "field_angle_at_max_deg",
            "flux_downward_lm",
            "flux_upward_lm",
            "luminance",
            "max_candela_per_klm",
            "nema_type",
            "zonal_lumens",
        ];
        assert_eq!(keys(&flood), dark);
        assert!(dark.iter().all(|key| flood[key].is_null()), "{flood}");
    }

    #[test]
    fn fluxes_count_what_their_names_say() {
        let summary = Summary::new(&photometric::parse(SMALL.as_bytes(), "small.ies").unwrap());
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
