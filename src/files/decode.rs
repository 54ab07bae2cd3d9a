//! Bytes to text. Formats are ASCII or UTF-8; files are not.

/// Text of a file, whatever its encoding; never fails.
///
/// A byte order mark or the pattern of NULs decides on UTF-16; valid UTF-8 is taken as such; anything else is read
/// as Windows-1252, which gives every byte a character. Only labels can be wrong then (Shift-JIS, say): numbers and
/// keywords are ASCII in all of these.
pub(crate) fn decode(bytes: &[u8]) -> String {
    if let Some(rest) = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]) {
        return utf8_or_1252(rest);
    }
    if let Some(rest) = bytes.strip_prefix(&[0xff, 0xfe]) {
        return utf16(rest, u16::from_le_bytes);
    }
    if let Some(rest) = bytes.strip_prefix(&[0xfe, 0xff]) {
        return utf16(rest, u16::from_be_bytes);
    }
    match utf16_without_mark(bytes) {
        Some(unit) => utf16(bytes, unit),
        None => utf8_or_1252(bytes),
    }
}

/// Whether they are UTF-16.
pub(crate) fn is_utf16(bytes: &[u8]) -> bool {
    [[0xff, 0xfe], [0xfe, 0xff]].iter().any(|mark| bytes.starts_with(mark))
        || utf16_without_mark(bytes).is_some()
}

type Unit = fn([u8; 2]) -> u16;

/// ASCII in UTF-16 has a NUL in every pair, always on the same side.
fn utf16_without_mark(bytes: &[u8]) -> Option<Unit> {
    let head = &bytes[..bytes.len().min(256)];
    let pairs = head.len() / 2;
    let nuls = |side: usize| head.chunks_exact(2).filter(|pair| pair[side] == 0).count();
    let (first, second) = (nuls(0), nuls(1));
    // Nine in ten: a label may hold other scripts. Two pairs at least, so that a lone NUL decides nothing.
    let most = |count: usize| pairs >= 2 && count * 10 >= pairs * 9;
    if most(second) && first == 0 {
        Some(u16::from_le_bytes)
    } else if most(first) && second == 0 {
        Some(u16::from_be_bytes)
    } else {
        None
    }
}

fn utf16(bytes: &[u8], unit: Unit) -> String {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

fn utf8_or_1252(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&b| windows_1252(b)).collect(),
    }
}

pub(super) fn windows_1252(byte: u8) -> char {
    /// 0x80..=0x9f; the five unassigned codes keep their number (WHATWG encoding standard).
    const HIGH: [char; 32] = [
        '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}',
        '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
    ];
    match byte {
        0x80..=0x9f => HIGH[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_gives_the_same_text() {
        let text = "IESNA91\r\n[TEST] caf\u{e9}\r\nTILT=NONE\r\n";
        let utf16 = |f: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(f).collect::<Vec<u8>>();
        let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        let with = |mark: &[u8], body: &[u8]| [mark, body].concat();
        assert_eq!(decode(text.as_bytes()), text);
        assert_eq!(decode(&with(&[0xef, 0xbb, 0xbf], text.as_bytes())), text);
        assert_eq!(decode(&latin), text);
        assert_eq!(decode(&utf16(u16::to_le_bytes)), text);
        assert_eq!(decode(&utf16(u16::to_be_bytes)), text);
        assert_eq!(decode(&with(&[0xff, 0xfe], &utf16(u16::to_le_bytes))), text);
        assert_eq!(decode(&with(&[0xfe, 0xff], &utf16(u16::to_be_bytes))), text);
        assert_eq!(decode(&[0x80, 0x96, 0xff]), "€–ÿ");
        assert_eq!(decode(b"\0"), "\0");
    }
}
