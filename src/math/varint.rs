//! Numbers as bytes. Of whole ones seven bits each, the lowest first: counts of a map are small, and most take one byte (LEB128).

use std::io::{self, Read, Write};

/// Numbers that are put together before they are written.
const CHUNK: usize = 1 << 13;
/// Most bytes of a number of 64 bits.
const MOST_BYTES: usize = 10;

/// Writes numbers.
///
/// # Errors
/// Those of the writer.
pub fn put(out: &mut dyn Write, numbers: impl IntoIterator<Item = u64>) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(CHUNK + MOST_BYTES);
    for mut number in numbers {
        while number >= 1 << 7 {
            bytes.push(number as u8 | 1 << 7);
            number >>= 7;
        }
        bytes.push(number as u8);
        if bytes.len() >= CHUNK {
            out.write_all(&bytes)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes)
}

/// Reads a number.
///
/// # Errors
/// Those of the reader; bytes that are no number of 64 bits.
pub fn take(from: &mut dyn Read) -> io::Result<u64> {
    let mut number = 0;
    for k in 0..MOST_BYTES {
        let mut byte = [0];
        from.read_exact(&mut byte)?;
        let bits = u64::from(byte[0] & 0x7f);
        let shift = 7 * k as u32;
        if bits << shift >> shift != bits {
            break;
        }
        number |= bits << shift;
        if byte[0] >> 7 == 0 {
            return Ok(number);
        }
    }
    Err(damaged("a number of more than 64 bits"))
}

/// Writes numbers of 128 bits, the lower half first.
///
/// # Errors
/// Those of the writer.
pub fn put_wide(out: &mut dyn Write, numbers: impl IntoIterator<Item = u128>) -> io::Result<()> {
    put(out, numbers.into_iter().flat_map(|number| [number as u64, (number >> 64) as u64]))
}

/// Reads a number of 128 bits.
///
/// # Errors
/// As [`take`].
pub fn take_wide(from: &mut dyn Read) -> io::Result<u128> {
    let (low, high) = (take(from)?, take(from)?);
    Ok(u128::from(high) << 64 | u128::from(low))
}

/// Writes floating-point numbers, to the bit.
///
/// # Errors
/// Those of the writer.
pub fn put_reals(out: &mut dyn Write, numbers: impl IntoIterator<Item = f64>) -> io::Result<()> {
    let bytes: Vec<u8> = numbers.into_iter().flat_map(f64::to_le_bytes).collect();
    out.write_all(&bytes)
}

/// Reads a floating-point number.
///
/// # Errors
/// Those of the reader.
pub fn take_real(from: &mut dyn Read) -> io::Result<f64> {
    let mut bytes = [0; 8];
    from.read_exact(&mut bytes)?;
    Ok(f64::from_le_bytes(bytes))
}

/// Reads a number that is at most this one.
///
/// # Errors
/// Those of the reader; a larger number.
pub fn take_up_to(from: &mut dyn Read, most: u64, what: &str) -> io::Result<u64> {
    match take(from)? {
        number if number <= most => Ok(number),
        number => Err(damaged(&format!("{number} {what}"))),
    }
}

/// Reads a number that is to be this one.
///
/// # Errors
/// Those of the reader; another number.
pub fn expect(from: &mut dyn Read, number: u64, what: &str) -> io::Result<()> {
    match take(from)? {
        found if found == number => Ok(()),
        found => Err(damaged(&format!("{found} {what} instead of {number}"))),
    }
}

/// That what was read cannot be.
pub fn damaged(found: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_and_small_ones_take_a_byte() {
        let numbers = [0, 1, 127, 128, 300, 1 << 35, u64::MAX - 1, u64::MAX];
        let mut bytes = Vec::new();
        put(&mut bytes, numbers).unwrap();
        assert_eq!(bytes.len(), 1 + 1 + 1 + 2 + 2 + 6 + 10 + 10);
        let mut from = &bytes[..];
        assert_eq!(numbers.map(|_| take(&mut from).unwrap()), numbers);
        assert!(take(&mut from).is_err());
    }

    #[test]
    fn numbers_of_128_bits_come_back() {
        let numbers = [0, u128::from(u64::MAX), 1 << 64, u128::MAX - 5];
        let mut bytes = Vec::new();
        put_wide(&mut bytes, numbers).unwrap();
        let mut from = &bytes[..];
        assert_eq!(numbers.map(|_| take_wide(&mut from).unwrap()), numbers);
    }

    #[test]
    fn what_is_no_number_is_refused() {
        let too_long = [0xff; 11];
        let mut too_large = [0xff; 10];
        too_large[9] = 2;
        for bytes in [&too_long[..], &too_large, &[0x80], &[]] {
            assert!(take(&mut &bytes[..]).is_err(), "{bytes:?}");
        }
        assert!(expect(&mut &[7_u8][..], 8, "cells").unwrap_err().to_string().contains("7 cells"));
    }
}
