//! What must hold of every tabulated surface: value, albedo, density and what `scatter` does to photons,
//! against each other and against quadrature. The same checks for tables from formulas, the project's own and
//! real files.
//!
//! `scatter` takes three coordinates here: one decides whether the photon is scattered and by which slice,
//! two place it.

use caustix::sample::coordinates::{Chooser, Coordinates};
use caustix::sample::method::Sampling;
use caustix::scattering::{Frame, LobeData, Quantity, ScatterTable};
use caustix::sequence::hash::mix64;
use caustix::sequence::independent::IndependentPoints;
use caustix::sequence::to_unit_f64;
use caustix::surface::tabulated::{Energy, Options, Sides};
use caustix::surface::{Event, Grey, Tabulated};
use glam::DVec3;

use crate::support::given::{Script, fraction};
use crate::support::local::{self, arriving, luminance};
use crate::support::quadrature::Gauss;
use crate::support::sphere_table::SphereTable;
use crate::support::statistics::{ChiSquare, chi_square};
use crate::support::tables::{angles, direction, incidence};

/// A side of a table on a surface.
pub struct Surface {
    pub name: String,
    pub lobes: Vec<LobeData>,
    pub sampler: Tabulated,
    pub from_front: bool,
}

impl Surface {
    pub fn albedo(&self, wi: DVec3) -> [f64; 3] {
        local::albedo(&self.sampler, self.from_front, wi)
    }

    /// g of a lobe by channel.
    pub fn projected(&self, wi: DVec3, quantity: Quantity, wo: DVec3) -> [f64; 3] {
        local::projected(&self.sampler, self.from_front, wi, quantity, wo)
    }

    /// What becomes of a photon of white light from wi.
    pub fn scatter(&self, wi: DVec3, chooser: &mut impl Chooser) -> Event {
        self.sampler.scatter(&arriving(self.from_front, wi), chooser, &mut Grey)
    }

    /// The same for three coordinates.
    pub fn scatter_by(&self, wi: DVec3, [event, u1, u2]: [u64; 3]) -> Event {
        self.scatter(wi, &mut Script::new(event, &[u1, u2]))
    }
}

/// The sides of a table that scatter, once where both are the same; albedos above 1 are scaled.
pub fn sides(name: &str, table: &ScatterTable) -> Vec<Surface> {
    let options = Options { energy: Energy::Scale, sides: Sides::Front, ..Options::default() };
    let sampler = Tabulated::new(table, &options).unwrap().0;
    let lobes = |from_front| -> Vec<_> {
        let both = [Quantity::Reflection, Quantity::Transmission];
        both.into_iter().filter_map(|quantity| table.lobe(quantity, from_front)).collect()
    };
    let (front, back) = (lobes(true), lobes(false));
    let same = front.len() == back.len() && front.iter().zip(&back).all(|(a, b)| std::ptr::eq(*a, *b));
    let wanted = [(true, front, "front"), (false, if same { vec![] } else { back }, "back")];
    let side = |(from_front, lobes, word): (bool, Vec<&caustix::scattering::Lobe>, &str)| Surface {
        name: if same { name.to_owned() } else { format!("{name}, {word}") },
        lobes: lobes.into_iter().map(|lobe| LobeData::clone(lobe)).collect(),
        sampler: sampler.clone(),
        from_front,
    };
    wanted.into_iter().filter(|(_, lobes, _)| !lobes.is_empty()).map(side).collect()
}

/// Twelve incident directions on and off the angles of a surface's first lobe: normal and grazing, at its
/// first and last angles and others between, halfway and elsewhere between two, beyond the last.
pub fn incidences_of(surface: &Surface) -> Vec<DVec3> {
    let lobe = &surface.lobes[0];
    let (thetas, phis) = (&lobe.theta_i_deg, &lobe.phi_i_deg);
    let (n, m) = (thetas.len(), phis.len());
    let (first, last) = (thetas[0], thetas[n - 1]);
    let between = |k: usize, t: f64| {
        let (k, next) = (k.min(n - 1), (k + 1).min(n - 1));
        thetas[k] + t * (thetas[next] - thetas[k])
    };
    // Azimuths on the table's and off them.
    let turn = |k: usize, t: f64| {
        let (k, next) = (k % m, (k % m + 1).min(m - 1));
        if m == 1 { 29.0 * k as f64 + 31.0 * t } else { phis[k] + t * (phis[next] - phis[k]) }
    };
    let list = [
        (0.0, 0.0),
        (0.4 * first.max(5.0), turn(1, 0.3)),
        (first, turn(2, 0.0)),
        (between(0, 0.5), turn(3, 0.5)),
        (between(n / 3, 0.0), turn(5, 0.0)),
        (between(n / 3, 0.25), turn(7, 0.9)),
        (between(n / 2, 0.0), turn(11, 0.5)),
        (between(n / 2, 0.7), turn(13, 0.0)),
        (between(n.saturating_sub(2), 0.4), turn(17, 0.1)),
        (last.min(89.9), turn(19, 0.0)),
        (0.5 * (last + 89.999), turn(23, 0.6)),
        (89.999, turn(29, 0.4)),
    ];
    list.map(|(theta, phi)| incidence(theta, phi)).to_vec()
}

