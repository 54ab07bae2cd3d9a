//! The nephroid: parallel light that falls aslant into a mirror cylinder.
//!
//! Light in the direction (sin e, 0, -cos e) meets the wall of radius R at R (cos t, sin t), height z, and goes on with the
//! horizontal direction (-cos 2t, -sin 2t); it comes down on the floor after the horizontal distance s = z tan e. The point of
//! arrival moves with t and s by the area |R cos t - 2 s| dt ds, so the illuminance that one reflection brings is
//!
//!     E0 cos e  sum of R cos t / |R cos t - 2 s|
//!
//! over the (t, s) that arrive there. It is without bound where s = R cos t / 2, on the curve
//! x = R (3 cos t - cos 3t) / 4, y = R (3 sin t - sin 3t) / 4 = R sin^3 t: a nephroid with its cusp at (R / 2, 0). A wall of the
//! height h sends light as far as s = h tan e, so all of the curve is there if h tan e is at least R / 2, whatever e is.
//! Half a cylinder is enough: nothing then stands in the light.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

use caustix::emitter::{AimFrame, Beam, BeamSection, Emitter};
use caustix::geometry::{Mesh, MeshParts, Smoothing};
use caustix::geometry::{Shape, Surface};
use caustix::picture::{AnyPicture, trace_picture};
use caustix::run::{Outcome, trace};
use caustix::scene::camera::{Camera, CameraSpec, Filter, Method};
use caustix::scene::receiver::ReceiverEvents;
use caustix::scene::receiver::ReceiverSpec;
use caustix::scene::{Scene, SceneBuilder};
use caustix::surface::{Material, Mirror, Reflectance};
use glam::DVec3;

use crate::support::judge::{SIGNIFICANCE, judge};
use crate::support::pictures::{grey, plan, rectangle, unwatched};

/// The farthest that reflected light goes along the floor, in radii of the cylinder (R = 1 m throughout).
const REACH: f64 = 0.6;

/// Cells to a radius.
const FINE: u32 = 128;
const COARSE: u32 = 16;
const THIN: u32 = 256;
const THIN_ROWS: u32 = 4095;

/// Half the wall of a cylinder about z, open towards -x, in flat facets a twentieth of a fine cell wide; its height.
fn wall(inclination: f64) -> (Surface, f64) {
    let (facets, height) = (8192u32, REACH / inclination.tan());
    let mut parts = MeshParts::default();
    for i in 0..=facets {
        let (sin, cos) = (PI * f64::from(i) / f64::from(facets) - FRAC_PI_2).sin_cos();
        // A hair above the floor.
        parts.vertices.extend([DVec3::new(cos, sin, 1e-6), DVec3::new(cos, sin, height)]);
    }
    for v in (0..2 * facets).step_by(2) {
        parts.triangles.extend([[v, v + 1, v + 3], [v, v + 3, v + 2]]);
    }
    let mesh = Mesh::new(parts, Smoothing::Flat, false).unwrap().0;
    (Surface { name: "wall".into(), shape: Shape::Mesh(mesh) }, height)
}

/// Light of 1 lx across the beam, which covers floor and wall.
fn cup(inclination: f64, floor: Material, camera: Option<CameraSpec>) -> Scene {
    let (wall, height) = wall(inclination);
    let (sin, cos) = inclination.sin_cos();
    let (direction, across) = (DVec3::new(sin, 0.0, -cos), DVec3::new(cos, 0.0, sin));
    let width = 1.02 * (cos + height * sin);
    let section = BeamSection::Rectangle { width, height: 2.02 };
    let frame = AimFrame::new(direction, Some(DVec3::Y)).unwrap();
    let centre = across * (0.5 * width - 0.01) - direction * 3.0;
    let flux_lm = width * 2.02;
    let receiver = |name, cells| {
        let spec = ReceiverSpec::new(name, "floor").unwrap().with_cells(cells).unwrap();
        spec.of_events(ReceiverEvents::Indirect)
    };
    let mirror = Material::Mirror(Mirror::new(Reflectance::new(1.0).unwrap()));
    let plate = rectangle("floor", DVec3::NEG_Y, DVec3::X, DVec3::Y * 2.0);
    let mut scene = SceneBuilder::new();
    scene
        .surface(plate.name, plate.shape, floor)
        .surface(wall.name, wall.shape, mirror)
        .emitter("sun", Emitter::Beam(Beam::new(centre, frame, section, flux_lm).unwrap()))
        .receiver(receiver("fine", [FINE, 2 * FINE]))
        .receiver(receiver("coarse", [COARSE, 2 * COARSE]))
        .receiver(receiver("thin", [THIN, THIN_ROWS]));
    if let Some(camera) = camera {
        scene.camera(Camera::new(camera).unwrap());
    }
    scene.build().unwrap()
}

