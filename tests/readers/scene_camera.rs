//! `[camera]` in scene files: every key, every default, every rule broken once; what a scene with a camera requires.

use caustix::error::{Diagnostic, Kind};
use caustix::files::bytes::Base;
use caustix::files::scene_toml::{SceneFile, parse};
use caustix::scene::camera::{Bandwidth, CameraSpec, Exposure, Filter, Kernel, Method};
use caustix::scene::requires::requirements;
use glam::DVec3;

const SCENE: &str = "[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 2]\nflux_lm = 100\n\
                     [material.black]\ntype = \"absorber\"\n\
                     [[surface]]\nname = \"plate\"\ntype = \"rectangle\"\nmaterial = \"black\"\n\
                     corner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n";
/// Lines of [`SCENE`] and the header: the keys begin after them.
const HEADER_LINE: usize = 14;
const REQUIRED: &str = "position = [0, -3, 0]\nlook_at = [0, 0, 4]\nfov_deg = 40\npixels = [320, 200]\n";

fn read(keys: &str) -> Result<SceneFile, Vec<Diagnostic>> {
    parse(&format!("{SCENE}[camera]\n{keys}"), "test.toml", Base::Directory(".".into()))
}

fn spec(keys: &str) -> CameraSpec {
    let scene = read(keys).and_then(SceneFile::build).unwrap_or_else(|e| panic!("{keys}: {e:#?}"));
    CameraSpec::clone(&scene.camera.unwrap())
}

