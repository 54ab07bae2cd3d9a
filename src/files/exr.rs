//! Maps of numbers as OpenEXR files: f32 channels, lossless, in scan lines, with the run's description in
//! attributes. The same contents give the same bytes.
//!
//! Text attributes are UTF-8. The format has no 64-bit integer: one that does not fit 32 bits is written as decimal text.

use std::io::{Cursor, Write};
use std::path::Path;

use ::exr::meta::attribute::Chromaticities;
use ::exr::prelude as exr;
use ::exr::prelude::WritableImage as _;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_atomically;

/// One channel to write.
#[derive(Debug, Clone, Copy)]
pub struct Channel<'a> {
    /// Its name, unique in the file.
    pub name: &'a str,
    /// Its values, rows from the top; NaN and infinities are kept.
    pub data: &'a [f32],
}

/// Numbers as 32-bit floats, which a file holds.
///
/// # Errors
/// [`Kind::Range`] for a finite number that a float cannot hold: it would be written as infinite.
pub fn floats(values: impl IntoIterator<Item = f64>) -> Result<Vec<f32>> {
    let float = |value: f64| match value as f32 {
        float if float.is_infinite() && value.is_finite() => {
            let found = format!("{value:e} in a cell");
            let required = format!("at most {:e}, which a 32-bit float holds", f32::MAX);
            Err(Diagnostic::new(Kind::Range, found, required)
                .hint("look at the lamp's flux and the receiver's size; report.json has the numbers"))
        }
        float => Ok(float),
    };
    values.into_iter().map(float).collect()
}

/// An attribute's value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Any text.
    Text(String),
    /// A number, kept bit for bit.
    F64(f64),
    /// An integer; read back as text when it does not fit 32 bits.
    I64(i64),
}

/// Most pixels of a file.
const MOST_PIXELS: usize = 1 << 28;

/// What a file's numbers are to a viewer of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Light {
    /// Channels `R`, `G`, `B` (or `Y`) of linear sRGB in cd/m2: with `chromaticities` (those of ITU-R BT.709) and
    /// `whiteLuminance` = 1, the luminance of (1, 1, 1) in cd/m2.
    Luminance,
    /// Any other numbers.
    Other,
}

