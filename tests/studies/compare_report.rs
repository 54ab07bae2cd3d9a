//! What a study says and how it is shown, from made-up studies whose laws, ratios and limits are known.

use caustix::image::canvas::Anchor;
use caustix::image::drawing::Shape;
use caustix::image::font;
use caustix::report::compare::csv::{HEADER, csv};
use caustix::report::compare::markdown::markdown;
use caustix::report::compare::plot::drawing;
use caustix::report::compare::text::{WIDTH, text};
use caustix::report::compare::write_files;
use caustix::study::fit::Uncertainty;
use caustix::study::norms::Errors;
use caustix::study::results::{Account, Reference, Run, Study, VariantResult};
use caustix::study::table::Table;

/// A number of [0, 1) for an index (SplitMix64's finaliser).
fn uniform(index: u64) -> f64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// About normal, mean 0, deviation 1: twelve uniforms less six.
fn normal(index: u64) -> f64 {
    (0..12).map(|i| uniform(12 * index + i)).sum::<f64>() - 6.0
}

const ASKED: u64 = 4_456_448;
const GRIDS: [u32; 3] = [48, 128, 256];

/// nRMS = `at_asked` on 48 x 48 cells at N = [`ASKED`], (N / ASKED)^rate of it elsewhere, 3 and 7 times on finer grids.
struct Law {
    name: &'static str,
    at_asked: f64,
    rate: f64,
    cpu_s_per_photon: f64,
}

const LAWS: [Law; 4] = [
    Law { name: "mc", at_asked: 0.025, rate: -0.5, cpu_s_per_photon: 1e-6 },
    Law { name: "qmc", at_asked: 0.0105, rate: -0.6, cpu_s_per_photon: 1e-6 },
    Law { name: "qmc-inverse", at_asked: 0.0046, rate: -0.7, cpu_s_per_photon: 1.25e-6 },
    Law { name: "qmc-inverse-reuse", at_asked: 0.0033, rate: -0.75, cpu_s_per_photon: 1.25e-6 },
];

fn grid_factor(grid: usize) -> f64 {
    [1.0, 3.0, 7.0][grid]
}

/// The laws with so much noise, relative, on every error.
fn study(ladder: &[u64], seeds: u64, noise: f64) -> Study {
    let variant = |(v, law): (usize, &Law)| {
        let run = |seed: u64, photons: u64| {
            let errors = (0..GRIDS.len()).map(|grid| {
                let shaken = 1.0
                    + noise
                        * normal((v as u64 * 1000 + seed) * 1000 + photons.ilog2() as u64 * 4 + grid as u64);
                let nrms = law.at_asked
                    * grid_factor(grid)
                    * (photons as f64 / ASKED as f64).powf(law.rate)
                    * shaken;
                Errors { relative_rms: 0.5 * nrms, nrms, relative_l1: 0.25 * nrms }
            });
            Run {
                seed,
                photons,
                cpu_s: law.cpu_s_per_photon * photons as f64,
                coordinates_mean: [8.2, 8.2, 5.0, 3.0][v],
                coordinates_max: [131, 131, 9, 5][v],
                errors: errors.collect(),
            }
        };
        VariantResult {
            name: law.name.into(),
            description: "rejection, retries from the next coordinates".into(),
            runs: (1..=seeds).flat_map(|seed| ladder.iter().map(move |&n| run(seed, n))).collect(),
            account: Some(Account { by_event: 8.2, equation_4: 6.9, equation_6: 3.9 }),
        }
    };
    let largest = ladder.iter().copied().max().unwrap_or(1);
    Study {
        caustix_version: "0.1.0".into(),
        scene_name: "wavy_glass".into(),
        scene_sha256: "0123456789abcdef".into(),
        built_in: true,
        command: "caustix compare --photons 4_456_448".into(),
        receivers: vec!["plate".into()],
        grids: GRIDS.into(),
        asked_photons: ASKED,
        ladder: ladder.into(),
        seeds: (1..=seeds).collect(),
        threads: 2,
        reference: Reference {
            photons: 100 * largest,
            replicates: 16,
            sequence: "halton-rotation".into(),
            emission_map: "directions uniform in solid angle, weighted by intensity".into(),
            seed: 20_011,
            own_nrms: vec![0.000_16, 0.000_44, 0.000_9],
            factor: 100.0,
        },
        variants: LAWS.iter().enumerate().map(variant).collect(),
        warnings: vec![],
    }
}

fn ladder() -> Vec<u64> {
    let mut ladder: Vec<u64> = (14..=22).map(|k| 1 << k).collect();
    ladder.push(ASKED);
    ladder
}

fn close(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() < 1e-12
}

#[test]
fn rates_are_found_within_their_standard_errors() {
    let table = Table::new(&study(&ladder(), 8, 0.05));
    let mut squares = 0.0;
    for (v, law) in LAWS.iter().enumerate() {
        for trend in &table.trends[v] {
            let found = trend.law.unwrap();
            let standard_error = found.rate_standard_error.unwrap();
            let z = (found.rate - law.rate) / standard_error;
            squares += z * z;
            assert_eq!(found.uncertainty, Uncertainty::Seeds);
            // Noise of 5 % on nine levels an octave apart: 0.05 / sqrt(60 ln(2)^2) a seed, over sqrt(8).
            let expected = 0.05 / (60.0_f64.sqrt() * std::f64::consts::LN_2) / 8.0_f64.sqrt();
            assert!(
                standard_error > 0.3 * expected && standard_error < 2.0 * expected,
                "{standard_error} {expected}"
            );
            // Student's t with 7 degrees passes 5.9 once in 1700, here among 12.
            assert!(z.abs() < 5.9, "{} {z}", law.name);
        }
    }
    // Twelve t-variables of 7 degrees: their squares' mean is 7/5 with deviation 0.9.
    assert!((0.3..4.1).contains(&(squares / 12.0)), "{}", squares / 12.0);
}

