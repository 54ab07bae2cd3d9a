//! A scattering table: values over incident and scattered directions, one lobe for each thing a surface does with light.
//!
//! **Value.** The BSDF f without the cosine, 1/sr: radiance leaving towards wo over illuminance arriving from wi. Both wi and
//! wo point away from the surface. With f known the part of the light from wi that is scattered is the integral of
//! f cos(theta_o) over the lobe's hemisphere.
//!
//! **Incidence.** theta_i is the angle between wi and the normal n on the side the light comes from. phi_i is the azimuth of
//! wi about n, counter-clockwise seen from the tip of n, from the surface's reference direction; isotropic tables have
//! one phi_i, which means nothing. Below the first theta_i its slice holds, beyond the last one the last.
//!
//! **Scattered directions.** t is the direction along the surface in which the mirrored and the straight-through light go on
//! (opposite to the part of wi along the surface), m the normal of the side light leaves on: n for reflection, -n for
//! transmission.
//!
//! | frame | polar angle from | azimuth 0 | azimuth grows |
//! |---|---|---|---|
//! | surface | m | t | counter-clockwise seen from the tip of n, so towards n x t |
//! | specular | s, the mirrored or straight-through direction | towards m: the part of m across s | counter-clockwise seen from the tip of s |
//!
//! At normal incidence the specular frame's azimuth 0 is the limit from theta_i > 0: -t, the side the light comes from. In
//! both frames a table that is symmetric about the plane of incidence has equal values at +azimuth and -azimuth; it is
//! stored unfolded, over a full turn. Between nodes f cos(theta_o) is bilinear in polar angle and azimuth, it is
//! zero beyond the last polar angle, and below the horizon of m a node counts as zero whatever the file says.

use crate::error::words::limit;
use crate::error::{Diagnostic, Kind, Result};

/// Values a table may have in all its lobes: 256 MiB.
pub const MAX_VALUES: usize = 1 << 26;

/// Which way the light of a lobe goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Back to the side it comes from (BRDF).
    Reflection,
    /// To the other side (BTDF).
    Transmission,
}

/// The side of the surface that the light of a lobe comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LobeSide {
    /// The side the outward normal points to.
    Front,
    /// The other one.
    Back,
    /// Either: the lobe is the same for both.
    Both,
}

/// What scattered directions are measured from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// The normal.
    Surface,
    /// The mirrored (reflection) or straight-through (transmission) direction.
    Specular,
}

/// The parts of a lobe as a reader fills them in; [`Lobe::new`] checks them. Angles in degrees.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeData {
    /// Which way the light goes.
    pub quantity: Quantity,
    /// Where it comes from.
    pub side: LobeSide,
    /// What the scattered directions are measured from.
    pub frame: Frame,
    /// Incident polar angles, rising within 0 to 90; one or more.
    pub theta_i_deg: Vec<f64>,
    /// Incident azimuths: one for an isotropic table, else rising over one full turn with both ends (0 and 360).
    pub phi_i_deg: Vec<f64>,
    /// Scattered polar angles, rising within 0 to 180; two or more.
    pub polar_deg: Vec<f64>,
    /// Scattered azimuths, rising over one full turn with both ends (-180 and 180, or 0 and 360).
    pub azimuth_deg: Vec<f64>,
    /// 1, or 3 for linear sRGB.
    pub channels: usize,
    /// f in 1/sr, index `[channel][phi_i][theta_i][polar][azimuth]`.
    pub values: Vec<f32>,
    /// Total integrated scatter as the file states it, index `[phi_i][theta_i]`; empty where it states none.
    pub declared_tis: Vec<f64>,
}

impl LobeData {
    /// Channels, phi_i, theta_i, polar angles and azimuths: how many of each.
    pub fn counts(&self) -> [usize; 5] {
        let [phi_i, theta_i] = [&self.phi_i_deg, &self.theta_i_deg].map(Vec::len);
        [self.channels, phi_i, theta_i, self.polar_deg.len(), self.azimuth_deg.len()]
    }
}

/// A checked lobe: finite values that are not negative, angles that rise within their ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct Lobe {
    data: LobeData,
}

impl std::ops::Deref for Lobe {
    type Target = LobeData;

    fn deref(&self) -> &LobeData {
        &self.data
    }
}

