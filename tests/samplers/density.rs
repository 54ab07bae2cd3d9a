//! Every photometric file: sampled directions have the density of the file's own candela.
//!
//! Directions come out of the emitter as photons get them. What they should be comes from the file alone:
//! angles by their definitions, cell masses and distribution functions by quadrature of `Web::intensity_cd`
//! under the solid angle of the file's type. Per file: chi-square on the table's cells and on cells shifted
//! by half a cell, Kolmogorov-Smirnov on the polar angle and on the azimuth given the polar angle; the level
//! of each is Sidak's for all files together.

use caustix::emitter::{AimFrame, Emits, Emitter, Emitters, Photometric};
use caustix::files::photometric;
use caustix::math::solve::Solver;
use caustix::photometry::{PhotometricType, Photometry, Web};
use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::{Rejection, Sampling};
use caustix::sequence::independent::IndependentPoints;
use caustix::sequence::{Points, to_unit_f64};
use glam::DVec3;
use std::path::{Path, PathBuf};

use crate::support::angles::Luminaire;
use crate::support::data;
use crate::support::density::{Density, Measure, PolarCdf, ends};
use crate::support::given::of_grid;
use crate::support::sphere_table::SphereTable;
use crate::support::statistics::{chi_square, kolmogorov_smirnov, sidak};

/// Samples where a density a little wrong must be refused.
const SAMPLES: usize = 200_000;
/// Samples of one file of many: a difference of twice the size shows as clearly.
const FEWER: usize = SAMPLES / 4;
/// Of so many samples one serves for the azimuth given the polar angle: each costs an integral over the whole turn.
const CONDITIONAL_STEP: usize = 20;
/// Chance of a false alarm over all files of a test together.
const FAMILY: f64 = 0.01;
const TESTS_A_FILE: usize = 4;
/// Unit roundoff of angles in degrees, up to 360.
const ANGLE_ROUNDING_DEG: f64 = 1e-12;

const AIM: DVec3 = DVec3::new(0.3, -0.7, -0.5);
/// Not perpendicular to the aim.
const UP: DVec3 = DVec3::new(0.2, 0.1, 1.0);

fn emitter(photometry: &Photometry) -> Photometric {
    Photometric::new(photometry, DVec3::new(1.0, 2.0, 3.0), AimFrame::new(AIM, Some(UP)).unwrap(), None)
        .unwrap()
}

/// (polar angle, azimuth) in degrees of directions that photons of this file start with.
fn sampled_angles(n: usize, photometry: &Photometry, density: &Density<'_>, seed: u64) -> Vec<(f64, f64)> {
    angles_by(Sampling::default(), n, photometry, density, seed)
}

/// The same by another way of sampling tables.
fn angles_by(
    sampling: Sampling,
    n: usize,
    photometry: &Photometry,
    density: &Density<'_>,
    seed: u64,
) -> Vec<(f64, f64)> {
    let emitters = Emitters::new(vec![Emitter::Photometric(emitter(photometry))]).unwrap();
    let points = IndependentPoints::new(seed, 0);
    let frame = Luminaire::new(AIM, UP);
    (0..)
        .filter_map(|i| emitters.emit(sampling, &mut Coordinates::new(&points, i, true)))
        .take(n)
        .map(|(_, emission)| {
            let angles = frame.angles_deg(photometry.web.photometric_type, emission.direction);
            density.polar_and_azimuth(angles)
        })
        .collect()
}

/// Counts of the cells between these edges; the second number is of samples outside all of them.
fn histogram(samples: &[(f64, f64)], p_edges: &[f64], q_edges: &[f64]) -> (Vec<u64>, u64) {
    let columns = q_edges.len() - 1;
    let mut counts = vec![0; (p_edges.len() - 1) * columns];
    let mut outside = 0;
    let find = |edges: &[f64], x: f64| {
        let [first, last] = ends(edges);
        let inside = x >= first - ANGLE_ROUNDING_DEG && x <= last + ANGLE_ROUNDING_DEG;
        inside.then(|| edges.partition_point(|e| *e <= x).clamp(1, edges.len() - 1) - 1)
    };
    for &(p, q) in samples {
        match (find(p_edges, p), find(q_edges, q)) {
            (Some(i), Some(j)) => counts[i * columns + j] += 1,
            _ => outside += 1,
        }
    }
    (counts, outside)
}

/// Edges halfway between the angles of the file, where there are only few an even division into `least`
/// beside.
fn shifted(breaks: &[f64], least: usize) -> Vec<f64> {
    let [first, last] = ends(breaks);
    let mut edges = vec![first];
    if breaks.len() > least {
        edges.extend(breaks.windows(2).map(|b| 0.5 * (b[0] + b[1])));
    } else {
        edges.extend((1..least).map(|k| first + (last - first) * k as f64 / least as f64));
    }
    edges.push(last);
    edges
}

