//! The coordinate counter against an account of every event.
//!
//! The account is kept outside: from the arrivals that a sink sees (Fresnel reflectance and total reflection by a formula
//! of its own), from the answers that the chooser gave, and from the scene (which choices an emission has). For every photon
//! the coordinates drawn must be what the account says, with renormalisation and without, and stand to the paper's
//! equations (4) and (6) as METHOD says. (K. Dmitriev, "From Monte Carlo to quasi-Monte Carlo".)

use caustix::emitter::{AimFrame, Emission, Emits, Emitter, Emitters, Isotropic, Photometric};
use caustix::files::photometric;
use caustix::geometry::{Rectangle, Shape, Sphere, Surface, box_mesh};
use caustix::sample::coordinates::{Chooser, Coordinates, Purpose};
use caustix::sample::method::Sampling;
use caustix::scene::{Scene, SceneBuilder};
use caustix::sequence::Points;
use caustix::sequence::independent::IndependentPoints;
use caustix::sequence::owen::OwenPoints;
use caustix::surface::{Dielectric, Grey, Lambertian, Material, Mirror, Reflectance};
use caustix::transport::census::{Exceptions, LONGEST_DIMENSION};
use caustix::transport::parallel::{How, trace_range};
use caustix::transport::{Arrival, End, Sink, walk};
use glam::DVec3;
use std::sync::atomic::AtomicBool;

use crate::support::data;

/// Bits of a coordinate that discrete events may use up before the next one takes a fresh coordinate: 64 - 24.
const SPENDABLE_BITS: f64 = 40.0;

/// What a photon met, as the sink saw it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Arrivals {
    /// At glass with both outcomes possible (0 < R < 1).
    fresnel: u32,
    /// At glass beyond the critical angle.
    total_reflections: u32,
    /// At mirrors of reflectance below 1, and of 1.
    mirror: u32,
    perfect_mirror: u32,
    /// At diffuse surfaces of reflectance between 0 and 1, and of 1.
    lambertian: u32,
    white: u32,
    absorber: u32,
}

struct Watch<'s> {
    scene: &'s Scene,
    seen: Arrivals,
}

impl Sink for Watch<'_> {
    fn arrive(&mut self, arrival: &Arrival<'_>) {
        let seen = &mut self.seen;
        let count = match self.scene.material(arrival.hit.surface) {
            Material::Dielectric(glass) => {
                // Snell: n1 sin(i) >= n2 leaves no way through. The cross product gives the sine.
                let sine = arrival.direction.cross(arrival.hit.normal).length();
                let (outside, inside) = (glass.ior_outside().unwrap_or(1.0), glass.ior());
                let (n1, n2) = if arrival.hit.front { (outside, inside) } else { (inside, outside) };
                if n1 * sine >= n2 { &mut seen.total_reflections } else { &mut seen.fresnel }
            }
            Material::Mirror(mirror) if mirror.reflectance().luminous() == 1.0 => &mut seen.perfect_mirror,
            Material::Mirror(_) => &mut seen.mirror,
            Material::Lambertian(wall) if wall.reflectance().luminous() == 1.0 => &mut seen.white,
            Material::Lambertian(_) => &mut seen.lambertian,
            Material::Absorber => &mut seen.absorber,
            other => unreachable!("no {other:?} in these scenes"),
        };
        *count += 1;
    }
}

/// A photon's coordinates with a record of the questions: how many had two answers, and the bits that the answers spent.
struct Recorded<'p, P> {
    coordinates: Coordinates<'p, P>,
    index: u64,
    /// Events with two outcomes.
    events: u32,
    /// Coordinates that the 24-bit rule gives those events, when they share.
    shared: u32,
    spent_bits: f64,
    /// How often survivals went on by a number that is no coordinate.
    independent: u32,
    scatter: u32,
    /// Whether the last event with two outcomes did not happen.
    refused_last: bool,
}

