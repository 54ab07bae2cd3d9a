//! The eye: from a pixel along mirrors and through glass to a scattering surface, and what light is found there.
//!
//! Photons carry flux, the eye radiance (luminance): an eye path that passes from a medium of index n1 into one of n2 takes
//! the factor (n1/n2)^2. docs/METHOD.md, "The picture".

pub mod film;
pub mod splat;

pub use film::Film;
