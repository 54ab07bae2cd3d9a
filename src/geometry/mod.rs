//! Shapes, meshes and the nearest hit.
//!
//! World units are metres, f64. Triangles are tested watertight with exact signs ([`Geometry::nearest`]), spheres and
//! paraboloids by their formulas; which side of a surface a photon is on is carried as state ([`Whereabouts`]).
//! There is no absolute epsilon: every tolerance is a rounding bound computed from the numbers at hand, so a scene and
//! the same scene times a power of two give the same hits bit for bit.

// `!(x > 0.0)` refuses NaN as well, which `x <= 0.0` would let pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod box_mesh;
mod bvh;
mod contact;
mod coplanar;
mod exact;
mod height_image;
mod heightfield;
mod inside;
pub mod mesh;
mod mesh_check;
mod nearest;
mod nearly;
mod noise;
mod openings;
mod overlap;
mod paraboloid;
mod ray;
mod rectangle;
mod shape;
mod skipped;
mod sphere;
mod touching;
mod transform;
mod triangle;
mod whereabouts;
mod wide;

use std::collections::BTreeSet;

use glam::DVec3;

pub use box_mesh::box_mesh;
use contact::Contacts;
#[cfg(feature = "internals")]
pub use contact::MOST_PAIRS;
pub use contact::{Bond, Contact};
pub use height_image::{HEIGHT, HeightImage};
pub use heightfield::{CELLS_REQUIRED, Facing, Formula, Heightfield, MOST_CELLS, Wave};
pub use mesh::{Mesh, MeshParts, Smoothing};
pub use nearly::Near;
pub use noise::{MOST_OCTAVES, Noise, Octave, PEAK, RELATIVE};
pub use paraboloid::Paraboloid;
pub use rectangle::Rectangle;
pub use shape::Shape;
pub use sphere::Sphere;
pub use transform::{SCALE, Transform};
pub use whereabouts::{Body, Met, Side, Touch, Whereabouts};

use crate::error::invalid::Interval;
use crate::error::words::limit;
use crate::error::{Diagnostic, Kind, Result};
use bvh::Bounds;
use wide::{Normalisation, WideTree};

/// Coordinates of shapes, m.
pub const COORDINATE: Interval =
    Interval { low: -1e9, high: 1e9, words: "a number of metres from -1e9 to 1e9" };
/// Lengths of shapes, m.
pub const LENGTH: Interval = Interval { low: 1e-9, high: 1e9, words: "a length from 1e-9 to 1e9 m" };
/// Angles, degrees.
pub const ANGLE: Interval = Interval { low: -1e6, high: 1e6, words: "an angle from -1e6 to 1e6 degrees" };

/// Largest coordinate (m) of a mesh: products of three still fit an f64 with room.
pub const MAX_COORDINATE_M: f64 = 1e30;

/// Number of a surface in its scene, from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SurfaceId(pub u32);

/// A named shape in world space.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Unique name; ties between surfaces are decided by it.
    pub name: String,
    /// The shape, transforms applied.
    pub shape: Shape,
}

/// Where a ray meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray (m), never negative.
    pub t: f64,
    /// Bound of the rounding error of `t` (m).
    pub t_bound: f64,
    /// The point, interpolated on the surface itself (not origin + t direction).
    pub position: DVec3,
    /// The surface.
    pub surface: SurfaceId,
    /// Primitive number, counted through all surfaces.
    pub primitive: u32,
    /// Face number in its shape, from 0: the index of [`Shape::face_areas`].
    pub face: u32,
    /// Unit normal of the facet (or of the exact shape), outward.
    pub normal: DVec3,
    /// Unit smooth normal; equals `normal` where the mesh has none.
    pub shading_normal: DVec3,
    /// The ray arrives on the side the outward normal points to. Exact; next to edge-on the sign of
    /// `direction . normal` may disagree by rounding.
    pub front: bool,
    /// Whether the surface has an inside, which the photon's state follows.
    pub body: Body,
    /// Faces in contact with this one here.
    pub touch: Option<Touch>,
}

impl Hit {
    /// The face that is hit, as a state remembers it.
    #[inline]
    pub fn face_met(&self) -> Met {
        Met { primitive: self.primitive, surface: self.surface, front: self.front, body: self.body }
    }

