//! A scene's files kept at or below its folder: for scenes from strangers.

use std::path::{Component, Path, PathBuf};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::excerpt::visible;

/// The folder that no file of a scene may lie outside of, links resolved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Confinement(PathBuf);

impl Confinement {
    /// The folder in which a scene file is named.
    ///
    /// # Errors
    /// [`Kind::Io`] for a folder that is not there; a scene file that is a link out of its folder.
    pub fn of(scene_file: &Path) -> Result<Self> {
        let folder = scene_file.parent().filter(|folder| !folder.as_os_str().is_empty());
        let led_to = folder.unwrap_or(Path::new(".")).canonicalize().map_err(|e| {
            let found = format!("a folder of the scene that cannot be looked into: {e}");
            Diagnostic::new(Kind::Io, found, "a folder that can be read")
        })?;
        let this = Self(led_to);
        this.resolved(scene_file).map(|_| this).ok_or_else(|| refused(scene_file))
    }

    /// Where a file lies that the scene calls `name`, once every link is followed.
    ///
    /// A name that is absolute, or that climbs out by `..`, is refused by its letters alone. What is outside and what is not there
    /// get the same answer, so that none tells what there is outside.
    ///
    /// # Errors
    /// [`Kind::Range`] for what is not at or below the folder.
    pub fn admit(&self, name: &str) -> Result<PathBuf> {
        let mut depth = 0i64;
        let is_within = Path::new(name).components().all(|part| {
            depth += match part {
                Component::Normal(_) => 1,
                Component::CurDir => 0,
                Component::ParentDir => -1,
                Component::RootDir | Component::Prefix(_) => return false,
            };
            depth >= 0
        });
        let led_to = if is_within { self.resolved(&self.0.join(name)) } else { None };
        led_to.ok_or_else(|| refused(Path::new(name)))
    }

    fn resolved(&self, path: &Path) -> Option<PathBuf> {
        path.canonicalize().ok().filter(|led_to| led_to.starts_with(&self.0))
    }
}

fn refused(path: &Path) -> Diagnostic {
    let shown = visible(&path.display().to_string());
    let found = format!("the file `{shown}`, which is not there or outside the scene's folder");
    let required =
        "with --confine, a file at or below the scene's folder, by a relative path, links followed";
    Diagnostic::new(Kind::Range, found, required).hint("copy the file into the scene's folder")
}
