//! Ctrl-C: what is written, what is said, what is kept.

use std::fs;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use crate::absorber::SCENE;
use crate::support::stranger::Stranger;

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
    fs::write(s.path("scene.toml"), SCENE).unwrap();
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
    fs::write(s.path("scene.toml"), SCENE).unwrap();
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
