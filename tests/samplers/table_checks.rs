//! What must hold of every tabulated surface: value, albedo, density, sample and its inverse against each other and against
//! quadrature. The same checks for tables from formulas, the project's own and real files.

use caustix::math::solve::Solver;
use caustix::scattering::{Frame, LobeData, Quantity, ScatterTable};
use caustix::sequence::hash::mix64;
use caustix::sequence::to_unit_f64;
use caustix::surface::Tabulated;
use caustix::surface::tabulated::{Energy, Options, Sides};
use glam::DVec3;

use crate::support::quadrature::Gauss;
use crate::support::statistics::{ChiSquare, chi_square};
use crate::support::tables::{angles, direction, incidence};

/// A side of a table on a surface.
pub struct Surface {
    pub name: String,
    pub lobes: Vec<LobeData>,
    pub sampler: Tabulated,
    pub from_front: bool,
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

/// Twelve incident directions on and off the angles of a surface's first lobe: normal and grazing, at its first and last
/// angles and others between, halfway and elsewhere between two, beyond the last.
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

pub fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// Integrals of g by channel and of the density over the cells of a lobe's grid, by quadrature.
fn integrals(surface: &Surface, lobe: usize, wi: DVec3) -> Vec<([f64; 3], f64)> {
    let (data, t, front) = (&surface.lobes[lobe], &surface.sampler, surface.from_front);
    let (along, around) = (Gauss::new(7), Gauss::new(3));
    let mut all = Vec::new();
    for polar in data.polar_deg.windows(2) {
        for azimuth in data.azimuth_deg.windows(2) {
            let (mut g, mut pdf) = ([0.0; 3], 0.0);
            let radians = [polar, azimuth].map(|ends| [ends[0].to_radians(), ends[1].to_radians()]);
            for (theta, weight) in along.points(radians[0][0], radians[0][1]) {
                for (phi, part) in around.points(radians[1][0], radians[1][1]) {
                    let weight = weight * part * theta.sin();
                    let wo = direction(data.frame, data.quantity, wi, theta, phi);
                    let here = t.eval_cos(front, wi, wo, data.quantity);
                    (0..3).for_each(|c| g[c] += weight * here[c]);
                    pdf += weight * t.pdf_omega(front, wi, wo, data.quantity);
                }
            }
            all.push((g, pdf));
        }
    }
    all
}

/// Integrals of the luminance of g and of the density over the cells of a lobe's grid.
pub fn masses(surface: &Surface, lobe: usize, wi: DVec3) -> (Vec<f64>, Vec<f64>) {
    integrals(surface, lobe, wi).into_iter().map(|(g, pdf)| (luminance(g), pdf)).unzip()
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

/// Albedo of every lobe and channel is the integral of its value, to 1e-6; the density integrates to 1. Returns the worst
/// relative difference of an albedo.
pub fn integrals_agree(surface: &Surface, wi: DVec3) -> f64 {
    let (t, front, name) = (&surface.sampler, surface.from_front, &surface.name);
    let (mut whole, mut worst) = (0.0, 0.0f64);
    for (lobe, data) in surface.lobes.iter().enumerate() {
        let cells = integrals(surface, lobe, wi);
        let albedo = t.albedo_of(front, wi, data.quantity);
        for (channel, albedo) in albedo.into_iter().enumerate() {
            let g: f64 = cells.iter().map(|(g, _)| g[channel]).sum();
            assert!((g - albedo).abs() <= 1e-6 * albedo, "{name} {wi} {channel}: {g} {albedo}");
            if albedo > 0.0 {
                worst = worst.max((g / albedo - 1.0).abs());
            }
        }
        whole += cells.iter().map(|(_, pdf)| pdf).sum::<f64>();
    }
    let expected = if luminance(t.albedo(front, wi)) > 0.0 { 1.0 } else { 0.0 };
    assert!((whole - expected).abs() < 1e-6, "{name} {wi}: {whole}");
    worst
}

/// Chi-square of so many samples against the density, cell by cell; `None` where nothing is scattered.
pub fn samples_against_density(surface: &Surface, wi: DVec3, n: u64, key: u64) -> Option<ChiSquare> {
    let (t, front) = (&surface.sampler, surface.from_front);
    let expected: Vec<Vec<f64>> = (0..surface.lobes.len()).map(|lobe| masses(surface, lobe, wi).1).collect();
    if luminance(t.albedo(front, wi)) == 0.0 {
        assert!(t.sample(front, wi, 7 << 60, 0.3, Solver::DEFAULT).is_none());
        return None;
    }
    let mut observed: Vec<Vec<u64>> = expected.iter().map(|m| vec![0; m.len()]).collect();
    for i in 0..n {
        let key = mix64(key << 32 | i);
        let (u1, u2) = (mix64(key), to_unit_f64(mix64(!key)));
        let s = t.sample(front, wi, u1, u2, Solver::DEFAULT).unwrap();
        let lobe = surface.lobes.iter().position(|l| l.quantity == s.quantity).unwrap();
        observed[lobe][cell(surface, lobe, wi, s.wo)] += 1;
        assert!((s.wo.length() - 1.0).abs() < 1e-12);
        let side = if s.quantity == Quantity::Reflection { s.wo.z } else { -s.wo.z };
        assert_eq!(s.below_horizon, side <= 0.0);
    }
    Some(chi_square(&observed.concat(), &expected.concat()))
}

/// One of the preimages of sample(u) is u, and gives the same direction again. Returns how many points were checked.
pub fn inverse_returns(surface: &Surface, wi: DVec3, n: u64) -> usize {
    let (t, front, name) = (&surface.sampler, surface.from_front, &surface.name);
    let mut checked = 0;
    for i in 0..n {
        let (u1, u2) = (mix64(2 * i + 1), to_unit_f64(mix64(2 * i + 2)));
        let Some(s) = t.sample(front, wi, u1, u2, Solver::DEFAULT) else { continue };
        let all = t.invert(front, wi, s.wo, s.quantity);
        let near = |(v1, v2): &(u64, f64)| (v1.abs_diff(u1) as f64 / 2f64.powi(64)).hypot((v2 - u2) * 1e-3);
        let Some(best) = all.iter().min_by(|a, b| near(a).total_cmp(&near(b))) else {
            panic!("{name} {wi} {i}: no coordinates of {s:?}");
        };
        // Where the density vanishes at the edge of a cell, phi says little about u2.
        let steep = t.pdf_omega(front, wi, s.wo, s.quantity) < 1e-3;
        let first = best.0.abs_diff(u1) as f64 / 2f64.powi(64);
        assert!(first < 1e-9, "{name} {wi} {i}: {best:?} for {u1} {u2}");
        assert!((best.1 - u2).abs() < 1e-6 || steep, "{name} {wi} {i}: {best:?} {u2}");
        let again = t.sample(front, wi, best.0, best.1, Solver::DEFAULT).unwrap();
        assert!((again.wo - s.wo).length() < 1e-6, "{name} {wi} {i}");
        checked += 1;
    }
    checked
}

/// 1 / |d wo / d(u1, u2)| by central differences of two widths; `None` where they disagree (an edge of a cell or a choice).
fn inverse_jacobian(surface: &Surface, wi: DVec3, (u1, u2): (u64, f64)) -> Option<f64> {
    let at = |h1: u64, h2: f64| {
        let sample = |u1: u64, u2: f64| {
            Some(surface.sampler.sample(surface.from_front, wi, u1, u2, Solver::DEFAULT)?.wo)
        };
        let (up, down) = (u1.checked_add(h1)?, u1.checked_sub(h1)?);
        let d1 = (sample(up, u2)? - sample(down, u2)?) / (2.0 * h1 as f64 / 2f64.powi(64));
        let d2 = (sample(u1, u2 + h2)? - sample(u1, u2 - h2)?) / (2.0 * h2);
        Some(1.0 / d1.cross(d2).length())
    };
    if !(0.02..0.98).contains(&u2) {
        return None;
    }
    let (wide, narrow) = (at(1 << 39, 2e-6)?, at(1 << 38, 1e-6)?);
    ((wide / narrow - 1.0).abs() < 1e-4).then_some(narrow)
}

/// The inverse Jacobians of all preimages of a direction add up to the density there. Returns how many points were
/// checked, and how many of them had several preimages.
pub fn jacobians_add_up(surface: &Surface, wi: DVec3, n: u64) -> (usize, usize) {
    let (t, front, name) = (&surface.sampler, surface.from_front, &surface.name);
    let (mut checked, mut several) = (0, 0);
    for i in 0..n {
        let (u1, u2) = (mix64(!(3 * i)), to_unit_f64(mix64(!(3 * i + 1))));
        let Some(s) = t.sample(front, wi, u1, u2, Solver::DEFAULT) else { continue };
        let all = t.invert(front, wi, s.wo, s.quantity);
        let parts = all.iter().map(|u| inverse_jacobian(surface, wi, *u)).collect::<Option<Vec<_>>>();
        let Some(parts) = parts else { continue };
        let sum: f64 = parts.iter().sum();
        let pdf = t.pdf_omega(front, wi, s.wo, s.quantity);
        assert!((sum / pdf - 1.0).abs() < 2e-4, "{name} {wi} {i}: {sum} {pdf} {all:?}");
        checked += 1;
        several += usize::from(all.len() > 1);
    }
    (checked, several)
}

/// The part of n samples that ends below the horizon.
pub fn below_horizon(surface: &Surface, wi: DVec3, n: u64) -> f64 {
    let lost = (0..n).filter(|i| {
        let (u1, u2) = (mix64(2 * i), to_unit_f64(mix64(2 * i + 1)));
        let sample = surface.sampler.sample(surface.from_front, wi, u1, u2, Solver::DEFAULT);
        sample.is_some_and(|s| s.below_horizon)
    });
    lost.count() as f64 / n as f64
}

/// Whether a lobe's cells are above the horizon, by their corners; the great circle bends less than 0.02 between them.
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
