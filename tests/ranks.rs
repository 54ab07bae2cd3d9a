//! `mpirun -n 4 caustix render ...`: the same bytes as of one process, and what is said when something goes wrong.
//!
//! Needs the feature `mpi` to be built, and `mpirun` to run; without it the tests say that they are skipped, and pass. The
//! protocol itself is tested without either, in `src/run/share`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

#[path = "command/absorber.rs"]
mod absorber;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

const CAUSTIX: &str = env!("CARGO_BIN_EXE_caustix");

/// Options that let Open MPI start more ranks than cores, as any user, without words of its own; `None` without `mpirun`.
fn options() -> Option<&'static [&'static str]> {
    let Ok(Output { stdout, .. }) = Command::new("mpirun").arg("--version").output() else {
        println!("mpirun: not found, skipped");
        return None;
    };
    let is_open = String::from_utf8_lossy(&stdout).contains("Open MPI");
    Some(if is_open { &["--allow-run-as-root", "--oversubscribe", "-q"] } else { &[] })
}

/// `mpirun -n SIZE caustix LINE` in a folder.
fn ranks(folder: &TempDir, options: &[&str], size: u32, line: &str) -> Command {
    let mut command = Command::new("mpirun");
    command.args(options).args(["-n", &size.to_string(), CAUSTIX]).args(line.split_whitespace());
    command.current_dir(folder.path());
    command
}

fn alone(folder: &TempDir, line: &str) -> Command {
    let mut command = Command::new(CAUSTIX);
    command.args(line.split_whitespace()).current_dir(folder.path());
    command
}

fn run(mut command: Command) -> (i32, String, String) {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

/// All results of a run by name, without the times in them.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let all = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let content = |path: &Path| {
        let bytes = fs::read(path).unwrap();
        match path.file_name().unwrap().to_str().unwrap() {
            "report.json" => {
                let mut report: Value = serde_json::from_slice(&bytes).unwrap();
                assert!(report["time"]["trace_s"].as_f64().unwrap() > 0.0);
                report["time"] = Value::Null;
                report.to_string().into_bytes()
            }
            "run.state" => {
                // Of the head the time of tracing is no result, so what was counted alone is looked at.
                let head = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
                bytes[16 + head..bytes.len() - 32].to_vec()
            }
            _ => bytes,
        }
    };
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    all.filter(|path| path.is_file() && !name(path).ends_with(".previous") && !name(path).starts_with('.'))
        .map(|path| (name(&path), content(&path)))
        .collect()
}

fn assert_same(folder: &TempDir, one: &str, other: &str) {
    let [one, other] = [one, other].map(|name| (name, results(&folder.path().join(name))));
    assert_eq!(one.1.keys().collect::<Vec<_>>(), other.1.keys().collect::<Vec<_>>());
    assert!(one.1.contains_key("report.json") && one.1.contains_key("run.state"));
    for (name, bytes) in &one.1 {
        assert!(bytes == &other.1[name], "{name} of {} is another than of {}", other.0, one.0);
    }
}

/// The black plate, with a spot, a grid and a far field.
fn scene() -> String {
    let of_plate =
        "cells = [16, 12]\ngrid = [4, 4]\nspot = true\n[[far_field]]\nname = \"all\"\naxis = [0, 0, -1]\n";
    absorber::SCENE.replace("cells = [4, 4]\n", of_plate)
}

#[test]
fn any_number_of_ranks_writes_the_bytes_of_one_process() {
    let Some(options) = options() else { return };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), scene()).unwrap();
    fs::write(folder.path().join("plate.toml"), absorber::SCENE).unwrap();
    for (number, line) in [
        // No power of two; the built-in scene, whose cells a pilot chooses; to an error.
        "render scene.toml --photons 500_003 --quiet",
        "render --photons 2^19 --quiet",
        "render plate.toml --error 0.05 --error-of cells --quiet",
    ]
    .into_iter()
    .enumerate()
    {
        let one = format!("alone-{number}");
        let of_one = run(alone(&folder, &format!("{line} -o {one} --threads 2")));
        assert_eq!(of_one.0, 0, "{}", of_one.2);
        for (size, threads) in [(1, 2), (2, 1), (2, 7), (4, 1)] {
            let out = format!("ranks-{number}-{size}-{threads}");
            let line = format!("{line} -o {out} --threads {threads}");
            assert_eq!(run(ranks(&folder, options, size, &line)), of_one, "{size} ranks say something else");
            assert_same(&folder, &one, &out);
        }
    }
    println!("mpirun: compared");
}

/// The processes of the ranks.
fn of_ranks(mpirun: &Child) -> Vec<u32> {
    let parent = format!("PPid:\t{}\n", mpirun.id());
    let all =
        fs::read_dir("/proc").unwrap().filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    all.filter(|id: &u32| {
        fs::read_to_string(format!("/proc/{id}/status")).is_ok_and(|status| status.contains(&parent))
    })
    .collect()
}

fn kill(signal: &str, process: u32) {
    assert!(Command::new("kill").args([signal, &process.to_string()]).status().unwrap().success());
}

