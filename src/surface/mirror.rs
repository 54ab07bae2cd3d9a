//! A mirror: a fixed part of the flux is reflected at every angle, the rest is absorbed.
//!
//! Scene text: `type = "mirror"`, `reflectance` 0 to 1 (default 1), or `[r, g, b]`.

use glam::DVec3;

use crate::sample::coordinates::Chooser;
use crate::surface::incidence::keep_side;
use crate::surface::{Event, Incidence, Kind, Model, Reflectance, Throughput, Way, Ways};

/// A mirror on both sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    reflectance: Reflectance,
}

impl Mirror {
    /// A mirror that reflects these parts of the flux.
    pub fn new(reflectance: Reflectance) -> Self {
        Self { reflectance }
    }

    /// Reflected parts of the flux.
    pub fn reflectance(&self) -> &Reflectance {
        &self.reflectance
    }
}

impl Model for Mirror {
    const REQUIRES: &[(u8, &'static str)] = &[(1, "mirror reflection")];

    fn kind(&self) -> Kind {
        Kind::Specular
    }

    fn keeps_all(&self) -> bool {
        self.reflectance.by_channel() == [1.0; 3]
    }

    fn is_opaque(&self) -> bool {
        true
    }

    fn is_coloured(&self) -> bool {
        self.reflectance.is_coloured()
    }

    /// Reflects what the throughput lets go on about the smooth normal.
    #[inline]
    fn scatter<C: Chooser, T: Throughput>(&self, at: &Incidence, chooser: &mut C, carried: &mut T) -> Event {
        if !carried.reflect(&self.reflectance, chooser) {
            return Event::Absorbed;
        }
        let (direction, corrected) = reflected(at);
        Event::Leaves { direction, through: false, corrected }
    }

    fn specular(&self, at: &Incidence) -> Ways {
        let way =
            Way { direction: reflected(at).0, part: self.reflectance.by_channel(), luminance_factor: 1.0 };
        Ways { mirrored: Some(way), ..Ways::default() }
    }
}

/// The mirrored direction, unit, and whether a smooth normal made an exception necessary.
#[inline]
fn reflected(at: &Incidence) -> (DVec3, bool) {
    let (normal, behind) = at.working_normal();
    let reflected = at.direction - 2.0 * at.direction.dot(normal) * normal;
    let (direction, turned) = keep_side(reflected, at.facet);
    (direction.normalize(), behind || turned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::Script;
    use crate::surface::throughput::Grey;

    #[test]
    fn reflects_by_the_law_and_absorbs_the_rest() {
        let at = Incidence {
            direction: DVec3::new(0.6, 0.0, -0.8),
            facet: DVec3::Z,
            smooth: DVec3::Z,
            front: true,
            indices: [1.0; 2],
        };
        let silver = Mirror::new(Reflectance::new(0.7).unwrap());
        let mut script = Script::new([true, false], []);
        match silver.scatter(&at, &mut script, &mut Grey) {
            Event::Leaves { direction, through: false, corrected: false } => {
                assert!((direction - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-15);
            }
            other => panic!("{other:?}"),
        }
        assert!(matches!(silver.scatter(&at, &mut script, &mut Grey), Event::Absorbed));
        assert_eq!(script.asked, [0.7, 0.7]);
        let perfect = Mirror::new(Reflectance::new(1.0).unwrap());
        assert!(matches!(perfect.scatter(&at, &mut Script::default(), &mut Grey), Event::Leaves { .. }));
    }

    #[test]
    fn an_eye_path_goes_on_as_a_photon_does() {
        let smooth = DVec3::new(0.1, 0.0, 1.0).normalize();
        let at = Incidence {
            direction: DVec3::new(0.6, 0.0, -0.8),
            facet: DVec3::Z,
            smooth,
            front: false,
            indices: [1.0; 2],
        };
        let parts = [0.75, 0.5, 0.25];
        let copper = Mirror::new(Reflectance::rgb(parts).unwrap());
        let Event::Leaves { direction, .. } = copper.scatter(&at, &mut Script::new([true], []), &mut Grey)
        else {
            panic!("reflected")
        };
        let way = Way { direction, part: parts, luminance_factor: 1.0 };
        assert_eq!(copper.specular(&at), Ways { mirrored: Some(way), through: None, lossless: false });
    }
}
