//! The certificate: right samplers pass on every file, variant and sequence; samplers that are a little wrong do not.

use caustix::files::photometric;
use caustix::lab::certificate::sampler::{made_from, sample};
use caustix::lab::certificate::{Certificate, Density, Draw, Judge, PointKind, REPLICATES, TestName};
use caustix::math::solve::Solver;
use caustix::photometry::{Format, Photometry};
use caustix::run::{Algorithm, Variant};
use caustix::sample::angles::Row;
use caustix::sample::cell::Cell;
use caustix::sample::choose::Reusable;
use caustix::sample::discrete::Discrete;
use caustix::sample::grid::Grid;
use caustix::sequence::independent::IndependentPoints;
use caustix::sequence::owen::OwenPoints;
use caustix::sequence::{Points, Sequence, to_unit_f64};
use std::path::{Path, PathBuf};

use crate::support::data;
use crate::support::density::{Density as Reference, ends};
use crate::support::ldt::{Ldt, NEITHER, TO_90, Table};
use crate::support::sphere_table::SphereTable;

fn grid_of(photometry: &Photometry) -> Grid {
    let full = photometry.web.full_grid();
    Grid::new(&full.polar_rad, &full.azimuth_rad, &full.intensity_cd).unwrap()
}

/// The certificate of a built-in sampler, with randomisations where there are any.
fn certify(photometry: &Photometry, algorithm: &Algorithm, seed: u64, n: u64) -> Certificate {
    let grid = grid_of(photometry);
    let density = Density::new(&photometry.web).unwrap();
    let mut judge = Judge::new(&density, made_from(algorithm.sequence));
    sample(&grid, algorithm, seed, 0, n, |block| {
        block.iter().for_each(|s| judge.draw(s.draw));
        true
    })
    .unwrap();
    if made_from(algorithm.sequence) == PointKind::LowDiscrepancy && algorithm.sequence.is_randomised() {
        for replicate in 1..=REPLICATES {
            let mut draws = Vec::new();
            sample(&grid, algorithm, seed, replicate, n / u64::from(REPLICATES), |block| {
                draws.extend(block.iter().map(|s| s.draw));
                true
            })
            .unwrap();
            judge.replicate(draws);
        }
    }
    judge.certificate()
}

fn summary(certificate: &Certificate) -> String {
    let tests = certificate.tests.iter().map(|t| format!("{} {:.2e}", t.name, t.p_corrected));
    let ratio = certificate.discrepancy.ratio;
    format!("{}; discrepancy ratio {ratio:.3}", tests.collect::<Vec<_>>().join(", "))
}

fn check_passes(path: &Path, algorithm: &Algorithm, seed: u64, n: u64) -> Certificate {
    let photometry = photometric::read(path).unwrap();
    let certificate = certify(&photometry, algorithm, seed, n);
    let name = path.file_name().unwrap().to_str().unwrap();
    println!("{name} {}: {}", algorithm.name(), summary(&certificate));
    assert!(certificate.passed, "{name} {}: {:?}", algorithm.name(), certificate.failures());
    assert_eq!(certificate.draws, n);
    certificate
}

#[test]
fn every_variant_and_sequence_passes_on_the_built_in_lamp() {
    let path = data::own_file("wavy_glass.ies");
    // `mc` is `qmc` on other points.
    for variant in [Variant::Qmc, Variant::QmcInverse, Variant::QmcInverseReuse] {
        for sequence in Sequence::ALL {
            let algorithm = Algorithm { sequence, ..Algorithm::from(variant) };
            let certificate = check_passes(&path, &algorithm, 1, 1 << 15);
            let coordinates = certificate.coordinates;
            match variant {
                Variant::QmcInverse => assert_eq!((coordinates.mean, coordinates.max), (3.0, 3)),
                Variant::QmcInverseReuse => assert_eq!((coordinates.mean, coordinates.max), (2.0, 2)),
                _ => assert!(coordinates.mean > 4.0 && coordinates.max > 10, "{coordinates:?}"),
            }
            if sequence == Sequence::SobolOwen && !variant.rejects() {
                assert!(certificate.discrepancy.ratio < 0.2, "{}", certificate.discrepancy.ratio);
            }
        }
    }
    for name in ["mc", "mc:table", "mc:next-point", "qmc:table", "qmc:next-point"] {
        check_passes(&path, &Algorithm::parse(name).unwrap(), 1, 1 << 15);
    }
}

