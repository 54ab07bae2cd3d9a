//! Reading a scene file: TOML text to a checked [`Description`], or every error at once.
//!
//! docs/SCENE.md is the manual of the format; the readers of its parts are the files of this folder.

pub mod build;
mod camera;
pub mod count;
pub mod description;
pub mod document;
pub mod source;
pub mod suggest;
pub mod toml_table;
pub mod without_camera;
mod emitter;
mod heightfield;
mod material;
mod names;
mod receiver;
mod surface;
mod syntax;

use std::path::{Path, PathBuf};

use glam::DVec3;

pub use crate::files::scene_toml::camera::MOST_PIXELS as MOST_CAMERA_PIXELS;
pub use crate::files::scene_toml::heightfield::MOST_CELLS as MOST_HEIGHTFIELD_CELLS;

use crate::error::{Diagnostic, Kind};
use crate::files::scene_toml::description::{
    CameraDescription, CompareDescription, Description, Place, Placed, RunDescription,
};
use crate::files::scene_toml::document::Document;
use crate::files::scene_toml::names::Names;
use crate::files::scene_toml::source::{Base, Source};
use crate::files::scene_toml::toml_table::{Interval, Table};

/// Most emitters, materials, surfaces or receivers of one scene, each.
pub const MOST_PARTS: usize = 4096;

/// Most replicates.
pub const MOST_REPLICATES: u64 = 65_536;

/// Most reflections of `[compare]`: M of them take 2 M + 4 coordinates, and 64 are a sequence's own.
pub const MOST_COMPARED_REFLECTIONS: u64 = 30;

const COORDINATE: Interval = Interval { low: -1e9, high: 1e9, words: "a number of metres from -1e9 to 1e9" };
const LENGTH: Interval = Interval { low: 1e-9, high: 1e9, words: "a length from 1e-9 to 1e9 m" };
const DIRECTION: Interval = Interval { low: -1e9, high: 1e9, words: "a number from -1e9 to 1e9" };
const ANGLE: Interval = Interval { low: -1e6, high: 1e6, words: "an angle from -1e6 to 1e6 degrees" };

/// Read a scene file of at most [`source::SCENE_LIMIT_BYTES`] and look for the files it names.
///
/// # Errors
/// Every error of the file, in its order: syntax, unknown keys and words, missing keys, values out of range,
/// names used twice or not at all, files that are not there. At most [`crate::files::scene_toml::document::MOST_ERRORS`], and
/// one that counts the rest.
pub fn read(path: impl AsRef<Path>) -> Result<Description, Vec<Diagnostic>> {
    let path = path.as_ref();
    let name = path.display().to_string();
    let bytes = source::read_capped(path, source::SCENE_LIMIT_BYTES).map_err(|e| vec![e.in_file(&name)])?;
    let text = std::str::from_utf8(&bytes).map_err(|e| vec![not_utf8(&bytes, e.valid_up_to(), &name)])?;
    let directory = path.parent().map(PathBuf::from).unwrap_or_default();
    let description = parse(text, &name, Base::Directory(directory))?;
    let missing = description.missing_files();
    if missing.is_empty() { Ok(description) } else { Err(missing) }
}

/// Read a scene from its text; no file is opened. `name` is for messages.
///
/// # Errors
/// As [`read`], but for the files that the scene names.
pub fn parse(text: &str, name: &str, base: Base) -> Result<Description, Vec<Diagnostic>> {
    if text.len() as u64 > source::SCENE_LIMIT_BYTES {
        let limit = format!("{} MiB", source::SCENE_LIMIT_BYTES >> 20);
        let found = format!("a scene of more than {limit}");
        return Err(vec![Diagnostic::new(Kind::Limit, found, format!("at most {limit}")).in_file(name)]);
    }
    let body = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document = Document::new(body, name);
    let root = match syntax::parse(body) {
        Ok(root) => root,
        Err(faults) => {
            syntax::report(&document, body, &faults);
            return Err(document.finish().err().unwrap_or_default());
        }
    };
    let parts = Parts::read(Table::new(&document, root.get_ref(), "a scene", Place { line: 1, column: 1 }));
    let warnings = document.finish()?;
    Ok(Description {
        source: Source::new(text, name, base),
        emitters: parts.emitters.into_iter().flatten().collect(),
        materials: parts.materials.into_iter().flatten().collect(),
        surfaces: parts.surfaces.into_iter().flatten().collect(),
        receivers: parts.receivers.into_iter().flatten().collect(),
        camera: parts.camera,
        compare: parts.compare,
        run: parts.run,
        warnings,
    })
}

/// The parts of a scene; `None` stands for one with an error, so that indices stay those of the file.
struct Parts {
    emitters: Vec<Option<description::EmitterDescription>>,
    materials: Vec<Option<description::MaterialDescription>>,
    surfaces: Vec<Option<description::SurfaceDescription>>,
    receivers: Vec<Option<description::ReceiverDescription>>,
    camera: Option<CameraDescription>,
    compare: Option<CompareDescription>,
    run: RunDescription,
}

