//! Writes the lenses of `scenes/luminaires/`: `cargo run --release --example make_lenses -- scenes/luminaires`.
//!
//! This file is their documentation. Both are of acrylic (refractive index 1.49) over a light-emitting diode at the origin
//! that shines towards +z by the cosine law, so that sin^2(theta) of its flux lies within theta of the axis. Each surface
//! turns the ray of each theta into a wanted direction: with i the ray before it and t after it (unit vectors in media n_i
//! and n_t), Snell's law and the law of reflection say that n_t t - n_i i is along the normal, and a point of the surface moves
//! across its normal, which is a differential equation for it in theta.
//!
//! | mesh | what |
//! |---|---|
//! | `tir_collimator.obj` | a collimator, closed, about 200,000 triangles: the middle refracts, the side reflects totally, both into I ~ (1 - (delta / delta_m)^2)^2, half of whose maximum lies at 5 degrees |
//! | `street_lens.obj` | a lens over a half sphere of air, closed, about 200,000 triangles: the ray of direction (sx, sy, sz) is wanted along (1.7 sx, 0.7 sy - 0.25, 1): 60 degrees to both sides along the road (x), from 44 degrees over the street (-y) to 24 on the other side |

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write;
use std::path::Path;

/// Refractive index of acrylic.
const N: f64 = 1.49;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: make_lenses FOLDER")?;
    for (name, text) in files(1.0) {
        std::fs::write(Path::new(&folder).join(name), text)?;
    }
    Ok(())
}

/// Name and text of every file, of meshes with so many times as many points along each direction.
pub fn files(finer: f64) -> Vec<(&'static str, String)> {
    vec![("tir_collimator.obj", Collimator::new(finer).obj(finer)), ("street_lens.obj", street_lens(finer))]
}

type V2 = [f64; 2];

fn add(a: V2, s: f64, b: V2) -> V2 {
    [a[0] + s * b[0], a[1] + s * b[1]]
}

fn dot(a: V2, b: V2) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The direction at this angle from the axis: (across it, along it).
fn at(angle: f64) -> V2 {
    [angle.sin(), angle.cos()]
}

fn points(count: f64, finer: f64) -> usize {
    (count * finer).round().max(2.0) as usize
}

/// A piece of a profile that is smooth in itself: points (r, z) and normals out of the body.
struct Piece(Vec<(V2, V2)>);

/// The profile of the collimator, from the axis at its lower end round to the axis at its top, m.
struct Collimator {
    pieces: Vec<Piece>,
}

/// Where the target I ~ (1 - x^2)^2, x = delta / delta_m, has half of its maximum.
const HALF_DEG: f64 = 5.0;
/// The ray at which the middle ends and the side begins.
const MIDDLE_DEG: f64 = 32.0;
/// Radius of the hole for the diode.
const HOLE_M: f64 = 0.0025;

/// The angle within which this part of the target's flux lies, by bisection of its integral (delta is small: sin delta = delta).
fn target(part: f64) -> f64 {
    let most = HALF_DEG.to_radians() / (1.0 - 0.5f64.sqrt()).sqrt();
    // Integral of (1 - x^2)^2 x is (1 - (1 - x^2)^3) / 6.
    most * (1.0 - (1.0 - part).cbrt()).max(0.0).sqrt()
}

