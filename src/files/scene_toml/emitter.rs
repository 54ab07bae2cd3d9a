//! `[[emitter]]`: photometric, isotropic, collimated, panel, disc.

use glam::DVec3;

use super::asked::What;
use super::loader::{Make, made};
use super::names::Names;
use super::numbers::DIRECTION;
use super::part::EmitterPart;
use super::table::{Placed, Table};
use crate::emitter::colour::{CCT_K, CHANNEL};
use crate::emitter::{
    AimFrame, AreaLight, Beam, BeamSection, Colour, Disc, Emitter, FLUX, Isotropic, Panel, Photometric,
};
use crate::error::{Diagnostic, Kind, Place};
use crate::files::eulumdat::MAX_LAMP_SETS;
use crate::files::suggest;
use crate::geometry::{COORDINATE, LENGTH};
use crate::photometry::Photometry;
use crate::photometry::tilt::TILT_DEG;

/// What makes an emitter of its table, its position (m) and its flux (lm), where these are given and good.
type Reader = fn(&mut Table<'_, '_>, &str, Option<DVec3>, Option<f64>) -> Option<Make<Emitter>>;

/// The types, each with what messages call it and its reader.
const TYPES: [(&str, (&str, Reader)); 5] = [
    ("photometric", ("a photometric [[emitter]]", read_photometric)),
    ("isotropic", ("an isotropic [[emitter]]", |t, _, p, lm| of_flux(t, p, lm, read_isotropic))),
    ("collimated", ("a collimated [[emitter]]", |t, _, p, lm| of_flux(t, p, lm, read_beam))),
    ("panel", ("a panel [[emitter]]", |t, _, p, lm| of_flux(t, p, lm, read_panel))),
    ("disc", ("a disc [[emitter]]", |t, _, p, lm| of_flux(t, p, lm, read_disc))),
];

pub(super) fn read(mut table: Table<'_, '_>, index: usize, names: &mut Names) -> Option<EmitterPart> {
    let unnamed = Placed { value: format!("emitter {}", index + 1), place: table.place() };
    let name = table.text("name").unwrap_or(unnamed);
    names.insert(table.document(), &name, &name.value, index);
    let words = suggest::list_quoted(&TYPES.map(|(word, _)| word));
    let (what, reader) = table.needed("type", &words, |t, key| t.word(key, &TYPES))?;
    table.call(what);
    let position = table.needed_vector("position", &COORDINATE, "[x, y, z] in metres");
    let flux_lm = table.number("flux_lm", &FLUX);
    let colour = read_colour(&mut table);
    let medium_name = table.text("medium");
    let make = reader(&mut table, &name.value, position, flux_lm);
    table.finish();
    Some(EmitterPart { name: name.value, colour: colour?, make: make?, medium_name, medium: None })
}

/// An emitter whose flux only the scene says.
fn of_flux(
    table: &mut Table<'_, '_>,
    position: Option<DVec3>,
    flux_lm: Option<f64>,
    read: fn(&mut Table<'_, '_>, Light) -> Option<Emitter>,
) -> Option<Make<Emitter>> {
    let flux_lm = table.needed("flux_lm", FLUX.words, |_, _| flux_lm);
    read(table, position.zip(flux_lm)).map(made)
}

fn read_isotropic(table: &mut Table<'_, '_>, light: Light) -> Option<Emitter> {
    let (position, flux_lm) = light?;
    table.accept(Isotropic::new(position, flux_lm)).map(Emitter::Isotropic)
}

fn read_photometric(
    table: &mut Table<'_, '_>,
    name: &str,
    position: Option<DVec3>,
    flux_lm: Option<f64>,
) -> Option<Make<Emitter>> {
    let file = table.path("file");
    let lamp_set =
        table.integer("lamp_set", 1, MAX_LAMP_SETS as u64, "the number of a lamp set of the file, from 1");
    let lamp_set =
        table.place_of("lamp_set").zip(lamp_set).map(|(place, n)| Placed { value: n as usize, place });
    let tilt_deg = table.angle("tilt_deg", &TILT_DEG);
    let tilt_deg = table.place_of("tilt_deg").zip(tilt_deg).map(|(place, value)| Placed { value, place });
    let frame = read_frame(table)?;
    let (file, position, name, place) = (file?, position?, name.to_owned(), table.place());
    Some(Box::new(move |loader| {
        let (photometry, _) = &*loader.photometry(&file, lamp_set.as_ref())?;
        loader.asked.count(What::Candela, &name, photometry.web.candela.len() as u64)?;
        let emitter = match &tilt_deg {
            Some(tilt) => Photometric::at_tilt(photometry, tilt.value, position, frame, flux_lm),
            None => Photometric::new(photometry, position, frame, flux_lm),
        };
        let emitter = emitter.map_err(|e| match &tilt_deg {
            Some(tilt) if e.what() == "tilt_deg" => {
                Diagnostic::from(e).placed(Some(tilt.place)).in_file(&loader.name)
            }
            _ => Diagnostic::from(e).in_file(loader.path(&file)),
        })?;
        if let Some(doubt) = of_tilt(photometry, tilt_deg.as_ref(), flux_lm.is_some(), place) {
            loader.warnings.push(doubt.in_file(&loader.name));
        }
        Ok(Emitter::Photometric(emitter))
    }))
}

