//! What decides: a photon's coordinates ([`super::coordinates::Coordinates`]), or a script.

use super::choose::{Reusable, SMALLEST_SPAN, TWO_TO_64};
use super::discrete::Discrete;
use super::method::Sampling;
use crate::sequence::to_unit_f64;

/// What a coordinate was drawn for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Which emitter and which table cell; what is left places the photon inside the cell along theta.
    Emission,
    /// The first continuous coordinate of an emission, where the one above could not serve.
    EmissionTheta,
    /// The second continuous coordinate of an emission.
    EmissionPhi,
    /// The place within a beam's cross-section or on a panel.
    BeamPosition,
    /// A discrete event at a surface.
    Event,
    /// A scattered direction.
    Scatter,
    /// Whether a proposed direction is accepted: rejection only.
    Acceptance,
}

impl Purpose {
    /// What every purpose is called in reports, in the order of the counters.
    pub const LABELS: [&'static str; 7] =
        ["emission", "emission theta", "emission phi", "beam position", "event", "scatter", "acceptance"];
}

/// What makes the decisions of a walk: a photon's coordinates, or a script.
pub trait Chooser {
    /// Whether an event of this probability happens. Probabilities at or beyond 0 and 1 decide themselves and
    /// cost nothing.
    fn happens(&mut self, probability: f64) -> bool;
    /// Whether a photon goes on that does so with this probability: an event of which there may be any number in a row.
    #[inline]
    fn survives(&mut self, probability: f64) -> bool {
        self.happens(probability)
    }

    /// A continuous coordinate in [0, 1).
    fn uniform(&mut self, purpose: Purpose) -> f64;

    /// A coordinate that serves discrete choices first ([`Self::choose_by`]) and as a continuous one last
    /// ([`Self::rest`]).
    #[inline]
    fn reusable(&mut self, purpose: Purpose) -> Reusable {
        Reusable::fresh((self.uniform(purpose) * TWO_TO_64) as u64)
    }

    /// A choice among more than one outcome on `u`; a spent coordinate is replaced first. Where a coordinate
    /// does not go on after a choice, it is spent then.
    #[inline]
    fn choose_by<R>(
        &mut self,
        u: &mut Reusable,
        purpose: Purpose,
        choice: impl FnOnce(&mut Reusable) -> R,
    ) -> R {
        if u.is_spent() {
            *u = self.reusable(purpose);
        }
        let chosen = choice(u);
        if !self.reuses() {
            u.spend();
        }
        chosen
    }

    /// An event of `table` on `u`, by [`Self::choose_by`] where there is more than one.
    #[inline]
    fn choose(&mut self, table: &Discrete, u: &mut Reusable, purpose: Purpose) -> usize {
        if table.is_single() {
            return table.choose(u).0;
        }
        self.choose_by(u, purpose, |u| table.choose(u).0)
    }

    /// What is left of `u` as a continuous coordinate; a fresh one where too little is.
    #[inline]
    fn rest(&mut self, u: Reusable, purpose: Purpose) -> f64 {
        if u.is_spent() { self.uniform(purpose) } else { to_unit_f64(u.bits()) }
    }

    /// Whether a coordinate goes on after a choice.
    #[inline]
    fn reuses(&self) -> bool {
        true
    }

    /// A choice among more than one outcome: one more of the photon's events, where these share a coordinate;
    /// else on a coordinate of this purpose.
    #[inline]
    fn decide<R>(&mut self, purpose: Purpose, choice: impl FnOnce(&mut Reusable) -> R) -> R {
        choice(&mut self.reusable(purpose))
    }

    /// What is left of a coordinate after a choice of this probability, for a last use; a fresh one where too
    /// little is.
    #[inline]
    fn left(&mut self, left: f64, probability: f64, purpose: Purpose) -> f64 {
        if probability < SMALLEST_SPAN { self.uniform(purpose) } else { left }
    }

    /// How tables of scattering are sampled.
    #[inline]
    fn sampling(&self) -> Sampling {
        Sampling::default()
    }
}
