//! The checks of a tabulated surface on files: the project's own tables, real ones where they are at hand, a
//! MERL file. Value, albedo, density, sample and its inverse against each other and against quadrature, at
//! twelve incident directions each.

use std::path::{Path, PathBuf};

use crate::support::data::project;
use crate::support::statistics::sidak;
use caustix::sample::method::Sampling;

use crate::support::local::luminance;
use crate::table_checks::{
    Surface, below_horizon, coordinates_come_back, incidences_of, integrals_agree, jacobians_add_up,
    photons_against_quadrature, sides,
};

/// Chance of a false alarm in a whole test.
const FAMILY: f64 = 1e-3;

/// Every check on every surface.
fn check(surfaces: &[Surface]) {
    let level = sidak(FAMILY, 12 * surfaces.len());
    for (k, surface) in surfaces.iter().enumerate() {
        let (mut worst, mut below, mut least) = (0.0f64, 0.0f64, 1.0f64);
        let (mut back, mut points, mut several) = (0, 0, 0);
        let incidences = incidences_of(surface);
        assert_eq!(incidences.len(), 12);
        for (d, wi) in incidences.into_iter().enumerate() {
            worst = worst.max(integrals_agree(surface, wi));
            below = below.max(below_horizon(surface, wi, 2000));
            assert!(luminance(surface.albedo(wi)) > 0.0, "{} is black somewhere", surface.name);
            let way = (d % 2 == 0, Sampling::default());
            let test = photons_against_quadrature(surface, wi, 20_000, (k as u64) << 8 | d as u64, way);
            assert!(test.p_value > level, "{} {wi}: {test:?}", surface.name);
            least = least.min(test.p_value);
            back += coordinates_come_back(surface, wi, 1000);
            let (some, of_several) = jacobians_add_up(surface, wi, 300);
            points += some;
            several += of_several;
        }
        println!(
            "{}: albedo against quadrature {worst:.1e}; least p {least:.4} of 12 (level {level:.1e}); below the horizon up \
             to {:.1} %; {back} came back; Jacobian at {points} points, {several} of several branches",
            surface.name,
            100.0 * below
        );
        assert!(back > 5000, "{}: {back}", surface.name);
        assert!(points > 1200, "{}: {points}", surface.name);
    }
}

/// The sides of the tables in a folder and those below it, in the order of their paths; and what is not read,
/// with the reason.
fn surfaces_of(folder: &Path, below: &Path) -> (Vec<Surface>, Vec<String>) {
    let mut paths: Vec<PathBuf> = std::fs::read_dir(below).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    let (mut surfaces, mut others) = (Vec::new(), Vec::new());
    for path in paths {
        if path.is_dir() {
            let (more, others_too) = surfaces_of(folder, &path);
            surfaces.extend(more);
            others.extend(others_too);
            continue;
        }
        let name = path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
        match caustix::files::bsdf::read(&path) {
            Ok(table) => surfaces.extend(sides(&name, &table)),
            Err(error) => others.push(format!("{name}: {}", error.found())),
        }
    }
    (surfaces, others)
}

#[test]
fn own_tables_hold() {
    let folder = project().join("brdf_tables");
    let (surfaces, others) = surfaces_of(&folder, &folder);
    // Seven tables, one of them with two different sides; beside them the README.
    assert_eq!((surfaces.len(), others.len()), (8, 1), "{others:?}");
    check(&surfaces);
}

#[test]
fn real_files_hold() {
    let Some(folder) = crate::support::scatter_files::real_folder() else { return };
    let (surfaces, others) = surfaces_of(&folder, &folder);
    others.iter().for_each(|other| println!("not read: {other}"));
    let read = |ending: &str| surfaces.iter().filter(|s| s.name.contains(ending)).count();
    // Six files that are the same from either side, and three sides of two matrices.
    assert_eq!((read(".bsdf"), read(".xml"), surfaces.len()), (6, 3, 9));
    check(&surfaces);
}

/// A lobe over a diffuse ground, in red and green, blue dark; directions near grazing were not measured.
#[test]
fn a_merl_file_holds() {
    let bytes = crate::support::scatter_files::merl_file(|h, d, bin| {
        let lobe = (-(h / 0.15) * (h / 0.15)).exp() * (1.0 + d);
        if bin >= 84 { [-1.0; 3] } else { [0.05 + lobe, 0.1 + 0.5 * lobe, 0.0] }
    });
    let table = caustix::files::bsdf::parse(&bytes, "lobe.binary").unwrap();
    assert!(table.warnings.iter().any(|w| w.found().contains("not measured")), "{:?}", table.warnings);
    let surfaces = sides("lobe.binary", &table);
    assert!(surfaces.len() == 1 && caustix::surface::Model::is_coloured(&surfaces[0].sampler));
    check(&surfaces);
}
