//! Far fields: a lamp's own table comes back, through a mirror mirrored; their flux is the counted one; extremes.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use caustix::emitter::{AimFrame, Emitter, Photometric};
use caustix::files::converted::{ExportFormat, photometric_file};
use caustix::files::photometric;
use caustix::photometry::{PhotometricType, Photometry, flux};
use caustix::report::far_field::{FarFieldStatistics, export};
use caustix::run::{Outcome, Plan, Settings, trace};
use caustix::scene::far_field::{FarFieldSpec, Symmetry};
use caustix::scene::{Scene, SceneBuilder};
use glam::{DVec3, dvec3};

#[allow(dead_code)]
#[path = "../../examples/make_lenses.rs"]
mod make_lenses;

use crate::support::data;
use crate::support::judge::student_p;
use crate::support::scenes::{scene, try_scene};

fn run(scene: &Scene, photons: u64, replicates: u32) -> Outcome {
    let settings = Settings { photons: Some(photons), replicates: Some(replicates), ..Settings::default() };
    trace(scene, &Plan::new(&settings).unwrap(), &AtomicBool::new(false), &|_| {}).unwrap()
}

fn down() -> AimFrame {
    AimFrame::new(DVec3::NEG_Z, Some(DVec3::Y)).unwrap()
}

/// A lamp alone, and its far field in its own frame.
fn bare(photometry: &Photometry, spec: FarFieldSpec) -> Scene {
    let lamp = Photometric::new(photometry, DVec3::ZERO, down(), None).unwrap();
    let mut builder = SceneBuilder::new();
    builder.emitter("lamp", Emitter::Photometric(lamp)).far_field(spec);
    builder.build().unwrap()
}

fn spec() -> FarFieldSpec {
    FarFieldSpec::new("far", down()).unwrap()
}

/// The nodes of a table of type C in all planes: gamma, C.
fn own_nodes(photometry: &Photometry) -> (Vec<f64>, Vec<f64>) {
    let grid = photometry.web.full_grid();
    // Angles of the file itself, where they are stored: radians and back would move them by a rounding.
    let gamma = photometry.web.vertical_deg.clone();
    let c: Vec<f64> = grid.azimuth_rad.iter().map(|a| (a.to_degrees() * 1e9).round() / 1e9).collect();
    (gamma, if c.len() == 2 { vec![0.0] } else { c })
}

/// Type C, its planes agreeing at the poles, within angles that a far field can have.
fn is_a_far_field(photometry: &Photometry) -> bool {
    let web = &photometry.web;
    let rows = web.vertical_deg.len();
    let (first, last) = (web.vertical_deg[0], web.vertical_deg[rows - 1]);
    let agree = |row: usize| web.candela.chunks(rows).all(|plane| plane[row] == web.candela[row]);
    web.photometric_type == PhotometricType::C
        && rows >= 2
        && web.horizontal_deg.iter().all(|h| *h >= 0.0)
        && [0.0, 90.0].contains(&first)
        && [90.0, 180.0].contains(&last)
        && (first != 0.0 || agree(0))
        && (last != 180.0 || agree(rows - 1))
}

/// Nodes within the two-sided 99.7 % of Student's t, and all; checks the flux, too.
fn nodes_within(photometry: &Photometry, photons: u64) -> (usize, usize) {
    const REPLICATES: u32 = 32;
    let (gamma, c) = own_nodes(photometry);
    let scene = bare(photometry, spec().with_gamma_deg(&gamma).unwrap().with_c_deg(&c).unwrap());
    let outcome = run(&scene, photons, REPLICATES);
    let s = FarFieldStatistics::new(&scene, &outcome, 0);
    let counted = scene.emitters.flux_lm();
    // A table that begins or ends at 90 degrees has all of its light in it.
    assert!((s.flux_lm + s.outside_lm - counted).abs() < 1e-12 * counted, "{}", photometry.file);
    assert!(s.outside_lm <= 1e-3 * counted, "{}: {} lm", photometry.file, s.outside_lm);
    let bilinear = flux::bilinear_lm(&s.web.full_grid());
    assert!((bilinear - s.flux_lm).abs() < 1e-9 * counted, "{}: {bilinear} {}", photometry.file, s.flux_lm);
    read_back(&scene, &outcome, &s);
    let errors = s.table.standard_error_cd.as_ref().unwrap();
    let planes = s.table.nodes.planes();
    let mut within = 0;
    for (at, (found, error)) in s.table.candela.iter().zip(errors).enumerate() {
        let (g, c) = (s.table.nodes.gamma_deg[at / planes], s.table.nodes.c_deg[at % planes]);
        let exact = photometry.web.intensity_cd(g, c) * photometry.factor();
        assert!(*error > 0.0 && found.is_finite());
        within += usize::from(student_p((found - exact) / error, REPLICATES - 1) >= 0.003);
    }
    (within, errors.len())
}

