//! `[[emitter]]`: photometric, isotropic, collimated, panel, disc.

use glam::DVec3;

use crate::emitter::colour::CCT_RANGE_K;
use crate::emitter::{AimFrame, BeamSection};
use crate::error::Kind;
use crate::files::scene_toml::description::{
    ColourDescription, EmitterDescription, EmitterShape, Place, Placed,
};
use crate::files::scene_toml::names::Names;
use crate::files::scene_toml::toml_table::{Interval, Table};
use crate::files::scene_toml::{COORDINATE, DIRECTION, LENGTH};

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
    Disc,
}

const TYPES: [(&str, Type); 5] = [
    ("photometric", Type::Photometric),
    ("isotropic", Type::Isotropic),
    ("collimated", Type::Collimated),
    ("panel", Type::Panel),
    ("disc", Type::Disc),
];

pub(crate) fn read(mut table: Table<'_, '_>, index: usize, names: &mut Names) -> Option<EmitterDescription> {
    let place = table.place();
    let given = table.text("name");
    let name_place = given.as_ref().map_or(place, |n| n.place);
    let name = given.map_or_else(|| format!("emitter {}", index + 1), |n| n.value);
    names.insert(table.document(), &name, name_place, index);

    let kind = table.word("type", &TYPES);
    let words = "\"photometric\", \"isotropic\", \"collimated\", \"panel\" or \"disc\"";
    let kind = table.require("type", kind, words)?;
    table.call(match kind {
        Type::Photometric => "a photometric [[emitter]]",
        Type::Isotropic => "an isotropic [[emitter]]",
        Type::Collimated => "a collimated [[emitter]]",
        Type::Panel => "a panel [[emitter]]",
        Type::Disc => "a disc [[emitter]]",
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
            (Some(EmitterShape::Isotropic), AimFrame::new(DVec3::NEG_Z, None).ok())
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
        Type::Disc => {
            table.require("flux_lm", flux_lm, FLUX.words);
            let radius = table.number("radius", &LENGTH);
            let radius = table.require("radius", radius, "... in metres");
            (radius.map(|radius| EmitterShape::Disc { radius }), read_frame(&mut table))
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
fn read_frame(table: &mut Table<'_, '_>) -> Option<AimFrame> {
    let mut direction = |key| {
        let vector = table.vector(key, &DIRECTION).map(|vector| vector.value);
        (vector.is_some() || table.place_of(key).is_none()).then_some(vector)
    };
    let (aim, up) = (direction("aim"), direction("up"));
    let frame = AimFrame::new(aim?.unwrap_or(DVec3::NEG_Z), up?);
    frame.map_err(|e| table.error(e.what(), Kind::Range, e.required())).ok()
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