impl Parts {
    fn read(mut root: Table<'_, '_>) -> Self {
        let document = root.document();
        let start = root.place();

        let emitter_tables = parts_named(&mut root, "emitter");
        if root.place_of("emitter").is_none() {
            document.error_at(
                start,
                Kind::Missing,
                "a scene without [[emitter]]",
                "at least one [[emitter]]",
            );
        }
        let mut names = Names::new("emitter");
        let emitters = emitter_tables
            .into_iter()
            .enumerate()
            .map(|(index, table)| emitter::read(table, index, &mut names))
            .collect();

        let material_tables = root
            .table("material", "the materials")
            .map(|t| t.named_tables("a [material.NAME]", MOST_PARTS, "a table [material.NAME]"))
            .unwrap_or_default();
        let mut material_names = Names::new("material");
        let mut materials = Vec::new();
        for (index, (name, table)) in material_tables.into_iter().enumerate() {
            material_names.insert(document, &name, table.place(), index);
            materials.push(material::read(table, name));
        }

        let mut surface_names = Names::new("surface");
        let surfaces: Vec<_> = parts_named(&mut root, "surface")
            .into_iter()
            .enumerate()
            .map(|(index, table)| surface::read(table, index, &mut surface_names, &material_names))
            .collect();
        heightfield::check_total(document, &surfaces);

        let mut names = Names::new("receiver");
        let receivers: Vec<_> = parts_named(&mut root, "receiver")
            .into_iter()
            .enumerate()
            .map(|(index, table)| receiver::read(table, index, &mut names, &surface_names, &surfaces))
            .collect();
        receiver::check_total(document, &receivers);
        if root.place_of("receiver").is_none() && root.place_of("camera").is_none() {
            let required = "at least one [[receiver]], or a [camera], or nothing is measured but the ledger";
            document.warn_at(start, Kind::Missing, "a scene without [[receiver]]", required);
        }
        warn_unused(document, &material_names, &surfaces);

        let camera = root.table("camera", "[camera]").and_then(camera::read);
        let compare = root.table("compare", "[compare]").and_then(read_compare);
        let run = root.table("run", "[run]").map(read_run).unwrap_or_default();
        root.finish();
        Self { emitters, materials, surfaces, receivers, camera, compare, run }
    }
}

/// The tables `[[key]]` of the scene.
fn parts_named<'t, 'd>(root: &mut Table<'t, 'd>, key: &'static str) -> Vec<Table<'t, 'd>> {
    let what = format!("an [[{key}]]").replace("an [[s", "a [[s").replace("an [[r", "a [[r");
    let required = format!("1 to {MOST_PARTS} tables headed [[{key}]] (two brackets)");
    root.tables(key, &what, MOST_PARTS, &required).unwrap_or_default()
}

fn warn_unused(document: &Document<'_>, names: &Names, surfaces: &[Option<description::SurfaceDescription>]) {
    let used: Vec<usize> = surfaces.iter().flatten().map(|s| s.material.index).collect();
    for (name, place, index) in names.in_order() {
        if !used.contains(&index) {
            let found = format!("the material `{name}`, which no surface has");
            document.warn_at(place, Kind::Unknown, found, format!("a surface with material = \"{name}\""));
        }
    }
}

/// `[compare]`: reflections.
fn read_compare(mut table: Table<'_, '_>) -> Option<CompareDescription> {
    let words = format!("a whole number from 0 to {MOST_COMPARED_REFLECTIONS}");
    let reflections = table.integer("reflections", 0, MOST_COMPARED_REFLECTIONS, &words);
    let reflections = table.require("reflections", reflections, &words);
    table.finish();
    reflections.map(|r| CompareDescription { reflections: r.value as u32 })
}

/// `[run]`: photons, seed, replicates.
fn read_run(mut table: Table<'_, '_>) -> RunDescription {
    let photons = table.count("photons");
    let seed = table.integer("seed", 0, u64::MAX, "a whole number from 0 to 2^64 - 1");
    let replicates = table.integer("replicates", 1, MOST_REPLICATES, "a whole number from 1 to 65536");
    if let (Some(photons), Some(replicates)) = (photons, replicates)
        && photons.value < replicates.value
    {
        table.error("replicates", Kind::Range, "at most as many replicates as photons");
    }
    table.finish();
    let replicates = replicates.map(|r| Placed { value: r.value as u32, place: r.place });
    RunDescription { photons, seed, replicates }
}

/// The unit vector along `v`; `None` for the zero vector.
fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    // Scaled first, so that neither a tiny nor a huge vector loses its length in the squares.
    (largest > 0.0 && largest.is_finite()).then(|| {
        let scaled = v / largest;
        scaled / scaled.length()
    })
}

/// A required direction; the zero vector is an error.
fn direction(table: &mut Table<'_, '_>, key: &'static str, default: Option<DVec3>) -> Option<DVec3> {
    const REQUIRED: &str = "a direction [x, y, z] that is not zero";
    let vector = table.vector(key, &DIRECTION);
    if vector.is_none() && table.place_of(key).is_none() && default.is_some() {
        return default;
    }
    let unit = unit(table.require(key, vector, REQUIRED)?.value);
    if unit.is_none() {
        table.error(key, Kind::Range, REQUIRED);
    }
    unit
}

fn not_utf8(bytes: &[u8], valid: usize, name: &str) -> Diagnostic {
    let text = std::str::from_utf8(bytes.get(..valid).unwrap_or_default()).unwrap_or_default();
    let place = Document::new(text, name).place(valid);
    let byte = bytes.get(valid).copied().unwrap_or_default();
    Diagnostic::new(Kind::Syntax, format!("the byte 0x{byte:02X}, which is not UTF-8"), "text in UTF-8")
        .at(place.line, place.column)
        .in_file(name)
}
