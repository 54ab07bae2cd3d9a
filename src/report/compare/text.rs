//! The table on the terminal, at most 110 columns wide.

use crate::lab::study::results::Study;
use crate::lab::study::table::Table;
use crate::report::numbers::{grouped, three_digits};

use super::numbers::{ASCII, Column, filled, known, of_paper};
use super::remarks::{cells, footnotes, own_errors, reference, seeds, shown_photons, warnings};

/// Widest line.
pub const WIDTH: usize = 110;
/// Narrowest that names of variants are cut to.
const NARROWEST_NAME: usize = 12;
const GAP: &str = "  ";

/// What is shown of a variant on a grid, heads in two lines.
const COLUMNS: [Column; 9] = [
    ("\nvariant", |l| l.variant.name.clone()),
    ("\nnRMS, %", |l| ASCII.error(l.row)),
    ("\nrate", |l| ASCII.rate(l.trend)),
    ("coordi-\nnates", |l| three_digits(l.row.coordinates)),
    ("Mphotons\n/ CPU s", |l| known(l.speed)),
    ("mc's error / own\nequal N", |l| known(l.row.ratio_equal_n)),
    ("\npaper", |l| of_paper(l.paper)),
    ("\nequal time", |l| ASCII.prediction(l.row.ratio_equal_time)),
    ("CPU s\nto 1 %", |l| ASCII.prediction(l.trend.time_to_target)),
];

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
                let (head, body) = filled(&COLUMNS, study, table, photons, g);
                lines.extend(aligned(&head, body));
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

/// Columns as wide as their widest entry, the first one to the left, the others to the right; names are cut if the whole
/// is too wide. A headline may reach over empty ones to its right.
fn aligned(head: &[&str], mut body: Vec<Vec<String>>) -> Vec<String> {
    let columns = head.len();
    let [above, below] = [0, 1].map(|i| head.iter().filter_map(|h| h.split('\n').nth(i)).collect::<Vec<_>>());
    (1..columns).for_each(|c| make_room_for_marks(&mut body, c));
    let widest = |c: usize| body.iter().map(|line| line[c].chars().count()).fold(below[c].len(), usize::max);
    let mut widths: Vec<usize> = (0..columns).map(widest).collect();
    let all = widths.iter().sum::<usize>() + GAP.len() * (columns - 1);
    if all > WIDTH {
        widths[0] = widths[0].saturating_sub(all - WIDTH).max(NARROWEST_NAME);
        body.iter_mut().for_each(|line| line[0] = cut(&line[0], widths[0]));
    }
    body.insert(0, below.into_iter().map(str::to_owned).collect());
    let entries = |line: &Vec<String>| {
        let padded = line.iter().zip(&widths).enumerate();
        let padded =
            padded.map(|(c, (text, &w))| if c == 0 { format!("{text:<w$}") } else { format!("{text:>w$}") });
        padded.collect::<Vec<_>>().join(GAP)
    };
    [headline(&above, &widths)].into_iter().chain(body.iter().map(entries)).collect()
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
fn headline(head: &[&str], widths: &[usize]) -> String {
    let mut line = String::new();
    let mut end = 0;
    let mut c = 0;
    while c < head.len() {
        let mut last = c;
        end += widths[c];
        while head[c].len() > widths[c] && last + 1 < head.len() && head[last + 1].is_empty() {
            last += 1;
            end += GAP.len() + widths[last];
        }
        let start = end.saturating_sub(head[c].len());
        line.push_str(&" ".repeat(start.saturating_sub(line.len())));
        line.push_str(head[c]);
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
