//! The data sheet of a luminaire: what stands beside flux and maximum in a [`super::Summary`].

use super::beam::{BEAM_SHARE, FIELD_SHARE, lobe_angle_at_max_deg};
use super::luminance::LuminanceTable;
use super::nema::NemaType;
use super::zones::{LampFlux, ZonalLumens, flux_code};
use super::{PhotometricType, Photometry};
use serde::Serialize;
use std::collections::BTreeMap;

/// Numbers of a data sheet. What a table does not define is `None`, and `absent` says why, by its key.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DataSheet {
    /// Flux below the horizontal (gamma to 90 degrees), lm.
    pub flux_downward_lm: Option<f64>,
    /// Flux above it, lm.
    pub flux_upward_lm: Option<f64>,
    /// Their part below, percent.
    pub downward_percent: Option<f64>,
    /// Zonal lumens.
    pub zonal_lumens: Option<ZonalLumens>,
    /// CIE flux code, percent.
    pub cie_flux_code: Option<[Option<f64>; 5]>,
    /// Beam angle in the plane through the largest intensity, degrees.
    pub beam_angle_at_max_deg: Option<f64>,
    /// Field angle there.
    pub field_angle_at_max_deg: Option<f64>,
    /// NEMA type.
    pub nema_type: Option<NemaType>,
    /// Largest intensity per 1000 lm of the lamps, or of the luminaire in absolute photometry, cd/klm.
    pub max_candela_per_klm: Option<f64>,
    /// Luminances of the opening.
    pub luminance: Option<LuminanceTable>,
    /// Why a number is not given, by its key.
    pub absent: BTreeMap<&'static str, &'static str>,
}

impl DataSheet {
    /// Of a file with this flux by the trapezoid.
    pub fn new(photometry: &Photometry, flux_lm: f64) -> Self {
        let web = &photometry.web;
        let mut absent = BTreeMap::new();
        let is_c = web.photometric_type == PhotometricType::C;
        if !is_c {
            let why = "defined around the axis of type C; types A and B have other poles";
            for key in
                ["flux_downward_lm", "flux_upward_lm", "downward_percent", "zonal_lumens", "cie_flux_code"]
            {
                absent.insert(key, why);
            }
        }
        let lamps = lamps(photometry);
        let zonal_lumens = ZonalLumens::new(web);
        let halves = zonal_lumens.as_ref().map(ZonalLumens::halves_lm);
        let cie_flux_code = flux_code(web, lamps);
        if cie_flux_code.is_some_and(|code| code.contains(&None)) {
            let dark = "some numbers are parts of no light, or of lamps whose lumens are not stated";
            absent.insert("cie_flux_code", dark);
        }
        let mut given =
            |key, value: Result<_, &'static str>| value.map_err(|why| absent.insert(key, why)).ok();
        let nema_type = given("nema_type", NemaType::new(web));
        let luminance = LuminanceTable::new(photometry).map_err(|why| absent.insert("luminance", why)).ok();
        let per_klm = klm(photometry, flux_lm).map(|klm| web.max_intensity().intensity_cd / klm);
        if flux_lm == 0.0 {
            for key in
                ["downward_percent", "beam_angle_at_max_deg", "field_angle_at_max_deg", "max_candela_per_klm"]
            {
                absent.entry(key).or_insert("a flux of 0");
            }
        } else if per_klm.is_none() {
            absent.insert("max_candela_per_klm", "the lumens of the lamps are 0");
        }
        Self {
            flux_downward_lm: halves.map(|[down, _]| down),
            flux_upward_lm: halves.map(|[_, up]| up),
            downward_percent: cie_flux_code.and_then(|code| code[3]),
            zonal_lumens,
            cie_flux_code,
            beam_angle_at_max_deg: lobe_angle_at_max_deg(web, BEAM_SHARE),
            field_angle_at_max_deg: lobe_angle_at_max_deg(web, FIELD_SHARE),
            nema_type,
            max_candela_per_klm: per_klm,
            luminance,
            absent,
        }
    }
}

fn lamps(photometry: &Photometry) -> LampFlux {
    match (photometry.lumens_per_lamp, photometry.lamps_lm()) {
        (None, _) => LampFlux::Absolute,
        (_, Some(lm)) => LampFlux::Lumens(lm),
        (_, None) => LampFlux::Unknown,
    }
}

/// Thousands of lumens that intensities are given for: of the lamps, or in absolute photometry of the
/// luminaire (EULUMDAT: as its lamp set states; LM-63: by the trapezoid, as given here); `None` where they
/// are 0.
pub fn klm(photometry: &Photometry, flux_lm: f64) -> Option<f64> {
    let of_set = photometry.lamp_sets.get(photometry.lamp_set).map(|set| set.flux_lm);
    let lm = match (of_set, lamps(photometry)) {
        (Some(lm), _) | (None, LampFlux::Lumens(lm)) => lm,
        (None, LampFlux::Absolute) => flux_lm,
        (None, LampFlux::Unknown) => 0.0,
    };
    (lm > 0.0).then_some(1e-3 * lm)
}
