//! All replicates of a run, advanced together: what there is of each, to be traced on, kept, and added up.
//!
//! Points are functions of (seed, replicate, index), sums are integers: parts of the indices that were traced elsewhere or
//! earlier are added, and nobody can tell (METHOD 7).

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::ops::Range;
use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use crate::error::Result;
use crate::math::varint::{damaged, put, take};
use crate::scene::Scene;
use crate::tally::Receivers;
use crate::transport::parallel::Traced;

use super::kept::{check_kept, counters};
use super::outcome::Outcome;
use super::plan::Plan;
use super::tracer::Tracer;

/// A total is looked at where there is a photon for so many counters: a photon takes some hundred times as long as the sum
/// over a counter, so that all sums take about a percent of the time.
pub(super) const COUNTERS_PER_PHOTON: u64 = 8;

/// All replicates of a run, or of each of them the photons of one part of the indices.
#[derive(Debug)]
pub struct Together<'s> {
    pub(super) scene: &'s Scene,
    pub(super) plan: Plan,
    part: Range<u64>,
    replicas: Vec<Replica<'s>>,
}

/// A replicate as far as it is traced.
#[derive(Debug)]
struct Replica<'s> {
    tracer: Tracer<'s>,
    receivers: Receivers<'s>,
    traced: Traced,
    octaves: Octaves,
}

/// Photons on each receiver by octaves of the index: under k those of [2^(k-1), 2^k), under the first all before. Of them comes
/// the error after every doubling, whoever traced which part.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Octaves {
    /// The first that is counted by itself.
    first: u32,
    counts: BTreeMap<u32, Vec<u64>>,
}

/// What moves a run on is watched and stopped by this.
#[derive(Clone, Copy)]
pub struct Watched<'a> {
    /// Set from outside to stop.
    pub interrupt: &'a AtomicBool,
    /// Told numbers of photons as they are done.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

impl<'s> Together<'s> {
    /// Nothing traced yet, of a scene and a plan.
    ///
    /// # Errors
    /// Far fields and spots of more replicates than there is room for.
    pub fn new(scene: &'s Scene, plan: &Plan) -> Result<Self> {
        Self::of_part(scene, plan, 0..plan.photons_per_replicate())
    }

