//! `caustix check`: what it says of scenes that are drawn wrong, before anybody has rendered them.

use std::fs;

use serde_json::Value;

use crate::absorber::SCENE;
use crate::support::stranger::Stranger;

/// The scene with a pane of two sheets over its plate, of which the lower one looks up (`edge_v` 1) or down (-1).
fn with_pane(edge_v: f64) -> String {
    let sheet = |name: &str, z: f64, v: f64| {
        format!(
            "[[surface]]\nname = \"{name}\"\ntype = \"rectangle\"\nmaterial = \"glass\"\ncorner = [-0.5, {:?}, {z:?}]\nedge_u = [1.0, 0.0, 0.0]\nedge_v = [0.0, {v:?}, 0.0]\n",
            -0.5 * v
        )
    };
    let glass = "[material.glass]\ntype = \"dielectric\"\nior = 1.5\n";
    SCENE.to_owned() + glass + &sheet("upper", 0.5, 1.0) + &sheet("lower", 0.45, edge_v)
}

#[test]
fn check_probes_with_photons_and_tells_what_a_run_would() {
    let s = Stranger::with(&[("right.toml", &with_pane(-1.0)), ("wrong.toml", &with_pane(1.0))]);
    let (code, out, err) = s.types("check right.toml --strict");
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    assert!(
        out.contains("probe      4 096 photons: nothing to warn of\nerror      1 % of cells: about 2^"),
        "{out}"
    );
    let probed = [
        "warning (found by a probe of 4 096 photons): untrusted: ",
        "\"lower\"",
        "exchange edge_u and edge_v",
    ];
    s.is_told("check wrong.toml", 0, &probed);
    s.is_told("check wrong.toml --strict", 4, &probed);
    let (code, out, _) = s.types("check wrong.toml --json --strict");
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &json["probe"]["photons"], &json["ok"]), (4, &Value::from(4096), &Value::from(true)));
    let [found] = &json["probe"]["warnings"].as_array().unwrap()[..] else { panic!("{out}") };
    assert_eq!((&found["code"], &found["severity"]), (&"contradicted-medium".into(), &"untrusted".into()));
    // The lamp is isotropic, 0.5 m above the upper sheet of 1 m x 1 m: that is a sixth of all directions. What enters there,
    // reaches the lower one, but for what is mirrored and what leaves at the rim.
    let share = found["share"].as_f64().unwrap();
    assert!((0.13..1.0 / 6.0).contains(&share), "{share}");
    let (_, out, _) = s.types("check right.toml --json");
    assert!(!out.contains("probe"), "{out}");
    assert_eq!(fs::read_dir(s.folder()).unwrap().count(), 2, "nothing is written");
}

#[test]
fn what_an_error_takes_is_foretold() {
    let s = Stranger::with(&[
        ("scene.toml", &SCENE.replace("[4, 4]", "[24, 24]")),
        ("dark.toml", &SCENE.replace("cells", "side = \"back\"\ncells")),
    ]);
    let (_, out, _) = s.types("check scene.toml --json");
    let json: Value = serde_json::from_str(&out).unwrap();
    let [cells, flux] = &json["forecast"].as_array().unwrap()[..] else { panic!("{out}") };
    assert_eq!(
        (&cells["error_of"], &flux["error_of"], &cells["error"]),
        (&"cells".into(), &"flux".into(), &0.01.into())
    );
    assert!(
        flux["photons"].as_u64() < cells["photons"].as_u64() && cells["seconds"].as_f64().unwrap() > 0.0,
        "{out}"
    );
    s.is_told("render scene.toml -o out --quiet --error 1", 0, &[]);
    let quotient = cells["photons"].as_f64().unwrap() / s.report("out")["photons"].as_f64().unwrap();
    assert!((0.4..2.5).contains(&quotient), "{quotient}");
    // Nothing arrives: no number of photons is told.
    let (_, out, _) = s.types("check dark.toml --json");
    assert!(!out.contains("forecast"), "{out}");
}

#[test]
fn what_is_known_before_a_run_is_said_once() {
    // The plate in millimetres, under the lamp of 100 lm.
    let large = SCENE.replace("1.0", "1000.0").replace("2.0", "2000.0");
    let s = Stranger::with(&[("large.toml", &large)]);
    s.is_told("check large.toml", 0, &["warning: doubtful: the scene is 2000 m large", "are metres"]);
    let (code, _, err) = s.types("render large.toml --photons 2^10 --quiet -o out --strict");
    assert_eq!((code, err.matches("2000 m large").count()), (0, 1), "{err}");
    assert_eq!(s.report("out")["warnings"][0]["code"], "millimetres");
}
