//! A scene made larger, smaller, or moved far away is the same scene.
//!
//! There is no absolute epsilon, so a scale of a power of two changes no bit but exponents. Other scales and shifts round
//! every coordinate anew; what that may change is stated here and tested.

use std::path::{Path as File, PathBuf};

use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::Sampling;
use caustix::scene::Scene;
use caustix::scene::receiver::Cells;
use caustix::sequence::Sequence;
use caustix::sequence::owen::OwenPoints;
use caustix::surface::Grey;
use caustix::transport::census::Exceptions;
use caustix::transport::{Arrival, End, Sink, walk};
use glam::DVec3;
use rayon::prelude::*;

use crate::lengths;
use crate::support::scenes::{run, scene_files};

/// A scene with every length times `s`.
fn scaled(file: &File, s: f64) -> Scene {
    lengths::scene(&lengths::scaled(lengths::table(file), s))
}

/// One arrival.
#[derive(Clone, Copy, PartialEq)]
struct Step {
    surface: u32,
    face: u32,
    front: bool,
    position: DVec3,
}

/// The arrivals of a photon and its end.
struct Path {
    steps: Vec<Step>,
    end: End,
}

struct Record<'a>(&'a mut Vec<Step>);

impl Sink for Record<'_> {
    fn arrive(&mut self, arrival: &Arrival<'_>) {
        let hit = arrival.hit;
        self.0.push(Step {
            surface: hit.surface.0,
            face: hit.face,
            front: hit.front,
            position: hit.position,
        });
    }
}

fn path(scene: &Scene, points: &OwenPoints, index: u64) -> Path {
    let mut coordinates = Coordinates::new(points, index, true);
    let (emitter, emission) = scene.emitters.emit(Sampling::default(), &mut coordinates).unwrap();
    let mut steps = Vec::new();
    let mut exceptions = Exceptions::default();
    let end = walk(
        scene,
        emission,
        scene.start(emitter),
        Grey,
        &mut coordinates,
        &mut Record(&mut steps),
        &mut exceptions,
    );
    Path { steps, end }
}

/// The cells a photon is counted in.
fn cells(scene: &Scene, path: &Path) -> Vec<(usize, u32, u32)> {
    let mut found = Vec::new();
    for step in &path.steps {
        for (i, receiver) in scene.receivers.iter().enumerate().filter(|(_, r)| r.surface.0 == step.surface) {
            let Cells::Grid { nu, nv } = receiver.cells else {
                found.push((i, step.face, 0));
                continue;
            };
            let (u, v) = scene.geometry.surfaces()[step.surface as usize].shape.uv(step.position).unwrap();
            found.push((i, (u * f64::from(nu)) as u32, (v * f64::from(nv)) as u32));
        }
    }
    found
}

#[test]
fn powers_of_two_change_no_hit() {
    let points = OwenPoints::new(1, 0);
    for file in continuous_scenes() {
        let original = scaled(&file, 1.0);
        for s in [1024.0, 1.0 / 1024.0] {
            let other = scaled(&file, s);
            (0..1u64 << 13).into_par_iter().for_each(|index| {
                let (a, b) = (path(&original, &points, index), path(&other, &points, index));
                assert_eq!(a.end, b.end, "{}: photon {index}", file.display());
                let larger = a.steps.iter().map(|step| Step { position: step.position * s, ..*step });
                assert!(larger.eq(b.steps), "{}: photon {index}", file.display());
            });
            let (a, b) = (
                run(&original, Sequence::SobolOwen, 1 << 11, 4, 2),
                run(&other, Sequence::SobolOwen, 1 << 11, 4, 2),
            );
            assert_eq!(
                (a.cells(), &a.ledger, &a.census),
                (b.cells(), &b.ledger, &b.census),
                "{}",
                file.display()
            );
            assert_eq!(a.photon_lm.to_bits(), b.photon_lm.to_bits());
        }
    }
}

