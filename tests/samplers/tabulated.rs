//! Scattering tables made from formulas: value, albedo, density, sample and its inverse against each other
//! and against quadrature, for incident directions on and off the table's angles.
//!
//! The frames are written down here once more, from the words of the table's documentation.

use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::{Rejection, Sampling};
use caustix::scattering::Quantity::Reflection;
use caustix::sequence::hash::mix64;
use caustix::sequence::independent::IndependentPoints;
use caustix::sequence::to_unit_f64;
use caustix::surface::tabulated::Options;
use caustix::surface::{Event, Fixed, Rgb, Tabulated, Throughput};
use glam::DVec3;

use crate::support::local::{self, luminance, projected};
use crate::support::statistics::{chi_square, sidak, z_test};
use crate::support::tables::{Case, angles, cases, direction, incidence, incidences};
use crate::table_checks::{
    Surface, below_horizon, coordinates_come_back, integrals_agree, jacobians_add_up, masses,
    photons_against_quadrature,
};

/// Chance of a false alarm in a whole test.
const FAMILY: f64 = 1e-3;

fn tabulated(case: &Case) -> Tabulated {
    Tabulated::new(&case.table(), &Options::default()).unwrap().0
}

fn surface(case: &Case) -> Surface {
    let (name, lobes) = (case.name.to_owned(), case.lobes.clone());
    Surface { name, lobes, sampler: tabulated(case), from_front: true }
}