impl<P: Points> Recorded<'_, P> {
    fn record(&mut self, probability: f64, happened: bool) {
        if probability > 0.0 && probability < 1.0 {
            self.events += 1;
            if self.shared == 0 || self.spent_bits > SPENDABLE_BITS {
                self.shared += 1;
                self.spent_bits = 0.0;
            }
            self.spent_bits -= if happened { probability } else { 1.0 - probability }.log2();
            self.refused_last = !happened;
        }
    }
}

impl<P: Points> Chooser for Recorded<'_, P> {
    fn happens(&mut self, probability: f64) -> bool {
        let happened = self.coordinates.happens(probability);
        self.record(probability, happened);
        happened
    }

    fn survives(&mut self, probability: f64) -> bool {
        // The last four of a block of 2^k indices go on by a number that is no coordinate.
        if self.shared > 0 && self.spent_bits > f64::from(self.index.max(1).ilog2()) - 2.0 {
            self.spent_bits = 0.0;
            self.independent += 1;
        }
        let survived = self.coordinates.survives(probability);
        self.record(probability, survived);
        survived
    }

    fn uniform(&mut self, purpose: Purpose) -> f64 {
        assert_eq!(purpose, Purpose::Scatter);
        self.scatter += 1;
        self.coordinates.uniform(purpose)
    }
}

/// Coordinates of an emission: with renormalisation two, (choices and the first angle, the second angle); without, one for
/// each choice that there is and two angles.
fn emission_account(scene: &Scene, emitter: usize, reuse: bool) -> u32 {
    let cells = scene.emitters.as_slice()[emitter].table().is_some_and(|grid| !grid.choice().is_single());
    let choices = u32::from(scene.emitters.as_slice().len() > 1) + u32::from(cells);
    if reuse { 2 } else { 2 + choices }
}

/// Sums over the photons of a scene.
#[derive(Debug, Default)]
struct Totals {
    drawn: u64,
    paper: u64,
    bound: u64,
    total_reflections: u64,
    independent: u64,
    longest: u32,
}

fn check_photon<P: Points>(scene: &Scene, points: &P, index: u64, reuse: bool, totals: &mut Totals) -> u32 {
    let mut coordinates = Coordinates::new(points, index, reuse);
    let (emitter, emission) = scene.emitters.emit(Sampling::default(), &mut coordinates).unwrap();
    let emitted_with = emission_account(scene, emitter, reuse);
    assert_eq!(coordinates.drawn(), emitted_with, "photon {index}: emission");
    let mut chooser = Recorded {
        coordinates,
        index,
        events: 0,
        shared: 0,
        spent_bits: 0.0,
        independent: 0,
        scatter: 0,
        refused_last: false,
    };
    let mut watch = Watch { scene, seen: Arrivals::default() };
    let end = follow(scene, emission, emitter, &mut chooser, &mut watch);
    let seen = watch.seen;
    let absorbed_by_chance = matches!(end, End::Absorbed(s) if !matches!(scene.material(s), Material::Absorber))
        && chooser.refused_last;
    let by_mirror = matches!(end, End::Absorbed(s) if matches!(scene.material(s), Material::Mirror(_)))
        && absorbed_by_chance;
    let by_diffuse = absorbed_by_chance && !by_mirror;

    // What the paper counts: ideal specular and other scatterings.
    let specular =
        seen.fresnel + seen.total_reflections + seen.mirror + seen.perfect_mirror - u32::from(by_mirror);
    let diffuse = seen.lambertian + seen.white - u32::from(by_diffuse);
    let events = seen.fresnel + seen.mirror + seen.lambertian;
    assert_eq!(chooser.events, events, "photon {index}: events with two outcomes, {seen:?}");
    assert_eq!(chooser.scatter, 2 * diffuse, "photon {index}: scatter draws, {seen:?}");

    let for_events = if reuse { chooser.shared } else { events };
    let drawn = chooser.coordinates.drawn();
    assert_eq!(drawn, emitted_with + for_events + 2 * diffuse, "photon {index}: {seen:?}");
    let labelled = chooser.coordinates.drawn_for();
    assert_eq!(labelled.iter().sum::<u32>(), drawn);
    assert_eq!(labelled[Purpose::Event as usize], for_events);
    assert_eq!(labelled[Purpose::Scatter as usize], 2 * diffuse);

    let c = match end {
        End::Escaped | End::Missed => 1,
        End::Absorbed(_) => 2,
        End::Killed | End::Trapped(_) => panic!("photon {index} was killed"),
    };
    let paper = 3 + specular + 3 * diffuse + c; // (4)
    let fresh = chooser.shared.saturating_sub(1);
    let bound = 2 + 2 * diffuse + c + fresh; // (6)
    if reuse {
        assert!(drawn <= bound, "photon {index}: {drawn} > {bound}");
    } else {
        // Ours counts what is drawn: nothing for an event with one outcome nor for the end, but one for the roulette that
        // ends a photon; and an emission may have another number of choices than a single table's.
        let certain = seen.total_reflections + seen.perfect_mirror + seen.white;
        let ours = paper - certain - c + u32::from(absorbed_by_chance) + emitted_with - 3;
        assert_eq!(drawn, ours, "photon {index}: {seen:?} {end:?}");
    }
    totals.drawn += u64::from(drawn);
    totals.paper += u64::from(paper);
    totals.bound += u64::from(bound);
    totals.total_reflections += u64::from(seen.total_reflections);
    totals.independent += u64::from(chooser.independent);
    totals.longest = totals.longest.max(drawn);
    drawn
}

