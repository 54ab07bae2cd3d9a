//! What makes the parts of a scene that need its files.

use std::path::PathBuf;
use std::rc::Rc;

use super::syntax::BACKSLASH;
use super::table::Placed;
use crate::error::{Diagnostic, Result};
use crate::files::bytes::Files;
use crate::files::lm63;
use crate::photometry::Photometry;
use crate::scene::steps::Steps;

/// Makes a part of a scene; whatever it says of itself has been checked when its table was read.
pub(crate) type Make<T> = Box<dyn FnOnce(&mut Loader) -> Result<T>>;

/// Where files are looked for.
const RELATIVE: &str = "paths are relative to the folder of the scene file";

/// Makes what needs no file.
pub(crate) fn made<T: 'static>(part: T) -> Make<T> {
    Box::new(move |_| Ok(part))
}

/// The files of a scene, and what is odd about them.
#[derive(Debug)]
pub(crate) struct Loader {
    /// The scene file's name, for messages.
    pub name: String,
    pub files: Files,
    pub warnings: Vec<Diagnostic>,
    /// The steps of the heightfield that was made last, where its image has few.
    pub steps: Option<Steps>,
}

impl Loader {
    /// The bytes of a file; errors point to where it is named.
    pub fn bytes(&mut self, file: &Placed<String>) -> Result<Rc<[u8]>> {
        self.files.load(&file.value).map_err(|e| self.at_name(file, e))
    }

    /// What messages call a file.
    pub fn path(&self, file: &Placed<String>) -> PathBuf {
        self.files.path(&file.value)
    }

    /// A photometric file; a tilt file is looked for beside it.
    pub fn photometry(&mut self, file: &Placed<String>) -> Result<Photometry> {
        let bytes = self.bytes(file)?;
        let name = self.path(file).display().to_string();
        let (folder, files) = (PathBuf::from(&file.value), &mut self.files);
        let photometry = lm63::parse_with(&bytes, &name, &mut |tilt| {
            files.load(&folder.with_file_name(tilt).to_string_lossy())
        })?;
        self.warnings.extend(photometry.warnings.iter().cloned());
        Ok(photometry)
    }

    /// The error that a file cannot be opened, if it cannot.
    pub fn missing(&self, file: &Placed<String>) -> Option<Diagnostic> {
        self.files.probe(&file.value).err().map(|e| self.at_name(file, e))
    }

    fn at_name(&self, file: &Placed<String>, error: Diagnostic) -> Diagnostic {
        let pointed = error.placed(Some(file.place)).in_file(&self.name);
        let hint = match file.value.as_str() {
            // No file is called so: an escape has come out of a path of Windows.
            path if path.contains(char::is_control) => format!("write {BACKSLASH}"),
            path if path.contains("://") => "download it: files are not fetched from elsewhere".into(),
            path if path.starts_with('~') => "write the whole path: `~` stands for nothing here".into(),
            _ => match pointed.advice() {
                Some(near) => format!("{near} {RELATIVE}"),
                None => RELATIVE.into(),
            },
        };
        pointed.hint(hint)
    }
}
