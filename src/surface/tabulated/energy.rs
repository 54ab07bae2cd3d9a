//! Albedos above 1: refused, or scaled to 1, as the scene asks; never silently.

use crate::error::{Diagnostic, Kind, Result};
use crate::surface::tabulated::Energy;
use crate::surface::tabulated::face::Face;
use crate::surface::tabulated::layer::Layer;

/// Albedos up to here are 1 as far as values in f32 can tell.
pub(crate) const ONE: f64 = 1.0 + 4.0 * f32::EPSILON as f64;

/// An albedo beyond this is no error of measurement: the values are of another unit.
const NO_MEASUREMENT: f64 = 2.0;

/// What an albedo is scaled to: 1, and enough beside it that mixtures of such slices don't round to less,
/// which would be an event that has to be decided.
const TO_ONE: f64 = 1.0 + 4.0 * f64::EPSILON;

/// An incidence at which a surface sends back and lets through more than it gets.
#[derive(Debug, Clone, Copy)]
struct Excess {
    albedo: f64,
    theta: f64,
    phi: f64,
}

/// Sees to it that no channel of either face scatters more than it gets, at any incidence: the albedos mix
/// linearly, so the table's own angles are enough.
///
/// # Errors
/// [`Energy::Refuse`] and an albedo above 1.
pub(super) fn check(layers: &mut [Layer], faces: &[Face; 2], energy: Energy) -> Result<Vec<Diagnostic>> {
    // Faces of the same lobes are one.
    let distinct = if faces[0].layers == faces[1].layers { &faces[..1] } else { &faces[..] };
    let all: Vec<Excess> = distinct.iter().flat_map(|face| excesses(layers, face)).collect();
    let Some(worst) = all.iter().max_by(|a, b| a.albedo.total_cmp(&b.albedo)) else {
        return Ok(Vec::new());
    };
    let mut warnings = Vec::new();
    if worst.albedo > ONE {
        let count = all.iter().filter(|e| e.albedo > ONE).count();
        let found = format!(
            "an albedo of {:.4} at theta_i = {:.4}, phi_i = {:.4} degrees, and more than 1 at {count} incidences",
            worst.albedo,
            worst.theta.to_degrees(),
            worst.phi.to_degrees(),
        );
        if energy == Energy::Refuse {
            let scale = "energy = \"scale\" scales these incidences to 1, where nothing is absorbed";
            let hint = if worst.albedo > NO_MEASUREMENT {
                format!("are the values in per cent, or multiplied by pi? f is in 1/sr; else {scale}")
            } else {
                scale.to_owned()
            };
            return Err(Diagnostic::new(Kind::Range, found, "albedos of at most 1").hint(hint));
        }
        let required = "albedos of at most 1; those above are scaled to 1";
        warnings.push(Diagnostic::new(Kind::Range, found, required));
    }
    scale_slices(layers, distinct);
    // Two lobes with angles of their own may still exceed 1 between the angles of one of them.
    for face in distinct {
        let most = excesses(layers, face).iter().map(|e| e.albedo).fold(0.0, f64::max);
        if most > ONE {
            for k in face.layers.into_iter().flatten() {
                (0..layers[k].grids.count()).for_each(|slice| layers[k].grids.scale(slice, 1.0 / most));
            }
        }
    }
    Ok(warnings)
}

/// The largest channel of what a face scatters at an incidence.
fn total(layers: &[Layer], face: &Face, theta: f64, phi: f64) -> f64 {
    let of_channel = |channel| -> f64 {
        let lobes = face.layers.into_iter().flatten().map(|k| &layers[k]);
        lobes.map(|layer| layer.albedo(&layer.mix(theta, phi), channel)).sum()
    };
    (0..3).map(of_channel).fold(0.0, f64::max)
}

/// The incidences of a face's tables at which it scatters more than 1.
fn excesses(layers: &[Layer], face: &Face) -> Vec<Excess> {
    let (mut thetas, mut phis) = (Vec::new(), Vec::new());
    for k in face.layers.into_iter().flatten() {
        let (theta, phi) = layers[k].angles();
        thetas.extend_from_slice(theta);
        phis.extend_from_slice(phi);
    }
    for angles in [&mut thetas, &mut phis] {
        angles.sort_by(f64::total_cmp);
        angles.dedup();
    }
    let at = |theta: f64, phi: f64| Excess { albedo: total(layers, face, theta, phi), theta, phi };
    let all = phis.iter().flat_map(|phi| thetas.iter().map(move |theta| at(*theta, *phi)));
    all.filter(|e| e.albedo > 1.0).collect()
}

/// Scales every slice by what its own incidence exceeds 1, all channels alike so that the colour stays.
fn scale_slices(layers: &mut [Layer], faces: &[Face]) {
    let mut factors: Vec<Vec<f64>> = layers.iter().map(|l| vec![1.0; l.incidences()]).collect();
    for face in faces {
        for k in face.layers.into_iter().flatten() {
            let (thetas, phis) = layers[k].angles();
            for (j, phi) in phis.iter().enumerate() {
                for (i, theta) in thetas.iter().enumerate() {
                    let factor = &mut factors[k][j * thetas.len() + i];
                    *factor = factor.min(TO_ONE / total(layers, face, *theta, *phi));
                }
            }
        }
    }
    for (layer, factors) in layers.iter_mut().zip(factors) {
        for (incidence, factor) in factors.into_iter().enumerate().filter(|(_, f)| *f < 1.0) {
            for channel in 0..layer.channels {
                let slice = layer.slice(channel, incidence);
                layer.grids.scale(slice, factor);
            }
        }
    }
}
