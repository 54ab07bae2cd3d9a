//! Photometric files of any format that is read, recognised by what is in them, not by their name.

use crate::error::{Diagnostic, Kind, Result};
use crate::files::bytes::{check_length, read_capped};
use crate::files::decode::decode;
use crate::files::eulumdat::{self, told};
use crate::files::kinds::{Use, instead, is_eulumdat, is_lm63, is_nearly_eulumdat};
use crate::files::lm63::{self, TiltFile};
use crate::photometry::{Format, Photometry};
use std::path::Path;

/// Larger files are refused: the largest real one has 1.3 MB.
pub const MAX_FILE_BYTES: u64 = 64 << 20;

/// Reads a photometric file; a tilt file is looked for beside it. Of several lamp sets (EULUMDAT) the first
/// is taken.
///
/// # Errors
/// [`Kind::Io`] when it cannot be read, `Kind::Limit` beyond `MAX_FILE_BYTES`, and those of [`parse`].
pub fn read(path: impl AsRef<Path>) -> Result<Photometry> {
    read_with(path, None)
}

/// The same with the lamp set of this number, from 1.
///
/// # Errors
/// Those of [`read`]; [`Kind::Range`] for a lamp set that the file does not have.
pub fn read_with(path: impl AsRef<Path>, lamp_set: Option<usize>) -> Result<Photometry> {
    let path = path.as_ref();
    let bytes = read_capped(path, MAX_FILE_BYTES).map_err(|d| d.in_file(path))?;
    let read = parse_with(&bytes, &path.display().to_string(), lamp_set, &mut |tilt| {
        Ok(read_capped(&path.with_file_name(tilt), MAX_FILE_BYTES)?.into())
    });
    read.map_err(|d| d.in_file(path))
}

/// Reads the bytes of a photometric file; `name` stands in messages. A tilt file is not looked for.
///
/// # Errors
/// [`Kind::Syntax`], [`Kind::Missing`], [`Kind::Range`] or [`Kind::Limit`] with file, line and column.
pub fn parse(bytes: &[u8], name: &str) -> Result<Photometry> {
    parse_with(bytes, name, None, &mut |_| {
        Err(Diagnostic::new(Kind::Unavailable, "no folder to look in", "a file beside it"))
    })
}

/// The same with a choice of the lamp set, from 1, where tilt files can be had. The error that there is no
/// such set names no file: it is about who chose.
pub fn parse_with(
    bytes: &[u8],
    name: &str,
    lamp_set: Option<usize>,
    tilt: TiltFile<'_>,
) -> Result<Photometry> {
    check_length(bytes, MAX_FILE_BYTES).map_err(|d| d.in_file(name))?;
    let text = decode(bytes);
    let read = if is_eulumdat(&text) || (!is_lm63(&text) && is_nearly_eulumdat(&text)) {
        eulumdat::parse_text(&text, lamp_set)
    } else {
        lm63::parse_text(&text, tilt)
    };
    let mut photometry = read.map_err(|d| {
        let required = "an IES LM-63 file (.ies) or an EULUMDAT file (.ldt)";
        instead(bytes, Use::Photometric, required, name).unwrap_or(d).in_file(name)
    })?;
    photometry.file = name.to_owned();
    photometry.warnings = photometry.warnings.into_iter().map(|d| d.in_file(name)).collect();
    check_lamp_set(&photometry, lamp_set)?;
    Ok(photometry)
}

/// Whether there is the lamp set that was chosen.
fn check_lamp_set(photometry: &Photometry, lamp_set: Option<usize>) -> Result<()> {
    let sets = &photometry.lamp_sets;
    let Some(number) = lamp_set.filter(|number| !(1..=sets.len()).contains(number)) else { return Ok(()) };
    let (found, required) = match (photometry.format, sets.len()) {
        (Format::Lm63(_), _) => (
            format!("lamp set {number} of an IES LM-63 file"),
            "no choice: LM-63 has no lamp sets".to_owned(),
        ),
        (Format::Eulumdat, 0) => {
            (format!("lamp set {number} of a file without lamp sets"), "no choice".to_owned())
        }
        (Format::Eulumdat, n) => (format!("lamp set {number} of {}", told(sets)), format!("1 to {n}")),
    };
    Err(Diagnostic::new(Kind::Range, found, required))
}
