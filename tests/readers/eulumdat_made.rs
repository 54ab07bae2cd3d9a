//! EULUMDAT from formulas whose flux and intensities are known exactly: symmetries, lamp sets, everything
//! that programs do to it.

use caustix::error::{Diagnostic, Kind};
use caustix::files::photometric;
use caustix::photometry::opening::OpeningShape;
use caustix::photometry::{Format, Photometry, Summary};
use std::f64::consts::PI;

use crate::support::data;
use crate::support::ldt::{BOTH, EVEN, Ldt, NEITHER, TO_0, TO_90, even};

/// The mean of the tables but `EVEN` is 100 cd per 1000 lm.
const FLUX_LM: f64 = 400.0 * PI;

fn parse(text: &str) -> Result<Photometry, Diagnostic> {
    photometric::parse(text.as_bytes(), "made.ldt")
}

fn with_set(text: &str, lamp_set: usize) -> Result<Photometry, Diagnostic> {
    photometric::parse_with(text.as_bytes(), "made.ldt", Some(lamp_set), &mut |_| unreachable!())
}

/// Flux and intensities at gamma 90 towards these C angles, against exact numbers.
fn check(name: &str, photometry: &Photometry, flux_lm: f64, candela: &[(f64, f64)], tolerance: f64) {
    assert_eq!(photometry.format, Format::Eulumdat, "{name}");
    let summary = Summary::new(photometry);
    assert!((summary.flux_lm / flux_lm - 1.0).abs() < tolerance, "{name}: {} lm, {flux_lm}", summary.flux_lm);
    for &(c, expected) in candela {
        let got = photometry.web.intensity_cd(90.0, c);
        assert!((got / expected - 1.0).abs() < tolerance, "{name}: {got} cd at C {c}, {expected}");
    }
}

fn warns(photometry: &Photometry, what: &str) -> bool {
    photometry.warnings.iter().any(|w| w.to_string().contains(what))
}

/// C0, C90, C180, C270.
fn round(candela: [f64; 4]) -> [(f64, f64); 4] {
    [0, 1, 2, 3].map(|i| (90.0 * i as f64, candela[i]))
}

#[test]
fn every_symmetry_has_the_planes_that_it_stores() {
    let quarter = 40.0 * 40f64.to_radians().cos();
    let fifth = 40.0 * 40f64.to_radians().sin();
    for (isym, table, candela) in [
        (0, BOTH, [140.0, 60.0, 140.0, 60.0]),
        (2, BOTH, [140.0, 60.0, 140.0, 60.0]),
        (3, BOTH, [140.0, 60.0, 140.0, 60.0]),
        (4, BOTH, [140.0, 60.0, 140.0, 60.0]),
        (2, TO_0, [140.0, 100.0, 60.0, 100.0]),
        (0, TO_90, [100.0, 140.0, 100.0, 60.0]),
        (3, TO_90, [100.0, 140.0, 100.0, 60.0]),
        (0, NEITHER, [100.0 + quarter, 100.0 + fifth, 100.0 - quarter, 100.0 - fifth]),
        (1, EVEN, [1000.0 / (4.0 * PI); 4]),
    ] {
        let file = Ldt::new(isym, table);
        let flux_lm = if isym == 1 { 1000.0 } else { FLUX_LM };
        let read = parse(&file.text()).unwrap();
        check(&format!("Isym {isym}"), &read, flux_lm, &round(candela), 1e-12);
        // In every direction of the grid, stored or mirrored.
        for c in &file.c {
            for gamma in &file.gamma {
                let exact = table(gamma.to_radians(), c.to_radians());
                let got = read.web.intensity_cd(*gamma, *c);
                assert!((got - exact).abs() < 1e-11, "Isym {isym}, C {c}, gamma {gamma}: {got}, {exact}");
            }
        }
    }
    // Uneven planes, and one plane alone.
    let c = vec![
        0.0, 10.0, 30.0, 60.0, 90.0, 120.0, 150.0, 170.0, 180.0, 190.0, 210.0, 240.0, 270.0, 300.0, 330.0,
        350.0,
    ];
    let gamma = vec![0.0, 10.0, 20.0, 40.0, 60.0, 90.0, 120.0, 140.0, 160.0, 170.0, 180.0];
    for isym in [0, 3] {
        let uneven = Ldt { c: c.clone(), gamma: gamma.clone(), steps: [0.0; 2], ..Ldt::new(isym, TO_90) };
        let read = parse(&uneven.text()).unwrap();
        check("uneven", &read, FLUX_LM, &round([100.0, 140.0, 100.0, 60.0]), 1e-12);
        assert!(!warns(&read, "distance"));
    }
    for isym in [0, 1] {
        let one = Ldt { c: vec![0.0], steps: [0.0, 5.0], ..Ldt::new(isym, EVEN) };
        let read = parse(&one.text()).unwrap();
        check("one plane", &read, 1000.0, &round([1000.0 / (4.0 * PI); 4]), 1e-12);
        assert_eq!((read.web.horizontal_deg.len(), read.warnings.len()), (1, 0), "{:?}", read.warnings);
    }
    let narrow = |gamma: Vec<f64>| parse(&Ldt { gamma, ..Ldt::new(3, TO_90) }.text()).unwrap();
    let to_140 = narrow(even(5.0, 29));
    check("to 140", &to_140, 200.0 * PI * (1.0 - 140f64.to_radians().cos()), &[(90.0, 140.0)], 1e-12);
    assert_eq!(to_140.web.intensity_cd(141.0, 0.0), 0.0);
    assert!(warns(&to_140, "gamma angle 140") && warns(&to_140, "downward fraction of 50 %"));
    let from_90 = narrow(even(5.0, 19).iter().map(|gamma| gamma + 90.0).collect());
    check("from 90", &from_90, 0.5 * FLUX_LM, &[(90.0, 140.0)], 1e-12);
    assert_eq!(from_90.web.intensity_cd(89.0, 0.0), 0.0);
}

