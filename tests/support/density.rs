//! The density that a photometric file stands for, by quadrature of its own candela: cell masses and distribution
//! functions over the type's polar angle and azimuth. Nothing of the sampler is used.

use super::quadrature::Gauss;
use caustix::photometry::{PhotometricType, Web};

/// The weight of the solid angle over the polar angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// sin of the angle: type C, polar angle V from the aim.
    Sine,
    /// cos of the angle: types A (V) and B (H), a latitude.
    Cosine,
}

/// A file's intensities over polar angle p and azimuth q, degrees: (V, H) for types C and A, (H, V) for B.
#[derive(Debug, Clone)]
pub struct Density<'w> {
    web: &'w Web,
    measure: Measure,
    /// Angles between which the density is smooth, degrees.
    pub p_breaks: Vec<f64>,
    pub q_breaks: Vec<f64>,
}

/// Breaks nearer than this many degrees are the same stored angle, mirrored in two ways.
const SAME_DEG: f64 = 1e-9;

impl<'w> Density<'w> {
    /// The density in the file's own measure.
    pub fn new(web: &'w Web) -> Self {
        let mirrored = |angles: &[f64]| {
            let ends = if angles.len() == 1 { vec![-90.0, 90.0] } else { Vec::new() };
            sorted(angles.iter().flat_map(|a| [*a, -a]).chain(ends))
        };
        let (v, h) = (&web.vertical_deg, &web.horizontal_deg);
        // Every symmetry of type C reflects or turns by quarters: all images are taken, whichever it is.
        let around = || {
            let images = h.iter().flat_map(|a| [*a, -a, 180.0 + a, 180.0 - a]);
            sorted(images.map(|a| a.rem_euclid(360.0)).chain([0.0, 360.0]))
        };
        let (measure, p_breaks, q_breaks) = match web.photometric_type {
            PhotometricType::C => (Measure::Sine, v.clone(), around()),
            PhotometricType::A => (Measure::Cosine, mirrored(v), mirrored(h)),
            PhotometricType::B => (Measure::Cosine, mirrored(h), mirrored(v)),
        };
        Self { web, measure, p_breaks, q_breaks }
    }

    /// The same candela under a solid angle that may be the wrong one: |sin| or |cos| of the polar angle.
    pub fn with_measure(self, measure: Measure) -> Self {
        Self { measure, ..self }
    }

    /// (V, H) as polar angle and azimuth.
    pub fn polar_and_azimuth(&self, (v, h): (f64, f64)) -> (f64, f64) {
        if self.web.photometric_type == PhotometricType::B { (h, v) } else { (v, h) }
    }

    fn intensity_cd(&self, p: f64, q: f64) -> f64 {
        let (v, h) = if self.web.photometric_type == PhotometricType::B { (q, p) } else { (p, q) };
        self.web.intensity_cd(v, h)
    }

    fn weight(&self, p: f64) -> f64 {
        match self.measure {
            Measure::Sine => p.to_radians().sin().abs(),
            Measure::Cosine => p.to_radians().cos().abs(),
        }
    }

    /// Integrals over solid angle (so lm, without the file's factor) of the cells between these edges, `[p][q]` in rows.
    pub fn masses(&self, p_edges: &[f64], q_edges: &[f64]) -> Vec<f64> {
        let (along_p, along_q) = (Gauss::new(8), linear());
        let p_panels = sorted(p_edges.iter().chain(&self.p_breaks).copied());
        let q_panels = sorted(q_edges.iter().chain(&self.q_breaks).copied());
        let columns = q_edges.len() - 1;
        let mut masses = vec![0.0; (p_edges.len() - 1) * columns];
        for p in p_panels.windows(2) {
            let Some(row) = panel_in(p_edges, p) else { continue };
            for q in q_panels.windows(2) {
                let Some(column) = panel_in(q_edges, q) else { continue };
                masses[row * columns + column] += along_p.integrate(p[0], p[1], |p| {
                    self.weight(p) * along_q.integrate(q[0], q[1], |q| self.intensity_cd(p, q))
                });
            }
        }
        let steradian = 1f64.to_radians().powi(2);
        masses.iter().map(|m| m * steradian).collect()
    }

