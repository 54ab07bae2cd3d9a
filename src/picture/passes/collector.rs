//! The passes of a picture from photon maps: photons are kept up to the camera's memory, shown to the camera,
//! dropped.
//!
//! Photons are accepted range by range of a replicate's indices; a range is a power of two where memory
//! decides it, so that it is a net by itself. How many photons a range will leave is foretold from those
//! before it. Where that fails the store is full before the range ends: receivers have counted it, its
//! photons are dropped, and it is traced again in halves for the camera alone.

use std::io::{self, Read, Write};
use std::ops::Range;
use std::sync::atomic::Ordering;
use std::time::Instant;

use crate::error::Result;
use crate::math::varint::{expect, put, put_reals, take, take_real, take_up_to};
use crate::picture::camera::Pass;
use crate::picture::photon_map::{Channels, Kept, Photon, PhotonMap, PhotonStore, SavedMap};
use crate::picture::summary::{Cost, PictureSummary};
use crate::picture::{Picture, Watch, hash_of_photons, settings_of};
use crate::run::turns::{KeepTurns, Turns, Unkept};
use crate::run::{Plan, Tracer};
use crate::scene::Scene;
use crate::scene::camera::Camera;
use crate::tally::Receivers;
use crate::transport::parallel::Traced;

use super::budget::{Budget, capacity};
use super::eye::Eye;

/// Tiles that are seen before it is looked whether what there is should be kept.
const TILES_AT_A_TIME: usize = 256;

/// Photons on their way into a picture.
pub(crate) struct Collector<'a, const C: usize> {
    scene: &'a Scene,
    plan: Plan,
    watch: Watch<'a>,
    eye: Eye<'a, C>,
    store: PhotonStore<C>,
    budget: Budget,
    held: Kept<C>,
    /// Replicates of `held`: whole ones, or a part of one.
    held_of: Range<u32>,
    /// Whether the last of them is whole.
    whole: bool,
    /// Replicates of all that was accepted.
    replicates: u32,
    /// Photons of the run as planned.
    planned: u64,
    passes: u32,
    /// Whether the last pass was of a part of a replicate that is to go on.
    open: bool,
    camera_s: f64,
    /// Tiles that have been seen of a pass in which a run stands that goes on.
    in_pass: Option<usize>,
    keep: &'a dyn KeepTurns,
}

impl<'a, const C: usize> Collector<'a, C> {
    /// For the camera of a scene.
    ///
    /// # Errors
    /// A camera that cannot see, or whose pixels need too much memory.
    pub(crate) fn new(
        scene: &'a Scene,
        camera: &Camera,
        plan: &Plan,
        hand_out: bool,
        watch: Watch<'a>,
        keep: &'a dyn KeepTurns,
    ) -> Result<Self> {
        Ok(Self {
            scene,
            plan: *plan,
            watch,
            eye: Eye::new(scene, camera, plan, watch)?,
            store: PhotonStore::new(scene),
            budget: Budget::new(capacity::<C>(camera), hand_out),
            held: Kept::default(),
            held_of: 0..0,
            whole: true,
            replicates: 0,
            planned: plan.photons(),
            passes: 0,
            open: false,
            camera_s: 0.0,
            in_pass: None,
            keep,
        })
    }

    /// Takes the tracer of a run on to photon number `end`, in as many ranges as memory asks for; false where that is not
    /// complete. An incomplete range is not accepted.
    ///
    /// # Errors
    /// Those of tracing, and of a pass.
    pub(crate) fn stage<T: Channels<C>>(
        &mut self,
        turns: &mut Turns<'_>,
        end: u64,
        carried: T,
    ) -> Result<bool> {
        if self.in_pass.is_some() {
            // A run that goes on stands in the midst of a pass.
            self.pass(turns, false)?;
        }
        let (n, from) = (self.plan.photons_per_replicate(), turns.tracer.photons);
        // A pass is of whole replicates or of a part of one: the camera's error comes from whole ones.
        if turns.tracer.points.replicate > 0 && from == 0 && self.budget.foretold(n) > self.budget.room() {
            self.pass_unless_empty(turns)?;
        }
        while turns.tracer.photons < end {
            let to = self.budget.next_end(turns.tracer.photons, end);
            if self.budget.foretold(to - turns.tracer.photons) > self.budget.room() {
                self.pass_unless_empty(turns)?;
            }
            let before = turns.tracer;
            let most = self.budget.room();
            let Turns { tracer, receivers, replica, .. } = turns;
            let (traced, kept) = self.range(tracer, to, most, receivers, carried, self.watch.photons)?;
            replica.merge(&traced);
            if !traced.complete {
                return Ok(false);
            }
            match kept {
                Some(kept) => self.accept(kept, &before, to),
                None => self.again(turns, before, to, carried)?,
            }
            if self.keep.is_due() {
                self.keep
                    .keep(turns, &mut |out| self.write(out, &self.held_of, None, self.held.iter().flatten()));
            }
        }
        if end == n && self.open {
            self.pass(turns, false)?;
        }
        Ok(true)
    }

