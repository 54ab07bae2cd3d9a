//! What is to be said beside a number: how far it can be trusted, why, and what to do.

use serde::Serialize;

/// How much a warning takes away from the numbers beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The numbers hold; the scene may not be what is meant.
    Note,
    /// Some number may be off by more than its error says.
    Doubtful,
    /// Some number is wrong.
    Untrusted,
}

/// Something about a run that its reader must know. Names are those of report.json: they are only added to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Warning {
    /// How much it matters.
    pub severity: Severity,
    /// A word for programs.
    pub code: &'static str,
    /// What is the matter.
    pub message: String,
    /// Names of the surfaces it is about.
    pub surfaces: Vec<String>,
    /// The share of photons that it concerns, 0 to 1, where photons were counted.
    pub share: Option<f64>,
    /// What to do.
    pub remedy: String,
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let word = match self.severity {
            Severity::Note => "note",
            Severity::Doubtful => "doubtful",
            Severity::Untrusted => "untrusted",
        };
        write!(f, "{word}: {}; {}", self.message, self.remedy)
    }
}

/// A number with four significant digits, as messages tell it.
pub fn four_digits(x: f64) -> String {
    let size = x.abs();
    if size > 0.0 && !(1e-4..1e9).contains(&size) {
        return format!("{x:.3e}");
    }
    let digits = if size > 0.0 { (3 - size.log10().floor() as i32).max(0) } else { 0 };
    format!("{x:.*}", digits as usize)
}