impl Lobe {
    /// Checks the parts. Negative values, which noise in measurements makes, become zero; the warning says how many there
    /// were and the most negative one.
    ///
    /// # Errors
    /// Angles that do not rise or leave their range, azimuths that do not span a full turn, another number of channels than
    /// 1 or 3, another number of values than the angles ask for, more than `MAX_VALUES`, a value that is not finite, and
    /// declared scatter that is not finite or not one for each incidence.
    pub fn new(mut data: LobeData) -> Result<(Self, Option<Diagnostic>)> {
        check_angles("theta_i", &data.theta_i_deg, 1, 90.0)?;
        check_angles("scattered polar", &data.polar_deg, 2, 180.0)?;
        check_turn("scattered azimuth", &data.azimuth_deg)?;
        if data.phi_i_deg.len() == 1 {
            finite("phi_i", &data.phi_i_deg)?;
        } else {
            check_turn("phi_i", &data.phi_i_deg)?;
        }
        check_counts(&data)?;
        if let Some(at) = data.values.iter().position(|v| !v.is_finite()) {
            return out_of_range(
                format!("value {} of {}: {}", at + 1, data.values.len(), data.values[at]),
                "finite values",
            );
        }
        let warning = clamp_negatives(&mut data.values);
        Ok((Self { data }, warning))
    }

    /// Number of values that angles and channels of these counts ask for.
    ///
    /// Readers call it before they make room for a table.
    ///
    /// # Errors
    /// More than `MAX_VALUES`.
    pub fn value_count(counts: [usize; 5]) -> Result<usize> {
        let product = counts.iter().try_fold(1usize, |n, c| n.checked_mul(*c));
        product.filter(|n| *n <= MAX_VALUES).ok_or_else(|| {
            let counts = counts.map(|c| c.to_string()).join(" x ");
            Diagnostic::new(
                Kind::Limit,
                format!("{counts} values (channels x phi_i x theta_i x polar x azimuth)"),
                format!("at most {} in all", limit(MAX_VALUES as u64)),
            )
        })
    }

    /// The parts.
    pub fn into_data(self) -> LobeData {
        self.data
    }

    /// Whether the surface looks the same from all azimuths of incidence.
    pub fn is_isotropic(&self) -> bool {
        self.phi_i_deg.len() == 1
    }

    /// The values of one channel at one incidence, index `[polar][azimuth]`.
    pub fn slice(&self, channel: usize, phi_i: usize, theta_i: usize) -> &[f32] {
        let [_, phis, thetas, polar, azimuth] = self.counts();
        let nodes = polar * azimuth;
        let start = ((channel * phis + phi_i) * thetas + theta_i) * nodes;
        &self.values[start..start + nodes]
    }

    /// The scatter that the file declares for one incidence.
    pub fn declared(&self, phi_i: usize, theta_i: usize) -> Option<f64> {
        self.declared_tis.get(phi_i * self.theta_i_deg.len() + theta_i).copied()
    }
}

/// A file's scattering table: everything the surface does with light.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterTable {
    /// What the file calls it, or the file's name.
    pub name: String,
    /// At least one; at most one of each quantity for light from each side.
    pub lobes: Vec<Lobe>,
    /// What is allowed but probably not meant.
    pub warnings: Vec<Diagnostic>,
}

impl ScatterTable {
    /// Checks the lobes one by one and together; `warnings` are the reader's own, those found here are added.
    ///
    /// # Errors
    /// Those of [`Lobe::new`]; no lobe; two lobes for the same light; more than `MAX_VALUES` in all.
    pub fn new(name: impl Into<String>, lobes: Vec<LobeData>, mut warnings: Vec<Diagnostic>) -> Result<Self> {
        if lobes.is_empty() {
            return Err(Diagnostic::new(Kind::Missing, "a table without lobes", "at least one lobe"));
        }
        if lobes.iter().map(|l| l.values.len()).sum::<usize>() > MAX_VALUES {
            return Err(Diagnostic::new(
                Kind::Limit,
                format!("{} lobes with more than {} values in all", lobes.len(), limit(MAX_VALUES as u64)),
                format!("at most {}", limit(MAX_VALUES as u64)),
            ));
        }
        for (i, one) in lobes.iter().enumerate() {
            if lobes[..i].iter().any(|other| one.quantity == other.quantity && meet(one.side, other.side)) {
                return out_of_range(
                    format!("two lobes for the {:?} of light from the same side", one.quantity),
                    "at most one for each quantity and side",
                );
            }
        }
        let mut checked = Vec::with_capacity(lobes.len());
        for data in lobes {
            let (lobe, warning) = Lobe::new(data)?;
            checked.push(lobe);
            warnings.extend(warning);
        }
        Ok(Self { name: name.into(), lobes: checked, warnings })
    }

