//! What `caustix bsdf` says about a scattering table: what it is made of, what it does with the energy, how far it is from
//! reciprocal.

use std::fmt::Write;

use glam::DVec3;
use serde::Serialize;

use crate::scattering::integral::slice_albedo;
use crate::scattering::reciprocity;
use crate::scattering::value::between;
use crate::scattering::{Frame, Lobe, LobeSide, Quantity, ScatterTable};
use crate::surface::luminance;
use crate::surface::tabulated::energy::ONE;

use super::numbers::{digits, printable, rounded, written};

/// Rows of the printed albedo table; of more incidences some are left out.
const MOST_ROWS: usize = 24;

/// The record of `caustix bsdf --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BsdfSummary {
    /// The file's path as given.
    pub file: String,
    /// What the table calls itself.
    pub name: String,
    /// What the format is called.
    pub format: &'static str,
    /// What the surface does with light.
    pub lobes: Vec<LobeSummary>,
    /// What becomes of the light of each side.
    pub energy: Vec<EnergySummary>,
    /// f(wi, wo) against f(wo, wi).
    pub reciprocity: Vec<ReciprocitySummary>,
    /// What was tolerated.
    pub warnings: Vec<String>,
}

/// One lobe.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LobeSummary {
    /// `reflection` (BRDF) or `transmission` (BTDF).
    pub quantity: &'static str,
    /// The side the light comes from: `front`, `back` or `both`.
    pub side: &'static str,
    /// `surface` or `specular`: what scattered directions are measured from.
    pub frame: &'static str,
    /// 1, or 3 for linear sRGB.
    pub channels: usize,
    /// Whether the surface looks the same from all azimuths of incidence.
    pub isotropic: bool,
    /// Of the scattered light: `rotational` about the frame's pole, `plane`: about the plane of incidence, `none`.
    pub symmetry: &'static str,
    /// Incident polar angles, degrees.
    pub theta_i_deg: Vec<f64>,
    /// Incident azimuths, degrees; one where they mean nothing.
    pub phi_i_deg: Vec<f64>,
    /// Number of scattered polar angles.
    pub polar_angles: usize,
    /// The last of them, degrees.
    pub polar_last_deg: f64,
    /// Number of scattered azimuths, unfolded to a full turn with both ends.
    pub azimuth_angles: usize,
    /// Largest value, 1/sr.
    pub max_per_sr: f64,
    /// Albedo of every incidence, theta_i running faster than phi_i.
    pub incidences: Vec<IncidenceSummary>,
}

/// What is scattered of the light from one direction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IncidenceSummary {
    /// Polar angle, degrees.
    pub theta_i_deg: f64,
    /// Azimuth, degrees.
    pub phi_i_deg: f64,
    /// Integral of f cos(theta_o), as photons sample it; luminance of colours.
    pub albedo: f64,
    /// The same by channel, of a table in colour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub albedo_rgb: Option<[f64; 3]>,
    /// Total integrated scatter as the file declares it.
    pub tis_declared: Option<f64>,
}

/// Reflected and transmitted light together, for light from one side.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EnergySummary {
    /// The side the light comes from: `front`, `back` or `both`.
    pub side: &'static str,
    /// Largest part that is scattered, over incidences and channels.
    pub max_albedo: f64,
    /// Incident polar angle of it, degrees.
    pub theta_i_deg: f64,
    /// Incident azimuth of it, degrees.
    pub phi_i_deg: f64,
    /// Whether no more leaves than arrives: else a scene takes the table only with `energy = "scale"`.
    pub conserved: bool,
}

/// How far a table is from reciprocal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReciprocitySummary {
    /// `reflection` or `transmission`.
    pub quantity: &'static str,
    /// The side the light comes from on the way there: `front` or `back`.
    pub side: &'static str,
    /// Root mean square of f(wi, wo) - f(wo, wi), relative to that of f.
    pub rms: f64,
    /// Largest |f(wi, wo) - f(wo, wi)|, relative to the larger of the two.
    pub largest: f64,
    /// Incident direction of the largest: polar angle and azimuth, degrees.
    pub incident_deg: [f64; 2],
    /// Scattered direction of the largest: angle from the normal of the side that the light comes from, and azimuth,
    /// degrees.
    pub scattered_deg: [f64; 2],
}

