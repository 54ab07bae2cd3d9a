//! A scene in code: what its builder takes, and that it tells all that is wrong at once, each at its place.

use caustix::emitter::{Emitter, Isotropic};
use caustix::error::Place;
use caustix::geometry::{Rectangle, Shape, Sphere};
use caustix::scene::SceneBuilder;
use caustix::scene::receiver::{Cells, ReceiverSpec};
use caustix::surface::Material;
use glam::DVec3;

fn plate(z: f64) -> Shape {
    Rectangle::new(DVec3::Z * z, DVec3::X, DVec3::Y).unwrap().into()
}

fn lamp(position: DVec3) -> Emitter {
    Emitter::Isotropic(Isotropic::new(position, 100.0).unwrap())
}

fn receiver(name: &str, surface: &str) -> ReceiverSpec {
    ReceiverSpec::new(name, surface).unwrap()
}

#[test]
fn a_scene_in_code_needs_no_text_and_no_file() {
    let mut scene = SceneBuilder::new();
    scene
        .surface("plate", plate(0.0), Material::Absorber)
        .emitter("lamp", lamp(DVec3::ONE))
        .receiver(receiver("plate", "plate"))
        .receiver(receiver("fine", "plate").with_cells([512, 256]).unwrap());
    let scene = scene.build().unwrap();
    assert_eq!(scene.receivers[0].cells, Cells::Grid { nu: 256, nv: 256 });
    assert_eq!(scene.receivers[1].cells, Cells::Grid { nu: 512, nv: 256 });
    assert_eq!((scene.emitters.flux_lm(), scene.emitter_colour(0)), (100.0, [1.0; 3]));
    assert!(scene.identity.light.is_empty() && scene.warnings.is_empty());
}

#[test]
fn all_that_is_wrong_is_told_at_once_and_where() {
    let mut scene = SceneBuilder::new();
    let mut line = 0;
    let mut next = || {
        line += 1;
        Place { line, column: 1 }
    };
    scene.at(next()).surface("plate", plate(0.0), Material::Absorber);
    scene.at(next()).surface("again", plate(0.0), Material::Absorber);
    scene.at(next()).emitter("lamp", lamp(DVec3::ONE));
    scene.at(next()).emitter("lamp", lamp(DVec3::ONE));
    scene.at(next()).emitter("on it", lamp(DVec3::new(0.5, 0.25, 0.0)));
    scene.at(next()).receiver(receiver("Plate", "plate").with_cells([8192, 4096]).unwrap());
    scene.at(next()).receiver(receiver("plate", "plate").with_cells([8192, 4096]).unwrap());
    scene.at(next()).receiver(receiver("nowhere", "floor"));
    scene.at(next()).receiver(receiver("third", "plate").with_cells([1, 1]).unwrap());
    let errors = scene.build().unwrap_err();
    let mut told: Vec<_> = errors.iter().map(|e| (e.line().unwrap(), e.found())).collect();
    told.sort_unstable();
    for ((line, found), (expected, word)) in told.iter().zip([
        (2, "again"),
        (4, "the emitter name `lamp` a second time"),
        (5, "emitter \"on it\" on surface"),
        (7, "the receiver name `plate` a second time"),
        (8, "surface \"floor\""),
        (9, "the receiver `third`, with which there are 67108865 cells"),
    ]) {
        assert!(*line == expected && found.contains(word), "{expected} {word}: {told:?}");
    }
    assert_eq!(told.len(), 6, "{told:?}");
}

#[test]
fn what_the_geometry_refuses_does_not_hide_the_rest() {
    let mut scene = SceneBuilder::new();
    let ball = || Sphere::new(DVec3::Z * 5.0, 1.0).unwrap().into();
    scene.surface("s", ball(), Material::Absorber).surface("s", plate(0.0), Material::Absorber);
    scene.emitter("lamp", lamp(DVec3::ONE)).emitter("lamp", lamp(DVec3::ONE));
    let found: Vec<String> = scene.build().unwrap_err().iter().map(|e| e.found().to_owned()).collect();
    assert!(found.iter().any(|f| f.contains("two surfaces named \"s\"")), "{found:?}");
    assert!(found.iter().any(|f| f.contains("emitter name `lamp`")), "{found:?}");
    let empty = SceneBuilder::new().build().unwrap_err();
    assert!(empty[0].required().contains("at least one emitter"), "{empty:?}");
}
