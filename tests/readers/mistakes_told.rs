//! Small mistakes of new users in scene files: one message each, with its place, the rule, and what to do.

use caustix::error::Diagnostic;
use caustix::files::bytes::Base;
use caustix::files::scene_toml;

const SCENE: &str = r#"[[emitter]]
type = "isotropic"
flux_lm = 1000
position = [0.0, 0.0, 2.0]

[material.glass]
type = "dielectric"
ior = 1.5

[material.paint]
type = "lambertian"
reflectance = 0.8

[[surface]]
name = "floor"
type = "rectangle"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 2.0, 0.0]
material = "paint"

[[surface]]
name = "ball"
type = "sphere"
center = [0.0, 0.0, 0.5]
radius = 0.2
material = "glass"

[[receiver]]
surface = "floor"
cells = [16, 16]

[run]
photons = 1024
"#;

fn errors(text: &str) -> Vec<Diagnostic> {
    scene_toml::parse(text, "scene.toml", Base::Directory(".".into())).map(|_| ()).err().unwrap_or_default()
}

#[test]
fn each_mistake_is_one_message_with_its_line_and_what_to_do() {
    assert_eq!(errors(SCENE), []);
    for (right, wrong, line, told) in [
        // The text itself.
        ("radius = 0.2", "radius = 20 cm", 26, "a number without a unit"),
        ("radius = 0.2", "radius = NaN", 26, "required: a number"),
        ("radius = 0.2", "radius: 0.2", 26, "with `=` in place of `:`"),
        ("radius = 0.2", "radius =", 26, "a value after the `=`"),
        ("radius = 0.2", "radius = False", 26, "true or false in small letters"),
        ("photons = 1024", "photons = 2^10", 34, "a power in quotes, as in \"2^22\""),
        ("\"ball\"", "“ball”", 23, "straight quotes"),
        ("\"ball\"", "\"ball", 23, "a quote at its end"),
        ("\"ball\"", "ball", 23, "a text in quotes"),
        ("[0.0, 0.0, 0.5]", "(0.0, 0.0, 0.5)", 25, "a list in square brackets"),
        ("[0.0, 0.0, 0.5]", "[0.0 0.0 0.5]", 25, "a comma between the values of a list"),
        ("[[surface]]", "[surface]", 22, "[[surface]] with two brackets, the same before each"),
        // Values.
        ("radius = 0.2", "radius = \"20 cm\"", 26, "write it without unit and quotes: 0.2)"),
        ("flux_lm = 1000", "flux_lm = \"1.5 klm\"", 3, "write it without unit and quotes: 1500)"),
        ("reflectance = 0.8", "reflectance = 80", 12, "80 % is 0.8)"),
        ("reflectance = 0.8", "reflectance = \"80 %\"", 12, "write it without unit and quotes: 0.8)"),
        ("cells = [16, 16]", "cells = 16", 31, "write [16, 16])"),
        ("cells = [16, 16]", "cells = \"16x9\"", 31, "write [16, 9])"),
        ("cells = [16, 16]", "cells = [16, 16.0]", 31, "write it without a point: 16)"),
        ("photons = 1024", "photons = \"4M\"", 34, "write 4e6)"),
        ("photons = 1024", "photons = \"1,000,000\"", 34, "write 1_000_000)"),
        // Words of other programs.
        ("\"dielectric\"", "\"glass\"", 7, "did you mean \"dielectric\"?"),
        ("\"sphere\"", "\"ball\"", 24, "did you mean \"sphere\"?"),
        ("\"isotropic\"", "\"point\"", 2, "did you mean \"isotropic\"?"),
        ("cells =", "side = \"outside\"\ncells =", 31, "did you mean \"front\"?"),
        // A key that is required and misspelt is one mistake, not two.
        ("corner =", "origin =", 17, "did you mean `corner`?"),
        ("position =", "positon =", 4, "did you mean `position`?"),
        ("[[emitter]]", "[[emiter]]", 1, "did you mean `emitter`?"),
        ("[run]", "[[run]]", 33, "one table, headed [run] (single brackets)"),
    ] {
        let all = errors(&SCENE.replacen(right, wrong, 1));
        assert_eq!(all.len(), 1, "{wrong}: {all:#?}");
        assert_eq!(all[0].line(), Some(line), "{wrong}: {}", all[0]);
        assert!(all[0].to_string().contains(told), "{wrong}: {}", all[0]);
    }
}

