//! The tables of a scene file, and its parts as they stand in it.

use std::cell::RefCell;

use super::asked::Asked;
use super::document::Document;
use super::names::Names;
use super::part::{EmitterPart, MaterialPart, SurfacePart};
use super::table::{Placed, Table, shown};
use super::{camera, emitter, far_field, material, receiver, surface};
use crate::error::{Kind, Place};
use crate::scene::camera::Camera;
use crate::scene::far_field::FarFieldSpec;
use crate::scene::media::Medium;
use crate::scene::receiver::ReceiverSpec;

/// Most emitters, materials, surfaces or receivers of one scene, each.
pub const MOST_PARTS: usize = 4096;

/// Most replicates.
const MOST_REPLICATES: u64 = 65_536;

/// Most reflections of `[compare]`: M of them take 2 M + 4 coordinates, and 64 are a sequence's own.
const MOST_COMPARED_REFLECTIONS: u64 = 30;

/// `[run]`: what the command line takes where it says nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RunDefaults {
    /// Number of photons, 1 to 2^48.
    pub photons: Option<u64>,
    /// Seed of the sequence.
    pub seed: Option<u64>,
    /// Number of replicates, 1 to 65536.
    pub replicates: Option<u32>,
}

/// The parts of a scene; `None` stands for one with an error, so that indices stay those of the file.
pub(super) struct Parts {
    pub emitters: Vec<Option<(EmitterPart, Place)>>,
    pub materials: Vec<Option<(MaterialPart, Place)>>,
    pub surfaces: Vec<Option<(SurfacePart, Place)>>,
    pub receivers: Vec<Option<(ReceiverSpec, Place)>>,
    pub far_fields: Vec<Option<(FarFieldSpec, Place)>>,
    pub camera: Option<(Camera, Option<Medium>, Place)>,
    pub ambient: Option<Medium>,
    pub compared_reflections: Option<u32>,
    pub run: RunDefaults,
    /// Every mention of a file.
    pub files: Vec<Placed<String>>,
    /// What the text asks for, before any file is looked at.
    pub asked: Asked,
}

impl Parts {
    pub fn read(mut root: Table<'_, '_>) -> Self {
        let document = root.document();
        let start = root.place();

        let emitter_tables = parts_named(&mut root, "emitter");
        if root.place_of("emitter").is_none() {
            let found = "a scene without [[emitter]]";
            root.absent("emitter", found, "at least one [[emitter]]");
        }
        let mut names = Names::new("emitter");
        let mut emitters = read_each(emitter_tables, |table, index| emitter::read(table, index, &mut names));

        let material_tables = root
            .table("material", "the materials")
            .map(|t| t.named_tables("a [material.NAME]", MOST_PARTS, "a table [material.NAME]"))
            .unwrap_or_default();
        let mut material_names = Names::new("material");
        let (names, tables): (Vec<_>, Vec<_>) = material_tables.into_iter().unzip();
        let materials = read_each(tables, |table, index| {
            let name = Placed { value: names[index].clone(), place: table.place() };
            material_names.insert(document, &name, &name.value, index);
            material::read(table, &name.value)
        });

        let named = RefCell::new(Vec::new());
        let medium = |name: &Placed<String>| {
            named.borrow_mut().push(name.value.clone());
            medium_named(document, name, &material_names, &materials)
        };
        for (part, _) in emitters.iter_mut().flatten() {
            part.medium = part.medium_name.as_ref().and_then(medium);
        }
        let ambient = root.table("ambient", "[ambient]").and_then(|mut table| {
            let required = "the name of a dielectric material, or \"air\"";
            let name = table.needed("medium", required, |t, key| t.text(key));
            table.finish();
            medium(&name?)
        });

        let mut surface_names = Names::new("surface");
        let mut asked = Asked::default();
        let surfaces = read_each(parts_named(&mut root, "surface"), |table, index| {
            surface::read(table, index, &mut surface_names, &material_names, &mut asked)
        });

        let mut names = Names::new("receiver").advising(
            "give it another `name`: names become names of files, and some systems don't tell capitals from small letters",
        );
        let receivers = read_each(parts_named(&mut root, "receiver"), |table, index| {
            receiver::read(table, index, &mut names, &surface_names, &surfaces)
        });
        // Their names are of one kind: those of files.
        let count = receivers.len();
        let far_fields = read_each(parts_named(&mut root, "far_field"), |table, index| {
            far_field::read(table, count + index, &mut names, &surface_names)
        });
        let measures = ["receiver", "far_field", "camera"];
        if measures.iter().all(|key| root.place_of(key).is_none()) {
            let required = "at least one [[receiver]], [[far_field]] or a [camera], or nothing is measured but the ledger";
            document.warn_at(start, Kind::Missing, "a scene without [[receiver]]", required);
        }
        let camera = root.table("camera", "[camera]").and_then(|mut table| {
            let place = table.place();
            let medium = table.text("medium").as_ref().and_then(medium);
            Some((camera::read(table)?, medium, place))
        });
        warn_unused(document, &material_names, &surfaces, &named.into_inner());
        let compared_reflections = root.table("compare", "[compare]").and_then(read_compare);
        let run = root.table("run", "[run]").map(read_run).unwrap_or_default();
        root.finish();
        let files = document.files();
        Self {
            emitters,
            materials,
            surfaces,
            receivers,
            far_fields,
            camera,
            ambient,
            compared_reflections,
            run,
            files,
            asked,
        }
    }
}

