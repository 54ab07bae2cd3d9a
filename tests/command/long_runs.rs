//! Runs that are gone on from, cut at any moment, or done in parts: the results are those of one run, to the byte.

use std::collections::BTreeMap;
use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::absorber::SCENE;
use crate::support::stranger::Stranger;

/// All that is counted without a camera: cells of a rectangle and of a sphere, an evaluation grid, a spot, far fields, and
/// cells that a pilot divides.
const ALL: &str = r#"
[[emitter]]
type = "isotropic"
position = [0.1, 0.0, 1.0]
flux_lm = 100
[material.white]
type = "lambertian"
reflectance = 0.5
[material.glass]
type = "dielectric"
ior = 1.5
[[surface]]
name = "plate"
type = "rectangle"
material = "white"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 2.0, 0.0]
[[surface]]
name = "ball"
type = "sphere"
material = "glass"
center = [0.0, 0.0, 0.4]
radius = 0.2
[[receiver]]
surface = "plate"
name = "plate"
cells = [16, 16]
grid = [5, 5]
spot = true
[[receiver]]
name = "undivided"
surface = "plate"
events = "indirect"
[[receiver]]
name = "ball"
surface = "ball"
side = "both"
cells = [8, 4]
[[far_field]]
name = "up"
axis = [0, 0, 1]
gamma_deg = 10
c_deg = 45
"#;

const CAMERA: &str = r#"
[camera]
position = [0, -2, 1.5]
look_at = [0, 0, 0.2]
fov_deg = 40
pixels = [48, 32]
samples = 4
photon_memory_mb = 1
"#;

/// Every result of a folder but its times and its state.
fn results(s: &Stranger, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(s.path(folder)).unwrap().map(|entry| entry.unwrap().path());
    let is_result = |name: &str| !name.contains("state") && !name.starts_with('.') && name != "report.json";
    let file = |path: std::path::PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        (path.is_file() && is_result(&name)).then(|| (name, fs::read(path).unwrap()))
    };
    let mut all: BTreeMap<_, _> = entries.filter_map(file).collect();
    let mut report = s.report(folder);
    report.as_object_mut().unwrap().remove("time");
    if let Some(camera) = report["camera"].as_object_mut() {
        camera.remove("time_s");
    }
    all.insert("report.json".into(), report.to_string().into_bytes());
    all
}

fn assert_same(s: &Stranger, folder: &str, whole: &str) {
    let (found, expected) = (results(s, folder), results(s, whole));
    assert!(found.keys().eq(expected.keys()), "{folder}: {:?}, {whole}: {:?}", found.keys(), expected.keys());
    for (name, bytes) in found {
        if name == "report.json" {
            let [found, expected] =
                [&bytes, &expected[&name]].map(|b| serde_json::from_slice::<Value>(b).unwrap());
            assert_eq!(found, expected, "{folder} against {whole}");
        }
        assert!(bytes == expected[&name], "{folder}/{name} is not that of {whole}");
    }
}

#[test]
fn photons_and_replicates_that_are_added_are_those_of_one_run() {
    let s = Stranger::with(&[(
        "scene.toml",
        &ALL.replace("name = \"undivided\"", "name = \"undivided\"\ncells = [4, 4]"),
    )]);
    let run = |rest: &str| s.is_told(&format!("render scene.toml --quiet {rest}"), 0, &[]);
    run("-o whole --photons 120000");
    run("-o more --photons 2^13");
    run("-o more --photons 50000 --resume");
    run("-o more --photons 120000 --resume --threads 1");
    assert_same(&s, "more", "whole");
    // Twice as many replicates of as many photons each; then both at once.
    run("-o wide --photons 240000 --replicates 16");
    run("-o more --replicates 16 --resume");
    assert_same(&s, "more", "wide");
    run("-o both --photons 2^13");
    run("-o both --photons 240000 --replicates 16 --resume --threads 3");
    assert_same(&s, "both", "wide");
    // All is there already: the results alone are made again.
    fs::remove_file(s.path("both/report.json")).unwrap();
    s.is_told("render scene.toml -o both --resume --quiet", 0, &["goes on after 240 000 photons"]);
    assert_same(&s, "both", "wide");
}

