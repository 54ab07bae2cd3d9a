//! Every rule of the scene format but those of surfaces and receivers, broken once: place, kind, found, required and hint of the
//! message.

use caustix::emitter::Emits;
use caustix::error::Kind;
use caustix::scene::receiver::Cells;

use crate::broken_scene::{
    BLACK, LAMP, LENGTH, METRES, PLATE, RECEIVER, emitter, expect, material, read, unmarked,
};

#[test]
fn the_scene_the_errors_are_put_into_is_good() {
    let scene = read(&format!("{LAMP}{BLACK}{PLATE}{RECEIVER}")).unwrap();
    assert!(scene.warnings.is_empty());
    assert_eq!(scene.build().unwrap().receivers[0].cells, Cells::Grid { nu: 256, nv: 256 });
}

/// The types of a table that docs/SCENE.md names, in its order: what messages must offer.
fn documented_types(table: &str) -> Vec<String> {
    let page = include_str!("../../docs/SCENE.md");
    let (_, section) = page.split_once(&format!("\n## `{table}`\n")).unwrap();
    let rows = section.lines().skip_while(|line| !line.starts_with("| `type`"));
    let rows = rows.take_while(|line| line.starts_with('|'));
    let is_type = |row: &&str| row.starts_with("| `\"") || row.starts_with("| `type` | `\"");
    let cell = |row: &str| row.split('|').find(|cell| cell.contains("`\"")).unwrap().to_owned();
    let cells: Vec<String> = rows.filter(is_type).map(cell).collect();
    let words = cells.iter().flat_map(|cell| cell.split("`\"").skip(1));
    words.map(|word| word.split('"').next().unwrap().to_owned()).collect()
}

/// Words as a message lists them, each between these marks.
fn listed(words: &[String], mark: &str) -> String {
    let (last, others) = words.split_last().unwrap();
    let marked = |word: &String| format!("{mark}{word}{mark}");
    format!("{} or {}", others.iter().map(marked).collect::<Vec<_>>().join(", "), marked(last))
}

#[test]
fn top_level() {
    let good = format!("{BLACK}{PLATE}{RECEIVER}");
    expect(&format!("«{good}"), Kind::Missing, "a scene without [[emitter]]", "at least one [[emitter]]");
    let error = expect(
        &format!("{LAMP}{good}[[«recever]]\nsurface = \"plate\"\n"),
        Kind::Unknown,
        "the unknown key `recever` in a scene",
        "emitter, material, ambient, surface, receiver, far_field, camera, compare or run",
    );
    assert_eq!(error.advice(), Some("did you mean `receiver`?"));
    expect(
        &format!("{LAMP}{good}«[camera]\nlook_at = [0, 0, 0]\nfov_deg = 40\npixels = [4, 3]\n"),
        Kind::Missing,
        "[camera] without `position`",
        "position = [x, y, z] in metres",
    );
    expect(
        &format!("«[emitter]\ntype = \"isotropic\"\n{good}"),
        Kind::Syntax,
        "emitter = [emitter]",
        "1 to 4096 tables headed [[emitter]] (two brackets)",
    );
    expect(&format!("material = «3\n{LAMP}"), Kind::Syntax, "material = 3", "a table { ... }");
    expect(
        &format!("{LAMP}[material]\nblack = «\"absorber\"\n"),
        Kind::Syntax,
        "black = \"absorber\"",
        "a table [material.NAME]",
    );
    let many = format!("«{}", LAMP.repeat(4097));
    expect(&many, Kind::Limit, "4097 emitter tables", "1 to 4096 tables headed [[emitter]] (two brackets)");
}

#[test]
fn toml_syntax() {
    let errors = read(&format!("{LAMP}x = \n")).unwrap_err();
    assert_eq!((errors[0].line(), errors[0].kind()), (Some(5), Kind::Syntax), "{errors:#?}");
    let errors = read("[[emitter]]\nname = \"grün\" oops\n").unwrap_err();
    assert_eq!((errors[0].line(), errors[0].column()), (Some(2), Some(15)), "{errors:#?}");
    expect(
        &format!("{LAMP}«flux_lm = 200\n{BLACK}"),
        Kind::Syntax,
        "`flux_lm` a second time (first in line 4)",
        "every key and every header once",
    );
    expect(
        &format!("{LAMP}{BLACK}\n[material.«black]\ntype = \"mirror\"\n"),
        Kind::Syntax,
        "`black` a second time (first in line 5)",
        "every key and every header once",
    );
}

