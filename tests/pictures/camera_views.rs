//! What a camera sees where a closed form says it, at the extremes, and the same for any number of threads and passes.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};

use caustix::error::Kind;
use caustix::geometry::Whereabouts;
use caustix::picture::camera::{Film, Pass, Sums, View, render};
use caustix::scene::Scene;
use caustix::scene::camera::{CameraSpec, Filter};
use caustix::sequence::Points;
use caustix::sequence::owen::OwenPoints;
use caustix::sequence::to_unit_f64;
use glam::DVec3;

use crate::one_pixel::*;

fn scene(parts: &[String]) -> Scene {
    crate::support::scenes::scene(&(MATERIALS.to_string() + &parts.concat()))
}

/// A cube of 2 m with a panel of luminance 1 just before each wall.
fn enclosure() -> Scene {
    let mut parts = Vec::new();
    let (side, near) = (2.0, 1.0 - 1e-5);
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let along = |x: f64| {
                let mut v = [0.0; 3];
                v[axis] = x;
                v
            };
            let (mut u, mut v) = ([0.0; 3], [0.0; 3]);
            u[(axis + 1) % 3] = 1.0;
            v[(axis + 2) % 3] = -sign;
            parts.push(plate(&format!("wall {axis} {sign}"), "grey", along(sign), u, v));
            parts.push(panel(along(sign * near), along(-sign), side, PI * side * side));
        }
    }
    scene(&parts)
}

#[test]
fn in_a_closed_enclosure_luminance_is_le_over_1_minus_a_everywhere() {
    let scene = enclosure();
    for (k, (position, look_at)) in [
        ([0.0, 0.0, 0.0], [1.0, 0.1, 0.2]),
        ([-0.9, 0.5, 0.3], [1.0, -0.2, -0.1]),
        ([0.5, 0.5, 0.9], [0.45, 0.4, 1.0]),
        ([0.9, -0.9, -0.9], [-0.5, 0.4, 1.0]),
    ]
    .into_iter()
    .enumerate()
    {
        let seen = pixel(&scene, &narrow(position, look_at), 13, 0.25);
        // Emitters themselves, one reflection, two and more.
        assert_close(&format!("view {k}: emission"), seen.emission, 1.0, 1e-9);
        assert_close(&format!("view {k}: direct"), seen.direct, 0.5, 0.02);
        assert_close(&format!("view {k}: diffuse"), seen.diffuse, 0.5, 0.05);
        assert_close(&format!("view {k}: all"), seen.all, 2.0, 0.03);
        assert_none("no caustic", seen.caustic);
    }
}

#[test]
fn a_point_below_the_corner_of_a_square_light_has_the_form_factor_0_138532() {
    // Luminance 1 at 1 m: E = pi F.
    let text = [panel([0.5, 0.5, 1.0], [0.0, 0.0, -1.0], 1.0, PI), floor("plate", "white", [0.0; 3], 0.1)];
    let spec = CameraSpec { samples: 1024, ..narrow([0.3, -0.5, 0.3], [0.0; 3]) };
    let seen = pixel(&scene(&text), &spec, 4, 0.1);
    assert_close("corner", seen.direct, 0.8 * 0.138_532, 0.01);
}

#[test]
fn a_plate_below_a_round_light_has_the_form_factor_of_the_disc_near_and_far() {
    // Luminance 1, radius 0.5. The plate looks up, h below and r off the axis; in radii below.
    for (i, (h, r)) in [(1.0, 0.0), (0.2, 0.3), (0.1, 0.7), (0.45, 0.45), (3.0, 1.0)].into_iter().enumerate()
    {
        let text = [
            format!(
                "[[emitter]]\ntype = \"disc\"\nposition = [0, 0, {h}]\nradius = 0.5\nflux_lm = {}\n",
                PI * PI * 0.25
            ),
            floor("plate", "white", [r, 0.0, 0.0], 0.1),
        ];
        // A pixel so small that the light is the same all over it.
        let spec = CameraSpec { samples: 1024, fov_deg: 0.01, ..narrow([r + 3.0, 0.0, 2.5], [r, 0.0, 0.0]) };
        let seen = pixel(&scene(&text), &spec, 4, 0.1);
        let (h2, r2) = (4.0 * h * h, 4.0 * r * r);
        let sum = 1.0 + h2 + r2;
        let exact = 0.5 * (1.0 - (sum - 2.0) / (sum * sum - 4.0 * r2).sqrt());
        assert_close(&format!("disc {i}"), seen.direct, 0.8 * exact, 0.03);
        let light = pixel(&scene(&text), &narrow([r, 0.0, 0.05], [0.1, 0.2, h]), 4, 0.1);
        assert_close(&format!("disc {i} itself"), light.emission, 1.0, 1e-12);
    }
}

