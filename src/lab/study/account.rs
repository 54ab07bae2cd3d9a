//! The coordinates that a photon uses, predicted from the events it goes through, beside the paper's
//! equations.
//!
//! The prediction shares nothing with the counter in [`crate::sample::coordinates`]: events are counted as
//! the walk asks for them, and the rules of METHOD 1 and 2 are applied to the counts; the proposals of a
//! rejection come from the table's integrals.

use crate::emitter::{Emits, Emitter};
use crate::run::Algorithm;
use crate::sample::choose::Reusable;
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sample::method::{Rejection, Sampling};
use crate::scene::Scene;
use crate::sequence::Points;
use crate::sequence::independent::IndependentPoints;
use crate::surface::{Grey, Incidence, Kind, Rgb, Throughput};
use crate::transport::census::Exceptions;
use crate::transport::{Arrival, End, Sink, walk};

use crate::lab::study::results::Account;

/// Photons whose events are counted.
const PHOTONS: u64 = 1 << 16;

/// What photons of a scene go through, on average over photons.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Events {
    /// Events at a mirror or a dielectric, B_s.
    pub specular: f64,
    /// Scatterings by other surfaces, B_d.
    pub scattered: f64,
    /// 1 for a photon that escapes, 2 for one that is absorbed: C.
    pub end: f64,
    /// Events with more than one outcome.
    pub decisions: f64,
    /// Coordinates that those take with renormalisation: one for all, and one more whenever fewer than 24
    /// bits are left.
    pub shared: f64,
    /// Continuous coordinates of scattered directions.
    pub continuous: f64,
    /// Of those, the ones of tables, two each.
    pub tables: f64,
    /// Choices of a slice and of a cell of a table, which share the first of those two with renormalisation.
    pub table_choices: f64,
    /// Proposals that tables take by rejection: inside cells, against the largest value.
    pub table_proposals: [f64; 2],
}

impl Events {
    /// Counts the events of the scene's first 2^16 photons under independent points.
    pub fn count(scene: &Scene) -> Self {
        count(scene, &IndependentPoints::new(0, 0))
    }

    /// The account of an algorithm, coordinates a photon.
    pub fn account(&self, scene: &Scene, algorithm: Algorithm) -> Account {
        let events = if algorithm.variant.reuses() { self.shared } else { self.decisions };
        Account {
            by_event: emission(scene, algorithm) + events + self.scattering(algorithm),
            equation_4: 3.0 + self.specular + 3.0 * self.scattered + self.end,
            equation_6: 2.0 + 2.0 * self.scattered + self.end,
        }
    }

    /// Coordinates of scattered directions.
    fn scattering(&self, algorithm: Algorithm) -> f64 {
        let others = self.continuous - self.tables;
        let choices = if algorithm.variant.reuses() { 0.0 } else { self.table_choices };
        let [cells, whole] = self.table_proposals;
        match algorithm.sampling() {
            Sampling::Inverse(_) => others + self.tables + choices,
            Sampling::Rejection(Rejection::Cell) => others + 3.0 * cells + choices,
            // No cell is chosen: one choice a scattering less.
            Sampling::Rejection(Rejection::Table | Rejection::NextPoint) => {
                others + 3.0 * whole + (choices - 0.5 * self.tables).max(0.0)
            }
        }
    }
}

/// Coordinates of an emission: the choices (emitter, cell), each with a coordinate of its own unless they are
/// shared, then the direction.
fn emission(scene: &Scene, algorithm: Algorithm) -> f64 {
    let emitters = scene.emitters.as_slice();
    let chosen_emitter = emitters.iter().filter(|e| e.flux_lm() > 0.0).count() > 1;
    let of_emitter = |emitter: &Emitter| {
        let (sampling, table) = (algorithm.sampling(), emitter.table());
        let chooses_cell = !matches!(sampling, Sampling::Rejection(Rejection::Table | Rejection::NextPoint));
        let chosen_cell = chooses_cell && table.is_some_and(|grid| !grid.choice().is_single());
        let choices = f64::from(u8::from(chosen_emitter) + u8::from(chosen_cell));
        let direction = match (sampling, table) {
            (Sampling::Rejection(Rejection::Cell), Some(grid)) => 3.0 * grid.proposals_of_cells(),
            (Sampling::Rejection(_), Some(grid)) => 3.0 * grid.proposals_of_table(),
            _ => f64::from(emitter.kind().coordinates),
        };
        let own = if algorithm.variant.reuses() { 0.0 } else { choices };
        emitter.flux_lm() / scene.emitters.flux_lm() * (own + direction)
    };
    emitters.iter().map(of_emitter).sum()
}

