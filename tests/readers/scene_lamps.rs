//! `lamp_set` and `tilt_deg` of photometric emitters.

use caustix::emitter::{Emits, Emitter};
use caustix::error::{Diagnostic, Kind};
use caustix::files::scene_toml;
use caustix::scene::Scene;
use std::f64::consts::TAU;
use std::fs;

use crate::broken_scene::emitter;
use crate::support::data;
use crate::support::ldt::{EVEN, Ldt};

/// An LM-63 file of 100 cd in the lower half, with these words for TILT.
fn ies(tilt: &str) -> String {
    format!("IESNA:LM-63-2002\nTILT={tilt}\n1 -1 1 2 1 1 2 0 0 0\n0.5 1 10\n0 90\n0\n100 100\n")
}

const INCLUDE: &str = "INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8";
/// Lumens of it: the half sphere, with the ballast.
const FLUX_LM: f64 = 0.5 * 100.0 * TAU;

/// The scene of an emitter with these keys beside `lamp`, `two.ldt`, `lamp.tlt`.
fn scene(lamp: &str, keys: &str) -> Result<Scene, Vec<Diagnostic>> {
    const TWO: [[&str; 6]; 2] =
        [["1", "LED 3 W", "1000", "3000", "80", "10"], ["1", "LED 5 W", "2500", "3000", "80", "22"]];
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("lamp", lamp);
    write("two.ldt", &Ldt { sets: &TWO, ..Ldt::new(1, EVEN) }.text());
    write("lamp.tlt", "1 2 10 90 0.5 0.25");
    let lamps: String = keys
        .split("--")
        .map(|keys| format!("[[emitter]]\ntype = \"photometric\"\nposition = [0, 0, 1]\n{keys}"))
        .collect();
    write("scene.toml", &emitter(&lamps));
    scene_toml::read_scene(folder.path().join("scene.toml"))
}

fn fluxes(scene: &Scene) -> Vec<f64> {
    scene.emitters.as_slice().iter().map(Emits::flux_lm).collect()
}

fn near(got: f64, exact: f64) -> bool {
    (got / exact - 1.0).abs() < 1e-12
}

#[test]
fn a_lamp_set_is_chosen_by_its_number() {
    let two = |keys: &str| scene("", &format!("file = \"two.ldt\"\n{keys}"));
    for (keys, flux_lm, warnings) in [
        ("", 1000.0, 1),
        ("lamp_set = 1\n", 1000.0, 0),
        ("lamp_set = 2\n", 2500.0, 0),
        ("lamp_set = 2\nflux_lm = 10\n", 10.0, 0),
    ] {
        let scene = two(keys).unwrap();
        assert!(near(fluxes(&scene)[0], flux_lm), "{keys}: {:?}", fluxes(&scene));
        assert_eq!(scene.warnings.len(), warnings, "{keys}: {:?}", scene.warnings);
        let Emitter::Photometric(lamp) = &scene.emitters.as_slice()[0] else { panic!() };
        assert!(near(lamp.file_flux_lm(), if keys.contains('2') { 2500.0 } else { 1000.0 }));
    }
    // Both sets of one file in one scene, and what a saved map hangs on.
    let both = two("lamp_set = 2\n--file = \"two.ldt\"\nlamp_set = 1\n--file = \"two.ldt\"\nlamp_set = 2\n")
        .unwrap();
    let got = fluxes(&both);
    assert!(near(got[0], 2500.0) && near(got[1], 1000.0) && near(got[2], 2500.0), "{got:?}");
    let light = |keys: &str| two(keys).unwrap().identity.light;
    assert_ne!(light("lamp_set = 1\n"), light("lamp_set = 2\n"));
    assert_eq!(light("lamp_set = 2\n"), light("lamp_set = 0x2 # the bright one\n"));
    for (keys, found, required) in [
        ("lamp_set = 3\n", "lamp set 3 of 2 lamp sets (1: LED 3 W", "1 to 2"),
        ("lamp_set = 0\n", "lamp_set = 0", "the number of a lamp set of the file, from 1"),
        ("lamp_set = 1.5\n", "lamp_set = 1.5", "the number of a lamp set"),
    ] {
        let errors = two(keys).unwrap_err();
        assert_eq!((errors.len(), errors[0].line()), (1, Some(5)), "{errors:?}");
        assert!(errors[0].file().unwrap().ends_with("scene.toml"), "{}", errors[0]);
        assert!(
            errors[0].found().starts_with(found) && errors[0].required().starts_with(required),
            "{}",
            errors[0]
        );
    }
    let errors = scene(&ies("NONE"), "file = \"lamp\"\nlamp_set = 1\n").unwrap_err();
    assert_eq!((errors[0].found(), errors[0].line()), ("lamp set 1 of an IES LM-63 file", Some(5)));
}

