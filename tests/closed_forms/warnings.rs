//! What is said beside the numbers of scenes that are drawn wrong, and that nothing is said beside the same drawn right.

use std::sync::atomic::AtomicBool;

use caustix::error::warning::{Severity, Warning};
use caustix::geometry::{Mesh, MeshParts, Rectangle, Shape, Smoothing};
use caustix::picture::{Watch, trace_picture};
use caustix::report::json::Report;
use caustix::report::statistics::ReceiverStatistics;
use caustix::run::{Plan, Settings, warnings};
use caustix::scene::{Scene, SceneBuilder};
use caustix::sequence::Sequence;
use caustix::surface::{Dielectric, Material};
use caustix::{AimFrame, Beam, BeamSection, Emitter};
use glam::DVec3;

use crate::media::{BLACK, GLASS, LAMP, WATER, cuboid, receiver, sheet, sphere};
use crate::support::scenes::{run_with_killed, scene};

/// What a run of few photons says.
pub(crate) fn said_of(scene: &Scene) -> Vec<Warning> {
    let said = warnings(scene, &run_with_killed(scene, Sequence::SobolOwen, 1 << 9, 8, 1));
    said.iter().for_each(|warning| println!("{warning}"));
    said
}

pub(crate) fn said(text: &str) -> Vec<Warning> {
    said_of(&scene(text))
}

/// The only warning there is.
pub(crate) fn only(said: &[Warning], code: &str, severity: Severity, surfaces: &[&str]) -> Warning {
    let found: Vec<_> = said.iter().map(|w| (w.code, w.severity)).collect();
    assert_eq!(found, [(code, severity)], "{said:?}");
    assert_eq!(said[0].surfaces, surfaces);
    said[0].clone()
}

/// A glass cube of 0.1 m, `gap` above the table, which looks up or down.
fn cube_on_a_table(gap: f64, more: &str, up: bool) -> String {
    [LAMP, GLASS, BLACK].concat()
        + &cuboid("cube", "glass", [-0.05, -0.05, gap], [0.05, 0.05, 0.1 + gap], more)
        + &sheet("table", "black", 0.0, up)
        + &receiver("table")
}

#[test]
fn faces_that_all_but_touch_are_told_with_their_distance() {
    let [cube, table] = ["cube", "table"];
    for up in [true, false] {
        for gap in [1e-7, 9e-7] {
            let found = said(&cube_on_a_table(gap, "", up));
            let apart = only(&found, "nearly-touching", Severity::Note, &[cube, table]);
            assert!(apart.message.contains(&format!("{gap:.1e} m")), "{apart}");
            let sunk = said(&cube_on_a_table(-gap, "", up));
            let sunk = only(&sunk, "nearly-touching", Severity::Doubtful, &[cube, table]);
            assert!(sunk.message.contains("reaches into"), "{sunk}");
            let glued = said(&cube_on_a_table(gap, "contact = \"glued\"", up));
            only(&glued, "nearly-touching", Severity::Doubtful, &[cube, table]);
        }
        // In contact, clearly apart, clearly sunk.
        for gap in [0.0, 1.1e-6, 1e-3] {
            assert_eq!(said(&cube_on_a_table(gap, "contact = \"film\"", up)), []);
        }
    }
}

#[test]
fn two_cubes_that_all_but_touch_and_curved_bodies_that_touch_in_a_point_or_line() {
    let cubes = |gap: f64| {
        [LAMP, GLASS, BLACK].concat()
            + &cuboid("small", "glass", [-0.05, -0.05, 0.5 + gap], [0.05, 0.05, 0.6 + gap], "")
            + &cuboid("big", "glass", [-0.5, -0.5, 0.0], [0.5, 0.5, 0.5], "")
            + &sheet("floor", "black", -0.5, true)
            + &receiver("floor")
    };
    only(&said(&cubes(8e-7)), "nearly-touching", Severity::Note, &["small", "big"]);
    assert_eq!(said(&cubes(2e-6)), []);
    // A sphere and a tube of very fine facets on a table: nothing is flat there.
    for sides in [64, 4096] {
        assert!(said_of(&with_mesh(tube(sides, 0.0))).iter().all(|w| w.code != "nearly-touching"));
    }
}

