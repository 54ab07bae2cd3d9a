//! What a photon carries from reflection to reflection beside its flux.
//!
//! The walk is compiled for one of these, so that a scene pays only for what it names: [`Grey`] carries
//! nothing, [`Rgb`] a weight per channel under the same roulette, [`Fixed`] a weight per channel through a
//! fixed number of reflections.

use crate::sample::coordinates::Chooser;
use crate::surface::reflectance::{Reflectance, luminance};
use crate::units::LUMINANCE_OF_RGB;

/// What a photon carries, and what a reflection does to it.
pub trait Throughput: Copy + Send + Sync {
    /// What a photon of light of this colour starts with, by channel with luminance 1 (linear sRGB), where a
    /// photon of white light starts with this.
    fn tinted(self, colour: [f64; 3]) -> Self;
    /// The photon meets a surface that reflects these parts: whether it goes on.
    fn reflect<C: Chooser>(&mut self, reflectance: &Reflectance, chooser: &mut C) -> bool;
    /// The photon meets a table of this albedo by channel: whether it is scattered. `rest_goes_on`: what the
    /// table leaves is not absorbed.
    fn scatter<C: Chooser>(&mut self, albedo: [f64; 3], rest_goes_on: bool, chooser: &mut C) -> Fate;
    /// It was scattered where the channels have these values (in any one unit), in a direction whose density
    /// is their mean weighted by the shares that [`Self::scatter`] gave; `part` is the part of white light's
    /// luminous flux that was scattered, 1 where the rest went on.
    fn scattered(&mut self, values: [f64; 3], part: f64);
}

/// What a table does with a photon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fate {
    /// It is scattered, in a direction chosen by the channels in these shares (any positive sum).
    Scattered([f64; 3]),
    /// It goes on as if the table were not there.
    GoesOn,
    /// It ends.
    Ends,
}

/// The event itself: scattered with this probability, else what becomes of the rest.
#[inline]
fn fate<C: Chooser>(probability: f64, shares: [f64; 3], rest_goes_on: bool, chooser: &mut C) -> Fate {
    match (chooser.survives(probability), rest_goes_on) {
        (true, _) => Fate::Scattered(shares),
        (false, true) => Fate::GoesOn,
        (false, false) => Fate::Ends,
    }
}

/// Nothing: the chance of going on is the reflectance. All that a scene without colour needs.
#[derive(Debug, Clone, Copy, Default)]
pub struct Grey;

impl Throughput for Grey {
    #[inline(always)]
    fn tinted(self, _: [f64; 3]) -> Self {
        self
    }

    #[inline(always)]
    fn reflect<C: Chooser>(&mut self, reflectance: &Reflectance, chooser: &mut C) -> bool {
        chooser.survives(reflectance.luminous())
    }

    #[inline(always)]
    fn scatter<C: Chooser>(&mut self, albedo: [f64; 3], rest_goes_on: bool, chooser: &mut C) -> Fate {
        fate(luminance(albedo), LUMINANCE_OF_RGB, rest_goes_on, chooser)
    }

    #[inline(always)]
    fn scattered(&mut self, _: [f64; 3], _: f64) {}
}

/// A weight per channel whose luminance stays 1 (METHOD 1): the photon goes on with the probability
/// q = Y(w rho) / Y(w), and its weight becomes w rho / q. Receivers of luminous flux go on counting photons.
#[derive(Debug, Clone, Copy)]
pub struct Rgb {
    weight: [f64; 3],
}

impl Rgb {
    /// A photon of white light.
    pub const WHITE: Self = Self { weight: [1.0; 3] };

    /// Weights of red, green and blue.
    pub fn weight(&self) -> [f64; 3] {
        self.weight
    }
}

impl Throughput for Rgb {
    #[inline]
    fn tinted(self, colour: [f64; 3]) -> Self {
        Self { weight: product(self.weight, colour) }
    }

    #[inline]
    fn reflect<C: Chooser>(&mut self, reflectance: &Reflectance, chooser: &mut C) -> bool {
        let reflected = product(self.weight, reflectance.by_channel());
        // Divided by the weight's own luminance, so that rounding does not add up over reflections.
        let q = luminance(reflected) / luminance(self.weight);
        if !chooser.survives(q) {
            return false;
        }
        self.weight = reflected.map(|w| w / q);
        true
    }

    #[inline]
    fn scatter<C: Chooser>(&mut self, albedo: [f64; 3], rest_goes_on: bool, chooser: &mut C) -> Fate {
        let q = luminance(product(self.weight, albedo)) / luminance(self.weight);
        let fate = fate(q, product(self.weight, LUMINANCE_OF_RGB), rest_goes_on, chooser);
        if fate == Fate::GoesOn {
            self.scattered(albedo.map(|a| 1.0 - a), 1.0);
        }
        fate
    }

    #[inline]
    fn scattered(&mut self, values: [f64; 3], _: f64) {
        // The density of the direction is Y(w values), whatever the event's probability: divided by it, Y
        // stays 1.
        let seen = product(self.weight, values);
        let y = luminance(seen);
        // Zero only on an edge where the table vanishes, which is reached at u = 0 and nowhere else.
        if y > 0.0 {
            self.weight = seen.map(|w| w / y);
        }
    }
}

