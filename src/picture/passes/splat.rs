//! The picture of photons that are joined to the pinhole one by one.

use std::time::Instant;

use crate::error::Result;
use crate::picture::camera::splat::{self, Splat, SplatMoments};
use crate::picture::camera::{Film, Pass, View};
use crate::picture::photon_map::Channels;
use crate::picture::summary::{Cost, PictureSummary};
use crate::picture::{Picture, Watch};
use crate::run::{Outcome, Plan, trace_by};
use crate::scene::Scene;
use crate::scene::camera::Camera;
use crate::surface::luminance_of;

use super::eye::Eye;

/// Traces a scene and splats its photons; emitters and background are seen by eye paths.
pub(crate) fn trace<const C: usize, T: Channels<C>>(
    scene: &Scene,
    camera: &Camera,
    plan: &Plan,
    watch: Watch<'_>,
    carried: T,
) -> Result<(Outcome, Picture<C>)> {
    let mut eye = Eye::<C>::new(scene, camera, plan, watch)?;
    let mut splat = Splat::<C>::new(scene, camera)?;
    let mut moments = SplatMoments::<C>::new(camera.pixels[0] as usize * camera.pixels[1] as usize);
    let mut joined = 0;
    let outcome = trace_by(
        scene,
        plan,
        |tracer, end, receivers| {
            let sink = || splat.sink(receivers.sink());
            let traced = tracer.trace_into(end, carried, sink, watch.interrupt, watch.photons)?;
            // What counts are whole replicates, and of the first one what is finished of it.
            if traced.complete && (tracer.points.replicate == 0 || end == plan.photons_per_replicate()) {
                if tracer.points.replicate == 0 {
                    moments.restart();
                }
                splat.close(&mut moments, end == plan.photons_per_replicate());
                joined = splat.joined();
            }
            Ok(traced)
        },
        watch.interrupt,
    )?;
    let started = Instant::now();
    eye.look(&Pass::EMISSION)?;
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
