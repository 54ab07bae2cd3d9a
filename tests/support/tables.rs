//! Scattering tables made from formulas, and the frames of scattered directions in the words of the table's documentation:
//! no code in common with the sampler.
// Each test binary, and benches/scattering.rs, uses a part of it.
#![allow(dead_code)]

use std::f64::consts::PI;

use caustix::scattering::{Frame, LobeData, LobeSide, Quantity, ScatterTable};
use glam::DVec3;

/// A table and what it is called.
#[derive(Debug, Clone)]
pub struct Case {
    pub name: &'static str,
    pub lobes: Vec<LobeData>,
}

impl Case {
    pub fn table(&self) -> ScatterTable {
        ScatterTable::new(self.name, self.lobes.clone(), vec![]).unwrap()
    }
}

/// From 0 to `last` by `step`, degrees.
pub fn steps(first: f64, last: f64, step: f64) -> Vec<f64> {
    let n = ((last - first) / step).round() as usize;
    (0..=n).map(|k| first + (last - first) * k as f64 / n as f64).collect()
}

/// A lobe whose values are a function of (channel, phi_i, theta_i, polar, azimuth) in degrees.
pub fn lobe(
    (quantity, frame): (Quantity, Frame),
    [theta_i_deg, phi_i_deg, polar_deg, azimuth_deg]: [Vec<f64>; 4],
    channels: usize,
    f: impl Fn(usize, f64, f64, f64, f64) -> f64,
) -> LobeData {
    let mut values = Vec::new();
    for c in 0..channels {
        for phi in &phi_i_deg {
            for theta in &theta_i_deg {
                for polar in &polar_deg {
                    values.extend(
                        azimuth_deg.iter().map(|azimuth| f(c, *phi, *theta, *polar, *azimuth) as f32),
                    );
                }
            }
        }
    }
    LobeData {
        quantity,
        side: LobeSide::Front,
        frame,
        theta_i_deg,
        phi_i_deg,
        polar_deg,
        azimuth_deg,
        channels,
        values,
        declared_tis: vec![],
    }
}

/// wi for angles in degrees about z, azimuth from x.
pub fn incidence(theta_deg: f64, phi_deg: f64) -> DVec3 {
    let (theta, phi) = (theta_deg.to_radians(), phi_deg.to_radians());
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// Twelve incident directions, on and off the angles of the tables below.
pub fn incidences() -> Vec<DVec3> {
    let list = [
        (0.0, 0.0),
        (3.0, 200.0),
        (10.0, 0.0),
        (20.0, 45.0),
        (22.5, 133.0),
        (30.0, 270.0),
        (41.0, 17.0),
        (60.0, 90.0),
        (66.0, 359.0),
        (75.0, 222.0),
        (85.0, 61.0),
        (89.999, 310.0),
    ];
    list.map(|(theta, phi)| incidence(theta, phi)).to_vec()
}

/// Unit vectors of azimuth 0, azimuth 90 degrees, and the pole. Reflection: the normal of the side that light leaves on is
/// z, transmission: -z. At normal incidence light counts as coming from x.
fn frame(frame: Frame, quantity: Quantity, wi: DVec3) -> [DVec3; 3] {
    let n = DVec3::Z;
    let m = if quantity == Quantity::Reflection { n } else { -n };
    let from = if wi.x == 0.0 && wi.y == 0.0 { DVec3::X } else { DVec3::new(wi.x, wi.y, 0.0).normalize() };
    let t = -from;
    match frame {
        Frame::Surface => [t, n.cross(t), m],
        Frame::Specular => {
            let s = match quantity {
                Quantity::Reflection => DVec3::new(-wi.x, -wi.y, wi.z),
                Quantity::Transmission => -wi,
            };
            // Towards m: m less its part along s; the limit at normal incidence is the side of the light.
            let across = m - m.dot(s) * s;
            let x = if t == -DVec3::X && wi.z == 1.0 { from } else { across.normalize() };
            [x, s.cross(x), s]
        }
    }
}

/// The direction of a lobe's (polar, azimuth), radians.
pub fn direction(f: Frame, quantity: Quantity, wi: DVec3, theta: f64, phi: f64) -> DVec3 {
    let [x, y, z] = frame(f, quantity, wi);
    theta.sin() * (phi.cos() * x + phi.sin() * y) + theta.cos() * z
}

/// (polar, azimuth) of a direction in a lobe's frame, radians, azimuth within [-pi, pi].
pub fn angles(f: Frame, quantity: Quantity, wi: DVec3, wo: DVec3) -> (f64, f64) {
    let [x, y, z] = frame(f, quantity, wi).map(|axis| axis.dot(wo));
    (x.hypot(y).atan2(z), y.atan2(x))
}

/// f of a rough conductor (GGX, Smith's separable shadowing, no Fresnel): D G / (4 cos_i cos_o).
pub fn ggx(alpha: f64, wi: DVec3, wo: DVec3) -> f64 {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return 0.0;
    }
    let h = (wi + wo).normalize();
    let a2 = alpha * alpha;
    let d = a2 / (PI * (h.z * h.z * (a2 - 1.0) + 1.0).powi(2));
    let g1 = |w: DVec3| 2.0 * w.z / (w.z + (a2 + (1.0 - a2) * w.z * w.z).sqrt());
    d * g1(wi) * g1(wo) / (4.0 * wi.z * wo.z)
}

