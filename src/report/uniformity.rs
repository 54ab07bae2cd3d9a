//! How uniform the light on some cells is: their extremes with errors, or why these are not given.

use serde::Serialize;

use crate::estimate::extremes::{Extremes, Interval, Unknown};
use crate::run::Outcome;
use crate::scene::receiver::Cells;

use super::unknown::why_unknown;

/// Extremes of the cells of a map or of an evaluation grid. Names are those of report.json.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Uniformity {
    /// U0 = minimum / mean, with its error; `None` where cells are too noisy for it.
    pub u0: Option<Interval>,
    /// Ud = minimum / maximum, with its error.
    pub ud: Option<Interval>,
    /// Illuminance of the darkest cell, lx, with its error.
    pub minimum: Option<Interval>,
    /// Illuminance of the brightest cell, lx, with its error.
    pub maximum: Option<Interval>,
    /// Why these four are not given, and what would do.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl Uniformity {
    /// Of extremes in photons a square metre; `key` of a receiver is what would divide it otherwise.
    pub(super) fn new(
        extremes: Result<Extremes, Unknown>,
        cells: Cells,
        key: &str,
        outcome: &Outcome,
    ) -> Self {
        match extremes {
            Ok(extremes) => Self {
                u0: Some(extremes.u0),
                ud: Some(extremes.ud),
                minimum: Some(extremes.minimum.times(outcome.photon_lm)),
                maximum: Some(extremes.maximum.times(outcome.photon_lm)),
                reason: None,
            },
            Err(why) => Self { reason: Some(why_unknown(why, cells, key, outcome)), ..Self::default() },
        }
    }
}
