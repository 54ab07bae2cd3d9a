//! What a run found: sums over replicates, and the numbers with their standard errors that come of them.

use std::collections::BTreeMap;

use crate::error::{Diagnostic, Kind};
use crate::estimate::diagnosis::{Counted, Diagnosis};
use crate::estimate::extremes::{Extremes, Interval, Map, Unknown};
use crate::estimate::far_field::{self, Sums, Table};
use crate::estimate::replicates::{standard_error_of_cell, standard_error_of_total};
use crate::scene::Scene;
use crate::tally::counts::Counts;
use crate::tally::spot::{SpotCount, SpotTally};
use crate::tally::{Moments, Receivers};
use crate::transport::parallel::Traced;
use crate::transport::{Census, Ledger};

use super::goal::ErrorOf;
use super::plan::Plan;

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoppedBy {
    /// All photons are traced.
    Photons,
    /// The error that was asked for is reached.
    Error,
    /// The time that was given is over.
    Time,
    /// It was interrupted; what is here are the first 2^m photons of every replicate. Where replicates are traced one
    /// after another: those finished by then, or, before the first was, the first 2^m photons of it.
    Interrupt,
}

/// What a run found: counts of photons by cell and account, from which [`Outcome::illuminance_lx`] and the
/// others make numbers with their errors.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was asked for.
    pub plan: Plan,
    /// Photons that the sums stand for: fewer than planned after an interrupt.
    pub photons: u64,
    /// Replicates that the sums stand for.
    pub replicates: u32,
    /// Flux of one photon, lm: 0 before there is one.
    pub photon_lm: f64,
    /// Flux of all emitters, lm.
    flux_lm: f64,
    /// Where photons began and ended.
    pub ledger: Ledger,
    /// Photons absorbed by each surface, escaped, killed, trapped.
    pub(super) accounts: Moments,
    /// Of every cell, by receiver.
    pub(super) cells: Vec<Moments>,
    /// Of each receiver's total: one entry a receiver.
    pub(super) totals: Moments,
    /// What each replicate counted.
    pub(super) by_replicate: Vec<ReplicateTotals>,
    /// Of every cell of an evaluation grid, by receiver; empty where it has none.
    pub(super) grids: Vec<Moments>,
    /// Of each evaluation grid's total.
    pub(super) grid_totals: Moments,
    /// Of every receiver whose spot is measured: what each replicate counted.
    pub(super) spots: Vec<Vec<SpotCount>>,
    /// Of every far field.
    pub(super) far_fields: Vec<Sums>,
    /// Arrivals on the side of each receiver on which it does not count.
    pub turned_away: Vec<u64>,
    /// Arrivals on the side of each receiver on which it counts, of a history that it does not count.
    pub other_events: Vec<u64>,
    /// Coordinates and exceptions.
    pub census: Census,
    /// Time of tracing, s.
    pub trace_s: f64,
    /// Why it ended.
    pub stopped_by: StoppedBy,
    /// The error that it was to reach, where it was.
    pub reached: Option<Reached>,
    /// Photons of each replicate on each receiver among those with an index below 2^k, by k; empty where replicates were traced
    /// one after another.
    pub(crate) doublings: BTreeMap<u32, Vec<Vec<u64>>>,
}

/// An error that was asked for, and what came of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// What it is of.
    pub of: ErrorOf,
    /// The relative standard error that was asked for, as a fraction.
    pub asked: f64,
    /// What it is now, of the receiver where it is largest; `None` where it is not known.
    pub error: Option<f64>,
}

impl Reached {
    /// Whether the error is as small as was asked for.
    pub fn is_met(&self) -> bool {
        self.error.is_some_and(|error| error <= self.asked)
    }
}

/// What one replicate counted in all: of it come errors of differences between runs of the same points, and what the spread
/// of replicates looks like.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReplicateTotals {
    /// Photons on each receiver.
    pub receivers: Vec<u64>,
    /// Photons absorbed by each surface, then those escaped, then those killed, then those trapped.
    pub accounts: Vec<u64>,
}

/// A number and its standard error (one sigma), both in the unit that the function which gives it names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error from the spread of the replicates (METHOD 7); `None` where there is a single one.
    pub standard_error: Option<f64>,
}

