//! The nearest hit: what a candidate must satisfy, and which of several is it.

use glam::DVec3;

use super::ray::Ray;
use super::skipped::Skipped;
use super::sphere::Root;
use super::triangle::{Block, Crossing, Lanes, View, coordinate_error};
use super::whereabouts::Verdict;
use super::wide::{BoxRay, Visitor};
use super::{Geometry, Hit, Info, Shape, SurfaceId, Whereabouts};

/// A candidate that is nearest so far.
#[derive(Debug, Clone, Copy)]
struct Best<'a> {
    t: f64,
    rank: u32,
    primitive: u32,
    surface: u32,
    crossing: Crossing,
    view: View,
    /// Where the triangle is: fetching it from the mesh would miss the cache.
    place: (&'a Block, usize),
}

/// A search along one ray. `LENIENT`: only the far sides of closed surfaces the photon is behind, edges widened by
/// their rounding.
struct Search<'a, const LENIENT: bool> {
    geometry: &'a Geometry,
    ray: &'a Ray,
    boxes: &'a BoxRay,
    at: &'a Whereabouts,
    only: Option<SurfaceId>,
    best: Option<Best<'a>>,
    nearest_t: f64,
    limit: f32,
    skipped: Skipped,
}

impl<'a, const LENIENT: bool> Search<'a, LENIENT> {
    #[inline(always)]
    fn new(
        geometry: &'a Geometry,
        (ray, boxes): (&'a Ray, &'a BoxRay),
        at: &'a Whereabouts,
        only: Option<SurfaceId>,
    ) -> Self {
        Self {
            geometry,
            ray,
            boxes,
            at,
            only,
            best: None,
            nearest_t: f64::INFINITY,
            limit: f32::INFINITY,
            skipped: Skipped::new(),
        }
    }