/// What `read` makes of each table and its index, with the place of its header.
fn read_each<'t, 'd, T>(
    tables: Vec<Table<'t, 'd>>,
    mut read: impl FnMut(Table<'t, 'd>, usize) -> Option<T>,
) -> Vec<Option<(T, Place)>> {
    let read = |(index, table): (usize, Table<'t, 'd>)| {
        let place = table.place();
        Some((read(table, index)?, place))
    };
    tables.into_iter().enumerate().map(read).collect()
}

/// The tables `[[key]]` of the scene.
fn parts_named<'t, 'd>(root: &mut Table<'t, 'd>, key: &'static str) -> Vec<Table<'t, 'd>> {
    let what = format!("an [[{key}]]").replace("an [[s", "a [[s").replace("an [[r", "a [[r");
    let required = format!("1 to {MOST_PARTS} tables headed [[{key}]] (two brackets)");
    root.tables(key, &what, MOST_PARTS, &required).unwrap_or_default()
}

/// The medium that a dielectric material is, or air.
fn medium_named(
    document: &Document<'_>,
    name: &Placed<String>,
    names: &Names,
    materials: &[Option<(MaterialPart, Place)>],
) -> Option<Medium> {
    let known = names.in_order().into_iter().find(|(known, _, _)| *known == name.value);
    let Some((_, _, index)) = known else {
        if name.value == "air" {
            return Some(Medium::air());
        }
        let found = format!("the medium `{}`", shown(&name.value));
        document.error_at(name.place, Kind::Unknown, found, "the name of a dielectric material, or \"air\"");
        return None;
    };
    // A material in error is reported already.
    let (material, _) = materials[index].as_ref()?;
    if material.ior.is_none() {
        let found = format!("the material `{}`, which is no medium", shown(&name.value));
        document.error_at(name.place, Kind::Range, found, "a material with type = \"dielectric\"");
    }
    Some(Medium { name: name.value.clone(), ior: material.ior? })
}

fn warn_unused(
    document: &Document<'_>,
    names: &Names,
    surfaces: &[Option<(SurfacePart, Place)>],
    media: &[String],
) {
    let used: Vec<usize> = surfaces.iter().flatten().map(|(s, _)| s.material).collect();
    for (name, place, index) in names.in_order() {
        if !used.contains(&index) && !media.iter().any(|medium| medium == name) {
            let found = format!("the material `{name}`, which no surface has");
            document.warn_at(place, Kind::Unknown, found, format!("a surface with material = \"{name}\""));
        }
    }
}

/// `[compare]`: reflections.
fn read_compare(mut table: Table<'_, '_>) -> Option<u32> {
    let words = format!("a whole number from 0 to {MOST_COMPARED_REFLECTIONS}");
    let reflections =
        table.needed("reflections", &words, |t, key| t.integer(key, 0, MOST_COMPARED_REFLECTIONS, &words));
    table.finish();
    reflections.map(|r| r as u32)
}

/// `[run]`: photons, seed, replicates.
fn read_run(mut table: Table<'_, '_>) -> RunDefaults {
    let photons = table.count("photons");
    let seed = table.integer("seed", 0, u64::MAX, "a whole number from 0 to 2^64 - 1");
    let replicates = table.integer("replicates", 1, MOST_REPLICATES, "a whole number from 1 to 65536");
    if photons.zip(replicates).is_some_and(|(photons, replicates)| photons < replicates) {
        table.error("replicates", Kind::Range, "at most as many replicates as photons");
    }
    table.finish();
    RunDefaults { photons, seed, replicates: replicates.map(|r| r as u32) }
}
