//! Spots of which centroid, radii and encircled flux are known: a disc of light, a paraboloid's focus, a ball lens.

use std::f64::consts::{FRAC_PI_4, PI, SQRT_2};

use caustix::estimate::spot::{Diameter, Figure};
use caustix::report::json::json;
use caustix::report::spot::{SpotFigures, SpotStatistics};
use caustix::report::statistics::ReceiverStatistics;
use caustix::scene::Scene;
use caustix::sequence::Sequence;
use rayon::prelude::*;

use crate::support::judge::student_p;
use crate::support::scenes::{run, scene, try_scene};

/// A collimated beam straight down, a disc of this radius about `centre`; and more of the scene.
fn beam(centre: [f64; 3], radius: f64, more: &str) -> String {
    format!(
        r#"
[[emitter]]
type = "collimated"
position = {centre:?}
radius = {radius}
flux_lm = 100
[material.black]
type = "absorber"
{more}"#
    )
}

/// A black rectangle whose spot is measured.
fn rectangle(corner: [f64; 3], u: [f64; 3], v: [f64; 3], keys: &str) -> String {
    format!(
        r#"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = {corner:?}
edge_u = {u:?}
edge_v = {v:?}
[[receiver]]
surface = "plate"
cells = [32, 32]
spot = true
{keys}"#
    )
}

fn spot(scene: &Scene, sequence: Sequence, photons: (u64, u32), seed: u64) -> SpotStatistics {
    let outcome = run(scene, sequence, photons.0, photons.1, seed);
    ReceiverStatistics::new(&outcome, &scene.receivers[0], 0).spot.unwrap()
}

fn figures(scene: &Scene, replicates: u32) -> SpotFigures {
    spot(scene, Sequence::SobolOwen, (1 << 15, replicates), 5).figures.unwrap()
}

const REPLICATES: u32 = 32;

/// Within the two-sided 99.9 % of Student's t, of an error that is small.
fn assert_figure(figure: &Figure, exact: f64, most: f64) {
    let error = figure.standard_error.unwrap();
    let p = student_p((figure.value - exact) / error, REPLICATES - 1);
    assert!(p > 1e-3 && error > 0.0 && error < most, "{exact}: {figure:?}");
}

/// The exact one lies in the interval, which is this narrow.
fn assert_diameter(d: &Diameter, exact: f64, widest: f64) {
    let (low, high) = (d.low.unwrap(), d.high.unwrap());
    assert!(low <= exact && exact <= high && high - low < widest, "{exact}: {d:?}");
    assert!(low <= d.by_cells[0] && d.by_cells[1] <= high && d.standard_error.unwrap() > 0.0, "{d:?}");
    assert!(d.by_cells[0] <= d.value && d.value <= d.by_cells[1], "{d:?}");
}