#[test]
fn intensities_are_per_1000_lm_of_one_lamp_set() {
    let of = |sets| Ldt { sets, ..Ldt::new(1, EVEN) };
    let single = |sets| parse(&of(sets).text()).unwrap();
    let absolute = single(&[["-1", "LED", "1234.5", "3000", "80", "10"]]);
    check("absolute", &absolute, 1234.5, &[(0.0, 1234.5 / (4.0 * PI))], 1e-12);
    assert_eq!((absolute.lumens_per_lamp, absolute.lamps_lm(), absolute.lamps), (None, None, 1.0));
    // The lumens are those of all lamps of the set.
    let three = single(&[["3", "LED", "3000", "3000", "1B/80", "30"]]);
    check("three lamps", &three, 3000.0, &[(0.0, 3000.0 / (4.0 * PI))], 1e-12);
    assert_eq!(
        (three.lumens_per_lamp, three.lamps_lm(), three.input_watts),
        (Some(1000.0), Some(3000.0), 30.0)
    );
    assert_eq!(three.lamp_sets[0].cri, "1B/80");
    assert_eq!(Summary::new(&three).light_output_ratio.map(|ratio| (ratio - 1.0).abs() < 1e-12), Some(true));

    let two =
        of(&[["1", "LED 3 W", "1000", "3000", "80", "10"], ["1", "LED 5 W", "2500", "3000", "80", "22"]]);
    let by_field =
        of(&[["1", "1", "LED 3 W", "LED 5 W", "1000", "2500"], ["3000", "3000", "80", "80", "10", "22"]]);
    for (file, grouped) in [(two, false), (by_field, true)] {
        let first = parse(&file.text()).unwrap();
        check("first set", &first, 1000.0, &[], 1e-12);
        assert_eq!((first.lamp_set, first.lamp_sets.len(), first.input_watts), (0, 2, 10.0));
        let told = "2 lamp sets (1: LED 3 W, 1000 lm, 10 W; 2: LED 5 W, 2500 lm, 22 W)";
        assert!(warns(&first, told), "{:?}", first.warnings);
        assert_eq!(warns(&first, "field by field"), grouped);
        for (number, flux_lm, watts) in [(1, 1000.0, 10.0), (2, 2500.0, 22.0)] {
            let read = with_set(&file.text(), number).unwrap();
            check("a set", &read, flux_lm, &[(0.0, flux_lm / (4.0 * PI))], 1e-12);
            assert_eq!((read.lamp_set, read.input_watts), (number - 1, watts));
            assert!(!warns(&read, "lamp sets ("), "{:?}", read.warnings);
            assert_eq!(Summary::new(&read).lamp_set, Some(number));
        }
        for number in [0, 3] {
            let error = with_set(&file.text(), number).unwrap_err();
            assert_eq!((error.kind(), error.required()), (Kind::Range, "1 to 2"));
            assert!(error.found().contains("LED 5 W"), "{error}");
        }
    }
    let none = of(&[]);
    check("no set", &parse(&none.text()).unwrap(), 1000.0, &[], 1e-12);
    assert!(warns(&parse(&none.text()).unwrap(), "0 lamp sets"));
    let dark = of(&[["1", "LED", "0", "3000", "80", "10"]]);
    assert_eq!(parse(&dark.text()).unwrap_err().line(), Some(29));
}

