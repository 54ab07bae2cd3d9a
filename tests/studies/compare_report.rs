//! How a study is shown and kept, from made-up studies whose laws, ratios and limits are known.

use caustix::lab::study::fit::Uncertainty;
use caustix::lab::study::norms::Errors;
use caustix::lab::study::results::Study;
use caustix::lab::study::table::Table;
use caustix::plot::canvas::Anchor;
use caustix::plot::compare::drawing;
use caustix::plot::drawing::Shape;
use caustix::plot::font;
use caustix::report::compare::csv::{HEADER, csv};
use caustix::report::compare::markdown::markdown;
use caustix::report::compare::text::{WIDTH, text};

use crate::made_up::{ASKED, GRIDS, ladder, study};

#[test]
fn csv_reads_back_as_the_table() {
    let study = study(&ladder(), 4, 0.03);
    let table = Table::new(&study);
    let csv = csv(&study, &table);
    let mut lines = csv.lines();
    assert_eq!(
        lines.next().unwrap(),
        "variant,photons,cells,relative_rms,nrms,relative_l1,nrms_spread,photons_per_s,coordinates,rate,\
         ratio_equal_n,ratio_equal_time"
    );
    let lines: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!((lines.len(), table.rows.len()), (4 * 10 * 3, 4 * 10 * 3));
    for (line, row) in lines.iter().zip(&table.rows) {
        assert_eq!(line[0], study.variants[row.variant].name);
        assert_eq!((line[1], line[2]), (&*row.photons.to_string(), &*GRIDS[row.grid].to_string()));
        let numbers: Vec<f64> = line[3..].iter().map(|field| field.parse().unwrap()).collect();
        let expected = [
            row.errors.relative_rms,
            row.errors.nrms,
            row.errors.relative_l1,
            row.nrms_spread.unwrap(),
            table.photons_per_cpu_s[row.variant].unwrap(),
            row.coordinates,
            table.trends[row.variant][row.grid].law.unwrap().rate,
            row.ratio_equal_n.unwrap(),
            row.ratio_equal_time.unwrap().value,
        ];
        assert_eq!(numbers, expected, "every bit");
    }
    let mut odd = study;
    odd.variants[1].name = "qmc, \"odd\"".into();
    assert!(caustix::report::compare::csv::csv(&odd, &table).contains("\n\"qmc, \"\"odd\"\"\",16384,48,"));
}

#[test]
fn what_is_unknown_is_empty() {
    let field = |study: &Study, column: &str| -> Vec<String> {
        let index = HEADER.split(',').position(|name| name == column).unwrap();
        let csv = csv(study, &Table::new(study));
        csv.lines().skip(1).map(|line| line.split(',').nth(index).unwrap().to_owned()).collect()
    };
    let all =
        |fields: Vec<String>, empty: bool| fields.iter().all(|f| f.is_empty() == empty) && !fields.is_empty();

    let mut without_mc = study(&ladder(), 3, 0.01);
    without_mc.variants.remove(0);
    for column in ["ratio_equal_n", "ratio_equal_time"] {
        assert!(all(field(&without_mc, column), true));
    }
    assert!(all(field(&without_mc, "rate"), false));

    let one_seed = study(&ladder(), 1, 0.01);
    assert!(all(field(&one_seed, "nrms_spread"), true));
    assert!(all(field(&one_seed, "rate"), false));
    let rate = Table::new(&one_seed).trends[3][0].law.unwrap();
    assert_eq!(rate.uncertainty, Uncertainty::Residuals);

    let one_level = study(&[ASKED], 3, 0.01);
    assert!(all(field(&one_level, "rate"), true));
    assert!(all(field(&one_level, "ratio_equal_n"), false));
    let at_equal_time = field(&one_level, "ratio_equal_time");
    assert_eq!((at_equal_time[0].as_str(), at_equal_time[3].as_str()), ("1", ""), "only mc knows its own");

    let mut timeless = study(&ladder(), 2, 0.01);
    for run in timeless.variants.iter_mut().flat_map(|v| &mut v.runs) {
        run.cpu_s = 0.0;
    }
    assert!(all(field(&timeless, "photons_per_s"), true));
}

