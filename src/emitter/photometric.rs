//! A point emitter with a table of luminous intensity, sampled by inverse functions (METHOD 3).
//!
//! Scene text: `type = "photometric"`, `file`, `position`, `aim`, `up`, `flux_lm` (optional, rescales).
//!
//! Frame (docs/PHOTOMETRIC_FRAME.md): with the aim a, the up direction u made perpendicular to it and r = a x u, the
//! direction of the angles (V, H) is
//!
//! | type | direction |
//! |---|---|
//! | C | sin V (cos H u + sin H (u x a)) + cos V a |
//! | A | cos V (cos H a + sin H r) + sin V u |
//! | B | cos H (cos V a + sin V u) + sin H r |

use glam::{DMat3, DVec3};

use super::Emission;
use crate::error::{Diagnostic, Kind, Result};
use crate::math::frame::frame_from_axis;
use crate::math::solve::Solver;
use crate::photometry::Photometry;
use crate::photometry::web::PhotometricType;
use crate::sample::cell::GridPoint;
use crate::sample::choose::Reusable;
use crate::sample::coordinates::Coordinates;
use crate::sample::grid::Grid;
use crate::sample::method::Sampling;
use crate::sample::uniform_map::UniformMap;
use crate::sequence::Points;

/// A photometric point emitter.
#[derive(Debug, Clone)]
pub struct Photometric {
    grid: Grid,
    /// Columns: where the grid's x, y and polar axis z point in the world.
    axes: DMat3,
    position: DVec3,
    flux_lm: f64,
    /// Candela per unit of the grid's value.
    scale: f64,
}

/// Axes of the unfolded grid (polar axis z, azimuth from x towards y) in the world, for each photometric type.
///
/// # Errors
/// `aim` or `up` without a direction, or parallel to each other.
pub fn grid_axes(kind: PhotometricType, aim: DVec3, up: DVec3) -> Result<DMat3> {
    let frame = frame_from_axis(aim, up).ok_or_else(|| {
        Diagnostic::new(
            Kind::Range,
            format!("aim {aim} and up {up}"),
            "two directions that are neither zero nor parallel",
        )
    })?;
    let (u, a) = (frame.x_axis, frame.z_axis);
    let r = a.cross(u);
    Ok(match kind {
        PhotometricType::C => DMat3::from_cols(u, u.cross(a), a),
        // Polar angle V + 90 degrees: from the direction that V = -90 names.
        PhotometricType::A => DMat3::from_cols(a, r, -u),
        // Polar angle H + 90 degrees, azimuth V.
        PhotometricType::B => DMat3::from_cols(a, u, -r),
    })
}

impl Photometric {
    /// The emitter of a photometric file. `flux_lm` rescales it; without, the file's candela stand, times ballast factor
    /// and (1986, 1991) field 12.
    ///
    /// # Errors
    /// A table that emits nothing; an aim and up without a frame.
    pub fn new(
        photometry: &Photometry,
        position: DVec3,
        aim: DVec3,
        up: DVec3,
        flux_lm: Option<f64>,
    ) -> Result<Self> {
        let full = photometry.web.full_grid();
        let grid = Grid::new(&full.polar_rad, &full.azimuth_rad, &full.intensity_cd)?;
        let emitted_lm = grid.integral() * photometry.factor();
        let flux_lm = flux_lm.unwrap_or(emitted_lm);
        let axes = grid_axes(photometry.web.photometric_type, aim, up)?;
        let scale = flux_lm / grid.integral();
        Ok(Self { grid, axes, position, flux_lm, scale })
    }

    /// Luminous flux, lm.
    pub fn flux_lm(&self) -> f64 {
        self.flux_lm
    }

    /// Where it is.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The sampler's table.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Luminous intensity towards a direction (unit), cd.
    pub fn intensity_cd(&self, direction: DVec3) -> f64 {
        let local = self.axes.transpose() * direction;
        let theta = libm::atan2(libm::hypot(local.x, local.y), local.z);
        let phi = libm::atan2(local.y, local.x);
        // The grid's azimuth starts at 0 (type C) or at -90 degrees (A, B): try the turn that fits.
        let turned = if phi < 0.0 { phi + 2.0 * std::f64::consts::PI } else { phi };
        self.scale * self.grid.value(theta, phi).max(self.grid.value(theta, turned))
    }

    /// A photon's start: the cell by its flux, theta and phi by inverse functions.
    #[inline]
    pub fn emit<P: Points>(
        &self,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
        solver: Solver,
    ) -> Emission {
        self.start(self.grid.draw_inverse(u, coordinates, solver))
    }

    /// The same by a given way of sampling; `None` where this point of the sequence gives none.
    #[inline]
    pub fn emit_by<P: Points>(
        &self,
        sampling: Sampling,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<Emission> {
        self.grid.draw(sampling, u, coordinates).map(|point| self.start(point))
    }

    /// A photon's start with a direction uniform in solid angle where the table is not zero, and the weight (1 on average)
    /// that makes its intensity the table's.
    pub fn emit_weighted<P: Points>(
        &self,
        map: &UniformMap,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> (Emission, f64) {
        let (point, weight) = map.sample(&self.grid, u, coordinates);
        (self.start(point), weight)
    }

    #[inline]
    fn start(&self, point: GridPoint) -> Emission {
        Emission { origin: self.position, direction: self.axes * point.direction }
    }
}
