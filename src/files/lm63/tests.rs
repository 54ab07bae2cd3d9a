//! Every quirk on a small file of its own.

use crate::error::Diagnostic;
use crate::files::lm63::*;
use crate::files::photometric::{parse, read};
use crate::photometry::opening::OpeningShape;
use crate::photometry::web::Symmetry;
use crate::photometry::{Format, PhotometricType, Revision, Summary, Tilt, TiltTable};

/// A small file in parts, so that each test changes one of them.
#[derive(Clone)]
struct Small<'a> {
    version: &'a str,
    label: &'a str,
    tilt: &'a str,
    ten: &'a str,
    three: &'a str,
    vertical: &'a str,
    horizontal: &'a str,
    candela: &'a str,
    after: &'a str,
}

/// 100 cd at the nadir, 50 at 45 degrees, 0 at 90; one plane; 2002; no warnings.
const SMALL: Small = Small {
    version: "IESNA:LM-63-2002",
    label: "[TEST] small",
    tilt: "TILT=NONE",
    ten: "1 -1 1 3 1 1 2 0 0 0",
    three: "1 1 10",
    vertical: "0 45 90",
    horizontal: "0",
    candela: "100 50 0",
    after: "",
};

impl Small<'_> {
    fn text(&self) -> String {
        [
            self.version,
            self.label,
            self.tilt,
            self.ten,
            self.three,
            self.vertical,
            self.horizontal,
            self.candela,
            self.after,
        ]
        .join("\n")
    }

    /// Without the warning that a table of 45 degrees is coarse, which has tests of its own (tests/readers).
    fn read(&self) -> Photometry {
        but_for_its_steps(parse(self.text().as_bytes(), "small.ies").unwrap())
    }

    fn refused(&self) -> Diagnostic {
        let error = parse(self.text().as_bytes(), "small.ies").unwrap_err();
        assert_eq!(error.file(), Some("small.ies"));
        assert!(error.line().is_some() && error.column().is_some(), "no place: {error}");
        error
    }

    /// The warnings, which must all have a place except those about the whole file.
    fn warnings(&self) -> Vec<String> {
        self.read().warnings.iter().map(ToString::to_string).collect()
    }

    fn warns_of(&self, what: &str) {
        let warnings = self.warnings();
        assert!(warnings.iter().any(|w| w.contains(what)), "{what}: {warnings:?}");
    }
}

fn but_for_its_steps(mut photometry: Photometry) -> Photometry {
    photometry.warnings.retain(|w| !w.found().contains("of the trapezoid"));
    photometry
}

fn at(error: &Diagnostic) -> (Kind, usize, usize) {
    (error.kind(), error.line().unwrap(), error.column().unwrap())
}

#[test]
fn a_plain_file_reads_without_warnings() {
    let p = SMALL.read();
    assert_eq!(p.warnings, []);
    assert_eq!(
        (p.format, &p.tilt, p.lamps, p.lumens_per_lamp),
        (Format::Lm63(Revision::Y2002), &Tilt::None, 1.0, None)
    );
    assert_eq!((p.multiplier, p.ballast_factor, p.field12, p.input_watts), (1.0, 1.0, 1.0, 10.0));
    assert_eq!(p.web.photometric_type, PhotometricType::C);
    assert_eq!(
        (p.web.vertical_deg.as_slice(), p.web.horizontal_deg.as_slice()),
        (&[0.0, 45.0, 90.0][..], &[0.0][..])
    );
    assert_eq!(p.web.candela, [100.0, 50.0, 0.0]);
    assert_eq!(p.label("test"), Some("small"));
}

