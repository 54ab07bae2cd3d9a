//! Zonal lumens: the flux between two angles from the axis of type C.
//!
//! The rule is that of the flux itself ([`super::flux::trapezoid_lm`]): a band between two stored angles has
//! the mean of its intensities all over it. A zone that ends within a band takes its part by exact solid
//! angle, so that zones that join add up to the flux.

use super::flux::{Band, bands};
use super::unfold::radians;
use super::{PhotometricType, Web};
use serde::Serialize;

/// The zones of a data sheet, degrees.
const SHEET_DEG: [[f64; 2]; 5] = [[0.0, 30.0], [0.0, 40.0], [0.0, 60.0], [0.0, 90.0], [90.0, 180.0]];

/// The flux of one zone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Zone {
    /// Angles from the axis, degrees.
    pub from_deg: f64,
    /// The larger one.
    pub to_deg: f64,
    /// Flux, lm.
    pub flux_lm: f64,
    /// Its part of the whole flux, percent; `None` in the dark.
    pub percent: Option<f64>,
}

/// Flux by the angle from the axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ZonalLumens {
    /// 0-30, 0-40, 0-60, 0-90 and 90-180 degrees.
    pub zones: Vec<Zone>,
    /// In tens of degrees, 0-10 to 170-180.
    pub tens: Vec<Zone>,
}

impl ZonalLumens {
    /// Of a table; `None` unless it is of type C.
    pub fn new(web: &Web) -> Option<Self> {
        let bands = bands_of(web)?;
        let whole = between_lm(&bands, 0.0, 180.0);
        let zone = |[from_deg, to_deg]: [f64; 2]| {
            let flux_lm = between_lm(&bands, from_deg, to_deg);
            let percent = (whole > 0.0).then(|| 100.0 * flux_lm / whole);
            Zone { from_deg, to_deg, flux_lm, percent }
        };
        let ten = |i: u32| [10.0 * f64::from(i), 10.0 * f64::from(i + 1)];
        Some(Self { zones: SHEET_DEG.map(zone).into(), tens: (0..18).map(|i| zone(ten(i))).collect() })
    }

    /// Flux below and above the horizontal, lm.
    pub fn halves_lm(&self) -> [f64; 2] {
        [self.zones[3].flux_lm, self.zones[4].flux_lm]
    }
}

/// The bands of a table of type C.
fn bands_of(web: &Web) -> Option<Vec<Band>> {
    (web.photometric_type == PhotometricType::C).then(|| bands(&web.full_grid()))
}

fn between_lm(bands: &[Band], from_deg: f64, to_deg: f64) -> f64 {
    bands.iter().map(|band| band.between_lm(radians(from_deg), radians(to_deg))).sum()
}

/// CIE flux code of a luminaire, percent (CIE 52-1982; EN 13032-2): with F1 to F4 the fluxes within pi/2, pi,
/// 3 pi/2 and 2 pi steradians around the downward axis (to 41.4, 60, 75.5 and 90 degrees), F the flux and L
/// that of the lamps: F1/F4, F2/F4, F3/F4, F4/F, F/L. The first three are `None` where nothing goes down, the
/// fourth in the dark, the last without a flux of lamps; absolute photometry has 100 there. `None` unless the
/// table is of type C.
pub fn flux_code(web: &Web, lamps_lm: LampFlux) -> Option<[Option<f64>; 5]> {
    let bands = bands_of(web)?;
    let within = |quarter: f64| {
        // 60 and 90 degrees as a table has them.
        let edge_rad = match quarter {
            2.0 => radians(60.0),
            4.0 => radians(90.0),
            _ => libm::acos(1.0 - 0.25 * quarter),
        };
        bands.iter().map(|band| band.between_lm(0.0, edge_rad)).sum::<f64>()
    };
    let (down, whole) = (within(4.0), between_lm(&bands, 0.0, 180.0));
    let percent = |part: f64, of: f64| (of > 0.0).then(|| 100.0 * part / of);
    let of_lamps = match lamps_lm {
        LampFlux::Absolute => (whole > 0.0).then_some(100.0),
        LampFlux::Lumens(lm) => percent(whole, lm),
        LampFlux::Unknown => None,
    };
    let [first, second, third] = [1.0, 2.0, 3.0].map(|quarter| percent(within(quarter), down));
    Some([first, second, third, percent(down, whole), of_lamps])
}

