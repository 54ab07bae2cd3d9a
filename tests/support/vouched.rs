//! The list of a folder's results, checked as a reader would: SHA-256 and length of every file that it names.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;
use sha2::{Digest, Sha256};

/// What a list says of its folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Found {
    /// There is no list.
    NoList,
    /// Every file is there as the list says; their names.
    Whole(BTreeSet<String>),
    /// These files are not there or are others.
    Mixed(Vec<String>),
}

/// Looks at a folder and its list `report.json` or another of this name.
pub fn found(folder: &Path, list: &str) -> Found {
    let Ok(text) = fs::read_to_string(folder.join(list)) else { return Found::NoList };
    let json: Value = serde_json::from_str(&text).unwrap();
    let files = json["files"].as_object().unwrap();
    let lengths = json["files_bytes"].as_object().unwrap();
    assert_eq!(files.keys().collect::<Vec<_>>(), lengths.keys().collect::<Vec<_>>());
    let is_other = |name: &&String| {
        let Ok(bytes) = fs::read(folder.join(name)) else { return true };
        let hash: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        files[*name] != hash || lengths[*name] != bytes.len()
    };
    let others: Vec<String> = files.keys().filter(is_other).cloned().collect();
    if others.is_empty() { Found::Whole(files.keys().cloned().collect()) } else { Found::Mixed(others) }
}

/// The whole set of a folder, list included, as names.
pub fn whole(folder: &Path, list: &str) -> BTreeSet<String> {
    match found(folder, list) {
        Found::Whole(mut names) => {
            names.insert(list.to_string());
            names
        }
        other => panic!("{}: {other:?}", folder.display()),
    }
}

/// Everything that lies in a folder, but for the state of the run, which changes while it lasts.
pub fn names(folder: &Path) -> BTreeSet<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| !name.starts_with("run.state")).collect()
}
