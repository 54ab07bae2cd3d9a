//! Every rule of the scene format, broken once: place, kind, found, required and hint of the message.

use caustix::error::{Diagnostic, Kind};
use caustix::scene::description::{Description, ReliefDescription, ShapeDescription};
use caustix::scene::file::parse;
use caustix::scene::source::Base;

/// Where an error is expected in a text of the tests.
const MARK: char = '«';

const LAMP: &str = "[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 2]\nflux_lm = 100\n";
const BLACK: &str = "[material.black]\ntype = \"absorber\"\n";
const PLATE: &str = "[[surface]]\nname = \"plate\"\ntype = \"rectangle\"\nmaterial = \"black\"\n\
                     corner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\n";
const RECEIVER: &str = "[[receiver]]\nsurface = \"plate\"\n";

fn read(text: &str) -> Result<Description, Vec<Diagnostic>> {
    parse(text, "test.toml", Base::Directory(".".into()))
}

/// The text without its marks, and the line and column of each.
fn unmarked(text: &str) -> (String, Vec<(usize, usize)>) {
    let (mut plain, mut places) = (String::new(), Vec::new());
    let (mut line, mut column) = (1, 1);
    for c in text.chars() {
        if c == MARK {
            places.push((line, column));
            continue;
        }
        plain.push(c);
        column += 1;
        if c == '\n' {
            (line, column) = (line + 1, 1);
        }
    }
    (plain, places)
}

/// The scene has exactly one error, at its mark: (kind, found, required); returns it.
#[track_caller]
fn expect(text: &str, kind: Kind, found: &str, required: &str) -> Diagnostic {
    let (plain, places) = unmarked(text);
    let errors = read(&plain).expect_err("the scene should be refused");
    assert_eq!(errors.len(), 1, "{errors:#?}");
    assert_eq!(places.len(), 1, "one mark");
    let error = errors[0].clone();
    assert_eq!((error.line(), error.column()), (Some(places[0].0), Some(places[0].1)), "{error}");
    assert_eq!(error.file(), Some("test.toml"));
    assert_eq!(error.kind(), kind, "{error}");
    assert_eq!(error.found(), found);
    assert_eq!(error.required(), required);
    error
}

/// A scene whose emitter is `body`.
fn emitter(body: &str) -> String {
    format!("{body}\n{BLACK}{PLATE}{RECEIVER}")
}

fn material(body: &str) -> String {
    format!("{LAMP}{body}\n{PLATE}{RECEIVER}")
}

fn surface(body: &str) -> String {
    format!("{LAMP}{BLACK}{PLATE}{RECEIVER}[[surface]]\nname = \"s\"\nmaterial = \"black\"\n{body}\n")
}

fn receiver(body: &str) -> String {
    format!("{LAMP}{BLACK}{PLATE}{body}\n")
}

const METRES: &str = "a number of metres from -1e9 to 1e9";
const LENGTH: &str = "a length from 1e-9 to 1e9 m";

#[test]
fn the_scene_the_errors_are_put_into_is_good() {
    let scene = read(&format!("{LAMP}{BLACK}{PLATE}{RECEIVER}")).unwrap();
    assert!(scene.warnings.is_empty());
    assert_eq!(scene.receivers[0].cells, Some([256, 256]));
}