#[test]
fn every_encoding_and_line_end_gives_the_same_numbers() {
    let text = SMALL.text();
    let plain = SMALL.read();
    let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let mixed = text.replacen('\n', "\r\n", 3).replacen("NONE\n", "NONE\r", 1);
    for bytes in [
        text.replace('\n', "\r").into_bytes(),
        text.replace('\n', "\r\n").into_bytes(),
        mixed.into_bytes(),
        [&[0xef, 0xbb, 0xbf], text.as_bytes()].concat(),
        [&[0xff, 0xfe], utf16.as_slice()].concat(),
        utf16,
        text.replace("100 50 0", "1E2,50.0\t,\t0.").into_bytes(),
        text.replace(' ', "\n").replace("[TEST]\n", "[TEST] ").into_bytes(),
        format!("\n\n  {text}\u{1a}\0\0").into_bytes(),
    ] {
        let p = but_for_its_steps(parse(&bytes, "small.ies").unwrap());
        assert_eq!((&p.web, &p.labels, &p.warnings), (&plain.web, &plain.labels, &plain.warnings));
    }
    // 0xA0 and 0x96 of Windows-1252; Shift-JIS katakana.
    for label in [b"[TEST] a\xa0b\x96".as_slice(), b"[MANUFAC] \x8eO\x95H\x83d\x8b@".as_slice()] {
        let bytes = [b"IESNA91\n", label, &text.as_bytes()[text.find("\nTILT").unwrap()..]].concat();
        assert_eq!(but_for_its_steps(parse(&bytes, "small.ies").unwrap()).web, plain.web);
    }
}

#[test]
fn field_12_is_a_factor_in_1986_and_1991_only() {
    for (version, factor, warnings) in [
        ("a free label", 0.45, 0),
        ("IESNA91", 0.45, 0),
        ("IESNA:LM-63-1995", 0.5, 1),
        ("IESNA:LM-63-2002", 0.5, 1),
        ("IES:LM-63-2019", 0.5, 1),
        ("IES:LM-63-2040", 0.5, 2),
    ] {
        let p = Small { version, three: "0.5 0.9 10", ..SMALL }.read();
        assert_eq!((p.factor(), p.warnings.len()), (factor, warnings), "{version}: {:?}", p.warnings);
        let summary = Summary::new(&p);
        assert!((summary.flux_with_factors_lm - factor * summary.flux_lm).abs() < 1e-12);
    }
    let p = Small { version: "IES:LM-63-2019", three: "1 1.1 10", ..SMALL }.read();
    assert_eq!((p.factor(), p.field12_text.as_str(), p.warnings.len()), (1.0, "1.1", 0));
    assert_eq!(generation_type("1.10000"), Some("test at an accredited laboratory"));
    assert_eq!(generation_type("0.9"), None);
}

#[test]
fn the_multiplier_scales_and_zero_is_dark_with_a_warning() {
    let p = Small { ten: "1 1000 2.5 3.0 1.0 1.0 2 0 0 0", ..SMALL }.read();
    assert_eq!((p.web.candela.as_slice(), p.lumens_per_lamp), (&[250.0, 125.0, 0.0][..], Some(1000.0)));
    let dark = Small { ten: "1 -1 0 3 1 1 2 0 0 0", ..SMALL };
    assert_eq!(Summary::new(&dark.read()).flux_lm, 0.0);
    dark.warns_of("flux is 0");
    assert_eq!(at(&Small { ten: "1 -1 -2 3 1 1 2 0 0 0", ..SMALL }.refused()), (Kind::Range, 4, 6));
}

