//! Tabulated materials in scenes: their keys, what goes wrong, and what a table does on a surface, against closed forms.
//!
//! The tables here have two scattered angles, 0 and 90 degrees, so that f cos(theta) falls linearly from f to 0 and the albedo
//! is 2 pi f (1 - 2 / pi): f is written for the albedo wanted.

use std::f64::consts::PI;
use std::fs;

use caustix::error::{Diagnostic, Kind};
use caustix::files::bytes::Base;
use caustix::files::scene_toml::{SceneFile, parse, read};
use caustix::math::digest::sha256_hex;
use caustix::run::{Estimate, Outcome};
use caustix::scene::Scene;
use caustix::scene::requires::requirements;
use caustix::sequence::Sequence;
use glam::DVec3;
use tempfile::TempDir;

use crate::support::data::project;
use crate::support::judge::assert_total;
use crate::support::scenes::run;

/// f in 1/sr of a slice of this albedo.
fn f_of(albedo: f64) -> f64 {
    albedo / (2.0 * PI * (1.0 - 2.0 / PI))
}

/// A lobe whose albedo is the same for all incidences.
fn even(quantity: &str, side: &str, albedo: f64) -> String {
    let f = f_of(albedo);
    format!(
        "frame surface\nsymmetry rotational\nchannels 1\ntheta_i 0\npolar 0 90\nlobe {quantity} {side}\nincidence 0\n\
         {f:.9} {f:.9}\n"
    )
}

/// A reflecting lobe of albedo 0.9 for light along the reference direction and 0.1 for light across it.
fn grooved() -> String {
    let slices = [0.9, 0.1, 0.9, 0.1, 0.9].iter().zip([0, 90, 180, 270, 360]).map(|(albedo, phi)| {
        let f = f_of(*albedo);
        format!("incidence 0 {phi}\n{f:.9} {f:.9}\n")
    });
    let head = "frame surface\nsymmetry rotational\nchannels 1\ntheta_i 0\nphi_i 0 90 180 270 360\npolar 0 90\n\
                lobe reflection both\n";
    head.to_owned() + &slices.collect::<String>()
}

/// A folder with tables, and scenes that read them.
struct Desk {
    folder: TempDir,
}

impl Desk {
    fn new(tables: &[(&str, String)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, lobes) in tables {
            fs::write(folder.path().join(name), format!("caustix-scattering 1\n{lobes}")).unwrap();
        }
        Self { folder }
    }

    fn describe(&self, text: &str) -> SceneFile {
        parse(text, "test.toml", Base::Directory(self.folder.path().into()))
            .unwrap_or_else(|e| panic!("{e:?}\n{text}"))
    }

    fn scene(&self, text: &str) -> Scene {
        self.describe(text).build().unwrap_or_else(|e| panic!("{e:?}\n{text}"))
    }

    fn refused(&self, text: &str) -> Vec<Diagnostic> {
        self.describe(text).build().unwrap_err()
    }
}

const LAMP: &str = "[[emitter]]\ntype = \"isotropic\"\nposition = [0.1, 0.2, 0.3]\nflux_lm = 100\n";
const BLACK: &str = "[material.black]\ntype = \"absorber\"\n";

/// A parallel beam of 100 lm and a cross-section of 0.1 m, from `from` to the origin.
fn beam(from: DVec3) -> String {
    let (p, aim) = (from.to_array(), (-from).to_array());
    format!(
        "[[emitter]]\ntype = \"collimated\"\nposition = {p:?}\naim = {aim:?}\nup = [0.3, 0.5, 0.7]\nsize = [0.1, 0.1]\n\
         flux_lm = 100\n"
    )
}

fn material(keys: &str) -> String {
    format!("[material.sheet]\ntype = \"tabulated\"\n{keys}\n")
}

fn surface(name: &str, keys: &str) -> String {
    format!("[[surface]]\nname = \"{name}\"\nmaterial = \"sheet\"\n{keys}\n")
}

const PLATE: &str = "type = \"rectangle\"\ncorner = [-1, -1, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 2, 0]";

fn absorbed(outcome: &Outcome, scene: &Scene, name: &str) -> Estimate {
    outcome.absorbed_lm(scene.geometry.surfaces().iter().position(|s| s.name == name).unwrap())
}

