//! A scene in another unit of length.

use caustix::files::scene_toml::description::{
    BeamSection, Description, EmitterShape, ReliefDescription, ShapeDescription,
};
use caustix::scene::camera::{Bandwidth, Camera, CameraSpec};

/// A description with every length times `s`, its camera's included.
pub fn scaled(mut d: Description, s: f64) -> Description {
    for e in &mut d.emitters {
        e.position.value *= s;
        match &mut e.shape {
            EmitterShape::Collimated { section: BeamSection::Disc { radius } } => *radius *= s,
            EmitterShape::Collimated { section: BeamSection::Rectangle { width, height } }
            | EmitterShape::Panel { width, height } => {
                *width *= s;
                *height *= s;
            }
            EmitterShape::Photometric { .. } | EmitterShape::Isotropic => {}
        }
    }
    for surface in &mut d.surfaces {
        surface.transform.translate *= s;
        match &mut surface.shape {
            ShapeDescription::Mesh { .. } => surface.transform.scale *= s,
            ShapeDescription::Rectangle { corner, edge_u, edge_v } => {
                *corner *= s;
                *edge_u *= s;
                *edge_v *= s;
            }
            ShapeDescription::Box { min, max } => {
                *min *= s;
                *max *= s;
            }
            ShapeDescription::Sphere { center, radius } => {
                *center *= s;
                *radius *= s;
            }
            ShapeDescription::Paraboloid { vertex, focal_length, radius, .. } => {
                *vertex *= s;
                *focal_length *= s;
                *radius *= s;
            }
            ShapeDescription::Heightfield(field) => {
                field.origin *= s;
                field.size = field.size.map(|x| x * s);
                match &mut field.relief {
                    ReliefDescription::Waves { waves, .. } => {
                        for wave in waves {
                            wave.amplitude *= s;
                            wave.wavelength *= s;
                        }
                    }
                    ReliefDescription::Noise { amplitude, octaves, .. } => {
                        *amplitude *= s;
                        octaves.iter_mut().for_each(|o| o.wavelength *= s);
                    }
                    ReliefDescription::Image { height, .. } => *height = height.map(|h| h * s),
                }
            }
        }
    }
    if let Some(camera) = &mut d.camera {
        let mut spec = CameraSpec::clone(&camera.spec);
        spec.position *= s;
        spec.lens_radius_m *= s;
        spec.focus_m *= s;
        spec.bandwidth = match spec.bandwidth {
            Bandwidth::Radius(r) => Bandwidth::Radius(r * s),
            Bandwidth::Progressive(r) => Bandwidth::Progressive(r * s),
            Bandwidth::AtLeast { radius_m, neighbours } => {
                Bandwidth::AtLeast { radius_m: radius_m * s, neighbours }
            }
            of_number @ (Bandwidth::Automatic | Bandwidth::Nearest(_)) => of_number,
        };
        camera.spec = Camera::new(spec).unwrap();
    }
    d
}
