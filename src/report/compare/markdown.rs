//! compare.md: the study with everything needed to judge and to repeat it.

use crate::lab::study::results::Study;
use crate::lab::study::table::{TARGET_ERROR, Table};
use crate::report::numbers::{grouped, list, three_digits};

use super::numbers::{DAGGERS, UNKNOWN, known};
use super::remarks::{cells, footnotes, own_errors, reference, seeds, shown_photons, warnings};

/// The study as a Markdown document.
pub fn markdown(study: &Study, table: &Table) -> String {
    let mut out = opening(study);
    match shown_photons(study, table) {
        None => out.push_str("\nNo run is finished.\n"),
        Some(photons) => {
            for (g, grid) in study.grids.iter().enumerate() {
                out.push_str(&format!("\n## {} photons on {} cells\n\n", grouped(photons), cells(*grid)));
                out.push_str(&errors_at(study, table, photons, g));
            }
            out.push_str("\n## Coordinates and speed\n\n");
            out.push_str(&costs(study, table, photons));
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
    let names: Vec<String> = study.receivers.iter().map(|r| plain(r)).collect();
    let ladder: Vec<String> = study.ladder.iter().map(|&n| photons_in_short(n)).collect();
    let mut out = format!(
        "# Algorithm variants on {}\n\n    {}\n\n",
        plain(&study.scene_name),
        unbroken(&study.command)
    );
    out.push_str(&format!(
        "- Scene: {}, SHA-256 `{}`; receivers: {}; cells along a side: {}\n",
        plain(&study.scene_name),
        one_line(&study.scene_sha256),
        list(&names),
        list(&study.grids.iter().map(u32::to_string).collect::<Vec<_>>()),
    ));
    out.push_str(&format!(
        "- Photons: N = {} asked for; measured at {}; {}, one set of N points each; {} threads; caustix {}\n",
        grouped(study.asked_photons),
        list(&ladder),
        seeds(study),
        study.threads,
        plain(&study.caustix_version)
    ));
    out.push_str(&format!("- Reference: {}\n", plain(&reference(study))));
    out.push_str(&format!("- The reference's own nRMS, from its replicates: {}\n\n", own_errors(study)));
    for variant in &study.variants {
        out.push_str(&format!("- `{}`: {}\n", one_line(&variant.name), plain(&variant.description)));
    }
    out
}

/// The errors of every variant at one N on one grid.
fn errors_at(study: &Study, table: &Table, photons: u64, grid: usize) -> String {
    let paper = study.variants.iter().any(|v| study.paper_ratio(&v.name).is_some());
    let mut head = vec!["variant", "nRMS, %", "of mc"];
    head.extend(paper.then_some("paper: of mc"));
    head.extend(["relative RMS, %", "relative L1, %", "rate", "mc's error over its own, equal N"]);
    head.extend(paper.then_some("paper's"));
    let time_to = format!("CPU s to {} %", 100.0 * TARGET_ERROR);
    head.extend(["the same, equal time", time_to.as_str()]);
    let mut body = Vec::new();
    for (v, variant) in study.variants.iter().enumerate() {
        let Some(row) = table.row(v, photons, grid) else { continue };
        let trend = &table.trends[v][grid];
        let of_paper = study.paper_ratio(&variant.name);
        let two = |value: Option<f64>| value.map_or(UNKNOWN.to_owned(), |value| format!("{value:.2}"));
        let mut line = vec![
            format!("`{}`", one_line(&variant.name)),
            DAGGERS.error(row),
            known(row.ratio_equal_n.map(|r| 1.0 / r)),
        ];
        line.extend(paper.then(|| two(of_paper.map(|r| 1.0 / r))));
        line.push(three_digits(100.0 * row.errors.relative_rms));
        line.push(three_digits(100.0 * row.errors.relative_l1));
        line.push(DAGGERS.rate(trend.law.as_ref(), trend.limited_by_reference));
        line.push(known(row.ratio_equal_n));
        line.extend(paper.then(|| two(of_paper)));
        line.push(DAGGERS.prediction(row.ratio_equal_time));
        line.push(DAGGERS.prediction(trend.time_to_target));
        body.push(line);
    }
    pipes(&head, &body)
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
    let mut body = Vec::new();
    for (v, variant) in study.variants.iter().enumerate() {
        let measured = table.rows.iter().find(|r| (r.variant, r.photons) == (v, photons));
        let most = variant.runs.iter().map(|run| run.coordinates_max).max();
        let account = |of: fn(&crate::lab::study::results::Account) -> f64| {
            variant.account.as_ref().map(of).map_or(UNKNOWN.to_owned(), |c| format!("{c:.4}"))
        };
        body.push(vec![
            format!("`{}`", one_line(&variant.name)),
            measured.map_or(UNKNOWN.to_owned(), |r| format!("{:.4}", r.coordinates)),
            most.map_or(UNKNOWN.to_owned(), |most| most.to_string()),
            account(|a| a.by_event),
            account(|a| a.equation_4),
            account(|a| a.equation_6),
            known(table.photons_per_cpu_s[v].map(|s| s / 1e6)),
        ]);
    }
    let mut out = pipes(&head, &body);
    out.push_str(
        "\nA coordinate is counted when it is drawn, and the event account adds up what every event draws; an event with one \
         possible outcome draws none. (4), D = 3 + B_s + 3 B_d + C, and (6), D' <= 2 + 2 B_d + C, are the paper's counts for \
         B_s specular and B_d other scatterings, C = 1 if the photon escapes and 2 if it is absorbed: (4) without, (6) with \
         renormalisation. Rejection draws as often as it must, which neither of them counts.\n",
    );
    out
}

/// nRMS of every variant, a line an N.
fn errors_against_photons(study: &Study, table: &Table, grid: usize) -> String {
    let names: Vec<String> = study.variants.iter().map(|v| format!("`{}`", one_line(&v.name))).collect();
    let head: Vec<&str> = ["N"].into_iter().chain(names.iter().map(String::as_str)).collect();
    let body: Vec<Vec<String>> = table
        .ladder()
        .into_iter()
        .map(|photons| {
            let errors = (0..names.len())
                .map(|v| table.row(v, photons, grid).map_or(UNKNOWN.to_owned(), |row| DAGGERS.error(row)));
            [photons_in_short(photons)].into_iter().chain(errors).collect()
        })
        .collect();
    pipes(&head, &body)
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
    if study.variants.iter().any(|v| study.paper_ratio(&v.name).is_some()) {
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
    let rule: Vec<&str> = (0..head.len()).map(|c| if c == 0 { "---" } else { "---:" }).collect();
    let mut out = format!("| {} |\n| {} |\n", head.join(" | "), rule.join(" | "));
    for line in body {
        out.push_str(&format!("| {} |\n", line.join(" | ")));
    }
    out
}

/// "2^22", or digits for what is no power of two.
fn photons_in_short(photons: u64) -> String {
    if photons >= 1024 && photons.is_power_of_two() {
        format!("2^{}", photons.trailing_zeros())
    } else {
        grouped(photons)
    }
}

/// Text from outside on one line.
fn unbroken(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Text from outside between backticks, in a table's cell: nothing that ends either.
fn one_line(text: &str) -> String {
    unbroken(text).replace('`', "'").replace('|', "/")
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
