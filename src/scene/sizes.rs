//! Sizes that look like millimetres: lengths are metres, and one who forgets it gets a millionth of the illuminance.

use crate::emitter::Emits;
use crate::error::warning::{Severity, Warning};
use crate::geometry::SurfaceId;

use super::Scene;

/// Glass begins here; water and ice, of which there are lakes, are below.
const GLASS: f64 = 1.4;
/// No piece of glass is thicker, m. (The largest mirrors of telescopes are 1 m thick; a window of "4" is meant as 4 mm.)
const THICKEST_M: f64 = 1.0;
/// A scene that is larger, m,
const LARGE_M: f64 = 100.0;
/// and whose lamps could give its receivers no more than this, lx, a hundredth of full moon's, is none that anybody lights.
const DARK_LX: f64 = 0.01;

/// What is to be said of the sizes of a scene.
pub(super) fn warning(scene: &Scene) -> Option<Warning> {
    let (surface, message) = thick_glass(scene).or_else(|| Some((None, dark(scene)?)))?;
    Some(Warning {
        severity: Severity::Doubtful,
        code: "millimetres",
        message,
        surfaces: surface.into_iter().collect(),
        share: None,
        remedy: "lengths are metres: if these are millimetres, divide positions, sizes and radii by 1000, and give meshes \
                 `scale = 0.001`"
            .into(),
    })
}

/// The thickest body of glass that is too thick.
fn thick_glass(scene: &Scene) -> Option<(Option<String>, String)> {
    let surfaces = scene.geometry.surfaces().iter().enumerate();
    let glass = surfaces.filter(|(i, _)| {
        let is_closed = scene.geometry.is_closed(SurfaceId(*i as u32));
        is_closed && scene.materials()[*i].indices().is_some_and(|(ior, _)| ior > GLASS)
    });
    // Of a plate its thickness, of a ball a third of its diameter.
    let thickness_m = |shape: &crate::geometry::Shape| 2.0 * shape.volume_m3() / shape.area();
    let thick = glass.map(|(_, s)| (s, thickness_m(&s.shape))).filter(|(_, t)| *t > THICKEST_M);
    let (surface, thickness_m) = thick.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let message = format!("the glass of \"{}\" is {thickness_m:.1} m thick", surface.name);
    Some((Some(surface.name.clone()), message))
}

/// A scene so large and dark.
fn dark(scene: &Scene) -> Option<String> {
    let (low, high) = scene.geometry.bounds();
    let size_m = (high - low).max_element();
    let of_receivers: f64 = scene.receivers.iter().map(|r| r.total_area_m2()).sum();
    let of_surfaces = || scene.geometry.surfaces().iter().map(|s| s.shape.area()).sum();
    let area_m2 = if of_receivers > 0.0 { of_receivers } else { of_surfaces() };
    let flux_lm: f64 = scene.emitters.as_slice().iter().map(Emits::flux_lm).sum();
    if !(size_m > LARGE_M && flux_lm < DARK_LX * area_m2) {
        return None;
    }
    let where_to = if of_receivers > 0.0 { "receivers" } else { "surfaces" };
    Some(format!(
        "the scene is {size_m:.0} m large, and all light of its lamps ({flux_lm:.0} lm) on the {area_m2:.0} m2 of its \
         {where_to} would be {:.1e} lx",
        flux_lm / area_m2
    ))
}
