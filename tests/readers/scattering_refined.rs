//! A tabulated rough conductor against its formula as the table's steps are halved: the rate at which the error falls.

use std::f64::consts::PI;

use caustix::scattering::{Frame, LobeData, LobeSide, Quantity, ScatterTable};
use caustix::sequence::hash::mix64;
use caustix::sequence::to_unit_f64;
use caustix::surface::tabulated::{Options, Tabulated};
use glam::DVec3;

use crate::make_brdf;
use crate::support::local;
use crate::support::quadrature::Gauss;

/// Steps of the coarsest table: theta_i, polar and azimuth, degrees.
const COARSEST: [f64; 3] = [10.0, 7.5, 15.0];
/// The coarsest table and how often its steps are halved.
const TABLES: usize = 4;

/// The formula of `ggx_aluminium.scatter`, 1/sr.
fn conductor() -> make_brdf::Formula {
    let tables = make_brdf::tables();
    tables.iter().find(|t| t.file == "ggx_aluminium.scatter").unwrap().lobes[0].formula
}

fn g_of_formula(f: make_brdf::Formula, wi: DVec3, wo: DVec3) -> f64 {
    if wo.z > 0.0 { f(wi.to_array(), wo.to_array()) * wo.z } else { 0.0 }
}

fn steps(last: f64, step: f64) -> Vec<f64> {
    (0..=(last / step).round() as usize).map(|k| k as f64 * step).collect()
}

/// The formula at nodes whose steps are the coarsest times `scale`; theta_i from 0 to 80, over the whole hemisphere or sphere.
fn table(frame: Frame, scale: f64) -> Tabulated {
    let f = conductor();
    let (word, last) = if frame == Frame::Surface { ("surface", 90.0) } else { ("specular", 180.0) };
    let theta_i_deg = steps(80.0, COARSEST[0] * scale);
    let polar_deg = steps(last, COARSEST[1] * scale);
    let azimuth_deg = steps(360.0, COARSEST[2] * scale);
    let mut values = Vec::with_capacity(theta_i_deg.len() * polar_deg.len() * azimuth_deg.len());
    for theta_i in &theta_i_deg {
        let wi = make_brdf::incident(*theta_i, 0.0);
        for polar in &polar_deg {
            for azimuth in &azimuth_deg {
                let wo = make_brdf::scattered(word, false, *theta_i, 0.0, *polar, *azimuth);
                values.push(if wo[2] > 0.0 { f(wi, wo) as f32 } else { 0.0 });
            }
        }
    }
    let data = LobeData {
        quantity: Quantity::Reflection,
        side: LobeSide::Both,
        frame,
        theta_i_deg,
        phi_i_deg: vec![0.0],
        polar_deg,
        azimuth_deg,
        channels: 1,
        values,
        declared_tis: vec![],
    };
    let table = ScatterTable::new("refined", vec![data], vec![]).unwrap();
    Tabulated::new(&table, &Options::default()).unwrap().0
}

/// A direction of a pair, even in projected solid angle, the incident one up to 80 degrees.
fn pair(i: u64) -> (DVec3, DVec3) {
    let u = |k: u64| to_unit_f64(mix64(4 * i + k));
    let most = 80f64.to_radians().sin().powi(2);
    let unit = |sine2: f64, turn: f64| {
        let phi = 2.0 * PI * turn;
        DVec3::new(sine2.sqrt() * phi.cos(), sine2.sqrt() * phi.sin(), (1.0 - sine2).sqrt())
    };
    (unit(most * u(0), u(1)), unit(u(2), u(3)))
}

/// Root mean square of g_table - g_formula over the pairs, relative to that of g_formula.
fn rms_of_g(t: &Tabulated, wanted: impl Fn(DVec3, DVec3) -> bool) -> f64 {
    let f = conductor();
    let (mut error, mut norm) = (0.0, 0.0);
    for (wi, wo) in (0..200_000).map(pair).filter(|(wi, wo)| wanted(*wi, *wo)) {
        let exact = g_of_formula(f, wi, wo);
        let own = local::projected(t, true, wi, Quantity::Reflection, wo)[0];
        error += (own - exact) * (own - exact);
        norm += exact * exact;
    }
    (error / norm).sqrt()
}

