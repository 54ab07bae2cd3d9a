//! The camera of `caustix render`: its files, and photons saved for another view of the same light.

use std::path::Path;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_atomically;
use crate::files::bytes::read_capped;
use crate::files::exr::Value;
use crate::files::photon_map;
use crate::picture;
use crate::picture::camera::Film;
use crate::picture::photon_map::SavedMap;
use crate::picture::{AnyPicture, Picture, check_saved, hash_of_photons};
use crate::plot::picture::{write_luminance_png, write_png};
use crate::report::camera::CameraReport;
use crate::report::picture::{camera_attributes, write_exr};
use crate::run::Plan;
use crate::scene::Scene;
use crate::scene::camera::{CameraSpec, Method};

use super::RenderArgs;

/// Largest photon map that is read: 64 GiB.
const MOST_MAP_BYTES: u64 = 64 << 30;

/// What is asked of the camera, checked before anything is traced.
///
/// # Errors
/// Options that need a camera where there is none; a camera that cannot be.
pub(super) fn check(args: &RenderArgs, scene: &Scene) -> Result<()> {
    let option = match (&args.map, &args.save_map) {
        (Some(_), _) => Some("--map"),
        (None, Some(_)) => Some("--save-map"),
        (None, None) => None,
    };
    let (kind, with, required) = match (&scene.camera, option) {
        (None, None) => return Ok(()),
        (None, Some(_)) => {
            let required = "a scene with a camera: photons are kept for it alone";
            (Kind::Missing, "a scene without [camera]", required)
        }
        (Some(spec), Some(option)) if spec.method == Method::Splat => {
            let required = match option {
                "--map" => "method = \"map\": splatting joins photons to the pinhole while they are traced",
                _ => "method = \"map\": splatting keeps no photons",
            };
            (Kind::Range, "method \"splat\"", required)
        }
        (Some(_), _) => return picture::check(scene),
    };
    let option = option.unwrap_or_default();
    Err(Diagnostic::new(kind, format!("{option} and {with}"), required))
}

/// Reads saved photons into a scene's channels. Those of the same scene may have others: the camera that they were traced for
/// saw another background, in colour or not.
///
/// # Errors
/// A file that cannot be read, is damaged, or holds other photons than this scene and these settings give.
pub(super) fn read<const C: usize>(path: &Path, scene: &Scene, plan: &Plan) -> Result<SavedMap<C>> {
    let read = || {
        let bytes = read_capped(path, MOST_MAP_BYTES)?;
        let hash = hash_of_photons(scene, plan);
        let saved = match photon_map::channels(&bytes)? {
            3 => photon_map::read::<3>(&bytes, &hash)?.in_channels(),
            _ => photon_map::read::<1>(&bytes, &hash)?.in_channels(),
        };
        check_saved(scene, &saved)?;
        Ok(saved)
    };
    read().map_err(|e: Diagnostic| e.in_file(path))
}

/// Writes the photons of a picture.
///
/// # Errors
/// A file that cannot be written; photons that were too many for the camera's memory.
pub(super) fn save(path: &Path, picture: &AnyPicture) -> Result<()> {
    match picture {
        AnyPicture::Grey(picture) => save_map(path, picture),
        AnyPicture::Rgb(picture) => save_map(path, picture),
    }
}

fn save_map<const C: usize>(path: &Path, Picture { summary, photons, .. }: &Picture<C>) -> Result<()> {
    let Some(map) = photons else {
        let found = format!("--save-map and {} photons, in {} passes", summary.photons_kept, summary.passes);
        let required = "as many photons as the camera's memory holds at a time, to save them";
        let hint = "a larger photon_memory_mb, or fewer photons; all other results are written";
        return Err(Diagnostic::new(Kind::Limit, found, required).hint(hint));
    };
    write_atomically(path, |out| photon_map::write(map, out))
}

/// Writes the camera's files into a directory that exists, and says what they are.
///
/// # Errors
/// A file that cannot be written; files written before it stay.
pub(super) fn write(
    directory: &Path,
    scene: &Scene,
    plan: &Plan,
    spec: &CameraSpec,
    picture: &AnyPicture,
) -> Result<CameraReport> {
    let summary = picture.summary();
    let attributes = camera_attributes(scene, plan, summary.photons, summary.replicates, spec);
    let files = match picture {
        AnyPicture::Grey(picture) => write_film(directory, spec, &picture.film, &attributes)?,
        AnyPicture::Rgb(picture) => write_film(directory, spec, &picture.film, &attributes)?,
    };
    Ok(CameraReport::new(spec, summary, &files))
}

fn write_film<const C: usize>(
    directory: &Path,
    spec: &CameraSpec,
    film: &Film<C>,
    attributes: &[(String, Value)],
) -> Result<Vec<String>> {
    let mut files = vec!["camera.exr".to_string(), "camera.png".to_string()];
    write_exr(&directory.join(&files[0]), spec, film, attributes)?;
    write_png(&directory.join(&files[1]), spec, film)?;
    if spec.false_colour {
        let file = "camera_luminance.png".to_string();
        write_luminance_png(&directory.join(&file), "camera", spec, film)?;
        files.push(file);
    }
    Ok(files)
}
