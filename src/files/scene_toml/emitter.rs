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
use crate::error::{Diagnostic, Kind};
use crate::files::suggest;
use crate::geometry::{COORDINATE, LENGTH};

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
    let frame = read_frame(table)?;
    let (file, position, name) = (file?, position?, name.to_owned());
    Some(Box::new(move |loader| {
        let (photometry, _) = &*loader.photometry(&file)?;
        loader.asked.count(What::Candela, &name, photometry.web.candela.len() as u64)?;
        let emitter = Photometric::new(photometry, position, frame, flux_lm);
        Ok(Emitter::Photometric(emitter.map_err(|e| Diagnostic::from(e).in_file(loader.path(&file)))?))
    }))
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
