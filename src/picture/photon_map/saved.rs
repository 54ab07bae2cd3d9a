//! Photons kept for another view of the same light.

use crate::surface::luminance_of;

use super::record::{Frame, Photon};

/// Photons with all that is needed to use them again. `C` channels: 1 or 3.
#[derive(Debug, Clone, PartialEq)]
pub struct SavedMap<const C: usize> {
    /// SHA-256 of the scene and its files.
    pub scene_hash: String,
    /// How they were traced, in words for the report.
    pub settings: String,
    /// Photons traced in all: those kept are some of the arrivals of these.
    pub photons_traced: u64,
    /// Replicates they were traced in.
    pub replicates: u32,
    /// Flux of one photon, lm.
    pub photon_lm: f64,
    /// What positions are counted in.
    pub frame: Frame,
    /// The photons.
    pub photons: Vec<Photon<C>>,
}

impl<const C: usize> SavedMap<C> {
    /// The same photons in another number of channels, 1 or 3: in three, one channel is white; three make one
    /// by their luminance, exactly where no surface coloured them.
    pub fn in_channels<const D: usize>(self) -> SavedMap<D> {
        let Self { scene_hash, settings, photons_traced, replicates, photon_lm, frame, photons } = self;
        let in_channels = |p: Photon<C>| {
            let weight: [f64; C] = p.weight.map(f64::from);
            let weight =
                if C == D { std::array::from_fn(|c| p.weight[c]) } else { [luminance_of(&weight) as f32; D] };
            let Photon { cell, direction, primitive, tag, .. } = p;
            Photon { cell, direction, primitive, tag, weight }
        };
        let photons = photons.into_iter().map(in_channels).collect();
        SavedMap { scene_hash, settings, photons_traced, replicates, photon_lm, frame, photons }
    }
}
