//! The tables as Markdown.

use std::fmt::Write;

use crate::lab::room::{RoomStudy, Row, SEQUENCES};
use crate::report::numbers::{grouped, piped, rounded, written};

use super::paper::{between, known, last_pair, mark, paper, paper_ratio, ratio, title, value};

/// The tables as Markdown, with the command that makes them.
pub fn markdown(study: &RoomStudy, command: &str) -> String {
    written(|out| write_markdown(out, study, command))
}

fn write_markdown(out: &mut String, study: &RoomStudy, command: &str) -> std::fmt::Result {
    let RoomStudy { scene_name, scene_sha256, reflections, areas_m2, options, .. } = study;
    let (triangles, seeds, [few, many]) = (areas_m2.len(), &options.seeds, last_pair(study).map(grouped));
    let (arrivals, coordinates) = (reflections + 1, 2 * reflections + 4);
    writeln!(out, "# Sequences in a room\n")?;
    writeln!(out, "`{command}`, caustix {}.\n", env!("CARGO_PKG_VERSION"))?;
    writeln!(
        out,
        "The experiment of S. Heinrich and A. Keller (1994), section 5, in a scene of our own: {triangles} triangles, \
         every photon reflected exactly {reflections} times, its weight by channel added at each of its {arrivals} \
         arrivals, {coordinates} coordinates. Scene {scene_name}, SHA-256 `{scene_sha256}`.\n"
    )?;
    writeln!(
        out,
        "A deviation is sqrt(sum A d^2 / sum A) over the triangles, d the distance of two colours, in units of the \
         greatest channel of the better estimate. Random points: mean and standard deviation over the seeds {seeds:?}; \
         the first N of one seed are part of its first 10 N.\n"
    )?;
    for sequence in 0..SEQUENCES.len() {
        writeln!(out, "## {}: between numbers of photons\n", title(sequence))?;
        writeln!(out, "{}", deviations(study, sequence))?;
    }
    writeln!(out, "## Random against the others\n")?;
    writeln!(out, "Deviation of {few} from {many} photons, random over the other's:\n")?;
    writeln!(out, "{}", ratios(study))?;
    writeln!(out, "## Between sequences, {many} photons\n")?;
    writeln!(out, "{}", table(&["", "and", "deviation", "paper"], between(study)))?;
    writeln!(out, "## Errors\n")?;
    writeln!(
        out,
        "nRMS of the luminance against the mean of the other low-discrepancy sequences at {many} photons (never the \
         sequence itself). Errors marked * are less than three times what that reference is expected to be off by \
         itself; rates leave them out. Ratios: the random sequence's error over this one's, with as many photons, and \
         after as much time.\n"
    )?;
    write!(out, "{}", errors(study))?;
    if !study.is_closed() {
        writeln!(out, "\n**Photons left the scene: it is not closed.**")?;
    }
    Ok(())
}

/// One of the paper's tables 2 to 5.
fn deviations(study: &RoomStudy, sequence: usize) -> String {
    let ladder = &study.options.ladder;
    let columns = ladder.len() - 1;
    let entry = |few: usize, many: usize| {
        if few >= many {
            return String::new();
        }
        let paper = paper(sequence, [ladder[few], ladder[many]]);
        let paper = paper.map_or(String::new(), |p| format!(" (paper {p:.2e})"));
        value(study.deviation(sequence, few, many)) + &paper
    };
    let head = ["N".to_owned()].into_iter().chain(ladder[..columns].iter().map(|n| grouped(*n)));
    let line = |many: usize| {
        let entries = (0..columns).map(|few| entry(few, many));
        [grouped(ladder[many])].into_iter().chain(entries).collect::<Vec<_>>()
    };
    table(&head.collect::<Vec<_>>(), (1..ladder.len()).map(line))
}

fn ratios(study: &RoomStudy) -> String {
    let line = |sequence: usize| {
        let paper = paper_ratio(sequence, last_pair(study)).unwrap_or_else(|| "-".to_string());
        [title(sequence).to_owned(), ratio(study.ratio_to_random(sequence)), paper]
    };
    table(&["sequence", "ratio", "paper"], (1..SEQUENCES.len()).map(line))
}

fn errors(study: &RoomStudy) -> String {
    let head = [
        "sequence",
        "photons",
        "nRMS %",
        "reference's own %",
        "rate",
        "at equal N",
        "at equal time",
        "photons/s",
        "coordinates",
    ];
    let line = |row: Row| {
        [
            title(row.sequence).to_owned(),
            grouped(row.photons),
            with_spread(&row) + mark(&row),
            rounded(100.0 * row.reference_nrms, 2),
            known(row.rate),
            known(Some(row.ratio_equal_n)),
            known(row.ratio_equal_time),
            grouped(row.photons_per_s as u64),
            rounded(row.coordinates, 4),
        ]
    };
    table(&head, study.rows().into_iter().map(line))
}

fn with_spread(row: &Row) -> String {
    let error = rounded(100.0 * row.errors.nrms, 3);
    row.nrms_spread.map_or(error.clone(), |s| format!("{error} +- {}", rounded(100.0 * s, 2)))
}

fn table(head: &[impl AsRef<str>], lines: impl Iterator<Item = impl IntoIterator<Item = String>>) -> String {
    piped(head) + "|" + &"---|".repeat(head.len()) + "\n" + &lines.map(piped).collect::<String>()
}
