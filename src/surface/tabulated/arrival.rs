//! Light on its way to a point of a surface: its angles, and the frames in which a table counts scattered
//! directions.

use glam::{DMat3, DVec3};

use crate::scattering::{Frame, Quantity};

/// Where light comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrival {
    /// Normal on the side it comes from.
    normal: DVec3,
    /// t: the direction along the surface in which mirrored and straight-through light go on.
    onward: DVec3,
    sin: f64,
    cos: f64,
}

impl Arrival {
    /// Light from wi (unit, pointing away from the surface) on the side of the unit normal. `tangent` is
    /// asked where there is no plane of incidence: light then counts as coming from its side.
    #[inline]
    pub fn new(wi: DVec3, normal: DVec3, along_tangent: impl FnOnce() -> DVec3) -> Self {
        // Edge-on, rounding may put the direction on the other side of the facet it arrived at.
        let cos = wi.dot(normal).clamp(0.0, 1.0);
        let along = wi - cos * normal;
        let sin = along.length();
        let onward = if sin > 0.0 { along / -sin } else { -along_tangent().normalize() };
        Self { normal, onward, sin: sin.min(1.0), cos }
    }

    /// theta_i.
    #[inline]
    pub fn theta(&self) -> f64 {
        libm::atan2(self.sin, self.cos)
    }

    /// phi_i, counter-clockwise about the normal from a tangent of any length.
    #[inline]
    pub fn phi(&self, tangent: DVec3) -> f64 {
        libm::atan2(-self.onward.dot(self.normal.cross(tangent)), -self.onward.dot(tangent))
    }

    /// m: the normal of the side that light leaves on.
    #[inline]
    pub fn outgoing_normal(&self, quantity: Quantity) -> DVec3 {
        match quantity {
            Quantity::Reflection => self.normal,
            Quantity::Transmission => -self.normal,
        }
    }

    /// Where mirrored or straight-through light goes.
    #[inline]
    pub fn specular(&self, quantity: Quantity) -> DVec3 {
        self.sin * self.onward + self.cos * self.outgoing_normal(quantity)
    }

    /// The frame of scattered directions (columns: azimuth 0, azimuth 90 degrees, pole), as
    /// [`crate::scattering::table`] defines it.
    #[inline]
    pub fn axes(&self, frame: Frame, quantity: Quantity) -> DMat3 {
        let m = self.outgoing_normal(quantity);
        match frame {
            Frame::Surface => DMat3::from_cols(self.onward, self.normal.cross(self.onward), m),
            Frame::Specular => {
                let pole = self.specular(quantity);
                let x = self.sin * m - self.cos * self.onward;
                DMat3::from_cols(x, pole.cross(x), pole)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_stand_as_the_table_says() {
        // Light from +x, 30 degrees off the normal z: it goes on towards -x.
        let wi = DVec3::new(0.5, 0.0, 0.75f64.sqrt());
        let arrival = Arrival::new(wi, DVec3::Z, || unreachable!());
        assert!((arrival.theta().to_degrees() - 30.0).abs() < 1e-13);
        assert!(arrival.phi(DVec3::X).abs() < 1e-15);
        assert!((arrival.phi(-DVec3::Y).to_degrees() - 90.0).abs() < 1e-13);
        let close = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-15, "{a} {b}");
        close(arrival.specular(Quantity::Reflection), DVec3::new(-wi.x, 0.0, wi.z));
        close(arrival.specular(Quantity::Transmission), -wi);
        let surface = arrival.axes(Frame::Surface, Quantity::Transmission);
        close(surface.x_axis, -DVec3::X);
        close(surface.y_axis, -DVec3::Y);
        close(surface.z_axis, -DVec3::Z);
        for quantity in [Quantity::Reflection, Quantity::Transmission] {
            let m = arrival.outgoing_normal(quantity);
            let axes = arrival.axes(Frame::Specular, quantity);
            assert!((axes.determinant() - 1.0).abs() < 1e-15);
            close(axes.z_axis, arrival.specular(quantity));
            assert!(axes.x_axis.dot(m) > 0.0 && axes.y_axis.dot(m).abs() < 1e-16);
        }
    }

    #[test]
    fn normal_incidence_is_the_limit_from_the_reference_direction() {
        let tangent = DVec3::new(0.6, 0.8, 0.0);
        for normal in [DVec3::Z, -DVec3::Z] {
            let at = Arrival::new(normal, normal, || tangent);
            let near = Arrival::new((normal + 1e-9 * tangent).normalize(), normal, || unreachable!());
            assert_eq!(at.phi(tangent), 0.0);
            for frame in [Frame::Surface, Frame::Specular] {
                let (a, b) = (at.axes(frame, Quantity::Reflection), near.axes(frame, Quantity::Reflection));
                assert!((a.x_axis - b.x_axis).length() < 1e-6 && (a.y_axis - b.y_axis).length() < 1e-6);
            }
        }
    }
}
