//! Coloured light: what emitters name, what photons carry, what receivers measure of it.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use caustix::error::{Diagnostic, Kind};
use caustix::files::bytes::Base;
use caustix::files::scene_toml::parse;
use caustix::run::{Estimate, Plan, Settings, trace};
use caustix::sample::method::Sampling;
use caustix::scene::Scene;
use caustix::scene::requires::requirements;
use caustix::sequence::owen::OwenPoints;
use caustix::surface::{Grey, Rgb, luminance};
use caustix::transport::parallel::{How, trace_range};
use caustix::transport::{Arrival, Sink};

/// Lamps in a closed sphere of this reflectance; the receiver is its inside.
fn text(lamps: &[&str], reflectance: &str, events: &str) -> String {
    let mut text = String::new();
    for (i, colour) in lamps.iter().enumerate() {
        let flux = 100 * (2 * i + 1);
        text += &format!("[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 0.{i}]\nflux_lm = {flux}\n");
        text += &format!("{colour}\n");
    }
    text + &format!(
        "[material.wall]\ntype = \"lambertian\"\nreflectance = {reflectance}\n[[surface]]\nname = \"room\"\n\
         type = \"sphere\"\nmaterial = \"wall\"\ncenter = [0, 0, 0]\nradius = 1\n[[receiver]]\nsurface = \"room\"\n\
         side = \"back\"\ncells = [8, 4]\nevents = \"{events}\"\n"
    )
}

fn scene(lamps: &[&str], reflectance: &str, events: &str) -> Scene {
    let text = text(lamps, reflectance, events);
    parse(&text, "test.toml", Base::Directory(".".into())).unwrap().build().unwrap()
}

fn flux(scene: &Scene) -> Estimate {
    let settings = Settings { photons: Some(1 << 15), replicates: Some(16), ..Settings::default() };
    let plan = Plan::new(&settings).unwrap();
    trace(scene, &plan, &AtomicBool::new(false), &|_| {}).unwrap().receiver_flux_lm(0)
}

#[test]
fn a_closed_sphere_adds_up_the_colour_s_own_reflections() {
    // Arrivals in all: the sum over k of Y(c rho^k) = Y(c / (1 - rho)), c of luminance 1.
    let rho = [0.6, 0.3, 0.1];
    let cases =
        [("colour = [1, 0, 0]", [1.0, 0.0, 0.0]), ("colour = [1, 2, 4]", [1.0, 2.0, 4.0]), ("", [1.0; 3])];
    // 3 tests at 0.1 % in all (Sidak) with 15 degrees of freedom.
    let limit = 4.6;
    for (lamp, c) in cases {
        let estimate = flux(&scene(&[lamp], "[0.6, 0.3, 0.1]", "all"));
        let sum: [f64; 3] = std::array::from_fn(|i| c[i] / (1.0 - rho[i]));
        let expected = 100.0 * luminance(sum) / luminance(c);
        let z = (estimate.value - expected) / estimate.standard_error.unwrap();
        println!("{lamp}: {} lm, {expected} expected, z = {z}", estimate.value);
        assert!(z.abs() < limit, "{lamp}: {} for {expected}", estimate.value);
    }
}

#[test]
fn red_light_leaves_a_green_wall_dark_and_any_colour_is_as_bright_on_grey() {
    assert_eq!(flux(&scene(&["colour = [1, 0, 0]"], "[0, 0.8, 0]", "indirect")).value, 0.0);
    let white = flux(&scene(&[""], "0.5", "all")).value;
    for lamp in ["colour = [1, 0, 0]", "cct_k = 3000", "colour = [0, 0, 5]"] {
        let coloured = flux(&scene(&[lamp], "0.5", "all")).value;
        // The same points and the same roulette, to the rounding of Y(w rho) / Y(w) against rho.
        assert!((coloured / white - 1.0).abs() < 1e-4, "{lamp}: {coloured} {white}");
    }
}

struct FirstWeights<'a>(&'a Mutex<Vec<[f64; 3]>>);

impl Sink<Rgb> for FirstWeights<'_> {
    fn arrive(&mut self, arrival: &Arrival<'_, Rgb>) {
        if arrival.events == 0 {
            self.0.lock().unwrap().push(arrival.carried.weight());
        }
    }
}