/// Share of a beam of radius R within r is (r / R)^2.
#[test]
fn a_uniform_disc_has_its_radii() {
    const R: f64 = 0.2;
    let plate = rectangle([-0.4, -0.3, 0.0], [1.0, 0.0, 0.0], [0.0, 0.8, 0.0], "spot_at = [0.45, 0.4]\n");
    let of = figures(&scene(&beam([0.05, 0.1, 1.0], R, &plate)), REPLICATES);
    assert_figure(&of.centroid_m[0], 0.45, 1e-4);
    assert_figure(&of.centroid_m[1], 0.4, 1e-4);
    assert_figure(&of.centroid_xyz_m[0], 0.05, 1e-4);
    assert_figure(&of.centroid_xyz_m[1], 0.1, 1e-4);
    assert_eq!(of.centroid_xyz_m[2], Figure { value: 0.0, standard_error: Some(0.0) });
    assert_figure(&of.rms_radius_m, R / SQRT_2, 1e-4);
    of.rms_m.iter().for_each(|rms| assert_figure(rms, 0.5 * R, 1e-4));
    assert_diameter(&of.d50_m, R * SQRT_2, 0.004);
    assert_diameter(&of.d86_m, 2.0 * R * (1.0 - (-2.0f64).exp()).sqrt(), 0.004);
    // A uniform disc is exact in fine cells but for its rim.
    assert!((of.d50_m.value / (R * SQRT_2) - 1.0).abs() < 1e-3, "{:?}", of.d50_m);
    for point in &of.encircled {
        let exact = (point.radius_m / R).powi(2).min(1.0);
        let error = point.share.standard_error.unwrap();
        let [low, high] = point.by_cells;
        assert!(low - 4.0 * error <= exact && exact <= high + 4.0 * error, "{exact}: {point:?}");
        assert!(error < 1e-3 && low <= point.share.value && point.share.value <= high, "{point:?}");
    }
    assert_eq!(of.edge_share, 0.0);
    // 100 lm on pi R^2. Sections go through the cell of the point, 31 mm x 25 mm wide.
    let lux = 100.0 / (PI * R * R);
    let peak = of.peak.illuminance_lx.unwrap();
    assert!(peak.low <= lux && lux <= peak.high && peak.high < 1.1 * lux, "{lux}: {peak:?}");
    assert!((of.sections_at_m[0] - 14.5 / 32.0).abs() < 1e-12, "{:?}", of.sections_at_m);
    assert!((of.sections_at_m[1] - 0.8 * 16.5 / 32.0).abs() < 1e-12, "{:?}", of.sections_at_m);
    for (section, (side, middle)) in of.sections.iter().zip([(1.0, 0.45), (0.8, 0.4)]) {
        assert_eq!(section.len(), 32);
        for cell in section {
            let (from, half) = ((cell.along_m - middle).abs(), side / 64.0);
            let error = cell.standard_error_lx.unwrap();
            if from + half < 0.19 {
                assert!((cell.lx - lux).abs() < 4.5 * error && error < 0.02 * lux, "{lux}: {cell:?}");
            } else if from - half > 0.2 {
                assert_eq!((cell.lx, cell.hits), (0.0, 0));
            }
        }
    }
}

/// On a rectangle inclined by 35 degrees about y, off the beam's axis, the disc is an ellipse: 1 / cos wider along u.
#[test]
fn an_inclined_rectangle_off_the_axis_has_an_ellipse() {
    const R: f64 = 0.1;
    let (sine, cosine) = 35f64.to_radians().sin_cos();
    let plate = rectangle([2.0, -3.0, 1.0], [0.9 * cosine, 0.0, 0.9 * sine], [0.0, 0.7, 0.0], "");
    let (x, y) = (2.3, -2.75);
    let of = figures(&scene(&beam([x, y, 3.0], R, &plate)), REPLICATES);
    let u = (x - 2.0) / cosine;
    for (figure, exact) in of.centroid_m.iter().zip([u, 0.25]) {
        assert_figure(figure, exact, 1e-4);
    }
    for (figure, exact) in of.centroid_xyz_m.iter().zip([x, y, 1.0 + u * sine]) {
        assert_figure(figure, exact, 1e-4);
    }
    let [along, across] = [0.5 * R / cosine, 0.5 * R];
    assert_figure(&of.rms_m[0], along, 1e-4);
    assert_figure(&of.rms_m[1], across, 1e-4);
    assert_figure(&of.rms_radius_m, along.hypot(across), 1e-4);
    assert!((of.peak.at_xyz_m[2] - 1.0 - of.peak.at_m[0] * sine).abs() < 1e-12);
}

