//! The search structure changes nothing: brute force, AVX2 or not, order of surfaces, scale, place.

use caustix::geometry::{
    Formula, Geometry, Heightfield, Hit, Noise, Octave, Paraboloid, Rectangle, Shape, Sphere, Surface,
    Transform, Whereabouts, box_mesh,
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::meshes::{Random, icosphere, named};

fn field(cells: u32) -> Shape {
    let octaves = [(1.0, 0.30), (0.45, 0.148), (0.12, 0.073)];
    let octaves = octaves.map(|(amplitude, wavelength_m)| Octave { amplitude, wavelength_m });
    let formula = Formula::Noise(Noise::new(5, octaves.to_vec(), 0.05).unwrap());
    let field =
        Heightfield::new(DVec3::new(-1.0, -1.0, 0.5), DVec2::splat(2.0), [cells, cells], formula).unwrap();
    Shape::Mesh(field.mesh().unwrap())
}

/// One of everything.
fn surfaces(cells: u32) -> Vec<Surface> {
    let v = DVec3::new;
    vec![
        named("field", field(cells)),
        named(
            "plate",
            Shape::Rectangle(
                Rectangle::new(v(-1.0, -1.0, -0.5), v(2.0, 0.0, 0.0), v(0.0, 2.0, 0.0)).unwrap(),
            ),
        ),
        named(
            "wall",
            Shape::Rectangle(
                Rectangle::new(v(-1.0, -1.0, -0.5), v(0.0, 2.0, 0.0), v(0.0, 0.0, 1.5)).unwrap(),
            ),
        ),
        named("sphere", Shape::Sphere(Sphere::new(v(0.4, 0.3, 0.1), 0.25).unwrap())),
        named(
            "bowl",
            Shape::Paraboloid(Paraboloid::new(v(-0.4, -0.3, -0.1), v(0.2, -0.3, 1.0), 0.1, 0.3).unwrap()),
        ),
        named("box", Shape::Mesh(box_mesh(v(0.1, -0.7, -0.3), v(0.5, -0.4, 0.1)).unwrap())),
        named(
            "ball",
            Shape::Mesh(icosphere(2))
                .transformed(&Transform::new(DVec3::splat(0.2), DVec3::ZERO, v(-0.5, 0.5, 0.0)).unwrap())
                .unwrap(),
        ),
    ]
}

/// Rays of all kinds: anywhere, at vertices of the mesh grid, along axes through box faces, from afar.
fn ray(seed: u64, i: u64) -> (DVec3, DVec3) {
    let mut r = Random::new(seed, i);
    let origin = r.in_box(1.0);
    match r.below(4) {
        0 => (origin, r.direction()),
        1 => (origin * 1e5, (r.in_box(1.0) - origin * 1e5).normalize()),
        2 => {
            let node = DVec3::new(r.below(33) as f64 / 16.0 - 1.0, r.below(33) as f64 / 16.0 - 1.0, 2.0);
            (node, -DVec3::Z)
        }
        _ => {
            // In the plane of a box face, along an axis or slanting.
            let p = DVec3::new([0.1, 0.5][r.below(2)], -3.0, -0.3 + 0.4 * r.unit());
            (p, if r.below(2) == 0 { DVec3::Y } else { DVec3::new(0.0, 0.8, -0.6) })
        }
    }
}

fn rays(n: u64) -> impl ParallelIterator<Item = (DVec3, DVec3)> {
    (0..n).into_par_iter().map(|i| ray(11, i))
}

fn nearest(g: &Geometry, (o, d): (DVec3, DVec3)) -> (Option<Hit>, u64) {
    let mut skipped = 0;
    let at = Whereabouts::default();
    let hit = g.nearest(o, d, &at, &mut skipped);
    (hit, skipped)
}

#[test]
fn tree_and_brute_force_agree_bit_for_bit() {
    let g = Geometry::build(surfaces(32)).unwrap();
    let hits: usize = rays(60_000)
        .map(|(o, d)| {
            let mut skipped = 0;
            let brute = g.nearest_by_exhaustion(o, d, &Whereabouts::default(), &mut skipped);
            assert_eq!(nearest(&g, (o, d)), (brute, skipped), "{o:?} {d:?}");
            usize::from(brute.is_some())
        })
        .sum();
    assert!(hits > 30_000, "{hits}");
}

#[test]
fn avx2_changes_no_bit() {
    let (fast, mut plain) = (Geometry::build(surfaces(64)).unwrap(), Geometry::build(surfaces(64)).unwrap());
    plain.use_avx2(false);
    rays(400_000).for_each(|ray| assert_eq!(nearest(&fast, ray), nearest(&plain, ray)));
}

#[test]
fn order_of_surfaces_changes_nothing_but_their_numbers() {
    let forward = Geometry::build(surfaces(32)).unwrap();
    let mut reversed = surfaces(32);
    reversed.reverse();
    let n = reversed.len() as u32;
    let reversed = Geometry::build(reversed).unwrap();
    rays(200_000).for_each(|ray| {
        let key =
            |h: Hit, s: u32| (s, h.face, h.t.to_bits(), h.position, h.normal, h.shading_normal, h.front);
        let (a, b) = (nearest(&forward, ray), nearest(&reversed, ray));
        assert_eq!(a.0.map(|h| key(h, h.surface.0)), b.0.map(|h| key(h, n - 1 - h.surface.0)));
        assert_eq!(a.1, b.1);
    });
}

fn moved(cells: u32, scale: f64, shift: DVec3) -> Geometry {
    let t = Transform::new(DVec3::splat(scale), DVec3::ZERO, shift).unwrap();
    let moved = surfaces(cells).into_iter().map(|s| Surface { shape: s.shape.transformed(&t).unwrap(), ..s });
    Geometry::build(moved.collect()).unwrap()
}

#[test]
fn powers_of_two_scale_every_hit_exactly() {
    // Moved by nothing, so that smooth normals are normalised as often here as there.
    let one = moved(128, 1.0, DVec3::ZERO);
    for scale in [2f64.powi(-10), 2f64.powi(10)] {
        let other = moved(128, scale, DVec3::ZERO);
        rays(300_000).for_each(|(o, d)| {
            let (a, s) = nearest(&one, (o, d));
            let (b, z) = nearest(&other, (o * scale, d));
            let scaled = a.map(|h| Hit {
                t: h.t * scale,
                t_bound: h.t_bound * scale,
                position: h.position * scale,
                ..h
            });
            assert_eq!((scaled, s), (b, z), "{o:?} {d:?}");
        });
    }
}

/// How many of a million rays end on another primitive, and the largest error of the others' positions [m].
fn differences(other: &Geometry, scale: f64, shift: DVec3) -> (usize, f64) {
    let one = Geometry::build(surfaces(128)).unwrap();
    (0..1_000_000u64)
        .into_par_iter()
        .map(|i| {
            // Generic rays: the aimed ones sit on edges on purpose, where a rounding decides.
            let mut r = Random::new(23, i);
            let (o, d) = (r.in_box(1.0), r.direction());
            let a = nearest(&one, (o, d)).0;
            let b = nearest(other, (o * scale + shift, d)).0;
            match (a, b) {
                (Some(a), Some(b)) if a.primitive == b.primitive => {
                    (0, (b.position - (a.position * scale + shift)).length() / scale)
                }
                (None, None) => (0, 0.0),
                _ => (1, 0.0),
            }
        })
        .reduce(|| (0, 0.0), |a, b| (a.0 + b.0, a.1.max(b.1)))
}

#[test]
fn other_scales_change_at_most_one_ray_in_a_million() {
    for scale in [1e-3, 1e3] {
        let (changed, error) = differences(&moved(128, scale, DVec3::ZERO), scale, DVec3::ZERO);
        println!("scale {scale}: {changed} changed, error {error:e}");
        assert!(changed <= 1, "{changed}");
    }
}

#[test]
fn a_kilometre_away_the_rounding_is_that_of_a_kilometre() {
    // Coordinates near 1e3 m carry half an ulp of 5.7e-14 m each. Where a ray meets a facet at a grazing angle the
    // point moves by that over the cosine, so a share of rays may change facet: rounding over facet size, 1e-13/1e-2.
    let shift = DVec3::new(1e3, -1e3, 1e3);
    let (changed, error) = differences(&moved(128, 1.0, shift), 1.0, shift);
    println!("shifted: {changed} changed, error {error:e}");
    assert!(changed <= 3, "{changed}");
    assert!(error < 1e-8, "{error:e}");
}

#[test]
fn nonsense_rays_hit_nothing() {
    let g = Geometry::build(surfaces(8)).unwrap();
    for (o, d) in [
        (DVec3::NAN, DVec3::X),
        (DVec3::ZERO, DVec3::NAN),
        (DVec3::ZERO, DVec3::ZERO),
        (DVec3::INFINITY, DVec3::X),
    ] {
        assert_eq!(nearest(&g, (o, d)).0, None);
    }
    assert_eq!(nearest(&Geometry::build(vec![]).unwrap(), (DVec3::ZERO, DVec3::X)).0, None);
}

#[test]
fn two_surfaces_of_one_name_are_refused() {
    let mut twice = surfaces(4);
    twice.push(named("box", Shape::Sphere(Sphere::new(DVec3::ONE, 1.0).unwrap())));
    assert!(Geometry::build(twice).unwrap_err().found().contains("\"box\""));
}