impl BsdfSummary {
    /// The record of a table.
    pub fn new(table: &ScatterTable, file: &str, format: &'static str) -> Self {
        let lobes: Vec<LobeSummary> = table.lobes.iter().map(LobeSummary::new).collect();
        let either = |lobe: &Lobe| lobe.side == LobeSide::Both;
        let sides: &[(&'static str, bool)] = if table.lobes.iter().all(either) {
            &[("both", true)]
        } else {
            &[("front", true), ("back", false)]
        };
        let energy = sides.iter().filter_map(|(side, front)| energy(table, &lobes, side, *front));
        Self {
            file: file.into(),
            name: table.name.clone(),
            format,
            energy: energy.collect(),
            reciprocity: reciprocity::all(table).into_iter().map(reciprocity_summary).collect(),
            warnings: table.warnings.iter().map(ToString::to_string).collect(),
            lobes,
        }
    }

    /// The report for a terminal: one quantity a line, then the albedo against incidence.
    pub fn text(&self) -> String {
        written(|out| self.write(out))
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        let mut line = |name: &str, value: String| writeln!(out, "{name:<20}{value}");
        line("file", printable(&self.file))?;
        line("name", printable(&self.name))?;
        line("format", self.format.into())?;
        for lobe in &self.lobes {
            let colour = if lobe.channels == 3 { "in colour (linear sRGB)" } else { "grey" };
            line(lobe.quantity, format!("{}, {colour}", from_side(lobe.side)))?;
            line("  incident", lobe.incident_text())?;
            line("  scattered", lobe.scattered_text())?;
            line("  largest", format!("{}/sr", digits(lobe.max_per_sr)))?;
        }
        for energy in &self.energy {
            let at = format!("at {}, {}", degrees(energy.theta_i_deg), degrees(energy.phi_i_deg));
            let verdict = if energy.conserved { "" } else { ": more than arrives" };
            let value = rounded(energy.max_albedo, 6);
            line("energy", format!("{}: largest albedo {value} {at}{verdict}", from_side(energy.side)))?;
        }
        for defect in &self.reciprocity {
            line("reciprocity", defect.text())?;
        }
        for warning in &self.warnings {
            line("warning", printable(warning))?;
        }
        for lobe in &self.lobes {
            lobe.write_albedos(out)?;
        }
        Ok(())
    }
}

impl LobeSummary {
    fn new(lobe: &Lobe) -> Self {
        let mut incidences = Vec::with_capacity(lobe.phi_i_deg.len() * lobe.theta_i_deg.len());
        for (p, phi_i_deg) in lobe.phi_i_deg.iter().enumerate() {
            for (t, theta_i_deg) in lobe.theta_i_deg.iter().enumerate() {
                let rgb = (lobe.channels == 3).then(|| [0, 1, 2].map(|c| slice_albedo(lobe, c, p, t)));
                incidences.push(IncidenceSummary {
                    theta_i_deg: *theta_i_deg,
                    phi_i_deg: *phi_i_deg,
                    albedo: rgb.map_or_else(|| slice_albedo(lobe, 0, p, t), luminance),
                    albedo_rgb: rgb,
                    tis_declared: lobe.declared(p, t),
                });
            }
        }
        Self {
            quantity: quantity_word(lobe.quantity),
            side: match lobe.side {
                LobeSide::Front => "front",
                LobeSide::Back => "back",
                LobeSide::Both => "both",
            },
            frame: match lobe.frame {
                Frame::Surface => "surface",
                Frame::Specular => "specular",
            },
            channels: lobe.channels,
            isotropic: lobe.is_isotropic(),
            symmetry: symmetry(lobe),
            theta_i_deg: lobe.theta_i_deg.clone(),
            phi_i_deg: lobe.phi_i_deg.clone(),
            polar_angles: lobe.polar_deg.len(),
            polar_last_deg: lobe.polar_deg.last().copied().unwrap_or_default(),
            azimuth_angles: lobe.azimuth_deg.len(),
            max_per_sr: lobe.values.iter().copied().fold(0.0, f32::max).into(),
            incidences,
        }
    }

