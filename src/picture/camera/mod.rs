//! The eye: from a pixel along mirrors and through glass to a scattering surface, and what light is found
//! there.
//!
//! Photons carry flux, the eye radiance (luminance): an eye path that passes from a medium of index n1 into
//! one of n2 takes the factor (n1/n2)^2. docs/PICTURE.md, "The camera".
//!
//! [`View`] puts a camera into a scene; [`render()`] adds a [`Pass`] over its pixels to [`Sums`], of which
//! [`Sums::finish`] makes a [`Film`]. [`pinhole`] and [`filter`] are the way from pixels to rays and back,
//! [`eye`] is one path.

pub mod pinhole;
pub mod filter;
pub mod view;
pub mod pixel;
pub mod film;
pub mod eye;
pub mod render;
pub mod splat;

pub use eye::Pass;
pub use film::{Film, Sums};
#[cfg(any(test, feature = "internals"))]
pub use render::render;
pub use view::View;