#[test]
fn what_is_declared_is_compared_and_scales_nothing() {
    // DFF, LORL, conversion, tilt.
    let of = |four, table| parse(&Ldt { four, ..Ldt::new(1, table) }.text()).unwrap();
    let doubled = of(["50", "100", "2", "0"], EVEN);
    check("conversion 2", &doubled, 2000.0, &[(0.0, 2000.0 / (4.0 * PI))], 1e-12);
    assert!(warns(&doubled, "2000.0 lm in the table for 1000 lm of the lamps"), "{:?}", doubled.warnings);
    let share = |_, _| 600.0 / (4.0 * PI);
    let right = of(["50", "60", "1", "15"], share);
    check("LORL 60", &right, 600.0, &[], 1e-12);
    assert_eq!((right.warnings.len(), right.flux_declared_lm), (0, Some(600.0)), "{:?}", right.warnings);
    assert_eq!(right.eulumdat.unwrap().measured_tilt_deg, 15.0);
    let wrong = of(["50", "60", "1", "0"], EVEN);
    check("LORL wrong", &wrong, 1000.0, &[], 1e-12);
    assert!(warns(&wrong, "LORL 60 %, which is 600.0 lm, for a table of 1000.0 lm"), "{:?}", wrong.warnings);
    for four in [["50", "96", "1", "0"], ["50", "104", "1", "0"], ["50", "0", "1", "0"], ["0", "0", "1", "0"]]
    {
        assert_eq!(of(four, EVEN).warnings.len(), 0, "{four:?}");
    }
    for four in
        [["50", "94", "1", "0"], ["50", "106", "1", "0"], ["52", "0", "1", "0"], ["48", "0", "1", "0"]]
    {
        assert_eq!(of(four, EVEN).warnings.len(), 1, "{four:?}");
    }
}

#[test]
fn every_dress_of_a_file_gives_the_same_numbers() {
    let file = Ldt::new(3, TO_90);
    let (text, plain) = (file.text(), parse(&file.text()).unwrap());
    let umlaut = text.replace("made up", "Gr\u{f6}\u{df}e");
    let several: String = {
        let lines = file.lines();
        let lists: Vec<String> = lines[42..].chunks(7).map(|words| words.join("  ")).collect();
        [&lines[..42], &lists].concat().join("\n")
    };
    for (name, bytes) in [
        ("LF, no final line end", text.trim_end().replace("\r\n", "\n").into_bytes()),
        ("CR", text.replace("\r\n", "\r").into_bytes()),
        ("blank tail", format!("{text}\r\n \r\n").into_bytes()),
        ("Ctrl-Z", format!("{text}\u{1a}\0\0more").into_bytes()),
        ("Windows-1252", umlaut.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect()),
        ("byte order mark", [&[0xef, 0xbb, 0xbf], umlaut.as_bytes()].concat()),
        ("UTF-16", umlaut.encode_utf16().flat_map(u16::to_le_bytes).collect()),
        (
            "text behind",
            text.replace("\r\n1200\r\n", "\r\n1200 mm\r\n")
                .replace("\r\n345\r\n", "\r\n345 deg\r\n")
                .into_bytes(),
        ),
        ("blanks", text.replace("\r\n", " \t\r\n  ").into_bytes()),
        ("several a line", several.into_bytes()),
        ("blank ratios", text.replace(&"0\r\n".repeat(10), &"\r\n".repeat(10)).into_bytes()),
        ("commas", text.replace('.', ",").replace("x,ldt", "x.ldt").into_bytes()),
    ] {
        let read = photometric::parse(&bytes, "made.ldt").unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(read.web, plain.web, "{name}");
        assert_eq!(read.warnings, plain.warnings, "{name}");
        let luminaire = if bytes.windows(2).any(|w| w == b"up") { "made up" } else { "Gr\u{f6}\u{df}e" };
        assert!(read.label("LUMINAIRE") == Some(luminaire) || name == "UTF-16", "{name}: {:?}", read.labels);
    }
    let comma = Ldt { sets: &[["-1", "LED", "1234,5", "3000", "80", "10"]], ..file.clone() };
    let read = parse(&comma.text().replace('.', ",")).unwrap();
    check("comma decimals", &read, 1.2345 * FLUX_LM, &round([123.45, 172.83, 123.45, 74.07]), 1e-12);
    // A comma beside points may have been meant for thousands: read, and told.
    let read = parse(&comma.text()).unwrap();
    check("mixed", &read, 1.2345 * FLUX_LM, &[], 1e-12);
    assert!(warns(&read, "\"1234,5\" in a file that has decimal points, too"), "{:?}", read.warnings);
}

