//! What of a surface counts as the neighbourhood of a point: which photons, and how much of the kernel.
//!
//! Only photons on the same surface, where it is turned less than 60 degrees from the point's own normal; the
//! kernel is divided by its integral over that same part of the surface within the ball. So no light comes
//! through a thin wall or round a corner, and a rectangle has no dark rim.

use std::sync::OnceLock;

use glam::DVec3;

use crate::geometry::{Geometry, Hit, Paraboloid, Rectangle, Shape, Sphere};
use crate::scene::camera::Kernel;

use super::faces::{FaceTree, LEAST_COSINE};

/// The surfaces of a scene as density estimation sees them. What a mesh needs is made when it is first asked
/// for.
#[derive(Debug)]
pub struct Footprints<'g> {
    geometry: &'g Geometry,
    /// The first primitive of every surface, and the number of all.
    first: Vec<u32>,
    faces: Vec<OnceLock<FaceTree>>,
}

/// The neighbourhood of one point.
#[derive(Debug, Clone, Copy)]
pub struct Footprint<'f> {
    centre: DVec3,
    normal: DVec3,
    /// The surface's primitives.
    first: u32,
    end: u32,
    part: Part<'f>,
}

#[derive(Debug, Clone, Copy)]
enum Part<'f> {
    Rectangle(&'f Rectangle),
    Sphere(&'f Sphere),
    Paraboloid(&'f Paraboloid, &'f OnceLock<FaceTree>),
    Mesh(&'f FaceTree),
}

impl<'g> Footprints<'g> {
    /// Of a scene's surfaces.
    pub fn new(geometry: &'g Geometry) -> Self {
        let mut first = vec![0];
        let mut count = 0;
        for surface in geometry.surfaces() {
            count += surface.shape.face_count() as u32;
            first.push(count);
        }
        let faces = geometry.surfaces().iter().map(|_| OnceLock::new()).collect();
        Self { geometry, first, faces }
    }

    /// The scene's geometry.
    pub fn geometry(&self) -> &'g Geometry {
        self.geometry
    }

    /// The surface a primitive belongs to, and its face there; `None` beyond the last.
    pub fn surface_of(&self, primitive: u32) -> Option<(usize, usize)> {
        let surface = self.first.partition_point(|&f| f <= primitive).checked_sub(1)?;
        let face = (primitive - self.first[surface]) as usize;
        (surface < self.faces.len()).then_some((surface, face))
    }

    /// The neighbourhood of a hit.
    #[inline]
    pub fn at(&self, hit: &Hit) -> Footprint<'_> {
        self.about(hit.position, hit.normal, hit.surface.0 as usize)
    }

    /// The neighbourhood of a photon's place; `None` where its primitive is not of this scene.
    pub fn of_primitive(&self, position: DVec3, primitive: u32) -> Option<Footprint<'_>> {
        let (surface, face) = self.surface_of(primitive)?;
        let normal = match &self.geometry.surfaces()[surface].shape {
            Shape::Rectangle(r) => r.normal(),
            Shape::Sphere(s) => s.normal(position),
            Shape::Paraboloid(p) => p.normal(position),
            Shape::Mesh(_) => self.tree(surface).normal(face),
        };
        Some(self.about(position, normal, surface))
    }

    fn about(&self, centre: DVec3, normal: DVec3, surface: usize) -> Footprint<'_> {
        let part = match &self.geometry.surfaces()[surface].shape {
            Shape::Rectangle(r) => Part::Rectangle(r),
            Shape::Sphere(s) => Part::Sphere(s),
            Shape::Paraboloid(p) => Part::Paraboloid(p, &self.faces[surface]),
            Shape::Mesh(_) => Part::Mesh(self.tree(surface)),
        };
        Footprint { centre, normal, first: self.first[surface], end: self.first[surface + 1], part }
    }

    fn tree(&self, surface: usize) -> &FaceTree {
        self.faces[surface].get_or_init(|| {
            let shape = &self.geometry.surfaces()[surface].shape;
            FaceTree::new((0..shape.face_count()).filter_map(|face| shape.triangle(face)).collect())
        })
    }
}