#[test]
fn the_tilt_table_gives_one_factor_of_all_intensities() {
    let of = |tilt: &str, keys: &str| scene(&ies(tilt), &format!("file = \"lamp\"\n{keys}"));
    let plain = of("NONE", "").unwrap();
    assert!(near(fluxes(&plain)[0], FLUX_LM), "{:?}", fluxes(&plain));
    for (tilt, keys, factor, told) in [
        (INCLUDE, "", 1.0, "factors 0.8 to 1 at 0 to 90 degrees"),
        (INCLUDE, "tilt_deg = 0\n", 1.0, ""),
        (INCLUDE, "tilt_deg = 22.5\n", 0.95, ""),
        (INCLUDE, "tilt_deg = 45\n", 0.9, ""),
        (INCLUDE, "tilt_deg = 90\n", 0.8, ""),
        // 1 at 0 degrees is usual, and anything else is applied and told.
        ("INCLUDE\n1\n2\n0 90\n0.5 1", "", 0.5, "0.5 at 0 degrees"),
        ("lamp.tlt", "tilt_deg = 50\n", 0.375, ""),
        ("lamp.tlt", "", 1.0, "the table does not reach 0 degrees: a factor of 1 is taken"),
        ("gone.tlt", "", 1.0, "its factors are taken as 1"),
    ] {
        let scene = of(tilt, keys).unwrap();
        let got = fluxes(&scene)[0];
        assert!(near(got, factor * FLUX_LM), "{tilt} {keys}: {got}, {}", factor * FLUX_LM);
        let warnings: Vec<String> = scene.warnings.iter().map(ToString::to_string).collect();
        assert!(told.is_empty() || warnings.iter().any(|w| w.contains(told)), "{tilt} {keys}: {warnings:?}");
        assert_eq!(told.is_empty(), warnings.is_empty(), "{tilt} {keys}: {warnings:?}");
        // The same in every direction: the tilt is not that of the emission.
        let intensity = |scene: &Scene, z: f64| {
            let Emitter::Photometric(lamp) = &scene.emitters.as_slice()[0] else { panic!() };
            lamp.intensity_cd(glam::dvec3((1.0f64 - z * z).sqrt(), 0.0, z))
        };
        for z in [-1.0, -0.7, -0.1] {
            assert!(near(intensity(&scene, z), factor * intensity(&plain, z)), "{tilt} {keys}");
        }
    }
    // flux_lm is what the lamp emits.
    let stated = of(INCLUDE, "tilt_deg = 90\nflux_lm = 100\n").unwrap();
    assert_eq!(fluxes(&stated), [100.0]);
    assert_eq!(stated.warnings[0].found(), "tilt_deg beside flux_lm");
    assert_eq!(of(INCLUDE, "flux_lm = 100\n").unwrap().warnings.len(), 0);
    let light = |keys: &str| of(INCLUDE, keys).unwrap().identity.light;
    assert_ne!(light("tilt_deg = 30\n"), light("tilt_deg = 45\n"));
    for (tilt, keys, found, required) in [
        (INCLUDE, "tilt_deg = 91\n", "tilt_deg = 91 outside the file's tilt table", "0 to 90 degrees"),
        ("lamp.tlt", "tilt_deg = 0\n", "tilt_deg = 0 outside the file's tilt table", "10 to 90 degrees"),
        (
            "NONE",
            "tilt_deg = 30\n",
            "tilt_deg = 30 for a file without a tilt table",
            "no tilt_deg, unless the file has TILT=INCLUDE",
        ),
        (
            "gone.tlt",
            "tilt_deg = 30\n",
            "tilt_deg = 30 for a file with TILT=gone.tlt, which was not read",
            "that file beside",
        ),
        (INCLUDE, "tilt_deg = 181\n", "tilt_deg = 181", "a mounting tilt from -180 to 180 degrees"),
    ] {
        let errors = of(tilt, keys).unwrap_err();
        assert_eq!(
            (errors.len(), errors[0].kind(), errors[0].line()),
            (1, Kind::Range, Some(5)),
            "{errors:?}"
        );
        assert_eq!(errors[0].found(), found);
        assert!(errors[0].required().starts_with(required), "{}", errors[0]);
    }
    let ldt = scene("", "file = \"two.ldt\"\nlamp_set = 1\ntilt_deg = 5\n").unwrap_err();
    assert!(ldt[0].found().contains("without a tilt table"), "{ldt:?}");
}

/// The case that version 0.1.0 said nothing of.
#[test]
fn the_factors_of_a_lamp_are_told_where_nobody_states_its_tilt() {
    let Some(folder) = data::real_folder() else { return };
    let Ok(scene) = scene_toml::read_scene(folder.with_file_name("cases").join("tilt/tilt_include.toml"))
    else {
        println!("no cases beside the data");
        return;
    };
    let said = scene.warnings.iter().find(|w| w.found().contains("factors 0.8 to 1 at 0 to 90 degrees"));
    let said = said.unwrap_or_else(|| panic!("{:?}", scene.warnings));
    assert_eq!(
        (said.required(), said.advice()),
        ("tilt_deg, the tilt at which it is mounted", Some("0 is taken: a factor of 1"))
    );
}