/// A weight per channel and a number of reflections that are still to come; no roulette at reflections. (A
/// dielectric chooses as ever and counts as no reflection.)
#[derive(Debug, Clone, Copy)]
pub struct Fixed {
    weight: [f64; 3],
    left: u32,
}

impl Fixed {
    /// A photon of white light that will be reflected this often: it arrives once more than that.
    pub const fn white(reflections: u32) -> Self {
        Self { weight: [1.0; 3], left: reflections }
    }

    /// Weights of red, green and blue: those of the emitter's colour times the reflectances so far; at most 1
    /// in white light.
    #[inline]
    pub fn weight(&self) -> [f64; 3] {
        self.weight
    }
}

impl Throughput for Fixed {
    #[inline]
    fn tinted(self, colour: [f64; 3]) -> Self {
        Self { weight: product(self.weight, colour), ..self }
    }

    #[inline]
    fn reflect<C: Chooser>(&mut self, reflectance: &Reflectance, _: &mut C) -> bool {
        if self.left == 0 {
            return false;
        }
        self.left -= 1;
        self.weight = product(self.weight, reflectance.by_channel());
        true
    }

    #[inline]
    fn scatter<C: Chooser>(&mut self, albedo: [f64; 3], rest_goes_on: bool, chooser: &mut C) -> Fate {
        let part = luminance(albedo);
        if self.left == 0 || (part == 0.0 && !rest_goes_on) {
            return Fate::Ends;
        }
        self.left -= 1;
        if !rest_goes_on {
            return Fate::Scattered(LUMINANCE_OF_RGB);
        }
        let fate = fate(part, LUMINANCE_OF_RGB, true, chooser);
        if fate == Fate::GoesOn {
            self.scattered(albedo.map(|a| 1.0 - a), 1.0);
        }
        fate
    }

    #[inline]
    fn scattered(&mut self, values: [f64; 3], part: f64) {
        let y = luminance(values);
        if y > 0.0 {
            self.weight = product(self.weight, values).map(|w| w * part / y);
        }
    }
}

#[inline]
fn product(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::Script;

    #[test]
    fn roulette_by_luminance_keeps_the_luminance_at_one() {
        let red = Reflectance::rgb([0.8, 0.1, 0.05]).unwrap();
        let mut photon = Rgb::WHITE;
        let mut script = Script::new([true; 200], []);
        for reflection in 0..200 {
            assert!(photon.reflect(&red, &mut script));
            assert!((luminance(photon.weight()) - 1.0).abs() < 1e-14, "after {reflection}");
        }
        assert!((script.asked[0] - red.luminous()).abs() < 1e-15);
        // Red is all that is left, so the chance of going on is red's reflectance.
        assert!((script.asked[199] - 0.8).abs() < 1e-14);
        assert!(photon.weight()[1] < 1e-150);
    }

    #[test]
    fn weight_times_chance_is_the_product_of_the_reflectances() {
        let walls = [[0.7, 0.2, 0.1], [0.1, 0.6, 0.3], [0.5, 0.5, 0.5]];
        let mut photon = Rgb::WHITE;
        let mut script = Script::new([true; 3], []);
        for wall in walls {
            assert!(photon.reflect(&Reflectance::rgb(wall).unwrap(), &mut script));
        }
        let chance: f64 = script.asked.iter().product();
        for (channel, weight) in photon.weight().into_iter().enumerate() {
            let expected: f64 = walls.iter().map(|w| w[channel]).product();
            assert!((chance * weight / expected - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn what_reflects_nothing_of_the_photon_ends_it_without_a_draw() {
        let mut photon = Rgb::WHITE;
        let mut script = Script::new([true], []);
        assert!(photon.reflect(&Reflectance::rgb([1.0, 0.0, 0.0]).unwrap(), &mut script));
        assert!(!photon.reflect(&Reflectance::rgb([0.0, 1.0, 1.0]).unwrap(), &mut script));
        let mut fresh = Rgb::WHITE;
        assert!(!fresh.reflect(&Reflectance::new(0.0).unwrap(), &mut script));
        assert_eq!(script.asked.len(), 1);
    }

    #[test]
    fn a_fixed_number_of_reflections_draws_nothing_and_multiplies() {
        let mut photon = Fixed::white(2);
        let wall = Reflectance::rgb([0.5, 0.25, 0.0]).unwrap();
        let mut script = Script::default();
        assert!(photon.reflect(&wall, &mut script) && photon.reflect(&wall, &mut script));
        assert_eq!(photon.weight(), [0.25, 0.0625, 0.0]);
        assert!(!photon.reflect(&wall, &mut script));
        assert!(script.asked.is_empty());
        // A table's scattering counts like a wall's reflection.
        let mut photon = Fixed::white(1);
        assert_ne!(photon.scatter([0.5; 3], false, &mut script), Fate::Ends);
        assert_eq!(photon.scatter([0.5; 3], false, &mut script), Fate::Ends);
        assert!(!photon.reflect(&wall, &mut script));
    }
}