/// Writes channels of `width` x `height` values, first row on top, with these attributes.
///
/// # Errors
/// [`Kind::Range`] for an empty map, a channel of another size, no channel, or a name that is empty, too long, taken
/// twice or used by the format itself; [`Kind::Io`] when the file cannot be written.
pub fn write_maps(
    path: impl AsRef<Path>,
    [width, height]: [usize; 2],
    channels: &[Channel<'_>],
    attributes: &[(String, Value)],
    light: Light,
) -> Result<()> {
    let path = path.as_ref();
    let bytes = encode(width, height, channels, attributes, light).map_err(|e| e.in_file(path))?;
    write_atomically(path, |writer| writer.write_all(&bytes))
}

/// Red, green, blue and white of ITU-R BT.709 in CIE 1931 x, y.
const BT709: Chromaticities = Chromaticities {
    red: exr::Vec2(0.64, 0.33),
    green: exr::Vec2(0.30, 0.60),
    blue: exr::Vec2(0.15, 0.06),
    white: exr::Vec2(0.3127, 0.3290),
};

fn encode(
    width: usize,
    height: usize,
    channels: &[Channel<'_>],
    attributes: &[(String, Value)],
    light: Light,
) -> Result<Vec<u8>> {
    let cells = width.checked_mul(height).filter(|&n| n > 0 && n <= MOST_PIXELS).ok_or_else(|| {
        Diagnostic::new(Kind::Range, format!("a map of {width} x {height} cells"), "1 to 2^28 cells")
    })?;
    let channels = checked(channels, cells)?;
    let mut described = exr::LayerAttributes::default();
    for (name, value) in attributes {
        if described.other.insert(text(name), attribute(value)).is_some() {
            return Err(bad_name("attribute", name, "a name used once"));
        }
        check_name("attribute", name)?;
        // Names that the format gives a type and a meaning of its own.
        if ::exr::meta::header::standard_names::ALL.contains(&name.as_bytes()) {
            return Err(bad_name("attribute", name, "a name that OpenEXR does not use itself"));
        }
    }
    let encoding = exr::Encoding {
        compression: exr::Compression::ZIP16,
        blocks: exr::Blocks::ScanLines,
        line_order: exr::LineOrder::Increasing,
    };
    let layer =
        exr::Layer::new((width, height), described, encoding, exr::AnyChannels::sort(channels.into()));
    let mut image = exr::Image::from_layer(layer);
    if light == Light::Luminance {
        image.attributes.chromaticities = Some(BT709);
        image.layer_data.attributes.white_luminance = Some(1.0);
    }
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).map_err(|error| {
        Diagnostic::new(Kind::Io, format!("\"{error}\" while encoding"), "maps that OpenEXR can hold")
    })?;
    let mut bytes = bytes.into_inner();
    sort_header(&mut bytes)?;
    Ok(bytes)
}

/// The channels, of so many values each.
fn checked(channels: &[Channel<'_>], cells: usize) -> Result<Vec<exr::AnyChannel<exr::FlatSamples>>> {
    if channels.is_empty() {
        return Err(Diagnostic::new(Kind::Range, "no channel", "at least one channel"));
    }
    let mut list = Vec::new();
    for (i, channel) in channels.iter().enumerate() {
        if channel.data.len() != cells {
            let found = format!("{} values in channel \"{}\"", channel.data.len(), channel.name);
            return Err(Diagnostic::new(Kind::Range, found, format!("{cells} values")));
        }
        check_name("channel", channel.name)?;
        if channels[..i].iter().any(|other| other.name == channel.name) {
            return Err(bad_name("channel", channel.name, "a name used once"));
        }
        let samples = exr::FlatSamples::F32(channel.data.to_vec());
        list.push(exr::AnyChannel::new(text(channel.name), samples));
    }
    Ok(list)
}

fn check_name(what: &str, name: &str) -> Result<()> {
    if name.is_empty() || name.len() > 255 || name.contains('\0') {
        return Err(bad_name(what, name, "a name of 1 to 255 bytes without a zero byte"));
    }
    Ok(())
}

fn bad_name(what: &str, name: &str, required: &str) -> Diagnostic {
    Diagnostic::new(Kind::Range, format!("the {what} name \"{name}\""), required)
}

fn text(value: &str) -> exr::Text {
    exr::Text::from_slice_unchecked(value.as_bytes())
}

fn attribute(value: &Value) -> exr::AttributeValue {
    match value {
        Value::Text(string) => exr::AttributeValue::Text(text(string)),
        Value::F64(number) => exr::AttributeValue::F64(*number),
        Value::I64(number) => i32::try_from(*number)
            .map_or_else(|_| exr::AttributeValue::Text(text(&number.to_string())), exr::AttributeValue::I32),
    }
}

/// Puts the attributes of the one header into the order of their names: the exr crate writes them in the order of a
/// hash map, which differs from run to run. The header keeps its length, so the offsets after it stay right.
fn sort_header(bytes: &mut [u8]) -> Result<()> {
    const START: usize = 8; // after the magic number and the version
    let damaged = || Diagnostic::new(Kind::Io, "a header without an end", "an OpenEXR header");
    let mut entries: Vec<&[u8]> = Vec::new();
    let mut at = START;
    while *bytes.get(at).ok_or_else(damaged)? != 0 {
        let end = end_of_attribute(bytes, at).ok_or_else(damaged)?;
        entries.push(&bytes[at..end]);
        at = end;
    }
    // Names end with a zero byte, so comparing whole entries compares names first.
    entries.sort_unstable();
    let sorted = entries.concat();
    bytes[START..START + sorted.len()].copy_from_slice(&sorted);
    Ok(())
}

/// Name, type, length, contents: OpenEXR file layout, "Attribute layout".
fn end_of_attribute(bytes: &[u8], start: usize) -> Option<usize> {
    let after_zero = |from: usize| Some(from + bytes.get(from..)?.iter().position(|&b| b == 0)? + 1);
    let length_at = after_zero(after_zero(start)?)?;
    let length = bytes.get(length_at..length_at + 4)?;
    let length = u32::from_le_bytes(length.try_into().ok()?) as usize;
    Some(length_at + 4 + length).filter(|&end| end <= bytes.len())
}

// Reading is for tests alone: the command only writes.
#[cfg(test)]
#[path = "../../tests/support/maps.rs"]
pub(crate) mod maps;

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::maps::{Attribute, Samples, read_maps};
    use super::*;

    fn attributes() -> Vec<(String, Value)> {
        vec![
            ("caustix.scene".into(), Value::Text("wavy_glass, 1 m², µ".into())),
            ("caustix.empty".into(), Value::Text(String::new())),
            ("caustix.flux_lm".into(), Value::F64(0.1 + 0.2)),
            ("caustix.seed".into(), Value::I64(-7)),
            ("caustix.photons".into(), Value::I64(1 << 40)),
            ("units".into(), Value::Text("lx".into())),
        ]
    }

    #[test]
    fn numbers_beyond_a_float_are_refused_and_infinities_kept() {
        assert_eq!(floats([1.5, -2.0, f64::INFINITY]).unwrap(), [1.5, -2.0, f32::INFINITY]);
        assert!(floats([f64::NAN]).unwrap()[0].is_nan());
        let error = floats([1.0, 8.2e47]).unwrap_err();
        assert_eq!(error.kind(), Kind::Range);
        assert!(error.to_string().contains("8.2e47"), "{error}");
    }

    #[test]
    fn values_and_attributes_come_back_bit_for_bit() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("map.exr");
        let (width, height) = (37, 21);
        let mut lux: Vec<f32> = (0..width * height).map(|i| (i as f32 * 0.37).exp2()).collect();
        (lux[3], lux[4], lux[5]) = (f32::NAN, f32::NEG_INFINITY, -0.0);
        lux[6] = f32::from_bits(1);
        let hits: Vec<f32> = (0..width * height).map(|i| ((1 << 24) - i) as f32).collect();
        let channels = [
            Channel { name: "standard_error", data: &lux },
            Channel { name: "hits", data: &hits },
            Channel { name: "Y", data: &lux },
        ];
        write_maps(&path, [width, height], &channels, &attributes(), Light::Other).unwrap();
        let maps = read_maps(&path).unwrap();
        assert_eq!((maps.width, maps.height), (width, height));
        let names: Vec<&str> = maps.channels.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["Y", "hits", "standard_error"]);
        for ((_, data), written) in maps.channels.iter().zip([&lux, &hits, &lux]) {
            let Samples::F32(read) = data else { unreachable!() };
            assert!(read.iter().zip(written).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        for (name, value) in attributes() {
            let expected = match value {
                Value::Text(text) => Attribute::Text(text),
                Value::F64(number) => Attribute::Number(number),
                Value::I64(n) if i32::try_from(n).is_ok() => Attribute::Number(n as f64),
                Value::I64(n) => Attribute::Text(n.to_string()),
            };
            assert_eq!(maps.attributes[&name], expected, "{name}");
        }
        assert_eq!(maps.attributes.len(), attributes().len());
    }

    #[test]
    fn the_same_contents_give_the_same_bytes() {
        let lux: Vec<f32> = (0..64 * 64).map(|i| (i as f32).sin()).collect();
        let channels = [Channel { name: "Y", data: &lux }];
        let first = encode(64, 64, &channels, &attributes(), Light::Other).unwrap();
        for _ in 0..8 {
            let mut shuffled = attributes();
            shuffled.reverse();
            assert!(encode(64, 64, &channels, &shuffled, Light::Other).unwrap() == first);
        }
    }

    #[test]
    fn what_cannot_be_written_is_refused() {
        let values = [1.0_f32; 4];
        let good = Channel { name: "a", data: &values };
        let kind = |w, h, c: &[Channel<'_>], a: &[(String, Value)]| {
            encode(w, h, c, a, Light::Other).unwrap_err().kind()
        };
        assert_eq!(kind(0, 4, &[good], &[]), Kind::Range);
        assert_eq!(kind(3, 1, &[good], &[]), Kind::Range);
        assert_eq!(kind(2, 2, &[], &[]), Kind::Range);
        assert_eq!(kind(2, 2, &[good, good], &[]), Kind::Range);
        assert_eq!(kind(2, 2, &[Channel { name: "", ..good }], &[]), Kind::Range);
        for name in ["", "channels", "dataWindow", "a\0b"] {
            assert_eq!(kind(2, 2, &[good], &[(name.into(), Value::I64(1))]), Kind::Range, "{name:?}");
        }
        let twice = [("x".into(), Value::I64(1)), ("x".into(), Value::I64(2))];
        assert_eq!(kind(2, 2, &[good], &twice), Kind::Range);
        assert_eq!(kind(usize::MAX, 2, &[good], &[]), Kind::Range);
    }
}