/// Nodes of the tables that come back.
const MOST_NODES: usize = 10_000;

/// What is written of a far field is read as its table, to the nine digits that a file has.
fn read_back(scene: &Scene, outcome: &Outcome, s: &FarFieldStatistics) {
    let export = export(scene, outcome, &scene.far_fields[0], s).unwrap();
    for format in [ExportFormat::Ies2002, ExportFormat::Ies2019, ExportFormat::Ldt] {
        let written = photometric_file(&export, format).unwrap();
        let read = photometric::parse(&written.bytes, "written").unwrap();
        assert_eq!(read.factor(), 1.0);
        // A beam that is narrow for the file's steps is one thing to tell.
        let is_known = |warning: &&caustix::error::Diagnostic| warning.found().contains("of the trapezoid");
        let others: Vec<_> = read.warnings.iter().filter(|w| !is_known(w)).collect();
        assert!(others.is_empty(), "{format:?}: {others:?}");
        let planes = s.table.nodes.planes();
        for (at, found) in s.table.candela.iter().enumerate() {
            let (g, c) = (s.table.nodes.gamma_deg[at / planes], s.table.nodes.c_deg[at % planes]);
            let again = read.web.intensity_cd(g, c);
            let most = 1e-8 * found + 1e-11 * s.max_candela.value;
            assert!((again - found).abs() <= most, "{format:?}, gamma {g}, C {c}: {again} {found}");
        }
    }
}

fn all_come_back(files: impl Iterator<Item = impl AsRef<Path>>, photons: u64) -> usize {
    let (mut tables, mut within, mut nodes) = (0, 0, 0);
    for path in files {
        let photometry = photometric::read(path).unwrap();
        // Larger ones would take minutes, and are no other case.
        if is_a_far_field(&photometry) && photometry.web.full_grid().intensity_cd.len() < MOST_NODES {
            let (some, all) = nodes_within(&photometry, photons);
            println!("{}: {some} of {all}", photometry.file);
            (tables, within, nodes) = (tables + 1, within + some, nodes + all);
        }
    }
    assert!(within as f64 >= 0.997 * nodes as f64, "{within} of {nodes} nodes in {tables} tables");
    tables
}

#[test]
fn a_lamps_own_table_comes_back_without_bias() {
    let tables = all_come_back(data::own_files().iter(), 1 << 17);
    assert!(tables >= 6, "{tables} tables of type C");
}

#[test]
fn tables_of_real_files_come_back() {
    let Some(files) = data::real_files() else { return };
    let tables = all_come_back(files.iter().take(60), 1 << 15);
    assert!(tables >= 30, "{tables} tables of type C whose planes agree at the poles");
}

/// EULUMDAT, too: files of type C whose planes agree at the poles.
#[test]
fn tables_of_real_eulumdat_files_come_back() {
    let Some(folder) = data::real_folder() else { return };
    let mut files: Vec<_> = ["permissive", "copyleft", "no-licence"]
        .iter()
        .flat_map(|part| std::fs::read_dir(folder.join("ldt").join(part)).unwrap())
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    let tables = all_come_back(files.iter(), 1 << 15);
    assert!(tables >= 10, "{tables} tables whose planes agree at the poles");
}

/// An asymmetric table that is dark beyond 60 degrees: I = 100 + 40 sin V (sin H + 0.5 cos H), H every 30 degrees.
fn asymmetric() -> Photometry {
    let angles = |end: i32, step: usize| (0..=end).step_by(step).collect::<Vec<i32>>();
    let (v, h) = (angles(60, 10), angles(360, 30));
    let text = |list: &[i32]| list.iter().map(i32::to_string).collect::<Vec<_>>().join(" ");
    let value = |h: i32, v: i32| {
        let (h, v) = (f64::from(h % 360).to_radians(), f64::from(v).to_radians());
        format!("{:.6}", 100.0 + 40.0 * v.sin() * (h.sin() + 0.5 * h.cos()))
    };
    let planes: Vec<String> = h
        .iter()
        .map(|&h| {
            v.iter().map(|&v| value(h, v)).chain(["0".into(), "0".into()]).collect::<Vec<_>>().join(" ")
        })
        .collect();
    let file = format!(
        "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {} {} 1 2 0 0 0\n1 1 0\n{} 60.01 90\n{}\n{}\n",
        v.len() + 2,
        h.len(),
        text(&v),
        text(&h),
        planes.join("\n")
    );
    photometric::parse(file.as_bytes(), "asymmetric.ies").unwrap()
}

