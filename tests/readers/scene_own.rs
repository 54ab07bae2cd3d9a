//! The scenes of this project: read without a warning, and light does reach their receivers.

use std::path::PathBuf;

use caustix::error::Kind;
use caustix::files::scene_toml::description::{
    BeamSection, ColourDescription, Description, EmitterShape, Facing, MaterialKind, ReceiverEvents,
    ReceiverSide, ReliefDescription, ShapeDescription, TransformDescription,
};
use caustix::files::scene_toml::source::Base;
use caustix::files::scene_toml::{parse, read};
use caustix::surface::{Dielectric, Material, Mirror, Reflectance};
use glam::DVec3;

use crate::support::data::project;

fn folder() -> PathBuf {
    project().join("scenes")
}

fn scene(name: &str) -> Description {
    let path = folder().join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    parse(&text, name, Base::Directory(folder())).unwrap()
}

fn shape<'s>(scene: &'s Description, name: &str) -> &'s ShapeDescription {
    &scene.surfaces.iter().find(|s| s.name == name).unwrap().shape
}

/// Corner, edges and unit normal of a rectangle.
fn rectangle(scene: &Description, name: &str) -> (DVec3, DVec3, DVec3, DVec3) {
    let ShapeDescription::Rectangle { corner, edge_u, edge_v } = shape(scene, name) else {
        panic!("{name} should be a rectangle")
    };
    (*corner, *edge_u, *edge_v, edge_u.cross(*edge_v).normalize())
}

/// (u, v) where a ray meets a rectangle, and whether it comes from the front.
fn meets(scene: &Description, name: &str, origin: DVec3, direction: DVec3) -> (f64, f64, bool) {
    let (corner, u, v, n) = rectangle(scene, name);
    let t = (corner - origin).dot(n) / direction.dot(n);
    assert!(t > 0.0, "the ray should run towards {name}");
    let p = origin + direction * t - corner;
    (p.dot(u) / u.length_squared(), p.dot(v) / v.length_squared(), direction.dot(n) < 0.0)
}

#[test]
fn every_scene_reads_without_a_warning() {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let name = path.file_name().unwrap().to_str().unwrap().to_string();
            let scene = scene(&name);
            assert_eq!(scene.warnings, [], "{name}");
            assert!(!scene.receivers.is_empty(), "{name}");
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
    let scene = Description::built_in().unwrap();
    assert_eq!(scene.warnings, []);
    assert_eq!(scene.emitters.len(), 1);
    let lamp = &scene.emitters[0];
    assert_eq!(lamp.position.value, DVec3::new(0.03, -0.02, 2.0));
    assert_eq!((lamp.frame.aim, lamp.frame.up), (DVec3::NEG_Z, DVec3::Y));
    assert_eq!(lamp.flux_lm, None);
    let EmitterShape::Photometric { file } = &lamp.shape else { panic!("a photometric lamp") };
    assert_eq!(file.value, "../ies/wavy_glass.ies");
    let mut seeds = Vec::new();
    for (name, z, facing, stretch) in
        [("glass top", 1.1, Facing::Up, 1.0), ("glass bottom", 0.8, Facing::Down, 1.1)]
    {
        let surface = scene.surfaces.iter().find(|s| s.name == name).unwrap();
        let material = &scene.materials[surface.material.index];
        let glass = Dielectric::new(1.5, 1.0).unwrap();
        assert!(matches!(material.kind, MaterialKind::Plain(Material::Dielectric(d)) if d == glass));
        let ShapeDescription::Heightfield(field) = &surface.shape else { panic!("a heightfield") };
        assert_eq!(field.origin, DVec3::new(-1.4, -1.4, z));
        assert_eq!((field.size, field.facing, field.smooth), ([2.8, 2.8], facing, true));
        let ReliefDescription::Noise { cells, seed, amplitude, octaves } = &field.relief else {
            panic!("noise")
        };
        assert_eq!((*cells, *amplitude), ([128, 128], 0.010));
        seeds.push(*seed);
        let expected = [(1.0, 0.300), (0.45, 0.148), (0.12, 0.073)];
        assert_eq!(octaves.len(), 3);
        for (octave, (amplitude, wavelength)) in octaves.iter().zip(expected) {
            assert_eq!(octave.amplitude, amplitude);
            assert!((octave.wavelength - wavelength * stretch).abs() < 1e-15, "{octave:?}");
        }
    }
    assert_ne!(seeds[0], seeds[1]);
    let (corner, u, v, normal) = rectangle(&scene, "plate");
    assert_eq!(corner + (u + v) / 2.0, DVec3::ZERO);
    assert_eq!((u.length(), v.length(), normal), (2.0, 2.0, DVec3::Z));
    let receiver = &scene.receivers[0];
    assert_eq!((receiver.name.as_str(), receiver.cells), ("plate", Some([512, 512])));
    assert_eq!((receiver.side, receiver.events), (ReceiverSide::Front, ReceiverEvents::All));
}

