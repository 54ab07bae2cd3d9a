//! The value of a table between two directions, and what it leaves of the light beyond.

use glam::DVec3;

use crate::scattering::Quantity;
use crate::surface::tabulated::arrival::Arrival;
use crate::surface::tabulated::{Face, Tabulated};
use crate::surface::value::Leg;

/// A way on for an eye path at a surface that leaves a part of the light as if it were a mirror or not there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beyond {
    /// Where the eye path goes on to; unit.
    pub direction: DVec3,
    /// Whether it crosses the surface.
    pub through: bool,
    /// Part of the luminance from there that goes on to the eye, by channel.
    pub part: [f64; 3],
}

impl Tabulated {
    /// f, 1/sr, by channel, of light from wi into wo on a facet with this outward normal.
    pub fn eval(&self, outward: DVec3, wi: Leg, wo: Leg) -> [f64; 3] {
        let cos_o = wo.direction.dot(outward).abs();
        if cos_o == 0.0 {
            return [0.0; 3];
        }
        let quantity = if wi.front == wo.front { Quantity::Reflection } else { Quantity::Transmission };
        self.projected(outward, wi, quantity, wo.direction).map(|g| g / cos_o)
    }

    /// g = f cos(theta_o), 1/sr, by channel: of the lobe that reflects or of the one that transmits, also where it reaches below
    /// its horizon. Its integral over all wo and both lobes is the albedo.
    pub fn projected(&self, outward: DVec3, wi: Leg, quantity: Quantity, wo: DVec3) -> [f64; 3] {
        let (face, arrival) = self.arriving(outward, wi);
        self.lobes(face, &arrival, || self.along(outward)).projected(quantity, wo)
    }

    /// Parts of the light from wi that are scattered, by channel, below the horizon included.
    pub fn albedo(&self, outward: DVec3, wi: Leg) -> [f64; 3] {
        let (face, arrival) = self.arriving(outward, wi);
        self.lobes(face, &arrival, || self.along(outward)).albedo(face.coloured)
    }

    /// Where an eye path that arrives along `direction` on the side `front` goes on to: the light that the table leaves comes
    /// from there. Mirrored from the side of the eye, and straight through from the other.
    pub fn beyond(&self, outward: DVec3, direction: DVec3, front: bool) -> [Option<Beyond>; 2] {
        [Quantity::Reflection, Quantity::Transmission].map(|quantity| {
            let through = quantity == Quantity::Transmission;
            let lit_front = front != through;
            let face = self.face(lit_front);
            if face.rest != Some(quantity) {
                return None;
            }
            let direction = if through {
                direction
            } else {
                let (_, arrival) = self.arriving(outward, Leg { direction: -direction, front });
                arrival.specular(Quantity::Reflection).normalize()
            };
            // Light of that side, on its way here.
            let albedo = self.albedo(outward, Leg { direction, front: lit_front });
            Some(Beyond { direction, through, part: albedo.map(|a| (1.0 - a).max(0.0)) })
        })
    }

    #[inline]
    fn arriving(&self, outward: DVec3, wi: Leg) -> (&Face, Arrival) {
        let normal = if wi.front { outward } else { -outward };
        (self.face(wi.front), Arrival::new(wi.direction, normal, || self.along(outward)))
    }
}
