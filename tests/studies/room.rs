//! Colour and weights against closed forms; the room; the study of it.
//!
//! Inside a sphere of radius R whose wall reflects rho_c of channel c, light that was reflected falls equally on all of it:
//! after m reflections Phi rho_c^m / (4 pi R^2), whatever the luminaire.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use caustix::files::scene_toml::read;
use caustix::geometry::Shape;
use caustix::lab::room::measure::measure;
use caustix::lab::room::{Measurement, Options, RoomStudy, SEQUENCES, Task};
use caustix::report::room as report;
use caustix::scene::Scene;
use caustix::scene::requires::requirements;
use caustix::sequence::Sequence;
use caustix::surface::{Lambertian, Material, Mirror, Reflectance};

use crate::support::data::project;
use crate::support::judge::{SIGNIFICANCE, assert_cells, assert_total, sidak, student_p};
use crate::support::scenes::{run, scene};

const Y: [f64; 3] = [0.2126, 0.7152, 0.0722];

fn luminance(rgb: [f64; 3]) -> f64 {
    (0..3).map(|c| Y[c] * rgb[c]).sum()
}

fn sphere(material: &str, rest: &str) -> Scene {
    scene(&format!(
        r#"
[[emitter]]
type = "panel"
position = [0.4, 0.3, -0.5]
aim = [1.0, 0.5, 0.2]
size = [0.3, 0.2]
flux_lm = 1000
[material.wall]
{material}
[[surface]]
name = "wall"
type = "sphere"
material = "wall"
center = [0.0, 0.0, 0.0]
radius = 1.4
[[receiver]]
surface = "wall"
side = "back"
events = "indirect"
cells = [8, 4]
{rest}
"#
    ))
}

const AREA: f64 = 4.0 * PI * 1.4 * 1.4;

#[test]
fn colour_in_an_integrating_sphere() {
    for (seed, rgb) in [(1, [0.9, 0.3, 0.1]), (2, [0.1, 0.5, 0.8]), (3, [0.95, 0.0, 0.5])] {
        let scene = sphere(&format!("type = \"lambertian\"\nreflectance = {rgb:?}"), "");
        assert!(requirements(&scene).contains(&"colour"));
        let indirect = luminance(rgb.map(|rho| rho / (1.0 - rho))) * 1000.0;
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 14, 16, seed);
        let label = format!("{rgb:?}");
        assert_cells(&label, &scene, &outcome, 0, &[indirect / AREA; 32]);
        assert_total(&label, &outcome, outcome.receiver_flux_lm(0), indirect);
        assert_eq!(outcome.ledger.absorbed[0], outcome.photons);
    }
}

#[test]
fn a_coloured_mirror_colours() {
    // The panel sees a mirror below it, and that the ceiling above: red light of 0.6, and 0.3 of the rest.
    let text = |mirror: &str| {
        format!(
            r#"
[[emitter]]
type = "collimated"
position = [0.0, 0.0, 1.0]
aim = [0.6, 0.0, -0.8]
radius = 0.1
flux_lm = 100
[material.tinted]
type = "mirror"
reflectance = {mirror}
[material.red]
type = "lambertian"
reflectance = [1.0, 0.0, 0.0]
[[surface]]
name = "mirror"
type = "rectangle"
material = "tinted"
corner = [-2.0, -2.0, 0.0]
edge_u = [4.0, 0.0, 0.0]
edge_v = [0.0, 4.0, 0.0]
[[surface]]
name = "ceiling"
type = "rectangle"
material = "red"
corner = [-9.0, -9.0, 1.5]
edge_u = [18.0, 0.0, 0.0]
edge_v = [0.0, 18.0, 0.0]
[[receiver]]
name = "up"
surface = "ceiling"
side = "back"
cells = [1, 1]
events = "all"
"#
        )
    };
    let scene = scene(&text("[0.6, 0.3, 0.3]"));
    let outcome = run(&scene, Sequence::SobolOwen, 1 << 12, 16, 5);
    // Direct from the mirror: Y(0.6, 0.3, 0.3) of 100 lm; what the ceiling and the mirror exchange is red alone, and more.
    let once = luminance([0.6, 0.3, 0.3]) * 100.0;
    let total = outcome.receiver_flux_lm(0).value;
    assert!(total > once, "{total} {once}");
    // The ceiling absorbs all but red: first Y(0, 0.3, 0.3), afterwards nothing.
    let absorbed = luminance([0.0, 0.3, 0.3]) * 100.0;
    assert_total("absorbed by the ceiling", &outcome, outcome.absorbed_lm(1), absorbed);
}

