//! The paper's numbers beside ours, and how ours are written.

use crate::lab::room::{RoomStudy, Row, SEQUENCES, Value};
use crate::report::numbers::rounded;
use crate::sequence::Sequence;

/// The paper's tables 2 to 5: two numbers of photons, and their deviations in the first four of [`SEQUENCES`]. Its scene is
/// another of as many triangles.
const PAPER: [([u64; 2], [f64; 4]); 6] = [
    ([10_000, 100_000], [0.004_304_51, 0.001_118_29, 0.001_113_91, 0.001_118_04]),
    ([10_000, 1_000_000], [0.003_614_28, 0.001_018_67, 0.001_158_95, 0.001_122_52]),
    ([100_000, 1_000_000], [0.001_300_49, 0.000_326_033, 0.000_425_24, 0.000_296_641]),
    ([10_000, PAPER_MASTER], [0.003_731_37, 0.001_010_63, 0.001_143_42, 0.001_140_25]),
    ([100_000, PAPER_MASTER], [0.001_365_92, 0.000_347_712, 0.000_421_544, 0.000_323_288]),
    ([1_000_000, PAPER_MASTER], [0.000_339_878, 0.000_079_831_7, 0.000_067_878_2, 0.000_063_608_6]),
];

/// The paper's table 6: pairs of the first four of [`SEQUENCES`] at 10^7 photons.
const PAPER_BETWEEN: [([usize; 2], f64); 6] = [
    ([0, 1], 0.000_100_943),
    ([0, 2], 0.000_103_805),
    ([0, 3], 0.000_110_742),
    ([1, 2], 0.000_035_803_7),
    ([1, 3], 0.000_029_486_6),
    ([2, 3], 0.000_030_054_9),
];

const PAPER_MASTER: u64 = 10_000_000;

/// The paper's name of a sequence of [`SEQUENCES`], which here is more exact than the name in commands.
pub fn title(sequence: usize) -> &'static str {
    match SEQUENCES[sequence] {
        Sequence::Independent => "random",
        Sequence::Halton => "Halton",
        Sequence::HaltonFaure => "scrambled Halton (Faure)",
        Sequence::Hammersley => "Hammersley",
        Sequence::Sobol => "Sobol'",
        other => other.name(),
    }
}

/// The paper's deviation of two numbers of photons of a sequence.
pub fn paper(sequence: usize, pair: [u64; 2]) -> Option<f64> {
    PAPER.iter().find(|(photons, _)| *photons == pair)?.1.get(sequence).copied()
}

/// Three digits of a small number, with the spread where there is one.
pub fn value(value: Value) -> String {
    with_spread(value, |x| format!("{x:.2e}"))
}

/// A ratio with the spread where there is one.
pub fn ratio(value: Value) -> String {
    with_spread(value, |x| format!("{x:.2}"))
}

fn with_spread(value: Value, written: impl Fn(f64) -> String) -> String {
    let spread = value.spread.map_or(String::new(), |s| format!(" +- {}", written(s)));
    written(value.mean) + &spread
}

/// The two largest numbers of photons.
pub fn last_pair(study: &RoomStudy) -> [u64; 2] {
    let ladder = &study.options.ladder;
    [ladder[ladder.len() - 2], ladder[ladder.len() - 1]]
}

/// The paper's ratio of the random sequence to another.
pub fn paper_ratio(sequence: usize, pair: [u64; 2]) -> Option<String> {
    Some(format!("{:.1}", paper(0, pair)? / paper(sequence, pair)?))
}

/// The paper's deviation of two sequences.
pub fn paper_between(sequences: [usize; 2], photons: u64) -> Option<f64> {
    let same = |e: &&([usize; 2], f64)| e.0 == sequences && photons == PAPER_MASTER;
    PAPER_BETWEEN.iter().find(same).map(|e| e.1)
}

/// Two sequences, their deviation with the most photons, and the paper's.
pub fn between(study: &RoomStudy) -> impl Iterator<Item = [String; 4]> {
    study.between().into_iter().map(|b| {
        let [first, second] = b.sequences.map(|s| title(s).to_owned());
        [first, second, value(b.value), printed(paper_between(b.sequences, b.photons[1]))]
    })
}

/// A number of the paper, three digits.
pub fn printed(paper: Option<f64>) -> String {
    paper.map_or("-".to_string(), |p| format!("{p:.2e}"))
}

/// Three digits of what may be unknown.
pub fn known(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map_or("-".to_string(), |v| rounded(v, 3))
}

/// What stands behind an error that the reference limits.
pub fn mark(row: &Row) -> &'static str {
    if row.is_limited() { "*" } else { "" }
}
