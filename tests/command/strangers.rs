//! Scenes from strangers, as a service runs them.

use std::fs;
use std::os::unix::fs::symlink;
use std::time::{Duration, Instant};

use crate::absorber::SCENE;
use crate::support::stranger::Stranger;

/// The scene with a mesh of this file in it.
fn with_mesh(file: &str) -> String {
    format!(
        "{SCENE}[[surface]]\nname = \"part\"\ntype = \"mesh\"\nmaterial = \"black\"\nfile = \"{file}\"\ntranslate = [0, 0, 0.2]\n"
    )
}

const TRIANGLE: &str = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n";
const OUTSIDE: &str = "outside the scene's folder";

#[test]
fn every_command_confines_a_scene_to_its_folder() {
    let s = Stranger::new();
    fs::create_dir(s.path("in")).unwrap();
    s.write("secret.obj", TRIANGLE);
    s.write("in/part.obj", TRIANGLE);
    symlink(s.path("secret.obj"), s.path("in/link.obj")).unwrap();
    symlink("part.obj", s.path("in/inner.obj")).unwrap();
    let absolute = s.path("in/part.obj").display().to_string();
    for (name, file) in [("up", "../secret.obj"), ("link", "link.obj"), ("absolute", &absolute[..])] {
        s.write(&format!("in/{name}.toml"), with_mesh(file));
        for command in ["check", "render --photons 64 --quiet", "compare --photons 64 --seeds 1 --quiet"] {
            let line = format!("{command} --confine in/{name}.toml");
            let line = if command == "check" { line } else { format!("{line} -o out-{name}") };
            s.is_told(&line, 1, &[OUTSIDE, "--confine"]);
            assert!(!s.path(&format!("out-{name}")).exists(), "{line}");
        }
        let (code, _, err) = s.types(&format!("check in/{name}.toml"));
        assert_eq!(code, 0, "{err}");
    }
    for file in ["part.obj", "inner.obj"] {
        s.write("in/right.toml", with_mesh(file));
        let (code, _, err) = s.types("render --confine in/right.toml --photons 64 --quiet -o out");
        assert_eq!(code, 0, "{err}");
    }
    // From within the folder, where the scene's folder has no name.
    let output = s.command("check --confine right.toml").current_dir(s.path("in")).output().unwrap();
    assert!(output.status.success(), "{output:?}");
}

#[test]
fn pipes_are_refused_at_once_wherever_a_file_is_named() {
    let s = Stranger::new();
    let pipe = std::process::Command::new("mkfifo").arg(s.path("pipe")).status().unwrap();
    assert!(pipe.success());
    let camera = "[camera]\nposition = [0, -1, 1]\nlook_at = [0, 0, 0]\nfov_deg = 30\npixels = [4, 4]\n";
    s.write("seen.toml", format!("{SCENE}{camera}"));
    let start = Instant::now();
    for line in [
        "check pipe",
        "render pipe",
        "compare pipe",
        "photometry pipe",
        "bsdf pipe",
        "sample pipe -n 16",
        "render seen.toml --photons 64 --map pipe -o out",
    ] {
        s.is_told(line, 1, &["pipe", "which is not a regular file"]);
    }
    for line in ["check /dev/zero", "photometry /dev/zero", "bsdf /dev/zero"] {
        s.is_told(line, 1, &["which is not a regular file"]);
    }
    s.is_told("check .", 1, &["found a folder"]);
    // A pipe in the place of an older list is no list.
    fs::create_dir(s.path("old")).unwrap();
    fs::rename(s.path("pipe"), s.path("old/report.json")).unwrap();
    let (code, _, err) = s.types("render seen.toml --photons 64 --quiet -o old");
    assert_eq!(code, 0, "{err}");
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
}