#[test]
fn a_lit_plate_is_as_bright_directly_by_mirror_and_less_fresnel_through_a_pane() {
    let parts = [
        beam([0.0, 0.0, -3.0], [0.0, 0.0, 1.0], 0.5, 100.0),
        ceiling("plate", "white", [0.0; 3], 0.6),
        plate("mirror", "silver", [2.0, 0.0, -1.0], [0.0, 0.0, 0.9], [0.0, 0.9, 0.0]),
    ];
    let lit = 100.0 / (PI * 0.25) * 0.8 / PI;
    let scene = scene(&parts);
    let direct = pixel(&scene, &narrow([1.0, 0.0, -1.0], [0.0; 3]), 4, 0.1);
    assert_close("directly", direct.direct, lit, 1e-9);
    let mirrored = pixel(&scene, &narrow([1.0, 0.0, -1.0], [4.0, 0.0, 0.0]), 4, 0.1);
    assert_close("by mirror", mirrored.direct, 0.9 * lit, 1e-9);
    // A pane stands between.
    let text =
        [parts[0].clone(), parts[1].clone(), cuboid("pane", "glass", [0.8, -0.5, -1.0], [0.9, 0.5, 0.5])];
    let through = crate::support::scenes::scene(&(MATERIALS.to_string() + &text.concat()));
    let spec = CameraSpec { samples: 4096, ..narrow([1.6, 0.0, -0.4], [0.0; 3]) };
    // Faces at x = 0.8 and 0.9: incidence by the direction's x.
    let cos_i: f64 = 1.6 / (1.6f64.powi(2) + 0.4f64.powi(2)).sqrt();
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / 2.25).sqrt();
    let s = ((cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t)).powi(2);
    let p = ((1.5 * cos_i - cos_t) / (1.5 * cos_i + cos_t)).powi(2);
    let r = 0.5 * (s + p);
    let seen = pixel(&through, &spec, 4, 0.1);
    assert_close("through a pane", seen.direct, lit * (1.0 - r) / (1.0 + r), 0.01);
}

#[test]
fn inside_glass_luminance_is_greater_by_the_square_of_the_index() {
    // At right angles to two faces of a block: n^2 (1 - R) (1 + R^2 + R^4 + ...) = n^2 / (1 + R).
    let text = [
        panel([0.0, 0.0, 2.0], [0.0, 0.0, -1.0], 2.0, 4.0 * PI),
        cuboid("block", "glass", [-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]),
    ];
    let spec = CameraSpec { samples: 4096, ..narrow([0.1, 0.1, 0.0], [0.1, 0.1, 1.0]) };
    let seen = pixel(&scene(&text), &spec, 4, 0.1);
    assert_close("in glass", seen.all, 2.25 / 1.04, 0.01);
}

/// The mean over a picture's pixels, each a net of its own, and its standard error.
fn mean_emission(scene: &Scene, spec: &CameraSpec) -> Part {
    let film = pass(&View::new(scene, &camera(spec.clone()), 5).unwrap(), &Pass::EMISSION);
    let n = film.value.len() as f64;
    let mean = film.value.iter().map(|v| v[0]).sum::<f64>() / n;
    let spread: f64 = film.value.iter().map(|v| (v[0] - mean).powi(2)).sum();
    Part { value: mean, error: (spread / (n * (n - 1.0))).sqrt() }
}

#[test]
fn paths_beyond_the_free_events_keep_the_mean_of_a_geometric_series() {
    // Between two mirrors of reflectance r a path crosses the panel of luminance 1 at every second event: 1 + r^2 + r^4 + ...
    // Of it the part r^32 lies beyond 32 events: 3 % and 72 %.
    for r in [0.9, 0.99] {
        let text = [
            format!("[material.mirror]\ntype = \"mirror\"\nreflectance = {r:?}\n"),
            panel([0.0, 0.0, 0.5], [0.0, 0.0, -1.0], 20.0, 400.0 * PI),
            floor("below", "mirror", [0.0; 3], 10.0),
            ceiling("above", "mirror", [0.0, 0.0, 1.0], 10.0),
        ];
        let spec = CameraSpec { pixels: [32, 32], ..narrow([0.0, 0.0, 0.25], [0.0, 0.0, 1.0]) };
        let exact = 1.0 / (1.0 - r * r);
        let seen = mean_emission(&scene(&text), &spec);
        assert_close(&format!("mirrors of {r}"), seen, exact, 0.02);
    }
}

