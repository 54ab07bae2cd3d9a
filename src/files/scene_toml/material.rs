//! `[material.NAME]`: dielectric, mirror, lambertian, absorber, tabulated.

use crate::error::{Invalid, Kind};
use crate::files::scene_toml::description::{MaterialDescription, MaterialKind, TabulatedDescription};
use crate::files::scene_toml::toml_table::{Interval, Table};
use crate::files::scene_toml::{ANGLE, direction};
use crate::surface::tabulated::{Energy, Sides};
use crate::surface::{
    Dielectric, DiffuseTransmission, Lambertian, Material, Mirror, Reflectance, dielectric,
    diffuse_transmission, reflectance,
};

const IOR: Interval = interval(dielectric::RANGE, dielectric::REQUIRED);
const REFLECTANCE: Interval = interval(reflectance::RANGE, reflectance::REQUIRED);
const TRANSMITTANCE: Interval = interval(reflectance::RANGE, diffuse_transmission::REQUIRED);

const fn interval([low, high]: [f64; 2], words: &'static str) -> Interval {
    Interval { low, high, words }
}

#[derive(Clone, Copy)]
enum Type {
    Dielectric,
    Mirror,
    Lambertian,
    Absorber,
    Tabulated,
}

const TYPES: [(&str, Type); 5] = [
    ("dielectric", Type::Dielectric),
    ("mirror", Type::Mirror),
    ("lambertian", Type::Lambertian),
    ("absorber", Type::Absorber),
    ("tabulated", Type::Tabulated),
];

const SIDES: [(&str, Sides); 3] = [("front", Sides::Front), ("back", Sides::Back), ("both", Sides::Both)];

const ENERGIES: [(&str, Energy); 2] = [("refuse", Energy::Refuse), ("scale", Energy::Scale)];

pub(crate) fn read(mut table: Table<'_, '_>, name: String) -> Option<MaterialDescription> {
    let place = table.place();
    if table.is_unavailable("type", &["conductor"], &TYPES.map(|(word, _)| word)) {
        return None;
    }
    let kind = table.word("type", &TYPES);
    let required = "\"dielectric\", \"mirror\", \"lambertian\", \"absorber\" or \"tabulated\"";
    let kind = table.require("type", kind, required)?;
    let kind = match kind {
        Type::Dielectric => read_dielectric(&mut table),
        Type::Mirror => {
            table.call("a mirror");
            let reflectance = parts(&mut table, "reflectance", &REFLECTANCE).unwrap_or([1.0; 3]);
            guarded(&table, Reflectance::rgb(reflectance)).map(|r| Material::Mirror(Mirror::new(r)).into())
        }
        Type::Lambertian => read_lambertian(&mut table),
        Type::Absorber => {
            table.call("an absorber");
            Some(Material::Absorber.into())
        }
        Type::Tabulated => read_tabulated(&mut table),
    };
    table.finish();
    Some(MaterialDescription { name, kind: kind?, place })
}

/// A number, or `[r, g, b]`.
fn parts(table: &mut Table<'_, '_>, key: &'static str, range: &Interval) -> Option<[f64; 3]> {
    table.number_or_vector(key, range).map(|rgb| rgb.to_array())
}

/// What a constructor made; what it refuses is an error at the place of that key.
fn guarded<T>(table: &Table<'_, '_>, made: Result<T, Invalid>) -> Option<T> {
    made.map_err(|e| table.error(e.what(), Kind::Range, e.required())).ok()
}

fn read_lambertian(table: &mut Table<'_, '_>) -> Option<MaterialKind> {
    table.call("a lambertian material");
    let reflectance = parts(table, "reflectance", &REFLECTANCE);
    let reflectance = table.require("reflectance", reflectance, REFLECTANCE.words);
    let transmittance = parts(table, "transmittance", &TRANSMITTANCE).unwrap_or([0.0; 3]);
    if transmittance == [0.0; 3] {
        let reflectance = guarded(table, Reflectance::rgb(reflectance?))?;
        return Some(Material::Lambertian(Lambertian::new(reflectance)).into());
    }
    let sheet = guarded(table, DiffuseTransmission::new(reflectance?, transmittance))?;
    Some(Material::DiffuseTransmission(sheet).into())
}

fn read_dielectric(table: &mut Table<'_, '_>) -> Option<MaterialKind> {
    table.call("a dielectric");
    let ior = table.number("ior", &IOR);
    let ior_outside = table.number("ior_outside", &IOR).unwrap_or(1.0);
    let ior = table.require("ior", ior, IOR.words)?;
    if ior == ior_outside {
        let place = table.place_of("ior").unwrap_or(table.place());
        let found = format!("ior = {ior}, the same as ior_outside");
        table.document().warn_at(place, Kind::Range, found, "two media that differ: light passes unchanged");
    }
    guarded(table, Dielectric::new(ior, ior_outside)).map(|glass| Material::Dielectric(glass).into())
}

fn read_tabulated(table: &mut Table<'_, '_>) -> Option<MaterialKind> {
    table.call("a tabulated material");
    let file = table.path("file");
    let sides = table.word("side", &SIDES).unwrap_or_default();
    let rotation_deg = table.number("rotation_deg", &ANGLE).unwrap_or(0.0);
    let reference = match table.place_of("reference") {
        Some(_) => Some(direction(table, "reference", None)?),
        None => None,
    };
    let energy = table.word("energy", &ENERGIES).unwrap_or_default();
    let specular_remainder = table.truth("specular_remainder").unwrap_or(false);
    Some(MaterialKind::Tabulated(TabulatedDescription {
        file: file?,
        sides,
        rotation_deg,
        reference,
        energy,
        specular_remainder,
    }))
}