fn surfaces() -> Vec<Surface> {
    cases().iter().map(surface).collect()
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
                            let found = projected(&t, true, wi, data.quantity, wo);
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

/// Between the table's angles g is the linear mixture of its slices at the same angles of the lobe's own
/// frame; before the first and beyond the last theta_i it is that slice.
#[test]
fn incident_angles_mix_linearly_where_the_lobe_stands_still() {
    // At normal incidence itself the plane of incidence is another one: this many degrees stand for none.
    let least = 1e-3f64;
    let mut checked = 0;
    for case in cases() {
        let t = tabulated(&case);
        for data in &case.lobes {
            let g = |theta_i: f64, phi_i: f64, theta: f64, phi: f64| {
                let wi = incidence(theta_i, phi_i);
                projected(&t, true, wi, data.quantity, direction(data.frame, data.quantity, wi, theta, phi))
            };
            let thetas = &data.theta_i_deg;
            let (first, last) = (thetas[0], thetas[thetas.len() - 1]);
            // (theta_i, the table's angles about it, the part of the second).
            let mut places = vec![(0.5 * (last + 90.0), last.max(least), last.max(least), 0.0)];
            if first > 0.0 {
                places.push((0.5 * first, first, first, 0.0));
            }
            for pair in thetas.windows(2) {
                let low = pair[0].max(least);
                places.extend([0.25, 0.6].map(|t| (low + t * (pair[1] - low), low, pair[1], t)));
            }
            let phis = if data.phi_i_deg.len() == 1 { &[10.0, 47.0][..] } else { &data.phi_i_deg[..] };
            for (turn, (middle, low, high, along)) in
                phis.windows(2).flat_map(|turn| places.iter().map(move |place| (turn, *place)))
            {
                for k in 0..40u64 {
                    let u = |j: u64| to_unit_f64(mix64(1 + 8 * k + j));
                    let theta = data.polar_deg[data.polar_deg.len() - 1].to_radians() * u(0);
                    let phi = (u(1) - 0.5) * 6.2;
                    let across = if data.phi_i_deg.len() == 1 { 0.0 } else { u(2) };
                    let corners = [
                        (g(low, turn[0], theta, phi), (1.0 - along) * (1.0 - across)),
                        (g(high, turn[0], theta, phi), along * (1.0 - across)),
                        (g(low, turn[1], theta, phi), (1.0 - along) * across),
                        (g(high, turn[1], theta, phi), along * across),
                    ];
                    let found = g(middle, turn[0] + across * (turn[1] - turn[0]), theta, phi);
                    for channel in 0..3 {
                        let expected: f64 = corners.iter().map(|(g, w)| w * g[channel]).sum();
                        let largest = corners.iter().map(|(g, _)| g[channel]).fold(0.0, f64::max);
                        let error = (found[channel] - expected).abs();
                        assert!(
                            error <= 2.0 * least / 20.0 * largest + 1e-13,
                            "{} at {middle}: {found:?}, expected {expected}",
                            case.name
                        );
                        checked += usize::from(expected > 0.0);
                    }
                }
            }
        }
    }
    assert!(checked > 5000, "{checked}");
}

#[test]
fn albedo_is_the_integral_of_the_value_and_the_density_integrates_to_one() {
    for surface in surfaces() {
        let (mut worst, mut below) = (0.0f64, 0.0f64);
        for wi in incidences() {
            worst = worst.max(integrals_agree(&surface, wi));
            below = below.max(below_horizon(&surface, wi, 2000));
        }
        println!(
            "{:<24} albedo against quadrature {worst:.1e}, below the horizon up to {:.1} %",
            surface.name,
            100.0 * below
        );
    }
}

/// Inverse functions with renormalisation and without: two ways to a cell, one density.
#[test]
fn samples_follow_the_density() {
    let surfaces = surfaces();
    let level = sidak(FAMILY, 2 * surfaces.len() * incidences().len());
    for (k, surface) in surfaces.iter().enumerate() {
        let mut least = 1.0f64;
        for (d, wi) in incidences().into_iter().enumerate() {
            for reuse in [true, false] {
                let seed = (k as u64) << 8 | d as u64;
                let test =
                    photons_against_quadrature(surface, wi, 20_000, seed, (reuse, Sampling::default()));
                assert!(test.p_value > level, "{} {wi} {reuse}: {test:?}", surface.name);
                least = least.min(test.p_value);
            }
        }
        println!("{:<24} least p {least:.4} of 24 (level {level:.1e})", surface.name);
    }
}

#[test]
fn the_coordinates_of_a_photon_come_back() {
    for surface in surfaces() {
        let checked: usize =
            incidences().into_iter().map(|wi| coordinates_come_back(&surface, wi, 1000)).sum();
        println!("{:<24} {checked} photons", surface.name);
        assert!(checked >= 5000, "{}: {checked}", surface.name);
    }
}

#[test]
fn the_jacobians_of_all_branches_add_up_to_the_density() {
    for surface in surfaces() {
        let (mut checked, mut several) = (0, 0);
        for wi in incidences() {
            let (some, of_several) = jacobians_add_up(&surface, wi, 300);
            checked += some;
            several += of_several;
        }
        println!("{:<24} {checked} points, {several} of several branches", surface.name);
        assert!(checked > 200, "{}: {checked}", surface.name);
    }
}

/// The extremes that the checks above run over are what their names say.
#[test]
fn extremes_are_what_they_are_called() {
    let all = surfaces();
    let named = |name: &str| all.iter().find(|s| s.name == name).unwrap_or_else(|| panic!("no {name}"));
    let wis = incidences();
    let grazing = incidence(89.999, 310.0);
    assert!(wis.contains(&DVec3::Z) && wis.iter().any(|wi| (*wi - grazing).length() < 1e-12));
    let lit = |surface: &Surface, wi: DVec3| -> Vec<usize> {
        let g = masses(surface, 0, wi);
        (0..g.len()).filter(|k| g[*k] > 0.0).collect()
    };
    let columns = |surface: &Surface| surface.lobes[0].azimuth_deg.len() - 1;

    // Light in the first step about the mirrored direction only: every cell there touches the pole.
    let narrow = named("narrower than a step");
    assert!(lit(narrow, incidence(35.0, 8.0)).into_iter().eq(0..columns(narrow)));

    let one = named("one incidence");
    let albedo = |surface: &Surface, theta_deg: f64| surface.albedo(incidence(theta_deg, 50.0));
    assert!(one.lobes[0].theta_i_deg == [30.0]);
    assert!(wis.iter().all(|wi| one.albedo(*wi) == albedo(one, 30.0)));

    let black = named("a black slice");
    assert!(albedo(black, 20.0)[0] > 0.0 && albedo(black, 40.0)[0] > 0.0);
    // 30 degrees come back from a direction with rounding, which lets a neighbour in.
    assert!(luminance(black.albedo(incidence(30.0, 270.0))) < 1e-15);

    assert_eq!(lit(named("one cell"), incidence(20.0, 0.0)).len(), 1);

    for name in ["ggx", "stops at 60 degrees", "anisotropic"] {
        assert!(below_horizon(named(name), grazing, 2000) > 0.01, "{name} crosses the horizon");
    }
    let wide = &named("1e12 range").lobes[0].values;
    let (low, high) = wide.iter().fold((f32::MAX, 0.0f32), |(low, high), v| (low.min(*v), high.max(*v)));
    assert!(low > 0.0 && f64::from(high) / f64::from(low) > 0.99e12, "{low} {high}");

    let [red, green, blue] = albedo(named("rgb"), 41.0);
    assert!(red > 0.0 && green > 0.0 && red != green && blue == 0.0, "{red} {green} {blue}");

    let stops = named("stops at 60 degrees");
    assert_eq!(stops.lobes[0].theta_i_deg.last(), Some(&60.0));
    assert_eq!(albedo(stops, 75.0), albedo(stops, 61.0));

    // At grazing incidence both poles of the frame have cells with light, and both kinds are sampled.
    let poles = named("pole cells");
    let (rows, n) = (poles.lobes[0].polar_deg.len() - 1, columns(poles));
    let cells = lit(poles, grazing);
    assert!((0..n).all(|k| cells.contains(&k)) && cells.iter().any(|k| k / n == rows - 1), "{cells:?}");
}

/// In the cells about a pole the azimuth of samples follows the conditional of a flat ring: even, at any size
/// of theta.
#[test]
fn azimuths_are_even_about_the_pole() {
    let all = surfaces();
    let narrow = all.iter().find(|s| s.name == "narrower than a step").unwrap();
    // On an angle of the table, far from the horizon: all nodes of the pole are one value.
    let wi = incidence(10.0, 0.0);
    let data = &narrow.lobes[0];
    let mut rings = [[0u64; 24]; 3];
    for i in 0..200_000u64 {
        let event = narrow.scatter_by(wi, [0, mix64(!(2 * i)), mix64(!(2 * i + 1))]);
        let Event::Leaves { direction, .. } = event else { panic!("{event:?}") };
        let (theta, phi) = angles(data.frame, data.quantity, wi, direction);
        let ring = ((theta.to_degrees() / 5.0 * 3.0) as usize).min(2);
        let turn = (phi / (2.0 * std::f64::consts::PI)).rem_euclid(1.0);
        rings[ring][((24.0 * turn) as usize).min(23)] += 1;
    }
    let level = sidak(FAMILY, rings.len());
    for ring in &rings {
        let test = chi_square(ring, &[1.0; 24]);
        assert!(test.p_value > level && test.degrees == 23, "{test:?}");
    }
    // g falls linearly from the pole to the first node: P(theta < t) = (x^2 - 2 x^3 / 3) / (1/3) for x = t /
    // step, but for the sine's curvature, 1e-3 of it.
    let inner = rings[0].iter().sum::<u64>() as f64 / 200_000.0;
    let expected = 3.0 * (1.0 / 9.0 - 2.0 / 81.0);
    assert!((inner - expected).abs() < 4.5 * (expected * (1.0 - expected) / 2e5).sqrt() + 1e-3, "{inner}");
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
        let surface = surface(case);
        for (k, rejection) in ways.into_iter().enumerate() {
            for wi in wis {
                let way = (false, Sampling::Rejection(rejection));
                let test = photons_against_quadrature(&surface, wi, 30_000, 40 + k as u64, way);
                assert!(test.p_value > level, "{} {rejection:?} {wi}: {test:?}", case.name);
            }
        }
    }
}