    /// The lobe for light from one side.
    pub fn lobe(&self, quantity: Quantity, from_front: bool) -> Option<&Lobe> {
        let side = if from_front { LobeSide::Front } else { LobeSide::Back };
        self.lobes.iter().find(|l| l.quantity == quantity && meet(l.side, side))
    }
}

fn meet(a: LobeSide, b: LobeSide) -> bool {
    a == b || a == LobeSide::Both || b == LobeSide::Both
}

fn check_counts(data: &LobeData) -> Result<()> {
    if ![1, 3].contains(&data.channels) {
        return out_of_range(format!("{} channels", data.channels), "1 or 3");
    }
    let required = Lobe::value_count(data.counts())?;
    if data.values.len() != required {
        return out_of_range(
            format!("{} values", data.values.len()),
            format!("{required}, one for each channel and combination of angles"),
        );
    }
    let incidences = data.phi_i_deg.len() * data.theta_i_deg.len();
    if ![0, incidences].contains(&data.declared_tis.len()) {
        return out_of_range(
            format!("{} declared total scatters for {incidences} incidences", data.declared_tis.len()),
            "none, or one for each incidence",
        );
    }
    finite("declared total scatter", &data.declared_tis)
}

fn out_of_range<T>(found: String, required: impl Into<String>) -> Result<T> {
    Err(Diagnostic::new(Kind::Range, found, required))
}

fn finite(what: &str, numbers: &[f64]) -> Result<()> {
    match numbers.iter().find(|x| !x.is_finite()) {
        Some(bad) => out_of_range(format!("{what} {bad}"), "finite numbers"),
        None => Ok(()),
    }
}

fn check_rising(what: &str, angles_deg: &[f64]) -> Result<()> {
    finite(what, angles_deg)?;
    match angles_deg.windows(2).find(|w| w[0] >= w[1]) {
        Some(w) => out_of_range(format!("{what} angle {} after {}", w[1], w[0]), "strictly rising angles"),
        None => Ok(()),
    }
}

fn check_angles(what: &str, angles_deg: &[f64], least: usize, most_deg: f64) -> Result<()> {
    check_rising(what, angles_deg)?;
    if angles_deg.len() < least {
        return Err(Diagnostic::new(
            Kind::Missing,
            format!("{} {what} angles", angles_deg.len()),
            format!("at least {least}"),
        ));
    }
    let (first, last) = (angles_deg[0], angles_deg[angles_deg.len() - 1]);
    if first < 0.0 || last > most_deg {
        return out_of_range(
            format!("{what} angles from {first} to {last}"),
            format!("0 to {most_deg} degrees"),
        );
    }
    Ok(())
}

fn check_turn(what: &str, angles_deg: &[f64]) -> Result<()> {
    check_rising(what, angles_deg)?;
    let turn = angles_deg.first().zip(angles_deg.last()).map_or(0.0, |(first, last)| last - first);
    // Differences of degrees that were printed or computed round at their own size.
    if (turn - 360.0).abs() > 360.0 * 16.0 * f64::EPSILON {
        return out_of_range(
            format!("{what} angles that span {turn} degrees"),
            "one full turn with both ends, such as 0 to 360",
        );
    }
    Ok(())
}