#[test]
fn the_head_is_shown_in_metres_and_the_words_of_lm_63() {
    let file = Ldt { four: ["50", "100", "1", "12.5"], ..Ldt::new(1, EVEN) };
    let mut lines = file.lines();
    for (line, value) in [(16, "1100"), (17, "200"), (18, "10"), (19, "20"), (20, "30"), (21, "40")] {
        lines[line - 1] = value.to_owned();
    }
    let read = parse(&lines.join("\n")).unwrap();
    let head = read.eulumdat.unwrap();
    assert_eq!((head.ityp, head.isym, head.c_planes, head.conversion), (3, 1, 24, 1.0));
    assert_eq!(head.luminaire_size_m, [1.2, 0.3, 0.06]);
    assert_eq!((head.downward_fraction_percent, head.light_output_ratio_percent), (50.0, 100.0));
    assert_eq!(head.measured_tilt_deg, 12.5);
    // LM-63's width is across H = 0, as EULUMDAT's length is across C0.
    assert_eq!((read.opening.shape, read.opening.size_m), (OpeningShape::Box, [1.1, 0.2, 0.04]));
    assert_eq!(read.opening.heights_m, Some([0.01, 0.02, 0.03, 0.04]));
    let labels: Vec<(&str, &str)> =
        read.labels.iter().map(|(key, text)| (key.as_str(), text.as_str())).collect();
    assert_eq!(
        labels,
        [
            ("MANUFAC", "Nobody"),
            ("TEST", "0"),
            ("LUMINAIRE", "made up"),
            ("LUMCAT", "1"),
            ("_FILENAME", "x.ldt"),
            ("ISSUEDATE", "2026-11-26"),
            ("LAMP", "LED")
        ]
    );
    lines[1] = "other".to_owned();
    lines[16] = "0".to_owned();
    lines[0] = String::new();
    let read = parse(&lines.join("\n")).unwrap();
    assert_eq!((read.opening.shape, read.label("MANUFAC")), (OpeningShape::VerticalCylinder, None));
    assert!(warns(&read, "type Ityp \"other\""));
}

