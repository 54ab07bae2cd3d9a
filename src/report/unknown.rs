//! Why a number is not given, in words.

use crate::estimate::extremes::Unknown;
use crate::run::Outcome;
use crate::scene::receiver::Cells;

use super::numbers::{grouped, rounded};

/// Why a run has no standard error, where it has none.
pub fn why_no_error(outcome: &Outcome) -> Option<&'static str> {
    match (outcome.replicates, outcome.plan.algorithm().sequence.is_randomised()) {
        (2.., _) => None,
        (_, false) => {
            Some("this sequence has no seed: there is one replicate, and one set of points has no spread")
        }
        (_, true) => Some("one replicate: the points of one set are not independent of each other"),
    }
}

/// Why extremes and uniformity of these cells are not given, and what would do: `key` divides them.
pub(super) fn why_unknown(why: Unknown, cells: Cells, key: &str, outcome: &Outcome) -> String {
    match why {
        Unknown::OneReplicate => why_no_error(outcome).unwrap_or("one replicate has no spread").to_owned(),
        Unknown::Dark => "no light arrives".to_owned(),
        Unknown::OneCell => "one cell".to_owned(),
        Unknown::Noisy { photons, error, bound, cells: fewer, more } => {
            let grid = fewer
                .and_then(|fewer| coarser(cells, key, fewer))
                .map_or(String::new(), |grid| grid + ", or ");
            let [photons, error, bound] = [photons, 100.0 * error, 100.0 * bound].map(|x| rounded(x, 2));
            let more = grouped(more.ceil() as u64);
            format!(
                "{photons} photons in a cell are too few: they are sure to {error} % where {bound} % is needed; {grid}{more} \
                 times the photons would do"
            )
        }
    }
}

/// A division into at most so many cells of the same shape, as the key of a receiver says it.
fn coarser(cells: Cells, key: &str, most: u64) -> Option<String> {
    match cells {
        Cells::Grid { nu, nv } => {
            let scale = (most as f64 / (f64::from(nu) * f64::from(nv))).sqrt();
            let [nu, nv] = [nu, nv].map(|n| ((f64::from(n) * scale) as u64).max(1));
            (nu * nv > 1).then(|| format!("`{key} = [{nu}, {nv}]`"))
        }
        Cells::Faces { .. } => Some(format!("{} faces of equal area", grouped(most))),
    }
}
