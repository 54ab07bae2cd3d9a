//! Faces in contact: which faces of two surfaces lie in one another, found when the scene is built.
//!
//! Two such faces are at the same distance along every ray, give or take rounding, so what is met first is decided by rule,
//! never by rounding, names or place. Faces that look at each other have a film of no thickness between them: a photon meets
//! its own body's face first, then stands in the film, before the other face. Where they are glued there is no film, and
//! both are crossed at once, as are faces that look the same way.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::bvh::{BinaryTree, Bounds};
use super::coplanar::{facing, normal, rounding};
use super::nearly::{Near, Nearly};
use super::ray::Ray;
use super::triangle::View;
use super::{Body, Info, Shape, Surface, SurfaceId};
use crate::error::{Diagnostic, Kind, Result};

/// How a surface behaves towards those that it touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Bond {
    /// It is joined to them: there is no film between.
    pub is_glued: bool,
    /// It bounds a transparent medium; of two faces crossed at once, one that does not acts alone.
    pub is_clear: bool,
}

/// A pair of surfaces of which faces are in contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Contact {
    /// Both, the lower number first; twice the same for a mesh that touches itself.
    pub surfaces: [SurfaceId; 2],
    /// The faces look at each other; else they look the same way.
    pub facing: bool,
}

/// Of one primitive: another in contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Partner {
    primitive: u32,
    pub other: u32,
    pub surface: u32,
    /// They look at each other.
    pub facing: bool,
    /// They are crossed at once.
    pub is_joint: bool,
}

/// All contacts of a scene.
#[derive(Debug, Default)]
pub(super) struct Contacts {
    /// In the order of primitives.
    partners: Vec<Partner>,
    pairs: Vec<Contact>,
    /// Pairs of transparent closed surfaces that cut each other; twice the same for one that cuts itself.
    cuts: BTreeSet<[SurfaceId; 2]>,
    /// Transparent closed surfaces, and opaque ones that cut them.
    solid_cuts: BTreeSet<[SurfaceId; 2]>,
    /// Faces that all but touch.
    near: Vec<Near>,
}

/// Most pairs of faces whose boxes meet, of those that are looked at, beside so many a face: about a minute. Of long faces in one
/// place every one meets every other.
pub const MOST_PAIRS: u64 = 1 << 28;
const PAIRS_A_FACE: u64 = 64;
/// Most contacts, likewise: a gigabyte.
pub const MOST_CONTACTS: u64 = 1 << 24;
const CONTACTS_A_FACE: u64 = 16;
/// Boxes compared for each pair that may meet.
const STEPS_A_PAIR: u64 = 8;

