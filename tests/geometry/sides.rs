//! The side is state: exact shapes, open interfaces, nested bodies, starting points.

use caustix::geometry::{
    Formula, Geometry, Heightfield, Mesh, MeshParts, Paraboloid, Rectangle, Shape, Side, Smoothing, Sphere,
    SurfaceId, Wave, Whereabouts, box_mesh,
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::meshes::{Random, icosphere, named};

fn sphere(centre: DVec3, radius: f64) -> Shape {
    Shape::Sphere(Sphere::new(centre, radius).unwrap())
}

#[test]
fn inside_a_mirror_sphere_every_chord_is_twice_the_cosine() {
    // Reflections inside a sphere keep the angle: every chord has the length 2 R cos(theta). A thousand bounces.
    let g = Geometry::build(vec![named("s", sphere(DVec3::new(3.0, -2.0, 1.0), 0.7))]).unwrap();
    (0..2000u64).into_par_iter().for_each(|i| {
        let mut r = Random::new(3, i);
        let mut origin = DVec3::new(3.0, -2.0, 1.0) + r.in_box(0.3);
        let mut direction = r.direction();
        let mut at = Whereabouts::start(g.all_behind(origin));
        let mut skipped = 0;
        let mut chord = None;
        for _ in 0..1000 {
            let hit = g.nearest(origin, direction, &at, &mut skipped).expect("a sphere has no holes");
            assert!(!hit.front);
            let length = (hit.position - origin).length();
            if let Some(chord) = chord {
                let error: f64 = length - chord;
                assert!(error.abs() < 1e-11, "{length} {chord}");
            }
            if at.surface_left().is_some() {
                chord = chord.or(Some(length));
            }
            direction = (direction - hit.normal * (2.0 * direction.dot(hit.normal))).normalize();
            origin = hit.position;
            at.leave(&hit, Side::Back);
        }
        assert_eq!(skipped, 0);
    });
}

#[test]
fn grazing_rays_enter_and_leave_a_sphere_or_miss_it() {
    let g = Geometry::build(vec![named("s", sphere(DVec3::ZERO, 1.0))]).unwrap();
    let mut entered = 0;
    for k in 0..2000 {
        let height = 1.0 + f64::from(k - 1000) * f64::EPSILON;
        let (mut origin, direction) = (DVec3::new(-2.0, height, 0.0), DVec3::X);
        let mut at = Whereabouts::default();
        let mut crossings = 0;
        let mut skipped = 0;
        while let Some(hit) = g.nearest(origin, direction, &at, &mut skipped) {
            assert_eq!(hit.front, crossings % 2 == 0);
            crossings += 1;
            assert!(crossings <= 2);
            at.leave(&hit, if hit.front { Side::Back } else { Side::Front });
            origin = hit.position;
        }
        assert!(crossings == 0 || crossings == 2, "{k}: {crossings}");
        entered += crossings / 2;
        assert!(!at.is_behind_any());
    }
    assert!((900..=1100).contains(&entered), "{entered}");
}

#[test]
fn an_open_interface_is_crossed_once_and_a_mirror_never() {
    // A wave surface as interface: straight through, aimed at its vertices and edges, is one crossing. Turned back by
    // reflection the ray must not meet the same place again.
    let wave = Wave { amplitude_m: 0.01, wavelength_m: 0.9, direction_deg: 20.0, phase_deg: 0.0 };
    let origin = DVec3::new(-1.0, -1.0, 0.0);
    let field = Heightfield::new(origin, DVec2::splat(2.0), [16, 16], Formula::Waves(vec![wave]))
        .unwrap()
        .smooth(false);
    let mesh = field.mesh().unwrap();
    let g = Geometry::build(vec![named("water", Shape::Mesh(mesh.clone()))]).unwrap();
    (0..300_000u64).into_par_iter().for_each(|i| {
        let mut r = Random::new(4, i);
        let (row, column) = (1 + r.below(15), 1 + r.below(15));
        let vertex = mesh.vertices()[row * 17 + column];
        let next = mesh.vertices()[row * 17 + column + 1];
        let aim = if r.below(2) == 0 { vertex } else { vertex + (next - vertex) * r.unit() };
        let mut towards = r.direction();
        towards.z = -towards.z.abs() - 0.3;
        let direction = towards.normalize();
        let origin = aim - direction * (0.5 + r.unit());
        let (mut at, mut skipped) = (Whereabouts::default(), 0);
        let hit = g.nearest(origin, direction, &at, &mut skipped).unwrap();
        assert!(hit.front);
        at.leave(&hit, Side::Back);
        assert_eq!(g.nearest(hit.position, direction, &at, &mut skipped), None);
        let mut at = Whereabouts::default();
        at.leave(&hit, Side::Front);
        let back = direction - hit.normal * (2.0 * direction.dot(hit.normal));
        assert_eq!(g.nearest(hit.position, back, &at, &mut skipped), None);
    });
}

#[test]
fn behind_is_geometry_at_the_start() {
    let turned = {
        let m = icosphere(2);
        let triangles = m.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let parts = MeshParts { vertices: m.vertices().to_vec(), triangles, ..MeshParts::default() };
        Mesh::new(parts, Smoothing::Flat, true).unwrap()
    };
    assert!(turned.1.iter().any(|w| w.found().contains("inward")), "{:?}", turned.1);
    let g = Geometry::build(vec![
        named("ball", Shape::Mesh(icosphere(2))),
        named("cave", Shape::Mesh(turned.0)),
        named("sphere", sphere(DVec3::new(0.0, 0.0, 5.0), 1.0)),
        named("sheet", Shape::Rectangle(Rectangle::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap())),
        named("box", Shape::Mesh(box_mesh(DVec3::splat(-3.0), DVec3::splat(3.0)).unwrap())),
    ])
    .unwrap();
    let id = |n: &[u32]| n.iter().map(|&i| SurfaceId(i)).collect::<Vec<_>>();
    assert_eq!(g.all_behind(DVec3::new(0.1, 0.2, -0.3)), id(&[0, 4]));
    assert_eq!(g.all_behind(DVec3::new(0.0, 0.0, 1.5)), id(&[1, 4]));
    assert_eq!(g.all_behind(DVec3::new(0.0, 0.0, 4.5)), id(&[1, 2]));
    assert_eq!(g.all_behind(DVec3::new(0.0, 0.0, 3.5)), id(&[1]));
}

#[test]
fn more_nested_bodies_than_the_list_holds_are_still_crossed_in_order() {
    let shells = 12;
    let g = Geometry::build(
        (0..shells).map(|i| named(&format!("s{i:02}"), sphere(DVec3::ZERO, 1.0 + f64::from(i)))).collect(),
    )
    .unwrap();
    let (mut origin, direction) = (DVec3::new(0.01, 0.02, -20.0), DVec3::Z);
    let (mut at, mut skipped) = (Whereabouts::default(), 0);
    let mut order = Vec::new();
    while let Some(hit) = g.nearest(origin, direction, &at, &mut skipped) {
        order.push((hit.surface.0, hit.front));
        at.leave(&hit, if hit.front { Side::Back } else { Side::Front });
        origin = hit.position;
    }
    let inward = (0..shells as u32).rev().map(|i| (i, true));
    let expected: Vec<_> = inward.chain((0..shells as u32).map(|i| (i, false))).collect();
    assert_eq!(order, expected);
    assert_eq!(skipped, 0);
    assert!(!at.is_behind_any());
}

#[test]
fn the_wrong_side_is_skipped_and_counted() {
    // In front of the box by decree though inside it: its far side contradicts the state.
    let g =
        Geometry::build(vec![named("box", Shape::Mesh(box_mesh(DVec3::ZERO, DVec3::ONE).unwrap()))]).unwrap();
    let (origin, direction) = (DVec3::splat(0.4), DVec3::new(0.48, 0.6, 0.64));
    let mut skipped = 0;
    assert_eq!(g.nearest(origin, direction, &Whereabouts::default(), &mut skipped), None);
    assert_eq!(skipped, 1);
    let at = Whereabouts::start([SurfaceId(0)]);
    assert!(!g.nearest(origin, direction, &at, &mut skipped).unwrap().front);
    assert_eq!(skipped, 1);
}

#[test]
fn a_paraboloid_is_met_from_both_sides_and_focuses() {
    let p = Paraboloid::new(DVec3::ZERO, DVec3::Z, 0.5, 1.0).unwrap();
    let g = Geometry::build(vec![named("dish", Shape::Paraboloid(p))]).unwrap();
    let mut skipped = 0;
    for i in 0..10_000 {
        let mut r = Random::new(9, i);
        let radius = 0.999 * r.unit();
        let phi = std::f64::consts::TAU * r.unit();
        let (x, y) = (radius * phi.cos(), radius * phi.sin());
        let hit = g.nearest(DVec3::new(x, y, 9.0), -DVec3::Z, &Whereabouts::default(), &mut skipped).unwrap();
        assert!(hit.front && (hit.position - DVec3::new(x, y, radius * radius / 2.0)).length() < 1e-14);
        let out = -DVec3::Z - hit.normal * (2.0 * hit.normal.dot(-DVec3::Z));
        let mut at = Whereabouts::default();
        at.leave(&hit, Side::Front);
        // The mirrored ray runs through the focus; the second root, if within the rim, is the next hit.
        let to_focus = p.focus() - hit.position;
        assert!(to_focus.cross(out).length() < 1e-13);
        if let Some(next) = g.nearest(hit.position, out, &at, &mut skipped) {
            assert!(next.t > 0.5 && next.front);
        }
        let below =
            g.nearest(DVec3::new(x, y, -9.0), DVec3::Z, &Whereabouts::default(), &mut skipped).unwrap();
        assert!(!below.front);
        let mut at = Whereabouts::default();
        at.leave(&below, Side::Front);
        assert_eq!(g.nearest(below.position, DVec3::Z, &at, &mut skipped), None);
    }
}

#[test]
fn rectangle_halves_meet_without_a_gap_and_uv_is_exact_at_corners() {
    let r = Rectangle::new(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.3, 0.4, 0.0), DVec3::new(-0.8, 0.6, 0.0))
        .unwrap();
    assert!((r.area() - 0.5).abs() < 1e-15);
    let g = Geometry::build(vec![named("r", Shape::Rectangle(r))]).unwrap();
    let mut skipped = 0;
    for i in 0..100_000 {
        let mut n = Random::new(10, i);
        let (u, d) = (n.unit(), n.direction());
        // On the diagonal.
        let aim = r.corner() + (r.edge_u() + r.edge_v()) * u;
        if d.z.abs() < 0.05 {
            continue;
        }
        let hit = g.nearest(aim - d, d, &Whereabouts::default(), &mut skipped).unwrap();
        let (a, b) = r.uv(hit.position);
        assert!((a - u).abs() < 1e-13 && (b - u).abs() < 1e-13);
        assert_eq!(hit.front, d.z < 0.0);
    }
    assert!(Rectangle::new(DVec3::ZERO, DVec3::X, DVec3::new(0.1, 1.0, 0.0)).is_err());
    assert!(Rectangle::new(DVec3::ZERO, DVec3::X, DVec3::ZERO).is_err());
    assert!(Rectangle::new(DVec3::NAN, DVec3::X, DVec3::Y).is_err());
}