/// Photons of `n` that are counted in other cells or end elsewhere in a second scene, and the largest distance [m, in the
/// first scene] between arrivals of the others; for each of several second scenes, with the way back from it.
fn changes<const K: usize, B: Fn(DVec3) -> DVec3 + Sync>(
    a: &Scene,
    others: &[(Scene, B); K],
    n: u64,
) -> [(u64, f64); K] {
    let points = OwenPoints::new(3, 0);
    (0..n)
        .into_par_iter()
        .map(|index| {
            let p = path(a, &points, index);
            others.each_ref().map(|(b, back)| {
                let q = path(b, &points, index);
                if p.end != q.end || p.steps.len() != q.steps.len() || cells(a, &p) != cells(b, &q) {
                    return (1, 0.0);
                }
                let steps = p.steps.iter().zip(&q.steps);
                (0, steps.map(|(s, t)| (s.position - back(t.position)).length()).fold(0.0, f64::max))
            })
        })
        .reduce(|| [(0, 0.0); K], |x, y| std::array::from_fn(|k| (x[k].0 + y[k].0, x[k].1.max(y[k].1))))
}

/// Scenes in which a change in the last digit of a direction changes the rest of a path as little. A table of scattering
/// chooses slice and cell by thresholds that depend on the incidence, and what is left of the coordinate is divided by the
/// probability of a rare cell: rounding grows by its inverse.
fn continuous_scenes() -> Vec<PathBuf> {
    let mut files = scene_files();
    files.retain(|file| !std::fs::read_to_string(file).unwrap().contains("type = \"tabulated\""));
    assert!(files.len() >= 7);
    files
}

/// Arrivals in scenes of a few metres, known to 2e-16 of that where they start; optics magnify it.
const SCALED_APART_M: f64 = 1e-10;

#[test]
fn other_scales_change_at_most_one_photon_in_a_million() {
    let (mut photons, mut changed) = (0, 0);
    for file in continuous_scenes() {
        let original = scaled(&file, 1.0);
        let scales = [1e3, 1e-3];
        let others = scales.map(|s| (scaled(&file, s), move |p: DVec3| p / s));
        let n = 1 << 18;
        let a = run(&original, Sequence::SobolOwen, 1 << 11, 8, 2);
        for (((k, apart), s), (other, _)) in
            changes(&original, &others, n).into_iter().zip(scales).zip(&others)
        {
            println!("{} x {s}: {k} of {n} change cell, others at most {apart:.1e} m apart", file.display());
            assert!(apart <= SCALED_APART_M, "{}: {apart} m", file.display());
            photons += n;
            changed += k;
            let b = run(other, Sequence::SobolOwen, 1 << 11, 8, 2);
            for receiver in 0..original.receivers.len() {
                let (a, b) = (a.receiver_flux_lm(receiver).value, b.receiver_flux_lm(receiver).value);
                assert!((a - b).abs() <= 1e-9 * a, "{}: {a} lm, {b} lm", file.display());
            }
        }
    }
    assert!(changed * 1_000_000 <= photons, "{changed} of {photons} photons");
}

/// Rounding at 1000 m is 1.1e-13 m; glass and mirrors at odd angles magnify it a few thousand times at most.
const SHIFTED_APART_M: f64 = 1e-9;

#[test]
fn a_kilometre_away_arrivals_agree_to_a_nanometre() {
    let by = DVec3::new(1000.0, -1000.0, 1000.0);
    let (mut photons, mut changed) = (0, 0);
    for file in continuous_scenes() {
        let original = scaled(&file, 1.0);
        let other = lengths::scene(&lengths::shifted(lengths::table(&file), by.to_array()));
        let n = 1 << 15;
        let [(k, apart)] = changes(&original, &[(other, |p| p - by)], n);
        println!("{}: {k} of {n} change cell, others at most {apart:.1e} m apart", file.display());
        assert!(apart <= SHIFTED_APART_M, "{}: {apart} m", file.display());
        photons += n;
        changed += k;
    }
    // A cell is some millimetres wide: 1e-9 m moves one photon in a million across a border.
    assert!(changed * 1_000_000 <= 2 * photons, "{changed} of {photons} photons");
}
