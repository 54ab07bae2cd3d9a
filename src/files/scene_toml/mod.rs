//! Scene files: TOML text to a [`Scene`], or every error at once.
//!
//! docs/SCENE.md is the manual of the format; the readers of its parts are the files of this folder. A part's reader gives its
//! keys to the constructors of what it describes and adds the place to what they refuse. What needs another file is made by
//! [`SceneFile::build`], when the text is known to be good.

pub mod asked;
mod camera;
mod canonical;
pub mod count;
pub mod document;
pub mod edit;
mod emitter;
mod far_field;
mod heightfield;
mod key_path;
mod loader;
mod material;
mod names;
mod numbers;
mod part;
mod parts;
mod receiver;
pub mod source;
mod surface;
mod syntax;
mod table;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::error::{Diagnostic, Kind, Place};
use crate::files::bytes::{Base, Files};
use crate::math::digest::sha256_hex;
use crate::scene::{Identity, Scene, SceneBuilder};
use crate::surface::Kind as MaterialKind;
use document::Document;
use loader::Loader;
#[cfg(feature = "internals")]
pub use parts::MOST_PARTS;
use parts::Parts;
pub use parts::RunDefaults;
use source::Source;
use table::Table;

/// Largest scene file that is read: 16 MiB.
pub const SCENE_LIMIT_BYTES: u64 = 16 << 20;

/// A scene file whose text is good; the files that it names have not been read.
pub struct SceneFile {
    /// What a run takes where nobody says otherwise.
    pub run: RunDefaults,
    /// What is allowed but probably not meant, in the text alone.
    pub warnings: Vec<Diagnostic>,
    text: String,
    loader: Loader,
    parts: Parts,
}

/// Read a scene file of at most 16 MiB and look for the files it names.
///
/// # Errors
/// Every error of the file, in its order: syntax, unknown keys and words, missing keys, values out of range,
/// names used twice or not at all, files that are not there. At most `document::MOST_ERRORS`, and one that counts the rest.
pub fn read(path: impl AsRef<Path>) -> Result<SceneFile, Vec<Diagnostic>> {
    read_from(path.as_ref(), false)
}

/// The same of a scene that may name only files at or below its own folder, links followed: one from a stranger.
///
/// # Errors
/// Those of [`read`]; a scene file or one it names that lies elsewhere (docs/SECURITY.md).
pub fn read_confined(path: impl AsRef<Path>) -> Result<SceneFile, Vec<Diagnostic>> {
    read_from(path.as_ref(), true)
}

fn read_from(path: &Path, confine: bool) -> Result<SceneFile, Vec<Diagnostic>> {
    let source = Source::open(path, confine)?;
    source.read(&source.text)
}

/// The scene of a file.
///
/// # Errors
/// Those of [`read`] and [`SceneFile::build`].
pub fn read_scene(path: impl AsRef<Path>) -> Result<Scene, Vec<Diagnostic>> {
    read(path)?.build()
}

/// The scene of a text; paths are relative to `folder`.
///
/// # Errors
/// Those of `parse` and [`SceneFile::build`].
pub fn parse_scene(text: &str, folder: impl Into<PathBuf>) -> Result<Scene, Vec<Diagnostic>> {
    parse(text, "scene", Base::Directory(folder.into()))?.build()
}

/// The name of the scene inside the program.
pub const BUILT_IN: &str = "wavy_glass.toml (built in)";

/// The scene inside the program, `scenes/wavy_glass.toml`.
///
/// # Errors
/// None, as the tests show; they are those of `parse`.
pub fn built_in() -> Result<SceneFile, Vec<Diagnostic>> {
    let (text, name) = built_in_text();
    parse(text, name, Base::BuiltIn)
}

/// The text inside the program, and what messages call it.
fn built_in_text() -> (&'static str, &'static str) {
    (include_str!("../../../scenes/wavy_glass.toml"), BUILT_IN)
}

/// Read a scene from its text; no file is opened. `name` is for messages.
///
/// # Errors
/// As [`read`], but for the files that the scene names.
pub fn parse(text: &str, name: &str, base: Base) -> Result<SceneFile, Vec<Diagnostic>> {
    if text.len() as u64 > SCENE_LIMIT_BYTES {
        let limit = format!("{} MiB", SCENE_LIMIT_BYTES >> 20);
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
    let loader = Loader::new(name.to_owned(), Files::new(base), parts.asked.clone());
    Ok(SceneFile { run: parts.run, warnings, text: text.to_owned(), loader, parts })
}

impl std::fmt::Debug for SceneFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SceneFile").field("name", &self.loader.name).finish_non_exhaustive()
    }
}

