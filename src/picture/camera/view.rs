//! A camera put into a scene.

use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::Whereabouts;
use crate::scene::Scene;
use crate::scene::camera::Camera;

use super::pinhole::Pinhole;

/// A camera with the scene before it, checked.
#[derive(Debug, Clone)]
pub struct View<'s> {
    /// The scene.
    pub scene: &'s Scene,
    /// The camera.
    pub camera: Camera,
    /// Its projection.
    pub pinhole: Pinhole,
    /// The side state of rays that start at it.
    pub start: Whereabouts,
    /// Seed of the pixels' samples.
    pub seed: u64,
}

/// Points of the rim of a lens that are looked at.
const RIM: u32 = 16;

impl<'s> View<'s> {
    /// A camera in a scene. `seed` is that of the pixels' samples. Inside glass, or any closed surface, is a
    /// place like others; the luminance is that in the medium there.
    ///
    /// # Errors
    /// A camera on a surface, where it is on neither side; a lens through which a closed surface
    /// passes.
    pub fn new(scene: &'s Scene, camera: &Camera, seed: u64) -> Result<Self> {
        let pinhole = Pinhole::new(camera);
        let geometry = &scene.geometry;
        let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Geometry, found, required));
        if let Some(surface) = geometry.surface_at(camera.position) {
            let name = geometry.name(surface);
            return fail(
                format!("the camera on surface \"{name}\""),
                "a camera off every surface: on one, it is on neither side",
            );
        }
        let behind = geometry.all_behind(camera.position);
        if pinhole.has_lens() {
            let rim =
                (0..RIM).map(|k| camera.position + pinhole.lens_point([1.0, f64::from(k) / f64::from(RIM)]));
            for point in rim {
                if geometry.all_behind(point) != behind {
                    return fail(
                        "the lens of the camera partly inside a closed surface".to_string(),
                        "a lens wholly on one side of every closed surface",
                    );
                }
            }
        }
        let start = Whereabouts::start(behind).in_ambient(scene.camera_ambient);
        Ok(Self { scene, camera: camera.clone(), pinhole, start, seed })
    }
}
