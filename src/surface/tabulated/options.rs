//! How a scattering table is put on a surface.

use crate::surface::Reference;

/// What is done about albedos above 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Energy {
    /// They are an error.
    #[default]
    Refuse,
    /// Incidences with an albedo above 1 are scaled to 1, with a warning.
    Scale,
}

/// Which side of the surface a table's lobes are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sides {
    /// The table's front is the side the outward normal points to. A side for which the table has no lobe
    /// absorbs.
    Front,
    /// The table's front is the other side.
    Back,
    /// As [`Self::Front`], and a side for which the table has no lobe is like the other one.
    #[default]
    Both,
}

/// How a table is put on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// What is done about albedos above 1.
    pub energy: Energy,
    /// Which side is which.
    pub sides: Sides,
    /// The surface's reference direction. Only tables with several phi_i depend on it.
    pub reference: Reference,
    /// Turn of the table's reference direction against the surface's, counter-clockwise seen from the tip of
    /// the outward normal.
    pub rotation_deg: f64,
    /// What the table leaves of the light goes on: straight through where the table transmits light of this
    /// side, mirrored where it only reflects it.
    pub specular_remainder: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            energy: Energy::default(),
            sides: Sides::default(),
            reference: Reference::default(),
            rotation_deg: 0.0,
            specular_remainder: false,
        }
    }
}
