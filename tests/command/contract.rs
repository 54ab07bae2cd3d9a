//! The command as a stranger types it: exit codes, messages, what is written, and the names that other programs rely on.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

use crate::support::stranger::Stranger;

fn project(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).display().to_string()
}

fn keys(value: &Value) -> BTreeSet<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

/// Exactly these keys: those of the contract, and the ones added to it.
fn assert_keys(value: &Value, contract: &[&str], added: &[&str]) {
    assert_eq!(keys(value), contract.iter().chain(added).copied().collect::<BTreeSet<_>>());
}

const ABSORBER_SCENE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0.0, 0.0, 1.0]
flux_lm = 100
[material.black]
type = "absorber"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 2.0, 0.0]
[[receiver]]
surface = "plate"
cells = [4, 4]
"#;

#[test]
fn what_is_not_built_yet_says_so_and_exits_2() {
    let s = Stranger::new();
    for line in ["render --error 1", "render --time 3", "render --resume"] {
        s.is_told(line, 2, &["not available yet"]);
    }
    assert_eq!(fs::read_dir(s.folder()).unwrap().count(), 0);
}

#[test]
fn wrong_usage_exits_2_and_help_and_version_exit_0() {
    let s = Stranger::new();
    for line in ["frobnicate", "render --photons", "render a b", "photometry", "render --threads x"] {
        s.is_told(line, 2, &["error:"]);
    }
    // A number that is none is told with what is required, negative ones included: they are no options.
    for (line, option, required) in [
        ("render --seed x", "'x' for '--seed <K>'", "from 0 to 18446744073709551615"),
        ("render --seed -1", "'-1' for '--seed <K>'", "from 0 to 18446744073709551615"),
        ("render --seed 1.5", "'1.5' for '--seed <K>'", "from 0 to 18446744073709551615"),
        ("render --replicates -8", "'-8' for '--replicates <R>'", "from 1 to 65536"),
        ("render --threads x", "'x' for '--threads <T>'", "from 1 to 1024"),
    ] {
        s.is_told(line, 2, &["error: invalid value ", option, "required: a whole number ", required]);
    }
    for line in
        ["--help", "--version", "help", "help render", "render --help", "photometry --help", "check --help"]
    {
        let (code, out, err) = s.types(line);
        assert_eq!((code, err.as_str()), (0, ""), "{line}");
        assert!(out.contains("caustix"), "{line}");
    }
    for line in ["--help", "help"] {
        let (_, out, _) = s.types(line);
        assert!(out.contains("Without a command the built-in scene is rendered"), "{line}\n{out}");
    }
    assert_eq!(s.types("help render").1, s.types("render --help").1);
}

#[test]
fn photons_are_saved_and_seen_again_by_a_camera_alone() {
    let s = Stranger::new();
    fs::write(s.path("plate.toml"), ABSORBER_SCENE).unwrap();
    s.is_told("render plate.toml --map old.map", 1, &["--map", "without [camera]", "a scene with a camera"]);
    s.is_told("render plate.toml --save-map new.map", 1, &["--save-map", "without [camera]"]);
    s.is_told("render plate.toml --save-map new.map --map old.map", 2, &["error:", "cannot be used with"]);
    assert!(!s.path("caustix-out").exists(), "refused before anything is made");
}

#[test]
fn impossible_requests_exit_1_and_say_what_is_required() {
    let s = Stranger::new();
    for (line, found, required) in [
        ("render --photons 0", "--photons `0`", "from 1 to 2^48"),
        ("render --photons -5", "--photons `-5`", "from 1 to 2^48"),
        ("render --photons -2^22", "--photons `-2^22`", "from 1 to 2^48"),
        ("render --photons --quiet", "--photons `--quiet`", "from 1 to 2^48"),
        ("render --photons abc", "--photons `abc`", "4_456_448, 4.5e6 or 2^22"),
        ("render --photons 4.5", "not whole", "a whole number"),
        ("render --photons 1e99", "more than 2^48", "from 1 to 2^48"),
        ("render --replicates 0", "0 replicates", "1 to 65536"),
        ("render --replicates 70000", "70000 replicates", "1 to 65536"),
        ("render --sequence sobol --replicates 8", "8 replicates", "one replicate"),
        ("render --sequence haltom", "--sequence haltom", "independent, sobol, sobol-owen"),
        ("render --variant qcm", "--variant qcm", "qmc-inverse, qmc-inverse-reuse"),
        ("render --threads 0 --photons 64", "--threads 0", "1 to 1024 threads"),
        ("render --threads 5000 --photons 64", "--threads 5000", "1 to 1024 threads"),
        ("render nowhere.toml", "nowhere.toml: found", "a file that can be read"),
        ("check nowhere.toml", "nowhere.toml: found", "a file that can be read"),
        ("photometry nowhere.ies", "nowhere.ies: found", "a readable file"),
    ] {
        s.is_told(line, 1, &[found, "; required: ", required]);
    }
}