/// Inclinations of the light, in degrees.
const INCLINED_DEG: [f64; 2] = [35.0, 60.0];

/// The runs at these inclinations, traced once for all tests.
static TRACED: LazyLock<[Outcome; 2]> = LazyLock::new(|| {
    INCLINED_DEG.map(|degrees| {
        let scene = cup(degrees.to_radians(), Material::Absorber, None);
        trace(&scene, &plan(1 << 19, 16), &AtomicBool::new(false), &|_| {}).unwrap()
    })
});

/// The nephroid at t.
fn nephroid(t: f64) -> [f64; 2] {
    [(3.0 * t.cos() - (3.0 * t).cos()) / 4.0, (3.0 * t.sin() - (3.0 * t).sin()) / 4.0]
}

/// Where the curve's branch y > 0 is at this x, 1/2 to x(pi / 8), by bisection: x grows with t there.
fn y_at(x: f64) -> f64 {
    let (mut low, mut high) = (0.0, PI / 8.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if nephroid(middle)[0] < x { low = middle } else { high = middle }
    }
    nephroid(low)[1]
}

/// The cell of a row of `n` from 0 with the greatest value within `reach` of this place.
fn brightest(n: u32, place: f64, reach: f64, value: impl Fn(u32) -> f64) -> u32 {
    let near = |i: &u32| ((f64::from(*i) + 0.5) / f64::from(FINE) - place).abs() < reach;
    (0..n).filter(near).max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap()
}

/// Cells by which a ridge that is in cell `found` misses the cells that the curve passes from `a` to `b`.
fn off_by(found: u32, a: f64, b: f64) -> u32 {
    let cell = |x: f64| (x * f64::from(FINE)) as u32;
    let (low, high) = (cell(a.min(b)), cell(a.max(b)));
    low.saturating_sub(found).max(found.saturating_sub(high))
}

/// The ridge of a map against the curve, cut along y where the curve runs more along x and along x where it runs more along
/// y; `value` by column and row from the axis, of the half y > 0 or y < 0. Numbers of cuts with the ridge 0, 1, 2... cells off.
fn ridge(value: impl Fn(u32, u32) -> f64) -> Vec<usize> {
    let mut off = vec![0; FINE as usize];
    let at = |i: u32| f64::from(i) / f64::from(FINE);
    let (middle, end) = (nephroid(PI / 8.0), 0.45);
    // From where the two branches are some cells apart.
    for i in 0..FINE {
        let (a, b) = (at(i), at(i + 1));
        if a > 0.53 && b < middle[0] {
            let j = brightest(FINE, y_at(0.5 * (a + b)), 0.1, |j| value(i, j));
            off[off_by(j, y_at(a), y_at(b)) as usize] += 1;
        }
    }
    for j in 0..FINE {
        let (a, b) = (at(j), at(j + 1));
        if a > middle[1] && b < end {
            let x = |y: f64| nephroid(y.cbrt().asin())[0];
            let i = brightest(FINE, x(0.5 * (a + b)), 0.1, |i| value(i, j));
            off[off_by(i, x(a), x(b)) as usize] += 1;
        }
    }
    while off.last() == Some(&0) {
        off.pop();
    }
    off
}

fn assert_ridges(label: &str, value: impl Fn(u32, bool, u32) -> f64) {
    for above in [true, false] {
        let off = ridge(|i, j| value(i, above, j));
        let cuts: usize = off.iter().sum();
        println!(
            "{label}, y {} 0: cuts with the ridge 0, 1... cells off: {off:?}",
            [">", "<"][usize::from(!above)]
        );
        assert!(cuts > 40, "{label}: {cuts}");
        assert!(off.len() <= 2, "{label}: {off:?}");
    }
}

