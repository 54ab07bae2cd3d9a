//! `caustix sample` as a user types it: the table, the CSV, the JSON, the exit codes.

use caustix::photometry::PhotometricType;
use glam::DVec3;
use serde_json::Value;
use std::process::Command;

use crate::support::angles::Luminaire;
use crate::support::data;

/// Exit code, stdout, stderr of `caustix sample` with these words.
fn sample(words: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_caustix")).arg("sample").args(words).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

fn own(name: &str) -> String {
    data::own_file(name).to_str().unwrap().to_owned()
}

#[test]
fn directions_are_written_in_the_files_own_angles() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("directions.csv");
    for (file, kind) in [
        ("wavy_glass.ies", PhotometricType::C),
        ("headlamp_a.ies", PhotometricType::A),
        ("floodlight_b.ies", PhotometricType::B),
    ] {
        let (code, _, err) = sample(&[&own(file), "-n", "1000", "-o", path.to_str().unwrap()]);
        assert_eq!((code, err.as_str()), (0, ""), "{file}");
        let text = std::fs::read_to_string(&path).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("index,vertical_deg,horizontal_deg,x,y,z,coordinates"));
        // A lamp that hangs: the world's axes are (r, u, -a).
        let lamp = Luminaire::new(DVec3::NEG_Z, DVec3::Y);
        let web = caustix::files::photometric::read(data::own_file(file)).unwrap().web;
        let mut rows = 0;
        for (i, line) in lines.enumerate() {
            let row: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
            let [index, vertical, horizontal, x, y, z, coordinates] = row[..] else { panic!("{line}") };
            assert_eq!((index, coordinates), (i as f64, 2.0));
            let direction = DVec3::new(x, y, z);
            assert!((direction.length() - 1.0).abs() < 1e-14);
            let (v, h) = lamp.angles_deg(kind, direction);
            assert!((v - vertical).abs() < 1e-11, "{file}: {v} {line}");
            // The angle about a pole is as uncertain as the direction's distance from the pole is small.
            let axis = if kind == PhotometricType::C { lamp.a } else { lamp.u };
            let sine = if kind == PhotometricType::B { 1.0 } else { direction.cross(axis).length() };
            assert!((h - horizontal).abs() < 1e-11 / sine, "{file}: {h} {line}");
            assert!(web.intensity_cd(vertical, horizontal) > 0.0, "{line}");
            rows += 1;
        }
        assert_eq!(rows, 1000);
    }
}

#[test]
fn json_has_every_number_of_the_certificate() {
    let (code, out, err) = sample(&[&own("spot.ies"), "-n", "2^14", "--json", "--seed", "7"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(report["passed"], true);
    assert_eq!(report["samples"], 1 << 14);
    assert_eq!(report["seed"], 7);
    assert_eq!(
        (&report["variant"], &report["sequence"]),
        (&"qmc-inverse-reuse:quadratic-newton".into(), &"sobol-owen".into())
    );
    assert_eq!(report["points"], "low-discrepancy");
    assert_eq!((&report["coordinates"]["mean"], &report["coordinates"]["max"]), (&2.0.into(), &2.into()));
    assert!(report["ns_per_sample"].as_f64().unwrap() > 0.0);
    assert_eq!((&report["samples_in_zero_cells"], &report["samples_outside"]), (&0.into(), &0.into()));
    let tests = report["tests"].as_object().unwrap();
    assert_eq!(tests.len(), 8);
    for name in [
        "chi_square",
        "largest_cell",
        "ks_theta",
        "ks_phi",
        "ks_theta_in_row",
        "ks_phi_in_column",
        "discrepancy",
        "cell_means",
    ] {
        let p = |key: &str| tests[name][key].as_f64().unwrap();
        assert!(p("p_value") > 0.0 && p("p_corrected") >= p("p_value"), "{name}");
        assert_eq!(tests[name]["passed"], true);
    }
    assert!(report["cells"]["pooled"].as_u64().unwrap() > 1);
    assert!(report["discrepancy"]["ratio"].as_f64().unwrap() < 0.5);
    // Of independent points there is neither a test of the discrepancy nor a need of further randomisations.
    let (_, out, _) = sample(&[&own("spot.ies"), "-n", "2^14", "--json", "--variant", "mc"]);
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((report["tests"].as_object().unwrap().len(), &report["points"]), (6, &"random".into()));
    assert!(report["coordinates"]["mean"].as_f64().unwrap() > 3.0);
}

#[test]
fn the_table_says_what_was_tested_and_how() {
    for (words, says) in [
        (vec!["--variant", "qmc:next-point"], ["points of the sequence", "an upper bound", "cell means"]),
        (
            vec!["--sequence", "sobol"],
            ["sobol; inverse functions (quadratic-newton)", "an upper bound", "discrepancy"],
        ),
        (vec!["--variant", "mc"], ["rejection inside the cell", "p-values hold", "KS phi | theta"]),
    ] {
        let file = own("wavy_glass.ies");
        let (code, out, _) = sample(&[&[file.as_str(), "-n", "20000"], &words[..]].concat());
        assert_eq!(code, 0, "{words:?}");
        assert!(says.iter().all(|part| out.contains(part)), "{words:?}\n{out}");
        assert!(out.ends_with("certificate       passed\n"), "{out}");
        assert!(out.lines().all(|line| line.len() <= 120), "{out}");
    }
}

#[test]
fn wrong_requests_are_told() {
    let file = own("spot.ies");
    for (words, code, parts) in [
        (vec![file.as_str()], 2, vec!["-n <N>"]),
        (vec![file.as_str(), "-n", "0"], 1, vec!["-n", "a whole number from 1"]),
        (vec![file.as_str(), "-n", "-5"], 1, vec!["-n", "a whole number from 1"]),
        (vec![file.as_str(), "-n", "9", "--variant", "magic"], 1, vec!["variant magic", "qmc-inverse-reuse"]),
        (vec![file.as_str(), "-n", "9", "--sequence", "magic"], 1, vec!["--sequence magic", "sobol-owen"]),
        (
            vec![
                file.as_str(),
                "-n",
                "9",
                "--variant",
                "qmc:next-point",
                "--sequence",
                "lattice",
                "-o",
                "x.csv",
            ],
            1,
            vec!["qmc:next-point:lattice", "goes on beyond N points"],
        ),
        (vec!["no_such.ies", "-n", "9"], 1, vec!["no_such.ies"]),
        (vec![file.as_str(), "-n", "9", "-o", "no/such/x.csv"], 1, vec!["no/such/x.csv"]),
    ] {
        let (got, out, err) = sample(&words);
        assert_eq!((got, out.as_str()), (code, ""), "{words:?}: {err}");
        assert!(parts.iter().all(|part| err.contains(part)), "{words:?}: {err}");
    }
    assert!(!std::path::Path::new("x.csv").exists());
}
