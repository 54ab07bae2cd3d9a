//! A file that cannot be written costs itself alone.

use std::process::Command;

const SCENE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0, 0, 1]
flux_lm = 100
[material.black]
type = "absorber"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [-1, -1, 0]
edge_u = [2, 0, 0]
edge_v = [0, 2, 0]
[[receiver]]
name = "first"
surface = "plate"
cells = [2, 2]
[[receiver]]
name = "second"
surface = "plate"
cells = [2, 2]
"#;

#[test]
fn a_map_that_cannot_be_written_does_not_lose_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    std::fs::write(&scene, SCENE).unwrap();
    std::fs::create_dir_all(out.join("first.exr")).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_caustix"));
    let output = command.arg("render").arg(&scene).arg("-o").arg(&out).args(["--photons", "1000"]).output();
    let output = output.unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("first.exr"), "{errors}");
    for name in ["second.exr", "second.png", "report.json"] {
        assert!(out.join(name).is_file(), "{name}");
    }
}