/// Exact illuminance of square cells [lx], by the midpoint rule in t and s. What comes back to the wall before it is down goes
/// on along the next chord, 2 cos t long, turned by pi - 2t.
fn exact_lx(inclination: f64, cells: u32) -> Vec<f64> {
    let mut lx = vec![0.0; (2 * cells * cells) as usize];
    let (nt, ns) = (1u32 << 13, 1u32 << 11);
    let (dt, ds) = (PI / f64::from(nt), REACH / f64::from(ns));
    for k in 0..nt {
        let first = (f64::from(k) + 0.5) * dt - FRAC_PI_2;
        // Flux over the area of a cell.
        let part = inclination.cos() * first.cos() * dt * ds * f64::from(cells * cells);
        let (chord, turn) = (2.0 * first.cos(), (PI - 2.0 * first.abs()) * first.signum());
        let (mut t, mut gone, mut along) = (first, 0.0, 2.0 * first);
        for m in 0..ns {
            let s = (f64::from(m) + 0.5) * ds;
            while s > gone + chord {
                (t, gone, along) = (t - turn, gone + chord, along - turn);
            }
            let x = t.cos() - (s - gone) * along.cos();
            let y = t.sin() - (s - gone) * along.sin();
            let (i, j) = (x * f64::from(cells), (1.0 - y) * f64::from(cells));
            lx[(j as u32 * cells + i as u32) as usize] += part;
        }
    }
    lx
}

#[test]
fn the_ridge_of_the_receiver_is_the_nephroid_and_its_cusp_is_at_half_the_radius() {
    for (inclination_deg, outcome) in INCLINED_DEG.iter().zip(TRACED.iter()) {
        assert_ridges(&format!("{inclination_deg} degrees"), |i, above, j| {
            // Row 0 is that of the greatest y.
            let row = if above { FINE - 1 - j } else { FINE + j };
            outcome.cells()[0].sum[(row * FINE + i) as usize] as f64
        });
        // Along the axis, in a row so thin that the branches leave it within a cell of the cusp: (w / 2)^(2/3) 3/4 = 0.003.
        let row = &outcome.cells()[2].sum[(THIN_ROWS / 2 * THIN) as usize..][..THIN as usize];
        let peak = (0..row.len()).max_by_key(|i| row[*i]).unwrap();
        println!("{inclination_deg} degrees: {} photons in the cell at {peak} of {THIN}", row[peak]);
        assert!(peak.abs_diff(THIN as usize / 2) <= 1, "{peak}: {row:?}");
        // Before the cusp there is little: once over |1 - 2 s| = 2 (1/2 - x).
        let before = row[..THIN as usize * 3 / 8].iter().max().unwrap();
        assert!(4 * before < row[peak], "{before} {}", row[peak]);
    }
}

#[test]
fn illuminances_are_those_of_the_sum_over_reflections() {
    for (inclination_deg, outcome) in INCLINED_DEG.iter().zip(TRACED.iter()) {
        let exact = exact_lx(inclination_deg.to_radians(), COARSE);
        let area = 1.0 / f64::from(COARSE * COARSE);
        let mut ts = Vec::new();
        for (cell, exact) in exact.iter().enumerate() {
            let got = outcome.illuminance_lx(1, cell, area);
            let error = got.standard_error.unwrap();
            if *exact == 0.0 {
                assert_eq!(got.value, 0.0, "cell {cell}");
            } else if error > 0.0 {
                ts.push((got.value - exact) / error);
            }
        }
        let verdict = judge(&ts, 15);
        println!("{inclination_deg} degrees: {verdict:?}");
        assert!(verdict.cells > 150);
        assert!(verdict.p_chi2 > SIGNIFICANCE && verdict.p_extreme > SIGNIFICANCE, "{verdict:?}");
    }
}

#[test]
fn the_ridge_of_the_splatted_picture_is_the_nephroid() {
    // Straight from above: 1 m by 1 m of the floor, x from 0 and y about 0, a pixel a fine cell.
    let (position, look_at) = (DVec3::new(0.5, 0.0, 4.0), DVec3::new(0.5, 0.0, 0.0));
    let fov_deg = 2.0 * (0.5f64 / 4.0).atan().to_degrees();
    let spec = CameraSpec {
        method: Method::Splat,
        filter: Filter::Box,
        ..CameraSpec::pinhole(position, look_at, DVec3::Y, fov_deg, [FINE, FINE])
    };
    let scene = cup(60f64.to_radians(), grey(0.5), Some(spec));
    let plan = plan(1 << 20, 4);
    let (_, picture) = trace_picture(&scene, &plan, false, unwatched(&AtomicBool::new(false))).unwrap();
    let AnyPicture::Grey(picture) = picture else { panic!("a grey scene") };
    assert!(picture.film.bias.iter().all(|b| *b == 0.0), "splats have no bias");
    assert_ridges("picture", |i, above, j| {
        if j >= FINE / 2 {
            return 0.0;
        }
        let row = if above { FINE / 2 - 1 - j } else { FINE / 2 + j };
        picture.film.value[(row * FINE + i) as usize][0]
    });
}