/// Light along the axis goes through the focus: all of it in one place, which lies on an edge between fine cells.
#[test]
fn a_paraboloid_has_its_spot_at_the_focus() {
    let mirror = r#"
[material.silver]
type = "mirror"
reflectance = 1.0
[[surface]]
name = "dish"
type = "paraboloid"
material = "silver"
vertex = [0.2, 0.1, 0.0]
axis = [0.0, 0.0, 1.0]
focal_length = 0.5
radius = 0.4
"#;
    // Facing down; u along y, v along x.
    let plate = rectangle([0.17, 0.05, 0.5], [0.0, 0.1, 0.0], [0.08, 0.0, 0.0], "");
    let scene = scene(&beam([0.2, 0.1, 2.0], 0.35, &(mirror.to_owned() + &plate)));
    let of = figures(&scene, REPLICATES);
    for (figure, exact) in of.centroid_m.iter().zip([0.05, 0.03]) {
        assert!((figure.value - exact).abs() < 1e-10, "{exact}: {figure:?}");
        assert!(figure.standard_error.is_some_and(|e| e > 0.0 && e < 1e-10), "{figure:?}");
    }
    assert!(of.rms_radius_m.value < 1e-10, "{:?}", of.rms_radius_m);
    let cell = 0.1 / 1024.0;
    for d in [&of.d50_m, &of.d86_m] {
        assert_eq!((d.low, d.by_cells[0]), (Some(0.0), 0.0));
        assert!(d.standard_error.is_some() && d.value < 2.5 * cell && d.high.unwrap() < 4.5 * cell, "{d:?}");
    }
    let said = spot(&scene, Sequence::SobolOwen, (1 << 10, 8), 1).warnings("plate");
    assert!(said[0].code == "spot-coarse" && said[0].message.contains("1024 x 819 fine cells"), "{said:?}");
}

/// Where a ray goes that meets a ball of radius 1 and index 1.5 at this height: after every number of reflections inside, the
/// distance from the axis at the plane, and what is left of the light (unpolarised at every face).
fn through_ball(height: f64, plane_z: f64) -> Vec<(f64, f64)> {
    const N: f64 = 1.5;
    let fresnel = |outside: f64| {
        let inside = (outside.sin() / N).asin();
        let (co, ci) = (outside.cos(), inside.cos());
        let (s, p) = ((co - N * ci) / (co + N * ci), (ci - N * co) / (ci + N * co));
        0.5 * (s * s + p * p)
    };
    let outside = height.asin();
    let (inside, lost) = ((height / N).asin(), fresnel(outside));
    // Polar angles in the plane of the ray, 0 up: each chord turns the place on the ball by pi - 2 inside.
    let mut place = outside;
    let mut left = 1.0 - lost;
    let mut all = Vec::new();
    for _ in 0..40 {
        place += PI - 2.0 * inside;
        // It leaves at `outside` to the normal, on the side to which it turns.
        let direction = place + outside;
        let (x, z) = (place.sin(), place.cos());
        let way = (plane_z - z) / direction.cos();
        if direction.cos() < 0.0 && way > 0.0 {
            all.push(((x + way * direction.sin()).abs(), left * (1.0 - lost)));
        }
        left *= lost;
    }
    all
}

/// The part of a circle about the middle of a square of side 2 a that lies in it.
fn part_in_square(radius: f64, a: f64) -> f64 {
    if radius <= a { 1.0 } else { (1.0 - (a / radius).acos() / FRAC_PI_4).max(0.0) }
}

#[test]
fn a_ball_lens_encircles_what_quadrature_says() {
    const PLANE: f64 = -1.45;
    const A: f64 = 0.5;
    let lens = r#"
[material.glass]
type = "dielectric"
ior = 1.5
[[surface]]
name = "ball"
type = "sphere"
material = "glass"
center = [0, 0, 0]
radius = 1
"#;
    let plate = rectangle([-A, -A, PLANE], [2.0 * A, 0.0, 0.0], [0.0, 2.0 * A, 0.0], "");
    let of = figures(&scene(&beam([0.0, 0.0, 2.0], 0.6, &(lens.to_owned() + &plate))), REPLICATES);
    // Rings of the beam of equal flux, each by its middle.
    const RINGS: usize = 1 << 18;
    let mut rays: Vec<(f64, f64)> = (0..RINGS)
        .flat_map(|i| through_ball(0.6 * ((i as f64 + 0.5) / RINGS as f64).sqrt(), PLANE))
        .map(|(distance, light)| (distance, light * part_in_square(distance, A)))
        .collect();
    rays.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = rays.iter().map(|ray| ray.1).sum();
    let mut sum = 0.0;
    let within: Vec<f64> = rays
        .iter()
        .map(|ray| {
            sum += ray.1;
            sum / total
        })
        .collect();
    let share = |radius: f64| match rays.partition_point(|ray| ray.0 <= radius) {
        0 => 0.0,
        n => within[n - 1],
    };
    let radius = |share: f64| rays[within.partition_point(|s| *s < share)].0;
    let mut nearest = 0;
    for point in &of.encircled {
        // A circle beyond the square has rings that the corners alone catch: these are counted alike.
        let (exact, error) = (share(point.radius_m), point.share.standard_error.unwrap());
        let [low, high] = point.by_cells;
        assert!(low - 4.0 * error <= exact && exact <= high + 4.0 * error, "{exact}: {point:?}");
        nearest += usize::from((point.share.value - exact).abs() < 4.0 * error + 1e-3);
    }
    assert!(nearest * 10 >= of.encircled.len() * 9, "{nearest} of {}", of.encircled.len());
    println!("{:?} {:?}", of.d50_m, of.d86_m);
    assert_diameter(&of.d50_m, 2.0 * radius(0.5), 0.01);
    assert_diameter(&of.d86_m, 2.0 * radius(1.0 - (-2.0f64).exp()), 0.01);
    let square: f64 = rays.iter().filter(|ray| ray.0 <= A).map(|ray| ray.1 * ray.0 * ray.0).sum();
    let in_circle: f64 = rays.iter().filter(|ray| ray.0 <= A).map(|ray| ray.1).sum();
    // What falls into the corners is little, and between A and A sqrt 2 from the axis.
    let corners = total - in_circle;
    let [least, most] = [A * A, 2.0 * A * A].map(|r2| ((square + corners * r2) / total).sqrt());
    let Figure { value, standard_error } = of.rms_radius_m;
    let error = 4.0 * standard_error.unwrap();
    assert!(least - error <= value && value <= most + error && error < 1e-3, "{least} {most}: {value}");
}