/// A file with one line other than it should be; what is said of it, and where.
#[test]
fn contradictions_are_told_or_refused_with_their_place() {
    let file = Ldt::new(3, TO_90);
    let of = |line: usize, text: &str| {
        let mut lines = file.lines();
        lines[line - 1] = text.to_owned();
        parse(&lines.join("\r\n"))
    };
    // Distances that the lists contradict: the lists are used.
    for (line, text, told) in [
        (5, "90", "a distance of 90 degrees, and C angles 0 and 15"),
        (7, "10", "a distance of 10 degrees, and gamma angles 0 and 5"),
        (2, "7", "type Ityp \"7\""),
        (14, "-5", "width of the luminaire \"-5\""),
        (24, "", "a blank line"),
        (24, "1 2", "one number: conversion factor"),
        (32, "ten", "watts of lamp set 1 \"ten\""),
        (27, "0", "number of lamps of lamp set 1 0"),
    ] {
        let read = of(line, text).unwrap_or_else(|e| panic!("{line} {text}: {e}"));
        check(text, &read, FLUX_LM, &round([100.0, 140.0, 100.0, 60.0]), 1e-12);
        let warning = read.warnings.iter().find(|w| w.to_string().contains(told));
        let warning = warning.unwrap_or_else(|| panic!("{told}: {:?}", read.warnings));
        assert_eq!((warning.file(), warning.line()), (Some("made.ldt"), Some(line)), "{warning}");
    }
    for (line, text, kind, at) in [
        (3, "5", Kind::Range, 3),
        (3, "x", Kind::Syntax, 3),
        (4, "0", Kind::Range, 4),
        (4, "22", Kind::Range, 4),
        (4, "23.5", Kind::Range, 4),
        (4, "2147483647", Kind::Limit, 4),
        (4, "", Kind::Missing, 4),
        (6, "99999", Kind::Missing, 584),
        (24, "0", Kind::Range, 24),
        (24, "-1", Kind::Range, 24),
        (26, "-1", Kind::Range, 26),
        (26, "1001", Kind::Limit, 26),
        (26, "1000", Kind::Missing, 584),
        (29, "-4", Kind::Range, 29),
        (29, "1,234.5", Kind::Syntax, 29),
        (29, "nan", Kind::Syntax, 29),
        (29, "", Kind::Missing, 29),
        (61, "271", Kind::Range, 61),
        (62, "270", Kind::Range, 62),
        (60, "400", Kind::Range, 60),
        (69, "15", Kind::Range, 70),
        (200, "-50", Kind::Range, 200),
        (200, "1.0D+02", Kind::Syntax, 200),
        (200, "inf", Kind::Syntax, 200),
        (200, "1e31", Kind::Limit, 200),
        (200, "1e400", Kind::Range, 200),
        (200, "l00", Kind::Syntax, 200),
    ] {
        let error = of(line, text).expect_err(text);
        assert_eq!(
            (error.kind(), error.line(), error.file()),
            (kind, Some(at), Some("made.ldt")),
            "{line} {text}: {error}"
        );
        assert!(error.column().is_some());
    }
    let text = file.text();
    let short = text.trim_end().rsplit_once("\r\n").unwrap().0;
    let error = parse(short).unwrap_err();
    assert_eq!((error.kind(), error.line()), (Kind::Missing, Some(583)));
    assert!(error.required().contains("value 481 of 481"), "{error}");
    let extra = parse(&format!("{text}1\r\n2\r\n")).unwrap();
    check("extra lines", &extra, FLUX_LM, &round([100.0, 140.0, 100.0, 60.0]), 1e-12);
    assert!(warns(&extra, "2 surplus numbers") && extra.warnings.iter().any(|w| w.line() == Some(585)));
    // All planes where the symmetry stores a part of them.
    for isym in ["1", "2", "3", "4"] {
        let mut lines = Ldt::new(0, TO_90).lines();
        lines[2] = isym.to_owned();
        let read = parse(&lines.join("\n")).unwrap();
        check("all planes", &read, FLUX_LM, &round([100.0, 140.0, 100.0, 60.0]), 1e-12);
        assert!(warns(&read, "read as Isym = 0"));
        assert_eq!(read.eulumdat.unwrap().isym, 0);
    }
    // Without symmetry a list over half the circle says nothing of the other half.
    let half = Ldt { c: even(15.0, 13), ..Ldt::new(0, TO_90) };
    let error = parse(&half.text()).unwrap_err();
    assert!(error.found().contains("C angles from 0 to 180 where Isym = 0"), "{error}");
}

#[test]
fn a_file_is_known_by_its_content() {
    let ies = std::fs::read(data::own_file("spot.ies")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("a.ldt"), &ies).unwrap();
    std::fs::write(path("a.ies"), Ldt::new(1, EVEN).text()).unwrap();
    assert!(matches!(photometric::read(path("a.ldt")).unwrap().format, Format::Lm63(_)));
    assert_eq!(photometric::read(path("a.ies")).unwrap().format, Format::Eulumdat);
    assert!(photometric::read_with(path("a.ies"), Some(1)).is_ok());
    let error = photometric::read_with(path("a.ldt"), Some(1)).unwrap_err();
    assert_eq!(error.found(), "lamp set 1 of an IES LM-63 file");
    assert_eq!(error.file(), path("a.ldt").to_str());
    // One whose head is damaged is told of as EULUMDAT.
    let broken = Ldt::new(1, EVEN).text().replacen("\r\n24\r\n", "\r\n24x\r\n", 1);
    let error = parse(&broken).unwrap_err();
    assert_eq!((error.line(), error.found()), (Some(4), "\"24x\""), "{error}");
}

