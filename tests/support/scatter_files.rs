//! FRED and Speos text tables, just enough to compare the same samples in several formats; MERL files from formulas.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use caustix::files::bsdf::merl;

use super::data;

/// The folder of real scattering files, where there are any.
pub fn real_folder() -> Option<PathBuf> {
    Some(data::real_folder()?.join("brdf"))
}

/// One incidence of a FRED list: its polar angle and (theta, phi, f) of every row, degrees and 1/sr.
pub type FredBlock = (f64, Vec<[f64; 3]>);

/// Reads `type bsdf_data`: two words are an incidence (polar angle, azimuth), three a row.
pub fn read_fred(path: &Path) -> Vec<FredBlock> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("type bsdf_data"));
    assert_eq!(lines.next(), Some("format angles=deg bsdf=value scale=1"));
    let mut blocks: Vec<FredBlock> = Vec::new();
    for line in lines {
        let numbers: Vec<f64> = line.split_whitespace().map(|w| w.parse().unwrap()).collect();
        match numbers[..] {
            [incidence, 0.0] => blocks.push((incidence, Vec::new())),
            [theta, phi, f] => blocks.last_mut().unwrap().1.push([theta, phi, f]),
            _ => panic!("{line}"),
        }
    }
    blocks
}

/// A Speos anisotropic table: incidences, percentage, and for each incidence (theta, phi, values [theta][phi]).
pub struct Speos {
    pub incidences: Vec<f64>,
    pub percent: f64,
    pub blocks: Vec<(Vec<f64>, Vec<f64>, Vec<f64>)>,
}

/// Reads the text form, version 8, of one reflection with one anisotropy angle.
pub fn read_speos(path: &Path) -> Speos {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    assert!(lines.next().unwrap().starts_with("OPTIS - Anisotropic BSDF surface file"));
    // Text or binary, comment, length of the description, description, anisotropy vector, reflection and transmission, kind of
    // value, one anisotropy angle, that angle.
    let head: Vec<&str> = lines.by_ref().take(9).collect();
    assert_eq!((head[0], head[5], head[6], head[7]), ("0", "1\t0", "1", "1"));
    let numbers = |line: &str| -> Vec<f64> { line.split_whitespace().map(|w| w.parse().unwrap()).collect() };
    let count = numbers(lines.next().unwrap())[0] as usize;
    let incidences = numbers(lines.next().unwrap());
    assert_eq!(incidences.len(), count);
    // Angles of the spectrum's measurement, its description, and the percentages by wavelength.
    let spectrum: Vec<&str> = lines.by_ref().take(5).collect();
    assert_eq!(spectrum[2], "2");
    let percent = numbers(spectrum[3])[1];
    let mut blocks = Vec::new();
    while let Some(sizes) = lines.next().filter(|l| *l != "End of file") {
        let sizes = numbers(sizes);
        let phi = numbers(lines.next().unwrap());
        assert_eq!(phi.len(), sizes[1] as usize);
        let (mut theta, mut values) = (Vec::new(), Vec::new());
        for row in lines.by_ref().take(sizes[0] as usize) {
            let row = numbers(row);
            theta.push(row[0]);
            values.extend(&row[1..]);
        }
        assert_eq!(values.len(), theta.len() * phi.len());
        blocks.push((theta, phi, values));
    }
    assert_eq!(blocks.len(), count);
    Speos { incidences, percent, blocks }
}

/// The bytes of a MERL file whose bins hold f(theta_h, theta_d, bin of theta_d): red, green, blue in 1/sr; angles in radians.
pub fn merl_file(f: impl Fn(f64, f64, usize) -> [f64; 3]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(merl::FILE_BYTES);
    for count in [90u32, 90, 180] {
        bytes.extend(count.to_le_bytes());
    }
    let scales = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
    let degree = PI / 180.0;
    for channel in 0..3 {
        for h in 0..90 {
            let x = (f64::from(h) + 0.5) / 90.0;
            for d in 0..90 {
                let rgb = f(0.5 * PI * x * x, (f64::from(d) + 0.5) * degree, d as usize);
                for _ in 0..180 {
                    bytes.extend((rgb[channel] / scales[channel]).to_le_bytes());
                }
            }
        }
    }
    bytes
}
