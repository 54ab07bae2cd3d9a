//! What the command writes, and the names in it that other programs rely on.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::absorber::SCENE;
use crate::support::data::in_project;
use crate::support::stranger::Stranger;

fn keys(value: &Value) -> BTreeSet<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

/// Exactly these keys: those of the contract, and the ones added to it.
fn assert_keys(value: &Value, contract: &[&str], added: &[&str]) {
    assert_eq!(keys(value), contract.iter().chain(added).copied().collect::<BTreeSet<_>>());
}

#[test]
fn photometry_says_a_warning_once() {
    let s = Stranger::new();
    let text = "IESNA91\n[LAMP] two\nTILT=INCLUDE\n1 2 0 90 1 0.9\n2 100 1.5 2 1 1 2 0 0 0\n0.9 0.8 10\n0 90\n0\n100 100\n";
    s.write("dark.ies", text);
    let (code, out, err) = s.types("photometry dark.ies");
    assert_eq!(code, 0, "{err}");
    // 150 cd over half a sphere: 942.5 lm, out of lamps of 200.
    assert_eq!((err.matches("942.5 lm").count(), err.lines().count()), (1, 1), "{err}");
    assert!(out.contains("2 x 100 lm; the table has 471.2 % of it") && !out.contains("warning"), "{out}");
    let (_, out, err) = s.types("photometry dark.ies --json");
    assert_eq!(err, "");
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["warnings"].as_array().unwrap().len(), 1);
    assert_eq!(json["file"], "dark.ies");
    assert_eq!(json["labels"], serde_json::json!([{"keyword": "LAMP", "text": "two"}]));
    for (key, value) in
        [("lamps", 2.0), ("lumens_per_lamp", 100.0), ("multiplier", 1.5), ("ballast_factor", 0.9)]
    {
        assert_eq!(json[key], value, "{key}");
    }
    let tilt = serde_json::json!({
        "kind": "include", "file": null, "geometry": 1, "angles_deg": [0.0, 90.0], "factors": [1.0, 0.9]
    });
    assert_eq!((&json["tilt"], &json["field12"]), (&tilt, &serde_json::json!("0.8")));
}

#[test]
fn photometry_json_has_the_keys_of_the_contract() {
    let s = Stranger::new();
    let (code, out, err) = s.types(&format!("photometry {} --json", in_project("ies/headlamp_a.ies")));
    assert_eq!((code, err.as_str()), (0, ""));
    let json: Value = serde_json::from_str(&out).unwrap();
    let contract = [
        "format",
        "revision",
        "photometric_type",
        "flux_lm",
        "flux_declared_lm",
        "max_candela",
        "max_at",
        "vertical_angles",
        "horizontal_angles",
        "symmetry",
        "luminous_opening",
        "beam_angle_deg",
        "field_angle_deg",
        "input_watts",
        "efficacy_lm_w",
        "warnings",
        "flux_with_factors_lm",
        "flux_emitted_lm",
    ];
    let added = [
        "file",
        "flux_emitted_relative",
        "lamps",
        "lumens_per_lamp",
        "lamps_lm",
        "light_output_ratio",
        "multiplier",
        "ballast_factor",
        "field12",
        "tilt",
        "labels",
        "beam_angle_across_deg",
        "field_angle_across_deg",
        "flux_downward_lm",
        "flux_upward_lm",
        "downward_percent",
        "zonal_lumens",
        "cie_flux_code",
        "beam_angle_at_max_deg",
        "field_angle_at_max_deg",
        "nema_type",
        "max_candela_per_klm",
        "luminance",
        "absent",
    ];
    assert_keys(&json, &contract, &added);
    assert_keys(&json["tilt"], &["kind", "file", "geometry", "angles_deg", "factors"], &[]);
    assert_keys(&json["labels"][0], &["keyword", "text"], &[]);
    assert_keys(&json["max_at"], &["vertical_deg", "horizontal_deg"], &[]);
    assert_keys(&json["luminous_opening"], &["shape", "size_m"], &[]);
    // The table of ies/README.md, computed outside the project.
    assert!((json["flux_lm"].as_f64().unwrap() - 735.360528).abs() < 1e-6);
    assert_eq!(json["max_candela"], 19965.37);
}

