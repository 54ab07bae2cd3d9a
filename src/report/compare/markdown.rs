//! compare.md: the study with everything needed to judge and to repeat it.

use crate::lab::study::results::{Study, VariantResult};
use crate::lab::study::table::Table;
use crate::report::numbers::{grouped, names, piped, printable, three_digits};

use super::numbers::{Column, DAGGERS, UNKNOWN, filled, known, of_paper};
use super::remarks::{cells, footnotes, own_errors, reference, seeds, shown_photons, warnings};

/// What is shown of a variant at one N on one grid.
const ERRORS: [Column; 11] = [
    ("variant", |l| code(&l.variant.name)),
    ("nRMS, %", |l| DAGGERS.error(l.row)),
    ("of mc", |l| known(l.row.ratio_equal_n.map(|r| 1.0 / r))),
    ("paper: of mc", |l| of_paper(l.paper.map(|r| 1.0 / r))),
    ("relative RMS, %", |l| three_digits(100.0 * l.row.errors.relative_rms)),
    ("relative L1, %", |l| three_digits(100.0 * l.row.errors.relative_l1)),
    ("rate", |l| DAGGERS.rate(l.trend)),
    ("mc's error over its own, equal N", |l| known(l.row.ratio_equal_n)),
    ("paper's", |l| of_paper(l.paper)),
    ("the same, equal time", |l| DAGGERS.prediction(l.row.ratio_equal_time)),
    ("CPU s to 1 %", |l| DAGGERS.prediction(l.trend.time_to_target)),
];

/// The study as a Markdown document.
pub fn markdown(study: &Study, table: &Table) -> String {
    let mut out = opening(study);
    match shown_photons(study, table) {
        None => out.push_str("\nNo run is finished.\n"),
        Some(photons) => {
            for (g, grid) in study.grids.iter().enumerate() {
                let (head, body) = filled(&ERRORS, study, table, photons, g);
                out += &format!("\n## {} photons on {} cells\n\n", grouped(photons), cells(*grid));
                out += &pipes(&head, &body);
            }
            out += "\n## Coordinates and speed\n\n";
            out += &costs(study, table, photons);
        }
    }
    for (g, grid) in study.grids.iter().enumerate() {
        out.push_str(&format!("\n## nRMS in % against N on {} cells\n\n", cells(*grid)));
        out.push_str(&errors_against_photons(study, table, g));
    }
    out.push_str(&closing(study, table));
    out
}

/// What was done, by which command, against which reference.
fn opening(study: &Study) -> String {
    let (scene, command, hash) =
        (plain(&study.scene_name), printable(&study.command), one_line(&study.scene_sha256));
    let receivers = names(study.receivers.iter().map(|r| plain(r)), usize::MAX);
    let grids = names(study.grids.iter().map(u32::to_string), usize::MAX);
    let (asked, ladder) =
        (grouped(study.asked_photons), names(study.ladder.iter().map(photons_in_short), usize::MAX));
    let (seeds, threads, version) = (seeds(study), study.threads, plain(&study.caustix_version));
    let (reference, own_errors) = (plain(&reference(study)), own_errors(study));
    let mut out = format!(
        "# Algorithm variants on {scene}\n\n    {command}\n\n\
         - Scene: {scene}, SHA-256 `{hash}`; receivers: {receivers}; cells along a side: {grids}\n\
         - Photons: N = {asked} asked for; measured at {ladder}; {seeds}, one set of N points each; {threads} threads; \
         caustix {version}\n\
         - Reference: {reference}\n\
         - The reference's own nRMS, from its replicates: {own_errors}\n\n"
    );
    for variant in &study.variants {
        out += &format!("- {}: {}\n", code(&variant.name), plain(&variant.description));
    }
    out
}