    fn incident_text(&self) -> String {
        let last = self.theta_i_deg.last().copied().unwrap_or_default();
        let polar = format!("{} to {}", counted(self.theta_i_deg.len(), "polar angle"), degrees(last));
        if self.isotropic {
            return format!("{polar}, isotropic");
        }
        format!("{polar} x {}, anisotropic", counted(self.phi_i_deg.len(), "azimuth"))
    }

    fn scattered_text(&self) -> String {
        let pole = match (self.frame, self.quantity) {
            ("surface", _) => "the normal",
            (_, "transmission") => "the straight-through direction",
            _ => "the mirrored direction",
        };
        let symmetry = match self.symmetry {
            "rotational" => "the same at all azimuths",
            "plane" => "symmetric about the plane of incidence",
            _ => "without symmetry",
        };
        format!(
            "{} to {} from {pole} x {}, {symmetry}",
            counted(self.polar_angles, "polar angle"),
            degrees(self.polar_last_deg),
            counted(self.azimuth_angles, "azimuth"),
        )
    }

    /// Albedo against theta_i; the range over azimuths where the surface is anisotropic.
    fn write_albedos(&self, out: &mut String) -> std::fmt::Result {
        let thetas = self.theta_i_deg.len();
        let declared = self.incidences.iter().any(|i| i.tis_declared.is_some());
        let mut heads = match (self.isotropic, self.channels) {
            (false, _) => vec!["least", "most"],
            (true, 3) => vec!["albedo", "red", "green", "blue"],
            (true, _) => vec!["albedo"],
        };
        heads.extend(declared.then_some("declared"));
        heads.extend((declared && !self.isotropic).then_some("to"));
        writeln!(out, "\n{} of light {}", self.quantity, from_side(self.side))?;
        write!(out, "{:>10}", "incidence")?;
        heads.iter().try_for_each(|head| write!(out, "{head:>12}"))?;
        writeln!(out)?;
        let every = thetas.div_ceil(MOST_ROWS);
        for t in (0..thetas).filter(|t| t % every == 0 || t + 1 == thetas) {
            let at: Vec<&IncidenceSummary> = self.incidences.iter().skip(t).step_by(thetas).collect();
            write!(out, "{:>10}", degrees(self.theta_i_deg[t]))?;
            let albedos: Vec<f64> = at.iter().map(|i| i.albedo).collect();
            let totals: Vec<f64> = at.iter().filter_map(|i| i.tis_declared).collect();
            let mut columns = if self.isotropic { albedos } else { range(&albedos) };
            columns.extend(at[0].albedo_rgb.filter(|_| self.isotropic).into_iter().flatten());
            columns.extend(if self.isotropic { totals } else { range(&totals) });
            columns.iter().try_for_each(|albedo| write!(out, "{albedo:>12.6}"))?;
            writeln!(out)?;
        }
        if every > 1 {
            writeln!(out, "{:>10}every {every}th of {thetas} incidences; --json has all", "")?;
        }
        Ok(())
    }

