//! Writes the scattering tables of `brdf_tables/` from their formulas: `cargo run --release --example make_brdf -- brdf_tables`.
//!
//! This file is their documentation: what a table holds is the formula beside its name at the table's angles, rounded to four
//! digits. `brdf_tables/README.md` states the albedo of each, by quadrature of the formula.

use libm::{cos, pow, sin};
use std::error::Error;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: make_brdf FOLDER")?;
    for table in tables() {
        std::fs::write(Path::new(&folder).join(table.file), table.text())?;
    }
    Ok(())
}

/// A direction; z is the normal on the side the light comes from, x the surface's reference direction.
pub type Direction = [f64; 3];

/// f(wi, wo) in 1/sr; both point away from the surface.
pub type Formula = fn(Direction, Direction) -> f64;

/// A lobe: quantity and side as the file writes them, and its formula.
pub struct Lobe {
    /// reflection or transmission
    pub quantity: &'static str,
    /// front, back or both
    pub side: &'static str,
    /// f
    pub formula: Formula,
}

/// A table: its angles in degrees, and what it is made of.
pub struct Table {
    /// Name of the file.
    pub file: &'static str,
    name: &'static str,
    /// surface or specular
    pub frame: &'static str,
    symmetry: &'static str,
    /// Incident polar angles.
    pub theta_i: Vec<f64>,
    /// Incident azimuths, none for isotropic tables.
    pub phi_i: Vec<f64>,
    polar: Vec<f64>,
    azimuth: Vec<f64>,
    /// What it does with light.
    pub lobes: Vec<Lobe>,
}

/// Every table of the project.
pub fn tables() -> Vec<Table> {
    vec![lambert(), phong(), aluminium(), brushed(), rough_glass(), satin_pane(), opal()]
}

fn reflection(formula: Formula) -> Lobe {
    Lobe { quantity: "reflection", side: "both", formula }
}

/// A perfectly diffuse white of albedo 0.8: f = 0.8 / pi.
fn lambert() -> Table {
    Table {
        file: "lambert.scatter",
        name: "Lambert, albedo 0.8",
        frame: "surface",
        symmetry: "rotational",
        theta_i: vec![0.0],
        phi_i: vec![],
        polar: steps(0.0, 1.0, 91),
        azimuth: vec![],
        lobes: vec![reflection(|_, _| 0.8 / PI)],
    }
}

/// The reciprocal Phong lobe: f = 0.7 (n + 2) / (2 pi) cos^n(alpha), n = 40, alpha the angle from the mirrored direction, zero
/// beyond 90 degrees (E. Lafortune, Y. Willems, "Using the modified Phong reflectance model", 1994). Albedo 0.7 at
/// normal incidence, less beyond: what would go below the horizon is lost.
fn phong() -> Table {
    Table {
        file: "phong.scatter",
        name: "Reciprocal Phong lobe, exponent 40",
        frame: "specular",
        symmetry: "plane",
        theta_i: vec![0.0, 15.0, 30.0, 45.0, 55.0, 65.0, 75.0, 80.0, 85.0, 89.0],
        phi_i: vec![],
        polar: [steps(0.0, 1.5, 41), vec![75.0, 90.0]].concat(),
        azimuth: steps(0.0, 7.5, 25),
        lobes: vec![reflection(|wi, wo| {
            let alpha = wi[2] * wo[2] - wi[0] * wo[0] - wi[1] * wo[1];
            0.7 * 42.0 / (2.0 * PI) * pow(alpha.max(0.0), 40.0)
        })],
    }
}

/// A rough conductor: GGX, alpha = 0.25, height-correlated masking and shadowing, Fresnel of aluminium at 550 nm (n = 0.958,
/// k = 6.69; A. Rakic, 1995), unpolarised.
fn aluminium() -> Table {
    Table {
        file: "ggx_aluminium.scatter",
        name: "Rough aluminium, GGX alpha 0.25",
        frame: "specular",
        symmetry: "plane",
        theta_i: [steps(0.0, 10.0, 6), vec![55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 84.0, 87.0, 89.0]].concat(),
        phi_i: vec![],
        polar: [steps(0.0, 1.5, 21), steps(33.0, 4.0, 6), steps(60.0, 10.0, 13)].concat(),
        azimuth: steps(0.0, 7.5, 25),
        lobes: vec![reflection(|wi, wo| conductor(wi, wo, 0.25, 0.25))],
    }
}

