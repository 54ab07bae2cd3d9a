//! Writes the turned meshes of `scenes/`: `cargo run --release --example make_glassware -- scenes/glassware`.
//!
//! This file is their documentation. Each mesh is a profile, points (r, z) in metres, turned about the z axis; vertex
//! normals are those of the profile. Fronts look to the right of one who follows the profile's points from first to last, in
//! a picture with r to the right and z up; so a solid's profile starts on the axis at the bottom.
//!
//! | mesh | what |
//! |---|---|
//! | `wine_glass.obj` | a stemmed glass, closed: foot, stem, bowl, rim and the inside; its foot is flat, at z = 0 |
//! | `wine.obj` | the wine in it, closed: its side and bottom run half-way through the glass, which fills what is in both (`priority`) |
//! | `ring.obj` | a finger ring of 50 mm: 46 mm inside, 22 mm high, its edges rounded |
//!
//! The bowl is r = R sqrt(sin(0.72 pi t)), t = (z - z0) / (z1 - z0), round below, and 0.88 R wide at the rim; inside it is the
//! same with R less by the wall of 1.4 mm and z0 higher by 4 mm, and the wine's side is the same with half of both.

use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

/// Vertices around the axis.
const AROUND: usize = 64;

/// A point of a profile and the direction across it.
#[derive(Clone, Copy)]
struct Point {
    r: f64,
    z: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: make_glassware FOLDER")?;
    for (name, text) in files() {
        std::fs::write(Path::new(&folder).join(name), text)?;
    }
    Ok(())
}

/// Name and text of every file.
pub fn files() -> Vec<(&'static str, String)> {
    let glass = Glass::default();
    let closed: Vec<Point> = glass.outside().into_iter().chain(glass.inside().into_iter().rev()).collect();
    vec![
        ("wine_glass.obj", turned(&closed, false, "a wine glass")),
        ("wine.obj", turned(&glass.wine(), false, "the wine in a wine glass, reaching into it")),
        ("ring.obj", turned(&ring(), true, "a ring")),
    ]
}

/// The measures of the wine glass, m.
struct Glass {
    foot_radius_m: f64,
    foot_height_m: f64,
    stem_radius_m: f64,
    bowl_radius_m: f64,
    bowl_bottom_m: f64,
    rim_m: f64,
    wall_m: f64,
    level_m: f64,
}

impl Default for Glass {
    fn default() -> Self {
        Self {
            foot_radius_m: 0.036,
            foot_height_m: 0.0025,
            stem_radius_m: 0.0038,
            bowl_radius_m: 0.042,
            bowl_bottom_m: 0.085,
            rim_m: 0.200,
            wall_m: 0.0014,
            level_m: 0.140,
        }
    }
}

/// The bowl's radius where t goes from 0 at its bottom to 1 at the rim.
fn bowl(radius_m: f64, t: f64) -> f64 {
    radius_m * (0.72 * PI * t.clamp(0.0, 1.0)).sin().sqrt()
}

impl Glass {
    /// From the axis at the bottom along foot, stem and bowl to the rim.
    fn outside(&self) -> Vec<Point> {
        let h = self.foot_height_m;
        let edge = 0.5 * h;
        // Flat, so in one piece: every photon on the table is asked about each facet that stands on it.
        let mut points: Vec<Point> = [0.0, self.foot_radius_m - edge].map(|r| Point { r, z: 0.0 }).into();
        // The foot's edge, a half circle.
        points.extend((1..=6).map(|i| {
            let angle = PI * (f64::from(i) / 6.0 - 0.5);
            Point { r: self.foot_radius_m - edge + edge * angle.cos(), z: edge + edge * angle.sin() }
        }));
        // Foot, stem and bowl as one curve: the sixth-power mean of a flaring stem and the bowl.
        let height = self.rim_m - self.bowl_bottom_m;
        let radius = |z: f64| {
            let flare = (self.foot_radius_m - edge - self.stem_radius_m) * (-(z - h) / 0.0045).exp();
            let stem = self.stem_radius_m + flare;
            let bowl = bowl(self.bowl_radius_m, (z - self.bowl_bottom_m) / height);
            (stem.powi(6) + bowl.powi(6)).powf(1.0 / 6.0)
        };
        let curve = |points: &mut Vec<Point>, n: u32, z: &dyn Fn(f64) -> f64| {
            points.extend((1..=n).map(|i| z(f64::from(i) / f64::from(n))).map(|z| Point { r: radius(z), z }));
        };
        curve(&mut points, 16, &|s| h + 0.03 * s * s);
        curve(&mut points, 6, &|s| h + 0.03 + (self.bowl_bottom_m - 0.003 - h - 0.03) * s);
        curve(&mut points, 34, &|s| {
            let from = self.bowl_bottom_m - 0.003;
            from + (self.rim_m - from) * (0.35 * s + 0.65 * s * s)
        });
        // The rim, a half circle over the wall.
        let outer = radius(self.rim_m);
        let inner = bowl(self.bowl_radius_m - self.wall_m, 1.0);
        let (middle, half) = (0.5 * (outer + inner), 0.5 * (outer - inner));
        points.extend((1..6).map(|i| {
            let angle = PI * f64::from(i) / 6.0;
            Point { r: middle + half * angle.cos(), z: self.rim_m + half * angle.sin() }
        }));
        points
    }