    /// Judges a crossing at `crossing.t`; `bound` is asked for only near the origin.
    #[inline(always)]
    fn consider(
        &mut self,
        (primitive, surface): (u32, u32),
        (view, place): (&View, (&'a Block, usize)),
        crossing: Crossing,
        bound: impl FnOnce() -> f64,
    ) {
        let t = crossing.t;
        let cap = self.geometry.bound_cap;
        let info = &self.geometry.info[surface as usize];
        if !(t >= -cap && t <= self.nearest_t) {
            return;
        }
        let mut here = false;
        if t <= cap {
            let bound = bound().min(cap);
            if t < -bound {
                return;
            }
            here = t <= bound;
        }
        let verdict = self.at.judge(SurfaceId(surface), info.body, crossing.front, here);
        if verdict == Verdict::Contradicts {
            self.skipped.push(t, self.nearest_t);
            return;
        }
        let t = t.max(0.0);
        let first = match &self.best {
            Some(b) => (t, info.rank, primitive) < (b.t, b.rank, b.primitive),
            None => true,
        };
        if first {
            self.best = Some(Best { t, rank: info.rank, primitive, surface, crossing, view: *view, place });
            self.nearest_t = t;
            self.limit = self.boxes.limit(t);
        }
    }

    #[inline(always)]
    fn triangle(&mut self, (block, lane): (&'a Block, usize), lanes: &Lanes) {
        let (primitive, surface) = (block.primitive[lane], block.surface[lane]);
        let view = lanes.view(lane, self.ray);
        if LENIENT {
            self.lenient_triangle((block, lane), &view);
            return;
        }
        let Some(crossing) = view.crossing() else { return };
        if self.at.has_met(primitive) {
            return;
        }
        let ray = self.ray;
        self.consider((primitive, surface), (&view, (block, lane)), crossing, || {
            view.bound(ray, coordinate_error(&block.triangle(lane), ray))
        });
    }

    #[cold]
    fn lenient_triangle(&mut self, (block, lane): (&'a Block, usize), view: &View) {
        let (primitive, surface) = (block.primitive[lane], block.surface[lane]);
        let error = coordinate_error(&block.triangle(lane), self.ray);
        let Some(crossing) = view.lenient_crossing(error) else { return };
        if crossing.front || self.at.has_met(primitive) {
            return;
        }
        let ray = self.ray;
        self.consider((primitive, surface), (view, (block, lane)), crossing, || view.bound(ray, error));
    }

    #[inline(never)]
    fn analytic(&mut self, (block, lane): (&'a Block, usize)) {
        let (primitive, surface) = (block.primitive[lane], block.surface[lane]);
        let on = self.at.has_met(primitive);
        let none = [None, None];
        let roots: [Option<Root>; 2] = match &self.geometry.surfaces[surface as usize].shape {
            Shape::Sphere(s) if LENIENT => [Some(s.exit(self.ray)), None],
            Shape::Sphere(s) => s.roots(self.ray, on),
            Shape::Paraboloid(p) if !LENIENT => p.roots(self.ray, on),
            Shape::Paraboloid(_) | Shape::Mesh(_) | Shape::Rectangle(_) => none,
        };
        for root in roots.into_iter().flatten() {
            let crossing = Crossing { t: root.t, weights: [0.0; 2], front: root.front };
            self.consider((primitive, surface), (&View::NONE, (block, lane)), crossing, || root.bound);
        }
    }

    /// All primitives of a block that the ray may meet.
    #[inline(always)]
    fn block(&mut self, block: &'a Block) {
        let (lanes, not_missed) = block.candidates(self.ray);
        let mut mask = if LENIENT { (1 << block.count) - 1 } else { not_missed };
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 3;
            mask &= mask - 1;
            let surface = SurfaceId(block.surface[lane]);
            if self.only.is_some_and(|s| s != surface) || (LENIENT && !self.at.is_behind(surface)) {
                continue;
            }
            if block.analytic >> lane & 1 == 1 {
                self.analytic((block, lane));
            } else {
                self.triangle((block, lane), &lanes);
            }
        }
    }
}

impl<'a, const LENIENT: bool> Visitor<'a> for Search<'a, LENIENT> {
    #[inline(always)]
    fn leaf(&mut self, block: &'a Block) {
        self.block(block);
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }
}

/// A search that ends at the first surface it finds.
struct Blocked<'a>(Search<'a, false>);

impl<'a> Visitor<'a> for Blocked<'a> {
    #[inline(always)]
    fn leaf(&mut self, block: &'a Block) {
        self.0.block(block);
        if self.0.best.is_some() {
            // No box begins before it: the walk is over.
            self.0.limit = -1.0;
        }
    }

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.0.limit
    }
}

impl Geometry {
    /// Whether anything stands between `origin` (m) and the point `distance` (m) away along the unit vector `direction`:
    /// `nearest(..).t < distance`, sooner answered. `at` is where the ray starts, as for [`Self::nearest`], by whose rules
    /// candidates count.
    pub fn occluded(&self, origin: DVec3, direction: DVec3, distance: f64, at: &Whereabouts) -> bool {
        if at.in_film().is_some() {
            return distance > 0.0;
        }
        if at.is_behind_any() {
            // Whether a rim has to be looked for depends on what lies beyond.
            return self.nearest(origin, direction, at, &mut 0).is_some_and(|hit| hit.t < distance);
        }
        let Some(ray) = Ray::new(origin, direction) else { return false };
        let Some(boxes) = BoxRay::new(&ray, &self.normalisation) else { return false };
        // `consider` takes what is not farther than the nearest so far.
        let within = distance.next_down();
        let mut search = Blocked(Search::new(self, (&ray, &boxes), at, None));
        search.0.nearest_t = within;
        search.0.limit = boxes.limit(within);
        self.walk_tree(&boxes, &mut search);
        search.0.best.is_some()
    }

