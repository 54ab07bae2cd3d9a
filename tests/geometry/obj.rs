//! OBJ files: read right, refused with a place and a reason, never a panic.

use std::path::Path;

use caustix::error::{Diagnostic, Kind};
use caustix::files::obj::{ObjOptions, parse_obj};
use caustix::geometry::{Mesh, Smoothing, Transform};
use glam::DVec3;

use crate::meshes::Random;

const CUBE: &str = "\
# a cube, quads, outward
mtllib none.mtl
o cube
v 0 0 0
v 1 0 0
v 0 1 0
v 1 1 0
v 0 0 1
v 1 0 1
v 0 1 1
v 1 1 1
vn 0 0 -1
vn 0 0 2
usemtl glass
f 1//1 3//1 4//1 2//1
f 5//2 6//2 8//2 7//2
g sides
f 1 2 6 5
f -6/1 -2/1 -1/1 -5/1
f 1 5 7 3
f 2 4 8 6
";

fn parse(text: &str, options: &ObjOptions) -> Result<(Mesh, Vec<Diagnostic>), Diagnostic> {
    parse_obj(text.as_bytes(), Path::new("cube.obj"), options)
}

fn closed() -> ObjOptions {
    ObjOptions { closed: true, ..ObjOptions::default() }
}

#[test]
fn a_cube_of_quads_is_read_with_groups_normals_and_negative_indices() {
    let (mesh, warnings) = parse(CUBE, &closed()).unwrap();
    assert_eq!(warnings, []);
    assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (8, 12));
    assert_eq!(mesh.topology().signed_volume_m3, 1.0);
    assert_eq!(mesh.area(), 6.0);
    assert!(mesh.is_smooth());
    let numbers: Vec<u32> = (0..12).map(|i| mesh.face_number(i)).collect();
    assert_eq!(numbers, [1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6]);
}

#[test]
fn transforms_apply_and_welding_ignores_other_attributes() {
    // Every face with vertices of its own: only positions decide what an edge is.
    let (mesh, _) = parse(CUBE, &closed()).unwrap();
    let mut text = String::new();
    for face in 0..12 {
        for v in mesh.triangle(face) {
            text += &format!("v {} {} {}\n", v.x, v.y, -0.0 + v.z);
        }
        text += &format!("vn {} 1 1\nf -3//-1 -2//-1 -1//-1\n", face);
    }
    let transform = Transform::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.0, 0.0, 90.0), DVec3::X).unwrap();
    let (split, _) =
        parse(&text, &ObjOptions { transform, smoothing: Smoothing::Computed, closed: true }).unwrap();
    assert_eq!(split.vertices().len(), 8);
    assert!((split.topology().signed_volume_m3 - 6.0).abs() < 1e-15);
    assert!(split.vertices().contains(&DVec3::new(-1.0, 1.0, 3.0)));
}