#[test]
fn keys_and_their_defaults() {
    let desk = Desk::new(&[("t.scatter", even("reflection", "both", 0.5))]);
    let text = |keys: &str| LAMP.to_owned() + &material(keys) + &surface("plate", PLATE);
    let material = |keys: &str| format!("{:?}", desk.scene(&text(keys)).materials()[0]);
    let plain = material("file = \"t.scatter\"");
    let defaults = "file = \"t.scatter\"\nside = \"both\"\nrotation_deg = 0\nreference = [3, 0, 0]\n\
                    energy = \"refuse\"\nspecular_remainder = false";
    assert_eq!(plain, material(defaults));
    for other in
        ["side = \"back\"", "rotation_deg = -30", "reference = [0, 0, 2]", "specular_remainder = true"]
    {
        assert_ne!(plain, material(&format!("file = \"t.scatter\"\n{other}")), "{other}");
    }
    let all = "file = \"t.scatter\"\nside = \"back\"\nrotation_deg = -30\nreference = [0, 0, 2]\nenergy = \"scale\"\n\
               specular_remainder = true";
    let scene = desk.scene(&text(all));
    assert!(requirements(&scene).contains(&"tabulated scattering"));
    // The table is a file of the scene: its hash tells whether a result can be repeated.
    let bytes = fs::read(desk.folder.path().join("t.scatter")).unwrap();
    assert_eq!(scene.identity.files, [("t.scatter".to_owned(), sha256_hex(&bytes))]);
}

#[test]
fn every_mistake_is_told_with_its_place() {
    let errors = |keys: &str| {
        let text = LAMP.to_owned() + &material(keys) + &surface("plate", PLATE);
        parse(&text, "test.toml", Base::Directory(".".into())).unwrap_err()
    };
    for (keys, line, kind, found, required) in [
        ("", 5, Kind::Missing, "a tabulated material without `file`", "the path of a file, relative to"),
        ("file = \"\"", 7, Kind::Range, "file = \"\"", "the path of a file, relative to the scene file"),
        ("file = \"t\"\nside = \"up\"", 8, Kind::Unknown, "side = \"up\"", "front, back or both"),
        ("file = \"t\"\nenergy = true", 8, Kind::Unknown, "energy = true", "refuse or scale"),
        ("file = \"t\"\nrotation_deg = nan", 8, Kind::Range, "rotation_deg = nan", "an angle from -1e6 to"),
        (
            "file = \"t\"\nreference = [0, 0, 0]",
            8,
            Kind::Range,
            "reference = [0, 0, 0]",
            "a direction [x, y, z]",
        ),
        ("file = \"t\"\nspecular_remainder = 1", 8, Kind::Syntax, "specular_remainder = 1", "true or false"),
    ] {
        let errors = errors(keys);
        assert_eq!(errors.len(), 1, "{keys}: {errors:?}");
        assert_eq!(
            (errors[0].line(), errors[0].kind(), errors[0].found()),
            (Some(line), kind, found),
            "{keys}"
        );
        assert!(errors[0].required().contains(required), "{keys}: {}", errors[0]);
    }
    for (keys, near) in
        [("energi = \"scale\"", "energy"), ("rotate_deg = 3", "rotation_deg"), ("sides = 1", "side")]
    {
        let errors = errors(&format!("file = \"t\"\n{keys}"));
        let hint = format!("did you mean `{near}`?");
        assert_eq!((errors[0].kind(), errors[0].advice()), (Kind::Unknown, Some(hint.as_str())), "{keys}");
    }
}

#[test]
fn mistakes_in_the_table_are_told_where_they_are() {
    let desk = Desk::new(&[
        ("bad.scatter", even("reflection", "both", 0.5).replace("polar 0 90", "polar 0 95x")),
        ("bright.scatter", even("reflection", "both", 1.25)),
    ]);
    let text = |keys: &str| LAMP.to_owned() + &material(keys) + &surface("plate", PLATE);
    let scene_file = desk.folder.path().join("scene.toml");
    fs::write(&scene_file, text("file = \"none.scatter\"")).unwrap();
    let missing = read(&scene_file).unwrap_err();
    assert_eq!((missing.len(), missing[0].line(), missing[0].column()), (1, Some(7), Some(8)));
    let errors = desk.refused(&text("file = \"bad.scatter\""));
    let path = desk.folder.path().join("bad.scatter").display().to_string();
    assert_eq!(
        (errors.len(), errors[0].file(), errors[0].line()),
        (1, Some(path.as_str()), Some(6)),
        "{errors:?}"
    );
    // Whether too much light is an error is the scene's to say: the place is where it lays the table on.
    let errors = desk.refused(&text("file = \"bright.scatter\""));
    let error = &errors[0];
    assert_eq!(
        (errors.len(), error.file(), error.line(), error.column()),
        (1, Some("test.toml"), Some(7), Some(8))
    );
    assert!(
        error.found().contains("an albedo of 1.25") && error.found().ends_with("\"bright.scatter\""),
        "{error}"
    );
    assert!(error.advice().unwrap().contains("energy = \"scale\""));
    let scene = desk.scene(&text("file = \"bright.scatter\"\nenergy = \"scale\""));
    assert!(scene.warnings.iter().any(|w| w.found().contains("an albedo of 1.25")), "{:?}", scene.warnings);
    let outcome = run(&scene, Sequence::SobolOwen, 1 << 12, 2, 1);
    assert_eq!(absorbed(&outcome, &scene, "plate").value, 0.0, "scaled to 1: nothing is absorbed");
}

