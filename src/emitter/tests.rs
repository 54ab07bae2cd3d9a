//! What tests of emitters share, and nonsense for every constructor.

use super::*;
use crate::error::Invalid;
use crate::files::photometric;
use crate::sample::coordinates::Purpose;
use crate::sequence::owen::OwenPoints;

/// Starts of `n` photons, each on this number of coordinates.
pub fn starts(emitter: &impl Emits, n: u64, coordinates: u32) -> impl Iterator<Item = Emission> {
    (0..n).map(move |i| {
        let points = OwenPoints::new(1, 0);
        let mut c = Coordinates::new(&points, i, true);
        let u = c.draw_reusable(Purpose::Emission);
        let emission = emitter.emit(Sampling::default(), u, &mut c).unwrap();
        assert_eq!((c.drawn(), emitter.kind().coordinates), (coordinates, coordinates));
        emission
    })
}

/// Mean of illuminance times cosine on a surface of this normal, over a grid of the unit square, and its largest term.
pub fn illuminance(light: &impl Emits, point: DVec3, normal: DVec3) -> (f64, f64) {
    let n = 400;
    let (mut sum, mut most) = (0.0, 0.0f64);
    for i in 0..n {
        for j in 0..n {
            let u = [(f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n)];
            let light = light.direct_light(point, u).unwrap();
            let term = light.illuminance_lx * light.towards.dot(normal).max(0.0);
            sum += term;
            most = most.max(term);
        }
    }
    (sum / f64::from(n * n), most)
}

/// The key that a constructor refuses; none where it takes all.
fn refused<T>(result: Result<T, Invalid>) -> &'static str {
    result.map_or_else(|e| e.what(), |_| "")
}

#[test]
fn nonsense_is_refused_by_the_name_of_its_key() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/ies/spot.ies");
    let photometry = photometric::read(file).unwrap();
    let frame = AimFrame::new(DVec3::NEG_Z, None).unwrap();
    let panel = Panel::new([1.0; 2]).unwrap();
    let section = BeamSection::Disc { radius: 1.0 };
    type Constructor<'a> = &'a dyn Fn(DVec3, f64) -> &'static str;
    let constructors: [(&str, Constructor<'_>); 4] = [
        ("isotropic", &|position, flux_lm| refused(Isotropic::new(position, flux_lm))),
        ("photometric", &|position, flux_lm| {
            refused(Photometric::new(&photometry, position, frame, Some(flux_lm)))
        }),
        ("beam", &|position, flux_lm| refused(Beam::new(position, frame, section, flux_lm))),
        ("area", &|position, flux_lm| refused(AreaLight::new(position, frame, panel, flux_lm))),
    ];
    let nonsense = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, 0.0, -0.0, 1e300, 1e-300];
    for (name, new) in constructors {
        for value in nonsense {
            assert_eq!(new(DVec3::ONE, value), "flux_lm", "{name} {value}");
            let is_a_place = value.abs() <= 1.0;
            let at = DVec3::new(0.0, value, 0.0);
            assert_eq!(new(at, 1.0), if is_a_place { "" } else { "position" }, "{name} {value}");
        }
    }
    for value in nonsense {
        assert_eq!(refused(Disc::new(value)), "radius", "{value}");
        for size in [[1.0, value], [value, 1.0]] {
            assert_eq!(refused(Panel::new(size)), "size", "{value}");
            let section = BeamSection::Rectangle { width: size[0], height: size[1] };
            assert_eq!(refused(Beam::new(DVec3::ZERO, frame, section, 1.0)), "size", "{value}");
        }
        let section = BeamSection::Disc { radius: value };
        assert_eq!(refused(Beam::new(DVec3::ZERO, frame, section, 1.0)), "radius", "{value}");
        let is_a_part = (0.0..=1.0).contains(&value);
        let part = if is_a_part { "" } else { "colour" };
        assert_eq!(refused(Colour::new([1.0, value, 1.0])), part, "{value}");
        assert_eq!(refused(Colour::black_body(value)), "cct_k", "{value}");
    }
    assert_eq!(refused(Colour::new([0.0; 3])), "colour");
    for value in
        [DVec3::ZERO, DVec3::splat(f64::NAN), DVec3::new(f64::INFINITY, 0.0, 1.0), DVec3::X * f64::NAN]
    {
        assert_eq!(refused(AimFrame::new(value, None)), "aim", "{value}");
        assert_eq!(refused(AimFrame::new(DVec3::X, Some(value))), "up", "{value}");
    }
    for up in [DVec3::X, DVec3::NEG_X * 1e-200, DVec3::new(1.0, 1e-10, 0.0)] {
        let invalid = AimFrame::new(DVec3::X * 3.0, Some(up)).unwrap_err();
        assert_eq!(invalid, Invalid::Parallel { what: "up", to: "aim" }, "{up}");
    }
    assert_eq!(refused(Emitters::new(vec![])), "emitter");
}
