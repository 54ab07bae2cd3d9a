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
use crate::picture::{AnyPicture, PictureSummary, Watch, check_saved, hash_of_photons, picture_of_saved};
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
    let Some(spec) = &scene.camera else {
        let option = match (&args.map, &args.save_map) {
            (None, None) => return Ok(()),
            (Some(_), _) => "--map",
            (None, Some(_)) => "--save-map",
        };
        return Err(Diagnostic::new(
            Kind::Missing,
            format!("{option} and a scene without [camera]"),
            "a scene with a camera: photons are kept for it alone",
        ));
    };
    let (option, required) = match (spec.method, &args.map, &args.save_map) {
        (Method::Splat, Some(_), _) => {
            ("--map", "method = \"map\": splatting joins photons to the pinhole while they are traced")
        }
        (Method::Splat, None, Some(_)) => ("--save-map", "method = \"map\": splatting keeps no photons"),
        _ => return picture::check(scene),
    };
    Err(Diagnostic::new(Kind::Range, format!("{option} and method \"splat\""), required))
}

/// Photons from a file, in one channel or three.
pub(super) enum AnyMap {
    Grey(SavedMap<1>),
    Rgb(SavedMap<3>),
}

/// Reads saved photons.
///
/// # Errors
/// A file that cannot be read, is damaged, or holds other photons than this scene and these settings give.
pub(super) fn read(path: &Path, scene: &Scene, plan: &Plan) -> Result<AnyMap> {
    let bytes = read_capped(path, MOST_MAP_BYTES).map_err(|e| e.in_file(path))?;
    let hash = hash_of_photons(scene, plan);
    let in_file = |e: Diagnostic| e.in_file(path);
    Ok(if scene.is_coloured() {
        AnyMap::Rgb(in_channels(&bytes, &hash, scene).map_err(in_file)?)
    } else {
        AnyMap::Grey(in_channels(&bytes, &hash, scene).map_err(in_file)?)
    })
}

/// The photons in a scene's channels. Those of the same scene may have others: the camera that they were traced for saw another
/// background, in colour or not.
fn in_channels<const C: usize>(bytes: &[u8], hash: &str, scene: &Scene) -> Result<SavedMap<C>> {
    let saved = match photon_map::channels(bytes)? {
        3 => photon_map::read::<3>(bytes, hash)?.in_channels(),
        _ => photon_map::read::<1>(bytes, hash)?.in_channels(),
    };
    check_saved(scene, &saved)?;
    Ok(saved)
}

/// The picture of saved photons.
///
/// # Errors
/// Photons on surfaces that the scene does not have; those of the camera.
pub(super) fn of_saved(saved: AnyMap, scene: &Scene, plan: &Plan, watch: Watch<'_>) -> Result<AnyPicture> {
    Ok(match saved {
        AnyMap::Grey(saved) => AnyPicture::Grey(picture_of_saved(scene, plan, saved, watch)?),
        AnyMap::Rgb(saved) => AnyPicture::Rgb(picture_of_saved(scene, plan, saved, watch)?),
    })
}

/// Writes the photons of a picture.
///
/// # Errors
/// A file that cannot be written; photons that were too many for the camera's memory.
pub(super) fn save(path: &Path, picture: &AnyPicture) -> Result<()> {
    match picture {
        AnyPicture::Grey(picture) => save_map(path, &picture.summary, picture.photons.as_ref()),
        AnyPicture::Rgb(picture) => save_map(path, &picture.summary, picture.photons.as_ref()),
    }
}

fn save_map<const C: usize>(
    path: &Path,
    summary: &PictureSummary,
    photons: Option<&SavedMap<C>>,
) -> Result<()> {
    match photons {
        Some(map) => write_atomically(path, |out| photon_map::write(map, out)),
        None => Err(Diagnostic::new(
            Kind::Limit,
            format!("--save-map and {} photons, in {} passes", summary.photons_kept, summary.passes),
            "as many photons as the camera's memory holds at a time, to save them",
        )
        .hint("a larger photon_memory_mb, or fewer photons; all other results are written")),
    }
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
