//! The closed set of shapes.

use glam::DVec3;

use super::{Body, Mesh, Paraboloid, Rectangle, Sphere, Transform};
use crate::error::Invalid;

/// A shape in world space. Triangles where there is no formula, exact where there is one.
#[derive(Debug, Clone)]
pub enum Shape {
    /// Triangles.
    Mesh(Mesh),
    /// A flat rectangle.
    Rectangle(Rectangle),
    /// An exact sphere.
    Sphere(Sphere),
    /// An exact paraboloid of revolution, clipped at its rim.
    Paraboloid(Paraboloid),
}

impl Shape {
    /// Number of faces: triangles of a mesh, 2 for a rectangle, 1 for an exact shape.
    pub fn face_count(&self) -> usize {
        match self {
            Self::Mesh(m) => m.triangles().len(),
            Self::Rectangle(_) => 2,
            Self::Sphere(_) | Self::Paraboloid(_) => 1,
        }
    }

    /// Whether the shape has an inside.
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Mesh(m) => m.topology().is_closed(),
            Self::Sphere(_) => true,
            Self::Rectangle(_) | Self::Paraboloid(_) => false,
        }
    }

    /// Whether and how it has an inside.
    pub fn body(&self) -> Body {
        match self {
            Self::Mesh(m) if m.topology().is_closed() => m.body(),
            Self::Sphere(_) => Body::Simple,
            Self::Mesh(_) | Self::Rectangle(_) | Self::Paraboloid(_) => Body::Open,
        }
    }

    /// What a closed shape holds, m3; 0 for an open one.
    pub fn volume_m3(&self) -> f64 {
        match self {
            Self::Mesh(m) if m.topology().is_closed() => m.topology().signed_volume_m3.abs(),
            Self::Sphere(s) => 4.0 / 3.0 * std::f64::consts::PI * s.radius().powi(3),
            Self::Mesh(_) | Self::Rectangle(_) | Self::Paraboloid(_) => 0.0,
        }
    }

    /// Area (m2).
    pub fn area(&self) -> f64 {
        match self {
            Self::Mesh(m) => m.area(),
            Self::Rectangle(r) => r.area(),
            Self::Sphere(s) => s.area(),
            Self::Paraboloid(p) => p.area(),
        }
    }

    /// Area of every face (m2), by face number.
    pub fn face_areas(&self) -> Vec<f64> {
        match self {
            Self::Mesh(m) => (0..m.triangles().len()).map(|i| m.face_area(i)).collect(),
            Self::Rectangle(r) => vec![0.5 * r.area(); 2],
            Self::Sphere(s) => vec![s.area()],
            Self::Paraboloid(p) => vec![p.area()],
        }
    }

    /// Surface coordinates in `[0, 1] x [0, 1]` in which equal areas are equal areas; `None` for a mesh.
    pub fn uv(&self, position: DVec3) -> Option<(f64, f64)> {
        match self {
            Self::Mesh(_) => None,
            Self::Rectangle(r) => Some(r.uv(position)),
            Self::Sphere(s) => Some(s.uv(position)),
            Self::Paraboloid(p) => Some(p.uv(position)),
        }
    }

    /// The point of these surface coordinates; `None` for a mesh.
    pub fn at(&self, u: f64, v: f64) -> Option<DVec3> {
        match self {
            Self::Mesh(_) => None,
            Self::Rectangle(r) => Some(r.at(u, v)),
            Self::Sphere(s) => Some(s.at(u, v)),
            Self::Paraboloid(p) => Some(p.at(u, v)),
        }
    }

    /// The shape, moved.
    ///
    /// # Errors
    /// An exact shape under a non-uniform scale, a rectangle that the scale makes oblique, coordinates out of range.
    pub fn transformed(self, by: &Transform) -> Result<Self, Invalid> {
        Ok(match self {
            Self::Mesh(m) => m.transformed(by)?.into(),
            Self::Rectangle(r) => r.transformed(by)?.into(),
            Self::Sphere(s) => s.transformed(by)?.into(),
            Self::Paraboloid(p) => p.transformed(by)?.into(),
        })
    }

    /// Corners of a face, right-handed about the outward normal; `None` for an exact shape.
    pub fn triangle(&self, face: usize) -> Option<[DVec3; 3]> {
        match self {
            Self::Mesh(m) => Some(m.triangle(face)),
            Self::Rectangle(r) => Some(r.triangle(face)),
            Self::Sphere(_) | Self::Paraboloid(_) => None,
        }
    }

    /// The smooth normal at a point of a face given by the weights of the second and third corner; `facet` where there is none.
    #[inline(always)]
    pub(crate) fn shading_normal(&self, face: usize, weights: [f64; 2], facet: DVec3) -> DVec3 {
        match self {
            Self::Mesh(m) => m.shading_normal(face, weights, facet),
            Self::Rectangle(_) | Self::Sphere(_) | Self::Paraboloid(_) => facet,
        }
    }

    /// Least and greatest corner of a face (m).
    pub(crate) fn face_bounds(&self, face: usize) -> (DVec3, DVec3) {
        match self {
            Self::Mesh(m) => bounds_of(&m.triangle(face)),
            Self::Rectangle(r) => bounds_of(&r.triangle(face)),
            Self::Sphere(s) => s.bounds(),
            Self::Paraboloid(p) => p.bounds(),
        }
    }

    /// Least and greatest corner of the whole (m).
    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        let faces = (0..self.face_count()).map(|face| self.face_bounds(face));
        faces.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), (a, b)| (l.min(a), h.max(b)))
    }

    /// Bytes held.
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of::<Self>()
            + match self {
                Self::Mesh(m) => m.memory_bytes(),
                Self::Rectangle(_) | Self::Sphere(_) | Self::Paraboloid(_) => 0,
            }
    }
}

fn bounds_of(corners: &[DVec3; 3]) -> (DVec3, DVec3) {
    let [a, b, c] = *corners;
    (a.min(b).min(c), a.max(b).max(c))
}

impl From<Mesh> for Shape {
    fn from(shape: Mesh) -> Self {
        Self::Mesh(shape)
    }
}

impl From<Rectangle> for Shape {
    fn from(shape: Rectangle) -> Self {
        Self::Rectangle(shape)
    }
}

impl From<Sphere> for Shape {
    fn from(shape: Sphere) -> Self {
        Self::Sphere(shape)
    }
}

impl From<Paraboloid> for Shape {
    fn from(shape: Paraboloid) -> Self {
        Self::Paraboloid(shape)
    }
}