fn follow<C: Chooser>(
    scene: &Scene,
    emission: Emission,
    emitter: usize,
    chooser: &mut C,
    watch: &mut Watch<'_>,
) -> End {
    walk(scene, emission, scene.start(emitter), Grey, chooser, watch, &mut Exceptions::default())
}

struct Ignore;

impl<T> Sink<T> for Ignore {
    fn arrive(&mut self, _: &Arrival<'_, T>) {}
}

/// Every photon of a scene, with and without renormalisation, two sequences; and the run's census is their sum.
fn check_scene(name: &str, scene: &Scene, photons: u64) -> [Totals; 2] {
    let independent = IndependentPoints::new(11, 0);
    let owen = OwenPoints::new(11, 0);
    [true, false].map(|reuse| {
        let mut totals = Totals::default();
        let mut histogram = vec![0; LONGEST_DIMENSION + 1];
        for i in 0..photons {
            let drawn = check_photon(scene, &owen, i, reuse, &mut totals);
            histogram[(drawn as usize).min(LONGEST_DIMENSION)] += 1;
        }
        let how = How {
            sampling: Sampling::default(),
            reuse,
            interrupt: &AtomicBool::new(false),
            progress: &|_| {},
        };
        let census = trace_range(scene, &scene.emitters, &owen, 0..photons, Grey, how, || Ignore).census;
        assert_eq!(census.drawn_for.iter().sum::<u64>(), totals.drawn, "{name}");
        assert_eq!(census.dimension_histogram, histogram, "{name}");
        assert_eq!(census.dimension_max, totals.longest, "{name}");
        for i in 0..photons / 4 {
            check_photon(scene, &independent, i, reuse, &mut Totals::default());
        }
        let mean = |sum: u64| sum as f64 / photons as f64;
        println!(
            "{name}, {}: drawn {:.3} a photon, at most {}, eq. (4) {:.3}, bound (6) {:.3}, independent {:.4}",
            if reuse { "reuse" } else { "plain" },
            mean(totals.drawn),
            totals.longest,
            mean(totals.paper),
            mean(totals.bound),
            mean(totals.independent)
        );
        totals
    })
}

fn surface(name: &str, shape: Shape, bsdf: Material) -> (Surface, Material) {
    (Surface { name: name.into(), shape }, bsdf)
}

fn glass_box(min: DVec3, max: DVec3) -> (Surface, Material) {
    let glass = Material::Dielectric(Dielectric::new(1.5, 1.0).unwrap());
    surface("glass", Shape::Mesh(box_mesh(min, max).unwrap()), glass)
}

fn table_lamp(file: &str, position: DVec3) -> Emitter {
    let photometry = photometric::read(data::own_file(file)).unwrap();
    let aim = DVec3::new(0.1, -0.2, -1.0);
    let frame = AimFrame::new(aim, None).unwrap();
    Emitter::Photometric(Photometric::new(&photometry, position, frame, None).unwrap())
}

fn point(position: DVec3, flux_lm: f64) -> Emitter {
    Emitter::Isotropic(Isotropic::new(position, flux_lm).unwrap())
}

fn scene(surfaces: Vec<(Surface, Material)>, emitters: Vec<Emitter>) -> Scene {
    let mut scene = SceneBuilder::new();
    for (surface, material) in surfaces {
        scene.surface(surface.name, surface.shape, material);
    }
    for (i, emitter) in emitters.into_iter().enumerate() {
        scene.emitter(format!("lamp {i}"), emitter);
    }
    scene.build().unwrap()
}

fn floor(bsdf: Material) -> (Surface, Material) {
    let plate = Rectangle::new(DVec3::new(-2.0, -2.0, 0.0), DVec3::X * 4.0, DVec3::Y * 4.0).unwrap();
    surface("floor", Shape::Rectangle(plate), bsdf)
}

#[test]
fn a_glass_slab_over_an_absorbing_floor() {
    let slab = || glass_box(DVec3::new(-1.0, -1.0, 0.5), DVec3::new(1.0, 1.0, 0.8));
    let one =
        scene(vec![slab(), floor(Material::Absorber)], vec![table_lamp("wavy_glass.ies", DVec3::Z * 2.0)]);
    let [reuse, plain] = check_scene("slab, one lamp", &one, 1 << 14);
    assert!(reuse.total_reflections > 0, "the account of events that draw nothing must be put to the test");
    // A specular scene: two coordinates and at most one event coordinate, whatever the number of faces crossed.
    assert_eq!(reuse.longest, 3);
    assert!(plain.longest > 6);
    let lamps = vec![
        table_lamp("wavy_glass.ies", DVec3::Z * 2.0),
        point(DVec3::new(0.3, 0.1, 1.5), 300.0),
        table_lamp("floodlight_b.ies", DVec3::new(-0.5, 0.2, 1.8)),
    ];
    check_scene("slab, three lamps", &scene(vec![slab(), floor(Material::Absorber)], lamps), 1 << 14);
}

#[test]
fn a_diffuse_sphere_from_inside() {
    let sphere = |reflectance| {
        let shape = Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0).unwrap());
        surface(
            "sphere",
            shape,
            Material::Lambertian(Lambertian::new(Reflectance::new(reflectance).unwrap())),
        )
    };
    let inside = DVec3::new(0.2, -0.3, 0.1);
    let simple = scene(vec![sphere(0.8)], vec![point(inside, 100.0)]);
    let [_, plain] = check_scene("diffuse sphere", &simple, 1 << 13);
    // Mean number of scatterings a / (1 - a) = 4 (variance a / (1 - a)^2 = 20): 3 coordinates each, 1 for the last roulette,
    // 2 for the emission; z-test over the photons, with Monte Carlo's variance as the bound.
    let (n, mean) = (f64::from(1 << 13), 2.0 + 3.0 * 4.0 + 1.0);
    assert!((plain.drawn as f64 / n - mean).abs() < 4.0 * 3.0 * (20.0 / n).sqrt());

    // Long paths through glass spend what the coordinate has for survivals: the rule of the last survivors is at work.
    let ball = Shape::Sphere(Sphere::new(DVec3::new(0.0, 0.0, -0.4), 0.4).unwrap());
    let glass = Material::Dielectric(Dielectric::new(1.5, 1.0).unwrap());
    let lamp = table_lamp("spot.ies", DVec3::new(0.0, 0.1, 0.5));
    let long = scene(vec![sphere(0.99), surface("ball", ball, glass)], vec![lamp, point(inside, 500.0)]);
    let [reuse, _] = check_scene("white sphere, glass ball", &long, 1 << 11);
    assert!(reuse.independent > 0, "no photon was among the last survivors");
}

