//! What a scene's files may make the program allocate.

use caustix::error::Kind;
use caustix::files::scene_toml::build::build;
use caustix::files::scene_toml::read;

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
    let grey = image::GrayImage::from_pixel(2050, 2049, image::Luma([7]));
    grey.save(folder.path().join("grey.png")).unwrap();
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    let errors = build(&read(&scene).unwrap()).unwrap_err();
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!((errors[0].kind(), errors[0].line()), (Kind::Limit, Some(8)), "{}", errors[0]);
    std::fs::write(&scene, format!("{SCENE}cells = [10, 10]\n")).unwrap();
    assert_eq!(build(&read(&scene).unwrap()).unwrap().geometry.primitive_count(), 200);
}

/// Two plates in one place, a lamp on the first and one inside glass: lines of the parts that are wrong.
const WRONG: &str = r#"[[emitter]]
name = "on the plate"
type = "isotropic"
position = [0.5, 0.25, 0]
flux_lm = 100
[[emitter]]
name = "in the ball"
type = "isotropic"
position = [0, 0, 5]
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
    let errors = build(&read(&scene).unwrap()).unwrap_err();
    let places: Vec<_> = errors.iter().map(|e| (e.line(), e.column(), e.kind())).collect();
    assert_eq!(places, [29, 1, 6].map(|line| (Some(line), Some(1), Kind::Geometry)), "{errors:?}");
    assert!(errors.iter().all(|e| e.file() == scene.to_str()));
}
