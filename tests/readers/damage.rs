//! Files damaged at random.

use crate::support::random::Generator;

/// How files are damaged.
pub struct Damage {
    /// Words put in anywhere.
    pub tokens: &'static [&'static str],
    /// So many changes at most.
    pub changes: usize,
    /// Fewer bytes than these are cut out at once.
    pub cut: usize,
}

impl Damage {
    /// The bytes with some of them changed, left out, or put in.
    pub fn mutate(&self, bytes: &[u8], generator: &mut Generator) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        for _ in 0..1 + generator.below(self.changes) {
            let at = generator.below(bytes.len());
            match generator.below(6) {
                0 => bytes[at] ^= 1 << generator.below(8),
                1 => bytes[at] = b'0' + generator.below(10) as u8,
                2 => drop(bytes.remove(at)),
                3 => bytes.insert(at, b"0123456789.-+eE, \t"[generator.below(18)]),
                4 => {
                    let token = format!(" {} ", self.tokens[generator.below(self.tokens.len())]);
                    bytes.splice(at..at, token.bytes());
                }
                _ => {
                    let end = (at + generator.below(self.cut)).min(bytes.len());
                    drop(bytes.drain(at..end));
                }
            }
            if bytes.is_empty() {
                break;
            }
        }
        bytes
    }
}
