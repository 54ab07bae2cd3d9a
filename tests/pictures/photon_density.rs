//! Density estimation against closed forms: spheres, borders, walls, few photons, neighbours, replicates.

use std::f64::consts::{PI, TAU};

use caustix::geometry::{Hit, Shape, Sphere, SurfaceId, Whereabouts, box_mesh};
use caustix::picture::gather::Gathered;
use caustix::picture::photon_map::PhotonMap;
use caustix::scene::camera::{Bandwidth, Kernel};
use glam::DVec3;

use crate::photons::{
    KERNELS, choice, density_at, density_of, error_and_bias, floor, frame_of, geometry, hit, mean_and_error,
    on_floor, on_the_floor, photon, u,
};
use crate::support::statistics::{sidak, z_test};

#[test]
fn borders_and_corners_of_a_rectangle_are_as_bright_as_its_middle() {
    let scene = geometry(vec![floor()]);
    let frame = frame_of(&scene);
    let places = [(0.5, 0.5), (0.002, 0.5), (0.5, 0.998), (0.003, 0.002), (0.03, 0.9)];
    let bandwidths = [Bandwidth::Radius(0.1), Bandwidth::Nearest(40), Bandwidth::Progressive(0.12)];
    let threshold = sidak(0.01, places.len() * bandwidths.len() * KERNELS.len());
    let (n, repeats) = (2000, 400);
    for kernel in KERNELS {
        for bandwidth in bandwidths {
            let mut values = vec![Vec::new(); places.len()];
            for seed in 0..repeats {
                let map = PhotonMap::build(on_the_floor(&frame, n, seed, 8), frame, 0.1);
                let density = density_of(&scene, &map, 1.0, choice(bandwidth, kernel, 8));
                for (values, &(x, y)) in values.iter_mut().zip(&places) {
                    values.push(density_at(&density, &on_floor(&scene, x, y), 8).0);
                }
            }
            for (values, place) in values.iter().zip(&places) {
                let (mean, error) = mean_and_error(values);
                let z = (mean - n as f64) / error;
                assert!(z_test(z) > threshold, "{kernel:?} {bandwidth:?} {place:?}: {mean} +- {error}");
                assert!(error < 0.03 * mean);
            }
        }
    }
}

#[test]
fn on_a_sphere_a_fixed_radius_is_unbiased_and_k_nearest_are_as_theory_has_it() {
    let radius = 1.5;
    let scene = geometry(vec![Shape::Sphere(Sphere::new(DVec3::ZERO, radius).unwrap())]);
    let frame = frame_of(&scene);
    let area = 4.0 * PI * radius * radius;
    let (n, repeats, k) = (3000u64, 300u64, 20u32);
    let at = |i: u64, seed: u64| {
        let (z, phi) = (2.0 * u(i, 2 * seed) - 1.0, TAU * u(i, 2 * seed + 1));
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z) * radius
    };
    let mut fixed: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    let (mut nearest, mut naive) = (Vec::new(), Vec::new());
    for seed in 0..repeats {
        let photons = (0..n).map(|i| photon(&frame, at(i, seed), 0, 0)).collect();
        let map = PhotonMap::build(photons, frame, 0.2);
        // Far apart, so that the estimates are independent: ball radii are below a quarter.
        for (x, y, z) in
            [(1.0, 0.0, 0.0), (-1.0, 0.2, 0.1), (0.1, -1.0, 0.0), (0.3, 0.2, 1.0), (0.0, 0.3, -1.0)]
        {
            let inside = Whereabouts::start([SurfaceId(0)]);
            let to = DVec3::new(x, y, z).normalize();
            let here = scene.nearest(DVec3::ZERO, to, &inside, &mut 0).unwrap();
            assert!(!here.front);
            let value = |bandwidth, kernel| {
                let density = density_of(&scene, &map, 1.0, choice(bandwidth, kernel, 1));
                let mut sums = Gathered::new(1);
                density.gather(&here, [1.0], |_, _| [1.0], &mut sums);
                sums.value[0] * area / n as f64
            };
            for (kernel, values) in KERNELS.into_iter().zip(&mut fixed) {
                values.push(value(Bandwidth::Radius(0.3), kernel));
            }
            let one = value(Bandwidth::Nearest(k), Kernel::Flat);
            nearest.push(one);
            naive.push(one * f64::from(k) / f64::from(k - 1));
        }
    }
    let threshold = sidak(0.01, 4);
    let check = |values: &[f64], expected: f64, what: &str| {
        let (mean, error) = mean_and_error(values);
        println!("{what}: {mean:.5} +- {error:.5}, expected {expected:.5}");
        assert!(z_test((mean - expected) / error) > threshold, "{what}");
    };
    check(&fixed[0], 1.0, "fixed radius, flat");
    check(&fixed[1], 1.0, "fixed radius, Epanechnikov");
    check(&nearest, 1.0, "(k - 1) / (pi r_k^2)");
    let kf = f64::from(k);
    // r_k^2 of n points on a closed surface is a beta variate: the mean of k / r_k^2 is n k / (k - 1) but for O(1 / n).
    check(&naive, kf / (kf - 1.0), "k / (pi r_k^2)");
    // Relative variance 1 / (k - 2), for a Poisson process; n points fixed lessen it by 1 / n.
    let squares: Vec<f64> = nearest.iter().map(|v| (v - 1.0).powi(2)).collect();
    let (variance, error) = mean_and_error(&squares);
    let expected = 1.0 / (kf - 2.0);
    println!("relative variance of k nearest: {variance:.5} +- {error:.5}, expected {expected:.5}");
    assert!((variance - expected).abs() < 3.0 * error && error < 0.1 * expected);
}

