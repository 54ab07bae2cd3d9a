//! A picture by the command: the same bytes for any number of threads and from saved photons; maps that are refused.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::support::stranger::Stranger;

/// A glass ball over a table under a beam and a panel, before a camera: `table` is the table's reflectance, `keys` more keys of
/// the camera.
fn ball(table: &str, keys: &str) -> String {
    format!(
        r#"
[[emitter]]
name = "lamp"
type = "collimated"
position = [0.0, 0.0, 1.0]
radius = 0.2
flux_lm = 100
[[emitter]]
name = "sky"
type = "panel"
position = [0.0, 0.0, 1.5]
size = [0.5, 0.5]
flux_lm = 60
[material.glass]
type = "dielectric"
ior = 1.5
[material.table]
type = "lambertian"
reflectance = {table}
[[surface]]
name = "ball"
type = "sphere"
material = "glass"
center = [0.0, 0.0, 0.25]
radius = 0.2
[[surface]]
name = "table"
type = "rectangle"
material = "table"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 2.0, 0.0]
[[receiver]]
surface = "table"
cells = [8, 8]
[camera]
position = [0.3, -1.2, 0.8]
look_at = [0.0, 0.0, 0.1]
fov_deg = 45
pixels = [24, 18]
samples = 4
{keys}
"#
    )
}

const GREY: &str = "0.6";
const COLOUR: &str = "[0.6, 0.4, 0.2]";

struct Folder(Stranger);

impl Folder {
    fn new() -> Self {
        Self(Stranger::new())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path(name)
    }

    fn scene(&self, name: &str, text: &str) {
        self.0.write(name, text);
    }

    /// `caustix render LINE` here; the exit code and what was said.
    fn render(&self, line: &str) -> (i32, String) {
        let (code, _, said) = self.0.types(&format!("render {line} --photons 2^15 --replicates 4"));
        (code, said)
    }

    /// A picture that must succeed: the bytes of camera.exr and camera.png, and the report.
    fn picture(&self, line: &str, out: &str) -> (Vec<u8>, Vec<u8>, Value) {
        let (code, said) = self.render(&format!("{line} -o {out} --quiet"));
        assert_eq!(code, 0, "{line}: {said}");
        let read = |name: &str| fs::read(self.path(out).join(name)).unwrap();
        let report = serde_json::from_slice(&read("report.json")).unwrap();
        (read("camera.exr"), read("camera.png"), report)
    }

    /// A line that must fail with exit code 1, say all of these, and write nothing.
    fn refused(&self, line: &str, all: &[&str]) {
        let (code, said) = self.render(&format!("{line} -o refused"));
        assert_eq!(code, 1, "{line}: {said}");
        for part in all {
            assert!(said.contains(part), "{line}: no \"{part}\" in\n{said}");
        }
        assert!(!self.path("refused").exists(), "{line}");
    }
}

#[test]
fn one_two_and_seven_threads_write_the_same_picture() {
    let folder = Folder::new();
    for (name, table, keys, least_passes) in [
        ("map-grey", GREY, "", 1),
        ("map-colour", COLOUR, "", 1),
        ("passes-grey", GREY, "photon_memory_mb = 1", 2),
        ("passes-colour", COLOUR, "photon_memory_mb = 1", 2),
        ("splat-grey", GREY, "method = \"splat\"", 1),
        ("splat-colour", COLOUR, "method = \"splat\"", 1),
    ] {
        folder.scene("scene.toml", &ball(table, keys));
        let on = |threads: u32| {
            let line = format!("scene.toml --threads {threads}");
            folder.picture(&line, &format!("{name}-{threads}"))
        };
        let (exr, png, report) = on(1);
        let passes = report["camera"]["passes"].as_u64().unwrap();
        println!("{name}: {passes} passes, {} photons kept", report["camera"]["photons_kept"]);
        assert!(passes >= least_passes, "{name}: {passes}");
        assert!(report["camera"]["photons_kept"].as_u64().unwrap() > 10_000, "{name}");
        for threads in [2, 7] {
            let (other_exr, other_png, _) = on(threads);
            assert!(other_exr == exr, "{name}: camera.exr on {threads} threads");
            assert!(other_png == png, "{name}: camera.png on {threads} threads");
        }
        let (other_seed, _, _) = folder.picture("scene.toml --seed 9", &format!("{name}-seed"));
        assert!(other_seed != exr, "{name}: the seed matters");
    }
}

