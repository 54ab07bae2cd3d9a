//! What the study of a room says ([`crate::lab::room`]): for a terminal, as Markdown, as CSV.

use std::fmt::Write;
use std::path::Path;

use crate::error::{Diagnostic, Result};
use crate::files::atomic::write_atomically;
use crate::lab::room::{RoomStudy, Row, SEQUENCES, Value};
use crate::sequence::Sequence;

use super::text::{grouped, rounded};

/// The paper's tables 2 to 5, in the order of the first four of [`SEQUENCES`]: deviations of (10^4, 10^5), (10^4, 10^6),
/// (10^5, 10^6), (10^4, 10^7), (10^5, 10^7), (10^6, 10^7) photons. Its scene is another of as many triangles.
pub const PAPER: [[f64; 6]; 4] = [
    [0.004_304_51, 0.003_614_28, 0.001_300_49, 0.003_731_37, 0.001_365_92, 0.000_339_878],
    [0.001_118_29, 0.001_018_67, 0.000_326_033, 0.001_010_63, 0.000_347_712, 0.000_079_831_7],
    [0.001_113_91, 0.001_158_95, 0.000_425_24, 0.001_143_42, 0.000_421_544, 0.000_067_878_2],
    [0.001_118_04, 0.001_122_52, 0.000_296_641, 0.001_140_25, 0.000_323_288, 0.000_063_608_6],
];

/// The pairs of numbers of photons that those columns are for.
const PAPER_PAIRS: [[u64; 2]; 6] = [
    [10_000, 100_000],
    [10_000, 1_000_000],
    [100_000, 1_000_000],
    [10_000, 10_000_000],
    [100_000, 10_000_000],
    [1_000_000, 10_000_000],
];

/// The paper's table 6: pairs of the first four of [`SEQUENCES`] at 10^7 photons.
pub const PAPER_BETWEEN: [(usize, usize, f64); 6] = [
    (0, 1, 0.000_100_943),
    (0, 2, 0.000_103_805),
    (0, 3, 0.000_110_742),
    (1, 2, 0.000_035_803_7),
    (1, 3, 0.000_029_486_6),
    (2, 3, 0.000_030_054_9),
];

const PAPER_MASTER: u64 = 10_000_000;

/// The paper's name of a sequence of [`SEQUENCES`], which here is more exact than the name in commands.
fn title(sequence: usize) -> &'static str {
    match SEQUENCES[sequence] {
        Sequence::Independent => "random",
        Sequence::Halton => "Halton",
        Sequence::HaltonFaure => "scrambled Halton (Faure)",
        Sequence::Hammersley => "Hammersley",
        Sequence::Sobol => "Sobol'",
        other => other.name(),
    }
}

fn paper(sequence: usize, pair: [u64; 2]) -> Option<f64> {
    let column = PAPER_PAIRS.iter().position(|p| *p == pair)?;
    PAPER.get(sequence).map(|row| row[column])
}

/// Three digits of a small number, with the spread where there is one.
fn value(value: Value) -> String {
    let scientific = |x: f64| format!("{x:.2e}");
    match value.spread {
        Some(spread) => format!("{} +- {}", scientific(value.mean), scientific(spread)),
        None => scientific(value.mean),
    }
}

fn known(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map(|v| rounded(v, 3)).unwrap_or_else(|| "-".to_string())
}

/// The tables for a terminal.
pub fn text(study: &RoomStudy) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _infallible = write_text(&mut out, study);
    out
}

fn write_text(out: &mut String, study: &RoomStudy) -> std::fmt::Result {
    writeln!(out, "scene      {}", study.scene_name)?;
    writeln!(
        out,
        "photons    {}; exactly {} reflections each, no roulette; {} triangles",
        study.options.ladder.iter().map(|n| grouped(*n)).collect::<Vec<_>>().join(", "),
        study.reflections,
        study.areas_m2.len()
    )?;
    writeln!(out, "\ndeviation between two numbers of photons of a sequence")?;
    writeln!(
        out,
        "  {:<24} {:>11} {:>11}  {:<22} {:>8}",
        "sequence", "photons", "and", "deviation", "paper"
    )?;
    for d in study.deviations() {
        let [sequence, _] = d.sequences;
        let paper = paper(sequence, d.photons).map_or("-".to_string(), |p| format!("{p:.2e}"));
        let [few, many] = d.photons.map(grouped);
        writeln!(out, "  {:<24} {few:>11} {many:>11}  {:<22} {paper:>8}", title(sequence), value(d.value))?;
    }
    let [few, many] = last_pair(study);
    writeln!(out, "\nrandom against the others, {} and {} photons", grouped(few), grouped(many))?;
    for sequence in 1..SEQUENCES.len() {
        writeln!(
            out,
            "  {:<24} {:<13} {}",
            title(sequence),
            ratio(study.ratio_to_random(sequence)),
            paper_ratio(sequence, [few, many])
        )?;
    }
    writeln!(out, "\ndeviation between sequences, {} photons", grouped(many))?;
    for b in study.between() {
        let [first, second] = b.sequences;
        writeln!(
            out,
            "  {:<24} {:<24} {:<22} {:>8}",
            title(first),
            title(second),
            value(b.value),
            paper_between(first, second, many).map_or("-".to_string(), |p| format!("{p:.2e}"))
        )?;
    }
    writeln!(out, "\nerror of the luminance against the other sequences' {} photons", grouped(many))?;
    writeln!(
        out,
        "  {:<24} {:>11} {:>10} {:>7} {:>9} {:>9} {:>12}",
        "sequence", "photons", "nRMS %", "rate", "equal N", "time", "photons/s"
    )?;
    for row in study.rows() {
        writeln!(
            out,
            "  {:<24} {:>11} {:>10} {:>7} {:>9} {:>9} {:>12}",
            title(row.sequence),
            grouped(row.photons),
            format!("{}{}", rounded(100.0 * row.errors.nrms, 3), if row.is_limited() { "*" } else { "" }),
            known(row.rate),
            known(Some(row.ratio_equal_n)),
            known(row.ratio_equal_time),
            grouped(row.photons_per_s as u64)
        )?;
    }
    writeln!(out, "  * less than three times the error that the reference is expected to have itself")?;
    if !study.is_closed() {
        writeln!(out, "\nwarning: photons left the scene; it is not closed")?;
    }
    Ok(())
}