/// A reflectance's channels all equal is another way to write a grey one: the same photons, bit for bit.
#[test]
fn grey_written_as_colour_is_grey() {
    let a = sphere("type = \"lambertian\"\nreflectance = 0.7", "");
    let b = sphere("type = \"lambertian\"\nreflectance = [0.7, 0.7, 0.7]", "");
    assert!(!requirements(&b).contains(&"colour"));
    let outcomes = [&a, &b].map(|s| run(s, Sequence::SobolOwen, 1 << 12, 4, 6));
    assert_eq!(outcomes[0].cells()[0], outcomes[1].cells()[0]);
    assert_eq!(outcomes[0].ledger, outcomes[1].ledger);
}

fn task(sequence: Sequence, seed: u64, photons: u64) -> Task {
    Task { sequence, seed, photons }
}

/// A clock that every system has.
fn clock() -> caustix::Result<Duration> {
    Ok(SystemTime::now().duration_since(UNIX_EPOCH).unwrap())
}

fn measured(scene: &Scene, sequence: Sequence, seed: u64, photons: u64) -> Measurement {
    measure(scene, &task(sequence, seed, photons), clock, &AtomicBool::new(false), &|_| {}).unwrap()
}

fn areas(scene: &Scene) -> Vec<f64> {
    scene.receivers.iter().flat_map(|r| (0..r.cells.len()).map(|c| r.area_m2(c))).collect()
}

/// Flux [lm] by channel that arrived in all cells.
fn flux(scene: &Scene, m: &Measurement) -> [f64; 3] {
    let areas = areas(scene);
    std::array::from_fn(|c| m.radiance.iter().zip(&areas).map(|(l, a)| PI * l[c] * a).sum())
}

/// The room with other materials: [material] tables and [compare] replaced.
fn room(reflectance: &str, reflections: u32) -> Scene {
    let text = std::fs::read_to_string(project().join("scenes/room.toml")).unwrap();
    let mut out = String::new();
    for line in text.lines() {
        let line = match line {
            l if l.starts_with("reflectance =") && !reflectance.is_empty() => {
                format!("reflectance = {reflectance}")
            }
            l if l.starts_with("reflections =") => format!("reflections = {reflections}"),
            l => l.to_string(),
        };
        out += &(line + "\n");
    }
    scene(&out)
}

#[test]
fn the_room_is_closed_and_has_276_triangles() {
    let file = project().join("scenes/room.toml");
    let scene = read(file).unwrap().build().unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(scene.geometry.primitive_count(), 276);
    assert_eq!(scene.receivers.iter().map(|r| r.cells.len()).sum::<usize>(), 276);
    assert_eq!(scene.compared_reflections, Some(4));
    // Walls look inward: by the divergence theorem the faces of the room enclose -60 m3, the things in it their volume.
    let volume = |name: &str| {
        let surface = scene.geometry.surface_named(name).unwrap();
        let Shape::Mesh(mesh) = &scene.geometry.surfaces()[surface.0 as usize].shape else {
            panic!("{name}")
        };
        let corners = (0..mesh.triangles().len()).map(|face| mesh.triangle(face));
        corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum::<f64>()
    };
    let walls = ["floor", "ceiling", "red wall", "green wall", "white walls"];
    assert!((walls.map(volume).iter().sum::<f64>() + 60.0).abs() < 1e-9);
    let table = 1.6 * 0.8 * 0.04 + 4.0 * 0.08 * 0.08 * 0.64;
    for (name, expected) in [("table", table), ("pillar", 0.4 * 0.4 * 2.96)] {
        assert!((volume(name) - expected).abs() < 1e-9, "{name}: {} {expected}", volume(name));
    }
    for (sequence, seed) in [(Sequence::SobolOwen, 1), (Sequence::Independent, 2)] {
        let outcome = run(&scene, sequence, 1 << 14, 8, seed);
        assert_eq!(outcome.ledger.escaped, 0);
        assert!(outcome.totals().sum.iter().sum::<u64>() > outcome.photons);
    }
}

#[test]
fn with_grey_walls_each_arrival_carries_a_power_of_the_reflectance() {
    for (reflectance, reflections) in [(0.5, 4), (0.7, 4), (0.3, 0), (0.9, 30), (1.0, 7)] {
        let scene = room(&reflectance.to_string(), reflections);
        for sequence in [Sequence::Independent, Sequence::Hammersley] {
            let n = 5000;
            let m = measured(&scene, sequence, 1, n);
            assert_eq!(m.escaped, 0);
            let arrivals = f64::from(reflections) + 1.0;
            let expected: f64 =
                6000.0 * (0..=reflections).map(|k| f64::powi(reflectance, k as i32)).sum::<f64>();
            // Half a quantum an arrival, and the roundings of the sum over 276 faces.
            let quantum = (arrivals * n as f64).log2().ceil() - 64.0;
            let tolerance = expected * 276.0 * f64::EPSILON + 6000.0 * arrivals * quantum.max(-52.0).exp2();
            for channel in flux(&scene, &m) {
                let off = (channel - expected).abs();
                assert!(off <= tolerance, "{reflectance}, {reflections}: off by {off}, {tolerance}");
            }
            assert_eq!(m.coordinates, (f64::from(2 * reflections + 4), 2 * reflections + 4));
        }
    }
}

