//! The files of a camera: luminance as EXR, the picture as PNG, on request its luminance in false colours.

use std::path::Path;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::exr::{Channel, Data, Light, Value, write_maps};
use crate::files::png::write_rgb8;
use crate::picture::camera::Film;
use crate::plot::false_colour::{FalseColour, Quantity};
use crate::plot::scale::Scale;
use crate::plot::tone::Tone;
use crate::run::Plan;
use crate::scene::Scene;
use crate::scene::camera::{Bandwidth, CameraSpec, Exposure, Method};
use crate::surface::luminance_of;

use super::attributes::run_attributes;
use super::text::{digits, rounded};

/// Writes `NAME.exr`, `NAME.png` and, where the camera asks for it, `NAME_luminance.png` into a directory that exists; their
/// names. `C` is 1 (luminance) or 3 (linear sRGB whose Y is luminance), in cd/m2. `attributes` go into the EXR beside those of
/// the picture itself: [`camera_attributes`], and what else is to be said (bandwidths chosen, passes made).
///
/// EXR channels: `R`, `G`, `B` (C = 3) or `Y` (C = 1), `standard_error` and `bias` of the luminance, all in cd/m2.
///
/// # Errors
/// A film whose numbers do not fit its sides; a file that cannot be written; files written before it stay.
pub fn write_camera<const C: usize>(
    directory: &Path,
    name: &str,
    spec: &CameraSpec,
    film: &Film<C>,
    attributes: &[(String, Value)],
) -> Result<Vec<String>> {
    let [width, height] = film.pixels.map(|n| n as usize);
    let pixels = film.value.len();
    if width * height != pixels || film.standard_error.len() != pixels || film.bias.len() != pixels {
        let found = format!("{pixels} pixels of a picture of {width} x {height}");
        return Err(Diagnostic::new(Kind::Range, found, "one value, error and bias for each pixel"));
    }
    let tone = Tone::of_camera(spec, film.value.iter().map(luminance_of));
    let mut files = vec![format!("{name}.exr"), format!("{name}.png")];
    write_exr(&directory.join(&files[0]), film, &[attributes, &picture_attributes(&tone)].concat())?;
    let bytes: Vec<u8> = film.value.iter().flat_map(|v| tone.display(rgb(*v)).to_srgb()).collect();
    write_rgb8(directory.join(&files[1]), width, height, &bytes)?;
    if spec.false_colour {
        let file = format!("{name}_luminance.png");
        write_false_colour(&directory.join(&file), name, film, &tone)?;
        files.push(file);
    }
    Ok(files)
}

/// Red, green and blue of a pixel; luminance alone is grey.
fn rgb<const C: usize>(value: [f64; C]) -> [f64; 3] {
    std::array::from_fn(|c| value[c.min(C - 1)])
}

fn write_exr<const C: usize>(path: &Path, film: &Film<C>, attributes: &[(String, Value)]) -> Result<()> {
    let floats = |values: &mut dyn Iterator<Item = f64>| -> Vec<f32> { values.map(|v| v as f32).collect() };
    let channel = |c: usize| floats(&mut film.value.iter().map(|v| v[c]));
    let colours: Vec<Vec<f32>> = (0..C).map(channel).collect();
    let names: &[&str] = if C == 1 { &["Y"] } else { &["R", "G", "B"] };
    let error = floats(&mut film.standard_error.iter().copied());
    let bias = floats(&mut film.bias.iter().copied());
    let mut channels: Vec<Channel<'_>> =
        names.iter().zip(&colours).map(|(name, data)| Channel { name, data: Data::F32(data) }).collect();
    channels.push(Channel { name: "standard_error", data: Data::F32(&error) });
    channels.push(Channel { name: "bias", data: Data::F32(&bias) });
    write_maps(path, film.pixels.map(|n| n as usize), &channels, attributes, Light::Luminance)
}

fn write_false_colour<const C: usize>(path: &Path, name: &str, film: &Film<C>, tone: &Tone) -> Result<()> {
    let values: Vec<f64> = film.value.iter().map(luminance_of).collect();
    let picture = FalseColour {
        title: name,
        width: film.pixels[0] as usize,
        height: film.pixels[1] as usize,
        quantity: Quantity::Luminance,
        values: &values,
        size_m: None,
        scale: Scale::Auto,
        isolux: false,
        footer: vec![format!(
            "white of the picture: {} cd/m2    {}",
            digits(tone.white_cd_m2),
            error_line(film, &values)
        )],
    };
    picture.write_png(path)
}

/// Root mean square of the standard error, of the mean luminance.
fn error_line<const C: usize>(film: &Film<C>, luminances: &[f64]) -> String {
    let known: Vec<f64> = film.standard_error.iter().copied().filter(|e| e.is_finite()).collect();
    let mean = luminances.iter().sum::<f64>() / luminances.len() as f64;
    if known.is_empty() || mean.is_nan() || mean <= 0.0 {
        return "no standard error".to_string();
    }
    let rms = (known.iter().map(|e| e * e).sum::<f64>() / known.len() as f64).sqrt();
    format!("pixel error {} % of the mean (rms)", rounded(100.0 * rms / mean, 3))
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
    use ::image::ImageReader;
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
        let files = write_camera(directory.path(), "camera", &spec(), &film, &[]).unwrap();
        assert_eq!(files, ["camera.exr", "camera.png"]);
        let path = directory.path().join("camera.exr");
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
    fn luminance_alone_is_one_channel_and_a_grey_picture() {
        let directory = tempfile::tempdir().unwrap();
        let spec = CameraSpec { exposure: Exposure::White(5.0), false_colour: true, ..spec() };
        let files = write_camera(directory.path(), "camera", &spec, &film(|i| [i as f64]), &[]).unwrap();
        assert_eq!(files, ["camera.exr", "camera.png", "camera_luminance.png"]);
        let maps = read_maps(directory.path().join("camera.exr")).unwrap();
        assert_eq!(floats(&maps, "Y"), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(maps.attributes["caustix.png.white_cd_m2"], Attribute::Number(5.0));
        let png = ImageReader::open(directory.path().join("camera.png")).unwrap().decode().unwrap().to_rgb8();
        assert_eq!(png.dimensions(), (3, 2));
        // 0, 0.2, ... 1 of white by IEC 61966-2-1.
        let codes: Vec<[u8; 3]> = png.pixels().map(|p| p.0).collect();
        assert_eq!(codes, [0, 124, 170, 203, 231, 255].map(|c| [c; 3]));
        let coloured = ImageReader::open(directory.path().join("camera_luminance.png")).unwrap();
        assert!(coloured.decode().is_ok());
    }

    #[test]
    fn a_film_of_another_size_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        let mut wrong = film(|i| [i as f64]);
        wrong.bias.pop();
        let error = write_camera(directory.path(), "camera", &spec(), &wrong, &[]).unwrap_err();
        assert_eq!(error.kind(), Kind::Range);
        assert!(std::fs::read_dir(directory.path()).unwrap().next().is_none());
    }
}
