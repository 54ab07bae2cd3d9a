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
use crate::files::bsdf::words::{Words, decode};
use crate::files::bytes::read_capped;
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
        let head = decode(&bytes[..bytes.len().min(64 << 10)]);
        let mut words = Words::new(&head);
        let first = words.next();
        let starts = |word: &str| first.is_some_and(|w| w.is(word));
        let unavailable = |what: &str| {
            let required = "a caustix, Zemax/Radiant, MERL or Klems XML table";
            Err(Diagnostic::new(Kind::Unavailable, what, required).at(1, 1).in_file(name))
        };
        if merl::is_merl(bytes) {
            return Ok(Self::Merl);
        }
        if bytes.starts_with(b"tensor_file") {
            return unavailable("an RGL tensor file");
        }
        if starts("OPTIS") {
            return unavailable("a Speos file");
        }
        if starts("type") && words.next().is_some_and(|w| w.is("bsdf_data")) {
            return unavailable("a FRED file");
        }
        if starts(text::MAGIC) {
            return Ok(Self::Text);
        }
        if first.is_some_and(|w| w.text.starts_with('<')) {
            return Ok(Self::Klems);
        }
        let keywords = ["Source", "Symmetry", "SpectralContent", "ScatterType", "SampleRotation"];
        if keywords.iter().any(|k| starts(k)) {
            return Ok(Self::Zemax);
        }
        match Path::new(name).extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("bsdf") => Ok(Self::Zemax),
            Some("xml") => Ok(Self::Klems),
            Some("binary") => Ok(Self::Merl),
            _ => {
                let found = first.map_or("a file without a word".to_owned(), |w| words::quoted(w.text));
                let required = "a caustix, Zemax/Radiant, MERL or Klems XML table";
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
    if bytes.len() as u64 > MAX_FILE_BYTES {
        let found = format!("more than {MAX_FILE_BYTES} bytes");
        let d = Diagnostic::new(Kind::Limit, found, format!("at most {MAX_FILE_BYTES} bytes"));
        return Err(d.in_file(name));
    }
    let mut table = match Format::of(bytes, name)? {
        Format::Text => text::parse(bytes, name),
        Format::Zemax => zemax::parse(bytes, name),
        Format::Merl => merl::parse(bytes, name),
        Format::Klems => klems::parse(bytes, name),
    }?;
    let remarks = remarks::remarks(&table);
    table.warnings.extend(remarks);
    table.warnings = table.warnings.into_iter().map(|d| d.in_file(name)).collect();
    Ok(table)
}
