//! The frame of docs/PHOTOMETRIC_FRAME.md: where (V, H) points in the world, for types A, B and C.
//!
//! The project's asymmetric files of each type, an aim that is not an axis and an up that is not perpendicular to it. The
//! world directions of the first test are worked out by hand, the candela are read in the files; mirrored tables must
//! fail.

use caustix::emitter::{AimFrame, Emitter, Emitters, Photometric};
use caustix::files::bytes::Base;
use caustix::files::photometric;
use caustix::files::scene_toml;
use caustix::photometry::{PhotometricType, Photometry};
use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::Sampling;
use caustix::scene::Scene;
use caustix::sequence::independent::IndependentPoints;
use glam::DVec3;

use crate::support::angles::Luminaire;
use crate::support::data;
use crate::support::data::project;
use crate::support::density::Density;
use crate::support::statistics::{sidak, z_test};

/// a = (0.6, 0.8, 0); up = 10 a + 5 (0, 0, 1), so u = (0, 0, 1), r = a x u = (0.8, -0.6, 0), u x a = (-0.8, 0.6, 0).
const AIM: DVec3 = DVec3::new(6.0, 8.0, 0.0);
const UP: DVec3 = DVec3::new(6.0, 8.0, 5.0);

fn emitter(photometry: &Photometry) -> Photometric {
    Photometric::new(photometry, DVec3::ZERO, AimFrame::new(AIM, Some(UP)).unwrap(), None).unwrap()
}

fn read(name: &str) -> Photometry {
    photometric::read(data::own_file(name)).unwrap()
}

/// A direction worked out by hand and what the file says there.
struct Known {
    v_deg: f64,
    h_deg: f64,
    direction: DVec3,
    /// From the file's own lines, times its factors.
    candela: f64,
}

const fn known(v_deg: f64, h_deg: f64, direction: [f64; 3], candela: f64) -> Known {
    Known { v_deg, h_deg, direction: DVec3::from_array(direction), candela }
}

/// Type C, mirrored in the 90-270 plane: sin V (cos H u + sin H (u x a)) + cos V a. Ballast factor 0.95, field 12 0.9.
const WALL_WASHER: [Known; 2] = [
    // 0.5 (-0.8, 0.6, 0) + 0.866 a.
    known(30.0, 90.0, [0.119_615_242_271, 0.992_820_323_028, 0.0], 1130.1632 * 0.95 * 0.9),
    // 0.5 (0.8, -0.6, 0) + 0.866 a.
    known(30.0, 270.0, [0.919_615_242_271, 0.392_820_323_028, 0.0], 428.6826 * 0.95 * 0.9),
];

/// Type C, full circle: 1500 cos V (1 + 0.3 sin V cos(H - 40)).
const PANEL: [Known; 2] = [
    known(30.0, 90.0, [0.119_615_242_271, 0.992_820_323_028, 0.0], 1424.289),
    known(30.0, 270.0, [0.919_615_242_271, 0.392_820_323_028, 0.0], 1173.787),
];

/// Type C, mirrored in the 0-180 plane; multiplier 1.25 (606.2178 x 1.25) and ballast factor 0.95.
const POOL_LAMP: [Known; 2] = [
    // 0.5 u + 0.866 a, and below the aim.
    known(30.0, 0.0, [0.519_615_242_271, 0.692_820_323_028, 0.5], 757.772_25 * 0.95),
    known(30.0, 180.0, [0.519_615_242_271, 0.692_820_323_028, -0.5], 324.759_5 * 0.95),
];

/// Type A: cos V (cos H a + sin H r) + sin V u. H grows towards r, the right; V towards u.
const HEADLAMP: [Known; 4] = [
    known(-1.5, 10.0, [0.729_553_108_614, 0.683_423_023_529, -0.026_176_948_308], 14240.5),
    known(-1.5, -10.0, [0.451_811_232_176, 0.891_729_430_857, -0.026_176_948_308], 6198.54),
    known(-4.0, 2.5, [0.632_779_260_380, 0.771_183_792_623, -0.069_756_473_744], 12337.55),
    known(4.0, 2.5, [0.632_779_260_380, 0.771_183_792_623, 0.069_756_473_744], 0.0),
];