/// What a light output ratio is of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LampFlux {
    /// Absolute photometry: the luminaire as a whole.
    Absolute,
    /// Lumens of all lamps.
    Lumens(f64),
    /// Not stated.
    Unknown,
}

#[cfg(test)]
mod tests {
    use super::super::PhotometricType::{B, C};
    use super::super::flux::trapezoid_lm;
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn near(got: f64, expected: f64) {
        assert!((got - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{got} {expected}");
    }

    #[test]
    fn zones_of_an_even_source_are_their_solid_angles() {
        // Stored angles that no zone ends at.
        let even = Web::new(C, vec![0.0, 17.0, 61.5, 180.0], vec![0.0], vec![100.0; 4]).unwrap();
        let zonal = ZonalLumens::new(&even).unwrap();
        for zone in zonal.zones.iter().chain(&zonal.tens) {
            let solid_angle = TAU * (zone.from_deg.to_radians().cos() - zone.to_deg.to_radians().cos());
            near(zone.flux_lm, 100.0 * solid_angle);
            near(zone.percent.unwrap(), 100.0 * solid_angle / (2.0 * TAU));
        }
        near(zonal.halves_lm()[0], 100.0 * TAU);
        // Flux code of it: a quarter, a half, three quarters of the half space, half of the light below.
        let code = flux_code(&even, LampFlux::Lumens(800.0 * PI)).unwrap();
        for (got, expected) in code.into_iter().zip([25.0, 50.0, 75.0, 50.0, 50.0]) {
            near(got.unwrap(), expected);
        }
    }

    #[test]
    fn zones_add_up_to_the_flux() {
        let v: Vec<f64> = vec![0.0, 4.5, 13.0, 29.0, 41.0, 66.0, 90.0, 101.0, 140.0];
        let h = vec![0.0, 20.0, 90.0];
        let candela = (0..27).map(|i| f64::from((i * 7919 + 13) % 101)).collect();
        let web = Web::new(C, v, h, candela).unwrap();
        let zonal = ZonalLumens::new(&web).unwrap();
        let flux_lm = trapezoid_lm(&web.full_grid());
        near(zonal.tens.iter().map(|zone| zone.flux_lm).sum(), flux_lm);
        near(zonal.halves_lm().iter().sum(), flux_lm);
        near(zonal.tens[..3].iter().map(|zone| zone.flux_lm).sum(), zonal.zones[0].flux_lm);
        assert_eq!(zonal.tens[14].flux_lm, 0.0);
    }

    #[test]
    fn the_code_of_a_cosine_and_of_uplights() {
        // A Lambertian source: flux to gamma is sin^2, so 1 - (1 - k/4)^2 of the whole.
        let v: Vec<f64> = (0..=900).map(|i| f64::from(i) * 0.1).collect();
        let cosine = v.iter().map(|v| v.to_radians().cos()).collect();
        let web = Web::new(C, v, vec![0.0], cosine).unwrap();
        let code = flux_code(&web, LampFlux::Absolute).unwrap();
        for (got, expected) in code.into_iter().zip([43.75, 75.0, 93.75, 100.0, 100.0]) {
            assert!((got.unwrap() - expected).abs() < 1e-4, "{got:?} {expected}");
        }
        let up = Web::new(C, vec![90.0, 180.0], vec![0.0], vec![1.0; 2]).unwrap();
        assert_eq!(flux_code(&up, LampFlux::Unknown), Some([None, None, None, Some(0.0), None]));
        let dark = Web::new(C, vec![0.0, 90.0], vec![0.0], vec![0.0; 2]).unwrap();
        assert_eq!(flux_code(&dark, LampFlux::Absolute), Some([None; 5]));
        assert_eq!(ZonalLumens::new(&dark).unwrap().zones[0].percent, None);
        let flood = Web::new(B, vec![-90.0, 90.0], vec![-90.0, 90.0], vec![1.0; 4]).unwrap();
        assert!(ZonalLumens::new(&flood).is_none() && flux_code(&flood, LampFlux::Absolute).is_none());
    }
}