#[test]
fn a_mirror_box_with_a_block_of_glass() {
    let mirror = |name: &str, half: f64, reflectance| {
        let shape = Shape::Mesh(box_mesh(DVec3::splat(-half), DVec3::splat(half)).unwrap());
        surface(name, shape, Material::Mirror(Mirror::new(Reflectance::new(reflectance).unwrap())))
    };
    let lamp = || point(DVec3::new(0.31, -0.27, 0.63), 100.0);
    check_scene("mirror box", &scene(vec![mirror("box", 1.0, 0.9)], vec![lamp()]), 1 << 13);
    let block = glass_box(DVec3::new(-0.5, -0.4, -0.3), DVec3::new(0.4, 0.5, 0.2));
    let [reuse, _] = check_scene(
        "mirror box, glass block",
        &scene(vec![mirror("box", 1.0, 0.98), block], vec![lamp()]),
        1 << 12,
    );
    assert!(reuse.total_reflections > 0 && reuse.independent > 0);
    // Perfect mirrors and perfect white surfaces draw nothing for the event.
    let open = vec![
        mirror("block", 0.4, 1.0),
        floor_below(Material::Lambertian(Lambertian::new(Reflectance::new(1.0).unwrap()))),
    ];
    check_scene(
        "perfect mirror, white floor",
        &scene(open, vec![point(DVec3::new(0.1, 0.2, 0.9), 1.0)]),
        1 << 13,
    );
}

