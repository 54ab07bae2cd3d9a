//! Photometric files as programs really write them: what is read, and what is said of it.

use caustix::error::Kind;
use caustix::files::photometric;
use caustix::photometry::{Format, Photometry, Revision, Summary};

/// Of these intensities each 15 degrees: 4107.64 lm by the trapezoid, 4095.13 lm of the bilinear table (computed elsewhere).
const CANDELA: &str = "1000 966 1083 957 717 384 0";
const FLUX_LM: f64 = 4107.64;
const EMITTED_LM: f64 = 4095.13;

/// A file in parts: what stands before TILT, lamps and lumens, field 12, angles, intensities plane by plane.
struct File<'a> {
    head: &'a str,
    lamps: &'a str,
    kind: u8,
    field12: &'a str,
    v: &'a str,
    h: &'a str,
    candela: &'a str,
}

const FILE: File = File {
    head: "IESNA:LM-63-2002\n[TEST] made up",
    lamps: "1 -1",
    kind: 1,
    field12: "1",
    v: "0 15 30 45 60 75 90",
    h: "0",
    candela: CANDELA,
};

impl File<'_> {
    fn text(&self) -> String {
        let [n_v, n_h] = [self.v, self.h].map(|axis| axis.split(' ').count());
        let File { head, lamps, kind, field12, v, h, candela } = self;
        format!(
            "{head}\nTILT=NONE\n{lamps} 1 {n_v} {n_h} {kind} 2 0.1 0.1 0\n1 {field12} 10\n{v}\n{h}\n{candela}\n"
        )
    }

    fn read(&self) -> Photometry {
        photometric::parse(self.text().as_bytes(), "a.ies").unwrap()
    }

    fn summary(&self) -> Summary {
        Summary::new(&self.read())
    }

    /// The only warning.
    fn warning(&self) -> String {
        let warnings = self.summary().warnings;
        assert_eq!(warnings.len(), 1, "{}\n{warnings:#?}", self.text());
        warnings[0].clone()
    }

    fn is_silent(&self) {
        assert_eq!(self.summary().warnings, Vec::<String>::new(), "{}", self.text());
    }
}

fn near(got: f64, expected: f64, within: f64) {
    assert!((got - expected).abs() <= within, "{got}, expected {expected}");
}

#[test]
fn the_two_fluxes_of_a_plain_file() {
    let s = FILE.summary();
    near(s.flux_lm, FLUX_LM, 5e-3);
    near(s.flux_emitted_lm, EMITTED_LM, 5e-3);
    near(s.flux_emitted_relative.unwrap(), EMITTED_LM / FLUX_LM - 1.0, 3e-6);
    FILE.is_silent();
}

#[test]
fn versions_in_other_spellings_name_their_edition() {
    // Field 12 of 0.9 is a factor in 1986 and 1991 alone.
    let with = EMITTED_LM * 0.9;
    for (head, revision, emitted_lm) in [
        ("IESNA:LM-63-91", Revision::Y1991, with),
        ("IES:LM-63-91", Revision::Y1991, with),
        ("IESNA LM-63-1991", Revision::Y1991, with),
        ("IESNA:LM-63-86", Revision::Y1986, with),
        ("IESNA:LM-63-95", Revision::Y1995, EMITTED_LM),
        ("IESNA:LM-63-02", Revision::Y2002, EMITTED_LM),
        ("IESNA LM-63-2002", Revision::Y2002, EMITTED_LM),
        ("IESNA-LM-63-2002", Revision::Y2002, EMITTED_LM),
        ("IESNA_LM63_2002", Revision::Y2002, EMITTED_LM),
        ("LM-63-2002", Revision::Y2002, EMITTED_LM),
        ("IES LM-63-19", Revision::Y2019, EMITTED_LM),
    ] {
        let head = format!("{head}\n[TEST] made up");
        let file = File { head: &head, field12: "0.9", ..FILE };
        assert_eq!(file.read().format, Format::Lm63(revision), "{head}");
        near(file.summary().flux_emitted_lm, emitted_lm, 5e-3);
        let warnings = file.summary().warnings;
        let said = format!("the rules of {}", revision.name());
        assert!(warnings[0].contains("a.ies:1:1") && warnings[0].contains(&said), "{warnings:?}");
    }
}

