//! Scenes from strangers: what all of their parts ask for together, and which files they get at.

use std::fs;
use std::path::Path;
use std::time::Instant;

use caustix::error::{Diagnostic, Kind};
use caustix::files::scene_toml::{SceneFile, read, read_confined};
use caustix::scene::Scene;

use crate::support::data::project;
use crate::support::png::grey_8;

const HEAD: &str = "[[emitter]]\ntype = 'isotropic'\nposition = [0, 0, 9000]\nflux_lm = 100\n\
                    [material.black]\ntype = 'absorber'\n";

/// A scene of lines 7 on, one surface of `LINES` lines after another.
const LINES: usize = 8;

fn image(i: usize, file: &str) -> String {
    format!(
        "[[surface]]\nname = 'h{i}'\ntype = 'heightfield'\nmaterial = 'black'\norigin = [-0.5, -0.5, {i}.5]\nsize = [1.0, 1.0]\n\
         facing = 'up'\nimage = '{file}'\nheight = [0.0, 0.05]\n"
    )
}

fn mesh(i: usize, file: &str) -> String {
    format!(
        "[[surface]]\nname = 'm{i}'\ntype = 'mesh'\nmaterial = 'black'\nfile = '{file}'\ntranslate = [0, 0, {i}]\n\n\n"
    )
}

/// What is wrong with a scene in a folder of these files.
fn errors(files: &[(&str, &[u8])], scene: &str) -> Vec<Diagnostic> {
    built(files, scene).unwrap_err()
}

fn built(files: &[(&str, &[u8])], scene: &str) -> Result<Scene, Vec<Diagnostic>> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    let path = folder.path().join("scene.toml");
    fs::write(&path, scene).unwrap();
    read(&path).and_then(SceneFile::build)
}

/// The only error: kind, line of the part, total and bound.
fn expect(errors: &[Diagnostic], line: usize, found: &str, required: &str) {
    let [e] = errors else { panic!("{errors:?}") };
    assert_eq!((e.kind(), e.line(), e.found(), e.required()), (Kind::Limit, Some(line), found, required));
}

#[test]
fn an_image_named_five_times_counts_five_times() {
    // A picture of one grey packs a thousandfold: 2047 x 2047 cells, of which four are below 2^24.
    let picture = grey_8([2048, 2048], &vec![0; 2048 * 2048]);
    assert!(picture.len() < 20_000, "{}", picture.len());
    let fields: String = (0..5).map(|i| image(i, "bomb.png")).collect();
    let start = Instant::now();
    let wrong = errors(&[("bomb.png", &picture)], &format!("{HEAD}{fields}"));
    let line = 7 + 4 * 9;
    expect(
        &wrong,
        line,
        "the heightfield `h4`, with which there are 20951045 cells",
        "at most 2^24 cells in all heightfields of a scene",
    );
    // 5 * 2047^2; and nothing was made of the four before it.
    assert_eq!(5 * 2047 * 2047, 20_951_045);
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
}

#[test]
fn pixels_count_where_cells_are_few() {
    let picture = grey_8([8192, 8192], &vec![0; 8192 * 8192]);
    let fields: String = (0..5).map(|i| image(i, "grey.png") + "cells = [1, 1]\n").collect();
    expect(
        &errors(&[("grey.png", &picture)], &format!("{HEAD}{fields}")),
        7 + 4 * 10,
        "the heightfield `h4`, with which there are 335544320 pixels",
        "at most 2^28 pixels in all height images of a scene",
    );
}