#[test]
fn emitters() {
    expect(
        &emitter("«[[emitter]]\ntype = \"panel\"\nposition = [0, 0, 1]\nflux_lm = 1"),
        Kind::Missing,
        "a panel [[emitter]] without `size`",
        "size = [width, height] in metres",
    );
    expect(
        &emitter("[[emitter]]\ntype = \"panel\"\nposition = [0, 0, 1]\nflux_lm = 1\nsize = [1, «0]"),
        Kind::Range,
        "size[1] = 0",
        "a length from 1e-9 to 1e9 m",
    );
    let error = expect(
        &emitter("[[emitter]]\ntype = «\"isotropc\""),
        Kind::Unknown,
        "type = \"isotropc\"",
        &listed(&documented_types("[[emitter]]"), ""),
    );
    assert_eq!(error.advice(), Some("did you mean \"isotropic\"?"));
    expect(
        &emitter("«[[emitter]]\nposition = [0, 0, 0]"),
        Kind::Missing,
        "an [[emitter]] without `type`",
        &format!("type = {}", listed(&documented_types("[[emitter]]"), "\"")),
    );
    expect(
        &emitter("«[[emitter]]\ntype = \"isotropic\"\nflux_lm = 1"),
        Kind::Missing,
        "an isotropic [[emitter]] without `position`",
        "position = [x, y, z] in metres",
    );
    expect(
        &emitter("«[[emitter]]\ntype = \"photometric\"\nposition = [0, 0, 1]"),
        Kind::Missing,
        "a photometric [[emitter]] without `file`",
        "file = the path of a file, relative to the scene file",
    );
    expect(
        &emitter("[[emitter]]\ntype = \"photometric\"\nposition = [0, 0, 1]\nfile = «\"\""),
        Kind::Range,
        "file = \"\"",
        "the path of a file, relative to the scene file",
    );
    expect(
        &emitter("«[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 1]"),
        Kind::Missing,
        "an isotropic [[emitter]] without `flux_lm`",
        "flux_lm = a flux from 1e-9 to 1e12 lm",
    );
    let error = expect(
        &emitter("[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 1]\nflux_lm = 1\n«diameter = 2"),
        Kind::Unknown,
        "the unknown key `diameter` in an isotropic [[emitter]]",
        "name, type, position, flux_lm, colour, cct_k or medium",
    );
    assert_eq!(error.advice(), None);
    let beam = "[[emitter]]\ntype = \"collimated\"\nposition = [0, 0, 1]\nflux_lm = 1\n";
    expect(
        &emitter(&format!("«{beam}")),
        Kind::Missing,
        "a collimated [[emitter]] without `radius`",
        "radius = ... for a disc, or size = [width, height], in metres",
    );
    expect(
        &emitter(&format!("{beam}radius = 1\nsize = «[1, 1]")),
        Kind::Range,
        "size = [1, 1]",
        "either radius or size, not both",
    );
    expect(&emitter(&format!("{beam}radius = «-1")), Kind::Range, "radius = -1", LENGTH);
    expect(&emitter(&format!("{beam}size = [1, «0]")), Kind::Range, "size[1] = 0", LENGTH);
}