/// Rejection against the table's maximum takes 73 coordinates a sample, and the high ones of plain Halton points and of
/// square roots of primes are far from uniform in pairs: the density is right, the points are not, and it shows.
#[test]
fn poor_points_are_refused() {
    let lamp = photometric::read(data::own_file("wavy_glass.ies")).unwrap();
    for name in ["qmc:table:halton", "qmc:table:weyl"] {
        let certificate = certify(&lamp, &Algorithm::parse(name).unwrap(), 1, 1 << 17);
        println!("{name}: {}", summary(&certificate));
        assert!(failed(&certificate).contains(&TestName::ChiSquare), "{name}");
    }
    // A set made for N points has no further ones to go on with.
    let algorithm = Algorithm::parse("qmc:next-point:jittered").unwrap();
    assert!(sample(&grid_of(&lamp), &algorithm, 1, 0, 10, |_| true).is_err());
}

#[test]
fn own_files_pass() {
    for path in data::own_files() {
        for name in ["mc", "qmc-inverse-reuse"] {
            check_passes(&path, &Algorithm::parse(name).unwrap(), 2, 1 << 15);
        }
    }
}

/// EULUMDAT: half of the planes stored, from C270 on; and real files.
#[test]
fn eulumdat_files_pass() {
    let folder = tempfile::tempdir().unwrap();
    let mut files: Vec<PathBuf> = Vec::new();
    for (name, isym, table) in [("isym3.ldt", 3, TO_90), ("isym0.ldt", 0, NEITHER)] {
        let bell: Table = if isym == 3 { |gamma, c| TO_90(gamma, c) * (1.0 + gamma.cos()) } else { table };
        files.push(folder.path().join(name));
        std::fs::write(&files[files.len() - 1], Ldt::new(isym, bell).text()).unwrap();
    }
    let names = [
        "copyleft/eurs__road_luminaire.ldt",
        "copyleft/gldf__lampsets.ldt",
        "permissive/pv-ldt__no_symmetry.ldt",
    ];
    files.extend(data::real_folder().into_iter().flat_map(|f| names.map(|name| f.join("ldt").join(name))));
    for path in files {
        assert_eq!(photometric::read(&path).unwrap().format, Format::Eulumdat);
        for name in ["mc", "qmc-inverse-reuse"] {
            check_passes(&path, &Algorithm::parse(name).unwrap(), 4, 1 << 15);
        }
    }
}

#[test]
fn real_files_pass() {
    let Some(files) = data::real_files() else { return };
    assert!(files.len() >= 20, "{} files", files.len());
    for path in files {
        for name in ["qmc-inverse-reuse", "qmc-inverse:independent"] {
            check_passes(&path, &Algorithm::parse(name).unwrap(), 3, 1 << 14);
        }
    }
}

/// The masses of the certificate against another quadrature of the same candela, cell by cell.
#[test]
fn masses_agree_with_another_quadrature() {
    let files = data::own_files().into_iter().chain(data::real_files().into_iter().flatten());
    for path in files {
        let photometry = photometric::read(&path).unwrap();
        let density = Density::new(&photometry.web).unwrap();
        let reference = Reference::new(&photometry.web);
        let masses = reference.masses(&reference.p_breaks, &reference.q_breaks);
        let total = reference.masses(&ends(&reference.p_breaks), &ends(&reference.q_breaks))[0];
        assert!((density.total_lm() / total - 1.0).abs() < 1e-12, "{}", path.display());
        let got = density.probabilities();
        // The reference may cut a rotational table along the azimuth; then totals must do.
        if got.len() == masses.len() {
            for (p, m) in got.iter().zip(&masses) {
                assert!((p - m / total).abs() <= 1e-12 * p + 1e-18, "{}: {p} {}", path.display(), m / total);
            }
        }
    }
}

/// False alarms: over seeds the smallest corrected p of right samplers is no smaller than so many tests give.
#[test]
fn right_samplers_rarely_fail() {
    let photometry = photometric::read(data::own_file("floodlight_b.ies")).unwrap();
    for name in ["mc", "qmc", "qmc-inverse", "qmc-inverse-reuse"] {
        let algorithm = Algorithm::parse(name).unwrap();
        let smallest = |seed| {
            let certificate = certify(&photometry, &algorithm, seed, 1 << 12);
            certificate.tests.iter().map(|t| t.p_corrected).fold(1.0, f64::min)
        };
        let least: Vec<f64> = (0..100).map(smallest).collect();
        // 100 certificates at the level 1e-3: two failures have a chance of 5e-3; below 0.05: 5 expected, 13 at 1e-3.
        let below = |level: f64| least.iter().filter(|p| **p < level).count();
        println!("{name}: {} below 0.001, {} below 0.05", below(1e-3), below(0.05));
        assert!(below(1e-3) <= 1 && below(0.05) <= 12, "{name}: {least:?}");
    }
}