#[test]
fn what_the_reference_limits_is_marked_everywhere() {
    let mut study = study(&ladder(), 3, 0.0);
    // The best variant has 0.33 % at the N asked for and 0.345 % at 2^22: 0.345 % is three times 0.115 %.
    study.reference.own_nrms[0] = 0.001_12;
    let table = Table::new(&study);
    let limited: Vec<(usize, u64, usize)> = table
        .rows
        .iter()
        .filter(|r| r.limited_by_reference)
        .map(|r| (r.variant, r.photons, r.grid))
        .collect();
    assert_eq!(limited, [(3, ASKED, 0)]);
    assert!(!table.trends[3][0].limited_by_reference, "the rate is fitted to powers of two");
    let (text, md) = (text(&study, &table), markdown(&study, &table));
    assert!(text.contains("* limited by the reference"), "{text}");
    assert!(text.contains(
        "warning: qmc-inverse-reuse on 48 x 48 cells: the error at N = 4 456 448 is less than 3 x"
    ));
    let line = md.lines().find(|line| line.starts_with("| 4 456 448 |")).unwrap();
    assert!(line.ends_with("† |") && line.matches('†').count() == 1, "{line}");
    assert!(md.contains("- † limited by the reference"));
    study.reference.own_nrms[0] = 0.001_16;
    let table = Table::new(&study);
    assert!(table.row(3, 1 << 22, 0).unwrap().limited_by_reference);
    assert!(table.trends[3][0].limited_by_reference && !table.trends[3][1].limited_by_reference);
    // Just as far from it as required: no mark.
    study.reference.own_nrms[0] = 0.0033 / 3.0 * 0.999;
    assert!(!Table::new(&study).rows.iter().any(|r| r.limited_by_reference));
    // A reference that does not know its own error limits everything.
    study.reference.own_nrms = vec![f64::NAN];
    assert!(Table::new(&study).rows.iter().all(|r| r.limited_by_reference));
}

#[test]
fn markdown_states_the_reference_the_settings_and_the_paper() {
    let study = study(&ladder(), 4, 0.02);
    let table = Table::new(&study);
    let md = markdown(&study, &table);
    for part in [
        "# Algorithm variants on wavy\\_glass",
        "    caustix compare --photons 4_456_448\n",
        "445 644 800 photons, 100 x the largest N, in 16 replicates; sequence halton-rotation",
        "0.0160 % on 48 x 48 cells, 0.0440 % on 128 x 128 cells and 0.0900 % on 256 x 256 cells",
        "## 4 456 448 photons on 128 x 128 cells",
        "4 seeds (1, 2, 3 and 4)",
        "eq. (4) | eq. (6)",
        "| 2^22 |",
        "‡ extrapolated",
    ] {
        assert!(md.contains(part), "{part:?} is not in\n{md}");
    }
    let line = md.lines().find(|line| line.starts_with("| `qmc-inverse-reuse` |")).unwrap();
    let fields: Vec<&str> = line.split('|').map(str::trim).collect();
    assert_eq!((fields[4], fields[9]), ("0.46", "2.19"), "{line}");
    // Every table is as wide as its head.
    for block in md.split("\n\n").filter(|block| block.starts_with('|')) {
        let bars: Vec<usize> = block.lines().map(|line| line.matches('|').count()).collect();
        assert!(bars.iter().all(|n| *n == bars[0]), "{block}");
    }
    let mut other = study;
    other.built_in = false;
    let (md, text) = (markdown(&other, &table), text(&other, &table));
    assert!(!md.contains("paper: of mc") && !md.contains("The paper's ratios") && !text.contains("paper"));
}

#[test]
fn names_from_outside_break_no_document() {
    let mut study = study(&ladder(), 2, 0.02);
    study.scene_name = "a|b\n<script>& \"x\" `y` * ".repeat(12);
    study.variants[0].name = "x|`y`\u{1}<z>&".repeat(9);
    study.variants[1].name = "qmc-with-global-rejection-and-retries-from-the-next-point".into();
    study.reference.emission_map = "m".repeat(300);
    study.warnings = vec!["w".repeat(250)];
    let table = Table::new(&study);
    for line in text(&study, &table).lines() {
        assert!(line.chars().count() <= WIDTH, "{} columns: {line}", line.chars().count());
    }
    for line in markdown(&study, &table).lines().filter(|line| line.starts_with("| `")) {
        assert_eq!(line.matches('`').count(), 2, "{line}");
    }
    assert_well_formed(&drawing(&study, &table).to_svg());
}

#[test]
fn the_terminal_table_is_aligned_and_says_what_the_numbers_say() {
    let study = study(&ladder(), 4, 0.02);
    let text = text(&study, &Table::new(&study));
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines.iter().all(|line| line.chars().count() <= WIDTH));
    let first = lines.iter().position(|line| line.starts_with("N = 4 456 448 on 48 x 48 cells")).unwrap();
    let block = &lines[first + 2..first + 7];
    assert!(block.iter().all(|line| line.chars().count() == block[0].chars().count()), "{text}");
    assert!(block[4].starts_with("qmc-inverse-reuse"), "{text}");
    // A mark stands behind its number: the digits of the others end where its digits end.
    let (marked, unmarked) = (block[1].rfind('~').unwrap(), block[4].trim_end());
    assert!(unmarked.ends_with(|c: char| c.is_ascii_digit()) && unmarked.len() == marked, "{text}");
    for number in ["2.19", "-0.7", "3.00", "0.800"] {
        assert!(block[4].contains(number), "{number} is not in {}", block[4]);
    }
}

