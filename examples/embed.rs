//! A scene in code: a photometric file above a pane of glass, the illuminance below it with its error.
//!
//! `cargo run --release --example embed -- ies/spot.ies`
#![allow(clippy::print_stdout)]

use std::sync::atomic::AtomicBool;

use caustix::{
    AimFrame, Diagnostic, Dielectric, Emitter, Lambertian, Material, Photometric, Plan, ReceiverSpec,
    Rectangle, Reflectance, SceneBuilder, Settings, Shape, box_mesh, read_photometry, trace,
};
use glam::dvec3;

fn main() -> Result<(), Vec<Diagnostic>> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "ies/spot.ies".to_string());
    let photometry = read_photometry(file)?;
    let down = AimFrame::new(dvec3(0.0, 0.0, -1.0), Some(dvec3(0.0, 1.0, 0.0)))?;
    let lamp = Photometric::new(&photometry, dvec3(0.0, 0.0, 2.0), down, None)?;

    let pane = box_mesh(dvec3(-1.0, -1.0, 1.0), dvec3(1.0, 1.0, 1.02))?;
    let floor = Rectangle::new(dvec3(-1.0, -1.0, 0.0), dvec3(2.0, 0.0, 0.0), dvec3(0.0, 2.0, 0.0))?;
    let grey = Lambertian::new(Reflectance::new(0.3)?);

    let mut scene = SceneBuilder::new();
    scene.emitter("lamp", Emitter::Photometric(lamp));
    scene.surface("pane", Shape::Mesh(pane), Material::Dielectric(Dielectric::new(1.52, 1.0)?));
    scene.surface("floor", Shape::Rectangle(floor), Material::Lambertian(grey));
    scene.receiver(ReceiverSpec::new("floor", "floor")?.with_cells([5, 5])?);
    let scene = scene.build()?;
    let plan = Plan::new(&Settings { photons: Some(1 << 18), ..Settings::default() })?;
    let outcome = trace(&scene, &plan, &AtomicBool::new(false), &|_photons| {})?;
    for cell in 0..25 {
        let e = outcome.illuminance_lx(0, cell, scene.receivers[0].area_m2(cell));
        let end = if cell % 5 == 4 { "\n" } else { "  " };
        print!("{:7.1} +- {:4.1} lx{end}", e.value, e.standard_error.unwrap_or(f64::NAN));
    }
    let flux = outcome.receiver_flux_lm(0);
    println!("{:.2} +- {:.2} lm on the floor", flux.value, flux.standard_error.unwrap_or(f64::NAN));
    Ok(())
}
