//! The passes of a picture from photon maps: photons are kept up to the camera's memory, shown to the camera, dropped.
//!
//! Photons are accepted range by range of a replicate's indices; a range is a power of two where memory decides it, so that
//! it is a net by itself. How many photons a range will leave is foretold from those before it. Where that fails the store
//! is full before the range ends: receivers have counted it, its photons are dropped, and it is traced again in halves for
//! the camera alone.

use std::ops::Range;
use std::time::Instant;

use crate::error::Result;
use crate::picture::photon_map::{Channels, Kept, Photon, PhotonMap, PhotonStore, SavedMap};
use crate::picture::summary::{Cost, PictureSummary};
use crate::picture::{Picture, Watch, hash_of_photons, settings_of};
use crate::run::{Plan, Tracer};
use crate::scene::Scene;
use crate::scene::camera::{Camera, Method};
use crate::tally::Receivers;
use crate::transport::parallel::Traced;

use super::eye::{Batch, Eye, Seeing};

/// Bytes of a photon while its map is made: as it was kept, and in the map with its index.
const fn bytes_of_photon<const C: usize>() -> u64 {
    2 * size_of::<Photon<C>>() as u64 + 8
}

/// Most photons that the camera has memory for at a time.
pub(crate) fn capacity<const C: usize>(camera: &Camera) -> usize {
    usize::try_from(camera.photon_memory_bytes / bytes_of_photon::<C>()).unwrap_or(usize::MAX).max(1)
}

/// What photons may leave above what is foretold: an eighth and some, so that few ranges are traced twice.
fn with_reserve(photons: f64) -> f64 {
    1.125 * photons + 1024.0
}

/// Photons on their way into a picture.
pub(crate) struct Collector<'a, const C: usize> {
    scene: &'a Scene,
    plan: Plan,
    watch: Watch<'a>,
    eye: Eye<'a, C>,
    store: PhotonStore<C>,
    /// Most photons at a time.
    capacity: usize,
    held: Kept<C>,
    held_photons: usize,
    /// Photons traced, of which some were kept.
    traced: u64,
    kept: u64,
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
    /// Whether all photons are to be handed out; no longer once they are more than there is room for.
    keep: bool,
    camera_s: f64,
}

impl<'a, const C: usize> Collector<'a, C> {
    /// For the camera of a scene.
    ///
    /// # Errors
    /// A camera that cannot see, or whose pixels need too much memory.
    pub(crate) fn new(
        scene: &'a Scene,
        camera: &'a Camera,
        plan: &Plan,
        keep: bool,
        watch: Watch<'a>,
    ) -> Result<Self> {
        Ok(Self {
            scene,
            plan: *plan,
            watch,
            eye: Eye::new(scene, camera, plan, watch)?,
            store: PhotonStore::new(scene),
            capacity: capacity::<C>(camera),
            held: Kept::default(),
            held_photons: 0,
            traced: 0,
            kept: 0,
            held_of: 0..0,
            whole: true,
            replicates: 0,
            planned: plan.photons(),
            passes: 0,
            open: false,
            keep,
            camera_s: 0.0,
        })
    }

    /// Takes a tracer on to photon number `end`, in as many ranges as memory asks for. An incomplete one is not accepted.
    ///
    /// # Errors
    /// Those of tracing, and of a pass.
    pub(crate) fn stage<T: Channels<C>>(
        &mut self,
        tracer: &mut Tracer<'_>,
        end: u64,
        receivers: &Receivers<'_>,
        carried: T,
    ) -> Result<Traced> {
        let mut all = Traced::new(self.scene);
        let (n, from) = (self.plan.photons_per_replicate(), tracer.photons());
        // A pass is of whole replicates or of a part of one: the camera's error comes from whole ones.
        if tracer.replicate() > 0 && from == 0 && self.foretold(n) > self.room() {
            self.pass_unless_empty()?;
        }
        while tracer.photons() < end && all.complete {
            let to = self.next_end(tracer.photons(), end);
            if self.foretold(to - tracer.photons()) > self.room() {
                self.pass_unless_empty()?;
            }
            let before = *tracer;
            let most = self.room();
            let (traced, kept) = self.range(tracer, to, most, receivers, carried)?;
            all.merge(&traced);
            match kept {
                _ if !traced.complete => {}
                Some(kept) => self.accept(kept, &before, to),
                None => self.again(before, to, carried)?,
            }
        }
        if all.complete && end == n && self.open {
            self.pass(false)?;
        }
        Ok(all)
    }

