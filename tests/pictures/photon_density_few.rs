//! Density estimation where light is on the other side, on another surface, or hardly there.

use std::f64::consts::PI;

use caustix::geometry::{Geometry, Hit, Rectangle, Shape, Surface, Whereabouts};
use caustix::picture::gather::bandwidth::choose;
use caustix::picture::gather::density::PROGRESSIVE_ALPHA;
use caustix::picture::gather::footprint::Footprints;
use caustix::picture::gather::{Choice, Density, Gathered};
use caustix::picture::photon_map::record::{FRONT, pack};
use caustix::picture::photon_map::{Frame, Photon, PhotonMap};
use caustix::scene::camera::{Bandwidth, Kernel};
use glam::DVec3;

use crate::photons::{density_of, error_and_bias, frame_of, u};

/// The unit square at z = 0, its front up, and as many more above it.
fn sheets(count: u32) -> Geometry {
    let sheet = |i: u32| {
        let corner = DVec3::Z * f64::from(i);
        Surface {
            name: format!("s{i}"),
            shape: Shape::Rectangle(Rectangle::new(corner, DVec3::X, DVec3::Y).unwrap()),
        }
    };
    Geometry::build((0..count).map(sheet).collect()).unwrap()
}

/// The middle of the lowest sheet, from its front or from behind.
fn middle(geometry: &Geometry, front: bool) -> Hit {
    let up = if front { 0.5 } else { -0.5 };
    let from = DVec3::new(0.5, 0.5, up);
    let hit = geometry.nearest(from, DVec3::Z * -up.signum(), &Whereabouts::default(), &mut 0).unwrap();
    assert_eq!((hit.front, hit.surface.0), (front, 0));
    hit
}

/// Even independent photons at right angles on a sheet, on the side told.
fn photons(frame: &Frame, n: u64, salt: u64, sheet: u32, front: bool) -> Vec<Photon<1>> {
    let one = |i: u64| {
        let at = DVec3::new(u(i, salt), u(i, salt + 1), f64::from(sheet));
        let (down, flag) = if front { (-DVec3::Z, FRONT) } else { (DVec3::Z, 0) };
        Photon {
            cell: frame.cell(at),
            direction: pack(down),
            primitive: 2 * sheet + u32::from(at.y > at.x),
            tag: (i % 8) as u32 | flag,
            weight: [1.0],
        }
    };
    (0..n).map(one).collect()
}

fn choice(bandwidth: Bandwidth) -> Choice {
    Choice { bandwidth, kernel: Kernel::Epanechnikov, replicates: 8 }
}

const BANDWIDTHS: [Bandwidth; 5] = [
    Bandwidth::Radius(0.1),
    Bandwidth::Progressive(0.1),
    Bandwidth::AtLeast { radius_m: 0.1, neighbours: 64 },
    Bandwidth::Nearest(50),
    Bandwidth::Automatic,
];

/// What a surface shows that scatters evenly to the side it is lit from, as luminance for a BSDF of 1.
fn evenly(density: &Density<'_, 1>, at: &Hit) -> Gathered<1> {
    let mut sums = Gathered::new(8);
    density.gather_evenly(at, [1.0], &mut sums);
    sums
}

