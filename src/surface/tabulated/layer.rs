//! The sampler of one lobe: a density for every incidence of the table, and their mixture between them.
//!
//! Stored is g = f cos(theta_o) at the nodes (METHOD 4). For the incidence of a photon up to four slices mix,
//! linear in theta_i and in phi_i, all in the frame of that incidence.

use std::f64::consts::PI;

use crate::error::Result;
use crate::sample::angles::Located;
use crate::sample::compact::CompactGrids;
use crate::scattering::{Frame, Lobe, Quantity};

/// The sampler of one lobe.
#[derive(Debug, Clone)]
pub(crate) struct Layer {
    pub quantity: Quantity,
    pub frame: Frame,
    /// 1 or 3.
    pub channels: usize,
    theta_i: Vec<f64>,
    phi_i: Vec<f64>,
    /// Slice of channel c at incidence k: c x incidences + k.
    pub grids: CompactGrids,
}

/// Incidences of the table and how much each counts; the weights sum to 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mix {
    parts: [(u32, f64); 4],
    length: u32,
}

impl Mix {
    /// (incidence, weight).
    #[inline(always)]
    pub fn parts(&self) -> impl Iterator<Item = (usize, f64)> {
        self.parts.iter().take(self.length as usize).map(|(incidence, weight)| (*incidence as usize, *weight))
    }

    #[inline(always)]
    fn add(&mut self, incidence: usize, weight: f64) {
        if weight > 0.0 {
            self.parts[self.length as usize & 3] = (incidence as u32, weight);
            self.length += 1;
        }
    }
}

impl Layer {
    /// The sampler of a lobe. Three equal channels become one.
    ///
    /// # Errors
    /// More nodes than a slice may have; values so large that an integral is not finite.
    pub fn new(lobe: &Lobe) -> Result<Self> {
        let rad = |angles: &[f64]| angles.iter().map(|a| a.to_radians()).collect::<Vec<f64>>();
        let polar: Vec<f64> = rad(&lobe.polar_deg).into_iter().map(|a| a.min(PI)).collect();
        let mut grids = CompactGrids::new(&polar, &rad(&lobe.azimuth_deg))?;
        let [channels, phis, thetas, ..] = lobe.counts();
        let per_channel = lobe.values.len() / channels;
        let grey = lobe.values.chunks(per_channel).all(|c| c == &lobe.values[..per_channel]);
        let channels = if grey { 1 } else { channels };
        grids.reserve(channels * phis * thetas);
        for channel in 0..channels {
            for phi in 0..phis {
                for theta in 0..thetas {
                    grids.push(&projected(lobe, channel, phi, theta))?;
                }
            }
        }
        let (theta_i, phi_i) = (rad(&lobe.theta_i_deg), rad(&lobe.phi_i_deg));
        Ok(Self { quantity: lobe.quantity, frame: lobe.frame, channels, theta_i, phi_i, grids })
    }

    /// Whether theta_i matters.
    pub fn has_angles(&self) -> bool {
        self.theta_i.len() > 1
    }

    /// Whether phi_i matters.
    pub fn has_azimuths(&self) -> bool {
        self.phi_i.len() > 1
    }

    /// Incident angles of the table, radians: (theta_i, phi_i).
    pub fn angles(&self) -> (&[f64], &[f64]) {
        (&self.theta_i, &self.phi_i)
    }

    /// Incidences of the table.
    pub fn incidences(&self) -> usize {
        self.theta_i.len() * self.phi_i.len()
    }

    /// The slices for an incidence.
    #[inline]
    pub fn mix(&self, theta: f64, phi: f64) -> Mix {
        let mut mix = Mix { parts: [(0, 0.0); 4], length: 0 };
        self.each_part(theta, phi, |incidence, weight| mix.add(incidence, weight));
        mix
    }

    /// Each incidence about this one, at most four, and its weight, which may be zero (and the incidence then
    /// none).
    #[inline(always)]
    pub fn each_part(&self, theta: f64, phi: f64, mut part: impl FnMut(usize, f64)) {
        let (i, t) = bracket(&self.theta_i, theta);
        if self.phi_i.len() == 1 {
            part(i, 1.0 - t);
            part(i + 1, t);
            return;
        }
        let (j, p) = self.azimuth_bracket(phi);
        let thetas = self.theta_i.len();
        let first = j * thetas + i;
        part(first, (1.0 - t) * (1.0 - p));
        part(first + 1, t * (1.0 - p));
        part(first + thetas, (1.0 - t) * p);
        part(first + thetas + 1, t * p);
    }

    fn azimuth_bracket(&self, phi: f64) -> (usize, f64) {
        let first = self.phi_i[0];
        let turns = libm::floor((phi - first) / (2.0 * PI));
        bracket(&self.phi_i, phi - 2.0 * PI * turns)
    }