/// Waits for something to come, for two minutes at most.
fn wait_for(what: &str, mut has_come: impl FnMut() -> bool) {
    let started = Instant::now();
    while !has_come() {
        assert!(started.elapsed() < Duration::from_secs(120), "no {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_whose_rank_was_killed_goes_on_with_other_ranks_to_the_same_bytes() {
    let Some(options) = options() else { return };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), scene()).unwrap();
    let line = "render scene.toml --photons 2^24 --quiet --threads 1 -o killed";
    let state = folder.path().join("killed/run.state");
    for killed in [1, 0] {
        let _gone = fs::remove_dir_all(folder.path().join("killed"));
        let mut mpirun = ranks(&folder, options, 2, line).stderr(Stdio::null()).spawn().unwrap();
        wait_for("state", || state.is_file());
        let all = of_ranks(&mpirun);
        assert_eq!(all.len(), 2, "the run was over before it could be killed");
        kill("-KILL", all[killed]);
        let mut code = None;
        wait_for("end", || {
            code = mpirun.try_wait().unwrap();
            code.is_some()
        });
        assert!(!code.unwrap().success());
        wait_for("end of the other rank", || of_ranks(&mpirun).is_empty());
        assert!(!folder.path().join("killed/report.json").exists());
    }
    let (code, _, err) = run(ranks(&folder, options, 3, &format!("{line} --resume")));
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("goes on after"), "{err}");
    let (code, _, err) = run(alone(&folder, &line.replace("killed", "whole")));
    assert_eq!(code, 0, "{err}");
    assert_same(&folder, "whole", "killed");
    println!("mpirun: compared");
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_of_any_rank_writes_what_there_is_and_says_so_once() {
    let Some(options) = options() else { return };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), absorber::SCENE).unwrap();
    let mut mpirun = ranks(&folder, options, 2, "render scene.toml --photons 2^45 -o out --threads 1");
    let mpirun = mpirun.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for("state", || folder.path().join("out/run.state").is_file());
    let all = of_ranks(&mpirun);
    kill("-INT", all[1]);
    let Output { status, stderr, .. } = mpirun.wait_with_output().unwrap();
    let err = String::from_utf8(stderr).unwrap();
    assert_eq!(status.code(), Some(130), "{err}");
    assert_eq!(err.matches("interrupted after").count(), 1, "{err}");
    let report = fs::read_to_string(folder.path().join("out/report.json")).unwrap();
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["stopped_by"], "interrupt");
    let photons = report["photons"].as_u64().unwrap();
    assert_eq!(report["ledger_photons"]["emitted"]["emitter 1"], photons);
    // A face of a cube around the lamp gets a sixth of its light.
    let flux = report["receivers"][0]["flux_lm"].as_f64().unwrap();
    let sigma = 100.0 * (1.0 / 6.0 * (5.0 / 6.0) / photons as f64).sqrt();
    assert!((flux - 100.0 / 6.0).abs() < 5.0 * sigma, "{flux} lm of {photons} photons");
    println!("mpirun: compared");
}

#[test]
fn what_cannot_be_shared_is_refused_once_and_says_what_to_do() {
    let Some(options) = options() else { return };
    let folder = tempfile::tempdir().unwrap();
    let camera = "[camera]\nposition = [0, 0, 3]\nlook_at = [0, 0, 0]\nup = [0, 1, 0]\nfov_deg = 40\npixels = [8, 8]\n";
    let with_camera = absorber::SCENE.replace("cells = [4, 4]\n", "") + camera;
    fs::write(folder.path().join("scene.toml"), absorber::SCENE).unwrap();
    fs::write(folder.path().join("camera.toml"), with_camera).unwrap();
    fs::write(folder.path().join("wrong.toml"), absorber::SCENE.replace("absorber", "absorbre")).unwrap();
    for (line, told) in [
        ("render camera.toml", "a scene with [camera] by 2 processes"),
        ("render scene.toml --sequence hammersley-rotation", "one after another by 2 processes"),
        ("render scene.toml --part 1/2 --photons 2^20", "--part by 2 processes"),
        ("render scene.toml --variant mc:next-point", "a run by mc:next-point"),
        ("render wrong.toml", "absorbre"),
        ("render none.toml", "none.toml"),
        ("check scene.toml", "several processes for one command"),
    ] {
        let (code, out, err) = run(ranks(&folder, options, 2, line));
        assert_eq!(code, 1, "{line}: {out}{err}");
        assert_eq!(err.matches("error: ").count(), 1, "{line}: {err}");
        assert!(err.contains(told) && err.contains("required"), "{line}: {err}");
        assert!(!folder.path().join("caustix-out").exists(), "{line}");
    }
    let (code, out, _) = run(ranks(&folder, options, 2, "--version"));
    assert_eq!((code, out.matches("caustix").count()), (0, 1), "{out}");
    println!("mpirun: compared");
}

#[test]
fn ranks_that_read_other_files_are_named() {
    let Some(options) = options() else { return };
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("a", absorber::SCENE), ("b", &absorber::SCENE.replace("1.0]", "1.5]"))] {
        fs::create_dir(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name).join("scene.toml"), text).unwrap();
    }
    for (other, told) in
        [("b", "another scene file on rank 1 than on rank 0"), (".", "rank 1 without the scene")]
    {
        let in_folder = |name| ["-n", "1", "-wdir", name, CAUSTIX, "render", "scene.toml"];
        let mut command = Command::new("mpirun");
        command.args(options).args(in_folder("a")).arg(":").args(in_folder(other)).current_dir(folder.path());
        let (code, _, err) = run(command);
        assert_eq!(code, 1, "{err}");
        assert!(err.contains(told) && err.matches("error: ").count() == 1, "{err}");
    }
    println!("mpirun: compared");
}