#[test]
fn built_in_scene_carries_its_files() {
    let scene = Description::built_in().unwrap();
    assert!(scene.missing_files().is_empty());
    for file in scene.files() {
        let embedded = scene.load(file).unwrap();
        assert_eq!(embedded, std::fs::read(folder().join(&file.value)).unwrap());
    }
    let text = std::fs::read(folder().join("wavy_glass.toml")).unwrap();
    assert_eq!(scene.source.text.as_bytes(), text);
    assert_eq!(scene.source.sha256, caustix::files::scene_toml::source::sha256_hex(&text));
    assert_eq!(scene.source.load("wavy_glass.toml").unwrap_err().kind(), Kind::Io);
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
    let scene = read(&path).unwrap();
    let file = scene.files().next().unwrap().clone();
    assert_eq!(scene.load(&file).unwrap(), b"v 0 0 0\n");

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
    let text = "[[emitter]]\ntype = 'photometric'\nfile = 'a.ies'\nposition = [1, 2, 3]\n\
                [[emitter]]\ntype = 'photometric'\nfile = 'a.ies'\nposition = [1, 2, 3]\naim = [0, -3, 0]\n\
                [[emitter]]\ntype = 'collimated'\nposition = [0, 0, 0]\nflux_lm = 5\nsize = [3, 4]\n\
                aim = [1, 1, 0]\nup = [0, 0, 2]\n\
                [material.m]\ntype = 'mirror'\n\
                [[surface]]\nname = 'ball'\ntype = 'sphere'\nmaterial = 'm'\ncenter = [0, 0, 9]\nradius = 1\n\
                [[receiver]]\nsurface = 'ball'\n";
    let scene = parse(text, "t.toml", Base::Directory(".".into())).unwrap();
    let names: Vec<&str> = scene.emitters.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["emitter 1", "emitter 2", "emitter 3"]);
    assert_eq!((scene.emitters[0].frame.aim, scene.emitters[0].frame.up), (DVec3::NEG_Z, DVec3::Y));
    assert_eq!((scene.emitters[1].frame.aim, scene.emitters[1].frame.up), (DVec3::NEG_Y, DVec3::X));
    let frame = scene.emitters[2].frame;
    assert!((frame.aim - DVec3::new(0.5f64.sqrt(), 0.5f64.sqrt(), 0.0)).length() < 1e-15);
    assert_eq!(frame.up, DVec3::Z);
    let EmitterShape::Collimated { section } = scene.emitters[2].shape else { panic!("a beam") };
    assert_eq!(section, BeamSection::Rectangle { width: 3.0, height: 4.0 });
    let mirror = Mirror::new(Reflectance::new(1.0).unwrap());
    assert!(matches!(scene.materials[0].kind, MaterialKind::Plain(Material::Mirror(m)) if m == mirror));
    assert!(scene.surfaces[0].transform.is_identity());
    let receiver = &scene.receivers[0];
    assert_eq!((receiver.name.as_str(), receiver.cells), ("ball", Some([256, 256])));
    assert_eq!((receiver.side, receiver.events), (ReceiverSide::Front, ReceiverEvents::All));
    assert_eq!(scene.run.photons, None);
}

#[test]
fn every_example_of_the_manual_reads() {
    let manual = include_str!("../../docs/SCENE.md");
    let blocks: Vec<&str> =
        manual.split("```toml\n").skip(1).map(|b| b.split("```").next().unwrap()).collect();
    assert_eq!(blocks.len(), manual.matches("```").count() / 2);
    let scene = parse(blocks[0], "manual", Base::BuiltIn).unwrap();
    assert_eq!(scene.warnings, []);
    // The others are parts of one scene, but for the glass of the first.
    let parts = blocks[1..].concat() + "[material.glass]\ntype = \"dielectric\"\nior = 1.5\n";
    let scene = parse(&parts, "manual", Base::BuiltIn).unwrap();
    assert_eq!((scene.emitters.len(), scene.surfaces.len(), scene.receivers.len()), (4, 8, 2));
    assert_eq!(scene.run.photons.unwrap().value, 1 << 24);
    assert_eq!(scene.camera.unwrap().spec.samples, 32);
    assert_eq!(scene.emitters[1].colour.unwrap().value, ColourDescription::Cct(2700.0));
}

#[test]
fn transforms_are_read() {
    let text = "[[emitter]]\ntype = 'isotropic'\nposition = [1, 2, 3]\nflux_lm = 1\n[material.m]\ntype = 'absorber'\n\
                [[surface]]\nname = 'a'\ntype = 'mesh'\nfile = 'a.obj'\nmaterial = 'm'\nscale = [1, 2, 3]\n\
                rotate_deg = [10, 20, 30]\ntranslate = [4, 5, 6]\nsmooth = false\n";
    let scene = parse(text, "t.toml", Base::Directory(".".into())).unwrap();
    let expected = TransformDescription {
        scale: DVec3::new(1.0, 2.0, 3.0),
        rotate_deg: DVec3::new(10.0, 20.0, 30.0),
        translate: DVec3::new(4.0, 5.0, 6.0),
    };
    assert_eq!(scene.surfaces[0].transform, expected);
    let ShapeDescription::Mesh { closed, smooth, .. } = scene.surfaces[0].shape else { panic!("a mesh") };
    assert_eq!((closed, smooth), (None, Some(false)));
}

