//! The tables as Markdown.

use std::fmt::Write;

use crate::lab::room::{RoomStudy, Row, SEQUENCES};
use crate::report::numbers::{grouped, rounded, written};

use super::paper::{known, last_pair, mark, paper, paper_between, paper_ratio, printed, ratio, title, value};

/// The tables as Markdown, with the command that makes them.
pub fn markdown(study: &RoomStudy, command: &str) -> String {
    written(|out| write_markdown(out, study, command))
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
        let paper = paper_ratio(sequence, [few, many]).unwrap_or_else(|| "-".to_string());
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
        let paper = printed(paper_between(first, second, many));
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
            mark(&row),
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