#[test]
fn saved_photons_give_the_bytes_of_the_fresh_picture_and_one_of_another_view() {
    let folder = Folder::new();
    for (name, table, other) in [("grey", GREY, COLOUR), ("colour", COLOUR, GREY)] {
        folder.scene("scene.toml", &ball(table, ""));
        let (exr, png, fresh) = folder.picture("scene.toml --save-map photons.map", &format!("{name}-fresh"));
        for threads in [1, 2, 7] {
            let line = format!("scene.toml --map photons.map --threads {threads}");
            let (again_exr, again_png, _) = folder.picture(&line, &format!("{name}-again-{threads}"));
            assert!(again_exr == exr && again_png == png, "{name} on {threads} threads");
        }
        // Another camera sees the same photons: that of a fresh run.
        folder.scene("closer.toml", &ball(table, "").replace("-1.2, 0.8", "-0.8, 0.6"));
        let (closer, _, report) = folder.picture("closer.toml --map photons.map", &format!("{name}-closer"));
        let (traced, _, _) = folder.picture("closer.toml", &format!("{name}-traced"));
        assert!(closer == traced && closer != exr, "{name}");
        assert_says_what_was_read(&fresh, &report);
        // A scene of the other number of channels.
        folder.scene("other.toml", &ball(other, ""));
        folder.refused("other.toml --map photons.map", &["photons.map", "hash"]);
    }
}

#[test]
fn a_background_in_colour_or_not_is_the_camera_s_affair_alone() {
    let folder = Folder::new();
    let (grey, blue) = ("background = [0.5, 0.5, 0.5]", "background = [0.2, 0.5, 0.9]");
    for (from, to) in [(grey, blue), (blue, grey)] {
        folder.scene("from.toml", &ball(GREY, from));
        folder.scene("to.toml", &ball(GREY, to));
        let (one, _, _) = folder.picture("from.toml --save-map photons.map", "from");
        let (saved_exr, saved_png, _) = folder.picture("to.toml --map photons.map", "saved");
        let (fresh_exr, fresh_png, _) = folder.picture("to.toml", "fresh");
        assert!(saved_exr == fresh_exr && saved_png == fresh_png && one != fresh_exr, "{from} {to}");
    }
}

#[test]
fn photons_too_many_to_save_cost_only_their_file() {
    let folder = Folder::new();
    folder.scene("scene.toml", &ball(GREY, "photon_memory_mb = 1"));
    let (_, _, report) = folder.picture("scene.toml", "without");
    assert!(report["camera"]["passes"].as_u64().unwrap() > 1);
    let (code, said) = folder.render("scene.toml --save-map photons.map -o with --quiet");
    assert!(code == 1 && said.contains("--save-map") && said.contains("photon_memory_mb"), "{code} {said}");
    assert!(!folder.path("photons.map").exists());
    for name in ["camera.exr", "camera.png", "report.json", "table.exr"] {
        assert!(folder.path("with").join(name).exists(), "{name}");
    }
}

#[test]
fn check_refuses_the_cameras_that_render_refuses() {
    let folder = Folder::new();
    let on_the_ball = ball(GREY, "").replace("[0.3, -1.2, 0.8]", "[0.0, 0.0, 0.45]");
    let too_large = ball(GREY, "method = \"splat\"").replace("[24, 18]", "[2900, 3600]");
    for (text, part) in [(on_the_ball, "the camera on surface"), (too_large, "which takes")] {
        folder.scene("scene.toml", &text);
        folder.refused("scene.toml", &[part]);
        folder.0.is_told("check scene.toml", 1, &[part]);
    }
}

