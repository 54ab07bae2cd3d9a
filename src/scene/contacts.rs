//! Surfaces in one place, bodies in one another: what is refused, and what is taken.

use std::collections::BTreeSet;

use crate::error::{Diagnostic, Kind};
use crate::geometry::{Contact, Geometry, SurfaceId};
use crate::surface::Material;

use super::facets;
use super::options::{Joint, SurfaceOptions};

/// Pairs that are told. Of thousands of surfaces in one place there are millions.
const MOST_FOUND: usize = 1000;

/// What was found about a pair of surfaces, to be said where the second of them stands in the scene.
pub(super) type Finding = (SurfaceId, Diagnostic);

/// Contacts in which no rule says what is met first, and bodies of which none is inside the other.
pub(super) fn errors(
    geometry: &Geometry,
    materials: &[Material],
    options: &[SurfaceOptions],
) -> Vec<Finding> {
    let at = |s: SurfaceId| s.0 as usize;
    let is_body = |s: SurfaceId| geometry.is_closed(s) && materials[at(s)].is_transparent();
    let name = |s: SurfaceId| geometry.name(s);
    let volume = |s: SurfaceId| geometry.surfaces()[at(s)].shape.volume_m3();
    let mut found = Vec::new();
    let mut refused = BTreeSet::new();
    for Contact { surfaces: [a, b], facing } in
        geometry.contacts().iter().copied().filter(|c| c.surfaces[0] != c.surfaces[1])
    {
        let is_open = !geometry.is_closed(a) && !geometry.is_closed(b);
        let are_solid = !materials[at(a)].is_transparent() && !materials[at(b)].is_transparent();
        if is_open || (!facing && are_solid) {
            let pair = format!("surfaces \"{}\" and \"{}\" in the same place", name(a), name(b));
            let e = Diagnostic::new(Kind::Geometry, pair, "surfaces that do not coincide");
            found.push((b, e.hint("leave one of them out, or move them apart")));
            refused.insert([a, b]);
        } else if !facing
            && is_body(a)
            && is_body(b)
            && equal(volume(a), volume(b))
            && options[at(a)].priority == options[at(b)].priority
        {
            let pair = format!("the bodies \"{}\" and \"{}\" in the same place", name(a), name(b));
            let e = Diagnostic::new(
                Kind::Geometry,
                pair,
                "a different `priority` of each: the body of the higher one fills the space",
            );
            found.push((b, e.hint("leave one of them out, or give one of them `priority = 1`")));
            refused.insert([a, b]);
        }
        if found.len() >= MOST_FOUND {
            return found;
        }
    }
    let bodies: Vec<SurfaceId> = (0..materials.len() as u32).map(SurfaceId).filter(|s| is_body(*s)).collect();
    for (i, &b) in bodies.iter().enumerate() {
        for &a in &bodies[..i] {
            let is_decided = options[at(a)].priority != options[at(b)].priority
                || materials[at(a)].indices().map(|n| n.0) == materials[at(b)].indices().map(|n| n.0)
                || refused.contains(&[a, b]);
            if is_decided || !geometry.overlap_in_part(a, b) {
                continue;
            }
            let pair = format!("the bodies \"{}\" and \"{}\" overlapping in part", name(a), name(b));
            let required = "bodies apart, one inside the other, or of different `priority`";
            let hint =
                format!("give the one that fills the common space `priority = 1`, say \"{}\"", name(b));
            found.push((b, Diagnostic::new(Kind::Geometry, pair, required).hint(hint)));
            if found.len() >= MOST_FOUND {
                return found;
            }
        }
    }
    found
}

fn equal(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.max(b)
}

/// Transparent bodies in contact of which the scene does not say how, and curves of flat facets.
pub(super) fn warnings(
    geometry: &Geometry,
    materials: &[Material],
    options: &[SurfaceOptions],
) -> Vec<Finding> {
    let at = |s: SurfaceId| s.0 as usize;
    let name = |s: SurfaceId| geometry.name(s);
    let pairs = geometry.contacts().iter().filter(|contact| {
        let [a, b] = contact.surfaces;
        let is_clear = |s: SurfaceId| materials[at(s)].is_transparent();
        contact.facing
            && a != b
            && is_clear(a)
            && is_clear(b)
            && options[at(a)].contact.or(options[at(b)].contact).is_none()
    });
    let of_pairs = pairs.map(|contact| {
            let [a, b] = contact.surfaces;
            let found = format!("surfaces \"{}\" and \"{}\" in contact", name(a), name(b));
            let required = "`contact = \"film\"` or `contact = \"glued\"` on one of them; a film of what surrounds them is taken \
                            to lie between them";
            (b, Diagnostic::new(Kind::Geometry, found, required))
        });
    let clear = (0..materials.len() as u32).map(SurfaceId).filter(|s| materials[at(*s)].is_transparent());
    let faceted = clear.filter_map(|s| Some((s, facets::warning(&geometry.surfaces()[at(s)])?)));
    of_pairs.take(MOST_FOUND).chain(faceted).collect()
}

/// Whether a surface is joined to all that it touches.
pub(super) fn is_glued(options: &SurfaceOptions) -> bool {
    options.contact == Some(Joint::Glued)
}