#[test]
fn numbers() {
    let isotropic = |position: &str, flux: &str| {
        emitter(&format!("[[emitter]]\ntype = \"isotropic\"\nposition = {position}\nflux_lm = {flux}"))
    };
    for bad in ["nan", "-nan", "inf", "-inf", "2e9", "-1e300", "1e999"] {
        expect(
            &isotropic(&format!("[0, «{bad}, 0]"), "1"),
            Kind::Range,
            &format!("position[1] = {bad}"),
            METRES,
        );
    }
    for bad in ["0", "-1", "nan", "inf", "0.0", "1e13"] {
        let found = format!("flux_lm = {bad}");
        expect(
            &isotropic("[0, 0, 0]", &format!("«{bad}")),
            Kind::Range,
            &found,
            "a flux from 1e-9 to 1e12 lm",
        );
    }
    let found = "flux_lm = \"100 lm\"";
    expect(&isotropic("[0, 0, 0]", "«\"100 lm\""), Kind::Syntax, found, "a flux from 1e-9 to 1e12 lm");
    let required = format!("a list of 3 numbers, each {METRES}");
    expect(&isotropic("«[0, 0]", "1"), Kind::Syntax, "position = [0, 0]", &required);
    expect(&isotropic("«[0, 0, 0, 0]", "1"), Kind::Syntax, "position = [0, 0, 0, 0]", &required);
    expect(&isotropic("«true", "1"), Kind::Syntax, "position = true", &required);
    expect(&isotropic("[0, 0, «\"up\"]", "1"), Kind::Syntax, "position[2] = \"up\"", METRES);
    // Integers, hexadecimals and separators are numbers too.
    let scene = read(&isotropic("[1, 0x10, -1_0.5e0]", "1_000")).unwrap();
    let scene = scene.build().unwrap();
    assert_eq!(scene.emitters.as_slice()[0].position().to_array(), [1.0, 16.0, -10.5]);
    assert_eq!(scene.emitters.flux_lm(), 1000.0);
    // A column counts characters, not bytes.
    let wide =
        "emitter = [{ name = \"größte λ\", type = \"isotropic\", position = [0, 0, «nan], flux_lm = 1 }]\n";
    expect(&format!("{wide}{BLACK}{PLATE}{RECEIVER}"), Kind::Range, "position[2] = nan", METRES);
}

#[test]
fn directions() {
    let aimed = |keys: &str| {
        emitter(&format!(
            "[[emitter]]\ntype = \"photometric\"\nfile = \"a.ies\"\nposition = [0, 0, 1]\n{keys}"
        ))
    };
    const DIRECTION: &str = "a direction [x, y, z] that is not zero";
    expect(&aimed("aim = «[0, 0, 0]"), Kind::Range, "aim = [0, 0, 0]", DIRECTION);
    expect(&aimed("up = «[0, 0.0, 0]"), Kind::Range, "up = [0, 0.0, 0]", DIRECTION);
    let parallel = "a direction that is not parallel to aim";
    expect(&aimed("up = «[0, 0, 5]"), Kind::Range, "up = [0, 0, 5]", parallel);
    expect(&aimed("aim = [1, 2, 3]\nup = «[-2, -4, -6]"), Kind::Range, "up = [-2, -4, -6]", parallel);
    expect(&aimed("aim = [0, 1, 0]\nup = «[1e-10, 1, 0]"), Kind::Range, "up = [1e-10, 1, 0]", parallel);
}

