//! What TILT= says: nothing, a table that follows, or the name of a file.

use super::TiltFile;
use super::body::Reader;
use crate::error::{Diagnostic, Kind, Result};
use crate::files::candela::checks::MAX_FACTOR;
use crate::files::candela::number::values;
use crate::files::decode::decode;
use crate::files::excerpt::quoted;
use crate::photometry::{Tilt, TiltTable};

/// What TILT= says; `value` begins at byte `offset`.
pub(super) fn read(
    (value, offset): (&str, usize),
    reader: &mut Reader,
    tilt_file: TiltFile<'_>,
) -> Result<Tilt> {
    let mut words = value.split_whitespace();
    let first = words.next().unwrap_or("");
    if first.is_empty() {
        let d = Diagnostic::new(Kind::Missing, "nothing after TILT=", "NONE, INCLUDE or the name of a file");
        return Err(reader.tokens.place(offset, d));
    }
    let none = first.eq_ignore_ascii_case("NONE");
    if none || first.eq_ignore_ascii_case("INCLUDE") {
        if words.next().is_some() {
            let found = format!("TILT={}", quoted(value));
            reader.warn(offset, Kind::Syntax, &found, "nothing after NONE or INCLUDE", "the rest is ignored");
        }
        return if none { Ok(Tilt::None) } else { table(reader).map(Tilt::Include) };
    }
    let name = if first.eq_ignore_ascii_case("FILE") && words.next().is_some() {
        let found = format!("TILT={}", quoted(value));
        let required = "TILT= and the name of the file";
        reader.warn(offset, Kind::Syntax, &found, required, "FILE is not part of LM-63");
        value[first.len()..].trim()
    } else {
        value
    };
    let table = read_tilt_file(name, tilt_file).map_err(|d| {
        let found = format!("tilt file {}", quoted(name));
        let hint = format!("its factors are taken as 1; {d}");
        reader.warn(offset, d.kind(), &found, "a readable tilt file", &hint);
    });
    Ok(Tilt::File { name: name.to_owned(), table: table.ok() })
}

/// A tilt file beside the photometric file; folders in its name belong to another machine and are dropped.
fn read_tilt_file(name: &str, tilt_file: TiltFile<'_>) -> Result<TiltTable> {
    let base = name.rsplit(['/', '\\']).next().filter(|base| !["", ".", ".."].contains(base));
    let Some(base) = base else {
        return Err(Diagnostic::new(Kind::Missing, quoted(name), "the name of a file"));
    };
    let bytes = tilt_file(base)?;
    table(&mut Reader::new(&decode(&bytes), 0))
}

/// The block of `TILT=INCLUDE`, or a tilt file: geometry, number of pairs, angles, factors.
fn table(reader: &mut Reader<'_>) -> Result<TiltTable> {
    let geometry = reader.code("lamp-to-luminaire geometry", &[1, 2, 3], "1, 2 or 3")?;
    let n = reader.count("number of tilt angles")?;
    reader.tokens.require(2 * n as u64, |_| format!("one of {n} tilt angles and {n} factors"))?;
    let angles = reader.tokens.numbers(n, "tilt angle")?;
    let factors = reader.tokens.numbers(n, "tilt factor")?;
    let mut falling = angles.windows(2).filter(|w| w[1].value <= w[0].value);
    if let Some(pair) = falling.next() {
        return reader.refuse(&pair[1], Kind::Range, "tilt angle", "angles in strictly increasing order");
    }
    if let Some(bad) = factors.iter().find(|n| !(0.0..=MAX_FACTOR).contains(&n.value)) {
        let required = format!("a factor between 0 and {MAX_FACTOR}");
        return reader.refuse(bad, Kind::Range, "tilt factor", &required);
    }
    let upright = angles.iter().zip(&factors).find(|(angle, _)| angle.value == 0.0);
    if let Some((_, factor)) = upright.filter(|(_, factor)| factor.value != 1.0) {
        let found = format!("tilt factor {} at 0 degrees", factor.text);
        reader.warn(
            factor.offset,
            Kind::Range,
            &found,
            "1 at 0 degrees",
            "it is a factor of what a lamp emits that is not tilted",
        );
    }
    Ok(TiltTable { geometry, angles_deg: values(&angles), factors: values(&factors) })
}
