//! Results are one set: what a list vouches for, who is kept out, what is refused, told and removed.

use std::fs;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use crate::absorber::SCENE;
use crate::support::data::in_project;
use crate::support::stranger::Stranger;
use crate::support::vouched::{Found, found, names, whole};

const REPORT: &str = "report.json";

/// The scene of [`SCENE`] with a camera.
fn seen() -> String {
    let camera = "[camera]\nposition = [0.3, -1.2, 0.8]\nlook_at = [0.0, 0.0, 0.1]\nfov_deg = 45\n\
                  pixels = [24, 18]\nsamples = 4\nfalse_colour = true\n";
    SCENE.replace("\"absorber\"", "\"lambertian\"\nreflectance = 0.5") + camera
}

fn stranger() -> Stranger {
    Stranger::with(&[("scene.toml", SCENE), ("seen.toml", &seen())])
}

#[test]
fn a_report_vouches_for_every_file_and_another_is_found() {
    let s = stranger();
    s.is_told("render seen.toml -o out --photons 2^12 --save-map out/photons.map", 0, &[]);
    let out = s.path("out");
    assert_eq!(whole(&out, REPORT), names(&out));
    assert!(names(&out).contains("photons.map") && names(&out).contains("camera_luminance.png"));
    // A bit of one file; a file cut short; a file that is gone.
    let good = fs::read(out.join("plate.exr")).unwrap();
    let mut changed = good.clone();
    *changed.last_mut().unwrap() ^= 1;
    for other in [&changed[..], &good[..good.len() - 1]] {
        fs::write(out.join("plate.exr"), other).unwrap();
        assert_eq!(found(&out, REPORT), Found::Mixed(vec!["plate.exr".into()]));
    }
    fs::remove_file(out.join("plate.exr")).unwrap();
    assert_eq!(found(&out, REPORT), Found::Mixed(vec!["plate.exr".into()]));
    // Seen again, from the photons that lie in the same folder: they are an input, and stay.
    s.is_told(
        "render seen.toml -o out --photons 2^12 --map out/photons.map",
        0,
        &["out also holds files", ": plate.csv and plate.png\n"],
    );
    assert!(whole(&out, REPORT).contains("camera.exr") && out.join("photons.map").is_file());
}

#[test]
fn a_study_has_a_list_of_its_own_beside_that_of_a_run() {
    let s = stranger();
    s.is_told("render scene.toml --photons 2^10", 0, &[]);
    let study = "compare scene.toml --photons 64 --reference-photons 2^12 --seeds 1 --cells 2 --variants mc,qmc --quiet";
    let (code, _, err) = s.types(study);
    assert_eq!((code, err.contains("also holds")), (0, false), "{err}");
    let out = s.path("caustix-out");
    let study_files = ["compare.csv", "compare.json", "compare.md", "compare.svg"].map(String::from);
    assert!(whole(&out, "compare.json").iter().eq(&study_files));
    let both: Vec<String> = whole(&out, REPORT).into_iter().chain(study_files).collect();
    assert!(
        names(&out).iter().filter(|name| *name != "parts").eq(&std::collections::BTreeSet::from_iter(both))
    );
    // A folder in the way of one file costs no other.
    fs::remove_file(out.join("compare.md")).unwrap();
    fs::create_dir(out.join("compare.md")).unwrap();
    let study = study.replace(" --quiet", "");
    let (code, printed, err) = s.types(&study);
    assert_eq!(code, 1, "{err}");
    assert!(err.contains("compare.md") && printed.contains("written to caustix-out, but"), "{err}{printed}");
    assert!(whole(&out, "compare.json").iter().eq(&["compare.csv", "compare.json", "compare.svg"]));
}

#[test]
fn every_file_that_cannot_be_written_costs_itself_alone() {
    let files = [
        "plate.exr",
        "plate.png",
        "plate.csv",
        "camera.exr",
        "camera.png",
        "camera_luminance.png",
        "photons.map",
    ];
    for bad in files.into_iter().chain([REPORT]) {
        let s = stranger();
        let out = s.path("out");
        fs::create_dir_all(out.join(bad)).unwrap();
        let line = "render seen.toml -o out --photons 2^12 --save-map out/photons.map";
        let (code, printed, err) = s.types(line);
        assert_eq!(code, 1, "{bad}: {err}");
        assert!(err.lines().any(|l| l.starts_with("error: ") && l.contains(bad)), "{bad}: {err}");
        assert!(printed.contains("written to out, but"), "{bad}: {printed}");
        for name in files {
            assert_eq!(out.join(name).is_file(), name != bad, "{bad}: {name}");
        }
        if bad != REPORT {
            let expected: Vec<&str> = files.into_iter().filter(|name| *name != bad).collect();
            let listed = whole(&out, REPORT);
            assert!(expected.iter().all(|name| listed.contains(*name)) && listed.len() == expected.len() + 1);
        }
    }
}