    fn pass_unless_empty(&mut self, turns: &Turns<'_>) -> Result<()> {
        if self.held_of.is_empty() {
            return Ok(());
        }
        self.budget.keep = false;
        self.pass(turns, false).map(|_| ())
    }

    fn range<T: Channels<C>>(
        &mut self,
        tracer: &mut Tracer<'_>,
        to: u64,
        most: usize,
        receivers: &Receivers<'_>,
        carried: T,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<(Traced, Option<Kept<C>>)> {
        self.store.limit(most);
        let replicate = tracer.points.replicate;
        let sink = || self.store.sink(receivers.sink(), replicate);
        let traced = tracer.trace_into(to, carried, sink, self.watch.interrupt, progress)?;
        Ok((traced, self.store.take()))
    }

    /// Takes the photons of a range from `before` to photon number `to` for good.
    fn accept(&mut self, kept: Kept<C>, before: &Tracer<'_>, to: u64) {
        let replicate = before.points.replicate;
        for (held, kept) in self.held.iter_mut().zip(kept) {
            self.budget.held += kept.iter().map(Vec::len).sum::<usize>();
            self.budget.kept += kept.iter().map(|block| block.len() as u64).sum::<u64>();
            held.extend(kept);
        }
        self.budget.traced += to - before.photons;
        if self.held_of.is_empty() {
            self.held_of.start = replicate;
        }
        self.held_of.end = replicate + 1;
        self.whole = to == self.plan.photons_per_replicate();
        self.replicates = self.replicates.max(replicate + 1);
    }

    /// A range that left more photons than there was room for, traced for the camera alone: at once where the
    /// room was what others left, else in halves.
    fn again<T: Channels<C>>(
        &mut self,
        turns: &Turns<'_>,
        before: Tracer<'_>,
        to: u64,
        carried: T,
    ) -> Result<()> {
        let had_all_room = self.budget.held == 0;
        // The run has counted the range already: from here it cannot be gone on from.
        let keep = std::mem::replace(&mut self.keep, &Unkept);
        self.pass_unless_empty(turns)?;
        let nobody = Receivers::new(&self.scene.geometry, &[]);
        let mut tracer = before;
        let mut length = to - before.photons;
        if had_all_room && length > 1 {
            length = length.next_power_of_two() / 2;
        }
        while tracer.photons < to {
            let from = tracer;
            let part = to.min((from.photons / length + 1) * length);
            // What one photon leaves is kept, however much it is.
            let most = if length == 1 { usize::MAX } else { self.budget.room() };
            match self.range(&mut tracer, part, most, &nobody, carried, &|_| {})? {
                (traced, _) if !traced.complete => break,
                (_, Some(kept)) => self.accept(kept, &from, part),
                (_, None) => self.again(turns, from, part, carried)?,
            }
        }
        self.keep = keep;
        Ok(())
    }

    /// Takes the photons of another run of the scene for its own; [`crate::picture::check_saved`] has passed
    /// them.
    pub(crate) fn adopt(&mut self, saved: SavedMap<C>) {
        self.planned = saved.photons_traced;
        self.replicates = saved.replicates;
        (self.held_of, self.whole) = (0..saved.replicates, true);
        self.budget.traced = saved.photons_traced;
        self.budget.kept = saved.photons.len() as u64;
        self.budget.held = saved.photons.len();
        let (scattered, not): (Vec<_>, Vec<_>) = saved.photons.into_iter().partition(Photon::is_scattered);
        self.held = [vec![not], vec![scattered]];
    }

    /// Shows the camera what is held. In the last pass a photon's flux is known exactly; before, it is that
    /// of the run as planned. Light that no photon brings is seen in the last pass.
    fn pass(&mut self, turns: &Turns<'_>, last: bool) -> Result<Option<Vec<Photon<C>>>> {
        let started = Instant::now();
        let first_tile = self.in_pass.take().unwrap_or(0);
        if last {
            self.drop_unfinished();
        }
        let flux_lm = self.scene.emitters.flux_lm();
        let exact_lm = flux_lm / self.budget.traced.max(1) as f64;
        let planned_lm = flux_lm / self.planned.max(1) as f64;
        let photon_lm = if last { exact_lm } else { planned_lm };
        if last && self.passes > 0 && exact_lm != planned_lm {
            // An interrupted run: earlier passes took a photon for less than it turned out to be.
            self.eye.sums.scale(exact_lm / planned_lm);
        }
        let in_pass = self.budget.held as f64;
        // A bandwidth is for the photons of the whole run: a pass has a part of them.
        let part = if self.budget.kept == 0 { 1.0 } else { in_pass / self.budget.kept as f64 };
        let replicates = std::mem::replace(&mut self.held_of, 0..0);
        let (held, frame) = (std::mem::take(&mut self.held), self.store.frame());
        let part_of_run = part * photon_lm / exact_lm;
        let maps = self.eye.maps(held, frame, part_of_run, replicates.len() as u32);
        let densities = self.eye.densities(&maps, photon_lm, part_of_run);
        let pass = Pass {
            densities: &densities,
            replicates: replicates.clone(),
            finishes: self.whole,
            emission: last,
            direct: last,
        };
        let tiles = self.eye.tile_count();
        for first in (first_tile..tiles).step_by(TILES_AT_A_TIME) {
            let end = tiles.min(first + TILES_AT_A_TIME);
            self.eye.look(&pass, first..end)?;
            let is_whole = !self.watch.interrupt.load(Ordering::Relaxed);
            if end < tiles && is_whole && self.keep.is_due() {
                let photons = || maps.iter().map(PhotonMap::photons);
                self.keep.keep(turns, &mut |out| self.write(out, &replicates, Some(end), photons()));
            }
        }
        drop(densities);
        self.budget.held = 0;
        self.open = !self.whole;
        self.passes += 1;
        self.camera_s += started.elapsed().as_secs_f64();
        Ok(self.budget.keep.then(|| maps.each_ref().map(PhotonMap::photons).concat()))
    }

    /// Writes the picture as far as it is, with the photons that are held for a pass, or in it after so many tiles.
    fn write<'p>(
        &self,
        out: &mut dyn Write,
        held_of: &Range<u32>,
        in_pass: Option<usize>,
        mut photons: impl Iterator<Item = impl AsRef<[Photon<C>]>> + 'p,
    ) -> io::Result<()> {
        let Budget { held, traced, kept, keep, .. } = self.budget;
        put(out, [C as u64, held as u64, traced, kept, u64::from(keep)])?;
        put(out, [held_of.start.into(), held_of.end.into(), self.whole.into(), self.replicates.into()])?;
        put(out, [self.passes.into(), self.open.into(), in_pass.map_or(0, |tiles| tiles as u64)])?;
        put_reals(out, [self.camera_s])?;
        self.eye.write(out)?;
        photons.try_for_each(|some| Photon::write_all(some.as_ref(), out))
    }

