//! Reader of MERL `.binary` files: isotropic reflection in half and difference angles (Matusik, Pfister, Brand, McMillan, "A
//! data-driven reflectance model", SIGGRAPH 2003).
//!
//! Three 32-bit counts, 90 90 180, then doubles, little endian, of red, green and blue in turn: index phi_d + 180 (theta_d + 90
//! theta_h). theta_h = 90 (i/90)^2 degrees, theta_d and phi_d one degree a bin; phi_d runs over half a turn, the
//! other half is the same by reciprocity. Scales: 1/1500, 1.15/1500, 1.66/1500. Negative values were not measured.
//!
//! A photon needs a table over incident and scattered angles, so the file is resampled to the specular frame: 21 incident
//! angles from 0 to 89 degrees, 50 polar angles (a quarter of a degree near the specular direction, where the file's own bins are
//! finest, 5 degrees beyond 20) and azimuths every 5 degrees, linearly between the middles of the file's bins; bins that were
//! not measured are left out of the mean, and what only such bins surround becomes zero and is counted in a warning.

use libm::{acos, atan2, cos, sin};

use crate::error::{Diagnostic, Kind, Result};
use crate::scattering::{Frame, LobeData, LobeSide, Quantity, ScatterTable};

const THETA_H: usize = 90;
const THETA_D: usize = 90;
const PHI_D: usize = 180;
const BINS: usize = THETA_H * THETA_D * PHI_D;
const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// Bytes of a file.
pub const FILE_BYTES: usize = 12 + 3 * 8 * BINS;

/// Whether the bytes begin as a MERL file does.
pub(crate) fn is_merl(bytes: &[u8]) -> bool {
    bytes.get(..12).is_some_and(|b| counts(b) == [THETA_H, THETA_D, PHI_D])
}

fn counts(header: &[u8]) -> Vec<usize> {
    header.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes) as usize).collect()
}

/// Reads the bytes of a file; `name` is the table's name.
///
/// # Errors
/// [`Kind::Syntax`] for other counts, [`Kind::Missing`] or [`Kind::Limit`] for another length, [`Kind::Range`] for a value
/// that is not finite.
pub fn parse(bytes: &[u8], name: &str) -> Result<ScatterTable> {
    if !is_merl(bytes) {
        let found = match bytes.get(..12) {
            Some(header) => format!("counts {:?}", counts(header)),
            None => format!("{} bytes", bytes.len()),
        };
        return Err(Diagnostic::new(Kind::Syntax, found, "counts 90 90 180, 32-bit little endian"));
    }
    if bytes.len() != FILE_BYTES {
        let kind = if bytes.len() < FILE_BYTES { Kind::Missing } else { Kind::Limit };
        return Err(Diagnostic::new(kind, format!("{} bytes", bytes.len()), format!("{FILE_BYTES} bytes")));
    }
    let file = Bins(bytes[12..].as_chunks().0);
    let storable = |v: f64| v.is_finite() && v * SCALES[2] < f64::from(f32::MAX);
    if let Some(bad) = (0..3 * BINS).find(|i| !storable(file.raw(0, *i))) {
        let found = format!("{} at byte {}", file.raw(0, bad), 12 + 8 * bad);
        return Err(Diagnostic::new(Kind::Range, found, "finite values that single precision holds"));
    }
    let (theta_i, polar, azimuth) = (theta_i_deg(), polar_deg(), steps(0.0, 5.0, 73));
    let mut values = vec![0.0f32; 3 * theta_i.len() * polar.len() * azimuth.len()];
    let nodes = values.len() / 3;
    let (mut at, mut unmeasured) = (0, 0usize);
    for &incidence in &theta_i {
        for &p in &polar {
            for &a in &azimuth {
                if let Some(angles) = half_difference(incidence, p, a) {
                    match file.interpolate(angles) {
                        Some(rgb) => (0..3).for_each(|c| values[c * nodes + at] = rgb[c] as f32),
                        None => unmeasured += 1,
                    }
                }
                at += 1;
            }
        }
    }
    let mut warnings = Vec::new();
    if unmeasured > 0 {
        let found = format!("{unmeasured} of {nodes} directions that were not measured");
        let d = Diagnostic::new(Kind::Missing, found, "measured values above the horizon");
        warnings.push(d.hint("they are taken as zero"));
    }
    let data = LobeData {
        quantity: Quantity::Reflection,
        side: LobeSide::Both,
        frame: Frame::Specular,
        theta_i_deg: theta_i,
        phi_i_deg: vec![0.0],
        polar_deg: polar,
        azimuth_deg: azimuth,
        channels: 3,
        values,
        declared_tis: vec![],
    };
    ScatterTable::new(name, vec![data], warnings)
}

