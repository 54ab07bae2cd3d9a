//! From a description to a scene: loads the files it names, makes shapes, materials, emitters and receivers.

use glam::{DVec2, DVec3};

use crate::emitter::collimated::CrossSection;
use crate::emitter::colour::{WHITE, normalised, planckian};
use crate::emitter::{Collimated, Emitter, Isotropic, Panel, Photometric};
use crate::error::{Diagnostic, Kind, Result};
use crate::files::lm63;
use crate::files::obj::{ObjOptions, parse_obj};
use crate::geometry;
use crate::geometry::{
    Formula, HeightImage, Heightfield, Noise, Octave, Paraboloid, Rectangle, Shape, Smoothing, Sphere,
    Surface, Transform, Wave, box_mesh,
};
use crate::surface::tabulated::Options;
use crate::surface::{Material, Reference, Tabulated};

use crate::files::scene_toml::MOST_HEIGHTFIELD_CELLS;
use crate::files::scene_toml::description::{
    BeamSection, ColourDescription, Description, EmitterDescription, EmitterShape, Facing,
    HeightfieldDescription, MaterialKind, Place, Placed, ReliefDescription, ShapeDescription,
    SurfaceDescription,
};
use crate::files::scene_toml::source::sha256_hex;
use crate::scene::receiver::ReceiverSpec;
use crate::scene::{Identity, Places, Scene, SceneParts};

/// Builds the scene that a description describes.
///
/// # Errors
/// All that is wrong with it and its files, not only the first.
pub fn build(description: &Description) -> std::result::Result<Scene, Vec<Diagnostic>> {
    let mut parts = SceneParts {
        compared_reflections: description.compare.map(|c| c.reflections),
        camera: description.camera.as_ref().map(|c| c.spec.clone()),
        identity: identity(description),
        ..SceneParts::default()
    };
    parts.warnings.extend(description.warnings.iter().cloned());
    let mut errors = Vec::new();
    let mut bsdfs = Vec::with_capacity(description.materials.len());
    for m in &description.materials {
        let bsdf = material(description, &m.kind, &mut parts.warnings);
        bsdfs.push(bsdf.map_err(|e| errors.push(placed(description, m.place, e))).ok());
    }
    for surface in &description.surfaces {
        let made_of = surface.material.index;
        let built = shape(description, surface, &mut parts.warnings).and_then(|shape| {
            // A material in error is reported already.
            let bsdf = bsdfs[made_of]
                .as_ref()
                .map(|bsdf| laid_on(bsdf, &description.materials[made_of].kind, &shape));
            Ok((shape, bsdf.transpose()?))
        });
        match built {
            Ok((shape, Some(bsdf))) => {
                parts.surfaces.push((Surface { name: surface.name.clone(), shape }, bsdf))
            }
            Ok((_, None)) => {}
            Err(e) => errors.push(placed(description, surface.place, e)),
        }
    }
    for e in &description.emitters {
        match emitter(description, e, &mut parts.warnings) {
            Ok(emitter) => {
                parts.emitters.push((e.name.clone(), emitter));
                parts.emitter_colours.push(colour(description, e, &mut parts.warnings));
            }
            Err(error) => errors.push(placed(description, e.place, error)),
        }
    }
    parts.receivers = description
        .receivers
        .iter()
        .map(|r| ReceiverSpec {
            name: r.name.clone(),
            surface: r.surface.name.clone(),
            cells: r.cells,
            side: r.side,
            events: r.events,
        })
        .collect();
    if !errors.is_empty() {
        return Err(errors);
    }
    parts.places = Places {
        surfaces: description.surfaces.iter().map(|s| s.place).collect(),
        emitters: description.emitters.iter().map(|e| e.place).collect(),
        receivers: description.receivers.iter().map(|r| r.place).collect(),
        camera: description.camera.as_ref().map(|c| c.place),
    };
    Scene::new(parts)
        .map_err(|errors| errors.into_iter().map(|e| e.in_file(&description.source.name)).collect())
}

/// An error without a place of its own gets that of the part of the scene it is about.
fn placed(description: &Description, place: Place, error: Diagnostic) -> Diagnostic {
    if error.file().is_some() {
        return error;
    }
    error.at(place.line, place.column).in_file(&description.source.name)
}

fn identity(description: &Description) -> Identity {
    let source = &description.source;
    // A file that cannot be read has its error reported where it is used.
    let files = description.files().filter_map(|file| {
        source.load(&file.value).ok().map(|bytes| (file.value.clone(), sha256_hex(&bytes)))
    });
    Identity {
        name: source.name.clone(),
        text: source.text.clone(),
        sha256: source.sha256.clone(),
        files: files.collect(),
    }
}