#[test]
fn parts_in_any_order_are_the_whole() {
    let s = Stranger::with(&[("scene.toml", ALL)]);
    s.is_told("render scene.toml -o whole --quiet --photons 100000", 0, &[]);
    for k in [3, 1, 5, 2, 4] {
        let threads = 1 + k % 3;
        let line =
            format!("render scene.toml -o parts --quiet --photons 100000 --part {k}/5 --threads {threads}");
        s.is_told(&line, 0, &[]);
    }
    s.is_told(
        "merge parts/part-4.state parts/part-2.state parts/part-1.state parts/part-5.state parts/part-3.state -o merged --quiet",
        0,
        &[],
    );
    assert_same(&s, "merged", "whole");
    // What was merged can be gone on from, like any run.
    s.is_told("render scene.toml -o merged --quiet --photons 150000 --resume", 0, &[]);
    s.is_told("render scene.toml -o longer --quiet --photons 150000", 0, &[]);
    // The pilot's cells are those of the first run.
    assert_eq!(s.report("merged")["receivers"][0], s.report("longer")["receivers"][0]);
}

#[test]
fn parts_of_a_picture_are_the_picture() {
    let scene = format!("{ALL}{CAMERA}").replace("photon_memory_mb = 1\n", "");
    let coloured = scene.replace("reflectance = 0.5", "reflectance = [0.5, 0.4, 0.3]");
    let splat = scene.replace("samples = 4", "samples = 4\nmethod = \"splat\"");
    let few = format!("{ALL}{CAMERA}");
    let s = Stranger::with(&[
        ("grey.toml", &scene),
        ("rgb.toml", &coloured),
        ("splat.toml", &splat),
        ("few.toml", &few),
    ]);
    for name in ["grey", "rgb"] {
        let line = format!("render {name}.toml --quiet --photons 40000");
        s.is_told(&format!("{line} -o {name}"), 0, &[]);
        for k in [2, 3, 1] {
            s.is_told(&format!("{line} -o p --part {k}/3 --threads {k}"), 0, &[]);
        }
        s.is_told(
            &format!("merge p/part-1.state p/part-3.state p/part-2.state -o {name}-merged --quiet"),
            0,
            &[],
        );
        assert_same(&s, &format!("{name}-merged"), name);
    }
    s.is_told(
        "render splat.toml --quiet --photons 40000 -o p --part 1/3",
        1,
        &["method \"splat\"", "in one piece"],
    );
    let told = ["photons for the camera", "photon_memory_mb"];
    s.is_told("render few.toml --quiet --photons 2^21 -o p --part 1/2", 1, &told);
}

#[test]
fn parts_that_are_missing_doubled_unfinished_or_of_another_run_are_refused_by_name() {
    let s = Stranger::with(&[("scene.toml", SCENE)]);
    let part = |k: u32, rest: &str| {
        s.is_told(&format!("render scene.toml -o p --quiet --part {k}/3 {rest}"), 0, &[]);
        fs::copy(s.path(&format!("p/part-{k}.state")), s.path(&format!("{k}{}", rest.replace(' ', ""))))
            .unwrap();
    };
    for k in 1..=3 {
        part(k, "--photons 3000");
    }
    let [one, two, three] = [1, 2, 3].map(|k| format!("{k}--photons3000"));
    let merge =
        |states: &[&str], all: &[&str]| s.is_told(&format!("merge -o m {}", states.join(" ")), 1, all);
    merge(&[&one, &three], &["2 of 3 parts", "missing 2"]);
    merge(&[&one], &["1 of 3 parts", "missing 2 and 3"]);
    merge(&[&one, &two, &three, &two], &[&format!("{two}: found part 2 of 3"), "once"]);
    part(2, "--photons 3000 --seed 2");
    merge(&[&one, "2--photons3000--seed2", &three], &["2--photons3000--seed2: ", "seed 2", "seed 1"]);
    part(2, "--photons 6000");
    merge(&[&one, "2--photons6000", &three], &["2--photons6000: ", "a replicate: 750", "a replicate: 375"]);
    part(2, "--photons 3000 --variant mc");
    merge(&[&one, "2--photons3000--variantmc", &three], &["by mc"]);
    // Another scene under the name of the first.
    s.write("scene.toml", SCENE.replace("flux_lm = 100", "flux_lm = 200"));
    merge(&[&one, &two, &three], &["another scene, or of scene.toml as it was"]);
    fs::remove_file(s.path("scene.toml")).unwrap();
    merge(&[&one, &two, &three], &["scene.toml"]);
    s.write("elsewhere.toml", format!("# the same\n{SCENE}"));
    s.is_told(&format!("merge {one} {two} {three} -o m --quiet --scene elsewhere.toml"), 0, &[]);
    assert_eq!(s.report("m")["photons"], 3000);
    // More photons than the parts were of: their indices are others.
    s.write("scene.toml", SCENE);
    for k in 1..=3 {
        s.is_told(&format!("render scene.toml -o more --quiet --part {k}/3 --photons 3000"), 0, &[]);
    }
    let told = ["more/part-2.state: found part 2 of 3 of a run of another number of photons", "are merged"];
    s.is_told("render scene.toml -o more --quiet --part 2/3 --photons 6000 --resume", 1, &told);
    let told = ["more/part-2.state: found the state of part 2 of 3", "one of part 2 of 4", "another folder"];
    s.is_told("render scene.toml -o more --quiet --part 2/4 --photons 3000 --resume", 1, &told);
    s.is_told("render scene.toml -o few --part 2/9 --photons 64", 1, &["9 parts of replicates of 8 photons"]);
    // What is no state, and a state that lacks its end.
    let bytes = fs::read(s.path(&two)).unwrap();
    s.write("cut", &bytes[..bytes.len() - 40]);
    s.write("text", "not a state");
    merge(&[&one, "cut", &three], &["cut: found a state that is cut short"]);
    merge(&[&one, "text", &three], &["text: found a file that is no state"]);
}