fn last_pair(study: &RoomStudy) -> [u64; 2] {
    let ladder = &study.options.ladder;
    [ladder[ladder.len() - 2], ladder[ladder.len() - 1]]
}

fn ratio(value: Value) -> String {
    match value.spread {
        Some(spread) => format!("{:.2} +- {spread:.2}", value.mean),
        None => format!("{:.2}", value.mean),
    }
}

fn paper_ratio(sequence: usize, pair: [u64; 2]) -> String {
    match (paper(0, pair), paper(sequence, pair)) {
        (Some(random), Some(other)) => format!("(paper {:.1})", random / other),
        _ => String::new(),
    }
}

fn paper_between(first: usize, second: usize, photons: u64) -> Option<f64> {
    let same = |e: &&(usize, usize, f64)| (e.0, e.1) == (first, second) && photons == PAPER_MASTER;
    PAPER_BETWEEN.iter().find(same).map(|e| e.2)
}

/// The tables as Markdown, with the command that makes them.
pub fn markdown(study: &RoomStudy, command: &str) -> String {
    let mut out = String::new();
    let _infallible = write_markdown(&mut out, study, command);
    out
}

fn write_markdown(out: &mut String, study: &RoomStudy, command: &str) -> std::fmt::Result {
    writeln!(out, "# Sequences in a room\n")?;
    writeln!(out, "`{command}`, caustix {}.\n", env!("CARGO_PKG_VERSION"))?;
    writeln!(
        out,
        "The experiment of S. Heinrich and A. Keller (1994), section 5, in a scene of our own: {} triangles, every photon \
         reflected exactly {} times, its weight by channel added at each of its {} arrivals, {} coordinates. Scene \
         {}, SHA-256 `{}`.\n",
        study.areas_m2.len(),
        study.reflections,
        study.reflections + 1,
        2 * study.reflections + 4,
        study.scene_name,
        study.scene_sha256
    )?;
    writeln!(
        out,
        "A deviation is sqrt(sum A d^2 / sum A) over the triangles, d the distance of two colours, in units of the \
         greatest channel of the better estimate. Random points: mean and standard deviation over the seeds {:?}; the \
         first N of one seed are part of its first 10 N.\n",
        study.options.seeds
    )?;
    for sequence in 0..SEQUENCES.len() {
        write_deviations(out, study, sequence)?;
    }
    write_ratios(out, study)?;
    write_between(out, study)?;
    write_errors(out, study)
}

/// One of the paper's tables 2 to 5.
fn write_deviations(out: &mut String, study: &RoomStudy, sequence: usize) -> std::fmt::Result {
    let ladder = &study.options.ladder;
    let few = &ladder[..ladder.len() - 1];
    writeln!(out, "## {}: between numbers of photons\n", title(sequence))?;
    write!(out, "| N |")?;
    few.iter().try_for_each(|n| write!(out, " {} |", grouped(*n)))?;
    writeln!(out, "\n|---|{}", "---|".repeat(few.len()))?;
    for many in 1..ladder.len() {
        write!(out, "| {} |", grouped(ladder[many]))?;
        for column in 0..few.len() {
            if column >= many {
                write!(out, " |")?;
                continue;
            }
            write!(out, " {}", value(study.deviation(sequence, column, many)))?;
            if let Some(p) = paper(sequence, [ladder[column], ladder[many]]) {
                write!(out, " (paper {p:.2e})")?;
            }
            write!(out, " |")?;
        }
        writeln!(out)?;
    }
    writeln!(out)
}