/// Type B: cos H (cos V a + sin V u) + sin H r.
const FLOODLIGHT: [Known; 4] = [
    // 0.75 a + 0.433 u + 0.5 r.
    known(30.0, 30.0, [0.85, 0.3, 0.433_012_701_892], 2801.0509),
    known(30.0, -30.0, [0.05, 0.9, 0.433_012_701_892], 2070.342),
    known(-30.0, 30.0, [0.85, 0.3, -0.433_012_701_892], 1680.6305),
    known(60.0, 20.0, [0.555_523_900_896, 0.170_664_962_319, 0.813_797_681_349], 1311.076),
];

fn all_known() -> [(&'static str, PhotometricType, &'static [Known]); 5] {
    [
        ("wall_washer_1991.ies", PhotometricType::C, &WALL_WASHER),
        ("panel_2019.ies", PhotometricType::C, &PANEL),
        ("pool_lamp.ies", PhotometricType::C, &POOL_LAMP),
        ("headlamp_a.ies", PhotometricType::A, &HEADLAMP),
        ("floodlight_b.ies", PhotometricType::B, &FLOODLIGHT),
    ]
}

/// Known directions in which the emitter's intensity is another than the file's. The directions are given to 12 decimals, and
/// no intensity of these files changes by more than its largest over 2 degrees (the headlamp's cut-off).
fn misses(emitter: &Photometric, known: &[Known], largest_cd: f64) -> usize {
    let tolerance = 2e-12 * largest_cd / 0.5f64.to_radians();
    let is_off =
        |k: &&Known| (emitter.intensity_cd(k.direction.normalize()) - k.candela).abs() > tolerance.max(1e-9);
    known.iter().filter(is_off).count()
}

#[test]
fn hand_computed_directions_have_the_candela_of_the_file() {
    let frame = Luminaire::new(AIM, UP);
    for (name, kind, known) in all_known() {
        let photometry = read(name);
        assert_eq!(photometry.web.photometric_type, kind);
        for k in known {
            let from_file = photometry.web.intensity_cd(k.v_deg, k.h_deg) * photometry.factor();
            assert!((from_file - k.candela).abs() < 1e-9, "{name} {} {}: {from_file}", k.v_deg, k.h_deg);
            assert!((frame.direction(kind, k.v_deg, k.h_deg) - k.direction).length() < 2e-12);
        }
        let largest = photometry.web.max_intensity().intensity_cd;
        assert_eq!(misses(&emitter(&photometry), known, largest), 0, "{name}");
    }
}

#[test]
fn any_direction_has_the_candela_of_the_file() {
    let frame = Luminaire::new(AIM, UP);
    for (name, kind, _) in all_known() {
        let photometry = read(name);
        let emitter = emitter(&photometry);
        let largest = photometry.web.max_intensity().intensity_cd;
        let mut positive = 0;
        // Odd steps: no angle of a file is hit, and all quarters are visited.
        for i in 0..61 {
            for j in 0..59 {
                let (v, h) = match kind {
                    PhotometricType::C => (0.7 + 2.93 * f64::from(i), 0.3 + 6.09 * f64::from(j)),
                    _ => (-88.7 + 2.93 * f64::from(i), -88.9 + 3.01 * f64::from(j)),
                };
                let expected = photometry.web.intensity_cd(v, h) * photometry.factor();
                let got = emitter.intensity_cd(frame.direction(kind, v, h));
                assert!((got - expected).abs() < 1e-11 * largest, "{name} V {v} H {h}: {got} {expected}");
                positive += u32::from(expected > 0.0);
            }
        }
        assert!(positive > 100, "{name}");
    }
}

/// A table with left and right exchanged: H becomes -H.
fn mirrored(photometry: &Photometry) -> Photometry {
    let mut mirrored = photometry.clone();
    let n_v = photometry.web.vertical_deg.len();
    let horizontal = photometry.web.horizontal_deg.clone();
    for (plane, h) in mirrored.web.candela.chunks_mut(n_v).zip(&horizontal) {
        for (candela, &v) in plane.iter_mut().zip(&photometry.web.vertical_deg) {
            *candela = photometry.web.intensity_cd(v, -h);
        }
    }
    mirrored
}

#[test]
fn a_mirrored_frame_is_seen() {
    for (name, _, known) in all_known() {
        let photometry = read(name);
        let largest = photometry.web.max_intensity().intensity_cd;
        let wrong = misses(&emitter(&mirrored(&photometry)), known, largest);
        // The 0-180 plane of the pool lamp is its own mirror image; every other file is different left and right.
        assert_eq!(wrong > 0, name != "pool_lamp.ies", "{name}: {wrong} misses with H mirrored");
        // Up and down exchanged for all of them; for type C that is H turned by half a circle.
        let down = AimFrame::new(AIM, Some(-UP)).unwrap();
        let upside_down = Photometric::new(&photometry, DVec3::ZERO, down, None).unwrap();
        assert!(misses(&upside_down, known, largest) > 0, "{name} with up turned round");
    }
}