/// A lamp, a black floor at 0 and one mesh of glass on it.
fn with_mesh(mesh: Mesh) -> Scene {
    let mut builder = SceneBuilder::new();
    let frame = AimFrame::new(DVec3::NEG_Z, None).unwrap();
    let beam = Beam::new(DVec3::Z * 2.0, frame, BeamSection::Disc { radius: 0.3 }, 1000.0).unwrap();
    builder.emitter("lamp", Emitter::Beam(beam));
    builder.surface("mesh", mesh.into(), Material::Dielectric(Dielectric::new(1.5, None).unwrap()));
    let floor = Rectangle::new(DVec3::new(-9.0, -9.0, 0.0), DVec3::X * 18.0, DVec3::Y * 18.0).unwrap();
    builder.surface("floor", Shape::Rectangle(floor), Material::Absorber);
    builder.build().unwrap()
}

/// A lying tube of this many sides, with caps, of radius 0.1 m and length 0.4 m, that stands on z = 0; without a part `slit` of
/// the cap at its end: 0 for none.
fn tube(sides: u32, slit: f64) -> Mesh {
    let at = |k: u32, y: f64| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / f64::from(sides)).sin_cos();
        DVec3::new(0.1 * sin, y, 0.1 - 0.1 * cos)
    };
    let mut vertices: Vec<DVec3> = (0..sides).flat_map(|k| [at(k, 0.0), at(k, 0.4)]).collect();
    vertices.extend([DVec3::new(0.0, 0.0, 0.1), DVec3::new(0.0, 0.4, 0.1)]);
    let faces = |k: u32| {
        let (a, b) = (2 * k, 2 * ((k + 1) % sides));
        [[a, a + 1, b + 1], [a, b + 1, b], [a, b, 2 * sides], [b + 1, a + 1, 2 * sides + 1]]
    };
    let mut triangles: Vec<[u32; 3]> = (0..sides).flat_map(faces).collect();
    triangles.truncate(triangles.len() - (slit * f64::from(sides)).round() as usize);
    let parts = MeshParts { vertices, triangles, ..MeshParts::default() };
    Mesh::new(parts, Smoothing::Computed, false).unwrap().0
}

#[test]
fn cracks_are_told_and_openings_are_not() {
    assert!(tube(64, 0.0).topology().is_closed());
    // A hole of one facet of the cap, pi 0.1^2 / 4096 of 0.31 m2.
    let found = said_of(&with_mesh(tube(4096, 1.0 / 4096.0)));
    let crack = found.iter().find(|w| w.code == "cracks").unwrap();
    assert_eq!((crack.severity, &crack.surfaces[..]), (Severity::Doubtful, &["mesh".to_string()][..]));
    assert!(
        crack.message.contains("3 open edges") && crack.message.contains("2.4e-5 of its area"),
        "{crack}"
    );
    // An open end, as of a light guide that is drawn without caps, is no crack.
    assert!(said_of(&with_mesh(tube(64, 64.0 / 64.0))).iter().all(|w| w.code != "cracks"));
    // Vertices that rounding has split: a seam of no width all along the tube.
    let mesh = tube(64, 0.0);
    let mut vertices = mesh.vertices().to_vec();
    let mut triangles = mesh.triangles().to_vec();
    let first = vertices.len() as u32;
    vertices.extend(mesh.vertices().iter().map(|v| *v + DVec3::splat(1e-12)));
    triangles[..128].iter_mut().flatten().for_each(|v| *v += first);
    let parts = MeshParts { vertices, triangles, ..MeshParts::default() };
    let (split, _) = Mesh::new(parts, Smoothing::Given, false).unwrap();
    // Two edges along the tube and two radii of each cap, each on both sides.
    assert_eq!(split.topology().open_edges, 2 * 6);
    assert!(split.topology().opening_m2 < 1e-12, "{}", split.topology().opening_m2);
    assert!(said_of(&with_mesh(split)).iter().any(|w| w.code == "cracks"));
}

