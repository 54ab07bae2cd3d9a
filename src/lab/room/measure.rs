//! One measurement: N points of a sequence through a scene, every photon reflected M times.

use std::f64::consts::PI;
use std::fmt;
use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use crate::error::{Diagnostic, Kind, Result};
use crate::lab::study::cells::areas_m2;
use crate::lab::study::runs::Clock;
use crate::run::tracer::PointSet;
use crate::sample::method::Sampling;
use crate::scene::Scene;
use crate::sequence::Sequence;
use crate::surface::Fixed;
use crate::tally::WeightedReceivers;
use crate::transport::parallel::{How, trace_range};

/// What to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Task {
    /// The points.
    pub sequence: Sequence,
    /// Their seed; 0 where they have none.
    pub seed: u64,
    /// The first N points; the set of N points of a sequence that is made for their number.
    pub photons: u64,
}

impl fmt::Display for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} photons, {}", self.photons, self.sequence.name())?;
        if self.sequence.is_randomised() { write!(f, ", seed {}", self.seed) } else { Ok(()) }
    }
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Name of the sequence.
    pub sequence: String,
    /// Its seed; 0 where it has none.
    pub seed: u64,
    /// Photons.
    pub photons: u64,
    /// Mean radiance arriving in each cell of the scene's receivers, one receiver after another, by channel:
    /// flux / area / pi, in cd/m2 of a white of which all channels are equal.
    pub radiance: Vec<[f64; 3]>,
    /// Photons that left the scene.
    pub escaped: u64,
    /// Mean and greatest number of coordinates of a photon.
    pub coordinates: (f64, u32),
    /// Time of tracing, s.
    pub trace_s: f64,
}

impl Measurement {
    /// Whether it is that of this task.
    pub fn is_of(&self, task: &Task) -> bool {
        self.sequence == task.sequence.name() && self.seed == task.seed && self.photons == task.photons
    }
}

/// The reflections M that a scene names.
pub(super) fn reflections(scene: &Scene) -> Result<u32> {
    let required = "[compare] with reflections = M, the number of reflections of every photon";
    let missing = || Diagnostic::new(Kind::Missing, "a scene without [compare]", required);
    scene.compared_reflections.ok_or_else(missing)
}

/// Traces the photons of a task through exactly M reflections each; `progress` is told the number of photons
/// after each batch. The same numbers, time apart, with any number of threads.
///
/// # Errors
/// A scene without `[compare]`; more photons than [`WeightedReceivers`] has room for; an interrupt.
pub fn measure(
    scene: &Scene,
    task: &Task,
    clock: Clock,
    interrupt: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Measurement> {
    let reflections = reflections(scene)?;
    let &Task { sequence, seed, photons } = task;
    let points = PointSet { sequence, seed, replicate: 0, number: photons }.any()?;
    let arrivals = arrivals(scene, reflections);
    let tally = WeightedReceivers::new(&scene.geometry, &scene.receivers, photons, arrivals)?;
    let started = clock()?;
    let how = How { reuse: true, sampling: Sampling::default(), interrupt, progress };
    let carried = Fixed::white(reflections);
    let traced = trace_range(scene, &scene.emitters, &points, 0..photons, carried, how, || tally.sink());
    if !traced.complete {
        let found = format!("an interrupt before {task} were traced");
        return Err(Diagnostic::new(Kind::Interrupted, found, "all of them for a result"));
    }
    let luminous = scene.emitters.flux_lm() / photons as f64 / PI;
    let radiance = |(cell, area): (usize, &f64)| tally.weight(cell).map(|w| luminous * w / area);
    Ok(Measurement {
        sequence: sequence.name().to_string(),
        seed,
        photons,
        radiance: areas_m2(&scene.receivers).iter().enumerate().map(radiance).collect(),
        escaped: traced.ledger.escaped,
        coordinates: (traced.census.dimension_mean(), traced.census.dimension_max),
        trace_s: clock()?.saturating_sub(started).as_secs_f64(),
    })
}

/// Most arrivals of a photon that can count in one cell: M + 1, but beyond those a photon passes dielectrics
/// as often as roulette lets it. Photons of coloured light count as often as their strongest channel
/// outweighs white's.
fn arrivals(scene: &Scene, reflections: u32) -> u32 {
    let passes = scene.receivers.iter().any(|r| scene.material(r.surface).is_transparent());
    let arrivals = if passes { crate::transport::walk::MAX_EVENTS } else { reflections + 1 };
    let emitters = 0..scene.emitters.as_slice().len();
    let strongest = emitters.flat_map(|e| scene.emitter_colour(e)).fold(1.0, f64::max);
    arrivals * strongest.ceil() as u32
}