fn write_ratios(out: &mut String, study: &RoomStudy) -> std::fmt::Result {
    let [few, many] = last_pair(study);
    writeln!(out, "## Random against the others\n")?;
    writeln!(
        out,
        "Deviation of {} from {} photons, random over the other's:\n",
        grouped(few),
        grouped(many)
    )?;
    writeln!(out, "| sequence | ratio | paper |\n|---|---|---|")?;
    for sequence in 1..SEQUENCES.len() {
        let paper = match (paper(0, [few, many]), paper(sequence, [few, many])) {
            (Some(random), Some(other)) => format!("{:.1}", random / other),
            _ => "-".to_string(),
        };
        writeln!(out, "| {} | {} | {paper} |", title(sequence), ratio(study.ratio_to_random(sequence)))?;
    }
    writeln!(out)
}

/// The paper's table 6.
fn write_between(out: &mut String, study: &RoomStudy) -> std::fmt::Result {
    let [_, many] = last_pair(study);
    writeln!(out, "## Between sequences, {} photons\n", grouped(many))?;
    writeln!(out, "| | and | deviation | paper |\n|---|---|---|---|")?;
    for b in study.between() {
        let [first, second] = b.sequences;
        let paper = paper_between(first, second, many).map_or("-".to_string(), |p| format!("{p:.2e}"));
        writeln!(out, "| {} | {} | {} | {paper} |", title(first), title(second), value(b.value))?;
    }
    writeln!(out)
}

fn write_errors(out: &mut String, study: &RoomStudy) -> std::fmt::Result {
    let [_, many] = last_pair(study);
    writeln!(out, "## Errors\n")?;
    writeln!(
        out,
        "nRMS of the luminance against the mean of the other low-discrepancy sequences at {} photons (never the sequence \
         itself). Errors marked * are less than three times what that reference is expected to be off by itself; rates \
         leave them out. Ratios: the random sequence's error over this one's, with as many photons, and after as \
         much time.\n",
        grouped(many)
    )?;
    writeln!(
        out,
        "| sequence | photons | nRMS % | reference's own % | rate | at equal N | at equal time | photons/s | coordinates |"
    )?;
    writeln!(out, "|---|---|---|---|---|---|---|---|---|")?;
    for row in study.rows() {
        writeln!(
            out,
            "| {} | {} | {}{} | {} | {} | {} | {} | {} | {} |",
            title(row.sequence),
            grouped(row.photons),
            with_spread(&row),
            if row.is_limited() { "*" } else { "" },
            rounded(100.0 * row.reference_nrms, 2),
            known(row.rate),
            known(Some(row.ratio_equal_n)),
            known(row.ratio_equal_time),
            grouped(row.photons_per_s as u64),
            rounded(row.coordinates, 4)
        )?;
    }
    if !study.is_closed() {
        writeln!(out, "\n**Photons left the scene: it is not closed.**")?;
    }
    Ok(())
}

fn with_spread(row: &Row) -> String {
    let error = rounded(100.0 * row.errors.nrms, 3);
    row.nrms_spread.map_or(error.clone(), |s| format!("{error} +- {}", rounded(100.0 * s, 2)))
}

/// One row for each sequence and number of photons, with the header of every `compare.csv`; errors are fractions, empty
/// where unknown.
pub fn csv(study: &RoomStudy) -> String {
    let mut out =
        "variant,photons,cells,relative_rms,nrms,relative_l1,nrms_spread,photons_per_s,coordinates,rate,\
                   ratio_equal_n,ratio_equal_time\n"
            .to_string();
    let optional = |v: Option<f64>| v.filter(|v| v.is_finite()).map(|v| v.to_string()).unwrap_or_default();
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
            optional(row.nrms_spread),
            row.photons_per_s,
            row.coordinates,
            optional(row.rate),
            row.ratio_equal_n,
            optional(row.ratio_equal_time)
        );
    }
    out
}

/// One row for each deviation: of two numbers of photons of one sequence, then of two sequences.
pub fn deviations_csv(study: &RoomStudy) -> String {
    let mut out = "first,first_photons,second,second_photons,deviation,spread,paper\n".to_string();
    let optional = |v: Option<f64>| v.map(|v| v.to_string()).unwrap_or_default();
    let mut row = |[first, second]: [usize; 2], pair: [u64; 2], v: Value, paper: Option<f64>| {
        let [a, b] = [first, second].map(|s| SEQUENCES[s].name());
        let (spread, paper) = (optional(v.spread), optional(paper));
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

/// Writes `compare.csv`, `compare.md` and `deviations.csv` into a directory that exists: names of those written, and
/// what went wrong with the others.
pub fn write_files(study: &RoomStudy, command: &str, directory: &Path) -> (Vec<String>, Vec<Diagnostic>) {
    let (mut written, mut errors) = (Vec::new(), Vec::new());
    for (name, content) in [
        ("compare.csv", csv(study)),
        ("compare.md", markdown(study, command)),
        ("deviations.csv", deviations_csv(study)),
    ] {
        let result: Result<()> = write_atomically(directory.join(name), |file| {
            std::io::Write::write_all(file, content.as_bytes())
        });
        match result {
            Ok(()) => written.push(name.to_string()),
            Err(e) => errors.push(e),
        }
    }
    (written, errors)
}