/// Mean of the directions of photons, and the same by quadrature of the file, in components along a, u and r; and
/// the standard deviation of one photon's components by quadrature.
fn mean_directions(photometry: &Photometry, samples: u64) -> ([f64; 3], [f64; 3], [f64; 3]) {
    let frame = Luminaire::new(AIM, UP);
    let kind = photometry.web.photometric_type;
    let split = |d: DVec3| [d.dot(frame.a), d.dot(frame.u), d.dot(frame.r)];
    let emitters = Emitters::new(vec![Emitter::Photometric(emitter(photometry))]).unwrap();
    let points = IndependentPoints::new(17, 0);
    let sum: DVec3 = (0..samples)
        .map(|i| {
            emitters.emit(Sampling::default(), &mut Coordinates::new(&points, i, true)).unwrap().1.direction
        })
        .sum();
    let density = Density::new(&photometry.web);
    let component = |p: f64, q: f64, k: usize| {
        let (v, h) = density.polar_and_azimuth((p, q));
        split(frame.direction(kind, v, h))[k]
    };
    let flux = density.total();
    let mean = [0, 1, 2].map(|k| density.moment(|p, q| component(p, q, k)) / flux);
    let deviation = [0, 1, 2].map(|k| {
        (density.moment(|p, q| component(p, q, k).powi(2)) / flux - mean[k].powi(2)).max(0.0).sqrt()
    });
    (split(sum / samples as f64), mean, deviation)
}

#[test]
fn sampled_directions_lean_where_the_file_does() {
    let samples = 1 << 18;
    let level = sidak(0.01, 15);
    for (name, _, _) in all_known() {
        let photometry = read(name);
        let (sampled, mean, deviation) = mean_directions(&photometry, samples);
        println!("{name}: mean along a, u, r sampled {sampled:.5?}, by quadrature {mean:.5?}");
        let z = |k: usize, mean: f64| (sampled[k] - mean) / (deviation[k] / (samples as f64).sqrt());
        for k in 0..3 {
            let p = z_test(z(k, mean[k]));
            assert!(p > level, "{name}: component {k}: {sampled:?} {mean:?}, p {p}");
        }
        // The mirrored mean is out of the question wherever the file differs left and right.
        if name == "pool_lamp.ies" {
            assert!(mean[2].abs() < 1e-12);
        } else {
            assert!(z(2, -mean[2]).abs() > 30.0, "{name}: {}", z(2, -mean[2]));
        }
    }
    // Which side that is, from the formulas in ies/README.md alone.
    let lean = |name: &str| mean_directions(&read(name), 1).1;
    let (panel, lamp, flood, head) =
        (lean("panel_2019.ies"), lean("pool_lamp.ies"), lean("floodlight_b.ies"), lean("headlamp_a.ies"));
    // cos(H - 40) leans towards u cos 40 + (u x a) sin 40, and r is -(u x a).
    assert!((panel[2] / panel[1] + 40f64.to_radians().tan()).abs() < 2e-3, "{panel:?}");
    // 1 + 0.8 sin V cos H: towards u, by the integrals (0.8 pi / 8) / (pi / 2) ... of cos V sin^2 V and cos V.
    assert!((lamp[1] - 0.8 / 4.0).abs() < 2e-3, "{lamp:?}");
    assert!(flood[1] > 0.0 && flood[2] > 0.0, "{flood:?}");
    // The low beam: to the right, H = 3 in the middle, and below the horizon.
    assert!((head[2] / head[0]).atan().to_degrees() > 2.0 && head[1] < 0.0, "{head:?}");
}

fn scene(name: &str, frame: &str) -> Scene {
    let text = format!(
        "[[emitter]]\ntype = \"photometric\"\nfile = \"{name}\"\nposition = [0.0, 0.0, 2.0]\n{frame}\n\
         [material.black]\ntype = \"absorber\"\n\
         [[surface]]\nname = \"plate\"\ntype = \"rectangle\"\nmaterial = \"black\"\n\
         corner = [-1.0, -1.0, 0.0]\nedge_u = [2.0, 0.0, 0.0]\nedge_v = [0.0, 2.0, 0.0]\n\
         [[receiver]]\nsurface = \"plate\"\ncells = [4, 4]\n"
    );
    let base = Base::Directory(project().join("ies"));
    scene_toml::parse(&text, "frame.toml", base).unwrap().build().unwrap()
}

