//! A thin sheet that scatters light diffusely on both sides, against the form factor of a small Lambertian spot and a square.

use caustix::scene::Scene;
use caustix::sequence::Sequence;

use crate::support::judge::assert_total;
use crate::support::scenes::{run, scene};

const FLUX_LM: f64 = 100.0;

/// Part of the light of a small Lambertian spot that a parallel square receives whose middle faces it: half its side over the
/// distance is `a`. (J. R. Howell, "A catalog of radiation heat transfer configuration factors", B-3, four times.)
fn onto_square(a: f64) -> f64 {
    let root = (1.0 + a * a).sqrt();
    4.0 / std::f64::consts::PI * (a / root) * (a / root).atan()
}

/// A thin slanted beam on a sheet at z = 1 between a floor at 0 and a ceiling at 3; it arrives on the sheet's front or back.
fn lit(parts: &str, front: bool) -> Scene {
    let along_y = if front { 0.1 } else { -0.1 };
    scene(&format!(
        "[[emitter]]\ntype = \"collimated\"\nposition = [-0.5, 0, 1.5]\naim = [1, 0, -1]\nradius = 1e-4\nflux_lm = {FLUX_LM:?}
[material.sheet]\ntype = \"lambertian\"\n{parts}
[material.black]\ntype = \"absorber\"
[[surface]]\nname = \"sheet\"\nmaterial = \"sheet\"\ntype = \"rectangle\"\ncorner = [-0.05, {:?}, 1]\nedge_u = [0.1, 0, 0]\nedge_v = [0, {along_y:?}, 0]
[[surface]]\nname = \"floor\"\nmaterial = \"black\"\ntype = \"rectangle\"\ncorner = [-1, -1, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 2, 0]
[[surface]]\nname = \"ceiling\"\nmaterial = \"black\"\ntype = \"rectangle\"\ncorner = [-1, 1, 3]\nedge_u = [2, 0, 0]\nedge_v = [0, -2, 0]
",
        -0.5 * along_y
    ))
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[test]
fn flux_is_reflected_transmitted_and_absorbed_as_the_keys_say() {
    let red = [0.6, 0.1, 0.0];
    let blue = [0.1, 0.2, 0.9];
    for (parts, reflected, transmitted) in [
        ("reflectance = 0.5\ntransmittance = 0.3".to_string(), 0.5, 0.3),
        ("reflectance = 0\ntransmittance = 1".to_string(), 0.0, 1.0),
        ("reflectance = 0.25\ntransmittance = 0.75".to_string(), 0.25, 0.75),
        (format!("reflectance = {red:?}\ntransmittance = {blue:?}"), luminance(red), luminance(blue)),
    ] {
        for front in [true, false] {
            let scene = lit(&parts, front);
            let outcome = run(&scene, Sequence::SobolOwen, 1 << 13, 16, 5);
            let exact = [
                ("absorbed by the sheet", 1.0 - reflected - transmitted),
                ("on the floor", transmitted * onto_square(1.0)),
                ("on the ceiling", reflected * onto_square(0.5)),
            ];
            for (surface, (label, part)) in exact.into_iter().enumerate() {
                let found = outcome.absorbed_lm(surface);
                if part.abs() < 1e-12 {
                    assert!(found.value < 1e-9, "{label}: {found:?}");
                } else {
                    assert_total(&format!("{parts}, {label}"), &outcome, found, part * FLUX_LM);
                }
            }
        }
    }
}

#[test]
fn no_transmittance_is_the_same_as_none_named() {
    let results = ["reflectance = 0.5", "reflectance = 0.5\ntransmittance = 0"].map(|parts| {
        let scene = lit(parts, true);
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 10, 4, 5);
        (
            format!("{:?}", outcome.ledger),
            format!("{:?}", outcome.census),
            caustix::scene::requires::requirements(&scene),
        )
    });
    assert_eq!(results[0], results[1]);
    assert!(!results[0].2.contains(&"diffuse transmission"));
    let scene = lit("reflectance = 0.5\ntransmittance = 0.1", true);
    let words = caustix::scene::requires::requirements(&scene);
    assert!(words.contains(&"diffuse scattering") && words.contains(&"diffuse transmission"), "{words:?}");
}
