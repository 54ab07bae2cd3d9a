//! Saved photon maps: a new view needs no new photons.
//!
//! Little endian: the magic `caustixM`, version (u32), channels (u32), scene hash and settings (each a u32 length and UTF-8),
//! photons traced (u64), replicates (u32), flux of a photon (f64, lm), the frame (low and step, 6 f64, m), number of photons
//! (u64), the photons (cell, direction, primitive, tag: 6 u32; weights: f32 a channel), and the SHA-256 of all before it.

use std::io::{self, Write};

use glam::DVec3;
use sha2::{Digest, Sha256};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::excerpt::cut;
use crate::math::digest::Hashing;
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
    Reader(bytes).head()
}

/// Writes the file.
///
/// # Errors
/// Those of the writer; texts beyond 1 MiB.
pub fn write<const C: usize>(map: &SavedMap<C>, writer: &mut dyn Write) -> io::Result<()> {
    let mut head = [&MAGIC[..], &VERSION.to_le_bytes(), &(C as u32).to_le_bytes()].concat();
    for text in [&map.scene_hash, &map.settings] {
        if text.len() > MOST_TEXT {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "a text of more than 1 MiB"));
        }
        head.extend((text.len() as u32).to_le_bytes());
        head.extend(text.as_bytes());
    }
    head.extend(map.photons_traced.to_le_bytes());
    head.extend(map.replicates.to_le_bytes());
    let numbers = [map.frame.low().to_array(), map.frame.steps_m().to_array()].concat();
    head.extend([map.photon_lm].iter().chain(&numbers).flat_map(|x| x.to_le_bytes()));
    head.extend((map.photons.len() as u64).to_le_bytes());
    let mut out = Hashing::new(writer);
    out.write_all(&head)?;
    Photon::write_all(&map.photons, &mut out)?;
    out.seal()
}

/// Reads the file, of the scene with this hash.
///
/// # Errors
/// What is no photon map, of another version or number of channels; a wrong checksum; a map of another scene; numbers that
/// cannot be.
pub fn read<const C: usize>(bytes: &[u8], expected_scene_hash: &str) -> Result<SavedMap<C>> {
    let mut reader = Reader(bytes);
    let channels = reader.head()?;
    if channels as usize != C {
        let required = format!("photons of {C} channel(s), as the scene has");
        return Err(Diagnostic::new(Kind::Range, format!("photons of {channels} channel(s)"), required));
    }
    check_digest(bytes)?;
    reader.0 = &reader.0[..reader.0.len().saturating_sub(DIGEST)];
    let scene_hash = reader.text()?;
    let settings = reader.text()?;
    if scene_hash != expected_scene_hash {
        let found = format!("photons with hash {}, traced by {}", cut(&scene_hash), cut(&settings));
        let required = format!("photons of this scene and these settings, hash {expected_scene_hash}");
        return Err(Diagnostic::new(Kind::Range, found, required).hint(
            "ask for the same settings; if they are, trace the photons again: the scene or a file of it has changed",
        ));
    }
    let photons_traced = u64::from_le_bytes(reader.take()?);
    let replicates = u32::from_le_bytes(reader.take()?);
    let photon_lm = f64::from_le_bytes(reader.take()?);
    let frame = Frame::from_steps(reader.vector()?, reader.vector()?);
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
    let Some(i) = map.photons.iter().position(|p| !good(p)) else { return Ok(()) };
    let (replicate, weight) = (map.photons[i].replicate(), map.photons[i].weight);
    let found = format!("photon {i} of replicate {replicate} with weights {weight:?}");
    wrong(found, "a replicate of the run, and weights of at least 0")
}

fn check_digest(bytes: &[u8]) -> Result<()> {
    let at = bytes.len().checked_sub(DIGEST).ok_or_else(truncated)?;
    let (body, digest) = bytes.split_at(at);
    if Sha256::digest(body).as_slice() == digest {
        return Ok(());
    }
    let found = "a photon map whose checksum does not fit its content";
    Err(Diagnostic::new(Kind::Syntax, found, "an undamaged, complete file").hint("trace the photons again"))
}

fn truncated() -> Diagnostic {
    Diagnostic::new(Kind::Syntax, "a photon map that ends too soon", "a complete file")
}

/// What is left to read.
struct Reader<'b>(&'b [u8]);

impl<'b> Reader<'b> {
    fn bytes(&mut self, n: usize) -> Result<&'b [u8]> {
        self.0.split_off(..n).ok_or_else(truncated)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let (head, tail) = self.0.split_first_chunk::<N>().ok_or_else(truncated)?;
        self.0 = tail;
        Ok(*head)
    }

    /// Magic, version; gives the number of channels.
    fn head(&mut self) -> Result<u32> {
        if self.bytes(MAGIC.len()).ok() != Some(MAGIC) {
            let found = "a file that is no photon map";
            return Err(Diagnostic::new(Kind::Syntax, found, "a photon map that caustix saved"));
        }
        let version = u32::from_le_bytes(self.take()?);
        if version != VERSION {
            let found = format!("a photon map of version {version}");
            return Err(Diagnostic::new(Kind::Unavailable, found, format!("version {VERSION}")));
        }
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn text(&mut self) -> Result<String> {
        let length = u32::from_le_bytes(self.take()?) as usize;
        if length > MOST_TEXT {
            return Err(Diagnostic::new(Kind::Limit, format!("a text of {length} bytes"), "at most 1 MiB"));
        }
        String::from_utf8(self.bytes(length)?.to_vec())
            .map_err(|_| Diagnostic::new(Kind::Syntax, "a text that is not UTF-8", "UTF-8"))
    }

    fn vector(&mut self) -> Result<DVec3> {
        let mut number = || -> Result<f64> { Ok(f64::from_le_bytes(self.take()?)) };
        Ok(DVec3::new(number()?, number()?, number()?))
    }

    /// The photons: exactly what is left. No more is allocated than the file itself holds.
    fn photons<const C: usize>(&mut self) -> Result<Vec<Photon<C>>> {
        let count = u64::from_le_bytes(self.take()?);
        let size = Photon::<C>::BYTES;
        if count != (self.0.len() / size) as u64 || !self.0.len().is_multiple_of(size) {
            let found = format!("{count} photons announced in {} bytes", self.0.len());
            return Err(Diagnostic::new(Kind::Syntax, found, format!("{size} bytes a photon")));
        }
        Ok(self.0.chunks_exact(size).map(Photon::from_bytes).collect())
    }
}