/// A level mirror turns z round: seen from above with C = 0 towards the same side, C runs the other way.
#[test]
fn a_mirror_mirrors_the_table() {
    let photometry = asymmetric();
    let text = r#"
[[emitter]]
type = "isotropic"
flux_lm = 1
position = [0, 0, 1]
[material.mirror]
type = "mirror"
reflectance = 1.0
[[surface]]
name = "mirror"
type = "rectangle"
material = "mirror"
corner = [-5, -5, 0]
edge_u = [10, 0, 0]
edge_v = [0, 10, 0]
"#;
    // The mirror of the text, the lamp of the table.
    let mirror = scene(text);
    let surface = &mirror.geometry.surfaces()[0];
    let lamp = Photometric::new(&photometry, DVec3::Z, down(), None).unwrap();
    let up = AimFrame::new(DVec3::Z, Some(DVec3::Y)).unwrap();
    let gamma: Vec<f64> = photometry.web.vertical_deg.clone();
    let far =
        FarFieldSpec::new("up", up).unwrap().with_gamma_deg(&gamma).unwrap().with_c_deg(&[30.0]).unwrap();
    let mut builder = SceneBuilder::new();
    builder.emitter("lamp", Emitter::Photometric(lamp)).far_field(far);
    builder.surface("mirror", surface.shape.clone(), mirror.materials()[0].clone());
    let scene = builder.build().unwrap();
    let outcome = run(&scene, 1 << 20, 16);
    let s = FarFieldStatistics::new(&scene, &outcome, 0);
    let (planes, errors) = (s.table.nodes.planes(), s.table.standard_error_cd.as_ref().unwrap());
    let mut beyond = 0;
    for (at, found) in s.table.candela.iter().enumerate().filter(|(at, _)| at / planes < 7) {
        let (g, c) = (s.table.nodes.gamma_deg[at / planes], s.table.nodes.c_deg[at % planes]);
        let exact = photometry.web.intensity_cd(g, 360.0 - c);
        assert!((found - exact).abs() < 0.02 * exact, "gamma {g} C {c}: {found} for {exact}");
        beyond += usize::from((found - exact).abs() > 3.5 * errors[at]);
    }
    assert!(beyond <= 2, "{beyond} of 84 nodes are beyond 3.5 standard errors");
    assert_eq!(outcome.ledger.escaped, outcome.photons);
    assert_eq!(s.efficiency.value, 1.0);
}

/// Tables of types A and B as type C: they agree at directions between the nodes within the error and what the steps cannot
/// follow, of which half the steps leave less.
#[test]
fn other_types_become_type_c() {
    for name in ["headlamp_a.ies", "floodlight_b.ies"] {
        let photometry = photometric::read(data::own_file(name)).unwrap();
        let lamp = Photometric::new(&photometry, DVec3::ZERO, down(), None).unwrap();
        let off = |step: f64| {
            let far = spec().with_gamma_deg(&[step]).unwrap().with_c_deg(&[step]).unwrap();
            let scene = bare(&photometry, far);
            let s = FarFieldStatistics::new(&scene, &run(&scene, 1 << 21, 8), 0);
            let axes = caustix::emitter::grid_axes(PhotometricType::C, down()).unwrap();
            let most = s.max_candela.value;
            let of = |i: u32| {
                // 100 directions, evenly spread over the sphere (golden angle).
                let z = 1.0 - (f64::from(i) + 0.5) / 50.0;
                let c = (137.507_764 * f64::from(i)).rem_euclid(360.0);
                let g = z.acos().to_degrees();
                let local = dvec3(c.to_radians().cos(), c.to_radians().sin(), 0.0) * (1.0 - z * z).sqrt()
                    + DVec3::Z * z;
                let exact = lamp.intensity_cd(axes * local);
                (s.web.intensity_cd(g, c) - exact) / most
            };
            let rms = ((0..100).map(|i| of(i).powi(2)).sum::<f64>() / 100.0).sqrt();
            println!("{name}: {step} degrees, off by {rms:.5} of the maximum, unresolved {:?}", s.unresolved);
            (rms, s.unresolved.unwrap().value)
        };
        let ((wide, wide_unresolved), (fine, fine_unresolved)) = (off(10.0), off(2.5));
        assert!(fine < 0.003, "{name}: {wide} {fine}");
        // The headlamp's beam is narrower than ten degrees; the floodlight needs no finer steps.
        if name == "headlamp_a.ies" {
            assert!(fine < 0.1 * wide && wide > 0.01, "{name}: {wide} {fine}");
            assert!(fine_unresolved < 0.2 * wide_unresolved, "{name}: {wide_unresolved} {fine_unresolved}");
        } else {
            assert!(wide < 0.003 && wide_unresolved < 0.01, "{name}: {wide} {wide_unresolved}");
        }
    }
}