/// A sampler by inverse functions that can be spoilt: shares of the cells by quadrature.
struct Spoilt {
    table: SphereTable,
    choice: Discrete,
    wrong: Wrong,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Wrong {
    /// Nothing.
    Right,
    /// The flux of the brightest cell times this.
    Flux(f64),
    /// The remainder of the choice is u - low, not divided by the width.
    NoDivision,
    /// theta by the candela alone, without the weight sin(theta), inside the cell.
    NoSine,
    /// Every direction one column on.
    Shifted,
}

impl Spoilt {
    fn new(photometry: &Photometry, wrong: Wrong) -> Self {
        let full = photometry.web.full_grid();
        let table = SphereTable::new(full.polar_rad, full.azimuth_rad, full.intensity_cd);
        let columns = table.azimuth.len() - 1;
        let cells = (table.polar.len() - 1) * columns;
        let mut weights: Vec<f64> = (0..cells).map(|k| table.part(k / columns, k % columns)).collect();
        if let Wrong::Flux(factor) = wrong {
            let brightest = (0..cells).max_by(|a, b| weights[*a].total_cmp(&weights[*b])).unwrap();
            weights[brightest] *= factor;
        }
        Self { table, choice: Discrete::new(&weights).unwrap(), wrong }
    }

    fn draw(&self, points: &impl Points, index: u64) -> Draw {
        let (u1, u2) = (points.coordinate(index, 0), to_unit_f64(points.coordinate(index, 1)));
        let SphereTable { polar, azimuth, .. } = &self.table;
        let mut u = Reusable::fresh(u1);
        let (chosen, _) = self.choice.choose(&mut u);
        let (i, j) = (chosen / (azimuth.len() - 1), chosen % (azimuth.len() - 1));
        let mut u_theta = to_unit_f64(u.bits());
        if self.wrong == Wrong::NoDivision {
            u_theta = (u_theta * self.table.part(i, j)).clamp(0.0, 1.0 - f64::EPSILON);
        }
        let row = Row::new(polar[i], polar[i + 1]);
        let at = |i: usize, j: usize| self.table.values[i * azimuth.len() + j];
        let corners = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
        let cell = Cell::new(&row, corners).unwrap();
        let mut s = cell.sample_theta(&row, u_theta, Solver::DEFAULT).s;
        let x = cell.sample_phi(&row, s, u2);
        if self.wrong == Wrong::NoSine {
            s = without_sine([corners[0] + corners[1], corners[2] + corners[3]], u_theta) * row.width;
        }
        let column = if self.wrong == Wrong::Shifted { j + 1 } else { j } % (azimuth.len() - 1);
        let phi_rad = azimuth[column] + x * (azimuth[column + 1] - azimuth[column]);
        Draw { theta_rad: row.theta + s, phi_rad, coordinates: 2 }
    }
}

/// Where in its cell theta is by the marginal of the candela alone, linear from a to b.
fn without_sine([a, b]: [f64; 2], u: f64) -> f64 {
    if (b - a).abs() < 1e-9 * (a + b) {
        return u;
    }
    (((a * a + u * (b * b - a * a)).max(0.0).sqrt() - a) / (b - a)).clamp(0.0, 1.0)
}

fn judged(photometry: &Photometry, wrong: Wrong, kind: PointKind, n: u64) -> Certificate {
    let spoilt = Spoilt::new(photometry, wrong);
    let density = Density::new(&photometry.web).unwrap();
    let mut judge = Judge::new(&density, kind);
    match kind {
        PointKind::Random => {
            let points = IndependentPoints::new(11, 0);
            (0..n).for_each(|i| judge.draw(spoilt.draw(&points, i)));
        }
        PointKind::LowDiscrepancy => {
            let points = OwenPoints::new(11, 0);
            (0..n).for_each(|i| judge.draw(spoilt.draw(&points, i)));
            for replicate in 1..=REPLICATES {
                let points = OwenPoints::new(11, replicate);
                judge.replicate((0..n / u64::from(REPLICATES)).map(|i| spoilt.draw(&points, i)));
            }
        }
    }
    let certificate = judge.certificate();
    println!("{wrong:?}, {kind:?}, {n}: {}", summary(&certificate));
    certificate
}

fn failed(certificate: &Certificate) -> Vec<TestName> {
    assert!(certificate.passed == certificate.failures().is_empty());
    certificate.tests.iter().filter(|t| !t.passed).map(|t| t.name).collect()
}

const KINDS: [PointKind; 2] = [PointKind::Random, PointKind::LowDiscrepancy];

#[test]
fn one_flux_2_per_cent_off_is_refused() {
    // The brightest cell of `spot` is a ring with a fifth of the flux: 2 % of 1e5 hits in it is 7 sigma of random points.
    let spot = photometric::read(data::own_file("spot.ies")).unwrap();
    for kind in KINDS {
        assert!(judged(&spot, Wrong::Right, kind, 500_000).passed);
        let certificate = judged(&spot, Wrong::Flux(1.02), kind, 500_000);
        assert!(failed(&certificate).contains(&TestName::LargestCell), "{kind:?}");
    }
    // That of `wavy_glass` has 2 %: there random points see nothing, as they must, and a randomised net sees it at once.
    let lamp = photometric::read(data::own_file("wavy_glass.ies")).unwrap();
    assert!(judged(&lamp, Wrong::Flux(1.02), PointKind::Random, 200_000).passed);
    for factor in [0.98, 1.02] {
        let certificate = judged(&lamp, Wrong::Flux(factor), PointKind::LowDiscrepancy, 200_000);
        assert!(failed(&certificate).contains(&TestName::CellMeans), "{factor}");
    }
}

#[test]
fn a_remainder_that_is_not_divided_is_refused() {
    let lamp = photometric::read(data::own_file("wavy_glass.ies")).unwrap();
    for kind in KINDS {
        assert!(judged(&lamp, Wrong::Right, kind, 200_000).passed);
        let failed = failed(&judged(&lamp, Wrong::NoDivision, kind, 200_000));
        assert!(
            failed.contains(&TestName::KsThetaInRow) && failed.contains(&TestName::KsTheta),
            "{failed:?}"
        );
        // The cells are chosen rightly: only what looks inside them can see it.
        assert!(!failed.contains(&TestName::ChiSquare), "{failed:?}");
    }
}

#[test]
fn theta_without_the_weight_of_the_solid_angle_is_refused() {
    let lamp = photometric::read(data::own_file("wavy_glass.ies")).unwrap();
    for kind in KINDS {
        let failed = failed(&judged(&lamp, Wrong::NoSine, kind, 200_000));
        assert!(failed.contains(&TestName::KsThetaInRow), "{failed:?}");
    }
}

#[test]
fn directions_one_column_on_are_refused() {
    // A lamp without dark cells, so that the tests must see it and not an empty cell.
    let lamp = photometric::read(data::own_file("pool_lamp.ies")).unwrap();
    for kind in KINDS {
        let certificate = judged(&lamp, Wrong::Shifted, kind, 200_000);
        let failed = failed(&certificate);
        assert!(failed.contains(&TestName::ChiSquare) && failed.contains(&TestName::KsPhi), "{failed:?}");
        if kind == PointKind::LowDiscrepancy {
            assert!(failed.contains(&TestName::Discrepancy) && failed.contains(&TestName::CellMeans));
        }
    }
}

#[test]
fn one_draw_in_the_dark_is_enough() {
    let lamp = photometric::read(data::own_file("wavy_glass.ies")).unwrap();
    let density = Density::new(&lamp.web).unwrap();
    let grid = grid_of(&lamp);
    let at = |theta_deg: f64, phi_deg: f64| {
        let mut judge = Judge::new(&density, PointKind::Random);
        sample(&grid, &Algorithm::from(Variant::Mc), 4, 0, 10_000, |block| {
            block.iter().for_each(|s| judge.draw(s.draw));
            true
        })
        .unwrap();
        judge.draw(Draw { theta_rad: theta_deg.to_radians(), phi_rad: phi_deg.to_radians(), coordinates: 2 });
        judge.certificate()
    };
    let dark = at(80.0, 10.0);
    assert!(!dark.passed && dark.draws_in_zero_cells == 1 && failed(&dark).is_empty());
    assert_eq!(dark.failures(), ["1 draw in cells of the table that are dark"]);
    let outside = at(91.0, 10.0);
    assert!(!outside.passed && outside.draws_outside == 1 && failed(&outside).is_empty());
}

#[test]
fn few_draws_prove_nothing_and_none_is_no_failure() {
    let lamp = photometric::read(data::own_file("batwing.ies")).unwrap();
    for n in [1, 2, 3, 100] {
        assert!(certify(&lamp, &Algorithm::from(Variant::QmcInverseReuse), 1, n).passed, "{n}");
        assert!(certify(&lamp, &Algorithm::from(Variant::Mc), 1, n).passed, "{n}");
    }
    let density = Density::new(&lamp.web).unwrap();
    assert!(Judge::new(&density, PointKind::LowDiscrepancy).certificate().passed);
}
