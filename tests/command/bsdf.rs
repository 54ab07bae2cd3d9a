//! `caustix bsdf` as a stranger types it: what is printed, the names that programs rely on, plots, exit codes.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::fs;

use serde_json::Value;

use crate::support::data::project;
use crate::support::stranger::Stranger;

/// A surface that reflects and transmits; f falls linearly (times cosine) from its value at the pole to 0 at 90 degrees, so
/// the albedo of f is 2 pi f (1 - 2 / pi).
const SHEET: &str = "caustix-scattering 1
name A sheet
frame surface
symmetry rotational
channels 1
theta_i 0 60
polar 0 90
lobe reflection front
incidence 0
0.10 0.10
incidence 60
0.20 0.20
lobe transmission front
theta_i 0 30
incidence 0
tis 0.3
0.15 0.15
incidence 30
tis 0.2
0.05 0.05
";

fn albedo_of(f: f64) -> f64 {
    2.0 * PI * f * (1.0 - 2.0 / PI)
}

fn json(s: &Stranger, file: &str) -> Value {
    let (code, out, err) = s.types(&format!("bsdf {file} --json"));
    assert_eq!((code, err.as_str()), (0, ""));
    serde_json::from_str(&out).unwrap()
}

fn keys(value: &Value) -> BTreeSet<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

fn near(value: &Value, exact: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - exact).abs() < 1e-6 * exact.abs().max(1.0), "{value}, not {exact}");
}

#[test]
fn the_printed_report_has_angles_albedos_and_declared_totals() {
    let s = Stranger::with(&[("sheet.scatter", SHEET)]);
    let (code, out, err) = s.types("bsdf sheet.scatter");
    assert_eq!(code, 0, "{err}");
    for line in [
        "name                A sheet",
        "format              caustix text",
        "reflection          from the front, grey",
        "  incident          2 polar angles to 60 deg, isotropic",
        "transmission        from the front, grey",
        "  incident          2 polar angles to 30 deg, isotropic",
        "  largest           0.2/sr",
        "reflection of light from the front",
        " incidence      albedo",
        "     0 deg    0.228319",
        "    60 deg    0.456637",
        "transmission of light from the front",
        " incidence      albedo    declared",
        "     0 deg    0.342478    0.300000",
        "    30 deg    0.114159    0.200000",
        // At 0 degrees 0.2283 + 0.3425; at 60 degrees the transmission of the last angle, 30, holds: 0.4566 + 0.1142.
        "energy              from the front: largest albedo 0.570796 at 0 deg, 0 deg",
    ] {
        assert!(out.lines().any(|l| l == line), "{line}\n{out}");
    }
    assert!(out.contains("reciprocity         reflection from the front: off by "), "{out}");
    assert!(
        err.contains("a declared total transmission of 0.2 at theta_i 30"),
        "warnings go to stderr: {err}"
    );
}

#[test]
fn json_has_the_same_and_keeps_its_names() {
    let s = Stranger::with(&[("sheet.scatter", SHEET)]);
    let json = json(&s, "sheet.scatter");
    let top = ["energy", "file", "format", "lobes", "name", "reciprocity", "warnings"];
    assert_eq!(keys(&json), top.into());
    let lobe = [
        "azimuth_angles",
        "channels",
        "frame",
        "incidences",
        "isotropic",
        "max_per_sr",
        "phi_i_deg",
        "polar_angles",
        "polar_last_deg",
        "quantity",
        "side",
        "symmetry",
        "theta_i_deg",
    ];
    assert_eq!(keys(&json["lobes"][0]), lobe.into());
    let incidence = ["albedo", "phi_i_deg", "theta_i_deg", "tis_declared"];
    assert_eq!(keys(&json["lobes"][1]["incidences"][0]), incidence.into());
    near(&json["lobes"][0]["incidences"][1]["albedo"], albedo_of(0.20));
    near(&json["lobes"][1]["incidences"][1]["tis_declared"], 0.2);
    assert_eq!(json["lobes"][0]["symmetry"], "rotational");
    assert_eq!(
        keys(&json["energy"][0]),
        ["conserved", "max_albedo", "phi_i_deg", "side", "theta_i_deg"].into()
    );
    near(&json["energy"][0]["max_albedo"], albedo_of(0.25));
    assert_eq!(json["energy"][0]["conserved"], true);
    let defect = ["incident_deg", "largest", "quantity", "rms", "scattered_deg", "side"];
    assert_eq!(keys(&json["reciprocity"][0]), defect.into());
    assert!(
        json["warnings"].as_array().unwrap().iter().any(|w| w.as_str().unwrap().contains("declared total"))
    );
}

