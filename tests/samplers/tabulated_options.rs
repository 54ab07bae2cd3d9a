//! How a table is put on a surface: sides, energy, the remainder, reference and rotation.

use caustix::sample::coordinates::Coordinates;
use caustix::scattering::{Frame, LobeSide, Quantity, ScatterTable};
use caustix::sequence::independent::IndependentPoints;
use caustix::surface::tabulated::{Energy, Options, Sides};
use caustix::surface::{Event, Grey, Incidence, Model, Reference, Tabulated};
use glam::DVec3;

use crate::support::local::albedo;
use crate::support::statistics::z_test;
use crate::support::tables::{incidence, lambert, lobe, steps};

fn tabulated(table: &ScatterTable, options: &Options) -> Tabulated {
    Tabulated::new(table, options).unwrap().0
}

#[test]
fn sides_energy_and_remainder_are_what_the_scene_asks_for() {
    let one = |options: Options| Tabulated::new(&single(0.6, LobeSide::Front), &options).unwrap().0;
    let wi = DVec3::new(0.6, 0.0, 0.8);
    let albedos = |t: &Tabulated| [true, false].map(|front| albedo(t, front, wi)[0] > 0.5);
    let with = |sides| one(Options { sides, ..Options::default() });
    assert_eq!(albedos(&with(Sides::Front)), [true, false]);
    assert_eq!(albedos(&with(Sides::Back)), [false, true]);
    assert_eq!(albedos(&with(Sides::Both)), [true, true]);
    assert!(!with(Sides::Both).is_coloured());
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
            let albedo = albedo(&t, true, incidence(f64::from(theta), 0.0))[0];
            assert!(albedo <= 1.0 + 1e-6 && albedo > 0.8, "{theta}: {albedo}");
        }
    }
}

#[test]
fn what_a_table_leaves_goes_on_where_it_is_asked_to() {
    let angles = || [vec![0.0], vec![0.0], steps(0.0, 90.0, 5.0), steps(0.0, 360.0, 60.0)];
    let wi = DVec3::new(0.48, 0.36, 0.8);
    for (quantity, expected) in [
        (Quantity::Reflection, DVec3::new(-0.48, -0.36, 0.8)),
        (Quantity::Transmission, DVec3::new(-0.48, -0.36, -0.8)),
    ] {
        let data = lobe((quantity, Frame::Surface), angles(), 1, |_, _, _, _, _| 0.1);
        let table = ScatterTable::new("thin", vec![data], vec![]).unwrap();
        let options = Options { specular_remainder: true, ..Options::default() };
        let t = tabulated(&table, &options);
        let points = IndependentPoints::new(5, 0);
        let (n, mut specular) = (20_000u64, 0.0);
        for i in 0..n {
            let at = Incidence {
                direction: -wi,
                facet: DVec3::Z,
                smooth: DVec3::Z,
                front: true,
                indices: [1.0; 2],
            };
            match t.scatter(&at, &mut Coordinates::new(&points, i, true), &mut Grey) {
                Event::Leaves { direction, through, .. } => {
                    assert_eq!(through, quantity == Quantity::Transmission);
                    assert_eq!(direction.z > 0.0, !through);
                    specular += f64::from(u8::from((direction - expected).length() < 1e-12));
                }
                other => panic!("{other:?}"),
            }
        }
        let rest = 1.0 - albedo(&t, true, wi)[0];
        // The same for an eye that looks along the way of the photon: the table is alike from both sides.
        let seen = t.specular(&crate::support::local::arriving(true, wi));
        let through = quantity == Quantity::Transmission;
        let (way, none) = if through { (seen.through, seen.mirrored) } else { (seen.mirrored, seen.through) };
        let way = way.unwrap();
        assert!((way.direction - expected).length() < 1e-15 && none.is_none());
        assert_eq!((way.part, way.luminance_factor), ([rest; 3], 1.0));
        let z = (specular / n as f64 - rest) / (rest * (1.0 - rest) / n as f64).sqrt();
        assert!(z_test(z) > 1e-4, "{specular} of {n}, {rest}");
    }
}

#[test]
fn an_anisotropic_table_turns_with_its_reference_and_rotation() {
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
        let t = tabulated(&table, options);
        let wi = (normal * 0.5 + from * 0.75f64.sqrt()).normalize();
        let at = Incidence { direction: -wi, facet: normal, smooth: normal, front, indices: [1.0; 2] };
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
