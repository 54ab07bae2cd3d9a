//! Tabulated surfaces in closed scenes: against the Lambertian material, and where all light must end in one place.

use caustix::emitter::{Emitter, Isotropic};
use caustix::geometry::{Rectangle, Shape, Sphere, Surface, box_mesh};
use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::Sampling;
use caustix::scattering::ScatterTable;
use caustix::scene::receiver::ReceiverSide;
use caustix::scene::receiver::ReceiverSpec;
use caustix::scene::{Scene, SceneBuilder};
use caustix::sequence::Sequence;
use caustix::sequence::independent::IndependentPoints;
use caustix::surface::tabulated::{Energy, Options};
use caustix::surface::{Grey, Lambertian, Material, Reflectance, Tabulated};
use caustix::transport::census::Exceptions;
use caustix::transport::{Arrival, End, Sink, walk};
use glam::DVec3;

use crate::support::judge::{SIGNIFICANCE, sidak, student_p};
use crate::support::local::albedo as albedo_of;
use crate::support::scenes::run;
use crate::support::statistics::z_test;
use crate::support::tables::{lambert, lobe, steps};

fn tabulated(table: &ScatterTable, options: &Options) -> Material {
    Material::Tabulated(Box::new(Tabulated::new(table, options).unwrap().0))
}

fn diffuser(albedo: f64, step: f64, energy: Energy) -> Material {
    let table = ScatterTable::new("lambert", vec![lambert(albedo, step)], vec![]).unwrap();
    tabulated(&table, &Options { energy, ..Options::default() })
}

/// A lamp in a box with a shelf, both of one material each; every wall of the shelf is a receiver of 4 x 4 cells.
fn room(walls: Material, shelf: Material) -> Scene {
    let box_shape = Shape::Mesh(box_mesh(DVec3::splat(-1.0), DVec3::new(1.0, 1.2, 0.9)).unwrap());
    let plate = Rectangle::new(DVec3::new(-0.7, -0.6, -0.3), DVec3::X * 1.2, DVec3::Y * 1.1).unwrap();
    let receiver =
        |name, side| ReceiverSpec::new(name, "shelf").unwrap().with_cells([4, 4]).unwrap().on_side(side);
    let lamp = Emitter::Isotropic(Isotropic::new(DVec3::new(0.3, 0.4, 0.5), 1000.0).unwrap());
    let mut scene = SceneBuilder::new();
    scene
        .surface("walls", box_shape, walls)
        .surface("shelf", plate.into(), shelf)
        .emitter("lamp", lamp)
        .receiver(receiver("up", ReceiverSide::Front))
        .receiver(receiver("down", ReceiverSide::Back));
    scene.build().unwrap()
}

#[test]
fn a_tabulated_diffuser_is_a_lambertian_surface() {
    let tables = room(diffuser(0.7, 1.0, Energy::Refuse), diffuser(0.5, 1.0, Energy::Refuse));
    // Bilinear between nodes a degree apart, a cosine loses 2.5e-5 of its integral: the same albedo on both sides.
    let albedo = |surface: usize| match &tables.materials()[surface] {
        Material::Tabulated(t) => albedo_of(t, true, DVec3::Z)[0],
        other => panic!("{other:?}"),
    };
    assert!((albedo(0) / 0.7 - 1.0).abs() < 3e-5 && (albedo(1) / 0.5 - 1.0).abs() < 3e-5);
    let matt = |part| Material::Lambertian(Lambertian::new(Reflectance::new(part).unwrap()));
    let formula = room(matt(albedo(0)), matt(albedo(1)));
    let replicates = 32;
    let a = run(&tables, Sequence::SobolOwen, 1 << 13, replicates, 1);
    let b = run(&formula, Sequence::SobolOwen, 1 << 13, replicates, 2);
    let (mut ts, mut cells) = (Vec::new(), 0);
    for receiver in 0..2 {
        let area = tables.receivers[receiver].area_m2(0);
        for cell in 0..16 {
            let (x, y) = (a.illuminance_lx(receiver, cell, area), b.illuminance_lx(receiver, cell, area));
            let error = x.standard_error.unwrap().hypot(y.standard_error.unwrap());
            ts.push((x.value - y.value) / error);
            cells += 1;
        }
        let (x, y) = (a.receiver_flux_lm(receiver), b.receiver_flux_lm(receiver));
        ts.push((x.value - y.value) / x.standard_error.unwrap().hypot(y.standard_error.unwrap()));
    }
    let largest = ts.iter().fold(0.0f64, |m, t| m.max(t.abs()));
    let p = sidak(student_p(largest, 2 * (replicates - 1)), ts.len());
    println!("{cells} cells and 2 totals: largest difference {largest:.2} standard errors, p {p:.3}");
    assert!(p > SIGNIFICANCE && largest < 3.5);
    assert_eq!((a.census.exceptions.below_horizon, a.ledger.killed), (0, 0));
}

