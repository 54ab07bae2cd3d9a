//! Real photometric files against numbers of other programs and of their makers.
//!
//! The files are not part of the project: the folder is named by CAUSTIX_TEST_DATA, and its `ies/expected.json` says
//! what each should give and who said so.

use caustix::files::photometric;
use caustix::photometry::{Photometry, Summary, flux};
use serde_json::Value;
use std::path::{Path, PathBuf};

use crate::support::data;

fn folder() -> Option<PathBuf> {
    Some(data::real_folder()?.join("ies"))
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// The one file whose maker declares a flux that its own table contradicts (91.6 for 121.1 lm).
const DECLARES_WRONGLY: &str = "permissive/photompy__write_test_full.ies";

/// A row of the table: what was found, and every criterion that was not met.
struct Row {
    line: String,
    faults: Vec<String>,
}

/// Reference fluxes of a file: number, who gave it, relative tolerance, and whether it is a bilinear integral.
fn references(name: &str, expected: &Value) -> Vec<(f64, String, f64, bool)> {
    let mut list = Vec::new();
    let add = |list: &mut Vec<_>, value: &Value, who: &str, tolerance: f64, bilinear: bool| {
        if let Some(flux_lm) = value.as_f64() {
            list.push((flux_lm, who.to_owned(), tolerance, bilinear));
        }
    };
    let by = &expected["ref"];
    add(&mut list, &by["photometric_toolbox"]["flux_lm"], "photometric_toolbox", 1e-5, false);
    if name != DECLARES_WRONGLY {
        add(&mut list, &by["declared_in_file"]["flux_lm"], "declared", 3e-3, false);
    }
    let basis = expected["expected_flux_basis"].as_str().unwrap_or("");
    // luxpy interpolates the table bilinearly and integrates that: compared with the same integral, not with the
    // trapezoid, which differs by 0.25 % for the 10 degree steps of mdl__example_modules.
    // The other bases are the two above again.
    if !basis.starts_with("photompy") && !basis.starts_with("luxpy") && !basis.starts_with("notebook") {
        assert!(!list.is_empty() || basis.is_empty(), "{name}: an unknown reference {basis}");
        return list;
    }
    let tolerance = if basis.starts_with("photompy") { 1e-2 } else { 3e-3 };
    add(&mut list, &expected["expected_flux_lm"], basis, tolerance, basis.starts_with("luxpy"));
    list
}

fn check(name: &str, photometry: &Photometry, expected: &Value) -> Row {
    let summary = Summary::new(photometry);
    let mut faults = Vec::new();
    let (n_v, n_h) = (summary.vertical_angles, summary.horizontal_angles);
    for (what, axis, got) in [("n_v", "v", n_v), ("n_h", "h", n_h)] {
        // Where no two tools agree on the counts, those of the file's own header.
        let header = || expected["survey"][axis][2].as_u64();
        let wanted = expected["expected_angles"][what].as_u64().or_else(header).unwrap();
        if wanted != got as u64 {
            faults.push(format!("{what} {got}, expected {wanted}"));
        }
    }
    let max = expected["expected_max_cd"].as_f64().unwrap_or(summary.max_candela);
    if (summary.max_candela - max).abs() > 1e-12 * max {
        faults.push(format!("max {} cd, expected {max}", summary.max_candela));
    }
    let bilinear = flux::bilinear_lm(&photometry.web.full_grid());
    let references = references(name, expected);
    let mut against = String::new();
    for (reference, who, tolerance, is_bilinear) in &references {
        let flux_lm = if *is_bilinear { bilinear } else { summary.flux_lm };
        let relative = flux_lm / reference - 1.0;
        let who = who.split(' ').next().unwrap_or("");
        against += &format!(
            " {who}{} {reference} | {relative:+.1e} |",
            if *is_bilinear { " (bilinear)" } else { "" }
        );
        if relative.abs() > *tolerance {
            faults.push(format!(
                "flux {flux_lm}, {who} says {reference}: {relative:+.2e}, allowed {tolerance:.0e}"
            ));
        }
    }
    if references.is_empty() {
        against = " - | - |".to_owned();
    }
    let warned = if summary.warnings.is_empty() { "read" } else { "read, warned" };
    let max = summary.max_candela;
    let line = format!("| {name} | {warned} | {n_v} {n_h} | {max:.6} | {:.4} |{against}", summary.flux_lm);
    Row { line, faults }
}

#[test]
fn every_well_formed_file_agrees_and_every_malformed_one_is_refused() {
    let Some(folder) = folder() else { return };
    let expected = json(&folder.join("expected.json"));
    let (mut faults, mut read, mut refused) = (Vec::new(), 0, 0);
    println!("| file | verdict | n_v n_h | max cd | flux lm | reference | rel. difference | ... |");
    println!("|---|---|---|---|---|---|---|---|");
    for (name, entry) in expected["files"].as_object().unwrap() {
        let result = photometric::read(folder.join(name));
        let malformed = entry["verdict"].as_str().unwrap().starts_with("malformed");
        match (result, malformed) {
            (Ok(photometry), false) => {
                read += 1;
                let row = check(name, &photometry, entry);
                println!("{}", row.line);
                faults.extend(row.faults.into_iter().map(|fault| format!("{name}: {fault}")));
            }
            (Err(error), true) => {
                refused += 1;
                let place = format!("{}:{}", error.line().unwrap(), error.column().unwrap());
                println!("| {name} | refused at {place}: {} | | | | | |", error.found());
            }
            (Ok(_), true) => faults.push(format!("{name}: read, must be refused")),
            (Err(error), false) => faults.push(error.to_string()),
        }
    }
    assert_eq!(faults, Vec::<String>::new());
    assert_eq!((read, refused), (75, 7));
}

#[test]
fn a_wrongly_declared_flux_warns_and_no_other_does() {
    let Some(folder) = folder() else { return };
    let expected = json(&folder.join("expected.json"));
    for (name, entry) in expected["files"].as_object().unwrap() {
        let Ok(photometry) = photometric::read(folder.join(name)) else { continue };
        let warned = photometry.warnings.iter().any(|w| w.found().contains("TOTALLUMINAIRELUMENS"));
        assert_eq!(warned, name == DECLARES_WRONGLY, "{name}");
        let declared = entry["ref"]["declared_in_file"]["flux_lm"].as_f64();
        assert_eq!(photometry.flux_declared_lm, declared, "{name}");
    }
}

#[test]
fn derived_files_do_what_their_note_says() {
    let Some(folder) = folder() else { return };
    let list = json(&folder.join("derived/derived.json"));
    let base = photometric::read(folder.join("permissive/rp__pear.ies")).unwrap();
    let base_flux = Summary::new(&base).flux_with_factors_lm;
    let mut seen = 0;
    for entry in list["files"].as_array().unwrap() {
        let name = entry["file"].as_str().unwrap();
        let note = entry["expected"].as_str().unwrap();
        let result = photometric::read(folder.join(name));
        seen += 1;
        if note.starts_with("reject") && !note.contains("or warn") {
            let error = result.expect_err(name);
            let (line, column) = (error.line().unwrap(), error.column().unwrap());
            println!("| {name} | refused at {line}:{column}: {} |", error.found());
            continue;
        }
        let photometry = result.unwrap_or_else(|e| panic!("{e}"));
        let summary = Summary::new(&photometry);
        let factor = match note {
            n if n.contains("x 0.5") => 0.5,
            n if n.contains("x 0.9") => 0.9,
            n if n.contains("flux 0") => 0.0,
            _ => 1.0,
        };
        let got = summary.flux_with_factors_lm;
        assert!((got - factor * base_flux).abs() <= 1e-12 * base_flux, "{name}: {got}");
        if factor != 0.0 {
            assert_eq!(photometry.web, base.web, "{name}");
        }
        let must_warn = note.contains("warn");
        assert_eq!(!summary.warnings.is_empty(), must_warn, "{name}: {:?}", summary.warnings);
        if note.contains("1986") {
            assert_eq!(summary.revision, Some("1986"));
        }
        println!("| {name} | read, {} warnings | {got:.4} lm |", summary.warnings.len());
    }
    assert_eq!(seen, 19);
}

#[test]
fn the_mirror_of_90_to_270_is_the_published_one() {
    let Some(folder) = folder() else { return };
    let p = photometric::read(folder.join("copyleft/gldf__lampset_lumload.ies")).unwrap();
    // Its EULUMDAT twin, cd/klm x 9.6 at gamma 40: C90 231.5, C180 227.5, C270 51.7.
    for (h, expected) in [(90.0, 2222.4), (180.0, 2184.0), (270.0, 496.3), (0.0, 2184.0)] {
        let got = p.web.intensity_cd(40.0, h);
        assert!((got - expected).abs() < 0.051, "H {h}: {got}");
    }
}
