//! A camera's picture as EXR, with everything needed to repeat it.

use std::path::Path;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::exr::{Channel, Light, Value, floats, write_maps};
use crate::picture::camera::Film;
use crate::run::Plan;
use crate::scene::Scene;
use crate::scene::camera::{Bandwidth, CameraSpec, Exposure, Method};
use crate::surface::luminance_of;

use super::attributes::run_attributes;
use super::colour::tone::Tone;

/// The exposure of a picture: as its camera asks for it.
pub fn tone<const C: usize>(spec: &CameraSpec, film: &Film<C>) -> Tone {
    Tone::of_camera(spec, film.value.iter().map(luminance_of))
}

/// Writes a camera's picture as EXR: `R`, `G`, `B` (C = 3, linear sRGB whose Y is luminance) or `Y` (C = 1), `standard_error`
/// and `bias` of the luminance, all in cd/m2. `attributes` go beside those of the picture itself: [`camera_attributes`], and
/// what else is to be said.
///
/// # Errors
/// A film whose numbers do not fit its sides; a number beyond a 32-bit float; a file that cannot be written.
pub fn write_exr<const C: usize>(
    path: &Path,
    spec: &CameraSpec,
    film: &Film<C>,
    attributes: &[(String, Value)],
) -> Result<()> {
    let [width, height] = film.pixels.map(|n| n as usize);
    let pixels = film.value.len();
    if width * height != pixels || film.standard_error.len() != pixels || film.bias.len() != pixels {
        let found = format!("{pixels} pixels of a picture of {width} x {height}");
        return Err(Diagnostic::new(Kind::Range, found, "one value, error and bias for each pixel"));
    }
    let names: &[&'static str] = if C == 1 { &["Y"] } else { &["R", "G", "B"] };
    let mut planes: Vec<(&str, Vec<f32>)> = Vec::new();
    let mut plane = |name: &'static str, values: &mut dyn Iterator<Item = f64>| -> Result<()> {
        planes.push((name, floats(values).map_err(|e| e.in_file(path))?));
        Ok(())
    };
    for (c, name) in names.iter().enumerate() {
        plane(name, &mut film.value.iter().map(|v| v[c]))?;
    }
    plane("standard_error", &mut film.standard_error.iter().copied())?;
    plane("bias", &mut film.bias.iter().copied())?;
    let channels: Vec<Channel<'_>> = planes.iter().map(|(name, data)| Channel { name, data }).collect();
    let attributes = [attributes, &picture_attributes(&tone(spec, film))].concat();
    write_maps(path, [width, height], &channels, &attributes, Light::Luminance)
}

fn picture_attributes(tone: &Tone) -> Vec<(String, Value)> {
    let text = |name: &str, value: &str| (name.to_string(), Value::Text(value.to_string()));
    vec![
        text("caustix.quantity", "luminance; colours are linear sRGB (ITU-R BT.709) whose Y is luminance"),
        text("caustix.unit", "cd/m2"),
        text("caustix.unit.standard_error", "cd/m2"),
        text("caustix.unit.bias", "cd/m2"),
        text("caustix.layout", "row 0, column 0 is the top left pixel"),
        ("caustix.png.white_cd_m2".to_string(), Value::F64(tone.white_cd_m2)),
        ("caustix.png.filmic".to_string(), Value::I64(i64::from(tone.filmic))),
    ]
}

