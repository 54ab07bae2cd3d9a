//! Results when a run is killed, the disk is full, or nobody takes what is printed.

use std::collections::BTreeMap;
use std::fs;
use std::process::{Command, Output, Stdio};
use std::time::Instant;

use crate::absorber::SCENE;
use crate::support::stranger::Stranger;
use crate::support::vouched::{Found, found, names, whole};

const REPORT: &str = "report.json";

/// Many small maps: renaming them takes a good part of the time.
fn many() -> String {
    let more = |k| format!("[[receiver]]\nname = \"r{k}\"\nsurface = \"plate\"\ncells = [2, 2]\n");
    SCENE.to_string() + &(0..10).map(more).collect::<String>()
}

/// Runs are killed at any moment of theirs while they replace an older set. `CAUSTIX_KILLS=100` for as many.
#[test]
fn killed_at_any_moment_a_run_leaves_no_mixture_that_a_report_vouches_for() {
    let times: u64 = std::env::var("CAUSTIX_KILLS").map_or(12, |n| n.parse().unwrap());
    let s = Stranger::with(&[("scene.toml", &many())]);
    let line = |seed: u64| format!("render scene.toml -o out --photons 2^10 --quiet --seed {seed}");
    let started = Instant::now();
    s.is_told(&line(0), 0, &[]);
    let lasts = started.elapsed();
    let mut ends: BTreeMap<&str, u64> = BTreeMap::new();
    for k in 1..=times {
        let older = found(&s.path("out"), REPORT);
        let old = fs::read(s.path("out").join(REPORT)).ok();
        let mut child = s.command(&line(k)).stderr(Stdio::null()).spawn().unwrap();
        // Spread evenly over the run, in an order that does not go with what stood before.
        std::thread::sleep(lasts.mul_f64((k as f64 * 0.618_034).fract() * 1.1));
        child.kill().unwrap();
        child.wait().unwrap();
        let end = match found(&s.path("out"), REPORT) {
            Found::NoList => "no list",
            Found::Whole(_) if fs::read(s.path("out").join(REPORT)).ok() == old => {
                assert!(older != Found::NoList);
                "old set"
            }
            Found::Whole(names) => {
                assert_eq!((names.len(), &s.report("out")["seed"]), (33, &k.into()));
                "new set"
            }
            Found::Mixed(others) => panic!("kill {k}: {others:?}"),
        };
        *ends.entry(end).or_default() += 1;
    }
    println!("{times} kills within {lasts:?}: {ends:?}");
    let (code, _, err) = s.types(&line(times + 1));
    assert_eq!(code, 0, "{err}");
    assert_eq!(whole(&s.path("out"), REPORT), names(&s.path("out")), "{err}");
}

#[test]
fn a_list_that_a_killed_run_did_not_come_to_write_is_told_by_the_next() {
    let s = Stranger::with(&[("scene.toml", SCENE)]);
    // As a kill between the first file and the list leaves it.
    fs::create_dir_all(s.path("out/.caustix-99-0.new")).unwrap();
    s.write("out/.caustix-99-0.new/report.json", "{}");
    s.write("out/plate.exr", "of the newer set");
    let told = ["without report.json they were no whole set", "removed 1 leftover"];
    s.is_told("render scene.toml -o out --photons 2^10 --quiet", 0, &told);
    assert_eq!(whole(&s.path("out"), REPORT), names(&s.path("out")));
}

/// `caustix LINE` by a shell that may say more.
fn shell(s: &Stranger, before: &str, line: &str, after: &str) -> Output {
    let binary = env!("CARGO_BIN_EXE_caustix");
    let script = format!("{before} exec {binary} {line} {after}");
    Command::new("sh").args(["-c", &script]).current_dir(s.folder()).output().unwrap()
}

/// No file longer than so many blocks of 512 bytes, which is refused instead of ending the process.
fn no_longer_than(blocks: u32) -> String {
    format!("trap '' XFSZ; ulimit -f {blocks};")
}

