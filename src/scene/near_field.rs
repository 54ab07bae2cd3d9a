//! Lamps of photometric files next to surfaces: such a file describes a lamp seen from afar.

use crate::emitter::{Emits, Emitter};
use crate::error::warning::{Severity, Warning};
use crate::sample::coordinates::{Coordinates, Purpose};
use crate::sample::method::Sampling;
use crate::sequence::independent::IndependentPoints;

use super::Scene;

/// Photometry is measured, and holds, from this many times the longest side of a luminous opening on (the "five-times
/// rule" of luminaire photometry).
const FAR: f64 = 5.0;
/// Where this share of the light meets something nearer, it matters.
const SHARE: f64 = 0.01;
/// Directions looked along, of all lamps and of one.
const ALL: usize = 1 << 16;
const OF_ONE: (usize, usize) = (64, 1024);
const SEED: u64 = 0x6e65_6172;

/// Lamps of which light meets something too near.
pub(super) fn warnings(scene: &Scene) -> impl Iterator<Item = Warning> {
    let lamps = scene.emitters.as_slice().iter().enumerate();
    let photometric = lamps.filter_map(|(i, lamp)| match lamp {
        Emitter::Photometric(lamp) => Some((i, FAR * lamp.opening_m())),
        _ => None,
    });
    photometric.filter(|(_, far_m)| *far_m > 0.0).filter_map(|(lamp, far_m)| too_near(scene, lamp, far_m))
}

fn too_near(scene: &Scene, lamp: usize, far_m: f64) -> Option<Warning> {
    let emitters = scene.emitters.as_slice();
    let rays = (ALL / emitters.len()).clamp(OF_ONE.0, OF_ONE.1);
    let (points, start) = (IndependentPoints::new(SEED, 0), scene.start(lamp));
    let met = (0..rays as u64).filter_map(|k| {
        let mut coordinates = Coordinates::new(&points, k, true);
        let u = coordinates.draw_reusable(Purpose::Emission);
        let emission = emitters[lamp].emit(Sampling::default(), u, &mut coordinates)?;
        scene.geometry.nearest(emission.origin, emission.direction, &start, &mut 0)
    });
    let near: Vec<_> = met.filter(|hit| hit.t < far_m).collect();
    let share = near.len() as f64 / rays as f64;
    let nearest = near.iter().min_by(|a, b| a.t.total_cmp(&b.t)).filter(|_| share >= SHARE)?;
    let surface = scene.geometry.name(nearest.surface).to_owned();
    let name = &scene.emitter_names[lamp];
    Some(Warning {
        severity: Severity::Doubtful,
        code: "near-field",
        message: format!(
            "the luminous opening of emitter \"{name}\" is {:.2} m long, and {:.0} % of its light meets a surface nearer \
             than five times that: \"{surface}\" is {:.2} m away; a photometric file is of a lamp seen from afar, and all its \
             light starts at one point",
            far_m / FAR,
            100.0 * share,
            nearest.t
        ),
        surfaces: vec![surface],
        share: Some(share),
        remedy: "move the lamp away, or draw its opening: `type = \"panel\"` or \"disc\" of its size".into(),
    })
}