#[test]
fn each_photon_starts_with_its_own_emitter_s_colour() {
    let scene = scene(&["colour = [1, 0, 0]", "cct_k = 6500"], "0.0", "all");
    let colours = [scene.emitter_colour(0), scene.emitter_colour(1)];
    let weights = Mutex::new(Vec::new());
    let how = How {
        reuse: true,
        sampling: Sampling::default(),
        interrupt: &AtomicBool::new(false),
        progress: &|_| {},
    };
    trace_range(&scene, &scene.emitters, &OwenPoints::new(1, 0), 0..4096, Rgb::WHITE, how, || {
        FirstWeights(&weights)
    });
    let weights = weights.into_inner().unwrap();
    let count = |c: [f64; 3]| weights.iter().filter(|w| **w == c).count();
    // 100 lm against 300 lm: a net of 4096 points splits exactly, up to the point on the edge.
    assert!((1023..=1025).contains(&count(colours[0])), "{}", count(colours[0]));
    assert_eq!(count(colours[0]) + count(colours[1]), 4096);
}

struct Directions<'a>(&'a Mutex<Vec<[u64; 3]>>);

impl Sink<Grey> for Directions<'_> {
    fn arrive(&mut self, arrival: &Arrival<'_, Grey>) {
        self.0.lock().unwrap().push(arrival.direction.to_array().map(f64::to_bits));
    }
}

#[test]
fn a_walk_that_carries_no_colour_is_not_touched_by_it() {
    let arrivals = |lamp: &str| {
        let found = Mutex::new(Vec::new());
        let how = How {
            reuse: true,
            sampling: Sampling::default(),
            interrupt: &AtomicBool::new(false),
            progress: &|_| {},
        };
        let scene = scene(&[lamp], "0.5", "all");
        trace_range(&scene, &scene.emitters, &OwenPoints::new(1, 0), 0..512, Grey, how, || {
            Directions(&found)
        });
        let mut found = found.into_inner().unwrap();
        found.sort_unstable();
        found
    };
    assert_eq!(arrivals(""), arrivals("colour = [0, 0, 1]"));
}

#[test]
fn only_colour_that_is_not_white_makes_a_scene_coloured() {
    let coloured = |lamp: &str| requirements(&scene(&[lamp], "0.5", "all")).contains(&"colour");
    assert!(!coloured("") && !coloured("colour = [0.2, 0.2, 0.2]"));
    assert!(coloured("colour = [0.2, 0.2, 0.3]") && coloured("cct_k = 6500"));
    let dim = scene(&["cct_k = 1500"], "0.5", "all");
    assert_eq!(dim.warnings.len(), 1, "{:?}", dim.warnings);
    assert!(dim.warnings[0].found().contains("1500") && dim.warnings[0].line() == Some(5));
    assert_eq!(dim.emitter_colour(0)[2], 0.0);
    assert!(scene(&["cct_k = 2700"], "0.5", "all").warnings.is_empty());
}

#[test]
fn wrong_colours_are_refused() {
    let errors = |lamp: &str| -> Vec<Diagnostic> {
        parse(&text(&[lamp], "0.5", "all"), "test.toml", Base::Directory(".".into())).expect_err(lamp)
    };
    for (lamp, line, kind, required) in [
        ("colour = [0, 0, 0]", 5, Kind::Range, "flux_lm says how bright"),
        ("colour = [1, -1, 0]", 5, Kind::Range, "0 to 1e9"),
        ("colour = 1", 5, Kind::Syntax, "3 numbers"),
        ("cct_k = 999", 5, Kind::Range, "1000 to 15000 K"),
        ("cct_k = 1e5", 5, Kind::Range, "1000 to 15000 K"),
        ("colour = [1, 1, 1]\ncct_k = 3000", 6, Kind::Range, "not both"),
    ] {
        let found = errors(lamp);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!((found[0].line(), found[0].kind()), (Some(line), kind), "{}", found[0]);
        assert!(found[0].required().contains(required), "{}", found[0]);
    }
}
