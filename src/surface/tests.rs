//! The contract of [`Material`], asked of all of them; and a chooser for tests of single events.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;

use super::*;
use crate::sample::coordinates::{Coordinates, Purpose};
use crate::scattering::{Frame, LobeData, LobeSide, Quantity, ScatterTable};
use crate::sequence::owen::OwenPoints;
use crate::surface::tabulated::Options;

/// A chooser that follows a script: events and uniforms in order. It panics when it runs out, so a test also
/// counts what is asked for.
#[derive(Debug, Default)]
pub(crate) struct Script {
    pub events: Vec<bool>,
    pub uniforms: Vec<f64>,
    /// Probabilities of the events so far.
    pub asked: Vec<f64>,
}

impl Script {
    pub fn new(events: impl Into<Vec<bool>>, uniforms: impl Into<Vec<f64>>) -> Self {
        Self { events: events.into(), uniforms: uniforms.into(), asked: Vec::new() }
    }
}

impl Chooser for Script {
    fn happens(&mut self, probability: f64) -> bool {
        if probability <= 0.0 || probability >= 1.0 {
            return probability >= 1.0;
        }
        self.asked.push(probability);
        self.events.remove(0)
    }

    fn uniform(&mut self, _: Purpose) -> f64 {
        self.uniforms.remove(0)
    }
}

fn part(part: f64) -> Reflectance {
    Reflectance::new(part).unwrap()
}

fn lambertian(reflectance: f64) -> Material {
    Material::Lambertian(Lambertian::new(part(reflectance)))
}

fn sheet(reflectance: f64, transmittance: f64) -> Material {
    Material::DiffuseTransmission(DiffuseTransmission::new([reflectance; 3], [transmittance; 3]).unwrap())
}

/// Every material but tables, of which tests of their own know more.
fn all() -> Vec<Material> {
    vec![
        Material::Dielectric(Dielectric::new(1.5, 1.0).unwrap()),
        Material::Mirror(Mirror::new(part(0.9))),
        lambertian(0.7),
        sheet(0.5, 0.3),
        Material::Absorber,
    ]
}

/// Light that arrives from wi = (x, y, z) on a facet with this outward normal.
fn arriving(outward: DVec3, wi: [f64; 3]) -> Incidence {
    let wi = DVec3::from_array(wi).normalize();
    let front = wi.dot(outward) > 0.0;
    let facet = if front { outward } else { -outward };
    Incidence {
        direction: -wi,
        facet,
        smooth: facet,
        front,
        indices: if front { [1.0, 1.5] } else { [1.5, 1.0] },
    }
}

fn incidences() -> [Incidence; 4] {
    let slanted = DVec3::new(0.3, -0.5, 0.8).normalize();
    [
        arriving(DVec3::Z, [0.5, 0.2, 0.8]),
        arriving(slanted, [0.9, 0.1, 0.2]),
        arriving(slanted, [-0.5, 0.3, -0.4]),
        arriving(-slanted, [0.1, 0.9, 0.2]),
    ]
}

/// Where a photon goes by these uniforms, whether through, and the probability of these events.
fn scattered(material: &Material, at: &Incidence, events: &[bool], u: [f64; 2]) -> (DVec3, bool, f64) {
    let mut script = Script::new(events, u);
    let Event::Leaves { direction, through, corrected: false } = material.scatter(at, &mut script, &mut Grey)
    else {
        panic!("{material:?} ends a photon")
    };
    assert!(script.events.is_empty() && script.uniforms.is_empty());
    let chance = events.iter().zip(&script.asked).map(|(e, p)| if *e { *p } else { 1.0 - p }).product();
    (direction, through, chance)
}

/// The density of `scatter` by finite differences is `pdf`: chance / |d direction / d u|.
fn assert_density(material: &Material, events: &[bool]) {
    const H: f64 = 1e-5;
    for at in incidences() {
        for u in [[0.1, 0.2], [0.5, 0.9], [0.9, 0.05], [0.35, 0.6]] {
            let (direction, through, chance) = scattered(material, &at, events, u);
            let step = |k: usize| {
                let moved = |by: f64| {
                    let mut u = u;
                    u[k] += by;
                    scattered(material, &at, events, u).0
                };
                (moved(H) - moved(-H)) / (2.0 * H)
            };
            let jacobian = step(0).cross(step(1)).length();
            let wi = Leg { direction: -at.direction, front: at.front };
            let wo = Leg { direction, front: at.front != through };
            assert_eq!(direction.dot(at.outward()) > 0.0, wo.front, "{material:?}");
            let pdf = material.pdf(at.outward(), wi, wo);
            // The step's square, with the third derivative of a square root at u = 0.1.
            assert!((pdf * jacobian / chance - 1.0).abs() < 1e-7, "{material:?} {at:?} {u:?}: {pdf}");
        }
    }
}

/// Integral of `pdf` over the directions of each side (that of arrival first), by the midpoint rule; relative
/// error below 1e-6.
fn albedo(material: &Material, at: &Incidence) -> [f64; 2] {
    let (rows, columns) = (1000, 8);
    let wi = Leg { direction: -at.direction, front: at.front };
    let frame = crate::math::frame::frame_about(at.facet);
    let mut sum = [0.0; 2];
    for (row, column) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let z = (f64::from(row) + 0.5) / f64::from(rows);
        let (sin, cos) = (TAU * (f64::from(column) + 0.5) / f64::from(columns)).sin_cos();
        let rho = (1.0 - z * z).sqrt();
        for (through, sign) in [(0, 1.0), (1, -1.0)] {
            let wo = Leg {
                direction: frame * DVec3::new(rho * cos, rho * sin, sign * z),
                front: at.front == (through == 0),
            };
            sum[through] += material.pdf(at.outward(), wi, wo) * TAU / f64::from(rows * columns);
        }
    }
    sum
}