struct Hits(u32);

impl Sink for Hits {
    fn arrive(&mut self, _: &Arrival<'_>) {
        self.0 += 1;
    }
}

#[test]
fn white_furnace_all_light_ends_on_the_one_black_patch() {
    let table = ScatterTable::new("white", vec![lambert(1.03, 5.0)], vec![]).unwrap();
    let (white, warnings) =
        Tabulated::new(&table, &Options { energy: Energy::Scale, ..Options::default() }).unwrap();
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].found().contains("an albedo of 1.02"), "{}", warnings[0].found());
    let scene = room(Material::Tabulated(Box::new(white)), Material::Absorber);
    let outcome = run(&scene, Sequence::SobolOwen, 1 << 14, 8, 3);
    assert_eq!(outcome.ledger.absorbed, [0, outcome.photons]);
    assert_eq!((outcome.ledger.killed, outcome.ledger.escaped), (0, 0));
}

#[test]
fn hits_per_photon_have_the_mean_that_the_albedo_gives() {
    for (seed, albedo) in [(1, 0.3), (2, 0.8), (3, 0.95)] {
        let bsdf = diffuser(albedo, 6.0, Energy::Refuse);
        let Material::Tabulated(t) = &bsdf else { unreachable!() };
        let a = albedo_of(t, true, DVec3::Z)[0];
        let ball = Shape::Sphere(Sphere::new(DVec3::new(0.1, 0.0, 0.2), 1.3).unwrap());
        let lamp = Emitter::Isotropic(Isotropic::new(DVec3::new(0.4, -0.3, 0.1), 1.0).unwrap());
        let mut scene = SceneBuilder::new();
        scene.surface("ball", ball, bsdf).emitter("lamp", lamp);
        let scene = scene.build().unwrap();
        let points = IndependentPoints::new(seed, 0);
        let (n, mut sum) = (1u64 << 17, 0.0);
        for index in 0..n {
            let mut c = Coordinates::new(&points, index, true);
            let (emitter, emission) = scene.emitters.emit(Sampling::default(), &mut c).unwrap();
            let (mut sink, mut exceptions) = (Hits(0), Exceptions::default());
            let start = scene.start(emitter);
            let end = walk(&scene, emission, start, Grey, &mut c, &mut sink, &mut exceptions);
            assert!(matches!(end, End::Absorbed(_)));
            sum += f64::from(sink.0);
        }
        let z = (sum / n as f64 - 1.0 / (1.0 - a)) / (a / (1.0 - a).powi(2) / n as f64).sqrt();
        println!("albedo {a:.4}: mean {:.4}, 1/(1 - a) {:.4}, z {z:.2}", sum / n as f64, 1.0 / (1.0 - a));
        assert!(z_test(z) > SIGNIFICANCE);
    }
}