impl Outcome {
    /// Nothing yet, of a scene to be traced by this plan.
    pub(super) fn new(scene: &Scene, plan: &Plan) -> Self {
        let surfaces = scene.geometry.surfaces().len();
        Self {
            plan: *plan,
            photons: 0,
            replicates: 0,
            photon_lm: 0.0,
            flux_lm: scene.emitters.flux_lm(),
            ledger: Ledger::new(scene.emitters.as_slice().len(), surfaces),
            accounts: Moments::new(surfaces + 3),
            cells: scene.receivers.iter().map(|r| Moments::new(r.cells.len())).collect(),
            totals: Moments::new(scene.receivers.len()),
            by_replicate: Vec::new(),
            grids: scene.receivers.iter().map(|r| Moments::new(r.grid.map_or(0, |g| g.cells()))).collect(),
            grid_totals: Moments::new(scene.receivers.len()),
            spots: vec![Vec::new(); scene.receivers.len()],
            far_fields: vec![Sums::of_photons(plan.photons_per_replicate()); scene.far_fields.len()],
            turned_away: vec![0; scene.receivers.len()],
            other_events: vec![0; scene.receivers.len()],
            census: Census::default(),
            trace_s: 0.0,
            stopped_by: StoppedBy::Photons,
            reached: None,
            doublings: BTreeMap::new(),
        }
    }

    /// Adds a replicate: its ledger and census, and what its receivers counted.
    pub(super) fn add(&mut self, traced: &Traced, receivers: &Receivers<'_>) {
        self.add_accounts(traced, receivers);
        for (receiver, moments) in self.cells.iter_mut().enumerate() {
            moments.absorb(receivers.counts(receiver).iter());
        }
        for (receiver, moments) in self.grids.iter_mut().enumerate() {
            moments.absorb(receivers.grid(receiver).into_iter().flat_map(Counts::iter));
        }
    }

    fn add_accounts(&mut self, traced: &Traced, receivers: &Receivers<'_>) {
        let Traced { ledger, census, .. } = traced;
        self.stand_for(self.photons + ledger.total_emitted());
        self.replicates += 1;
        self.ledger.merge(ledger);
        self.census.merge(census);
        let others = [ledger.escaped, ledger.killed, ledger.total_trapped()];
        let accounts: Vec<u64> = ledger.absorbed.iter().copied().chain(others).collect();
        self.accounts.absorb(accounts.iter().copied());
        let on_receivers = receivers.totals();
        self.totals.absorb(on_receivers.iter().copied());
        self.by_replicate.push(ReplicateTotals { receivers: on_receivers, accounts });
        let refused = [
            (&mut self.turned_away, receivers.turned_away()),
            (&mut self.other_events, receivers.other_events()),
        ];
        for (sums, counts) in refused {
            sums.iter_mut().zip(counts.iter()).for_each(|(sum, count)| *sum += count);
        }
        for (receiver, spot) in self.spots.iter_mut().enumerate() {
            spot.extend(receivers.spot(receiver).map(SpotTally::counted));
        }
        let counted = receivers.far_fields();
        for (field, sums) in self.far_fields.iter_mut().enumerate() {
            sums.absorb(
                counted.nodes(field).iter().collect(),
                counted.outside().get(field),
                counted.seen().get(field),
            );
        }
        self.grid_totals.absorb((0..self.cells.len()).map(|r| receivers.grid(r).map_or(0, Counts::total)));
    }

    /// Takes replicates that have come equally far, each with its receivers, in the place of what there was.
    pub(super) fn replace<'a>(
        &mut self,
        replicas: impl Iterator<Item = (&'a Traced, &'a Receivers<'a>)> + Clone,
    ) {
        self.clear_accounts();
        for (traced, receivers) in replicas.clone() {
            self.add_accounts(traced, receivers);
        }
        for (receiver, moments) in self.cells.iter_mut().enumerate() {
            let counts: Vec<_> = replicas.clone().map(|(_, receivers)| receivers.counts(receiver)).collect();
            moments.replace(&counts);
        }
        for (receiver, moments) in self.grids.iter_mut().enumerate() {
            let counts: Vec<_> =
                replicas.clone().filter_map(|(_, receivers)| receivers.grid(receiver)).collect();
            moments.replace(&counts);
        }
    }

