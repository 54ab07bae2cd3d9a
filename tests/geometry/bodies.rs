//! Scenes of many bodies (in one another, in contact, overlapping, of any size and anywhere), walked straight through: a ray that
//! starts outside ends outside, and meets the faces of each body in turn from without and from within. The example
//! `watertight` does it with 2 x 10^7 rays (docs/TRUST.md).
//!
//! Rays aimed at edges and vertices, along axes and in the planes of faces, meet them to the last bit. Where bodies share edges
//! or cut one another, rounding at one face can then move a ray past the edge of another: some of those rays are lost, and
//! counted so. Of rays that go anywhere none may be.

use std::sync::atomic::{AtomicU32, Ordering};

use caustix::geometry::{Body, Mesh, MeshParts, Shape, Smoothing, Sphere, Transform, Whereabouts, box_mesh};
use caustix::scene::{Scene, SceneBuilder, SurfaceOptions};
use caustix::surface::{Dielectric, Material};
use caustix::{Emitter, Isotropic};
use glam::DVec3;
use rayon::prelude::*;

use super::meshes::{Random, Tally, icosphere, slab};

/// Bodies, and what rays are aimed at.
pub struct Case {
    pub name: String,
    scene: Scene,
    centre: DVec3,
    /// Half of the extent.
    size: f64,
    /// Whether faces of different bodies cut or touch one another.
    pub meets: bool,
}

/// Where rays go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aim {
    /// Through any points of faces, in any direction.
    Anywhere,
    /// Through vertices and edges, along axes, in the planes of faces.
    Edges,
}

/// More than any straight line crosses in these scenes.
const MOST_CROSSINGS: u64 = 400;

type Parts = Vec<(Shape, f64, i32)>;

impl Case {
    /// Shapes with the index of their glass and their priority, about `centre`.
    fn new(name: impl Into<String>, parts: Parts, centre: DVec3, size: f64) -> Self {
        let mut builder = SceneBuilder::new();
        // A scene needs a lamp; rays do not start there.
        let lamp = Isotropic::new(centre + DVec3::new(0.013, 0.017, 0.011) * size, 1.0).unwrap();
        builder.emitter("lamp", Emitter::Isotropic(lamp));
        for (i, (shape, ior, priority)) in parts.into_iter().enumerate() {
            let glass = Material::Dielectric(Dielectric::new(ior, None).unwrap());
            let options = SurfaceOptions { priority, ..SurfaceOptions::default() };
            builder.surface_with(format!("body {i}"), shape, glass, options);
        }
        Self { name: name.into(), scene: builder.build().unwrap(), centre, size, meets: false }
    }

    /// How many bodies there are.
    #[allow(dead_code)]
    pub fn bodies(&self) -> usize {
        self.scene.geometry.surfaces().len()
    }

    fn meeting(self) -> Self {
        Self { meets: true, ..self }
    }

    /// A vertex, a point of an edge or of a face of some body; of a sphere, a point.
    fn target(&self, r: &mut Random, aim: Aim) -> DVec3 {
        let surfaces = self.scene.geometry.surfaces();
        match &surfaces[r.below(surfaces.len())].shape {
            Shape::Mesh(mesh) => {
                let [a, b, c] = mesh.triangle(r.below(mesh.triangles().len()));
                match r.below(5) {
                    _ if aim == Aim::Anywhere => {
                        let (u, v) = (r.unit(), r.unit());
                        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                        a + (b - a) * u + (c - a) * v
                    }
                    0 => a,
                    1 => (a + b) * 0.5,
                    2 | 3 => a + (b - a) * r.unit(),
                    _ => a + (b - a) * (r.unit() * 0.5) + (c - a) * (r.unit() * 0.5),
                }
            }
            Shape::Sphere(sphere) => sphere.centre() + r.direction() * sphere.radius(),
            _ => self.centre,
        }
    }

    /// From outside all bodies: at a point of one of them from anywhere, along an axis, or in an axis-parallel plane.
    fn ray(&self, r: &mut Random, aim: Aim) -> (DVec3, DVec3) {
        let far = 4.0 * self.size;
        let target = self.target(r, aim);
        if aim == Aim::Anywhere {
            let direction = r.direction();
            return (target - direction * far, direction);
        }
        let axis = |k: usize, sign: f64| DVec3::AXES[k] * sign;
        let sign = if r.below(2) == 0 { 1.0 } else { -1.0 };
        let k = r.below(3);
        let direction = match r.below(4) {
            0 => axis(k, sign),
            1 => (axis(k, sign) + axis((k + 1) % 3, r.unit() - 0.5)).normalize(),
            _ => r.direction(),
        };
        let origin = target - direction * far;
        // Through the aimed point as far as numbers have it.
        let direction = if r.below(2) == 0 { direction } else { (target - origin).normalize() };
        (origin, direction)
    }