/// How often 95 % intervals hold the exact value, of a disc of light on a strip (few fine cells: the test is quick).
#[test]
fn intervals_of_a_spot_hold_the_exact_values_95_percent_of_the_time() {
    const SEEDS: u64 = 400;
    const R: f64 = 0.04;
    let t = caustix::estimate::extremes::student(7);
    let plate = rectangle([-0.8, -0.05, 0.0], [1.6, 0.0, 0.0], [0.0, 0.1, 0.0], "");
    let scene = scene(&beam([0.1, 0.005, 1.0], R, &plate));
    for sequence in [Sequence::Independent, Sequence::SobolOwen] {
        let covered = |seed: u64| {
            let of = spot(&scene, sequence, (512, 8), 9000 + seed).figures.unwrap();
            let is_in = |value: f64, error: Option<f64>, exact: f64| {
                u64::from((value - exact).abs() <= t * error.unwrap())
            };
            let of_figure = |figure: &Figure, exact| is_in(figure.value, figure.standard_error, exact);
            let (d50, d86) = (R * SQRT_2, 2.0 * R * (1.0 - (-2.0f64).exp()).sqrt());
            let holds = |d: &Diameter, exact| u64::from((d.low.unwrap()..=d.high.unwrap()).contains(&exact));
            [
                of_figure(&of.centroid_m[0], 0.9),
                of_figure(&of.rms_radius_m, R / SQRT_2),
                is_in(of.d50_m.value, of.d50_m.standard_error, d50),
                is_in(of.d86_m.value, of.d86_m.standard_error, d86),
                holds(&of.d50_m, d50),
                holds(&of.d86_m, d86),
            ]
        };
        let each: Vec<[u64; 6]> = (0..SEEDS).into_par_iter().map(covered).collect();
        let share = |i: usize| each.iter().map(|hits| hits[i]).sum::<u64>() as f64 / SEEDS as f64;
        let shares: [f64; 6] = std::array::from_fn(share);
        println!("{sequence:?}: {shares:?}");
        assert!(shares[..4].iter().all(|share| (share - 0.95).abs() < 0.03), "{sequence:?}: {shares:?}");
        // With the cells in them they hold it at least as often.
        assert!(shares[4..].iter().all(|share| *share > 0.95), "{sequence:?}: {shares:?}");
    }
}

