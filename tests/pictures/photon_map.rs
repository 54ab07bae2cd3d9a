//! The photon map as a container: searches against looking at every photon, order, extremes, memory, packing.

use caustix::error::Kind;
use caustix::files::photon_map as file;
use caustix::picture::photon_map::record::{FRONT, SCATTERED, pack, unpack};
use caustix::picture::photon_map::{Frame, Photon, PhotonMap, SavedMap};
use caustix::sequence::hash::mix64;
use glam::DVec3;
use sha2::{Digest, Sha256};

/// Numbers in [0, 1) without pattern.
fn u(i: u64, salt: u64) -> f64 {
    (mix64(mix64(i) ^ mix64(salt.wrapping_mul(0x9e37_79b9))) >> 11) as f64 / (1u64 << 53) as f64
}

fn direction(i: u64) -> DVec3 {
    let (z, phi) = (2.0 * u(i, 101) - 1.0, std::f64::consts::TAU * u(i, 102));
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * phi.cos(), r * phi.sin(), z)
}

/// A floor, a wall, a tight cluster and strays in a room of this size (m).
fn place(i: u64, size: f64) -> DVec3 {
    let (a, b, c) = (u(i, 1), u(i, 2), u(i, 3));
    size * match i % 8 {
        0..4 => DVec3::new(a, b, 0.0),
        4 | 5 => DVec3::new(a, 1.0, b),
        6 => DVec3::new(0.4, 0.3, 0.2) + 1e-4 * DVec3::new(a, b, c),
        _ => DVec3::new(a, b, c),
    }
}

fn photons<const C: usize>(n: u64, frame: &Frame, at: impl Fn(u64) -> DVec3) -> Vec<Photon<C>> {
    let flags = |i: u64| {
        (i % 8) as u32
            | if i.is_multiple_of(3) { FRONT } else { 0 }
            | if i.is_multiple_of(5) { SCATTERED } else { 0 }
    };
    let photon = |i: u64| Photon {
        cell: frame.cell(at(i)),
        direction: pack(direction(i)),
        primitive: (i % 12) as u32,
        tag: flags(i),
        weight: std::array::from_fn(|c| u(i, 200 + c as u64) as f32),
    };
    (0..n).map(photon).collect()
}

fn room(size: f64) -> Frame {
    Frame::new(DVec3::ZERO, DVec3::splat(size))
}

fn by_looking<const C: usize>(map: &PhotonMap<C>, centre: DVec3, radius: f64) -> Vec<(u64, u32)> {
    let d2 = |p: &Photon<C>| (map.position(p) - centre).length_squared();
    let near = map.photons().iter().filter(|p| d2(p) < radius * radius);
    near.map(|p| (d2(p).to_bits(), p.direction)).collect()
}

fn by_searching<const C: usize>(map: &PhotonMap<C>, centre: DVec3, radius: f64) -> Vec<(u64, u32)> {
    let mut found = Vec::new();
    map.within(centre, radius, |p, d2| found.push((d2.to_bits(), p.direction)));
    found
}

#[test]
fn a_search_finds_what_looking_at_every_photon_finds() {
    for size in [1e-6, 1.0, 1e6] {
        let frame = room(size);
        for built_for in [0.0, 1e-5 * size, 0.003 * size, 0.05 * size, 0.3 * size, 10.0 * size] {
            let map = PhotonMap::build(photons::<1>(20_000, &frame, |i| place(i, size)), frame, built_for);
            let mut found = 0;
            for q in 0..60u64 {
                let centre = if q % 3 == 0 {
                    place(q * 77, size)
                } else {
                    place(q * 77, size) + direction(q) * (0.02 * size)
                };
                for radius in [1e-5, 3e-4, 0.01, 0.07, 0.6, 3.0].map(|r| r * size) {
                    let expected = by_looking(&map, centre, radius);
                    assert_eq!(
                        by_searching(&map, centre, radius),
                        expected,
                        "{size} {built_for} {q} {radius}"
                    );
                    found += expected.len();
                }
            }
            assert!(found > 100_000);
        }
    }
}

#[test]
fn the_map_is_the_same_for_any_order_of_photons_and_any_number_of_threads() {
    let frame = room(3.0);
    let mut given = photons::<3>(50_000, &frame, |i| place(i / 3, 3.0));
    // Photons that differ in one field only, and some that do not differ.
    for i in 0..3000 {
        let mut twin = given[i];
        match i % 4 {
            0 => twin.tag ^= 1,
            1 => twin.weight[2] += 0.5,
            2 => twin.primitive += 1,
            _ => {}
        }
        given.push(twin);
    }
    let map = |photons: Vec<Photon<3>>, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| PhotonMap::build(photons, frame, 0.02))
    };
    let one = map(given.clone(), 1);
    for (shift, threads) in [(17usize, 1), (0, 2), (1717, 2), (29_999, 7)] {
        let mut other = given.clone();
        other.rotate_left(shift);
        if shift % 2 == 1 {
            other.reverse();
        }
        let other = map(other, threads);
        assert!(one.photons() == other.photons(), "{shift} {threads}");
    }
}