    /// Straight through everything, from a place of which the state is `at`.
    fn walk(&self, mut origin: DVec3, direction: DVec3, mut at: Whereabouts) -> Tally {
        let Scene { geometry, media, .. } = &self.scene;
        let mut within = vec![0i32; geometry.surfaces().len()];
        let mut tally = Tally { rays: 1, ..Tally::default() };
        while let Some(hit) = geometry.nearest(origin, direction, &at, &mut tally.skipped) {
            tally.crossings += 1;
            if tally.crossings > MOST_CROSSINGS {
                return Tally { endless: 1, ..tally };
            }
            for hit in std::iter::once(hit).chain(geometry.joint_hits(&hit)) {
                let depth = &mut within[hit.surface.0 as usize];
                *depth += if hit.front { 1 } else { -1 };
                if !(0..=1).contains(depth) && hit.body == Body::Simple {
                    tally.doubles += 1;
                    *depth = (*depth).clamp(0, 1);
                }
            }
            media.leave(&mut at, &hit, hit.other_side());
            origin = hit.position;
        }
        let is_in = within.iter().any(|depth| *depth != 0) || media.bodies_of(&at).next().is_some();
        tally.leaks += u64::from(is_in);
        tally
    }

    /// Rays of one seed.
    pub fn run(&self, rays: u64, seed: u64, aim: Aim) -> Tally {
        let shown = AtomicU32::new(0);
        let of_ray = |i: u64| {
            let (origin, direction) = self.ray(&mut Random::new(seed, i), aim);
            let tally = self.walk(origin, direction, Whereabouts::default());
            let is_expected = self.meets && aim == Aim::Edges;
            if tally.faults() > 0 && !is_expected && shown.fetch_add(1, Ordering::Relaxed) < 5 {
                println!("{}: ray {i} of seed {seed}: {origin:?} {direction:?}: {tally:?}", self.name);
            }
            tally
        };
        (0..rays).into_par_iter().map(of_ray).reduce(Tally::default, Tally::plus)
    }
}

fn cuboid(centre: DVec3, half: DVec3) -> Shape {
    Shape::Mesh(box_mesh(centre - half, centre + half).unwrap())
}

fn ball(centre: DVec3, radius: f64) -> Shape {
    Shape::Sphere(Sphere::new(centre, radius).unwrap())
}

fn moved(mesh: &Mesh, by: impl Fn(DVec3) -> DVec3) -> Shape {
    let parts = MeshParts {
        vertices: mesh.vertices().iter().map(|v| by(*v)).collect(),
        triangles: mesh.triangles().to_vec(),
        ..MeshParts::default()
    };
    Shape::Mesh(Mesh::new(parts, Smoothing::Flat, true).unwrap().0)
}

/// Two meshes as one.
fn joined(a: &Mesh, b: &Mesh) -> Shape {
    let first = a.vertices().len() as u32;
    let others = b.triangles().iter().map(|t| t.map(|v| v + first));
    let parts = MeshParts {
        vertices: a.vertices().iter().chain(b.vertices()).copied().collect(),
        triangles: a.triangles().iter().copied().chain(others).collect(),
        ..MeshParts::default()
    };
    Shape::Mesh(Mesh::new(parts, Smoothing::Flat, true).unwrap().0)
}