/// 1 cd everywhere: the greatest of 400 noisy values is far more, the maximum that is told is not.
#[test]
fn the_maximum_is_not_the_noise() {
    let text = "[[emitter]]\ntype = \"isotropic\"\nflux_lm = 12.566370614359172\nposition = [0, 0, 0]\n\
                [[far_field]]\nname = \"far\"\naxis = [0, 0, -1]\ngamma_deg = 10\nc_deg = 15\n";
    let scene = scene(text);
    let (mut sum, mut square, mut errors) = (0.0, 0.0, 0.0);
    let seeds = 20;
    for seed in 1..=seeds {
        let mut settings =
            Settings { photons: Some(1 << 14), replicates: Some(8), seed, ..Settings::default() };
        settings.algorithm.sequence = caustix::sequence::Sequence::Independent;
        let plan = Plan::new(&settings).unwrap();
        let outcome = trace(&scene, &plan, &AtomicBool::new(false), &|_| {}).unwrap();
        let s = FarFieldStatistics::new(&scene, &outcome, 0);
        assert!(s.table.candela.iter().copied().fold(0.0, f64::max) > 1.2);
        let (value, error) = (s.max_candela.value, s.max_candela.standard_error.unwrap());
        (sum, square, errors) = (sum + value, square + value * value, errors + error);
    }
    let n = seeds as f64;
    let (mean, error) = (sum / n, errors / n);
    assert!((mean - 1.0).abs() < 4.0 * error / n.sqrt(), "{mean} +- {}", error / n.sqrt());
    // The error is that of a node: neither far less than the spread nor far more.
    let spread = (square / n - mean * mean).sqrt();
    assert!(spread < 1.5 * error && error < 3.0 * spread, "{spread} {error}");
}

/// Batwing at steps of 2 degrees, whose nodes beside the axis are tiny: the maximum is the wings', and angles are given only where
/// noise has not made them. The file's maximum is 1071.9 cd.
#[test]
fn a_noisy_table_tells_no_angle_that_noise_made() {
    let batwing = photometric::read(data::own_file("batwing.ies")).unwrap();
    let exact = caustix::photometry::beam::lobe_angle_deg(&batwing.web, 0.5).unwrap();
    let (mut told, mut unknown) = (0, 0);
    for photons in [1 << 12, 1 << 16, 1 << 21] {
        let far = spec().with_gamma_deg(&[2.0]).unwrap().with_c_deg(&[10.0]).unwrap();
        let scene = bare(&batwing, far);
        let s = FarFieldStatistics::new(&scene, &run(&scene, photons, 8), 0);
        let (max, error) = (s.max_candela.value, s.max_candela.standard_error.unwrap());
        assert!((max - 1071.874).abs() < 4.0 * error, "{photons}: {max} +- {error}");
        match s.beam_angle_deg[0] {
            Some(angle) => {
                assert!((angle.value - exact).abs() < 0.1 * exact, "{photons}: {angle:?} {exact}");
                told += 1;
            }
            None => {
                assert!(s.angles_absent.is_some());
                assert!(s.warnings(&scene.far_fields[0]).iter().any(|w| w.code == "far-field-noise"));
                unknown += 1;
            }
        }
    }
    assert!(told >= 1 && unknown >= 1, "{told} {unknown}");
}