/// An isotropic lamp of so many lumens.
pub(crate) fn lamp(position: [f64; 3], flux_lm: f64) -> String {
    format!(
        "[[emitter]]\nname = \"lamp\"\ntype = \"isotropic\"\nposition = {position:?}\nflux_lm = {flux_lm:?}\n"
    )
}

/// A rectangle by its corner and edges.
pub(crate) fn rectangle(name: &str, material: &str, [corner, u, v]: [[f64; 3]; 3]) -> String {
    format!(
        "[[surface]]\nname = \"{name}\"\ntype = \"rectangle\"\nmaterial = \"{material}\"\ncorner = {corner:?}\nedge_u = {u:?}\nedge_v = {v:?}\n"
    )
}

#[test]
fn sizes_that_look_like_millimetres() {
    let field = |lamps: u32, flux_lm: f64| {
        let lamps = (0..lamps)
            .map(|k| lamp([f64::from(k), 30.0, 20.0], flux_lm).replace("\"lamp\"", &format!("\"lamp {k}\"")));
        [BLACK, &lamps.collect::<String>()].concat()
            + &rectangle("field", "black", [[0.0; 3], [100.0, 0.0, 0.0], [0.0, 60.0, 0.0]])
            + &receiver("field")
    };
    assert_eq!(said(&field(40, 1e5)), [], "a stadium");
    assert_eq!(said(&field(1, 500.0)), [], "a car park");
    // A room of 5 m x 4 m in millimetres, 6000 lm: 3e-4 lx.
    let room = |unit: f64| {
        [BLACK, &lamp([2.5 * unit, 2.0 * unit, 2.8 * unit], 6000.0)].concat()
            + &rectangle("floor", "black", [[0.0; 3], [5.0 * unit, 0.0, 0.0], [0.0, 4.0 * unit, 0.0]])
            + &receiver("floor")
    };
    assert_eq!(said(&room(1.0)), []);
    let found = only(&said(&room(1000.0)), "millimetres", Severity::Doubtful, &[]);
    assert!(found.message.contains("5000 m large") && found.message.contains("3.0e-4 lx"), "{found}");
    // A ball of 50 mm: a third of its diameter is 16.7.
    let ball = |radius: f64| {
        [BLACK, GLASS, &lamp([0.0, 0.0, 9.0 * radius], 1e6)].concat()
            + &sphere("ball", "glass", [0.0, 0.0, 2.0 * radius], radius, "")
            + &rectangle(
                "table",
                "black",
                [[-4.0 * radius, -4.0 * radius, 0.0], [8.0 * radius, 0.0, 0.0], [0.0, 8.0 * radius, 0.0]],
            )
            + &receiver("table")
    };
    assert_eq!(said(&ball(0.025)), []);
    let water = ball(0.025).replace("1.5", "1.333").replace("0.025", "25.0");
    assert!(said(&water).iter().all(|w| w.code != "millimetres"));
    let found = only(&said(&ball(25.0)), "millimetres", Severity::Doubtful, &["ball"]);
    assert!(found.message.contains("16.7 m thick"), "{found}");
    // A plate of 40 m x 40 m x 0.1 m that is turned.
    let plate = [BLACK, GLASS, &lamp([0.0, 0.0, 60.0], 1e6)].concat()
        + &cuboid(
            "plate",
            "glass",
            [-20.0, -20.0, -0.05],
            [20.0, 20.0, 0.05],
            "rotate_deg = [45.0, 0.0, 0.0]",
        )
        + &rectangle("table", "black", [[-20.0, -20.0, -50.0], [40.0, 0.0, 0.0], [0.0, 40.0, 0.0]])
        + &receiver("table");
    assert_eq!(said(&plate), []);
}

