//! What EULUMDAT says beside the intensities: lamp sets, and the lines that LM-63 has no field for.

use serde::Serialize;

/// One lamp set of a EULUMDAT file. Sets are alternatives, never a sum: intensities hold for one of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LampSet {
    /// Number of lamps; negative for absolute photometry, as it is written.
    pub count: f64,
    /// Kind of lamps, as text.
    pub kind: String,
    /// Lumens of all lamps of the set together, or of the luminaire in absolute photometry.
    pub flux_lm: f64,
    /// Colour appearance, as text: `4000`, `nw`.
    pub colour: String,
    /// Colour rendering, as text: `80`, `1B/80`, `>90`.
    pub cri: String,
    /// Watts with their gear; 0 where the file does not know it.
    pub watts: f64,
}

impl LampSet {
    /// Whether the intensities are those of the luminaire as measured, not of bare lamps of these lumens.
    pub fn is_absolute(&self) -> bool {
        self.count < 0.0
    }
}

/// The lines of a EULUMDAT file that LM-63 has no field for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EulumdatHead {
    /// Ityp: 0 or 1 point source with symmetry about the vertical axis, 2 linear, 3 other. A label: it
    /// decides nothing.
    pub ityp: u32,
    /// Isym, which planes are stored: 0 all, 1 one, 2 C0..C180, 3 C270..C90, 4 C0..C90.
    pub isym: u32,
    /// Mc, the number of C planes of the whole circle.
    pub c_planes: usize,
    /// Luminaire: length (along C90-C270) or diameter, width (along C0-C180; 0 where it is round), height, m.
    pub luminaire_size_m: [f64; 3],
    /// Downward flux fraction, per cent, as declared.
    pub downward_fraction_percent: f64,
    /// Light output ratio of the luminaire (LORL), per cent, as declared; 0 where it is not stated. It is in
    /// the intensities already.
    pub light_output_ratio_percent: f64,
    /// Conversion factor of the intensities, which is in `multiplier`.
    pub conversion: f64,
    /// Tilt of the luminaire during measurement, degrees. Shown only.
    pub measured_tilt_deg: f64,
    /// Direct ratios for room indices k = 0.6, 0.8, 1, 1.25, 1.5, 2, 2.5, 3, 4, 5, as declared.
    pub direct_ratios: [f64; 10],
}
