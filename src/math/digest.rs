//! SHA-256: what tells whether a scene, a file or kept photons are the same.

use std::io::{self, Read};

use sha2::{Digest, Sha256};

/// SHA-256 in lower-case hexadecimal digits.
pub fn sha256_hex(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Length and SHA-256 of all that can be read, block by block.
///
/// # Errors
/// Those of reading.
pub fn sha256_of(source: &mut impl Read) -> io::Result<(u64, String)> {
    let (mut hash, mut length, mut block) = (Sha256::new(), 0u64, vec![0u8; 1 << 16]);
    loop {
        match source.read(&mut block) {
            Ok(0) => return Ok((length, hexadecimal(&hash.finalize()))),
            Ok(read) => {
                hash.update(&block[..read]);
                length += read as u64;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
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
