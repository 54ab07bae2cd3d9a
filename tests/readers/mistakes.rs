//! Mistakes of new users: what is said of them names the mistake and the remedy.

use caustix::error::{Diagnostic, Kind};
use caustix::files::bytes::Base;
use caustix::files::obj::{ObjOptions, parse_obj};
use caustix::files::photometric;
use caustix::files::scene_toml;
use caustix::photometry::Summary;
use std::path::Path;

use crate::broken_scene::{LAMP, emitter, expect, read};

/// A lamp of 30 degrees steps; `numbers` writes its candela.
fn lamp(candela: &str, opening: &str) -> String {
    format!(
        "IESNA:LM-63-2002\n[TEST] made up\nTILT=NONE\n1 -1 1 4 1 1 2 {opening} {opening} 0\n1 1 10\n0 30 60 90\n0\n{candela}\n"
    )
}

fn ies(text: &str) -> Result<caustix::photometry::Photometry, Diagnostic> {
    photometric::parse(text.as_bytes(), "a.ies")
}

#[test]
fn commas_within_numbers_of_a_photometric_file_are_refused() {
    let plain = ies(&lamp("1000.5 866 500 0", "0.1")).unwrap();
    // Of the trapezoid, by hand: bands of cos V, mean of their ends, times 2 pi.
    let band =
        |a: f64, b: f64, va: f64, vb: f64| 0.5 * (a + b) * (va.to_radians().cos() - vb.to_radians().cos());
    let sum = band(1000.5, 866.0, 0.0, 30.0) + band(866.0, 500.0, 30.0, 60.0) + band(500.0, 0.0, 60.0, 90.0);
    let flux_lm = Summary::new(&plain).flux_lm;
    assert!((flux_lm / (std::f64::consts::TAU * sum) - 1.0).abs() < 1e-12, "{flux_lm}");
    for (candela, opening, place) in [
        ("1000,5 866,0 500,0 0,0", "0.1", (8, 1)),
        ("1,000.5 866 500 0", "0.1", (8, 1)),
        ("1000,5\n866\n500\n0", "0.1", (8, 1)),
        ("1000 866 500 0", "0,1", (4, 16)),
        ("1000,5 866,0 500,0 0,0", "-0,1", (4, 16)),
    ] {
        let error = ies(&lamp(candela, opening)).unwrap_err();
        assert_eq!((error.kind(), error.line().zip(error.column())), (Kind::Syntax, Some(place)), "{error}");
        assert!(error.advice().unwrap().contains("decimal comma"), "{error}");
    }
    // A tilt table before the numbers.
    let tilted = lamp("1000,5 866 500 0", "0.1").replace("NONE", "INCLUDE\n1 2 0 90 1 0,9");
    assert_eq!(ies(&tilted).unwrap_err().line(), Some(4));
}

#[test]
fn commas_between_numbers_of_a_photometric_file_part_them() {
    let plain = ies(&lamp("1000 866 500 0", "0.1")).unwrap();
    let text = lamp("1000 866 500 0", "0.1");
    let (head, numbers) = text.split_at(text.find("1 -1").unwrap());
    for with in [",", ", ", " ,"] {
        let commas = format!("{head}{}", numbers.replace(' ', with));
        let read = ies(&commas).unwrap();
        // The one warning of each: 30 degrees are coarse.
        assert_eq!((read.web, read.warnings), (plain.web.clone(), plain.warnings.clone()), "{commas}");
    }
    // Real files put numbers of one record close: surplus ones are told as before.
    let surplus = ies(&lamp("1000,866,500,0 7 8,9", "0.1")).unwrap();
    assert_eq!(surplus.web, plain.web);
    assert!(surplus.warnings[0].found().contains("3 surplus numbers"), "{:?}", surplus.warnings);
}