#[test]
fn a_version_line_need_not_be_the_first() {
    for (head, line, revision, emitted_lm) in [
        ("* written by a tool\nIESNA:LM-63-2002", 2, Revision::Y2002, EMITTED_LM),
        ("a\n\n[TEST] b\nIESNA:LM-63-1995", 4, Revision::Y1995, EMITTED_LM),
        ("IES file of a tool\nIESNA91", 2, Revision::Y1991, EMITTED_LM * 0.9),
        ("written\rIESNA:LM-63-02", 2, Revision::Y2002, EMITTED_LM),
    ] {
        let file = File { head, field12: "0.9", ..FILE };
        assert_eq!(file.read().format, Format::Lm63(revision), "{head}");
        near(file.summary().flux_emitted_lm, emitted_lm, 5e-3);
        let warnings = file.summary().warnings;
        let place = format!("a.ies:{line}:1");
        assert!(warnings[0].contains(&place) && warnings[0].contains("first one"), "{warnings:?}");
    }
    // Words about the standard are no version line: without one it is 1986.
    for head in
        ["made by hand\nIES file of a tool", "maker\nLM-63-1995 is not followed", "[TEST] IESNA:LM-63-2002"]
    {
        let file = File { head, field12: "0.9", ..FILE };
        assert_eq!(file.read().format, Format::Lm63(Revision::Y1986), "{head}");
        near(file.summary().flux_emitted_lm, EMITTED_LM * 0.9, 5e-3);
    }
    let two = File { head: "IESNA:LM-63-2002\nIESNA91", ..FILE };
    assert_eq!(two.read().format, Format::Lm63(Revision::Y2002));
    assert!(two.warning().contains("one version line"), "{}", two.warning());
}

#[test]
fn more_light_than_the_lamps_have_is_told() {
    let at = |lumens: f64| format!("2 {}", lumens / 2.0);
    for (lamps_lm, doubted) in
        [(500.0, true), (FLUX_LM / 1.16, true), (FLUX_LM / 1.14, false), (6000.0, false)]
    {
        let lamps = at(lamps_lm);
        let file = File { lamps: &lamps, ..FILE };
        let s = file.summary();
        near(s.light_output_ratio.unwrap(), FLUX_LM / lamps_lm, 1e-5 * FLUX_LM / lamps_lm);
        assert_eq!((s.lamps, s.lumens_per_lamp, s.lamps_lm), (2.0, Some(lamps_lm / 2.0), Some(lamps_lm)));
        assert_eq!(s.warnings.len(), usize::from(doubted), "{:?}", s.warnings);
        assert!(
            !doubted || s.warnings[0].contains("4107.6 lm in the table, out of lamps"),
            "{:?}",
            s.warnings
        );
        // The intensities are the table's, whatever the lamps have.
        near(s.flux_emitted_lm, EMITTED_LM, 5e-3);
    }
    assert_eq!(FILE.summary().light_output_ratio, None);
}

/// Three planes, H = 90 ten times the others.
const PLANES: &str = "100 100 90 80 60 30 0\n1000 1000 900 800 600 300 0\n100 100 90 80 60 30 0";

/// The first plane's nadir differs from the second's in these files: that warning apart, the words of the others.
fn other_warnings(s: &Summary) -> Vec<&String> {
    s.warnings.iter().filter(|w| !w.contains("which is one direction")).collect()
}

