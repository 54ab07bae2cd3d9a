//! A point emitter with a table of luminous intensity, sampled by inverse functions (METHOD 3).
//!
//! Scene text: `type = "photometric"`, `file`, `position`, `aim`, `up`, `flux_lm` (optional, rescales), `tilt_deg`, `lamp_set`.
//!
//! Frame (docs/PHOTOMETRIC_FRAME.md): with the aim a, the up direction u made perpendicular to it and r = a x u, the
//! direction of the angles (V, H) is
//!
//! | type | direction |
//! |---|---|
//! | C | sin V (cos H u + sin H (u x a)) + cos V a |
//! | A | cos V (cos H a + sin H r) + sin V u |
//! | B | cos H (cos V a + sin V u) + sin H r |

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::{AimFrame, DirectLight, Emission, Emits, EmitterKind, FLUX};
use crate::error::Invalid;
use crate::error::invalid::positive;
use crate::geometry::COORDINATE;
use crate::math::frame::frame_from_axis;
use crate::photometry::Photometry;
use crate::photometry::web::PhotometricType;
use crate::sample::choose::Reusable;
use crate::sample::coordinates::Coordinates;
use crate::sample::grid::Grid;
use crate::sample::method::Sampling;
use crate::sample::uniform_map::UniformMap;
use crate::sequence::Points;

/// A photometric point emitter.
#[derive(Debug, Clone)]
pub struct Photometric {
    grid: Arc<Grid>,
    /// Columns: where the grid's x, y and polar axis z point in the world.
    axes: DMat3,
    position: DVec3,
    flux_lm: f64,
    /// What the file says, with its factors, lm.
    file_flux_lm: f64,
    /// Candela per unit of the grid's value.
    scale: f64,
    /// The longest side of the file's luminous opening, m.
    opening_m: f64,
    /// Of references: directions uniform in solid angle, with weights.
    uniform: Option<Arc<UniformMap>>,
}

/// Axes of the unfolded grid (polar axis z, azimuth from x towards y) in the world, for each photometric type.
///
/// # Errors
/// None for a frame, whose directions are neither zero nor parallel.
pub fn grid_axes(kind: PhotometricType, frame: AimFrame) -> Result<DMat3, Invalid> {
    let parallel = Invalid::Parallel { what: "up", to: "aim" };
    let frame = frame_from_axis(frame.aim(), frame.up()).ok_or(parallel)?;
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

/// What a table's sampler refuses, as the file's fault.
fn of_file(refused: impl Into<crate::error::Diagnostic>) -> Invalid {
    let refused = refused.into();
    Invalid::Content { what: "file", found: refused.found().into(), required: refused.required().into() }
}

impl Photometric {
    /// The emitter of a photometric file at `position` (m). `flux_lm` is what it emits; without, the file's candela stand, times
    /// [`Photometry::factor`].
    ///
    /// # Errors
    /// A table that emits nothing; a position or flux out of range or not a number.
    pub fn new(
        photometry: &Photometry,
        position: DVec3,
        frame: AimFrame,
        flux_lm: Option<f64>,
    ) -> Result<Self, Invalid> {
        Self::with_factor(photometry, photometry.factor(), position, frame, flux_lm)
    }

    /// The same, mounted at this tilt: with the factor of the file's tilt table there ([`Photometry::factor_at_tilt`]). `aim` turns
    /// the lamp, the tilt does not. A `flux_lm` is what is emitted, whatever the tilt.
    ///
    /// # Errors
    /// Those of [`Self::new`]; a file without a tilt table, a tilt outside it.
    pub fn at_tilt(
        photometry: &Photometry,
        tilt_deg: f64,
        position: DVec3,
        frame: AimFrame,
        flux_lm: Option<f64>,
    ) -> Result<Self, Invalid> {
        Self::with_factor(photometry, photometry.factor_at_tilt(tilt_deg)?, position, frame, flux_lm)
    }

    fn with_factor(
        photometry: &Photometry,
        factor: f64,
        position: DVec3,
        frame: AimFrame,
        flux_lm: Option<f64>,
    ) -> Result<Self, Invalid> {
        let full = photometry.web.full_grid();
        let grid = Grid::new(&full.polar_rad, &full.azimuth_rad, &full.intensity_cd).map_err(of_file)?;
        let file_flux_lm = grid.integral() * factor;
        let flux_lm = match flux_lm {
            Some(flux_lm) => FLUX.check("flux_lm", flux_lm)?,
            None => positive("flux_lm", file_flux_lm, "a file of positive flux")?,
        };
        let axes = grid_axes(photometry.web.photometric_type, frame)?;
        let (scale, position) = (flux_lm / grid.integral(), COORDINATE.vector("position", position)?);
        let opening_m = photometry.opening.size_m.into_iter().fold(0.0, f64::max);
        Ok(Self {
            grid: Arc::new(grid),
            axes,
            position,
            flux_lm,
            file_flux_lm,
            scale,
            opening_m,
            uniform: None,
        })
    }

    /// The same light for references: directions uniform in solid angle where the table is not zero, with weights (1 on
    /// average) that make their intensity the table's.
    ///
    /// # Errors
    /// None for an emitter, whose table emits.
    pub(super) fn with_weights(&self) -> Result<Self, Invalid> {
        let map = UniformMap::new(&self.grid).map_err(of_file)?;
        Ok(Self { uniform: Some(Arc::new(map)), ..self.clone() })
    }

    /// The flux of the file as it stands, times ballast factor, (1986, 1991) field 12 and tilt factor, lm: what the lamp emits
    /// where nothing rescales it.
    pub fn file_flux_lm(&self) -> f64 {
        self.file_flux_lm
    }

    /// The longest side of the luminous opening that the file was measured with, m; 0 where it is a point. Light leaves from
    /// the point all the same.
    pub fn opening_m(&self) -> f64 {
        self.opening_m
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
}

impl Emits for Photometric {
    fn flux_lm(&self) -> f64 {
        self.flux_lm
    }

    fn position(&self) -> DVec3 {
        self.position
    }

    /// By inverse functions: the cell by its flux, theta and phi inside it.
    #[inline]
    fn emit<P: Points>(
        &self,
        sampling: Sampling,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<Emission> {
        let (point, weight) = match &self.uniform {
            None => (self.grid.draw(sampling, u, coordinates)?, 1.0),
            Some(map) => map.sample(&self.grid, u, coordinates),
        };
        Some(Emission { origin: self.position, direction: self.axes * point.direction, weight })
    }

    /// The tabulated intensity itself over the square of the distance.
    fn direct_light(&self, point: DVec3, _: [f64; 2]) -> Option<DirectLight> {
        DirectLight::from_point(self.position, point, |direction| self.intensity_cd(direction))
    }

    fn table(&self) -> Option<&Grid> {
        Some(&self.grid)
    }

    #[inline]
    fn kind(&self) -> EmitterKind {
        EmitterKind::new("point", (0, "photometric table"))
    }
}
