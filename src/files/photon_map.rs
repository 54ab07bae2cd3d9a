//! Saved photon maps: a new view needs no new photons.
//!
//! Little endian: the magic `caustixM`, version (u32), channels (u32), scene hash and settings (each a u32 length and UTF-8),
//! photons traced (u64), replicates (u32), flux of a photon (f64, lm), the frame (low and step, 6 f64, m), number of photons
//! (u64), the photons (cell, direction, primitive, tag: 6 u32; weights: f32 a channel), and the SHA-256 of all before it.

use std::io::{self, Write};

use glam::DVec3;
use sha2::{Digest, Sha256};

use crate::error::{Diagnostic, Kind, Result};
use crate::picture::photon_map::{Frame, Photon, SavedMap};

/// How a saved photon map begins.
pub const MAGIC: &[u8; 8] = b"caustixM";

/// The version that is written and read.
pub const VERSION: u32 = 1;

/// Longest text in the file, bytes.
const MOST_TEXT: usize = 1 << 20;

/// Length of a SHA-256.
const DIGEST: usize = 32;

/// Channels of a saved map: 1 or 3.
///
/// # Errors
/// What is no photon map, or one of another version.
pub fn channels(bytes: &[u8]) -> Result<u32> {
    let mut reader = Reader { rest: bytes };
    reader.head()
}

/// Writes the file.
///
/// # Errors
/// Those of the writer; texts beyond 1 MiB.
pub fn write<const C: usize>(map: &SavedMap<C>, writer: &mut dyn Write) -> io::Result<()> {
    let mut out = Hashing { writer, hash: Sha256::new() };
    out.put(MAGIC)?;
    out.put(&VERSION.to_le_bytes())?;
    out.put(&(C as u32).to_le_bytes())?;
    for text in [&map.scene_hash, &map.settings] {
        if text.len() > MOST_TEXT {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "a text of more than 1 MiB"));
        }
        out.put(&(text.len() as u32).to_le_bytes())?;
        out.put(text.as_bytes())?;
    }
    out.put(&map.photons_traced.to_le_bytes())?;
    out.put(&map.replicates.to_le_bytes())?;
    out.put(&map.photon_lm.to_le_bytes())?;
    for v in [map.frame.low(), map.frame.steps_m()] {
        for x in v.to_array() {
            out.put(&x.to_le_bytes())?;
        }
    }
    out.put(&(map.photons.len() as u64).to_le_bytes())?;
    let mut buffer = Vec::with_capacity(photon_bytes(C) * 4096);
    for some in map.photons.chunks(4096) {
        buffer.clear();
        for p in some {
            let [x, y, z] = p.cell;
            for word in [x, y, z, p.direction, p.primitive, p.tag] {
                buffer.extend_from_slice(&word.to_le_bytes());
            }
            for w in p.weight {
                buffer.extend_from_slice(&w.to_le_bytes());
            }
        }
        out.put(&buffer)?;
    }
    let digest = out.hash.finalize();
    writer.write_all(digest.as_slice())
}

/// Reads the file, of the scene with this hash.
///
/// # Errors
/// What is no photon map, of another version or number of channels; a wrong checksum; a map of another scene; numbers that
/// cannot be.
pub fn read<const C: usize>(bytes: &[u8], expected_scene_hash: &str) -> Result<SavedMap<C>> {
    let mut reader = Reader { rest: bytes };
    let channels = reader.head()?;
    if channels as usize != C {
        return Err(Diagnostic::new(
            Kind::Range,
            format!("photons of {channels} channel(s)"),
            format!("photons of {C} channel(s), as the scene has"),
        ));
    }
    check_digest(bytes)?;
    reader.rest = &reader.rest[..reader.rest.len().saturating_sub(DIGEST)];
    let scene_hash = reader.text()?;
    let settings = reader.text()?;
    if scene_hash != expected_scene_hash {
        return Err(Diagnostic::new(
            Kind::Range,
            format!("photons with hash {scene_hash}, traced by {settings}"),
            format!("photons of this scene and these settings, hash {expected_scene_hash}"),
        )
        .hint(
            "ask for the same settings; if they are, trace the photons again: the scene or a file of it has changed",
        ));
    }
    let photons_traced = u64::from_le_bytes(reader.take()?);
    let replicates = u32::from_le_bytes(reader.take()?);
    let photon_lm = f64::from_le_bytes(reader.take()?);
    let frame = reader.frame()?;
    let photons = reader.photons()?;
    let saved = SavedMap { scene_hash, settings, photons_traced, replicates, photon_lm, frame, photons };
    check(&saved)?;
    Ok(saved)
}