#[test]
fn too_much_light_colour_and_missing_symmetry_are_told() {
    // 1.25 of green at 50 degrees; the way there and back differ: red light from 0 scatters to 50 three times as much.
    let (r, g, b) = (0.1, 1.25 / albedo_of(1.0), 0.05);
    let block = |r: f64, g: f64, b: f64| format!("{r} {r}\n{g:.9} {g:.9}\n{b} {b}\n");
    let text = format!(
        "caustix-scattering 1\nframe surface\nsymmetry rotational\nchannels 3\ntheta_i 0 50\npolar 0 90\n\
         lobe reflection both\nincidence 0\n{}incidence 50\n{}",
        block(0.3, 0.1, 0.0),
        block(r, g, b)
    );
    let s = Stranger::with(&[("paint.scatter", &text)]);
    let json = json(&s, "paint.scatter");
    let energy = &json["energy"][0];
    near(&energy["max_albedo"], 1.25);
    assert_eq!(
        (&energy["conserved"], energy["theta_i_deg"].as_f64(), &energy["side"]),
        (&false.into(), Some(50.0), &"both".into())
    );
    let at = &json["lobes"][0]["incidences"][1];
    near(&at["albedo_rgb"][0], albedo_of(r));
    near(&at["albedo_rgb"][1], 1.25);
    near(&at["albedo"], 0.2126 * albedo_of(r) + 0.7152 * 1.25 + 0.0722 * albedo_of(b));
    assert!(json["reciprocity"][0]["rms"].as_f64().unwrap() > 0.2, "{}", json["reciprocity"]);
    let (_, out, _) = s.types("bsdf paint.scatter");
    assert!(out.contains("largest albedo 1.25 at 50 deg, 0 deg: more than arrives"), "{out}");
    assert!(out.contains(" incidence      albedo         red       green        blue"), "{out}");
}

#[test]
fn own_tables_conserve_energy_and_plot() {
    let s = Stranger::with(&[]);
    let folder = project().join("brdf_tables");
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "scatter") {
            let json = json(&s, &path.display().to_string());
            for energy in json["energy"].as_array().unwrap() {
                assert_eq!(energy["conserved"], true, "{}: {energy}", path.display());
            }
            let (code, _, err) = s.types(&format!("bsdf {} --plot a.svg", path.display()));
            assert_eq!(code, 0, "{err}");
            let svg = fs::read_to_string(s.folder().join("a.svg")).unwrap();
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{}", path.display());
            assert!(
                svg.contains("cd/lm") && svg.contains(json["name"].as_str().unwrap()),
                "{}",
                path.display()
            );
            count += 1;
        }
    }
    assert!(count >= 7);
}

#[test]
fn plots_are_written_by_their_ending() {
    let s = Stranger::with(&[("sheet.scatter", SHEET)]);
    let (code, _, err) = s.types("bsdf sheet.scatter --plot a.PNG");
    assert_eq!(code, 0, "{err}");
    assert!(fs::read(s.folder().join("a.PNG")).unwrap().starts_with(b"\x89PNG"));
    let (code, _, err) = s.types("bsdf sheet.scatter --plot a.gif");
    assert_eq!(code, 1);
    assert!(err.contains("--plot a.gif; required: a name ending in .svg or .png"), "{err}");
}

#[test]
fn mistakes_exit_1_with_their_place_and_usage_exits_2() {
    let bad = SHEET.replace("0.20 0.20", "0.20 x");
    let s = Stranger::with(&[("bad.scatter", &bad), ("x.bsdf", "OPTIS - Anisotropic BSDF"), ("empty", "")]);
    for (line, code, parts) in [
        ("bsdf bad.scatter", 1, &["bad.scatter:12:6: found ", "required: "][..]),
        ("bsdf x.bsdf", 1, &["x.bsdf:1:1: found a Speos file"]),
        ("bsdf empty", 1, &["empty:1:1: found an empty file"]),
        ("bsdf nowhere.bsdf", 1, &["nowhere.bsdf"]),
        ("bsdf", 2, &["FILE"]),
        ("bsdf sheet.scatter --plott a.svg", 2, &["--plot"]),
    ] {
        let (exit, out, err) = s.types(line);
        assert_eq!((exit, out.as_str()), (code, ""), "{line}\n{err}");
        for part in parts {
            assert!(err.contains(part), "caustix {line}: no \"{part}\" in\n{err}");
        }
    }
}