impl Contacts {
    /// The contacts of surfaces bound in these ways; none are looked for without bonds. The tree is that over the boxes of all
    /// primitives, as wide as [`super::nearly`] wants them, whose surfaces are `owner`.
    ///
    /// # Errors
    /// [`Kind::Limit`] where more faces meet than [`MOST_PAIRS`] and [`MOST_CONTACTS`] allow.
    pub fn find(
        surfaces: &[Surface],
        info: &[Info],
        bonds: &[Bond],
        (tree, boxes, owner): (&BinaryTree, &[Bounds], &[u32]),
    ) -> Result<Self> {
        if bonds.is_empty() || tree.order.is_empty() {
            return Ok(Self::default());
        }
        let faces = boxes.len() as u64;
        let (most_pairs, most_contacts) =
            (MOST_PAIRS + PAIRS_A_FACE * faces, MOST_CONTACTS + CONTACTS_A_FACE * faces);
        let (mut pairs, mut contacts) = (0u64, 0u64);
        let (mut found, mut nearly) = (Self::default(), Nearly::new(surfaces, info));
        // Of a body and a face of an opaque surface: the sides from which the body's faces touch it.
        let mut sides: BTreeMap<(u32, u32), [bool; 2]> = BTreeMap::new();
        let is_body = |s: u32| bonds[s as usize].is_clear && info[s as usize].body != Body::Open;
        pairs_of_boxes((tree, boxes, owner), is_body, STEPS_A_PAIR * most_pairs, |p, q| {
            let (s, t) = (owner[p as usize], owner[q as usize]);
            pairs += 1;
            if pairs > most_pairs || contacts > most_contacts {
                return Err(too_many([s, t].map(|s| &surfaces[s as usize].name[..])));
            }
            let shape = |s: u32| &surfaces[s as usize].shape;
            let face = |p: u32, s: u32| (p - info[s as usize].first_primitive) as usize;
            let facing = match (shape(s).triangle(face(p, s)), shape(t).triangle(face(q, t))) {
                (Some(a), Some(b)) => {
                    // Neighbours in a mesh do not cut each other.
                    let are_neighbours = s == t && a.iter().any(|v| b.contains(v));
                    if is_body(s) && is_body(t) && !are_neighbours && cut(&a, &b) {
                        found.cuts.insert([SurfaceId(s.min(t)), SurfaceId(s.max(t))]);
                    }
                    for ([body, solid], [of_body, of_solid], face) in
                        [([s, t], [&a, &b], q), ([t, s], [&b, &a], p)]
                    {
                        let pair = [SurfaceId(body), SurfaceId(solid)];
                        // One cut is enough.
                        if !is_body(body)
                            || bonds[solid as usize].is_clear
                            || found.solid_cuts.contains(&pair)
                        {
                            continue;
                        }
                        let is_through = touches_from(of_body, of_solid).is_some_and(|side| {
                            contacts += 1;
                            let seen = sides.entry((body, face)).or_default();
                            seen[usize::from(side)] = true;
                            *seen == [true; 2]
                        });
                        if is_through || cut(of_body, of_solid) {
                            found.solid_cuts.insert(pair);
                        }
                    }
                    let facing = facing(&a, &b);
                    if facing.is_none() && s != t {
                        nearly.consider([s, t], [&a, &b]);
                    }
                    facing
                }
                (None, None) => coincide(shape(s), shape(t)).then_some(false),
                _ => None,
            };
            let Some(facing) = facing else { return Ok(()) };
            contacts += 2;
            let is_glued = s == t || bonds[s as usize].is_glued || bonds[t as usize].is_glued;
            let is_joint = !facing || is_glued;
            for (primitive, other, surface) in [(p, q, t), (q, p, s)] {
                found.partners.push(Partner { primitive, other, surface, facing, is_joint });
            }
            let surfaces = [SurfaceId(s.min(t)), SurfaceId(s.max(t))];
            found.pairs.push(Contact { surfaces, facing });
            Ok(())
        })?;
        found.partners.sort_unstable();
        found.pairs.sort_unstable();
        found.pairs.dedup();
        found.near = nearly.finish();
        Ok(found)
    }

    /// Pairs of surfaces in contact, each once a way.
    pub fn pairs(&self) -> &[Contact] {
        &self.pairs
    }

    /// Pairs of transparent closed surfaces that cut each other, by their numbers in order; twice the same for one that cuts
    /// itself.
    pub fn cuts(&self) -> &BTreeSet<[SurfaceId; 2]> {
        &self.cuts
    }

    /// Transparent closed surfaces, and opaque ones that cut them.
    pub fn solid_cuts(&self) -> &BTreeSet<[SurfaceId; 2]> {
        &self.solid_cuts
    }

    /// Pairs of surfaces that all but touch.
    pub fn near(&self) -> &[Near] {
        &self.near
    }

    /// What is in contact with a primitive.
    pub fn partners(&self, primitive: u32) -> impl Iterator<Item = &Partner> {
        let first = self.partners.partition_point(|p| p.primitive < primitive);
        self.partners[first..].iter().take_while(move |p| p.primitive == primitive)
    }
}

/// Whether a ray's line meets a triangle that is in contact with one which it meets: whether they touch there.
pub(super) fn covers(triangle: &[DVec3; 3], ray: &Ray) -> Option<super::triangle::Crossing> {
    View::new(&triangle.map(|v| v.to_array()), ray).crossing()
}

/// The refusal of a scene of which too many faces meet, the last of them of these two surfaces.
fn too_many([a, b]: [&str; 2]) -> Diagnostic {
    let found = if a == b {
        format!(
            "surfaces of which so many faces meet that contacts cannot be looked for, such as those of \"{a}\""
        )
    } else {
        format!(
            "surfaces of which so many faces meet that contacts cannot be looked for, such as \"{a}\" and \"{b}\""
        )
    };
    let required = format!("at most 2^{} pairs of faces that meet", MOST_PAIRS.trailing_zeros());
    Diagnostic::new(Kind::Limit, found, required)
        .hint("leave out surfaces that lie in one another, or split long thin faces")
}

