//! Triangle meshes.

use std::collections::HashMap;

use glam::DVec3;

use super::mesh_check::{Topology, inspect};
use super::{Body, MAX_COORDINATE_M, Transform};
use crate::error::invalid::vector;
use crate::error::{Diagnostic, Invalid};

/// Where smooth normals come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Smoothing {
    /// None: the facet's normal everywhere.
    Flat,
    /// The normals that come with the mesh, facet normals where there are none.
    #[default]
    Given,
    /// Computed: facet normals averaged at each vertex, weighted by the facet's angle there.
    Computed,
}

/// What a mesh is made of, unchecked.
#[derive(Debug, Clone, Default)]
pub struct MeshParts {
    /// Vertex positions (m).
    pub vertices: Vec<DVec3>,
    /// Vertex indices of each triangle, right-handed about the outward normal.
    pub triangles: Vec<[u32; 3]>,
    /// Normals, of any positive length; may be empty.
    pub normals: Vec<DVec3>,
    /// Index into `normals` per corner, `u32::MAX` for none; empty, or one entry per triangle.
    pub normal_indices: Vec<[u32; 3]>,
    /// Number of the file's face that each triangle comes from, from 1; empty for 1, 2, 3...
    pub face_numbers: Vec<u32>,
}

/// A checked triangle mesh. Vertices of bit-equal position are one vertex.
#[derive(Debug, Clone)]
pub struct Mesh {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    normal_indices: Vec<[u32; 3]>,
    face_numbers: Vec<u32>,
    topology: Topology,
}

/// No normal at this corner.
pub(crate) const NO_NORMAL: u32 = u32::MAX;

impl Mesh {
    /// Checks and welds. Triangles two of whose corners coincide are dropped, with a warning. The second part of the
    /// result are the warnings.
    ///
    /// # Errors
    /// No triangle, an index that names nothing, a coordinate that is not finite or out of range, a normal without
    /// direction; with `closed`, open or inconsistently oriented edges, with their number.
    pub fn new(
        parts: MeshParts,
        smoothing: Smoothing,
        closed: bool,
    ) -> Result<(Self, Vec<Diagnostic>), Invalid> {
        let mut mesh = weld(parts)?;
        mesh.topology.add(inspect(&mesh.vertices, &mesh.triangles, &mesh.face_numbers));
        if mesh.triangles.is_empty() {
            let found = format!("a mesh of no triangle ({} degenerate ones)", mesh.topology.degenerate.len());
            return Err(Invalid::Shape { what: "triangles", found, required: "at least one triangle" });
        }
        if closed {
            mesh.topology.require_closed()?;
        }
        match smoothing {
            Smoothing::Flat => {
                mesh.normals.clear();
                mesh.normal_indices.clear();
            }
            Smoothing::Given => {}
            Smoothing::Computed => mesh.compute_normals(),
        }
        let warnings = mesh.topology.warnings();
        Ok((mesh, warnings))
    }

    /// Vertices (m).
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Vertex indices of every triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The file's number of a face, from 1.
    pub fn face_number(&self, face: usize) -> u32 {
        self.face_numbers[face]
    }

    /// What was found out about edges, orientation and volume.
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// How it has an inside, if it is closed.
    pub(crate) fn body(&self) -> Body {
        if self.topology.is_layered() { Body::Layered } else { Body::Simple }
    }

