//! The material made of a table against the table read on its own: two ways to the same function.

use caustix::scattering::Quantity;
use caustix::scattering::integral::slice_albedo;
use caustix::scattering::value::value;
use caustix::surface::tabulated::{Options, Tabulated};
use glam::DVec3;
use std::path::PathBuf;

use crate::support::data::project;
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
                    let eval = material.eval(front, wi, wo)[0];
                    let own = value(lobe, 0, wi, wo);
                    let largest = f64::from(lobe.values.iter().copied().fold(0.0, f32::max));
                    worst = worst.max((eval - own).abs() / (own + 1e-6 * largest));
                    compared += 1;
                }
                for (t, theta_i) in lobe.theta_i_deg.iter().enumerate().filter(|(_, t)| **t < 90.0) {
                    let wi = incidence(*theta_i, lobe.phi_i_deg[0]);
                    let albedo = material.albedo_of(front, wi, quantity)[0];
                    let own = slice_albedo(lobe, 0, 0, t);
                    assert!(
                        (albedo - own).abs() <= 1e-6 * own,
                        "{} {theta_i}: {albedo} {own}",
                        path.display()
                    );
                }
            }
        }
        println!("{}: {compared} pairs, worst relative {worst:.2e}", path.display());
        assert!(compared >= 400 && worst < 1e-6, "{}: {worst}", path.display());
    }
}