    /// The same of a part of the indices of every replicate.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_part(scene: &'s Scene, plan: &Plan, part: Range<u64>) -> Result<Self> {
        check_kept(scene, plan)?;
        let replicas = (0..plan.replicates()).map(|r| Replica::new(scene, plan, r, part.start)).collect();
        Ok(Self { scene, plan: *plan, part, replicas })
    }

    /// The indices of each replicate that this is to trace.
    pub fn part(&self) -> Range<u64> {
        self.part.clone()
    }

    /// The scene.
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The first index that some replicate has not traced.
    pub fn done(&self) -> u64 {
        self.replicas.iter().map(|replica| replica.tracer.photons).min().unwrap_or(0)
    }

    /// The first index that no replicate has traced: that of [`Self::done`] but where replicates were added.
    pub fn farthest(&self) -> u64 {
        self.replicas.iter().map(|replica| replica.tracer.photons).max().unwrap_or(0)
    }

    /// Whether all is traced.
    pub fn is_done(&self) -> bool {
        self.done() == self.part.end
    }

    /// Photons traced so far, over all replicates.
    pub fn photons(&self) -> u64 {
        self.replicas.iter().map(|replica| replica.tracer.photons - self.part.start).sum()
    }

    /// Units of a photon in far fields.
    pub fn units_of_a_photon(&self) -> u64 {
        self.replicas.first().map_or(0, |replica| replica.receivers.far_fields().units_of_a_photon())
    }

    /// Counters of all replicates.
    pub(super) fn counters(&self) -> u64 {
        counters(self.scene, &self.plan)
    }

    /// Traces all replicates up to this index; false where an interrupt came before: then counters hold photons that are no
    /// fair sample, and nothing may be made of them any more.
    ///
    /// # Errors
    /// Those of [`Tracer::trace`].
    pub fn trace(&mut self, end: u64, watched: Watched<'_>) -> Result<bool> {
        let Watched { interrupt, progress } = watched;
        self.trace_by(end, |tracer, end, receivers| tracer.trace(end, receivers, interrupt, progress))
    }

    /// The same by other hands, which take a tracer on to an index and add every arrival to the receivers once.
    ///
    /// # Errors
    /// Those of tracing.
    pub fn trace_by(
        &mut self,
        end: u64,
        step: impl Fn(&mut Tracer<'s>, u64, &Receivers<'s>) -> Result<Traced> + Sync,
    ) -> Result<bool> {
        let part_end = self.part.end;
        // Threads that one replicate leaves idle go on with the next.
        self.replicas.par_iter_mut().try_for_each(|replica| replica.trace(end, part_end, &step))?;
        Ok(self.replicas.iter().all(|replica| replica.traced.complete))
    }

    /// The index up to which the photons of all replicates belong to one octave, and which is no farther than `end`: where a
    /// part of them that is traced elsewhere has to be added.
    pub(super) fn stage(&self, end: u64) -> u64 {
        let open = self.replicas.iter().filter(|replica| replica.tracer.photons < end);
        open.map(Replica::octave).min().map_or(end, |octave| octave.min(end))
    }

    /// The indices up to `end` that are not traced, by replicate.
    pub(super) fn open(&self, end: u64) -> Vec<Range<u64>> {
        self.replicas.iter().map(|replica| replica.tracer.photons..end).collect()
    }

    /// Traces some photons of a replicate, to be told of by [`Self::took`].
    ///
    /// # Errors
    /// Those of [`Tracer::trace`].
    pub(super) fn task(&self, replicate: u32, range: Range<u64>, watched: Watched<'_>) -> Result<Traced> {
        let Replica { tracer, receivers, .. } = &self.replicas[replicate as usize];
        let mut tracer = *tracer;
        tracer.move_to(range.start, range.start);
        tracer.trace(range.end, receivers, watched.interrupt, watched.progress)
    }

    /// A task of a replicate is done.
    pub(super) fn took(&mut self, replicate: u32, traced: &Traced) {
        self.replicas[replicate as usize].traced.merge(traced);
    }

    /// All photons up to the end of a [`Self::stage`] are traced, and what was counted elsewhere has been added.
    pub(super) fn close(&mut self, end: u64) {
        let part_end = self.part.end;
        self.replicas.par_iter_mut().for_each(|replica| replica.close(end, part_end));
    }

    /// Counts nothing any more, for the next stage of a process whose photons were added elsewhere.
    pub(super) fn clear(&mut self) {
        let scene = self.scene;
        self.replicas.par_iter_mut().for_each(|replica| {
            replica.receivers.clear();
            replica.traced = Traced::new(scene);
        });
    }

    /// What each replicate counted, as bytes.
    pub(super) fn counted(&self) -> io::Result<Vec<Vec<u8>>> {
        let replicas = self.replicas.par_iter();
        replicas
            .map(|Replica { receivers, traced, .. }| {
                let mut bytes = Vec::new();
                traced.write(&mut bytes)?;
                receivers.write(&mut bytes)?;
                Ok(bytes)
            })
            .collect()
    }

    /// Adds what each replicate counted elsewhere.
    ///
    /// # Errors
    /// What is of another run.
    pub(super) fn add_counted(&mut self, counted: &[Vec<u8>]) -> io::Result<()> {
        if counted.len() != self.replicas.len() {
            return Err(damaged(&format!("{} replicates instead of {}", counted.len(), self.replicas.len())));
        }
        self.replicas.par_iter_mut().zip(counted).try_for_each(|(replica, bytes)| {
            let mut from = &bytes[..];
            replica.traced.add_from(&mut from)?;
            replica.receivers.add_from(&mut from)?;
            if from.is_empty() { Ok(()) } else { Err(damaged(&format!("{} bytes too many", from.len()))) }
        })
    }

    /// Takes what there is in the place of what an outcome held. All replicates have come equally far.
    pub(super) fn sum_up(&self, outcome: &mut Outcome) {
        outcome.replace(self.replicas.iter().map(|replica| (&replica.traced, &replica.receivers)));
    }

    /// Photons of each replicate on each receiver among those with an index below 2^k, by k.
    pub(super) fn doublings(&self) -> BTreeMap<u32, Vec<Vec<u64>>> {
        let mut doublings: BTreeMap<u32, Vec<Vec<u64>>> = BTreeMap::new();
        for replica in &self.replicas {
            let mut sums = vec![0; self.scene.receivers.len()];
            for (k, counts) in &replica.octaves.counts {
                sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
                if 1 << k <= self.done() {
                    doublings.entry(*k).or_default().push(sums.clone());
                }
            }
        }
        doublings
    }

    /// All parts of the indices have been added.
    pub fn whole(&mut self) {
        let end = self.part.end;
        self.replicas.iter_mut().for_each(|replica| replica.tracer.move_to(end, end));
    }

    /// Writes how far each replicate is, and everything that it counted.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        for Replica { tracer, receivers, traced, octaves } in &self.replicas {
            put(out, [tracer.photons, tracer.attempts()])?;
            octaves.write(out)?;
            traced.write(out)?;
            receivers.write(out)?;
        }
        Ok(())
    }

    /// Adds what so many first replicates of the same run counted elsewhere or earlier, and goes on from where they came to.
    ///
    /// # Errors
    /// Those of the reader; what is of another run.
    pub fn add_from(&mut self, from: &mut dyn Read, replicates: u32) -> io::Result<()> {
        for replica in self.replicas.iter_mut().take(replicates as usize) {
            let (photons, attempts) = (take(from)?, take(from)?);
            if !(self.part.start..=self.part.end).contains(&photons) || attempts < photons {
                return Err(damaged(&format!("photons to number {photons}")));
            }
            replica.octaves.add_from(from)?;
            replica.traced.add_from(from)?;
            replica.receivers.add_from(from)?;
            replica.tracer.move_to(photons, attempts);
        }
        Ok(())
    }
}