/// Integrals of g by channel over the cells of a lobe's grid, by quadrature.
fn integrals(surface: &Surface, lobe: usize, wi: DVec3) -> Vec<[f64; 3]> {
    let data = &surface.lobes[lobe];
    let (along, around) = (Gauss::new(7), Gauss::new(3));
    let mut all = Vec::new();
    for polar in data.polar_deg.windows(2) {
        for azimuth in data.azimuth_deg.windows(2) {
            let mut g = [0.0; 3];
            let radians = [polar, azimuth].map(|ends| [ends[0].to_radians(), ends[1].to_radians()]);
            for (theta, weight) in along.points(radians[0][0], radians[0][1]) {
                for (phi, part) in around.points(radians[1][0], radians[1][1]) {
                    let weight = weight * part * theta.sin();
                    let wo = direction(data.frame, data.quantity, wi, theta, phi);
                    let here = surface.projected(wi, data.quantity, wo);
                    (0..3).for_each(|c| g[c] += weight * here[c]);
                }
            }
            all.push(g);
        }
    }
    all
}

/// Integrals of the luminance of g over the cells of a lobe's grid.
pub fn masses(surface: &Surface, lobe: usize, wi: DVec3) -> Vec<f64> {
    integrals(surface, lobe, wi).into_iter().map(luminance).collect()
}

/// The cell of a lobe's grid that holds a direction.
pub fn cell(surface: &Surface, lobe: usize, wi: DVec3, wo: DVec3) -> usize {
    let data = &surface.lobes[lobe];
    let (theta, phi) = angles(data.frame, data.quantity, wi, wo);
    let (theta, mut phi) = (theta.to_degrees(), phi.to_degrees());
    if phi < data.azimuth_deg[0] {
        phi += 360.0;
    }
    let at = |angles: &[f64], x: f64| {
        angles[1..angles.len() - 1].iter().filter(|a| x >= **a).count().min(angles.len() - 2)
    };
    at(&data.polar_deg, theta) * (data.azimuth_deg.len() - 1) + at(&data.azimuth_deg, phi)
}

/// Albedo of every channel is the integral of g over all lobes, to 1e-6. Returns the worst relative
/// difference.
pub fn integrals_agree(surface: &Surface, wi: DVec3) -> f64 {
    let lobes = (0..surface.lobes.len()).map(|lobe| integrals(surface, lobe, wi));
    let cells: Vec<[f64; 3]> = lobes.flatten().collect();
    let mut worst = 0.0f64;
    for (channel, albedo) in surface.albedo(wi).into_iter().enumerate() {
        let g: f64 = cells.iter().map(|g| g[channel]).sum();
        assert!((g - albedo).abs() <= 1e-6 * albedo, "{} {wi} {channel}: {g} {albedo}", surface.name);
        if albedo > 0.0 {
            worst = worst.max((g / albedo - 1.0).abs());
        }
    }
    worst
}

/// How photons get their coordinates: with renormalisation or without, and how tables are sampled.
pub type Way = (bool, Sampling);

