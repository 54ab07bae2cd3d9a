//! Hits on faces in contact: which of them it is, and what goes with it ([`super::contact`]).

use glam::DVec3;

use super::contact::{Partner, covers};
use super::ray::Ray;
use super::triangle::Crossing;
use super::whereabouts::Verdict;
use super::{Body, Geometry, Hit, Met, SurfaceId, Touch, Whereabouts};

impl Geometry {
    /// A hit on a surface that touches others: the face among those here that comes first, with those that go with it.
    #[cold]
    pub(super) fn in_contact(&self, hit: &Hit, ray: &Ray, at: &Whereabouts) -> Hit {
        let mut hit = *hit;
        // Its own body's face comes before the one beyond the film.
        if hit.front {
            let own = self.covering(&hit, ray).find(|(partner, crossing)| {
                let body = self.info[partner.surface as usize].body;
                let here = hit.t <= 4.0 * hit.t_bound;
                !partner.is_joint
                    && !crossing.front
                    && !at.has_met(partner.other)
                    && at.judge(SurfaceId(partner.surface), body, false, here) == Verdict::Take
            });
            if let Some((partner, crossing)) = own {
                hit = self.hit_on(partner.other, crossing, ray);
            }
        }
        hit = self.acting(hit, ray);
        // Through an edge, within rounding, the body beyond may have been entered already.
        let beyond = |(partner, _): &(&Partner, Crossing)| {
            let surface = SurfaceId(partner.surface);
            let is_in = self.info[partner.surface as usize].body == Body::Simple && at.is_behind(surface);
            !partner.is_joint && !is_in
        };
        let film = if hit.front {
            None
        } else {
            self.covering(&hit, ray).find(beyond).map(|(p, _)| self.met(p.other, true))
        };
        self.touching(hit, ray, film)
    }

    /// The face that comes next for what stands in a film, having left a face on its front.
    #[cold]
    pub(super) fn across_film(&self, origin: DVec3, left: u32, next: u32) -> Option<Hit> {
        let surface = self.surface_of(next);
        let face = (next - self.info[surface as usize].first_primitive) as usize;
        // Only triangles have a film between them.
        let [a, b, c] = self.surfaces[surface as usize].shape.triangle(face)?;
        let (ab, ac, to) = (b - a, c - a, origin - a);
        let normal = ab.cross(ac);
        let area2 = normal.length_squared();
        // Barycentric, by areas; what rounding puts beside the triangle, is on its edge.
        let v = (to.cross(ac).dot(normal) / area2).clamp(0.0, 1.0);
        let w = (ab.cross(to).dot(normal) / area2).clamp(0.0, 1.0 - v);
        let weights = [v, w];
        let normal = normal.normalize();
        let hit = self.hit_at(next, Crossing { t: 0.0, weights, front: true }, a + ab * v + ac * w, normal);
        let Some(ray) = Ray::new(hit.position, -normal) else { return Some(hit) };
        let hit = self.acting(hit, &ray);
        Some(self.touching(hit, &ray, Some(self.met(left, true))))
    }

    /// Hits on the faces that are crossed at once with the one that is hit.
    #[inline]
    pub fn joint_hits(&self, hit: &Hit) -> impl Iterator<Item = Hit> {
        let joint = hit.touch.map_or([None; 2], |touch| touch.joint);
        let hit = *hit;
        joint.into_iter().flatten().map(move |Met { primitive, surface, front, body }| {
            let sign = if front == hit.front { 1.0 } else { -1.0 };
            let face = primitive - self.info[surface.0 as usize].first_primitive;
            let (normal, shading_normal) = (hit.normal * sign, hit.shading_normal * sign);
            Hit { primitive, surface, face, front, body, normal, shading_normal, touch: None, ..hit }
        })
    }

    /// Of faces crossed at once, the one that acts: one that is not transparent, if there is such.
    fn acting(&self, hit: Hit, ray: &Ray) -> Hit {
        if !self.info[hit.surface.0 as usize].is_clear {
            return hit;
        }
        let solid = |(partner, _): &(&Partner, Crossing)| {
            partner.is_joint && !self.info[partner.surface as usize].is_clear
        };
        let acting = self.covering(&hit, ray).find(solid);
        acting.map_or(hit, |(partner, crossing)| self.hit_on(partner.other, crossing, ray))
    }

    /// The hit with all that is crossed with it.
    fn touching(&self, hit: Hit, ray: &Ray, film: Option<Met>) -> Hit {
        let mut joint = [None; 2];
        let together = self.covering(&hit, ray).filter(|(partner, _)| partner.is_joint);
        for (place, (partner, _)) in joint.iter_mut().zip(together) {
            // Facing the same way, or opposite ways: the sign of the crossing itself is not as sure where it is edge-on.
            let front = if partner.facing { !hit.front } else { hit.front };
            *place = Some(self.met(partner.other, front));
        }
        Hit { touch: (film.is_some() || joint[0].is_some()).then_some(Touch { film, joint }), ..hit }
    }

    /// The faces in contact with the one that is hit which the ray's line meets, too.
    fn covering<'a>(
        &'a self,
        hit: &Hit,
        ray: &'a Ray,
    ) -> impl Iterator<Item = (&'a Partner, Crossing)> + use<'a> {
        let Hit { t, front, .. } = *hit;
        self.contacts.partners(hit.primitive).filter_map(move |partner| {
            let info = &self.info[partner.surface as usize];
            let shape = &self.surfaces[partner.surface as usize].shape;
            let crossing = match shape.triangle((partner.other - info.first_primitive) as usize) {
                Some(triangle) => covers(&triangle, ray),
                // Two exact shapes in one place look the same way.
                None => Some(Crossing { t, weights: [0.0; 2], front }),
            };
            crossing.map(|crossing| (partner, crossing))
        })
    }

    fn met(&self, primitive: u32, front: bool) -> Met {
        let surface = self.surface_of(primitive);
        Met { primitive, surface: SurfaceId(surface), front, body: self.info[surface as usize].body }
    }

    pub(super) fn surface_of(&self, primitive: u32) -> u32 {
        self.info.partition_point(|info| info.first_primitive <= primitive) as u32 - 1
    }

    fn hit_at(&self, primitive: u32, crossing: Crossing, position: DVec3, normal: DVec3) -> Hit {
        let surface = self.surface_of(primitive);
        let info = &self.info[surface as usize];
        let face = primitive - info.first_primitive;
        let shape = &self.surfaces[surface as usize].shape;
        Hit {
            t: crossing.t,
            t_bound: 0.0,
            position,
            surface: SurfaceId(surface),
            primitive,
            face,
            normal,
            shading_normal: shape.shading_normal(face as usize, crossing.weights, normal),
            front: crossing.front,
            body: info.body,
            touch: None,
        }
    }
}
