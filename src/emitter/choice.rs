//! All emitters of a scene, chosen by flux.

use super::{Emission, Emits, Emitter};
use crate::error::Invalid;
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sample::discrete::Discrete;
use crate::sample::method::Sampling;
use crate::sequence::Points;

/// All emitters of a scene.
#[derive(Debug, Clone)]
pub struct Emitters {
    emitters: Vec<Emitter>,
    choice: Discrete,
    flux_lm: f64,
}

impl Emitters {
    /// The emitters of a scene.
    ///
    /// # Errors
    /// No emitter; more flux than a number holds.
    pub fn new(emitters: Vec<Emitter>) -> Result<Self, Invalid> {
        let fluxes: Vec<f64> = emitters.iter().map(Emits::flux_lm).collect();
        let flux_lm: f64 = fluxes.iter().sum();
        match Discrete::new(&fluxes) {
            Some(choice) if flux_lm.is_finite() => Ok(Self { emitters, choice, flux_lm }),
            _ => Err(Invalid::Content {
                what: "emitter",
                found: format!("{} emitters with {flux_lm} lm in all", emitters.len()),
                required: "at least one emitter with positive flux".into(),
            }),
        }
    }

    /// The same light for references: directions of tables uniform in solid angle, photons with weights; all else as ever.
    ///
    /// # Errors
    /// None for emitters that stand in a scene.
    pub fn with_weights(&self) -> Result<Self, Invalid> {
        let mut weighted = self.clone();
        for emitter in &mut weighted.emitters {
            if let Emitter::Photometric(e) = emitter {
                *e = e.with_weights()?;
            }
        }
        Ok(weighted)
    }

    /// Sum of the fluxes, lm.
    pub fn flux_lm(&self) -> f64 {
        self.flux_lm
    }

    /// Whether one emitter has all the flux, so that none is chosen.
    pub fn is_single(&self) -> bool {
        self.choice.is_single()
    }

    /// The emitters in the order of the scene.
    pub fn as_slice(&self) -> &[Emitter] {
        &self.emitters
    }

    /// Starts a photon: the index of its emitter and where it starts; `None` where this point of the sequence gives no photon.
    /// A single emitter costs no choice.
    #[inline]
    pub fn emit<P: Points>(
        &self,
        sampling: Sampling,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<(usize, Emission)> {
        let mut u = coordinates.draw_reusable(Purpose::Emission);
        let which = coordinates.choose(&self.choice, &mut u, Purpose::Emission);
        Some((which, self.emitters[which].emit(sampling, u, coordinates)?))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::Isotropic;
    use super::*;
    use crate::sequence::independent::IndependentPoints;

    fn lamp(flux_lm: f64) -> Emitter {
        Emitter::Isotropic(Isotropic::new(DVec3::splat(flux_lm), flux_lm).unwrap())
    }

    #[test]
    fn emitters_are_chosen_by_flux() {
        let emitters = Emitters::new(vec![lamp(100.0), lamp(1e-9), lamp(300.0)]).unwrap();
        assert_eq!(emitters.flux_lm(), 400.0 + 1e-9);
        let points = IndependentPoints::new(1, 0);
        let n = 100_000;
        let mut count = [0.0; 3];
        for i in 0..n {
            let mut c = Coordinates::new(&points, i, true);
            let (which, emission) = emitters.emit(Sampling::default(), &mut c).unwrap();
            assert_eq!(emission.origin.x, emitters.as_slice()[which].flux_lm());
            count[which] += 1.0;
        }
        assert_eq!(count[1], 0.0);
        let z = (count[0] - 0.25 * n as f64) / (n as f64 * 0.1875).sqrt();
        assert!(z.abs() < 4.0, "{z}");
    }

    #[test]
    fn reuse_saves_the_coordinate_of_the_choice() {
        let emitters = Emitters::new(vec![lamp(100.0), lamp(300.0)]).unwrap();
        let points = IndependentPoints::new(1, 0);
        for (reuse, expected) in [(true, 2), (false, 3)] {
            let mut c = Coordinates::new(&points, 0, reuse);
            emitters.emit(Sampling::default(), &mut c);
            assert_eq!(c.drawn(), expected);
        }
    }
}