/// Brushed aluminium: as above with alpha 0.15 along x and 0.5 along y, so the brush runs along x.
fn brushed() -> Table {
    Table {
        file: "brushed_aluminium.scatter",
        name: "Brushed aluminium, GGX alpha 0.15 along x and 0.5 along y",
        frame: "specular",
        symmetry: "orthotropic",
        theta_i: vec![0.0, 15.0, 30.0, 45.0, 60.0, 72.0, 80.0],
        phi_i: steps(0.0, 15.0, 7),
        polar: [
            steps(0.0, 3.0, 9),
            steps(28.0, 4.0, 5),
            vec![50.0, 56.0, 63.0, 70.0, 80.0, 90.0, 105.0, 120.0, 145.0, 170.0],
        ]
        .concat(),
        azimuth: steps(0.0, 10.0, 36),
        lobes: vec![reflection(|wi, wo| conductor(wi, wo, 0.15, 0.5))],
    }
}

/// One rough face of glass, n = 1.5: GGX alpha = 0.4, light from the air in front and from the glass behind (B. Walter et al.,
/// "Microfacet models for refraction through rough surfaces", 2007, equations 20 and 21), masking height-correlated for
/// reflection, separable for transmission. A closed shape of it is a body of frosted glass.
///
/// f carries flux, not radiance: f(wi, wo) / n_o^2 is what is reciprocal between the two sides.
fn rough_glass() -> Table {
    Table {
        file: "rough_glass.scatter",
        name: "Rough face of glass, n 1.5, GGX alpha 0.4",
        frame: "specular",
        symmetry: "plane",
        theta_i: vec![0.0, 8.0, 16.0, 24.0, 32.0, 40.0, 48.0, 57.0, 66.0, 75.0, 84.0],
        phi_i: vec![],
        polar: [steps(0.0, 1.5, 11), steps(17.5, 2.5, 18), steps(65.0, 5.0, 6), steps(100.0, 10.0, 9)]
            .concat(),
        azimuth: steps(0.0, 9.0, 21),
        lobes: vec![
            Lobe { quantity: "reflection", side: "front", formula: |wi, wo| glass_reflection(wi, wo, 1.5) },
            Lobe {
                quantity: "transmission",
                side: "front",
                formula: |wi, wo| glass_transmission(wi, wo, 1.5),
            },
            Lobe {
                quantity: "reflection",
                side: "back",
                formula: |wi, wo| glass_reflection(wi, wo, 1.0 / 1.5),
            },
            Lobe {
                quantity: "transmission",
                side: "back",
                formula: |wi, wo| glass_transmission(wi, wo, 1.0 / 1.5),
            },
        ],
    }
}

/// A thin pane of satin glass as one surface: reflection is a GGX lobe, alpha 0.2, with the reflectance of a slab,
/// 2 R / (1 + R), R Fresnel's of n = 1.5 at the microfacet; transmission is the same lobe mirrored in the pane, with what is left:
/// (1 - R) / (1 + R). Reciprocal, the same from both sides.
fn satin_pane() -> Table {
    Table {
        file: "satin_pane.scatter",
        name: "Thin satin pane, n 1.5, GGX alpha 0.2",
        frame: "specular",
        symmetry: "plane",
        theta_i: vec![0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 68.0, 75.0, 80.0, 85.0, 88.0],
        phi_i: vec![],
        polar: [steps(0.0, 1.5, 17), steps(28.0, 4.0, 6), steps(55.0, 10.0, 13), vec![180.0]].concat(),
        azimuth: steps(0.0, 6.0, 31),
        lobes: vec![
            reflection(|wi, wo| {
                microfacet(wi, wo, 0.2, 0.2, |c| 2.0 * fresnel(c, 1.5) / (1.0 + fresnel(c, 1.5)))
            }),
            Lobe {
                quantity: "transmission",
                side: "both",
                formula: |wi, wo| {
                    let mirrored = [wo[0], wo[1], -wo[2]];
                    microfacet(wi, mirrored, 0.2, 0.2, |c| (1.0 - fresnel(c, 1.5)) / (1.0 + fresnel(c, 1.5)))
                },
            },
        ],
    }
}

/// An opal sheet: f = 0.30 a(theta_i) a(theta_o) / pi back and 0.55 a a / pi through, a(theta) = 1 - (1 - cos theta)^5: what
/// the sheet's face lets in and out (after C. Schlick, 1994), everything between forgotten.
fn opal() -> Table {
    let lobe = |quantity, formula| Lobe { quantity, side: "both", formula };
    Table {
        file: "opal.scatter",
        name: "Opal diffuser",
        frame: "surface",
        symmetry: "rotational",
        theta_i: [steps(0.0, 5.0, 17), vec![82.0, 84.0, 86.0, 88.0, 89.0, 90.0]].concat(),
        phi_i: vec![],
        polar: steps(0.0, 1.0, 91),
        azimuth: vec![],
        lobes: vec![
            lobe("reflection", |wi, wo| 0.30 * enters(wi[2]) * enters(wo[2]) / PI),
            lobe("transmission", |wi, wo| 0.55 * enters(wi[2]) * enters(-wo[2]) / PI),
        ],
    }
}