#[test]
fn an_eye_in_a_glass_block_sees_what_total_reflection_does_not_catch() {
    // In a room of luminance 1 it sees n^2 in every direction from which light can come in: those within the critical angle of one of
    // the three axes, whatever the number of events. Other paths never leave, and show nothing.
    let mut text = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let at: [f64; 3] = std::array::from_fn(|k| if k == axis { sign } else { 0.0 });
            text.push(panel(at.map(|x| 3.0 * x), at.map(|x| -x), 6.0, 36.0 * PI));
        }
    }
    text.push(cuboid("block", "glass", [-1.0, -0.7, -0.5], [1.0, 0.7, 0.5]));
    let scene = scene(&text);
    let critical = (1.0f64 - 1.0 / 2.25).sqrt();
    let position = DVec3::new(0.2, 0.1, -0.1);
    let picture = |look_at: DVec3, fov_deg: f64| CameraSpec {
        samples: 16,
        ..CameraSpec::pinhole(position, position + look_at, DVec3::Z, fov_deg, [24, 24])
    };
    for (label, look_at) in [
        ("along an axis", DVec3::new(1.0, 0.1, 0.05)),
        ("near the critical angle", DVec3::new(critical + 0.01, 0.47, 0.47)),
    ] {
        assert!(look_at.normalize().x > critical + 0.005);
        assert_close(label, mean_emission(&scene, &picture(look_at, 0.2)), 2.25, 0.02);
    }
    // All of these are caught. `pass` asks that none comes to the guard.
    let caught = mean_emission(&scene, &picture(DVec3::ONE, 10.0));
    assert_none("caught", caught);
}

#[test]
fn a_pixel_on_an_edge_is_half_lit_by_every_filter() {
    let text =
        [panel([0.5, 0.0, 1.0], [0.0, 0.0, -1.0], 1.0, PI), floor("below", "black", [0.0, 0.0, -1.0], 1.0)];
    for filter in [Filter::Box, Filter::Tent, Filter::Gaussian] {
        let spec = CameraSpec { filter, samples: 4096, ..narrow([0.0; 3], [0.0, 0.0, 1.0]) };
        let seen = pixel(&scene(&text), &spec, 4, 0.1);
        assert_close(&format!("{filter:?}"), seen.all, 0.5, 0.02);
    }
}

#[test]
fn a_lens_out_of_focus_blurs_an_edge_by_the_disc_of_confusion() {
    let text =
        [panel([0.5, 0.0, 1.0], [0.0, 0.0, -1.0], 1.0, PI), floor("below", "black", [0.0, 0.0, -1.0], 1.0)];
    // In the plane of the panel the rays fill a disc of half the lens's radius about the pixel's place.
    let (radius, place): (f64, f64) = (0.05, 0.02);
    let x = place / radius;
    let exact = (PI - x.acos() + x * (1.0 - x * x).sqrt()) / PI;
    let spec = CameraSpec {
        lens_radius_m: 2.0 * radius,
        focus_m: 2.0,
        samples: 4096,
        ..narrow([place, 0.0, 0.0], [place, 0.0, 1.0])
    };
    assert_close("out of focus", pixel(&scene(&text), &spec, 4, 0.1).all, exact, 0.02);
    let sharp = CameraSpec { focus_m: 1.0, ..spec };
    assert_close("in focus", pixel(&scene(&text), &sharp, 4, 0.1).all, 1.0, 1e-12);
}

#[test]
fn the_background_is_seen_where_nothing_is_also_by_mirror() {
    let text = [lamp([0.0, 0.0, 5.0], 1.0), floor("mirror", "silver", [0.0; 3], 1.0)];
    let scene = scene(&text);
    let spec = |look_at| CameraSpec { background_cd_m2: [3.0; 3], ..narrow([0.0, 0.0, 1.0], look_at) };
    assert_close("sky", pixel(&scene, &spec([5.0, 0.0, 2.0]), 4, 0.1).all, 3.0, 1e-12);
    assert_close("sky by mirror", pixel(&scene, &spec([0.5, 0.0, 0.0]), 4, 0.1).all, 2.7, 1e-12);
}