#[test]
fn order_of_materials_is_the_file_s() {
    let text = "[[emitter]]\ntype = 'isotropic'\nposition = [1, 2, 3]\nflux_lm = 1\n\
                [material.z]\ntype = 'absorber'\n[material.a]\ntype = 'mirror'\n\
                [[surface]]\nname = 's'\ntype = 'sphere'\ncenter = [0, 0, 9]\nradius = 1\nmaterial = 'a'\n";
    let scene = parse(text, "t.toml", Base::Directory(".".into())).unwrap();
    assert_eq!(scene.materials.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["z", "a"]);
    assert_eq!(scene.surfaces[0].material.index, 1);
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
    let lamp = &scene.emitters[0];
    let (u, v, front) = meets(&scene, "floor", lamp.position.value, lamp.frame.aim);
    assert!((0.3..0.7).contains(&u) && (0.3..0.7).contains(&v) && front);
    let ShapeDescription::Heightfield(water) = shape(&scene, "water") else { panic!("a heightfield") };
    let ReliefDescription::Waves { waves, .. } = &water.relief else { panic!("waves") };
    let peak: f64 = waves.iter().map(|w| w.amplitude.abs()).sum();
    let (corner, _, edge_up, _) = rectangle(&scene, "wall west");
    assert!(water.origin.z + peak < corner.z + edge_up.z, "the water stays below the rim");
    assert!(water.origin.z - peak > 0.0);
}

#[test]
fn ball_lens_plate_lies_at_the_waist() {
    let scene = scene("ball_lens.toml");
    let ShapeDescription::Sphere { center, radius } = shape(&scene, "ball") else { panic!("a sphere") };
    let lamp = scene.emitters[0].position.value;
    let focal = 1.5 * radius / (2.0 * (1.5 - 1.0));
    let image = 1.0 / (1.0 / focal - 1.0 / (lamp.z - center.z));
    let (corner, ..) = rectangle(&scene, "plate");
    let distance = center.z - corner.z;
    assert!(distance > *radius && distance < image, "{radius} {distance} {image}");
    assert_eq!(meets(&scene, "plate", lamp, scene.emitters[0].frame.aim), (0.5, 0.5, true));
}

#[test]
fn reflector_lamp_is_in_the_focus_and_the_beam_falls_on_the_wall() {
    let scene = scene("reflector.toml");
    let ShapeDescription::Paraboloid { vertex, axis, focal_length, radius } = *shape(&scene, "mirror") else {
        panic!("a paraboloid")
    };
    assert_eq!(vertex + axis * focal_length, scene.emitters[0].position.value);
    for rim in [DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
        let start = vertex + rim * radius + axis * (radius * radius / (4.0 * focal_length));
        let (u, v, front) = meets(&scene, "wall", start, axis);
        assert!((0.2..=0.8).contains(&u) && (0.2..=0.8).contains(&v) && front, "{u} {v}");
    }
}

/// Triangles of the prism in the scene's coordinates.
fn prism_faces(scene: &Description) -> Vec<[DVec3; 3]> {
    let text = std::fs::read_to_string(folder().join("prism.obj")).unwrap();
    let numbers =
        |line: &str| line.split_whitespace().skip(1).map(|t| t.parse().unwrap()).collect::<Vec<f64>>();
    let transform = scene.surfaces[0].transform;
    assert_eq!((transform.scale, transform.rotate_deg), (DVec3::ONE, DVec3::ZERO));
    let vertices: Vec<DVec3> = text
        .lines()
        .filter(|l| l.starts_with("v "))
        .map(|l| DVec3::from_slice(&numbers(l)) + transform.translate)
        .collect();
    let faces = text.lines().filter(|l| l.starts_with("f ")).map(numbers);
    faces.map(|f| [0, 1, 2].map(|i| vertices[f[i] as usize - 1])).collect()
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
    let beam = &scene.emitters[0];
    let EmitterShape::Collimated { section: BeamSection::Disc { radius } } = beam.shape else {
        panic!("a disc")
    };
    let across = beam.frame.aim.cross(beam.frame.up);
    let last = |n: f64| n * radius;
    for (i, (x, y)) in [(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)].into_iter().enumerate()
    {
        let mut origin = beam.position.value + across * last(x) + beam.frame.up * last(y);
        let mut direction = beam.frame.aim;
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
            let deviation = beam.frame.aim.dot(direction).acos().to_degrees();
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
