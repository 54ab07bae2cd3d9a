//! Photometric files of any format that is read, recognised by what is in them, not by their name.

use crate::error::{Diagnostic, Kind, Result};
use crate::files::bytes::{check_length, read_capped};
use crate::files::decode::decode;
use crate::files::kinds::{Use, instead};
use crate::files::lm63::{self, TiltFile};
use crate::photometry::Photometry;
use std::path::Path;

/// Larger files are refused: the largest real one has 1.3 MB.
pub const MAX_FILE_BYTES: u64 = 64 << 20;

/// Reads a photometric file; a tilt file is looked for beside it.
///
/// # Errors
/// [`Kind::Io`] when it cannot be read, `Kind::Limit` beyond `MAX_FILE_BYTES`, and those of [`parse`].
pub fn read(path: impl AsRef<Path>) -> Result<Photometry> {
    let path = path.as_ref();
    let bytes = read_capped(path, MAX_FILE_BYTES).map_err(|d| d.in_file(path))?;
    parse_with(&bytes, &path.display().to_string(), &mut |tilt| {
        Ok(read_capped(&path.with_file_name(tilt), MAX_FILE_BYTES)?.into())
    })
}

/// Reads the bytes of a photometric file; `name` stands in messages. A tilt file is not looked for.
///
/// # Errors
/// [`Kind::Syntax`], [`Kind::Missing`], [`Kind::Range`] or [`Kind::Limit`] with file, line and column.
pub fn parse(bytes: &[u8], name: &str) -> Result<Photometry> {
    parse_with(bytes, name, &mut |_| {
        Err(Diagnostic::new(Kind::Unavailable, "no folder to look in", "a file beside it"))
    })
}

/// The same where tilt files can be had.
pub fn parse_with(bytes: &[u8], name: &str, tilt: TiltFile<'_>) -> Result<Photometry> {
    check_length(bytes, MAX_FILE_BYTES).map_err(|d| d.in_file(name))?;
    let mut photometry = lm63::parse_text(&decode(bytes), tilt).map_err(|d| {
        let other = instead(bytes, Use::Photometric, "an IES LM-63 file (.ies)", name);
        other.unwrap_or(d).in_file(name)
    })?;
    photometry.file = name.to_owned();
    photometry.warnings = photometry.warnings.into_iter().map(|d| d.in_file(name)).collect();
    Ok(photometry)
}