/// Means over photons of what goes on, by channel, and of that times cos(theta_o): against albedo and
/// quadrature.
#[test]
fn colour_is_carried_without_bias_and_luminance_stays_one() {
    let cases = cases();
    let case = cases.iter().find(|c| c.name == "rgb").unwrap();
    for (remainder, level) in [(false, sidak(FAMILY, 36)), (true, sidak(FAMILY, 36))] {
        let options = Options { specular_remainder: remainder, ..Options::default() };
        let t = Tabulated::new(&case.table(), &options).unwrap().0;
        for (d, wi) in [incidence(20.0, 0.0), incidence(50.0, 90.0)].into_iter().enumerate() {
            let albedo = local::albedo(&t, true, wi);
            let mirrored = DVec3::new(-wi.x, -wi.y, wi.z);
            // A photon that red walls have met: the weights are what reflect() leaves, luminance 1.
            let mut red = Rgb::WHITE;
            let wall = caustix::surface::Reflectance::rgb([0.9, 0.3, 0.0]).unwrap();
            let some = IndependentPoints::new(0, 0);
            assert!((0..99).any(|i| red.reflect(&wall, &mut Coordinates::new(&some, i, true))));
            for (k, start) in [Rgb::WHITE, red].into_iter().enumerate() {
                let points = IndependentPoints::new((10 * d + k) as u64, 0);
                let n = 200_000u64;
                let mut sums = [[0.0f64; 2]; 3];
                for i in 0..n {
                    let mut photon = start;
                    let mut c = Coordinates::new(&points, i, true);
                    let gone = match t.scatter(&local::arriving(true, wi), &mut c, &mut photon) {
                        Event::Leaves { direction, .. } => direction != mirrored,
                        Event::BelowHorizon => true,
                        Event::Absorbed => {
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
                assert!(!matches!(
                    t.scatter(&local::arriving(true, wi), &mut c, &mut photon),
                    Event::Absorbed
                ));
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