#[test]
fn the_state_before_a_torn_one_is_gone_on_from_and_another_run_is_refused() {
    let s = Stranger::with(&[("scene.toml", SCENE)]);
    s.is_told("render scene.toml -o whole --quiet --photons 2^16", 0, &[]);
    s.is_told("render scene.toml -o out --quiet --photons 2^13", 0, &[]);
    s.is_told(
        "render scene.toml -o out --quiet --photons 2^14 --resume",
        0,
        &["goes on after 8 192 photons"],
    );
    let newest = fs::read(s.path("out/run.state")).unwrap();
    s.write("out/run.state", &newest[..newest.len() / 2]);
    let told =
        ["run.state: found a state that is cut short", "run.state.previous", "goes on after 8 192 photons"];
    s.is_told("render scene.toml -o out --quiet --photons 2^16 --resume", 0, &told);
    assert_same(&s, "out", "whole");
    // One bit.
    let mut bytes = fs::read(s.path("out/run.state")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 16;
    s.write("out/run.state", &bytes);
    s.write("out/run.state.previous", &bytes);
    s.is_told("render scene.toml -o out --quiet --resume", 1, &["checksum does not fit"]);
    // Of another run.
    for (rest, said) in [
        ("--photons 2^12", "8 replicates of 512 photons"),
        ("--replicates 4 --photons 2^16", "4 replicates"),
        ("--seed 7", "seed 7"),
        ("--variant mc", "one by mc"),
    ] {
        s.is_told("render scene.toml -o of --quiet --photons 2^13", 0, &[]);
        let line = format!("render scene.toml -o of --quiet --resume {rest}");
        s.is_told(&line, 1, &["of/run.state: found the state of", said]);
    }
    s.write("other.toml", SCENE.replace("flux_lm = 100", "flux_lm = 101"));
    s.is_told("render other.toml -o of --quiet --resume", 1, &["the state of a run of another scene"]);
    // Comments, layout and [run] make no other scene.
    s.write("same.toml", format!("# the same\n[run]\nseed = 1\nphotons = 7\n{SCENE}"));
    s.is_told("render same.toml -o of --quiet --resume", 0, &["goes on after 8 192 photons"]);
}

/// Whole runs, killed with SIGKILL and gone on from until they end by themselves: every other one at any moment, the others some
/// time after they have kept a state. `CAUSTIX_KILLS=100` for as many.
fn killed(scene: &str, line: &str) {
    let times: u32 = std::env::var("CAUSTIX_KILLS").map_or(2, |n| n.parse().unwrap());
    let s = Stranger::with(&[("scene.toml", scene)]);
    let started = Instant::now();
    s.is_told(&format!("{line} -o whole"), 0, &[]);
    let lasts = started.elapsed();
    let mut went_on = 0;
    for k in 1..=times {
        let start = || s.command(&format!("{line} -o out --resume")).stderr(Stdio::piped()).spawn().unwrap();
        let mut child = start();
        if k % 2 == 0 {
            while !s.path("out/run.state").exists() && child.try_wait().unwrap().is_none() {
                std::thread::sleep(Duration::from_millis(2));
            }
        }
        let part = (f64::from(k) * 0.618_034).fract();
        std::thread::sleep(lasts.mul_f64(if k % 2 == 0 { 0.2 * part } else { part }));
        child.kill().unwrap();
        child.wait().unwrap();
        let output = start().wait_with_output().unwrap();
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "kill {k}: {err}");
        went_on += u32::from(err.contains("goes on after"));
        assert_same(&s, "out", "whole");
        fs::remove_dir_all(s.path("out")).unwrap();
    }
    println!("{times} kills of runs of {lasts:?}: {went_on} went on from a state");
    assert!(went_on > 0, "no run of {lasts:?} got as far as a state");
}