#[test]
fn tilt_is_read_and_is_no_part_of_the_table() {
    let p = Small { tilt: " Tilt = Include\n1\n3\n0 45 90\n1 .9 .8", ..SMALL }.read();
    let table = TiltTable { geometry: 1, angles_deg: vec![0.0, 45.0, 90.0], factors: vec![1.0, 0.9, 0.8] };
    assert_eq!((p.tilt, p.web, p.warnings.len()), (Tilt::Include(table.clone()), SMALL.read().web, 0));
    assert_eq!(p_factor(&Small { tilt: "TILT=INCLUDE\n1\n2\n0 90\n.5 1", ..SMALL }), (0.5, 0.75));
    Small { tilt: "TILT=INCLUDE\n1\n2\n0 90\n.5 1", ..SMALL }.warns_of("tilt factor .5 at 0 degrees");
    let below = Small { tilt: "TILT=INCLUDE\n1\n2\n0 90\n1 -.5", ..SMALL };
    assert_eq!(at(&below.refused()), (Kind::Range, 7, 3));
    let missing = Small { tilt: "TILT=FILE lamp.tlt", ..SMALL };
    assert_eq!(missing.read().tilt, Tilt::File { name: "lamp.tlt".into(), table: None });
    missing.warns_of("lamp.tlt");
    assert_eq!(at(&Small { tilt: "TILT=INCLUDE\n1\n3000000000\n", ..SMALL }.refused()), (Kind::Limit, 5, 1));
    assert_eq!(at(&Small { tilt: "TILT=  ", ..SMALL }.refused()), (Kind::Missing, 3, 8));
    Small { tilt: "TILT=INCLUDE 1 2 0 90 .5 1", ..SMALL }.refused();

    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("lamp.tlt"), "1 3 0,45,90 1 .9 .8").unwrap();
    let path = folder.path().join("a.ies");
    std::fs::write(&path, Small { tilt: "TILT=C:\\LAMPS\\lamp.tlt", ..SMALL }.text()).unwrap();
    let p = but_for_its_steps(read(&path).unwrap());
    assert_eq!(p.tilt, Tilt::File { name: "C:\\LAMPS\\lamp.tlt".into(), table: Some(table) });
    assert_eq!((p.file, p.warnings.len()), (path.display().to_string(), 0));
    assert_eq!(read(folder.path().join("none.ies")).unwrap_err().kind(), Kind::Io);
}

/// The factor of a small file that is not tilted, and at 45 degrees.
fn p_factor(small: &Small<'_>) -> (f64, f64) {
    let p = small.read();
    (p.factor(), p.factor_at_tilt(45.0).unwrap())
}

#[test]
fn damaged_numbers_are_refused_at_their_place() {
    for (candela, kind, column) in [
        ("100 nan 0", Kind::Syntax, 5),
        ("100 inf 0", Kind::Syntax, 5),
        ("100 50; 0", Kind::Syntax, 5),
        ("1.0D+02 50 0", Kind::Syntax, 1),
        ("100 1e400 0", Kind::Range, 5),
        ("100 1e31 0", Kind::Limit, 5),
        ("100 -1 0", Kind::Range, 5),
        ("100 50", Kind::Missing, 7),
        ("100 50 END", Kind::Syntax, 8),
    ] {
        assert_eq!(at(&Small { candela, ..SMALL }.refused()), (kind, 8, column), "{candela}");
    }
    let noise = Small { candela: "100 50 -0.05", ..SMALL };
    assert_eq!(noise.read().web.candela, [100.0, 50.0, 0.0]);
    noise.warns_of("negative");
}

#[test]
fn counts_are_bounded_before_memory_is_asked_for() {
    for (ten, kind, column) in [
        ("1 -1 1 2147483647 2147483647 1 2 0 0 0", Kind::Limit, 8),
        ("1 -1 1 0 1 1 2 0 0 0", Kind::Range, 8),
        ("1 -1 1 3.5 1 1 2 0 0 0", Kind::Range, 8),
        ("1 -1 1 3 -1 1 2 0 0 0", Kind::Range, 10),
        ("1 -1 1 3 1 4 2 0 0 0", Kind::Range, 12),
        ("1 -1 1 3 1 1 0 0 0 0", Kind::Range, 14),
    ] {
        assert_eq!(at(&Small { ten, ..SMALL }.refused()), (kind, 4, column), "{ten}");
    }
    let error = Small { ten: "1 -1 1 99999 99999 1 2 0 0 0", ..SMALL }.refused();
    assert_eq!(error.kind(), Kind::Missing);
    let error = Small { three: "", ..SMALL }.refused();
    assert!(error.advice().unwrap().contains("three"), "{error}");
}