#[test]
fn triangles_of_all_meshes_have_a_cap_and_a_mesh_is_read_once() {
    // A fan of 2^20 corners is 2^20 - 2 triangles; 33 of them are more than 2^25.
    let fan = format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nf{}\n", " 1 2 3 2".repeat(1 << 18));
    let meshes: String = (0..34).map(|i| mesh(i, "fan.obj")).collect();
    let start = Instant::now();
    let wrong = errors(&[("fan.obj", fan.as_bytes())], &format!("{HEAD}{meshes}"));
    expect(
        &wrong,
        7 + 32 * LINES,
        "the surface `m32`, with which there are 34602942 triangles",
        "at most 2^25 triangles in all surfaces of a scene",
    );
    assert_eq!(33 * ((1 << 20) - 2), 34_602_942);
    // The text is looked at once: 34 times would take longer than one of a second each.
    assert!(start.elapsed().as_secs() < 10, "{:?}", start.elapsed());
    // Triangles of heightfields count beside those of meshes: 2^24 cells are 2^25 triangles.
    let field = |i: usize| {
        image(i, "").replace(
            "image = ''\nheight = [0.0, 0.05]\n",
            "cells = [2048, 2048]\nwaves = [{ amplitude = 0.01, wavelength = 1 }]\n",
        )
    };
    let fields: String = (0..4).map(field).collect();
    expect(
        &errors(
            &[("one.obj", b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")],
            &format!("{HEAD}{fields}{}", mesh(9, "one.obj")),
        ),
        7 + 4 * 9,
        "the surface `m9`, with which there are 33554433 triangles",
        "at most 2^25 triangles in all surfaces of a scene",
    );
}

#[test]
fn vertices_count_where_triangles_are_few() {
    let points = format!("{}f 1 2 3\n", "v 0 0 0\nv 1 0 0\nv 1 1 0\n".repeat(200_000));
    let meshes: String = (0..224).map(|i| mesh(i, "points.obj")).collect();
    expect(
        &errors(&[("points.obj", points.as_bytes())], &format!("{HEAD}{meshes}")),
        7 + 223 * LINES,
        "the mesh `m223`, with which there are 134400000 vertices and normals",
        "at most 2^27 vertices and normals in all meshes of a scene",
    );
}

#[test]
fn waves_count_once_for_each_cell() {
    let waves = "{ amplitude = 0.01, wavelength = 1 }, ".repeat(256);
    let field = |i, cells: &str| {
        image(i, "")
            .replace("image = ''\nheight = [0.0, 0.05]\n", &format!("cells = {cells}\nwaves = [{waves}]\n"))
    };
    // 256 of 2^22 cells are 2^30, as many as there may be.
    expect(
        &errors(&[], &format!("{HEAD}{}{}", field(0, "[2048, 2048]"), field(1, "[1, 1]"))),
        7 + 9,
        "the heightfield `h1`, with which there are 1073742080 waves and octaves times cells",
        "at most 2^30 waves and octaves times cells in all heightfields of a scene",
    );
}

#[test]
fn cells_of_receivers_on_faces_count_too() {
    let field = image(0, "").replace(
        "image = ''\nheight = [0.0, 0.05]\n",
        "cells = [512, 256]\nwaves = [{ amplitude = 0.01, wavelength = 1 }]\n",
    );
    let receivers: String =
        (0..260).map(|i| format!("[[receiver]]\nname = 'r{i}'\nsurface = 'h0'\n\n")).collect();
    // 2^18 triangles: 256 receivers have 2^26 cells.
    expect(
        &errors(&[], &format!("{HEAD}{field}{receivers}")),
        7 + 9 + 4 * 256,
        "the receiver `r256`, with which there are 67371008 cells",
        "at most 2^26 cells in all receivers of a scene",
    );
}

#[test]
fn candela_and_scattering_values_have_caps() {
    // 1801 x 1441 values, of which 2^24 hold six tables.
    let angles = |n: usize, last: f64| {
        (0..n).map(|i| format!("{}\n", last * i as f64 / (n - 1) as f64)).collect::<String>()
    };
    let ies = format!(
        "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 1801 1441 1 2 0 0 0\n1 1 0\n{}{}{}",
        angles(1801, 180.0),
        angles(1441, 360.0),
        "1 ".repeat(1801 * 1441)
    );
    let lamps: String = (0..8)
        .map(|i| format!("[[emitter]]\nname = 'l{i}'\ntype = 'photometric'\nfile = 'lamp.ies'\nposition = [0, 0, {i}]\n"))
        .collect();
    expect(
        &errors(&[("lamp.ies", ies.as_bytes())], &format!("{lamps}[material.black]\ntype = 'absorber'\n")),
        1 + 6 * 5,
        "the emitter `l6`, with which there are 18166687 candela values",
        "at most 2^24 candela values in all emitters of a scene",
    );
    assert_eq!(7 * 1801 * 1441, 18_166_687);
}

#[test]
fn faces_in_one_place_are_refused_before_they_are_all_compared() {
    // 20 000 long thin triangles through one point, and as many again: 4e8 pairs of boxes that meet.
    let fan = |z: f64| {
        let mut text = String::new();
        for i in 0..20_000 {
            let (s, c) = (f64::from(i) * 0.001).sin_cos();
            text += &format!("v {c} {s} {z}\nv {} {} {z}\nv {} 0.001 {z}\n", -c, -s, f64::from(i) * 1e-9);
        }
        for i in 0..20_000 {
            text += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
        }
        text
    };
    let scene = format!("{HEAD}{}{}", mesh(0, "a.obj"), mesh(0, "b.obj").replace("m0", "m1"));
    let start = Instant::now();
    let wrong = errors(&[("a.obj", fan(0.0).as_bytes()), ("b.obj", fan(0.0).as_bytes())], &scene);
    let [e] = &wrong[..] else { panic!("{wrong:?}") };
    println!("{e} after {:?}", start.elapsed());
    assert_eq!(e.kind(), Kind::Limit);
    assert!(e.found().contains("contacts cannot be looked for, such as \"m"), "{e}");
    assert!(start.elapsed().as_secs() < 300, "{:?}", start.elapsed());
}

/// Every key that names a file, as a scene of its own.
fn naming(file: &str) -> Vec<(&'static str, String)> {
    let plate = "[[surface]]\nname = 's'\ntype = 'rectangle'\nmaterial = 'm'\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n";
    vec![
        (
            "ies",
            format!(
                "[[emitter]]\ntype = 'photometric'\nfile = '{file}'\nposition = [0, 0, 2]\n[material.m]\ntype = 'absorber'\n{plate}"
            ),
        ),
        (
            "bsdf",
            format!(
                "{}[material.m]\ntype = 'tabulated'\nfile = '{file}'\n{plate}",
                HEAD.replace("black", "other")
            ),
        ),
        ("obj", format!("{HEAD}{}", mesh(0, file))),
        ("image", format!("{HEAD}{}", image(0, file))),
    ]
}

fn told(path: &Path, confine: bool) -> Vec<String> {
    let file = if confine { read_confined(path) } else { read(path) };
    match file.and_then(SceneFile::build) {
        Ok(_) => Vec::new(),
        Err(errors) => errors.iter().map(ToString::to_string).collect(),
    }
}

#[cfg(unix)]
#[test]
fn pipes_devices_and_folders_are_refused_by_every_reader() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    assert!(std::process::Command::new("mkfifo").arg(path("pipe")).status().unwrap().success());
    fs::create_dir(path("folder")).unwrap();
    std::os::unix::fs::symlink(path("pipe"), path("link")).unwrap();
    for (file, what) in [
        ("pipe", "not a regular file (a pipe, a device or a socket)"),
        ("link", "not a regular file (a pipe, a device or a socket)"),
        ("/dev/zero", "not a regular file (a pipe, a device or a socket)"),
        ("folder", "a folder"),
    ] {
        for (reader, scene) in naming(file) {
            fs::write(path("scene.toml"), scene).unwrap();
            let told = told(&path("scene.toml"), false);
            assert!(told.len() == 1 && told[0].contains(what), "{reader} {file}: {told:?}");
        }
        // Scenes themselves, and the readers by themselves.
        let direct = path(file);
        for found in [
            read(&direct).unwrap_err()[0].to_string(),
            caustix::files::photometric::read(&direct).unwrap_err().to_string(),
            caustix::files::bsdf::read(&direct).unwrap_err().to_string(),
        ] {
            assert!(found.contains(what), "{file}: {found}");
        }
    }
}

#[cfg(unix)]
#[test]
fn a_confined_scene_reads_at_and_below_its_folder_alone() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir_all(path("in/below")).unwrap();
    let files = [("ies", "spot.ies"), ("bsdf", "../brdf_tables/opal.scatter")];
    for (_, name) in files {
        let from = project().join("ies").join(name);
        let to = from.file_name().unwrap().to_owned();
        fs::copy(&from, path("out").with_file_name(&to)).unwrap();
        fs::copy(&from, path("in/below").join(&to)).unwrap();
    }
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
    let png = grey_8([3, 3], &[0; 9]);
    for at in ["", "in/below/"] {
        fs::write(path(&format!("{at}a.obj")), obj).unwrap();
        fs::write(path(&format!("{at}a.png")), &png).unwrap();
    }
    symlink(folder.path(), path("in/up")).unwrap();
    symlink(path("in/below"), path("in/down")).unwrap();
    symlink(path("not there"), path("in/dangling")).unwrap();
    let scene = path("in/scene.toml");
    let names = ["spot.ies", "opal.scatter", "a.obj", "a.png"];
    for (k, name) in names.into_iter().enumerate() {
        let told = |file: &str, confine| {
            fs::write(&scene, &naming(file)[k].1).unwrap();
            told(&scene, confine)
        };
        symlink(path(name), path("in/link to ").with_file_name(format!("link {name}"))).unwrap();
        let absolute = path("in/below").join(name).display().to_string();
        for inside in [format!("below/{name}"), format!("./below/../below/{name}"), format!("down/{name}")] {
            assert_eq!(told(&inside, true), Vec::<String>::new(), "{inside}");
        }
        for outside in [format!("../{name}"), format!("up/{name}"), format!("link {name}"), absolute] {
            assert_eq!(told(&outside, false), Vec::<String>::new(), "{outside}");
            let told = told(&outside, true);
            assert!(told.len() == 1 && told[0].contains("outside the scene's folder"), "{outside}: {told:?}");
        }
        // What is not there is told in the same words, so that nobody learns what is.
        for nothing in ["../nothing", "up/nothing", "dangling", "nothing"] {
            let told = told(nothing, true);
            assert!(told.len() == 1 && told[0].contains("is not there or outside"), "{nothing}: {told:?}");
        }
    }
    // A scene file that is a link out of its folder is none of that folder.
    fs::write(path("elsewhere.toml"), &naming("a.obj")[2].1).unwrap();
    symlink(path("elsewhere.toml"), path("in/linked.toml")).unwrap();
    assert!(told(&path("in/linked.toml"), true)[0].contains("outside the scene's folder"));
    assert_eq!(told(&path("elsewhere.toml"), true), Vec::<String>::new());
}

