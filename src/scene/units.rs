//! Numbers that look as if they were of another quantity: candela given as lumens, values of a table times the cosine.

use crate::emitter::{Emits, Emitter};
use crate::error::warning::{Severity, Warning, four_digits};
use crate::error::words::quoted_names;
use crate::surface::Material;

use super::Scene;

/// A file's flux is rescaled by no more than this where the same lamp is meant.
const FACTOR: f64 = 10.0;

/// What is to be said of them.
pub(super) fn warnings(scene: &Scene) -> impl Iterator<Item = Warning> {
    let fluxes =
        scene.emitters.as_slice().iter().zip(&scene.emitter_names).filter_map(|(e, name)| flux(e, name));
    fluxes.chain(with_cosine(scene))
}

/// A flux far from that of the lamp's own file.
fn flux(emitter: &Emitter, name: &str) -> Option<Warning> {
    let Emitter::Photometric(lamp) = emitter else { return None };
    let (flux_lm, of_file_lm) = (emitter.flux_lm(), lamp.file_flux_lm());
    if of_file_lm <= 0.0 || (flux_lm <= FACTOR * of_file_lm && of_file_lm <= FACTOR * flux_lm) {
        return None;
    }
    Some(Warning {
        severity: Severity::Note,
        code: "flux-of-file",
        message: format!(
            "emitter \"{name}\" has flux_lm = {}, {} times the {} lm of its file",
            four_digits(flux_lm),
            four_digits(flux_lm / of_file_lm),
            four_digits(of_file_lm)
        ),
        surfaces: Vec::new(),
        share: None,
        remedy: "flux_lm is the flux of the lamp in lumens, not its intensity in candela; without it the file's candela stand"
            .into(),
    })
}

/// Surfaces whose table is reciprocal only without a cosine.
fn with_cosine(scene: &Scene) -> Option<Warning> {
    let surfaces = scene.geometry.surfaces().iter().zip(scene.materials());
    let found = surfaces.filter_map(|(surface, material)| match material {
        Material::Tabulated(table) => Some((surface.name.clone(), table.with_cosine()?)),
        _ => None,
    });
    let (surfaces, defects): (Vec<_>, Vec<_>) = found.unzip();
    let worst = defects.into_iter().max_by(|a, b| a.as_it_stands.total_cmp(&b.as_it_stands))?;
    Some(Warning {
        severity: Severity::Doubtful,
        code: "cosine-in-table",
        message: format!(
            "the scattering table of {} is far from reciprocal, by {:.0} %, but by {:.0} % if its values are divided by the cosine \
             of the scattered light's angle",
            quoted_names(&surfaces),
            100.0 * worst.as_it_stands,
            100.0 * worst.divided
        ),
        surfaces,
        share: None,
        remedy: "was the value multiplied by the cosine? a table holds f in 1/sr without it: divide by it (`caustix bsdf` tells \
                 the albedo)"
            .into(),
    })
}
