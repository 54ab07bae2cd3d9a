//! Tabulated surfaces in closed scenes: against the Lambertian material, and where all light must end in one place.

use caustix::emitter::{Emitter, Isotropic};
use caustix::geometry::{Rectangle, Shape, Sphere, Surface, box_mesh};
use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::Sampling;
use caustix::scattering::{LobeSide, ScatterTable};
use caustix::scene::receiver::ReceiverSide;
use caustix::scene::receiver::ReceiverSpec;
use caustix::scene::{Scene, SceneBuilder};
use caustix::sequence::Sequence;
use caustix::sequence::independent::IndependentPoints;
use caustix::surface::tabulated::{Energy, Options, Sides};
use caustix::surface::{Grey, Lambertian, Material, Reference, Reflectance, Tabulated};
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

#[test]
fn sides_energy_and_remainder_are_what_the_scene_asks_for() {
    let one = |options: Options| Tabulated::new(&single(0.6, LobeSide::Front), &options).unwrap().0;
    let wi = DVec3::new(0.6, 0.0, 0.8);
    let albedos = |t: &Tabulated| [true, false].map(|front| albedo_of(t, front, wi)[0] > 0.5);
    let with = |sides| one(Options { sides, ..Options::default() });
    assert_eq!(albedos(&with(Sides::Front)), [true, false]);
    assert_eq!(albedos(&with(Sides::Back)), [false, true]);
    assert_eq!(albedos(&with(Sides::Both)), [true, true]);
    assert!(!caustix::surface::Model::is_coloured(&with(Sides::Both)));
    assert!(with(Sides::Both).with_reference(Reference::Along(DVec3::ZERO)).is_err());
    let bad = Options { rotation_deg: f64::NAN, ..Options::default() };
    assert!(Tabulated::new(&single(0.6, LobeSide::Both), &bad).is_err());
    let refused = Tabulated::new(&single(1.2, LobeSide::Both), &Options::default()).unwrap_err();
    assert!(refused.found().starts_with("an albedo of 1.19"), "{refused}");
    assert!(refused.advice().unwrap().contains("scale"));
}

fn single(albedo: f64, side: LobeSide) -> ScatterTable {
    let mut data = lambert(albedo, 5.0);
    data.side = side;
    ScatterTable::new("one", vec![data], vec![]).unwrap()
}

#[test]
fn two_lobes_that_exceed_one_together_are_scaled_together() {
    use caustix::scattering::{Frame, Quantity};
    let lobes = |theta: [Vec<f64>; 2]| {
        let [r, t] = theta;
        let angles = |theta| [theta, vec![0.0], steps(0.0, 90.0, 5.0), steps(0.0, 360.0, 60.0)];
        let reflected = lobe((Quantity::Reflection, Frame::Surface), angles(r), 1, |_, _, theta, _, _| {
            0.1 + theta / 200.0
        });
        let through = lobe((Quantity::Transmission, Frame::Surface), angles(t), 1, |_, _, theta, _, _| {
            0.3 - theta / 400.0
        });
        ScatterTable::new("two", vec![reflected, through], vec![]).unwrap()
    };
    let same = lobes([vec![0.0, 30.0, 60.0], vec![0.0, 30.0, 60.0]]);
    let other = lobes([vec![0.0, 60.0], vec![10.0, 30.0, 80.0]]);
    for (table, above) in [(same, "at 3 incidences"), (other, "at 5 incidences")] {
        assert!(Tabulated::new(&table, &Options::default()).is_err());
        let options = Options { energy: Energy::Scale, ..Options::default() };
        let (t, warnings) = Tabulated::new(&table, &options).unwrap();
        assert!(warnings[0].found().ends_with(above), "{}", warnings[0]);
        for theta in 0..90 {
            let albedo = albedo_of(&t, true, crate::support::tables::incidence(f64::from(theta), 0.0))[0];
            assert!(albedo <= 1.0 + 1e-6 && albedo > 0.8, "{theta}: {albedo}");
        }
    }
}