    /// The nearest hit of a ray from `origin` (m) along the unit vector `direction`.
    ///
    /// `at` says where the photon is: primitives just met, the sides it left them on, the closed surfaces it is
    /// behind. Candidates that contradict it are the same crossing seen again, or the rounding of a silhouette; those
    /// before the hit are added to `skipped`. Among equal distances the first by surface name and face number is
    /// taken, so the answer does not depend on the order of surfaces.
    ///
    /// A ray that is behind a closed surface and by rounding misses its far side (it entered at a silhouette) gets the
    /// nearest far side within rounding; that, too, is counted.
    #[inline]
    pub fn nearest(
        &self,
        origin: DVec3,
        direction: DVec3,
        at: &Whereabouts,
        skipped: &mut u64,
    ) -> Option<Hit> {
        self.nearest_by(origin, direction, at, skipped, true)
    }

    /// [`Geometry::nearest`] by trying every primitive: the same bits, slowly. For checking the search structure.
    pub fn nearest_by_exhaustion(
        &self,
        origin: DVec3,
        direction: DVec3,
        at: &Whereabouts,
        skipped: &mut u64,
    ) -> Option<Hit> {
        self.nearest_by(origin, direction, at, skipped, false)
    }

    #[inline(always)]
    fn nearest_by(
        &self,
        origin: DVec3,
        direction: DVec3,
        at: &Whereabouts,
        skipped: &mut u64,
        tree: bool,
    ) -> Option<Hit> {
        if let Some((left, next)) = at.in_film() {
            return self.across_film(origin, left, next);
        }
        let ray = Ray::new(origin, direction)?;
        let boxes = BoxRay::new(&ray, &self.normalisation)?;
        let rays = (&ray, &boxes);
        let mut search = Search::<false>::new(self, rays, at, None);
        self.run(&mut search, tree);
        *skipped += search.skipped.before(search.nearest_t);
        // References: to move what was found costs more than to look for a rim.
        let rim =
            if at.is_behind_any() { self.rim(search.best.as_ref(), rays, at, skipped, tree) } else { None };
        let best = rim.as_ref().or(search.best.as_ref())?;
        let (block, lane) = best.place;
        let hit = self.finish(best, &block.triangle(lane), &ray);
        if self.info[best.surface as usize].touches {
            return Some(self.in_contact(&hit, &ray, at));
        }
        Some(hit)
    }