#[test]
fn numbers_are_read_as_people_write_them() {
    let s = Stranger::new();
    fs::write(s.path("scene.toml"), ABSORBER_SCENE).unwrap();
    for (text, photons) in [("4_456_448", 4_456_448u64), ("4.5e6", 4_500_000), ("2^22", 4_194_304)] {
        let (code, out, err) = s.types(&format!("render scene.toml -o out --photons {text}"));
        assert_eq!(code, 0, "{err}");
        assert_eq!(s.report("out")["photons"], photons, "{out}");
    }
    // Replicates are equal sets: what does not divide is rounded up, and said.
    let (code, _, err) = s.types("render scene.toml -o out --photons 1001");
    assert_eq!((code, s.report("out")["photons"].as_u64()), (0, Some(1008)));
    assert!(err.contains("1 008 photons instead of 1 001"), "{err}");
}

#[test]
fn broken_files_are_named_with_line_and_column() {
    let s = Stranger::new();
    let whole = fs::read_to_string(project("ies/spot.ies")).unwrap();
    fs::write(s.path("word.ies"), whole.replace("\r\n12000", "\r\nbright")).unwrap();
    let cut = whole.trim_end().rsplit_once(|c: char| c.is_whitespace()).unwrap().0;
    fs::write(s.path("cut.ies"), cut).unwrap();
    fs::write(s.path("scene.toml"), ABSORBER_SCENE.replace("flux_lm", "flux")).unwrap();
    fs::write(s.path("broken.toml"), "[[emitter]\n").unwrap();
    for (line, place) in [
        ("photometry word.ies", "word.ies:"),
        ("photometry cut.ies", "cut.ies:"),
        ("check scene.toml", "scene.toml:5:1: found the unknown key `flux`"),
        ("render scene.toml", "did you mean `flux_lm`?"),
        ("check broken.toml", "broken.toml:1:"),
    ] {
        s.is_told(line, 1, &[place, "found ", "; required: "]);
        let (_, _, err) = s.types(line);
        let place = err.lines().next().unwrap().strip_prefix("error: ").unwrap();
        let numbers: Vec<usize> =
            place.split(':').skip(1).map_while(|part| part.trim().parse().ok()).collect();
        assert!(numbers.len() == 2 && numbers.iter().all(|n| *n > 0), "{err}");
    }
    // A scene's file that is missing is named where the scene names it.
    let scene = ABSORBER_SCENE.replace("\"isotropic\"", "\"photometric\"\nfile = \"gone.ies\"");
    fs::write(s.path("scene.toml"), scene).unwrap();
    s.is_told("check scene.toml", 1, &["scene.toml:4:8: found", "gone.ies"]);
}

