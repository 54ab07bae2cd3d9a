//! Files in the wrong place and requests that nobody can meet: what to type instead.

use std::fs;

use crate::absorber::SCENE;
use crate::support::data::in_project;
use crate::support::stranger::Stranger;

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const LDT: &str = "maker\r\n1\r\n1\r\n19\r\n10\r\n19\r\n5\r\nr\r\n";

/// A folder with a file of each kind, under names that say nothing.
fn with_files() -> Stranger {
    let s = Stranger::with(&[("plate.toml", SCENE), ("a.obj", OBJ), ("a.ldt", LDT)]);
    s.write("lamp.ies", fs::read(in_project("ies/spot.ies")).unwrap());
    s.write("table", fs::read(in_project("brdf_tables/phong.scatter")).unwrap());
    s.write("scene", SCENE);
    s.write("photons", b"caustixM\x01\0\0\0");
    s.write("map", b"\x76\x2f\x31\x01\0\0");
    s.write("page", "<!DOCTYPE html>\n<html>\n");
    s.write("empty", "");
    s.write("my scene.toml", SCENE);
    fs::create_dir(s.path("folder")).unwrap();
    s.write("folder/b.toml", SCENE);
    s.write("folder/a.toml", SCENE);
    fs::create_dir(s.path("bare")).unwrap();
    s
}

#[test]
fn a_file_in_place_of_a_command_is_answered_with_what_to_type() {
    let s = with_files();
    for (line, what, advice) in [
        ("plate.toml", "a scene", "type `caustix render plate.toml`"),
        ("scene", "a scene", "type `caustix render scene`"),
        ("lamp.ies", "an IES photometric file", "type `caustix photometry lamp.ies`"),
        ("table", "a scattering table", "type `caustix bsdf table`"),
        ("photons", "a photon map", "type `caustix render SCENE.toml --map photons`"),
        ("a.obj", "a mesh (OBJ)", "the `file` of a [[surface]] of type \"mesh\""),
        ("a.ldt", "an EULUMDAT file (.ldt)", "type `caustix photometry a.ldt`"),
        ("map", "an EXR picture", "viewers of EXR open it"),
        ("page", "a web page (HTML)", "download the file it links to"),
        ("empty", "an empty file", "was it saved"),
        ("folder", "a folder", "`caustix render folder/a.toml` renders the first of 2 scenes in it"),
        ("bare", "a folder", "there is no scene (.toml) in it"),
        ("gone.toml", "no command, and no file of this name", "a command before the file"),
        ("plate.toml --photons 64", "a scene", "type `caustix render plate.toml`"),
    ] {
        let (code, out, err) = s.types(line);
        let name = line.split(' ').next().unwrap();
        assert_eq!((code, out.as_str()), (2, ""), "{line}");
        assert!(
            err.starts_with(&format!("error: {name}: found {what}")) && err.contains(advice),
            "{line}\n{err}"
        );
    }
    let spaced = s.command("").arg("my scene.toml").output().unwrap();
    let err = String::from_utf8(spaced.stderr).unwrap();
    assert!(err.contains("`caustix render 'my scene.toml'`"), "{err}");
    // A word that is no file is what clap says of it.
    s.is_told("rander", 2, &["unrecognized subcommand 'rander'", "'render'"]);
    // What was advised is done.
    assert_eq!(s.types("check scene").0, 0);
    assert_eq!(s.types("bsdf table").0, 0);
}

#[test]
fn a_file_of_another_kind_is_named_by_every_command() {
    let s = with_files();
    for (line, what, advice) in [
        ("render lamp.ies", "an IES photometric file", "`caustix photometry lamp.ies`"),
        ("check a.obj", "a mesh (OBJ)", "[[surface]]"),
        ("compare table", "a scattering table", "`caustix bsdf table`"),
        ("render photons", "a photon map", "--map photons"),
        ("render empty", "an empty file", "was it saved"),
        ("render folder", "a folder", "`caustix render folder/a.toml`"),
        ("photometry plate.toml", "a scene", "`caustix render plate.toml`"),
        ("photometry a.ldt", "the end of the file", "a line: the name of the luminaire"),
        (
            "photometry lamp.ies --lamp-set 2",
            "lamp set 2 of an IES LM-63 file",
            "no choice: LM-63 has no lamp sets",
        ),
        ("render a.ldt", "an EULUMDAT file", "`caustix photometry a.ldt`"),
        ("photometry page", "a web page (HTML)", "download"),
        ("photometry table", "a scattering table", "`caustix bsdf table`"),
        ("sample a.obj -n 8", "a mesh (OBJ)", "[[surface]]"),
        ("bsdf lamp.ies", "an IES photometric file", "`caustix photometry lamp.ies`"),
        ("bsdf map", "an EXR picture", "viewers"),
    ] {
        s.is_told(line, 1, &["error: ", ": found ", what, "; required: ", advice]);
        assert_eq!(s.types(line).2.lines().count(), 1, "{line}");
    }
    // In a scene, too: whatever reads the file.
    let seen = format!(
        "{SCENE}[camera]\nposition = [0, -3, 2]\nlook_at = [0, 0, 0]\nfov_deg = 40\npixels = [4, 4]\n"
    );
    s.write("seen.toml", seen);
    s.is_told(
        "render seen.toml --map map",
        1,
        &["map:1:1: found an EXR picture", "a photon map that caustix saved"],
    );
    let height = "[[surface]]\nname = \"relief\"\ntype = \"heightfield\"\nmaterial = \"black\"\norigin = [0, 0, 3]\n\
                  size = [1, 1]\nfacing = \"up\"\nheight = [0, 1]\nimage = \"FILE\"\n";
    let mesh = "[[surface]]\nname = \"body\"\ntype = \"mesh\"\nmaterial = \"black\"\nfile = \"FILE\"\n";
    let table = "[material.coat]\ntype = \"tabulated\"\nfile = \"FILE\"\n";
    s.write("a.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF");
    s.write("a.tif", b"II*\0\x08\0\0\0");
    s.write("a.webp", b"RIFF\x10\0\0\0WEBPVP8 ");
    s.write("a.bmp", b"BM\x46\0\0\0\0\0\0\0\x36\0\0\0");
    s.write("a.step", "ISO-10303-21;\n");
    s.write("a.gltf", "{\"asset\": {\"version\": \"2.0\"}}");
    for (part, file, what, advice) in [
        (height, "a.jpg", "a JPEG picture", "PNG"),
        (height, "a.tif", "a TIFF picture", "PNG"),
        (height, "a.webp", "a WebP picture", "PNG"),
        (height, "a.bmp", "a BMP picture", "PNG"),
        (height, "map", "an EXR picture", "PNG of 16 bits"),
        (height, "lamp.ies", "an IES photometric file", "photometry"),
        (mesh, "a.step", "a STEP file", "FreeCAD"),
        (mesh, "a.gltf", "a glTF file", "Blender"),
        (mesh, "plate.toml", "a scene", "caustix render"),
        (table, "lamp.ies", "an IES photometric file", "[[emitter]]"),
        (table, "a.obj", "a mesh (OBJ)", "[[surface]]"),
    ] {
        s.write("with.toml", format!("{SCENE}{}", part.replace("FILE", file)));
        s.is_told("check with.toml", 1, &[&format!("error: {file}:1:1: found {what}"), advice]);
    }
}