/// The error that is told of a node is about the spread over seeds, averaged nodes with few hits among them; and so is the
/// flux's, where half of the light is outside.
#[test]
fn errors_are_neither_too_small_nor_too_large() {
    let led = photometric::read(data::own_file("led.ies")).unwrap();
    let far = spec().with_gamma_deg(&[5.0]).unwrap().with_symmetry(Symmetry::Rotational);
    let half = FarFieldSpec::new("half", AimFrame::new(DVec3::X, None).unwrap()).unwrap();
    let half = half.with_gamma_deg(&[0.0, 45.0, 90.0]).unwrap().with_c_deg(&[30.0]).unwrap();
    let lamp = Photometric::new(&led, DVec3::ZERO, down(), None).unwrap();
    let mut builder = SceneBuilder::new();
    builder.emitter("lamp", Emitter::Photometric(lamp)).far_field(far).far_field(half);
    let scene = builder.build().unwrap();
    let seeds = 30;
    let rows = 16;
    let (mut values, mut said) = (vec![Vec::new(); rows + 1], vec![0.0; rows + 1]);
    for seed in 1..=seeds {
        let mut settings =
            Settings { photons: Some(1 << 14), replicates: Some(8), seed, ..Settings::default() };
        settings.algorithm.sequence = caustix::sequence::Sequence::Independent;
        let plan = Plan::new(&settings).unwrap();
        let outcome = trace(&scene, &plan, &AtomicBool::new(false), &|_| {}).unwrap();
        let [s, half] = [0, 1].map(|i| FarFieldStatistics::new(&scene, &outcome, i));
        let (planes, errors) = (s.table.nodes.planes(), s.table.standard_error_cd.as_ref().unwrap());
        for row in 0..rows {
            values[row].push(s.table.candela[row * planes]);
            said[row] += errors[row * planes] / seeds as f64;
        }
        values[rows].push(half.flux_lm);
        said[rows] += half.flux_standard_error_lm.unwrap() / seeds as f64;
    }
    for (row, (values, said)) in values.iter().zip(said).enumerate() {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let spread = (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)).sqrt();
        // 30 seeds know a spread to 13 %; the pole's floor of few hits is an upper bound.
        let most = if row == 0 { 3.0 } else { 1.6 };
        assert!(said > 0.6 * spread && said < most * spread, "row {row}: said {said}, spread {spread}");
    }
}

/// A beam has one direction: all of its light is on the nodes there, exactly at a pole, at C = 360 and at gamma = 90 too.
#[test]
fn a_single_direction_is_exact() {
    for (aim, gamma, c) in [
        ("[0, 0, -1]", 0.0, None),
        ("[0, 0, 1]", 180.0, None),
        ("[0, 1, 0]", 90.0, Some(0.0)),
        ("[-1, 0, 0]", 90.0, Some(90.0)),
    ] {
        let text = format!(
            r#"
[[emitter]]
type = "collimated"
flux_lm = 10
position = [0, 0, 0]
aim = {aim}
radius = 0.1
[[far_field]]
name = "beam"
axis = [0, 0, -1]
up = [0, 1, 0]
gamma_deg = 10
c_deg = 30
"#
        );
        let scene = scene(&text);
        let s = FarFieldStatistics::new(&scene, &run(&scene, 1 << 12, 4), 0);
        assert!((s.flux_lm - 10.0).abs() < 1e-12 && s.outside_lm == 0.0, "{aim}");
        assert!((flux::bilinear_lm(&s.web.full_grid()) - 10.0).abs() < 1e-9, "{aim}");
        assert_eq!(s.max_at_deg[0], gamma, "{aim}");
        assert!(c.is_none_or(|c| s.max_at_deg[1] == c), "{aim}: {:?}", s.max_at_deg);
        assert!(s.table.candela.iter().all(|c| *c >= 0.0) && s.nodes_held_at_zero > 100, "{aim}");
        // No steps follow a beam without width.
        assert!(s.unresolved.unwrap().value > 0.3, "{aim}: {:?}", s.unresolved);
        let codes: Vec<_> = s.warnings(&scene.far_fields[0]).iter().map(|w| w.code).collect();
        assert!(codes.contains(&"far-field-steps"), "{aim}: {codes:?}");
    }
}