/// A lobe about the mirrored direction of grazing light reaches below the horizon: what it sends there is absorbed and
/// counted, the rest leaves. Both parts by the midpoint rule over the hemisphere, in the surface's own angles.
#[test]
fn light_below_the_horizon_is_absorbed_and_counted() {
    use caustix::emitter::{AimFrame, Beam, BeamSection};
    use caustix::scattering::{Frame, Quantity};
    let angles = [vec![70.0], vec![0.0], steps(0.0, 60.0, 10.0), steps(0.0, 360.0, 30.0)];
    let data = lobe((Quantity::Reflection, Frame::Specular), angles, 1, |_, _, _, polar, _| {
        2.0 * (-polar / 20.0f64).exp()
    });
    let table = ScatterTable::new("grazing", vec![data], vec![]).unwrap();
    let bsdf = tabulated(&table, &Options::default());
    let Material::Tabulated(t) = &bsdf else { unreachable!() };
    let wi = crate::support::tables::incidence(85.0, 30.0);
    let (n, degree) = (900, std::f64::consts::PI / 180.0);
    let mut above = 0.0;
    for i in 0..n {
        let theta = (f64::from(i) + 0.5) * 90.0 / f64::from(n);
        let ring: f64 = (0..n)
            .map(|j| {
                let wo =
                    crate::support::tables::incidence(theta, (f64::from(j) + 0.5) * 360.0 / f64::from(n));
                crate::support::local::eval(t, true, wi, wo)[0]
            })
            .sum();
        above += ring * (theta * degree).sin() * (theta * degree).cos();
    }
    above *= 90.0 * 360.0 * degree * degree / f64::from(n * n);
    let below = albedo_of(t, true, wi)[0] - above;
    assert!(below > 0.03 && above > 0.1, "{below} {above}");
    let frame = AimFrame::new(-wi, Some(DVec3::Z)).unwrap();
    let beam = Beam::new(4.0 * wi, frame, BeamSection::Disc { radius: 0.1 }, 100.0).unwrap();
    let plate = Rectangle::new(DVec3::new(-2.0, -2.0, 0.0), DVec3::X * 4.0, DVec3::Y * 4.0).unwrap();
    let mut scene = SceneBuilder::new();
    scene.surface("plate", Shape::Rectangle(plate), bsdf).emitter("beam", Emitter::Beam(beam));
    let scene = scene.build().unwrap();
    let outcome = run(&scene, Sequence::Independent, 1 << 18, 4, 5);
    let photons = outcome.photons as f64;
    for (count, part) in [(outcome.census.exceptions.below_horizon, below), (outcome.ledger.escaped, above)] {
        let z = (count as f64 - photons * part) / (photons * part * (1.0 - part)).sqrt();
        println!("{:.5} of the photons, expected {part:.5}: z = {z:.2}", count as f64 / photons);
        assert!(z_test(z) > SIGNIFICANCE);
    }
    assert_eq!(outcome.ledger.absorbed[0] + outcome.ledger.escaped, outcome.photons);
}

#[test]
fn the_account_of_coordinates_counts_what_tables_draw() {
    use caustix::lab::study::account::Events;
    use caustix::run::{Algorithm, Plan, Settings, trace};
    use caustix::scattering::{Frame, Quantity};
    let angles = || [vec![0.0, 40.0, 80.0], vec![0.0], steps(0.0, 90.0, 6.0), steps(0.0, 360.0, 30.0)];
    let glossy = lobe((Quantity::Reflection, Frame::Specular), angles(), 1, |_, _, theta, polar, _| {
        0.3 * (1.0 + theta / 90.0) * (-polar / 25.0).exp()
    });
    let table = ScatterTable::new("glossy", vec![glossy], vec![]).unwrap();
    let scene = room(tabulated(&table, &Options::default()), diffuser(0.6, 5.0, Energy::Refuse));
    let events = Events::count(&scene);
    assert!(events.tables > 0.0, "no photon met a table");
    for variant in ["mc", "mc:table", "qmc-inverse", "qmc-inverse-reuse"] {
        let algorithm = Algorithm::parse(variant).unwrap();
        let settings = Settings { photons: Some(1 << 16), replicates: Some(16), seed: 7, algorithm };
        let interrupt = std::sync::atomic::AtomicBool::new(false);
        let census = trace(&scene, &Plan::new(&settings).unwrap(), &interrupt, &|_| {}).unwrap().census;
        let (mean, account) = (census.dimension_mean(), events.account(&scene, algorithm).by_event);
        println!("{variant}: {mean:.4} coordinates a photon, account {account:.4}");
        // Two means over 2^16 photons; the spread of either is less than its mean.
        assert!((mean / account - 1.0).abs() < 0.02, "{variant}: {mean} {account}");
    }
}