#[test]
fn weights_in_a_coloured_sphere_are_the_partial_sums_of_the_series() {
    let rgb = [0.9, 0.3, 0.1];
    let reflections = 4;
    let rest = format!("[compare]\nreflections = {reflections}");
    let scene = sphere(&format!("type = \"lambertian\"\nreflectance = {rgb:?}"), &rest);
    let seeds = 16;
    let measurements: Vec<Measurement> =
        (1..=seeds).map(|seed| measured(&scene, Sequence::SobolOwen, seed, 1 << 14)).collect();
    let mut smallest = 1.0f64;
    let mut tests = 0;
    for cell in 0..32 {
        for (channel, rho) in rgb.into_iter().enumerate() {
            let exact = (1..=reflections).map(|m| f64::powi(rho, m)).sum::<f64>() * 1000.0 / AREA / PI;
            let values: Vec<f64> = measurements.iter().map(|m| m.radiance[cell][channel]).collect();
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
            smallest = smallest.min(student_p((mean - exact) / (variance / n).sqrt(), seeds as u32 - 1));
            tests += 1;
        }
    }
    let p = sidak(smallest, tests);
    println!("{tests} cells and channels, smallest p corrected {p:.3}");
    assert!(p > SIGNIFICANCE);
}

/// Roulette in colour and a fixed number of reflections with weights are two estimators of one thing: what is left after 30
/// reflections at 0.5 is 1e-9 of the flux.
#[test]
fn weights_and_roulette_agree_in_the_room() {
    let dim = room("[0.5, 0.3, 0.4]", 30);
    let outcome = run(&dim, Sequence::SobolOwen, 1 << 14, 16, 7);
    let seeds = 16;
    let sets: Vec<Vec<f64>> = (1..=seeds)
        .map(|seed| {
            let m = measured(&dim, Sequence::SobolOwen, 100 + seed, 1 << 12);
            m.radiance.iter().map(|l| PI * luminance(*l)).collect()
        })
        .collect();
    let mut cell_of_all = 0;
    let (mut smallest, mut tests) = (1.0f64, 0);
    for (r, receiver) in dim.receivers.iter().enumerate() {
        for cell in 0..receiver.cells.len() {
            let roulette = outcome.illuminance_lx(r, cell, receiver.area_m2(cell));
            let hits = outcome.cells()[r].sum[cell];
            let values: Vec<f64> = sets.iter().map(|s| s[cell_of_all]).collect();
            cell_of_all += 1;
            if hits < 160 {
                continue;
            }
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n;
            // Welch's t has at least 15 degrees of freedom here.
            let error = (variance + roulette.standard_error.unwrap().powi(2)).sqrt();
            smallest = smallest.min(student_p((mean - roulette.value) / error, seeds as u32 - 1));
            tests += 1;
        }
    }
    let p = sidak(smallest, tests);
    println!("{tests} triangles, smallest p corrected {p:.3}");
    assert!(tests > 200 && p > SIGNIFICANCE);
}

#[test]
fn threads_do_not_change_a_bit() {
    let scene = room("", 4);
    for sequence in [Sequence::Independent, Sequence::Halton] {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| measured(&scene, sequence, 1, 50_000))
        };
        let (one, three) = (with(1), with(3));
        assert_eq!(one.radiance, three.radiance);
        assert_eq!(one.coordinates, three.coordinates);
        // What a study keeps and reads again is the same to the last bit.
        let text = serde_json::to_string(&one).unwrap();
        assert_eq!(serde_json::from_str::<Measurement>(&text).unwrap(), one);
    }
}