#[test]
fn a_disk_that_takes_no_more_leaves_the_older_set_as_it_was() {
    let s = Stranger::with(&[("scene.toml", SCENE)]);
    s.is_told("render scene.toml -o out --photons 2^12 --quiet", 0, &[]);
    let files = ["plate.exr", "plate.png", "plate.csv", REPORT];
    let all = |folder: &str| files.map(|name| fs::read(s.path(folder).join(name)).ok());
    let before = all("out");
    let lengths = before.each_ref().map(|bytes| bytes.as_ref().unwrap().len());
    // Down to where nothing fits. Shells count in blocks of 512 or 1024 bytes.
    for blocks in (0..=(lengths.iter().max().unwrap() / 512) as u32).rev().step_by(2) {
        let line = "render scene.toml -o out --photons 2^12 --seed 2";
        let output = shell(&s, &no_longer_than(blocks), line, "");
        let err = String::from_utf8_lossy(&output.stderr);
        if output.status.success() {
            assert_eq!(whole(&s.path("out"), REPORT).len(), 4);
            s.is_told("render scene.toml -o out --photons 2^12 --quiet", 0, &[]);
            assert_eq!(all("out")[0], before[0]);
            continue;
        }
        assert_eq!(output.status.code(), Some(1), "{err}");
        let named = files.iter().filter(|name| err.contains(&format!("error: out/{name}: "))).count();
        assert!(named > 0 && err.contains("are left as they were"), "{blocks}: {err}");
        assert_eq!(all("out")[..3], before[..3]);
        assert!(matches!(found(&s.path("out"), REPORT), Found::Whole(_)));
        // What fitted stands beside.
        let beside = s.path("out/incomplete");
        assert!(!matches!(found(&beside, REPORT), Found::Mixed(_)));
        assert_eq!(all("out/incomplete").iter().flatten().count(), 4 - named, "{err}");
        if beside.exists() {
            fs::remove_dir_all(&beside).unwrap();
        }
        let expected = names(&s.path("out"));
        assert_eq!(expected.len(), 4, "{expected:?}");
    }
}

#[test]
fn errors_are_told_before_where_the_rest_was_written() {
    let s = Stranger::with(&[("scene.toml", SCENE)]);
    fs::create_dir_all(s.path("out/plate.png")).unwrap();
    let output = shell(&s, "", "render scene.toml -o out --photons 2^10", "2>&1");
    let said = String::from_utf8(output.stdout).unwrap();
    let at = |text: &str| said.find(text).unwrap_or_else(|| panic!("no {text} in\n{said}"));
    assert!(at("error: out/plate.png: ") < at("written to out, but"), "{said}");
    assert_eq!(output.status.code(), Some(1));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_stdout_is_exit_1_and_told_and_a_closed_one_is_no_failure() {
    let s = Stranger::with(&[("scene.toml", SCENE)]);
    fs::copy(crate::support::data::in_project("ies/spot.ies"), s.path("spot.ies")).unwrap();
    for line in [
        "render scene.toml -o out --photons 2^10",
        "check scene.toml",
        "check scene.toml --json",
        "photometry spot.ies",
        "sample spot.ies -n 1000 --json",
        "--help",
        "--version",
    ] {
        let output = shell(&s, "", line, "> /dev/full");
        let err = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{line}: {err}");
        assert_eq!(err.matches("while writing to stdout").count(), 1, "{line}: {err}");
        let binary = env!("CARGO_BIN_EXE_caustix");
        let script = format!("({binary} {line}; echo $? > code) | true");
        let ended = Command::new("sh").args(["-c", &script]).current_dir(s.folder()).output().unwrap();
        let code = fs::read_to_string(s.path("code")).unwrap();
        assert_eq!((code.trim(), ended.stderr.len()), ("0", 0), "{line}");
    }
    // What was to be written to files is there all the same.
    assert!(matches!(found(&s.path("out"), REPORT), Found::Whole(_)));
}