    /// Goes on from what was written, of the same scene, camera and plan.
    ///
    /// # Errors
    /// Those of the reader; what is of another picture.
    pub(crate) fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        expect(from, C as u64, "channels")?;
        let most = capacity::<C>(&self.eye.view.camera) as u64;
        // What a single photon leaves is held beyond that.
        let held = take_up_to(from, most.max(1 << 24), "photons held")?;
        (self.budget.traced, self.budget.kept) = (take(from)?, take(from)?);
        self.budget.keep = take_up_to(from, 1, "flags")? == 1;
        let replicate = |from: &mut dyn Read| take_up_to(from, self.plan.replicates().into(), "replicates");
        self.held_of = replicate(from)? as u32..replicate(from)? as u32;
        self.whole = take_up_to(from, 1, "flags")? == 1;
        self.replicates = replicate(from)? as u32;
        self.passes = take_up_to(from, u32::MAX.into(), "passes")? as u32;
        self.open = take_up_to(from, 1, "flags")? == 1;
        let tiles = take_up_to(from, self.eye.tile_count() as u64, "tiles")? as usize;
        self.in_pass = Some(tiles).filter(|tiles| *tiles > 0);
        self.camera_s = take_real(from)?;
        self.eye.read(from)?;
        self.held = [vec![Vec::new()], vec![Vec::new()]];
        for _ in 0..held {
            let photon = Photon::read(from, self.scene.geometry.primitive_count())?;
            self.held[usize::from(photon.is_scattered())][0].push(photon);
        }
        self.budget.held = held as usize;
        Ok(())
    }

    /// Drops what an interrupt left of a replicate: its photons are of a part of the emitters' directions,
    /// not a sample of them. Of the first replicate, without which there is nothing, what is finished stays.
    fn drop_unfinished(&mut self) {
        if self.whole || self.replicates < 2 {
            return;
        }
        self.eye.sums.drop_unfinished();
        self.held = Kept::default();
        (self.budget.held, self.held_of) = (0, 0..0);
        self.replicates -= 1;
        self.budget.traced = u64::from(self.replicates) * self.plan.photons_per_replicate();
        (self.whole, self.open) = (true, false);
    }

    /// The picture of all that was accepted.
    ///
    /// # Errors
    /// Those of a pass.
    pub(crate) fn finish(mut self, turns: &Turns<'_>) -> Result<Picture<C>> {
        let kept = self.pass(turns, true)?;
        let photons = kept.map(|photons| SavedMap {
            scene_hash: hash_of_photons(self.scene, &self.plan),
            settings: settings_of(&self.plan),
            photons_traced: self.budget.traced,
            replicates: self.replicates,
            photon_lm: self.scene.emitters.flux_lm() / self.budget.traced.max(1) as f64,
            frame: self.store.frame(),
            photons,
        });
        let (film, summary) = self.eye.finish();
        let summary = PictureSummary {
            cost: Cost::of(&film),
            photons: self.budget.traced,
            replicates: self.replicates,
            photons_kept: self.budget.kept,
            passes: self.passes,
            time_s: self.camera_s,
            ..summary
        };
        Ok(Picture { film, summary, photons })
    }
}
