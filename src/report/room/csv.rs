//! The tables as CSV.

use std::fmt::Write;

use crate::lab::room::{RoomStudy, Row, SEQUENCES, Value};
use crate::lab::study::norms::Errors;
use crate::report::compare::csv::HEADER;
use crate::report::numbers::bare;

use super::paper::{paper, paper_between};

/// One row for each sequence and number of photons, with the header of every `compare.csv`; errors are fractions, empty
/// where unknown.
pub fn csv(study: &RoomStudy) -> String {
    let mut out = format!("{HEADER}\n");
    for row in study.rows() {
        let Row { photons, photons_per_s, coordinates, ratio_equal_n, .. } = row;
        let Errors { relative_rms, nrms, relative_l1 } = row.errors;
        let [spread, rate, ratio_equal_time] = [row.nrms_spread, row.rate, row.ratio_equal_time].map(bare);
        let (name, cells) = (SEQUENCES[row.sequence].name(), study.areas_m2.len());
        let _infallible = writeln!(
            out,
            "{name},{photons},{cells},{relative_rms},{nrms},{relative_l1},{spread},{photons_per_s},{coordinates},\
             {rate},{ratio_equal_n},{ratio_equal_time}"
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
    for b in study.between() {
        row(b.sequences, b.photons, b.value, paper_between(b.sequences, b.photons[1]));
    }
    out
}