#[test]
fn materials() {
    let types = listed(&documented_types("[material.NAME]"), "");
    expect(
        &material("[material.black]\ntype = «\"conductor\"\nfile = \"x\""),
        Kind::Unavailable,
        "type = \"conductor\"",
        &format!("{types}; conductor is not available yet"),
    );
    let error = expect(
        &material("[material.black]\ntype = «\"Absorbr\""),
        Kind::Unknown,
        "type = \"Absorbr\"",
        &types,
    );
    assert_eq!(error.advice(), Some("did you mean \"absorber\"?"));
    expect(
        &material("[material.«black]"),
        Kind::Missing,
        "a [material.NAME] without `type`",
        &format!("type = {}", listed(&documented_types("[material.NAME]"), "\"")),
    );
    let ior = "a refractive index from 0.001 to 1000";
    for bad in ["0", "-1.5", "nan", "inf", "1e-9", "1e9"] {
        expect(
            &material(&format!("[material.black]\ntype = \"dielectric\"\nior = «{bad}")),
            Kind::Range,
            &format!("ior = {bad}"),
            ior,
        );
    }
    expect(
        &material("[material.«black]\ntype = \"dielectric\""),
        Kind::Missing,
        "a dielectric without `ior`",
        &format!("ior = {ior}"),
    );
    expect(
        &material("[material.black]\ntype = \"dielectric\"\nior = 1.5\nior_outside = «0"),
        Kind::Range,
        "ior_outside = 0",
        ior,
    );
    let reflectance = "a reflectance from 0 to 1";
    for (kind, bad) in [("mirror", "1.01"), ("lambertian", "-0.1"), ("lambertian", "nan")] {
        expect(
            &material(&format!("[material.black]\ntype = \"{kind}\"\nreflectance = «{bad}")),
            Kind::Range,
            &format!("reflectance = {bad}"),
            reflectance,
        );
    }
    expect(
        &material("[material.«black]\ntype = \"lambertian\""),
        Kind::Missing,
        "a lambertian material without `reflectance`",
        &format!("reflectance = {reflectance}"),
    );
    for bad in ["1.01", "-0.1", "nan"] {
        expect(
            &material(&format!(
                "[material.black]\ntype = \"lambertian\"\nreflectance = 0.1\ntransmittance = «{bad}"
            )),
            Kind::Range,
            &format!("transmittance = {bad}"),
            "a transmittance from 0 to 1",
        );
    }
    expect(
        &material(
            "[material.black]\ntype = \"lambertian\"\nreflectance = [0.2, 0.6, 0.2]\ntransmittance = «0.5",
        ),
        Kind::Range,
        "transmittance = 0.5",
        "a transmittance of at most 1 - reflectance in every channel",
    );
    let error = expect(
        &material("[material.black]\ntype = \"mirror\"\n«reflectence = 0.5"),
        Kind::Unknown,
        "the unknown key `reflectence` in a mirror",
        "type or reflectance",
    );
    assert_eq!(error.advice(), Some("did you mean `reflectance`?"));
    let scene =
        read(&material("[material.black]\ntype = \"dielectric\"\nior = 1.33\nior_outside = 1.33")).unwrap();
    assert_eq!(scene.warnings.len(), 1);
    let warning = &scene.warnings[0];
    assert_eq!((warning.line(), warning.column(), warning.kind()), (Some(7), Some(7), Kind::Range));
    assert_eq!(warning.found(), "ior = 1.33, the same as ior_outside");
}

#[test]
fn references_and_names() {
    let head = format!("{LAMP}{BLACK}");
    let error = expect(
        &format!("{head}{}{RECEIVER}", PLATE.replace("\"black\"", "«\"blakc\"")),
        Kind::Unknown,
        "the unknown material `blakc`",
        "a material of this scene: black",
    );
    assert_eq!(error.advice(), Some("did you mean `black`?"));
    expect(
        &format!("{LAMP}{}{RECEIVER}", PLATE.replace("\"black\"", "«\"black\"")),
        Kind::Unknown,
        "the unknown material `black`",
        "a material of this scene: there is none",
    );
    let error = expect(
        &format!("{head}{PLATE}[[receiver]]\nsurface = «\"plat\"\n"),
        Kind::Unknown,
        "the unknown surface `plat`",
        "a surface of this scene: plate",
    );
    assert_eq!(error.advice(), Some("did you mean `plate`?"));
    expect(
        &format!("{head}{PLATE}«[[receiver]]\nside = \"front\"\n"),
        Kind::Missing,
        "a [[receiver]] without `surface`",
        "surface = the name of a surface, in quotes",
    );
    expect(
        &format!("{head}{PLATE}{}", PLATE.replace("\"plate\"", "«\"plate\"")),
        Kind::Range,
        "the surface name `plate` a second time (first in line 8)",
        "a name of its own for every surface",
    );
    let named = LAMP.replace("type", "name = \"emitter 2\"\ntype");
    expect(
        &format!("{named}«{LAMP}{BLACK}{PLATE}{RECEIVER}"),
        Kind::Range,
        "the emitter name `emitter 2` a second time (first in line 2)",
        "a name of its own for every emitter",
    );
    expect(
        &format!("{head}{PLATE}{RECEIVER}[[receiver]]\nname = «\"Plate\"\nsurface = \"plate\"\n"),
        Kind::Range,
        "the receiver name `Plate` a second time (first in line 15)",
        "a name of its own for every receiver",
    );
    expect(
        &format!("{head}{}", PLATE.replace("\"plate\"", "«\"\"")),
        Kind::Range,
        "the surface name ``",
        "a name of 1 to 100 characters, none of them a control character",
    );
    expect(
        &format!("{head}«{}", PLATE.replace("name = \"plate\"\n", "")),
        Kind::Missing,
        "a [[surface]] without `name`",
        "name = a name of its own, in quotes",
    );
    // Two receivers on one surface are fine if their names differ.
    let two = format!("{head}{PLATE}{RECEIVER}[[receiver]]\nname = \"direct\"\nsurface = \"plate\"\n");
    assert_eq!(read(&two).unwrap().build().unwrap().receivers.len(), 2);
}