    /// The sums stand for so many photons.
    pub(super) fn stand_for(&mut self, photons: u64) {
        self.photons = photons;
        self.photon_lm = self.flux_lm / photons.max(1) as f64;
    }

    /// The run is over: what it found, or that it found nothing.
    ///
    /// # Errors
    /// An interrupt before there was a result, for which it takes `fewest` photons.
    pub(super) fn finished(self, fewest: u64) -> crate::error::Result<Self> {
        if self.photons == 0 {
            return Err(Diagnostic::new(
                Kind::Interrupted,
                format!("an interrupt before the first {fewest} photons were traced"),
                "at least these for a result",
            ));
        }
        Ok(self)
    }

    /// Nothing again.
    pub(super) fn clear(&mut self) {
        self.clear_accounts();
        self.cells.iter_mut().chain(&mut self.grids).for_each(Moments::clear);
    }

    fn clear_accounts(&mut self) {
        (self.photons, self.replicates, self.census) = (0, 0, Census::default());
        self.by_replicate.clear();
        self.turned_away.fill(0);
        self.other_events.fill(0);
        self.spots.iter_mut().for_each(Vec::clear);
        self.far_fields.iter_mut().for_each(Sums::clear);
        self.ledger = Ledger::new(self.ledger.emitted.len(), self.ledger.absorbed.len());
        [&mut self.accounts, &mut self.totals, &mut self.grid_totals].into_iter().for_each(Moments::clear);
    }

    /// Photons counted in the cells of each receiver, row by row from the top left, or face by face.
    pub fn cells(&self) -> &[Moments] {
        &self.cells
    }

    /// Photons counted on each receiver.
    pub fn totals(&self) -> &Moments {
        &self.totals
    }

    /// What each replicate counted in all, in their order.
    pub(crate) fn by_replicate(&self) -> &[ReplicateTotals] {
        &self.by_replicate
    }

    /// What replicates and doublings say of a receiver at which a photon arrives at most once, or not; `None` for one replicate.
    pub(crate) fn diagnosis(&self, receiver: usize, is_once: bool) -> Option<Diagnosis> {
        let photons = self.photons / u64::from(self.replicates.max(1));
        let on = |totals: &ReplicateTotals| totals.receivers[receiver];
        // An interrupt may have come after a doubling that is not in the sums.
        let is_summed = |(k, counts): &(&u32, &Vec<Vec<u64>>)| {
            **k < u64::BITS && 1 << **k <= photons && counts.len() == self.by_replicate.len()
        };
        let of = |counts: &Vec<Vec<u64>>| counts.iter().map(|counts| counts[receiver]).collect();
        let first = self.doublings.iter().filter(is_summed).map(|(k, counts)| (1 << k, of(counts))).collect();
        Counted { photons, on_receiver: self.by_replicate().iter().map(on).collect(), first, is_once }
            .diagnosis()
    }

    /// Photons absorbed by each surface, then those escaped, then those killed, then those trapped.
    pub fn accounts(&self) -> &Moments {
        &self.accounts
    }

    /// Illuminance in a cell of a receiver with this cell area, lx.
    pub fn illuminance_lx(&self, receiver: usize, cell: usize, area_m2: f64) -> Estimate {
        self.estimate(&self.cells[receiver], cell, self.photon_lm / area_m2, standard_error_of_cell)
    }

    /// The darkest and the brightest cell of a receiver with these cell areas, in photons a square metre, and their
    /// uniformities.
    ///
    /// # Errors
    /// Why they are not known.
    pub(crate) fn extremes(&self, receiver: usize, areas_m2: &[f64]) -> Result<Extremes, Unknown> {
        let (sum, square) = (self.totals.sum[receiver], self.totals.square[receiver]);
        let error_of_sum = standard_error_of_total(sum, square, self.replicates);
        Map { cells: &self.cells[receiver], areas_m2, error_of_sum, replicates: self.replicates }.extremes()
    }

