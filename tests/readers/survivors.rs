//! Inputs that `examples/fuzz` found a fault with, each as small as it could be made: what is said of them now.

use std::path::Path;

use caustix::files::obj::{ObjOptions, parse_obj};
use caustix::files::scene_toml::count::parse_count;
use caustix::files::scene_toml::parse_scene;

/// Words of a file stood in messages as they were: control characters move a terminal's cursor and change its colours.
#[test]
fn control_characters_of_a_file_are_escaped() {
    let obj = |text: &str| {
        parse_obj(text.as_bytes(), Path::new("a.obj"), &ObjOptions::default()).unwrap_err().to_string()
    };
    assert_eq!(obj("v 0 0 \u{10}"), "a.obj:1:7: found \"\\u{10}\"; required: a number");
    assert_eq!(obj("v 0 0 \u{1b}[31m"), "a.obj:1:7: found \"\\u{1b}[31m\"; required: a number");
    assert_eq!(
        obj("v 0 0 0\nf 1/\u{7f}/ 1 1"),
        "a.obj:2:3: found \"1/\\u{7f}/\"; required: a whole number for the texture coordinate"
    );
    assert_eq!(
        parse_count("\0").unwrap_err().to_string(),
        "found `\\0`; required: a whole number from 1 to 2^48, written like 4_456_448, 4.5e6 or 2^22"
    );
}

/// A row of 65 536 equal cells: the builder of the tree joined one pair of boxes a round, and took 9 s, for rows of millions hours.
#[test]
fn a_long_row_of_cells_is_built_in_no_time() {
    let scene = "[[emitter]]\ntype = 'isotropic'\nposition = [0, 0, 9]\nflux_lm = 100\n[material.m]\ntype = 'absorber'\n[[surface]]\n\
                 name = 'row'\nmaterial = 'm'\ntype = 'heightfield'\norigin = [-1, -1, 1]\nsize = [0.5, 0.5]\ncells = [65536, 2]\nfacing = 'up'\n\
                 waves = [{ amplitude = 0.01, wavelength = 0.3, direction_deg = 15 }]\n";
    let start = cpu_time::ThreadTime::now();
    let scene = parse_scene(scene, "").unwrap();
    assert_eq!(scene.geometry.primitive_count(), 262_144);
    // 0.4 s, of which the mesh takes the most; 8.6 s before.
    assert!(start.elapsed().as_secs_f64() < 4.0, "{:?}", start.elapsed());
}

/// Open edges all in one place, measured by the size of the mesh: each vertex was compared with all others.
#[test]
fn a_crowd_of_open_edges_in_one_place_is_looked_at_in_no_time() {
    let mut obj = String::from("v 1000 0 0\nv 1000 1 0\nv 1000 0 1\nf 1 2 3\n");
    for i in 0..40_000 {
        let (x, y) = (1e-6 * f64::from(i % 200), 1e-6 * f64::from(i / 200));
        obj += &format!("v {x} {y} 0\nv {} {y} 0\nv {x} {} 0\nf -3 -2 -1\n", x + 1e-7, y + 1e-7);
    }
    let start = cpu_time::ThreadTime::now();
    let (mesh, _) = parse_obj(obj.as_bytes(), Path::new("a.obj"), &ObjOptions::default()).unwrap();
    assert_eq!(mesh.topology().open_edges, 3 * 40_001);
    assert!(start.elapsed().as_secs_f64() < 4.0, "{:?}", start.elapsed());
}
