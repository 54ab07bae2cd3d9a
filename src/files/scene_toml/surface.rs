//! `[[surface]]`: shapes and transforms. Heightfields have a file of their own.

use glam::DVec3;

use super::asked::{Asked, What};
use super::heightfield;
use super::loader::{Make, made};
use super::names::Names;
use super::numbers::{DIRECTION, DIRECTION_REQUIRED};
use super::part::SurfacePart;
use super::table::Table;
use crate::error::invalid::Interval;
use crate::error::{Invalid, Kind};
use crate::files::obj::{ObjOptions, mesh_of};
use crate::geometry::{
    ANGLE, COORDINATE, LENGTH, Paraboloid, Rectangle, SCALE, Shape, Smoothing, Sphere, Transform, box_mesh,
};
use crate::scene::{Joint, SurfaceOptions};

const TYPES: [&str; 6] = ["mesh", "rectangle", "box", "sphere", "paraboloid", "heightfield"];

const JOINTS: [(&str, Joint); 2] = [("film", Joint::Film), ("glued", Joint::Glued)];

const PRIORITY: Interval =
    Interval { low: -1000.0, high: 1000.0, words: "a whole number from -1000 to 1000" };

const POINT: &str = "[x, y, z] in metres";

pub(super) fn read(
    mut table: Table<'_, '_>,
    index: usize,
    names: &mut Names,
    materials: &Names,
    asked: &mut Asked,
) -> Option<SurfacePart> {
    let name = table.needed("name", "a name of its own, in quotes", Table::text);
    if let Some(name) = &name {
        names.insert(table.document(), name, &name.value, index);
    }
    let material = materials.refer(&mut table, "material");
    let transform = read_transform(&mut table);
    let options = read_options(&mut table);
    let words = "\"mesh\", \"rectangle\", \"box\", \"sphere\", \"paraboloid\" or \"heightfield\"";
    let kind = table.needed("type", words, |t, key| t.word(key, &TYPES.map(|word| (word, word))))?;
    let label = name.as_ref().map_or("", |name| &name.value);
    let mut ask: Option<Make<()>> = None;
    let shape: Option<Make<Shape>> = match kind {
        "mesh" => read_mesh(&mut table, label, transform).map(|(make, counts)| {
            ask = Some(counts);
            make
        }),
        "heightfield" => {
            let read = heightfield::read(&mut table, label, asked);
            read.zip(transform).map(|((make, counts), t)| -> Make<Shape> {
                ask = counts;
                Box::new(move |loader| Ok(moved(make(loader)?, &t)?))
            })
        }
        _ => {
            let shape = match kind {
                "rectangle" => read_rectangle(&mut table).map(Shape::Rectangle),
                "box" => read_box(&mut table),
                "sphere" => read_sphere(&mut table).map(Shape::Sphere),
                _ => read_paraboloid(&mut table).map(Shape::Paraboloid),
            };
            shape.zip(transform).and_then(|(shape, t)| table.accept(moved(shape, &t))).map(made)
        }
    };
    table.finish();
    let of_faces = ["mesh", "box", "heightfield"].contains(&kind).then_some(kind);
    let (name, material) = (name?.value, material?.1);
    Some(SurfacePart { name, material, ask, shape: shape?, of_faces, options })
}

/// `contact` and `priority`.
fn read_options(table: &mut Table<'_, '_>) -> SurfaceOptions {
    let contact = table.word("contact", &JOINTS);
    let priority = table.number("priority", &PRIORITY).unwrap_or(0.0);
    if priority.fract() != 0.0 {
        table.error("priority", Kind::Range, PRIORITY.words);
    }
    SurfaceOptions { priority: priority as i32, contact }
}

/// A shape that is not moved keeps its bits: no normal is normalised again.
fn moved(shape: Shape, by: &Transform) -> Result<Shape, Invalid> {
    if *by == Transform::identity() { Ok(shape) } else { shape.transformed(by) }
}

fn read_transform(table: &mut Table<'_, '_>) -> Option<Transform> {
    let scale = table.number_or_vector("scale", &SCALE).unwrap_or(DVec3::ONE);
    let rotate_deg = table.angles("rotate_deg", &ANGLE).unwrap_or(DVec3::ZERO);
    let translate = table.vector("translate", &COORDINATE).unwrap_or(DVec3::ZERO);
    table.accept(Transform::new(scale, rotate_deg, translate))
}

/// The mesh, and what counts its triangles before any is made.
fn read_mesh(
    table: &mut Table<'_, '_>,
    name: &str,
    transform: Option<Transform>,
) -> Option<(Make<Shape>, Make<()>)> {
    table.call("a mesh");
    let file = table.path("file");
    let closed = table.truth("closed") == Some(true);
    let smoothing = match table.truth("smooth") {
        Some(true) => Smoothing::Computed,
        Some(false) => Smoothing::Flat,
        None => Smoothing::Given,
    };
    let (file, transform, name) = (file?, transform?, name.to_owned());
    let counted = file.clone();
    let ask: Make<()> = Box::new(move |loader| {
        let text = loader.obj(&counted)?;
        loader.asked.count(What::Triangles, &name, text.triangles() as u64)?;
        loader.asked.count(What::Vertices, &name, text.points() as u64)
    });
    let make: Make<Shape> = Box::new(move |loader| {
        // The transform is applied before the mesh is checked.
        let options = ObjOptions { transform, smoothing, closed };
        loader.bytes(&file)?;
        let (mesh, found) = mesh_of(&*loader.obj(&file)?, &loader.path(&file), &options)?;
        loader.warnings.extend(found);
        Ok(mesh.into())
    });
    Some((make, ask))
}

fn read_rectangle(table: &mut Table<'_, '_>) -> Option<Rectangle> {
    const EDGE: &str = "an edge [x, y, z] with a length from 1e-9 to 1e9 m";
    table.call("a rectangle");
    let corner = table.needed_vector("corner", &COORDINATE, POINT);
    let edge_u = table.needed_vector("edge_u", &COORDINATE, EDGE);
    let edge_v = table.needed_vector("edge_v", &COORDINATE, EDGE);
    table.accept(Rectangle::new(corner?, edge_u?, edge_v?))
}

fn read_box(table: &mut Table<'_, '_>) -> Option<Shape> {
    table.call("a box");
    let min = table.needed_vector("min", &COORDINATE, POINT);
    let max = table.needed_vector("max", &COORDINATE, POINT);
    table.accept(box_mesh(min?, max?)).map(Shape::Mesh)
}

fn read_sphere(table: &mut Table<'_, '_>) -> Option<Sphere> {
    table.call("a sphere");
    let center = table.needed_vector("center", &COORDINATE, POINT);
    let radius = table.needed_number("radius", &LENGTH);
    table.accept(Sphere::new(center?, radius?))
}

fn read_paraboloid(table: &mut Table<'_, '_>) -> Option<Paraboloid> {
    table.call("a paraboloid");
    let vertex = table.needed_vector("vertex", &COORDINATE, POINT);
    let axis = table.needed_vector("axis", &DIRECTION, DIRECTION_REQUIRED);
    let focal_length = table.needed_number("focal_length", &LENGTH);
    let radius = table.needed_number("radius", &LENGTH);
    table.accept(Paraboloid::new(vertex?, axis?, focal_length?, radius?))
}