#[test]
fn several_mistakes_are_counted_in_the_first_line() {
    let s = Stranger::new();
    s.write("one.toml", SCENE.replace("flux_lm = 100", "flux_lm = -1"));
    s.write(
        "two.toml",
        SCENE.replace("flux_lm = 100", "flux_lm = -1").replace("cells = [4, 4]", "cells = 0"),
    );
    let (_, _, err) = s.types("render one.toml");
    assert!(
        err.starts_with("error: one.toml:5:11: found flux_lm = -1; required: ") && err.lines().count() == 1,
        "{err}"
    );
    for command in ["render", "check", "compare"] {
        let (code, _, err) = s.types(&format!("{command} two.toml"));
        let lines: Vec<&str> = err.lines().collect();
        assert_eq!(
            (code, lines.len(), lines[0]),
            (1, 3, "error: two.toml cannot be rendered: 2 mistakes"),
            "{err}"
        );
        assert!(
            lines[1].starts_with("error: two.toml:5:11: ") && lines[2].starts_with("error: two.toml:17:9: "),
            "{err}"
        );
    }
    // Of a file that is full of them the count is a bound.
    s.write(
        "many.toml",
        "[a]\n".to_string() + &(0..150).map(|i| format!("[[surface]]\nkey{i} = 1\n")).collect::<String>(),
    );
    let (_, _, err) = s.types("check many.toml");
    assert!(err.starts_with("error: many.toml cannot be rendered: more than 100 mistakes\n"), "{err}");
    // For programs there is nothing but the JSON.
    assert_eq!(s.types("check two.toml --json").2, "");
}

#[test]
fn requests_that_cannot_be_met_say_what_is_meant() {
    let s = with_files();
    s.write("afile", "");
    for (line, code, told) in [
        ("render plate.toml --photons 4M", 1, "(hint: write 4e6)"),
        ("render plate.toml --photons 1,000,000", 1, "(hint: write 1_000_000)"),
        ("sample lamp.ies -n 1M", 1, "(hint: write 1e6)"),
        ("render plate.toml --variant qcm", 1, "did you mean `qmc`?"),
        ("render plate.toml --variant sobol", 1, "`--sequence sobol`"),
        ("render plate.toml --sequence haltom", 1, "did you mean `halton`?"),
        (
            "render plat.toml",
            1,
            "found no file `plat.toml`; required: a file that can be read (hint: did you mean `plate.toml`?)",
        ),
        ("photometry lmap.ies", 1, "did you mean `lamp.ies`?"),
        ("photometry no/lamp.ies", 1, "there is no folder `no`"),
        ("photometry folder", 1, "which is a folder"),
        ("render plate.toml -o afile", 1, "afile: found a file where a folder is to be made"),
        ("render plate.toml -o afile/out", 1, "found a file `afile` where a folder is to be made"),
        ("photometry lamp.ies --plot no/x.svg", 1, "found no folder `no`"),
        ("check plate.toml --photons 10", 2, "tip: `caustix render` has --photons"),
        ("render plate.toml --photons 1 000", 2, "tip: names and numbers with spaces stand in quotes"),
        ("bsdf table lamp.ies", 2, "tip: one file is read at a time"),
        ("photometry lamp.ies table", 1, "`caustix bsdf table`"),
        ("compare plate.toml --cells x", 2, "required: a whole number from 1 to 4096"),
        ("compare plate.toml --variants mc;qmc", 1, "variants are parted by commas"),
    ] {
        s.is_told(line, code, &["error: ", told]);
    }
    let lamp = SCENE.replace("\"isotropic\"", "\"photometric\"\nfile = \"FILE\"");
    for (file, told) in [
        ("lmap.ies", "did you mean `lamp.ies`? paths are relative to the folder of the scene file"),
        ("~/lamp.ies", "`~` stands for nothing here"),
        ("https://example.org/lamp.ies", "download it"),
        (".", "found `.`, which is a folder"),
    ] {
        s.write("with.toml", lamp.replace("FILE", file));
        s.is_told("check with.toml", 1, &["error: with.toml:4:8: found ", told]);
    }
}
