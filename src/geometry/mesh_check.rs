//! What can be wrong with a mesh: edges, orientation, duplicates, volume.

use glam::DVec3;

use super::openings::{opening, parts};
use crate::error::warning::four_digits;
use crate::error::words::names;
use crate::error::{Diagnostic, Invalid, Kind};

/// Findings about a mesh whose equal vertices have been welded. Faces go by their numbers in the file, from 1.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Topology {
    /// Dropped: two corners at one place.
    pub degenerate: Vec<u32>,
    /// Kept, but without area: three corners on a line. They are edges' neighbours and never visibly hit.
    pub collinear: Vec<u32>,
    /// Pairs of faces with the same three corners.
    pub duplicates: Vec<(u32, u32)>,
    /// Edges that belong to one face only.
    pub open_edges: usize,
    /// The first open edge: its face and its ends (m).
    pub first_open_edge: Option<(u32, [DVec3; 2])>,
    /// The area that the loops of open edges span, m2: next to nothing where they are two sides of a crack.
    pub opening_m2: f64,
    /// Edges of more than two faces.
    pub non_manifold_edges: usize,
    /// A face at a non-manifold edge.
    pub first_non_manifold: Option<u32>,
    /// Edges of several faces that are not run through equally often in both directions.
    pub inconsistent_edges: usize,
    /// A face at an inconsistent edge.
    pub first_inconsistent: Option<u32>,
    /// Volume enclosed (m3): negative where the normals point inward; of no meaning for an open mesh.
    pub signed_volume_m3: f64,
    triangles: usize,
    /// Parts that share no vertex.
    parts: usize,
}

/// Openings of less than this share of a mesh's area are cracks.
const OF_A_CRACK: f64 = 1e-3;

impl Topology {
    /// Whether it may have more than one layer: several parts, or edges of more than two faces.
    pub(crate) fn is_layered(&self) -> bool {
        self.parts > 1 || self.non_manifold_edges > 0
    }

    /// No open edge and every edge run through equally often in both directions: there is an inside.
    pub fn is_closed(&self) -> bool {
        self.triangles > 0 && self.open_edges == 0 && self.inconsistent_edges == 0
    }

    /// Open, but so little that it was meant to be closed: the loops of its open edges span less than this share of its area.
    pub(crate) fn is_cracked(&self, area_m2: f64) -> bool {
        self.open_edges > 0 && self.opening_m2 < OF_A_CRACK * area_m2
    }

    /// Takes over what was found later; the list of dropped faces is kept.
    pub(crate) fn add(&mut self, found: Self) {
        let degenerate = std::mem::take(&mut self.degenerate);
        *self = Self { degenerate, ..found };
    }

    /// # Errors
    /// The mesh is not closed.
    pub(crate) fn require_closed(&self) -> Result<(), Invalid> {
        if let Some((face, [a, b])) = self.first_open_edge {
            let found = format!("{} open edges, the first of face {face} from {a} to {b}", self.open_edges);
            let required = "a closed mesh: every edge shared by two faces, whose vertices are welded only where their \
                            coordinates are equal to the last bit";
            return Err(Invalid::Shape { what: "closed", found, required });
        }
        if let Some(face) = self.first_inconsistent {
            let found = format!(
                "{} edges of inconsistent orientation, the first at face {face}",
                self.inconsistent_edges
            );
            let required = "a closed mesh: neighbours run through their edge in opposite directions";
            return Err(Invalid::Shape { what: "closed", found, required });
        }
        Ok(())
    }