#[test]
fn a_study_in_small() {
    let scene = room("", 4);
    let options = Options::new(vec![500, 2_000, 16_000], vec![1, 2]).unwrap();
    let photons = std::sync::atomic::AtomicU64::new(0);
    let count = |n| {
        photons.fetch_add(n, std::sync::atomic::Ordering::Relaxed);
    };
    let tasks = options.tasks();
    let of = |task: &Task| measure(&scene, task, clock, &AtomicBool::new(false), &count).unwrap();
    let mut measurements: Vec<Measurement> = tasks.iter().map(of).collect();
    let found = RoomStudy::new(&scene, &options, &measurements).unwrap();
    assert_eq!(photons.into_inner(), options.photons());
    assert_eq!(options.photons(), 6 * 18_500);
    assert!(found.is_closed());
    assert_eq!(found.deviations().len(), SEQUENCES.len() * 3);
    assert_eq!(found.between().len(), 10);
    for d in found.deviations() {
        assert!(d.value.mean > 0.0 && d.value.mean < 0.3, "{d:?}");
        assert_eq!(d.value.spread.is_some(), d.sequences[0] == 0);
        assert!(d.sequences[0] == d.sequences[1] && d.photons[0] < d.photons[1], "{d:?}");
    }
    let rows = found.rows();
    assert_eq!(rows.len(), SEQUENCES.len() * 3);
    for row in &rows {
        assert_eq!(row.coordinates, 12.0);
        // Error falls, and a low-discrepancy sequence has the smaller one.
        assert!(row.ratio_equal_n >= 1.0 || row.photons == 500, "{row:?}");
    }
    // Finished measurements in any order make the same study.
    measurements.reverse();
    assert_eq!(RoomStudy::new(&scene, &options, &measurements).unwrap(), found);
    measurements.pop();
    assert!(RoomStudy::new(&scene, &options, &measurements).is_err());

    let csv = report::csv(&found);
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(
        lines[0],
        "variant,photons,cells,relative_rms,nrms,relative_l1,nrms_spread,photons_per_s,coordinates,rate,ratio_equal_n,ratio_equal_time"
    );
    assert_eq!(lines.len(), 1 + rows.len());
    for (line, row) in lines[1..].iter().zip(&rows) {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), 12);
        assert_eq!((fields[0], fields[2]), (SEQUENCES[row.sequence].name(), "276"));
        assert_eq!(fields[4].parse::<f64>().unwrap(), row.errors.nrms);
        assert_eq!(fields[6].is_empty(), row.sequence != 0);
    }
    let deviations = report::deviations_csv(&found);
    assert_eq!(deviations.lines().count(), 1 + 15 + 10);
    assert!(deviations.lines().all(|l| l.split(',').count() == 7));
    let (text, markdown) = (report::text(&found), report::markdown(&found, "caustix compare room.toml"));
    for name in ["random", "Halton", "Faure", "Hammersley", "Sobol'"] {
        assert!(text.contains(name) && markdown.contains(name));
    }
    assert!(text.lines().all(|l| l.chars().count() <= 110), "{text}");
}

#[test]
fn what_a_study_needs_is_asked_for() {
    for (ladder, seeds) in
        [(vec![], vec![1]), (vec![5], vec![1]), (vec![5, 5], vec![1]), (vec![5, 6], vec![])]
    {
        assert!(Options::new(ladder, seeds).is_err());
    }
    assert_eq!(Options::paper_ladder(false), [10_000, 100_000, 1_000_000]);
    assert_eq!(Options::paper_ladder(true)[3..], [10_000_000]);
    let without = sphere("type = \"lambertian\"\nreflectance = 0.5", "");
    let error = measure(&without, &task(Sequence::Sobol, 0, 10), clock, &AtomicBool::new(false), &|_| {})
        .unwrap_err();
    assert!(error.to_string().contains("[compare]"), "{error}");
    let interrupted =
        measure(&room("", 4), &task(Sequence::Sobol, 0, 10), clock, &AtomicBool::new(true), &|_| {});
    assert_eq!(interrupted.unwrap_err().kind(), caustix::error::Kind::Interrupted);
}

#[test]
fn colours_and_compare_are_read() {
    let with = |material: &str, rest: &str| {
        scene(&format!(
            "[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 3]\nflux_lm = 1\n[material.m]\n{material}\n\
             [[surface]]\nname = \"ball\"\ntype = \"sphere\"\nmaterial = \"m\"\ncenter = [0, 0, 0]\nradius = 1\n{rest}"
        ))
    };
    let d = with("type = \"lambertian\"\nreflectance = [0.25, 0.5, 1]", "[compare]\nreflections = 0");
    let wall = Lambertian::new(Reflectance::rgb([0.25, 0.5, 1.0]).unwrap());
    assert!(matches!(d.materials()[0], Material::Lambertian(l) if l == wall));
    assert_eq!(d.compared_reflections, Some(0));
    let d = with("type = \"mirror\"\nreflectance = [1, 0.5, 0]", "");
    let mirror = Mirror::new(Reflectance::rgb([1.0, 0.5, 0.0]).unwrap());
    assert!(matches!(d.materials()[0], Material::Mirror(m) if m == mirror));
    assert_eq!(d.compared_reflections, None);
}
