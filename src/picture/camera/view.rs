//! A camera put into a scene.

use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::Whereabouts;
use crate::picture::camera::pinhole::Pinhole;
use crate::scene::Scene;
use crate::scene::camera::CameraSpec;

/// A camera with the scene before it, checked.
#[derive(Debug, Clone)]
pub struct View<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) spec: CameraSpec,
    pub(crate) pinhole: Pinhole,
    pub(crate) start: Whereabouts,
    pub(crate) seed: u64,
}

/// Points of the rim of a lens that are looked at.
const RIM: u32 = 16;

impl<'s> View<'s> {
    /// A camera in a scene. `seed` is that of the pixels' samples. Inside glass, or any closed surface, is a place like
    /// others; the luminance is that in the medium there.
    ///
    /// # Errors
    /// What [`Pinhole::new`] refuses; a camera on a surface, where it is on neither side; a lens through which a closed surface
    /// passes.
    pub fn new(scene: &'s Scene, spec: &CameraSpec, seed: u64) -> Result<Self> {
        let pinhole = Pinhole::new(spec)?;
        let geometry = &scene.geometry;
        let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Geometry, found, required));
        if let Some(surface) = geometry.surface_at(spec.position) {
            let name = &geometry.surfaces()[surface.0 as usize].name;
            return fail(
                format!("the camera on surface \"{name}\""),
                "a camera off every surface: on one, it is on neither side",
            );
        }
        let behind = geometry.all_behind(spec.position);
        if pinhole.has_lens() {
            let rim =
                (0..RIM).map(|k| spec.position + pinhole.lens_point([1.0, f64::from(k) / f64::from(RIM)]));
            for point in rim {
                if geometry.all_behind(point) != behind {
                    return fail(
                        "the lens of the camera partly inside a closed surface".to_string(),
                        "a lens wholly on one side of every closed surface",
                    );
                }
            }
        }
        Ok(Self { scene, spec: spec.clone(), pinhole, start: Whereabouts::start(behind), seed })
    }

    /// The projection.
    pub fn pinhole(&self) -> &Pinhole {
        &self.pinhole
    }

    /// The scene.
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }

    /// The side state of rays that start at the camera.
    pub fn start(&self) -> Whereabouts {
        self.start
    }

    /// The camera.
    pub fn spec(&self) -> &CameraSpec {
        &self.spec
    }
}
