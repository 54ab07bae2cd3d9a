//! `[material.NAME]`: dielectric, mirror, lambertian, absorber, tabulated.

use glam::DVec3;

use super::asked::What;
use super::loader::{Make, made};
use super::numbers::{DIRECTION, DIRECTION_REQUIRED};
use super::part::MaterialPart;
use super::table::Table;
use crate::error::{Diagnostic, Kind, Result};
use crate::files::suggest;
use crate::geometry::{ANGLE, Shape};
use crate::math::frame::unit;
use crate::surface::dielectric::IOR;
use crate::surface::diffuse_transmission::TRANSMITTANCE;
use crate::surface::reflectance::REFLECTANCE;
use crate::surface::tabulated::{Energy, Options, Sides};
use crate::surface::{
    Dielectric, DiffuseTransmission, Lambertian, Material, Mirror, Reference, Reflectance, Tabulated,
};

/// What a material's table says beside what it is made of.
#[derive(Default)]
struct Aside {
    /// The direction from which azimuths are counted, where one is given.
    reference: Option<DVec3>,
    /// The refractive index of one that can name a medium.
    ior: Option<f64>,
}

/// What makes a material of its table.
type Reader = fn(&mut Table<'_, '_>, &str, &mut Aside) -> Option<Make<Material>>;

/// The types, each with its reader.
const TYPES: [(&str, Reader); 5] = [
    ("dielectric", |table, _, aside| {
        let dielectric = read_dielectric(table)?;
        aside.ior = Some(dielectric.ior());
        Some(made(Material::Dielectric(dielectric)))
    }),
    ("mirror", |table, _, _| read_mirror(table).map(made)),
    ("lambertian", |table, _, _| read_lambertian(table).map(made)),
    ("absorber", |table, _, _| {
        table.call("an absorber");
        Some(made(Material::Absorber))
    }),
    ("tabulated", read_tabulated),
];

const SIDES: [(&str, Sides); 3] = [("front", Sides::Front), ("back", Sides::Back), ("both", Sides::Both)];

const ENERGIES: [(&str, Energy); 2] = [("refuse", Energy::Refuse), ("scale", Energy::Scale)];

pub(super) fn read(mut table: Table<'_, '_>, name: &str) -> Option<MaterialPart> {
    if table.word_of("type") == Some("conductor") {
        let required =
            format!("{}; conductor is not available yet", suggest::list(&TYPES.map(|(word, _)| word)));
        table.error("type", Kind::Unavailable, &required);
        return None;
    }
    let required = suggest::list_quoted(&TYPES.map(|(word, _)| word));
    let reader = table.needed("type", &required, |t, key| t.word(key, &TYPES))?;
    let mut aside = Aside::default();
    let make = reader(&mut table, name, &mut aside);
    table.finish();
    Some(MaterialPart { make: make?, reference: aside.reference, ior: aside.ior })
}

fn read_mirror(table: &mut Table<'_, '_>) -> Option<Material> {
    table.call("a mirror");
    let rgb = table.number_or_vector("reflectance", &REFLECTANCE).unwrap_or(DVec3::ONE);
    let reflectance = table.accept(Reflectance::rgb(rgb.to_array()))?;
    Some(Material::Mirror(Mirror::new(reflectance)))
}

fn read_lambertian(table: &mut Table<'_, '_>) -> Option<Material> {
    table.call("a lambertian material");
    let reflectance =
        table.needed("reflectance", REFLECTANCE.words, |t, key| t.number_or_vector(key, &REFLECTANCE));
    let transmittance = table.number_or_vector("transmittance", &TRANSMITTANCE).unwrap_or(DVec3::ZERO);
    let reflectance = reflectance?.to_array();
    if transmittance != DVec3::ZERO {
        let sheet = DiffuseTransmission::new(reflectance, transmittance.to_array());
        return table.accept(sheet).map(Material::DiffuseTransmission);
    }
    let reflectance = table.accept(Reflectance::rgb(reflectance))?;
    Some(Material::Lambertian(Lambertian::new(reflectance)))
}

fn read_dielectric(table: &mut Table<'_, '_>) -> Option<Dielectric> {
    table.call("a dielectric");
    let ior = table.number("ior", &IOR);
    let ior_outside = table.number("ior_outside", &IOR);
    let ior = table.needed("ior", IOR.words, |_, _| ior)?;
    if Some(ior) == ior_outside {
        let place = table.place_of("ior").unwrap_or(table.place());
        let found = format!("ior = {ior}, the same as ior_outside");
        table.document().warn_at(place, Kind::Range, found, "two media that differ: light passes unchanged");
    }
    table.accept(Dielectric::new(ior, ior_outside))
}

/// What makes the table.
fn read_tabulated(table: &mut Table<'_, '_>, name: &str, aside: &mut Aside) -> Option<Make<Material>> {
    table.call("a tabulated material");
    let file = table.path("file");
    let sides = table.word("side", &SIDES).unwrap_or_default();
    let rotation_deg = table.angle("rotation_deg", &ANGLE).unwrap_or(0.0);
    let along = table.vector("reference", &DIRECTION);
    if along.is_some_and(|v| unit(v).is_none()) {
        table.error("reference", Kind::Range, DIRECTION_REQUIRED);
    }
    aside.reference = along.and_then(unit);
    let energy = table.word("energy", &ENERGIES).unwrap_or_default();
    let specular_remainder = table.truth("specular_remainder").unwrap_or(false);
    let (file, called) = (file?, name.to_owned());
    let options = Options { energy, sides, rotation_deg, specular_remainder, ..Options::default() };
    Some(Box::new(move |loader| {
        let name = loader.path(&file).display().to_string();
        let table = loader.scattering(&file)?;
        let values: usize = table.lobes.iter().map(|lobe| lobe.values.len()).sum();
        loader.asked.count(What::Scattering, &called, values as u64)?;
        // The table is as it should be; that it is laid on a surface here is what the scene can change.
        let (table, found) = Tabulated::new(&table, &options).map_err(|e| {
            let found = format!("{} in \"{}\"", e.found(), file.value);
            let refused = Diagnostic::new(e.kind(), found, e.required()).placed(Some(file.place));
            let refused = refused.in_file(&loader.name);
            e.advice().map_or_else(|| refused.clone(), |hint| refused.clone().hint(hint))
        })?;
        loader.warnings.extend(found.into_iter().map(|w| w.in_file(&name)));
        Ok(Material::Tabulated(Box::new(table)))
    }))
}

/// A material on a surface: a table is told which direction its azimuths are counted from there.
pub(super) fn laid_on(material: &Material, reference: Option<DVec3>, shape: &Shape) -> Result<Material> {
    let Material::Tabulated(table) = material else { return Ok(material.clone()) };
    let own = || match shape {
        Shape::Rectangle(rectangle) => Reference::Along(rectangle.edge_u()),
        Shape::Paraboloid(paraboloid) => Reference::Around(paraboloid.axis()),
        Shape::Sphere(_) => Reference::Around(DVec3::Z),
        Shape::Mesh(_) => Reference::Along(DVec3::X),
    };
    let reference = reference.map_or_else(own, Reference::Along);
    Ok(Material::Tabulated(Box::new(table.with_reference(reference)?)))
}