#[test]
fn tables_of_721_by_361_angles_are_read() {
    let (c, gamma) = (even(0.5, 720), even(0.5, 361));
    let large = Ldt { c, gamma, steps: [0.5, 0.5], ..Ldt::new(0, NEITHER) };
    let text = large.text();
    let start = std::time::Instant::now();
    let read = parse(&text).unwrap();
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
    assert_eq!((read.web.horizontal_deg.len(), read.web.vertical_deg.len()), (720, 361));
    check("large", &read, FLUX_LM, &[(40.0, 140.0), (220.0, 60.0)], 1e-9);
}

/// The same files as others wrote them, six digits each.
#[test]
fn files_of_the_data_folder_have_their_exact_values() {
    let Some(folder) = data::real_folder().map(|folder| folder.join("ldt/made")) else { return };
    let to_90 = [100.0, 140.0, 100.0, 60.0];
    let both = [140.0, 60.0, 140.0, 60.0];
    let even = |flux_lm: f64| [flux_lm / (4.0 * PI); 4];
    let mut rows: Vec<(&str, f64, [f64; 4], &str)> = vec![
        ("isym2", FLUX_LM, [140.0, 100.0, 60.0, 100.0], ""),
        ("isym0", FLUX_LM, [130.642, 125.712, 69.358, 74.288], ""),
        ("isym1_mc24", 1000.0, even(1000.0), ""),
        ("isym1_mc1", 1000.0, even(1000.0), ""),
        ("two_sets", 1000.0, even(1000.0), "2 lamp sets"),
        ("two_sets_by_field", 1000.0, even(1000.0), "2 lamp sets"),
        ("absolute", 1234.5, even(1234.5), ""),
        ("three_lamps_total", 3000.0, even(3000.0), ""),
        ("conversion2", 2000.0, even(2000.0), "2000.0 lm in the table for 1000 lm"),
        ("lorl_60", 600.0, even(600.0), "-"),
        ("lorl_wrong", 1000.0, even(1000.0), "LORL"),
        ("lorl_0", 1000.0, even(1000.0), "-"),
        ("comma_decimals", 1551.32, [123.45, 172.83, 123.45, 74.07], ""),
        ("gamma_to_140", 1109.64, to_90, "gamma angle 140"),
        ("gamma_from_90", 628.319, to_90, ""),
        ("dc_contradicts", FLUX_LM, to_90, "a distance of 90 degrees"),
        ("extra_lines", FLUX_LM, to_90, "2 surplus numbers"),
        ("zero_sets", 1000.0, even(1000.0), "0 lamp sets"),
        ("all_planes_though_isym4", f64::NAN, [f64::NAN; 4], "read as Isym = 0"),
    ];
    rows.extend(
        ["both_isym0", "both_isym2", "both_isym3", "both_isym4"].map(|name| (name, FLUX_LM, both, "")),
    );
    let dresses = [
        "isym3",
        "isym0_of_isym3",
        "uneven",
        "cr_only",
        "lf_nofinal",
        "blank_tail",
        "ctrl_z",
        "cp1252_name",
        "utf8_bom",
        "text_behind",
    ];
    rows.extend(dresses.map(|name| (name, FLUX_LM, to_90, "")));
    let mut seen = 0;
    for (name, flux_lm, candela, warning) in rows {
        let read = photometric::read(folder.join(format!("{name}.ldt"))).unwrap_or_else(|e| panic!("{e}"));
        if flux_lm.is_finite() {
            check(name, &read, flux_lm, &round(candela), 2e-5);
        }
        match warning {
            "" => {}
            "-" => assert_eq!(read.warnings.len(), 0, "{name}: {:?}", read.warnings),
            _ => assert!(warns(&read, warning), "{name}: {:?}", read.warnings),
        }
        println!("{name}: {:.4} lm, {} warnings", Summary::new(&read).flux_lm, read.warnings.len());
        seen += 1;
    }
    let error = photometric::read(folder.join("short_by_one.ldt")).unwrap_err();
    assert!(error.required().contains("value 481 of 481") && error.line().is_some(), "{error}");
    assert_eq!(seen + 1, std::fs::read_dir(&folder).unwrap().count(), "every file of the folder");
    for name in ["two_sets", "two_sets_by_field"] {
        let second = photometric::read_with(folder.join(format!("{name}.ldt")), Some(2)).unwrap();
        check(name, &second, 2500.0, &[], 2e-5);
    }
}