    /// Everything that is worth a word but no refusal.
    pub(crate) fn warnings(&self) -> Vec<Diagnostic> {
        let mut list = Vec::new();
        let mut warn = |found: String, required: &str| {
            list.push(Diagnostic::new(Kind::Geometry, found, required));
        };
        if !self.degenerate.is_empty() {
            let found = format!("degenerate faces {} (dropped)", names(&self.degenerate, FACES));
            warn(found, "three different corners");
        }
        if !self.collinear.is_empty() {
            warn(format!("faces without area {}", names(&self.collinear, FACES)), "corners not on one line");
        }
        if let Some((a, b)) = self.duplicates.first() {
            let found = format!("{} duplicate faces, the first {a} and {b}", self.duplicates.len());
            warn(found, "each face once");
        }
        if let Some(face) = self.first_non_manifold {
            let found =
                format!("{} edges of more than two faces, the first at face {face}", self.non_manifold_edges);
            warn(found, "at most two faces at an edge");
        }
        if let Some(face) = self.first_inconsistent {
            let found = format!(
                "{} edges of inconsistent orientation, the first at face {face}",
                self.inconsistent_edges
            );
            warn(found, "neighbours run through their edge in opposite directions");
        }
        if self.is_closed() && self.signed_volume_m3 < 0.0 {
            let volume_m3 = four_digits(self.signed_volume_m3);
            let found = format!("a closed mesh of volume {volume_m3} m3: its normals point inward");
            warn(found, "normals that point outward, unless the inside is meant to be the front");
        }
        list
    }
}

/// Faces that a warning names before it only counts the rest.
const FACES: usize = 10;

/// One use of an edge.
struct Use {
    ends: (u32, u32),
    forward: bool,
    triangle: u32,
}

/// Examines a welded mesh; `face_numbers` names its triangles.
pub(crate) fn inspect(vertices: &[DVec3], triangles: &[[u32; 3]], face_numbers: &[u32]) -> Topology {
    let mut found = Topology { triangles: triangles.len(), ..Topology::default() };
    let reference = triangles.first().map_or(DVec3::ZERO, |t| vertices[t[0] as usize]);
    let mut uses = Vec::with_capacity(3 * triangles.len());
    let mut volume = 0.0;
    for (i, t) in triangles.iter().enumerate() {
        let [a, b, c] = t.map(|v| vertices[v as usize] - reference);
        volume += a.dot(b.cross(c));
        if (b - a).cross(c - a) == DVec3::ZERO {
            found.collinear.push(face_numbers[i]);
        }
        for (p, q) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            uses.push(Use { ends: (p.min(q), p.max(q)), forward: p < q, triangle: i as u32 });
        }
    }
    found.signed_volume_m3 = volume / 6.0;
    uses.sort_unstable_by_key(|u| (u.ends, u.triangle));
    let mut open: Vec<[u32; 2]> = Vec::new();
    let mut first_open: Option<(u32, [u32; 2])> = None;
    let mut first_many = u32::MAX;
    let mut first_twisted = u32::MAX;
    for edge in uses.chunk_by(|a, b| a.ends == b.ends) {
        let triangle = edge[0].triangle;
        if let [only] = edge {
            found.open_edges += 1;
            let (p, q) = only.ends;
            let ends = if only.forward { [p, q] } else { [q, p] };
            open.push(ends);
            if first_open.is_none_or(|(t, _)| triangle < t) {
                first_open = Some((triangle, ends));
            }
            continue;
        }
        if edge.len() > 2 {
            found.non_manifold_edges += 1;
            first_many = first_many.min(triangle);
        }
        if 2 * edge.iter().filter(|u| u.forward).count() != edge.len() {
            found.inconsistent_edges += 1;
            first_twisted = first_twisted.min(triangle);
        }
    }
    let number = |t: u32| face_numbers.get(t as usize).copied();
    found.first_open_edge =
        first_open.map(|(t, ends)| (face_numbers[t as usize], ends.map(|v| vertices[v as usize])));
    found.first_non_manifold = number(first_many);
    found.first_inconsistent = number(first_twisted);
    found.duplicates = duplicates(triangles, face_numbers);
    found.parts = parts(vertices.len(), triangles);
    found.opening_m2 = opening(vertices, &open);
    found
}

fn duplicates(triangles: &[[u32; 3]], face_numbers: &[u32]) -> Vec<(u32, u32)> {
    let mut keys: Vec<([u32; 3], usize)> = triangles
        .iter()
        .enumerate()
        .map(|(i, t)| {
            let mut key = *t;
            key.sort_unstable();
            (key, i)
        })
        .collect();
    keys.sort_unstable();
    let pairs = keys.windows(2).filter(|w| w[0].0 == w[1].0);
    let mut list: Vec<(u32, u32)> = pairs.map(|w| (face_numbers[w[0].1], face_numbers[w[1].1])).collect();
    list.sort_unstable();
    list
}