#[test]
fn no_light_comes_through_a_wall_or_round_a_corner() {
    // A slab 2 mm thin with photons on its top, a plate just under it, and photons beside the slab's vertical edge.
    let slab = box_mesh(DVec3::new(0.0, 0.0, 0.1), DVec3::new(1.0, 1.0, 0.102)).unwrap();
    let scene = geometry(vec![Shape::Mesh(slab), floor()]);
    let frame = frame_of(&scene);
    let top = |i: u64| DVec3::new(u(i, 1), u(i, 2), 0.102);
    // Faces of a box: -x, +x, -y, +y, -z, +z, two triangles each; the upper half of +z is face 11.
    let photons = (0..20_000).map(|i| photon(&frame, top(i), if top(i).y > top(i).x { 11 } else { 10 }, 0));
    let map = PhotonMap::build(photons.collect(), frame, 0.05);
    let density = density_of(&scene, &map, 1.0, choice(Bandwidth::Radius(0.05), Kernel::Flat, 1));
    let of = |from: DVec3, to: DVec3| {
        let at = hit(&scene, from, to);
        let mut sums = Gathered::new(1);
        density.gather(&at, [1.0], |_, _| [1.0], &mut sums);
        (sums.value[0], sums.second[0])
    };
    let above = of(DVec3::new(0.4, 0.6, 1.0), DVec3::new(0.4, 0.6, 0.0));
    assert!((above.0 / 20_000.0 - 1.0).abs() < 0.25, "{above:?}");
    // At the slab's rim the top is as bright as elsewhere.
    let rim = of(DVec3::new(0.001, 0.5, 1.0), DVec3::new(0.001, 0.5, 0.0));
    assert!((rim.0 / 20_000.0 - 1.0).abs() < 0.4, "{rim:?}");
    assert_eq!(of(DVec3::new(0.4, 0.6, 0.05), DVec3::new(0.4, 0.6, 1.0)), (0.0, 0.0), "under the slab");
    assert_eq!(of(DVec3::new(-1.0, 0.5, 0.101), DVec3::new(1.0, 0.5, 0.101)), (0.0, 0.0), "its edge");
    assert_eq!(of(DVec3::new(0.4, 0.6, 0.05), DVec3::new(0.4, 0.6, 0.0)), (0.0, 0.0), "the plate under it");

    // One sheet with photons on its front only: what the other side shows of them is the BSDF's to say.
    let sheet = geometry(vec![floor()]);
    let frame = frame_of(&sheet);
    let map = PhotonMap::build(on_the_floor(&frame, 5000, 3, 1), frame, 0.1);
    let density = density_of(&sheet, &map, 1.0, choice(Bandwidth::Radius(0.1), Kernel::default(), 1));
    let below = hit(&sheet, DVec3::new(0.5, 0.5, -0.5), DVec3::new(0.5, 0.5, 0.0));
    assert!(!below.front);
    assert_eq!(density_at(&density, &below, 1).0, 0.0);
    let mut through = Gathered::new(1);
    density.gather(&below, [1.0], |_, front| [if front { 1.0 } else { 0.0 }], &mut through);
    assert!((through.value[0] / 5000.0 - 1.0).abs() < 0.4);
}