#[test]
fn killed_at_any_moment_a_run_goes_on_to_the_same_bytes() {
    killed(ALL, "render scene.toml --quiet --photons 6000000 --threads 1");
}

#[test]
fn killed_at_any_moment_a_picture_goes_on_to_the_same_bytes() {
    let scene = format!("{ALL}{CAMERA}");
    killed(&scene, "render scene.toml --quiet --photons 2^22 --threads 1");
}

#[test]
fn a_picture_of_splats_goes_on_after_its_replicates() {
    let scene = format!("{ALL}{CAMERA}").replace("photon_memory_mb = 1", "method = \"splat\"");
    killed(&scene, "render scene.toml --quiet --photons 2^22 --threads 1");
}

#[test]
fn a_full_disk_costs_a_run_no_more_than_its_state() {
    let s = Stranger::with(&[("scene.toml", &SCENE.replace("cells = [4, 4]", "cells = [400, 400]"))]);
    s.is_told("render scene.toml -o out --quiet --photons 2^12", 0, &[]);
    let older = fs::read(s.path("out/run.state")).unwrap();
    // No file of more than 512 KiB, which the state is and the map's results are not all.
    let line = format!(
        "trap '' XFSZ; ulimit -f 1024; exec {} render scene.toml -o out --quiet --resume --photons 2^13",
        env!("CARGO_BIN_EXE_caustix")
    );
    let output = Command::new("sh").args(["-c", &line]).current_dir(s.folder()).output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(err.contains("run.state.new") && err.contains("the run goes on"), "{err}");
    assert_eq!(fs::read(s.path("out/run.state")).unwrap(), older);
    s.is_told(
        "render scene.toml -o out --quiet --resume --photons 2^13",
        0,
        &["goes on after 4 096 photons"],
    );
    s.is_told("render scene.toml -o whole --quiet --photons 2^13", 0, &[]);
    assert_same(&s, "out", "whole");
}

#[test]
fn a_run_ends_at_its_error_or_says_that_it_did_not() {
    let s = Stranger::with(&[("scene.toml", SCENE)]);
    s.is_told("render scene.toml -o out --quiet --error 2%", 0, &[]);
    let report = s.report("out");
    assert_eq!((&report["stopped_by"], &report["replicates"]), (&"error".into(), &32.into()));
    let stopping = &report["stopping"];
    assert_eq!(
        (&stopping["error_of"], &stopping["asked"], &stopping["met"]),
        (&"cells".into(), &0.02.into(), &true.into())
    );
    let reached = stopping["reached"].as_f64().unwrap();
    assert_eq!(reached, report["receivers"][0]["expected_nrms"].as_f64().unwrap());
    assert!((0.012..=0.02).contains(&reached), "{reached}");
    // The same command goes on to no more photons.
    let photons = report["photons"].clone();
    s.is_told("render scene.toml -o out --quiet --resume", 0, &[]);
    assert_eq!(s.report("out")["photons"], photons);
    // A smaller error goes on, to what a run of its own has.
    s.is_told("render scene.toml -o out --quiet --resume --error 1", 0, &[]);
    s.is_told("render scene.toml -o whole --quiet --error 1", 0, &[]);
    assert_same(&s, "out", "whole");
    // Of the flux: a sixth of the light, sure to 1 % after 50,000 independent photons.
    s.is_told("render scene.toml -o flux --quiet --variant mc --error 1 --error-of flux", 0, &[]);
    let report = s.report("flux");
    assert!((40_000..90_000).contains(&report["photons"].as_u64().unwrap()), "{}", report["photons"]);
    assert_eq!(report["stopped_by"], "error");
    // Too few photons, too little time.
    let told = ["all photons are traced", "not the 0.01 % that were asked for", "--resume"];
    s.is_told("render scene.toml -o few --quiet --error 0.01 --photons 2^16", 3, &told);
    assert_eq!(
        (&s.report("few")["stopped_by"], &s.report("few")["stopping"]["met"]),
        (&"photons".into(), &false.into())
    );
    s.is_told("render scene.toml -o short --quiet --error 0.0001 --time 1", 3, &["the time is over"]);
    assert_eq!(s.report("short")["stopped_by"], "time");
    // Time alone is no failure.
    s.is_told("render scene.toml -o time --quiet --photons 2^40 --time 1s", 0, &[]);
    assert_eq!(s.report("time")["stopped_by"], "time");
}