fn clamp_negatives(values: &mut [f32]) -> Option<Diagnostic> {
    let (mut count, mut most) = (0usize, 0.0f32);
    for v in values.iter_mut().filter(|v| **v < 0.0) {
        count += 1;
        most = most.min(*v);
        *v = 0.0;
    }
    (count > 0).then(|| {
        Diagnostic::new(
            Kind::Range,
            format!("{count} negative values of {}, the most negative {most}/sr", values.len()),
            "values that are not negative; they are taken as zero",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lambert() -> LobeData {
        LobeData {
            quantity: Quantity::Reflection,
            side: LobeSide::Front,
            frame: Frame::Surface,
            theta_i_deg: vec![0.0, 60.0],
            phi_i_deg: vec![0.0],
            polar_deg: vec![0.0, 45.0, 90.0],
            azimuth_deg: vec![0.0, 180.0, 360.0],
            channels: 1,
            values: vec![0.3; 18],
            declared_tis: vec![],
        }
    }

    #[test]
    fn good_tables_pass_and_slices_are_found() {
        let mut data = lambert();
        data.channels = 3;
        data.phi_i_deg = vec![0.0, 90.0, 360.0];
        data.values = (0..3 * 3 * 18).map(|i| i as f32).collect();
        data.declared_tis = (0..6).map(f64::from).collect();
        let (lobe, warning) = Lobe::new(data).unwrap();
        assert!(warning.is_none() && !lobe.is_isotropic());
        // channel 2, phi_i 1, theta_i 1: (2 * 3 + 1) * 2 + 1 slices of 9 nodes before it.
        assert_eq!(lobe.slice(2, 1, 1)[0], 135.0);
        assert_eq!((lobe.declared(2, 1), lobe.declared(3, 0)), (Some(5.0), None));
    }

    #[test]
    fn negative_values_become_zero_and_are_reported() {
        let mut data = lambert();
        data.values[3] = -0.25;
        data.values[7] = -1.0;
        let table = ScatterTable::new("x", vec![data], vec![]).unwrap();
        assert_eq!((table.lobes[0].values[3], table.lobes[0].values[7]), (0.0, 0.0));
        assert_eq!(table.warnings[0].found(), "2 negative values of 18, the most negative -1/sr");
    }

    #[test]
    fn bad_tables_are_refused() {
        type Damage = fn(&mut LobeData);
        let damages: [(Damage, Kind); 14] = [
            (|d| d.theta_i_deg.clear(), Kind::Missing),
            (|d| d.theta_i_deg[1] = 0.0, Kind::Range),
            (|d| d.theta_i_deg[1] = 91.0, Kind::Range),
            (|d| d.theta_i_deg[1] = f64::NAN, Kind::Range),
            (|d| d.polar_deg[0] = -1.0, Kind::Range),
            (|d| d.polar_deg = vec![3.0], Kind::Missing),
            (|d| d.azimuth_deg[2] = 359.0, Kind::Range),
            (|d| d.azimuth_deg.clear(), Kind::Range),
            (|d| d.phi_i_deg = vec![0.0, 180.0], Kind::Range),
            (|d| d.channels = 2, Kind::Range),
            (|d| d.values.truncate(17), Kind::Range),
            (|d| d.values[2] = f32::NAN, Kind::Range),
            (|d| d.values[2] = f32::INFINITY, Kind::Range),
            (|d| d.declared_tis = vec![0.5], Kind::Range),
        ];
        for (i, (damage, kind)) in damages.into_iter().enumerate() {
            let mut data = lambert();
            damage(&mut data);
            assert_eq!(Lobe::new(data).unwrap_err().kind(), kind, "damage {i}");
        }
        assert_eq!(Lobe::value_count([3, 1 << 20, 90, 90, 2]).unwrap_err().kind(), Kind::Limit);
        assert_eq!(Lobe::value_count([3, usize::MAX, 9, 9, 2]).unwrap_err().kind(), Kind::Limit);
        assert_eq!(Lobe::value_count([1, 1, 2, 3, 3]).unwrap(), 18);
    }

    #[test]
    fn lobes_of_the_same_light_are_refused() {
        let with = |quantity, side| LobeData { quantity, side, ..lambert() };
        let (r, t) = (Quantity::Reflection, Quantity::Transmission);
        let (front, back, both) = (LobeSide::Front, LobeSide::Back, LobeSide::Both);
        let table = |lobes: &[(Quantity, LobeSide)]| {
            ScatterTable::new("x", lobes.iter().map(|(q, s)| with(*q, *s)).collect(), vec![])
        };
        assert!(table(&[]).is_err());
        assert!(table(&[(r, front), (r, both)]).is_err());
        let good = table(&[(r, front), (r, back), (t, both)]).unwrap();
        assert_eq!(good.lobe(t, false).unwrap().side, both);
        assert_eq!(good.lobe(r, false).unwrap().side, back);
        assert!(table(&[(r, front)]).unwrap().lobe(r, false).is_none());
    }
}
