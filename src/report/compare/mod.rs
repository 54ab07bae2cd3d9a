//! What `caustix compare` shows: a table for the terminal, compare.csv, compare.md and compare.svg, all from one
//! [`Study`].

pub mod csv;
pub mod markdown;
mod markers;
pub mod numbers;
pub mod plot;
pub mod remarks;
pub mod text;

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::Diagnostic;
use crate::files::atomic::write_atomically;
use crate::lab::study::results::Study;
use crate::lab::study::table::Table;

/// What became of the files.
#[derive(Debug, Clone, Default)]
pub struct Files {
    /// Those that were written.
    pub written: Vec<PathBuf>,
    /// Why others were not.
    pub errors: Vec<Diagnostic>,
}

/// Writes compare.csv, compare.md and compare.svg into a directory that is there. One that cannot be written keeps no
/// other from being.
pub fn write_files(study: &Study, table: &Table, directory: impl AsRef<Path>) -> Files {
    let mut files = Files::default();
    for (name, content) in [
        ("compare.csv", csv::csv(study, table)),
        ("compare.md", markdown::markdown(study, table)),
        ("compare.svg", plot::drawing(study, table).to_svg()),
    ] {
        let path = directory.as_ref().join(name);
        match write_atomically(&path, |file| file.write_all(content.as_bytes())) {
            Ok(()) => files.written.push(path),
            Err(error) => files.errors.push(error),
        }
    }
    files
}
