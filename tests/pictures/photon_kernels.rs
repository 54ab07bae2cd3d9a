//! What of a kernel a surface holds: polygons, meshes, spheres and bowls against quadrature.

use std::f64::consts::{PI, TAU};

use caustix::geometry::{Mesh, MeshParts, Paraboloid, Shape, Smoothing, Sphere};
use caustix::picture::gather::footprint::Footprints;
use caustix::scene::camera::Kernel;
use glam::DVec3;

use crate::photons::{KERNELS, floor, geometry, hit, on_floor, u};
use crate::support::quadrature::Gauss;

/// The kernel's integral over x in [a, b], y in [c, d] cut by its disc, by quadrature along x, closed along y.
fn over_rectangle(kernel: Kernel, [a, b, c, d]: [f64; 4]) -> f64 {
    if a >= 1.0 || b <= -1.0 {
        return 0.0;
    }
    let slice = |x: f64| {
        let half = (1.0 - x * x).max(0.0).sqrt();
        let (low, high) = (c.max(-half), d.min(half));
        let primitive = |y: f64| match kernel {
            Kernel::Flat => y,
            Kernel::Epanechnikov => 2.0 * ((1.0 - x * x) * y - y * y * y / 3.0),
        };
        if high > low { (primitive(high) - primitive(low)) / PI } else { 0.0 }
    };
    // In the angle, where the slices' square roots are smooth; panels end where a corner enters.
    let mut edges: Vec<f64> = vec![a, b];
    for y in [c, d] {
        if y.abs() < 1.0 {
            let x = (1.0 - y * y).sqrt();
            edges.extend([-x, x]);
        }
    }
    edges.push(0.0);
    edges.retain(|x| *x >= a.max(-1.0) && *x <= b.min(1.0));
    edges.extend([a.max(-1.0), b.min(1.0)]);
    edges.sort_by(f64::total_cmp);
    let edges: Vec<f64> = edges.iter().map(|x| x.asin()).collect();
    Gauss::new(60).over_panels(&edges, |t| slice(t.sin()) * t.cos())
}

#[test]
fn a_kernel_over_a_polygon_agrees_with_quadrature() {
    let cases = [
        [-0.3, 0.4, -0.2, 0.5],
        [0.0, 2.0, 0.0, 2.0],
        [-2.0, 2.0, -0.3, 2.0],
        [-2.0, 0.2, -0.1, 0.6],
        [0.2, 0.9, 0.3, 0.8],
        [0.9, 3.0, -0.1, 0.1],
        [-5.0, 5.0, -5.0, 5.0],
        [1.1, 2.0, -1.0, 1.0],
        [-0.7, 0.7, -0.7, 0.75],
    ];
    for kernel in KERNELS {
        for [a, b, c, d] in cases {
            let corners = [(a, c), (b, c), (b, d), (a, d)].map(|(x, y)| DVec3::new(x, y, 0.0));
            let expected = over_rectangle(kernel, [a, b, c, d]);
            let found = kernel.over_polygon(&corners, DVec3::Z);
            assert!((found - expected).abs() < 1e-11, "{kernel:?} {:?}: {found} {expected}", [a, b, c, d]);
            // Off the centre's plane: a smaller disc, and for the sloping kernel a lower one.
            let lifted = corners.map(|v| v + DVec3::Z * 0.6);
            let disc = [a, b, c, d].map(|x| x / 0.8);
            let expected = match kernel {
                Kernel::Flat => 0.64 * over_rectangle(kernel, disc),
                Kernel::Epanechnikov => 0.64 * 0.64 * over_rectangle(kernel, disc),
            };
            let found = kernel.over_polygon(&lifted, DVec3::Z);
            assert!(
                (found - expected).abs() < 1e-11,
                "{kernel:?} lifted {:?}: {found} {expected}",
                [a, b, c, d]
            );
        }
        let quarter = [DVec3::ZERO, DVec3::X * 3.0, DVec3::new(3.0, 3.0, 0.0), DVec3::Y * 3.0];
        assert!((kernel.over_polygon(&quarter, DVec3::Z) - 0.25).abs() < 1e-15);
        assert_eq!(kernel.over_polygon(&quarter.map(|v| v + DVec3::Z * 1.5), DVec3::Z), 0.0);
    }
}

/// A grid of n x n cells of two triangles over the unit square, lifted by `height`.
fn sheet(n: u32, height: impl Fn(f64, f64) -> f64) -> Mesh {
    let mut parts = MeshParts::default();
    for j in 0..=n {
        for i in 0..=n {
            let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            parts.vertices.push(DVec3::new(x, y, height(x, y)));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let v = |di: u32, dj: u32| (j + dj) * (n + 1) + i + di;
            parts.triangles.extend([[v(0, 0), v(1, 0), v(1, 1)], [v(0, 0), v(1, 1), v(0, 1)]]);
        }
    }
    Mesh::new(parts, Smoothing::Flat, false).unwrap().0
}

