//! Photometric files as tables: the candela of one, and several in a row each.

use crate::photometry::{Photometry, Summary};

use super::numbers::{bare, printable, quoted};

/// The candela table of a file as CSV: a row for each V, a column for each H, as they are stored; value x
/// multiplier, divided by
/// `per`: 1 for candela, the thousands of lumens for candela per 1000 lm.
pub fn candela_csv(photometry: &Photometry, per: f64) -> String {
    let web = &photometry.web;
    let n_v = web.vertical_deg.len();
    let mut out = String::from("vertical_deg");
    web.horizontal_deg.iter().for_each(|h| out.push_str(&format!(",{h}")));
    out.push('\n');
    for (i, v) in web.vertical_deg.iter().enumerate() {
        out.push_str(&v.to_string());
        let plane = |h: usize| web.candela[h * n_v + i] / per;
        (0..web.horizontal_deg.len()).for_each(|h| out.push_str(&format!(",{}", plane(h))));
        out.push('\n');
    }
    out
}

/// The head of [`row_csv`].
pub const CSV_HEAD: &str = "file,format,revision,photometric_type,symmetry,flux_lm,flux_with_factors_lm,flux_emitted_lm,\
    flux_declared_lm,light_output_ratio,downward_percent,max_candela,max_vertical_deg,max_horizontal_deg,\
    max_candela_per_klm,beam_angle_deg,beam_angle_across_deg,beam_angle_at_max_deg,field_angle_deg,\
    field_angle_across_deg,field_angle_at_max_deg,input_watts,efficacy_lm_w,warnings\n";

/// A file as a row of CSV; empty where a number is not given.
pub fn row_csv(s: &Summary) -> String {
    let number = |value: f64| bare(Some(value));
    let words = [
        quoted(&s.file),
        s.format.to_owned(),
        s.revision.unwrap_or_default().to_owned(),
        s.photometric_type.to_owned(),
        s.symmetry.to_owned(),
        number(s.flux_lm),
        number(s.flux_with_factors_lm),
        number(s.flux_emitted_lm),
        bare(s.flux_declared_lm),
        bare(s.light_output_ratio),
        bare(s.sheet.downward_percent),
        number(s.max_candela),
        number(s.max_at.vertical_deg),
        number(s.max_at.horizontal_deg),
        bare(s.sheet.max_candela_per_klm),
        bare(s.beam_angle_deg),
        bare(s.beam_angle_across_deg),
        bare(s.sheet.beam_angle_at_max_deg),
        bare(s.field_angle_deg),
        bare(s.field_angle_across_deg),
        bare(s.sheet.field_angle_at_max_deg),
        number(s.input_watts),
        bare(s.efficacy_lm_w),
        s.warnings.len().to_string(),
    ];
    words.join(",") + "\n"
}

/// Several files, a row each, columns aligned.
pub fn table(summaries: &[Summary]) -> String {
    let head = [
        "file",
        "flux lm",
        "max cd",
        "beam deg",
        "across",
        "at max",
        "field deg",
        "across",
        "LOR %",
        "W",
        "lm/W",
    ];
    let mut rows = vec![head.map(str::to_owned)];
    let one = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.1}"));
    rows.extend(summaries.iter().map(|s| {
        [
            printable(&s.file),
            format!("{:.1}", s.flux_lm),
            format!("{:.1}", s.max_candela),
            one(s.beam_angle_deg),
            one(s.beam_angle_across_deg),
            one(s.sheet.beam_angle_at_max_deg),
            one(s.field_angle_deg),
            one(s.field_angle_across_deg),
            one(s.light_output_ratio.map(|ratio| 100.0 * ratio)),
            one((s.input_watts > 0.0).then_some(s.input_watts)),
            one(s.efficacy_lm_w),
        ]
    }));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let told = |row: &[String; 11]| {
        let numbers = row.iter().zip(&widths).skip(1).map(|(word, width)| format!("  {word:>width$}"));
        format!("{:<first$}{}\n", row[0], numbers.collect::<String>(), first = widths[0])
    };
    rows.iter().map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::photometric;

    const SMALL: &str =
        "IESNA91\nTILT=NONE\n2 100 2 3 2 1 2 0 0 0\n0.5 0.9 10\n0 40 90\n0 90\n100 0 0\n100 50 0.25\n";

    #[test]
    fn the_candela_table_has_a_row_for_each_vertical_angle() {
        let photometry = photometric::parse(SMALL.as_bytes(), "small.ies").unwrap();
        assert_eq!(candela_csv(&photometry, 1.0), "vertical_deg,0,90\n0,200,200\n40,0,100\n90,0,0.5\n");
        assert_eq!(candela_csv(&photometry, 0.2), "vertical_deg,0,90\n0,1000,1000\n40,0,500\n90,0,2.5\n");
    }

    #[test]
    fn several_files_have_a_row_each() {
        let summary = |name: &str| Summary::new(&photometric::parse(SMALL.as_bytes(), name).unwrap());
        let (a, b) = (summary("a.ies"), summary("b, \"c\".ies"));
        let table = table(&[a.clone(), b.clone()]);
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines.iter().all(|line| line.len() == lines[0].len()), "{table}");
        let words: Vec<&str> = lines[1].split_whitespace().collect();
        // A cone in C0-C180: half at 20 degrees; in C90-C270 200 at 0, 100 at 40.
        assert_eq!((words[0], words[2], words[3], words[4]), ("a.ies", "200.0", "40.0", "80.0"));
        assert_eq!(CSV_HEAD.trim().split(',').count(), row_csv(&a).trim().split(',').count());
        assert!(
            row_csv(&b).starts_with("\"b, \"\"c\"\".ies\",IES LM-63,1991,C,quadrants,"),
            "{}",
            row_csv(&b)
        );
    }
}
