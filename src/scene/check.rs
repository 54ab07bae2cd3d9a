//! Checks that need the whole scene: coincident surfaces, emitters where none may be.

use glam::DVec3;

use crate::bsdf::Bsdf;
use crate::emitter::{Emitter, collimated::CrossSection};
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::{Geometry, Surface, SurfaceId, Whereabouts, coincident_surfaces};

use super::description::Place;

/// Every pair of surfaces that lie in the same place: neither would be first. Each points to the second of the two.
pub fn coincidences(surfaces: &[Surface], places: &[Place]) -> Vec<Diagnostic> {
    coincident_surfaces(surfaces).into_iter().map(|([_, second], e)| at_place(places, second, e)).collect()
}

/// The diagnostic at the place of part number `index`, if the scene comes from a file.
pub fn at_place(places: &[Place], index: usize, diagnostic: Diagnostic) -> Diagnostic {
    match places.get(index) {
        Some(place) => diagnostic.at(place.line, place.column),
        None => diagnostic,
    }
}

/// The side state of photons of an emitter.
///
/// # Errors
/// An emitter on a surface, where no side is right; inside a closed dielectric, because there is no medium to start
/// in; a beam whose cross-section reaches across a closed surface.
pub fn start(name: &str, emitter: &Emitter, geometry: &Geometry, bsdfs: &[Bsdf]) -> Result<Whereabouts> {
    let centre = emitter.centre();
    let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Geometry, found, required));
    let label = |surface: SurfaceId| &geometry.surfaces()[surface.0 as usize].name;
    if !matches!(emitter, Emitter::Collimated(_))
        && let Some(surface) = geometry.surface_at(centre)
    {
        return fail(
            format!("emitter \"{name}\" on surface \"{}\"", label(surface)),
            "an emitter off every surface: on one, it is on neither side",
        );
    }
    let behind = geometry.all_behind(centre);
    for &surface in &behind {
        if bsdfs[surface.0 as usize].is_transparent() && geometry.is_closed(surface) {
            return fail(
                format!("emitter \"{name}\" inside the dielectric \"{}\"", label(surface)),
                "an emitter outside closed dielectrics",
            );
        }
    }
    for point in rim(emitter) {
        if geometry.all_behind(point) != behind {
            return fail(
                format!("the beam of emitter \"{name}\" starting partly inside a closed surface"),
                "a cross-section wholly on one side of every closed surface",
            );
        }
    }
    Ok(Whereabouts::start(behind))
}

/// Points around the cross-section of a beam.
fn rim(emitter: &Emitter) -> Vec<DVec3> {
    let Emitter::Collimated(beam) = emitter else { return Vec::new() };
    let (x, y, corner) = match beam.section {
        CrossSection::Rectangle(x, y) => (x, y, 1.0),
        CrossSection::Disc(x, y) => (x, y, std::f64::consts::FRAC_1_SQRT_2),
    };
    [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
        .into_iter()
        .chain([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(a, b)| (a * corner, b * corner)))
        .map(|(a, b)| beam.centre + x * a + y * b)
        .collect()
}