/// Masses of the cells between edges.
struct Cells {
    p_edges: Vec<f64>,
    q_edges: Vec<f64>,
    masses: Vec<f64>,
}

impl Cells {
    fn new(density: &Density<'_>, p_edges: Vec<f64>, q_edges: Vec<f64>) -> Self {
        let masses = density.masses(&p_edges, &q_edges);
        Self { p_edges, q_edges, masses }
    }

    fn p_value(&self, samples: &[(f64, f64)]) -> f64 {
        let (counts, outside) = histogram(samples, &self.p_edges, &self.q_edges);
        if outside > 0 { 0.0 } else { chi_square(&counts, &self.masses).p_value }
    }
}

/// What samples are judged by: the quadrature is done once for all sets of them.
struct Judge<'w> {
    density: Density<'w>,
    cells: [Cells; 2],
    polar: PolarCdf,
}

impl<'w> Judge<'w> {
    fn new(density: Density<'w>) -> Self {
        let cells = [
            Cells::new(&density, density.p_breaks.clone(), density.q_breaks.clone()),
            Cells::new(&density, shifted(&density.p_breaks, 17), shifted(&density.q_breaks, 11)),
        ];
        Self { cells, polar: density.polar_cdf(), density }
    }

    /// p-values: chi-square on the file's cells, on shifted cells, Kolmogorov-Smirnov on both angles.
    fn p_values(&self, samples: &[(f64, f64)]) -> [f64; TESTS_A_FILE] {
        let polar = samples.iter().map(|s| self.polar.at(s.0)).collect();
        let some = samples.iter().take(samples.len() / CONDITIONAL_STEP);
        let azimuth = some.map(|s| self.density.azimuth_cdf(s.0, s.1)).collect();
        let [cells, shifted] = &self.cells;
        [
            cells.p_value(samples),
            shifted.p_value(samples),
            kolmogorov_smirnov(polar).p_value,
            kolmogorov_smirnov(azimuth).p_value,
        ]
    }
}

fn p_values(samples: &[(f64, f64)], density: &Density<'_>) -> [f64; TESTS_A_FILE] {
    Judge::new(density.clone()).p_values(samples)
}

/// Tests these files; the smallest p-value is asserted against the corrected level.
fn check_density(files: &[PathBuf]) {
    let level = sidak(FAMILY, files.len() * TESTS_A_FILE);
    let mut smallest = 1.0f64;
    for (k, path) in files.iter().enumerate() {
        let name = path.file_name().unwrap().to_str().unwrap();
        let photometry = photometric::read(path).unwrap();
        let density = Density::new(&photometry.web);
        let samples = sampled_angles(FEWER, &photometry, &density, 1 + k as u64);
        let p = p_values(&samples, &density);
        println!(
            "{name}: p cells {:.4}, shifted cells {:.4}, polar {:.4}, azimuth {:.4}",
            p[0], p[1], p[2], p[3]
        );
        let least = p.into_iter().fold(1.0, f64::min);
        assert!(least > level, "{name}: {p:?}, level {level:e}");
        smallest = smallest.min(least);
    }
    println!("{} files, smallest p {smallest:.2e}, level {level:.2e}", files.len());
}

/// The emitter's flux is the integral of the file's candela, to the rounding of the sums.
fn check_flux(path: &Path) {
    let photometry = photometric::read(path).unwrap();
    let expected = Density::new(&photometry.web).total() * photometry.factor();
    let got = emitter(&photometry).flux_lm();
    assert!((got / expected - 1.0).abs() < 1e-11, "{}: {got} lm, quadrature {expected} lm", path.display());
}

/// A photon's coordinates come back from its direction by quadrature, at points that have nothing to do with
/// the grid.
fn check_invert(path: &Path) {
    let photometry = photometric::read(path).unwrap();
    let full = photometry.web.full_grid();
    let table = SphereTable::new(full.polar_rad, full.azimuth_rad, full.intensity_cd);
    let grid = emitter(&photometry).table().unwrap().clone();
    let points = IndependentPoints::new(99, 0);
    let (mut worst, mut checked) = ([0.0f64; 2], 0);
    for i in 0..20_000 {
        let (u1, u2) = (points.coordinate(i, 0), points.coordinate(i, 1));
        let at = of_grid(&grid, u1, u2, Solver::DEFAULT);
        let [v1, v2] = table.by_cell(at.theta, at.phi);
        worst[0] = worst[0].max((v1 - to_unit_f64(u1)).abs());
        worst[1] = worst[1].max((v2 - to_unit_f64(u2)).abs());
        checked += 1;
    }
    println!("{}: {checked} points, worst |du1| {:.1e}, |du2| {:.1e}", path.display(), worst[0], worst[1]);
    // The sum of the cells' fluxes, which shares out u1, is rounded once a cell.
    assert!(worst[0] < 1e-13 && worst[1] < 1e-12, "{}: {worst:?}", path.display());
}