fn material(d: &Description, kind: &MaterialKind, warnings: &mut Vec<Diagnostic>) -> Result<Material> {
    Ok(match kind {
        MaterialKind::Plain(material) => material.clone(),
        MaterialKind::Tabulated(tabulated) => {
            let file = &tabulated.file;
            // Messages name the file by its path, or as it is written in a scene without a folder.
            let path = d.source.path(&file.value).unwrap_or_else(|| file.value.clone().into());
            let name = path.display().to_string();
            let table = crate::files::bsdf::parse(&d.load(file)?, &name)?;
            warnings.extend(table.warnings.iter().cloned());
            let options = Options {
                energy: tabulated.energy,
                sides: tabulated.sides,
                rotation_deg: tabulated.rotation_deg,
                specular_remainder: tabulated.specular_remainder,
                ..Options::default()
            };
            // The table is as it should be; that it is laid on a surface here is what the scene can change.
            let refused = |e: Diagnostic| {
                let found = format!("{} in \"{}\"", e.found(), file.value);
                let refused = d.diagnostic(file.place, e.kind(), found, e.required());
                e.advice().map_or_else(|| refused.clone(), |hint| refused.clone().hint(hint))
            };
            let (bsdf, found) = Tabulated::new(&table, &options).map_err(refused)?;
            warnings.extend(found.into_iter().map(|w| w.in_file(&name)));
            Material::Tabulated(Box::new(bsdf))
        }
    })
}

/// A material on a surface: a table is told which direction its azimuths are counted from there.
fn laid_on(bsdf: &Material, kind: &MaterialKind, shape: &Shape) -> Result<Material> {
    let (Material::Tabulated(table), MaterialKind::Tabulated(tabulated)) = (bsdf, kind) else {
        return Ok(bsdf.clone());
    };
    let own = || match shape {
        Shape::Rectangle(rectangle) => Reference::Along(rectangle.edge_u()),
        Shape::Paraboloid(paraboloid) => Reference::Around(paraboloid.axis()),
        Shape::Sphere(_) => Reference::Around(DVec3::Z),
        Shape::Mesh(_) => Reference::Along(DVec3::X),
    };
    let reference = tabulated.reference.map_or_else(own, Reference::Along);
    Ok(Material::Tabulated(Box::new(table.with_reference(reference)?)))
}

fn shape(d: &Description, surface: &SurfaceDescription, warnings: &mut Vec<Diagnostic>) -> Result<Shape> {
    let t = &surface.transform;
    let transform = Transform::new(t.scale, t.rotate_deg, t.translate)?;
    let shape = match &surface.shape {
        ShapeDescription::Mesh { file, closed, smooth } => {
            let bytes = d.load(file)?;
            let options = ObjOptions {
                transform,
                smoothing: match smooth {
                    Some(true) => Smoothing::Computed,
                    Some(false) => Smoothing::Flat,
                    None => Smoothing::Given,
                },
                closed: *closed == Some(true),
            };
            // Messages name the file by its path, or as it is written in a scene without a folder.
            let path = d.source.path(&file.value).unwrap_or_else(|| file.value.clone().into());
            let (mesh, found) = parse_obj(&bytes, &path, &options)?;
            warnings.extend(found);
            return Ok(Shape::Mesh(mesh)); // The transform is applied already, before the checks.
        }
        ShapeDescription::Rectangle { corner, edge_u, edge_v } => {
            Shape::Rectangle(Rectangle::new(*corner, *edge_u, *edge_v)?)
        }
        ShapeDescription::Box { min, max } => Shape::Mesh(box_mesh(*min, *max)?),
        ShapeDescription::Sphere { center, radius } => Shape::Sphere(Sphere::new(*center, *radius)?),
        ShapeDescription::Paraboloid { vertex, axis, focal_length, radius } => {
            Shape::Paraboloid(Paraboloid::new(*vertex, *axis, *focal_length, *radius)?)
        }
        ShapeDescription::Heightfield(field) => Shape::Mesh(heightfield(d, field)?.mesh()?),
    };
    if t.is_identity() { Ok(shape) } else { shape.transformed(&transform) }
}

