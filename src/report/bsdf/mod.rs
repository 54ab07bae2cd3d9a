//! What `caustix bsdf` says about a scattering table: what it is made of, what it does with the energy, how far it is from
//! reciprocal.

mod text;

use glam::DVec3;
use serde::Serialize;

use crate::scattering::integral::slice_albedo;
use crate::scattering::reciprocity;
use crate::scattering::value::between;
use crate::scattering::{Frame, Lobe, LobeSide, Quantity, ScatterTable};
use crate::surface::luminance;
use crate::surface::tabulated::energy::ONE;

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
        let sides: &[&str] =
            if lobes.iter().all(|l| l.side == "both") { &["both"] } else { &["front", "back"] };
        Self {
            file: file.into(),
            name: table.name.clone(),
            format,
            energy: sides.iter().filter_map(|side| energy(&lobes, side)).collect(),
            reciprocity: reciprocity::all(table).into_iter().map(reciprocity_summary).collect(),
            warnings: table.warnings.iter().map(ToString::to_string).collect(),
            lobes,
        }
    }
}

impl LobeSummary {
    fn new(lobe: &Lobe) -> Self {
        let incidence = |p: usize, t: usize| {
            let rgb = (lobe.channels == 3).then(|| [0, 1, 2].map(|c| slice_albedo(lobe, c, p, t)));
            IncidenceSummary {
                theta_i_deg: lobe.theta_i_deg[t],
                phi_i_deg: lobe.phi_i_deg[p],
                albedo: rgb.map_or_else(|| slice_albedo(lobe, 0, p, t), luminance),
                albedo_rgb: rgb,
                tis_declared: lobe.declared(p, t),
            }
        };
        let thetas = lobe.theta_i_deg.len();
        let incidences = (0..lobe.phi_i_deg.len() * thetas).map(|i| incidence(i / thetas, i % thetas));
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
            incidences: incidences.collect(),
        }
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

/// The largest albedo for light from one side: mixtures are linear, so the tables' own angles are enough.
fn energy(lobes: &[LobeSummary], side: &'static str) -> Option<EnergySummary> {
    let lobes: Vec<&LobeSummary> = lobes.iter().filter(|l| l.side == "both" || l.side == side).collect();
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