#[cfg(unix)]
#[test]
fn a_tilt_file_is_confined_like_the_file_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("in")).unwrap();
    let ies = fs::read_to_string(project().join("ies/spot.ies")).unwrap();
    fs::write(path("in/lamp.ies"), ies.replace("TILT=NONE", "TILT=lamp.tlt")).unwrap();
    fs::write(path("secret"), "1\n3\n0 45 90\n1.0 0.95 0.9\n").unwrap();
    std::os::unix::fs::symlink(path("secret"), path("in/lamp.tlt")).unwrap();
    fs::write(path("in/scene.toml"), &naming("lamp.ies")[0].1).unwrap();
    let files = |confine: bool| {
        let file = if confine { read_confined(path("in/scene.toml")) } else { read(path("in/scene.toml")) };
        file.unwrap().build().unwrap().identity.files.len()
    };
    assert_eq!((files(false), files(true)), (2, 1));
}

#[test]
fn no_message_repeats_a_foreign_file() {
    // Lines like those of /etc/shadow: whatever reader they are given to, at most a word of 40 characters is told.
    let secret: String =
        (0..40).map(|i| format!("user{i}:$6$salt{i}${}:19000:0:99999:7:::\n", "Hh0".repeat(28))).collect();
    let hash = "Hh0".repeat(14);
    for (reader, scene) in naming("secret.obj") {
        let wrong = errors(&[("secret.obj", secret.as_bytes())], &scene);
        let told: String = wrong.iter().map(|e| format!("{e}\n")).collect();
        assert!(!told.contains(&hash), "{reader}: {told}");
        let users = (0..40).filter(|i| told.contains(&format!("user{i}:"))).count();
        assert!(users <= 1, "{reader}: {told}");
        assert!(told.chars().filter(|c| c.is_control()).all(|c| c == '\n'), "{reader}: {told:?}");
        println!("{reader}: {told}");
    }
}

