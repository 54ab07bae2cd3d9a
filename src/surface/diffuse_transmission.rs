//! A thin diffuse sheet (paper, opal glass, a lampshade): light leaves with the cosine law on the side of
//! arrival and on the other one. The medium is the same on both sides.
//!
//! Scene text: `type = "lambertian"`, `reflectance` and `transmittance`, each 0 to 1 or `[r, g, b]`, at most
//! 1 together.

use glam::DVec3;

use crate::error::Invalid;
use crate::error::invalid::Interval;
use crate::sample::coordinates::Chooser;
use crate::surface::lambertian::{sample_cosine, value};
use crate::surface::throughput::Fate;
use crate::surface::{Event, Incidence, Kind, Leg, Model, Reflectance, Throughput, luminance};

/// A thin sheet: f = reflectance / pi between directions of one side, transmittance / pi between those of
/// different sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiffuseTransmission {
    reflected: Reflectance,
    transmitted: Reflectance,
}

/// Transmitted parts.
pub const TRANSMITTANCE: Interval = Interval { low: 0.0, high: 1.0, words: "a transmittance from 0 to 1" };

impl DiffuseTransmission {
    /// A sheet that reflects and transmits these parts of red, green and blue, on either side.
    ///
    /// # Errors
    /// Parts that are not from 0 to 1, or more than 1 together.
    pub fn new(reflectance: [f64; 3], transmittance: [f64; 3]) -> Result<Self, Invalid> {
        let reflected = Reflectance::rgb(reflectance)?;
        let transmitted = Reflectance::named("transmittance", transmittance, &TRANSMITTANCE)?;
        let this = Self { reflected, transmitted };
        if this.scattered().iter().all(|part| *part <= 1.0) {
            return Ok(this);
        }
        Err(Invalid::Content {
            what: "transmittance",
            found: format!("transmittance = {transmittance:?} with reflectance = {reflectance:?}"),
            required: "a transmittance of at most 1 - reflectance in every channel".to_string(),
        })
    }

    /// Both parts together.
    fn scattered(&self) -> [f64; 3] {
        let (reflected, transmitted) = (self.reflected.by_channel(), self.transmitted.by_channel());
        std::array::from_fn(|c| reflected[c] + transmitted[c])
    }
}