#[test]
fn angles_must_rise_within_their_type() {
    assert_eq!(at(&Small { vertical: "0 90 45", ..SMALL }.refused()), (Kind::Range, 6, 6));
    assert_eq!(at(&Small { vertical: "25 25 25", ..SMALL }.refused()), (Kind::Range, 6, 4));
    assert_eq!(at(&Small { vertical: "0 90 200", ..SMALL }.refused()), (Kind::Range, 6, 6));
    assert_eq!(at(&Small { vertical: "-10 45 90", ..SMALL }.refused()), (Kind::Range, 6, 1));
    Small { vertical: "0 45 80", ..SMALL }.warns_of("zero beyond");
    Small { vertical: "5 45 90", ..SMALL }.warns_of("zero below");
    Small { horizontal: "45", ..SMALL }.warns_of("one plane");
    let two = |horizontal| Small { ten: "1 -1 1 3 2 1 2 0 0 0", horizontal, candela: "9 5 1 9 4 1", ..SMALL };
    for (horizontal, symmetry) in [
        ("0 90", Symmetry::Quadrants),
        ("0 180", Symmetry::Bilateral0To180),
        ("90 270", Symmetry::Bilateral90To270),
        ("0 360", Symmetry::None),
        ("0 345", Symmetry::None),
    ] {
        assert_eq!(two(horizontal).read().web.symmetry(), symmetry);
    }
    two("90 270").warns_of("90..270");
    two("0 360").warns_of("H = 0 and H = 360");
    assert_eq!(Small { candela: "9 5 1 9 5 1", ..two("0 360") }.warnings().len(), 0);
    assert_eq!(at(&two("0 45").refused()), (Kind::Range, 7, 3));
    assert_eq!(at(&two("-90 90").refused()), (Kind::Range, 7, 1));
    let b = |vertical, horizontal| Small {
        ten: "1 -1 1 2 2 2 2 0 0 0",
        vertical,
        horizontal,
        candela: "9 5 1 9",
        ..SMALL
    };
    assert_eq!(b("-90 90", "-90 90").read().web.photometric_type, PhotometricType::B);
    assert_eq!(b("0 90", "0 90").read().web.symmetry(), Symmetry::LeftRightUpDown);
    b("-90 90", "-90 40").warns_of("zero beyond");
    assert_eq!(at(&b("-90 90", "-90 100").refused()), (Kind::Range, 7, 5));
}

#[test]
fn what_stands_behind_the_table_is_named() {
    assert_eq!(Small { after: "\u{1a}", ..SMALL }.warnings(), Vec::<String>::new());
    Small { after: "END", ..SMALL }.warns_of("\"END\"");
    Small { after: "7 8 9", ..SMALL }.warns_of("3 surplus numbers");
    Small { after: "\u{1a}more", ..SMALL }.warns_of("end-of-file mark");
    let second = SMALL.text();
    Small { after: &second, ..SMALL }.warns_of("another luminaire");
}

#[test]
fn the_declared_flux_is_compared() {
    // Trapezoid: 2 pi (75 (1 - cos 45) + 25 cos 45) = 249.096 lm.
    let exact = std::f64::consts::TAU * (75.0 * (1.0 - 0.5f64.sqrt()) + 25.0 * 0.5f64.sqrt());
    assert!((Summary::new(&SMALL.read()).flux_lm - exact).abs() < 1e-12 * exact);
    let right = Small { label: "[_TOTALLUMINAIRELUMENS] 249.1", ..SMALL };
    assert_eq!((right.read().flux_declared_lm, right.warnings().len()), (Some(249.1), 0));
    Small { label: "[_TotalLuminaireLumens]251", ..SMALL }.warns_of("251");
}

#[test]
fn openings_are_metres_and_unknown_signs_a_warning() {
    let p = Small { ten: "1 -1 1 3 1 1 1 -2 -2 0", ..SMALL }.read();
    assert_eq!(
        (p.opening.shape, p.opening.size_m, p.warnings.len()),
        (OpeningShape::Disk, [0.6096, 0.6096, 0.0], 0)
    );
    Small { ten: "1 -1 1 3 1 1 2 1 1 -1", ..SMALL }.warns_of("++-");
}

#[test]
fn values_that_scale_nothing_are_warned_about() {
    Small { ten: "0 -1 1 3 1 1 2 0 0 0", ..SMALL }.warns_of("number of lamps");
    Small { ten: "1 -5 1 3 1 1 2 0 0 0", ..SMALL }.warns_of("lumens per lamp");
    Small { three: "1 1 -4", ..SMALL }.warns_of("input watts");
    assert_eq!(at(&Small { three: "-1 1 4", ..SMALL }.refused()), (Kind::Range, 5, 1));
}