    /// The curve at this part of the bowl's wall, 0 outside and 1 inside: the t of the wine's level, and the point of a t,
    /// which goes from 0 at the bottom to 1 at the rim.
    fn within(&self, part: f64) -> (f64, impl Fn(f64) -> Point) {
        let bottom = self.bowl_bottom_m + 0.004 * part;
        let (height, radius) = (self.rim_m - bottom, self.bowl_radius_m - self.wall_m * part);
        ((self.level_m - bottom) / height, move |t| Point { r: bowl(radius, t), z: bottom + height * t })
    }

    /// From the axis at the bottom of the bowl, inside, to the rim; the level of the wine is one of the points.
    fn inside(&self) -> Vec<Point> {
        let (level, at) = self.within(1.0);
        // Even steps of the root: even steps along the round bottom.
        let below = (0..=24).map(|i| level * (f64::from(i) / 24.0).powi(2));
        let above = (1..=14).map(|i| level + (1.0 - level) * f64::from(i) / 14.0);
        below.chain(above).map(at).collect()
    }

    /// From the axis at the bottom, half-way through the glass, to the level, and along it to the axis.
    fn wine(&self) -> Vec<Point> {
        let (level, at) = self.within(0.5);
        let flat = |r: f64| Point { r, z: self.level_m };
        let (level_inside, at_inside) = self.within(1.0);
        let (side, inside) = (at(level).r, at_inside(level_inside).r);
        let mut points: Vec<Point> = (0..24).map(|i| at(level * (f64::from(i) / 24.0).powi(2))).collect();
        // The normal at the corner is slanted; the next point, still in the glass, is level.
        points.extend([flat(side), flat(0.5 * (side + inside)), flat(0.5 * inside), flat(0.0)]);
        points
    }
}

/// A rectangle with rounded corners beside the axis, as a closed loop.
fn ring() -> Vec<Point> {
    let (inner, outer, height, round) = (0.046, 0.050, 0.022, 0.0015);
    let corner = |r: f64, z: f64, from: f64| {
        (0..=6).map(move |i| {
            let angle = (from + 90.0 * f64::from(i) / 6.0).to_radians();
            Point { r: r + round * angle.cos(), z: z + round * angle.sin() }
        })
    };
    let mut points: Vec<Point> = corner(outer - round, round, -90.0).collect();
    points.extend(corner(outer - round, height - round, 0.0));
    points.extend(corner(inner + round, height - round, 90.0));
    points.extend(corner(inner + round, round, 180.0));
    points
}

/// A profile turned about the axis, as OBJ. `closed`: the last point is followed by the first.
fn turned(profile: &[Point], closed: bool, title: &str) -> String {
    let n = profile.len();
    let neighbour = |i: usize, step: isize| {
        let j = i as isize + step;
        let j = if closed { j.rem_euclid(n as isize) } else { j.clamp(0, n as isize - 1) };
        profile[j as usize]
    };
    let mut text = format!("# {title}: examples/make_glassware.rs\n");
    let mut first = Vec::with_capacity(n);
    let mut count = 0;
    for (i, p) in profile.iter().enumerate() {
        first.push(count);
        let (a, b) = (neighbour(i, -1), neighbour(i, 1));
        // To the right of the way along the profile; on the axis along it.
        let (mut nr, mut nz) = (b.z - a.z, a.r - b.r);
        if p.r == 0.0 {
            (nr, nz) = (0.0, nz.signum());
        }
        let length = nr.hypot(nz);
        (nr, nz) = (nr / length, nz / length);
        let around = if p.r == 0.0 { 1 } else { AROUND };
        count += around;
        for k in 0..around {
            let (sin, cos) = (2.0 * PI * k as f64 / AROUND as f64).sin_cos();
            let _ = writeln!(text, "v {:.7} {:.7} {:.7}", p.r * cos, p.r * sin, p.z);
            let _ = writeln!(text, "vn {:.5} {:.5} {:.5}", nr * cos, nr * sin, nz);
        }
    }
    let vertex = |i: usize, k: usize| first[i] + 1 + if profile[i].r == 0.0 { 0 } else { k % AROUND };
    let mut face = |corners: [usize; 3]| {
        let [a, b, c] = corners;
        if a != b && b != c && c != a {
            let _ = writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}");
        }
    };
    for i in 0..if closed { n } else { n - 1 } {
        let j = (i + 1) % n;
        for k in 0..AROUND {
            face([vertex(i, k), vertex(i, k + 1), vertex(j, k + 1)]);
            face([vertex(i, k), vertex(j, k + 1), vertex(j, k)]);
        }
    }
    text
}
