//! Parts that a study has finished, and what names them.

use indicatif::ProgressBar;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::cli::say;
use crate::error::{Diagnostic, Kind, Result};
use crate::files::parts::{Found, Parts};
use crate::lab::study::REVISION;
use crate::scene::Scene;

/// All that a scene's photons depend on.
pub fn scene_key(scene: &Scene) -> String {
    let identity = &scene.identity;
    let version = env!("CARGO_PKG_VERSION");
    let mut key = format!("caustix {version} revision {REVISION}\nscene {}", identity.sha256);
    for (file, sha256) in &identity.files {
        key.push_str(&format!("\nfile {sha256} {file}"));
    }
    key
}

/// A part that is there and whole; one that is damaged is told, and made again.
pub fn found(parts: &Parts, progress: &ProgressBar, kind: &str, key: &str) -> Option<Vec<u8>> {
    match parts.load(kind, key) {
        Found::Whole(content) => Some(content),
        Found::Missing => None,
        Found::Damaged(diagnostic) => {
            progress.suspend(|| say(&format!("warning: {diagnostic}")));
            None
        }
    }
}

/// The command as it was typed, without the folder that the program lies in.
pub fn command_line() -> String {
    let quoted = |word: String| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:^=+".contains(c);
        if !word.is_empty() && word.chars().all(plain) { word } else { format!("'{word}'") }
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("caustix".to_string()).chain(words).collect::<Vec<_>>().join(" ")
}

/// The same of a part in JSON.
pub fn found_json<T: DeserializeOwned>(
    parts: &Parts,
    progress: &ProgressBar,
    kind: &str,
    key: &str,
) -> Option<T> {
    serde_json::from_slice(&found(parts, progress, kind, key)?).ok()
}

/// Keeps a part as JSON.
///
/// # Errors
/// A file that cannot be written.
pub fn store_json(parts: &Parts, kind: &str, key: &str, part: &impl Serialize) -> Result<()> {
    let bytes = serde_json::to_vec_pretty(part).map_err(|e| {
        Diagnostic::new(Kind::Io, format!("\"{e}\" while writing a {kind}"), "a part as text")
    })?;
    parts.store(kind, key, &bytes)
}
