//! `[[emitter]]`: photometric, isotropic, collimated, panel.

use glam::DVec3;

use super::EmitterPart;
use super::loader::Make;
use super::names::Names;
use super::table::Table;
use crate::emitter::collimated::CrossSection;
use crate::emitter::colour::{CCT_RANGE_K, WHITE, normalised, planckian};
use crate::emitter::{Collimated, Emitter, Isotropic, Panel, Photometric};
use crate::error::Kind;
use crate::error::invalid::Interval;
use crate::geometry::{COORDINATE, LENGTH};
use crate::math::frame::unit;

const FLUX: Interval = Interval { low: 1e-9, high: 1e12, words: "a flux from 1e-9 to 1e12 lm" };

const CHANNEL: Interval = Interval { low: 0.0, high: 1e9, words: "a part of light from 0 to 1e9" };
const TEMPERATURE: Interval = Interval {
    low: CCT_RANGE_K[0],
    high: CCT_RANGE_K[1],
    words: "a colour temperature from 1000 to 15000 K",
};

/// The types with what messages call them.
const TYPES: [(&str, &str); 4] = [
    ("photometric", "a photometric [[emitter]]"),
    ("isotropic", "an isotropic [[emitter]]"),
    ("collimated", "a collimated [[emitter]]"),
    ("panel", "a panel [[emitter]]"),
];

pub(super) fn read(mut table: Table<'_, '_>, index: usize, names: &mut Names) -> Option<EmitterPart> {
    let place = table.place();
    let given = table.text("name");
    let name_place = given.as_ref().map_or(place, |n| n.place);
    let name = given.map_or_else(|| format!("emitter {}", index + 1), |n| n.value);
    names.insert(table.document(), &name, name_place, index);

    let kind = table.word("type", &TYPES);
    let kind = table.require("type", kind, "\"photometric\", \"isotropic\", \"collimated\" or \"panel\"")?;
    table.call(kind);
    let position = table.needed_vector("position", &COORDINATE, "[x, y, z] in metres");
    let flux_lm = table.number("flux_lm", &FLUX);
    let colour = read_colour(&mut table);
    let make: Option<Make<Emitter>> = if kind == TYPES[0].1 {
        read_photometric(&mut table, position, flux_lm)
    } else {
        let flux_lm = table.require("flux_lm", flux_lm, FLUX.words);
        let emitter = match kind {
            kind if kind == TYPES[1].1 => position
                .zip(flux_lm)
                .map(|(position, flux_lm)| Emitter::Isotropic(Isotropic { position, flux_lm })),
            kind if kind == TYPES[2].1 => {
                read_collimated(&mut table, position, flux_lm).map(Emitter::Collimated)
            }
            _ => read_panel(&mut table, position, flux_lm).map(Emitter::Panel),
        };
        emitter.map(|emitter| -> Make<Emitter> { Box::new(move |_| Ok(emitter)) })
    };
    table.finish();
    Some(EmitterPart { name, colour, make: make?, place })
}

fn read_photometric(
    table: &mut Table<'_, '_>,
    position: Option<DVec3>,
    flux_lm: Option<f64>,
) -> Option<Make<Emitter>> {
    let file = table.path("file");
    let (aim, up) = read_frame(table)?;
    let (file, position) = (file?, position?);
    Some(Box::new(move |loader| {
        let photometry = loader.photometry(&file)?;
        let emitter = Photometric::new(&photometry, position, aim, up, flux_lm);
        Ok(Emitter::Photometric(Box::new(emitter.map_err(|e| e.in_file(loader.path(&file)))?)))
    }))
}

/// A beam of `radius`, or `size = [width, height]`.
fn read_collimated(
    table: &mut Table<'_, '_>,
    position: Option<DVec3>,
    flux_lm: Option<f64>,
) -> Option<Collimated> {
    let radius = table.number("radius", &LENGTH);
    let size = table.numbers::<2>("size", &LENGTH);
    match (table.place_of("radius").is_some(), table.place_of("size").is_some()) {
        (true, true) => table.error("size", Kind::Range, "either radius or size, not both"),
        (false, false) => {
            table.error("radius", Kind::Missing, "... for a disc, or size = [width, height], in metres");
        }
        _ => {}
    }
    let (direction, up) = read_frame(table)?;
    let across = direction.cross(up);
    let section = match (radius, size) {
        (Some(radius), None) => CrossSection::Disc(across * radius, up * radius),
        (None, Some([width, height])) => CrossSection::Rectangle(across * (0.5 * width), up * (0.5 * height)),
        _ => return None,
    };
    Some(Collimated { centre: position?, direction, section, flux_lm: flux_lm? })
}

fn read_panel(table: &mut Table<'_, '_>, position: Option<DVec3>, flux_lm: Option<f64>) -> Option<Panel> {
    let size = table.numbers::<2>("size", &LENGTH);
    let size = table.require("size", size, "[width, height] in metres");
    let (aim, up) = read_frame(table)?;
    Some(Panel::new(position?, aim, up, size?, flux_lm?))
}

/// `colour = [r, g, b]`, `cct_k = 3000`, or neither: linear sRGB of luminance 1.
fn read_colour(table: &mut Table<'_, '_>) -> [f64; 3] {
    let rgb = table.numbers::<3>("colour", &CHANNEL);
    let cct_k = table.number("cct_k", &TEMPERATURE);
    let Some(place) = table.place_of("cct_k") else {
        if rgb == Some([0.0; 3]) {
            table.error("colour", Kind::Range, "a colour that is not black: flux_lm says how bright it is");
        }
        return rgb.and_then(normalised).unwrap_or(WHITE);
    };
    if table.place_of("colour").is_some() {
        table.error("cct_k", Kind::Range, "either colour or cct_k, not both");
    }
    let Some(cct_k) = cct_k else { return WHITE };
    let (rgb, clipped) = planckian(cct_k);
    if clipped {
        let found = format!("cct_k = {cct_k}, a light more saturated than sRGB can show");
        let required = "about 1900 K or more; its blue is taken as 0 instead of below";
        table.document().warn_at(place, Kind::Range, found, required);
    }
    rgb
}

/// `aim` and `up`, made orthogonal.
fn read_frame(table: &mut Table<'_, '_>) -> Option<(DVec3, DVec3)> {
    let aim = table.direction("aim", Some(DVec3::NEG_Z));
    let is_given = table.place_of("up").is_some();
    let up = table.direction("up", Some(DVec3::Y));
    let (aim, up) = (aim?, up?);
    if let Some(up) = orthogonal_part(up, aim) {
        return Some((aim, up));
    }
    if is_given {
        table.error("up", Kind::Range, "a direction that is not parallel to aim");
        return None;
    }
    orthogonal_part(DVec3::X, aim).map(|up| (aim, up))
}

/// The unit vector along the part of unit vector `v` that is orthogonal to unit vector `axis`; `None` if the
/// angle between their lines is below 1e-9, where rounding would choose the direction.
pub(super) fn orthogonal_part(v: DVec3, axis: DVec3) -> Option<DVec3> {
    let sine = v.cross(axis).length();
    // Subtracted twice: the first remainder is orthogonal to rounding of v, the second to rounding of itself.
    let once = unit(v - axis * v.dot(axis))?;
    let part = unit(once - axis * once.dot(axis))?;
    (sine >= 1e-9).then_some(part)
}