#[test]
fn noise_about_multiples_of_90_is_none() {
    let exact = File { h: "0 90 180", candela: PLANES, ..FILE }.summary();
    near(exact.flux_lm, 1922.74, 5e-3);
    assert_eq!((exact.symmetry, other_warnings(&exact).len()), ("bilateral 0-180", 0));
    for h in ["0 90 180.00001", "0 90 179.9995", "0 90.0009 180", "-0.00001 90 180"] {
        let s = File { h, candela: PLANES, ..FILE }.summary();
        assert_eq!(
            (s.flux_lm, s.flux_emitted_lm, s.symmetry),
            (exact.flux_lm, exact.flux_emitted_lm, exact.symmetry)
        );
        assert!(
            s.warnings.iter().any(|w| w.contains("taken for") && w.contains("a.ies:7:")),
            "{:?}",
            s.warnings
        );
    }
    let two = &PLANES[..PLANES.rfind('\n').unwrap()];
    let quadrants = File { h: "0 90", candela: two, ..FILE }.summary();
    assert_eq!(quadrants.symmetry, "quadrants");
    for h in ["0 90.00001", "0 89.9991", "0.0001 90"] {
        let s = File { h, candela: two, ..FILE }.summary();
        assert_eq!((s.flux_lm, s.symmetry), (quadrants.flux_lm, "quadrants"), "{h}");
    }
    // 100 cd all around.
    for v in ["0 90 180.00001", "0 90 179.9995", "-0.0005 90 180", "0 90.0001 180"] {
        let file = File { v, candela: "100 100 100", ..FILE };
        near(file.summary().flux_emitted_lm, 400.0 * std::f64::consts::PI, 1e-9);
        assert!(file.warning().contains("a.ies:6:"), "{}", file.warning());
    }
    // Beyond 0.001 degrees they are what they are.
    let error = photometric::parse(File { h: "0 90.002", candela: two, ..FILE }.text().as_bytes(), "a.ies")
        .unwrap_err();
    assert_eq!((error.kind(), error.line()), (Kind::Range, Some(7)), "{error}");
    let close = File { h: "0 90 90.0005 180", candela: &format!("{PLANES}\n{CANDELA}"), ..FILE };
    assert_eq!(close.read().web.horizontal_deg, [0.0, 90.0, 90.0005, 180.0]);
}

#[test]
fn planes_counted_from_minus_180_are_turned() {
    let plane = |share: f64| {
        let values = [1000.0, 1000.0, 900.0, 800.0, 600.0, 300.0, 0.0].map(|c| format!("{}", c * share));
        values.join(" ")
    };
    let planes = |shares: &[f64]| shares.iter().map(|&s| plane(s)).collect::<Vec<_>>().join("\n");
    for (signed, shares, turned, turned_shares) in [
        (
            "-180 -90 0 90 180",
            &[0.1, 0.5, 1.0, 0.4, 0.1][..],
            "0 90 180 270 360",
            &[1.0, 0.4, 0.1, 0.5, 1.0][..],
        ),
        ("-180 -90 0 90", &[0.1, 0.5, 1.0, 0.4], "0 90 180 270 360", &[1.0, 0.4, 0.1, 0.5, 1.0]),
        ("-90 0 90 180", &[0.5, 1.0, 0.4, 0.1], "0 90 180 270 360", &[1.0, 0.4, 0.1, 0.5, 1.0]),
        ("-180 -60 60 180", &[0.1, 0.5, 1.0, 0.1], "60 180 300", &[1.0, 0.1, 0.5]),
        (
            "-180.00001 -90 0 90 180",
            &[0.1, 0.5, 1.0, 0.4, 0.1],
            "0 90 180 270 360",
            &[1.0, 0.4, 0.1, 0.5, 1.0],
        ),
    ] {
        let (candela, turned_candela) = (planes(shares), planes(turned_shares));
        let file = File { h: signed, candela: &candela, ..FILE };
        let expected = File { h: turned, candela: &turned_candela, ..FILE }.read();
        assert_eq!(file.read().web, expected.web, "{signed}");
        let summary = file.summary();
        assert!(summary.warnings.iter().any(|w| w.contains("read as 0..360")), "{:?}", summary.warnings);
    }
    let differs =
        File { h: "-180 -90 0 90 180", candela: &planes(&[0.2, 0.5, 1.0, 0.4, 0.1]), ..FILE }.summary();
    let seam = "planes H = -180 and H = 180 that differ by up to 100 cd";
    assert!(differs.warnings.iter().any(|w| w.contains(seam)), "{:?}", differs.warnings);
    // Half a circle below 0 is none of the ranges, and is refused as before.
    let half = File { h: "-180 -90 0", candela: PLANES, ..FILE };
    assert!(photometric::parse(half.text().as_bytes(), "a.ies").is_err());
}