    /// Albedo of a channel at an incidence: the slices' own, mixed linearly, the first and the last holding beyond themselves.
    fn albedo(&self, channel: usize, theta_i_deg: f64, phi_i_deg: f64) -> f64 {
        let thetas = self.theta_i_deg.len();
        let own = |p: usize, t: usize| {
            let incidence = &self.incidences[p * thetas + t];
            incidence.albedo_rgb.map_or(incidence.albedo, |rgb| rgb[channel])
        };
        let mut sum = 0.0;
        for (p, of_p) in between(&self.phi_i_deg, phi_i_deg) {
            for (t, of_t) in between(&self.theta_i_deg, theta_i_deg) {
                sum += of_p * of_t * own(p, t);
            }
        }
        sum
    }
}

impl ReciprocitySummary {
    fn text(&self) -> String {
        let percent = |x: f64| format!("{} %", rounded(100.0 * x, 3));
        let direction =
            |[theta, phi]: [f64; 2]| format!("({}, {})", degrees(theta.round()), degrees(phi.round()));
        let way = if self.quantity == "reflection" { from_side(self.side) } else { "through" };
        format!(
            "{} {way}: off by {} (root mean square), at most {}, between {} and {}",
            self.quantity,
            percent(self.rms),
            percent(self.largest),
            direction(self.incident_deg),
            direction(self.scattered_deg),
        )
    }
}

/// The largest albedo for light from one side: mixtures are linear, so the tables' own angles are enough.
fn energy(
    table: &ScatterTable,
    summaries: &[LobeSummary],
    side: &'static str,
    front: bool,
) -> Option<EnergySummary> {
    let concerned = |lobe: &Lobe| match lobe.side {
        LobeSide::Both => true,
        LobeSide::Front => front,
        LobeSide::Back => !front,
    };
    let lobes: Vec<&LobeSummary> =
        table.lobes.iter().zip(summaries).filter(|(lobe, _)| concerned(lobe)).map(|(_, s)| s).collect();
    let at = |theta_i_deg: f64, phi_i_deg: f64, channel: usize| {
        let max_albedo = lobes.iter().map(|l| l.albedo(channel, theta_i_deg, phi_i_deg)).sum();
        EnergySummary { side, max_albedo, theta_i_deg, phi_i_deg, conserved: max_albedo <= ONE }
    };
    let thetas = || lobes.iter().flat_map(|l| &l.theta_i_deg);
    let phis = lobes.iter().flat_map(|l| &l.phi_i_deg);
    let incidences = phis.flat_map(|phi| thetas().map(|theta| (*theta, *phi)));
    let all = incidences.flat_map(|(theta, phi)| [0, 1, 2].map(|channel| at(theta, phi, channel)));
    all.reduce(|most, other| if other.max_albedo > most.max_albedo { other } else { most })
}

/// The least and the greatest; nothing of nothing.
fn range(values: &[f64]) -> Vec<f64> {
    let over = |pick: fn(f64, f64) -> f64| values.iter().copied().reduce(pick);
    over(f64::min).into_iter().chain(over(f64::max)).collect()
}

fn reciprocity_summary(
    (quantity, front, defect): (Quantity, bool, reciprocity::Defect),
) -> ReciprocitySummary {
    let angles = |w: DVec3| {
        let across = (w.x * w.x + w.y * w.y).sqrt();
        [libm::atan2(across, w.z).to_degrees(), libm::atan2(w.y, w.x).to_degrees()]
    };
    ReciprocitySummary {
        quantity: quantity_word(quantity),
        side: if front { "front" } else { "back" },
        rms: defect.rms,
        largest: defect.largest,
        incident_deg: angles(defect.at.0),
        scattered_deg: angles(defect.at.1),
    }
}

/// The symmetry that the values have: of every slice, whatever the file says.
fn symmetry(lobe: &Lobe) -> &'static str {
    let azimuths = lobe.azimuth_deg.len();
    let mut rows = lobe.values.chunks(azimuths);
    if rows.all(|row| row.iter().all(|v| *v == row[0])) {
        return "rotational";
    }
    let turn = lobe.azimuth_deg[0] + lobe.azimuth_deg[azimuths - 1];
    // Angles round when they are unfolded.
    let is_mirrored =
        |i: usize| (lobe.azimuth_deg[i] + lobe.azimuth_deg[azimuths - 1 - i] - turn).abs() < 1e-9 * 360.0;
    let mut rows = lobe.values.chunks(azimuths);
    if (0..azimuths).all(is_mirrored) && rows.all(|row| row.iter().eq(row.iter().rev())) {
        return "plane";
    }
    "none"
}

fn quantity_word(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Reflection => "reflection",
        Quantity::Transmission => "transmission",
    }
}

fn from_side(side: &str) -> &'static str {
    match side {
        "front" => "from the front",
        "back" => "from the back",
        _ => "from either side",
    }
}

fn degrees(angle_deg: f64) -> String {
    format!("{} deg", digits(angle_deg))
}

fn counted(n: usize, noun: &str) -> String {
    if n == 1 { format!("1 {noun}") } else { format!("{n} {noun}s") }
}
