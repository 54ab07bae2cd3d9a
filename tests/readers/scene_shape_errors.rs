//! Every rule of the surfaces and receivers of a scene, broken once: place, kind, found, required and hint of the message.

use caustix::error::Kind;
use caustix::files::scene_toml::SceneFile;
use caustix::scene::receiver::Cells;

use crate::broken_scene::{BLACK, LAMP, LENGTH, PLATE, RECEIVER, expect, read, receiver, surface};

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
        assert_eq!(read(&text).unwrap().build().unwrap().receivers[0].name, good);
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
    let most = read(&on_plate("cells = [8192, 8192]")).unwrap().build().unwrap();
    assert_eq!(most.receivers[0].cells, Cells::Grid { nu: 8192, nv: 8192 });
    let error =
        expect(&on_plate("side = «\"fornt\""), Kind::Unknown, "side = \"fornt\"", "front, back or both");
    assert_eq!(error.advice(), Some("did you mean \"front\"?"));
    expect(&on_plate("side = «2"), Kind::Unknown, "side = 2", "front, back or both");
    let error =
        expect(&on_plate("events = «\"in\""), Kind::Unknown, "events = \"in\"", "all, direct or indirect");
    assert_eq!(error.advice(), Some("did you mean \"indirect\"?"));
    let on_box =
        surface("type = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]") + "[[receiver]]\nsurface = \"s\"\n";
    let faces = read(&on_box.replace("[0, 0, 0]\nmax", "[0, 0, 0.5]\nmax")).unwrap().build().unwrap();
    assert_eq!(faces.receivers[1].cells, Cells::Faces { count: 12 });
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
    const RIGHT: &str = "an edge perpendicular to edge_u";
    const EDGE: &str = "an edge [x, y, z] with a length from 1e-9 to 1e9 m";
    expect(&rectangle("«[0, 0, 0]", "[0, 1, 0]", ""), Kind::Geometry, "edge_u = [0, 0, 0]", EDGE);
    expect(&rectangle("[1, 0, 0]", "«[-2, 0, 0]", ""), Kind::Geometry, "edge_v = [-2, 0, 0]", RIGHT);

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
        "name, material, scale, rotate_deg, translate, contact, priority, type, center or radius",
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
fn receivers_together_have_a_cap_on_their_cells() {
    let one =
        |name: &str| format!("[[receiver]]\nname = \"{name}\"\nsurface = \"plate\"\ncells = [8192, 4096]\n");
    assert!(read(&receiver(&(one("a") + &one("b")))).and_then(SceneFile::build).is_ok(), "2^26 cells in two");
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
    assert!(read(&receiver(&format!("{RECEIVER}{four}"))).is_ok(), "2^24 cells in four");
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
