//! Damaged photometric files: a result or a diagnostic, never a panic, a hang or memory beyond the file's size.

use caustix::files::photometric;
use caustix::photometry::Summary;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::damage::Damage;
use crate::support::data;
use crate::support::random::Generator;

/// Reads bytes and, if they are read, asks everything a program would ask; true if they were read.
pub fn survives(bytes: &[u8]) -> bool {
    match photometric::parse(bytes, "damaged.ies") {
        Ok(photometry) => {
            let summary = Summary::new(&photometry);
            let all =
                [summary.flux_lm, summary.flux_with_factors_lm, summary.flux_emitted_lm, summary.max_candela];
            assert!(all.iter().all(|x| x.is_finite() && *x >= 0.0), "{all:?}");
            for (v, h) in [(0.0, 0.0), (90.0, 359.999), (-12.5, -90.0), (180.0, 1e9), (f64::NAN, f64::NAN)] {
                assert!(photometry.web.intensity_cd(v, h) >= 0.0);
            }
            let text = caustix::report::photometry::text(&photometry, &summary, None);
            assert!(text.contains("flux"));
            true
        }
        Err(error) => {
            assert!(error.line().is_some() && error.column().is_some(), "no place: {error}");
            assert!(error.to_string().len() < 1000, "a message, not the file: {error}");
            false
        }
    }
}

/// The project's own files, and real ones where they are at hand.
fn files() -> Vec<PathBuf> {
    let names = ["spot.ies", "pool_lamp.ies", "wall_washer_1991.ies", "headlamp_a.ies", "panel_2019.ies"];
    let mut list: Vec<PathBuf> = names.iter().map(|name| data::own_file(name)).collect();
    if let Some(folder) = data::real_folder() {
        let names = [
            "permissive/rp__star_focused.ies",
            "permissive/rp__defined_diffuse.ies",
            "permissive/mdl__test.ies",
            "copyleft/eurs__TILT_TEST_SYNTHETIC.ies",
            "derived/rp__pear__commas.ies",
            "no-licence/acuity__ELM2_LED.ies",
        ];
        list.extend(names.iter().map(|name| folder.join("ies").join(name)));
    }
    list
}

#[test]
fn every_truncation_is_a_result_or_a_diagnostic() {
    for path in files() {
        let bytes = std::fs::read(&path).unwrap();
        let (mut read, mut refused) = (0, 0);
        for length in 0..bytes.len() {
            if survives(&bytes[..length]) { read += 1 } else { refused += 1 }
        }
        println!("{}: {read} read, {refused} refused", path.display());
        // Whole numbers are cut off at most; what is read must be cut within the last one or behind it.
        assert!(refused > 0 && read <= 64, "{}: {read} truncations were read", path.display());
    }
}

/// What goes in where something else was.
const DAMAGE: Damage = Damage { tokens: &TOKENS, changes: 4, cut: 40 };
const TOKENS: [&str; 18] = [
    "nan",
    "-1",
    "0",
    "1e308",
    "-1e308",
    "1e-320",
    "2147483647",
    "99999",
    "99999 99999",
    ";",
    "TILT=",
    "\n",
    "\r",
    "\u{1a}",
    "360",
    "180",
    "1.5",
    "\0",
];

#[test]
fn thousands_of_mutations_are_results_or_diagnostics() {
    let mut generator = Generator(63);
    let (mut read, mut refused) = (0, 0);
    for path in files() {
        let bytes = std::fs::read(&path).unwrap();
        for _ in 0..3000 {
            if survives(&DAMAGE.mutate(&bytes, &mut generator)) { read += 1 } else { refused += 1 }
        }
    }
    println!("mutations: {read} read, {refused} refused");
    assert!(read > 1000 && refused > 1000, "the mutations reach both ends: {read}, {refused}");
}

#[test]
fn numbers_that_ask_for_memory_are_refused_at_once() {
    let start = Instant::now();
    for ten in [
        "1 -1 1 2147483647 2147483647 1 2 0 0 0",
        "1 -1 1 100000 100000 1 2 0 0 0",
        "1 -1 1 1e18 1 1 2 0 0 0",
        "1 -1 1 3 99999 1 2 0 0 0",
    ] {
        let text = format!("IESNA91\nTILT=NONE\n{ten}\n1 1 1\n{}", "0 ".repeat(100_000));
        assert!(!survives(text.as_bytes()), "{ten}");
    }
    assert!(!survives(b"IESNA91\nTILT=INCLUDE\n1 4294967295\n1 1 1"));
    let long = format!("IESNA91\nTILT=NONE\n{}", "9".repeat(4 << 20));
    assert!(!survives(long.as_bytes()));
    let labels = "[MORE] x\n".repeat(1 << 18);
    assert!(!survives(labels.as_bytes()));
    let labels = "x\n".repeat(1 << 20);
    assert!(!survives(format!("{labels}TILT=NONE\n").as_bytes()));
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}