/// A run that would take years, once it has its folder.
fn endless(s: &Stranger, seed: u64) -> Child {
    let line = format!("render scene.toml -o out --photons 2^45 --seed {seed}");
    let child = s.command(&line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let started = Instant::now();
    while !s.path("out/.caustix.lock").exists() {
        assert!(started.elapsed() < Duration::from_secs(60), "no run has taken its folder");
        std::thread::sleep(Duration::from_millis(10));
    }
    // It exists a moment before it is locked.
    std::thread::sleep(Duration::from_millis(200));
    child
}

#[test]
fn a_second_run_is_kept_out_until_the_first_has_ended_however_it_does() {
    let s = stranger();
    s.is_told("render scene.toml -o out --photons 2^12 --quiet", 0, &[]);
    let before = whole(&s.path("out"), REPORT);
    let mut first = endless(&s, 1);
    for line in ["render scene.toml -o out --photons 2^10", "compare scene.toml -o out --photons 64"] {
        s.is_told(line, 1, &["error: out: ", "another run of caustix", "-o"]);
    }
    s.is_told("render scene.toml -o elsewhere --photons 2^10 --quiet", 0, &[]);
    assert_eq!(whole(&s.path("out"), REPORT), before);
    first.kill().unwrap();
    first.wait().unwrap();
    s.is_told("render scene.toml -o out --photons 2^10 --quiet", 0, &[]);
    assert_eq!(whole(&s.path("out"), REPORT), names(&s.path("out")));
}

#[test]
fn of_two_runs_at_once_one_writes_a_whole_set_and_the_other_is_told() {
    let times = std::env::var("CAUSTIX_PAIRS").map_or(4, |n| n.parse().unwrap());
    let s = stranger();
    for pair in 0..times {
        let both: Vec<Child> = (0..2)
            .map(|k| {
                let line = format!("render scene.toml -o out --photons 2^14 --quiet --seed {}", 2 * pair + k);
                s.command(&line).stderr(Stdio::piped()).spawn().unwrap()
            })
            .collect();
        let ended: Vec<_> = both.into_iter().map(|child| child.wait_with_output().unwrap()).collect();
        let done = ended.iter().filter(|output| output.status.success()).count();
        assert!(done >= 1, "{ended:?}");
        for output in ended.iter().filter(|output| !output.status.success()) {
            let err = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.code() == Some(1) && err.contains("another run of caustix"), "{err}");
        }
        assert_eq!(whole(&s.path("out"), REPORT), names(&s.path("out")));
    }
}

#[test]
fn nothing_that_is_read_or_written_is_overwritten_by_another() {
    let s = stranger();
    s.is_told("render seen.toml -o out --photons 2^12 --save-map kept.map --quiet", 0, &[]);
    s.write("plate.png", fs::read(in_project("ies/spot.ies")).unwrap());
    let lamp = "type = \"photometric\"\nfile = \"plate.png\"\naim = [0, 0, -1]";
    s.write("own.toml", SCENE.replace("type = \"isotropic\"", lamp));
    s.write("lamp.png", fs::read(in_project("ies/spot.ies")).unwrap());
    let read = "a file that this command reads";
    let written = "another result of this command";
    let before = whole(&s.path("out"), REPORT);
    for (line, why, file) in [
        ("render own.toml -o . --photons 2^10", read, "plate.png"),
        ("render seen.toml -o new --photons 2^12 --save-map seen.toml", read, "seen.toml"),
        ("render seen.toml -o out --photons 2^12 --save-map out/plate.exr", written, "plate.exr"),
        ("render seen.toml -o out --photons 2^12 --save-map out/../out/report.json", written, REPORT),
        ("render seen.toml -o out --photons 2^12 --save-map out/camera.png", written, "camera.png"),
        ("photometry lamp.png --plot lamp.png", read, "lamp.png"),
        ("sample lamp.png -n 10 -o lamp.png", read, "lamp.png"),
    ] {
        s.is_told(line, 1, &[why, file]);
    }
    // Photons that would be replaced by the picture made of them.
    fs::copy(s.path("kept.map"), s.path("out/camera.exr")).unwrap();
    s.is_told("render seen.toml -o out --photons 2^12 --map out/camera.exr", 1, &[read, "camera.exr"]);
    assert_eq!(fs::read(s.path("out/camera.exr")).unwrap(), fs::read(s.path("kept.map")).unwrap());
    assert_eq!(fs::read(s.path("plate.png")).unwrap(), fs::read(s.path("lamp.png")).unwrap());
    assert_eq!(names(&s.path("out")), before);
    assert!(!s.path("new").exists());
    // Two surfaces' names that give one file: the camera's luminance, and a receiver's map.
    let twice = seen().replace("[[receiver]]", "[[receiver]]\nname = \"camera_luminance\"");
    s.write("twice.toml", twice);
    s.is_told("render twice.toml -o new --photons 2^12", 1, &[written, "camera_luminance.png"]);
}

#[test]
fn files_of_other_runs_are_told_in_one_line_and_left() {
    let s = stranger();
    let many: String = (0..7)
        .map(|k| format!("[[receiver]]\nname = \"r{k}\"\nsurface = \"plate\"\ncells = [2, 2]\n"))
        .collect();
    s.write("many.toml", SCENE.to_string() + &many);
    s.is_told("render many.toml -o out --photons 2^10 --quiet", 0, &[]);
    s.write("out/notes.txt", "mine");
    let (code, _, err) = s.types("render scene.toml -o out --photons 2^10 --quiet");
    let told: Vec<&str> = err.lines().collect();
    assert_eq!((code, told.len()), (0, 1), "{err}");
    assert!(told[0].contains("out also holds files that this run did not write: r0.csv, "), "{err}");
    // Seven receivers with an EXR, a PNG and a CSV each, five names told.
    assert!(told[0].ends_with("and 16 more"), "{err}");
    assert!(s.path("out/r6.exr").is_file() && s.path("out/notes.txt").is_file());
    assert_eq!(whole(&s.path("out"), REPORT).len(), 4);
}
