//! One point set of one algorithm, traced range by range.

use std::sync::atomic::AtomicBool;

use crate::error::{Diagnostic, Kind, Result};
use crate::scene::Scene;
use crate::sequence::independent::IndependentPoints;
use crate::sequence::other::OtherPoints;
use crate::sequence::owen::OwenPoints;
use crate::sequence::sobol::SobolPoints;
use crate::sequence::{Points, Sequence};
use crate::surface::{Grey, Rgb, Throughput};
use crate::tally::Receivers;
use crate::transport::Sink;
use crate::transport::attempts::advance;
use crate::transport::parallel::{How, Traced, trace_range};

use super::algorithm::Algorithm;

/// What is done with the points of a sequence: the one place where a sequence's name becomes a type, so that
/// the walk is compiled for it.
pub trait UsePoints {
    /// What comes of it.
    type Output;
    /// Does it.
    fn with<P: Points>(self, points: &P) -> Self::Output;
}

/// A set of points: a sequence under one randomisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PointSet {
    /// The sequence.
    pub sequence: Sequence,
    /// Seed of its randomisation.
    pub seed: u64,
    /// Which of the independent randomisations under that seed.
    pub replicate: u32,
    /// Number of points, which some sequences must know.
    pub number: u64,
}

impl PointSet {
    /// Hands the points over.
    ///
    /// # Errors
    /// A sequence that cannot have this many points.
    pub fn provide<U: UsePoints>(&self, user: U) -> Result<U::Output> {
        Ok(match self.sequence {
            Sequence::Independent => user.with(&IndependentPoints::new(self.seed, self.replicate)),
            Sequence::Sobol => user.with(&SobolPoints),
            Sequence::SobolOwen => user.with(&OwenPoints::new(self.seed, self.replicate)),
            _ => user.with(&self.any()?),
        })
    }

    /// The points behind one type, for uses that are not worth a walk compiled for each sequence.
    ///
    /// # Errors
    /// A sequence that cannot have this many points.
    pub fn any(&self) -> Result<OtherPoints> {
        OtherPoints::new(self.sequence, self.seed, self.replicate, Some(self.number))
    }
}

/// Follows a point set through a scene; each call goes on where the last one ended.
#[derive(Debug, Clone, Copy)]
pub struct Tracer<'s> {
    scene: &'s Scene,
    algorithm: Algorithm,
    /// The points it follows.
    pub points: PointSet,
    /// Photons traced so far.
    pub photons: u64,
    /// Points used so far: more than photons where rejected points give none.
    attempts: u64,
}

impl<'s> Tracer<'s> {
    /// At the first of `number` points.
    pub fn new(scene: &'s Scene, algorithm: Algorithm, seed: u64, replicate: u32, number: u64) -> Self {
        let points = PointSet { sequence: algorithm.sequence, seed, replicate, number };
        Self { scene, algorithm, points, photons: 0, attempts: 0 }
    }

    /// Points used so far.
    pub fn attempts(&self) -> u64 {
        self.attempts
    }

    /// Goes on from this photon and this point, which another tracer came to, or which it left out.
    pub(super) fn move_to(&mut self, photons: u64, attempts: u64) {
        (self.photons, self.attempts) = (photons, attempts);
    }

    /// Traces up to photon number `until`.
    ///
    /// # Errors
    /// A sequence that cannot have this many points; rejection by next point on a sequence that ends or with
    /// several emitters; a ledger that does not balance (a defect of the program).
    pub fn trace(
        &mut self,
        until: u64,
        receivers: &Receivers<'_>,
        interrupt: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Traced> {
        let sink = || receivers.sink();
        // A scene in colour is traced by one walk for all sequences, any other by a walk compiled for its
        // own.
        if self.scene.is_coloured() {
            return self.trace_into(until, Rgb::WHITE, sink, interrupt, progress);
        }
        let stage = Stage { tracer: self, how: self.how(interrupt, progress)?, until, sink };
        let (traced, attempts) = self.points.provide(stage)?;
        self.moved_on(until, attempts, traced)
    }

    /// Traces up to photon number `until` with arrivals in a sink of any kind, by one walk for all sequences.
    ///
    /// # Errors
    /// Those of [`Self::trace`].
    pub fn trace_into<T: Throughput, S: Sink<T>>(
        &mut self,
        until: u64,
        carried: T,
        sink: impl Fn() -> S + Sync,
        interrupt: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Traced> {
        let how = self.how(interrupt, progress)?;
        let stage = Stage { tracer: self, how, until, sink };
        let (traced, attempts) = stage.carrying(&self.points.any()?, carried);
        self.moved_on(until, attempts, traced)
    }

    fn how<'a>(&self, interrupt: &'a AtomicBool, progress: &'a (dyn Fn(u64) + Sync)) -> Result<How<'a>> {
        self.algorithm.check_skipping(self.scene.emitters.is_single())?;
        let (reuse, sampling) = (self.algorithm.variant.reuses(), self.algorithm.sampling());
        Ok(How { reuse, sampling, interrupt, progress })
    }

    fn moved_on(&mut self, until: u64, attempts: u64, traced: Traced) -> Result<Traced> {
        let ledger = &traced.ledger;
        if !ledger.is_balanced() {
            return Err(Diagnostic::new(
                Kind::Geometry,
                format!("{} photons begun, {} ended", ledger.total_emitted(), ledger.total_ended()),
                "every photon to end exactly once: this is a defect of caustix, please report it with the scene",
            ));
        }
        (self.photons, self.attempts) = (until, attempts);
        Ok(traced)
    }
}

/// The photons up to number `until`, still to be traced.
struct Stage<'a, 's, F> {
    tracer: &'a Tracer<'s>,
    how: How<'a>,
    until: u64,
    sink: F,
}

impl<S: Sink<Grey>, F: Fn() -> S + Sync> UsePoints for Stage<'_, '_, F> {
    type Output = (Traced, u64);

    fn with<P: Points>(self, points: &P) -> Self::Output {
        self.carrying(points, Grey)
    }
}

impl<F> Stage<'_, '_, F> {
    fn carrying<P: Points, T: Throughput, S: Sink<T>>(self, points: &P, carried: T) -> (Traced, u64)
    where
        F: Fn() -> S + Sync,
    {
        let Self { tracer, how, until, sink } = self;
        let (scene, start) = (tracer.scene, tracer.attempts);
        let wanted = until.saturating_sub(tracer.photons);
        let skips = how.sampling.skips_points();
        let end = if skips { advance(scene, points, &how, start, wanted) } else { start + wanted };
        (trace_range(scene, &scene.emitters, points, start..end, carried, how, sink), end)
    }
}
