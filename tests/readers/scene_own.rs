//! The scenes of this project: read without a warning, and light does reach their receivers.

use std::path::{Path, PathBuf};

use caustix::emitter::{AimFrame, Emits, Emitter, Photometric};
use caustix::error::Kind;
use caustix::files::bytes::Base;
use caustix::files::obj::{self, ObjOptions};
use caustix::files::photometric;
use caustix::files::scene_toml::{RunDefaults, built_in, parse, read};
use caustix::geometry::{Facing, Formula, Heightfield, Mesh, Noise, Octave, Shape, Transform};
use caustix::math::digest::sha256_hex;
use caustix::scene::Scene;
use caustix::scene::receiver::{Cells, ReceiverEvents, ReceiverSide};
use caustix::surface::{Material, Mirror, Reflectance};
use glam::{DVec2, DVec3};

use crate::support::data::project;

fn folder() -> PathBuf {
    project().join("scenes")
}

fn scene(name: &str) -> Scene {
    read(folder().join(name)).unwrap().build().unwrap()
}

fn shape<'s>(scene: &'s Scene, name: &str) -> &'s Shape {
    &scene.geometry.surfaces().iter().find(|s| s.name == name).unwrap().shape
}

/// Corner, edges and unit normal of a rectangle.
fn rectangle(scene: &Scene, name: &str) -> (DVec3, DVec3, DVec3, DVec3) {
    let Shape::Rectangle(r) = shape(scene, name) else { panic!("{name} should be a rectangle") };
    (r.corner(), r.edge_u(), r.edge_v(), r.normal())
}

/// (u, v) where a ray meets a rectangle, and whether it comes from the front.
fn meets(scene: &Scene, name: &str, origin: DVec3, direction: DVec3) -> (f64, f64, bool) {
    let (corner, u, v, n) = rectangle(scene, name);
    let t = (corner - origin).dot(n) / direction.dot(n);
    assert!(t > 0.0, "the ray should run towards {name}");
    let p = origin + direction * t - corner;
    (p.dot(u) / u.length_squared(), p.dot(v) / v.length_squared(), direction.dot(n) < 0.0)
}

/// A vector of a scene's text.
fn vector(value: &toml::Value) -> DVec3 {
    let number = |i: usize| value[i].as_float().or(value[i].as_integer().map(|n| n as f64)).unwrap();
    DVec3::new(number(0), number(1), number(2))
}

/// Where the first emitter is and where its scene says that it aims.
fn lamp(scene: &Scene) -> (DVec3, DVec3) {
    let text: toml::Table = scene.identity.text.parse().unwrap();
    let aim = text["emitter"][0].get("aim").map_or(DVec3::NEG_Z, vector);
    (scene.emitters.as_slice()[0].position(), aim.normalize())
}

/// That a lamp is that of a file of this project, turned this way.
fn is_turned(lamp: &Photometric, file: &str, aim: DVec3, up: DVec3) {
    let photometry = photometric::read(project().join("ies").join(file)).unwrap();
    let expected =
        Photometric::new(&photometry, lamp.position(), AimFrame::new(aim, Some(up)).unwrap(), None).unwrap();
    assert_eq!(lamp.flux_lm(), expected.flux_lm());
    for d in [DVec3::NEG_Z, DVec3::NEG_Y, DVec3::new(0.1, 0.2, -1.0), DVec3::new(-0.2, -1.0, 0.3)] {
        assert_eq!(lamp.intensity_cd(d.normalize()), expected.intensity_cd(d.normalize()), "{d}");
    }
}

/// A heightfield as the scene should have it.
fn heightfield(origin: DVec3, size: f64, cells: [u32; 2], formula: Formula, facing: Facing) -> Mesh {
    Heightfield::new(origin, DVec2::splat(size), cells, formula).unwrap().facing(facing).mesh().unwrap()
}

#[test]
fn every_scene_reads_without_a_warning() {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let name = path.file_name().unwrap().to_str().unwrap().to_string();
            let file = read(&path).unwrap();
            assert_eq!(file.warnings, [], "{name}");
            assert!(!file.build().unwrap().receivers.is_empty(), "{name}");
            names.push(name);
        }
    }
    names.sort();
    let all = [
        "ball_lens",
        "brushed_reflector",
        "flat_slab",
        "glass_sphere",
        "opal_cover",
        "pool",
        "pool_seen",
        "prism",
        "reflector",
        "ring",
        "room",
        "satin_pane",
        "wavy_glass",
        "wavy_glass_seen",
        "wine",
    ];
    assert_eq!(names, all.map(|n| format!("{n}.toml")));
}

