//! The camera of `caustix render`: its files, and photons saved for another view of the same light.

use std::path::Path;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_atomically;
use crate::files::bytes::read_capped;
use crate::files::exr::Value;
use crate::files::kinds::{Use, instead};
use crate::files::photon_map;
use crate::files::set::Set;
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

/// The camera's files.
const EXR: &str = "camera.exr";
const PNG: &str = "camera.png";
const LUMINANCE: &str = "camera_luminance.png";

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
    let bytes = read_capped(path, MOST_MAP_BYTES).map_err(|e| e.in_file(path))?;
    let read = || {
        let hash = hash_of_photons(scene, plan);
        let saved = match photon_map::channels(&bytes)? {
            3 => photon_map::read::<3>(&bytes, &hash)?.in_channels(),
            _ => photon_map::read::<1>(&bytes, &hash)?.in_channels(),
        };
        check_saved(scene, &saved)?;
        Ok(saved)
    };
    read().map_err(|e: Diagnostic| {
        let name = path.display().to_string();
        let other = instead(&bytes, Use::PhotonMap, "a photon map that caustix saved", &name);
        other.unwrap_or(e).in_file(path)
    })
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

/// Names of the camera's files.
pub(super) fn files(spec: &CameraSpec) -> Vec<String> {
    let names = [Some(EXR), Some(PNG), spec.false_colour.then_some(LUMINANCE)];
    names.into_iter().flatten().map(str::to_string).collect()
}

/// Makes the camera's files, and says which there are.
pub(super) fn write(
    set: &mut Set<'_>,
    scene: &Scene,
    plan: &Plan,
    spec: &CameraSpec,
    picture: &AnyPicture,
) -> CameraReport {
    let summary = picture.summary();
    let attributes = camera_attributes(scene, plan, summary.photons, summary.replicates, spec);
    let files = match picture {
        AnyPicture::Grey(picture) => write_film(set, spec, &picture.film, &attributes),
        AnyPicture::Rgb(picture) => write_film(set, spec, &picture.film, &attributes),
    };
    CameraReport::new(spec, summary, &files)
}

fn write_film<const C: usize>(
    set: &mut Set<'_>,
    spec: &CameraSpec,
    film: &Film<C>,
    attributes: &[(String, Value)],
) -> Vec<String> {
    let mut made = files(spec);
    made.retain(|name| {
        set.add(name, |path| {
            match name.as_str() {
                EXR => write_exr(path, spec, film, attributes),
                PNG => write_png(path, spec, film),
                _ => write_luminance_png(path, "camera", spec, film),
            }
            .map(|()| true)
        })
    });
    made
}