impl<'s> Replica<'s> {
    fn new(scene: &'s Scene, plan: &Plan, replicate: u32, start: u64) -> Self {
        let (seed, n) = (plan.seed(), plan.photons_per_replicate());
        let mut tracer = Tracer::new(scene, plan.algorithm(), seed, replicate, n);
        tracer.move_to(start, start);
        // Of one replicate, so that it does not depend on their number.
        let few = (counters(scene, plan) / u64::from(plan.replicates()) / COUNTERS_PER_PHOTON).max(1 << 5);
        let first = few.next_power_of_two().trailing_zeros();
        Self {
            tracer,
            receivers: Receivers::of_scene(scene, n),
            traced: Traced::new(scene),
            octaves: Octaves { first, counts: BTreeMap::new() },
        }
    }

    fn trace(
        &mut self,
        end: u64,
        part_end: u64,
        step: impl Fn(&mut Tracer<'s>, u64, &Receivers<'s>) -> Result<Traced>,
    ) -> Result<()> {
        while self.tracer.photons < end && self.traced.complete {
            let octave = self.octave();
            let next = octave.min(end);
            let more = step(&mut self.tracer, next, &self.receivers)?;
            self.traced.merge(&more);
            if more.complete {
                self.close_octave(octave, next, part_end);
            }
        }
        Ok(())
    }

    /// The end of the octave in which the next photon is.
    fn octave(&self) -> u64 {
        (self.tracer.photons + 1).next_power_of_two().max(1 << self.octaves.first)
    }

    /// All photons up to `end`, in the octave of the next one, are traced.
    fn close(&mut self, end: u64, part_end: u64) {
        if self.tracer.photons < end {
            let octave = self.octave();
            self.tracer.move_to(end, end);
            self.close_octave(octave, end, part_end);
        }
    }

    fn close_octave(&mut self, octave: u64, end: u64, part_end: u64) {
        if end == octave || end == part_end {
            self.octaves.close(octave.trailing_zeros(), &self.receivers);
        }
    }
}

impl Octaves {
    /// Everything that was counted since the last one belongs to this one.
    fn close(&mut self, octave: u32, receivers: &Receivers<'_>) {
        let mut counts = receivers.totals();
        for before in self.counts.values() {
            counts.iter_mut().zip(before).for_each(|(count, before)| *count = count.saturating_sub(*before));
        }
        let sums = self.counts.entry(octave).or_insert_with(|| vec![0; counts.len()]);
        sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
    }

    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        put(out, [self.counts.len() as u64])?;
        for (octave, counts) in &self.counts {
            put(out, [u64::from(*octave), counts.len() as u64])?;
            put(out, counts.iter().copied())?;
        }
        Ok(())
    }

    fn add_from(&mut self, from: &mut dyn Read) -> io::Result<()> {
        for _ in 0..take(from)? {
            let (octave, receivers) = (take(from)?, take(from)?);
            if octave > u64::from(u64::BITS) || receivers > MOST_RECEIVERS {
                return Err(damaged("an octave that no run has"));
            }
            let counts = (0..receivers).map(|_| take(from)).collect::<io::Result<Vec<_>>>()?;
            let sums = self.counts.entry(octave as u32).or_insert_with(|| vec![0; counts.len()]);
            for (sum, count) in sums.iter_mut().zip(counts) {
                *sum = sum.checked_add(count).ok_or_else(|| damaged("a count of more than 64 bits"))?;
            }
        }
        Ok(())
    }
}

/// More receivers than any scene has.
const MOST_RECEIVERS: u64 = 1 << 24;
