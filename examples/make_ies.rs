//! Writes the photometric files of `ies/` from their formulas: `cargo run --release --example make_ies -- ies`.
//!
//! This file is their documentation: what a table holds is the formula beside its name, rounded to the decimals
//! given there. `ies/README.md` states the flux of each by independent quadrature.

use libm::{acos, cos, exp, pow, sin};
use std::error::Error;
use std::f64::consts::LN_2;
use std::fmt::Write;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: make_ies FOLDER")?;
    for (name, text) in files() {
        std::fs::write(Path::new(&folder).join(name), text)?;
    }
    Ok(())
}

/// Name and text of every file.
pub fn files() -> Vec<(&'static str, String)> {
    vec![
        ("wavy_glass.ies", wavy_glass()),
        ("spot.ies", spot()),
        ("downlight.ies", downlight()),
        ("pool_lamp.ies", pool_lamp()),
        ("floodlight_b.ies", floodlight_b()),
        ("headlamp_a.ies", headlamp_a()),
        ("batwing.ies", batwing()),
        ("uplight.ies", uplight()),
        ("wall_washer_1991.ies", wall_washer_1991()),
        ("panel_2019.ies", panel_2019()),
        ("led.ies", led()),
    ]
}

/// The luminaire of the built-in scene: a floodlight with two lobes and shields.
///
/// Type C, 37 V angles by 2.5 degrees, 24 H angles by 15 (the circle is closed by the reader). Where it shines it
/// spans one decade: I = 4250 x 10^(s - 1) cd, s the sum of two Gaussian lobes (half width 13 and 12 degrees) and a
/// ripple; dark where s is below 0.05. Shields: three whole meridians and three blocks are dark, and everything beyond
/// 70 degrees.
fn wavy_glass() -> String {
    let shielded = |v: f64, h: f64| {
        let meridian = [120.0, 300.0, 315.0].contains(&h);
        let block = |v0: f64, v1: f64, planes: &[f64]| v >= v0 && v <= v1 && planes.contains(&h);
        let blocks = block(10.0, 17.5, &[345.0, 0.0, 15.0])
            || block(20.0, 27.5, &[60.0, 75.0])
            || block(7.5, 15.0, &[225.0, 240.0]);
        meridian || blocks || v > 70.0
    };
    let intensity = |v: f64, h: f64| {
        if shielded(v, h) {
            return 0.0;
        }
        let lobe = |v0: f64, h0: f64, half: f64| gauss(angle_between_deg(v, h, v0, h0) / half);
        let ripple = 0.05 * sin_deg(v) * sin_deg(5.0 * h + 4.0 * v);
        let s = 0.94 * lobe(12.0, 40.0, 13.0) + 0.80 * lobe(15.0, 205.0, 12.0) + ripple;
        if s < 0.05 { 0.0 } else { 4250.0 * pow(10.0, s.min(1.0) - 1.0) }
    };
    let table = Table { vertical: steps(0.0, 2.5, 37), horizontal: steps(0.0, 15.0, 24), decimals: 1 };
    let file = File {
        labels: &["[TEST] caustix wavy_glass", "[LUMINAIRE] two lobes, shields: the built-in scene"],
        ..File::new("IESNA:LM-63-2002")
    };
    file.write(&table, intensity)
}

/// A narrow, rotationally symmetric beam: I = 12000 x 2^-(V / 5 degrees)^2 cd; beam angle 10 degrees.
fn spot() -> String {
    let vertical = [steps(0.0, 1.0, 20), steps(20.0, 2.5, 8), steps(40.0, 10.0, 6)].concat();
    let file =
        File { labels: &["[TEST] caustix spot", "[LUMINAIRE] narrow beam"], ..File::new("IESNA:LM-63-2002") };
    file.write(&Table { vertical, horizontal: vec![0.0], decimals: 2 }, |v, _| 12000.0 * gauss(v / 5.0))
}

/// A light-emitting diode without lens: I = 40 cos V cd, dark beyond 90 degrees.
fn led() -> String {
    let file = File {
        labels: &["[TEST] caustix led", "[LUMINAIRE] light-emitting diode"],
        ..File::new("IESNA:LM-63-2002")
    };
    let table = Table { vertical: steps(0.0, 2.5, 37), horizontal: vec![0.0], decimals: 4 };
    file.write(&table, |v, _| 40.0 * cos_deg(v))
}

/// A Lambertian emitter: I = 1000 cos V cd, so the flux is 1000 pi lm.
fn downlight() -> String {
    let file = File {
        labels: &["[TEST] caustix downlight", "[LUMINAIRE] cosine"],
        opening: "-0.2 -0.2 0",
        input_watts: "30",
        ..File::new("IESNA:LM-63-2002")
    };
    let table = Table { vertical: steps(0.0, 2.5, 37), horizontal: vec![0.0], decimals: 5 };
    file.write(&table, |v, _| 1000.0 * cos_deg(v))
}