fn lamp(scene: &Scene) -> &Photometric {
    match &scene.emitters.as_slice()[0] {
        Emitter::Photometric(e) => e,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_scene_file_gives_the_same_frame() {
    for (name, _, known) in all_known() {
        let scene = scene(name, "aim = [6.0, 8.0, 0.0]\nup = [6.0, 8.0, 5.0]");
        let largest = read(name).web.max_intensity().intensity_cd;
        assert_eq!(misses(lamp(&scene), known, largest), 0, "{name}");
    }
}

#[test]
fn without_aim_and_up_a_lamp_hangs() {
    // a = -z, u = +y, u x a = -x: H = 90 tilts to -x, counter-clockwise seen from above.
    let hanging = scene("panel_2019.ies", "");
    let towards = |d: [f64; 3]| lamp(&hanging).intensity_cd(DVec3::from_array(d).normalize());
    let cos_30 = 0.75f64.sqrt();
    assert!((towards([0.0, 0.0, -1.0]) - 1500.0).abs() < 1e-6);
    assert!((towards([-0.5, 0.0, -cos_30]) - 1424.289).abs() < 1e-6);
    assert!((towards([0.5, 0.0, -cos_30]) - 1173.787).abs() < 1e-6);
}

/// Cells of the rows of docs/PHOTOMETRIC_FRAME.md that begin with a file's name and have this many cells.
fn rows_of_the_page(cells: usize) -> Vec<Vec<String>> {
    let page = project().join("docs/PHOTOMETRIC_FRAME.md");
    let text = std::fs::read_to_string(page).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("| `"));
    let split =
        |line: &str| line.trim_matches('|').split('|').map(|c| c.trim().to_owned()).collect::<Vec<_>>();
    rows.map(split).filter(|row| row.len() == cells).collect()
}

#[test]
fn the_numbers_of_the_page_are_these() {
    let numbers = |text: &str, separator: &str| -> Vec<f64> {
        text.trim_matches(['(', ')']).split(separator).map(|n| n.trim().parse().unwrap()).collect()
    };
    let file = |cell: &str| format!("{}.ies", cell.trim_matches('`'));
    let worked = rows_of_the_page(7);
    assert_eq!(worked.len(), all_known().iter().map(|(.., known)| known.len()).sum::<usize>());
    for row in &worked {
        let name = file(&row[0]);
        let (_, kind, known) = all_known().into_iter().find(|(n, ..)| *n == name).unwrap();
        let (v, h): (f64, f64) = (row[2].parse().unwrap(), row[3].parse().unwrap());
        let k = known.iter().find(|k| (k.v_deg, k.h_deg) == (v, h)).unwrap();
        assert_eq!(row[1], kind.name());
        // Six decimals of the direction; the intensity as a product of what the file says.
        let direction = DVec3::from_slice(&numbers(&row[4], ","));
        assert!((direction - k.direction).abs().max_element() < 6e-7, "{row:?}");
        assert!((numbers(&row[6], " x ").iter().product::<f64>() - k.candela).abs() < 1e-9, "{row:?}");
        // What it is made of: "0.5 u + 0.866 a".
        if row[5] != "as above" {
            let frame = Luminaire::new(AIM, UP);
            let by_hand: DVec3 =
                row[5].replace("- ", "+ -").split(" + ").map(|term| axis(&frame, term)).sum();
            assert!((by_hand - k.direction).length() < 1e-3, "{row:?}: {by_hand}");
        }
    }
    let leaning = rows_of_the_page(5);
    assert_eq!(leaning.len(), all_known().len());
    for row in &leaning {
        let mean = mean_directions(&read(&file(&row[0])), 1).1;
        for (stated, mean) in row[1..4].iter().zip(mean) {
            assert!((stated.parse::<f64>().unwrap() - mean).abs() < 6e-5, "{row:?}: {mean}");
        }
    }
}

/// "-0.433 u" or "0.5 (u x a)" as a vector.
fn axis(frame: &Luminaire, term: &str) -> DVec3 {
    let (factor, name) = term.split_once(' ').unwrap();
    let axis = match name {
        "a" => frame.a,
        "u" => frame.u,
        "r" => frame.r,
        "(u x a)" => -frame.r,
        other => panic!("{other}"),
    };
    axis * factor.parse::<f64>().unwrap()
}