fn enters(cosine: f64) -> f64 {
    1.0 - pow(1.0 - cosine, 5.0)
}

/// GGX with the Fresnel reflectance of aluminium.
fn conductor(wi: Direction, wo: Direction, along_x: f64, along_y: f64) -> f64 {
    microfacet(wi, wo, along_x, along_y, aluminium_fresnel)
}

/// D G2 F / (4 cos cos): D of T. Trowbridge and K. Reitz (GGX), G2 height-correlated (E. Heitz, "Understanding the
/// masking-shadowing function", 2014, equation 99), F by the cosine at the microfacet.
fn microfacet(wi: Direction, wo: Direction, ax: f64, ay: f64, fresnel: fn(f64) -> f64) -> f64 {
    let h = unit([wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]]);
    let masking = 1.0 / (1.0 + lambda(wi, ax, ay) + lambda(wo, ax, ay));
    ggx(h, ax, ay) * masking * fresnel(dot(wi, h)) / (4.0 * wi[2] * wo[2])
}

/// The density of microfacet normals.
fn ggx(h: Direction, ax: f64, ay: f64) -> f64 {
    let (x, y) = (h[0] / ax, h[1] / ay);
    let s = x * x + y * y + h[2] * h[2];
    1.0 / (PI * ax * ay * s * s)
}

/// Smith's Lambda of GGX.
fn lambda(w: Direction, ax: f64, ay: f64) -> f64 {
    let (x, y) = (w[0] * ax, w[1] * ay);
    0.5 * ((1.0 + (x * x + y * y) / (w[2] * w[2])).sqrt() - 1.0)
}

/// Unpolarised reflectance of a dielectric of relative index n at a cosine on the side of index 1; 1 beyond the critical
/// angle.
fn fresnel(cosine: f64, n: f64) -> f64 {
    let sine2 = (1.0 - cosine * cosine) / (n * n);
    if sine2 >= 1.0 {
        return 1.0;
    }
    let inside = (1.0 - sine2).sqrt();
    let s = (cosine - n * inside) / (cosine + n * inside);
    let p = (n * cosine - inside) / (n * cosine + inside);
    0.5 * (s * s + p * p)
}

/// Unpolarised reflectance of a conductor, n + i k, from a cosine (M. Born, E. Wolf, Principles of Optics, 14.2).
fn aluminium_fresnel(cosine: f64) -> f64 {
    let (n, k) = (0.958, 6.69);
    let (c2, s2) = (cosine * cosine, 1.0 - cosine * cosine);
    let difference = n * n - k * k - s2;
    let both = (difference * difference + 4.0 * n * n * k * k).sqrt();
    let a = (0.5 * (both + difference)).sqrt();
    let s = (both + c2 - 2.0 * a * cosine) / (both + c2 + 2.0 * a * cosine);
    let p = s * (c2 * both + s2 * s2 - 2.0 * a * cosine * s2) / (c2 * both + s2 * s2 + 2.0 * a * cosine * s2);
    0.5 * (s + p)
}

/// Reflection at the rough face of a body whose index is n times that of the side the light comes from.
fn glass_reflection(wi: Direction, wo: Direction, n: f64) -> f64 {
    let h = unit([wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]]);
    let masking = 1.0 / (1.0 + lambda(wi, 0.4, 0.4) + lambda(wo, 0.4, 0.4));
    ggx(h, 0.4, 0.4) * masking * fresnel(dot(wi, h), n) / (4.0 * wi[2] * wo[2])
}

/// Transmission through it; index 1 on the side of wi, n on that of wo.
fn glass_transmission(wi: Direction, wo: Direction, n: f64) -> f64 {
    let h = unit([wi[0] + n * wo[0], wi[1] + n * wo[1], wi[2] + n * wo[2]]);
    // The half vector of refraction points into the denser side.
    let h = if h[2] < 0.0 { [-h[0], -h[1], -h[2]] } else { h };
    let (i, o) = (dot(wi, h), dot(wo, h));
    if i <= 0.0 || o >= 0.0 {
        return 0.0;
    }
    let masking = 1.0 / ((1.0 + lambda(wi, 0.4, 0.4)) * (1.0 + lambda(wo, 0.4, 0.4)));
    let jacobian = n * n * i * -o / ((i + n * o) * (i + n * o));
    ggx(h, 0.4, 0.4) * masking * (1.0 - fresnel(i, n)) * jacobian / (wi[2] * -wo[2])
}

