//! Tabulated surfaces in a local frame: z the normal on the side that light comes from, x the reference
//! direction.

use caustix::scattering::Quantity;
use caustix::surface::{Incidence, Leg, Model, Tabulated};
use glam::DVec3;

/// The outward normal, and light from wi on that side of it.
fn leg(from_front: bool, wi: DVec3) -> (DVec3, Leg) {
    (if from_front { DVec3::Z } else { -DVec3::Z }, Leg { direction: wi, front: from_front })
}

/// A photon from wi.
pub fn arriving(from_front: bool, wi: DVec3) -> Incidence {
    Incidence { direction: -wi, facet: DVec3::Z, smooth: DVec3::Z, front: from_front, indices: [1.0; 2] }
}

/// Parts of the light from wi that are scattered, by channel.
pub fn albedo(t: &Tabulated, from_front: bool, wi: DVec3) -> [f64; 3] {
    let (outward, wi) = leg(from_front, wi);
    t.albedo(outward, wi)
}

/// f by channel, for wo of either side.
pub fn eval(t: &Tabulated, from_front: bool, wi: DVec3, wo: DVec3) -> [f64; 3] {
    let (outward, wi) = leg(from_front, wi);
    t.eval(outward, wi, Leg::new(wo, outward))
}

/// g = f cos(theta_o) of a lobe by channel, also below its horizon.
pub fn projected(t: &Tabulated, from_front: bool, wi: DVec3, quantity: Quantity, wo: DVec3) -> [f64; 3] {
    let (outward, wi) = leg(from_front, wi);
    t.projected(outward, wi, quantity, wo)
}

pub fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}