/// What the EXR of a camera says about its run and itself: everything needed to repeat it. `photons` and `replicates` are
/// those that the picture stands for.
pub fn camera_attributes(
    scene: &Scene,
    plan: &Plan,
    photons: u64,
    replicates: u32,
    spec: &CameraSpec,
) -> Vec<(String, Value)> {
    let mut all = run_attributes(scene, plan, photons, replicates);
    let mut add = |name: &str, value: Value| all.push((format!("caustix.camera.{name}"), value));
    for (name, v) in [("position_m", spec.position), ("forward", spec.forward), ("up", spec.up)] {
        for (axis, x) in ["x", "y", "z"].into_iter().zip(v.to_array()) {
            add(&format!("{name}.{axis}"), Value::F64(x));
        }
    }
    add("fov_deg", Value::F64(spec.fov_deg));
    add("samples", Value::I64(i64::from(spec.samples)));
    add("lens_radius_m", Value::F64(spec.lens_radius_m));
    add("focus_m", Value::F64(spec.focus_m));
    let mut word = |name: &str, value: &str| add(name, Value::Text(value.to_string()));
    word("method", spec.method.word());
    word("filter", spec.filter.word());
    word("exposure", if spec.exposure == Exposure::Auto { "auto" } else { "given" });
    if spec.method == Method::Map {
        word("kernel", spec.kernel.word());
        match spec.bandwidth {
            Bandwidth::Automatic => word("bandwidth", "automatic"),
            Bandwidth::Radius(r) => add("radius_m", Value::F64(r)),
            Bandwidth::AtLeast { radius_m, neighbours } => {
                add("radius_m", Value::F64(radius_m));
                add("nearest", Value::I64(i64::from(neighbours)));
            }
            Bandwidth::Nearest(k) => add("nearest", Value::I64(i64::from(k))),
            Bandwidth::Progressive(r) => add("progressive_radius_m", Value::F64(r)),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::exr::maps::{Attribute, Maps, Samples, read_maps};
    use glam::DVec3;

    fn spec() -> CameraSpec {
        CameraSpec::pinhole(DVec3::new(0.0, -2.0, 1.0), DVec3::ZERO, DVec3::Z, 40.0, [3, 2])
    }

    fn film<const C: usize>(value: impl Fn(usize) -> [f64; C]) -> Film<C> {
        Film {
            pixels: [3, 2],
            value: (0..6).map(value).collect(),
            standard_error: (0..6).map(|i| if i == 0 { f64::NAN } else { 0.25 * f64::from(i) }).collect(),
            bias: (0..6).map(|i| -0.5 * f64::from(i)).collect(),
        }
    }

    fn floats(maps: &Maps, name: &str) -> Vec<f32> {
        match &maps.channels.iter().find(|(n, _)| n == name).unwrap().1 {
            Samples::F32(values) => values.clone(),
            Samples::U32(_) => panic!("{name}"),
        }
    }

    #[test]
    fn colours_errors_and_bias_come_back_and_the_format_s_own_attributes_are_set() {
        let directory = tempfile::tempdir().unwrap();
        let film = film(|i| [2.0 * i as f64, i as f64, 0.5 * i as f64]);
        let path = directory.path().join("camera.exr");
        write_exr(&path, &spec(), &film, &[]).unwrap();
        let maps = read_maps(&path).unwrap();
        assert_eq!((maps.width, maps.height), (3, 2));
        let names: Vec<&str> = maps.channels.iter().map(|(n, _)| n.as_str()).collect();
        assert_eq!(names, ["B", "G", "R", "bias", "standard_error"]);
        assert_eq!(floats(&maps, "R"), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(floats(&maps, "B"), [0.0, 0.5, 1.0, 1.5, 2.0, 2.5]);
        assert_eq!(floats(&maps, "bias")[5], -2.5);
        assert!(floats(&maps, "standard_error")[0].is_nan());
        assert_eq!(maps.attributes["caustix.unit"], Attribute::Text("cd/m2".into()));
        let meta = ::exr::meta::MetaData::read_from_file(&path, true).unwrap();
        let header = &meta.headers[0];
        assert_eq!(header.own_attributes.white_luminance, Some(1.0));
        let primaries = header.shared_attributes.chromaticities.unwrap();
        assert_eq!((primaries.red.0, primaries.white.1), (0.64, 0.3290));
    }

    #[test]
    fn luminance_alone_is_one_channel() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("camera.exr");
        let spec = CameraSpec { exposure: Exposure::White(5.0), ..spec() };
        write_exr(&path, &spec, &film(|i| [i as f64]), &[]).unwrap();
        let maps = read_maps(&path).unwrap();
        assert_eq!(floats(&maps, "Y"), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(maps.attributes["caustix.png.white_cd_m2"], Attribute::Number(5.0));
    }

    #[test]
    fn a_film_of_another_size_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        let mut wrong = film(|i| [i as f64]);
        wrong.bias.pop();
        let error = write_exr(&directory.path().join("camera.exr"), &spec(), &wrong, &[]).unwrap_err();
        assert_eq!(error.kind(), Kind::Range);
        assert!(std::fs::read_dir(directory.path()).unwrap().next().is_none());
    }
}