#[test]
fn a_diagram_is_what_its_name_says() {
    let s = Stranger::new();
    for (name, magic) in [("p.svg", &b"<svg"[..]), ("p.png", &b"\x89PNG\r\n\x1a\n"[..])] {
        let (code, _, err) = s.types(&format!("photometry {} --plot {name}", in_project("ies/batwing.ies")));
        assert_eq!((code, err.as_str()), (0, ""));
        let bytes = fs::read(s.path(name)).unwrap();
        let head = &bytes[..bytes.len().min(200)];
        assert!(head.windows(magic.len()).any(|w| w == magic), "{name}");
    }
}

#[test]
fn check_json_has_the_keys_of_the_contract() {
    let s = Stranger::new();
    let contract = ["ok", "requires", "surfaces", "emitters", "memory_mb", "warnings", "errors"];
    let (code, out, _) = s.types("check --json");
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &json["ok"]), (0, &Value::Bool(true)));
    assert_keys(&json, &contract, &["receivers", "forecast"]);
    assert_keys(&json["surfaces"][0], &["name", "triangles", "open_edges"], &["closed", "area_m2"]);
    assert_keys(&json["emitters"][0], &["name", "flux_emitted_lm"], &[]);
    // 128 x 128 cells of two triangles; the rim of an open sheet of 128 x 128 has 512 edges.
    assert_eq!(
        (&json["surfaces"][0]["triangles"], &json["surfaces"][0]["open_edges"]),
        (&32768.into(), &512.into())
    );

    fs::write(s.path("scene.toml"), SCENE.replace("flux_lm", "flux")).unwrap();
    let (code, out, _) = s.types("check --json scene.toml");
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &json["ok"]), (1, &Value::Bool(false)));
    assert_keys(&json, &contract, &["receivers"]);
    let error = json["errors"].as_array().unwrap().iter().find(|e| e["line"] == 5).unwrap();
    assert_keys(error, &["file", "line", "column", "found", "required"], &[]);
    assert_eq!((&error["file"], &error["column"]), (&"scene.toml".into(), &1.into()));

    // A scene that is not there has a name all the same, but no line.
    let (code, out, _) = s.types("check --json nowhere.toml");
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, json["errors"].as_array().unwrap().len()), (1, 1));
    let error = &json["errors"][0];
    assert_eq!((&error["file"], &error["line"]), (&"nowhere.toml".into(), &Value::Null));
}

#[test]
fn a_report_has_the_keys_of_the_contract_and_balances() {
    let s = Stranger::new();
    let (code, out, err) = s.types("render --photons 2^14 --quiet");
    assert_eq!((code, out.as_str(), err.as_str()), (0, "", ""));
    let report = s.report("caustix-out");
    assert_keys(
        &report,
        &[
            "caustix",
            "scene",
            "variant",
            "sequence",
            "seed",
            "photons",
            "replicates",
            "time",
            "ledger_lm",
            "dimension",
            "receivers",
            "stopped_by",
        ],
        &[
            "photons_planned",
            "solver",
            "standard_error_absent",
            "ledger_photons",
            "exceptions",
            "warnings",
            "files",
            "files_bytes",
        ],
    );
    assert_keys(&report["scene"], &["path", "sha256"], &["files"]);
    assert_keys(&report["time"], &["trace_s", "total_s", "photons_per_s"], &["merit_per_s"]);
    let ledger = &report["ledger_lm"];
    assert_keys(ledger, &["emitted", "absorbed", "escaped", "killed"], &["standard_error"]);
    assert_keys(&report["dimension"], &["mean", "max"], &["histogram", "mean_by_purpose"]);
    assert_keys(
        &report["receivers"][0],
        &[
            "name",
            "flux_lm",
            "flux_standard_error_lm",
            "min_lx",
            "mean_lx",
            "max_lx",
            "uniformity_u0",
            "area_m2",
            "cells",
            "u0",
            "ud",
            "minimum",
            "maximum",
        ],
        &["expected_nrms", "files", "reason", "diagnosis"],
    );
    let sum = |v: &Value| v.as_object().unwrap().values().map(|x| x.as_f64().unwrap()).sum::<f64>();
    let lm = |key: &str| ledger[key].as_f64().unwrap();
    let ended = sum(&ledger["absorbed"]) + lm("escaped") + lm("killed");
    // What the file emits was computed outside the project.
    let table = fs::read_to_string(in_project("ies/README.md")).unwrap();
    let row = table.lines().find(|l| l.starts_with("| `wavy_glass.ies`")).unwrap();
    let expected: f64 = row.split('|').nth(3).unwrap().trim().parse().unwrap();
    assert!((lm("emitted") - expected).abs() < 1e-5, "{} {expected}", lm("emitted"));
    assert!((ended - lm("emitted")).abs() < 1e-9 * ended);
    let photons = &report["ledger_photons"];
    let ended = sum(&photons["absorbed"])
        + photons["escaped"].as_f64().unwrap()
        + photons["killed"].as_f64().unwrap();
    assert_eq!((sum(&photons["emitted"]), ended), (16384.0, 16384.0));
    assert_eq!(report["stopped_by"], "photons");
}