#[test]
fn a_whole_turn_of_types_a_and_b_is_silent() {
    let five = ["100 100 100 100 100"; 5].join("\n");
    let (turn, half) = ("-180 -90 0 90 180", "-90 -45 0 45 90");
    // 100 cd all around: 4 pi x 100 lm.
    for (kind, v, h) in [
        (2, turn, half),
        (3, half, turn),
        (2, "0 45 90 135 180", half),
        (2, "-180 -90 0 90 180", "0 22 45 66 90"),
    ] {
        let file = File { kind, v, h, candela: &five, ..FILE };
        near(file.summary().flux_emitted_lm, 400.0 * std::f64::consts::PI, 1e-9);
        file.is_silent();
    }
    // An end between is doubted as before.
    let file = File { kind: 2, v: "-170 -90 0 90 180", h: half, candela: &five, ..FILE };
    assert!(file.warning().contains("zero below"), "{}", file.warning());
}

#[test]
fn a_declared_flux_that_cannot_be_read_is_told() {
    for text in ["4.160,0 lm", "4107,6", "4.107.6", "see data sheet", "0"] {
        let head = format!("{}\n[_TOTALLUMINAIRELUMENS] {text}", FILE.head);
        let file = File { head: &head, ..FILE };
        assert_eq!(file.summary().flux_declared_lm, None, "{text}");
        assert!(
            file.warning().contains(text) && file.warning().contains("cannot be read"),
            "{}",
            file.warning()
        );
    }
    for text in ["4107.6", "4,107.6 lm", "4108lm", "4100"] {
        let head = format!("{}\n[_TOTALLUMINAIRELUMENS] {text}", FILE.head);
        File { head: &head, ..FILE }.is_silent();
    }
}

#[test]
fn the_distance_of_the_two_fluxes_is_told_beyond_one_percent() {
    let spot = File { v: "0 5 10 15 20 90", candela: "20000 9000 1200 100 20 0", ..FILE };
    let s = spot.summary();
    near(s.flux_lm, 857.6, 0.05);
    near(s.flux_emitted_lm, 769.8, 0.05);
    near(s.flux_emitted_relative.unwrap(), 769.8 / 857.6 - 1.0, 1.2e-4);
    for part in ["769.8 lm", "857.6 lm", "10.2 % below"] {
        assert!(spot.warning().contains(part), "{part}: {}", spot.warning());
    }
    // One band 0..T that falls to 0: trapezoid pi (1 - cos T), bilinear 2 pi (1 - sin T / T) a candela. Upwards the same.
    for (v, candela, t) in
        [("0 50 90", "1 0 0", 50.0f64), ("0 20 90", "1 0 0", 20.0), ("90 150 180", "0 0 1", 30.0)]
    {
        let file = File { v, candela, ..FILE };
        let t = t.to_radians();
        let relative = 2.0 * (1.0 - t.sin() / t) / (1.0 - t.cos()) - 1.0;
        near(file.summary().flux_emitted_relative.unwrap(), relative, 1e-12);
        assert!(file.warning().contains(&format!("{:.1} % below", -100.0 * relative)), "{}", file.warning());
    }
}

#[test]
fn a_beam_ends_where_it_has_fallen_to_a_half() {
    let beam = |v, candela| {
        let s = File { v, candela, ..FILE }.summary();
        (s.beam_angle_deg.unwrap(), s.field_angle_deg.unwrap())
    };
    let plateau = beam("0 10 20 30 40 90", "100 50 50 50 20 0");
    assert_eq!(plateau.0, 20.0);
    // A tenth: 40 + 50 x 10 / 20.
    near(plateau.1, 130.0, 1e-12);
    near(beam("0 10 20 30 40 90", "300 300 30 30 30 0").1, 40.0, 1e-12);
    assert_eq!(beam("0 10 20 30 90", "100 80 50 50 0").0, 40.0);
    assert_eq!(beam("90 160 170 180", "0 50 50 100").0, 20.0);
    near(beam("0 10 20 30 90", "100 80 51 50 0").0, 60.0, 1e-12);
    // A multiplier that rounds both: still the plateau.
    let text = File { v: "0 10 20 30 40 90", candela: "300 300 30 30 30 0", ..FILE }.text();
    let scaled = photometric::parse(text.replace("1 -1 1 ", "1 -1 1.1 ").as_bytes(), "a.ies").unwrap();
    near(Summary::new(&scaled).field_angle_deg.unwrap(), 40.0, 1e-12);
}