#[test]
fn a_missing_key_is_told_where_nothing_was_meant_to_be_it() {
    let all = errors(&SCENE.replacen("corner =", "zebra =", 1));
    assert_eq!(all.len(), 2, "{all:#?}");
    assert!(all[0].found().contains("without `corner`") && all[1].found().contains("`zebra`"), "{all:#?}");
}

#[test]
fn too_many_tables_are_one_error_whatever_refers_to_them() {
    let sphere = |i: u32| {
        format!(
            "[[surface]]\nname = \"s{i}\"\ntype = \"sphere\"\ncenter = [0, 0, {i}]\nradius = 0.1\nmaterial = \"paint\"\n"
        )
    };
    let many: String = (0..4096).map(sphere).collect();
    let of_last = "[[receiver]]\nsurface = \"s4095\"\n";
    let all = errors(&format!("{SCENE}\n{many}{of_last}"));
    assert_eq!(all.len(), 1, "{all:#?}");
    assert!(
        all[0].to_string().contains("found 4098 surface tables; required: 1 to 4096 tables"),
        "{}",
        all[0]
    );
    let many: String = (0..4096).map(|i| format!("[material.m{i}]\ntype = \"absorber\"\n")).collect();
    let all = errors(&format!("{}\n{many}", SCENE.replace("material = \"glass\"", "material = \"m4095\"")));
    assert_eq!(all.len(), 1, "{all:#?}");
    assert!(all[0].found().contains("4098 entries"), "{}", all[0]);
}

#[test]
fn receivers_whose_files_some_systems_would_not_tell_apart_are_refused() {
    let ball = "[[receiver]]\nname = \"NAME\"\nsurface = \"ball\"\ncells = [4, 4]\n";
    for (name, is_same) in [("FLOOR", true), ("Floor", true), ("floor ", false), ("floor2", false)] {
        let all = errors(&format!("{SCENE}\n{}", ball.replace("NAME", name)));
        let is_told = all.iter().any(|e| e.found().contains("a second time (first in line 30)"));
        assert_eq!(is_told, is_same, "{name}: {all:#?}");
        assert!(!is_same || all[0].advice().unwrap().contains("capitals"), "{all:#?}");
    }
    // One letter for some systems, two for others.
    let strasse = SCENE.replace("surface = \"floor\"", "name = \"straße\"\nsurface = \"floor\"");
    assert_eq!(errors(&format!("{strasse}\n{}", ball.replace("NAME", "STRASSE"))).len(), 1);
}

#[test]
fn marks_of_byte_order_are_read_and_utf_16_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, format!("\u{feff}{SCENE}")).unwrap();
    assert!(scene_toml::read_scene(&path).is_ok());
    let units = |f: fn(u16) -> [u8; 2]| SCENE.encode_utf16().flat_map(f).collect::<Vec<u8>>();
    for bytes in [units(u16::to_le_bytes), [vec![0xfe, 0xff], units(u16::to_be_bytes)].concat()] {
        std::fs::write(&path, bytes).unwrap();
        let all = scene_toml::read(&path).unwrap_err();
        assert_eq!(
            (all.len(), all[0].found(), all[0].advice()),
            (1, "a text in UTF-16", Some("save it as UTF-8"))
        );
    }
    let table = std::fs::read(crate::support::data::in_project("brdf_tables/phong.scatter")).unwrap();
    let plain = caustix::files::bsdf::parse(&table, "a").unwrap();
    let marked = caustix::files::bsdf::parse(&[b"\xef\xbb\xbf", &table[..]].concat(), "a").unwrap();
    assert_eq!(format!("{:?}", marked.name), format!("{:?}", plain.name));
    let lamp = std::fs::read(crate::support::data::in_project("ies/downlight.ies")).unwrap();
    let flux = |bytes: &[u8]| {
        caustix::photometry::Summary::new(&caustix::files::photometric::parse(bytes, "a").unwrap()).flux_lm
    };
    // pi times 1000 cd of a cosine, by the trapezoid.
    assert!((flux(&[b"\xef\xbb\xbf", &lamp[..]].concat()) - 1000.0 * std::f64::consts::PI).abs() < 1.0);
}
