//! The picture of photons that are joined to the pinhole one by one.

use std::time::Instant;

use crate::error::Result;
use crate::picture::camera::splat;
use crate::picture::camera::splat::{Splat, SplatMoments};
use crate::picture::camera::{Film, View};
use crate::picture::photon_map::Channels;
use crate::scene::Scene;
use crate::scene::camera::{CameraSpec, Method};
use crate::surface::luminance_of;

use crate::picture::passes::eye::{Eye, Seeing};
use crate::picture::summary::{Cost, PictureSummary};
use crate::picture::{Picture, Watch};
use crate::run::{Outcome, Plan, trace_by};

/// Traces a scene and splats its photons; emitters and background are seen by eye paths.
pub(crate) fn trace<const C: usize, T: Channels<C>>(
    scene: &Scene,
    spec: &CameraSpec,
    plan: &Plan,
    watch: Watch<'_>,
    carried: T,
) -> Result<(Outcome, Picture<C>)> {
    let mut eye = Eye::<C>::new(scene, spec, plan, watch)?;
    let mut splat = Splat::<C>::new(scene, spec)?;
    let mut moments = SplatMoments::<C>::new(spec.pixels[0] as usize * spec.pixels[1] as usize);
    let mut joined = 0;
    let outcome = trace_by(
        scene,
        plan,
        |tracer, end, receivers| {
            let sink = || splat.sink(receivers.sink());
            let traced = tracer.trace_into(end, carried, sink, watch.interrupt, watch.photons)?;
            // What counts are whole replicates, and of the first one what is finished of it.
            if traced.complete && (tracer.replicate() == 0 || end == plan.photons_per_replicate) {
                if tracer.replicate() == 0 {
                    moments.restart();
                }
                splat.close(&mut moments, end == plan.photons_per_replicate);
                joined = splat.joined();
            }
            Ok(traced)
        },
        watch.interrupt,
    )?;
    let started = Instant::now();
    eye.add_emitters()?;
    let Seeing { film, killed, unseen } = eye.finish();
    let film = with_splats(film, &moments, &outcome, &View::new(scene, spec, plan.seed)?);
    let cost = Cost::of(&film);
    let summary = PictureSummary {
        method: Method::Splat,
        photons: outcome.photons,
        replicates: outcome.replicates,
        photons_kept: joined,
        passes: 1,
        bandwidth: None,
        eye_paths_killed: killed,
        splats_cut: splat.cut(),
        pixels_unseen: unseen,
        cost,
        time_s: started.elapsed().as_secs_f64(),
    };
    Ok((outcome, Picture { film, summary, photons: None }))
}

/// The film of the eye's paths with the splats added to its pixels; there is no bias. Pixels that an interrupt left unseen stay so.
fn with_splats<const C: usize>(
    mut film: Film<C>,
    moments: &SplatMoments<C>,
    outcome: &Outcome,
    view: &View<'_>,
) -> Film<C> {
    let (photon_lm, r) = (outcome.photon_lm, f64::from(outcome.replicates));
    for (pixel, (sum, square)) in moments.sum.iter().zip(&moments.square).enumerate() {
        if film.bias[pixel].is_nan() {
            continue;
        }
        for (value, sum) in film.value[pixel].iter_mut().zip(sum) {
            *value += sum * photon_lm;
        }
        let y = luminance_of(sum);
        // R s^2 of the R partial sums.
        let variance = r / (r - 1.0) * (square - y * y / r).max(0.0) * photon_lm * photon_lm;
        let (of_eye, owed) = (film.standard_error[pixel], splat::owed(view, pixel, photon_lm, y * photon_lm));
        film.standard_error[pixel] =
            if outcome.replicates < 2 { f64::NAN } else { (variance + of_eye * of_eye + owed * owed).sqrt() };
    }
    film
}
