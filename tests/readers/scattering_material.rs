//! The material made of a table against the table read on its own: two ways to the same function.

use caustix::scattering::integral::slice_albedo;
use caustix::scattering::value::value;
use caustix::scattering::{Lobe, Quantity};
use caustix::surface::tabulated::{Options, Tabulated};
use glam::DVec3;
use std::path::PathBuf;

use crate::support::data::project;
use crate::support::local;
use crate::support::tables::incidence;

/// The project's own tables, and real ones where they are at hand.
fn files() -> Vec<PathBuf> {
    let own = project().join("brdf_tables");
    let mut list: Vec<PathBuf> = std::fs::read_dir(own).unwrap().map(|e| e.unwrap().path()).collect();
    list.retain(|p| p.extension().is_some_and(|e| e == "scatter"));
    list.sort();
    if let Some(folder) = crate::support::scatter_files::real_folder() {
        let real = [
            "zemax/IMX455.bsdf",
            "zemax/ansys_planesymmetric_btdf.bsdf",
            "klems/aerc6216_kf.xml",
            "klems/sawtooth.xml",
        ];
        list.extend(real.map(|f| folder.join(f)));
    }
    list
}

/// Albedo of a lobe at the first phi_i, linear between the angles of its table.
fn albedo_between(lobe: &Lobe, theta_i: f64) -> f64 {
    let angles = &lobe.theta_i_deg;
    let after = angles.partition_point(|a| *a <= theta_i);
    let (low, high) = (after.saturating_sub(1), after.min(angles.len() - 1));
    let t = if low == high { 0.0 } else { (theta_i - angles[low]) / (angles[high] - angles[low]) };
    (1.0 - t) * slice_albedo(lobe, 0, 0, low) + t * slice_albedo(lobe, 0, 0, high)
}

#[test]
fn a_material_scatters_as_its_table_says() {
    for path in files() {
        let table = caustix::files::bsdf::read(&path).unwrap();
        let (material, _) = Tabulated::new(&table, &Options::default()).unwrap();
        let (mut compared, mut worst) = (0, 0.0f64);
        for front in [true, false] {
            for quantity in [Quantity::Reflection, Quantity::Transmission] {
                let Some(lobe) = table.lobe(quantity, front) else { continue };
                // Directions are local: z the normal on the side the light comes from.
                let side = if quantity == Quantity::Reflection { 1.0 } else { -1.0 };
                for i in 0..400 {
                    let part = |step: f64| (0.5 + f64::from(i) * step).fract();
                    let wi = incidence(88.0 * part(0.857), 360.0 * part(0.734));
                    let wo = incidence(89.0 * part(0.629), 360.0 * part(0.539));
                    let wo = DVec3::new(wo.x, wo.y, side * wo.z);
                    let eval = local::eval(&material, front, wi, wo)[0];
                    let own = value(lobe, 0, wi, wo);
                    let largest = f64::from(lobe.values.iter().copied().fold(0.0, f32::max));
                    worst = worst.max((eval - own).abs() / (own + 1e-6 * largest));
                    compared += 1;
                }
            }
            // At the angles of the first lobe: of another one with other angles, between its own.
            let both = [Quantity::Reflection, Quantity::Transmission];
            let lobes: Vec<&Lobe> = both.iter().filter_map(|q| table.lobe(*q, front)).collect();
            let Some(first) = lobes.first() else { continue };
            for theta_i in first.theta_i_deg.iter().filter(|t| **t < 90.0) {
                let albedo = local::albedo(&material, front, incidence(*theta_i, first.phi_i_deg[0]))[0];
                let own: f64 = lobes.iter().map(|lobe| albedo_between(lobe, *theta_i)).sum();
                assert!((albedo - own).abs() <= 1e-6 * own, "{} {theta_i}: {albedo} {own}", path.display());
            }
        }
        println!("{}: {compared} pairs, worst relative {worst:.2e}", path.display());
        assert!(compared >= 400 && worst < 1e-6, "{}: {worst}", path.display());
    }
}
