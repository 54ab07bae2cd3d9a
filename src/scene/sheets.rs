//! Open transparent surfaces, looked through along their normals: what they say of the space between two of them, and whether
//! there is a second one at all.

use std::collections::BTreeMap;

use glam::DVec3;

use crate::error::warning::{Severity, Warning};
use crate::geometry::{Shape, SurfaceId, Whereabouts};

use super::Scene;
use super::media::{MediumId, Role};

/// Two open surfaces that face each other and state different media of the space between.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Clash {
    /// Both, the lower number first.
    pub surfaces: [SurfaceId; 2],
    /// Both fronts look the same way: a pane of which one face should be turned round.
    pub same_way: bool,
    between: [MediumId; 2],
}

/// The code of what is said of a clash, also where photons meet it.
pub const CLASH: &str = "contradicted-medium";

/// Lines through each surface.
const LINES: usize = 64;
/// Most faces crossed along one.
const MOST: usize = 64;
/// Of the lines, so many see the same.
const MANY: usize = LINES / 8;
/// Steeper than this, a liquid does not stand: the most of its normal's component upwards.
const UPRIGHT: f64 = 0.5;
/// A surface is flat whose area, with its direction, sums up to this much of it.
const FLAT: f64 = 0.999;

/// What the lines through one surface show.
#[derive(Default)]
struct Seen {
    clashes: BTreeMap<[SurfaceId; 2], (usize, Option<Clash>)>,
    /// Lines that meet another clear surface next behind it.
    paired: usize,
    lines: usize,
}

/// What is found about the open transparent surfaces.
pub(super) fn look(scene: &Scene) -> (Vec<Clash>, Vec<Warning>) {
    let (mut clashes, mut warnings) = (BTreeMap::new(), Vec::new());
    let ids = (0..scene.geometry.surfaces().len() as u32).map(SurfaceId);
    for surface in ids {
        let Role::Open { media: [before, behind] } = scene.media.role(surface) else { continue };
        if before == behind {
            continue;
        }
        let seen = look_through(scene, surface);
        let enough = seen.clashes.into_values().filter(|(count, _)| *count >= MANY);
        clashes.extend(enough.filter_map(|(_, clash)| clash).map(|clash| (clash.surfaces, clash)));
        if seen.lines > 0
            && seen.paired < MANY
            && is_upright(&scene.geometry.surfaces()[surface.0 as usize].shape)
        {
            warnings.push(one_sheet(scene, surface, behind));
        }
    }
    let clashes: Vec<Clash> = clashes.into_values().collect();
    warnings.splice(0..0, clashes.iter().map(|clash| clash.warning(scene)));
    (clashes, warnings)
}

/// Points of a surface, with the normals of their faces; none of an exact shape.
fn points(shape: &Shape) -> impl Iterator<Item = (DVec3, DVec3)> {
    let faces = shape.face_count();
    (0..LINES).filter_map(move |k| {
        let face = if faces < LINES { k % faces } else { k * faces / LINES };
        let [a, b, c] = shape.triangle(face)?;
        // The additive recurrence of the plastic number, folded into the triangle.
        let [u, v] =
            [0.754_877_666_246_693, 0.569_840_290_998_053].map(|x: f64| (0.5 + x * (k + 1) as f64).fract());
        let [u, v] = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
        Some((a + (b - a) * u + (c - a) * v, (b - a).cross(c - a).try_normalize()?))
    })
}

