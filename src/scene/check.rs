//! Checks that need the whole scene: coincident surfaces, emitters where none may be.

use crate::emitter::{Emits, Emitter};
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::{Geometry, Surface, SurfaceId, Whereabouts, coincident_surfaces};
use crate::surface::Bsdf;

use super::figure::{Contact, Figure};
use crate::files::scene_toml::description::Place;

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
/// in; one whose photons start on both sides of a closed surface, because that touches or cuts the figure that they start in.
/// (An open surface may cut it: there is no side that its photons could be wrong about.)
pub fn start(name: &str, emitter: &Emitter, geometry: &Geometry, bsdfs: &[Bsdf]) -> Result<Whereabouts> {
    let centre = emitter.position();
    let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Geometry, found, required));
    let label = |surface: SurfaceId| &geometry.surfaces()[surface.0 as usize].name;
    let figure = Figure::new(emitter);
    let on = || geometry.surface_at(centre).or_else(|| figure.as_ref()?.met(geometry, Contact::Flush));
    if let Some(surface) = (!emitter.kind().may_touch).then(on).flatten() {
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
    let Some(figure) = figure else { return Ok(Whereabouts::start(behind)) };
    if figure.rim().any(|point| geometry.all_behind(point) != behind) {
        return fail(
            format!("the light of emitter \"{name}\" starting partly inside a closed surface"),
            "a cross-section, or a panel, wholly on one side of every closed surface",
        );
    }
    if let Some(surface) = figure.met(geometry, Contact::Cut) {
        let noun = emitter.kind().noun;
        return fail(
            format!("the {noun} \"{name}\" cut by the closed surface \"{}\"", label(surface)),
            &format!("a {noun} wholly on one side of every closed surface"),
        );
    }
    Ok(Whereabouts::start(behind))
}
