//! Emitters where none may be: on a surface, across a closed surface.

use crate::emitter::{Emits, Emitter};
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::{Geometry, SurfaceId, Whereabouts};

use super::figure::{Contact, Figure};

/// The side state of photons of an emitter.
///
/// # Errors
/// An emitter on a surface, where no side is right; one whose photons start on both sides of a closed surface, because that touches or cuts the figure that they start in.
/// (An open surface may cut it: there is no side that its photons could be wrong about.)
pub fn start(name: &str, emitter: &Emitter, geometry: &Geometry) -> Result<Whereabouts> {
    let centre = emitter.position();
    let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Geometry, found, required));
    let label = |surface: SurfaceId| geometry.name(surface);
    let figure = Figure::new(emitter);
    let on = || geometry.surface_at(centre).or_else(|| figure.as_ref()?.met(geometry, Contact::Flush));
    if let Some(surface) = (!emitter.kind().may_touch).then(on).flatten() {
        return fail(
            format!("emitter \"{name}\" on surface \"{}\"", label(surface)),
            "an emitter off every surface: on one, it is on neither side",
        );
    }
    let behind = geometry.all_behind(centre);
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
