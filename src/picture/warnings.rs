//! What a picture says of itself: where eye paths found that the scene is not what its pixels would be right for.

use std::sync::atomic::AtomicBool;

use crate::error::Result;
use crate::error::warning::Warning;
use crate::geometry::SurfaceId;
use crate::picture::camera::render::{Rendered, render};
use crate::picture::camera::{Pass, Sums, View};
use crate::run::warnings::{contradiction, percent};
use crate::scene::Scene;
use crate::scene::camera::{Camera, CameraSpec};

use super::PictureSummary;

/// The warnings of a picture.
pub fn warnings(scene: &Scene, summary: &PictureSummary) -> Vec<Warning> {
    let of = |(&surface, &count): (&SurfaceId, &u64)| {
        let (name, share) =
            (scene.geometry.name(surface), count as f64 / (summary.eye_paths as f64).max(1.0));
        let message = format!(
            "{} of all eye paths reached surface \"{name}\" in another medium than the scene says is there",
            percent(share)
        );
        contradiction(scene, surface, share, message)
    };
    summary.eye_paths_contradicted.iter().map(of).collect()
}

/// Columns and rows of a probe, at most.
const PROBE: u32 = 64;

/// What a picture of few pixels says of itself, where the scene has a camera. Nothing is lit.
///
/// # Errors
/// A camera that sees nothing.
pub fn probe(scene: &Scene, interrupt: &AtomicBool) -> Result<Vec<Warning>> {
    let Some(camera) = &scene.camera else { return Ok(Vec::new()) };
    let pixels = camera.pixels.map(|n| n.min(PROBE));
    let camera = Camera::new(CameraSpec { pixels, samples: 1, ..CameraSpec::clone(camera) })?;
    let (view, mut sums) = (View::new(scene, &camera, 0)?, Sums::<3>::new(pixels)?);
    let Rendered { paths, contradicted, .. } = render(&view, &Pass::EMISSION, &mut sums, interrupt, &|_| {})?;
    let summary = PictureSummary {
        eye_paths: paths,
        eye_paths_contradicted: contradicted,
        ..PictureSummary::default()
    };
    Ok(warnings(scene, &summary))
}
