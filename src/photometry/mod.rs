//! Photometric files: reading, symmetry, flux, summary.
