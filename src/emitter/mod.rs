//! Where photons start.
//!
//! An emitter turns coordinates into a start and a direction; every photon of a scene carries the same flux, so emitters
//! are chosen in proportion to theirs ([`Emitters`], METHOD 2: the chooser's coordinate goes on to the table cell).
//!
//! To add an emitter: a file beside these, a line in [`Emitter`], arms in its methods; the scene file's name for it
//! is given in `scene`.

pub mod collimated;
pub mod direct;
pub mod colour;
pub mod isotropic;
pub mod panel;
pub mod photometric;
mod spherical_rectangle;

use glam::DVec3;

use crate::error::{Diagnostic, Kind, Result};
use crate::math::solve::Solver;
use crate::sample::choose::Reusable;
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sample::discrete::Discrete;
use crate::sample::method::Sampling;
use crate::sample::uniform_map::UniformMap;
use crate::sequence::Points;

pub use collimated::Collimated;
pub use direct::DirectLight;
pub use isotropic::Isotropic;
pub use panel::Panel;
pub use photometric::Photometric;

/// The start of a photon.
#[derive(Debug, Clone, Copy)]
pub struct Emission {
    /// Where.
    pub origin: DVec3,
    /// Where to; unit.
    pub direction: DVec3,
}

/// Everything that can emit.
#[derive(Debug, Clone)]
pub enum Emitter {
    /// A point with a table of luminous intensity.
    Photometric(Box<Photometric>),
    /// A point that emits alike in all directions.
    Isotropic(Isotropic),
    /// A beam of parallel light.
    Collimated(Collimated),
    /// A Lambertian rectangle.
    Panel(Panel),
}

impl Emitter {
    /// Luminous flux in lumens.
    pub fn flux_lm(&self) -> f64 {
        match self {
            Self::Photometric(e) => e.flux_lm(),
            Self::Isotropic(e) => e.flux_lm,
            Self::Collimated(e) => e.flux_lm,
            Self::Panel(e) => e.flux_lm(),
        }
    }

    /// A photon's start by inverse functions, tables by this solver; `u` is the coordinate that chose the emitter, renormalised.
    #[inline]
    pub fn emit<P: Points>(
        &self,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
        solver: Solver,
    ) -> Emission {
        match self {
            Self::Photometric(e) => e.emit(u, coordinates, solver),
            Self::Isotropic(e) => e.emit(u, coordinates),
            Self::Collimated(e) => e.emit(u, coordinates),
            Self::Panel(e) => e.emit(u, coordinates),
        }
    }

    /// The same by a given way of sampling tables. `None` where this point of the sequence gives no photon, which only
    /// rejection knows.
    #[inline]
    pub fn emit_by<P: Points>(
        &self,
        sampling: Sampling,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<Emission> {
        match (self, sampling) {
            (_, Sampling::Inverse(solver)) => Some(self.emit(u, coordinates, solver)),
            (Self::Photometric(e), Sampling::Rejection(_)) => e.emit_by(sampling, u, coordinates),
            // Nothing else has a table: there is nothing to reject, and no equation to solve.
            (_, Sampling::Rejection(_)) => Some(self.emit(u, coordinates, Solver::DEFAULT)),
        }
    }

    /// Continuous coordinates of an emission: two for a direction or a place, four for both.
    pub const fn continuous_coordinates(&self) -> f64 {
        match self {
            Self::Photometric(_) | Self::Isotropic(_) | Self::Collimated(_) => 2.0,
            Self::Panel(_) => 4.0,
        }
    }

    /// A point of the emitter: where the photons of a point emitter start, the middle of a beam's cross-section or of a
    /// panel.
    pub fn centre(&self) -> DVec3 {
        match self {
            Self::Photometric(e) => e.position(),
            Self::Isotropic(e) => e.position,
            Self::Collimated(e) => e.centre,
            Self::Panel(e) => e.centre(),
        }
    }

    /// Bytes held beyond the enum itself.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Self::Photometric(e) => size_of::<Photometric>() + e.grid().memory_bytes(),
            Self::Isotropic(_) | Self::Collimated(_) | Self::Panel(_) => 0,
        }
    }
}

