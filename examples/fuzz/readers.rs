//! What reads damaged files, and what must hold of what it says.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use caustix::error::Diagnostic;
use caustix::files::bytes::Base;
use caustix::files::folder::Folder;
use caustix::files::obj::{ObjOptions, parse_obj};
use caustix::files::parts::{Found, Parts};
use caustix::files::scene_toml::{self, SceneFile, count::parse_count};
use caustix::files::{bsdf, height_image, photometric, photon_map};
use caustix::photometry::Summary;
use caustix::picture::check_saved;
use caustix::scene::Scene;
use sha2::{Digest, Sha256};

use crate::corpus;
use crate::mutate::with_checksums;
use crate::random::Generator;

/// Reads a damaged file; whether it was read.
type Run = Box<dyn Fn(Vec<u8>, &mut Generator) -> bool>;

/// A reader: its name, its share of all cases (of 1000), good files, bytes that it may have in use at a time for an input of so many.
pub struct Reader {
    pub name: &'static str,
    pub share: u64,
    pub corpus: Vec<Vec<u8>>,
    pub most_bytes: fn(usize) -> usize,
    pub run: Run,
}

const MIB: usize = 1 << 20;

/// Texts: so much a byte, beside what every one takes.
const A_TEXT: fn(usize) -> usize = |length| 4 * MIB + 512 * length;
/// A picture may have 2^26 pixels of eight bytes, of which heights of eight are made (docs/SECURITY.md).
const A_PICTURE: fn(usize) -> usize = |length| (24 << 26) + length;
/// A table may have 2^26 values, which are unfolded from a copy.
const A_TABLE: fn(usize) -> usize = |length| (16 << 26) + 512 * length;

/// All of them; those that need files have them in this folder.
pub fn all(folder: &Path) -> Vec<Reader> {
    let of = |name, share, corpus, most_bytes, run: Run| Reader { name, share, corpus, most_bytes, run };
    let table = |name: &'static str| -> Run { Box::new(move |bytes, _| is_read(bsdf::parse(&bytes, name))) };
    let lamp = corpus::own("ies/spot.ies");
    let lamp = String::from_utf8(lamp).expect("text").replace("TILT=NONE", "TILT=lamp.tlt");
    vec![
        of(
            "LM-63",
            200,
            corpus::lamps(),
            A_TEXT,
            Box::new(|bytes, _| photometry(&bytes, corpus::TILT.as_bytes())),
        ),
        of(
            "EULUMDAT",
            80,
            corpus::eulumdats(),
            A_TEXT,
            Box::new(|bytes, _| photometry(&bytes, corpus::TILT.as_bytes())),
        ),
        of(
            "tilt file",
            40,
            vec![corpus::TILT.into()],
            A_TEXT,
            Box::new(move |bytes, _| photometry(lamp.as_bytes(), &bytes)),
        ),
        of("BSDF text", 100, corpus::texts(), A_TABLE, table("a.scatter")),
        of("Zemax", 100, corpus::zemaxes(), A_TABLE, table("a.bsdf")),
        of("Klems XML", 80, vec![corpus::WINDOW.into()], A_TABLE, table("a.xml")),
        of("MERL head", 10, vec![merl(64)], A_TABLE, table("a.binary")),
        of(
            "OBJ",
            130,
            corpus::meshes(),
            A_TEXT,
            Box::new(|bytes, _| is_read(parse_obj(&bytes, Path::new("a.obj"), &ObjOptions::default()))),
        ),
        of("PNG", 80, corpus::pictures(), A_PICTURE, Box::new(picture)),
        of("photon map", 60, corpus::photons(), A_TEXT, photons()),
        of(
            "scene",
            120,
            corpus::scenes(),
            |length| 16 * MIB + 4096 * length,
            Box::new(|bytes, _| scene_text(&bytes)),
        ),
        of("scene, built", 20, vec![corpus::SCENE.into()], |_| 4096 * MIB, built(folder, "scene.toml")),
        of(
            "scene's lamp",
            10,
            [corpus::lamps(), corpus::eulumdats()].concat(),
            |_| 1024 * MIB,
            built(folder, "lamp.ies"),
        ),
        of(
            "scene's table",
            10,
            vec![corpus::texts()[0].clone()],
            |_| 1024 * MIB,
            built(folder, "opal.scatter"),
        ),
        of("scene's mesh", 10, corpus::meshes(), |_| 1024 * MIB, built(folder, "sheet.obj")),
        of("scene's picture", 5, corpus::pictures(), |_| 4096 * MIB, built(folder, "hills.png")),
        of("part of a study", 5, vec![part(folder)], A_TEXT, Box::new(study(folder))),
        of("list of results", 5, vec![corpus::LIST.into()], A_TEXT, Box::new(results(folder))),
        of(
            "count",
            15,
            vec![b"4_456_448".into(), b"4.5e6".into(), b"2^22".into()],
            A_TEXT,
            Box::new(|bytes, _| is_read(parse_count(&String::from_utf8_lossy(&bytes)))),
        ),
    ]
}

/// The one whole MERL file and its like: 35 MB each, so only few of them.
pub fn whole_merl() -> Reader {
    let run: Run = Box::new(|bytes, _| is_read(bsdf::parse(&bytes, "a.binary")));
    Reader { name: "MERL", share: 0, corpus: vec![merl(3 * 8 * 90 * 90 * 180)], most_bytes: A_TABLE, run }
}

/// What is said of a file must be short, and must be text.
fn told(diagnostic: &Diagnostic) {
    let text = diagnostic.to_string();
    assert!(text.chars().count() < 1200, "a message of {} characters: {text:.300}", text.len());
    assert!(!text.contains(char::is_control), "control characters in {text:?}");
    assert!(!diagnostic.found().is_empty() && !diagnostic.required().is_empty(), "{diagnostic:?}");
}

