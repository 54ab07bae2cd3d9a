//! The tables as CSV.

use std::fmt::Write;

use crate::lab::room::{RoomStudy, SEQUENCES, Value};
use crate::report::compare::csv::HEADER;
use crate::report::numbers::bare;

use super::paper::{last_pair, paper, paper_between};

/// One row for each sequence and number of photons, with the header of every `compare.csv`; errors are fractions, empty
/// where unknown.
pub fn csv(study: &RoomStudy) -> String {
    let mut out = format!("{HEADER}\n");
    for row in study.rows() {
        let _infallible = writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{},{},{}",
            SEQUENCES[row.sequence].name(),
            row.photons,
            study.areas_m2.len(),
            row.errors.relative_rms,
            row.errors.nrms,
            row.errors.relative_l1,
            bare(row.nrms_spread),
            row.photons_per_s,
            row.coordinates,
            bare(row.rate),
            row.ratio_equal_n,
            bare(row.ratio_equal_time)
        );
    }
    out
}

/// One row for each deviation: of two numbers of photons of one sequence, then of two sequences.
pub fn deviations_csv(study: &RoomStudy) -> String {
    let mut out = "first,first_photons,second,second_photons,deviation,spread,paper\n".to_string();
    let mut row = |[first, second]: [usize; 2], pair: [u64; 2], v: Value, paper: Option<f64>| {
        let [a, b] = [first, second].map(|s| SEQUENCES[s].name());
        let (spread, paper) = (bare(v.spread), bare(paper));
        let _infallible = writeln!(out, "{a},{},{b},{},{},{spread},{paper}", pair[0], pair[1], v.mean);
    };
    for d in study.deviations() {
        row(d.sequences, d.photons, d.value, paper(d.sequences[0], d.photons));
    }
    let [_, many] = last_pair(study);
    for b in study.between() {
        let [first, second] = b.sequences;
        row(b.sequences, b.photons, b.value, paper_between(first, second, many));
    }
    out
}
