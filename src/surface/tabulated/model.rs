//! A table under the contract of all materials: what tells it apart from others, its value between two
//! directions, and what it leaves of the light beyond.

use std::sync::Arc;

use glam::DVec3;

use crate::sample::coordinates::Chooser;
use crate::scattering::Quantity;
use crate::surface::tabulated::Tabulated;
use crate::surface::tabulated::arrival::Arrival;
use crate::surface::tabulated::face::Face;
use crate::surface::{Event, Incidence, Kind, Leg, Model, Throughput, Way, Ways};
use crate::units::LUMINANCE_OF_RGB;

impl Model for Tabulated {
    const REQUIRES: &[(u8, &'static str)] = &[(4, "tabulated scattering")];

    #[inline]
    fn kind(&self) -> Kind {
        Kind::Scattering
    }

    fn is_opaque(&self) -> bool {
        false
    }

    fn is_coloured(&self) -> bool {
        self.faces.iter().any(|face| face.coloured)
    }

    #[inline]
    fn scatter<C: Chooser, T: Throughput>(&self, at: &Incidence, chooser: &mut C, carried: &mut T) -> Event {
        self.scatter(at, chooser, carried)
    }

    fn eval(&self, outward: DVec3, wi: Leg, wo: Leg) -> [f64; 3] {
        let cos_o = wo.direction.dot(outward).abs();
        if cos_o == 0.0 {
            return [0.0; 3];
        }
        let quantity = if wi.front == wo.front { Quantity::Reflection } else { Quantity::Transmission };
        self.projected(outward, wi, quantity, wo.direction).map(|g| g / cos_o)
    }

    /// Mirrored from the side of the eye, and straight through from the other; both only where the two sides
    /// of a table differ.
    fn specular(&self, at: &Incidence) -> Ways {
        let outward = at.outward();
        let way = |quantity| {
            let lit_front = at.front != (quantity == Quantity::Transmission);
            if self.face(lit_front).rest != Some(quantity) {
                return None;
            }
            let direction = match quantity {
                Quantity::Transmission => at.direction,
                Quantity::Reflection => {
                    let (_, arrival) =
                        self.arriving(outward, Leg { direction: -at.direction, front: at.front });
                    arrival.specular(Quantity::Reflection).normalize()
                }
            };
            // Light of that side, on its way here.
            let albedo = self.albedo(outward, Leg { direction, front: lit_front });
            Some(Way { direction, part: albedo.map(|a| (1.0 - a).max(0.0)), luminance_factor: 1.0 })
        };
        Ways { mirrored: way(Quantity::Reflection), through: way(Quantity::Transmission), lossless: false }
    }

    fn proposals(&self, at: &Incidence) -> [f64; 2] {
        let outward = at.outward();
        let (face, arrival) = self.arriving(outward, Leg { direction: -at.direction, front: at.front });
        let lobes = self.lobes(face, &arrival, || self.along(outward));
        lobes.proposals(LUMINANCE_OF_RGB).into()
    }

    fn table_bytes(&self) -> Option<(usize, usize)> {
        Some((
            Arc::as_ptr(&self.layers).addr(),
            self.layers.iter().map(|layer| layer.grids.memory_bytes()).sum(),
        ))
    }
}

impl Tabulated {
    /// g = f cos(theta_o), 1/sr, by channel: of the lobe that reflects or of the one that transmits, also
    /// where it reaches below its horizon. Its integral over all wo and both lobes is the albedo.
    pub fn projected(&self, outward: DVec3, wi: Leg, quantity: Quantity, wo: DVec3) -> [f64; 3] {
        let (face, arrival) = self.arriving(outward, wi);
        self.lobes(face, &arrival, || self.along(outward)).projected(quantity, wo)
    }

    /// Parts of the light from wi that are scattered, by channel, below the horizon included.
    pub fn albedo(&self, outward: DVec3, wi: Leg) -> [f64; 3] {
        let (face, arrival) = self.arriving(outward, wi);
        self.lobes(face, &arrival, || self.along(outward)).albedo(face.coloured)
    }

    #[inline]
    fn arriving(&self, outward: DVec3, wi: Leg) -> (&Face, Arrival) {
        let normal = if wi.front { outward } else { -outward };
        (self.face(wi.front), Arrival::new(wi.direction, normal, || self.along(outward)))
    }
}