/// A lamp in a black box: zeros, and no number that is none.
#[test]
fn nothing_gives_zeros_and_says_so() {
    let scene = scene(
        r#"
[[emitter]]
type = "isotropic"
flux_lm = 10
position = [0.5, 0.5, 0.5]
[material.black]
type = "absorber"
[[surface]]
name = "box"
type = "box"
material = "black"
min = [0, 0, 0]
max = [1, 1, 1]
[[far_field]]
name = "dark"
axis = [0, 0, -1]
symmetry = "rotational"
"#,
    );
    let s = FarFieldStatistics::new(&scene, &run(&scene, 1 << 12, 4), 0);
    assert_eq!((s.flux_lm, s.efficiency.value, s.max_candela.value), (0.0, 0.0, 0.0));
    assert_eq!((s.beam_angle_deg, s.field_angle_deg), ([None; 2], [None; 2]));
    assert!(s.table.candela.iter().all(|c| *c == 0.0));
    assert_eq!((s.noise, s.unresolved), (None, None));
    let said = s.warnings(&scene.far_fields[0]);
    assert!(said.iter().any(|w| w.code == "far-field-dark"), "{said:?}");
    assert!(serde_json::to_string(&s).unwrap().contains("\"flux_lm\":0.0"));
}

/// Averaged to a symmetry that it has not: what is averaged away has the size that quadrature says, whatever the noise.
#[test]
fn an_asymmetry_is_measured_whatever_the_noise() {
    let photometry = asymmetric();
    let (gamma, _) = own_nodes(&photometry);
    let of = |symmetry: &str, photons: u64| {
        let symmetry = match symmetry {
            "rotational" => Symmetry::Rotational,
            _ => Symmetry::Bilateral90To270,
        };
        let far = spec().with_gamma_deg(&gamma).unwrap().with_c_deg(&[30.0]).unwrap().with_symmetry(symmetry);
        let scene = bare(&photometry, far);
        let s = FarFieldStatistics::new(&scene, &run(&scene, photons, 8), 0);
        (s.asymmetry.unwrap(), s.warnings(&scene.far_fields[0]).len(), s)
    };
    // By quadrature: the norm of the table less its mean over C, over its own; planes and mirrored planes likewise.
    let value = |g: f64, c: f64| photometry.web.intensity_cd(g, c);
    let (mut all, mut mean_gone, mut mirror_gone) = (0.0, 0.0, 0.0);
    for i in 0..600 {
        let g = 0.1 * (f64::from(i) + 0.5);
        let row: Vec<f64> = (0..360).map(|c| value(g, f64::from(c) + 0.5)).collect();
        let mean = row.iter().sum::<f64>() / 360.0;
        let measure = g.to_radians().sin();
        for c in 0..360 {
            let mirrored = value(g, 180.0 - (f64::from(c) + 0.5));
            all += measure * row[c as usize].powi(2);
            mean_gone += measure * (row[c as usize] - mean).powi(2);
            mirror_gone += measure * (0.5 * (row[c as usize] - mirrored)).powi(2);
        }
    }
    let expected = [mean_gone, mirror_gone].map(|gone: f64| (gone / all).sqrt());
    for (symmetry, expected) in ["rotational", "bilateral 90-270"].into_iter().zip(expected) {
        for photons in [1 << 14, 1 << 19] {
            let (asymmetry, warnings, s) = of(symmetry, photons);
            let error = asymmetry.standard_error.unwrap();
            assert!(
                (asymmetry.value - expected).abs() < 4.0 * error + 0.002,
                "{symmetry}: {asymmetry:?} {expected}"
            );
            assert!(warnings >= 1 && error < 0.05, "{symmetry}: {error}");
            assert!((flux::bilinear_lm(&s.web.full_grid()) - s.flux_lm).abs() < 1e-9 * s.flux_lm);
        }
    }
}

/// Steps that nobody gave: the wide ones for a broad light, narrow ones for a beam; and more photons see more.
#[test]
fn steps_are_chosen_by_what_the_light_shows() {
    let step = |name: &str, photons: u64| {
        let scene = bare(&photometric::read(data::own_file(name)).unwrap(), spec());
        let s = FarFieldStatistics::new(&scene, &run(&scene, photons, 8), 0);
        let (Some(unresolved), Some(noise)) = (s.unresolved, s.noise) else { return s.widest_step_deg };
        let most = 1.5 * noise + 2.0 * unresolved.standard_error.unwrap();
        assert!(unresolved.value <= most, "{name}: {unresolved:?} {noise}");
        s.widest_step_deg
    };
    // Every symmetry finds its planes among those that are chosen.
    for symmetry in [Symmetry::Quadrants, Symmetry::Bilateral0To180, Symmetry::Bilateral90To270] {
        let batwing = photometric::read(data::own_file("batwing.ies")).unwrap();
        let scene = bare(&batwing, spec().with_symmetry(symmetry));
        let outcome = run(&scene, 1 << 12, 4);
        read_back(&scene, &outcome, &FarFieldStatistics::new(&scene, &outcome, 0));
    }
    let (few, many) = (step("spot.ies", 1 << 8), step("spot.ies", 1 << 20));
    assert!(many[0] < few[0] && many[0] <= 1.0, "{few:?} {many:?}");
    assert_eq!(many[1], 30.0, "a beam that is the same all round needs few planes");
}