/// Chi-square of so many photons from wi: those absorbed, those that leave by the cell of their lobe. Of
/// light below the horizon no direction is told, so the cells that may reach there are one.
pub fn photons_against_quadrature(
    surface: &Surface,
    wi: DVec3,
    n: u64,
    seed: u64,
    (reuse, sampling): Way,
) -> ChiSquare {
    let lobes = 0..surface.lobes.len();
    let expected: Vec<Vec<f64>> = lobes.clone().map(|lobe| masses(surface, lobe, wi)).collect();
    let mut observed: Vec<Vec<u64>> = expected.iter().map(|m| vec![0; m.len()]).collect();
    let points = IndependentPoints::new(seed, 0);
    let (mut below, mut absorbed) = (0, 0);
    for i in 0..n {
        match surface.scatter(wi, &mut Coordinates::sampling_by(&points, i, reuse, sampling)) {
            Event::Leaves { direction, through, .. } => {
                assert!((direction.length() - 1.0).abs() < 1e-12 && (direction.z < 0.0) == through);
                let lobe =
                    surface.lobes.iter().position(|l| (l.quantity == Quantity::Transmission) == through);
                observed[lobe.unwrap()][cell(surface, lobe.unwrap(), wi, direction)] += 1;
            }
            Event::BelowHorizon => below += 1,
            Event::Absorbed => absorbed += 1,
        }
    }
    let safe = lobes.flat_map(|lobe| above(surface, lobe, wi));
    // An albedo of 1 is one to rounding.
    let rest = 1.0 - luminance(surface.albedo(wi));
    let (mut counts, mut weights) = (vec![absorbed, below], vec![if rest > 1e-12 { rest } else { 0.0 }, 0.0]);
    for ((count, weight), safe) in observed.concat().into_iter().zip(expected.concat()).zip(safe) {
        if safe {
            counts.push(count);
            weights.push(weight);
        } else {
            counts[1] += count;
            weights[1] += weight;
        }
    }
    chi_square(&counts, &weights)
}

/// What can scatter a photon from wi: a slice of a lobe for a channel, by its own quadrature.
struct Branch<'a> {
    lobe: &'a LobeData,
    table: SphereTable,
    /// Where its part of the events begins and ends.
    events: [f64; 2],
}

impl Branch<'_> {
    /// (theta, phi) of a direction, phi within the table's range where it can be; `None` outside of it.
    fn place(&self, wi: DVec3, wo: DVec3) -> Option<(f64, f64)> {
        let (theta, phi) = angles(self.lobe.frame, self.lobe.quantity, wi, wo);
        let turn = 2.0 * std::f64::consts::PI;
        let phi = if phi < self.table.azimuth[0] { phi + turn } else { phi };
        let within = |edges: &[f64], x: f64| x >= edges[0] && x <= edges[edges.len() - 1] + 1e-15;
        (within(&self.table.polar, theta) && within(&self.table.azimuth, phi)).then_some((theta, phi))
    }
}

/// Incidences of a lobe about an angle: (index, weight), by the words of the contract: linear between angles,
/// the end ones hold.
fn about(angles: &[f64], x: f64) -> Vec<(usize, f64)> {
    let last = angles.len() - 1;
    match angles.iter().position(|a| *a > x) {
        Some(0) => vec![(0, 1.0)],
        None => vec![(last, 1.0)],
        Some(k) => {
            let t = (x - angles[k - 1]) / (angles[k] - angles[k - 1]);
            vec![(k - 1, 1.0 - t), (k, t)]
        }
    }
}

/// g at the nodes of a slice. A table keeps them as f32, in units of the largest.
fn nodes(lobe: &LobeData, channel: usize, phi_i: usize, theta_i: usize) -> Vec<f64> {
    let (azimuths, nodes) = (lobe.azimuth_deg.len(), lobe.polar_deg.len() * lobe.azimuth_deg.len());
    let slice = (channel * lobe.phi_i_deg.len() + phi_i) * lobe.theta_i_deg.len() + theta_i;
    let wi = incidence(lobe.theta_i_deg[theta_i], 0.0);
    let g: Vec<f64> = (0..nodes)
        .map(|k| {
            let (polar, azimuth) = (lobe.polar_deg[k / azimuths], lobe.azimuth_deg[k % azimuths]);
            let wo = direction(lobe.frame, lobe.quantity, wi, polar.to_radians(), azimuth.to_radians());
            let cos = if lobe.quantity == Quantity::Reflection { wo.z } else { -wo.z };
            if cos < 1e-14 { 0.0 } else { f64::from(lobe.values[slice * nodes + k]) * cos }
        })
        .collect();
    let largest = g.iter().copied().fold(0.0, f64::max);
    g.into_iter()
        .map(|g| if largest > 0.0 { f64::from((g / largest) as f32) * largest } else { 0.0 })
        .collect()
}