#[test]
fn the_caps_of_the_manual_are_those_of_the_code() {
    use caustix::files::bytes::{FILE_LIMIT_BYTES, FILES_LIMIT_BYTES};
    use caustix::files::scene_toml::{MOST_PARTS, SCENE_LIMIT_BYTES, asked};
    use caustix::files::{bsdf, height_image, photometric};
    use caustix::geometry::{MOST_CELLS, MOST_PAIRS};
    use caustix::scene::{camera, receiver};
    let power = |n: u64| {
        assert!(n.is_power_of_two());
        format!("2^{}", n.trailing_zeros())
    };
    let bytes = |n: u64| if n >= 1 << 30 { format!("{} GiB", n >> 30) } else { format!("{} MiB", n >> 20) };
    let two = |a: String, b: String| format!("{a}; {b}");
    let rows = [
        ("the scene file", bytes(SCENE_LIMIT_BYTES)),
        ("a file that it names; all of them", two(bytes(FILE_LIMIT_BYTES), bytes(FILES_LIMIT_BYTES))),
        (
            "a photometric file; a scattering table",
            two(bytes(photometric::MAX_FILE_BYTES), bytes(bsdf::MAX_FILE_BYTES)),
        ),
        ("emitters, materials, surfaces, receivers", format!("{MOST_PARTS} each")),
        ("candela values, once for each lamp", power(asked::MOST_CANDELA)),
        ("values of scattering tables, once for each material", power(asked::MOST_SCATTERING)),
        ("cells of a heightfield; of all", two(power(MOST_CELLS), power(asked::MOST_CELLS))),
        ("waves and octaves times cells", power(asked::MOST_TERMS)),
        (
            "pixels of a height image; of all, once for each surface",
            two(power(height_image::MOST_PIXELS), power(asked::MOST_PIXELS)),
        ),
        ("triangles of all surfaces", power(asked::MOST_TRIANGLES)),
        ("vertices and normals, once for each mesh", power(asked::MOST_VERTICES)),
        ("pairs of faces that meet, and 64 more for each face", power(MOST_PAIRS)),
        (
            "cells of all receivers, their grids and the faces of meshes among them",
            power(receiver::MOST_CELLS),
        ),
        ("pixels of the camera", power(camera::MOST_PIXELS)),
        ("events of a photon", caustix::transport::walk::MAX_EVENTS.to_string()),
    ];
    let manual = fs::read_to_string(project().join("docs/SECURITY.md")).unwrap();
    let table: String = rows.iter().map(|(what, most)| format!("| {what} | {most} |\n")).collect();
    assert!(manual.contains(&table), "docs/SECURITY.md has not\n{table}");
}