#[test]
fn defaults_are_those_of_the_manual() {
    let camera = spec(REQUIRED);
    assert_eq!(camera.position, DVec3::new(0.0, -3.0, 0.0));
    assert!((camera.forward - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
    assert!((camera.up - DVec3::new(0.0, -0.8, 0.6)).length() < 1e-15);
    assert_eq!((camera.fov_deg, camera.pixels, camera.samples), (40.0, [320, 200], 16));
    assert_eq!((camera.lens_radius_m, camera.focus_m), (0.0, 5.0));
    assert_eq!((camera.filter, camera.method), (Filter::Tent, Method::Map));
    assert_eq!((camera.bandwidth, camera.kernel), (Bandwidth::Automatic, Kernel::Epanechnikov));
    assert_eq!((camera.background_cd_m2, camera.exposure), ([0.0; 3], Exposure::Auto));
    assert_eq!((camera.filmic, camera.false_colour), (false, false));
    assert_eq!(camera.photon_memory_bytes, 2 << 30);
    let file = read(REQUIRED).unwrap();
    assert!(file.warnings.is_empty(), "a camera is reason enough: {:?}", file.warnings);
}

#[test]
fn every_key_is_read() {
    let camera = spec(&format!(
        "{REQUIRED}up = [1, 0, 0]\nsamples = 64\nlens_radius = 0.02\nfocus = 1.5\nfilter = \"gaussian\"\n\
         method = \"map\"\nnearest = 120\nkernel = \"flat\"\nbackground = [1, 2, 3]\nexposure = 250\nfilmic = true\n\
         false_colour = true\nphoton_memory_mb = 0x10\n"
    ));
    assert_eq!(camera.up, DVec3::X);
    assert_eq!((camera.samples, camera.lens_radius_m, camera.focus_m), (64, 0.02, 1.5));
    assert_eq!((camera.filter, camera.kernel), (Filter::Gaussian, Kernel::Flat));
    assert_eq!((camera.bandwidth, camera.exposure), (Bandwidth::Nearest(120), Exposure::White(250.0)));
    assert_eq!(camera.background_cd_m2, [1.0, 2.0, 3.0]);
    assert!(camera.filmic && camera.false_colour);
    assert_eq!(camera.photon_memory_bytes, 16_000_000);
    let other = |keys: &str| spec(&format!("{REQUIRED}{keys}\n"));
    assert_eq!(other("radius = 0.01").bandwidth, Bandwidth::Radius(0.01));
    assert_eq!(other("progressive_radius = 0.1").bandwidth, Bandwidth::Progressive(0.1));
    assert_eq!(other("method = \"splat\"").method, Method::Splat);
    assert_eq!(other("filter = \"box\"").filter, Filter::Box);
    assert_eq!(other("exposure = \"auto\"\nbackground = 7").background_cd_m2, [7.0; 3]);
}

#[test]
fn looking_along_z_takes_y_for_up() {
    for look_at in ["[0, -3, 4]", "[0, -3, -4]"] {
        let keys = REQUIRED.replace("[0, 0, 4]", look_at);
        let camera = spec(&keys);
        assert_eq!((camera.up, camera.forward.x, camera.forward.y), (DVec3::Y, 0.0, 0.0));
    }
    // Almost along it: still orthogonal.
    let camera = spec(&REQUIRED.replace("[0, 0, 4]", "[0, -2.9999, 4]"));
    assert!(camera.up.dot(camera.forward).abs() < 1e-15 && (camera.up.length() - 1.0).abs() < 1e-15);
}

/// (keys after the required ones, line of the error after them, kind, required); the required keys are REQUIRED.
fn expect(keys: &str, line: usize, kind: Kind, required: &str) -> Diagnostic {
    let errors = read(keys).expect_err(keys);
    assert_eq!(errors.len(), 1, "{keys}: {errors:#?}");
    assert_eq!(errors[0].line(), Some(HEADER_LINE + line), "{}", errors[0]);
    assert_eq!(errors[0].kind(), kind, "{}", errors[0]);
    assert!(errors[0].required().contains(required), "{}", errors[0]);
    errors[0].clone()
}

#[test]
fn what_is_required_is_missed() {
    for (key, required) in
        [("position", "[x, y, z]"), ("look_at", "[x, y, z]"), ("fov_deg", "degrees"), ("pixels", "columns")]
    {
        let without: String =
            REQUIRED.lines().filter(|l| !l.starts_with(key)).map(|l| format!("{l}\n")).collect();
        let error = expect(&without, 0, Kind::Missing, required);
        assert_eq!(error.found(), format!("[camera] without `{key}`"));
    }
}

#[test]
fn every_rule_broken_once() {
    let five = |line: &str| format!("{REQUIRED}{line}\n");
    let hint = expect(&five("samlpes = 4"), 5, Kind::Unknown, "position, look_at");
    assert_eq!(hint.advice(), Some("did you mean `samples`?"));
    for (line, kind, required) in [
        ("samples = 0", Kind::Range, "multiple of 4"),
        ("samples = 18", Kind::Range, "multiple of 4"),
        ("samples = 65540", Kind::Range, "65536"),
        ("samples = 4.0", Kind::Syntax, "multiple of 4"),
        ("up = [0, 0, 0]", Kind::Range, "not zero and not along the view"),
        ("up = [0, -0.6, -0.8]", Kind::Range, "not along the view"),
        ("lens_radius = -0.1", Kind::Range, "pinhole"),
        ("focus = 0", Kind::Range, "a length from 1e-9"),
        ("filter = \"mitchell\"", Kind::Unknown, "box, tent or gaussian"),
        ("method = \"path\"", Kind::Unknown, "map or splat"),
        ("radius = 0", Kind::Range, "a length"),
        ("nearest = 1", Kind::Range, "from 2 to 2^20"),
        ("nearest = 1048577", Kind::Range, "from 2 to 2^20"),
        ("progressive_radius = nan", Kind::Range, "a length"),
        ("kernel = \"cone\"", Kind::Unknown, "flat or epanechnikov"),
        ("background = -1", Kind::Range, "cd/m2"),
        ("background = [1, 2]", Kind::Syntax, "3 numbers"),
        ("exposure = 0", Kind::Range, "\"auto\""),
        ("exposure = true", Kind::Syntax, "\"auto\""),
        ("exposure = \"bright\"", Kind::Unknown, "auto"),
        ("filmic = 1", Kind::Syntax, "true or false"),
        ("false_colour = \"yes\"", Kind::Syntax, "true or false"),
        ("photon_memory_mb = 0", Kind::Range, "megabytes"),
    ] {
        expect(&five(line), 5, kind, required);
    }
    for (line, bad, kind, required) in [
        (2, REQUIRED.replace("[0, 0, 4]", "[0, -3, 0]"), Kind::Range, "away from position"),
        (3, REQUIRED.replace("40", "180"), Kind::Range, "179"),
        (3, REQUIRED.replace("40", "0"), Kind::Range, "0.001"),
        (4, REQUIRED.replace("200", "0"), Kind::Range, "at least 1"),
        (4, REQUIRED.replace("[320, 200]", "[8192, 8193]"), Kind::Limit, "2^26"),
        (4, REQUIRED.replace("[320, 200]", "320"), Kind::Syntax, "columns"),
    ] {
        expect(&bad, line, kind, required);
    }
    expect(&five("radius = 0.1\nnearest = 50"), 6, Kind::Range, "not several");
    expect(&five("progressive_radius = 0.1\nradius = 0.1"), 6, Kind::Range, "not several");
    expect(&five("lens_radius = 0.1\nmethod = \"splat\""), 5, Kind::Range, "one point");
}

#[test]
fn what_splatting_does_not_look_at_is_said() {
    let file = read(&format!("{REQUIRED}method = \"splat\"\nradius = 0.1\nkernel = \"flat\"\n")).unwrap();
    let found: Vec<&str> = file.warnings.iter().map(Diagnostic::found).collect();
    assert_eq!(found, ["radius with method = \"splat\"", "kernel with method = \"splat\""]);
}

#[test]
fn a_scene_with_a_camera_requires_it_and_only_the_map_keeps_photons() {
    let words = |keys: &str| requirements(&read(keys).unwrap().build().unwrap());
    assert_eq!(words(REQUIRED), ["isotropic emission", "triangles", "camera", "stored photons"]);
    let splat = words(&format!("{REQUIRED}method = \"splat\"\n"));
    assert_eq!(splat, ["isotropic emission", "triangles", "camera"]);
    let scene = read(REQUIRED).unwrap().build().unwrap();
    assert_eq!(scene.camera.as_deref(), Some(&spec(REQUIRED)));
}

#[test]
fn check_tells_of_the_camera() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.toml");
    let check = |text: &str, json: &[&str]| {
        std::fs::write(&file, text).unwrap();
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_caustix"));
        let output = command.arg("check").arg(&file).args(json).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let with = format!("{SCENE}[camera]\n{REQUIRED}");
    let text = check(&with, &[]);
    let line = "camera     320 x 200 pixels of 16 samples, map, at most 2 147 MB of photons at a time\n";
    assert!(text.contains(line), "{text}");
    let json: serde_json::Value = serde_json::from_str(&check(&with, &["--json"])).unwrap();
    assert_eq!(json["camera"]["pixels"], serde_json::json!([320, 200]));
    let json: serde_json::Value = serde_json::from_str(&check(SCENE, &["--json"])).unwrap();
    assert!(json.get("camera").is_none());
}