/// What a photon costs: coordinates beside three other counts of them, and time.
fn costs(study: &Study, table: &Table, photons: u64) -> String {
    let head = [
        "variant",
        "coordinates, measured",
        "at most",
        "by the event account",
        "eq. (4)",
        "eq. (6)",
        "Mphotons per CPU s",
    ];
    let of_variant = |(v, variant): (usize, &VariantResult)| {
        let four = |count: Option<f64>| count.map_or(UNKNOWN.to_owned(), |c| format!("{c:.4}"));
        let measured = table.rows.iter().find(|r| (r.variant, r.photons) == (v, photons));
        let most = variant.runs.iter().map(|run| run.coordinates_max).max();
        let account = variant.account.as_ref();
        vec![
            code(&variant.name),
            four(measured.map(|r| r.coordinates)),
            most.map_or(UNKNOWN.to_owned(), |most| most.to_string()),
            four(account.map(|a| a.by_event)),
            four(account.map(|a| a.equation_4)),
            four(account.map(|a| a.equation_6)),
            known(table.photons_per_cpu_s[v].map(|s| s / 1e6)),
        ]
    };
    let body: Vec<Vec<String>> = study.variants.iter().enumerate().map(of_variant).collect();
    pipes(&head, &body)
        + "\nA coordinate is counted when it is drawn, and the event account adds up what every event draws; an event with \
           one possible outcome draws none. (4), D = 3 + B_s + 3 B_d + C, and (6), D' <= 2 + 2 B_d + C, are the paper's \
           counts for B_s specular and B_d other scatterings, C = 1 if the photon escapes and 2 if it is absorbed: (4) \
           without, (6) with renormalisation. Rejection draws as often as it must, which neither of them counts.\n"
}

/// nRMS of every variant, a line an N.
fn errors_against_photons(study: &Study, table: &Table, grid: usize) -> String {
    let names: Vec<String> = study.variants.iter().map(|v| code(&v.name)).collect();
    let head: Vec<&str> = ["N"].into_iter().chain(names.iter().map(String::as_str)).collect();
    let line = |photons: u64| {
        let row = |v: usize| table.row(v, photons, grid);
        let errors = (0..names.len()).map(|v| row(v).map_or(UNKNOWN.to_owned(), |row| DAGGERS.error(row)));
        [photons_in_short(&photons)].into_iter().chain(errors).collect()
    };
    pipes(&head, &table.ladder().into_iter().map(line).collect::<Vec<_>>())
}

/// Warnings, and what the columns and marks mean.
fn closing(study: &Study, table: &Table) -> String {
    let mut out = String::new();
    let warnings = warnings(study, table);
    if !warnings.is_empty() {
        out.push_str("\n## Warnings\n\n");
        for warning in warnings {
            out.push_str(&format!("- {}\n", plain(&warning)));
        }
    }
    out.push_str(
        "\n## Notes\n\n\
         - nRMS = sqrt( mean (E - E\\*)² ) / mean E\\*, relative RMS = sqrt( sum A (E - E\\*)² / sum A E\\*² ), relative L1 = sum A |E - \
         E\\*| / sum A E\\*, with E the estimated and E\\* the reference illuminance of a cell of area A, means weighted by A. Root mean \
         square over the seeds, of relative L1 the mean.\n\
         - +- behind an error is its standard deviation over the seeds, behind a rate its standard error.\n\
         - Rate: nRMS falls like N^rate; the mean slope of the seeds, each fitted by least squares in logarithms to its \
         powers of two, where there are two of them.\n\
         - Equal time: nRMS of `mc` after the CPU time of the variant's run, by the fitted law of `mc`, over the variant's. \
         Speed and time are CPU time over all threads, from runs with the largest N.\n",
    );
    if study.is_of_paper() {
        out.push_str(
            "- The paper's ratios are for 4 456 448 photons, its own scene and cells, and a norm that it does not state.\n",
        );
    }
    for note in footnotes(table, &DAGGERS) {
        out.push_str(&format!("- {note}\n"));
    }
    out
}

/// A table: the first column to the left, numbers to the right.
fn pipes(head: &[&str], body: &[Vec<String>]) -> String {
    let rule = (0..head.len()).map(|c| if c == 0 { "---" } else { "---:" });
    piped(head) + &piped(rule) + &body.iter().map(piped).collect::<String>()
}

/// "2^22", or digits for what is no power of two.
fn photons_in_short(&photons: &u64) -> String {
    if photons >= 1024 && photons.is_power_of_two() {
        format!("2^{}", photons.trailing_zeros())
    } else {
        grouped(photons)
    }
}

/// Text from outside between backticks, in a table's cell: nothing that ends either.
fn one_line(text: &str) -> String {
    printable(text).replace('`', "'").replace('|', "/")
}

fn code(name: &str) -> String {
    format!("`{}`", one_line(name))
}

/// Text from outside as it is, whatever marks it contains.
fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '#' | '&' => out.extend(['\\', c]),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