    /// The brightest cell of a receiver with these cell areas, lx; `None` where it is not known.
    pub(crate) fn peak_lx(&self, receiver: usize, areas_m2: &[f64]) -> Option<Interval> {
        let (cells, replicates) = (&self.cells[receiver], self.replicates);
        let peak = Map { cells, areas_m2, error_of_sum: None, replicates }.peak();
        peak.map(|peak| peak.times(self.photon_lm))
    }

    /// The mean of a receiver's evaluation grid in photons a square metre, and the extremes of its cells of this area.
    pub(crate) fn grid(&self, receiver: usize, area_m2: f64) -> (Estimate, Result<Extremes, Unknown>) {
        let (cells, total) = (&self.grids[receiver], &self.grid_totals);
        let unit = 1.0 / (area_m2 * cells.sum.len() as f64);
        let mean = self.estimate(total, receiver, unit, standard_error_of_total);
        let error_of_sum = mean.standard_error.map(|error| error / unit);
        (mean, Map { cells, areas_m2: &[area_m2], error_of_sum, replicates: self.replicates }.extremes())
    }

    /// Mean illuminance over a cell of a receiver's evaluation grid with this cell area, lx.
    pub fn grid_illuminance_lx(&self, receiver: usize, cell: usize, area_m2: f64) -> Estimate {
        self.estimate(&self.grids[receiver], cell, self.photon_lm / area_m2, standard_error_of_cell)
    }

    /// Photons in the cells of a receiver's evaluation grid.
    pub fn grid_cells(&self, receiver: usize) -> &Moments {
        &self.grids[receiver]
    }

    /// What each replicate counted of a receiver's spot; nothing where it is not measured.
    pub(crate) fn spot(&self, receiver: usize) -> &[SpotCount] {
        &self.spots[receiver]
    }

    /// Flux that arrived at a receiver, lm.
    pub fn receiver_flux_lm(&self, receiver: usize) -> Estimate {
        self.total(&self.totals, receiver)
    }

    /// The table of a far field, cd.
    pub(crate) fn far_field(&self, scene: &Scene, field: usize) -> Table {
        far_field::table(&scene.far_fields[field], &self.far_fields[field], self.photon_lm)
    }

    /// What a far field saw in all, what of it was inside its nodes, and what outside, lm.
    pub(crate) fn far_field_lm(&self, field: usize) -> [Estimate; 3] {
        let sums = &self.far_fields[field];
        let inside: Vec<u64> = sums.seen.iter().zip(&sums.outside).map(|(seen, out)| seen - out).collect();
        [&sums.seen, &inside, &sums.outside].map(|by_replicate| {
            let (photons, error) = far_field::total(by_replicate);
            let standard_error = error.map(|error| error * self.photon_lm);
            Estimate { value: photons as f64 * self.photon_lm, standard_error }
        })
    }

    /// Photons that a far field saw, by replicate.
    pub(crate) fn far_field_seen(&self, field: usize) -> &[u64] {
        &self.far_fields[field].seen
    }

    /// Flux absorbed by a surface, lm.
    pub fn absorbed_lm(&self, surface: usize) -> Estimate {
        self.total(&self.accounts, surface)
    }

    /// Flux that left the scene, lm.
    pub fn escaped_lm(&self) -> Estimate {
        self.total(&self.accounts, self.ledger.absorbed.len())
    }

    /// Flux of photons ended by the guard, lm.
    pub fn killed_lm(&self) -> Estimate {
        self.total(&self.accounts, self.ledger.absorbed.len() + 1)
    }

    /// Flux kept for ever by total reflection, lm.
    pub fn trapped_lm(&self) -> Estimate {
        self.total(&self.accounts, self.ledger.absorbed.len() + 2)
    }

    fn total(&self, moments: &Moments, at: usize) -> Estimate {
        self.estimate(moments, at, self.photon_lm, standard_error_of_total)
    }

    /// A count of photons in a unit, what one photon is worth.
    fn estimate(
        &self,
        moments: &Moments,
        at: usize,
        unit: f64,
        error: fn(u64, u128, u32) -> Option<f64>,
    ) -> Estimate {
        let (sum, square) = (moments.sum[at], moments.square[at]);
        let standard_error = error(sum, square, self.replicates).map(|e| e * unit);
        Estimate { value: sum as f64 * unit, standard_error }
    }
}