#[test]
fn own_files_are_sampled_with_their_density() {
    check_density(&data::own_files());
}

#[test]
fn own_files_are_sampled_with_their_density_by_every_rejection() {
    let files = data::own_files();
    let level = sidak(FAMILY, files.len() * TESTS_A_FILE * Rejection::ALL.len());
    for (k, path) in files.iter().enumerate() {
        let photometry = photometric::read(path).unwrap();
        let judge = Judge::new(Density::new(&photometry.web));
        for rejection in Rejection::ALL {
            let sampling = Sampling::Rejection(rejection);
            let samples = angles_by(sampling, FEWER / 2, &photometry, &judge.density, 100 + k as u64);
            let p = judge.p_values(&samples);
            println!("{} {}: {p:.4?}", path.display(), rejection.name());
            assert!(p.into_iter().all(|p| p > level), "{} {}: {p:?}", path.display(), rejection.name());
        }
    }
}

#[test]
fn real_files_are_sampled_with_their_density() {
    let Some(files) = data::real_files() else { return };
    assert!(files.len() >= 20, "{} files", files.len());
    check_density(&files);
}

#[test]
fn flux_is_the_integral_of_the_intensity() {
    data::own_files().iter().for_each(|path| check_flux(path));
    data::real_files().iter().flatten().for_each(|path| check_flux(path));
}

#[test]
fn own_files_invert_to_the_coordinates() {
    data::own_files().iter().for_each(|path| check_invert(path));
}

#[test]
fn real_files_invert_to_the_coordinates() {
    data::real_files().iter().flatten().for_each(|path| check_invert(path));
}

/// Negative control: the samples of a file are refused by densities that are a little wrong.
#[test]
fn wrong_densities_are_refused() {
    let level = sidak(FAMILY, 400);
    let photometry = photometric::read(data::own_file("floodlight_b.ies")).unwrap();
    let right = Density::new(&photometry.web);
    let samples = sampled_angles(SAMPLES, &photometry, &right, 5);
    assert!(p_values(&samples, &right).into_iter().all(|p| p > level));

    // The weight of a polar angle for that of a latitude.
    let p = p_values(&samples, &right.clone().with_measure(Measure::Sine));
    assert!(p[0] < level && p[1] < level && p[2] < level, "measure: {p:?}");

    let wrong = |change: &dyn Fn(&mut Web)| {
        let mut web = photometry.web.clone();
        change(&mut web);
        p_values(&samples, &Density::new(&web))
    };
    // Left and right, and up and down, exchanged.
    let n_v = photometry.web.vertical_deg.len();
    let p = wrong(&|web| {
        let planes: Vec<f64> = web.candela.chunks(n_v).rev().flatten().copied().collect();
        web.candela = planes;
    });
    assert!(p[0] < level && p[1] < level && p[2] < level, "left-right: {p:?}");
    let p = wrong(&|web| web.candela.chunks_mut(n_v).for_each(<[f64]>::reverse));
    assert!(p[0] < level && p[1] < level && p[3] < level, "up-down: {p:?}");
    // The angles of the two axes exchanged: rows read as columns.
    let p = wrong(&|web| {
        let old = web.candela.clone();
        for (i, c) in web.candela.iter_mut().enumerate() {
            *c = old[i % n_v * n_v + i / n_v];
        }
    });
    assert!(p.into_iter().all(|p| p < level), "transposed: {p:?}");
    // One plane of 37 dimmed by 30 %: 8 % of the flux by 15 % in the mean, a noncentrality of some 500 on
    // 1300 degrees.
    let p = wrong(&|web| {
        let middle = web.horizontal_deg.len() / 2;
        web.candela[middle * n_v..(middle + 1) * n_v].iter_mut().for_each(|c| *c *= 0.7);
    });
    assert!(p[0] < level, "dimmed plane: {p:?}");
}

/// The same for type C: the corners of each cell exchanged along the azimuth, which leaves every node's ring
/// as it is but for a turn by one plane.
#[test]
fn a_turn_by_one_plane_is_refused() {
    let photometry = photometric::read(data::own_file("wavy_glass.ies")).unwrap();
    assert_eq!(photometry.web.photometric_type, PhotometricType::C);
    let samples = sampled_angles(SAMPLES, &photometry, &Density::new(&photometry.web), 6);
    let mut turned = photometry.web.clone();
    let n_v = turned.vertical_deg.len();
    turned.candela.rotate_right(n_v);
    let p = p_values(&samples, &Density::new(&turned));
    assert!(p[0] == 0.0 && p[1] == 0.0 && p[3] < sidak(FAMILY, 400), "{p:?}");
}
