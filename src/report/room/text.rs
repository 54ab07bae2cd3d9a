//! The tables for a terminal.

use std::fmt::Write;

use crate::lab::room::{RoomStudy, SEQUENCES};
use crate::report::numbers::{grouped, rounded, written};

use super::paper::{between, known, last_pair, mark, paper, paper_ratio, printed, ratio, title, value};

/// The tables for a terminal.
pub fn text(study: &RoomStudy) -> String {
    written(|out| {
        writeln!(out, "scene      {}", study.scene_name)?;
        let ladder: Vec<String> = study.options.ladder.iter().map(|n| grouped(*n)).collect();
        let (ladder, reflections, triangles) = (ladder.join(", "), study.reflections, study.areas_m2.len());
        writeln!(
            out,
            "photons    {ladder}; exactly {reflections} reflections each, no roulette; {triangles} triangles"
        )?;
        write_deviations(out, study)?;
        write_errors(out, study)?;
        if !study.is_closed() {
            writeln!(out, "\nwarning: photons left the scene; it is not closed")?;
        }
        Ok(())
    })
}

fn write_deviations(out: &mut String, study: &RoomStudy) -> std::fmt::Result {
    writeln!(out, "\ndeviation between two numbers of photons of a sequence")?;
    let mut line = |[a, b, c, d, e]: [&str; 5]| writeln!(out, "  {a:<24} {b:>11} {c:>11}  {d:<22} {e:>8}");
    line(["sequence", "photons", "and", "deviation", "paper"])?;
    for d in study.deviations() {
        let ([sequence, _], [few, many]) = (d.sequences, d.photons.map(grouped));
        let paper = printed(paper(sequence, d.photons));
        line([title(sequence), &few, &many, &value(d.value), &paper])?;
    }
    let [few, many] = last_pair(study);
    writeln!(out, "\nrandom against the others, {} and {} photons", grouped(few), grouped(many))?;
    for sequence in 1..SEQUENCES.len() {
        let paper = paper_ratio(sequence, [few, many]).map_or(String::new(), |p| format!("(paper {p})"));
        let ratio = ratio(study.ratio_to_random(sequence));
        writeln!(out, "  {:<24} {ratio:<13} {paper}", title(sequence))?;
    }
    writeln!(out, "\ndeviation between sequences, {} photons", grouped(many))?;
    for [first, second, value, paper] in between(study) {
        writeln!(out, "  {first:<24} {second:<24} {value:<22} {paper:>8}")?;
    }
    Ok(())
}

fn write_errors(out: &mut String, study: &RoomStudy) -> std::fmt::Result {
    let [_, many] = last_pair(study);
    writeln!(out, "\nerror of the luminance against the other sequences' {} photons", grouped(many))?;
    let mut line = |[a, b, c, d, e, f, g]: [&str; 7]| {
        writeln!(out, "  {a:<24} {b:>11} {c:>10} {d:>7} {e:>9} {f:>9} {g:>12}")
    };
    line(["sequence", "photons", "nRMS %", "rate", "equal N", "time", "photons/s"])?;
    for row in study.rows() {
        line([
            title(row.sequence),
            &grouped(row.photons),
            &format!("{}{}", rounded(100.0 * row.errors.nrms, 3), mark(&row)),
            &known(row.rate),
            &known(Some(row.ratio_equal_n)),
            &known(row.ratio_equal_time),
            &grouped(row.photons_per_s as u64),
        ])?;
    }
    writeln!(out, "  * less than three times the error that the reference is expected to have itself")
}
