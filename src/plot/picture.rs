//! A camera's picture as PNG, as on a screen, and its luminance in false colours.

use std::path::Path;

use crate::error::Result;
use crate::files::png::write_rgb8;
use crate::picture::camera::Film;
use crate::report::numbers::{digits, rounded, three_digits};
use crate::report::picture::tone;
use crate::scene::camera::CameraSpec;
use crate::surface::luminance_of;

use super::false_colour::{Axes, FalseColour, Quantity};

/// Writes the picture as a screen shows it, with the camera's exposure. `C` is 1 (luminance) or 3 (linear sRGB whose Y is
/// luminance), in cd/m2.
///
/// # Errors
/// A film whose numbers do not fit its sides; a file that cannot be written.
pub fn write_png<const C: usize>(path: &Path, spec: &CameraSpec, film: &Film<C>) -> Result<()> {
    let [width, height] = film.pixels.map(|n| n as usize);
    let tone = tone(spec, film);
    let bytes: Vec<u8> = film.value.iter().flat_map(|v| tone.display(rgb(*v)).to_srgb()).collect();
    write_rgb8(path, width, height, &bytes)
}

/// Red, green and blue of a pixel; luminance alone is grey.
fn rgb<const C: usize>(value: [f64; C]) -> [f64; 3] {
    std::array::from_fn(|c| value[c.min(C - 1)])
}

/// Writes the luminance of the picture in false colours.
///
/// # Errors
/// A file that cannot be written.
pub fn write_luminance_png<const C: usize>(
    path: &Path,
    title: &str,
    spec: &CameraSpec,
    film: &Film<C>,
) -> Result<()> {
    let values: Vec<f64> = film.value.iter().map(luminance_of).collect();
    let picture = FalseColour {
        title,
        width: film.pixels[0] as usize,
        height: film.pixels[1] as usize,
        quantity: Quantity::Luminance,
        values: &values,
        axes: Axes::None,
        points: None,
        isolux: false,
        footer: vec![
            statistics_line(&values),
            format!(
                "white of the picture: {} cd/m2    {}",
                digits(tone(spec, film).white_cd_m2),
                error_line(film, &values)
            ),
        ],
    };
    picture.render().write_png(path)
}

/// Minimum, mean and maximum of the pixels that have a value, noise included.
fn statistics_line(values: &[f64]) -> String {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let count = finite().count();
    if count == 0 {
        return "no values".to_owned();
    }
    let min = finite().fold(f64::INFINITY, f64::min);
    let max = finite().fold(f64::NEG_INFINITY, f64::max);
    let mean = finite().map(|v| v / count as f64).sum::<f64>();
    let [min, mean, max] = [min, mean, max].map(three_digits);
    format!("min {min} cd/m2    mean {mean} cd/m2    max {max} cd/m2")
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::png::read_rgb8;
    use crate::scene::camera::Exposure;
    use glam::DVec3;

    #[test]
    fn luminance_alone_is_a_grey_picture() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("camera.png");
        let mut spec = CameraSpec::pinhole(DVec3::new(0.0, -2.0, 1.0), DVec3::ZERO, DVec3::Z, 40.0, [3, 2]);
        spec.exposure = Exposure::White(5.0);
        let film = Film {
            pixels: [3, 2],
            value: (0..6).map(|i| [f64::from(i)]).collect(),
            standard_error: vec![f64::NAN, 0.25, 0.5, 0.75, 1.0, 1.25],
            bias: vec![0.0; 6],
        };
        write_png(&path, &spec, &film).unwrap();
        let (size, bytes) = read_rgb8(&path);
        assert_eq!(size, [3, 2]);
        // 0, 0.2, ... 1 of white by IEC 61966-2-1.
        assert_eq!(bytes, [0, 124, 170, 203, 231, 255].map(|c| [c; 3]).concat());
        write_luminance_png(&path, "camera", &spec, &film).unwrap();
        read_rgb8(&path);
    }
}