impl Collimator {
    fn new(finer: f64) -> Self {
        let edge = MIDDLE_DEG.to_radians();
        let inside = |delta: f64| at((delta.sin() / N).asin());
        let flux = |theta: f64| theta.sin().powi(2);
        // The middle: r' = -r (e.N) / (i.N) for the point r i, N = n t - i, e across i.
        let wanted = |theta: f64| inside(target(flux(theta) / flux(edge)));
        let normal = |theta: f64| add([-at(theta)[0], -at(theta)[1]], N, wanted(theta));
        let slope = |theta: f64| {
            let across = [theta.cos(), -theta.sin()];
            -dot(across, normal(theta)) / dot(at(theta), normal(theta))
        };
        // ln r along theta: its size is free, and the edge of the hole fixes it.
        let logs = integral(slope, edge, points(120.0, finer));
        let scale = HOLE_M / edge.sin() / logs[logs.len() - 1].1.exp();
        let middle = logs.iter().map(|&(theta, log)| {
            let point = at(theta).map(|x| x * scale * log.exp());
            (point, outwards(normal(theta), [0.0, -1.0]))
        });
        let middle = Piece(middle.collect());
        // The side: behind the wall of the hole at P the ray goes on along d, and s' = -(P' + s d').N / (d.N) for the
        // point P + s d, N = t - d; from the horizontal ray, where s is the width of the foot, to that of the edge.
        let wall = |theta: f64| [HOLE_M, HOLE_M / theta.tan()];
        let within = |theta: f64| {
            let along = theta.cos() / N;
            [(1.0 - along * along).sqrt(), along]
        };
        let wanted = |theta: f64| inside(target((1.0 - flux(theta)) / (1.0 - flux(edge))));
        let normal = |theta: f64| add(wanted(theta), -1.0, within(theta));
        let moves = |theta: f64, s: f64| {
            let h = 1e-6;
            let moved =
                |of: &dyn Fn(f64) -> V2| add(of(theta + h), -1.0, of(theta - h)).map(|x| x / (2.0 * h));
            let by = add(moved(&wall), s, moved(&within));
            -dot(by, normal(theta)) / dot(within(theta), normal(theta))
        };
        const FOOT_M: f64 = 0.0003;
        let steps = points(180.0, finer);
        let mut side = Vec::new();
        let (mut s, step) = (FOOT_M, (edge - FRAC_PI_2) / steps as f64);
        for i in 0..=steps {
            let theta = FRAC_PI_2 + step * i as f64;
            let point = add(wall(theta), s, within(theta));
            side.push((point, outwards(normal(theta), [1.0, -0.5])));
            s = runge_kutta(moves, theta, s, step);
        }
        let (foot, rim) = (side[0].0, side[steps].0);
        // A step out and a small collar, so that no ray meets the rim.
        const COLLAR_M: f64 = 0.0002;
        let collar = [rim[0] + COLLAR_M, rim[1]];
        let top = rim[1] + COLLAR_M;
        let straight = |from: V2, to: V2, count: f64, normal: V2| {
            let count = points(count, finer);
            let part = |i: usize| add(from, i as f64 / count as f64, add(to, -1.0, from));
            Piece((0..=count).map(|i| (part(i), normal)).collect())
        };
        let hole = wall(edge);
        Self {
            pieces: vec![
                middle,
                straight(hole, [HOLE_M, 0.0], 40.0, [-1.0, 0.0]),
                straight([HOLE_M, 0.0], foot, 2.0, [0.0, -1.0]),
                Piece(side),
                straight(rim, collar, 2.0, [0.0, -1.0]),
                straight(collar, [collar[0], top], 2.0, [1.0, 0.0]),
                straight([collar[0], top], [0.0, top], 50.0, [0.0, 1.0]),
            ],
        }
    }

    /// Turned about the axis.
    fn obj(&self, finer: f64) -> String {
        let around = points(256.0, finer);
        let mut obj = Obj::new("a collimator for a light-emitting diode, m");
        // Rings of vertices: neighbouring pieces share the one between them, but for its normals.
        let mut first = obj.ring(self.pieces[0].0[0].0, around);
        for Piece(points) in &self.pieces {
            let mut before = (first.clone(), obj.normals(points[0].1, around));
            for &(point, normal) in &points[1..] {
                let ring = (obj.ring(point, around), obj.normals(normal, around));
                obj.band(&before, &ring);
                before = ring;
            }
            first = before.0;
        }
        obj.text
    }
}

/// A normal on the side of this direction, as a unit vector.
fn outwards(normal: V2, side: V2) -> V2 {
    let length = dot(normal, normal).sqrt().copysign(dot(normal, side));
    normal.map(|x| x / length)
}

/// The integral of `slope` from 0 to each of so many steps to `end`, by Simpson's rule.
fn integral(slope: impl Fn(f64) -> f64, end: f64, steps: usize) -> Vec<(f64, f64)> {
    let step = end / steps as f64;
    let mut sum = 0.0;
    let mut all = vec![(0.0, 0.0)];
    for i in 0..steps {
        let from = step * i as f64;
        sum += step / 6.0 * (slope(from) + 4.0 * slope(from + 0.5 * step) + slope(from + step));
        all.push((from + step, sum));
    }
    all
}

fn runge_kutta(slope: impl Fn(f64, f64) -> f64, x: f64, y: f64, h: f64) -> f64 {
    let a = slope(x, y);
    let b = slope(x + 0.5 * h, y + 0.5 * h * a);
    let c = slope(x + 0.5 * h, y + 0.5 * h * b);
    let d = slope(x + h, y + h * c);
    y + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
}

/// Tangents of the angles from the axis within which the light of the street lens goes: along the road to both sides, across it
/// to both sides of a direction, and that direction's (-y is the street).
const ALONG: f64 = 1.7;
const ACROSS: f64 = 0.7;
const FORWARD: f64 = -0.25;

/// ln r along theta in the plane of this azimuth, from ln 1 on the axis: r' = -r (e.N) / (i.N), N = n i - t.
fn leaving(phi: f64, steps: usize) -> Vec<f64> {
    let slope = |theta: f64| {
        let (sine, cosine) = theta.sin_cos();
        let i = [sine * phi.cos(), sine * phi.sin(), cosine];
        let across = [cosine * phi.cos(), cosine * phi.sin(), -sine];
        let t = [ALONG * i[0], ACROSS * i[1] + FORWARD, 1.0];
        let length = dot3(t, t).sqrt();
        let normal: [f64; 3] = std::array::from_fn(|k| N * i[k] - t[k] / length);
        -dot3(across, normal) / dot3(i, normal)
    };
    integral(slope, FRAC_PI_2, steps).into_iter().map(|(_, log)| log).collect()
}

