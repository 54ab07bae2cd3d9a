//! What a table does with a photon.

use crate::sample::coordinates::Chooser;
use crate::scattering::Quantity;
use crate::surface::luminance;
use crate::surface::tabulated::Tabulated;
use crate::surface::tabulated::arrival::Arrival;
use crate::surface::tabulated::branch::{Branches, Left, leave};
use crate::surface::tabulated::face::Face;
use crate::surface::throughput::Fate;
use crate::surface::{Event, Incidence, Reflectance, Throughput};
use crate::units::LUMINANCE_OF_RGB;

impl Tabulated {
    /// Scatters what the throughput lets be scattered. (Kept out of the walk, whose other surfaces need few
    /// registers.)
    #[inline(never)]
    pub fn scatter<C: Chooser, T: Throughput>(
        &self,
        at: &Incidence,
        chooser: &mut C,
        carried: &mut T,
    ) -> Event {
        let face = self.face(at.front);
        let along = || self.along(if at.front { at.facet } else { -at.facet });
        let arrival = Arrival::new(-at.direction, at.facet, along);
        let angles = Self::angles(face, &arrival, along);
        if face.coloured {
            self.scatter_coloured(face, &arrival, angles, chooser, carried)
        } else {
            self.scatter_grey(face, &arrival, angles, chooser, carried)
        }
    }

    #[inline(always)]
    fn scatter_grey<C: Chooser, T: Throughput>(
        &self,
        face: &Face,
        arrival: &Arrival,
        (theta, phi): (f64, f64),
        chooser: &mut C,
        carried: &mut T,
    ) -> Event {
        let layers = face.layers.map(|k| k.map(|k| &self.layers[k]));
        let mut branches = Branches::none();
        let albedo = branches.add_grey(layers, theta, phi);
        let fate = if face.rest.is_some() {
            carried.scatter([albedo; 3], true, chooser)
        } else if carried.reflect(&Reflectance::of_table(albedo), chooser) {
            Fate::Scattered(LUMINANCE_OF_RGB)
        } else {
            Fate::Ends
        };
        if !matches!(fate, Fate::Scattered(_)) {
            return unscattered(face, arrival, fate);
        }
        match branches.decide(chooser) {
            Some(branch) => match layers[branch.lobe as usize] {
                Some(layer) => outcome(&leave(arrival, layer, branch.slice as usize, chooser).0),
                None => Event::Absorbed,
            },
            None => Event::Absorbed,
        }
    }

    #[inline(always)]
    fn scatter_coloured<C: Chooser, T: Throughput>(
        &self,
        face: &Face,
        arrival: &Arrival,
        angles: (f64, f64),
        chooser: &mut C,
        carried: &mut T,
    ) -> Event {
        let lobes = self.mixed(face, arrival, angles);
        let albedo = lobes.albedo(true);
        let fate = carried.scatter(albedo, face.rest.is_some(), chooser);
        let Fate::Scattered(shares) = fate else {
            return unscattered(face, arrival, fate);
        };
        let Some(left) = lobes.sample(shares, chooser) else {
            return Event::Absorbed;
        };
        let part = if face.rest.is_some() { 1.0 } else { luminance(albedo) };
        carried.scattered(left.values, part);
        outcome(&left)
    }
}

/// What becomes of a photon that the table does not scatter.
fn unscattered(face: &Face, arrival: &Arrival, fate: Fate) -> Event {
    match (fate, face.rest) {
        (Fate::GoesOn, Some(quantity)) => {
            let direction = arrival.specular(quantity).normalize();
            Event::Leaves { direction, through: quantity == Quantity::Transmission, corrected: false }
        }
        _ => Event::Absorbed,
    }
}

/// What becomes of one that it scatters.
#[inline(always)]
fn outcome(left: &Left) -> Event {
    if left.below_horizon {
        return Event::BelowHorizon;
    }
    let through = left.quantity == Quantity::Transmission;
    Event::Leaves { direction: left.wo.normalize(), through, corrected: false }
}
