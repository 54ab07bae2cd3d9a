//! The scattering function of a lobe at any pair of directions, by the interpolation rule of [`super::table`].

use std::f64::consts::PI;

use glam::DVec3;
use libm::{atan2, cos, sin};

use super::integral::node_cosine;
use super::{Frame, Lobe, Quantity};

/// f in 1/sr of one channel. wi and wo are unit vectors that point away from the surface, in the local frame of the side the
/// light comes from: z the normal there, x the surface's reference direction. Zero where wo is not on the lobe's side.
///
/// g = f cos(theta_o) is interpolated: bilinear within a slice, at the scattered angles of the actual incidence; linear
/// between the slices of theta_i and phi_i around it, the first and last theta_i holding beyond themselves.
pub fn value(lobe: &Lobe, channel: usize, wi: DVec3, wo: DVec3) -> f64 {
    let cos_o = match lobe.quantity {
        Quantity::Reflection => wo.z,
        Quantity::Transmission => -wo.z,
    };
    if wi.z <= 0.0 || cos_o <= 0.0 {
        return 0.0;
    }
    let across = (wi.x * wi.x + wi.y * wi.y).sqrt();
    let theta_i = atan2(across, wi.z);
    // At normal incidence the azimuth is free; 0 is what t is taken for there.
    let phi_i = if across > 0.0 { atan2(wi.y, wi.x).to_degrees() } else { 0.0 };
    let (polar, azimuth) = scattered_angles(lobe, wi, wo, theta_i, across);
    let thetas = between(&lobe.theta_i_deg, theta_i.to_degrees());
    // Of an isotropic lobe this is its one phi_i.
    let phis = between(&lobe.phi_i_deg, wrap(&lobe.phi_i_deg, phi_i));
    let mut g = 0.0;
    for (phi, of_phi) in phis {
        for (theta, of_theta) in thetas {
            if of_phi * of_theta > 0.0 {
                g += of_phi * of_theta * slice_value(lobe, channel, phi, theta, polar, azimuth);
            }
        }
    }
    g / cos_o
}

/// Polar angle and azimuth of wo in the lobe's frame, degrees.
fn scattered_angles(lobe: &Lobe, wi: DVec3, wo: DVec3, theta_i: f64, across: f64) -> (f64, f64) {
    let n = DVec3::Z;
    let t = if across > 0.0 { DVec3::new(-wi.x, -wi.y, 0.0) / across } else { DVec3::NEG_X };
    let m = if lobe.quantity == Quantity::Reflection { n } else { -n };
    let (pole, zero, ninety) = match lobe.frame {
        Frame::Surface => (m, t, n.cross(t)),
        Frame::Specular => {
            let (sin_i, cos_i) = (sin(theta_i), cos(theta_i));
            let s = t * sin_i + m * cos_i;
            let zero = m * sin_i - t * cos_i;
            (s, zero, s.cross(zero))
        }
    };
    let (x, y) = (wo.dot(zero), wo.dot(ninety));
    (atan2((x * x + y * y).sqrt(), wo.dot(pole)).to_degrees(), atan2(y, x).to_degrees())
}

/// g of one slice at scattered angles in degrees.
fn slice_value(lobe: &Lobe, channel: usize, phi_i: usize, theta_i: usize, polar: f64, azimuth: f64) -> f64 {
    let polars = &lobe.polar_deg;
    if polar < polars[0] || polar > polars[polars.len() - 1] {
        return 0.0;
    }
    let slice = lobe.slice(channel, phi_i, theta_i);
    let azimuths = &lobe.azimuth_deg;
    let (rows, columns) = (between(polars, polar), between(azimuths, wrap(azimuths, azimuth)));
    let mut g = 0.0;
    for (i, of_row) in rows {
        for (j, of_column) in columns {
            let cosine = node_cosine(lobe.frame, lobe.theta_i_deg[theta_i], polars[i], azimuths[j]);
            g += of_row * of_column * f64::from(slice[i * azimuths.len() + j]) * cosine.max(0.0);
        }
    }
    g
}

/// The two nodes around x with their weights; the first or the last alone beyond them.
pub fn between(nodes: &[f64], x: f64) -> [(usize, f64); 2] {
    let last = nodes.len() - 1;
    let after = nodes.partition_point(|n| *n <= x);
    if after == 0 {
        return [(0, 1.0), (0, 0.0)];
    }
    if after > last {
        return [(last, 1.0), (last, 0.0)];
    }
    let far = (x - nodes[after - 1]) / (nodes[after] - nodes[after - 1]);
    [(after - 1, 1.0 - far), (after, far)]
}

/// An azimuth in degrees within the turn that the nodes span.
fn wrap(turn: &[f64], azimuth: f64) -> f64 {
    let first = turn[0];
    (first + (azimuth - first).rem_euclid(360.0)).min(turn[turn.len() - 1])
}

/// The unit vector of polar angle and azimuth, radians.
pub(super) fn direction(theta: f64, phi: f64) -> DVec3 {
    debug_assert!((0.0..=PI).contains(&theta));
    DVec3::new(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta))
}