    /// The slice of a channel at an incidence; a grey table has one channel for all.
    #[inline]
    pub fn slice(&self, channel: usize, incidence: usize) -> usize {
        if self.channels == 1 { incidence } else { channel * self.incidences() + incidence }
    }

    /// Integral of f cos(theta_o) of a channel for a mixture: the part of the light that is scattered.
    #[inline(always)]
    pub fn albedo(&self, mix: &Mix, channel: usize) -> f64 {
        let mut sum = 0.0;
        for (k, weight) in mix.parts() {
            sum += weight * self.grids.integral(self.slice(channel, k));
        }
        sum
    }

    /// g by channel for a mixture at a scattered direction.
    #[inline]
    pub fn values_at(&self, mix: &Mix, at: &Located) -> [f64; 3] {
        let of = |channel| {
            let mut sum = 0.0;
            for (k, weight) in mix.parts() {
                sum += weight * self.grids.value(self.slice(channel, k), at);
            }
            sum
        };
        if self.channels == 1 { [of(0); 3] } else { [of(0), of(1), of(2)] }
    }
}

/// (k, t): x lies the fraction t of the way from angle k to the next one; the ends hold beyond themselves.
#[inline]
fn bracket(angles: &[f64], x: f64) -> (usize, f64) {
    let above = angles.partition_point(|a| *a <= x);
    if above == 0 {
        return (0, 0.0);
    }
    if above == angles.len() {
        return (above - 1, 0.0);
    }
    let (low, high) = (angles[above - 1], angles[above]);
    (above - 1, (x - low) / (high - low))
}

/// g at the nodes of a slice; zero at and below the horizon.
fn projected(lobe: &Lobe, channel: usize, phi_i: usize, theta_i: usize) -> Vec<f64> {
    let (sin_i, cos_i) = sin_cos_deg(lobe.theta_i_deg[theta_i]);
    let azimuth: Vec<(f64, f64)> = lobe.azimuth_deg.iter().map(|a| sin_cos_deg(*a)).collect();
    let mut values = lobe.slice(channel, phi_i, theta_i).iter();
    let mut g = Vec::with_capacity(lobe.polar_deg.len() * azimuth.len());
    for polar in &lobe.polar_deg {
        let (sin, cos) = sin_cos_deg(*polar);
        for ((_, cos_azimuth), f) in azimuth.iter().zip(&mut values) {
            // cos(theta_o) = d . m; in the specular frame m = (sin theta_i, 0, cos theta_i).
            let (across, along) = match lobe.frame {
                Frame::Surface => (0.0, cos),
                Frame::Specular => (sin * cos_azimuth * sin_i, cos * cos_i),
            };
            let cos_o = across + along;
            // Below the rounding of its terms the sum is on the horizon.
            let above = cos_o > 4.0 * f64::EPSILON * (across.abs() + along.abs());
            g.push(if above { f64::from(*f) * cos_o } else { 0.0 });
        }
    }
    g
}

/// (sin, cos) of an angle in degrees, exactly zero where they vanish.
fn sin_cos_deg(angle_deg: f64) -> (f64, f64) {
    let quarters = libm::round(angle_deg / 90.0);
    let (s, c) = libm::sincos((angle_deg - 90.0 * quarters).to_radians());
    match (quarters as i64).rem_euclid(4) {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_exact_at_right_angles() {
        let expected = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)];
        for k in -9..9i32 {
            let (s, c) = sin_cos_deg(f64::from(90 * k));
            assert_eq!((s + 0.0, c + 0.0), expected[k.rem_euclid(4) as usize], "{k}");
            let (s, c) = sin_cos_deg(f64::from(90 * k) + 30.0);
            let angle = (f64::from(90 * k) + 30.0).to_radians();
            assert!((s - angle.sin()).abs() < 1e-14 && (c - angle.cos()).abs() < 1e-14);
        }
    }

    #[test]
    fn brackets_hold_beyond_the_ends() {
        let angles = [0.1, 0.2, 0.6];
        assert_eq!(bracket(&angles, 0.0), (0, 0.0));
        assert_eq!(bracket(&angles, 0.1), (0, 0.0));
        assert_eq!(bracket(&angles, 0.2), (1, 0.0));
        assert_eq!(bracket(&angles, 0.6), (2, 0.0));
        assert_eq!(bracket(&angles, 1.5), (2, 0.0));
        let (k, t) = bracket(&angles, 0.3);
        assert!(k == 1 && (t - 0.25).abs() < 1e-15);
        assert_eq!(bracket(&[0.3], 0.7), (0, 0.0));
    }
}