#[test]
fn a_lamp_nearer_than_five_times_its_luminous_opening() {
    let file = std::fs::read_to_string(crate::support::data::in_project("ies/downlight.ies")).unwrap();
    assert!(file.contains("1 -1 1 37 1 1 2 -0.2 -0.2 0"), "an opening of 0.2 m");
    let at = |height: f64| {
        let lamp = format!(
            "[[emitter]]\nname = \"lamp\"\ntype = \"photometric\"\nfile = \"../ies/downlight.ies\"\nposition = [0.0, 0.0, {height:?}]\n"
        );
        let shelf = rectangle("shelf", "black", [[-9.0, -9.0, 0.0], [18.0, 0.0, 0.0], [0.0, 18.0, 0.0]]);
        [BLACK, &lamp, &shelf, &receiver("shelf")].concat()
    };
    assert_eq!(said(&at(1.01)), []);
    // A cosine of intensity: within the cone in which the shelf, h away below, is nearer than 1 m are 1 - h^2 of the flux.
    for (height, share) in [(0.9, 0.19), (0.5, 0.75)] {
        let found = only(&said(&at(height)), "near-field", Severity::Doubtful, &["shelf"]);
        let [low, high] = [-3.5, 3.5].map(|s| share + s * (share * (1.0 - share) / 1024.0f64).sqrt());
        assert!((low..high).contains(&found.share.unwrap()), "{found}");
        assert!(
            found.message.contains("is 0.20 m long")
                && found.message.contains(&format!("{height:.2} m away")),
            "{found}"
        );
    }
    // Light that goes elsewhere: a wall behind the lamp does not count.
    let behind =
        at(1.5) + &rectangle("ceiling", "black", [[-9.0, -9.0, 1.55], [0.0, 18.0, 0.0], [18.0, 0.0, 0.0]]);
    assert_eq!(said(&behind), []);
}

#[test]
fn a_window_of_one_sheet() {
    // A sheet of glass hangs between lamp and table: what goes past it, reaches the same table in air.
    let hanging = |more: &str, half: f64| {
        [BLACK, GLASS, &lamp([0.0, 0.0, 2.0], 1000.0)].concat()
            + &rectangle(
                "pane",
                "glass",
                [[-half, -half, 1.0], [2.0 * half, 0.0, 0.0], [0.0, 2.0 * half, 0.0]],
            )
            + &rectangle("table", "black", [[-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]])
            + &receiver("table")
            + more
    };
    // Seen from the lamp, the shadow of a half width h at 1 m is 2 h wide on the table, but refracted light spreads less: with
    // sin b = sin a / 1.5 it stays in the shadow of the pane, so lamp and light do not meet: seen by the camera alone.
    let camera =
        "[camera]\nposition = [0.9, 0.0, 0.3]\nlook_at = [0.0, 0.0, 0.0]\nfov_deg = 40\npixels = [8, 8]\n";
    let found = only(&said(&hanging(camera, 0.4)), "mixed-media", Severity::Doubtful, &["pane"]);
    assert!(
        found.message.contains("what the camera sees directly") && found.message.contains("1.5"),
        "{found}"
    );
    // Two lamps: the second stands under the pane and shines down.
    let second = "[[emitter]]\nname = \"second\"\ntype = \"collimated\"\nposition = [0.0, 0.0, 0.5]\naim = [0.0, 0.0, -1.0]\nradius = 0.3\nflux_lm = 10.0\n";
    let found = only(&said(&hanging(second, 0.4)), "mixed-media", Severity::Doubtful, &["pane"]);
    assert!(found.message.contains("what emitter \"second\" lights directly"), "{found}");
    // The same with a box instead.
    let boxed = hanging(&(second.to_owned() + camera), 0.4)
        .replace("type = \"rectangle\"\nmaterial = \"glass\"", "type = \"box\"\nmaterial = \"glass\"");
    let boxed = boxed.replace(
        "corner = [-0.4, -0.4, 1.0]\nedge_u = [0.8, 0.0, 0.0]\nedge_v = [0.0, 0.8, 0.0]",
        "min = [-0.4, -0.4, 0.99]\nmax = [0.4, 0.4, 1.0]",
    );
    assert!(said(&boxed).iter().all(|w| w.code == "trapped"), "{boxed}");
    // Water from wall to wall, and water over a floor as wide as itself.
    let wall = "[[surface]]\nname = \"basin\"\ntype = \"box\"\nmaterial = \"black\"\nmin = [-1.0, -1.0, -0.1]\nmax = [1.0, 1.0, 3.0]\n";
    let camera = camera.replace("0.3]\nlook", "1.5]\nlook");
    assert_eq!(said(&hanging(&(wall.to_owned() + &camera), 1.0)), []);
    assert_eq!(said(&hanging(&camera, 1.0)), []);
}

