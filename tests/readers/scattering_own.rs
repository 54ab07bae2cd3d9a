//! The project's own scattering tables: what the formulas give is what is on disk, and what the README states.

use caustix::scattering::integral::slice_albedo;
use caustix::scattering::reciprocity::{self, reciprocity};
use caustix::scattering::value::value;
use caustix::scattering::{Frame, LobeData, LobeSide, Quantity, ScatterTable};
use glam::DVec3;
use std::f64::consts::PI;
use std::path::PathBuf;

use crate::make_brdf;
use crate::support::data::project;
use crate::support::quadrature::Gauss;

fn folder() -> PathBuf {
    project().join("brdf_tables")
}

fn read(file: &str) -> ScatterTable {
    caustix::files::bsdf::read(folder().join(file)).unwrap()
}

#[test]
fn files_on_disk_are_the_formulas() {
    let tables = make_brdf::tables();
    for table in &tables {
        let on_disk = std::fs::read(folder().join(table.file)).unwrap();
        assert!(on_disk == table.text().as_bytes(), "{} differs: run the example make_brdf", table.file);
        assert!(on_disk.len() < 300_000, "{}: {} bytes", table.file, on_disk.len());
    }
    let mut on_disk: Vec<String> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".scatter"))
        .collect();
    on_disk.sort();
    let mut names: Vec<&str> = tables.iter().map(|t| t.file).collect();
    names.sort_unstable();
    assert_eq!(on_disk, names);
}

/// Albedo of a formula by Gauss-Legendre quadrature in panels of the table's frame.
fn formula_albedo(table: &make_brdf::Table, lobe: &make_brdf::Lobe, theta_i: f64, phi_i: f64) -> f64 {
    let rule = Gauss::new(4);
    let frame = table.frame;
    let transmitted = lobe.quantity == "transmission";
    let wi = make_brdf::incident(theta_i, phi_i);
    let last = if frame == "surface" { 90 } else { 180 };
    let polar: Vec<f64> = (0..=last).map(f64::from).collect();
    let azimuth: Vec<f64> = (0..=60).map(|i| f64::from(6 * i)).collect();
    let degree = PI / 180.0;
    rule.over_panels(&polar, |p| {
        (p * degree).sin()
            * rule.over_panels(&azimuth, |a| {
                let wo = make_brdf::scattered(frame, transmitted, theta_i, phi_i, p, a);
                let cosine = if transmitted { -wo[2] } else { wo[2] };
                if cosine > 0.0 { cosine * (lobe.formula)(wi, wo) } else { 0.0 }
            })
    }) * degree
        * degree
}

/// Rows of the README's table: file, quantity, side, theta_i, phi_i, albedo of the formula, albedo of the table.
fn stated() -> Vec<(String, String, f64, f64, f64, f64)> {
    let readme = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let rows = readme.lines().filter(|line| line.starts_with("| `") && line.contains(".scatter` |"));
    rows.filter_map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let number = |i: usize| cells.get(i).and_then(|cell| cell.parse::<f64>().ok());
        let text = |i: usize| cells.get(i).map(|c| c.trim_matches('`').to_owned());
        Some((text(1)?, text(2)?, number(3)?, number(4)?, number(5)?, number(6)?))
    })
    .collect()
}

#[test]
fn albedos_are_those_of_the_readme() {
    let (rows, tables) = (stated(), make_brdf::tables());
    let mut at = 0;
    let mut wrong = Vec::new();
    for table in &tables {
        let file = read(table.file);
        for (n, lobe) in table.lobes.iter().enumerate() {
            for (theta_i, phi_i) in stated_at(table) {
                let data = &file.lobes[n];
                let t = data.theta_i_deg.iter().position(|x| *x == theta_i).unwrap();
                let p = data.phi_i_deg.iter().position(|x| *x == phi_i).unwrap();
                let (formula, own) =
                    (formula_albedo(table, lobe, theta_i, phi_i), slice_albedo(data, 0, p, t));
                let name = format!("{} {}", lobe.quantity, lobe.side);
                println!("| `{}` | {name} | {theta_i} | {phi_i} | {formula:.5} | {own:.5} |", table.file);
                let close = rows.get(at).is_some_and(|row| {
                    (row.0.as_str(), row.1.as_str(), row.2, row.3)
                        == (table.file, name.as_str(), theta_i, phi_i)
                        && (row.4 - formula).abs() <= 1.1e-5
                        && (row.5 - own).abs() <= 1.1e-5
                });
                if !close {
                    wrong.push(format!("{:?}", rows.get(at)));
                }
                // Parts of the incident light: four digits and the angles' steps part the table from the formula.
                if (own - formula).abs() > 0.01 {
                    wrong.push(format!("{} {theta_i} {phi_i}: {own} {formula}", table.file));
                }
                at += 1;
            }
        }
    }
    assert!(wrong.is_empty(), "not as the README states:\n{}", wrong.join("\n"));
    assert_eq!(at, rows.len());
}

