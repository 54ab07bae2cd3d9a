//! `[[emitter]]`: photometric, isotropic, collimated, panel.

use glam::DVec3;

use crate::emitter::colour::CCT_RANGE_K;
use crate::error::Kind;
use crate::files::scene_toml::description::{
    BeamSection, ColourDescription, EmitterDescription, EmitterShape, Frame, Place, Placed,
};
use crate::files::scene_toml::names::Names;
use crate::files::scene_toml::toml_table::{Interval, Table};
use crate::files::scene_toml::{COORDINATE, LENGTH, direction, orthogonal_part};

const FLUX: Interval = Interval { low: 1e-9, high: 1e12, words: "a flux from 1e-9 to 1e12 lm" };

const CHANNEL: Interval = Interval { low: 0.0, high: 1e9, words: "a part of light from 0 to 1e9" };
const TEMPERATURE: Interval = Interval {
    low: CCT_RANGE_K[0],
    high: CCT_RANGE_K[1],
    words: "a colour temperature from 1000 to 15000 K",
};

#[derive(Clone, Copy)]
enum Type {
    Photometric,
    Isotropic,
    Collimated,
    Panel,
}

const TYPES: [(&str, Type); 4] = [
    ("photometric", Type::Photometric),
    ("isotropic", Type::Isotropic),
    ("collimated", Type::Collimated),
    ("panel", Type::Panel),
];

pub(crate) fn read(mut table: Table<'_, '_>, index: usize, names: &mut Names) -> Option<EmitterDescription> {
    let place = table.place();
    let given = table.text("name");
    let name_place = given.as_ref().map_or(place, |n| n.place);
    let name = given.map_or_else(|| format!("emitter {}", index + 1), |n| n.value);
    names.insert(table.document(), &name, name_place, index);

    let kind = table.word("type", &TYPES);
    let kind = table.require("type", kind, "\"photometric\", \"isotropic\", \"collimated\" or \"panel\"")?;
    table.call(match kind {
        Type::Photometric => "a photometric [[emitter]]",
        Type::Isotropic => "an isotropic [[emitter]]",
        Type::Collimated => "a collimated [[emitter]]",
        Type::Panel => "a panel [[emitter]]",
    });

    let position = table.vector("position", &COORDINATE);
    let position = table.require("position", position, "[x, y, z] in metres");
    let flux_lm = table.number("flux_lm", &FLUX);
    let colour = read_colour(&mut table);
    let (shape, frame) = match kind {
        Type::Photometric => {
            let file = table.path("file");
            (file.map(|file| EmitterShape::Photometric { file }), read_frame(&mut table))
        }
        Type::Isotropic => {
            table.require("flux_lm", flux_lm, FLUX.words);
            (Some(EmitterShape::Isotropic), Some(Frame { aim: DVec3::NEG_Z, up: DVec3::Y }))
        }
        Type::Collimated => {
            table.require("flux_lm", flux_lm, FLUX.words);
            let section = read_section(&mut table);
            (section.map(|section| EmitterShape::Collimated { section }), read_frame(&mut table))
        }
        Type::Panel => {
            table.require("flux_lm", flux_lm, FLUX.words);
            let size = table.numbers::<2>("size", &LENGTH);
            let size = table.require("size", size, "[width, height] in metres");
            (size.map(|[width, height]| EmitterShape::Panel { width, height }), read_frame(&mut table))
        }
    };
    table.finish();
    Some(EmitterDescription {
        name,
        position: position?,
        frame: frame?,
        flux_lm,
        colour,
        shape: shape?,
        place,
    })
}

/// `colour = [r, g, b]`, `cct_k = 3000`, or neither.
fn read_colour(table: &mut Table<'_, '_>) -> Option<Placed<ColourDescription>> {
    let rgb = table.numbers::<3>("colour", &CHANNEL);
    let cct_k = table.number("cct_k", &TEMPERATURE);
    let (rgb_place, cct_place) = (table.place_of("colour"), table.place_of("cct_k"));
    if rgb_place.is_some() && cct_place.is_some() {
        table.error("cct_k", Kind::Range, "either colour or cct_k, not both");
        return None;
    }
    if rgb == Some([0.0; 3]) {
        table.error("colour", Kind::Range, "a colour that is not black: flux_lm says how bright it is");
        return None;
    }
    let placed = |value, place: Option<Place>| place.map(|place| Placed { value, place });
    match (rgb, cct_k) {
        (Some(rgb), _) => placed(ColourDescription::Rgb(rgb), rgb_place),
        (None, Some(cct_k)) => placed(ColourDescription::Cct(cct_k), cct_place),
        (None, None) => None,
    }
}

/// `aim` and `up`, made orthogonal.
fn read_frame(table: &mut Table<'_, '_>) -> Option<Frame> {
    let aim = direction(table, "aim", Some(DVec3::NEG_Z));
    let is_given = table.place_of("up").is_some();
    let up = direction(table, "up", Some(DVec3::Y));
    let (aim, up) = (aim?, up?);
    if let Some(up) = orthogonal_part(up, aim) {
        return Some(Frame { aim, up });
    }
    if is_given {
        table.error("up", Kind::Range, "a direction that is not parallel to aim");
        return None;
    }
    orthogonal_part(DVec3::X, aim).map(|up| Frame { aim, up })
}

/// `radius`, or `size = [width, height]`.
fn read_section(table: &mut Table<'_, '_>) -> Option<BeamSection> {
    let radius = table.number("radius", &LENGTH);
    let size = table.numbers::<2>("size", &LENGTH);
    match (table.place_of("radius").is_some(), table.place_of("size").is_some()) {
        (true, true) => {
            table.error("size", Kind::Range, "either radius or size, not both");
            None
        }
        (true, false) => radius.map(|radius| BeamSection::Disc { radius }),
        (false, true) => size.map(|[width, height]| BeamSection::Rectangle { width, height }),
        (false, false) => {
            table.error("radius", Kind::Missing, "... for a disc, or size = [width, height], in metres");
            None
        }
    }
}