fn is_read<T>(read: Result<T, Diagnostic>) -> bool {
    read.map_err(|e| told(&e)).is_ok()
}

fn photometry(bytes: &[u8], tilt: &[u8]) -> bool {
    let read = photometric::parse_with(bytes, "lamp.ies", None, &mut |_| Ok(Rc::from(tilt)));
    if let Ok(photometry) = &read {
        photometry.warnings.iter().for_each(told);
        let summary = Summary::new(photometry);
        assert!(summary.flux_lm >= 0.0 && summary.flux_lm.is_finite(), "{}", summary.flux_lm);
    }
    is_read(read)
}

fn picture(mut bytes: Vec<u8>, random: &mut Generator) -> bool {
    if random.below(4) > 0 {
        with_checksums(&mut bytes);
    }
    let size = height_image::size(&bytes);
    height_image::has_8_bits(&bytes);
    let read = height_image::parse(&bytes, [0.0, 1.0]);
    if let (Ok(image), Ok([columns, rows])) = (&read, &size) {
        assert_eq!(image.size().map(|n| n as u64), [*columns, *rows]);
    }
    is_read(read)
}

fn photons() -> Run {
    let scene: Scene = scene_toml::parse_scene(&corpus::scene_without_files(), "").expect("a scene");
    Box::new(move |mut bytes, random| {
        if random.below(4) > 0 && bytes.len() > 32 {
            let body = bytes.len() - 32;
            let digest = Sha256::digest(&bytes[..body]);
            bytes[body..].copy_from_slice(&digest);
        }
        let channels = photon_map::channels(&bytes);
        let grey = photon_map::read::<1>(&bytes, corpus::HASH);
        let rgb = photon_map::read::<3>(&bytes, corpus::HASH);
        assert!(channels.is_ok() || (grey.is_err() && rgb.is_err()));
        let is_grey = is_read(grey.and_then(|map| check_saved(&scene, &map.in_channels::<3>())));
        is_read(rgb.and_then(|map| check_saved(&scene, &map))) || is_grey
    })
}

fn are_told<T>(read: Result<T, Vec<Diagnostic>>) -> Option<T> {
    read.map_err(|errors| {
        assert!((1..=5000).contains(&errors.len()), "{} errors", errors.len());
        errors.iter().for_each(told);
    })
    .ok()
}

fn scene_text(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    are_told(scene_toml::parse(&text, "scene.toml", Base::BuiltIn)).is_some()
}

/// The scene of all kinds of files, one of which is damaged; so are its bodies and lamps, since all of it is built.
fn built(folder: &Path, damaged: &'static str) -> Run {
    let folder = folder.join(damaged.replace('.', "-"));
    fs::create_dir_all(&folder).expect("a folder");
    let files: [(&str, Vec<u8>); 5] = [
        ("scene.toml", corpus::SCENE.into()),
        ("lamp.ies", corpus::own("ies/spot.ies")),
        ("opal.scatter", corpus::texts()[0].clone()),
        ("sheet.obj", b"v -.1 -.1 0\nv .1 -.1 0\nv .1 .1 0\nf 1 2 3\n".to_vec()),
        ("hills.png", corpus::pictures()[0].clone()),
    ];
    for (name, bytes) in files {
        fs::write(folder.join(name), bytes).expect("a file");
    }
    Box::new(move |mut bytes, random| {
        if damaged == "hills.png" && random.below(4) > 0 {
            with_checksums(&mut bytes);
        }
        fs::write(folder.join(damaged), bytes).expect("a file");
        let read = scene_toml::read_confined(folder.join("scene.toml"));
        let scene = are_told(read.and_then(SceneFile::build));
        if let Some(scene) = &scene {
            scene.warnings.iter().for_each(told);
        }
        scene.is_some()
    })
}

/// The first bytes of a MERL file.
fn merl(length: usize) -> Vec<u8> {
    let head: Vec<u8> = [90u32, 90, 180].into_iter().flat_map(u32::to_le_bytes).collect();
    let value = 150.0f64.to_le_bytes();
    head.into_iter().chain(value.into_iter().cycle().take(length)).collect()
}

const KEY: &str = "caustix, a scene, a run";

fn part_path(folder: &Path) -> PathBuf {
    let parts = folder.join("parts");
    let first = || fs::read_dir(&parts).ok()?.flatten().next().map(|entry| entry.path());
    first().expect("a part")
}

fn part(folder: &Path) -> Vec<u8> {
    Parts::new(folder.join("parts")).store("run", KEY, b"[1.5, 2.5]").expect("a part");
    fs::read(part_path(folder)).expect("a part")
}

fn study(folder: &Path) -> impl Fn(Vec<u8>, &mut Generator) -> bool + use<> {
    let (parts, path) = (Parts::new(folder.join("parts")), part_path(folder));
    move |bytes, _| {
        fs::write(&path, bytes).expect("a part");
        match parts.load("run", KEY) {
            Found::Whole(content) => {
                assert_eq!(content, b"[1.5, 2.5]");
                true
            }
            Found::Missing => false,
            Found::Damaged(diagnostic) => {
                told(&diagnostic);
                false
            }
        }
    }
}

fn results(folder: &Path) -> impl Fn(Vec<u8>, &mut Generator) -> bool + use<> {
    let path = folder.join("out");
    let taken = Cell::new(Some(Folder::take(&path, "a folder").expect("a folder")));
    fs::write(path.join("floor.exr"), "").expect("a file");
    move |bytes, _| {
        fs::write(path.join("report.json"), bytes).expect("a file");
        let folder = taken.take().expect("a folder");
        let others = folder.others(&BTreeSet::new(), &[]);
        taken.set(Some(folder));
        others.is_empty()
    }
}