/// All branches for light from wi, in the order in which they share events.
fn branches(surface: &Surface, wi: DVec3) -> Vec<Branch<'_>> {
    let theta_deg = wi.truncate().length().atan2(wi.z).to_degrees();
    let phi_deg = wi.y.atan2(wi.x).to_degrees();
    let radians = |angles: &[f64]| angles.iter().map(|a| a.to_radians()).collect::<Vec<f64>>();
    let mut all = Vec::new();
    for quantity in [Quantity::Reflection, Quantity::Transmission] {
        for lobe in surface.lobes.iter().filter(|lobe| lobe.quantity == quantity) {
            let per_channel = lobe.values.len() / lobe.channels;
            let grey = lobe.values.chunks(per_channel).all(|c| c == &lobe.values[..per_channel]);
            let shares = if grey { vec![1.0] } else { vec![0.2126, 0.7152, 0.0722] };
            let first = lobe.phi_i_deg[0];
            let turned =
                if lobe.phi_i_deg.len() == 1 { first } else { first + (phi_deg - first).rem_euclid(360.0) };
            for (channel, share) in shares.into_iter().enumerate() {
                for (j, across) in about(&lobe.phi_i_deg, turned) {
                    for (i, along) in about(&lobe.theta_i_deg, theta_deg) {
                        let values = nodes(lobe, channel, j, i);
                        let table =
                            SphereTable::new(radians(&lobe.polar_deg), radians(&lobe.azimuth_deg), values);
                        let weight = share * across * along * table.total();
                        all.extend((weight > 0.0).then_some((lobe, table, weight)));
                    }
                }
            }
        }
    }
    let whole: f64 = all.iter().map(|(_, _, weight)| weight).sum();
    // The event takes as much as the albedo; what is left of it chooses the branch.
    let scale = luminance(surface.albedo(wi)).min(1.0) / whole;
    let mut sum = 0.0;
    let mut part = |weight: f64| {
        sum += weight * scale;
        [sum - weight * scale, sum]
    };
    all.into_iter().map(|(lobe, table, weight)| Branch { lobe, table, events: part(weight) }).collect()
}

/// Coordinates of a photon, of eight seven that are scattered.
fn coordinates(i: u64, albedo: f64) -> [u64; 3] {
    let [event, u1, u2] = [0, 1, 2].map(|k| mix64(4 * i + k));
    [if i.is_multiple_of(8) { event } else { fraction(albedo.min(1.0) * to_unit_f64(event)) }, u1, u2]
}

/// The coordinates of a photon follow from where it went: whether it was scattered and by which slice from
/// the event, two more by quadrature of that slice; and they send it there again. Returns how many photons
/// left.
pub fn coordinates_come_back(surface: &Surface, wi: DVec3, n: u64) -> usize {
    let name = &surface.name;
    let (branches, albedo) = (branches(surface, wi), luminance(surface.albedo(wi)));
    let mut checked = 0;
    for u in (0..n).map(|i| coordinates(i, albedo)) {
        let event = to_unit_f64(u[0]);
        let at_an_edge = |edge: f64| (event - edge).abs() < 1e-6;
        if at_an_edge(albedo) || branches.iter().any(|b| at_an_edge(b.events[0])) {
            continue;
        }
        let wo = match surface.scatter_by(wi, u) {
            Event::Absorbed => {
                assert!(event > albedo, "{name} {wi}: absorbed at {event} of {albedo}");
                continue;
            }
            Event::BelowHorizon => continue,
            Event::Leaves { direction, .. } => direction,
        };
        assert!(event < albedo, "{name} {wi}: scattered at {event} of {albedo}");
        let branch = branches.iter().find(|b| event < b.events[1]).unwrap();
        assert_eq!(wo.z > 0.0, branch.lobe.quantity == Quantity::Reflection, "{name} {wi}");
        let (theta, phi) =
            branch.place(wi, wo).unwrap_or_else(|| panic!("{name} {wi}: {wo} is off its table"));
        let [v1, v2] = branch.table.by_row(theta, phi);
        // Where the density vanishes at the edge of a cell, angles say little about coordinates.
        let flat = branch.table.density(theta, phi) < 1e-3;
        let off = [v1 - to_unit_f64(u[1]), v2 - to_unit_f64(u[2])].map(f64::abs);
        assert!(off[0] < 1e-8 || flat, "{name} {wi}: {v1} for {}", to_unit_f64(u[1]));
        assert!(off[1] < 1e-6 || flat, "{name} {wi}: {v2} for {}", to_unit_f64(u[2]));
        let again = surface.scatter_by(wi, [u[0], fraction(v1), fraction(v2)]);
        let Event::Leaves { direction, .. } = again else { panic!("{name} {wi}: {again:?}") };
        assert!((direction - wo).length() < 1e-6, "{name} {wi}: {direction} {wo}");
        checked += 1;
    }
    checked
}