/// A lamp in a closed convex cover that passes t and throws back r of whatever meets it: t / (1 - r) gets out, in
/// t + r t + r^2 t + ..., and the rest is absorbed by the cover.
#[test]
fn a_closed_cover_lets_out_what_its_table_says() {
    let (r, t) = (0.55, 0.3);
    let lobes = even("reflection", "both", r) + &even("transmission", "both", t);
    let desk = Desk::new(&[("opal.scatter", lobes)]);
    let lantern = project().join("scenes/opal_cover.obj");
    fs::copy(lantern, desk.folder.path().join("cover.obj")).unwrap();
    for shape in [
        "type = \"sphere\"\ncenter = [0, 0, 0.3]\nradius = 0.5",
        "type = \"box\"\nmin = [-1, -2, 0]\nmax = [1, 0.5, 0.7]",
        "type = \"mesh\"\nfile = \"cover.obj\"\nclosed = true\nscale = 4",
    ] {
        let text = LAMP.to_owned() + &material("file = \"opal.scatter\"") + &surface("cover", shape);
        let scene = desk.scene(&text);
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 14, 16, 3);
        assert_total(shape, &outcome, outcome.escaped_lm(), 100.0 * t / (1.0 - r));
        assert_total(shape, &outcome, absorbed(&outcome, &scene, "cover"), 100.0 * (1.0 - t / (1.0 - r)));
        assert_eq!(outcome.census.exceptions.below_horizon, 0);
    }
}

/// A sheet that scatters nothing and lets the remainder pass is not there: no refraction, inside is air, no coordinate drawn.
#[test]
fn a_sheet_of_remainder_alone_is_not_there() {
    let lobes = even("reflection", "both", 0.0) + &even("transmission", "both", 0.0);
    let desk = Desk::new(&[("none.scatter", lobes)]);
    let floor = "[[surface]]\nname = \"floor\"\ntype = \"rectangle\"\nmaterial = \"black\"\ncorner = [-2, -2, -1]\n\
                 edge_u = [4, 0, 0]\nedge_v = [0, 4, 0]\n[[receiver]]\nsurface = \"floor\"\ncells = [32, 32]\n";
    let text = |keys: &str| {
        let cover = surface("cover", "type = \"sphere\"\ncenter = [0, 0, 0.3]\nradius = 0.5");
        let pane = surface("pane", PLATE) + "translate = [0, 0, -0.5]\n";
        LAMP.to_owned() + &material(keys) + &cover + &pane + BLACK + floor
    };
    let bare = desk.scene(&(LAMP.to_owned() + BLACK + floor));
    let outcome = run(&bare, Sequence::SobolOwen, 1 << 14, 2, 5);
    let sheets = desk.scene(&text("file = \"none.scatter\"\nspecular_remainder = true"));
    let through = run(&sheets, Sequence::SobolOwen, 1 << 14, 2, 5);
    assert_eq!(through.census.dimension_histogram, outcome.census.dimension_histogram);
    let (a, b) = (outcome.receiver_flux_lm(0).value, through.receiver_flux_lm(0).value);
    assert!(a > 20.0 && a == b, "{a} lm without the sheets, {b} lm with them");
    // Without the remainder the same sheets absorb everything.
    let dark = desk.scene(&text("file = \"none.scatter\""));
    let outcome = run(&dark, Sequence::SobolOwen, 1 << 12, 2, 5);
    assert!((absorbed(&outcome, &dark, "cover").value - 100.0).abs() < 1e-12);
}

#[test]
fn the_remainder_of_a_table_that_reflects_is_mirrored() {
    let desk = Desk::new(&[("half.scatter", even("reflection", "both", 0.0))]);
    // Mirrored, the beam from (1, 0, 1) goes up to the left, to a wall that only such light meets.
    let wall = "[[surface]]\nname = \"wall\"\ntype = \"rectangle\"\nmaterial = \"black\"\ncorner = [-2, -0.2, 1.8]\n\
                edge_u = [0, 0.4, 0]\nedge_v = [0, 0, 0.4]\n";
    let keys = "file = \"half.scatter\"\nspecular_remainder = true";
    let text = beam(DVec3::new(1.0, 0.0, 1.0)) + &material(keys) + &surface("plate", PLATE) + BLACK + wall;
    let scene = desk.scene(&text);
    let outcome = run(&scene, Sequence::SobolOwen, 1 << 12, 2, 7);
    assert!((absorbed(&outcome, &scene, "wall").value - 100.0).abs() < 1e-12);
}

