//! Real EULUMDAT files against numbers of another reader, and against the LM-63 files that their makers wrote
//! of the same lamps.

use caustix::files::photometric;
use caustix::photometry::{Format, Photometry, Summary};
use serde_json::Value;
use std::path::PathBuf;

use crate::support::data;

fn folder() -> Option<PathBuf> {
    data::real_folder()
}

/// Six digits, as the reference has them.
fn six(x: f64) -> String {
    format!("{x:.5e}")
}

#[test]
fn every_file_has_the_flux_and_the_maximum_of_another_reader() {
    let Some(folder) = folder().map(|folder| folder.join("ldt")) else { return };
    let first: Value =
        serde_json::from_slice(&std::fs::read(folder.join("first_set.json")).unwrap()).unwrap();
    let files = first["files"].as_object().unwrap();
    let mut faults = Vec::new();
    for (name, expected) in files {
        let read = match photometric::read(folder.join(name)) {
            Ok(read) => read,
            Err(error) => {
                faults.push(error.to_string());
                continue;
            }
        };
        let summary = Summary::new(&read);
        let number = |key: &str| expected[key].as_f64().unwrap();
        let head = read.eulumdat.unwrap();
        println!(
            "| {name} | {} | {:.6} | {:.6} | {} |",
            head.isym,
            summary.flux_lm,
            summary.max_candela,
            summary.warnings.len()
        );
        read.warnings.iter().for_each(|w| println!("    {w}"));
        let mut same = |what: &str, got: f64, wanted: f64| {
            if six(got) != six(wanted) {
                faults.push(format!("{name}: {what} {got}, {wanted}"));
            }
        };
        same("flux", summary.flux_lm, number("flux_lm"));
        same("maximum", summary.max_candela, number("max_cd"));
        same("lumens", read.lamp_sets[0].flux_lm, number("lumens_set_1"));
        same("Isym", f64::from(head.isym), number("isym"));
        same(
            "planes",
            head.c_planes.max(1) as f64,
            number("planes_full").max(if head.isym == 1 { head.c_planes as f64 } else { 0.0 }),
        );
        let at: Vec<f64> =
            expected["at_c_gamma"].as_str().unwrap().split(", ").map(|word| word.parse().unwrap()).collect();
        // The reference names the first of equal directions over the whole circle.
        same("maximum there", read.web.intensity_cd(at[1], at[0]), number("max_cd"));
        assert_eq!(read.format, Format::Eulumdat);
        assert_eq!(read.lamp_sets.len() > 1, read.warnings.iter().any(|w| w.found().contains("lamp sets (")));
    }
    assert_eq!(faults, Vec::<String>::new());
    assert_eq!(files.len(), 21);
}

/// In every direction that either file has.
#[test]
fn pairs_of_both_formats_are_one_light() {
    let Some(folder) = folder() else { return };
    let read = |name: &str| photometric::read(folder.join(name)).unwrap();
    for (ldt, ies, digits) in [
        ("ldt/copyleft/gldf__lampsets.ldt", "ies/copyleft/gldf__lampset_lumload.ies", 0.051),
        (
            "ldt/copyleft/luxpy__Testlamp_Isym1_007cfb11e343e2f42e3b476be4ab684e.ldt",
            "ies/copyleft/luxpy__Testlamp_Isym1_007cfb11e343e2f42e3b476be4ab684e.ies",
            0.051,
        ),
    ] {
        let (a, b): (Photometry, Photometry) = (read(ldt), read(ies));
        let most = a.web.max_intensity().intensity_cd;
        let mut off: f64 = 0.0;
        for v in a.web.vertical_deg.iter().chain(&b.web.vertical_deg) {
            for i in 0..144 {
                let h = 2.5 * f64::from(i);
                off = off.max((a.web.intensity_cd(*v, h) - b.web.intensity_cd(*v, h)).abs());
            }
        }
        println!("{ldt}: {off} of {most} cd");
        // The IES files have one digit behind the point.
        assert!(off <= (1e-4 * most).max(digits), "{ldt}: {off} of {most} cd");
        let fluxes = [&a, &b].map(|p| Summary::new(p).flux_lm);
        assert!((fluxes[0] / fluxes[1] - 1.0).abs() < 2e-4, "{ldt}: {fluxes:?}");
    }
}