/// 1 / |d wo / d(u1, u2)| of a branch by central differences of two widths; `None` where they disagree (an
/// edge of a cell) or light ends below the horizon.
fn inverse_jacobian(surface: &Surface, wi: DVec3, branch: &Branch<'_>, [v1, v2]: [f64; 2]) -> Option<f64> {
    let event = fraction(0.5 * (branch.events[0] + branch.events[1]));
    let (u1, u2) = (fraction(v1), fraction(v2));
    let at = |h: u64| {
        let sample = |u1: Option<u64>, u2: Option<u64>| match surface.scatter_by(wi, [event, u1?, u2?]) {
            Event::Leaves { direction, .. } => Some(direction),
            Event::BelowHorizon | Event::Absorbed => None,
        };
        let width = 2.0 * h as f64 / 2f64.powi(64);
        let d1 = sample(u1.checked_add(h), Some(u2))? - sample(u1.checked_sub(h), Some(u2))?;
        let d2 = sample(Some(u1), u2.checked_add(h))? - sample(Some(u1), u2.checked_sub(h))?;
        Some(1.0 / (d1 / width).cross(d2 / width).length())
    };
    let (wide, narrow) = (at(1 << 42)?, at(1 << 41)?);
    ((wide / narrow - 1.0).abs() < 1e-4).then_some(narrow)
}

/// The inverse Jacobians of all branches at a direction, each by its part of the events, add up to g there.
/// Returns how many points were checked, and how many of them several branches reach.
pub fn jacobians_add_up(surface: &Surface, wi: DVec3, n: u64) -> (usize, usize) {
    let (branches, albedo) = (branches(surface, wi), luminance(surface.albedo(wi)));
    let (mut checked, mut several) = (0, 0);
    for u in (0..n).map(|i| coordinates(1 << 32 | i, albedo)) {
        let Event::Leaves { direction: wo, through, .. } = surface.scatter_by(wi, u) else { continue };
        let quantity = if through { Quantity::Transmission } else { Quantity::Reflection };
        let reaching = branches.iter().filter(|b| b.lobe.quantity == quantity);
        let parts: Option<Vec<f64>> = reaching
            .filter_map(|b| Some((b, b.place(wi, wo)?)))
            .filter(|(b, (theta, phi))| b.table.value(*theta, *phi) > 0.0)
            .map(|(b, (theta, phi))| {
                let part = b.events[1] - b.events[0];
                Some(part * inverse_jacobian(surface, wi, b, b.table.by_row(theta, phi))?)
            })
            .collect();
        let Some(parts) = parts else { continue };
        let (sum, g) = (parts.iter().sum::<f64>(), luminance(surface.projected(wi, quantity, wo)));
        assert!((sum / g - 1.0).abs() < 2e-4, "{} {wi}: {sum} {g} {parts:?}", surface.name);
        checked += 1;
        several += usize::from(parts.len() > 1);
    }
    (checked, several)
}

/// The part of the light scattered in n tries that ends below the horizon.
pub fn below_horizon(surface: &Surface, wi: DVec3, n: u64) -> f64 {
    let (mut lost, mut all) = (0.0, 0.0);
    for u in (0..n).map(|i| coordinates(i, luminance(surface.albedo(wi)))) {
        let event = surface.scatter_by(wi, u);
        lost += f64::from(u8::from(matches!(event, Event::BelowHorizon)));
        all += f64::from(u8::from(!matches!(event, Event::Absorbed)));
    }
    if all > 0.0 { lost / all } else { 0.0 }
}

/// Whether a lobe's cells are above the horizon, by their corners; the great circle bends less than 0.02
/// between them.
pub fn above(surface: &Surface, lobe: usize, wi: DVec3) -> Vec<bool> {
    let data = &surface.lobes[lobe];
    let mut all = Vec::new();
    for polar in data.polar_deg.windows(2) {
        for azimuth in data.azimuth_deg.windows(2) {
            let corners = polar.iter().flat_map(|p| azimuth.iter().map(move |a| (p, a)));
            let sides = corners.map(|(p, a)| {
                let wo = direction(data.frame, data.quantity, wi, p.to_radians(), a.to_radians());
                if data.quantity == Quantity::Reflection { wo.z } else { -wo.z }
            });
            all.push(sides.fold(1.0, f64::min) > 0.02 || data.frame == Frame::Surface);
        }
    }
    all
}
