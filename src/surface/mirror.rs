//! A mirror: a fixed part of the flux is reflected at every angle, the rest is absorbed.
//!
//! Scene text: `type = "mirror"`, `reflectance` 0 to 1 (default 1), or `[r, g, b]`.

use glam::DVec3;

use crate::sample::coordinates::Chooser;
use crate::surface::{Event, Incidence, Reflectance, Throughput, keep_side, working_normal};

/// Reflects what the throughput lets go on about the smooth normal.
#[inline]
pub fn scatter<C: Chooser, T: Throughput>(
    reflectance: &Reflectance,
    at: &Incidence,
    chooser: &mut C,
    carried: &mut T,
) -> Event {
    if !carried.reflect(reflectance, chooser) {
        return Event::Absorbed;
    }
    let (direction, corrected) = reflected(at);
    Event::Leaves { direction, through: false, corrected }
}

/// Where a mirror sends what arrives, unit, and whether a smooth normal made an exception necessary.
#[inline]
pub fn reflected(at: &Incidence) -> (DVec3, bool) {
    let (normal, behind) = working_normal(at);
    let reflected = at.direction - 2.0 * at.direction.dot(normal) * normal;
    let (direction, turned) = keep_side(reflected, at.facet);
    (direction.normalize(), behind || turned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::script::Script;
    use crate::surface::throughput::Grey;

    #[test]
    fn reflects_by_the_law_and_absorbs_the_rest() {
        let at = Incidence {
            direction: DVec3::new(0.6, 0.0, -0.8),
            facet: DVec3::Z,
            smooth: DVec3::Z,
            front: true,
        };
        let mut script = Script { events: vec![true, false], ..Script::default() };
        match scatter(&Reflectance::grey(0.7), &at, &mut script, &mut Grey) {
            Event::Leaves { direction, through: false, corrected: false } => {
                assert!((direction - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-15);
            }
            other => panic!("{other:?}"),
        }
        assert!(matches!(scatter(&Reflectance::grey(0.7), &at, &mut script, &mut Grey), Event::Absorbed));
        assert_eq!(script.asked, [0.7, 0.7]);
        assert!(matches!(
            scatter(&Reflectance::grey(1.0), &at, &mut Script::default(), &mut Grey),
            Event::Leaves { .. }
        ));
    }
}