#[test]
fn every_fault_has_its_line_and_reason() {
    let swap = |from: &str, to: &str| CUBE.replacen(from, to, 1);
    for (text, kind, place, word) in [
        (swap("v 1 0 0", "v 1 nan 0"), Kind::Range, Some((5, 5)), "nan"),
        (swap("v 1 0 0", "v 1 inf 0"), Kind::Range, Some((5, 5)), "inf"),
        (swap("v 1 0 0", "v 1 1e31 0"), Kind::Range, Some((5, 5)), "1e31"),
        (swap("v 1 0 0", "v 1 zero 0"), Kind::Syntax, Some((5, 5)), "zero"),
        (swap("v 1 0 0", "v 1 0"), Kind::Syntax, Some((5, 1)), "2 numbers"),
        (swap("v 1 0 0", "v 1 0 0 2"), Kind::Syntax, Some((5, 9)), "weight"),
        (swap("vn 0 0 2", "vn 0 0 0"), Kind::Syntax, Some((13, 4)), "length 0"),
        (swap("f 1 2 6 5", "f 1 2 9 5"), Kind::Range, Some((18, 7)), "vertex 9"),
        (swap("f 1 2 6 5", "f 0 2 6 5"), Kind::Range, Some((18, 3)), "vertex 0"),
        (swap("f 1 2 6 5", "f -9 2 6 5"), Kind::Range, Some((18, 3)), "vertex -9"),
        (swap("f 1 2 6 5", "f 1//3 2 6 5"), Kind::Range, Some((18, 3)), "normal 3"),
        (swap("f 1 2 6 5", "f 1/x 2 6 5"), Kind::Syntax, Some((18, 3)), "1/x"),
        (swap("f 1 2 6 5", "f 1 2"), Kind::Syntax, Some((18, 1)), "2 corners"),
        (swap("f 1 2 6 5", "f 1 2 6 \\"), Kind::Syntax, Some((18, 1)), "continued"),
        (swap("f 1 2 6 5\n", ""), Kind::Geometry, None, "4 open edges"),
        (swap("f 1 2 6 5", "f 5 6 2 1"), Kind::Geometry, None, "4 edges of inconsistent orientation"),
        ("v 0 0 0\n".into(), Kind::Missing, None, "no face"),
        (String::new(), Kind::Missing, Some((1, 1)), "an empty file"),
        ("v 0 0 0\nf 1 1 1\n".into(), Kind::Geometry, None, "no triangle"),
    ] {
        let d = parse(&text, &closed()).unwrap_err();
        assert_eq!(d.kind(), kind, "{d}");
        assert_eq!(d.line().zip(d.column()), place, "{d}");
        assert!(d.found().contains(word), "{d}");
        assert_eq!(d.file(), Some("cube.obj"));
    }
}

#[test]
fn what_is_odd_but_traceable_is_warned_about_by_number() {
    for (more, word) in [
        ("f 1 1 2\n", "degenerate faces 7 (dropped)"),
        ("v 0.5 0 0\nf 1 9 2\n", "faces without area 7"),
        ("f 1 2 6\n", "duplicate"),
        ("f 1 2 6\n", "edges of more than two faces"),
        ("f 1 2 6\n", "inconsistent orientation"),
        ("v 0 0 5\nv 2 0 5\nv 0.2 0.2 5\nv 0 2 5\nf 10 11 12 9\n", "concave"),
        ("curv 0 1 1 2\n", "curv"),
    ] {
        let (_, warnings) = parse(&format!("{CUBE}{more}"), &ObjOptions::default()).unwrap();
        assert!(warnings.iter().any(|w| w.found().contains(word)), "{word}: {warnings:?}");
    }
    let (mesh, _) = parse(&CUBE.replacen("f 1 2 6 5\n", "", 1), &ObjOptions::default()).unwrap();
    assert_eq!(mesh.topology().open_edges, 4);
    assert!(!mesh.topology().is_closed());
}

#[test]
fn truncated_and_mutated_files_give_a_mesh_or_a_diagnostic() {
    let (mut read, mut refused) = (0, 0);
    let mut feed = |bytes: &[u8]| match parse_obj(bytes, Path::new("x.obj"), &ObjOptions::default()) {
        Ok(_) => read += 1,
        Err(d) => {
            assert!(!d.found().is_empty());
            refused += 1;
        }
    };
    for cut in 0..CUBE.len() {
        feed(&CUBE.as_bytes()[..cut]);
    }
    let alphabet = b"0123456789-+.eEvnf /\\#\n\tNaInf\xff\x00";
    for i in 0..30_000 {
        let mut r = Random::new(31, i);
        let mut bytes = CUBE.as_bytes().to_vec();
        for _ in 0..=r.below(6) {
            let at = r.below(bytes.len());
            match r.below(4) {
                0 => bytes[at] = alphabet[r.below(alphabet.len())],
                1 => bytes.insert(at, alphabet[r.below(alphabet.len())]),
                2 => drop(bytes.remove(at)),
                _ => {
                    let end = (at + r.below(40)).min(bytes.len());
                    let piece = bytes[at..end].to_vec();
                    let to = r.below(bytes.len());
                    bytes.splice(to..to, piece);
                }
            }
        }
        feed(&bytes);
    }
    println!("{read} read, {refused} refused");
    assert!(read > 3000 && refused > 3000, "{read} {refused}");
}