fn count<P: Points>(scene: &Scene, points: &P) -> Events {
    let (mut seen, mut sink) = (Events::default(), Arrivals { scene, events: Events::default() });
    for index in 0..PHOTONS {
        let mut chooser =
            Watched { inner: Coordinates::new(points, index, true), index, seen: &mut seen, span: None };
        let Some((emitter, emission)) = scene.emitters.emit(Sampling::default(), &mut chooser.inner) else {
            continue;
        };
        let start = scene.start(emitter);
        let exceptions = &mut Exceptions::default();
        let end = if scene.is_coloured() {
            let carried = Rgb::WHITE.tinted(scene.emitter_colour(emitter));
            walk(scene, emission, start, carried, &mut chooser, &mut sink, exceptions)
        } else {
            walk(scene, emission, start, Grey, &mut chooser, &mut sink, exceptions)
        };
        match end {
            End::Absorbed(surface) => {
                // The last arrival was no scattering.
                sink.events.end += 2.0;
                if scene.material(surface).scatters() {
                    sink.events.scattered -= 1.0;
                }
            }
            End::Escaped | End::Missed | End::Killed | End::Trapped(_) => sink.events.end += 1.0,
        }
    }
    let (a_photon, arrived) = (|sum: f64| sum / PHOTONS as f64, sink.events);
    Events {
        specular: a_photon(arrived.specular),
        scattered: a_photon(arrived.scattered),
        end: a_photon(arrived.end),
        decisions: a_photon(seen.decisions),
        shared: a_photon(seen.shared),
        continuous: a_photon(seen.continuous),
        tables: a_photon(seen.tables),
        table_choices: a_photon(seen.table_choices),
        table_proposals: arrived.table_proposals.map(a_photon),
    }
}

/// Counts arrivals by what the surface is.
struct Arrivals<'s> {
    scene: &'s Scene,
    events: Events,
}

impl<T> Sink<T> for Arrivals<'_> {
    fn arrive(&mut self, arrival: &Arrival<'_, T>) {
        let material = self.scene.material(arrival.hit.surface);
        match material.kind() {
            Kind::Specular => self.events.specular += 1.0,
            Kind::Scattering => {
                self.events.scattered += 1.0;
                let proposals = material.proposals(&Incidence::of(arrival.hit, arrival.direction, [1.0; 2]));
                for (sum, proposals) in self.events.table_proposals.iter_mut().zip(proposals) {
                    *sum += proposals;
                }
            }
            Kind::Absorbing => {}
        }
    }
}

/// Passes questions on and counts them.
struct Watched<'p, P> {
    inner: Coordinates<'p, P>,
    index: u64,
    seen: &'p mut Events,
    /// Probability of what was decided on the coordinate in use; `None` before the first.
    span: Option<f64>,
}

impl<P: Points> Watched<'_, P> {
    fn decided(&mut self, probability: f64, happened: bool) {
        if probability > 0.0 && probability < 1.0 {
            self.seen.decisions += 1.0;
            self.share(if happened { probability } else { 1.0 - probability });
        }
    }

    /// An event of this probability on the coordinate of all events.
    fn share(&mut self, probability: f64) {
        // Of 64 bits 24 must be left: 40 may be spent.
        let left = self.span.filter(|span| -span.log2() <= 40.0);
        if left.is_none() {
            self.seen.shared += 1.0;
        }
        self.span = Some(left.unwrap_or(1.0) * probability);
    }
}

impl<P: Points> Chooser for Watched<'_, P> {
    fn happens(&mut self, probability: f64) -> bool {
        let happened = self.inner.happens(probability);
        self.decided(probability, happened);
        happened
    }

    fn survives(&mut self, probability: f64) -> bool {
        // The last survivors go on by a number that is no coordinate.
        if self.span.is_some_and(|span| span * 2f64.powi((self.index | 1).ilog2() as i32) < 4.0) {
            self.span = Some(1.0);
        }
        let survived = self.inner.survives(probability);
        self.decided(probability, survived);
        survived
    }

    fn uniform(&mut self, purpose: Purpose) -> f64 {
        self.seen.continuous += 1.0;
        self.inner.uniform(purpose)
    }

    fn reusable(&mut self, purpose: Purpose) -> Reusable {
        // Only tables ask for these, for two each.
        self.seen.continuous += 1.0;
        self.seen.tables += 1.0;
        self.inner.reusable(purpose)
    }

    fn decide<R>(&mut self, purpose: Purpose, choice: impl FnOnce(&mut Reusable) -> R) -> R {
        self.seen.table_choices += 1.0;
        let mut probability = 1.0;
        let chosen = self.inner.decide(purpose, |u| {
            let before = u.span();
            let chosen = choice(u);
            probability = u.span() / before;
            chosen
        });
        self.share(probability);
        chosen
    }

    fn left(&mut self, left: f64, probability: f64, purpose: Purpose) -> f64 {
        // A row and a column: without renormalisation they are one choice, of a cell.
        if probability < 1.0 {
            self.seen.table_choices += 0.5;
        }
        self.inner.left(left, probability, purpose)
    }
}
