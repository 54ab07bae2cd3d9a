//! Meshes from OBJ files: checked text, read by tobj, checked as a mesh.

use std::path::Path;

use glam::DVec3;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::kinds::{Use, instead};
pub(crate) use crate::files::obj_text::Checked;
use crate::files::obj_text::check;
use crate::geometry::mesh::NO_NORMAL;
use crate::geometry::{Mesh, MeshParts, Smoothing, Transform};

/// Concave faces that are told one by one.
const MOST_CONCAVE: usize = 10;
const CONVEX: &str = "convex polygons, or triangles";

/// What to make of an OBJ file.
#[derive(Debug, Clone, Copy, Default)]
pub struct ObjOptions {
    /// Applied to every vertex and normal.
    pub transform: Transform,
    /// Where smooth normals come from.
    pub smoothing: Smoothing,
    /// Refuse a mesh that is not closed.
    pub closed: bool,
}

/// The mesh in the bytes of an OBJ file, and the warnings about it; `name` goes into messages.
///
/// Polygons become fans of triangles about their first corner. Positions, normals and faces are read, all groups into
/// one mesh; materials, textures and curves are not.
///
/// # Errors
/// A line that cannot be read (with its number), numbers out of range, indices that name nothing, no face, and
/// everything [`Mesh::new`] refuses.
#[cfg(feature = "internals")]
pub fn parse_obj(bytes: &[u8], name: &Path, options: &ObjOptions) -> Result<(Mesh, Vec<Diagnostic>)> {
    mesh_of(&check_obj(bytes, name)?, name, options)
}

/// The text of an OBJ file, from which [`mesh_of`] makes meshes; how many triangles that takes is known by then.
///
/// # Errors
/// A line that cannot be read (with its number), numbers out of range, indices that name nothing, no face.
pub(crate) fn check_obj(bytes: &[u8], name: &Path) -> Result<Checked> {
    checked(bytes).map_err(|d| {
        let name = name.display().to_string();
        instead(bytes, Use::Mesh, "a mesh in an OBJ file", &name).unwrap_or(d).in_file(name)
    })
}

fn checked(bytes: &[u8]) -> Result<Checked> {
    // Names and comments may be in any encoding; geometry is ASCII.
    let text = String::from_utf8_lossy(bytes);
    check(text.strip_prefix('\u{feff}').unwrap_or(&text))
}

/// The mesh of a checked text, and the warnings about it.
///
/// # Errors
/// Everything [`Mesh::new`] refuses.
pub(crate) fn mesh_of(
    checked: &Checked,
    name: &Path,
    options: &ObjOptions,
) -> Result<(Mesh, Vec<Diagnostic>)> {
    made(checked, options)
        .map(|(mesh, warnings)| (mesh, warnings.into_iter().map(|w| w.in_file(name)).collect()))
        .map_err(|d| d.in_file(name))
}

fn made(checked: &Checked, options: &ObjOptions) -> Result<(Mesh, Vec<Diagnostic>)> {
    let load = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..tobj::LoadOptions::default() };
    let models =
        tobj::load_obj_buf(&mut checked.geometry.as_bytes(), &load, |_| Err(tobj::LoadError::GenericFailure));
    let (models, _) = models
        .map_err(|e| Diagnostic::new(Kind::Syntax, format!("an OBJ file that gives: {e}"), "an OBJ file"))?;
    let [model] = &models[..] else {
        let found = format!("{} objects where one was written", models.len());
        return Err(Diagnostic::new(Kind::Syntax, found, "one object"));
    };
    let mut warnings = checked.warnings.clone();
    let parts = assemble(&model.mesh, checked, &options.transform, &mut warnings)?;
    let (mesh, more) = Mesh::new(parts, options.smoothing, options.closed)?;
    warnings.extend(more);
    Ok((mesh, warnings))
}

/// Fans of triangles, with the numbers of the faces they come from.
fn assemble(
    mesh: &tobj::Mesh,
    checked: &Checked,
    transform: &Transform,
    warnings: &mut Vec<Diagnostic>,
) -> Result<MeshParts> {
    let points = |flat: &[f64]| flat.chunks_exact(3).map(DVec3::from_slice).collect::<Vec<_>>();
    let vertices: Vec<DVec3> = points(&mesh.positions).into_iter().map(|p| transform.point(p)).collect();
    let normals: Vec<DVec3> = points(&mesh.normals).into_iter().map(|n| transform.normal(n)).collect();
    let smooth = checked.corner_has_normal.contains(&true);
    let mut parts = MeshParts { vertices, normals, ..MeshParts::default() };
    let (mut first, mut concave) = (0usize, 0usize);
    for (f, &line) in checked.face_lines.iter().enumerate() {
        let arity = mesh.face_arities.get(f).map_or(3, |&a| a as usize);
        let range = first..first + arity;
        first += arity;
        let (Some(corners), Some(has)) =
            (mesh.indices.get(range.clone()), checked.corner_has_normal.get(range.clone()))
        else {
            return Err(Diagnostic::new(Kind::Syntax, "a face that was not read", "a polygon").at(line, 1));
        };
        let normal = |k: usize| match mesh.normal_indices.get(range.start + k) {
            Some(&n) if has[k] => n,
            _ => NO_NORMAL,
        };
        if is_concave(corners, &parts.vertices) {
            concave += 1;
            if concave <= MOST_CONCAVE {
                let found = format!("face {} (concave): its fan of triangles folds over", f + 1);
                warnings.push(Diagnostic::new(Kind::Geometry, found, CONVEX).at(line, 1));
            }
        }
        for k in 2..arity {
            parts.triangles.push([corners[0], corners[k - 1], corners[k]]);
            parts.face_numbers.push(f as u32 + 1);
            if smooth {
                parts.normal_indices.push([normal(0), normal(k - 1), normal(k)]);
            }
        }
    }
    if concave > MOST_CONCAVE {
        let found = format!("{} more concave faces", concave - MOST_CONCAVE);
        warnings.push(Diagnostic::new(Kind::Geometry, found, CONVEX));
    }
    Ok(parts)
}

/// Whether some triangle of the polygon's fan is turned against the polygon.
fn is_concave(corners: &[u32], vertices: &[DVec3]) -> bool {
    let Some(polygon) =
        corners.iter().map(|&i| vertices.get(i as usize).copied()).collect::<Option<Vec<_>>>()
    else {
        return false;
    };
    let fan = || polygon.windows(2).skip(1).map(|w| (w[0] - polygon[0]).cross(w[1] - polygon[0]));
    let whole: DVec3 = fan().sum();
    polygon.len() > 3 && fan().any(|n| n.dot(whole) < 0.0)
}
