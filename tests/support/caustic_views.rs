//! Scenes in which a camera sees caustics directly, for the comparison of the photon map with the splat: shared by
//! `tests/pictures/bias.rs` and `examples/picture_bias.rs`.
#![allow(dead_code)]

use std::path::PathBuf;

use caustix::error::{Diagnostic, Kind, Result};
use caustix::files::bytes::Base;
use caustix::files::scene_toml;
use caustix::run::{Plan, Settings};
use caustix::scene::Scene;
use caustix::scene::camera::{CameraSpec, Filter};
use glam::DVec3;

/// A scene and its camera.
pub struct View {
    pub name: &'static str,
    pub scene: Scene,
    pub spec: CameraSpec,
    /// Whether a beam lights nothing but what is seen: photons cost little.
    pub in_beam: bool,
}

/// A file of the project.
fn of_file(path: &str) -> std::result::Result<Scene, Vec<Diagnostic>> {
    scene_toml::read_scene(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path))
}

type Built = std::result::Result<View, Vec<Diagnostic>>;

/// The plate of the built-in scene from below the pane: all that is seen is light that came through it.
pub fn wavy_glass(columns: u32) -> Built {
    let scene = of_file("scenes/wavy_glass_seen.toml")?;
    let (position, look_at) = (DVec3::new(0.0, -0.8, 0.7), DVec3::new(0.0, 0.1, 0.0));
    let spec = CameraSpec::pinhole(position, look_at, DVec3::Z, 50.0, [columns, columns * 3 / 4]);
    Ok(View { name: "wavy glass", scene, spec: CameraSpec { filter: Filter::Box, ..spec }, in_beam: false })
}

/// A glass ball in a beam of its own width, and the floor behind it.
pub fn ball(columns: u32) -> Built {
    let scene = scene_toml::parse(BALL, "ball", Base::BuiltIn)?.build()?;
    let (position, look_at) = (DVec3::new(0.5, 0.0, 0.6), DVec3::new(0.22, 0.0, 0.0));
    let spec = CameraSpec::pinhole(position, look_at, DVec3::Z, 32.0, [columns, columns * 3 / 4]);
    Ok(View { name: "ball", scene, spec: CameraSpec { filter: Filter::Box, ..spec }, in_beam: true })
}

/// The metal ring as its own camera sees it, without the sky, whose mirror image on the table has no caustic.
pub fn ring(columns: u32) -> Built {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let text = std::fs::read_to_string(folder.join("ring.toml"))
        .map_err(|e| vec![Diagnostic::new(Kind::Io, e.to_string(), "scenes/ring.toml")])?;
    // The first emitter is the sun; the second, which the materials follow, is the sky.
    let sky = text.rfind("[[emitter]]").unwrap_or_default();
    let rest = text[sky..].find("[material").unwrap_or_default();
    let scene =
        scene_toml::parse(&(text[..sky].to_owned() + &text[sky + rest..]), "ring", Base::Directory(folder))?;
    let scene = scene.build()?;
    let (position, look_at) = (DVec3::new(0.02, -0.26, 0.22), DVec3::new(0.01, 0.0, 0.006));
    let spec = CameraSpec::pinhole(position, look_at, DVec3::Z, 32.0, [columns, columns * 3 / 4]);
    Ok(View { name: "ring", scene, spec: CameraSpec { filter: Filter::Box, ..spec }, in_beam: false })
}

/// A pane of uneven glass in a beam narrower than it, and the floor below it, seen from below the pane.
pub fn pane(columns: u32) -> Built {
    let scene = scene_toml::parse(PANE, "pane", Base::BuiltIn)?.build()?;
    let (position, look_at) = (DVec3::new(0.0, -0.24, 0.27), DVec3::new(0.0, 0.0, 0.0));
    let spec = CameraSpec::pinhole(position, look_at, DVec3::Z, 40.0, [columns, columns * 3 / 4]);
    Ok(View { name: "pane", scene, spec: CameraSpec { filter: Filter::Box, ..spec }, in_beam: true })
}

/// 2^m photons.
pub fn plan(m: u32, replicates: u32, seed: u64) -> Result<Plan> {
    let photons = Some(1 << m);
    Plan::new(&Settings { photons, replicates: Some(replicates), seed, ..Settings::default() })
}

const BALL: &str = r#"
[[emitter]]
name = "sun"
type = "collimated"
radius = 0.1
position = [-0.2, 0.0, 0.4]
aim = [0.2, 0.0, -0.2]
flux_lm = 1000.0

[material.glass]
type = "dielectric"
ior = 1.5

[material.floor]
type = "lambertian"
reflectance = 0.5

[[surface]]
name = "ball"
type = "sphere"
material = "glass"
center = [0.0, 0.0, 0.2]
radius = 0.1

[[surface]]
name = "floor"
type = "rectangle"
material = "floor"
corner = [-0.25, -0.25, 0.0]
edge_u = [0.75, 0.0, 0.0]
edge_v = [0.0, 0.5, 0.0]

[[receiver]]
name = "floor"
surface = "floor"
cells = [64, 64]
"#;

const PANE: &str = r#"
[[emitter]]
name = "sun"
type = "collimated"
radius = 0.2
position = [0.05, 0.0, 1.0]
aim = [-0.05, 0.0, -1.0]
flux_lm = 1000.0

[material.glass]
type = "dielectric"
ior = 1.5

[material.floor]
type = "lambertian"
reflectance = 0.5

[[surface]]
name = "top"
type = "heightfield"
material = "glass"
origin = [-0.3, -0.3, 0.32]
size = [0.6, 0.6]
cells = [64, 64]
facing = "up"
smooth = true
noise = { seed = 3, amplitude = 0.0012, octaves = [
    { amplitude = 1.00, wavelength = 0.08 },
    { amplitude = 0.30, wavelength = 0.04 },
] }

[[surface]]
name = "bottom"
type = "rectangle"
material = "glass"
corner = [-0.3, -0.3, 0.3]
edge_u = [0.0, 0.6, 0.0]
edge_v = [0.6, 0.0, 0.0]          # u x v points down, out of the glass

[[surface]]
name = "floor"
type = "rectangle"
material = "floor"
corner = [-0.4, -0.4, 0.0]
edge_u = [0.8, 0.0, 0.0]
edge_v = [0.0, 0.8, 0.0]

[[receiver]]
name = "floor"
surface = "floor"
cells = [64, 64]
"#;