#[test]
fn run() {
    let good = format!("{LAMP}{BLACK}{PLATE}{RECEIVER}[run]\n");
    for (text, photons) in
        [("\"2^22\"", 1 << 22), ("4.5e6", 4_500_000), ("4_456_448", 4_456_448), ("0x10", 16)]
    {
        let scene = read(&format!("{good}photons = {text}\nseed = 7\nreplicates = 4\n")).unwrap();
        assert_eq!(scene.run.photons, Some(photons));
        assert_eq!(scene.run.seed, Some(7));
        assert_eq!(scene.run.replicates, Some(4));
    }
    let count = "a whole number from 1 to 2^48, written like 4_456_448, 4.5e6 or 2^22";
    for (bad, kind) in [
        ("0", Kind::Range),
        ("-5", Kind::Range),
        ("2.5", Kind::Range),
        ("nan", Kind::Syntax),
        ("\"many\"", Kind::Syntax),
        ("true", Kind::Syntax),
        ("1e18", Kind::Limit),
        ("\"2^49\"", Kind::Limit),
    ] {
        expect(&format!("{good}photons = «{bad}\n"), kind, &format!("photons = {bad}"), count);
    }
    let required = "a whole number from 1 to 65536";
    expect(&format!("{good}replicates = «0\n"), Kind::Range, "replicates = 0", required);
    expect(
        &format!("{good}photons = 4\nreplicates = «8\n"),
        Kind::Range,
        "replicates = 8",
        "at most as many replicates as photons",
    );
    expect(&format!("{good}seed = «1.5\n"), Kind::Syntax, "seed = 1.5", "a whole number from 0 to 2^64 - 1");
}

#[test]
fn all_errors_are_told_in_the_order_of_the_file() {
    let text = format!(
        "[[emitter]]\ntype = \"isotropic\"\nposition = [«nan, 0, «inf]\nflux_lm = «0\n«color = 1\n\
         [material.black]\ntype = «\"blak\"\n{}[[receiver]]\nsurface = «\"floor\"\nside = «\"up\"\n",
        PLATE.replace("[1, 0, 0]", "«[0, 0, 0]"),
    );
    let (plain, places) = unmarked(&text);
    let errors = read(&plain).unwrap_err();
    let found: Vec<_> = errors.iter().map(|e| (e.line().unwrap(), e.column().unwrap())).collect();
    assert_eq!(found, places, "{errors:#?}");
    assert!(errors.iter().all(|e| e.file() == Some("test.toml")));
}

#[test]
fn a_flood_of_errors_is_cut_and_counted() {
    let mut text = format!("{LAMP}{BLACK}{PLATE}");
    for i in 0..5000 {
        text.push_str(&format!("unknown{i} = 1\n"));
    }
    let errors = read(&text).unwrap_err();
    assert_eq!(errors.len(), 101);
    assert_eq!(errors[100].found(), "4900 more errors, not listed");
}

#[test]
fn a_byte_order_mark_and_windows_line_ends_change_no_place() {
    let (plain, places) = unmarked("[[emitter]]\r\ntype = «\"isotropi\"\r\n");
    let errors = read(&format!("\u{feff}{plain}")).unwrap_err();
    assert_eq!((errors[0].line(), errors[0].column()), (Some(places[0].0), Some(places[0].1)));
}
