//! Units and the few constants that photometry fixes.
//!
//! Inside caustix lengths are metres, angles radians, flux lumens, intensity candela, illuminance lux. Degrees and
//! feet exist only where files are read (names end in `_deg`, `_ft`).

/// Luminance of a colour of linear RGB with the primaries of ITU-R BT.709: their relative luminances, 1 in all.
pub const LUMINANCE_OF_RGB: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The international foot in metres (exact).
pub const METRES_PER_FOOT: f64 = 0.3048;

/// Radians per degree.
pub const RADIANS_PER_DEGREE: f64 = std::f64::consts::PI / 180.0;
