//! Damaged scene files: a description or diagnostics, never a panic, and never without a place to look at.

use caustix::files::bytes::Base;
use caustix::files::scene_toml::document::MOST_ERRORS;
use caustix::files::scene_toml::parse;

use crate::support::random::Generator;

const SCENES: [(&str, &str); 6] = [
    ("wavy_glass", include_str!("../../scenes/wavy_glass.toml")),
    ("pool", include_str!("../../scenes/pool.toml")),
    ("ball_lens", include_str!("../../scenes/ball_lens.toml")),
    ("flat_slab", include_str!("../../scenes/flat_slab.toml")),
    ("reflector", include_str!("../../scenes/reflector.toml")),
    ("prism", include_str!("../../scenes/prism.toml")),
];

/// Fragments that mean something to TOML or to a scene.
const TOKENS: [&str; 40] = [
    "nan",
    "-inf",
    "1e999",
    "-0.0",
    "0x7fffffffffffffff",
    "99999999999999999999",
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    "\"",
    "'''",
    "\"\"\"",
    "=",
    ".",
    ",",
    "#",
    "\n",
    "\r",
    "\0",
    "\u{feff}",
    "ß",
    "true",
    "[[emitter]]",
    "[material]",
    "[material.glass]",
    "[[material.glass]]",
    "[camera]",
    "[run]",
    "photons = \"2^22\"\n",
    "emitter = 3\n",
    "surface.name = 1\n",
    "noise = {}\n",
    "cells = [0, 0]\n",
    "up = [0,0,1]\n",
    "1979-05-27T07:32:00Z",
    "type = \"panel\"\n",
    "\\u0000",
];

/// Read it; every error must say where, what and what instead. Returns whether the scene is good.
fn check(text: &str) -> bool {
    match parse(text, "damaged.toml", Base::BuiltIn) {
        Ok(_) => true,
        Err(errors) => {
            assert!(!errors.is_empty() && errors.len() <= MOST_ERRORS + 1);
            let lines = text.bytes().filter(|b| *b == b'\n').count() + 1;
            for error in &errors {
                assert!(!error.found().is_empty() && !error.required().is_empty(), "{error:?}");
                assert!(error.found().chars().count() < 400, "{error}");
                assert!(error.line().is_none_or(|line| (1..=lines).contains(&line)), "{error}");
                assert_eq!(error.file(), Some("damaged.toml"));
            }
            assert!(errors[0].line().is_some() && errors[0].column().is_some(), "{:?}", errors[0]);
            false
        }
    }
}

#[test]
fn every_truncation() {
    for (name, text) in SCENES {
        assert!(check(text), "{name} itself is good");
        let mut refused = 0;
        for end in 0..text.len() {
            if let Some(part) = text.get(..end) {
                refused += usize::from(!check(part));
            }
        }
        println!("{name}: {refused} of {} truncations refused", text.len());
        assert!(refused > text.len() / 4, "{name}");
    }
}

#[test]
fn thousands_of_mutations() {
    let mut random = Generator(20_260_101);
    let (mut good, mut bad) = (0, 0);
    for round in 0..6000 {
        let (_, text) = SCENES[round % SCENES.len()];
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..=random.below(4) {
            let at = random.below(bytes.len());
            match random.below(6) {
                0 => bytes[at] = random.next() as u8,
                1 => bytes[at] ^= 1 << random.below(7),
                2 => {
                    let end = (at + 1 + random.below(30)).min(bytes.len());
                    bytes.drain(at..end);
                }
                3 => {
                    let token = TOKENS[random.below(TOKENS.len())];
                    bytes.splice(at..at, token.bytes());
                }
                4 => {
                    let from = random.below(bytes.len());
                    let end = (from + random.below(200)).min(bytes.len());
                    let piece = bytes[from..end].to_vec();
                    bytes.splice(at..at, piece);
                }
                _ => {
                    // A token in the place of a whole value.
                    let start = bytes[at..].iter().position(|b| *b == b'=').map_or(at, |i| at + i + 1);
                    let end = bytes[start..].iter().position(|b| *b == b'\n').map_or(start, |i| start + i);
                    bytes.splice(start..end, TOKENS[random.below(TOKENS.len())].bytes());
                }
            }
            if bytes.is_empty() {
                bytes.push(b'x');
            }
        }
        match check(&String::from_utf8_lossy(&bytes)) {
            true => good += 1,
            false => bad += 1,
        }
    }
    println!("{good} mutated scenes read, {bad} refused");
    assert!(good > 100 && bad > 3000, "{good} {bad}");
}

#[test]
fn hostile_sizes_are_refused_quickly() {
    for text in [
        "[".repeat(1 << 20),
        "a = ".to_string() + &"[".repeat(1 << 20),
        "a.".repeat(1 << 18) + "b = 1",
        "a = {".repeat(1 << 18),
        format!("[[emitter]]\ntype = \"{}\"", "x".repeat(1 << 20)),
        format!("[[emitter]]\n{} = 1", "x".repeat(1 << 20)),
        "[[emitter]]\n".repeat(100_000),
        (0..100_000).map(|i| format!("k{i} = 1\n")).collect(),
        (0..4096).map(|i| format!("[[receiver]]\nsurface = \"{i}\"\n")).collect(),
        "=\n".repeat(1 << 18),
        "=\n".repeat(1 << 22),
        "\n".repeat(1 << 20),
        "x".repeat((16 << 20) + 1),
    ] {
        let start = std::time::Instant::now();
        let result = parse(&text, "hostile.toml", Base::BuiltIn);
        assert!(result.is_err());
        assert!(start.elapsed().as_secs() < 60, "{} bytes took {:?}", text.len(), start.elapsed());
        println!("{:>9} bytes, {:?}...: {:?}", text.len(), &text[..text.len().min(16)], start.elapsed());
    }
}