    fn pass_unless_empty(&mut self) -> Result<()> {
        if self.held_of.is_empty() {
            return Ok(());
        }
        self.keep = false;
        self.pass(false).map(|_| ())
    }

    /// Where the next range ends: at `end`, or where as many photons as there is memory for are to be expected.
    fn next_end(&self, from: u64, end: u64) -> u64 {
        let mut length = end - from;
        if self.foretold(length) <= self.capacity {
            return end;
        }
        length = length.next_power_of_two();
        while length > 1 && self.foretold(length) > self.capacity {
            length /= 2;
        }
        end.min((from / length + 1) * length)
    }

    /// Photons that so many traced ones are likely to leave; 0 while nothing is known, and where all are kept if they can be:
    /// only that they cannot is a reason then.
    fn foretold(&self, photons: u64) -> usize {
        if self.traced == 0 || self.keep {
            return 0;
        }
        with_reserve(photons as f64 * (self.kept as f64 / self.traced as f64)) as usize
    }

    fn room(&self) -> usize {
        self.capacity.saturating_sub(self.held_photons)
    }

    fn range<T: Channels<C>>(
        &mut self,
        tracer: &mut Tracer<'_>,
        to: u64,
        most: usize,
        receivers: &Receivers<'_>,
        carried: T,
    ) -> Result<(Traced, Option<Kept<C>>)> {
        self.store.limit(most);
        let replicate = tracer.replicate();
        let sink = || self.store.sink(receivers.sink(), replicate);
        let traced = tracer.trace_into(to, carried, sink, self.watch.interrupt, self.watch.photons)?;
        Ok((traced, self.store.take()))
    }

    /// Takes the photons of a range from `before` to photon number `to` for good.
    fn accept(&mut self, kept: Kept<C>, before: &Tracer<'_>, to: u64) {
        let replicate = before.replicate();
        for (held, kept) in self.held.iter_mut().zip(kept) {
            self.held_photons += kept.iter().map(Vec::len).sum::<usize>();
            self.kept += kept.iter().map(|block| block.len() as u64).sum::<u64>();
            held.extend(kept);
        }
        self.traced += to - before.photons();
        if self.held_of.is_empty() {
            self.held_of.start = replicate;
        }
        self.held_of.end = replicate + 1;
        self.whole = to == self.plan.photons_per_replicate();
        self.replicates = self.replicates.max(replicate + 1);
    }

    /// A range that left more photons than there was room for, traced for the camera alone: at once where the room was
    /// what others left, else in halves.
    fn again<T: Channels<C>>(&mut self, before: Tracer<'_>, to: u64, carried: T) -> Result<()> {
        let had_all_room = self.held_photons == 0;
        self.pass_unless_empty()?;
        let nobody = Receivers::new(&self.scene.geometry, &[]);
        let silent = Watch { photons: &|_| {}, ..self.watch };
        let watch = std::mem::replace(&mut self.watch, silent);
        let mut tracer = before;
        let mut length = to - before.photons();
        if had_all_room && length > 1 {
            length = length.next_power_of_two() / 2;
        }
        let mut result = Ok(());
        while result.is_ok() && tracer.photons() < to {
            let from = tracer;
            let part = to.min((from.photons() / length + 1) * length);
            // What one photon leaves is kept, however much it is.
            let most = if length == 1 { usize::MAX } else { self.room() };
            result = match self.range(&mut tracer, part, most, &nobody, carried) {
                Err(e) => Err(e),
                Ok((traced, _)) if !traced.complete => break,
                Ok((_, Some(kept))) => {
                    self.accept(kept, &from, part);
                    Ok(())
                }
                Ok((_, None)) => self.again(from, part, carried),
            };
        }
        self.watch = watch;
        result
    }