/// A table with one lobe, for its front: which side of a plate absorbs 20 %, and which all.
#[test]
fn sides_are_those_of_the_table_turned_or_doubled() {
    let desk = Desk::new(&[("front.scatter", even("reflection", "front", 0.8))]);
    for (side, of_front, of_back) in [("front", 20.0, 100.0), ("back", 100.0, 20.0), ("both", 20.0, 20.0)] {
        for (z, lost) in [(1.0, of_front), (-1.0, of_back)] {
            let keys = format!("file = \"front.scatter\"\nside = \"{side}\"");
            let text = beam(DVec3::new(0.2, 0.1, z)) + &material(&keys) + &surface("plate", PLATE);
            let scene = desk.scene(&text);
            let outcome = run(&scene, Sequence::SobolOwen, 1 << 14, 16, 11);
            assert_total(side, &outcome, absorbed(&outcome, &scene, "plate"), lost);
        }
    }
}

/// Light along the reference direction loses 10 %, light across it 90 %, at azimuth a in between linearly.
#[test]
fn azimuths_are_counted_from_the_reference_direction_of_each_shape() {
    let desk = Desk::new(&[("grooved.scatter", grooved())]);
    let tilted = "type = \"rectangle\"\ncorner = [1, -1, 0]\nedge_u = [0, 2, 0]\nedge_v = [-2, 0, 0]";
    let field = "type = \"heightfield\"\norigin = [-1, -1, 0]\nsize = [2, 2]\ncells = [1, 1]\nfacing = \"up\"\n\
                 waves = [{ amplitude = 1e-9, wavelength = 1e6 }]";
    let field_turned = format!("{field}\nrotate_deg = [0, 0, 40]");
    // So large that the beam sees one normal: at the origin x, and (-2, 0, 1) where the bowl rises by its double.
    let sphere = "type = \"sphere\"\ncenter = [-1000, 0, 0]\nradius = 1000";
    let bowl = "type = \"paraboloid\"\nvertex = [-2000, 0, -2000]\naxis = [0, 0, 1]\nfocal_length = 500\nradius = 2500";
    let [from_x, from_y, between] = [[0.2, 0.0], [0.0, 0.2], [0.2, 0.2]].map(|[x, y]| DVec3::new(x, y, 1.0));
    let behind = |d: DVec3| DVec3::new(d.x, d.y, -d.z);
    // From azimuth 30 degrees about the normal n, where the reference direction should be r.
    let off = |n: DVec3, r: DVec3| {
        let n = n.normalize();
        n + 0.2 * (0.75f64.sqrt() * r + 0.5 * n.cross(r))
    };
    // Onto the outside of the bowl: inside, scattered light would meet it again.
    let (at_bowl, third) = (off(DVec3::new(2.0, 0.0, -1.0), DVec3::Y), 80.0 / 3.0);
    for (label, shape, keys, from, lost) in [
        ("edge_u is x", PLATE, "", from_x, 10.0),
        ("edge_u is x, across", PLATE, "", from_y, 90.0),
        ("half way", PLATE, "", between, 50.0),
        ("from behind", PLATE, "", behind(from_y), 90.0),
        ("edge_u is y", tilted, "", from_x, 90.0),
        ("turned by 90", PLATE, "rotation_deg = 90", from_x, 90.0),
        ("turned by 45", PLATE, "rotation_deg = 45", from_y, 50.0),
        // 30 degrees off the reference direction: a third of the way from 10 to 90.
        ("turned by 30", PLATE, "rotation_deg = 30", from_x, 10.0 + third),
        // The light comes from azimuth 45, 15 degrees beyond: a sixth of the way.
        ("turned the right way", PLATE, "rotation_deg = 30", between, 10.0 + 0.5 * third),
        ("turned, as the front sees it", PLATE, "rotation_deg = 30", behind(between), 10.0 + 0.5 * third),
        ("another reference", PLATE, "reference = [0, 3, 5]", from_y, 10.0),
        ("a heightfield's is x", field, "", from_x, 10.0),
        ("of the world, not of the shape", field_turned.as_str(), "", from_x, 10.0),
        ("a sphere's goes around z", sphere, "", off(DVec3::X, DVec3::Y), 10.0 + third),
        ("a paraboloid's goes around its axis", bowl, "", at_bowl, 10.0 + third),
        ("a paraboloid's other reference", bowl, "reference = [1, 0, 0]", at_bowl, 90.0 - third),
    ] {
        let table = format!("file = \"grooved.scatter\"\n{keys}");
        let scene = desk.scene(&(beam(from) + &material(&table) + &surface("s", shape)));
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 13, 16, 13);
        assert_total(label, &outcome, absorbed(&outcome, &scene, "s"), lost);
    }
}
