//! What an eye path carries: the part of the luminance ahead of it that reaches the eye.
//!
//! A mirror multiplies it by its reflectance, glass by the part that goes the way which is followed and by the square of the
//! indices ([`Dielectric::luminance_factor`]). Roulette ends paths that have become faint or long.

use crate::sample::coordinates::Chooser;
use crate::surface::Dielectric;
use crate::surface::reflectance::luminance;

/// Weights of red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeWeight {
    weight: [f64; 3],
}

/// Luminance of the weight below which roulette begins.
const ROULETTE_BELOW: f64 = 1.0 / 16.0;

/// Events of a path before its length is a reason to end it.
pub const FREE_EVENTS: u32 = 32;

impl EyeWeight {
    /// Of a path that begins.
    pub const ONE: Self = Self { weight: [1.0; 3] };

    /// Red, green, blue.
    #[inline]
    pub fn weight(&self) -> [f64; 3] {
        self.weight
    }

    /// Multiplies all channels.
    #[inline]
    pub fn scale(&mut self, factor: f64) {
        self.weight = self.weight.map(|w| w * factor);
    }

    /// Multiplies by channel; whether the path goes on. Of paths whose weight has become small, few go on with more: the mean
    /// stays.
    #[inline]
    pub fn attenuate<C: Chooser>(&mut self, factor: [f64; 3], chooser: &mut C) -> bool {
        for (w, f) in self.weight.iter_mut().zip(factor) {
            *w *= f;
        }
        let y = luminance(self.weight);
        if y >= ROULETTE_BELOW {
            return true;
        }
        let q = y / ROULETTE_BELOW;
        if !chooser.happens(q) {
            return false;
        }
        self.scale(1.0 / q);
        true
    }

    /// After so many events, whether the path goes on. Total reflection keeps light in glass without loss, often for good; of long
    /// paths therefore fewer and fewer go on, with more: the mean stays. A path of [`FREE_EVENTS`] becomes one of n events with the
    /// probability (FREE_EVENTS / n)^2, so that its length has a mean of 2 FREE_EVENTS however it is caught; its weight grows no
    /// faster than n^2, so that light which becomes rarer with n in any constant proportion has a finite variance.
    #[inline]
    pub fn outlast<C: Chooser>(&mut self, events: u32, chooser: &mut C) -> bool {
        if events <= FREE_EVENTS {
            return true;
        }
        let ratio = f64::from(events - 1) / f64::from(events);
        let q = ratio * ratio;
        if !chooser.happens(q) {
            return false;
        }
        self.scale(1.0 / q);
        true
    }
}

impl Dielectric {
    /// (n_i / n_t)^2: luminance over the square of the index is what refraction leaves unchanged, so an eye path that goes
    /// on `through` from the medium of index n_i, on the side `front`, sees that part of the luminance in n_t. (E. Veach, "Robust
    /// Monte Carlo Methods for Light Transport Simulation", 1997, section 5.2.)
    #[inline]
    pub fn luminance_factor(&self, front: bool) -> f64 {
        let ratio = self.ior_outside / self.ior;
        if front { ratio * ratio } else { 1.0 / (ratio * ratio) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::script::Script;

    #[test]
    fn mirrors_multiply_and_roulette_keeps_the_mean() {
        let mut weight = EyeWeight::ONE;
        let mut script = Script { events: vec![true, false], ..Script::default() };
        let mirror = [0.5, 0.25, 0.0];
        assert!(weight.attenuate(mirror, &mut script));
        assert_eq!(weight.weight(), [0.5, 0.25, 0.0]);
        assert!(script.asked.is_empty());
        // Y = 0.2126/4 + 0.7152/16 = 0.0979, then 0.0377: below 1/16.
        assert!(weight.attenuate(mirror, &mut script) && script.asked.is_empty());
        assert!(weight.attenuate(mirror, &mut script));
        assert_eq!(script.asked.len(), 1);
        let chance = script.asked[0];
        assert!((weight.weight()[0] * chance - 0.125).abs() < 1e-16);
        assert!((luminance(weight.weight()) - ROULETTE_BELOW).abs() < 1e-16);
        assert!(!weight.attenuate(mirror, &mut script));
        let mut dark = EyeWeight::ONE;
        assert!(!dark.attenuate([0.0; 3], &mut Script::default()));
    }

    #[test]
    fn a_long_path_goes_on_ever_more_rarely_and_heavier() {
        let mut weight = EyeWeight::ONE;
        let mut script = Script { events: vec![true; 1000 - FREE_EVENTS as usize], ..Script::default() };
        assert!((1..=1000).all(|events| weight.outlast(events, &mut script)));
        assert!(script.events.is_empty(), "free until {FREE_EVENTS}, then a draw for each event");
        let chance: f64 = script.asked.iter().product();
        assert!((chance / (32.0f64 / 1000.0).powi(2) - 1.0).abs() < 1e-12);
        assert!((weight.weight()[1] * chance - 1.0).abs() < 1e-12);
        assert!(!weight.outlast(1001, &mut Script { events: vec![false], ..Script::default() }));
    }

    #[test]
    fn into_glass_the_eye_sees_luminance_divided_by_the_square_of_the_index() {
        let glass = Dielectric { ior_outside: 1.0, ior: 1.5 };
        assert!((glass.luminance_factor(true) - 1.0 / 2.25).abs() < 1e-15);
        assert!((glass.luminance_factor(false) - 2.25).abs() < 1e-15);
    }
}
