//! Values set by the paths of their keys.

use super::*;

const SCENE: &str = "# a scene\n[[emitter]]  # the lamp\nname = \"lamp\"\nposition = [1.0, 2, 0x3] # m\n[[emitter]]\nflux_lm = 3\n\
                     [material.glass]\nior = 1.5\n[material]\nclear = { ior = 1.4 }\nnone = {}\n[[surface]]\nname = \"a b\"\r\n\
                     [[receiver]]\nsurface = \"a b\"\n[ambient]\nmedium = \"air\"";

fn set(path: &str, value: &str) -> String {
    with_value(SCENE, path, value).unwrap()
}

#[test]
fn a_value_is_replaced_where_it_stands_and_nothing_else() {
    for (path, old, new) in [
        ("emitter.lamp.position[0]", "[1.0, 2", "[7, 2"),
        ("emitter.lamp.position[2]", "0x3]", "7]"),
        ("emitter[0].position[1]", "1.0, 2,", "1.0, 7,"),
        ("emitter.lamp.position", "[1.0, 2, 0x3]", "7"),
        ("emitter[1].flux_lm", "flux_lm = 3", "flux_lm = 7"),
        ("material.glass.ior", "ior = 1.5", "ior = 7"),
        ("material.clear.ior", "ior = 1.4", "ior = 7"),
        ("receiver.a b.surface", "surface = \"a b\"", "surface = 7"),
        ("surface.\"a b\".name", "name = \"a b\"", "name = 7"),
        ("ambient.medium", "\"air\"", "7"),
        // What is not there is added below its header, or behind its brace.
        ("emitter.lamp.cct_k", "[[emitter]]  # the lamp", "[[emitter]]  # the lamp\ncct_k = 7"),
        ("surface.a b.translate[1]", "[[surface]]", "[[surface]]\ntranslate = [0.0, 7, 0.0]"),
        ("surface.a b.scale[0]", "[[surface]]", "[[surface]]\nscale = [7, 1.0, 1.0]"),
        ("material.clear.ior_outside", "{ ior", "{ ior_outside = 7, ior"),
        ("material.none.ior", "{}", "{ ior = 7}"),
        ("run.photons", "\"air\"", "\"air\"\n\n[run]\nphotons = 7\n"),
    ] {
        assert!(SCENE.contains(old), "{old}");
        assert_eq!(set(path, "7"), SCENE.replacen(old, new, 1), "{path}");
    }
    let marked = format!("\u{feff}{SCENE}");
    assert_eq!(with_value(&marked, "material.glass.ior", "7").unwrap(), marked.replace("= 1.5", "= 7"));
    // Every change is TOML.
    for path in ["emitter.lamp.cct_k", "surface.a b.scale[0]", "material.none.ior", "run.seed"] {
        assert!(DeTable::parse(&set(path, "7")).is_ok(), "{path}");
    }
}

#[test]
fn a_path_that_leads_nowhere_is_told_with_what_was_meant() {
    for (path, found, meant) in [
        ("", "the key ``", "a path such as"),
        ("emitter..x", "the key `emitter..x`", "a path such as"),
        ("emitter[x].flux_lm", "the key", "a path such as"),
        ("emitter[0]flux_lm", "the key", "a path such as"),
        ("emitter.\"lamp.x", "the key", "a path such as"),
        ("emiter.lamp.flux_lm", "no `emiter` in the scene", "did you mean `emitter`?"),
        ("far_field.f.name", "no `far_field` in the scene", "begins with one of"),
        ("emitter.lmap.flux_lm", "no emitter of the name `lmap`", "did you mean `lamp`?"),
        ("emitter.flux_lm", "no emitter of the name `flux_lm`", "emitter.lamp, emitter[0] to emitter[1]"),
        ("emitter[2].flux_lm", "emitter[2], of which there are 2", "[0] to [1]"),
        ("emitter.lamp.position[3]", "position[3], of which there are 3", "[0] to [2]"),
        ("emitter.lamp.position.z", "position.z, where emitter.lamp.position is a list", "position[0]"),
        ("emitter.lamp.positon[2]", "no list `positon` in emitter.lamp", "did you mean `position`?"),
        ("emitter.lamp.flux lm", "no key `flux lm` in emitter.lamp", "one of: "),
        ("surface.a b.translate[3]", "translate[3], of which there are 3", "[0] to [2]"),
        ("emitter.lamp.deep.er", "no table `deep`", "one of: "),
        ("material.glas.ior", "no material `glas` in material", "did you mean `glass`?"),
        ("material.glass.ior[0]", "where material.glass.ior is no list", "material.glass.ior alone"),
        ("material.glass.ior.x", "where material.glass.ior is no table", "material.glass.ior alone"),
        ("material.glass", "material.glass, which is a table", "it has ior"),
        ("emitter", "emitter, which is a table", "it has lamp"),
    ] {
        let error = with_value(SCENE, path, "7").unwrap_err();
        assert!(error.found().contains(found) && error.to_string().contains(meant), "{path}: {error}");
    }
    let dotted = with_value("run.seed = 3\n", "run.photons", "7").unwrap_err();
    assert!(dotted.found().contains("whose keys are written with dots"), "{dotted}");
    assert_eq!(with_value("run.seed = 3\n", "run.seed", "7").unwrap(), "run.seed = 7\n");
}