#[test]
fn the_nearest_are_the_nearest() {
    let frame = room(2.0);
    for built_for in [1e-4, 0.05, 5.0] {
        let map = PhotonMap::build(photons::<1>(5000, &frame, |i| place(i, 2.0)), frame, built_for);
        let mut found = Vec::new();
        for q in 0..50u64 {
            let centre = place(q * 31, 2.0) + direction(q) * 0.01;
            let mut all: Vec<f64> = map
                .photons()
                .iter()
                .filter(|p| p.is_front())
                .map(|p| (map.position(p) - centre).length_squared())
                .collect();
            all.sort_by(f64::total_cmp);
            for k in [1, 2, 50, all.len() - 1, all.len(), 100_000] {
                map.nearest(centre, k, [0.0, 0.01, 100.0][q as usize % 3], Photon::is_front, &mut found);
                assert_eq!(found.len(), k.min(all.len()));
                assert_eq!(found.last().unwrap().0, all[found.len() - 1]);
                let mut distances: Vec<f64> = found.iter().map(|f| f.0).collect();
                distances.sort_by(f64::total_cmp);
                assert_eq!(distances, all[..found.len()]);
            }
        }
    }
}

#[test]
fn maps_of_no_photon_of_one_and_of_many_in_one_place() {
    let frame = room(1.0);
    let mut found = vec![(1.0, 1)];
    let none = PhotonMap::<1>::build(Vec::new(), frame, 0.1);
    none.within(DVec3::ZERO, 10.0, |_, _| panic!("there is none"));
    none.nearest(DVec3::ZERO, 3, 0.1, |_| true, &mut found);
    assert!(found.is_empty());

    let middle = DVec3::splat(0.5);
    for n in [1u64, 100_000] {
        let map = PhotonMap::build(photons::<3>(n, &frame, |_| middle), frame, 0.0);
        for (radius, expected) in [(1e-12, 0), (0.02, 0), (0.11, n), (10.0, n), (1e300, n)] {
            let mut count = 0;
            map.within(middle + DVec3::X * 0.1, radius, |_, _| count += 1);
            assert_eq!(count, expected, "{radius}");
        }
        map.nearest(middle, 5, 0.0, |_| true, &mut found);
        assert_eq!(found.len() as u64, n.min(5));
    }
    // A frame without extent.
    let flat = Frame::new(middle, middle);
    let map = PhotonMap::build(photons::<1>(10, &flat, |_| middle), flat, 0.1);
    assert_eq!(by_searching(&map, middle, 1e-3).len(), 10);
    map.nearest(middle, 50, 0.0, |_| true, &mut found);
    assert_eq!(found.len(), 10);
    let map = PhotonMap::build(photons::<1>(10, &flat, |_| middle), flat, 0.0);
    map.nearest(middle, 50, 0.0, |_| true, &mut found);
    assert_eq!(found.len(), 10);
}

#[test]
fn directions_survive_packing_to_within_the_stated_angle() {
    let (mut worst, mut n) = (0.0f64, 0);
    let mut check = |d: DVec3| {
        let back = unpack(pack(d));
        assert!((back.length() - 1.0).abs() < 1e-15);
        worst = worst.max(back.cross(d).length().atan2(back.dot(d)));
        n += 1;
    };
    for i in 0..2_000_000 {
        check(direction(i));
    }
    // Where the map folds, and its corners.
    for i in 0..200_000 {
        let phi = std::f64::consts::TAU * u(i, 5);
        for z in [0.0, 1e-9, -1e-9, 1e-5, -1e-5, 0.999_999_999] {
            let r = (1.0f64 - z * z).sqrt();
            check(DVec3::new(r * phi.cos(), r * phi.sin(), z));
            check(DVec3::new(z, r * phi.cos(), r * phi.sin()));
        }
    }
    for d in [DVec3::X, DVec3::Y, DVec3::Z] {
        check(d);
        check(-d);
    }
    /// sqrt 18 / 65535 = 6.474e-5, rounded up.
    const BOUND_RAD: f64 = 6.5e-5;
    println!("worst error of {n} directions: {worst:.3e} rad");
    assert!(worst < BOUND_RAD);
    // The bound is no idle one.
    assert!(worst > 0.8 * BOUND_RAD);
}