#[test]
fn a_sheet_that_stands_upright_is_a_window() {
    let window = |more: &str| {
        [BLACK, GLASS, &lamp([-2.0, 0.0, 1.0], 1000.0)].concat()
            + &rectangle("window", "glass", [[0.0, 1.0, 0.0], [0.0, -2.0, 0.0], [0.0, 0.0, 2.0]])
            + &rectangle("wall", "black", [[2.0, -9.0, -9.0], [0.0, 18.0, 0.0], [0.0, 0.0, 18.0]])
            + &receiver("wall")
            + more
    };
    let found = said(&window(""));
    let sheet = found.iter().find(|w| w.code == "one-sheet").unwrap();
    assert_eq!((sheet.severity, &sheet.surfaces[..]), (Severity::Doubtful, &["window".to_string()][..]));
    let inner = |y: f64| rectangle("inner", "glass", [[0.1, -y, 0.0], [0.0, 2.0 * y, 0.0], [0.0, 0.0, 2.0]]);
    assert!(said(&window(&inner(1.0))).iter().all(|w| w.code != "one-sheet"));
}

#[test]
fn a_pane_whose_second_face_looks_the_wrong_way_is_found_without_photons() {
    let pane = |second: [[f64; 3]; 3], more: &str| {
        [BLACK, GLASS, WATER, &lamp([0.0, 0.0, 2.0], 1000.0)].concat()
            + &rectangle("upper", "glass", [[-0.5, -0.5, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
            + &rectangle("lower", "glass", second)
            + &rectangle("table", "black", [[-1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]])
            + &receiver("table")
            + more
    };
    let down = [[-0.5, 0.5, 0.9], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
    let up = [[-0.5, -0.5, 0.9], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert!(scene(&pane(down, "")).found.is_empty());
    let wrong = scene(&pane(up, ""));
    let clash = only(&wrong.found, "contradicted-medium", Severity::Doubtful, &["upper", "lower"]);
    assert!(
        clash.message.contains("\"upper\" and \"lower\"") && clash.message.contains("is 1.5, the second 1"),
        "{clash}"
    );
    assert!(clash.remedy.contains("exchange edge_u and edge_v"), "{clash}");
    // Photons say how much, and the remedy is the same.
    let met = only(&said_of(&wrong), "contradicted-medium", Severity::Untrusted, &["lower"]);
    assert_eq!(met.remedy, clash.remedy);
    assert!(met.share.unwrap() > 0.01);
    // Water on the glass, of which one face says air: they face each other.
    let on_it = rectangle("water", "water", [[-0.5, 0.5, 1.1], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
    let wet = scene(&pane(down, &on_it));
    assert!(wet.found.is_empty(), "air between: {:?}", wet.found);
    let full = wet_between(&pane(down, &on_it));
    let clash = only(&scene(&full).found, "contradicted-medium", Severity::Doubtful, &["upper", "water"]);
    assert!(clash.remedy.contains("state the same medium"), "{clash}");
}

/// The upper face of the pane says that water is before it, and the water above it says that air is.
fn wet_between(text: &str) -> String {
    let wet = "[material.wet]\ntype = \"dielectric\"\nior = 1.5\nior_outside = 1.333\n";
    wet.to_owned()
        + &text.replace(
            "name = \"upper\"\ntype = \"rectangle\"\nmaterial = \"glass\"",
            "name = \"upper\"\ntype = \"rectangle\"\nmaterial = \"wet\"",
        )
}

#[test]
fn receivers_on_bodies_that_trap_light_are_marked() {
    let text = [BLACK, WATER, &lamp([0.0, 0.0, 0.001], 1000.0)].concat()
        + &sphere("room", "black", [0.0; 3], 1.0, "")
        + &cuboid("tank", "water", [-0.2, -0.1, -0.1], [0.2, 0.1, 0.1], "")
        + "[[receiver]]\nname = \"walls\"\nsurface = \"room\"\nside = \"back\"\n[[receiver]]\nname = \"it\"\nsurface = \"tank\"\nside = \"back\"\n";
    let scene = scene(&text);
    let outcome = run_with_killed(&scene, Sequence::SobolOwen, 1 << 4, 2, 1);
    let statistics: Vec<_> =
        scene.receivers.iter().enumerate().map(|(i, r)| ReceiverStatistics::new(&outcome, r, i)).collect();
    let files = [Vec::new(), Vec::new()];
    let json = serde_json::to_value(Report::new(&scene, &outcome, &statistics, &files, 0.0)).unwrap();
    assert!(json["receivers"][0].get("untrusted").is_none());
    assert_eq!(json["receivers"][1]["untrusted"], serde_json::json!(["trapped"]));
}

#[test]
fn eye_paths_that_are_contradicted_are_counted_and_told() {
    // The camera looks up from under water, and does not say so: the surface fills the middle of its 60 degrees.
    let pond = |medium: &str| {
        [BLACK, WATER, &lamp([0.0, 0.0, 2.0], 1000.0)].concat()
            + &rectangle("water", "water", [[-0.1, -0.1, 1.0], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0]])
            + &rectangle("floor", "black", [[-0.1, -0.1, 0.0], [0.2, 0.0, 0.0], [0.0, 0.2, 0.0]])
            + &receiver("floor")
            + &format!(
                "[camera]\nposition = [0.0, 0.0, 0.8]\nlook_at = [0.0, 0.0, 1.0]\nup = [0.0, 1.0, 0.0]\nfov_deg = 60\npixels = [64, 64]\nsamples = 4\nmethod = \"splat\"\n{medium}"
            )
    };
    let scene = scene(&pond(""));
    let watch = Watch { interrupt: &AtomicBool::new(false), photons: &|_| {}, camera: &|_| {} };
    let plan =
        Plan::new(&Settings { photons: Some(256), replicates: Some(2), ..Settings::default() }).unwrap();
    let (_, picture) = trace_picture(&scene, &plan, false, watch).unwrap();
    let said = caustix::picture::warnings(&scene, picture.summary());
    let found = only(&said, "contradicted-medium", Severity::Untrusted, &["water"]);
    println!("{found}");
    // A square of 0.2 m at 0.2 m, in a picture 2 tan 30 degrees high: (0.5 / tan 30)^2 of it.
    let exact = 0.75;
    assert!((found.share.unwrap() - exact).abs() < 0.01, "{found}");
    assert!(found.message.contains("of all eye paths") && found.remedy.contains("`medium`"), "{found}");
    // A probe of fewer pixels sees the same.
    let probed = caustix::picture::probe(&scene, &AtomicBool::new(false)).unwrap();
    assert!((probed[0].share.unwrap() - exact).abs() < 0.02, "{probed:?}");
    let right = crate::support::scenes::scene(&pond("medium = \"water\"\n"));
    assert_eq!(caustix::picture::probe(&right, &AtomicBool::new(false)).unwrap(), []);
}