/// The incidences that the README states: every theta_i, of the anisotropic table along, between and across.
fn stated_at(table: &make_brdf::Table) -> Vec<(f64, f64)> {
    let phis = if table.phi_i.is_empty() { vec![0.0] } else { vec![0.0, 45.0, 90.0] };
    phis.iter().flat_map(|p| table.theta_i.iter().filter(|t| **t < 90.0).map(|t| (*t, *p))).collect()
}

#[test]
fn every_table_reads_without_a_warning_and_keeps_energy() {
    for table in make_brdf::tables() {
        let file = read(table.file);
        assert!(file.warnings.is_empty(), "{:?}", file.warnings);
        for front in [true, false] {
            let lobes: Vec<_> = [Quantity::Reflection, Quantity::Transmission]
                .into_iter()
                .filter_map(|q| file.lobe(q, front))
                .collect();
            for t in 0..lobes[0].theta_i_deg.len() {
                for p in 0..lobes[0].phi_i_deg.len() {
                    let total: f64 = lobes.iter().map(|l| slice_albedo(l, 0, p, t)).sum();
                    assert!(total > 0.0 && total <= 1.0, "{} {t} {p} {front}: {total}", table.file);
                }
            }
        }
    }
}

/// Root mean square of value - formula over the pairs of directions, relative to that of the formula.
fn interpolation_error(table: &make_brdf::Table, file: &ScatterTable, lobe: usize) -> f64 {
    let (mut error, mut norm) = (0.0, 0.0);
    for i in 0..64 {
        for j in 0..64 {
            let angles =
                |k: usize| (libm::asin((0.992 * (k as f64 + 0.5) / 64.0).sqrt()), 2.399_963 * k as f64);
            let ((ti, pi), (to, po)) = (angles(i), angles(j));
            let unit = |t: f64, p: f64| DVec3::new(t.sin() * p.cos(), t.sin() * p.sin(), t.cos());
            let (wi, mut wo) = (unit(ti, pi), unit(to, po + 0.7 * i as f64));
            if table.lobes[lobe].quantity == "transmission" {
                wo.z = -wo.z;
            }
            let exact = (table.lobes[lobe].formula)(wi.to_array(), wo.to_array());
            let own = value(&file.lobes[lobe], 0, wi, wo);
            error += (own - exact) * (own - exact);
            norm += exact * exact;
        }
    }
    (error / norm).sqrt()
}

/// (interpolation error, defect of reciprocity) that the README states for a lobe, "quantity side".
fn stated_errors(file: &str, lobe: &str) -> (f64, f64) {
    let readme = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let start = format!("| `{}` | {lobe} |", file.trim_end_matches(".scatter"));
    let row =
        readme.lines().find_map(|line| line.strip_prefix(&start)).unwrap_or_else(|| panic!("no {start}"));
    let cells: Vec<f64> = row.split('|').filter_map(|cell| cell.trim().parse().ok()).collect();
    (cells[0], cells[1])
}

/// Four decimals, as stated.
fn assert_stated(file: &str, lobe: &str, error: f64, defect: f64) {
    let (stated_error, stated_defect) = stated_errors(file, lobe);
    let close = |a: f64, b: f64| (a - b).abs() <= 0.6e-4;
    assert!(close(error, stated_error) && close(defect, stated_defect), "{file} {lobe}: {error} {defect}");
}