/// That the numbers are such as a run writes.
fn check<const C: usize>(map: &SavedMap<C>) -> Result<()> {
    let wrong = |found: String, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
    if !(map.photon_lm > 0.0 && map.photon_lm.is_finite()) {
        return wrong(format!("photons of {} lm", map.photon_lm), "a positive flux");
    }
    if map.replicates == 0 || map.replicates > 1 << 16 {
        return wrong(format!("{} replicates", map.replicates), "1 to 65536 replicates");
    }
    let (low, step) = (map.frame.low(), map.frame.steps_m());
    if !(low.is_finite() && step.is_finite() && step.min_element() >= 0.0) {
        return wrong(format!("a frame from {low} in steps of {step} m"), "finite numbers");
    }
    let good = |p: &Photon<C>| {
        p.replicate() < map.replicates as usize && p.weight.iter().all(|w| w.is_finite() && *w >= 0.0)
    };
    match map.photons.iter().position(|p| !good(p)) {
        None => Ok(()),
        Some(i) => wrong(
            format!(
                "photon {i} of replicate {} with weights {:?}",
                map.photons[i].replicate(),
                map.photons[i].weight
            ),
            "a replicate of the run, and weights of at least 0",
        ),
    }
}

/// Bytes of a photon in the file.
const fn photon_bytes(channels: usize) -> usize {
    24 + 4 * channels
}

fn check_digest(bytes: &[u8]) -> Result<()> {
    let at = bytes.len().checked_sub(DIGEST).ok_or_else(truncated)?;
    let (body, digest) = bytes.split_at(at);
    if Sha256::digest(body).as_slice() == digest {
        return Ok(());
    }
    Err(Diagnostic::new(
        Kind::Syntax,
        "a photon map whose checksum does not fit its content",
        "an undamaged, complete file",
    )
    .hint("trace the photons again"))
}

fn truncated() -> Diagnostic {
    Diagnostic::new(Kind::Syntax, "a photon map that ends too soon", "a complete file")
}

/// Hands on what it hashes.
struct Hashing<'w> {
    writer: &'w mut dyn Write,
    hash: Sha256,
}

impl Hashing<'_> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.update(bytes);
        self.writer.write_all(bytes)
    }
}

struct Reader<'b> {
    rest: &'b [u8],
}

impl<'b> Reader<'b> {
    fn bytes(&mut self, n: usize) -> Result<&'b [u8]> {
        let (head, tail) = self.rest.split_at_checked(n).ok_or_else(truncated)?;
        self.rest = tail;
        Ok(head)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let (head, tail) = self.rest.split_first_chunk::<N>().ok_or_else(truncated)?;
        self.rest = tail;
        Ok(*head)
    }

    /// Magic, version; gives the number of channels.
    fn head(&mut self) -> Result<u32> {
        if self.bytes(MAGIC.len()).is_ok_and(|m| m == MAGIC) {
            let version = u32::from_le_bytes(self.take()?);
            if version != VERSION {
                return Err(Diagnostic::new(
                    Kind::Unavailable,
                    format!("a photon map of version {version}"),
                    format!("version {VERSION}"),
                ));
            }
            return Ok(u32::from_le_bytes(self.take()?));
        }
        Err(Diagnostic::new(Kind::Syntax, "a file that is no photon map", "a photon map that caustix saved"))
    }

    fn text(&mut self) -> Result<String> {
        let length = u32::from_le_bytes(self.take()?) as usize;
        if length > MOST_TEXT {
            return Err(Diagnostic::new(Kind::Limit, format!("a text of {length} bytes"), "at most 1 MiB"));
        }
        let bytes = self.bytes(length)?;
        let text = std::str::from_utf8(bytes);
        text.map(str::to_string)
            .map_err(|_| Diagnostic::new(Kind::Syntax, "a text that is not UTF-8", "UTF-8"))
    }

    fn vector(&mut self) -> Result<DVec3> {
        let mut number = || -> Result<f64> { Ok(f64::from_le_bytes(self.take()?)) };
        Ok(DVec3::new(number()?, number()?, number()?))
    }

    fn frame(&mut self) -> Result<Frame> {
        Ok(Frame::from_steps(self.vector()?, self.vector()?))
    }

    /// The photons: exactly what is left. No more is allocated than the file itself holds.
    fn photons<const C: usize>(&mut self) -> Result<Vec<Photon<C>>> {
        let count = u64::from_le_bytes(self.take()?);
        let size = photon_bytes(C);
        if count != (self.rest.len() / size) as u64 || !self.rest.len().is_multiple_of(size) {
            return Err(Diagnostic::new(
                Kind::Syntax,
                format!("{count} photons announced in {} bytes", self.rest.len()),
                format!("{size} bytes a photon"),
            ));
        }
        let photon = |bytes: &[u8]| {
            let mut words = bytes.as_chunks::<4>().0.iter().map(|w| u32::from_le_bytes(*w));
            let mut next = || words.next().unwrap_or_default();
            Photon {
                cell: [next(), next(), next()],
                direction: next(),
                primitive: next(),
                tag: next(),
                weight: std::array::from_fn(|_| f32::from_bits(next())),
            }
        };
        Ok(self.rest.chunks_exact(size).map(photon).collect())
    }
}