#[test]
fn a_toml_text_with_too_much_in_it_is_told_the_rule() {
    let s = Stranger::new();
    for (text, required) in [
        ("a == 1", "one `=` between a key and its value"),
        ("a = 01", "a number without leading zeros"),
        ("a = 00.5", "a number without leading zeros"),
        ("a = +-3", "a number with at most one sign"),
        ("a = -0x1f", "begins with 0x, 0o or 0b and has no sign"),
        ("a = 1__0", "a digit before and after every `_`"),
        ("a = _1", "; required: "),
        ("a = 0x0x1", "; required: "),
        ("a = --inf", "; required: "),
        ("a = [1] ] 2", "; required: "),
    ] {
        fs::write(s.path("scene.toml"), format!("{text}\n")).unwrap();
        s.is_told("check scene.toml", 1, &["scene.toml:1:", required]);
        let (_, _, err) = s.types("check scene.toml");
        assert!(!err.contains("required: nothing"), "{text}\n{err}");
    }
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_tracing() {
    let s = Stranger::new();
    fs::write(s.path("file"), "not a folder").unwrap();
    for output in ["file", "file/below"] {
        // 2^48 photons would take years: that this ends shows that nothing was traced.
        s.is_told(
            &format!("render -o {output} --photons 2^48"),
            1,
            &["file", "required: a directory for the results"],
        );
    }
    s.is_told(&format!("photometry {} --plot p.jpg", project("ies/spot.ies")), 1, &["p.jpg", ".svg or .png"]);
}

#[test]
fn photometry_json_has_the_keys_of_the_contract() {
    let s = Stranger::new();
    let (code, out, err) = s.types(&format!("photometry {} --json", project("ies/headlamp_a.ies")));
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
    assert_keys(&json, &contract, &[]);
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
        let (code, _, err) = s.types(&format!("photometry {} --plot {name}", project("ies/batwing.ies")));
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
    assert_keys(&json, &contract, &["receivers"]);
    assert_keys(&json["surfaces"][0], &["name", "triangles", "open_edges"], &["closed", "area_m2"]);
    assert_keys(&json["emitters"][0], &["name", "flux_emitted_lm"], &[]);
    // 128 x 128 cells of two triangles; the rim of an open sheet of 128 x 128 has 512 edges.
    assert_eq!(
        (&json["surfaces"][0]["triangles"], &json["surfaces"][0]["open_edges"]),
        (&32768.into(), &512.into())
    );

    fs::write(s.path("scene.toml"), ABSORBER_SCENE.replace("flux_lm", "flux")).unwrap();
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
        &["photons_planned", "solver", "standard_error_absent", "ledger_photons", "exceptions", "warnings"],
    );
    assert_keys(&report["scene"], &["path", "sha256"], &["files"]);
    assert_keys(&report["time"], &["trace_s", "total_s", "photons_per_s"], &[]);
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
        ],
        &["expected_nrms", "files"],
    );
    let sum = |v: &Value| v.as_object().unwrap().values().map(|x| x.as_f64().unwrap()).sum::<f64>();
    let lm = |key: &str| ledger[key].as_f64().unwrap();
    let ended = sum(&ledger["absorbed"]) + lm("escaped") + lm("killed");
    // What the file emits was computed outside the project.
    let table = fs::read_to_string(project("ies/README.md")).unwrap();
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
    fs::write(s.path("scene.toml"), ABSORBER_SCENE).unwrap();
    fs::create_dir(s.path("elsewhere")).unwrap();
    fs::write(s.path("elsewhere/renamed.toml"), ABSORBER_SCENE).unwrap();
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
        "illuminance",
        "standard_error",
        "hits",
        "caustix.version",
        "caustix.unit.illuminance",
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
        copied(Path::new(&project(folder)), &s.path(folder));
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
    }
}

#[cfg(unix)]
mod interrupts {
    use super::*;
    use std::process::{Child, Stdio};
    use std::time::Duration;

    /// Starts a run that would take years, and interrupts it after a second and a half.
    fn interrupted(s: &Stranger, line: &str) -> (i32, String, String) {
        let child: Child = s.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(1500));
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (status.code().unwrap(), text(stdout), text(stderr))
    }

    #[test]
    fn an_interrupted_run_writes_what_there_is_and_says_so() {
        let s = Stranger::new();
        fs::write(s.path("scene.toml"), ABSORBER_SCENE).unwrap();
        let (code, out, err) = interrupted(&s, "render scene.toml -o out --photons 2^45");
        assert_eq!(code, 130, "{out}{err}");
        assert!(err.contains("interrupted after") && err.contains("was written to out"), "{err}");
        let report = s.report("out");
        assert_eq!(report["stopped_by"], "interrupt");
        let photons = report["photons"].as_u64().unwrap();
        assert!(photons > 0 && photons < 1 << 45);
        assert_eq!(report["ledger_photons"]["emitted"]["emitter 1"], photons);
        assert!(s.path("out/plate.exr").is_file() && s.path("out/plate.png").is_file());
        // A plate of 2 m seen from 1 m above its centre takes 1/6 of an isotropic lamp's light: a face of a cube.
        let flux = report["receivers"][0]["flux_lm"].as_f64().unwrap();
        let sigma = 100.0 * (1.0 / 6.0 * (5.0 / 6.0) / photons as f64).sqrt();
        assert!((flux - 100.0 / 6.0).abs() < 5.0 * sigma, "{flux} lm of {photons} photons");
    }

    #[test]
    fn an_interrupted_run_leaves_the_results_of_a_longer_one() {
        let s = Stranger::new();
        fs::write(s.path("scene.toml"), ABSORBER_SCENE).unwrap();
        let (code, _, err) = s.types("render scene.toml -o out --photons 2^14 --quiet");
        assert_eq!(code, 0, "{err}");
        // As a run of years would have left it.
        let path = s.path("out/report.json");
        let longer =
            fs::read_to_string(&path).unwrap().replace("\"photons\": 16384", "\"photons\": 281474976710656");
        fs::write(&path, &longer).unwrap();
        let map = fs::read(s.path("out/plate.exr")).unwrap();
        let (code, _, err) = interrupted(&s, "render scene.toml -o out --photons 2^45 --seed 2");
        assert_eq!(code, 130, "{err}");
        assert_eq!(fs::read_to_string(&path).unwrap(), longer);
        assert_eq!(fs::read(s.path("out/plate.exr")).unwrap(), map);
        assert_eq!(s.report("out/interrupted")["stopped_by"], "interrupt");
    }
}