#[test]
fn reciprocal_tables_are_so_within_their_interpolation_error() {
    for table in make_brdf::tables() {
        if table.lobes[0].side != "both" {
            continue;
        }
        let file = read(table.file);
        for (quantity, _, defect) in reciprocity::all(&file) {
            let lobe = file.lobes.iter().position(|l| l.quantity == quantity).unwrap();
            let error = interpolation_error(&table, &file, lobe);
            println!(
                "{} {quantity:?}: rms {:.5}, largest {:.3}; interpolation {error:.5}",
                table.file, defect.rms, defect.largest
            );
            let word = if quantity == Quantity::Reflection { "reflection both" } else { "transmission both" };
            assert_stated(table.file, word, error, defect.rms);
            // f12 - f21 is the difference of two errors.
            assert!(defect.rms <= 2.0 * error + 1e-4, "{} {quantity:?}: {} {error}", table.file, defect.rms);
            assert!(defect.pairs > 1000 && error < 0.12, "{}: {error}", table.file);
        }
    }
    let lambert = reciprocity(&read("lambert.scatter"), Quantity::Reflection, true).unwrap();
    assert!(lambert.rms < 1e-3, "{lambert:?}");
}

/// f carries flux, so between air and glass it is f / n^2 of the outgoing side that is reciprocal; of the bare f the defect is
/// that of 2.25 against 1.
#[test]
fn glass_is_reciprocal_but_for_the_square_of_its_index() {
    let table = read("rough_glass.scatter");
    let (front, back) = (&table.lobes[1], &table.lobes[3]);
    let (mut error, mut norm) = (0.0, 0.0);
    for i in 0..4096 {
        let part = |step: f64| (0.5 + f64::from(i) * step).fract();
        let unit = |u: f64, v: f64| {
            let (sine, phi) = ((0.95 * u).sqrt(), 2.0 * PI * v);
            DVec3::new(sine * phi.cos(), sine * phi.sin(), (1.0 - sine * sine).sqrt())
        };
        let (wi, wo) = (unit(part(0.856_675), part(0.733_892)), -unit(part(0.628_707), part(0.538_597)));
        let other = |w: DVec3| DVec3::new(w.x, -w.y, -w.z);
        let (forth, home) = (value(front, 0, wi, wo) / 2.25, value(back, 0, other(wo), other(wi)));
        error += (forth - home) * (forth - home);
        norm += 0.5 * (forth * forth + home * home);
    }
    let (rms, bare) = ((error / norm).sqrt(), reciprocity(&table, Quantity::Transmission, true).unwrap().rms);
    let expected = 1.25 / (0.5f64 * (1.0 + 2.25 * 2.25)).sqrt();
    let tables = make_brdf::tables();
    let glass = tables.iter().find(|t| t.file == "rough_glass.scatter").unwrap();
    let errors = [1, 3].map(|lobe| interpolation_error(glass, &table, lobe));
    println!("f / n^2: {rms}, interpolation {errors:?}; f: {bare}, expected {expected}");
    assert_stated(glass.file, "transmission front", errors[0], rms);
    assert_stated(glass.file, "transmission back", errors[1], rms);
    assert!(rms <= errors[0] + errors[1] && errors.iter().all(|e| *e < 0.05), "{rms} {errors:?}");
    assert!((bare - expected).abs() <= rms, "{bare} {expected}");
}

/// f = c (1 + cos theta_i) is not reciprocal. With x = cos^2 even between cos^2 85 degrees and 1: E[cos] = 0.67131 and E[cos^2] =
/// 0.50380, so the defect is sqrt(2 (0.50380 - 0.67131^2) / (1 + 2 x 0.67131 + 0.50380)) = 0.1932.
#[test]
fn a_table_that_is_not_reciprocal_is_caught() {
    let theta_i_deg: Vec<f64> = (0..=90).map(f64::from).collect();
    let values =
        theta_i_deg.iter().flat_map(|t| vec![0.1 * (1.0 + t.to_radians().cos()) as f32; 91 * 3]).collect();
    let data = LobeData {
        quantity: Quantity::Reflection,
        side: LobeSide::Both,
        frame: Frame::Surface,
        polar_deg: theta_i_deg.clone(),
        theta_i_deg,
        phi_i_deg: vec![0.0],
        azimuth_deg: vec![0.0, 180.0, 360.0],
        channels: 1,
        values,
        declared_tis: vec![],
    };
    let table = ScatterTable::new("not reciprocal", vec![data], vec![]).unwrap();
    let defect = reciprocity(&table, Quantity::Reflection, true).unwrap();
    assert!((defect.rms - 0.1932).abs() < 0.004, "{defect:?}");
    let (wi, wo) = defect.at;
    assert!((wi.z - wo.z).abs() > 0.7, "the worst pair is steep against grazing: {defect:?}");
    assert!(reciprocity(&table, Quantity::Transmission, true).is_none());
}
