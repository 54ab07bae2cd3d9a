//! The table on the terminal, at most 110 columns wide.

use crate::lab::study::results::Study;
use crate::lab::study::table::Table;
use crate::report::numbers::{grouped, three_digits};

use super::numbers::{ASCII, UNKNOWN, known};
use super::remarks::{cells, footnotes, own_errors, reference, seeds, shown_photons, warnings};

/// Widest line.
pub const WIDTH: usize = 110;
/// Narrowest that names of variants are cut to.
const NARROWEST_NAME: usize = 12;
const GAP: &str = "  ";

/// The table, with what it was measured against, the meaning of its marks, and warnings.
pub fn text(study: &Study, table: &Table) -> String {
    let mut lines = Vec::new();
    wrap(&mut lines, "scene      ", &study.scene_name);
    wrap(&mut lines, "reference  ", &reference(study));
    wrap(&mut lines, "           ", &format!("its own nRMS: {}", own_errors(study)));
    wrap(&mut lines, "errors     ", &format!("nRMS of one set of N points, {}", seeds(study)));
    match shown_photons(study, table) {
        None => lines.push("\nno run is finished".to_owned()),
        Some(photons) => {
            for (g, grid) in study.grids.iter().enumerate() {
                lines.push(format!("\nN = {} on {} cells", grouped(photons), cells(*grid)));
                lines.extend(grid_table(study, table, photons, g));
            }
        }
    }
    let (notes, warned) = (footnotes(table, &ASCII), warnings(study, table));
    if !notes.is_empty() || !warned.is_empty() {
        lines.push(String::new());
    }
    for note in notes {
        wrap(&mut lines, "  ", &note);
    }
    for warning in warned {
        wrap(&mut lines, "warning: ", &warning);
    }
    lines.join("\n") + "\n"
}

/// One grid: a line a variant.
fn grid_table(study: &Study, table: &Table, photons: u64, grid: usize) -> Vec<String> {
    let paper = study.variants.iter().any(|v| study.paper_ratio(&v.name).is_some());
    let mut head =
        vec![["", "variant"], ["", "nRMS, %"], ["", "rate"], ["coordi-", "nates"], ["Mphotons", "/ CPU s"]];
    head.extend([["mc's error / own", "equal N"], ["", "equal time"], ["CPU s", "to 1 %"]]);
    if paper {
        head.insert(6, ["", "paper"]);
    }
    let mut body = Vec::new();
    for (v, variant) in study.variants.iter().enumerate() {
        let Some(row) = table.row(v, photons, grid) else { continue };
        let trend = &table.trends[v][grid];
        let speed = table.photons_per_cpu_s[v].map(|s| s / 1e6);
        let mut line = vec![
            variant.name.clone(),
            ASCII.error(row),
            ASCII.rate(trend.law.as_ref(), trend.limited_by_reference),
            three_digits(row.coordinates),
            known(speed),
            known(row.ratio_equal_n),
            ASCII.prediction(row.ratio_equal_time),
            ASCII.prediction(trend.time_to_target),
        ];
        if paper {
            line.insert(
                6,
                study.paper_ratio(&variant.name).map_or(UNKNOWN.to_owned(), |r| format!("{r:.2}")),
            );
        }
        body.push(line);
    }
    aligned(&head, body)
}

/// Columns as wide as their widest entry, the first one to the left, the others to the right; names are cut if the whole
/// is too wide. A headline may reach over empty ones to its right.
fn aligned(head: &[[&str; 2]], mut body: Vec<Vec<String>>) -> Vec<String> {
    let columns = head.len();
    (1..columns).for_each(|c| make_room_for_marks(&mut body, c));
    let widest = |c: usize, body: &[Vec<String>]| {
        let entries = body.iter().map(|line| line[c].chars().count());
        entries.chain([head[c][1].len()]).max().unwrap_or(0)
    };
    let mut widths: Vec<usize> = (0..columns).map(|c| widest(c, &body)).collect();
    let all = widths.iter().sum::<usize>() + GAP.len() * (columns - 1);
    if all > WIDTH {
        widths[0] = widths[0].saturating_sub(all - WIDTH).max(NARROWEST_NAME);
        for line in &mut body {
            line[0] = cut(&line[0], widths[0]);
        }
    }
    let mut lines = vec![headline(head, &widths)];
    let entries = |line: &[&str]| {
        let padded: Vec<String> = line
            .iter()
            .zip(&widths)
            .enumerate()
            .map(|(c, (text, &w))| if c == 0 { format!("{text:<w$}") } else { format!("{text:>w$}") })
            .collect();
        padded.join(GAP)
    };
    lines.push(entries(&head.iter().map(|h| h[1]).collect::<Vec<_>>()));
    lines.extend(body.iter().map(|line| entries(&line.iter().map(String::as_str).collect::<Vec<_>>())));
    lines
}

/// Spaces behind the numbers of a column that carry fewer marks than others, so that digits stand below each other.
fn make_room_for_marks(body: &mut [Vec<String>], column: usize) {
    let marks = |text: &str| text.len() - text.trim_end_matches(['*', '~', '^']).len();
    let most = body.iter().map(|line| marks(&line[column])).max().unwrap_or(0);
    for line in body {
        let missing = most - marks(&line[column]);
        line[column].push_str(&" ".repeat(missing));
    }
}

/// The upper of the two lines of heads: each at the right end of its column, or over it and the empty ones that follow.
fn headline(head: &[[&str; 2]], widths: &[usize]) -> String {
    let mut line = String::new();
    let mut end = 0;
    let mut c = 0;
    while c < head.len() {
        let mut last = c;
        end += widths[c];
        while head[c][0].len() > widths[c] && last + 1 < head.len() && head[last + 1][0].is_empty() {
            last += 1;
            end += GAP.len() + widths[last];
        }
        let start = end.saturating_sub(head[c][0].len());
        line.push_str(&" ".repeat(start.saturating_sub(line.len())));
        line.push_str(head[c][0]);
        end += GAP.len();
        c = last + 1;
    }
    line.trim_end().to_owned()
}

/// At most so many characters, the last one a full stop where something was cut.
fn cut(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    text.chars().take(width.saturating_sub(1)).chain(['.']).collect()
}

/// Appends text broken at spaces, further lines indented like the first; a word wider than a line is broken.
fn wrap(lines: &mut Vec<String>, label: &str, text: &str) {
    let indent = label.chars().count();
    let room = WIDTH - indent;
    let mut current = String::new();
    let mut label = label.to_owned();
    let mut flush = |current: &mut String| {
        lines.push(format!("{label}{current}").trim_end().to_owned());
        label = " ".repeat(indent);
        current.clear();
    };
    for word in text.split_whitespace() {
        let used = current.chars().count();
        if used > 0 && used + 1 + word.chars().count() > room {
            flush(&mut current);
        } else if used > 0 {
            current.push(' ');
        }
        for c in word.chars() {
            if current.chars().count() == room {
                flush(&mut current);
            }
            current.push(c);
        }
    }
    flush(&mut current);
}
