//! Checks that need the whole scene: coincident surfaces, emitters where none may be.

use glam::DVec3;

use crate::emitter::{Emitter, Panel, collimated::CrossSection};
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::{Geometry, Surface, SurfaceId, Whereabouts, coincident_surfaces};
use crate::surface::Material;

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
/// in; a beam whose cross-section reaches across a closed surface; a panel that a closed surface touches or cuts. (An open
/// surface may cut a panel: there is no side that its photons could be wrong about.)
pub fn start(
    name: &str,
    emitter: &Emitter,
    geometry: &Geometry,
    materials: &[Material],
) -> Result<Whereabouts> {
    let centre = emitter.centre();
    let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Geometry, found, required));
    let label = |surface: SurfaceId| &geometry.surfaces()[surface.0 as usize].name;
    let on = match emitter {
        Emitter::Collimated(_) => None,
        Emitter::Panel(panel) => geometry.surface_at(centre).or_else(|| lies_on(panel, geometry)),
        Emitter::Photometric(_) | Emitter::Isotropic(_) => geometry.surface_at(centre),
    };
    if let Some(surface) = on {
        return fail(
            format!("emitter \"{name}\" on surface \"{}\"", label(surface)),
            "an emitter off every surface: on one, it is on neither side",
        );
    }
    let behind = geometry.all_behind(centre);
    for &surface in &behind {
        if materials[surface.0 as usize].is_transparent() && geometry.is_closed(surface) {
            return fail(
                format!("emitter \"{name}\" inside the dielectric \"{}\"", label(surface)),
                "an emitter outside closed dielectrics",
            );
        }
    }
    for point in rim(emitter) {
        if geometry.all_behind(point) != behind {
            return fail(
                format!("the light of emitter \"{name}\" starting partly inside a closed surface"),
                "a cross-section, or a panel, wholly on one side of every closed surface",
            );
        }
    }
    if let Emitter::Panel(panel) = emitter
        && let Some(surface) = cut_by(panel, geometry, &behind)
    {
        return fail(
            format!("the panel \"{name}\" cut by the closed surface \"{}\"", label(surface)),
            "a panel wholly on one side of every closed surface",
        );
    }
    Ok(Whereabouts::start(behind))
}

/// Lines across a panel, each way, along which a closed surface is looked for.
const PANEL_LINES: u32 = 16;

/// The surface that a part of a panel lies on, as far as points of it show. What crosses it meets it in a line.
fn lies_on(panel: &Panel, geometry: &Geometry) -> Option<SurfaceId> {
    let of_strip = |k: u32| (2.0 * f64::from(k) + 1.0) / f64::from(PANEL_LINES) - 1.0;
    let mut met: Vec<(SurfaceId, Vec<[i64; 2]>)> = Vec::new();
    for (i, k) in (0..PANEL_LINES).flat_map(|i| (0..PANEL_LINES).map(move |k| (i, k))) {
        let Some(surface) = geometry.surface_at(panel.point(of_strip(i), of_strip(k))) else { continue };
        let place = [i64::from(i), i64::from(k)];
        let Some((_, places)) = met.iter_mut().find(|(other, _)| *other == surface) else {
            met.push((surface, vec![place]));
            continue;
        };
        let turns =
            |[a, b]: [[i64; 2]; 2]| (a[0] - b[0]) * (place[1] - b[1]) != (a[1] - b[1]) * (place[0] - b[0]);
        if places.len() > 1 && turns([places[0], places[1]]) {
            return Some(surface);
        }
        places.push(place);
    }
    None
}

/// The closed surface that cuts a panel, as far as lines across it show.
fn cut_by(panel: &Panel, geometry: &Geometry, behind: &[SurfaceId]) -> Option<SurfaceId> {
    let lines = f64::from(PANEL_LINES);
    // The middles of strips: the rim itself, which may lie close to a wall, has been looked at.
    let end = 1.0 - 1.0 / lines;
    for i in 0..PANEL_LINES {
        let across = (2.0 * f64::from(i) + 1.0) / lines - 1.0;
        for (from, to) in [((-end, across), (end, across)), ((across, -end), (across, end))] {
            let (from, to) = (panel.point(from.0, from.1), panel.point(to.0, to.1));
            let length = (to - from).length();
            let start = Whereabouts::start(behind.iter().copied());
            let hit = geometry.nearest(from, (to - from) / length, &start, &mut 0);
            if let Some(hit) = hit.filter(|hit| hit.closed && hit.t < length) {
                return Some(hit.surface);
            }
        }
    }
    None
}

/// Points around the cross-section of a beam, or around a panel.
fn rim(emitter: &Emitter) -> Vec<DVec3> {
    let (centre, x, y, corner) = match emitter {
        Emitter::Collimated(beam) => match beam.section {
            CrossSection::Rectangle(x, y) => (beam.centre, x, y, 1.0),
            CrossSection::Disc(x, y) => (beam.centre, x, y, std::f64::consts::FRAC_1_SQRT_2),
        },
        Emitter::Panel(panel) => {
            let centre = panel.centre();
            (centre, panel.point(1.0, 0.0) - centre, panel.point(0.0, 1.0) - centre, 1.0)
        }
        Emitter::Photometric(_) | Emitter::Isotropic(_) => return Vec::new(),
    };
    [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
        .into_iter()
        .chain([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(a, b)| (a * corner, b * corner)))
        .map(|(a, b)| centre + x * a + y * b)
        .collect()
}