/// Parts of 2^14 photons that are reflected and transmitted.
fn counted(material: &Material, at: &Incidence) -> [f64; 2] {
    let points = OwenPoints::new(5, 0);
    let mut counts = [0.0; 2];
    for i in 0..1 << 14 {
        match material.scatter(at, &mut Coordinates::new(&points, i, true), &mut Grey) {
            Event::Leaves { through, .. } => counts[usize::from(through)] += 1.0 / f64::from(1 << 14),
            Event::Absorbed | Event::BelowHorizon => {}
        }
    }
    counts
}

#[test]
fn the_density_of_a_lambertian_surface_is_its_pdf() {
    assert_density(&lambertian(0.7), &[true]);
    assert_density(&lambertian(1.0), &[]);
}

#[test]
fn the_density_of_a_diffuse_sheet_is_its_pdf_on_both_sides() {
    for reflect in [true, false] {
        assert_density(&sheet(0.5, 0.3), &[true, reflect]);
        assert_density(&sheet(0.75, 0.25), &[reflect]);
    }
    assert_density(&sheet(0.0, 0.3), &[true]);
    assert_density(&sheet(0.0, 1.0), &[]);
}

#[test]
fn flux_goes_where_the_density_says() {
    for material in all() {
        for at in incidences() {
            let (exact, counts) = (albedo(&material, &at), counted(&material, &at));
            let scatters = material.scatters();
            for (exact, count) in exact.into_iter().zip(counts) {
                // A net of 2^14 points is right to some 2^-13.
                assert!(!scatters || (exact - count).abs() < 5e-4, "{material:?}: {exact} {count}");
                assert!(scatters || exact == 0.0, "{material:?} has a value");
            }
        }
    }
    let [front, back] = albedo(&lambertian(0.7), &incidences()[1]);
    assert!((front - 0.7).abs() < 1e-6 && back == 0.0);
    let [front, back] = albedo(&sheet(0.5, 0.3), &incidences()[2]);
    assert!((front - 0.5).abs() < 1e-6 && (back - 0.3).abs() < 1e-6);
}

#[test]
fn every_answer_fits_the_others() {
    let mut words = BTreeMap::new();
    for material in all() {
        for (rank, word) in material.requires() {
            assert_eq!(words.insert(*rank, *word).unwrap_or(word), *word, "two words in one place");
        }
        for at in incidences() {
            let ways = material.specular(&at);
            let parts = [ways.mirrored, ways.through].into_iter().flatten().map(|way| way.part[1]);
            let all: f64 = parts.sum();
            assert!(if ways.lossless { (all - 1.0).abs() < 1e-15 } else { all <= 1.0 });
            assert_eq!(material.kind() == Kind::Specular, all > 0.0, "{material:?}");
            for (way, side) in [(ways.mirrored, at.facet), (ways.through, -at.facet)] {
                assert!(way.is_none_or(|way| way.direction.dot(side) > 0.0), "{material:?}");
            }
            if material.is_opaque() {
                let [wi, wo] = [-at.direction, -at.facet].map(|d| Leg::new(d, at.outward()));
                assert!(ways.through.is_none() && material.eval(at.outward(), wi, wo) == [0.0; 3]);
            }
            if let Some(value) = material.even_value() {
                let [wi, same] =
                    [-at.direction, at.facet].map(|direction| Leg { direction, front: at.front });
                let other = Leg { direction: -at.facet, front: !at.front };
                assert_eq!(material.eval(at.outward(), wi, same), value);
                assert_eq!(material.eval(at.outward(), wi, other), [0.0; 3]);
            }
            assert_eq!(material.proposals(&at), [0.0; 2]);
        }
        assert!(!material.is_coloured());
    }
    let red = Reflectance::rgb([0.8, 0.3, 0.05]).unwrap();
    for material in [Material::Mirror(Mirror::new(red)), Material::Lambertian(Lambertian::new(red))] {
        assert!(material.is_coloured());
    }
    assert!(lambertian(0.0).requires().is_empty() && !lambertian(0.0).scatters());
    assert_eq!(lambertian(0.5).even_value(), Some([0.5 * FRAC_1_PI; 3]));
    assert_eq!(memory_bytes(&all()), 0);
}

#[test]
fn copies_of_a_table_are_held_once() {
    let lobe = LobeData {
        quantity: Quantity::Reflection,
        side: LobeSide::Both,
        frame: Frame::Surface,
        theta_i_deg: vec![0.0],
        phi_i_deg: vec![0.0],
        polar_deg: vec![0.0, 90.0],
        azimuth_deg: vec![0.0, 360.0],
        channels: 1,
        values: vec![0.1; 4],
        declared_tis: Vec::new(),
    };
    let table = ScatterTable::new("even", vec![lobe], Vec::new()).unwrap();
    let made = || Material::Tabulated(Box::new(Tabulated::new(&table, &Options::default()).unwrap().0));
    let (one, other) = (made(), made());
    let bytes = memory_bytes(std::slice::from_ref(&one));
    assert!(bytes > 0);
    assert_eq!(memory_bytes(&[one.clone(), Material::Absorber, one.clone()]), bytes);
    assert_eq!(memory_bytes(&[one, other]), 2 * bytes);
}
