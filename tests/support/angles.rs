//! Photometric angles and world directions by their definitions: no code in common with the emitter.

use caustix::photometry::PhotometricType;
use glam::DVec3;

/// The luminaire's axes in the world: a the aim, u the part of up across it, r = a x u.
#[derive(Debug, Clone, Copy)]
pub struct Luminaire {
    pub a: DVec3,
    pub u: DVec3,
    pub r: DVec3,
}

impl Luminaire {
    /// From an aim and an up that need be neither unit nor perpendicular (Gram-Schmidt).
    pub fn new(aim: DVec3, up: DVec3) -> Self {
        let a = aim.normalize();
        let u = (up - a * up.dot(a)).normalize();
        Self { a, u, r: a.cross(u) }
    }

    /// (V, H) in degrees of a world direction: H of type C in [0, 360), all others in (-180, 180].
    pub fn angles_deg(&self, kind: PhotometricType, d: DVec3) -> (f64, f64) {
        let (a, u, r) = (d.dot(self.a), d.dot(self.u), d.dot(self.r));
        let degrees = |y: f64, x: f64| y.atan2(x).to_degrees();
        match kind {
            // H from up towards u x a = -r.
            PhotometricType::C => (degrees(u.hypot(r), a), degrees(-r, u).rem_euclid(360.0)),
            PhotometricType::A => (degrees(u, a.hypot(r)), degrees(r, a)),
            PhotometricType::B => (degrees(u, a), degrees(r, a.hypot(u))),
        }
    }

    /// The world direction of (V, H) in degrees: rotations of the aim, one after the other.
    pub fn direction(&self, kind: PhotometricType, v_deg: f64, h_deg: f64) -> DVec3 {
        let (v, h) = (v_deg.to_radians(), h_deg.to_radians());
        match kind {
            // Tilt from the aim towards up by V, then turn by H about the aim, counter-clockwise seen from behind the
            // luminaire: against the right-handed sense about the aim.
            PhotometricType::C => rotate(rotate(self.a, self.a.cross(self.u), v), self.a, -h),
            // Type A turns by H towards r first, then lifts by V along that meridian.
            PhotometricType::A => {
                let turned = rotate(self.a, self.a.cross(self.r), h);
                rotate(turned, turned.cross(self.u), v)
            }
            // Type B lifts by V first, then turns by H towards r.
            PhotometricType::B => {
                let lifted = rotate(self.a, self.a.cross(self.u), v);
                rotate(lifted, lifted.cross(self.r), h)
            }
        }
    }
}

/// v turned by an angle about a unit axis, right-handed (Rodrigues).
fn rotate(v: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    let (sin, cos) = angle.sin_cos();
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}