/// Out of a ball of glass: what comes out of its front is what left it, counted where it crosses, at each crossing.
#[test]
fn light_out_of_a_surface_is_counted_there() {
    let scene = scene(
        r#"
[[emitter]]
type = "collimated"
flux_lm = 10
position = [0, 0, 0.1]
radius = 0.01
[material.glass]
type = "dielectric"
ior = 1.5
[material.black]
type = "absorber"
[[surface]]
name = "ball"
type = "sphere"
material = "glass"
center = [0, 0, 0]
radius = 0.02
[[surface]]
name = "floor"
type = "rectangle"
material = "black"
corner = [-1, -1, -0.1]
edge_u = [2, 0, 0]
edge_v = [0, 2, 0]
[[far_field]]
name = "out"
axis = [0, 0, -1]
surface = "ball"
gamma_deg = 2
c_deg = 30
[[far_field]]
name = "left"
axis = [0, 0, -1]
gamma_deg = 2
c_deg = 30
"#,
    );
    let outcome = run(&scene, 1 << 16, 8);
    let [out, left] = [0, 1].map(|i| FarFieldStatistics::new(&scene, &outcome, i));
    // Fresnel's reflection of the front face, by quadrature over the beam's disc: what gets in comes out (a ball
    // traps nothing that refraction let in).
    let reflected = |sin: f64| {
        let (ci, ct) = ((1.0 - sin * sin).sqrt(), (1.0 - sin * sin / 2.25).sqrt());
        let (s, p) = ((ci - 1.5 * ct) / (ci + 1.5 * ct), (1.5 * ci - ct) / (1.5 * ci + ct));
        0.5 * (s * s + p * p)
    };
    let steps = 2000;
    let in_flux: f64 = (0..steps)
        .map(|i| {
            let part = (f64::from(i) + 0.5) / f64::from(steps);
            (1.0 - reflected(0.5 * part.sqrt())) / f64::from(steps)
        })
        .sum::<f64>()
        * 10.0;
    let error = out.flux_standard_error_lm.unwrap();
    assert!((out.flux_lm - in_flux).abs() < 4.0 * error, "{} +- {error}, {in_flux}", out.flux_lm);
    let escaped = outcome.ledger.escaped as f64 * outcome.photon_lm;
    assert!((left.flux_lm - escaped).abs() < 1e-12 && escaped < 1.5, "{} {escaped}", left.flux_lm);
}

/// As many bits with one thread as with three, and after the same photons in one replicate more or less.
#[test]
fn threads_change_no_bit() {
    let scene = bare(&asymmetric(), spec().with_c_deg(&[30.0]).unwrap());
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| FarFieldStatistics::new(&scene, &run(&scene, 100_000, 4), 0))
    };
    let (one, three) = (of(1), of(3));
    assert_eq!(one.table.candela, three.table.candela);
    assert_eq!(one.table.standard_error_cd, three.table.standard_error_cd);
}

