//! The text of a scene file, and the base of the files it names: what scenes of other values are read from, too.

use std::path::{Path, PathBuf};

use super::{SCENE_LIMIT_BYTES, SceneFile, built_in_text, not_utf8, parse};
use crate::error::Diagnostic;
use crate::files::bytes::{Base, read_capped};
use crate::files::confine::Confinement;
use crate::files::kinds::{Use, instead};

/// A scene file's text.
#[derive(Debug)]
pub struct Source {
    /// The text.
    pub text: String,
    /// The file, for messages.
    pub name: String,
    base: Base,
}

impl Source {
    /// The text of a file; with `confine` it may name only files at or below its own folder, links followed.
    ///
    /// # Errors
    /// A file that cannot be read, is no text or too large; a link that leads elsewhere.
    pub fn open(path: &Path, confine: bool) -> Result<Self, Vec<Diagnostic>> {
        let name = path.display().to_string();
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        let base = match confine {
            true => Base::Confined(folder, Confinement::of(path).map_err(|e| vec![e.in_file(path)])?),
            false => Base::Directory(folder),
        };
        let bytes = read_capped(path, SCENE_LIMIT_BYTES).map_err(|e| vec![e.in_file(&name)])?;
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Self { text, name, base }),
            Err(error) => {
                let (valid, bytes) = (error.utf8_error().valid_up_to(), error.as_bytes());
                Err(vec![other_file(bytes, &name).unwrap_or_else(|| not_utf8(bytes, valid, &name))])
            }
        }
    }

    /// The text inside the program.
    pub fn built_in() -> Self {
        let (text, name) = built_in_text();
        Self { text: text.to_owned(), name: name.to_owned(), base: Base::BuiltIn }
    }

    /// Reads a text in the place of this one: its own, or one with other values.
    ///
    /// # Errors
    /// Every error of the text, files that are not there included.
    pub fn read(&self, text: &str) -> Result<SceneFile, Vec<Diagnostic>> {
        let file = parse(text, &self.name, self.base.clone())
            .map_err(|errors| other_file(text.as_bytes(), &self.name).map_or(errors, |other| vec![other]))?;
        let missing: Vec<_> = file.parts.files.iter().filter_map(|f| file.loader.missing(f)).collect();
        if missing.is_empty() { Ok(file) } else { Err(missing) }
    }
}

/// That the file is one of another kind.
fn other_file(bytes: &[u8], name: &str) -> Option<Diagnostic> {
    instead(bytes, Use::Scene, "a scene file (TOML)", name)
}