#[test]
fn spots_have_the_same_bits_with_any_number_of_threads() {
    let plate = rectangle([-0.4, -0.3, 0.0], [1.0, 0.0, 0.0], [0.0, 0.8, 0.0], "");
    let scene = scene(&beam([0.05, 0.1, 1.0], 0.2, &plate));
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let spot = spot(&scene, Sequence::SobolOwen, (1 << 12, 8), 3);
            let encircled = format!("{:?}", spot.figures.as_ref().unwrap().encircled);
            (json(&spot).unwrap(), encircled)
        })
    };
    let one = of(1);
    assert_eq!(one, of(3));
    assert!(one.0.contains("\"centroid_m\"") && one.0.contains("\"photons\": 32768"), "{}", one.0);
}

#[test]
fn spots_that_are_cut_dark_or_of_few_photons_are_told() {
    let plate = |keys: &str| rectangle([-0.5, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], keys);
    // Wider than the plate: uniform on it, and in the strips of a sixty-fourth what their area is of the whole.
    let cut = spot(&scene(&beam([0.0, 0.0, 1.0], 2.0, &plate(""))), Sequence::SobolOwen, (1 << 14, 8), 1);
    let said = cut.warnings("plate");
    assert_eq!(said.iter().map(|w| w.code).collect::<Vec<_>>(), ["spot-cut"]);
    let strip = 1.0 - (62.0f64 / 64.0).powi(2);
    assert!((said[0].share.unwrap() / strip - 1.0).abs() < 0.03, "{said:?} {strip}");
    let dark = scene(&beam([3.0, 0.0, 1.0], 0.2, &plate("")));
    let few = scene(&beam([0.5, 0.0, 1.0], 0.2, &plate("")));
    for (scene, photons, words) in
        [(&dark, (512, 8), "no light arrives"), (&few, (16, 8), "fewer than 100 say nothing")]
    {
        let spot = spot(scene, Sequence::SobolOwen, photons, 1);
        let reason = spot.reason.as_ref().unwrap();
        assert!(spot.figures.is_none() && reason.contains(words), "{reason}");
        assert_eq!(spot.warnings("plate")[0].code, "spot-absent");
        assert!(spot.text().contains(words) && spot.photons < 100, "{}", spot.text());
    }
    // One replicate: values without errors.
    let one = spot(&few, Sequence::SobolOwen, (1 << 12, 1), 1);
    let of = one.figures.as_ref().unwrap();
    assert!(of.rms_radius_m.standard_error.is_none() && of.d50_m.low.is_none() && of.d50_m.value > 0.0);
    assert!(of.centroid_xyz_m[0].standard_error.is_none() && of.peak.among_m.is_none());
    assert!(of.encircled.iter().all(|point| point.share.standard_error.is_none()));
    assert!(one.text().contains("by cells") && !one.text().contains("NaN"), "{}", one.text());
}

#[test]
fn spots_that_cannot_be_are_refused_where_they_stand() {
    let ball = "[[surface]]\nname = \"ball\"\ntype = \"sphere\"\nmaterial = \"black\"\ncenter = [3, 0, 0]\n\
                radius = 0.5\n";
    let plate = rectangle([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.5, 0.0], "");
    for (keys, words) in [
        ("surface = \"ball\"\nspot = true", "`spot` for receiver \"r\", which is no rectangle"),
        ("surface = \"plate\"\nspot = 1", "true or false"),
        ("surface = \"plate\"\nspot_at = [0.1, 0.1]", "`spot = true`"),
        ("surface = \"plate\"\nspot = false\nspot_at = [0.1, 0.1]", "`spot = true`"),
        ("surface = \"plate\"\nspot = true\nspot_at = [0.1, 0.6]", "[0 to 1, 0 to 0.5]"),
        ("surface = \"plate\"\nspot = true\nspot_at = [-0.1, 0.1]", "0 to the length of its edge"),
        ("surface = \"plate\"\nspot = true\nspot_at = [0.1, 0.1, 0.0]", "2 numbers"),
    ] {
        let text = beam([0.0, 0.0, 1.0], 0.2, &format!("{plate}{ball}[[receiver]]\nname = \"r\"\n{keys}\n"));
        let errors = try_scene(&text).unwrap_err();
        let text = errors.iter().map(|e| format!("{e} {}\n", e.required())).collect::<String>();
        assert!(text.contains(words) && text.contains("test.toml:"), "{keys}: {text}");
    }
}
