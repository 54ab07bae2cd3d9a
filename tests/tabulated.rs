//! Scattering tables made from formulas: value, albedo, density, sample and its inverse against each other and against
//! quadrature, for incident directions on and off the table's angles.
//!
//! The frames are written down here once more, from the words of the table's documentation.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

#[path = "tabulated_support/mod.rs"]
mod tables;

mod support;

use caustix::bsdf::tabulated::Options;
use caustix::bsdf::{Bsdf, Fixed, Grey, Incidence, Outcome, Rgb, Tabulated, Throughput};
use caustix::math::solve::Solver;
use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::{Rejection, Sampling};
use caustix::scattering::Quantity::{Reflection, Transmission};
use caustix::sequence::hash::mix64;
use caustix::sequence::independent::IndependentPoints;
use caustix::sequence::to_unit_f64;
use glam::DVec3;
use support::quadrature::Gauss;
use support::statistics::{chi_square, sidak, z_test};
use tables::{Case, angles, cases, direction, incidence, incidences};

/// Chance of a false alarm in a whole test.
const FAMILY: f64 = 1e-3;

fn tabulated(case: &Case) -> Tabulated {
    Tabulated::new(&case.table(), &Options::default()).unwrap().0
}

/// Integrals of g and of the density over the cells of a lobe's grid, by quadrature.
fn masses(t: &Tabulated, case: &Case, lobe: usize, wi: DVec3) -> (Vec<f64>, Vec<f64>) {
    let data = &case.lobes[lobe];
    let (along, around) = (Gauss::new(7), Gauss::new(3));
    let (mut g, mut pdf) = (Vec::new(), Vec::new());
    for polar in data.polar_deg.windows(2) {
        for azimuth in data.azimuth_deg.windows(2) {
            let integrate = |f: &dyn Fn(DVec3) -> f64| {
                along.integrate(polar[0].to_radians(), polar[1].to_radians(), |theta| {
                    theta.sin()
                        * around.integrate(azimuth[0].to_radians(), azimuth[1].to_radians(), |phi| {
                            f(direction(data.frame, data.quantity, wi, theta, phi))
                        })
                })
            };
            g.push(integrate(&|wo| luminance(t.eval_cos(true, wi, wo, data.quantity))));
            pdf.push(integrate(&|wo| t.pdf_omega(true, wi, wo, data.quantity)));
        }
    }
    (g, pdf)
}

fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// The cell of a lobe's grid that holds a direction.
fn cell(case: &Case, lobe: usize, wi: DVec3, wo: DVec3) -> usize {
    let data = &case.lobes[lobe];
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

#[test]
fn values_at_the_nodes_are_those_of_the_table() {
    for case in cases() {
        let t = tabulated(&case);
        for data in &case.lobes {
            let lobe = caustix::scattering::Lobe::new(data.clone()).unwrap().0;
            for (j, phi_i) in data.phi_i_deg.iter().enumerate() {
                for (i, theta_i) in data.theta_i_deg.iter().enumerate() {
                    let wi = incidence(*theta_i, if data.phi_i_deg.len() > 1 { *phi_i } else { 77.0 });
                    let wi = if *theta_i == 0.0 { DVec3::Z } else { wi };
                    for (p, polar) in data.polar_deg.iter().enumerate() {
                        // At a pole there is one direction, and a table may have many values for it.
                        let row =
                            &lobe.slice(0, j, i)[p * data.azimuth_deg.len()..][..data.azimuth_deg.len()];
                        if polar % 180.0 == 0.0 && row.iter().any(|v| *v != row[0]) {
                            continue;
                        }
                        for (a, azimuth) in data.azimuth_deg.iter().enumerate() {
                            // At normal incidence a table has one plane of incidence, that of its reference.
                            if *theta_i == 0.0 && data.phi_i_deg.len() > 1 && j > 0 {
                                continue;
                            }
                            // At either end the direction must not round to where there is no table.
                            let inwards = if p == 0 { 1e-14 } else { -1e-14 };
                            let (theta, phi) = (polar.to_radians() * (1.0 + inwards), azimuth.to_radians());
                            let wo = direction(data.frame, data.quantity, wi, theta, phi);
                            let cos = if data.quantity == Reflection { wo.z } else { -wo.z };
                            let found = t.eval_cos(true, wi, wo, data.quantity);
                            for (channel, g) in found.into_iter().enumerate() {
                                let channel = channel.min(data.channels - 1);
                                let slice = lobe.slice(channel, j, i);
                                let expected =
                                    f64::from(slice[p * data.azimuth_deg.len() + a]) * cos.max(0.0);
                                // f32, and neighbours in the table within rounding of the angles.
                                let largest = lobe.values.iter().copied().fold(0.0, f32::max);
                                let error = (g - expected).abs();
                                assert!(
                                    error <= 1e-6 * expected + 1e-12 * f64::from(largest),
                                    "{}: {theta_i} {phi_i} {polar} {azimuth}: {g:e} {expected:e}",
                                    case.name
                                );
                            }
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn albedo_is_the_integral_of_the_value_and_the_density_integrates_to_one() {
    for case in cases() {
        let t = tabulated(&case);
        let (mut worst, mut below) = (0.0f64, 0.0f64);
        for wi in incidences() {
            let mut whole = 0.0;
            for (lobe, data) in case.lobes.iter().enumerate() {
                let (g, pdf) = masses(&t, &case, lobe, wi);
                let (g, pdf): (f64, f64) = (g.iter().sum(), pdf.iter().sum());
                let albedo = luminance(t.albedo_of(true, wi, data.quantity));
                assert!((g - albedo).abs() <= 1e-6 * albedo, "{} {wi}: {g} {albedo}", case.name);
                worst = worst.max((g / albedo - 1.0).abs());
                whole += pdf;
            }
            let albedo = luminance(t.albedo(true, wi));
            let expected = if albedo > 0.0 { 1.0 } else { 0.0 };
            assert!((whole - expected).abs() < 1e-6, "{} {wi}: {whole}", case.name);
            let lost = (0..2000u64).filter(|i| {
                let (u1, u2) = (mix64(2 * i), to_unit_f64(mix64(2 * i + 1)));
                t.sample(true, wi, u1, u2, Solver::DEFAULT).is_some_and(|s| s.below_horizon)
            });
            below = below.max(lost.count() as f64 / 2000.0);
        }
        println!(
            "{:<24} albedo against quadrature {worst:.1e}, below the horizon up to {:.1} %",
            case.name,
            100.0 * below
        );
    }
}

#[test]
fn samples_follow_the_density() {
    let cases = cases();
    let level = sidak(FAMILY, cases.len() * incidences().len());
    let n = 20_000u64;
    for (k, case) in cases.iter().enumerate() {
        let t = tabulated(case);
        let mut least = 1.0f64;
        for (d, wi) in incidences().into_iter().enumerate() {
            let expected: Vec<Vec<f64>> =
                (0..case.lobes.len()).map(|lobe| masses(&t, case, lobe, wi).1).collect();
            if luminance(t.albedo(true, wi)) == 0.0 {
                assert!(t.sample(true, wi, 7 << 60, 0.3, Solver::DEFAULT).is_none());
                continue;
            }
            let mut observed: Vec<Vec<u64>> = expected.iter().map(|m| vec![0; m.len()]).collect();
            for i in 0..n {
                let key = mix64((k as u64) << 40 | (d as u64) << 32 | i);
                let (u1, u2) = (mix64(key), to_unit_f64(mix64(!key)));
                let s = t.sample(true, wi, u1, u2, Solver::DEFAULT).unwrap();
                let lobe = case.lobes.iter().position(|l| l.quantity == s.quantity).unwrap();
                observed[lobe][cell(case, lobe, wi, s.wo)] += 1;
                assert!((s.wo.length() - 1.0).abs() < 1e-12);
                let side = if s.quantity == Reflection { s.wo.z } else { -s.wo.z };
                assert_eq!(s.below_horizon, side <= 0.0);
            }
            let test = chi_square(&observed.concat(), &expected.concat());
            assert!(test.p_value > level, "{} {wi}: {test:?}", case.name);
            least = least.min(test.p_value);
        }
        println!("{:<24} least p {least:.4} of 12 (level {level:.1e})", case.name);
    }
}

#[test]
fn sample_then_invert_returns_the_coordinates() {
    for case in cases() {
        let t = tabulated(&case);
        let mut checked = 0;
        for wi in incidences() {
            for i in 0..1000u64 {
                let (u1, u2) = (mix64(2 * i + 1), to_unit_f64(mix64(2 * i + 2)));
                let Some(s) = t.sample(true, wi, u1, u2, Solver::DEFAULT) else { continue };
                let all = t.invert(true, wi, s.wo, s.quantity);
                let near =
                    |(v1, v2): &(u64, f64)| (v1.abs_diff(u1) as f64 / 2f64.powi(64)).hypot((v2 - u2) * 1e-3);
                let Some(best) = all.iter().min_by(|a, b| near(a).total_cmp(&near(b))) else {
                    panic!("{} {wi} {i}: no coordinates of {s:?}", case.name);
                };
                // Where the density vanishes at the edge of a cell, phi says little about u2.
                let steep = t.pdf_omega(true, wi, s.wo, s.quantity) < 1e-3;
                let first = best.0.abs_diff(u1) as f64 / 2f64.powi(64);
                assert!(first < 1e-9, "{} {wi} {i}: {best:?} for {u1} {u2}", case.name);
                assert!((best.1 - u2).abs() < 1e-6 || steep, "{} {wi} {i}: {best:?} {u2}", case.name);
                let again = t.sample(true, wi, best.0, best.1, Solver::DEFAULT).unwrap();
                assert!((again.wo - s.wo).length() < 1e-6, "{} {wi} {i}", case.name);
                checked += 1;
            }
        }
        assert!(checked >= 5000, "{}: {checked}", case.name);
    }
}

/// 1 / |d wo / d(u1, u2)| by central differences of two widths; `None` where they disagree (an edge of a cell or a choice).
fn inverse_jacobian(t: &Tabulated, wi: DVec3, (u1, u2): (u64, f64)) -> Option<f64> {
    let at = |h1: u64, h2: f64| {
        let sample = |u1: u64, u2: f64| Some(t.sample(true, wi, u1, u2, Solver::DEFAULT)?.wo);
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

#[test]
fn the_jacobians_of_all_preimages_add_up_to_the_density() {
    for case in cases() {
        let t = tabulated(&case);
        let (mut checked, mut several) = (0, 0);
        for wi in incidences() {
            for i in 0..300u64 {
                let (u1, u2) = (mix64(!(3 * i)), to_unit_f64(mix64(!(3 * i + 1))));
                let Some(s) = t.sample(true, wi, u1, u2, Solver::DEFAULT) else { continue };
                let all = t.invert(true, wi, s.wo, s.quantity);
                let Some(parts) =
                    all.iter().map(|u| inverse_jacobian(&t, wi, *u)).collect::<Option<Vec<_>>>()
                else {
                    continue;
                };
                let sum: f64 = parts.iter().sum();
                let pdf = t.pdf_omega(true, wi, s.wo, s.quantity);
                assert!((sum / pdf - 1.0).abs() < 2e-4, "{} {wi} {i}: {sum} {pdf} {all:?}", case.name);
                checked += 1;
                several += usize::from(all.len() > 1);
            }
        }
        println!("{:<24} {checked} points, {several} with several preimages", case.name);
        assert!(checked > 200, "{}: {checked}", case.name);
    }
}

/// Whether a lobe's cells are above the horizon, by their corners; the great circle bends less than 0.02 between them.
fn above(case: &Case, lobe: usize, wi: DVec3) -> Vec<bool> {
    let data = &case.lobes[lobe];
    let mut all = Vec::new();
    for polar in data.polar_deg.windows(2) {
        for azimuth in data.azimuth_deg.windows(2) {
            let corners = polar.iter().flat_map(|p| azimuth.iter().map(move |a| (p, a)));
            let sides = corners.map(|(p, a)| {
                let wo = direction(data.frame, data.quantity, wi, p.to_radians(), a.to_radians());
                if data.quantity == Reflection { wo.z } else { -wo.z }
            });
            all.push(sides.fold(1.0, f64::min) > 0.02 || data.frame == caustix::scattering::Frame::Surface);
        }
    }
    all
}

/// A photon at a surface whose reference direction is x, arriving from wi.
fn arriving(wi: DVec3) -> Incidence {
    Incidence { direction: -wi, facet: DVec3::Z, smooth: DVec3::Z, front: true }
}

#[test]
fn rejection_follows_the_same_density() {
    let cases = cases();
    let wanted = ["ggx", "rgb", "both ways"];
    let chosen: Vec<&Case> = cases.iter().filter(|c| wanted.contains(&c.name)).collect();
    let ways = [Rejection::Cell, Rejection::Table, Rejection::NextPoint];
    let wis = [incidence(0.0, 0.0), incidence(37.0, 20.0), incidence(64.0, 130.0)];
    let level = sidak(FAMILY, chosen.len() * ways.len() * wis.len());
    assert_eq!(chosen.len(), wanted.len());
    for case in chosen {
        let bsdf = Bsdf::Tabulated(Box::new(tabulated(case)));
        let Bsdf::Tabulated(t) = &bsdf else { unreachable!() };
        for (k, rejection) in ways.into_iter().enumerate() {
            for wi in wis {
                let expected: Vec<Vec<f64>> =
                    (0..case.lobes.len()).map(|lobe| masses(t, case, lobe, wi).0).collect();
                let mut observed: Vec<Vec<u64>> = expected.iter().map(|m| vec![0; m.len()]).collect();
                let points = IndependentPoints::new(40 + k as u64, 0);
                let (n, mut below, mut absorbed) = (30_000u64, 0, 0);
                for i in 0..n {
                    let mut c = Coordinates::sampling_by(&points, i, false, Sampling::Rejection(rejection));
                    match bsdf.interact(&arriving(wi), &mut c, &mut Grey) {
                        Outcome::Leaves { direction, through, .. } => {
                            let quantity = if through { Transmission } else { Reflection };
                            let lobe = case.lobes.iter().position(|l| l.quantity == quantity).unwrap();
                            observed[lobe][cell(case, lobe, wi, direction)] += 1;
                        }
                        Outcome::BelowHorizon => below += 1,
                        Outcome::Absorbed => absorbed += 1,
                    }
                }
                // Below the horizon there is no direction to count: the cells that may reach there are one.
                let safe: Vec<bool> = (0..case.lobes.len()).flat_map(|lobe| above(case, lobe, wi)).collect();
                let (mut counts, mut weights) = (vec![absorbed, below], vec![0.0; 2]);
                weights[0] = 1.0 - luminance(t.albedo(true, wi));
                for ((count, weight), safe) in observed.concat().into_iter().zip(expected.concat()).zip(safe)
                {
                    if safe {
                        counts.push(count);
                        weights.push(weight);
                    } else {
                        counts[1] += count;
                        weights[1] += weight;
                    }
                }
                let test = chi_square(&counts, &weights);
                assert!(test.p_value > level, "{} {rejection:?} {wi}: {test:?}", case.name);
            }
        }
    }
}

/// Means over photons of what goes on, by channel, and of that times cos(theta_o): against albedo and quadrature.
#[test]
fn colour_is_carried_without_bias_and_luminance_stays_one() {
    let cases = cases();
    let case = cases.iter().find(|c| c.name == "rgb").unwrap();
    for (remainder, level) in [(false, sidak(FAMILY, 36)), (true, sidak(FAMILY, 36))] {
        let options = Options { specular_remainder: remainder, ..Options::default() };
        let t = Tabulated::new(&case.table(), &options).unwrap().0;
        for (d, wi) in [incidence(20.0, 0.0), incidence(50.0, 90.0)].into_iter().enumerate() {
            let albedo = t.albedo(true, wi);
            let mirrored = DVec3::new(-wi.x, -wi.y, wi.z);
            // A photon that red walls have met: the weights are what reflect() leaves, luminance 1.
            let mut red = Rgb::WHITE;
            let wall = caustix::bsdf::Reflectance::rgb([0.9, 0.3, 0.0]);
            let some = IndependentPoints::new(0, 0);
            assert!((0..99).any(|i| red.reflect(&wall, &mut Coordinates::new(&some, i, true))));
            for (k, start) in [Rgb::WHITE, red].into_iter().enumerate() {
                let points = IndependentPoints::new((10 * d + k) as u64, 0);
                let n = 200_000u64;
                let mut sums = [[0.0f64; 2]; 3];
                for i in 0..n {
                    let mut photon = start;
                    let mut c = Coordinates::new(&points, i, true);
                    let gone = match t.interact(&arriving(wi), &mut c, &mut photon) {
                        Outcome::Leaves { direction, .. } => direction != mirrored,
                        Outcome::BelowHorizon => true,
                        Outcome::Absorbed => {
                            assert!(!remainder);
                            continue;
                        }
                    };
                    assert!((luminance(photon.weight()) - 1.0).abs() < 1e-12);
                    if gone || remainder {
                        for (sum, w) in sums.iter_mut().zip(photon.weight()) {
                            sum[0] += w;
                            sum[1] += w * w;
                        }
                    }
                }
                for (channel, [sum, square]) in sums.into_iter().enumerate() {
                    let n = n as f64;
                    let part = if remainder { 1.0 } else { albedo[channel] };
                    let expected = start.weight()[channel] * part;
                    let mean = sum / n;
                    let error = ((square / n - mean * mean) / n).sqrt();
                    println!("{wi} {k} channel {channel}: {mean:.5} +- {error:.5}, expected {expected:.5}");
                    if error > 0.0 {
                        assert!(z_test((mean - expected) / error) > level);
                    } else {
                        assert!((mean - expected).abs() < 1e-12);
                    }
                }
            }
            // A fixed number of reflections: the same means without roulette.
            let points = IndependentPoints::new(77, 0);
            let (n, mut sums) = (100_000u64, [[0.0f64; 2]; 3]);
            for i in 0..n {
                let mut photon = Fixed::white(1);
                let mut c = Coordinates::new(&points, i, true);
                assert!(!matches!(t.interact(&arriving(wi), &mut c, &mut photon), Outcome::Absorbed));
                for (sum, w) in sums.iter_mut().zip(photon.weight()) {
                    sum[0] += w;
                    sum[1] += w * w;
                }
            }
            for (channel, [sum, square]) in sums.into_iter().enumerate() {
                let mean = sum / n as f64;
                let error = ((square / n as f64 - mean * mean) / n as f64).sqrt();
                let expected = if remainder { 1.0 } else { albedo[channel] };
                assert!((mean - expected).abs() <= 4.5 * error + 1e-12, "{mean} {error} {expected}");
            }
        }
    }
}
