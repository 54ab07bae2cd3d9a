//! A photon, or an eye path, at a surface; and the side that a direction is on.

use glam::DVec3;

use crate::geometry::Hit;

/// What arrives at a surface.
#[derive(Debug, Clone, Copy)]
pub struct Incidence {
    /// The way it travels, towards the surface; unit.
    pub direction: DVec3,
    /// Normal of the facet, unit, on the side of arrival: direction . facet < 0.
    pub facet: DVec3,
    /// Interpolated shading normal, unit. Same orientation as `facet`.
    pub smooth: DVec3,
    /// Whether the side of arrival is the one the outward normal points to.
    pub front: bool,
    /// Refractive indices of the media on the side of arrival and on the other; 1 where no light passes between media.
    pub indices: [f64; 2],
}

impl Incidence {
    /// What travels along `direction` and meets a surface there, between media of these refractive indices.
    #[inline]
    pub fn of(hit: &Hit, direction: DVec3, indices: [f64; 2]) -> Self {
        let sign = if hit.front { 1.0 } else { -1.0 };
        let (facet, smooth) = (hit.normal * sign, hit.shading_normal * sign);
        Self { direction, facet, smooth, front: hit.front, indices }
    }

    /// The facet's outward normal.
    #[inline]
    pub fn outward(&self) -> DVec3 {
        if self.front { self.facet } else { -self.facet }
    }

    /// The shading normal where the direction arrives in front of it, else the facet's (METHOD 1); true in
    /// the second case.
    #[inline]
    pub(super) fn working_normal(&self) -> (DVec3, bool) {
        if self.direction.dot(self.smooth) < 0.0 { (self.smooth, false) } else { (self.facet, true) }
    }
}

/// A direction that left on the wrong side of the facet, mirrored in the facet's plane (METHOD 1); `towards`
/// is the facet normal on the side where it must be. True where it was mirrored.
#[inline]
pub(super) fn keep_side(direction: DVec3, towards: DVec3) -> (DVec3, bool) {
    let along = direction.dot(towards);
    if along < 0.0 { (direction - 2.0 * along * towards, true) } else { (direction, false) }
}

/// A direction away from a surface, and the side it is on: state where it is known, because next to edge-on
/// the sign of a product may disagree by rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Unit, pointing away from the surface.
    pub direction: DVec3,
    /// Whether it is on the side the outward normal points to.
    pub front: bool,
}

impl Leg {
    /// A direction, its side by its sign with the outward normal.
    #[inline]
    pub fn new(direction: DVec3, outward: DVec3) -> Self {
        Self { direction, front: direction.dot(outward) > 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_side_is_mirrored_in_the_facet() {
        let d = DVec3::new(0.6, 0.0, -0.8);
        assert_eq!(keep_side(d, DVec3::Z), (DVec3::new(0.6, 0.0, 0.8), true));
        assert_eq!(keep_side(d, -DVec3::Z), (d, false));
    }

    #[test]
    fn photon_behind_the_smooth_normal_uses_the_facet() {
        let at = Incidence {
            direction: DVec3::new(0.8, 0.0, -0.6),
            facet: DVec3::Z,
            smooth: DVec3::new(0.8, 0.0, 0.6),
            front: true,
            indices: [1.0; 2],
        };
        assert_eq!(at.working_normal(), (DVec3::Z, true));
    }

    #[test]
    fn normals_are_turned_to_the_side_of_arrival() {
        let hit = |front| Hit {
            t: 1.0,
            t_bound: 0.0,
            position: DVec3::ZERO,
            surface: crate::geometry::SurfaceId(0),
            primitive: 0,
            face: 0,
            normal: DVec3::Z,
            shading_normal: DVec3::new(0.6, 0.0, 0.8),
            front,
            body: crate::geometry::Body::Open,
            touch: None,
        };
        let front = Incidence::of(&hit(true), -DVec3::Z, [1.0; 2]);
        assert_eq!((front.facet, front.smooth), (DVec3::Z, DVec3::new(0.6, 0.0, 0.8)));
        let back = Incidence::of(&hit(false), DVec3::Z, [1.0; 2]);
        assert_eq!((back.facet, back.smooth), (-DVec3::Z, DVec3::new(-0.6, -0.0, -0.8)));
        assert!(front.front && !back.front);
        assert_eq!((front.outward(), back.outward()), (DVec3::Z, DVec3::Z));
    }
}
