//! `caustix compare` killed without warning and started again finishes with the numbers of a run that was left alone, and
//! uses no part that is damaged or of another study.

use caustix::files::parts::{Found, Parts, from_bytes, to_bytes};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A small study: 8 parts of the reference, 2 seeds of 3 variants.
fn compare(output: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_caustix"));
    command
        .args([
            "compare",
            "--photons",
            "2^14",
            "--reference-photons",
            "2^17",
            "--seeds",
            "2",
            "--cells",
            "16,32",
        ])
        .args(["--variants", "mc,qmc,qmc-inverse-reuse", "--from", "2^11", "-o"])
        .arg(output)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

fn finish(output: &Path) -> Output {
    let done = compare(output).output().unwrap();
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    done
}

fn parts(output: &Path) -> Vec<PathBuf> {
    let Ok(folder) = fs::read_dir(output.join("parts")) else { return vec![] };
    let mut parts: Vec<_> = folder.map(|entry| entry.unwrap().path()).collect();
    parts.retain(|path| path.extension().is_some_and(|e| e == "part"));
    parts.sort();
    parts
}

/// compare.csv without what depends on the clock.
fn errors(output: &Path) -> Vec<Vec<String>> {
    let csv = fs::read_to_string(output.join("compare.csv")).unwrap();
    let mut rows = csv.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let kept = |name: &String| name != "photons_per_s" && name != "ratio_equal_time";
    let columns: Vec<usize> = (0..header.len()).filter(|c| kept(&header[*c])).collect();
    assert_eq!(columns.len(), 10);
    rows.map(|row| columns.iter().map(|c| row[*c].clone()).collect()).collect()
}

#[test]
fn killed_and_started_again_it_gives_the_numbers_of_a_run_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (alone, killed) = (folder.path().join("alone"), folder.path().join("killed"));
    finish(&alone);
    let expected = errors(&alone);
    assert_eq!(expected.len(), 3 * 4 * 2, "variants x numbers of photons x grids");
    // Killed in the middle of the reference, and in the middle of the runs.
    for wanted in [3, 11] {
        let mut child = compare(&killed).spawn().unwrap();
        let started = Instant::now();
        while parts(&killed).len() < wanted && child.try_wait().unwrap().is_none() {
            assert!(started.elapsed() < Duration::from_secs(300), "{wanted} parts");
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let kept: Vec<(PathBuf, Vec<u8>)> =
        parts(&killed).into_iter().map(|path| (path.clone(), fs::read(path).unwrap())).collect();
    assert!(kept.len() >= 11);
    finish(&killed);
    assert_eq!(errors(&killed), expected);
    // What was finished was not done again: the files are as they were, times included.
    for (path, content) in kept {
        assert!(fs::read(&path).unwrap() == content, "{}", path.display());
    }
    let files =
        |output: &Path| parts(output).iter().map(|p| p.file_name().unwrap().to_owned()).collect::<Vec<_>>();
    assert_eq!(files(&killed), files(&alone));
}

#[test]
fn a_damaged_part_is_told_and_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out");
    finish(&output);
    let expected = errors(&output);
    let all = parts(&output);
    let (reference, run) = (&all[0], &all[all.len() - 1]);
    assert!(reference.to_string_lossy().contains("reference-") && run.to_string_lossy().contains("run-"));
    // One bit of a count, and a file cut short.
    let mut bytes = fs::read(reference).unwrap();
    let last = bytes.len() - 3;
    bytes[last] ^= 4;
    fs::write(reference, &bytes).unwrap();
    let text = fs::read(run).unwrap();
    fs::write(run, &text[..text.len() / 2]).unwrap();
    let told = String::from_utf8(finish(&output).stderr).unwrap();
    assert_eq!(told.matches("checksum").count(), 2, "{told}");
    assert!(told.contains(reference.file_name().unwrap().to_str().unwrap()), "{told}");
    assert_eq!(errors(&output), expected);
}

#[test]
fn parts_of_another_key_are_not_used() {
    let folder = tempfile::tempdir().unwrap();
    let parts = Parts::new(folder.path().join("parts"));
    let numbers = [0, 1, u64::MAX, 1 << 40];
    parts.store("reference", "key one", &to_bytes(&numbers)).unwrap();
    let Found::Whole(bytes) = parts.load("reference", "key one") else { panic!("lost") };
    assert_eq!(from_bytes(&bytes, 4).unwrap(), numbers);
    assert!(from_bytes(&bytes, 5).is_none() && from_bytes(&bytes[1..], 4).is_none());
    assert!(matches!(parts.load("reference", "key two"), Found::Missing));
    assert!(matches!(parts.load("run", "key one"), Found::Missing));
    // The file of one key under the name of another.
    parts.store("reference", "key two", b"other").unwrap();
    let mut files: Vec<_> = fs::read_dir(parts.directory()).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    let (a, b) = (fs::read(&files[0]).unwrap(), fs::read(&files[1]).unwrap());
    fs::write(&files[0], b).unwrap();
    fs::write(&files[1], a).unwrap();
    for key in ["key one", "key two"] {
        assert!(matches!(parts.load("reference", key), Found::Damaged(_)), "{key}");
    }
}
