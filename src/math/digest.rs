//! SHA-256: what tells whether a scene, a file or kept photons are the same.

use std::io::{self, Read, Write};

use sha2::{Digest, Sha256};

/// SHA-256 in lower-case hexadecimal digits.
pub fn sha256_hex(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Length and SHA-256 of all that can be read.
///
/// # Errors
/// Those of reading.
pub fn sha256_of(source: &mut impl Read) -> io::Result<(u64, String)> {
    let mut through = Hashing::new(io::sink());
    let length = io::copy(source, &mut through)?;
    Ok((length, hexadecimal(&through.digest())))
}

/// Hashes what is written through it.
pub struct Hashing<W> {
    inner: W,
    hash: Sha256,
}

impl<W: Write> Hashing<W> {
    /// Nothing yet, on its way to `inner`.
    pub fn new(inner: W) -> Self {
        Self { inner, hash: Sha256::new() }
    }

    /// The SHA-256 of all that was written.
    pub fn digest(self) -> [u8; 32] {
        self.hash.finalize().into()
    }

    /// Writes the SHA-256 of all before it.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn seal(self) -> io::Result<()> {
        let Self { mut inner, hash } = self;
        inner.write_all(hash.finalize().as_slice())
    }
}

impl<W: Write> Write for Hashing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hash.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn hash_is_that_of_fips_180() {
        // FIPS 180-2, appendix B.1.
        assert_eq!(sha256_hex(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        // FIPS 180-2, appendix B.3: a million times the letter a.
        let million = vec![b'a'; 1_000_000];
        let hash = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";
        assert_eq!(sha256_of(&mut &million[..]).unwrap(), (1_000_000, hash.to_string()));
    }
}