impl Model for DiffuseTransmission {
    const REQUIRES: &[(u8, &'static str)] = &[(2, "diffuse scattering"), (3, "diffuse transmission")];

    fn kind(&self) -> Kind {
        if luminance(self.scattered()) > 0.0 { Kind::Scattering } else { Kind::Absorbing }
    }

    fn is_opaque(&self) -> bool {
        false
    }

    fn is_coloured(&self) -> bool {
        self.reflected.is_coloured() || self.transmitted.is_coloured()
    }

    /// Scatters what the throughput lets go on; into which side is an event of its own. (Kept out of the
    /// walk, whose other surfaces need few registers.)
    #[inline(never)]
    fn scatter<C: Chooser, T: Throughput>(&self, at: &Incidence, chooser: &mut C, carried: &mut T) -> Event {
        let scattered = self.scattered();
        let Fate::Scattered(shares) = carried.scatter(scattered, false, chooser) else {
            return Event::Absorbed;
        };
        let seen = |parts: [f64; 3]| (0..3).map(|c| shares[c] * parts[c]).sum::<f64>();
        let through = !chooser.happens(seen(self.reflected.by_channel()) / seen(scattered));
        let (side, normal) =
            if through { (&self.transmitted, -at.facet) } else { (&self.reflected, at.facet) };
        carried.scattered(side.by_channel(), luminance(scattered));
        Event::Leaves { direction: sample_cosine(normal, chooser), through, corrected: false }
    }

    fn eval(&self, _outward: DVec3, wi: Leg, wo: Leg) -> [f64; 3] {
        value(if wi.front == wo.front { &self.reflected } else { &self.transmitted })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_1_PI;

    use super::*;
    use crate::surface::tests::Script;
    use crate::surface::{Fixed, Grey, Rgb};

    const RED: [f64; 3] = [0.5, 0.25, 0.125];
    const BLUE: [f64; 3] = [0.0, 0.25, 0.75];

    fn sheet() -> DiffuseTransmission {
        DiffuseTransmission::new(RED, BLUE).unwrap()
    }

    fn at() -> Incidence {
        Incidence {
            direction: DVec3::new(0.6, 0.0, -0.8),
            facet: DVec3::Z,
            smooth: DVec3::Z,
            front: true,
            indices: [1.0; 2],
        }
    }

    #[test]
    fn value_is_reflectance_or_transmittance_over_pi_and_symmetric() {
        let directions = [DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 0.8, 0.6)];
        let legs = directions.into_iter().flat_map(|d| [Leg::new(d, DVec3::Z), Leg::new(-d, DVec3::Z)]);
        for (a, b) in legs.clone().flat_map(|a| legs.clone().map(move |b| (a, b))) {
            let parts = if a.front == b.front { RED } else { BLUE };
            assert_eq!(sheet().eval(DVec3::Z, a, b), parts.map(|part| part * FRAC_1_PI));
            assert_eq!(sheet().eval(DVec3::Z, a, b), sheet().eval(DVec3::Z, b, a));
        }
        assert!(sheet().is_coloured() && sheet().kind() == Kind::Scattering);
        let dark = DiffuseTransmission::new([0.0; 3], [0.0; 3]).unwrap();
        assert!(dark.kind() == Kind::Absorbing && dark.requires().is_empty());
    }

    #[test]
    fn directions_stay_on_their_side_even_at_the_last_uniform() {
        let largest = 1.0 - f64::EPSILON / 2.0;
        for (reflect, sign) in [(true, 1.0), (false, -1.0)] {
            let mut script = Script::new([true, reflect], [largest, 0.3]);
            match sheet().scatter(&at(), &mut script, &mut Grey) {
                Event::Leaves { direction, through, .. } => {
                    assert!(through != reflect && direction.z * sign > 0.0);
                }
                other => panic!("{other:?}"),
            }
        }
        assert!(matches!(sheet().scatter(&at(), &mut Script::new([false], []), &mut Grey), Event::Absorbed));
    }

    /// Weight times chance of each side, by channel.
    fn expected<T: Throughput>(carried: T, weight: fn(&T) -> [f64; 3], first: &[bool]) -> [[f64; 3]; 2] {
        [true, false].map(|reflect| {
            let mut photon = carried;
            let events = [first, &[reflect]].concat();
            let mut script = Script::new(events.clone(), [0.5, 0.5]);
            sheet().scatter(&at(), &mut script, &mut photon);
            let chances = events.iter().zip(&script.asked).map(|(e, p)| if *e { *p } else { 1.0 - p });
            let chance: f64 = chances.product();
            weight(&photon).map(|w| w * chance)
        })
    }

    #[test]
    fn colour_is_unbiased_whatever_the_photon_carries() {
        // Of luminance 1, as every emitter's.
        let colour = [0.5, (1.0 - 0.5 * 0.2126 - 1.5 * 0.0722) / 0.7152, 1.5];
        let tinted = Rgb::WHITE.tinted(colour);
        let product = |parts: [f64; 3]| -> [f64; 3] { std::array::from_fn(|c| colour[c] * parts[c]) };
        for sides in [
            expected(tinted, Rgb::weight, &[true]),
            expected(Fixed::white(1).tinted(colour), Fixed::weight, &[]),
        ] {
            for (found, exact) in sides.iter().zip([product(RED), product(BLUE)]) {
                assert!((0..3).all(|c| (found[c] - exact[c]).abs() < 1e-15), "{found:?} {exact:?}");
            }
        }
        let mut photon = tinted;
        sheet().scatter(&at(), &mut Script::new([true, false], [0.5, 0.5]), &mut photon);
        assert!((luminance(photon.weight()) - 1.0).abs() < 1e-15);
        let mut none_left = Fixed::white(0);
        assert!(matches!(sheet().scatter(&at(), &mut Script::default(), &mut none_left), Event::Absorbed));
    }

    #[test]
    fn what_scatters_more_than_arrives_is_refused() {
        for part in [f64::NAN, f64::INFINITY, -0.1, 1.1, 1e300] {
            for c in 0..3 {
                let mut parts = [0.25; 3];
                parts[c] = part;
                assert_eq!(DiffuseTransmission::new(parts, [0.25; 3]).unwrap_err().what(), "reflectance");
                assert_eq!(DiffuseTransmission::new([0.25; 3], parts).unwrap_err().what(), "transmittance");
            }
        }
        assert!(DiffuseTransmission::new([0.2, 0.3, 0.5], [0.5, 0.5, 0.5 + f64::EPSILON]).is_err());
        // Decimals that sum to 1 do so within rounding.
        for k in 0..=1000 {
            let part = f64::from(k) / 1000.0;
            assert!(DiffuseTransmission::new([part; 3], [f64::from(1000 - k) / 1000.0; 3]).is_ok(), "{part}");
        }
    }
}