/// A lamp that throws towards H = 0, mirrored in the 0-180 plane: I = 500 cos V (1 + 0.8 sin V cos H) x 1.25 cd;
/// the multiplier is 1.25, the ballast factor 0.95, the opening in feet. 500 pi x 1.25 lm without the ballast.
fn pool_lamp() -> String {
    let file = File {
        labels: &["[TEST] caustix pool_lamp", "[LUMINAIRE] asymmetric", "[MORE] mirrored in the 0-180 plane"],
        lamps: "2 1100 1.25",
        units: 1,
        opening: "0.5 1 0",
        factors: "0.95 1",
        input_watts: "45",
        ..File::new("IESNA:LM-63-1995")
    };
    let table = Table { vertical: steps(0.0, 5.0, 19), horizontal: steps(0.0, 15.0, 13), decimals: 4 };
    file.write(&table, |v, h| 500.0 * cos_deg(v) * (1.0 + 0.8 * sin_deg(v) * cos_deg(h)))
}

/// Type B, different in all four quarters: I = 4000 cos^3 H cos^2 V (1 + 0.3 sin H)(1 + 0.5 sin V) cd;
/// 4000 x 3 pi^2 / 16 lm.
fn floodlight_b() -> String {
    let file = File {
        labels: &["[TEST] caustix floodlight_b", "[LUMINAIRE] asymmetric in H and V"],
        photometric_type: 2,
        opening: "0.3 0.2 0",
        ..File::new("IESNA:LM-63-2002")
    };
    let table = Table { vertical: steps(-90.0, 5.0, 37), horizontal: steps(-90.0, 5.0, 37), decimals: 4 };
    file.write(&table, |v, h| {
        4000.0
            * pow(cos_deg(h), 3.0)
            * cos_deg(v)
            * cos_deg(v)
            * (1.0 + 0.3 * sin_deg(h))
            * (1.0 + 0.5 * sin_deg(v))
    })
}

/// Type A, a headlamp's low beam: I = 20000 x 2^-((H - 3) / 10)^2 x 2^-((V + 1.5) / 3)^2 cd, dark above a cut-off at
/// V = 0.5 for H < 0 that rises by a quarter of H to the right, and at 30 degrees and beyond.
fn headlamp_a() -> String {
    let vertical =
        [vec![-90.0, -30.0, -20.0, -15.0], steps(-10.0, 2.0, 3), steps(-5.0, 0.5, 21), steps(6.0, 2.0, 3)]
            .concat();
    let vertical = [vertical, vec![15.0, 20.0, 30.0, 90.0]].concat();
    let horizontal = [vec![-90.0], steps(-30.0, 2.5, 25), vec![90.0]].concat();
    let file = File {
        labels: &["[TEST] caustix headlamp_a", "[LUMINAIRE] low beam, driving on the right"],
        photometric_type: 3,
        opening: "0.2 0 0.1",
        ..File::new("IESNA:LM-63-2002")
    };
    file.write(&Table { vertical, horizontal, decimals: 2 }, |v, h| {
        let cut_off = 0.5 + 0.25 * h.max(0.0);
        if v > cut_off || v.abs() >= 30.0 || h.abs() >= 30.0 {
            return 0.0;
        }
        20000.0 * gauss((h - 3.0) / 10.0) * gauss((v + 1.5) / 3.0)
    })
}

/// A batwing stored as one quadrant: I = 1000 cos V (0.4 + 1.8 sin^2 V (1 + 0.2 cos 2H)) cd; 1300 pi lm.
fn batwing() -> String {
    let file = File {
        labels: &["[TEST] caustix batwing", "[LUMINAIRE] two wings across the axis"],
        opening: "0.3 1.2 0",
        ..File::new("IESNA:LM-63-1995")
    };
    let table = Table { vertical: steps(0.0, 2.5, 37), horizontal: steps(0.0, 22.5, 5), decimals: 3 };
    file.write(&table, |v, h| {
        let s = sin_deg(v);
        1000.0 * cos_deg(v) * (0.4 + 1.8 * s * s * (1.0 + 0.2 * cos_deg(2.0 * h)))
    })
}

/// Light upwards only, V = 90..180: I = 600 cos^2 V cd; 400 pi lm.
fn uplight() -> String {
    let file =
        File { labels: &["[TEST] caustix uplight", "[LUMINAIRE] upwards"], ..File::new("IESNA:LM-63-2002") };
    let table = Table { vertical: steps(90.0, 2.5, 37), horizontal: vec![0.0], decimals: 4 };
    file.write(&table, |v, _| 600.0 * cos_deg(v) * cos_deg(v))
}