    /// Takes the photons of another run of the scene for its own; [`crate::picture::check_saved`] has passed them.
    pub(crate) fn adopt(&mut self, saved: SavedMap<C>) {
        self.planned = saved.photons_traced;
        self.replicates = saved.replicates;
        (self.held_of, self.whole) = (0..saved.replicates, true);
        self.traced = saved.photons_traced;
        self.kept = saved.photons.len() as u64;
        self.held_photons = saved.photons.len();
        let (scattered, not): (Vec<_>, Vec<_>) = saved.photons.into_iter().partition(Photon::is_scattered);
        self.held = [vec![not], vec![scattered]];
    }

    /// Shows the camera what is held. In the last pass a photon's flux is known exactly; before, it is that of the run as
    /// planned. Light that no photon brings is seen in the last pass.
    fn pass(&mut self, last: bool) -> Result<Option<Vec<Photon<C>>>> {
        let started = Instant::now();
        if last {
            self.drop_unfinished();
        }
        let flux_lm = self.scene.emitters.flux_lm();
        let exact_lm = flux_lm / self.traced.max(1) as f64;
        let planned_lm = flux_lm / self.planned.max(1) as f64;
        let photon_lm = if last { exact_lm } else { planned_lm };
        if last && self.passes > 0 && exact_lm != planned_lm {
            // An interrupted run: earlier passes took a photon for less than it turned out to be.
            self.eye.scale(exact_lm / planned_lm);
        }
        let in_pass = std::mem::take(&mut self.held_photons) as f64;
        // A bandwidth is for the photons of the whole run: a pass has a part of them.
        let part = if self.kept == 0 { 1.0 } else { in_pass / self.kept as f64 };
        let maps = self.eye.add(Batch {
            photons: std::mem::take(&mut self.held),
            frame: self.store.frame(),
            photon_lm,
            part: part * photon_lm / exact_lm,
            replicates: std::mem::replace(&mut self.held_of, 0..0),
            finishes: self.whole,
            last,
        })?;
        self.open = !self.whole;
        self.passes += 1;
        self.camera_s += started.elapsed().as_secs_f64();
        Ok(self.keep.then(|| maps.each_ref().map(PhotonMap::photons).concat()))
    }

    /// Drops what an interrupt left of a replicate: its photons are of a part of the emitters' directions, not a sample of
    /// them. Of the first replicate, without which there is nothing, what is finished stays.
    fn drop_unfinished(&mut self) {
        if self.whole || self.replicates < 2 {
            return;
        }
        self.eye.drop_unfinished();
        self.held = Kept::default();
        (self.held_photons, self.held_of) = (0, 0..0);
        self.replicates -= 1;
        self.traced = u64::from(self.replicates) * self.plan.photons_per_replicate();
        (self.whole, self.open) = (true, false);
    }

    /// The picture of all that was accepted.
    ///
    /// # Errors
    /// Those of a pass.
    pub(crate) fn finish(mut self) -> Result<Picture<C>> {
        let kept = self.pass(true)?;
        let photons = kept.map(|photons| SavedMap {
            scene_hash: hash_of_photons(self.scene, &self.plan),
            settings: settings_of(&self.plan),
            photons_traced: self.traced,
            replicates: self.replicates,
            photon_lm: self.scene.emitters.flux_lm() / self.traced.max(1) as f64,
            frame: self.store.frame(),
            photons,
        });
        let Seeing { film, killed, unseen, bandwidths } = self.eye.finish();
        let cost = Cost::of(&film);
        let summary = PictureSummary {
            method: Method::Map,
            photons: self.traced,
            replicates: self.replicates,
            photons_kept: self.kept,
            passes: self.passes,
            bandwidth: Some(bandwidths),
            eye_paths_killed: killed,
            splats_cut: 0,
            pixels_unseen: unseen,
            cost,
            time_s: self.camera_s,
        };
        Ok(Picture { film, summary, photons })
    }
}
