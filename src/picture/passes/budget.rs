//! How many photons a range may leave, and how many it is likely to.

use crate::picture::photon_map::Photon;
use crate::scene::camera::Camera;

/// Most photons that the camera has memory for at a time.
pub(crate) fn capacity<const C: usize>(camera: &Camera) -> usize {
    // While its map is made a photon takes room as it was kept, and in the map with its index.
    let bytes_of_photon = 2 * size_of::<Photon<C>>() as u64 + 8;
    usize::try_from(camera.photon_memory_bytes / bytes_of_photon).unwrap_or(usize::MAX).max(1)
}

/// What photons may leave above what is foretold: an eighth and some, so that few ranges are traced twice.
pub(crate) fn with_reserve(photons: f64) -> f64 {
    1.125 * photons + 1024.0
}

/// Photons kept against the memory for them.
pub(crate) struct Budget {
    /// Most photons at a time.
    capacity: usize,
    /// Photons held for the next pass.
    pub(crate) held: usize,
    /// Photons traced so far, and those of them that were kept.
    pub(crate) traced: u64,
    pub(crate) kept: u64,
    /// Whether all photons are to be handed out; no longer once they are more than there is room for.
    pub(crate) keep: bool,
}

impl Budget {
    pub(crate) fn new(capacity: usize, keep: bool) -> Self {
        Self { capacity, held: 0, traced: 0, kept: 0, keep }
    }

    /// Photons that there is room for beside those held.
    pub(crate) fn room(&self) -> usize {
        self.capacity.saturating_sub(self.held)
    }

    /// Photons that so many traced ones are likely to leave; 0 while nothing is known, and where all are kept
    /// if they can be: only that they cannot is a reason then.
    pub(crate) fn foretold(&self, photons: u64) -> usize {
        if self.traced == 0 || self.keep {
            return 0;
        }
        with_reserve(photons as f64 * (self.kept as f64 / self.traced as f64)) as usize
    }

    /// Where the next range ends: at `end`, or where as many photons as there is memory for are to be
    /// expected. Ranges cut by memory are a power of two long and begin at a multiple of it: each is a net by
    /// itself.
    pub(crate) fn next_end(&self, from: u64, end: u64) -> u64 {
        let mut length = end - from;
        if self.foretold(length) <= self.capacity {
            return end;
        }
        length = length.next_power_of_two();
        while length > 1 && self.foretold(length) > self.capacity {
            length /= 2;
        }
        end.min((from / length + 1) * length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::camera::CameraSpec;
    use glam::DVec3;

    #[test]
    fn memory_is_for_photons_as_kept_and_as_mapped() {
        let of = |photon_memory_bytes| {
            let spec = CameraSpec::pinhole(DVec3::ZERO, DVec3::X, DVec3::Z, 40.0, [1, 1]);
            Camera::new(CameraSpec { photon_memory_bytes, ..spec }).unwrap()
        };
        // 28 and 36 bytes, twice, and 8 of the index.
        assert_eq!(capacity::<1>(&of(6400)), 100);
        assert_eq!((capacity::<3>(&of(8000)), capacity::<3>(&of(7999))), (100, 99));
        assert_eq!(capacity::<1>(&of(1)), 1);
    }

    #[test]
    fn what_is_likely_comes_from_what_was_and_a_reserve() {
        let mut budget = Budget::new(10_000, false);
        assert_eq!((budget.foretold(1 << 40), budget.room()), (0, 10_000));
        (budget.traced, budget.kept, budget.held) = (1000, 500, 9_000);
        assert_eq!(budget.foretold(1600), 900 + 1024);
        assert_eq!(budget.room(), 1000);
        budget.held = 10_001;
        assert_eq!(budget.room(), 0);
        budget.keep = true;
        assert_eq!(budget.foretold(1600), 0);
    }

    #[test]
    fn ranges_cut_by_memory_are_nets() {
        let mut budget = Budget::new(10_000, false);
        // Nothing known: all at once.
        assert_eq!(budget.next_end(0, 1 << 20), 1 << 20);
        (budget.traced, budget.kept) = (1000, 1000);
        // 1.125 n + 1024 <= 10000 up to n = 7978: whole where it fits, else the next multiple of 4096.
        assert_eq!(budget.next_end(22, 8000), 8000);
        assert_eq!(budget.next_end(0, 8000), 4096);
        assert_eq!(budget.next_end(4096, 100_000), 8192);
        assert_eq!(budget.next_end(5000, 100_000), 8192);
        // No room even for one: one at a time.
        let hopeless = Budget { capacity: 1, ..budget };
        assert_eq!(hopeless.next_end(77, 1 << 20), 78);
    }
}