impl Footprint<'_> {
    /// The point it is about.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Whether a photon on this primitive at this place counts.
    #[inline(always)]
    pub fn holds(&self, primitive: u32, position: impl FnOnce() -> DVec3) -> bool {
        if primitive < self.first || primitive >= self.end {
            return false;
        }
        match self.part {
            Part::Rectangle(_) => true,
            // Turned less than 60 degrees: a chord shorter than the radius.
            Part::Sphere(s) => (position() - self.centre).length_squared() < s.radius() * s.radius(),
            Part::Paraboloid(p, _) => p.normal(position()).dot(self.normal) > LEAST_COSINE,
            Part::Mesh(faces) => faces.faces((primitive - self.first) as usize, self.normal),
        }
    }

    /// Integral of a kernel of this radius (m) over the neighbourhood: 1 where it is flat, or a sphere, and
    /// wide enough. Exact for rectangles, spheres and meshes; of a paraboloid see the source. Never 0.
    pub fn integral(&self, kernel: Kernel, radius_m: f64) -> f64 {
        let of_all = match self.part {
            Part::Rectangle(r) => over_rectangle(r, kernel, self.centre, radius_m),
            Part::Sphere(s) => {
                let t = s.radius() / radius_m;
                kernel.within((t * t).min(1.0))
            }
            Part::Paraboloid(p, faces) => self.over_paraboloid(p, faces, kernel, radius_m),
            Part::Mesh(faces) => faces.integral(kernel, self.centre, self.normal, radius_m),
        };
        // The point lies on its surface but for rounding; a radius within that rounding has no neighbourhood
        // to speak of.
        if of_all > 0.0 { of_all } else { 1.0 }
    }

    /// Away from the rim, and for radii small against the focal length, 1: of a surface of principal
    /// curvatures a and b a small ball cuts pi r^2 (1 + r^2 (a - b)^2 / 32 + ...), here within 0.05 %.
    /// Elsewhere the bowl is taken as facets.
    fn over_paraboloid(
        &self,
        bowl: &Paraboloid,
        faces: &OnceLock<FaceTree>,
        kernel: Kernel,
        radius_m: f64,
    ) -> f64 {
        let across = self.centre - bowl.vertex();
        let rho = (across - bowl.axis() * across.dot(bowl.axis())).length();
        if radius_m <= 0.25 * bowl.focal_length() && rho + radius_m <= bowl.radius() {
            return 1.0;
        }
        let tree = faces.get_or_init(|| FaceTree::new(bowl.facets(PARABOLOID_RINGS)));
        tree.integral(kernel, self.centre, self.normal, radius_m)
    }
}

/// Rings of facets that stand for a paraboloid's rim: its area is then within 0.02 %.
const PARABOLOID_RINGS: u32 = 64;

fn over_rectangle(r: &Rectangle, kernel: Kernel, centre: DVec3, radius_m: f64) -> f64 {
    let (u, v) = (r.edge_u(), r.edge_v());
    let from = r.corner() - centre;
    let (length_u, length_v) = (u.length(), v.length());
    let (a, b) = (-from.dot(u) / length_u, -from.dot(v) / length_v);
    if a.min(length_u - a).min(b).min(length_v - b) >= radius_m {
        return 1.0;
    }
    let corner = |du: DVec3, dv: DVec3| (from + du + dv) / radius_m;
    let zero = DVec3::ZERO;
    let corners = [corner(zero, zero), corner(u, zero), corner(u, v), corner(zero, v)];
    // In the rectangle's own plane: a hit lies on it but for rounding, which a small radius would magnify.
    let normal = r.normal();
    let flat = corners.map(|c| c - normal * c.dot(normal));
    kernel.over_polygon(&flat, normal)
}