/// 1991, mirrored in the 90-270 plane: I = 900 cos V (1 + 0.9 sin V sin H) cd; 900 pi lm, x 0.95 (ballast) x 0.9
/// (field 12, a factor in this edition); with a tilt table that nothing applies.
fn wall_washer_1991() -> String {
    let file = File {
        labels: &["[TEST] caustix wall_washer_1991", "[LUMINAIRE] towards H = 90"],
        tilt: "TILT=INCLUDE\r\n1\r\n3\r\n0 45 90\r\n1 0.95 0.9",
        lamps: "1 3000 1",
        opening: "-0.3 0 0",
        factors: "0.95 0.9",
        input_watts: "60",
        ..File::new("IESNA91")
    };
    let table = Table { vertical: steps(0.0, 5.0, 19), horizontal: steps(90.0, 15.0, 13), decimals: 4 };
    file.write(&table, |v, h| 900.0 * cos_deg(v) * (1.0 + 0.9 * sin_deg(v) * sin_deg(h)))
}

/// 2019, the whole circle: I = 1500 cos V (1 + 0.3 sin V cos(H - 40 degrees)) cd; 1500 pi lm. Field 12 says "computer
/// simulation" and is no factor.
fn panel_2019() -> String {
    let file = File {
        labels: &[
            "[TEST] caustix panel_2019",
            "[TESTLAB] none",
            "[ISSUEDATE] 2026",
            "[MANUFAC] caustix",
            "[LUMINAIRE] tilted panel",
        ],
        opening: "0.6 0.6 0",
        factors: "1 1.00010",
        input_watts: "40",
        ..File::new("IES:LM-63-2019")
    };
    let table = Table { vertical: steps(0.0, 2.5, 37), horizontal: steps(0.0, 30.0, 13), decimals: 3 };
    file.write(&table, |v, h| 1500.0 * cos_deg(v) * (1.0 + 0.3 * sin_deg(v) * cos_deg(h - 40.0)))
}

/// The angles of a file, and the decimals of its intensities.
struct Table {
    vertical: Vec<f64>,
    horizontal: Vec<f64>,
    decimals: usize,
}

/// What stands around the table; every field as it is written.
struct File<'a> {
    version: &'a str,
    labels: &'a [&'a str],
    tilt: &'a str,
    /// Lamps, lumens per lamp (-1: absolute), multiplier.
    lamps: &'a str,
    /// 1 C, 2 B, 3 A.
    photometric_type: u32,
    /// 1 feet, 2 metres.
    units: u32,
    opening: &'a str,
    /// Ballast factor and field 12.
    factors: &'a str,
    input_watts: &'a str,
}

impl<'a> File<'a> {
    fn new(version: &'a str) -> Self {
        Self {
            version,
            labels: &[],
            tilt: "TILT=NONE",
            lamps: "1 -1 1",
            photometric_type: 1,
            units: 2,
            opening: "0 0 0",
            factors: "1 1",
            input_watts: "0",
        }
    }

    /// The file's text; intensity(V, H) in degrees, before the multiplier. Lines end with CR LF and stay below 80.
    fn write(&self, table: &Table, intensity: impl Fn(f64, f64) -> f64) -> String {
        let mut out = format!("{}\r\n", self.version);
        for label in self.labels {
            out += &format!("{label}\r\n");
        }
        let (n_v, n_h) = (table.vertical.len(), table.horizontal.len());
        out += &format!("{}\r\n{} {n_v} {n_h} ", self.tilt, self.lamps);
        out += &format!("{} {} {}\r\n", self.photometric_type, self.units, self.opening);
        out += &format!("{} {}\r\n", self.factors, self.input_watts);
        wrap(&mut out, table.vertical.iter().map(|v| format!("{v}")));
        wrap(&mut out, table.horizontal.iter().map(|h| format!("{h}")));
        for &h in &table.horizontal {
            let decimals = table.decimals;
            // Adding 0 turns a negative zero into a plain one.
            wrap(
                &mut out,
                table.vertical.iter().map(|&v| format!("{:.decimals$}", intensity(v, h).max(0.0) + 0.0)),
            );
        }
        out
    }
}

fn wrap(out: &mut String, words: impl Iterator<Item = String>) {
    let mut column = 0;
    for word in words {
        let blank = if column == 0 { "" } else { " " };
        if column + blank.len() + word.len() > 78 {
            out.push_str("\r\n");
            column = 0;
        }
        let blank = if column == 0 { "" } else { " " };
        // Writing to a String cannot fail.
        let _ = write!(out, "{blank}{word}");
        column += blank.len() + word.len();
    }
    out.push_str("\r\n");
}

fn steps(first: f64, step: f64, n: u32) -> Vec<f64> {
    (0..n).map(|i| first + step * f64::from(i)).collect()
}

/// 2^-(x^2): one half at x = 1.
fn gauss(x: f64) -> f64 {
    exp(-LN_2 * x * x)
}

fn sin_deg(x: f64) -> f64 {
    sin(x.to_radians())
}

fn cos_deg(x: f64) -> f64 {
    cos(x.to_radians())
}

/// Angle between two directions of type C, degrees.
fn angle_between_deg(v: f64, h: f64, v0: f64, h0: f64) -> f64 {
    let cosine = cos_deg(v) * cos_deg(v0) + sin_deg(v) * sin_deg(v0) * cos_deg(h - h0);
    acos(cosine.clamp(-1.0, 1.0)).to_degrees()
}