#[test]
fn positions_survive_to_half_a_step() {
    for (low, size) in [(DVec3::ZERO, 1e-6), (DVec3::new(-3.0, 5.0, 100.0), 8.0), (DVec3::splat(-1e6), 2e6)] {
        let frame = Frame::new(low, low + DVec3::new(size, 0.5 * size, 0.0));
        for i in 0..10_000 {
            let p = low + DVec3::new(u(i, 1) * size, u(i, 2) * 0.5 * size, 0.0);
            let error = (frame.position(frame.cell(p)) - p).abs();
            // Half a step, and the rounding of coordinates that are large against it.
            let rounding = 4.0 * f64::EPSILON * low.abs().max_element().max(size);
            let bound = frame.steps_m() * 0.5 + DVec3::splat(rounding);
            assert!((bound - error).min_element() >= 0.0, "{p}");
        }
        let corner = low + DVec3::new(size, 0.5 * size, 0.0);
        assert_eq!(frame.cell(corner), [u32::MAX, u32::MAX, 0]);
    }
}

fn saved() -> SavedMap<3> {
    let frame = Frame::new(DVec3::new(-1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 3.0));
    SavedMap {
        scene_hash: "abc123".into(),
        settings: "4096 photons, seed 7".into(),
        photons_traced: 4096,
        replicates: 8,
        photon_lm: 0.25,
        frame,
        photons: photons(1000, &frame, |i| DVec3::new(5.0 * u(i, 1) - 1.0, 2.0 + 3.0 * u(i, 2), 3.0)),
    }
}

fn bytes_of<const C: usize>(map: &SavedMap<C>) -> Vec<u8> {
    let mut bytes = Vec::new();
    file::write(map, &mut bytes).unwrap();
    bytes
}

#[test]
fn a_saved_map_comes_back_as_it_was() {
    let map = saved();
    let bytes = bytes_of(&map);
    assert_eq!(file::channels(&bytes).unwrap(), 3);
    assert_eq!(file::read::<3>(&bytes, "abc123").unwrap(), map);
    let empty = SavedMap { photons: Vec::new(), ..map };
    assert_eq!(file::read::<3>(&bytes_of(&empty), "abc123").unwrap(), empty);
}

#[test]
fn damaged_and_foreign_maps_are_refused() {
    let bytes = bytes_of(&saved());
    let error = |bytes: &[u8], hash: &str| file::read::<3>(bytes, hash).unwrap_err();
    // Every flipped bit in the head, and some elsewhere; every truncation in the head, and some elsewhere.
    for at in (0..200).chain((200..bytes.len()).step_by(997)).chain(bytes.len() - 32..bytes.len()) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        let e = error(&damaged, "abc123");
        assert!(
            !e.found().is_empty() && matches!(e.kind(), Kind::Syntax | Kind::Unavailable | Kind::Range),
            "{e}"
        );
        if at > 16 {
            assert!(e.found().contains("checksum"), "{at}: {e}");
        }
        let cut = error(&bytes[..at], "abc123");
        assert_eq!(cut.kind(), Kind::Syntax, "{cut}");
    }
    assert_eq!(error(b"", "abc123").kind(), Kind::Syntax);
    assert_eq!(error(b"not a photon map at all", "abc123").kind(), Kind::Syntax);
    let foreign = error(&bytes, "another");
    assert!(foreign.found().contains("abc123") && foreign.required().contains("another"), "{foreign}");
    let channels = file::read::<1>(&bytes, "abc123").unwrap_err();
    assert!(channels.found().contains("3 channel"), "{channels}");

    // Sound checksums over numbers that cannot be.
    let resigned = |change: &dyn Fn(&mut SavedMap<3>)| {
        let mut map = saved();
        change(&mut map);
        error(&bytes_of(&map), "abc123").kind()
    };
    assert_eq!(resigned(&|m| m.photon_lm = f64::NAN), Kind::Range);
    assert_eq!(resigned(&|m| m.photon_lm = 0.0), Kind::Range);
    assert_eq!(resigned(&|m| m.replicates = 0), Kind::Range);
    assert_eq!(resigned(&|m| m.replicates = 4), Kind::Range);
    assert_eq!(resigned(&|m| m.photons[7].weight[1] = f32::INFINITY), Kind::Range);
    assert_eq!(resigned(&|m| m.frame = Frame::from_steps(DVec3::NAN, DVec3::ONE)), Kind::Range);

    // A number of photons that the file does not hold asks for no memory.
    let mut lying = bytes[..bytes.len() - 32].to_vec();
    let at = lying.len() - 1000 * 36 - 8;
    lying[at..at + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    let digest = Sha256::digest(&lying);
    lying.extend_from_slice(digest.as_slice());
    assert!(error(&lying, "abc123").found().contains("announced"));
}