#[test]
fn built_in_scene_is_the_paper_s_experiment() {
    let scene = built_in().unwrap().build().unwrap();
    assert_eq!(scene.warnings, []);
    assert_eq!(scene.emitters.as_slice().len(), 1);
    let Emitter::Photometric(lamp) = &scene.emitters.as_slice()[0] else { panic!("a photometric lamp") };
    assert_eq!(lamp.position(), DVec3::new(0.03, -0.02, 2.0));
    is_turned(lamp, "wavy_glass.ies", DVec3::NEG_Z, DVec3::Y);
    for (name, z, facing, stretch, seed) in
        [("glass top", 1.1, Facing::Up, 1.0, 1), ("glass bottom", 0.8, Facing::Down, 1.1, 2)]
    {
        let index = scene.geometry.surfaces().iter().position(|s| s.name == name).unwrap();
        let Material::Dielectric(glass) = &scene.materials()[index] else { panic!("glass") };
        assert_eq!((glass.ior(), glass.ior_outside()), (1.5, None));
        let octaves = [(1.0, 0.300), (0.45, 0.148), (0.12, 0.073)]
            .map(|(amplitude, wavelength)| Octave { amplitude, wavelength_m: wavelength * stretch });
        let noise = Formula::Noise(Noise::new(seed, octaves.to_vec(), 0.010).unwrap());
        let expected = heightfield(DVec3::new(-1.4, -1.4, z), 2.8, [128, 128], noise, facing);
        let Shape::Mesh(mesh) = shape(&scene, name) else { panic!("a heightfield") };
        assert!(mesh.is_smooth() && mesh.triangles() == expected.triangles());
        let apart = mesh.vertices().iter().zip(expected.vertices()).map(|(a, b)| (*a - *b).length());
        assert!(apart.fold(0.0, f64::max) < 1e-12, "{name}");
    }
    let (corner, u, v, normal) = rectangle(&scene, "plate");
    assert_eq!(corner + (u + v) / 2.0, DVec3::ZERO);
    assert_eq!((u.length(), v.length(), normal), (2.0, 2.0, DVec3::Z));
    let receiver = &scene.receivers[0];
    assert_eq!((receiver.name.as_str(), receiver.cells), ("plate", Cells::Grid { nu: 512, nv: 512 }));
    assert_eq!((receiver.side, receiver.events), (ReceiverSide::Front, ReceiverEvents::All));
}

#[test]
fn built_in_scene_carries_its_files() {
    let inside = built_in().unwrap().build().unwrap();
    let outside = scene("wavy_glass.toml");
    assert_eq!(inside.identity.files, outside.identity.files);
    assert_eq!(inside.identity.light, outside.identity.light);
    let text = std::fs::read(folder().join("wavy_glass.toml")).unwrap();
    assert_eq!(inside.identity.text.as_bytes(), text);
    assert_eq!(inside.identity.sha256, sha256_hex(&text));
    let ies = std::fs::read(folder().join("../ies/wavy_glass.ies")).unwrap();
    assert_eq!(inside.identity.files, [("../ies/wavy_glass.ies".to_owned(), sha256_hex(&ies))]);
    let text = inside.identity.text.replace("wavy_glass.ies", "other.ies");
    assert_eq!(parse(&text, "s", Base::BuiltIn).unwrap().build().unwrap_err()[0].kind(), Kind::Io);
}

#[test]
fn read_from_a_file_names_the_file_and_finds_its_neighbours() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("prism.toml");
    let text = std::fs::read_to_string(self::folder().join("prism.toml")).unwrap();
    std::fs::write(&path, &text).unwrap();
    let errors = read(&path).unwrap_err();
    assert_eq!(errors.len(), 1, "{errors:#?}");
    let line = 1 + text.lines().position(|l| l.starts_with("file = ")).unwrap();
    assert_eq!((errors[0].kind(), errors[0].line(), errors[0].column()), (Kind::Io, Some(line), Some(8)));
    assert_eq!(errors[0].file(), path.to_str());
    assert!(errors[0].found().contains("prism.obj"), "{}", errors[0]);
    assert_eq!(errors[0].advice(), Some("paths are relative to the folder of the scene file"));
    std::fs::write(folder.path().join("prism.obj"), "v 0 0 0\n").unwrap();
    let errors = read(&path).unwrap().build().unwrap_err();
    assert_eq!((errors.len(), errors[0].found()), (1, "no face"), "it is read when the scene is built");

    let errors = read(folder.path().join("absent.toml")).unwrap_err();
    assert_eq!((errors.len(), errors[0].kind()), (1, Kind::Io));
    std::fs::write(&path, b"# gr\xfcn\n").unwrap();
    let errors = read(&path).unwrap_err();
    assert_eq!((errors[0].line(), errors[0].column(), errors[0].kind()), (Some(1), Some(5), Kind::Syntax));
    assert_eq!(errors[0].found(), "the byte 0xFC, which is not UTF-8");
    std::fs::write(&path, vec![b'#'; (16 << 20) + 1]).unwrap();
    assert_eq!(read(&path).unwrap_err()[0].kind(), Kind::Limit);
}

