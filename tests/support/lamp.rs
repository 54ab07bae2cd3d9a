//! Light of a luminaire that meets a surface straight, from the file's own table: nothing of the sampler is
//! used.

use caustix::files::photometric;
use caustix::photometry::Photometry;
use caustix::photometry::web::PhotometricType;
use glam::DVec3;

use super::data::own_file;

/// A luminaire as docs/PHOTOMETRIC_FRAME.md places it.
pub struct Lamp {
    photometry: Photometry,
    position: DVec3,
    aim: DVec3,
    up: DVec3,
}

impl Lamp {
    /// One of the project's photometric files.
    pub fn new(file: &str, position: DVec3, aim: DVec3, up: DVec3) -> Self {
        let photometry = photometric::read(own_file(file)).unwrap();
        let aim = aim.normalize();
        let up = (up - up.dot(aim) * aim).normalize();
        Self { photometry, position, aim, up }
    }

    /// Luminous intensity towards a direction (unit), cd: bilinear in the file's vertical and horizontal
    /// angles.
    pub fn intensity_cd(&self, direction: DVec3) -> f64 {
        let right = self.aim.cross(self.up);
        let [a, u, r] = [self.aim, self.up, right].map(|axis| direction.dot(axis));
        let (v, h) = match self.photometry.web.photometric_type {
            // u x a = -r.
            PhotometricType::C => (a.clamp(-1.0, 1.0).acos(), (-r).atan2(u)),
            PhotometricType::A => (u.clamp(-1.0, 1.0).asin(), r.atan2(a)),
            PhotometricType::B => (u.atan2(a), r.clamp(-1.0, 1.0).asin()),
        };
        self.photometry.web.intensity_cd(v.to_degrees(), h.to_degrees()) * self.photometry.factor()
    }

    /// Illuminance at a point of a surface of this normal (unit), on the side that the normal points to, lx.
    pub fn illuminance_lx(&self, point: DVec3, normal: DVec3) -> f64 {
        let to = point - self.position;
        let distance = to.length();
        self.intensity_cd(to / distance) * -normal.dot(to / distance) / (distance * distance)
    }

    /// The same as it is seen in a mirror in the plane x = `x`; the normal is along that plane.
    pub fn mirrored_illuminance_lx(&self, x: f64, point: DVec3, normal: DVec3) -> f64 {
        self.illuminance_lx(DVec3::new(2.0 * x - point.x, point.y, point.z), normal)
    }
}