/// All scenes.
pub fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    let (zero, one) = (DVec3::ZERO, DVec3::ONE);
    // Triangles a million times as long as wide: a rod of 12 sides, a flattened ball.
    let rod = moved(&icosphere(2), |v| DVec3::new(v.x * 1e-6, v.y * 1e-6, v.z));
    all.push(Case::new("needles of 1e6", vec![(rod, 1.5, 0)], zero, 1.0));
    let flat = moved(&icosphere(3), |v| DVec3::new(v.x, v.y, v.z * 1e-6));
    all.push(Case::new("slivers of 1e6", vec![(flat, 1.5, 0)], zero, 1.0));
    for exponent in [-9, -3, 0, 4, 9] {
        // Radii end at 1e-9 and 1e9 m.
        let s = 10f64.powi(exponent) * if exponent < 0 { 2.0 } else { 0.5 };
        let parts = vec![
            (cuboid(zero, one * s), 1.5, 0),
            (ball(zero, 0.9 * s), 1.4, 0),
            (moved(&icosphere(2), |v| v * (0.7 * s)), 1.3, 0),
        ];
        all.push(Case::new(format!("bodies of 1e{exponent} m"), parts, zero, s));
    }
    // Twenty in one another: boxes, and balls and boxes from 1e-9 to 1e9 m.
    let nested =
        (0..20).map(|k| (cuboid(zero, one * (1.0 - 0.045 * f64::from(k))), 1.2 + 0.02 * f64::from(k), 0));
    all.push(Case::new("20 boxes in one another", nested.collect(), zero, 1.0));
    let ladder = (0..20).map(|k| {
        let s = 1e9 * 10f64.powf(-18.0 * f64::from(k) / 19.0);
        (if k % 2 == 0 { ball(zero, s) } else { cuboid(zero, one * (0.5 * s)) }, 1.2 + 0.02 * f64::from(k), 0)
    });
    all.push(Case::new("20 from 1e-9 to 1e9 m", ladder.collect(), zero, 1e9));
    // Overlapping by priority, and one mesh that cuts itself.
    let parts = vec![
        (cuboid(zero, one), 1.5, 0),
        (cuboid(one * 0.7, one * 0.8), 1.4, 1),
        (moved(&icosphere(2), |v| v + DVec3::X), 1.3, 2),
        (ball(DVec3::Y, 0.6), 1.2, 3),
    ];
    all.push(Case::new("overlapping", parts, zero, 2.0).meeting());
    let cut = joined(&icosphere(2), &slab(6, 0.05));
    all.push(Case::new("one mesh that cuts itself", vec![(cut, 1.5, 0)], zero, 1.0).meeting());
    // In contact: a stack, a block in a corner, flush rims; as they stand, and turned.
    for (name, turn_deg) in [("", DVec3::ZERO), (", turned", DVec3::new(10.0, 20.0, 30.0))] {
        let turn = Transform::new(one, turn_deg, zero).unwrap();
        let cuboid = |centre: DVec3, half: DVec3| {
            moved(&box_mesh(centre - half, centre + half).unwrap(), |v| turn.point(v))
        };
        let stack = (0..10).map(|k| {
            let z = -0.9 + 0.2 * f64::from(k);
            (cuboid(DVec3::Z * z, DVec3::new(0.5, 0.5, 0.1)), 1.2 + 0.05 * f64::from(k), 0)
        });
        all.push(Case::new(format!("stack of 10{name}"), stack.collect(), zero, 1.0).meeting());
        let block = |x: f64, y: f64, z: f64| cuboid(DVec3::new(x, y, z), one * 0.25);
        let corner = vec![
            (block(0.0, 0.0, 0.0), 1.5, 0),
            (block(0.5, 0.0, 0.0), 1.4, 0),
            (block(0.0, 0.5, 0.0), 1.3, 0),
            (block(0.0, 0.0, -0.5), 1.2, 0),
        ];
        all.push(Case::new(format!("block in a corner{name}"), corner, zero, 1.0).meeting());
    }
    // Survey coordinates: bodies of 0.1 m at 5e6 m, the last digit 1 nm.
    let at = DVec3::new(5e6, 4.3e6, 120.0);
    let parts = vec![
        (cuboid(at, one * 0.05), 1.5, 0),
        (ball(at + DVec3::X * 0.2, 0.05), 1.4, 0),
        (moved(&icosphere(2), |v| at + DVec3::Y * 0.2 + v * 0.05), 1.3, 0),
        (moved(&slab(6, 0.05), |v| at - DVec3::Y * 0.2 + v * 0.05), 1.3, 0),
    ];
    all.push(Case::new("0.1 m at 5e6 m", parts, at, 0.3));
    all
}

#[test]
fn rays_through_bodies_neither_leak_nor_cross_twice() {
    for case in cases() {
        for aim in [Aim::Anywhere, Aim::Edges] {
            let tally = case.run(10_000, 1, aim);
            println!("{}, {aim:?}: {tally:?}", case.name);
            assert!(tally.crossings > tally.rays, "{}: rays meet bodies", case.name);
            assert_eq!((tally.doubles, tally.endless), (0, 0), "{}: {tally:?}", case.name);
            let most = if case.meets && aim == Aim::Edges { tally.rays / 50 } else { 0 };
            assert!(tally.leaks <= most, "{}: {tally:?}", case.name);
        }
    }
}

#[test]
fn a_body_that_a_ray_is_in_without_having_entered_it_is_seen() {
    // The test above must be able to fail.
    let case = Case::new("box", vec![(cuboid(DVec3::ZERO, DVec3::ONE), 1.5, 0)], DVec3::ZERO, 1.0);
    let through = |z: f64, at| case.walk(DVec3::new(0.1, 0.2, z), DVec3::NEG_Z, at);
    assert_eq!(through(3.0, Whereabouts::default()).faults(), 0);
    // Said to be in the box from the start, the ray meets its far face alone; from beyond the box, none.
    let inside = || Whereabouts::start([caustix::geometry::SurfaceId(0)]);
    assert_eq!((through(3.0, inside()).crossings, through(3.0, inside()).doubles), (1, 1));
    assert_eq!((through(-3.0, inside()).crossings, through(-3.0, inside()).leaks), (0, 1));
}