impl SceneFile {
    /// The scene, with the files that it names.
    ///
    /// # Errors
    /// All that is wrong with it and its files, not only the first.
    pub fn build(self) -> Result<Scene, Vec<Diagnostic>> {
        let Self { warnings, text, mut loader, parts, .. } = self;
        loader.warnings = warnings;
        let mut scene = SceneBuilder::new();
        let mut errors = Vec::new();
        // An error without a place of its own gets that of the part of the scene it is about.
        let name = loader.name.clone();
        let placed = |place: Place, e: Diagnostic| match e.file() {
            Some(_) => e,
            None => e.placed(Some(place)).in_file(&name),
        };
        for (part, place) in parts.emitters.into_iter().flatten() {
            match (part.make)(&mut loader) {
                Ok(emitter) => {
                    scene.at(place).coloured_emitter(part.name, emitter, part.colour);
                    if let Some(medium) = part.medium {
                        scene.emitter_in(medium);
                    }
                }
                Err(e) => errors.push(placed(place, e)),
            }
            if loader.is_over() {
                return Err(errors);
            }
        }
        let mut materials = Vec::new();
        for (part, place) in parts.materials.into_iter().flatten() {
            let made = (part.make)(&mut loader).map_err(|e| errors.push(placed(place, e)));
            materials.push(made.ok().map(|material| (material, part.reference)));
            if loader.is_over() {
                return Err(errors);
            }
        }
        // What all surfaces ask for is known before the first is made.
        let mut surfaces = Vec::new();
        for (mut part, place) in parts.surfaces.into_iter().flatten() {
            let counted = part.ask.take().map_or(Ok(()), |ask| ask(&mut loader));
            if loader.is_over() {
                errors.extend(counted.err().map(|e| placed(place, e)));
                return Err(errors);
            }
            surfaces.push((part, place, counted));
        }
        for (part, place, counted) in surfaces {
            let made = counted.and_then(|()| (part.shape)(&mut loader)).and_then(|shape| {
                // A material in error is reported already.
                let Some((material, reference)) = &materials[part.material] else { return Ok(()) };
                let material = material::laid_on(material, *reference, &shape)?;
                let steps = loader.steps.take().filter(|_| material.kind() == MaterialKind::Specular);
                if let Some(warning) = steps.and_then(|steps| steps.warning(&part.name)) {
                    scene.tell(warning);
                }
                scene.at(place).surface_with(part.name, shape, material, part.options);
                Ok(())
            });
            errors.extend(made.err().map(|e| placed(place, e)));
        }
        if !errors.is_empty() {
            return Err(errors);
        }
        for (receiver, place) in parts.receivers.into_iter().flatten() {
            scene.at(place).receiver(receiver);
        }
        for (far_field, place) in parts.far_fields.into_iter().flatten() {
            scene.at(place).far_field(far_field);
        }
        if let Some((camera, medium, place)) = parts.camera {
            scene.at(place).camera(camera);
            if let Some(medium) = medium {
                scene.camera_in(medium);
            }
        }
        if let Some(medium) = parts.ambient {
            scene.ambient(medium);
        }
        if let Some(reflections) = parts.compared_reflections {
            scene.compared_reflections(reflections);
        }
        let mut scene = scene
            .build()
            .map_err(|errors| errors.into_iter().map(|e| e.in_file(&name)).collect::<Vec<_>>())?;
        let files = loader.files.hashes();
        let hash_of = |path: &str| files.iter().find(|(name, _)| name == path).map(|(_, hash)| hash.clone());
        // Files that others name (tilt) are in the scene, too.
        let contents: BTreeSet<&str> = files.iter().map(|(_, hash)| hash.as_str()).collect();
        let without = |table: &str| {
            sha256_hex(format!("{}{contents:?}", canonical::canonical(&text, table, &hash_of)).as_bytes())
        };
        let (light, results) = (without("camera"), without("run"));
        scene.identity = Identity { name, sha256: sha256_hex(text.as_bytes()), text, files, light, results };
        // What the builder found has a place, but no file.
        let found = scene.warnings.into_iter().map(|w| w.in_file(&scene.identity.name));
        scene.warnings = loader.warnings.into_iter().chain(found).collect();
        Ok(scene)
    }
}

fn not_utf8(bytes: &[u8], valid: usize, name: &str) -> Diagnostic {
    let text = std::str::from_utf8(bytes.get(..valid).unwrap_or_default()).unwrap_or_default();
    let place = Document::new(text, name).place(valid);
    let byte = bytes.get(valid).copied().unwrap_or_default();
    Diagnostic::new(Kind::Syntax, format!("the byte 0x{byte:02X}, which is not UTF-8"), "text in UTF-8")
        .hint("save the file as UTF-8")
        .placed(Some(place))
        .in_file(name)
}