/// What to say of a tilt table that nobody asks for, or whose factor changes nothing.
fn of_tilt(
    photometry: &Photometry,
    tilt_deg: Option<&Placed<f64>>,
    has_flux: bool,
    place: Place,
) -> Option<Diagnostic> {
    let table = photometry.tilt_table()?;
    let (low, high) = table.factor_range();
    match tilt_deg {
        Some(tilt) if has_flux => {
            let d = Diagnostic::new(Kind::Range, "tilt_deg beside flux_lm", "one of them");
            Some(
                d.placed(Some(tilt.place))
                    .hint("flux_lm is what the lamp emits: the tilt's factor changes nothing"),
            )
        }
        None if !has_flux && (low, high) != (1.0, 1.0) => {
            let found =
                format!("a lamp with a tilt table: factors {low} to {high} at {} degrees", table.range());
            let taken = match photometry.untilted_factor() {
                Some(factor) => format!("0 is taken: a factor of {factor}"),
                None => "the table does not reach 0 degrees: a factor of 1 is taken".to_owned(),
            };
            let required = "tilt_deg, the tilt at which it is mounted";
            Some(Diagnostic::new(Kind::Missing, found, required).placed(Some(place)).hint(taken))
        }
        _ => None,
    }
}

/// Position (m) and flux (lm), where both are good.
type Light = Option<(DVec3, f64)>;

/// A beam of `radius`, or `size = [width, height]`.
fn read_beam(table: &mut Table<'_, '_>, light: Light) -> Option<Emitter> {
    let radius = table.number("radius", &LENGTH);
    let size = table.numbers::<2>("size", &LENGTH);
    match (table.place_of("radius").is_some(), table.place_of("size").is_some()) {
        (true, true) => table.error("size", Kind::Range, "either radius or size, not both"),
        (false, false) => {
            table.error("radius", Kind::Missing, "... for a disc, or size = [width, height], in metres");
        }
        _ => {}
    }
    let frame = read_frame(table)?;
    let section = match (radius, size) {
        (Some(radius), _) => BeamSection::Disc { radius },
        (None, Some([width, height])) => BeamSection::Rectangle { width, height },
        (None, None) => return None,
    };
    let (centre, flux_lm) = light?;
    table.accept(Beam::new(centre, frame, section, flux_lm)).map(Emitter::Beam)
}

fn read_panel(table: &mut Table<'_, '_>, light: Light) -> Option<Emitter> {
    let size = table.needed("size", "[width, height] in metres", |t, key| t.numbers(key, &LENGTH));
    let frame = read_frame(table)?;
    let ((centre, flux_lm), panel) = (light?, table.accept(Panel::new(size?))?);
    table.accept(AreaLight::new(centre, frame, panel, flux_lm)).map(Emitter::Panel)
}

fn read_disc(table: &mut Table<'_, '_>, light: Light) -> Option<Emitter> {
    let radius = table.needed("radius", "... in metres", |t, key| t.number(key, &LENGTH));
    let frame = read_frame(table)?;
    let ((centre, flux_lm), disc) = (light?, table.accept(Disc::new(radius?))?);
    table.accept(AreaLight::new(centre, frame, disc, flux_lm)).map(Emitter::Disc)
}

/// `colour = [r, g, b]`, `cct_k = 3000`, or neither.
fn read_colour(table: &mut Table<'_, '_>) -> Option<Colour> {
    let rgb = table.numbers::<3>("colour", &CHANNEL);
    let cct_k = table.number("cct_k", &CCT_K);
    match (table.place_of("colour"), table.place_of("cct_k")) {
        (None, None) => Some(Colour::WHITE),
        (Some(_), None) => table.accept(Colour::new(rgb?)),
        (None, Some(place)) => {
            let (colour, clipped) = table.accept(Colour::black_body(cct_k?))?;
            if clipped {
                let found = format!("cct_k = {}, a light more saturated than sRGB can show", cct_k?);
                let required = "about 1900 K or more; its blue is taken as 0 instead of below";
                table.document().warn_at(place, Kind::Range, found, required);
            }
            Some(colour)
        }
        (Some(_), Some(_)) => {
            table.error("cct_k", Kind::Range, "either colour or cct_k, not both");
            None
        }
    }
}

/// `aim` and `up`.
fn read_frame(table: &mut Table<'_, '_>) -> Option<AimFrame> {
    let mut direction = |key| {
        let vector = table.vector(key, &DIRECTION);
        (vector.is_some() || table.place_of(key).is_none()).then_some(vector)
    };
    let (aim, up) = (direction("aim"), direction("up"));
    table.accept(AimFrame::new(aim?.unwrap_or(DVec3::NEG_Z), up?))
}