fn look_through(scene: &Scene, surface: SurfaceId) -> Seen {
    let geometry = &scene.geometry;
    let surfaces = geometry.surfaces();
    let (low, high) = geometry.bounds();
    let far = 2.0 * (high - low).length();
    // Far outside everything one is behind closed surfaces that look inward, and no others.
    let is_inverted = |shape: &Shape| matches!(shape, Shape::Mesh(m) if m.topology().is_closed() && m.topology().signed_volume_m3 < 0.0);
    let ids = (0..surfaces.len() as u32).map(SurfaceId);
    let outside: Vec<SurfaceId> = ids.filter(|s| is_inverted(&surfaces[s.0 as usize].shape)).collect();
    let mut seen = Seen::default();
    for (point, normal) in points(&surfaces[surface.0 as usize].shape) {
        let (mut at, mut origin) = (Whereabouts::start(outside.iter().copied()), point + normal * far);
        let mut crossed: Vec<(SurfaceId, bool)> = Vec::new();
        while let Some(hit) = geometry.nearest(origin, -normal, &at, &mut 0).filter(|_| crossed.len() < MOST)
        {
            crossed.push((hit.surface, hit.front));
            scene.media.leave(&mut at, &hit, hit.other_side());
            origin = hit.position;
        }
        seen.lines += 1;
        let is_clear = |s: SurfaceId| scene.media.role(s) != Role::Solid;
        let mut is_paired = false;
        for pair in crossed.windows(2) {
            let [(a, a_front), (b, b_front)] = [pair[0], pair[1]];
            is_paired |=
                (a == surface && a_front && is_clear(b)) || (b == surface && !b_front && is_clear(a));
            let (Role::Open { media: of_a }, Role::Open { media: of_b }) =
                (scene.media.role(a), scene.media.role(b))
            else {
                continue;
            };
            let between = [of_a[usize::from(a_front)], of_b[usize::from(!b_front)]];
            if a == b || (a != surface && b != surface) || between[0] == between[1] {
                continue;
            }
            let (surfaces, between) =
                if a < b { ([a, b], between) } else { ([b, a], [between[1], between[0]]) };
            let (count, clash) = seen.clashes.entry(surfaces).or_default();
            *count += 1;
            *clash = Some(Clash { surfaces, same_way: a_front == b_front, between });
        }
        seen.paired += usize::from(is_paired);
    }
    seen
}

/// Whether it is flat and stands: no liquid's surface does.
fn is_upright(shape: &Shape) -> bool {
    let triangles = (0..shape.face_count()).filter_map(|face| shape.triangle(face));
    let sum: DVec3 = triangles.map(|[a, b, c]| (b - a).cross(c - a)).sum::<DVec3>() * 0.5;
    sum.length() > FLAT * shape.area() && sum.z.abs() < UPRIGHT * sum.length()
}

impl Clash {
    /// What to do.
    pub fn remedy(&self) -> &'static str {
        if self.same_way {
            "their fronts look the same way: turn the second face of a pane round, so that its front looks out, too (a \
             rectangle: exchange edge_u and edge_v; a heightfield: `facing`), or exchange its `ior` and `ior_outside`"
        } else {
            "state the same medium of the space between them: `ior` is what is behind the front of each, `ior_outside` what \
             is before it"
        }
    }

    fn warning(&self, scene: &Scene) -> Warning {
        let surfaces = self.surfaces.map(|s| scene.geometry.name(s).to_owned());
        let ([a, b], [first, second]) = (&surfaces, self.between.map(|m| scene.media.ior(m)));
        Warning {
            severity: Severity::Doubtful,
            code: CLASH,
            message: format!(
                "of the space between \"{a}\" and \"{b}\" the first says that its refractive index is {first}, the second \
                 {second}"
            ),
            surfaces: surfaces.to_vec(),
            share: None,
            remedy: self.remedy().into(),
        }
    }
}

fn one_sheet(scene: &Scene, surface: SurfaceId, behind: MediumId) -> Warning {
    let name = scene.geometry.name(surface).to_owned();
    Warning {
        severity: Severity::Doubtful,
        code: "one-sheet",
        message: format!(
            "the open surface \"{name}\" stands upright and has no second face: light that passes it is bent once, and all \
             that lies behind it is in a medium of refractive index {}",
            scene.media.ior(behind)
        ),
        surfaces: vec![name],
        share: None,
        remedy: "a pane has two faces: draw it as a box, or with a second sheet whose front looks out on the other side".into(),
    }
}