#[test]
fn files_of_another_format_are_named() {
    // A EULUMDAT file, whatever it is called, that ends too early, or has commas: by its own reader.
    let ldt = "maker\r\n1\r\n1\r\n19\r\n10\r\n19\r\n5\r\nr\r\nlum\r\nno\r\nf.ldt\r\n2024\r\n";
    for text in [ldt.to_owned(), ldt.replace("\r\n5\r\n", "\r\n5,0\r\n")] {
        let error = ies(&text).unwrap_err();
        assert_eq!((error.kind(), error.line()), (Kind::Missing, Some(12)), "{error}");
        assert_eq!(error.found(), "the end of the file");
        assert_eq!(error.required(), "a line: length of the luminaire");
    }
    let error = ies("<?xml version=\"1.0\"?><IESTM33-22>").unwrap_err();
    assert_eq!((error.kind(), error.found()), (Kind::Unavailable, "an IES TM-33 file (XML)"));
    assert!(error.advice().unwrap().contains("convert the file to IES LM-63 or EULUMDAT"), "{error}");
    let mesh = |bytes: &[u8]| parse_obj(bytes, Path::new("a.obj"), &ObjOptions::default());
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let mut binary = vec![0u8; 80];
    binary.extend(1u32.to_le_bytes());
    binary.extend([0u8; 50]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nend_header\n";
    for (bytes, what) in [(text.as_bytes(), "STL"), (&binary, "STL"), (ply.as_bytes(), "PLY")] {
        let error = mesh(bytes).unwrap_err();
        assert_eq!(error.kind(), Kind::Unavailable, "{error}");
        assert!(error.found().contains(what) && error.advice().unwrap().contains("OBJ"), "{error}");
    }
    let triangle = "v 0 0 0\nv 3 0 0\nv 0 4 0\nf 1 2 3\n";
    for marked in ["", "\u{feff}"] {
        let (mesh, warnings) = mesh(format!("{marked}{triangle}").as_bytes()).unwrap();
        assert_eq!((mesh.vertices().len(), mesh.area(), warnings.len()), (3, 6.0, 0));
    }
}

/// The only error of a text of TOML.
fn refused(text: &str) -> Diagnostic {
    let errors = read(text).expect_err("the scene should be refused");
    assert_eq!(errors.len(), 1, "{errors:#?}");
    errors[0].clone()
}

#[test]
fn backslashes_of_paths_are_named() {
    for path in [r"C:\Users\me\spot.ies", r"..\ies\spot.ies", r"..\obj\tumbler.obj"] {
        let error = refused(&format!("{LAMP}file = \"{path}\"\n"));
        assert_eq!((error.line(), error.kind()), (Some(5), Kind::Syntax), "{error}");
        assert!(error.required().contains("single quotes"), "{error}");
        // As it stands in the file, not escaped once more.
        assert!(error.found().contains(&format!("`file = \"{path}\"`")), "{error}");
    }
    // \t is an escape: the file is looked for by a name with a TAB in it.
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("a.toml");
    let lamp = "[[emitter]]\ntype = \"photometric\"\nposition = [0, 0, 1]\nfile = \"\\tumbler.ies\"\n";
    std::fs::write(&scene, emitter(lamp)).unwrap();
    let errors = scene_toml::read(&scene).unwrap_err();
    assert!(errors[0].found().contains(r"/\tumbler.ies`"), "{}", errors[0]);
    assert!(errors[0].advice().unwrap().contains("single quotes"), "{}", errors[0]);
    // In single quotes it is a name as any other, and so is what is missing.
    std::fs::write(&scene, emitter(&lamp.replace("\"\\tumbler.ies\"", "'.\\tumbler.ies'"))).unwrap();
    let errors = scene_toml::read(&scene).unwrap_err();
    assert!(!errors[0].advice().unwrap().contains("single quotes"), "{}", errors[0]);
}

#[test]
fn commas_and_quotes_of_numbers_are_named() {
    for (line, word) in [
        ("flux_lm = 1000,", "no comma after a value"),
        ("name = \"lamp\",", "no comma after a value"),
        ("aim = [0, 0, -1],", "no comma after a value"),
        ("flux_lm = 1000,5", "decimal point"),
        ("ior = -1,5e0 # glass", "decimal point"),
    ] {
        let error = refused(&format!("[[emitter]]\n{line}\n"));
        assert_eq!(error.line(), Some(2), "{error}");
        assert!(error.required().contains(word), "{line}: {error}");
    }
    let lamp = "[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 1]\nflux_lm = «\"1000\"";
    let flux = "a flux from 1e-9 to 1e12 lm";
    let error = expect(&emitter(lamp), Kind::Syntax, "flux_lm = \"1000\"", flux);
    assert_eq!(error.advice(), Some("write it without quotes: 1000"));
    let error = expect(&emitter(&lamp.replace("1000", "1,5")), Kind::Syntax, "flux_lm = \"1,5\"", flux);
    assert_eq!(error.advice(), Some("write it without quotes: 1.5"));
    let error = expect(&emitter(&lamp.replace("1000", "nan")), Kind::Syntax, "flux_lm = \"nan\"", flux);
    assert_eq!(error.advice(), None);
    let scene = scene_toml::parse(&emitter(LAMP), "a", Base::Directory(".".into()));
    assert!(scene.unwrap().warnings.is_empty());
}