#[test]
fn nothing_arrives_and_no_error_is_reached() {
    let dark = SCENE.replace("surface = \"plate\"", "surface = \"plate\"\nside = \"back\"");
    let s = Stranger::with(&[("scene.toml", &dark)]);
    for of in ["cells", "flux", "mean", "max"] {
        let line = format!("render scene.toml -o out --quiet --error 50 --error-of {of} --photons 2^16");
        s.is_told(&line, 3, &["all photons are traced"]);
        assert_eq!(s.report("out")["photons"], 65_536, "{of}");
    }
}

#[test]
fn options_that_do_not_go_together_are_told() {
    let scene = format!("{SCENE}{CAMERA}");
    let far = SCENE.replace(
        "[[receiver]]\nsurface = \"plate\"\ncells = [4, 4]",
        "[[far_field]]\nname = \"up\"\naxis = [0, 0, 1]",
    );
    let s = Stranger::with(&[("scene.toml", SCENE), ("seen.toml", &scene), ("far.toml", &far)]);
    for (line, code, all) in [
        ("scene.toml --error 0", 1, &["an error of 0 %", "above 0 %"][..]),
        ("scene.toml --error 100%", 1, &["below 100 %"]),
        ("scene.toml --error=-1", 1, &["an error of -1 %"]),
        ("scene.toml --error 0,5", 1, &["--error 0,5", "write 0.5"]),
        ("scene.toml --error one", 1, &["--error one", "in percent"]),
        ("scene.toml --error 1 --error-of flus", 1, &["--error-of flus", "flux, mean, cells, max"]),
        ("scene.toml --error-of flux", 2, &["--error"]),
        ("scene.toml --error 1 --replicates 1", 1, &["one replicate", "several replicates"]),
        ("scene.toml --error 1 --sequence sobol", 1, &["one replicate of \"sobol\""]),
        ("scene.toml --error 1 --sequence jittered", 1, &["one after another"]),
        (
            "scene.toml --time 1 --sequence jittered",
            1,
            &["a time to be kept by replicates that are traced one after another"],
        ),
        ("scene.toml --time 0", 1, &["--time 0", "10min"]),
        ("scene.toml --time soon", 1, &["--time soon"]),
        ("scene.toml --part 5/4", 1, &["--part 5/4", "like 3/16"]),
        ("scene.toml --part 1/2 --error 1", 1, &["--part with --error or --time"]),
        ("scene.toml --part 1/2 --variant mc:next-point", 1, &["a part of a run by mc:next-point"]),
        ("scene.toml --part 1/2 --sequence jittered", 1, &["a part of a run by"]),
        ("seen.toml --error 1", 1, &["--error and a scene with [camera]"]),
        ("seen.toml --time 1", 1, &["--time and a scene with [camera]"]),
        ("far.toml --error 1", 1, &["--error-of flux"]),
    ] {
        s.is_told(&format!("render {line} -o out"), code, all);
        assert!(!s.path("out/report.json").exists(), "{line}");
    }
    s.is_told("render far.toml --error 1 --error-of flux -o out --quiet", 0, &[]);
    let told = ["no out2/run.state to go on from: this run starts with its first photon"];
    s.is_told("render scene.toml -o out2 --resume --photons 2^12", 0, &told);
}
