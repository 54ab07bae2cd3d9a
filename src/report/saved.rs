//! report.json of a picture of saved photons: what was read, how it had been traced, what the camera made of it.

use std::path::Path;

use serde::Serialize;

use crate::error::warning::Warning;
use crate::run::Plan;
use crate::scene::Scene;

use super::camera::CameraReport;
use super::json::RunReport;

/// Everything report.json says where nothing was traced. What it shares with [`super::Report`] has the same names; flux and
/// receivers are in the report of the run that saved the photons. Names are a contract: they are only added to.
#[derive(Debug, Clone, Serialize)]
pub struct SavedReport {
    /// What was run.
    #[serde(flatten)]
    pub run: RunReport,
    /// Replicates they were traced in.
    pub replicates: u32,
    /// The file of photons, as given.
    pub map: String,
    /// Times.
    pub time: SavedTime,
    /// The camera.
    pub camera: CameraReport,
    /// "photons": all that were asked for are in the picture.
    pub stopped_by: &'static str,
    /// Warnings about the picture, the scene and its files.
    pub warnings: Vec<String>,
}

/// Times of a [`SavedReport`].
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SavedTime {
    /// Everything from reading the scene on, s.
    pub total_s: f64,
}

impl SavedReport {
    /// The report of a picture of the photons in this file, which a run by this plan saved.
    pub fn new(
        scene: &Scene,
        plan: &Plan,
        map: &Path,
        (camera, said): (CameraReport, &[Warning]),
        total_s: f64,
    ) -> Self {
        let said = said.iter().chain(&scene.found).map(ToString::to_string);
        Self {
            run: RunReport::new(scene, plan, camera.picture.photons),
            replicates: plan.replicates(),
            map: map.display().to_string(),
            time: SavedTime { total_s },
            camera,
            stopped_by: "photons",
            warnings: said.chain(scene.warnings.iter().map(ToString::to_string)).collect(),
        }
    }
}
