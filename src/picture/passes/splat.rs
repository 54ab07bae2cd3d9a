//! The picture of photons that are joined to the pinhole one by one.

use std::io::{self, Read, Write};
use std::time::Instant;

use crate::error::Result;
use crate::math::varint::{expect, put, take};
use crate::picture::camera::splat::{self, Splat, SplatMoments};
use crate::picture::camera::{Film, Pass, View};
use crate::picture::photon_map::Channels;
use crate::picture::summary::{Cost, PictureSummary};
use crate::picture::{Picture, Watch, not_of_this};
use crate::run::Outcome;
use crate::run::together::Watched;
use crate::run::turns::{KeepTurns, Stage, Turns};
use crate::scene::camera::Camera;
use crate::surface::luminance_of;

use super::eye::Eye;

/// Traces a scene and splats its photons; emitters and background are seen by eye paths.
pub(crate) fn trace<const C: usize, T: Channels<C>>(
    mut turns: Turns<'_>,
    state: Option<&mut dyn Read>,
    camera: &Camera,
    watch: Watch<'_>,
    keep: &dyn KeepTurns,
    carried: T,
) -> Result<(Outcome, Picture<C>)> {
    let (scene, plan) = (turns.scene(), *turns.plan());
    let mut eye = Eye::<C>::new(scene, camera, &plan, watch)?;
    let moments = SplatMoments::<C>::new(camera.pixels[0] as usize * camera.pixels[1] as usize);
    let splat = Splat::<C>::new(scene, camera)?;
    let mut joiner = Joiner { splat, moments, joined: 0, watch, keep, carried };
    if let Some(from) = state {
        turns.read(from).and_then(|()| joiner.read(from)).map_err(|e| not_of_this(&e))?;
    }
    turns.run(Watched { interrupt: watch.interrupt, progress: watch.photons }, &mut joiner)?;
    let outcome = turns.finish()?;
    let Joiner { splat, moments, joined, .. } = joiner;
    let started = Instant::now();
    eye.look(&Pass::EMISSION, 0..eye.tile_count())?;
    let view = eye.view.clone();
    let (film, summary) = eye.finish();
    let film = with_splats(film, &moments, &outcome, &view);
    let summary = PictureSummary {
        cost: Cost::of(&film),
        photons: outcome.photons,
        replicates: outcome.replicates,
        photons_kept: joined,
        passes: 1,
        bandwidth: None,
        splats_cut: splat.cut(),
        time_s: started.elapsed().as_secs_f64(),
        ..summary
    };
    Ok((outcome, Picture { film, summary, photons: None }))
}

/// Joins the photons of a run to the pinhole.
struct Joiner<'a, 's, const C: usize, T> {
    splat: Splat<'s, C>,
    moments: SplatMoments<C>,
    joined: u64,
    watch: Watch<'a>,
    keep: &'a dyn KeepTurns,
    carried: T,
}

impl<const C: usize, T: Channels<C>> Stage for Joiner<'_, '_, C, T> {
    fn stage(&mut self, turns: &mut Turns<'_>, end: u64) -> Result<bool> {
        let Watch { interrupt, photons, .. } = self.watch;
        let Turns { tracer, receivers, replica, .. } = turns;
        let sink = || self.splat.sink(receivers.sink());
        let traced = tracer.trace_into(end, self.carried, sink, interrupt, photons)?;
        replica.merge(&traced);
        let (is_first, is_last) = (tracer.points.replicate == 0, end == turns.plan().photons_per_replicate());
        // What counts are whole replicates, and of the first one what is finished of it.
        if traced.complete && (is_first || is_last) {
            if is_first {
                self.moments.restart();
            }
            self.splat.close(&mut self.moments, is_last);
            self.joined = self.splat.joined();
        }
        Ok(traced.complete)
    }

    fn turned(&mut self, turns: &Turns<'_>) {
        if self.keep.is_due() {
            self.keep.keep(turns, &mut |out| self.write(out));
        }
    }
}

impl<const C: usize, T> Joiner<'_, '_, C, T> {
    /// Writes the sums of whole replicates.
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        put(out, [C as u64, self.splat.joined(), self.splat.cut()])?;
        self.moments.write(out)
    }

    fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        expect(from, C as u64, "channels")?;
        self.splat.after(take(from)?, take(from)?);
        self.joined = self.splat.joined();
        self.moments.read(from)
    }
}

/// The film of the eye's paths with the splats added to its pixels; there is no bias. Pixels that an
/// interrupt left unseen stay so.
fn with_splats<const C: usize>(
    mut film: Film<C>,
    moments: &SplatMoments<C>,
    outcome: &Outcome,
    view: &View<'_>,
) -> Film<C> {
    let photon_lm = outcome.photon_lm;
    for (pixel, sum) in moments.sum.iter().enumerate() {
        if film.bias[pixel].is_nan() {
            continue;
        }
        for (value, sum) in film.value[pixel].iter_mut().zip(sum) {
            *value += sum * photon_lm;
        }
        let (of_eye, y) = (film.standard_error[pixel], luminance_of(sum));
        let owed = splat::owed(view, pixel, photon_lm, y * photon_lm);
        let variance = moments.variance(pixel, outcome.replicates) * photon_lm * photon_lm;
        film.standard_error[pixel] = (variance + of_eye * of_eye + owed * owed).sqrt();
    }
    film
}