    /// A photon that has entered a closed surface must leave it: where no exact crossing is left, the far side is
    /// taken within rounding, if it comes before the best hit.
    #[inline(never)]
    fn rim<'a>(
        &'a self,
        best: Option<&Best<'a>>,
        rays: (&'a Ray, &'a BoxRay),
        at: &'a Whereabouts,
        skipped: &mut u64,
        tree: bool,
    ) -> Option<Best<'a>> {
        let Some(far) = best else { return self.far_side(f64::INFINITY, None, rays, at, skipped, tree) };
        // Of those entered at this very place, the last one as a rule, each must have a far side ahead.
        let mut rim: Option<Best<'a>> = None;
        for entered in at.entered_here().filter(|s| s.0 != far.surface) {
            let mut search = Search::<false>::new(self, rays, at, Some(entered));
            self.run(&mut search, tree);
            if search.best.is_none() {
                let before = rim.as_ref().unwrap_or(far).t;
                rim = self.far_side(before, Some(entered), rays, at, skipped, tree).or(rim);
            }
        }
        rim
    }

    /// The far side within rounding of a closed surface, or of any, if there is one no farther than `before` (m).
    fn far_side<'a>(
        &'a self,
        before: f64,
        only: Option<SurfaceId>,
        rays: (&'a Ray, &'a BoxRay),
        at: &'a Whereabouts,
        skipped: &mut u64,
        tree: bool,
    ) -> Option<Best<'a>> {
        let mut search = Search::<true>::new(self, rays, at, only);
        self.run(&mut search, tree);
        let far = search.best.filter(|far| far.t <= before);
        *skipped += u64::from(far.is_some());
        far
    }

    #[inline(always)]
    fn run<'a, const LENIENT: bool>(&'a self, search: &mut Search<'a, LENIENT>, tree: bool) {
        if !tree {
            for block in &self.tree.blocks {
                search.block(block);
            }
            return;
        }
        self.walk_tree(search.boxes, search);
    }

    #[inline(always)]
    fn walk_tree<'a, V: Visitor<'a>>(&'a self, boxes: &BoxRay, visitor: &mut V) {
        #[cfg(target_arch = "x86_64")]
        if self.avx2 {
            // SAFETY: `avx2` is set only where the processor was found to have it.
            #[allow(unsafe_code)]
            unsafe {
                self.walk_avx2(boxes, visitor);
            }
            return;
        }
        self.walk(boxes, visitor);
    }

    /// The walk compiled for AVX2 and bit counts. No fused operations: the same bits as without.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1")]
    fn walk_avx2<'a, V: Visitor<'a>>(&'a self, boxes: &BoxRay, visitor: &mut V) {
        self.walk(boxes, visitor);
    }

    /// The stack holds 7 entries a level and one more; the tree's depth picks its size.
    #[inline(always)]
    fn walk<'a, V: Visitor<'a>>(&'a self, boxes: &BoxRay, visitor: &mut V) {
        match self.tree.depth {
            0..=9 => self.tree.walk::<64, _>(boxes, visitor),
            10..=18 => self.tree.walk::<128, _>(boxes, visitor),
            _ => self.tree.walk::<512, _>(boxes, visitor),
        }
    }

    /// A hit on a primitive that the ray is known to meet.
    pub(super) fn hit_on(&self, primitive: u32, crossing: Crossing, ray: &Ray) -> Hit {
        let surface = self.surface_of(primitive);
        let Info { rank, first_primitive, .. } = self.info[surface as usize];
        let corners = self.surfaces[surface as usize].shape.triangle((primitive - first_primitive) as usize);
        let corners = corners.map_or([[0.0; 3]; 3], |corners| corners.map(|v| v.to_array()));
        let (view, t) = (View::new(&corners, ray), crossing.t.max(0.0));
        let place = (&Block::EMPTY, 0);
        self.finish(&Best { t, rank, primitive, surface, crossing, view, place }, &corners, ray)
    }

    /// Position and normals of the chosen candidate, whose triangle has these corners.
    #[inline(always)]
    fn finish(&self, best: &Best<'_>, corners: &[[f64; 3]; 3], ray: &Ray) -> Hit {
        let info = &self.info[best.surface as usize];
        let shape = &self.surfaces[best.surface as usize].shape;
        let face = best.primitive - info.first_primitive;
        let [v, w] = best.crossing.weights;
        let facing = if best.crossing.front { -ray.direction } else { ray.direction };
        let flat = || {
            let [a, b, c] = corners.map(DVec3::from_array);
            let (ab, ac) = (b - a, c - a);
            let normal = ab.cross(ac).try_normalize().unwrap_or(facing);
            let bound = best.view.bound(ray, coordinate_error(corners, ray));
            (a + ab * v + ac * w, normal, bound)
        };
        let along = ray.origin + ray.direction * best.t;
        let (position, normal, bound) = match shape {
            Shape::Mesh(_) | Shape::Rectangle(_) => flat(),
            Shape::Sphere(s) => {
                let p = s.project(along);
                (p, s.normal(p), s.exit(ray).bound)
            }
            Shape::Paraboloid(p) => {
                let q = p.project(along);
                (q, p.normal(q), p.bound(ray))
            }
        };
        let shading_normal = shape.shading_normal(face as usize, [v, w], normal);
        Hit {
            t: best.t,
            t_bound: bound.min(self.bound_cap),
            position,
            surface: SurfaceId(best.surface),
            primitive: best.primitive,
            face,
            normal,
            shading_normal,
            front: best.crossing.front,
            body: info.body,
            touch: None,
        }
    }
}