const R: (Quantity, Frame) = (Quantity::Reflection, Frame::Surface);
const RS: (Quantity, Frame) = (Quantity::Reflection, Frame::Specular);

/// A diffuser of this albedo by nodes `step` degrees apart.
pub fn lambert(albedo: f64, step: f64) -> LobeData {
    let angles = [vec![0.0], vec![0.0], steps(0.0, 90.0, step), steps(0.0, 360.0, 30.0)];
    lobe(R, angles, 1, |_, _, _, _, _| albedo / PI)
}

/// Every kind of table, the extremes of the task among them.
pub fn cases() -> Vec<Case> {
    let iso = || vec![0.0];
    let aoi = || steps(0.0, 80.0, 20.0);
    let phong = |n: i32| {
        move |_: usize, _: f64, _: f64, polar: f64, _: f64| {
            0.12 * f64::from(n + 2) / PI * polar.to_radians().cos().max(0.0).powi(n)
        }
    };
    let ggx_values = |_: usize, _: f64, theta: f64, polar: f64, azimuth: f64| {
        let wi = incidence(theta, 0.0);
        let wo =
            direction(Frame::Specular, Quantity::Reflection, wi, polar.to_radians(), azimuth.to_radians());
        0.7 * ggx(0.35, wi, wo)
    };
    let lumpy = |scale: f64| {
        move |_: usize, _: f64, theta: f64, polar: f64, azimuth: f64| {
            let k = ((theta + 3.0 * polar + 7.0 * (azimuth.rem_euclid(360.0))) as u64 * 2_654_435_761) % 13;
            0.05 * scale.powf(k as f64 / 12.0)
        }
    };
    vec![
        Case { name: "lambert", lobes: vec![lambert(0.8, 5.0)] },
        Case {
            name: "phong",
            lobes: vec![lobe(
                RS,
                [aoi(), iso(), steps(0.0, 105.0, 3.5), steps(-180.0, 180.0, 20.0)],
                1,
                phong(20),
            )],
        },
        Case {
            name: "ggx",
            lobes: vec![lobe(
                RS,
                [aoi(), iso(), steps(0.0, 160.0, 8.0), steps(0.0, 360.0, 15.0)],
                1,
                ggx_values,
            )],
        },
        Case {
            name: "narrower than a step",
            lobes: vec![lobe(
                RS,
                [vec![10.0, 60.0], iso(), steps(0.0, 90.0, 5.0), steps(0.0, 360.0, 45.0)],
                1,
                |_, _, _, polar, _| if polar == 0.0 { 60.0 } else { 0.0 },
            )],
        },
        Case {
            name: "one incidence",
            lobes: vec![lobe(
                RS,
                [vec![30.0], iso(), steps(0.0, 90.0, 6.0), steps(0.0, 360.0, 20.0)],
                1,
                |_, _, _, polar, azimuth| 0.1 * (-polar / 20.0).exp() * (1.2 + azimuth.to_radians().cos()),
            )],
        },
        Case {
            name: "a black slice",
            lobes: vec![lobe(
                R,
                [steps(0.0, 90.0, 30.0), iso(), steps(0.0, 90.0, 10.0), steps(0.0, 360.0, 60.0)],
                1,
                |_, _, theta, polar, _| if theta == 30.0 { 0.0 } else { 0.25 * (1.0 - polar / 120.0) },
            )],
        },
        Case {
            name: "one cell",
            lobes: vec![lobe(
                R,
                [vec![0.0, 50.0], iso(), steps(20.0, 80.0, 10.0), steps(0.0, 360.0, 40.0)],
                1,
                |_, _, _, polar, azimuth| if polar == 20.0 && azimuth == 0.0 { 2.0 } else { 0.0 },
            )],
        },
        Case {
            name: "pole cells",
            lobes: vec![lobe(
                RS,
                [vec![0.0, 45.0, 89.0], iso(), steps(0.0, 180.0, 20.0), steps(0.0, 360.0, 40.0)],
                1,
                // About the specular direction and, at grazing incidence, about where the light comes from.
                |_, _, _, polar, azimuth| match polar {
                    0.0 => 1.5,
                    160.0 => 0.8 + 0.6 * azimuth.to_radians().sin(),
                    _ => 0.0,
                },
            )],
        },
        Case {
            name: "1e12 range",
            lobes: vec![lobe(
                R,
                [aoi(), iso(), steps(0.0, 90.0, 7.5), steps(0.0, 360.0, 24.0)],
                1,
                lumpy(1e-12),
            )],
        },
        Case {
            name: "rgb",
            lobes: vec![lobe(
                R,
                [steps(0.0, 90.0, 30.0), iso(), steps(0.0, 90.0, 7.5), steps(0.0, 360.0, 24.0)],
                3,
                |channel, _, theta, polar, azimuth| match channel {
                    0 => 0.25 + 0.05 * azimuth.to_radians().cos(),
                    1 => 0.2 * (1.0 - polar / 100.0) * (1.0 + theta / 200.0),
                    _ => 0.0,
                },
            )],
        },
        Case {
            name: "stops at 60 degrees",
            lobes: vec![lobe(
                RS,
                [steps(10.0, 60.0, 25.0), iso(), steps(0.0, 120.0, 6.0), steps(0.0, 360.0, 20.0)],
                1,
                |_, _, theta, polar, _| 0.4 * (-polar / 15.0).exp() * (1.0 + theta / 60.0),
            )],
        },
        Case {
            name: "both ways",
            lobes: vec![
                lobe(
                    RS,
                    [vec![0.0, 45.0, 80.0], iso(), steps(0.0, 90.0, 5.0), steps(0.0, 360.0, 30.0)],
                    1,
                    |_, _, theta, polar, _| 0.2 * (1.0 + theta / 90.0) * (-polar / 25.0).exp(),
                ),
                lobe(
                    (Quantity::Transmission, Frame::Surface),
                    [vec![0.0, 30.0, 60.0, 90.0], iso(), steps(0.0, 90.0, 6.0), steps(0.0, 360.0, 30.0)],
                    1,
                    |_, _, theta, polar, azimuth| {
                        0.1 * (1.0 + azimuth.to_radians().cos() * theta / 100.0) * (1.0 - polar / 180.0)
                    },
                ),
            ],
        },
        Case {
            name: "anisotropic",
            lobes: vec![lobe(
                (Quantity::Transmission, Frame::Specular),
                [
                    vec![0.0, 40.0, 80.0],
                    steps(0.0, 360.0, 45.0),
                    steps(0.0, 90.0, 9.0),
                    steps(-180.0, 180.0, 30.0),
                ],
                1,
                |_, phi, theta, polar, azimuth| {
                    // The same at normal incidence for all phi_i, as it must be.
                    let swing = (2.0 * phi).to_radians().cos() * theta / 90.0;
                    0.15 * (-polar / 30.0).exp()
                        * (1.5
                            + swing * (2.0 * azimuth).to_radians().cos()
                            + 0.3 * azimuth.to_radians().sin())
                },
            )],
        },
    ]
}
