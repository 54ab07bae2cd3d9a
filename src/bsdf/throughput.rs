//! What a photon carries from reflection to reflection beside its flux.
//!
//! The walk is compiled for one of these, so that a scene pays only for what it names: [`Grey`] carries nothing, [`Rgb`] a
//! weight per channel under the same roulette, [`Fixed`] a weight per channel through a fixed number of reflections.

use super::reflectance::{Reflectance, luminance};
use crate::sample::coordinates::Chooser;

/// What a photon carries, and what a reflection does to it.
pub trait Throughput: Copy + Send + Sync {
    /// The photon meets a surface that reflects these parts: whether it goes on.
    fn reflect<C: Chooser>(&mut self, reflectance: &Reflectance, chooser: &mut C) -> bool;
}

/// Nothing: the chance of going on is the reflectance. All that a scene without colour needs.
#[derive(Debug, Clone, Copy, Default)]
pub struct Grey;

impl Throughput for Grey {
    #[inline(always)]
    fn reflect<C: Chooser>(&mut self, reflectance: &Reflectance, chooser: &mut C) -> bool {
        chooser.happens(reflectance.luminous())
    }
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
    fn reflect<C: Chooser>(&mut self, reflectance: &Reflectance, chooser: &mut C) -> bool {
        let reflected = product(self.weight, reflectance.by_channel());
        // Divided by the weight's own luminance, so that rounding does not add up over reflections.
        let q = luminance(reflected) / luminance(self.weight);
        if !chooser.happens(q) {
            return false;
        }
        self.weight = reflected.map(|w| w / q);
        true
    }
}

/// A weight per channel and a number of reflections that are still to come; no roulette at reflections. (A dielectric
/// chooses as ever and counts as no reflection.)
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

    /// Weights of red, green and blue: products of the reflectances so far, at most 1.
    #[inline]
    pub fn weight(&self) -> [f64; 3] {
        self.weight
    }
}

impl Throughput for Fixed {
    #[inline]
    fn reflect<C: Chooser>(&mut self, reflectance: &Reflectance, _: &mut C) -> bool {
        if self.left == 0 {
            return false;
        }
        self.left -= 1;
        self.weight = product(self.weight, reflectance.by_channel());
        true
    }
}

#[inline]
fn product(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::script::Script;

    #[test]
    fn roulette_by_luminance_keeps_the_luminance_at_one() {
        let red = Reflectance::rgb([0.8, 0.1, 0.05]);
        let mut photon = Rgb::WHITE;
        let mut script = Script { events: vec![true; 200], ..Script::default() };
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
        let mut script = Script { events: vec![true; 3], ..Script::default() };
        for wall in walls {
            assert!(photon.reflect(&Reflectance::rgb(wall), &mut script));
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
        let mut script = Script { events: vec![true], ..Script::default() };
        assert!(photon.reflect(&Reflectance::rgb([1.0, 0.0, 0.0]), &mut script));
        assert!(!photon.reflect(&Reflectance::rgb([0.0, 1.0, 1.0]), &mut script));
        let mut fresh = Rgb::WHITE;
        assert!(!fresh.reflect(&Reflectance::grey(0.0), &mut script));
        assert_eq!(script.asked.len(), 1);
    }

    #[test]
    fn a_fixed_number_of_reflections_draws_nothing_and_multiplies() {
        let mut photon = Fixed::white(2);
        let wall = Reflectance::rgb([0.5, 0.25, 0.0]);
        let mut script = Script::default();
        assert!(photon.reflect(&wall, &mut script) && photon.reflect(&wall, &mut script));
        assert_eq!(photon.weight(), [0.25, 0.0625, 0.0]);
        assert!(!photon.reflect(&wall, &mut script));
        assert!(script.asked.is_empty());
    }
}