    /// Integral over all directions: the flux without the file's factor.
    pub fn total(&self) -> f64 {
        self.masses(&ends(&self.p_breaks), &ends(&self.q_breaks))[0]
    }

    /// Integral of intensity times a function of (polar angle, azimuth) over solid angle.
    pub fn moment(&self, f: impl Fn(f64, f64) -> f64) -> f64 {
        let rule = Gauss::new(8);
        let steradian = 1f64.to_radians().powi(2);
        steradian
            * rule.over_panels(&self.p_breaks, |p| {
                self.weight(p) * rule.over_panels(&self.q_breaks, |q| self.intensity_cd(p, q) * f(p, q))
            })
    }

    /// The distribution function of the polar angle.
    pub fn polar_cdf(&self) -> PolarCdf {
        const PARTS: usize = 8;
        let rule = linear();
        let marginal =
            |p: f64| self.weight(p) * rule.over_panels(&self.q_breaks, |q| self.intensity_cd(p, q));
        let along_p = Gauss::new(4);
        let (mut panels, mut mass) = (Vec::new(), 0.0);
        for b in self.p_breaks.windows(2) {
            let step = (b[1] - b[0]) / PARTS as f64;
            for k in 0..PARTS {
                let (low, high) = (b[0] + k as f64 * step, b[0] + (k + 1) as f64 * step);
                // The density may jump at a break: its ends are taken just inside.
                let slopes = [marginal(low + 1e-9 * step), marginal(high - 1e-9 * step)];
                let inside = along_p.integrate(low, high, marginal);
                panels.push(Panel { low, width: step, below: mass, inside, slopes });
                mass += inside;
            }
        }
        PolarCdf { panels, mass }
    }

    /// The conditional distribution function of the azimuth at a polar angle.
    pub fn azimuth_cdf(&self, p: f64, q: f64) -> f64 {
        let rule = linear();
        let (mut below, mut total) = (0.0, 0.0);
        for b in self.q_breaks.windows(2) {
            let panel = rule.integrate(b[0], b[1], |q| self.intensity_cd(p, q));
            total += panel;
            if q >= b[1] {
                below += panel;
            } else if q > b[0] {
                below += rule.integrate(b[0], q, |q| self.intensity_cd(p, q));
            }
        }
        below / total
    }
}

/// A distribution function by panels: exact masses at their ends, cubic between (error of the fourth order in a panel
/// of an eighth of a cell).
#[derive(Debug, Clone)]
pub struct PolarCdf {
    panels: Vec<Panel>,
    mass: f64,
}

#[derive(Debug, Clone, Copy)]
struct Panel {
    low: f64,
    width: f64,
    below: f64,
    inside: f64,
    slopes: [f64; 2],
}

impl PolarCdf {
    /// F(p).
    pub fn at(&self, p: f64) -> f64 {
        let panel = self.panels[self.panels.partition_point(|a| a.low <= p).saturating_sub(1)];
        let x = ((p - panel.low) / panel.width).clamp(0.0, 1.0);
        let (m0, m1) = (panel.slopes[0] * panel.width, panel.slopes[1] * panel.width);
        let cubic =
            panel.inside * x * x * (3.0 - 2.0 * x) + m0 * x * (1.0 - x).powi(2) - m1 * x * x * (1.0 - x);
        (panel.below + cubic) / self.mass
    }
}

/// Exact along the azimuth, where the candela between neighbouring angles of the file is linear.
fn linear() -> Gauss {
    Gauss::new(1)
}

/// The first and the last of a list.
pub fn ends(list: &[f64]) -> [f64; 2] {
    [list[0], list[list.len() - 1]]
}

/// Which of the panels between `edges` holds this one.
fn panel_in(edges: &[f64], panel: &[f64]) -> Option<usize> {
    let middle = 0.5 * (panel[0] + panel[1]);
    let at = edges.partition_point(|e| *e <= middle);
    (at > 0 && at < edges.len()).then(|| at - 1)
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut list: Vec<f64> = values.collect();
    list.sort_by(f64::total_cmp);
    list.dedup_by(|b, a| *b - *a < SAME_DEG);
    list
}