fn heightfield(d: &Description, field: &HeightfieldDescription) -> Result<Heightfield> {
    let (cells, formula) = match &field.relief {
        ReliefDescription::Waves { cells, waves } => {
            let waves = waves.iter().map(|w| Wave {
                amplitude_m: w.amplitude,
                wavelength_m: w.wavelength,
                direction_deg: w.direction_deg,
                phase_deg: w.phase_deg,
            });
            (*cells, Formula::Waves(waves.collect()))
        }
        ReliefDescription::Noise { cells, seed, amplitude, octaves } => {
            let octaves = octaves
                .iter()
                .map(|o| Octave { amplitude: o.amplitude, wavelength_m: o.wavelength })
                .collect();
            (*cells, Formula::Noise(Noise::new(*seed, octaves, *amplitude)?))
        }
        ReliefDescription::Image { cells, file, height: [low, high] } => {
            let path = d.source.path(&file.value).ok_or_else(|| {
                Diagnostic::new(
                    Kind::Io,
                    format!("the image \"{}\" in a scene that is inside the program", file.value),
                    "a scene file in a folder",
                )
            })?;
            let image = HeightImage::read(&path, *low, *high)?;
            let [columns, rows] = image.size();
            let own = [columns as u32 - 1, rows as u32 - 1];
            let cells = cells.unwrap_or(own);
            // A picture of one grey packs a thousandfold: a small file must not ask for gigabytes of triangles.
            if u64::from(cells[0]) * u64::from(cells[1]) > MOST_HEIGHTFIELD_CELLS {
                return Err(Diagnostic::new(
                    Kind::Limit,
                    format!("a heightfield with a vertex for each of {columns} x {rows} pixels"),
                    format!("at most {MOST_HEIGHTFIELD_CELLS} cells"),
                )
                .hint("give cells = [along x, along y]: heights between pixels are interpolated"));
            }
            (cells, Formula::Image(image))
        }
    };
    let min = DVec2::new(field.origin.x, field.origin.y);
    Ok(Heightfield {
        min,
        max: min + DVec2::from_array(field.size),
        z_m: field.origin.z,
        cells,
        formula,
        facing: match field.facing {
            Facing::Up => geometry::Facing::Up,
            Facing::Down => geometry::Facing::Down,
        },
        smooth: field.smooth,
    })
}

fn emitter(d: &Description, e: &EmitterDescription, warnings: &mut Vec<Diagnostic>) -> Result<Emitter> {
    let position = e.position.value;
    let (aim, up) = (e.frame.aim, e.frame.up);
    match &e.shape {
        EmitterShape::Photometric { file } => {
            let bytes = d.load(file)?;
            let path = d.source.path(&file.value);
            let photometry = match &path {
                Some(path) => lm63::read(path)?,
                None => lm63::parse(&bytes, &file.value)?,
            };
            warnings.extend(photometry.warnings.iter().cloned());
            let emitter = Photometric::new(&photometry, position, aim, up, e.flux_lm);
            let name = path.map_or_else(|| file.value.clone(), |p| p.display().to_string());
            Ok(Emitter::Photometric(Box::new(emitter.map_err(|error| error.in_file(name))?)))
        }
        EmitterShape::Isotropic => Ok(Emitter::Isotropic(Isotropic { position, flux_lm: required_flux(e)? })),
        EmitterShape::Collimated { section } => {
            let across: DVec3 = aim.cross(up);
            let section = match section {
                BeamSection::Disc { radius } => CrossSection::Disc(across * *radius, up * *radius),
                BeamSection::Rectangle { width, height } => {
                    CrossSection::Rectangle(across * (0.5 * width), up * (0.5 * height))
                }
            };
            let flux_lm = required_flux(e)?;
            Ok(Emitter::Collimated(Collimated { centre: position, direction: aim, section, flux_lm }))
        }
        EmitterShape::Panel { width, height } => {
            Ok(Emitter::Panel(Panel::new(position, aim, up, [*width, *height], required_flux(e)?)))
        }
    }
}

/// The colour of an emitter's light; what no sRGB colour can show is clipped and said.
fn colour(d: &Description, e: &EmitterDescription, warnings: &mut Vec<Diagnostic>) -> [f64; 3] {
    let Some(Placed { value, place }) = e.colour else { return WHITE };
    match value {
        ColourDescription::Rgb(rgb) => normalised(rgb).unwrap_or(WHITE),
        ColourDescription::Cct(cct_k) => {
            let (rgb, clipped) = planckian(cct_k);
            if clipped {
                let found = format!("cct_k = {cct_k}, a light more saturated than sRGB can show");
                let required = "about 1900 K or more; its blue is taken as 0 instead of below";
                warnings.push(d.diagnostic(place, Kind::Range, found, required));
            }
            rgb
        }
    }
}

fn required_flux(e: &EmitterDescription) -> Result<f64> {
    e.flux_lm.ok_or_else(|| {
        Diagnostic::new(
            Kind::Missing,
            format!("emitter \"{}\" without flux_lm", e.name),
            "flux_lm, in lumens",
        )
    })
}
