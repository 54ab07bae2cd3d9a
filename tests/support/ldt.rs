//! EULUMDAT files from formulas: every line has its number in the format, so that a test can change any of
//! them.

use std::f64::consts::PI;

/// cd per 1000 lm of a direction (gamma, C), rad.
pub type Table = fn(f64, f64) -> f64;

/// 100 + 40 sin gamma sin C: symmetric to C90-C270.
pub const TO_90: Table = |gamma, c| 100.0 + 40.0 * gamma.sin() * c.sin();
/// Symmetric to C0-C180.
pub const TO_0: Table = |gamma, c| 100.0 + 40.0 * gamma.sin() * c.cos();
/// Both.
pub const BOTH: Table = |gamma, c| 100.0 + 40.0 * gamma.sin() * (2.0 * c).cos();
/// Neither.
pub const NEITHER: Table = |gamma, c| 100.0 + 40.0 * gamma.sin() * (c - 40f64.to_radians()).cos();
/// 1000 lm for 1000 lm.
pub const EVEN: Table = |_, _| 1000.0 / (4.0 * PI);

/// A file.
#[derive(Clone)]
pub struct Ldt {
    pub isym: usize,
    pub c: Vec<f64>,
    pub gamma: Vec<f64>,
    /// Dc and Dg.
    pub steps: [f64; 2],
    /// DFF, LORL, conversion factor, tilt.
    pub four: [&'static str; 4],
    /// Lines of the lamp sets, as they stand.
    pub sets: &'static [[&'static str; 6]],
    pub table: Table,
}

pub const ONE: [[&str; 6]; 1] = [["1", "LED", "1000", "4000", "80", "10"]];

pub fn even(step: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| step * i as f64).collect()
}

impl Ldt {
    /// 24 planes, 37 angles, one lamp set of 1000 lm.
    pub fn new(isym: usize, table: Table) -> Self {
        let (c, gamma) = (even(15.0, 24), even(5.0, 37));
        let four = ["50", "0", "1", "0"];
        Self { isym, c, gamma, steps: [15.0, 5.0], four, sets: &ONE, table }
    }

    /// C angles of the planes that have values, in the order of the file.
    pub fn stored(&self) -> Vec<f64> {
        let n = self.c.len();
        match self.isym {
            0 => self.c.clone(),
            1 => self.c[..1].to_vec(),
            2 => self.c[..=n / 2].to_vec(),
            3 => [&self.c[3 * n / 4..], &self.c[..=n / 4]].concat(),
            _ => self.c[..=n / 4].to_vec(),
        }
    }

    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = vec!["Nobody".into(), "3".into(), self.isym.to_string()];
        lines.extend(
            [self.c.len() as f64, self.steps[0], self.gamma.len() as f64, self.steps[1]]
                .map(|x| x.to_string()),
        );
        lines.extend(["0", "made up", "1", "x.ldt", "2026-11-26"].map(String::from));
        lines.extend(["1200", "300", "60", "1100", "200", "0", "0", "0", "0"].map(String::from));
        lines.extend(self.four.map(String::from));
        lines.push(self.sets.len().to_string());
        lines.extend(self.sets.iter().flatten().map(|line| (*line).to_owned()));
        lines.extend((0..10).map(|_| "0".to_owned()));
        lines.extend(self.c.iter().chain(&self.gamma).map(f64::to_string));
        for c in self.stored() {
            let value = |gamma: &f64| (self.table)(gamma.to_radians(), c.to_radians()).to_string();
            lines.extend(self.gamma.iter().map(value));
        }
        lines
    }

    pub fn text(&self) -> String {
        self.lines().join("\r\n") + "\r\n"
    }
}