#[test]
fn a_sheet_that_is_lit_from_behind_alone_is_dark_and_not_certain() {
    let scene = sheets(1);
    let frame = frame_of(&scene);
    let here = middle(&scene, true);
    for bandwidth in BANDWIDTHS {
        let map = PhotonMap::build(photons(&frame, 5000, 1, 0, false), frame, 0.1);
        let density = density_of(&scene, &map, 1.0, choice(bandwidth));
        let opaque = |_, front: bool| [if front { 1.0 } else { 0.0 }];
        let mut asked = Gathered::new(8);
        density.gather(&here, [1.0], opaque, &mut asked);
        for (how, sums) in [("evenly", evenly(&density, &here)), ("by its BSDF", asked)] {
            assert_eq!(sums.value, [0.0], "{bandwidth:?} {how}");
            assert!(error_and_bias(&sums).0 > 0.0, "{bandwidth:?} {how}: 0 and certain");
        }
        if let Bandwidth::Radius(r) = bandwidth {
            let one = 1.0 / (PI * r * r);
            assert!((evenly(&density, &here).sparse / one - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn photons_of_the_other_side_change_nothing_of_what_is_gathered_evenly() {
    let scene = sheets(1);
    let frame = frame_of(&scene);
    // Hardly any, too few for the radius, enough for it.
    for n in [3, 500, 20_000] {
        let seen = photons(&frame, n, 3, 0, true);
        let behind = photons(&frame, 4000, 5, 0, false);
        let alone = PhotonMap::build(seen.clone(), frame, 0.1);
        let both = PhotonMap::build([seen, behind].concat(), frame, 0.1);
        for bandwidth in BANDWIDTHS {
            // Its choice is made of the photons of both sides.
            if bandwidth == Bandwidth::Automatic {
                continue;
            }
            let of = |map| evenly(&density_of(&scene, map, 1.0, choice(bandwidth)), &middle(&scene, true));
            let (alone, both) = (of(&alone), of(&both));
            let numbers = |g: &Gathered<1>| [g.value[0], g.second[0], g.sparse, g.nearest_bias];
            for (a, b) in numbers(&alone).into_iter().zip(numbers(&both)) {
                assert!((a - b).abs() <= 1e-12 * a.abs(), "{n} {bandwidth:?}: {alone:?}\n{both:?}");
            }
        }
    }
}

#[test]
fn a_sheet_that_transmits_shows_the_photons_of_both_sides_and_their_error() {
    let scene = sheets(1);
    let frame = frame_of(&scene);
    let here = middle(&scene, true);
    let sides = [photons(&frame, 20_000, 7, 0, true), photons(&frame, 20_000, 9, 0, false)];
    let map = PhotonMap::build(sides.concat(), frame, 0.1);
    for bandwidth in BANDWIDTHS {
        let density = density_of(&scene, &map, 1.0, choice(bandwidth));
        let mut sums = Gathered::new(8);
        density.gather(&here, [1.0], |_, front| [if front { 0.5 } else { 0.25 }], &mut sums);
        let error = error_and_bias(&sums).0;
        assert!(
            (sums.value[0] - 15_000.0).abs() < 5.0 * error + error_and_bias(&sums).1,
            "{bandwidth:?}: {sums:?}"
        );
        assert!(error < 3000.0, "{bandwidth:?}: {error}");
    }
    // A sheet that does nothing but transmit, and five photons behind it: those before it bring nothing.
    let few = photons(&frame, 1 << 20, 11, 0, false).into_iter();
    let few = few.filter(|p| (frame.position(p.cell) - here.position).length() < 0.1).take(5).collect();
    let map = PhotonMap::build([sides[0].clone(), few].concat(), frame, 0.1);
    let density = density_of(&scene, &map, 1.0, choice(Bandwidth::Radius(0.1)));
    let mut sums = Gathered::new(8);
    density.gather(&here, [1.0], |_, front| [if front { 0.0 } else { 0.25 }], &mut sums);
    let expected = 0.25 * 6f64.sqrt() / (PI * 0.01);
    assert!((sums.sparse / expected - 1.0).abs() < 1e-12, "{} {expected}", sums.sparse);
}

#[test]
fn the_k_nearest_of_a_surface_do_not_depend_on_others() {
    let scene = sheets(3);
    let frame = frame_of(&scene);
    let own = photons(&frame, 90, 13, 0, true);
    let others = [1, 2].map(|sheet| photons(&frame, 20_000, 15, sheet, true)).concat();
    let alone = PhotonMap::build(own.clone(), frame, 0.1);
    let among = PhotonMap::build([own, others].concat(), frame, 0.01);
    for bandwidth in [Bandwidth::Nearest(30), Bandwidth::AtLeast { radius_m: 0.02, neighbours: 30 }] {
        let of = |map| evenly(&density_of(&scene, map, 1.0, choice(bandwidth)), &middle(&scene, true));
        let (alone, among) = (of(&alone), of(&among));
        assert!((alone.value[0] / among.value[0] - 1.0).abs() < 1e-12, "{bandwidth:?}");
        assert!((alone.second[0] / among.second[0] - 1.0).abs() < 1e-12, "{bandwidth:?}");
        assert!((alone.value[0] - 90.0).abs() < 40.0, "{bandwidth:?}: {alone:?}");
    }
}

#[test]
fn a_bandwidth_of_few_photons_is_local() {
    let scene = sheets(1);
    let frame = frame_of(&scene);
    let footprints = Footprints::new(&scene);
    for n in [600, 1392, 5000, 15_000] {
        let map = PhotonMap::build(photons(&frame, n, 17, 0, true), frame, 0.0);
        let chosen = choose(&footprints, &map, Kernel::Epanechnikov, 8, 1.0);
        println!("{n}: {chosen:?}");
        // The mean count is that of the median radius but for its spread.
        let most = 1.2 * n as f64 / 32.0;
        assert!(chosen.mean_neighbours <= most, "{n}: {chosen:?}");
    }
}

#[test]
fn a_photon_that_no_replicate_found_is_worth_that_of_the_narrowest_radius() {
    let scene = sheets(1);
    let frame = frame_of(&scene);
    let map = PhotonMap::build(Vec::new(), frame, 0.1);
    let density = density_of(&scene, &map, 3.0, choice(Bandwidth::Progressive(0.1)));
    // r_(i+1)^2 = r_i^2 (i + 2/3) / (i + 1), eight of them.
    let narrowest2 =
        (1..8).fold(0.01, |r2, i| r2 * (f64::from(i) + PROGRESSIVE_ALPHA) / (f64::from(i) + 1.0));
    let expected = 3.0 / (PI * narrowest2);
    let sums = evenly(&density, &middle(&scene, true));
    assert!((sums.sparse / expected - 1.0).abs() < 1e-12, "{} {expected}", sums.sparse);
}
