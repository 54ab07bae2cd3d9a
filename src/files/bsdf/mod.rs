//! Readers of scattering tables: which format a file has, by its content, and one file a format.

pub mod klems;
pub mod merl;
mod remarks;
pub mod text;
mod unfold;
mod words;
mod xyz;
pub mod zemax;

use std::path::Path;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::bsdf::words::Words;
use crate::files::bytes::{check_length, read_capped};
use crate::files::kinds::{Use, ZEMAX, instead};
use crate::scattering::ScatterTable;

/// Larger files are refused; a MERL file has 35 MB.
pub const MAX_FILE_BYTES: u64 = 64 << 20;

/// The formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// caustix's own ([`text`]).
    Text,
    /// Zemax/Radiant tabular ([`zemax`]).
    Zemax,
    /// MERL binary ([`merl`]).
    Merl,
    /// WINDOW/Radiance XML ([`klems`]).
    Klems,
}

impl Format {
    /// The format of these bytes. The content decides; the ending of `name` only where it says nothing.
    ///
    /// # Errors
    /// [`Kind::Unavailable`] for formats that are known and not read, [`Kind::Unknown`] for the rest.
    pub fn of(bytes: &[u8], name: &str) -> Result<Self> {
        let required = "a caustix, Zemax/Radiant, MERL or Klems XML table";
        if merl::is_merl(bytes) {
            return Ok(Self::Merl);
        }
        if let Some(other) = instead(bytes, Use::Scattering, required, name) {
            return Err(other);
        }
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(64 << 10)]);
        let mut words = Words::new(&head);
        let first = words.next();
        let starts = |word: &str| first.is_some_and(|w| w.is(word));
        match Path::new(name).extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            _ if starts(text::MAGIC) => Ok(Self::Text),
            _ if first.is_some_and(|w| w.text.starts_with('<')) => Ok(Self::Klems),
            _ if ZEMAX.iter().any(|k| starts(k)) => Ok(Self::Zemax),
            Some("bsdf") => Ok(Self::Zemax),
            Some("xml") => Ok(Self::Klems),
            Some("binary") => Ok(Self::Merl),
            // Not even its first word is repeated: the file may be anybody's.
            _ => {
                let found =
                    if first.is_some() { "a file of another format" } else { "a file without a word" };
                Err(Diagnostic::new(Kind::Unknown, found, required).at(1, 1).in_file(name))
            }
        }
    }

    /// What people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "caustix text",
            Self::Zemax => "Zemax/Radiant",
            Self::Merl => "MERL",
            Self::Klems => "Klems XML",
        }
    }
}

/// Reads a scattering table, whatever its format.
///
/// # Errors
/// [`Kind::Io`] when it cannot be read, `Kind::Limit` beyond `MAX_FILE_BYTES`, and those of [`parse`].
pub fn read(path: impl AsRef<Path>) -> Result<ScatterTable> {
    let path = path.as_ref();
    let bytes = read_capped(path, MAX_FILE_BYTES).map_err(|d| d.in_file(path))?;
    parse(&bytes, &path.display().to_string())
}

/// Reads the bytes of a scattering table, whatever its format; `name` stands in messages.
///
/// # Errors
/// Those of `Format::of` and of the format's reader; `Kind::Limit` beyond `MAX_FILE_BYTES`.
pub fn parse(bytes: &[u8], name: &str) -> Result<ScatterTable> {
    check_length(bytes, MAX_FILE_BYTES).map_err(|d| d.in_file(name))?;
    let mut table = match Format::of(bytes, name)? {
        Format::Text => text::parse(bytes, name),
        Format::Zemax => zemax::parse(bytes, name),
        Format::Merl => merl::parse(bytes, name),
        Format::Klems => klems::parse(bytes, name),
    }
    .map_err(|d| d.in_file(name))?;
    let remarks = remarks::remarks(&table);
    table.warnings.extend(remarks);
    table.warnings = table.warnings.into_iter().map(|d| d.in_file(name)).collect();
    Ok(table)
}