/// Bytes of a file as text where they are printable: the attributes' names and texts stand in it as they are.
fn readable(path: &Path) -> String {
    fs::read(path).unwrap().iter().map(|b| if (32..127).contains(b) { *b as char } else { '\n' }).collect()
}

#[test]
fn an_exr_says_how_to_repeat_the_run_and_nothing_else() {
    let s = Stranger::new();
    fs::write(s.path("scene.toml"), SCENE).unwrap();
    fs::create_dir(s.path("elsewhere")).unwrap();
    fs::write(s.path("elsewhere/renamed.toml"), SCENE).unwrap();
    for line in [
        "render scene.toml -o a --photons 4096 --threads 1",
        "render elsewhere/renamed.toml -o b --photons 4096 --threads 3",
    ] {
        let (code, _, err) = s.types(line);
        assert_eq!(code, 0, "{err}");
    }
    // Another time, path, folder and number of threads: the same bytes.
    assert_eq!(fs::read(s.path("a/plate.exr")).unwrap(), fs::read(s.path("b/plate.exr")).unwrap());
    let text = readable(&s.path("a/plate.exr"));
    for name in [
        "Y",
        "standard_error",
        "hits",
        "caustix.version",
        "caustix.unit.Y",
        "caustix.variant",
        "caustix.sequence",
        "caustix.seed",
        "caustix.photons",
        "caustix.replicates",
        "caustix.scene.sha256",
        "caustix.scene.text",
    ] {
        assert!(text.lines().any(|l| l.contains(name)), "{name}");
    }
    let folder = s.folder().display().to_string();
    for word in [folder.as_str(), "scene.toml", "thread", "capDate", "utcOffset", "elapsed"] {
        assert!(!text.contains(word), "the EXR names {word}");
    }
}

/// Copies a folder with all that is in it.
fn copied(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copied(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// A picture of 24 x 16 pixels where the scene has a camera: it is written all the same.
fn with_few_pixels(scene: &Path) {
    let text = fs::read_to_string(scene).unwrap();
    let lines =
        text.lines().map(|line| if line.starts_with("pixels = ") { "pixels = [24, 16]" } else { line });
    fs::write(scene, lines.collect::<Vec<_>>().join("\n")).unwrap();
}

#[test]
fn every_scene_passes_check_without_warnings_and_lights_every_receiver() {
    let s = Stranger::new();
    for folder in ["scenes", "ies", "brdf_tables"] {
        copied(Path::new(&in_project(folder)), &s.path(folder));
    }
    let mut scenes: Vec<PathBuf> =
        fs::read_dir(s.path("scenes")).unwrap().map(|e| e.unwrap().path()).collect();
    scenes.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    scenes.sort();
    assert!(scenes.len() >= 6);
    for scene in scenes {
        with_few_pixels(&scene);
        let (code, out, _) = s.types(&format!("check --json {}", scene.display()));
        let check: Value = serde_json::from_str(&out).unwrap();
        assert_eq!((code, check["warnings"].as_array().unwrap().len()), (0, 0), "{out}");
        assert!(!check["receivers"].as_array().unwrap().is_empty(), "{}", scene.display());
        let (code, _, err) = s.types(&format!("render {} -o out --photons 2^13 --quiet", scene.display()));
        assert_eq!((code, err.as_str()), (0, ""), "{}", scene.display());
        for receiver in s.report("out")["receivers"].as_array().unwrap() {
            assert!(receiver["flux_lm"].as_f64().unwrap() > 0.0, "{}: {receiver}", scene.display());
            for file in receiver["files"].as_array().unwrap() {
                assert!(fs::metadata(s.path("out").join(file.as_str().unwrap())).unwrap().len() > 0);
            }
        }
        fs::remove_dir_all(s.path("out")).unwrap();
    }
}
