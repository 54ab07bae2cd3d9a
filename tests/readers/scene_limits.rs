//! What a scene's files may make the program allocate.

use caustix::error::Kind;
use caustix::files::scene_toml::read;
use caustix::math::digest::sha256_hex;
use glam::DVec3;

use crate::support::data::project;
use crate::support::png::grey_8;

const SCENE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0, 0, 2]
flux_lm = 100
[material.black]
type = "absorber"
[[surface]]
name = "hills"
type = "heightfield"
material = "black"
origin = [0, 0, 0]
size = [1, 1]
facing = "up"
image = "grey.png"
height = [0, 0.1]
"#;

#[test]
fn a_picture_does_not_make_more_triangles_than_cells_may() {
    let folder = tempfile::tempdir().unwrap();
    // 2^22 cells and one column more.
    let picture = grey_8([2050, 2049], &vec![7; 2050 * 2049]);
    std::fs::write(folder.path().join("grey.png"), picture).unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let errors = read(&scene).unwrap().build().unwrap_err();
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!((errors[0].kind(), errors[0].line()), (Kind::Limit, Some(8)), "{}", errors[0]);
    std::fs::write(&scene, format!("{SCENE}cells = [10, 10]\n")).unwrap();
    assert_eq!(read(&scene).unwrap().build().unwrap().geometry.primitive_count(), 200);
    // Without cells: a vertex a pixel, black and white at the heights given.
    let picture = grey_8([4, 3], &[0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0, 255]);
    std::fs::write(folder.path().join("grey.png"), picture).unwrap();
    std::fs::write(&scene, SCENE).unwrap();
    let scene = read(&scene).unwrap().build().unwrap();
    assert_eq!(scene.geometry.primitive_count(), 2 * 3 * 2);
    assert_eq!(scene.geometry.bounds(), (DVec3::ZERO, DVec3::new(1.0, 1.0, 0.1)));
}

/// Two plates in one place, a lamp on the first and one across a ball of glass: lines of the parts that are wrong.
const WRONG: &str = r#"[[emitter]]
name = "on the plate"
type = "isotropic"
position = [0.5, 0.25, 0]
flux_lm = 100
[[emitter]]
name = "across the ball"
type = "disc"
position = [0, 0, 5]
radius = 2
flux_lm = 100
[material.black]
type = "absorber"
[material.glass]
type = "dielectric"
ior = 1.5
[[surface]]
name = "ball"
type = "sphere"
material = "glass"
center = [0, 0, 5]
radius = 1
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [0, 0, 0]
edge_u = [1, 0, 0]
edge_v = [0, 1, 0]
[[surface]]
name = "again"
type = "rectangle"
material = "black"
corner = [0, 0, 0]
edge_u = [1, 0, 0]
edge_v = [0, 1, 0]
[[receiver]]
surface = "plate"
"#;

#[test]
fn errors_of_the_whole_scene_point_to_the_part_they_are_about() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, WRONG).unwrap();
    let errors = read(&scene).unwrap().build().unwrap_err();
    let places: Vec<_> = errors.iter().map(|e| (e.line(), e.column(), e.kind())).collect();
    assert_eq!(places, [30, 1, 6].map(|line| (Some(line), Some(1), Kind::Geometry)), "{errors:?}");
    assert!(errors.iter().all(|e| e.file() == scene.to_str()));
}

const LAMPS: &str = "[[emitter]]\ntype = 'photometric'\nfile = 'lamp.ies'\nposition = [0, 0, 2]\n";
const FLOOR: &str = "[material.m]\ntype = 'absorber'\n[[surface]]\nname = 's'\ntype = 'rectangle'\nmaterial = 'm'\n\
                     corner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n[[receiver]]\nsurface = 's'\n";

#[test]
fn a_file_named_often_is_read_once_and_its_tilt_file_counts() {
    let folder = tempfile::tempdir().unwrap();
    let ies = std::fs::read_to_string(project().join("ies/spot.ies")).unwrap();
    assert!(ies.contains("TILT=NONE"));
    let ies = ies.replace("TILT=NONE", "TILT=C:\\lamps\\tilt.tlt");
    let tilt = "1\n3\n0 45 90\n1.0 0.95 0.9\n";
    std::fs::write(folder.path().join("lamp.ies"), &ies).unwrap();
    std::fs::write(folder.path().join("tilt.tlt"), tilt).unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, LAMPS.repeat(3) + FLOOR).unwrap();
    let file = read(&path).unwrap();
    // Whatever happens to the text afterwards, the hash is of the bytes that are used.
    let scene = file.build().unwrap();
    let hashes = [("lamp.ies", ies.as_str()), ("tilt.tlt", tilt)];
    let hashes = hashes.map(|(name, text)| (name.to_owned(), sha256_hex(text.as_bytes())));
    // Once for each lamp that names them.
    assert_eq!(scene.identity.files, [hashes.clone(), hashes.clone(), hashes].concat());
    // Another tilt file is another scene to saved photons; another name of the same file is not.
    let light = |lamp: &str, tilt: &str| {
        std::fs::write(folder.path().join("tilt.tlt"), tilt).unwrap();
        std::fs::write(folder.path().join("same.ies"), &ies).unwrap();
        std::fs::write(&path, LAMPS.replace("lamp.ies", lamp) + FLOOR).unwrap();
        read(&path).unwrap().build().unwrap().identity.light
    };
    assert_eq!(light("lamp.ies", tilt), light("same.ies", tilt));
    assert_ne!(light("lamp.ies", tilt), light("lamp.ies", &tilt.replace("0.95", "0.94")));
}