#[test]
fn both_principal_planes_have_their_beam() {
    let s = File { v: "0 15 30 60 90", h: "0 90", candela: "1000 900 100 10 0\n1000 990 900 700 0", ..FILE }
        .summary();
    // Half of 1000: in C0 at 15 + 15 x 400 / 800, in C90 at 60 + 30 x 200 / 700.
    near(s.beam_angle_deg.unwrap(), 45.0, 1e-12);
    near(s.beam_angle_across_deg.unwrap(), 2.0 * (60.0 + 30.0 * 2.0 / 7.0), 1e-12);
    let turned =
        File { v: "0 15 30 60 90", h: "0 90", candela: "1000 990 900 700 0\n1000 900 100 10 0", ..FILE }
            .summary();
    assert_eq!(
        (turned.beam_angle_deg, turned.beam_angle_across_deg),
        (s.beam_angle_across_deg, s.beam_angle_deg)
    );
    let round = File { v: "0 40 90", candela: "1000 0 0", ..FILE }.summary();
    assert_eq!((round.beam_angle_deg, round.beam_angle_across_deg), (Some(40.0), Some(40.0)));
    // Type B: 10 degrees up and down, 40 left and right.
    let flood = File { kind: 2, v: "-10 0 10", h: "0 40", candela: "0 100 0\n0 0 0", ..FILE }.summary();
    assert_eq!((flood.beam_angle_deg, flood.beam_angle_across_deg), (Some(40.0), Some(10.0)));
}

#[test]
fn several_intensities_of_one_direction_are_told() {
    let down = "1000 900 600 200 0\n500 900 600 200 0\n100 900 600 200 0";
    let up = "0 200 600 900 1000\n0 200 600 900 1000\n0 200 600 900 998.9";
    for (kind, v, h, candela, said) in [
        (1, "0 20 45 70 90", "0 45 90", down, "100 to 1000 cd at vertical angle 0"),
        (1, "90 110 135 160 180", "0 45 90", up, "998.9 to 1000 cd at vertical angle 180"),
        (3, "-90 -45 0 45 90", "-90 0 90", down, "100 to 1000 cd at vertical angle -90"),
        (
            2,
            "-90 0 90",
            "-90 -45 0 45 90",
            "3 9 3\n9 9 9\n9 9 9\n9 9 9\n9 9 9",
            "3 to 9 cd at horizontal angle -90",
        ),
    ] {
        let warnings = File { kind, v, h, candela, ..FILE }.summary().warnings;
        assert!(warnings.iter().any(|w| w.contains(said)), "{said}: {warnings:?}");
    }
    // Within 0.1 % of the maximum it is noise.
    let noise = up.replace("998.9", "999.1");
    let s = File { v: "90 110 135 160 180", h: "0 45 90", candela: &noise, ..FILE }.summary();
    assert!(s.warnings.iter().all(|w| !w.contains("one direction")), "{:?}", s.warnings);
}

#[test]
fn commas_of_numbers_are_refused_with_place_and_remedy() {
    let decimal = "1000,0 966,0 1083,0 957,0 717,0 384,0 0,0";
    let thousands = "3,000 2,898 3,249 2,871 2,151 1,152 0";
    let five = "300,0000 298,8584 295,4423 289,7777 281,9078 271,8923 0,0000";
    for candela in [decimal, thousands, five, &decimal.replace(' ', "\n"), "1,000.5 966 1083 957 717 384 0"] {
        let error = photometric::parse(File { candela, ..FILE }.text().as_bytes(), "a.ies").unwrap_err();
        let first = candela.split_ascii_whitespace().next().unwrap();
        assert_eq!((error.line(), error.column()), (Some(8), Some(1)), "{error}");
        assert!(
            error.found().contains(first) && error.advice().unwrap().contains("decimal comma"),
            "{error}"
        );
    }
}
