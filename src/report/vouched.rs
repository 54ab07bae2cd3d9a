//! Lists of a set's files, in its report.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::error::Result;
use crate::files::set::Listed;

use super::json::json;

/// A report and the files that it vouches for. Names are a contract: they are only added to.
#[derive(Debug, Clone, Serialize)]
struct Vouched<'a, R> {
    #[serde(flatten)]
    report: &'a R,
    /// SHA-256 of every other file of the set, by name.
    files: &'a BTreeMap<String, String>,
    /// Their lengths.
    files_bytes: &'a BTreeMap<String, u64>,
}

/// The report as JSON text, with the files of its set.
///
/// # Errors
/// Numbers that JSON cannot hold.
pub fn vouching(report: &impl Serialize, files: &Listed) -> Result<String> {
    json(&Vouched { report, files: &files.sha256, files_bytes: &files.bytes })
}