/// Albedo of the formula by Gauss-Legendre quadrature over panels of the hemisphere.
fn albedo_of_formula(theta_i: f64) -> f64 {
    let (f, rule) = (conductor(), Gauss::new(8));
    let wi = DVec3::from(make_brdf::incident(theta_i, 0.0));
    let polar: Vec<f64> = steps(90.0, 3.0).into_iter().map(f64::to_radians).collect();
    let azimuth: Vec<f64> = steps(360.0, 6.0).into_iter().map(f64::to_radians).collect();
    rule.over_panels(&polar, |p| {
        let (sin, cos) = p.sin_cos();
        sin * rule
            .over_panels(&azimuth, |a| g_of_formula(f, wi, DVec3::new(sin * a.cos(), sin * a.sin(), cos)))
    })
}

/// Largest difference of the albedo from the formula's, at incidences of no table.
fn albedo_error(t: &Tabulated, exact: &[(f64, f64)]) -> f64 {
    let off = exact.iter().map(|(theta_i, albedo)| {
        let wi = DVec3::from(make_brdf::incident(*theta_i, 0.0));
        (local::albedo(t, true, wi)[0] - albedo).abs()
    });
    off.fold(0.0, f64::max)
}

/// Prints the errors and the rates between neighbours: log2 of how often smaller they got.
fn rates(what: &str, errors: &[f64]) -> Vec<f64> {
    let rates: Vec<f64> = errors.windows(2).map(|e| (e[0] / e[1]).log2()).collect();
    let words = |list: &[f64], digits: usize| {
        list.iter().map(|x| format!("{x:.digits$}")).collect::<Vec<_>>().join(" | ")
    };
    println!("| {what} | {} | {} |", words(errors, 6), words(&rates, 2));
    rates
}

/// Halving every step must divide the error by four once the steps resolve the lobe. About the specular direction they do from
/// the first table on; about the normal the lobe moves with the incidence, and only the last two tables are fine enough.
#[test]
fn a_rough_conductor_converges_to_its_formula_as_the_square_of_the_step() {
    let exact: Vec<(f64, f64)> =
        [3.1, 17.3, 33.3, 44.7, 56.9, 71.7, 78.3].map(|t| (t, albedo_of_formula(t))).to_vec();
    for (frame, word) in [(Frame::Specular, "specular"), (Frame::Surface, "surface")] {
        let tables: Vec<Tabulated> = (0..TABLES).map(|k| table(frame, 0.5f64.powi(k as i32))).collect();
        let rms = |least_cosine: f64| -> Vec<f64> {
            tables.iter().map(|t| rms_of_g(t, |_, wo| wo.z > least_cosine)).collect()
        };
        let off: Vec<f64> = tables.iter().map(|t| albedo_error(t, &exact)).collect();
        let all = rates(&format!("{word}: g, rms of all pairs"), &rms(0.0));
        let high = rates(&format!("{word}: g, rms of wo at least 15 degrees above the horizon"), &rms(0.26));
        let albedo = rates(&format!("{word}: albedo, largest difference"), &off);
        let second_order = |rate: f64| (rate - 2.0).abs() < 0.15;
        assert!(second_order(high[2]), "{word}: {high:?}");
        if frame == Frame::Specular {
            assert!(all[1..].iter().chain(&high).all(|r| second_order(*r)), "{all:?} {high:?}");
            assert!(albedo.iter().all(|r| (r - 2.0).abs() < 0.25), "{albedo:?}");
        } else {
            // Rising towards 2 as the steps resolve the lobe at grazing incidence too; errors of the albedo cancel.
            assert!(all.is_sorted() && all[2] > 1.7 && all[2] < 2.15, "{all:?}");
            assert!(albedo.iter().all(|r| *r > 1.85), "{albedo:?}");
        }
    }
}