#[test]
fn defaults_are_as_documented() {
    let text = "[[emitter]]\ntype = 'photometric'\nfile = '../ies/spot.ies'\nposition = [1, 2, 3]\n\
                [[emitter]]\ntype = 'photometric'\nfile = '../ies/spot.ies'\nposition = [1, 2, 3]\naim = [0, -3, 0]\n\
                [[emitter]]\ntype = 'collimated'\nposition = [0, 0, 0]\nflux_lm = 5\nsize = [3, 4]\n\
                aim = [1, 1, 0]\nup = [0, 0, 2]\n\
                [material.m]\ntype = 'mirror'\n\
                [[surface]]\nname = 'ball'\ntype = 'sphere'\nmaterial = 'm'\ncenter = [0, 0, 9]\nradius = 1\n\
                [[receiver]]\nsurface = 'ball'\n";
    let file = parse(text, "t.toml", Base::Directory(folder())).unwrap();
    assert_eq!(file.run, RunDefaults::default());
    let scene = file.build().unwrap();
    assert_eq!(scene.emitter_names, ["emitter 1", "emitter 2", "emitter 3"]);
    assert_eq!(scene.identity.files.len(), 2, "one entry for each part that names a file");
    let [Emitter::Photometric(first), Emitter::Photometric(second), beam @ Emitter::Beam(_)] =
        scene.emitters.as_slice()
    else {
        panic!("two lamps and a beam")
    };
    is_turned(first, "spot.ies", DVec3::NEG_Z, DVec3::Y);
    is_turned(second, "spot.ies", DVec3::NEG_Y, DVec3::X);
    // 3 m along aim x up, 4 m along up: corners and middles of edges, in order around.
    let outline = beam.outline();
    let [a, b, c] = [outline[1], outline[3], outline[5]];
    let (width, height) = if (b - a).z.abs() < 1e-14 { (b - a, c - b) } else { (c - b, b - a) };
    assert!((height.abs() - DVec3::Z * 4.0).length() < 1e-14 && (width.length() - 3.0).abs() < 1e-14);
    assert!(width.dot(DVec3::new(1.0, 1.0, 0.0)).abs() < 1e-14);
    let mirror = Mirror::new(Reflectance::new(1.0).unwrap());
    assert!(matches!(scene.materials()[0], Material::Mirror(m) if m == mirror));
    let Shape::Sphere(ball) = shape(&scene, "ball") else { panic!("a sphere") };
    assert_eq!((ball.centre(), ball.radius()), (DVec3::Z * 9.0, 1.0));
    let receiver = &scene.receivers[0];
    assert_eq!((receiver.name.as_str(), receiver.cells), ("ball", Cells::Grid { nu: 256, nv: 256 }));
    assert_eq!((receiver.side, receiver.events), (ReceiverSide::Front, ReceiverEvents::All));
}

#[test]
fn every_example_of_the_manual_reads() {
    let manual = include_str!("../../docs/SCENE.md");
    let blocks: Vec<&str> =
        manual.split("```toml\n").skip(1).map(|b| b.split("```").next().unwrap()).collect();
    assert_eq!(blocks.len(), manual.matches("```").count() / 2);
    let file = parse(blocks[0], "manual", Base::BuiltIn).unwrap();
    assert_eq!(file.warnings, []);
    // The others are parts of one scene, but for the glass of the first.
    let parts = blocks[1..].concat() + "[material.glass]\ntype = \"dielectric\"\nior = 1.5\n";
    let file = parse(&parts, "manual", Base::BuiltIn).unwrap();
    assert_eq!(file.run.photons, Some(1 << 24));
    for (header, count) in [("[[emitter]]", 5), ("[[surface]]", 8), ("[[receiver]]", 3), ("[[far_field]]", 1)]
    {
        assert_eq!(parts.matches(header).count(), count, "{header}");
    }
}