/// The report of a picture of saved photons against that of the run that saved them.
fn assert_says_what_was_read(fresh: &Value, saved: &Value) {
    for key in ["caustix", "variant", "sequence", "solver", "seed", "photons", "replicates", "warnings"] {
        assert_eq!(saved[key], fresh[key], "{key}");
    }
    assert_eq!((&saved["map"], &saved["stopped_by"]), (&Value::from("photons.map"), &Value::from("photons")));
    assert_eq!(saved["scene"]["path"], "closer.toml");
    assert_ne!(saved["scene"]["sha256"], fresh["scene"]["sha256"], "another camera is another file");
    assert!(saved["time"]["total_s"].as_f64().unwrap() > 0.0);
    for key in ["pixels", "samples", "method", "photons", "photons_kept", "passes", "bandwidth", "files"] {
        assert_eq!(saved["camera"][key], fresh["camera"][key], "{key}");
    }
    for key in ["receivers", "ledger_lm"] {
        assert!(saved[key].is_null(), "{key}: nothing was traced");
    }
}

#[test]
fn damaged_maps_and_those_of_another_run_are_refused_by_name_and_reason() {
    let folder = Folder::new();
    folder.scene("scene.toml", &ball(GREY, ""));
    folder.picture("scene.toml --save-map photons.map", "fresh");
    let good = fs::read(folder.path("photons.map")).unwrap();
    let damage = |name: &str, bytes: &[u8]| fs::write(folder.path(name), bytes).unwrap();
    let flipped = |at: usize| {
        let mut bytes = good.clone();
        bytes[at] ^= 1;
        bytes
    };
    damage("flipped.map", &flipped(good.len() / 2));
    damage("digest.map", &flipped(good.len() - 1));
    damage("half.map", &good[..good.len() / 2]);
    damage("longer.map", &[good.as_slice(), b"x"].concat());
    damage("empty.map", b"");
    damage("other.map", b"P6 a picture, not photons, and some more bytes to fill it up to 64");
    damage("newer.map", &flipped(8));
    for (name, reason) in [
        ("flipped.map", "checksum"),
        ("digest.map", "checksum"),
        ("half.map", "checksum"),
        ("longer.map", "checksum"),
        ("empty.map", "photon map"),
        ("other.map", "photon map"),
        ("newer.map", "version"),
        ("missing.map", "missing.map"),
    ] {
        folder.refused(&format!("scene.toml --map {name}"), &["error", name, reason]);
    }
    // Another text of the same light: a comment, a blank line, another way to write a number, another camera.
    let same = ball(GREY, "kernel = \"flat\"").replace("0.25", "2.5e-1");
    folder.scene("same.toml", &format!("# again\n\n{same}"));
    folder.picture("same.toml --map photons.map", "same");
    folder.refused(
        "scene.toml --map photons.map --seed 9",
        &["traced by qmc-inverse-reuse", "seed 1", "same settings"],
    );
    // More than this camera has memory for.
    folder.scene("small.toml", &ball(GREY, "photon_memory_mb = 1"));
    folder.refused("small.toml --map photons.map", &["saved photons", "photon_memory_mb"]);
    // Whole, but of other photons: another seed, another number, another sequence, another scene.
    for options in ["--seed 9", "--sequence independent", "--variant mc"] {
        folder.refused(
            &format!("scene.toml --map photons.map {options}"),
            &["photons.map", "hash", "trace the photons again"],
        );
    }
    folder.scene("lower.toml", &ball(GREY, "").replace("0.0, 0.0, 0.25", "0.0, 0.0, 0.24"));
    folder.refused("lower.toml --map photons.map", &["photons.map", "hash", "the scene or a file of it"]);
    folder.scene("splat.toml", &ball(GREY, "method = \"splat\""));
    folder.refused("splat.toml --map photons.map", &["splat", "method = \"map\""]);
}
