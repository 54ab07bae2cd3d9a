//! What an eye path carries: the part of the luminance ahead of it that reaches the eye.
//!
//! A way multiplies it by its part of the flux and by its [`crate::surface::Way::luminance_factor`]. Roulette
//! ends paths that have become faint or long.

use crate::sample::coordinates::Chooser;
use crate::surface::Way;
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

    /// Follows a way that was chosen with this chance.
    #[inline]
    pub fn follow(&mut self, way: &Way, chance: f64) {
        for (w, part) in self.weight.iter_mut().zip(way.part) {
            *w = *w * (part / chance) * way.luminance_factor;
        }
    }

    /// Russian roulette: paths of small weight end with probability 1 - q, survivors are divided by q.
    /// Whether the path goes on.
    #[inline]
    pub fn roulette<C: Chooser>(&mut self, chooser: &mut C) -> bool {
        let y = luminance(self.weight);
        y >= ROULETTE_BELOW || self.survives(y / ROULETTE_BELOW, chooser)
    }

    #[inline]
    fn survives<C: Chooser>(&mut self, q: f64, chooser: &mut C) -> bool {
        let survives = chooser.happens(q);
        if survives {
            self.weight = self.weight.map(|w| w * (1.0 / q));
        }
        survives
    }

    /// Russian roulette by length: whether the path goes on after so many events. Total reflection keeps
    /// light in glass without loss, often for good. A path of [`FREE_EVENTS`] becomes one of n events with
    /// the probability (FREE_EVENTS / n)^2, so that its length has a mean of 2 FREE_EVENTS however it is
    /// caught; its weight grows no faster than n^2, so that light which becomes rarer with n in any constant
    /// proportion has a finite variance.
    #[inline]
    pub fn outlast<C: Chooser>(&mut self, events: u32, chooser: &mut C) -> bool {
        events <= FREE_EVENTS || {
            let ratio = f64::from(events - 1) / f64::from(events);
            self.survives(ratio * ratio, chooser)
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::surface::tests::Script;

    #[test]
    fn mirrors_multiply_and_roulette_keeps_the_mean() {
        let mut weight = EyeWeight::ONE;
        let mut script = Script::new([true, false], []);
        let mirror = |part| Way { direction: DVec3::Z, part, luminance_factor: 1.0 };
        let meet = |weight: &mut EyeWeight, part, script: &mut Script| {
            weight.follow(&mirror(part), 1.0);
            weight.roulette(script)
        };
        let red = [0.5, 0.25, 0.0];
        assert!(meet(&mut weight, red, &mut script));
        assert_eq!(weight.weight(), [0.5, 0.25, 0.0]);
        assert!(script.asked.is_empty());
        // Y = 0.2126/4 + 0.7152/16 = 0.0979, then 0.0377: below 1/16.
        assert!(meet(&mut weight, red, &mut script) && script.asked.is_empty());
        assert!(meet(&mut weight, red, &mut script));
        assert_eq!(script.asked.len(), 1);
        let chance = script.asked[0];
        assert!((weight.weight()[0] * chance - 0.125).abs() < 1e-16);
        assert!((luminance(weight.weight()) - ROULETTE_BELOW).abs() < 1e-16);
        assert!(!meet(&mut weight, red, &mut script));
        let mut dark = EyeWeight::ONE;
        assert!(!meet(&mut dark, [0.0; 3], &mut Script::default()));
    }

    #[test]
    fn a_long_path_goes_on_ever_more_rarely_and_heavier() {
        let mut weight = EyeWeight::ONE;
        let mut script = Script::new([true; 1000 - FREE_EVENTS as usize], []);
        assert!((1..=1000).all(|events| weight.outlast(events, &mut script)));
        assert!(script.events.is_empty(), "free until {FREE_EVENTS}, then a draw for each event");
        let chance: f64 = script.asked.iter().product();
        assert!((chance / (32.0f64 / 1000.0).powi(2) - 1.0).abs() < 1e-12);
        assert!((weight.weight()[1] * chance - 1.0).abs() < 1e-12);
        assert!(!weight.outlast(1001, &mut Script::new([false], [])));
    }
}