fn dot(a: Direction, b: Direction) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(v: Direction) -> Direction {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

fn steps(first: f64, step: f64, n: u32) -> Vec<f64> {
    (0..n).map(|i| first + step * f64::from(i)).collect()
}

/// Light from azimuth phi_i at theta_i, degrees.
pub fn incident(theta_i: f64, phi_i: f64) -> Direction {
    let (t, p) = (theta_i.to_radians(), phi_i.to_radians());
    [sin(t) * cos(p), sin(t) * sin(p), cos(t)]
}

/// A scattered direction: polar angle and azimuth (degrees) of a frame ("surface" or "specular") of light that comes from
/// theta_i, phi_i. In both, +z is the side the light comes from; transmission leaves to -z.
pub fn scattered(
    frame: &str,
    transmitted: bool,
    theta_i: f64,
    phi_i: f64,
    polar: f64,
    azimuth: f64,
) -> Direction {
    let (t, p, a) = (theta_i.to_radians(), polar.to_radians(), azimuth.to_radians());
    let side = if transmitted { -1.0 } else { 1.0 };
    // In the plane of incidence: x along the surface the way light goes on, y towards n x x, z the normal.
    let local = if frame == "surface" {
        [sin(p) * cos(a), sin(p) * sin(a), side * cos(p)]
    } else {
        // Pole (sin t, 0, +-cos t), azimuth 0 towards the normal of the outgoing side, 90 at pole x that: -+y.
        let (up, across) = (sin(p) * cos(a), sin(p) * sin(a));
        [cos(p) * sin(t) - up * cos(t), -side * across, side * (cos(p) * cos(t) + up * sin(t))]
    };
    let phi = (phi_i + 180.0).to_radians();
    [local[0] * cos(phi) - local[1] * sin(phi), local[0] * sin(phi) + local[1] * cos(phi), local[2]]
}

impl Table {
    /// The file's text.
    pub fn text(&self) -> String {
        let mut out = format!("caustix-scattering 1\nname {}\n", self.name);
        // Writing to a String cannot fail.
        let _ = writeln!(out, "# Written by examples/make_brdf.rs, which has the formula.");
        let _ = writeln!(out, "frame {}\nsymmetry {}\nchannels 1", self.frame, self.symmetry);
        for (key, list) in [
            ("theta_i", &self.theta_i),
            ("phi_i", &self.phi_i),
            ("polar", &self.polar),
            ("azimuth", &self.azimuth),
        ] {
            if !list.is_empty() {
                let _ = writeln!(
                    out,
                    "{key} {}",
                    list.iter().map(|a| a.to_string()).collect::<Vec<_>>().join(" ")
                );
            }
        }
        for lobe in &self.lobes {
            let _ = writeln!(out, "lobe {} {}", lobe.quantity, lobe.side);
            for phi_i in
                self.phi_i.first().map_or(vec![None], |_| self.phi_i.iter().copied().map(Some).collect())
            {
                for theta_i in &self.theta_i {
                    let _ = match phi_i {
                        Some(phi) => writeln!(out, "incidence {theta_i} {phi}"),
                        None => writeln!(out, "incidence {theta_i}"),
                    };
                    self.rows(&mut out, lobe, *theta_i, phi_i.unwrap_or(0.0));
                }
            }
        }
        out
    }

    fn rows(&self, out: &mut String, lobe: &Lobe, theta_i: f64, phi_i: f64) {
        let rotational = [0.0];
        let azimuths = if self.azimuth.is_empty() { &rotational[..] } else { &self.azimuth };
        for azimuth in azimuths {
            let row: Vec<String> =
                self.polar.iter().map(|p| digits(self.value(lobe, theta_i, phi_i, *p, *azimuth))).collect();
            out.push_str(&row.join(" "));
            out.push('\n');
        }
    }

    /// f at a node; 0 at and below the horizon, where the cosine of g makes it 0 anyway.
    fn value(&self, lobe: &Lobe, theta_i: f64, phi_i: f64, polar: f64, azimuth: f64) -> f64 {
        let transmitted = lobe.quantity == "transmission";
        // At grazing incidence proper the formulas divide by a zero cosine.
        let wi = incident(theta_i.min(89.999), phi_i);
        let wo = scattered(self.frame, transmitted, theta_i, phi_i, polar, azimuth);
        let cosine = if transmitted { -wo[2] } else { wo[2] };
        if cosine > 1e-9 { (lobe.formula)(wi, wo) } else { 0.0 }
    }
}

/// Four digits, in the shorter of two ways of writing.
fn digits(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{x:.3e}");
    let decimals = 3 - libm::floor(libm::log10(x.abs())) as i32;
    let plain = format!("{x:.*}", decimals.max(0) as usize);
    let plain = if plain.contains('.') {
        plain.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        plain
    };
    if plain.len() <= scientific.len() { plain } else { scientific }
}
