//! The project's own photometric files: what the formulas give is what is on disk, and what the README states.

use caustix::files::photometric;
use caustix::photometry::{PhotometricType, Summary};
use std::path::PathBuf;

use crate::make_ies;
use crate::support::data::project;

fn folder() -> PathBuf {
    project().join("ies")
}

#[test]
fn files_on_disk_are_the_formulas() {
    let files = make_ies::files();
    for (name, text) in &files {
        let on_disk = std::fs::read(folder().join(name)).unwrap();
        assert!(on_disk == text.as_bytes(), "{name} differs: run the example make_ies");
    }
    let mut on_disk: Vec<String> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".ies"))
        .collect();
    on_disk.sort();
    let mut names: Vec<&str> = files.iter().map(|(name, _)| *name).collect();
    names.sort_unstable();
    assert_eq!(on_disk, names);
}

/// Rows of the README's table of fluxes: file, trapezoid, emitted, formula (if it has an integral), largest cd.
fn stated() -> Vec<(String, f64, f64, Option<f64>, f64)> {
    let readme = std::fs::read_to_string(folder().join("README.md")).unwrap();
    let rows = readme.lines().filter(|line| line.starts_with("| `") && line.contains(".ies` |"));
    rows.filter_map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let number = |i: usize| cells.get(i).and_then(|cell| cell.parse::<f64>().ok());
        Some((cells[1].trim_matches('`').to_owned(), number(2)?, number(3)?, number(4), number(5)?))
    })
    .collect()
}

#[test]
fn fluxes_are_those_of_the_readme() {
    let rows = stated();
    assert_eq!(rows.len(), make_ies::files().len());
    for (name, trapezoid, emitted, formula, max) in rows {
        let photometry = photometric::read(folder().join(&name)).unwrap();
        assert_eq!(photometry.warnings, [], "{name}");
        let summary = Summary::new(&photometry);
        println!("{name}: {} {} {}", summary.flux_lm, summary.flux_emitted_lm, summary.max_candela);
        // The README's numbers are rounded to six decimals.
        assert!((summary.flux_lm - trapezoid).abs() <= 6e-7, "{name}: {} {trapezoid}", summary.flux_lm);
        assert!(
            (summary.flux_emitted_lm - emitted).abs() <= 6e-7,
            "{name}: {} {emitted}",
            summary.flux_emitted_lm
        );
        assert_eq!(summary.max_candela, max, "{name}");
        if let Some(formula) = formula {
            // The formula's own integral: the table is a bilinear stand-in for it.
            let tolerance = if name == "spot.ies" { 1e-2 } else { 2e-3 };
            assert!(
                (summary.flux_lm / formula - 1.0).abs() <= tolerance,
                "{name}: {} {formula}",
                summary.flux_lm
            );
        }
    }
}

#[test]
fn the_fixed_experiment_is_what_it_was_said_to_be() {
    let web = photometric::read(folder().join("wavy_glass.ies")).unwrap().web;
    assert_eq!(
        (web.photometric_type, web.vertical_deg.len(), web.horizontal_deg.len()),
        (PhotometricType::C, 37, 24)
    );
    assert_eq!((web.horizontal_deg[0], web.horizontal_deg[23]), (0.0, 345.0));
    let at = |v: usize, h: usize| web.candela[h * 37 + v];
    let lit: Vec<f64> = web.candela.iter().copied().filter(|&c| c > 0.0).collect();
    let (low, high) = lit.iter().fold((f64::MAX, 0.0f64), |(l, h), &c| (l.min(c), h.max(c)));
    assert!(high / low > 8.0 && high / low <= 10.0, "{low} .. {high}: one decade");
    for h in [8, 20, 21] {
        assert!((0..37).all(|v| at(v, h) == 0.0), "meridian {h} is dark");
    }
    assert!((4..=7).all(|v| [23, 0, 1].iter().all(|&h| at(v, h) == 0.0)), "a dark block");
    assert!((29..37).all(|v| (0..24).all(|h| at(v, h) == 0.0)), "dark beyond 70 degrees");
    // Two lobes: a maximum near (12, 40) and one near (15, 205), a dark block between them and a step below both.
    let peak = |planes: std::ops::RangeInclusive<usize>| {
        let cells = planes.flat_map(|h| (0..37).map(move |v| (v, h)));
        cells.max_by(|a, b| at(a.0, a.1).total_cmp(&at(b.0, b.1))).unwrap()
    };
    let (first, second) = (peak(0..=7), peak(11..=17));
    assert!((3..=6).contains(&first.0) && (2..=4).contains(&first.1), "{first:?}");
    assert!((4..=8).contains(&second.0) && (12..=14).contains(&second.1), "{second:?}");
    assert!(at(first.0, first.1) > 7.0 * low && at(second.0, second.1) > 5.0 * low);
}