    /// The side that a ray goes on to which passes unhindered.
    #[inline]
    pub fn other_side(&self) -> Side {
        if self.front { Side::Back } else { Side::Front }
    }
}

/// What the search needs to know of a surface.
#[derive(Debug, Clone, Copy)]
struct Info {
    /// Place of the name among all names.
    rank: u32,
    body: Body,
    first_primitive: u32,
    /// Whether any of its faces is in contact with another surface's.
    touches: bool,
    /// As [`Bond::is_clear`].
    is_clear: bool,
}

/// All surfaces of a scene, ready for rays.
#[derive(Debug)]
pub struct Geometry {
    surfaces: Vec<Surface>,
    info: Vec<Info>,
    tree: WideTree,
    normalisation: Normalisation,
    /// Cap of a rounding bound [m]: a quarter of the slack that boxes are tested with.
    bound_cap: f64,
    bounds: (DVec3, DVec3),
    avx2: bool,
    contacts: Contacts,
}

/// Primitives a scene may have.
const MAX_PRIMITIVES: usize = 1 << 31;

impl Geometry {
    /// Builds the search structure. What lies in one place is not looked for.
    ///
    /// # Errors
    /// Two surfaces of one name; more than 2^31 primitives or surfaces.
    pub fn build(surfaces: Vec<Surface>) -> Result<Self> {
        Self::joined(surfaces, &[])
    }

    /// Builds the search structure, with the contacts between surfaces that are bound in these ways, one a surface.
    ///
    /// # Errors
    /// As [`Self::build`].
    pub fn joined(surfaces: Vec<Surface>, bonds: &[Bond]) -> Result<Self> {
        let mut info = describe(&surfaces)?;
        let world = |s: &Surface, face: usize| s.shape.face_bounds(face);
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for s in &surfaces {
            for face in 0..s.shape.face_count() {
                let (l, h) = world(s, face);
                lo = lo.min(l);
                hi = hi.max(h);
            }
        }
        let empty = !(lo.is_finite() && hi.is_finite());
        let (lo, hi) = if empty { (DVec3::ZERO, DVec3::ZERO) } else { (lo, hi) };
        let normalisation = Normalisation::new(lo, hi);
        let mut boxes: Vec<Bounds> = Vec::new();
        let mut owner: Vec<u32> = Vec::new();
        for (i, s) in surfaces.iter().enumerate() {
            for face in 0..s.shape.face_count() {
                let (l, h) = world(s, face);
                boxes.push(normalisation.bounds(l, h));
                owner.push(i as u32);
            }
        }
        for (info, bond) in info.iter_mut().zip(bonds) {
            info.is_clear = bond.is_clear;
        }
        let binary = bvh::build(&boxes);
        let contacts = if bonds.is_empty() {
            Contacts::default()
        } else {
            // What all but touches is looked for, too.
            let reaches: Vec<f64> = surfaces.iter().map(nearly::reach).collect();
            for (primitive, (bounds, &i)) in boxes.iter_mut().zip(&owner).enumerate() {
                let (s, reach) = (&surfaces[i as usize], reaches[i as usize]);
                let (l, h) = world(s, primitive - info[i as usize].first_primitive as usize);
                *bounds = normalisation.bounds(l - reach, h + reach);
            }
            Contacts::find(&surfaces, &info, bonds, (&binary.with_boxes(&boxes), &boxes, &owner))?
        };
        for contact in contacts.pairs() {
            contact.surfaces.iter().for_each(|s| info[s.0 as usize].touches = true);
        }
        for [s, _] in contacts.cuts().iter().filter(|[s, t]| s == t) {
            info[s.0 as usize].body = Body::Layered;
        }
        let tree = WideTree::new(&binary, |block, lane, primitive| {
            let surface = owner[primitive as usize];
            block.primitive[lane] = primitive;
            block.surface[lane] = surface;
            let face = (primitive - info[surface as usize].first_primitive) as usize;
            match surfaces[surface as usize].shape.triangle(face) {
                Some(corners) => {
                    for (k, corner) in corners.iter().enumerate() {
                        for axis in 0..3 {
                            block.v[k][axis][lane] = corner[axis];
                        }
                    }
                }
                None => block.analytic |= 1 << lane,
            }
        });
        let bound_cap = libm::scalbn(1.0 / normalisation.scale, -22);
        Ok(Self {
            surfaces,
            info,
            tree,
            normalisation,
            bound_cap,
            bounds: (lo, hi),
            avx2: has_avx2(),
            contacts,
        })
    }