/// Calls for every pair of primitives of different surfaces (and of one surface with itself where `with_itself` says so)
/// whose boxes meet, until it is an error. After so many steps that is one, too.
fn pairs_of_boxes(
    (tree, boxes, owner): (&BinaryTree, &[Bounds], &[u32]),
    with_itself: impl Fn(u32) -> bool,
    most_steps: u64,
    mut call: impl FnMut(u32, u32) -> Result<()>,
) -> Result<()> {
    const MIXED: u32 = u32::MAX;
    // The one surface of a node; children stand behind their parents.
    let mut only = vec![MIXED; tree.nodes.len()];
    for i in (0..tree.nodes.len()).rev() {
        let node = &tree.nodes[i];
        let of = if node.count > 0 {
            let primitives = &tree.order[node.first as usize..(node.first + node.count) as usize];
            let first = owner[primitives[0] as usize];
            primitives.iter().all(|p| owner[*p as usize] == first).then_some(first)
        } else {
            let [l, r] = node.children.map(|c| only[c as usize]);
            (l == r).then_some(l)
        };
        only[i] = of.unwrap_or(MIXED);
    }
    let is_dull = |i: usize, j: usize| only[i] == only[j] && only[i] != MIXED && !with_itself(only[i]);
    let (mut work, mut steps) = (vec![(0usize, 0usize)], 0u64);
    while let Some((i, j)) = work.pop() {
        steps += 1;
        if steps > most_steps {
            let found = "surfaces whose faces are so near to each other that contacts cannot be looked for";
            return Err(Diagnostic::new(Kind::Limit, found, "surfaces apart from each other"));
        }
        let (a, b) = (&tree.nodes[i], &tree.nodes[j]);
        if is_dull(i, j) || !meet(&a.bounds, &b.bounds) {
            continue;
        }
        match (a.count > 0, b.count > 0) {
            (true, true) => {
                let of = |n: &super::bvh::BinaryNode| n.first as usize..(n.first + n.count) as usize;
                for &p in &tree.order[of(a)] {
                    for &q in &tree.order[of(b)] {
                        let (s, t) = (owner[p as usize], owner[q as usize]);
                        let is_new = i != j || p < q;
                        if is_new
                            && (s != t || with_itself(s))
                            && meet(&boxes[p as usize], &boxes[q as usize])
                        {
                            call(p, q)?;
                        }
                    }
                }
            }
            _ if i == j => {
                let [l, r] = a.children.map(|c| c as usize);
                work.extend([(l, l), (l, r), (r, r)]);
            }
            (a_is_leaf, b_is_leaf) => {
                let split_first = b_is_leaf || (!a_is_leaf && a.bounds.half_area() >= b.bounds.half_area());
                let (node, other) = if split_first { (a, j) } else { (b, i) };
                work.extend(node.children.map(|c| (c as usize, other)));
            }
        }
    }
    Ok(())
}

fn meet(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|k| a.lo[k] <= b.hi[k] && b.lo[k] <= a.hi[k])
}

/// Exact shapes in one place.
fn coincide(a: &Shape, b: &Shape) -> bool {
    match (a, b) {
        (Shape::Sphere(a), Shape::Sphere(b)) => a == b,
        (Shape::Paraboloid(a), Shape::Paraboloid(b)) => a == b,
        _ => false,
    }
}

/// The side, of the two of a triangle's plane, on which another one is that has a corner inside the triangle.
fn touches_from(other: &[DVec3; 3], t: &[DVec3; 3]) -> Option<bool> {
    let (rounding, n) = (rounding(other, t), normal(t).try_normalize()?);
    let heights = other.map(|v| (v - t[0]).dot(n));
    let is_within = |v: DVec3| {
        (0..3).all(|k| {
            let edge = t[(k + 1) % 3] - t[k];
            n.cross(edge).dot(v - t[k]) > rounding * edge.length()
        })
    };
    let touches = other.iter().zip(heights).any(|(v, height)| height.abs() <= rounding && is_within(*v));
    let [is_below, is_above] =
        [heights.iter().any(|h| *h < -rounding), heights.iter().any(|h| *h > rounding)];
    (touches && is_below != is_above).then_some(is_above)
}

/// Whether an edge of one triangle passes through the inside of the other, by more than the rounding of their corners.
fn cut(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let rounding = rounding(a, b);
    let passes = |t: &[DVec3; 3], p: DVec3, q: DVec3| {
        let Some(n) = normal(t).try_normalize() else { return false };
        let (from, to) = ((p - t[0]).dot(n), (q - t[0]).dot(n));
        if from.abs() <= rounding || to.abs() <= rounding || (from < 0.0) == (to < 0.0) {
            return false;
        }
        let point = p + (q - p) * (from / (from - to));
        (0..3).all(|k| {
            let edge = t[(k + 1) % 3] - t[k];
            n.cross(edge).dot(point - t[k]) > rounding * edge.length()
        })
    };
    (0..3).any(|k| passes(b, a[k], a[(k + 1) % 3]) || passes(a, b[k], b[(k + 1) % 3]))
}