#[test]
fn few_photons_give_numbers_with_errors_that_say_so() {
    let scene = geometry(vec![floor()]);
    let frame = frame_of(&scene);
    let here = on_floor(&scene, 0.5, 0.5);
    for bandwidth in
        [Bandwidth::Radius(0.1), Bandwidth::Nearest(50), Bandwidth::Progressive(0.1), Bandwidth::Automatic]
    {
        for n in [0u32, 1, 2, 9] {
            // A little off the middle, in different replicates.
            let near = |i: u32| DVec3::new(0.5 + 0.001 * f64::from(i + 1), 0.5, 0.0);
            let photons = (0..n).map(|i| photon(&frame, near(i), 0, i % 4)).collect();
            let map = PhotonMap::build(photons, frame, 0.1);
            let density = density_of(&scene, &map, 1.0, choice(bandwidth, Kernel::Epanechnikov, 4));
            let (value, sums) = density_at(&density, &here, 4);
            let error = error_and_bias(&sums).0;
            assert!(
                value.is_finite() && error.is_finite() && error > 0.0,
                "{bandwidth:?} {n}: {value} {error}"
            );
            assert!(error_and_bias(&sums).1.is_finite());
            // Of k nearest that at the distance r_k is left out; the automatic bandwidth wants 64.
            let by_neighbours = matches!(bandwidth, Bandwidth::Nearest(50) | Bandwidth::Automatic);
            assert_eq!(n == 0 || (n == 1 && by_neighbours), value == 0.0, "{bandwidth:?} {n}");
        }
    }
    // None at all: one photon's worth, pi r^2 wide.
    let map = PhotonMap::build(Vec::new(), frame, 0.1);
    let density = density_of(&scene, &map, 3.0, choice(Bandwidth::Radius(0.1), Kernel::default(), 1));
    let (value, sums) = density_at(&density, &here, 8);
    assert_eq!(value, 0.0);
    assert!((error_and_bias(&sums).0 / (3.0 / (PI * 0.01)) - 1.0).abs() < 1e-12);
    assert!(error_and_bias(&density_at(&density, &here, 1).1).0.is_nan());

    // All in one place, on the point itself.
    let photons: Vec<_> = (0..1000).map(|i| photon(&frame, here.position, 0, i % 4)).collect();
    let map = PhotonMap::build(photons, frame, 0.01);
    for bandwidth in [Bandwidth::Radius(0.1), Bandwidth::Nearest(10), Bandwidth::Automatic] {
        let density = density_of(&scene, &map, 1.0, choice(bandwidth, Kernel::Flat, 4));
        let (value, sums) = density_at(&density, &here, 4);
        assert!(value.is_finite() && value > 0.0 && error_and_bias(&sums).0.is_finite(), "{bandwidth:?}");
    }
}

#[test]
fn sums_over_replicates_add_up_and_their_spread_is_the_error() {
    let scene = geometry(vec![floor()]);
    let frame = frame_of(&scene);
    let places: Vec<Hit> = (0..40).map(|i| on_floor(&scene, u(i, 50), u(i, 51))).collect();
    for bandwidth in [Bandwidth::Radius(0.08), Bandwidth::Progressive(0.1), Bandwidth::Nearest(60)] {
        let (mut squares, mut variances) = (Vec::new(), Vec::new());
        for seed in 0..100 {
            let map = PhotonMap::build(on_the_floor(&frame, 4000, seed, 8), frame, 0.08);
            let density = density_of(&scene, &map, 1.0, choice(bandwidth, Kernel::Epanechnikov, 8));
            for at in &places {
                let (value, sums) = density_at(&density, at, 8);
                let total: f64 = sums.by_replicate.iter().sum();
                assert!((total - value).abs() < 1e-12 * value);
                squares.push((value / 4000.0 - 1.0).powi(2));
                variances.push((error_and_bias(&sums).0 / 4000.0).powi(2));
            }
        }
        // The estimate is unbiased here, so the mean square of its error is its variance. Of k nearest the spread over
        // replicates is conditional on the radius: smaller or larger, not the same thing.
        let ((a, da), (b, db)) = (mean_and_error(&squares), mean_and_error(&variances));
        println!(
            "{bandwidth:?}: mean squared error {a:.6} +- {da:.6}, mean squared standard error {b:.6} +- {db:.6}"
        );
        if bandwidth != Bandwidth::Nearest(60) {
            // Places share photons: their errors are not independent, so five times.
            assert!((a - b).abs() < 5.0 * (da * da + db * db).sqrt(), "{bandwidth:?}");
        }
    }
}