/// All emitters of a scene, chosen by flux.
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
    /// No emitter, a flux that is negative or not finite, and a total of zero.
    pub fn new(emitters: Vec<Emitter>) -> Result<Self> {
        let fluxes: Vec<f64> = emitters.iter().map(Emitter::flux_lm).collect();
        let flux_lm: f64 = fluxes.iter().sum();
        match Discrete::new(&fluxes) {
            Some(choice) if flux_lm.is_finite() => Ok(Self { emitters, choice, flux_lm }),
            _ => Err(Diagnostic::new(
                Kind::Range,
                format!("{} emitters with {flux_lm} lm in all", emitters.len()),
                "at least one emitter with positive flux",
            )),
        }
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

    /// Starts a photon by inverse functions: the index of its emitter and where it starts. A single emitter costs no choice.
    #[inline]
    pub fn emit<P: Points>(&self, coordinates: &mut Coordinates<'_, P>) -> (usize, Emission) {
        let mut u = coordinates.draw_reusable(Purpose::Emission);
        let which = coordinates.choose(&self.choice, &mut u, Purpose::Emission);
        (which, self.emitters[which].emit(u, coordinates, Solver::DEFAULT))
    }

    /// The same by a given way of sampling tables; `None` where this point of the sequence gives no photon.
    #[inline]
    pub fn emit_by<P: Points>(
        &self,
        sampling: Sampling,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<(usize, Emission)> {
        let mut u = coordinates.draw_reusable(Purpose::Emission);
        let which = coordinates.choose(&self.choice, &mut u, Purpose::Emission);
        Some((which, self.emitters[which].emit_by(sampling, u, coordinates)?))
    }
}

/// The emission of references: from a table in directions uniform in solid angle, weighted; from anything else as ever.
#[derive(Debug, Clone)]
pub struct WeightedEmitters<'e> {
    emitters: &'e Emitters,
    maps: Vec<Option<UniformMap>>,
}

impl<'e> WeightedEmitters<'e> {
    /// The maps of these emitters.
    ///
    /// # Errors
    /// None for emitters that stand in a scene.
    pub fn new(emitters: &'e Emitters) -> Result<Self> {
        let map = |emitter: &Emitter| match emitter {
            Emitter::Photometric(e) => UniformMap::new(e.grid()).map(Some),
            Emitter::Isotropic(_) | Emitter::Collimated(_) | Emitter::Panel(_) => Ok(None),
        };
        Ok(Self { emitters, maps: emitters.emitters.iter().map(map).collect::<Result<_>>()? })
    }

    /// Starts a photon: the index of its emitter, where it starts, and its weight, 1 on average.
    pub fn emit<P: Points>(&self, coordinates: &mut Coordinates<'_, P>) -> (usize, Emission, f64) {
        let mut u = coordinates.draw_reusable(Purpose::Emission);
        let which = coordinates.choose(&self.emitters.choice, &mut u, Purpose::Emission);
        let (emission, weight) = match (&self.emitters.emitters[which], &self.maps[which]) {
            (Emitter::Photometric(e), Some(map)) => e.emit_weighted(map, u, coordinates),
            (emitter, _) => (emitter.emit(u, coordinates, Solver::DEFAULT), 1.0),
        };
        (which, emission, weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::independent::IndependentPoints;

    fn lamp(flux_lm: f64) -> Emitter {
        Emitter::Isotropic(Isotropic { position: DVec3::splat(flux_lm), flux_lm })
    }

    #[test]
    fn emitters_are_chosen_by_flux() {
        let emitters = Emitters::new(vec![lamp(100.0), lamp(0.0), lamp(300.0)]).unwrap();
        assert_eq!(emitters.flux_lm(), 400.0);
        let points = IndependentPoints::new(1, 0);
        let n = 100_000;
        let mut count = [0.0; 3];
        for i in 0..n {
            let (which, emission) = emitters.emit(&mut Coordinates::new(&points, i, true));
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
            emitters.emit(&mut c);
            assert_eq!(c.drawn(), expected);
        }
    }

    #[test]
    fn a_scene_without_flux_is_refused() {
        assert!(Emitters::new(vec![]).is_err());
        assert!(Emitters::new(vec![lamp(0.0)]).is_err());
        assert!(Emitters::new(vec![lamp(f64::NAN)]).is_err());
    }
}