#[test]
fn top_level() {
    let good = format!("{BLACK}{PLATE}{RECEIVER}");
    expect(&format!("«{good}"), Kind::Missing, "a scene without [[emitter]]", "at least one [[emitter]]");
    let error = expect(
        &format!("{LAMP}{good}[[«recever]]\nsurface = \"plate\"\n"),
        Kind::Unknown,
        "the unknown key `recever` in a scene",
        "emitter, material, surface, receiver, camera, compare or run",
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
        "photometric, isotropic, collimated or panel",
    );
    assert_eq!(error.advice(), Some("did you mean \"isotropic\"?"));
    expect(
        &emitter("«[[emitter]]\nposition = [0, 0, 0]"),
        Kind::Missing,
        "an [[emitter]] without `type`",
        "type = \"photometric\", \"isotropic\", \"collimated\" or \"panel\"",
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
        &emitter("[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 1]\nflux_lm = 1\n«radius = 2"),
        Kind::Unknown,
        "the unknown key `radius` in an isotropic [[emitter]]",
        "name, type, position, flux_lm, colour or cct_k",
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
    assert_eq!(scene.emitters[0].position.value.to_array(), [1.0, 16.0, -10.5]);
    assert_eq!(scene.emitters[0].flux_lm, Some(1000.0));
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
    expect(
        &material("[material.black]\ntype = «\"conductor\"\nfile = \"x\""),
        Kind::Unavailable,
        "type = \"conductor\"",
        "dielectric, mirror, lambertian, absorber or tabulated; conductor is not available yet",
    );
    let error = expect(
        &material("[material.black]\ntype = «\"Absorbr\""),
        Kind::Unknown,
        "type = \"Absorbr\"",
        "dielectric, mirror, lambertian, absorber or tabulated",
    );
    assert_eq!(error.advice(), Some("did you mean \"absorber\"?"));
    expect(
        &material("[material.«black]"),
        Kind::Missing,
        "a [material.NAME] without `type`",
        "type = \"dielectric\", \"mirror\", \"lambertian\", \"absorber\" or \"tabulated\"",
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
    assert_eq!(read(&two).unwrap().receivers.len(), 2);
}

#[test]
fn receiver_names_are_file_names() {
    for bad in ["../evil", "a/b", "a\\\\b", ".hidden", "end.", " a", "a:b", "camera", "NUL", "report", "a*"] {
        let text = receiver(&format!("[[receiver]]\nname = \"{bad}\"\nsurface = \"plate\""));
        let errors = read(&text).expect_err(bad);
        assert_eq!(errors.len(), 1, "{errors:#?}");
        assert_eq!((errors[0].line(), errors[0].column()), (Some(15), Some(8)), "{bad}");
        assert!(errors[0].required().contains("file name"), "{bad}: {}", errors[0]);
    }
    for good in ["plate 2", "Wand-Süd", "a.b_c"] {
        let text = receiver(&format!("[[receiver]]\nname = \"{good}\"\nsurface = \"plate\""));
        assert_eq!(read(&text).unwrap().receivers[0].name, good);
    }
}

#[test]
fn receivers() {
    const CELLS: &str = "[cells along u, cells along v], each at least 1, at most 2^26 in all";
    let on_plate = |keys: &str| receiver(&format!("[[receiver]]\nsurface = \"plate\"\n{keys}"));
    expect(&on_plate("cells = [«0, 5]"), Kind::Range, "cells[0] = 0", CELLS);
    expect(&on_plate("cells = [5, «-1]"), Kind::Range, "cells[1] = -1", CELLS);
    expect(&on_plate("cells = [5, «2.5]"), Kind::Syntax, "cells[1] = 2.5", CELLS);
    expect(&on_plate("cells = «[5]"), Kind::Syntax, "cells = [5]", CELLS);
    expect(&on_plate("cells = «[8192, 8193]"), Kind::Limit, "cells = [8192, 8193]", CELLS);
    expect(
        &on_plate("cells = [«99999999999999999999999, 1]"),
        Kind::Range,
        "cells[0] = 99999999999999999999999",
        CELLS,
    );
    assert_eq!(read(&on_plate("cells = [8192, 8192]")).unwrap().receivers[0].cells, Some([8192, 8192]));
    let error =
        expect(&on_plate("side = «\"fornt\""), Kind::Unknown, "side = \"fornt\"", "front, back or both");
    assert_eq!(error.advice(), Some("did you mean \"front\"?"));
    expect(&on_plate("side = «2"), Kind::Unknown, "side = 2", "front, back or both");
    let error =
        expect(&on_plate("events = «\"in\""), Kind::Unknown, "events = \"in\"", "all, direct or indirect");
    assert_eq!(error.advice(), Some("did you mean \"indirect\"?"));
    let on_box =
        surface("type = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]") + "[[receiver]]\nsurface = \"s\"\n";
    assert_eq!(read(&on_box).unwrap().receivers[1].cells, None);
    expect(
        &format!("{on_box}cells = «[2, 2]\n"),
        Kind::Range,
        "cells = [2, 2]",
        "no cells: a box has one value a triangle",
    );
    let scene = read(&format!("{LAMP}{BLACK}{PLATE}")).unwrap();
    assert_eq!(scene.warnings.len(), 1);
    assert_eq!(scene.warnings[0].found(), "a scene without [[receiver]]");
    assert_eq!((scene.warnings[0].line(), scene.warnings[0].column()), (Some(1), Some(1)));
    let scene =
        read(&format!("{LAMP}{BLACK}[material.spare]\ntype = \"mirror\"\n{PLATE}{RECEIVER}")).unwrap();
    assert_eq!(scene.warnings.len(), 1);
    assert_eq!(scene.warnings[0].found(), "the material `spare`, which no surface has");
    assert_eq!((scene.warnings[0].line(), scene.warnings[0].column()), (Some(7), Some(11)));
}

#[test]
fn shapes() {
    let error = expect(
        &surface("type = «\"recangle\""),
        Kind::Unknown,
        "type = \"recangle\"",
        "mesh, rectangle, box, sphere, paraboloid or heightfield",
    );
    assert_eq!(error.advice(), Some("did you mean \"rectangle\"?"));
    let rectangle = |u: &str, v: &str, more: &str| {
        surface(&format!("type = \"rectangle\"\ncorner = [0, 0, 0]\nedge_u = {u}\nedge_v = {v}\n{more}"))
    };
    const EDGE: &str = "an edge [x, y, z] with a length from 1e-9 to 1e9 m";
    expect(&rectangle("«[0, 0, 0]", "[0, 1, 0]", ""), Kind::Geometry, "edge_u = [0, 0, 0]", EDGE);
    expect(
        &rectangle("[1, 0, 0]", "«[-2, 0, 0]", ""),
        Kind::Geometry,
        "edge_v = [-2, 0, 0]",
        "an edge that is not parallel to edge_u: the area is zero",
    );
    const RIGHT: &str = "an edge at right angles to edge_u (after scaling)";
    expect(&rectangle("[1, 0, 0]", "«[1, 1, 0]", ""), Kind::Geometry, "edge_v = [1, 1, 0]", RIGHT);
    expect(
        &rectangle("[1, 1, 0]", "«[-1, 1, 0]", "scale = [1, 2, 1]"),
        Kind::Geometry,
        "edge_v = [-1, 1, 0]",
        RIGHT,
    );
    assert!(read(&rectangle("[1, 1, 0]", "[-1, 1, 0]", "scale = 2")).is_ok());
    let box_of = |max: &str| surface(&format!("type = \"box\"\nmin = [0, 0, 0]\nmax = {max}"));
    const ABOVE: &str = "each coordinate of max from 1e-9 to 1e9 m above that of min";
    expect(&box_of("«[1, 0, 1]"), Kind::Geometry, "max = [1, 0, 1]", ABOVE);
    expect(&box_of("«[1, 1, -1]"), Kind::Geometry, "max = [1, 1, -1]", ABOVE);
    let sphere = |radius: &str, more: &str| {
        surface(&format!("type = \"sphere\"\ncenter = [0, 0, 0]\nradius = {radius}\n{more}"))
    };
    expect(&sphere("«0", ""), Kind::Range, "radius = 0", LENGTH);
    expect(&sphere("«-1", ""), Kind::Range, "radius = -1", LENGTH);
    let uniform = "one factor for all axes: a sphere or paraboloid keeps its shape";
    expect(&sphere("1", "scale = «[1, 1, 2]"), Kind::Geometry, "scale = [1, 1, 2]", uniform);
    let factor = "a positive factor from 1e-9 to 1e9";
    expect(&sphere("1", "scale = «0"), Kind::Range, "scale = 0", factor);
    expect(&sphere("1", "scale = [1, «-1, 1]"), Kind::Range, "scale[1] = -1", factor);
    expect(
        &sphere("1", "scale = «\"big\""),
        Kind::Syntax,
        "scale = \"big\"",
        "a positive factor from 1e-9 to 1e9, or a list of 3 such numbers",
    );
    expect(
        &sphere("1", "rotate_deg = [0, «nan, 0]"),
        Kind::Range,
        "rotate_deg[1] = nan",
        "an angle from -1e6 to 1e6 degrees",
    );
    let dish = |axis: &str, focal: &str| {
        surface(&format!(
            "type = \"paraboloid\"\nvertex = [0, 0, 0]\naxis = {axis}\nfocal_length = {focal}\nradius = 1"
        ))
    };
    const DIRECTION: &str = "a direction [x, y, z] that is not zero";
    expect(&dish("«[0, 0, 0]", "1"), Kind::Range, "axis = [0, 0, 0]", DIRECTION);
    expect(&dish("[0, 0, 1]", "«-2"), Kind::Range, "focal_length = -2", LENGTH);
    expect(
        &surface("type = \"mesh\"\nfile = \"a.obj\"\nclosed = «1"),
        Kind::Syntax,
        "closed = 1",
        "true or false",
    );
    let error = expect(
        &sphere("1", "«centre = [0, 0, 0]"),
        Kind::Unknown,
        "the unknown key `centre` in a sphere",
        "name, material, scale, rotate_deg, translate, type, center or radius",
    );
    assert_eq!(error.advice(), Some("did you mean `center`?"));
}

#[test]
fn heightfields() {
    let field = |more: &str| {
        surface(&format!(
            "type = \"heightfield\"\norigin = [0, 0, 0]\nsize = [1, 1]\nfacing = \"up\"\n{more}"
        ))
    };
    const CELLS: &str = "[cells along x, cells along y], each at least 1, at most 2^22 in all";
    let waves = "waves = [{ amplitude = 0.1, wavelength = 1 }]";
    let noise = "noise = { amplitude = 0.1, octaves = [{ amplitude = 1, wavelength = 1 }] }";
    assert!(read(&field(&format!("cells = [2, 2]\n{waves}"))).is_ok());
    assert!(read(&field(&format!("cells = [2, 2]\n{noise}"))).is_ok());
    assert!(read(&field("image = \"a.png\"\nheight = [0, 0.1]")).is_ok());
    expect(
        &field("cells = [2, 2]").replace("[[surface]]\nname = \"s\"", "«[[surface]]\nname = \"s\""),
        Kind::Missing,
        "a heightfield without `waves`",
        "waves = [{ ... }], or noise = { ... }, or image = \"file.png\"",
    );
    expect(
        &field(waves).replace("[[surface]]\nname = \"s\"", "«[[surface]]\nname = \"s\""),
        Kind::Missing,
        "a heightfield without `cells`",
        &format!("cells = {CELLS}"),
    );
    expect(
        &field(&format!("cells = [2, 2]\n{waves}\n{}", noise.replace("= {", "= «{"))),
        Kind::Range,
        "noise = { amplitude = 0.1, octaves = [{ amplitud...",
        "one of waves, noise and image, not several",
    );
    expect(&field(&format!("cells = «[4096, 1025]\n{waves}")), Kind::Limit, "cells = [4096, 1025]", CELLS);
    for (keys, expected) in [("", None), ("cells = [2, 3]", Some([2, 3]))] {
        let scene = read(&field(&format!("image = \"a.png\"\nheight = [0, 1]\n{keys}"))).unwrap();
        let ShapeDescription::Heightfield(image) = &scene.surfaces[1].shape else { panic!("a heightfield") };
        let ReliefDescription::Image { cells, file, height } = &image.relief else { panic!("an image") };
        assert_eq!((*cells, file.value.as_str(), *height), (expected, "a.png", [0.0, 1.0]));
    }
    expect(
        &field("image = \"a.png\"").replace("[[surface]]\nname = \"s\"", "«[[surface]]\nname = \"s\""),
        Kind::Missing,
        "a heightfield without `height`",
        "height = [height of black, height of white] in metres",
    );
    expect(
        &field(&format!("cells = [2, 2]\nheight = «[0, 1]\n{waves}")),
        Kind::Range,
        "height = [0, 1]",
        "no height: it belongs to an image",
    );
    let with = |body: &str| field(&format!("cells = [2, 2]\n{body}"));
    expect(&with("waves = [{ amplitude = 0.1, wavelength = «0 }]"), Kind::Range, "wavelength = 0", LENGTH);
    let error = expect(
        &with("waves = [{ amplitude = 0.1, wavelength = 1, «phase = 0 }]"),
        Kind::Unknown,
        "the unknown key `phase` in a wave",
        "amplitude, wavelength, direction_deg or phase_deg",
    );
    assert_eq!(error.advice(), Some("did you mean `phase_deg`?"));
    let list = "a list of 1 to 256 waves { amplitude, wavelength, direction_deg, phase_deg }";
    expect(&with("waves = «[]"), Kind::Limit, "0 waves tables", list);
    expect(&with("waves = [«3]"), Kind::Syntax, "waves[0] = 3", list);
    expect(
        &with("noise = { seed = «-1, amplitude = 1, octaves = [{ amplitude = 1, wavelength = 1 }] }"),
        Kind::Range,
        "seed = -1",
        "a whole number from 0 to 2^64 - 1",
    );
    expect(
        &with("noise = { amplitude = 1, octaves = «[{ amplitude = 0, wavelength = 1 }] }"),
        Kind::Range,
        "octaves = [{ amplitude = 0, wavelength = 1 }]",
        "at least one octave of an amplitude above 0",
    );
    expect(
        &with("noise = «{ amplitude = 1 }"),
        Kind::Missing,
        "noise without `octaves`",
        "octaves = a list of 1 to 32 octaves { amplitude, wavelength }",
    );
}

#[test]
fn run() {
    let good = format!("{LAMP}{BLACK}{PLATE}{RECEIVER}[run]\n");
    for (text, photons) in
        [("\"2^22\"", 1 << 22), ("4.5e6", 4_500_000), ("4_456_448", 4_456_448), ("0x10", 16)]
    {
        let scene = read(&format!("{good}photons = {text}\nseed = 7\nreplicates = 4\n")).unwrap();
        assert_eq!(scene.run.photons.unwrap().value, photons);
        assert_eq!(scene.run.seed.unwrap().value, 7);
        assert_eq!(scene.run.replicates.unwrap().value, 4);
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

#[test]
fn receivers_together_have_a_cap_on_their_cells() {
    let one =
        |name: &str| format!("[[receiver]]\nname = \"{name}\"\nsurface = \"plate\"\ncells = [8192, 4096]\n");
    assert!(read(&receiver(&(one("a") + &one("b")))).is_ok(), "2^26 cells in two");
    expect(
        &receiver(&(one("a") + &one("b") + &one("c").replace("[[", "«[["))),
        Kind::Limit,
        "the receiver `c`, with which there are 100663296 cells",
        "at most 2^26 cells in all receivers of a scene",
    );
}

#[test]
fn heightfields_together_have_a_cap_on_their_cells() {
    let field = |i: usize| {
        format!(
            "[[surface]]\nname = \"f{i}\"\nmaterial = \"black\"\ntype = \"heightfield\"\norigin = [0, 0, 1]\n\
             size = [1, 1]\ncells = [2048, 2048]\nfacing = \"up\"\nwaves = [{{ amplitude = 0.1, wavelength = 1, direction_deg = 0, phase_deg = 0 }}]\n"
        )
    };
    let four: String = (0..4).map(field).collect();
    assert_eq!(
        read(&receiver(&format!("{RECEIVER}{four}"))).unwrap().surfaces.len(),
        5,
        "2^24 cells in four"
    );
    expect(
        &receiver(&format!("{RECEIVER}{four}{}", field(4).replace("[[", "«[["))),
        Kind::Limit,
        "the heightfield `f4`, with which there are 20971520 cells",
        "at most 2^24 cells in all heightfields of a scene",
    );
}

#[test]
fn receiver_names_fit_into_a_file_name() {
    let named = |lamps: usize| {
        let name = "灯".repeat(lamps);
        read(&receiver(&format!("[[receiver]]\nname = \"{name}\"\nsurface = \"plate\"")))
    };
    assert!(named(66).is_ok(), "198 bytes");
    let errors = named(67).unwrap_err();
    assert!(errors[0].required().contains("at most 200 bytes"), "{}", errors[0]);
}