    /// The same surface whose other side is the front.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let turned = |list: &[[u32; 3]]| list.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
        let mut topology = self.topology.clone();
        topology.signed_volume_m3 = -topology.signed_volume_m3;
        Self {
            triangles: turned(&self.triangles),
            normals: self.normals.iter().map(|n| -*n).collect(),
            normal_indices: turned(&self.normal_indices),
            topology,
            ..self.clone()
        }
    }

    /// Whether the mesh has smooth normals.
    pub fn is_smooth(&self) -> bool {
        !self.normal_indices.is_empty()
    }

    /// Corners of a face (m).
    #[inline(always)]
    pub fn triangle(&self, face: usize) -> [DVec3; 3] {
        self.triangles[face].map(|i| self.vertices[i as usize])
    }

    /// Area of a face (m2).
    pub fn face_area(&self, face: usize) -> f64 {
        let [a, b, c] = self.triangle(face);
        0.5 * (b - a).cross(c - a).length()
    }

    /// Area (m2).
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|i| self.face_area(i)).sum()
    }

    /// The smooth normal at a point given by the weights of the second and third corner; `facet` where there is none.
    #[inline(always)]
    pub(crate) fn shading_normal(&self, face: usize, weights: [f64; 2], facet: DVec3) -> DVec3 {
        let Some(indices) = self.normal_indices.get(face) else { return facet };
        let normal = |k: usize| self.normals.get(indices[k] as usize).copied().unwrap_or(facet);
        let (a, b, c) = (normal(0), normal(1), normal(2));
        let n = a + (b - a) * weights[0] + (c - a) * weights[1];
        n.try_normalize().unwrap_or(facet)
    }

    /// The largest angle between a smooth normal at a corner and its facet's, radians; 0 where none are smooth.
    pub fn largest_tilt(&self) -> f64 {
        let of_face = |face: usize| {
            let [a, b, c] = self.triangle(face);
            let facet = (b - a).cross(c - a).normalize_or_zero();
            let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            let tilt = |n: DVec3| libm::atan2(facet.cross(n).length(), facet.dot(n));
            corners
                .map(|weights| tilt(self.shading_normal(face, weights, facet)))
                .into_iter()
                .fold(0.0, f64::max)
        };
        if self.is_smooth() { (0..self.triangles.len()).map(of_face).fold(0.0, f64::max) } else { 0.0 }
    }

    /// The mesh, moved, and checked again (rounding may weld what was apart).
    ///
    /// # Errors
    /// Coordinates out of range; nothing left; a closed mesh that rounding has opened.
    pub fn transformed(&self, by: &Transform) -> Result<Self, Invalid> {
        let parts = MeshParts {
            vertices: self.vertices.iter().map(|&v| by.point(v)).collect(),
            triangles: self.triangles.clone(),
            normals: self.normals.iter().map(|&n| by.normal(n)).collect(),
            normal_indices: self.normal_indices.clone(),
            face_numbers: self.face_numbers.clone(),
        };
        Ok(Self::new(parts, Smoothing::Given, self.topology.is_closed())?.0)
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(self.vertices.as_slice())
            + size_of_val(self.triangles.as_slice())
            + size_of_val(self.normals.as_slice())
            + size_of_val(self.normal_indices.as_slice())
            + size_of_val(self.face_numbers.as_slice())
    }

    /// Angle-weighted vertex normals (G. Thürmer, C. Wüthrich: Computing Vertex Normals from Polygonal Facets, 1998).
    fn compute_normals(&mut self) {
        let mut sums = vec![DVec3::ZERO; self.vertices.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|i| self.vertices[i as usize]);
            let Some(n) = (b - a).cross(c - a).try_normalize() else { continue };
            for (k, [p, q, r]) in [[a, b, c], [b, c, a], [c, a, b]].into_iter().enumerate() {
                let cosine = (q - p).normalize().dot((r - p).normalize()).clamp(-1.0, 1.0);
                sums[triangle[k] as usize] += n * libm::acos(cosine);
            }
        }
        self.normals = sums.iter().map(|s| s.normalize_or_zero()).collect();
        let of = |&i: &u32| if self.normals[i as usize] == DVec3::ZERO { NO_NORMAL } else { i };
        self.normal_indices = self.triangles.iter().map(|t| [of(&t[0]), of(&t[1]), of(&t[2])]).collect();
    }
}

/// Checks numbers and indices, makes one vertex of those of bit-equal position, drops triangles that vanish by it.
fn weld(parts: MeshParts) -> Result<Mesh, Invalid> {
    let MeshParts { vertices, triangles, mut normals, normal_indices, face_numbers } = parts;
    let mut first_at: HashMap<[u64; 3], u32> = HashMap::with_capacity(vertices.len());
    let mut welded = Vec::new();
    let mut place = Vec::with_capacity(vertices.len());
    for &v in &vertices {
        vector("vertices", v, MAX_COORDINATE_M, "finite coordinates up to 1e30 m")?;
        // -0 and 0 are one place.
        let v = v + DVec3::ZERO;
        let next = welded.len() as u32;
        let index = *first_at.entry(v.to_array().map(f64::to_bits)).or_insert(next);
        if index == next {
            welded.push(v);
        }
        place.push(index);
    }
    for (i, n) in normals.iter_mut().enumerate() {
        *n = n.try_normalize().ok_or_else(|| {
            let found = format!("normal {} = {} {} {}", i + 1, n.x, n.y, n.z);
            Invalid::Shape { what: "normals", found, required: "a finite normal of positive length" }
        })?;
    }
    let mut mesh = Mesh {
        vertices: welded,
        triangles: Vec::with_capacity(triangles.len()),
        normals,
        normal_indices: Vec::new(),
        face_numbers: Vec::with_capacity(triangles.len()),
        topology: Topology::default(),
    };
    for (i, triangle) in triangles.iter().enumerate() {
        let number = face_numbers.get(i).copied().unwrap_or(i as u32 + 1);
        let mut corners = [0; 3];
        for (corner, &index) in corners.iter_mut().zip(triangle) {
            *corner = *place.get(index as usize).ok_or_else(|| {
                let found = format!("vertex index {index} (from 0) in face {number}");
                Invalid::Shape { what: "triangles", found, required: "an index below the number of vertices" }
            })?;
        }
        if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
            mesh.topology.degenerate.push(number);
            continue;
        }
        mesh.triangles.push(corners);
        mesh.face_numbers.push(number);
        if let Some(indices) = normal_indices.get(i) {
            mesh.normal_indices.push(*indices);
        }
    }
    if !(mesh.normal_indices.is_empty() || mesh.normal_indices.len() == mesh.triangles.len()) {
        let found = format!("normal indices for {} of {} triangles", normal_indices.len(), triangles.len());
        return Err(Invalid::Shape {
            what: "normal_indices",
            found,
            required: "none, or those of every triangle",
        });
    }
    Ok(mesh)
}