/// The collimator of scenes/luminaires, of a coarser mesh: half of its maximum at 5 degrees, as it was designed; efficiency by
/// the ledger; and its file, traced over a plane 10 m away, gives what diode and lens give there.
#[test]
fn a_collimator_becomes_a_file_that_gives_its_light() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in make_lenses::files(0.7) {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let text =
        std::fs::read_to_string(data::project().join("scenes/luminaires/tir_collimator.toml")).unwrap();
    let plane = r#"
[[surface]]
name = "wall"
type = "rectangle"
material = "black"
corner = [-1.5, -1.5, 10]
edge_u = [0, 3, 0]
edge_v = [3, 0, 0]
[[receiver]]
surface = "wall"
cells = [15, 15]
"#;
    let lamps = data::project().join("ies/led.ies").display().to_string();
    let text = text.replace("../../ies/led.ies", &lamps) + plane;
    // The wall takes what would leave: the lens's far field is that of its own surface here.
    let text = text.replace("symmetry = \"rotational\"", "symmetry = \"rotational\"\nsurface = \"lens\"");
    let lens = caustix::files::scene_toml::parse_scene(&text, folder.path()).unwrap();
    let by_lens = run(&lens, 1 << 18, 8);
    let s = FarFieldStatistics::new(&lens, &by_lens, 0);
    for angle in s.beam_angle_deg.into_iter().flatten() {
        assert!((angle.value - 10.0).abs() < 0.1, "{angle:?}");
    }
    // Within half of the maximum every node is known to a percent.
    let errors = s.table.standard_error_cd.as_ref().unwrap();
    let planes = s.table.nodes.planes();
    let inside = (0..s.table.candela.len()).filter(|at| s.table.nodes.gamma_deg[at / planes] <= 5.0);
    assert!(inside.into_iter().all(|at| errors[at] < 0.01 * s.table.candela[at]));
    read_back(&lens, &by_lens, &s);
    // What the lens lets out is what does not end in it or on its board, but for what comes back and goes in again.
    let wall = by_lens.receiver_flux_lm(0);
    assert!(s.flux_lm > wall.value && s.asymmetry.unwrap().value < 0.01);
    let written =
        photometric_file(&export(&lens, &by_lens, &lens.far_fields[0], &s).unwrap(), ExportFormat::Ies2002)
            .unwrap();
    std::fs::write(folder.path().join("lens.ies"), &written.bytes).unwrap();
    let text = format!(
        "[material.black]\ntype = \"absorber\"\n[[emitter]]\ntype = \"photometric\"\nfile = \"lens.ies\"\n\
         position = [0, 0, 0]\naim = [0, 0, 1]\nup = [1, 0, 0]\n{plane}"
    );
    let lamp = caustix::files::scene_toml::parse_scene(&text, folder.path()).unwrap();
    let by_file = run(&lamp, 1 << 18, 8);
    // Of the maximum: the steps' 0.3 % and the noise of both; the lens is 2 cm wide, its light 1.7 m.
    let (mut most, mut rms) = (0.0f64, 0.0);
    for cell in 0..225 {
        let area = lens.receivers[0].area_m2(cell);
        let [a, b] = [&by_lens, &by_file].map(|outcome| outcome.illuminance_lx(0, cell, area).value);
        (most, rms) = (most.max(a), rms + (a - b) * (a - b) / 225.0);
    }
    assert!(rms.sqrt() < 0.006 * most, "{} of {most} lx", rms.sqrt());
}

#[test]
fn what_cannot_be_is_refused_in_words() {
    let with = |keys: &str| {
        let text = format!(
            "[[emitter]]\ntype = \"isotropic\"\nflux_lm = 1\nposition = [0, 0, 0]\n[[far_field]]\nname = \"far\"\n{keys}\n"
        );
        try_scene(&text)
            .map(|_| ())
            .unwrap_err()
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join("\n")
    };
    for (keys, words) in [
        ("axis = [0, 0, -1]\nc_deg = 7", "c_deg = 7; required: a step from 0.01 that divides 360 degrees"),
        (
            "axis = [0, 0, -1]\ngamma_deg = [0, 30]",
            "gamma_deg = [0, 30]; required: a step from 0.01 that divides 90 degrees",
        ),
        ("axis = [0, 0, -1]\nc_deg = [0, 45, 90, 135, 180]", "no 180 degrees without a plane"),
        ("axis = [0, 0, -1]\ngamma_deg = 0.005", "a step from 0.01"),
        ("axis = [0, 0, -1]\ngamma_deg = \"1\"", "write it without quotes: 1"),
        ("axis = [0, 0, 0]", "axis = [0, 0, 0]; required: a direction [x, y, z] that is not zero"),
        ("axis = [0, 0, 1]\nup = [0, 0, 2]", "not parallel to axis"),
        ("", "without `axis`"),
        (
            "axis = [0, 0, 1]\nsymmetry = \"round\"",
            "symmetry = \"round\"; required: none, rotational, quadrants",
        ),
        ("axis = [0, 0, 1]\nsurface = \"lens\"", "the unknown surface `lens`"),
        (
            "axis = [0, 0, 1]\nsymmetry = \"quadrants\"\nc_deg = 72",
            "symmetry = \"quadrants\" with these `c_deg`",
        ),
        (
            "axis = [0, 0, 1]\n[[receiver]]\nname = \"FAR\"\nsurface = \"floor\"",
            "the unknown surface `floor`",
        ),
    ] {
        let said = with(keys);
        assert!(said.contains(words), "{keys}\n{said}");
    }
}