#[test]
fn looking_along_a_surface_gives_numbers() {
    let text = [lamp([0.0, 0.0, 1.0], 100.0), floor("plate", "white", [0.0; 3], 1.0)];
    let scene = scene(&text);
    for height in [0.0, 1e-300, 1e-12] {
        // The plate lies in the picture's horizon: rays along it, just above and just below.
        let spec = CameraSpec { pixels: [3, 3], ..narrow([-2.0, 0.0, height], [0.0, 0.0, height]) };
        let film = whole(&scene, &spec, 6);
        assert!(film.value.iter().all(|v| v[0].is_finite() && v[0] >= 0.0), "{film:?}");
        assert!(film.standard_error.iter().chain(&film.bias).all(|e| e.is_finite()));
    }
}

fn whole(scene: &Scene, spec: &CameraSpec, m: u32) -> Film<1> {
    let photon_lm = scene.emitters.flux_lm() / (f64::from(REPLICATES) * (1u64 << m) as f64);
    let maps = photons(scene, 0..REPLICATES, m, 7);
    let densities = maps.each_ref().map(|map| within(&scene.geometry, map, photon_lm, 0.2));
    pass(&View::new(scene, &camera(spec.clone()), 3).unwrap(), &all(&densities, REPLICATES))
}

#[test]
fn no_place_for_a_camera() {
    let text = [
        lamp([0.0, 0.0, 5.0], 100.0),
        floor("plate", "white", [0.0; 3], 1.0),
        "[[surface]]\nname = \"ball\"\ntype = \"sphere\"\nmaterial = \"glass\"\ncenter = [0.0, 0.0, 2.0]\nradius = 0.5\n"
            .to_string(),
    ];
    let scene = scene(&text);
    let on = View::new(&scene, &camera(narrow([0.2, 0.2, 0.0], [0.0, 0.0, 1.0])), 1).unwrap_err();
    assert!(on.kind() == Kind::Geometry && on.to_string().contains("\"plate\""), "{on}");
    let across = CameraSpec { lens_radius_m: 0.1, ..narrow([0.495, 0.0, 2.0], [3.0, 0.0, 2.0]) };
    assert!(View::new(&scene, &camera(across), 1).unwrap_err().to_string().contains("lens"));
    assert!(View::new(&scene, &camera(narrow([0.0, 0.0, 2.0], [0.0, 0.0, 0.0])), 1).is_ok(), "inside glass");
}

