//! Ways to damage a file, each drawn from a seed.

use crate::random::Generator;

/// Inputs grow to no more than this.
const LONGEST: usize = 1 << 16;

/// What numbers are replaced by.
const NUMBERS: [&str; 22] = [
    "0",
    "-1",
    "1",
    "2",
    "1e300",
    "-1e300",
    "nan",
    "inf",
    "-inf",
    "2147483648",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "-0",
    "1e-320",
    "4294967295",
    "65536",
    "0.1",
    "360",
    "1_000",
    "0x7fffffffffffffff",
    "99999999999999999999999999999999999999999999999999999999999999999999999999999999999999999999.9999999999",
];

/// What words of four or eight bytes are replaced by.
const WORDS: [u64; 8] =
    [0, 1, u64::MAX, 1 << 31, 1 << 63, 0x7ff0_0000_0000_0000, 0x7ff8_0000_0000_0001, 0x7fef_ffff_ffff_ffff];

/// Changes: often one alone, so that what comes behind it is reached.
const CHANGES: [usize; 8] = [1, 1, 1, 1, 2, 2, 3, 4];

/// The bytes with one to four changes; `other` is what is spliced in.
pub fn mutate(bytes: &[u8], other: &[u8], random: &mut Generator) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..CHANGES[random.below(CHANGES.len())] {
        change(&mut bytes, other, random);
    }
    bytes.truncate(LONGEST.max(other.len()));
    bytes
}

fn change(bytes: &mut Vec<u8>, other: &[u8], random: &mut Generator) {
    if bytes.is_empty() {
        bytes.extend_from_slice(&other[..random.below(other.len())]);
        return;
    }
    let at = random.below(bytes.len());
    let end = (at + 1 + random.below(64)).min(bytes.len());
    match random.below(17) {
        0 => bytes[at] ^= 1 << random.below(8),
        1 => bytes[at] = [0, 0xff, b'\n', b' ', b'-', b'"', 0x80, b'['][random.below(8)],
        2 => bytes.insert(at, random.next() as u8),
        3 => drop(bytes.drain(at..end)),
        4 => {
            let (piece, to) = (bytes[at..end].to_vec(), random.below(bytes.len()));
            drop(bytes.splice(to..to, piece));
        }
        5 => bytes.truncate(at),
        6 | 14 => {
            let [from, to] = word(bytes, at, |b| b.is_ascii_digit() || b"+-.eE".contains(&b));
            drop(bytes.splice(from..to, NUMBERS[random.below(NUMBERS.len())].bytes()));
        }
        7 => {
            let line = line(bytes, at);
            let times = if random.below(8) == 0 { random.below(200) } else { 1 };
            let times = times.min(LONGEST / (line[1] - line[0]).max(1) + 1);
            let copies = bytes[line[0]..line[1]].repeat(times);
            drop(bytes.splice(line[1]..line[1], copies));
        }
        8 => {
            let line = line(bytes, at);
            drop(bytes.drain(line[0]..line[1]));
        }
        9 => swap_words(bytes, at, random.below(bytes.len())),
        10 => {
            let from = random.below(other.len());
            bytes.truncate(at);
            bytes.extend_from_slice(&other[from..]);
        }
        11 => {
            let from = random.below(other.len());
            let piece = &other[from..(from + random.below(200)).min(other.len())];
            drop(bytes.splice(at..end, piece.iter().copied()));
        }
        15 | 16 => {
            if let Some(digit) = bytes[at..].iter_mut().find(|b| b.is_ascii_digit()) {
                *digit = b'0' + random.below(10) as u8;
            }
        }
        _ => {
            let size = if random.below(2) == 0 { 4 } else { 8 };
            let value = WORDS[random.below(WORDS.len())];
            let words = [value.to_le_bytes(), value.to_be_bytes()][random.below(2)];
            let words = &words[..size];
            let at = at & !3;
            for (to, from) in bytes[at..].iter_mut().zip(words) {
                *to = *from;
            }
        }
    }
}

/// The run of such bytes around one, or that byte.
fn word(bytes: &[u8], at: usize, is: impl Fn(u8) -> bool) -> [usize; 2] {
    // The next one there is.
    let at = bytes[at..].iter().position(|b| is(*b)).map_or(at, |i| at + i);
    let from = bytes[..at].iter().rposition(|b| !is(*b)).map_or(0, |i| i + 1);
    let to = bytes[at..].iter().position(|b| !is(*b)).map_or(bytes.len(), |i| at + i);
    [from, to.max(from)]
}

fn line(bytes: &[u8], at: usize) -> [usize; 2] {
    let from = bytes[..at].iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
    let to = bytes[at..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |i| at + i + 1);
    [from, to]
}

fn swap_words(bytes: &mut Vec<u8>, at: usize, and: usize) {
    let is = |b: u8| !b.is_ascii_whitespace();
    let ([a, b], [c, d]) = (word(bytes, at.min(and), is), word(bytes, at.max(and), is));
    if b <= c {
        let swapped = [&bytes[c..d], &bytes[b..c], &bytes[a..b]].concat();
        drop(bytes.splice(a..d, swapped));
    }
}

/// A PNG whose checksums are those of what it holds now, so that what is behind them is reached.
pub fn with_checksums(png: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = png.get(at..at + 4).map(|b| u32::from_be_bytes(b.try_into().unwrap()) as usize) {
        let Some(end) = at.checked_add(8 + length).filter(|end| end + 4 <= png.len()) else { return };
        let sum = crc32(&png[at + 4..end]);
        png[end..end + 4].copy_from_slice(&sum.to_be_bytes());
        at = end + 4;
    }
}

/// ISO 3309, as in the PNG specification, annex D.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), |c, _| if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 })
    })
}