#[test]
fn ratios_are_those_computed_by_hand() {
    let table = Table::new(&study(&ladder(), 2, 0.0));
    for (v, law) in LAWS.iter().enumerate() {
        for (g, _) in GRIDS.iter().enumerate() {
            let row = table.row(v, ASKED, g).unwrap();
            assert!(close(row.errors.nrms, law.at_asked * grid_factor(g)));
            assert!(close(row.errors.relative_rms, 0.5 * row.errors.nrms));
            assert!(close(row.errors.relative_l1, 0.25 * row.errors.nrms));
            assert!(row.nrms_spread.unwrap() < 1e-15);
            assert!(close(row.ratio_equal_n.unwrap(), 0.025 / law.at_asked));
            // In its time mc traces so many times the photons, at the rate -1/2.
            let more = law.cpu_s_per_photon / LAWS[0].cpu_s_per_photon;
            let at_equal_time = row.ratio_equal_time.unwrap();
            assert!(close(at_equal_time.value, 0.025 / law.at_asked / more.sqrt()), "{at_equal_time:?}");
            assert_eq!(at_equal_time.extrapolated, more > 1.0, "mc was not measured beyond the N asked for");
            assert!(close(table.photons_per_cpu_s[v].unwrap(), 1.0 / law.cpu_s_per_photon));
            // e = 1 % at N = ASKED (e0 / 1 %)^(1 / -rate).
            let photons = ASKED as f64 * (row.errors.nrms / 0.01).powf(-1.0 / law.rate);
            let time = table.trends[v][g].time_to_target.unwrap();
            assert!(close(time.value, photons * law.cpu_s_per_photon), "{time:?}");
            assert_eq!(time.extrapolated, photons > ASKED as f64);
        }
    }
    // At 2^20, qmc-inverse-reuse takes the time of 1.25 x 2^20 photons of mc: measured, not extrapolated.
    let row = table.row(3, 1 << 20, 0).unwrap();
    assert!(!row.ratio_equal_time.unwrap().extrapolated);
}

#[test]
fn errors_over_seeds_are_root_mean_squares_and_their_spread() {
    let mut study = study(&[1 << 20], 2, 0.0);
    for (run, nrms) in study.variants[0].runs.iter_mut().zip([0.03, 0.04]) {
        run.errors[0] = Errors { relative_rms: 2.0 * nrms, nrms, relative_l1: nrms };
        run.cpu_s = 100.0 * nrms;
        run.coordinates_mean = 200.0 * nrms;
    }
    let table = Table::new(&study);
    let row = table.row(0, 1 << 20, 0).unwrap();
    assert!(close(row.errors.nrms, 0.001_25_f64.sqrt()));
    assert!(close(row.errors.relative_rms, 2.0 * 0.001_25_f64.sqrt()));
    assert!(close(row.errors.relative_l1, 0.035));
    assert!(close(row.nrms_spread.unwrap(), 0.01 / 2.0_f64.sqrt()));
    assert!(close(row.cpu_s, 3.5) && close(row.coordinates, 7.0));
}

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
fn the_asked_number_is_measured_but_no_part_of_the_law() {
    let mut study = study(&ladder(), 3, 0.0);
    for run in study.variants[3].runs.iter_mut().filter(|run| run.photons == ASKED) {
        run.errors[0].nrms *= 1.09;
    }
    let table = Table::new(&study);
    assert!((table.trends[3][0].law.unwrap().rate + 0.75).abs() < 1e-12);
    assert!(close(table.row(3, ASKED, 0).unwrap().errors.nrms, 1.09 * 0.0033));
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
    let canvas = drawing.to_canvas();
    let discs = drawing.shapes.iter().filter_map(|shape| match shape {
        Shape::Polygon { corners, colour } if corners.len() == 24 && colour.to_srgb() == [0; 3] => {
            Some(corners)
        }
        _ => None,
    });
    let mut seen = 0;
    for corners in discs {
        let middle = |k: usize| corners.iter().map(|c| c[k]).sum::<f64>() / 24.0;
        assert_eq!(canvas.pixel(middle(0) as usize, middle(1) as usize).to_srgb(), [0; 3]);
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

#[test]
fn files_are_written_and_one_that_cannot_be_keeps_no_other() {
    let study = study(&ladder(), 2, 0.02);
    let table = Table::new(&study);
    let directory = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(directory.path().join("compare.md/occupied")).unwrap();
    let files = write_files(&study, &table, directory.path());
    let names: Vec<_> = files.written.iter().map(|p| p.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!((names, files.errors.len()), (vec!["compare.csv", "compare.svg"], 1));
    assert_eq!(std::fs::read_to_string(&files.written[0]).unwrap(), csv(&study, &table));
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
