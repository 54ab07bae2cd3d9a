//! What makes the parts of a scene that need its files.

use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

use super::asked::Asked;
use super::syntax::BACKSLASH;
use super::table::Placed;
use crate::error::{Diagnostic, Result};
use crate::files::bytes::Files;
use crate::files::obj::{Checked, check_obj};
use crate::files::{bsdf, photometric};
use crate::photometry::Photometry;
use crate::scattering::ScatterTable;
use crate::scene::steps::Steps;

/// Makes a part of a scene; whatever it says of itself has been checked when its table was read.
pub(crate) type Make<T> = Box<dyn FnOnce(&mut Loader) -> Result<T>>;

/// Where files are looked for.
const RELATIVE: &str = "paths are relative to the folder of the scene file";

/// Makes what needs no file.
pub(crate) fn made<T: 'static>(part: T) -> Make<T> {
    Box::new(move |_| Ok(part))
}

/// What files hold, or what is wrong with them, by the numbers of the files: each is looked at once.
type Known<T, K = usize> = HashMap<K, Result<Rc<T>>>;

/// The files of a scene, and what is odd about them.
#[derive(Debug)]
pub(crate) struct Loader {
    /// The scene file's name, for messages.
    pub name: String,
    pub files: Files,
    pub warnings: Vec<Diagnostic>,
    /// The steps of the heightfield that was made last, where its image has few.
    pub steps: Option<Steps>,
    /// What its parts ask for together.
    pub asked: Asked,
    /// Photometric files with one of their lamp sets, and the tilt files that they name.
    lamps: Known<(Photometry, Vec<String>), (usize, Option<usize>)>,
    tables: Known<ScatterTable>,
    meshes: Known<Checked>,
}

impl Loader {
    pub fn new(name: String, files: Files, asked: Asked) -> Self {
        let (lamps, tables, meshes) = (Known::new(), Known::new(), Known::new());
        Self { name, files, warnings: Vec::new(), steps: None, asked, lamps, tables, meshes }
    }

    /// Whether more was asked for than there may be, so that nothing more is to be made.
    pub fn is_over(&self) -> bool {
        self.asked.is_over() || self.files.is_over()
    }

    /// The bytes of a file; errors point to where it is named.
    pub fn bytes(&mut self, file: &Placed<String>) -> Result<Rc<[u8]>> {
        self.files.load(&file.value).map_err(|e| self.at_name(file, e))
    }

    /// What messages call a file.
    pub fn path(&self, file: &Placed<String>) -> PathBuf {
        self.files.path(&file.value)
    }

    /// The same, before a part is made of them, and the number of the file.
    pub fn look(&mut self, file: &Placed<String>) -> Result<(usize, Rc<[u8]>)> {
        self.files.look(&file.value).map_err(|e| self.at_name(file, e))
    }

    /// A photometric file with this lamp set; a tilt file is looked for beside it. What is odd about it is told of the first lamp
    /// that names it.
    pub fn photometry(
        &mut self,
        file: &Placed<String>,
        lamp_set: Option<&Placed<usize>>,
    ) -> Result<Rc<(Photometry, Vec<String>)>> {
        let (number, _) = self.look(file)?;
        let bytes = self.bytes(file)?;
        let key = (number, lamp_set.map(|set| set.value));
        // An error of no file is one of the choice.
        let scene = self.name.clone();
        let at_choice = |e: Diagnostic| match e.file() {
            Some(_) => e,
            None => e.placed(lamp_set.map(|set| set.place)).in_file(&scene),
        };
        if let Some(known) = self.lamps.get(&key) {
            let known = known.clone().map_err(at_choice)?;
            // A lamp's tilt file is a file of that lamp, too.
            known.1.iter().try_for_each(|tilt| self.files.load(tilt).map(drop))?;
            return Ok(known);
        }
        let name = self.path(file).display().to_string();
        let (folder, files, mut tilts) = (PathBuf::from(&file.value), &mut self.files, Vec::new());
        let read = photometric::parse_with(&bytes, &name, key.1, &mut |tilt| {
            let name = folder.with_file_name(tilt).to_string_lossy().into_owned();
            let bytes = files.load(&name)?;
            tilts.push(name);
            Ok(bytes)
        });
        let read = read.map(|photometry| Rc::new((photometry, tilts)));
        // Two lamp sets of one file have most of its oddities in common.
        for warning in read.iter().flat_map(|read| &read.0.warnings) {
            if !self.warnings.contains(warning) {
                self.warnings.push(warning.clone());
            }
        }
        self.lamps.insert(key, read.clone());
        read.map_err(at_choice)
    }

    /// A scattering table.
    pub fn scattering(&mut self, file: &Placed<String>) -> Result<Rc<ScatterTable>> {
        let (number, _) = self.look(file)?;
        let bytes = self.bytes(file)?;
        if let Some(known) = self.tables.get(&number) {
            return known.clone();
        }
        let read = bsdf::parse(&bytes, &self.path(file).display().to_string()).map(Rc::new);
        self.warnings.extend(read.iter().flat_map(|table| table.warnings.iter().cloned()));
        self.tables.insert(number, read.clone());
        read
    }

    /// The text of a mesh.
    pub fn obj(&mut self, file: &Placed<String>) -> Result<Rc<Checked>> {
        let (number, bytes) = self.look(file)?;
        if let Some(known) = self.meshes.get(&number) {
            return known.clone();
        }
        let checked = check_obj(&bytes, &self.path(file)).map(Rc::new);
        self.meshes.insert(number, checked.clone());
        checked
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
