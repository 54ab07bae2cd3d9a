//! A scattering table in words.

use std::fmt::Write;

use crate::report::numbers::{digits, printable, rounded, written};

use super::{BsdfSummary, IncidenceSummary, LobeSummary, ReciprocitySummary};

/// Rows of the printed albedo table; of more incidences some are left out.
const MOST_ROWS: usize = 24;

impl BsdfSummary {
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

/// The least and the greatest; nothing of nothing.
fn range(values: &[f64]) -> Vec<f64> {
    let over = |pick: fn(f64, f64) -> f64| values.iter().copied().reduce(pick);
    over(f64::min).into_iter().chain(over(f64::max)).collect()
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