#[test]
fn transforms_are_read() {
    let text = "[[emitter]]\ntype = 'isotropic'\nposition = [1, 2, 30]\nflux_lm = 1\n[material.m]\ntype = 'absorber'\n\
                [[surface]]\nname = 'a'\ntype = 'mesh'\nfile = 'prism.obj'\nmaterial = 'm'\nscale = [1, 2, 3]\n\
                rotate_deg = [10, 20, 30]\ntranslate = [4, 5, 6]\nsmooth = false\n";
    let scene = parse(text, "t.toml", Base::Directory(folder())).unwrap().build().unwrap();
    let transform =
        Transform::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(10.0, 20.0, 30.0), DVec3::new(4.0, 5.0, 6.0));
    let transform = transform.unwrap();
    let Shape::Mesh(mesh) = shape(&scene, "a") else { panic!("a mesh") };
    let plain = obj::parse_obj(
        &std::fs::read(folder().join("prism.obj")).unwrap(),
        Path::new("prism.obj"),
        &ObjOptions::default(),
    );
    let moved: Vec<DVec3> = plain.unwrap().0.vertices().iter().map(|v| transform.point(*v)).collect();
    assert_eq!(mesh.vertices(), moved);
    assert!(!mesh.is_smooth());
}

#[test]
fn materials_are_found_by_name() {
    let text = "[[emitter]]\ntype = 'isotropic'\nposition = [1, 2, 3]\nflux_lm = 1\n\
                [material.z]\ntype = 'absorber'\n[material.a]\ntype = 'mirror'\n\
                [[surface]]\nname = 's'\ntype = 'sphere'\ncenter = [0, 0, 9]\nradius = 1\nmaterial = 'a'\n";
    let scene = parse(text, "t.toml", Base::Directory(".".into())).unwrap().build().unwrap();
    assert!(matches!(scene.materials()[..], [Material::Mirror(_)]));
}

#[test]
fn pool_walls_look_inwards_and_the_lamp_looks_at_the_water() {
    let scene = scene("pool.toml");
    for (wall, normal) in [
        ("wall west", DVec3::X),
        ("wall east", DVec3::NEG_X),
        ("wall south", DVec3::Y),
        ("wall north", DVec3::NEG_Y),
        ("floor", DVec3::Z),
    ] {
        let (corner, u, v, n) = rectangle(&scene, wall);
        assert!((n - normal).length() < 1e-15, "{wall}");
        assert!((corner + (u + v) / 2.0 - DVec3::new(0.0, 0.0, 0.55)).dot(n) < 0.0, "{wall} faces the pool");
    }
    let (position, aim) = lamp(&scene);
    let (u, v, front) = meets(&scene, "floor", position, aim);
    assert!((0.3..0.7).contains(&u) && (0.3..0.7).contains(&v) && front);
    let Shape::Mesh(water) = shape(&scene, "water") else { panic!("a heightfield") };
    let (corner, _, edge_up, _) = rectangle(&scene, "wall west");
    for vertex in water.vertices() {
        assert!(vertex.z < corner.z + edge_up.z, "the water stays below the rim");
        assert!(vertex.z > 0.0);
    }
}

#[test]
fn ball_lens_plate_lies_at_the_waist() {
    let scene = scene("ball_lens.toml");
    let Shape::Sphere(ball) = shape(&scene, "ball") else { panic!("a sphere") };
    let (center, radius) = (ball.centre(), ball.radius());
    let (lamp, aim) = lamp(&scene);
    let focal = 1.5 * radius / (2.0 * (1.5 - 1.0));
    let image = 1.0 / (1.0 / focal - 1.0 / (lamp.z - center.z));
    let (corner, ..) = rectangle(&scene, "plate");
    let distance = center.z - corner.z;
    assert!(distance > radius && distance < image, "{radius} {distance} {image}");
    assert_eq!(meets(&scene, "plate", lamp, aim), (0.5, 0.5, true));
}

