//! What is drawn of a scattering table: intensity in the plane of incidence, for light from a few directions.

use glam::DVec3;

use crate::plot::page::curve_angles;
use crate::scattering::value::value;
use crate::scattering::{Frame, Lobe, Quantity};
use crate::units::LUMINANCE_OF_RGB;

/// Incidences that are looked for, degrees; the table's nearest are drawn.
pub const WANTED_DEG: [f64; 4] = [0.0, 30.0, 60.0, 80.0];

/// Points of a curve in a degree; the table's own angles are added.
const PER_DEGREE: i32 = 2;

/// Scattered intensity in the plane of incidence, for light from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Slice {
    /// Incident polar angle, degrees.
    pub theta_i_deg: f64,
    /// Incident azimuth, degrees; `None` where the table is isotropic.
    pub phi_i_deg: Option<f64>,
    /// Which way the light goes.
    pub quantity: Quantity,
    /// (angle from the normal of the side light leaves on, degrees, positive forwards; candela per lumen).
    pub points: Vec<(f64, f64)>,
}

impl Slice {
    /// The largest intensity.
    pub fn max(&self) -> f64 {
        self.points.iter().map(|p| p.1).fold(0.0, f64::max)
    }
}

/// The slices of a lobe that are drawn: at most four incident polar angles, in the first plane of an anisotropic surface
/// and in the one across it.
pub fn slices(lobe: &Lobe) -> Vec<Slice> {
    let thetas = nearest(&lobe.theta_i_deg, &WANTED_DEG);
    let azimuths: &[f64] = if lobe.is_isotropic() { &[0.0] } else { &[0.0, 90.0] };
    let first = lobe.phi_i_deg[0];
    let phis = nearest(&lobe.phi_i_deg, &azimuths.iter().map(|a| a + first).collect::<Vec<_>>());
    let slice = |phi: usize, theta: usize| Slice {
        theta_i_deg: lobe.theta_i_deg[theta],
        phi_i_deg: (!lobe.is_isotropic()).then(|| lobe.phi_i_deg[phi]),
        quantity: lobe.quantity,
        points: in_plane(lobe, phi, theta),
    };
    phis.iter().flat_map(|phi| thetas.iter().map(move |theta| slice(*phi, *theta))).collect()
}

/// Indices of the angles nearest to the wanted ones, each once, rising.
fn nearest(angles_deg: &[f64], wanted_deg: &[f64]) -> Vec<usize> {
    let distance = |i: usize, wanted: f64| (angles_deg[i] - wanted).abs();
    let mut chosen: Vec<usize> = wanted_deg
        .iter()
        .filter_map(|w| (0..angles_deg.len()).min_by(|a, b| distance(*a, *w).total_cmp(&distance(*b, *w))))
        .collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// (signed angle, candela per lumen) in the plane of incidence; luminance of colours.
fn in_plane(lobe: &Lobe, phi_i: usize, theta_i: usize) -> Vec<(f64, f64)> {
    let theta_i_deg = lobe.theta_i_deg[theta_i];
    // At normal incidence the table's azimuths are the limit from larger angles.
    let theta = theta_i_deg.to_radians().max(f64::EPSILON);
    let phi = lobe.phi_i_deg[phi_i].to_radians();
    let along = DVec3::new(libm::cos(phi), libm::sin(phi), 0.0);
    // At grazing incidence light still arrives.
    let wi = along * libm::sin(theta) + DVec3::Z * libm::cos(theta).max(f64::MIN_POSITIVE);
    let normal = if lobe.quantity == Quantity::Reflection { DVec3::Z } else { DVec3::NEG_Z };
    // Where the pole of the grid lies in the plane.
    let pole_deg = match lobe.frame {
        Frame::Surface => 0.0,
        Frame::Specular => theta_i_deg,
    };
    let own = lobe.polar_deg.iter().flat_map(|p| [pole_deg + p, pole_deg - p]);
    let weights: &[f64] = if lobe.channels == 3 { &LUMINANCE_OF_RGB } else { &[1.0] };
    let intensity = |angle_deg: f64| {
        let angle = angle_deg.to_radians();
        let cosine = libm::cos(angle);
        let wo = normal * cosine - along * libm::sin(angle);
        let f = weights.iter().enumerate().map(|(channel, weight)| weight * value(lobe, channel, wi, wo));
        f.sum::<f64>() * cosine
    };
    curve_angles(90, PER_DEGREE, own).into_iter().map(|a| (a, intensity(a))).collect()
}