#[test]
fn interrupted_and_empty_studies_can_be_shown() {
    let mut partial = study(&ladder(), 3, 0.02);
    partial.variants[3].runs.clear();
    partial.variants[2].runs.truncate(4);
    for run in partial.variants.iter_mut().flat_map(|v| &mut v.runs).filter(|run| run.seed == 2) {
        run.errors.truncate(1);
    }
    partial.variants[0].runs.retain(|run| run.photons < 1 << 18);
    partial.variants[1].runs.retain(|run| run.photons < 1 << 18);
    let mut empty = study(&[], 1, 0.0);
    empty.grids.clear();
    empty.variants.clear();
    let mut dark = study(&ladder(), 2, 0.0);
    for run in dark.variants.iter_mut().flat_map(|v| &mut v.runs) {
        run.errors = vec![Errors { relative_rms: 0.0, nrms: 0.0, relative_l1: 0.0 }; 3];
    }
    for study in [partial, empty, dark, study(&[], 2, 0.0), study(&[1], 1, 0.0), study(&[ASKED], 1, 0.0)] {
        let table = Table::new(&study);
        let (text, md, svg) =
            (text(&study, &table), markdown(&study, &table), drawing(&study, &table).to_svg());
        assert!(!text.is_empty() && !md.is_empty());
        assert_well_formed(&svg);
        for document in [text, md, svg, csv(&study, &table)] {
            assert!(!document.contains("NaN") && !document.contains("inf"), "{document}");
        }
    }
}

#[test]
fn the_plot_has_every_point_its_bars_and_legible_text_on_the_page() {
    let study = study(&ladder(), 4, 0.03);
    let drawing = drawing(&study, &Table::new(&study));
    assert_well_formed(&drawing.to_svg());
    let colours = |shape: &Shape| match shape {
        Shape::Polyline { points, pen } => Some((points.len(), pen.width_px, pen.colour.to_srgb())),
        _ => None,
    };
    let blue = [0x00, 0x72, 0xb2];
    let lines: Vec<(usize, f64)> =
        drawing.shapes.iter().filter_map(colours).filter(|l| l.2 == blue).map(|l| (l.0, l.1)).collect();
    assert_eq!(lines.iter().filter(|l| **l == (10, 2.0)).count(), 3, "a line of ten points a panel");
    assert_eq!(lines.iter().filter(|l| **l == (2, 1.4)).count(), 3 * 10 * 3, "bars with two caps");
    // Monte Carlo's black discs are drawn last: nothing hides one in the picture of the same shapes.
    let bytes = drawing.to_canvas().to_srgb_bytes();
    let discs = drawing.shapes.iter().filter_map(|shape| match shape {
        Shape::Polygon { corners, colour } if corners.len() == 24 && colour.to_srgb() == [0; 3] => {
            Some(corners)
        }
        _ => None,
    });
    let mut seen = 0;
    for corners in discs {
        let middle = |k: usize| corners.iter().map(|c| c[k]).sum::<f64>() / 24.0;
        let at = 3 * (middle(1) as usize * drawing.width + middle(0) as usize);
        assert_eq!(bytes[at..at + 3], [0; 3]);
        seen += 1;
    }
    assert_eq!(seen, 1 + 3 * 10, "the legend's and every point's");
    for shape in &drawing.shapes {
        let inside = |p: &[f64; 2]| {
            (0.0..=drawing.width as f64).contains(&p[0]) && (0.0..=drawing.height as f64).contains(&p[1])
        };
        match shape {
            Shape::Text { at, text, style } => {
                assert!(style.size_px >= 12.0, "{text}");
                let width = font::width_px(text, style.size_px, true);
                let start = match style.anchor {
                    Anchor::Start => at[0],
                    Anchor::Middle => at[0] - 0.5 * width,
                    Anchor::End => at[0] - width,
                };
                assert!(start >= 2.0 && start + width <= drawing.width as f64 - 2.0, "{text}");
                assert!(at[1] >= 12.0 && at[1] <= drawing.height as f64 - 4.0, "{text}");
            }
            Shape::Polyline { points, .. } => assert!(points.iter().all(inside), "{points:?}"),
            Shape::Polygon { corners, .. } => assert!(corners.iter().all(inside), "{corners:?}"),
            _ => {}
        }
    }
}

#[test]
fn a_study_survives_being_written_and_read() {
    let study = study(&ladder(), 2, 0.02);
    let json = serde_json::to_string(&study).unwrap();
    assert_eq!(serde_json::from_str::<Study>(&json).unwrap(), study);
}

/// Tags nest, attributes are quoted, and no bare `<` or `&` stands in text.
fn assert_well_formed(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        let between = &rest[..start];
        assert!(!between.contains('>'), "{between}");
        for entity in between.split('&').skip(1) {
            let name = entity.split(';').next().unwrap();
            assert!(["amp", "lt", "gt", "quot", "#39"].contains(&name), "&{entity}");
        }
        let end = start + rest[start..].find('>').expect("every tag ends");
        let tag = &rest[start + 1..end];
        assert!(!tag.contains('<') && tag.matches('"').count().is_multiple_of(2), "{tag}");
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(name);
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty() && svg.starts_with("<svg ") && rest.trim().is_empty());
}
