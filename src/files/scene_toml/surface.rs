//! `[[surface]]`: shapes and transforms. Heightfields have a file of their own.

use glam::DVec3;

use crate::error::Kind;
use crate::files::scene_toml::description::{ShapeDescription, SurfaceDescription, TransformDescription};
use crate::files::scene_toml::heightfield;
use crate::files::scene_toml::names::Names;
use crate::files::scene_toml::toml_table::{Interval, Table};
use crate::files::scene_toml::{ANGLE, COORDINATE, LENGTH, direction};

const SCALE: Interval = Interval { low: 1e-9, high: 1e9, words: "a positive factor from 1e-9 to 1e9" };

/// Largest cosine between the edges of a rectangle: what is left of a right angle in numbers of ten digits.
const LARGEST_COSINE: f64 = 1e-9;

#[derive(Clone, Copy)]
enum Type {
    Mesh,
    Rectangle,
    Box,
    Sphere,
    Paraboloid,
    Heightfield,
}

const TYPES: [(&str, Type); 6] = [
    ("mesh", Type::Mesh),
    ("rectangle", Type::Rectangle),
    ("box", Type::Box),
    ("sphere", Type::Sphere),
    ("paraboloid", Type::Paraboloid),
    ("heightfield", Type::Heightfield),
];

pub(crate) fn read(
    mut table: Table<'_, '_>,
    index: usize,
    names: &mut Names,
    materials: &Names,
) -> Option<SurfaceDescription> {
    let place = table.place();
    let name = table.text("name");
    let name = table.require("name", name, "a name of its own, in quotes");
    if let Some(name) = &name {
        names.insert(table.document(), &name.value, name.place, index);
    }
    let material = materials.refer(&mut table, "material");
    let transform = read_transform(&mut table);
    let kind = table.word("type", &TYPES);
    let words = "\"mesh\", \"rectangle\", \"box\", \"sphere\", \"paraboloid\" or \"heightfield\"";
    let shape = match table.require("type", kind, words)? {
        Type::Mesh => read_mesh(&mut table),
        Type::Rectangle => read_rectangle(&mut table, transform.scale),
        Type::Box => read_box(&mut table),
        Type::Sphere => read_sphere(&mut table, transform.scale),
        Type::Paraboloid => read_paraboloid(&mut table, transform.scale),
        Type::Heightfield => heightfield::read(&mut table).map(ShapeDescription::Heightfield),
    };
    table.finish();
    Some(SurfaceDescription { name: name?.value, material: material?, shape: shape?, transform, place })
}

fn read_transform(table: &mut Table<'_, '_>) -> TransformDescription {
    let identity = TransformDescription::IDENTITY;
    let scale = table.number_or_vector("scale", &SCALE).unwrap_or(identity.scale);
    let rotate_deg = table.vector("rotate_deg", &ANGLE).map_or(identity.rotate_deg, |v| v.value);
    let translate = table.vector("translate", &COORDINATE).map_or(identity.translate, |v| v.value);
    TransformDescription { scale, rotate_deg, translate }
}

fn read_mesh(table: &mut Table<'_, '_>) -> Option<ShapeDescription> {
    table.call("a mesh");
    let file = table.path("file");
    let closed = table.truth("closed");
    let smooth = table.truth("smooth");
    Some(ShapeDescription::Mesh { file: file?, closed, smooth })
}

fn read_rectangle(table: &mut Table<'_, '_>, scale: DVec3) -> Option<ShapeDescription> {
    table.call("a rectangle");
    let corner = table.vector("corner", &COORDINATE);
    let corner = table.require("corner", corner, "[x, y, z] in metres");
    let edge_u = read_edge(table, "edge_u");
    let edge_v = read_edge(table, "edge_v");
    let (corner, edge_u, edge_v) = (corner?.value, edge_u?, edge_v?);
    let (u, v) =
        (crate::files::scene_toml::unit(edge_u * scale)?, crate::files::scene_toml::unit(edge_v * scale)?);
    let cosine = u.dot(v).abs();
    if u.cross(v).length() <= LARGEST_COSINE {
        table.error("edge_v", Kind::Geometry, "an edge that is not parallel to edge_u: the area is zero");
        return None;
    }
    if cosine > LARGEST_COSINE {
        table.error("edge_v", Kind::Geometry, "an edge at right angles to edge_u (after scaling)");
        return None;
    }
    Some(ShapeDescription::Rectangle { corner, edge_u, edge_v })
}

fn read_edge(table: &mut Table<'_, '_>, key: &'static str) -> Option<DVec3> {
    const REQUIRED: &str = "an edge [x, y, z] with a length from 1e-9 to 1e9 m";
    let edge = table.vector(key, &COORDINATE);
    let edge = table.require(key, edge, REQUIRED)?.value;
    let length = edge.length();
    if !(LENGTH.low..=LENGTH.high).contains(&length) {
        table.error(key, Kind::Geometry, REQUIRED);
        return None;
    }
    Some(edge)
}

fn read_box(table: &mut Table<'_, '_>) -> Option<ShapeDescription> {
    table.call("a box");
    let min = table.vector("min", &COORDINATE);
    let min = table.require("min", min, "[x, y, z] in metres");
    let max = table.vector("max", &COORDINATE);
    let max = table.require("max", max, "[x, y, z] in metres");
    let (min, max) = (min?.value, max?.value);
    let extent = max - min;
    if !(extent.min_element() >= LENGTH.low && extent.max_element() <= LENGTH.high) {
        table.error("max", Kind::Geometry, "each coordinate of max from 1e-9 to 1e9 m above that of min");
        return None;
    }
    Some(ShapeDescription::Box { min, max })
}

fn read_sphere(table: &mut Table<'_, '_>, scale: DVec3) -> Option<ShapeDescription> {
    table.call("a sphere");
    let center = table.vector("center", &COORDINATE);
    let center = table.require("center", center, "[x, y, z] in metres");
    let radius = table.number("radius", &LENGTH);
    let radius = table.require("radius", radius, LENGTH.words);
    require_uniform(table, scale)?;
    Some(ShapeDescription::Sphere { center: center?.value, radius: radius? })
}

fn read_paraboloid(table: &mut Table<'_, '_>, scale: DVec3) -> Option<ShapeDescription> {
    table.call("a paraboloid");
    let vertex = table.vector("vertex", &COORDINATE);
    let vertex = table.require("vertex", vertex, "[x, y, z] in metres");
    let axis = direction(table, "axis", None);
    let focal_length = table.number("focal_length", &LENGTH);
    let focal_length = table.require("focal_length", focal_length, LENGTH.words);
    let radius = table.number("radius", &LENGTH);
    let radius = table.require("radius", radius, LENGTH.words);
    require_uniform(table, scale)?;
    Some(ShapeDescription::Paraboloid {
        vertex: vertex?.value,
        axis: axis?,
        focal_length: focal_length?,
        radius: radius?,
    })
}

/// Exact shapes stay what they are only under one factor for all axes.
fn require_uniform(table: &Table<'_, '_>, scale: DVec3) -> Option<()> {
    if scale.x == scale.y && scale.y == scale.z {
        return Some(());
    }
    table.error("scale", Kind::Geometry, "one factor for all axes: a sphere or paraboloid keeps its shape");
    None
}