fn steps(first: f64, step: f64, n: u32) -> Vec<f64> {
    (0..n).map(|i| first + step * f64::from(i)).collect()
}

fn theta_i_deg() -> Vec<f64> {
    [steps(0.0, 5.0, 17), vec![82.5, 85.0, 87.5, 89.0]].concat()
}

fn polar_deg() -> Vec<f64> {
    let fine = [steps(0.0, 0.25, 4), steps(1.0, 0.5, 4), steps(3.0, 1.0, 4)].concat();
    [fine, vec![8.0, 10.0, 12.5, 15.0, 17.5], steps(20.0, 5.0, 33)].concat()
}

/// theta_h, theta_d and phi_d in radians of a direction of the specular frame; `None` below the horizon.
fn half_difference(theta_i_deg: f64, polar_deg: f64, azimuth_deg: f64) -> Option<[f64; 3]> {
    let (ti, p, a) = (theta_i_deg.to_radians(), polar_deg.to_radians(), azimuth_deg.to_radians());
    // wi lies in the half plane of -x. s = (sin ti, 0, cos ti) is its mirrored direction. Azimuth 0 about s is along
    // e = (-cos ti, 0, sin ti), azimuth 90 along s x e = (0, -1, 0).
    let wi = [-sin(ti), 0.0, cos(ti)];
    let (along, up, across) = (cos(p), sin(p) * cos(a), sin(p) * sin(a));
    let wo = [along * sin(ti) - up * cos(ti), -across, along * cos(ti) + up * sin(ti)];
    if wo[2] < 0.0 {
        return None;
    }
    let h = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
    let length = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]).sqrt();
    if length <= 0.0 {
        return None;
    }
    let h = h.map(|x| x / length);
    let theta_h = acos(h[2].clamp(-1.0, 1.0));
    let phi_h = atan2(h[1], h[0]);
    // wi turned by -phi_h about the normal, then by -theta_h about y: the difference vector.
    let (x, y) = (wi[0] * cos(phi_h) + wi[1] * sin(phi_h), wi[1] * cos(phi_h) - wi[0] * sin(phi_h));
    let d = [x * cos(theta_h) - wi[2] * sin(theta_h), y, x * sin(theta_h) + wi[2] * cos(theta_h)];
    Some([theta_h, acos(d[2].clamp(-1.0, 1.0)), atan2(d[1], d[0])])
}

/// The doubles of a file.
struct Bins<'a>(&'a [[u8; 8]]);

impl Bins<'_> {
    fn raw(&self, channel: usize, bin: usize) -> f64 {
        f64::from_le_bytes(self.0[channel * BINS + bin])
    }

    /// Red, green and blue, 1/sr: linear between the middles of the bins, those not measured left out.
    fn interpolate(&self, [theta_h, theta_d, phi_d]: [f64; 3]) -> Option<[f64; 3]> {
        let quarter = std::f64::consts::FRAC_PI_2;
        let two_bins = |x: f64, n: usize| {
            let x = (x - 0.5).clamp(0.0, (n - 1) as f64);
            let low = (x as usize).min(n - 2);
            [(low, 1.0 - (x - low as f64)), (low + 1, x - low as f64)]
        };
        let h = two_bins((theta_h / quarter).max(0.0).sqrt() * THETA_H as f64, THETA_H);
        let d = two_bins(theta_d / quarter * THETA_D as f64, THETA_D);
        let place = (phi_d / std::f64::consts::PI * PHI_D as f64 - 0.5).rem_euclid(PHI_D as f64);
        let low = (place as usize).min(PHI_D - 1);
        let phi = [(low, 1.0 - (place - low as f64)), ((low + 1) % PHI_D, place - low as f64)];
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for (i, wh) in h {
            for (j, wd) in d {
                for (k, wp) in phi {
                    let bin = k + PHI_D * (j + THETA_D * i);
                    let rgb = [self.raw(0, bin), self.raw(1, bin), self.raw(2, bin)];
                    if rgb.iter().all(|v| *v >= 0.0) {
                        let weight = wh * wd * wp;
                        weights += weight;
                        (0..3).for_each(|c| sum[c] += weight * rgb[c] * SCALES[c]);
                    }
                }
            }
        }
        (weights > 0.0).then(|| sum.map(|s| s / weights))
    }
}
