//! Nothing leaks: rays aimed at edges, vertices and along faces of closed meshes, walked straight through.

use std::sync::atomic::{AtomicU32, Ordering};

use caustix::geometry::{
    Geometry, Mesh, MeshParts, Shape, Side, Smoothing, SurfaceId, Whereabouts, box_mesh,
};
use glam::DVec3;
use rayon::prelude::*;

use crate::meshes::{Random, Tally, icosphere, named, slab};

/// One closed mesh and where to aim.
struct Target {
    geometry: Geometry,
    mesh: Mesh,
}

impl Target {
    fn new(mesh: Mesh) -> Self {
        assert!(mesh.topology().is_closed());
        Self { geometry: Geometry::build(vec![named("mesh", Shape::Mesh(mesh.clone()))]).unwrap(), mesh }
    }

    /// A vertex, a point of an edge or the middle of a face.
    fn aim(&self, r: &mut Random) -> DVec3 {
        let face = r.below(self.mesh.triangles().len());
        let [a, b, c] = self.mesh.triangle(face);
        match r.below(5) {
            0 => a,
            1 => (a + b) * 0.5,
            2 | 3 => a + (b - a) * r.unit(),
            _ => a + (b - a) * (r.unit() * 0.5) + (c - a) * (r.unit() * 0.5),
        }
    }
}

/// Straight through everything from a point that is inside (or not).
fn walk(geometry: &Geometry, mut origin: DVec3, direction: DVec3, inside: bool) -> Tally {
    let mut at = Whereabouts::start(inside.then_some(SurfaceId(0)));
    let mut tally = Tally { rays: 1, ..Tally::default() };
    let mut behind = inside;
    while let Some(hit) = geometry.nearest(origin, direction, &at, &mut tally.skipped) {
        tally.crossings += 1;
        if tally.crossings > 200 {
            tally.endless = 1;
            return tally;
        }
        tally.doubles += u64::from(hit.front == behind);
        behind = hit.front;
        at.leave(&hit, if hit.front { Side::Back } else { Side::Front });
        origin = hit.position;
    }
    tally.leaks += u64::from(behind);
    tally
}

fn run(
    target: &Target,
    n: u64,
    seed: u64,
    ray: impl Fn(&mut Random, &Target) -> (DVec3, DVec3, bool) + Sync,
) -> Tally {
    // A few failures are enough to look at.
    let shown = AtomicU32::new(0);
    (0..n)
        .into_par_iter()
        .map(|i| {
            let mut r = Random::new(seed, i);
            let (origin, direction, inside) = ray(&mut r, target);
            let tally = walk(&target.geometry, origin, direction, inside);
            if tally.faults() > 0 && shown.fetch_add(1, Ordering::Relaxed) < 5 {
                println!("ray {i} of seed {seed}: {origin:?} {direction:?} inside {inside}: {tally:?}");
            }
            tally
        })
        .reduce(Tally::default, Tally::plus)
}

fn from_inside(centre: DVec3) -> impl Fn(&mut Random, &Target) -> (DVec3, DVec3, bool) + Sync {
    move |r, t| {
        let origin = centre + r.direction() * (0.05 * r.unit());
        (origin, (t.aim(r) - origin).normalize(), true)
    }
}

fn from_outside(r: &mut Random, t: &Target) -> (DVec3, DVec3, bool) {
    let distance = if r.below(20) == 0 { 1e6 } else { 3.0 + 4.0 * r.unit() };
    let aim = t.aim(r);
    let origin = aim + r.direction() * distance;
    (origin, (aim - origin).normalize(), false)
}

/// Along an axis, through a point of the mesh: in the planes of a box's faces, along its edges.
fn axis_parallel(r: &mut Random, t: &Target) -> (DVec3, DVec3, bool) {
    let mut direction = [0.0; 3];
    direction[r.below(3)] = if r.below(2) == 0 { 1.0 } else { -1.0 };
    let direction = DVec3::from_array(direction);
    let mut origin = t.aim(r) - direction * 4.0;
    if r.below(3) == 0 {
        // Within a face's plane, slanting.
        let other = DVec3::new(direction.y, direction.z, direction.x);
        let slanted = (direction + other * (r.unit() - 0.5)).normalize();
        origin = t.aim(r) - slanted * 4.0;
        return (origin, slanted, false);
    }
    (origin, direction, false)
}

fn check(name: &str, tally: Tally) {
    println!("{name}: {tally:?}");
    assert_eq!((tally.leaks, tally.doubles, tally.endless), (0, 0, 0), "{name}");
}

#[test]
fn rays_at_edges_and_vertices_neither_leak_nor_hit_twice() {
    let cube = || Target::new(box_mesh(DVec3::new(-0.5, -0.3, -0.7), DVec3::new(0.5, 0.6, 0.1)).unwrap());
    let ball = || Target::new(icosphere(3));
    let slab = || Target::new(slab(24, 0.05));
    check("box from inside", run(&cube(), 100_000, 1, from_inside(DVec3::new(0.0, 0.0, -0.3))));
    check("box from outside", run(&cube(), 100_000, 2, from_outside));
    check("box along axes", run(&cube(), 100_000, 3, axis_parallel));
    check("ball from inside", run(&ball(), 100_000, 4, from_inside(DVec3::ZERO)));
    check("ball from outside", run(&ball(), 80_000, 5, from_outside));
    check("ball along axes", run(&ball(), 50_000, 6, axis_parallel));
    check("slab from inside", run(&slab(), 80_000, 7, from_inside(DVec3::new(0.01, -0.02, 0.0))));
    check("slab from outside", run(&slab(), 80_000, 8, from_outside));
    check("slab along axes", run(&slab(), 50_000, 9, axis_parallel));
}

#[test]
fn a_missing_triangle_is_seen_as_a_leak() {
    // The test above must be able to fail: an open mesh, declared the inside of nothing, lets rays out.
    let mesh = icosphere(2);
    let parts = MeshParts {
        vertices: mesh.vertices().to_vec(),
        triangles: mesh.triangles()[1..].to_vec(),
        ..MeshParts::default()
    };
    let (open, _) = Mesh::new(parts, Smoothing::Flat, false).unwrap();
    assert_eq!(open.topology().open_edges, 3);
    let geometry = Geometry::build(vec![named("open", Shape::Mesh(open))]).unwrap();
    let [a, b, c] = mesh.triangle(0);
    let tally = walk(&geometry, DVec3::ZERO, ((a + b + c) / 3.0).normalize(), true);
    assert_eq!((tally.crossings, tally.leaks), (0, 1));
}
