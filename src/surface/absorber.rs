//! A black surface: ends every photon.
//!
//! Scene text: `type = "absorber"`.

use crate::sample::coordinates::Chooser;
use crate::surface::{Event, Incidence, Kind, Model, Throughput};

/// A black surface.
pub struct Absorber;

impl Model for Absorber {
    const REQUIRES: &[(u8, &'static str)] = &[];

    fn kind(&self) -> Kind {
        Kind::Absorbing
    }

    fn is_opaque(&self) -> bool {
        true
    }

    fn is_coloured(&self) -> bool {
        false
    }

    fn scatter<C: Chooser, T: Throughput>(&self, _: &Incidence, _: &mut C, _: &mut T) -> Event {
        Event::Absorbed
    }
}