fn floor_below(bsdf: Material) -> (Surface, Material) {
    let plate = Rectangle::new(DVec3::new(-3.0, -3.0, -1.0), DVec3::X * 6.0, DVec3::Y * 6.0).unwrap();
    surface("floor", Shape::Rectangle(plate), bsdf)
}

/// Points of which the first coordinate is given.
struct FirstGiven(u64, IndependentPoints);

impl Points for FirstGiven {
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        if coordinate == 0 { self.0 } else { self.1.coordinate(index, coordinate) }
    }
}

#[test]
fn an_emission_that_spends_its_coordinate_takes_a_fresh_one() {
    // A lamp of 1e-13 of the flux costs 43.2 bits: fewer than 24 remain, so its first angle needs another coordinate; one
    // of 1e-12 costs 39.9, and what remains will do. A table behind the rare choice takes a fresh one for its cell.
    for (share, table, drawn) in [(1e-13, false, 3), (1e-12, false, 2), (1e-13, true, 3)] {
        let big = point(DVec3::ZERO, 1e12);
        let rare = if table {
            let photometry = photometric::read(data::own_file("spot.ies")).unwrap();
            let frame = AimFrame::new(DVec3::NEG_Z, None).unwrap();
            let e = Photometric::new(&photometry, DVec3::Z, frame, Some(1e12 * share)).unwrap();
            Emitter::Photometric(e)
        } else {
            point(DVec3::Z, 1e12 * share)
        };
        let emitters = Emitters::new(vec![rare, big]).unwrap();
        let points = FirstGiven(1 << 19, IndependentPoints::new(3, 0));
        let mut coordinates = Coordinates::new(&points, 0, true);
        let (which, _) = emitters.emit(Sampling::default(), &mut coordinates).unwrap();
        assert_eq!((which, coordinates.drawn()), (0, drawn), "{share} {table}");
    }
}