fn dot3(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn street_lens(finer: f64) -> String {
    const INNER_M: f64 = 0.002;
    const OUTER_M: f64 = 0.007;
    let (steps, around) = (points(240.0, finer), points(320.0, finer));
    let azimuth = |j: usize| TAU * j as f64 / around as f64;
    let logs: Vec<Vec<f64>> = (0..around).map(|j| leaving(azimuth(j), steps)).collect();
    let place = |i: usize, j: usize| {
        let (theta, phi) = (FRAC_PI_2 * i as f64 / steps as f64, azimuth(j));
        let r = OUTER_M * logs[j][i].exp();
        [r * theta.sin() * phi.cos(), r * theta.sin() * phi.sin(), r * theta.cos()]
    };
    let mut obj = Obj::new("a street lens for a light-emitting diode, m");
    // From the top down the outside, in along the foot, and up the half sphere of air.
    let apex = obj.vertex(place(0, 0));
    let up = obj.normal([0.0, 0.0, 1.0]);
    let mut before = (vec![apex; around], vec![up; around]);
    for i in 1..=steps {
        let ring = (0..around).map(|j| obj.vertex(place(i, j))).collect::<Vec<_>>();
        let normals = (0..around).map(|j| {
            let (left, right) = (place(i, (j + around - 1) % around), place(i, (j + 1) % around));
            let below = place((i + 1).min(steps), j);
            let above = place(i - 1, j);
            obj.normal(cross(sub(below, above), sub(right, left)))
        });
        let ring = (ring, normals.collect());
        obj.band(&ring, &before);
        before = ring;
    }
    let down = vec![obj.normal([0.0, 0.0, -1.0]); around];
    let rim = (before.0, down.clone());
    let sphere = |theta: f64| [INNER_M * theta.sin(), INNER_M * theta.cos()];
    let edge = obj.ring(sphere(FRAC_PI_2), around);
    obj.band(&(edge.clone(), down), &rim);
    let half = points(80.0, finer);
    let mut before = (edge, obj.normals([-1.0, 0.0], around));
    for i in (0..half).rev() {
        let theta = FRAC_PI_2 * i as f64 / half as f64;
        let ring = (obj.ring(sphere(theta), around), obj.normals(at(theta).map(|x| -x), around));
        obj.band(&ring, &before);
        before = ring;
    }
    obj.text
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

/// An OBJ on its way.
struct Obj {
    text: String,
    vertices: usize,
    normals: usize,
}

/// Vertices and normals around the axis.
type Ring = (Vec<usize>, Vec<usize>);

impl Obj {
    fn new(what: &str) -> Self {
        Self { text: format!("# {what}; written by examples/make_lenses.rs\n"), vertices: 0, normals: 0 }
    }

    fn vertex(&mut self, [x, y, z]: [f64; 3]) -> usize {
        let _infallible = writeln!(self.text, "v {x:.9} {y:.9} {z:.9}");
        self.vertices += 1;
        self.vertices
    }

    fn normal(&mut self, normal: [f64; 3]) -> usize {
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [x, y, z] = normal.map(|x| x / length);
        let _infallible = writeln!(self.text, "vn {x:.7} {y:.7} {z:.7}");
        self.normals += 1;
        self.normals
    }

    /// A point of a profile turned about the axis; one vertex on it.
    fn ring(&mut self, [r, z]: V2, around: usize) -> Vec<usize> {
        if r == 0.0 {
            return vec![self.vertex([0.0, 0.0, z]); around];
        }
        let turned = |j: usize| {
            let phi = TAU * j as f64 / around as f64;
            [r * phi.cos(), r * phi.sin(), z]
        };
        (0..around).map(|j| self.vertex(turned(j))).collect()
    }

    fn normals(&mut self, [r, z]: V2, around: usize) -> Vec<usize> {
        let turned = |j: usize| {
            let phi = TAU * j as f64 / around as f64;
            [r * phi.cos(), r * phi.sin(), z]
        };
        (0..around).map(|j| self.normal(turned(j))).collect()
    }

    /// The faces between two rings, their fronts to the right of one who goes from the first to the second in a picture with
    /// r to the right and z up.
    fn band(&mut self, (low, low_normals): &Ring, (high, high_normals): &Ring) {
        for j in 0..low.len() {
            let k = (j + 1) % low.len();
            let corner = |ring: &[usize], normals: &[usize], i: usize| format!("{}//{}", ring[i], normals[i]);
            let (a, b) = (corner(low, low_normals, j), corner(low, low_normals, k));
            let (c, d) = (corner(high, high_normals, k), corner(high, high_normals, j));
            if low[j] != low[k] {
                let _infallible = writeln!(self.text, "f {a} {b} {c}");
            }
            if high[j] != high[k] {
                let _infallible = writeln!(self.text, "f {a} {c} {d}");
            }
        }
    }
}