#[test]
fn what_a_table_leaves_goes_on_where_it_is_asked_to() {
    use caustix::scattering::{Frame, Quantity};
    use caustix::surface::{Event, Incidence};
    let angles = || [vec![0.0], vec![0.0], steps(0.0, 90.0, 5.0), steps(0.0, 360.0, 60.0)];
    let wi = DVec3::new(0.48, 0.36, 0.8);
    for (quantity, expected) in [
        (Quantity::Reflection, DVec3::new(-0.48, -0.36, 0.8)),
        (Quantity::Transmission, DVec3::new(-0.48, -0.36, -0.8)),
    ] {
        let data = lobe((quantity, Frame::Surface), angles(), 1, |_, _, _, _, _| 0.1);
        let table = ScatterTable::new("thin", vec![data], vec![]).unwrap();
        let options = Options { specular_remainder: true, ..Options::default() };
        let Material::Tabulated(t) = tabulated(&table, &options) else { unreachable!() };
        let points = IndependentPoints::new(5, 0);
        let (n, mut specular) = (20_000u64, 0.0);
        for i in 0..n {
            let at = Incidence { direction: -wi, facet: DVec3::Z, smooth: DVec3::Z, front: true };
            match t.scatter(&at, &mut Coordinates::new(&points, i, true), &mut Grey) {
                Event::Leaves { direction, through, .. } => {
                    assert_eq!(through, quantity == Quantity::Transmission);
                    assert_eq!(direction.z > 0.0, !through);
                    specular += f64::from(u8::from((direction - expected).length() < 1e-12));
                }
                other => panic!("{other:?}"),
            }
        }
        let rest = 1.0 - albedo_of(&t, true, wi)[0];
        let z = (specular / n as f64 - rest) / (rest * (1.0 - rest) / n as f64).sqrt();
        assert!(z_test(z) > SIGNIFICANCE, "{specular} of {n}, {rest}");
    }
}

#[test]
fn an_anisotropic_table_turns_with_its_reference_and_rotation() {
    use caustix::scattering::{Frame, Quantity};
    use caustix::surface::{Event, Incidence};
    // Black unless light comes from phi_i = 90 degrees: seen only along one tangent.
    let angles = [vec![60.0], steps(0.0, 360.0, 45.0), steps(0.0, 90.0, 10.0), steps(0.0, 360.0, 60.0)];
    let data = lobe(
        (Quantity::Reflection, Frame::Surface),
        angles,
        1,
        |_, phi, _, _, _| {
            if phi == 90.0 { 0.3 } else { 0.0 }
        },
    );
    let table = ScatterTable::new("slit", vec![data], vec![]).unwrap();
    let lit = |options: &Options, normal: DVec3, front: bool, from: DVec3| {
        let Material::Tabulated(t) = tabulated(&table, options) else { unreachable!() };
        let wi = (normal * 0.5 + from * 0.75f64.sqrt()).normalize();
        let at = Incidence { direction: -wi, facet: normal, smooth: normal, front };
        let points = IndependentPoints::new(1, 0);
        (0..200).any(|i| {
            let mut c = Coordinates::new(&points, i, true);
            !matches!(t.scatter(&at, &mut c, &mut Grey), Event::Absorbed)
        })
    };
    let along_x = Options::default();
    assert!(lit(&along_x, DVec3::Z, true, DVec3::Y) && !lit(&along_x, DVec3::Z, true, -DVec3::Y));
    assert!(!lit(&along_x, DVec3::Z, true, DVec3::X));
    // On the back the normal is turned over, so counter-clockwise is the other way round.
    assert!(lit(&along_x, -DVec3::Z, false, -DVec3::Y) && !lit(&along_x, -DVec3::Z, false, DVec3::Y));
    let turned = Options { rotation_deg: 90.0, ..Options::default() };
    assert!(lit(&turned, DVec3::Z, true, -DVec3::X) && !lit(&turned, DVec3::Z, true, DVec3::Y));
    let other = Options { reference: Reference::Along(DVec3::new(0.0, 3.0, 7.0)), ..Options::default() };
    assert!(lit(&other, DVec3::Z, true, -DVec3::X) && !lit(&other, DVec3::Z, true, DVec3::Y));
    // A facet across the reference still has some tangent.
    assert!([DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z].into_iter().any(|d| lit(&along_x, DVec3::X, true, d)));
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