/// A room with all that an eye path can meet, and a picture of several tiles.
fn mixed() -> (Scene, CameraSpec) {
    let scene = scene(&[
        panel([0.5, 0.0, 1.9], [0.0, 0.0, -1.0], 0.5, 100.0),
        lamp([-0.5, 0.3, 1.0], 200.0),
        floor("floor", "grey", [0.0; 3], 1.0),
        plate("wall", "white", [-1.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        plate("mirror", "silver", [1.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
        "[[surface]]\nname = \"ball\"\ntype = \"sphere\"\nmaterial = \"glass\"\ncenter = [0.0, 0.0, 0.5]\nradius = 0.3\n"
            .to_string(),
    ]);
    let spec = CameraSpec {
        samples: 8,
        ..CameraSpec::pinhole(DVec3::new(0.0, -3.0, 1.2), DVec3::new(0.0, 0.0, 0.6), DVec3::Z, 45.0, [37, 21])
    };
    (scene, spec)
}

#[test]
fn the_bits_do_not_depend_on_threads() {
    let (scene, spec) = mixed();
    let with = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap()
            .install(|| whole(&scene, &spec, 6))
    };
    let one = with(1);
    assert!(one.value.iter().filter(|v| v[0] > 0.0).count() > 200);
    for threads in [2, 7] {
        let many = with(threads);
        let bits = |film: &Film<1>| {
            let value = film.value.iter().map(|v| v[0]);
            value
                .chain(film.standard_error.iter().copied())
                .chain(film.bias.iter().copied())
                .map(f64::to_bits)
                .collect::<Vec<_>>()
        };
        assert_eq!(bits(&one), bits(&many), "{threads} threads");
    }
}

#[test]
fn passes_add_up_to_the_picture_of_all_photons() {
    let (scene, spec) = mixed();
    let m = 6;
    let photon_lm = scene.emitters.flux_lm() / (f64::from(REPLICATES) * (1u64 << m) as f64);
    let one = whole(&scene, &spec, m);
    let view = View::new(&scene, &camera(spec.clone()), 3).unwrap();
    let mut sums = Sums::<1>::new(spec.pixels).unwrap();
    let mut add = |pass: &Pass<'_, 1>| {
        assert!(render(&view, pass, &mut sums, &AtomicBool::new(false), &|_| {}).unwrap().unseen == 0);
    };
    // Replicates 0 to 4; half of replicate 5's photons and the other half; the rest.
    let density = |map| within(&scene.geometry, map, photon_lm, 0.2);
    let first = photons(&scene, 0..5, m, 7);
    add(&all(&first.each_ref().map(density), 5));
    let fifth = photons(&scene, 5..6, m, 7);
    let [caustic, diffuse] = fifth.each_ref().map(density);
    add(&part(&[caustic], 5..6, false));
    add(&part(&[diffuse], 5..6, true));
    let rest = photons(&scene, 6..REPLICATES, m, 7);
    add(&part(&rest.each_ref().map(density), 6..REPLICATES, true));
    let many = sums.finish();
    assert_eq!(sums.replicates, REPLICATES);
    for k in 0..one.value.len() {
        let (a, b) = (one.value[k][0], many.value[k][0]);
        assert!((a - b).abs() <= 1e-12 * a, "{a} {b}");
        let (a, b) = (one.standard_error[k], many.standard_error[k]);
        // A pass of few photons doubts more than one of all: the error of (photons + 1) is its own.
        assert!(b >= a - 1e-6 * one.value[k][0], "{a} {b}");
    }
}

#[test]
fn one_replicate_or_one_sample_knows_no_error() {
    let (scene, spec) = mixed();
    let spec = CameraSpec { samples: 1, pixels: [2, 2], ..spec };
    let film = pass(&View::new(&scene, &camera(spec.clone()), 3).unwrap(), &all(&[], 0));
    assert!(film.value.iter().all(|v| v[0].is_finite()) && film.standard_error.iter().all(|e| e.is_nan()));
}

#[test]
fn an_interrupted_pass_leaves_what_it_saw_and_says_what_it_did_not_see() {
    let (scene, spec) = mixed();
    let spec = CameraSpec { pixels: [40, 24], ..spec };
    let view = View::new(&scene, &camera(spec.clone()), 3).unwrap();
    let whole = pass(&view, &all(&[], 0));
    let interrupt = AtomicBool::new(false);
    let mut sums = Sums::<1>::new(spec.pixels).unwrap();
    let after_a_tile = |_| interrupt.store(true, Ordering::Relaxed);
    let done = render(&view, &all(&[], 0), &mut sums, &interrupt, &after_a_tile).unwrap();
    let film = sums.finish();
    let unseen: Vec<bool> = film.standard_error.iter().map(|e| e.is_nan()).collect();
    let number = unseen.iter().filter(|u| **u).count();
    assert!(number > 0 && number < 960, "{number}");
    assert_eq!(done.unseen, number as u64);
    for (i, unseen) in unseen.into_iter().enumerate() {
        if unseen {
            assert!(film.value[i] == [0.0] && film.bias[i].is_nan());
        } else {
            assert_eq!((film.value[i], film.standard_error[i]), (whole.value[i], whole.standard_error[i]));
        }
    }
}

#[test]
fn what_stands_between_is_what_the_nearest_hit_says() {
    let (scene, _) = mixed();
    let points = OwenPoints::new(1, 0);
    let (mut yes, mut no) = (0, 0);
    for i in 0..20_000 {
        let u: [f64; 6] = std::array::from_fn(|c| to_unit_f64(points.coordinate(i, c as u32)));
        let [from, to] = [[u[0], u[1], u[2]], [u[3], u[4], u[5]]]
            .map(|[x, y, z]| DVec3::new(3.0 * x - 1.5, 3.0 * y - 1.5, 3.0 * z - 0.5));
        let distance = (to - from).length();
        let direction = (to - from) / distance;
        let at = Whereabouts::start(scene.geometry.all_behind(from));
        let hit = scene.geometry.nearest(from, direction, &at, &mut 0);
        let expected = hit.is_some_and(|hit| hit.t < distance);
        assert_eq!(scene.geometry.occluded(from, direction, distance, &at), expected, "{from} {to}");
        *(if expected { &mut yes } else { &mut no }) += 1;
    }
    assert!(yes > 4000 && no > 4000, "{yes} {no}");
}