#[test]
fn a_mesh_holds_of_a_kernel_what_its_faces_hold() {
    let flat = geometry(vec![Shape::Mesh(sheet(40, |_, _| 0.0))]);
    let rectangle = geometry(vec![floor()]);
    let (meshes, whole) = (Footprints::new(&flat), Footprints::new(&rectangle));
    for kernel in KERNELS {
        for i in 0..200 {
            let (x, y) = (u(i, 1), u(i, 2));
            for radius in [0.004, 0.03, 0.2, 0.7, 3.0] {
                let a = meshes.at(&on_floor(&flat, x, y)).integral(kernel, radius);
                let b = whole.at(&on_floor(&rectangle, x, y)).integral(kernel, radius);
                assert!((a - b).abs() < 1e-10 * b.max(1e-3), "{kernel:?} {x} {y} {radius}: {a} {b}");
            }
        }
    }
    // Waves: by the definition, adding up points of the surface itself, those turned less than 60 degrees.
    let height = |x: f64, y: f64| 0.05 * (20.0 * x).sin() * (15.0 * y).cos();
    let mesh = sheet(24, height);
    let waves = geometry(vec![Shape::Mesh(mesh.clone())]);
    let footprints = Footprints::new(&waves);
    let mut partly = 0;
    for i in 0..20 {
        let at = hit(&waves, DVec3::new(u(i, 3), u(i, 4), 1.0), DVec3::new(u(i, 3), u(i, 4), 0.0));
        for (kernel, radius) in [(Kernel::Flat, 0.3), (Kernel::Epanechnikov, 0.15)] {
            let mut expected = 0.0;
            for face in 0..mesh.triangles().len() {
                let [a, b, c] = mesh.triangle(face);
                let normal = (b - a).cross(c - a);
                if normal.normalize().dot(at.normal) <= 0.5 {
                    partly += 1;
                    continue;
                }
                let n = 60;
                for j in 0..n {
                    for k in 0..n - j {
                        for third in 0..2 {
                            let step = (f64::from(third) + 1.0) / 3.0;
                            let (p, q) =
                                ((f64::from(j) + step) / f64::from(n), (f64::from(k) + step) / f64::from(n));
                            if p + q >= 1.0 {
                                continue;
                            }
                            let t = (a + (b - a) * p + (c - a) * q - at.position).length_squared()
                                / (radius * radius);
                            if t < 1.0 {
                                let area = 0.5 * normal.length() / f64::from(n * n);
                                expected += kernel.shape(t) / (PI * radius * radius) * area;
                            }
                        }
                    }
                }
            }
            let found = footprints.at(&at).integral(kernel, radius);
            assert!((found - expected).abs() < 4e-3 * expected, "{i} {kernel:?}: {found} {expected}");
        }
    }
    assert!(partly > 1000, "some faces are turned away: {partly}");
}

#[test]
fn a_kernel_on_spheres_and_bowls() {
    let centre = DVec3::new(0.3, -0.1, 0.2);
    let ball = geometry(vec![Shape::Sphere(Sphere::new(centre, 0.5).unwrap())]);
    let footprints = Footprints::new(&ball);
    let at = hit(&ball, centre + DVec3::X * 2.0, centre);
    let here = footprints.at(&at);
    for kernel in KERNELS {
        // Turned less than 60 degrees is a chord below the radius; until there, exactly the disc.
        assert_eq!(here.integral(kernel, 0.1), 1.0);
        assert_eq!(here.integral(kernel, 0.5), 1.0);
    }
    assert!((here.integral(Kernel::Flat, 1.0) - 0.25).abs() < 1e-15);
    assert!((here.integral(Kernel::Epanechnikov, 1.0) - 0.4375).abs() < 1e-15);

    // A bowl: the integral over its own coordinates, dA = rho sqrt(1 + rho^2 / 4 f^2) drho dphi.
    let (f, rim) = (0.3, 0.5);
    let bowl = geometry(vec![Shape::Paraboloid(Paraboloid::new(DVec3::ZERO, DVec3::Z, f, rim).unwrap())]);
    let footprints = Footprints::new(&bowl);
    for kernel in KERNELS {
        for (x, radius) in [(0.0, 0.05), (0.3, 0.07), (0.2, 0.25), (0.45, 0.2), (0.48, 0.05)] {
            let at = hit(&bowl, DVec3::new(x, 0.0, 1.0), DVec3::new(x, 0.0, 0.0));
            let (mut expected, n) = (0.0, 1200);
            for i in 0..n {
                for j in 0..n {
                    let (rho, phi) = (
                        rim * (f64::from(i) + 0.5) / f64::from(n),
                        TAU * (f64::from(j) + 0.5) / f64::from(n),
                    );
                    let p = DVec3::new(rho * phi.cos(), rho * phi.sin(), rho * rho / (4.0 * f));
                    let normal = DVec3::new(-p.x, -p.y, 2.0 * f).normalize();
                    let t = (p - at.position).length_squared() / (radius * radius);
                    if t < 1.0 && normal.dot(at.normal) > 0.5 {
                        let area =
                            rho * (1.0 + rho * rho / (4.0 * f * f)).sqrt() * rim * TAU / f64::from(n * n);
                        expected += kernel.shape(t) / (PI * radius * radius) * area;
                    }
                }
            }
            let found = footprints.at(&at).integral(kernel, radius);
            assert!(
                (found - expected).abs() < 3e-3 * expected,
                "{kernel:?} {x} {radius}: {found} {expected}"
            );
        }
    }
}