#[test]
fn reflector_lamp_is_in_the_focus_and_the_beam_falls_on_the_wall() {
    let scene = scene("reflector.toml");
    let Shape::Paraboloid(mirror) = shape(&scene, "mirror") else { panic!("a paraboloid") };
    let (vertex, axis, focal_length, radius) =
        (mirror.vertex(), mirror.axis(), mirror.focal_length(), mirror.radius());
    assert_eq!(mirror.focus(), scene.emitters.as_slice()[0].position());
    for rim in [DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
        let start = vertex + rim * radius + axis * (radius * radius / (4.0 * focal_length));
        let (u, v, front) = meets(&scene, "wall", start, axis);
        assert!((0.2..=0.8).contains(&u) && (0.2..=0.8).contains(&v) && front, "{u} {v}");
    }
}

/// Triangles of the prism in the scene's coordinates.
fn prism_faces(scene: &Scene) -> Vec<[DVec3; 3]> {
    let Shape::Mesh(mesh) = &scene.geometry.surfaces()[0].shape else { panic!("a mesh") };
    (0..mesh.triangles().len()).map(|face| mesh.triangle(face)).collect()
}

#[test]
fn prism_is_closed_and_outward() {
    let faces = prism_faces(&scene("prism.toml"));
    let volume: f64 = faces.iter().map(|[a, b, c]| a.dot(b.cross(*c)) / 6.0).sum();
    let expected = 0.1 * 0.08660254037844387 / 2.0 * 0.12;
    assert!((volume - expected).abs() < 1e-12 * 0.01, "{volume} {expected}");
    let bits = |p: DVec3| p.to_array().map(f64::to_bits);
    let mut edges = std::collections::BTreeMap::new();
    for face in &faces {
        for i in 0..3 {
            *edges.entry((bits(face[i]), bits(face[(i + 1) % 3]))).or_insert(0) += 1;
        }
    }
    for ((a, b), count) in &edges {
        assert_eq!((*count, edges.get(&(*b, *a))), (1, Some(&1)), "an edge runs once in each direction");
    }
}

#[test]
fn prism_turns_the_beam_onto_the_screen() {
    let scene = scene("prism.toml");
    let faces = prism_faces(&scene);
    let beam = &scene.emitters.as_slice()[0];
    let text: toml::Table = scene.identity.text.parse().unwrap();
    let aim = vector(&text["emitter"][0]["aim"]).normalize();
    let radius = text["emitter"][0]["radius"].as_float().unwrap();
    let across = aim.cross(DVec3::Y).normalize() * radius;
    let up = across.cross(aim);
    for (i, (x, y)) in [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)].into_iter().enumerate()
    {
        let mut origin = beam.position() + across * x + up * y;
        let mut direction = aim;
        for eta in [1.0 / 1.5, 1.5] {
            let (t, normal) = nearest(&faces, origin, direction).expect("the beam meets the prism");
            origin += direction * t;
            direction = refract(direction, normal, eta);
        }
        assert!(
            nearest(&faces, origin + direction * 1e-9, direction).is_none(),
            "it leaves by the second face"
        );
        let (u, v, front) = meets(&scene, "screen", origin, direction);
        assert!((0.2..0.8).contains(&u) && (0.2..0.8).contains(&v) && front, "{u} {v}");
        if i == 0 {
            // Least deviation: 2 asin(n sin 30 deg) - 60 deg.
            let deviation = aim.dot(direction).acos().to_degrees();
            let least = 2.0 * 0.75f64.asin().to_degrees() - 60.0;
            assert!((deviation - least).abs() < 1e-4, "{deviation} {least}");
        }
    }
}

/// Distance to the nearest face before a point that does not lie on one, and the normal against the
/// direction.
fn nearest(faces: &[[DVec3; 3]], origin: DVec3, direction: DVec3) -> Option<(f64, DVec3)> {
    let mut best: Option<(f64, DVec3)> = None;
    for [a, b, c] in faces {
        let n = (b - a).cross(c - a).normalize();
        let t = (*a - origin).dot(n) / direction.dot(n);
        let p = origin + direction * t;
        let inside = [(a, b), (b, c), (c, a)].iter().all(|(p0, p1)| (*p1 - *p0).cross(p - *p0).dot(n) >= 0.0);
        if t > 1e-9 && inside && best.is_none_or(|(least, _)| t < least) {
            best = Some((t, if direction.dot(n) < 0.0 { n } else { -n }));
        }
    }
    best
}

/// Snell's law with the normal against the direction and eta = n before / n after.
fn refract(direction: DVec3, normal: DVec3, eta: f64) -> DVec3 {
    let cosine = -direction.dot(normal);
    let squared = 1.0 - eta * eta * (1.0 - cosine * cosine);
    assert!(squared > 0.0, "no total reflection on this path");
    direction * eta + normal * (eta * cosine - squared.sqrt())
}
