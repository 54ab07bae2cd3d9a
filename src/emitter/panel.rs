//! A Lambertian rectangle: equal luminance at all its points and in all directions on the side of its aim, dark on the
//! other side.
//!
//! Scene text: `type = "panel"`, `position` (the centre), `aim` (the normal of the lit side), `up`, `size = [w, h]`, w along
//! aim x up and h along up, `flux_lm`. It is light, not geometry: photons pass it unhindered.

use glam::{DMat3, DVec3};

use super::Emission;
use crate::sample::choose::Reusable;
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sequence::{Points, to_unit_f64};
use crate::surface::lambertian::cosine_direction;

/// A rectangle of constant luminance flux / (pi width height).
#[derive(Debug, Clone, Copy)]
pub struct Panel {
    centre: DVec3,
    /// Columns: aim x up, up, aim; unit.
    axes: DMat3,
    /// Along aim x up and along up, m.
    size_m: [f64; 2],
    flux_lm: f64,
}

impl Panel {
    /// A panel of this centre and size (m) that shines towards `aim`; `aim` and `up` are orthogonal unit vectors.
    pub fn new(centre: DVec3, aim: DVec3, up: DVec3, size_m: [f64; 2], flux_lm: f64) -> Self {
        Self { centre, axes: DMat3::from_cols(aim.cross(up), up, aim), size_m, flux_lm }
    }

    /// Luminous flux, lm.
    pub fn flux_lm(&self) -> f64 {
        self.flux_lm
    }

    /// The middle.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The normal of the lit side, unit.
    #[inline]
    pub fn aim(&self) -> DVec3 {
        self.axes.z_axis
    }

    /// Width along aim x up and height along up, m.
    #[inline]
    pub fn size_m(&self) -> [f64; 2] {
        self.size_m
    }

    /// x and y of a point of its plane, as [`Self::point`] counts them.
    #[inline]
    pub fn coordinates(&self, point: DVec3) -> [f64; 2] {
        let from_centre = point - self.centre;
        [
            from_centre.dot(self.axes.x_axis) / (0.5 * self.size_m[0]),
            from_centre.dot(self.axes.y_axis) / (0.5 * self.size_m[1]),
        ]
    }

    /// The point at x and y from the centre, each in halves of the size: -1 to 1.
    #[inline]
    pub fn point(&self, x: f64, y: f64) -> DVec3 {
        self.centre
            + self.axes.x_axis * (0.5 * self.size_m[0] * x)
            + self.axes.y_axis * (0.5 * self.size_m[1] * y)
    }

    /// A photon's start: uniform over the rectangle, cosine law about the aim.
    #[inline]
    pub fn emit<P: Points>(&self, u: Reusable, coordinates: &mut Coordinates<'_, P>) -> Emission {
        let x = coordinates.rest(u, Purpose::BeamPosition);
        let y = to_unit_f64(coordinates.draw(Purpose::BeamPosition));
        let u1 = to_unit_f64(coordinates.draw(Purpose::EmissionTheta));
        let u2 = to_unit_f64(coordinates.draw(Purpose::EmissionPhi));
        Emission {
            origin: self.point(2.0 * x - 1.0, 2.0 * y - 1.0),
            direction: (self.axes * cosine_direction(u1, u2)).normalize(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::owen::OwenPoints;

    #[test]
    fn moments_are_those_of_a_lambertian_rectangle() {
        let (aim, up) = (DVec3::NEG_Z, DVec3::X);
        let panel = Panel::new(DVec3::new(1.0, 2.0, 3.0), aim, up, [0.4, 3.0], 10.0);
        let points = OwenPoints::new(1, 0);
        let n = 1u64 << 14;
        let (mut across2, mut up2, mut cos, mut cos2, mut cross) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for i in 0..n {
            let mut c = Coordinates::new(&points, i, true);
            let u = c.draw_reusable(Purpose::Emission);
            let e = panel.emit(u, &mut c);
            assert_eq!(c.drawn(), 4);
            let d = e.origin - panel.centre();
            assert!(d.z == 0.0 && d.x.abs() <= 1.5 && d.y.abs() <= 0.2 + 1e-15);
            assert!(e.direction.z < 0.0);
            across2 += d.y * d.y;
            up2 += d.x * d.x;
            cos += e.direction.dot(aim);
            cos2 += e.direction.dot(aim).powi(2);
            cross += d.x * e.direction.x;
        }
        let mean = |sum: f64| sum / n as f64;
        assert!((mean(across2) - 0.04 / 3.0).abs() < 1e-5);
        assert!((mean(up2) - 0.75).abs() < 1e-3);
        assert!((mean(cos) - 2.0 / 3.0).abs() < 1e-4 && (mean(cos2) - 0.5).abs() < 1e-4);
        assert!(mean(cross).abs() < 3e-3, "place and direction are independent");
    }
}