    /// The name of a surface.
    pub fn name(&self, surface: SurfaceId) -> &str {
        &self.surfaces[surface.0 as usize].name
    }

    /// The surfaces, by [`SurfaceId`].
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// Pairs of surfaces in contact.
    pub fn contacts(&self) -> &[Contact] {
        self.contacts.pairs()
    }

    /// Pairs of surfaces that all but touch, one of them closed.
    pub fn nearly(&self) -> &[Near] {
        self.contacts.near()
    }

    /// Pairs of transparent closed surfaces whose faces cut each other, the lower number first; twice the same for one that
    /// cuts itself.
    pub fn cuts(&self) -> &BTreeSet<[SurfaceId; 2]> {
        self.contacts.cuts()
    }

    /// Clear bodies and opaque surfaces whose triangles cut each other.
    fn solid_cuts(&self) -> &BTreeSet<[SurfaceId; 2]> {
        self.contacts.solid_cuts()
    }

    /// The surface of this name.
    pub fn surface_named(&self, name: &str) -> Option<SurfaceId> {
        self.surfaces.iter().position(|s| s.name == name).map(|i| SurfaceId(i as u32))
    }

    /// Whether the surface has an inside (no open edge, consistently oriented; a sphere).
    pub fn is_closed(&self, surface: SurfaceId) -> bool {
        self.info.get(surface.0 as usize).is_some_and(|i| i.body != Body::Open)
    }

    /// Least and greatest corner of everything (m); zeros for an empty scene.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.bounds
    }

    /// Number of primitives (triangles and exact shapes).
    pub fn primitive_count(&self) -> usize {
        self.surfaces.iter().map(|s| s.shape.face_count()).sum()
    }

    /// Bytes held by shapes and search structure.
    pub fn memory_bytes(&self) -> usize {
        let shapes: usize = self.surfaces.iter().map(|s| s.shape.memory_bytes()).sum();
        shapes + self.tree.memory_bytes() + size_of_val(self.info.as_slice())
    }

    /// Turns the AVX2 code path on (where the machine has it) or off: the same bits either way, at another speed.
    pub fn use_avx2(&mut self, on: bool) {
        self.avx2 = on && has_avx2();
    }
}

/// Names, closedness and numbering of the surfaces.
fn describe(surfaces: &[Surface]) -> Result<Vec<Info>> {
    let mut by_name: Vec<usize> = (0..surfaces.len()).collect();
    by_name.sort_by(|&i, &j| surfaces[i].name.cmp(&surfaces[j].name));
    for pair in by_name.windows(2) {
        if surfaces[pair[0]].name == surfaces[pair[1]].name {
            let found = format!("two surfaces named \"{}\"", surfaces[pair[0]].name);
            return Err(Diagnostic::new(Kind::Geometry, found, "a name of its own for every surface"));
        }
    }
    let mut rank = vec![0u32; surfaces.len()];
    for (r, &i) in by_name.iter().enumerate() {
        rank[i] = r as u32;
    }
    let mut first = 0usize;
    let mut info = Vec::with_capacity(surfaces.len());
    for (i, s) in surfaces.iter().enumerate() {
        info.push(Info {
            rank: rank[i],
            body: s.shape.body(),
            first_primitive: first as u32,
            touches: false,
            is_clear: false,
        });
        first += s.shape.face_count();
        if first > MAX_PRIMITIVES {
            return Err(Diagnostic::new(
                Kind::Limit,
                format!("more than {} triangles and shapes", limit(MAX_PRIMITIVES as u64)),
                format!("at most {} in a scene", limit(MAX_PRIMITIVES as u64)),
            ));
        }
    }
    Ok(info)
}

fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("bmi1")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
}
