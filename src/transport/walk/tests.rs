//! The walk on scenes of a few surfaces, with scripted events.

use super::*;
use crate::emitter::{Emitter, Isotropic};
use crate::geometry::mesh::{MeshParts, Smoothing};
use crate::geometry::{Mesh, Rectangle, Shape, SurfaceId, box_mesh};
use crate::sample::coordinates::Coordinates;
use crate::scattering::{Frame, LobeData, LobeSide, Quantity, ScatterTable};
use crate::scene::SceneBuilder;
use crate::sequence::independent::IndependentPoints;
use crate::surface::tabulated::{Energy, Options};
use crate::surface::tests::Script;
use crate::surface::{Dielectric, Lambertian, Material, Mirror, Reflectance, Rgb, Tabulated};
use crate::transport::trap::walk;

/// An arrival: surface, front, events, whether the photon was behind that surface; what it carried.
type Seen<T> = Vec<((u32, bool, u32, bool), T)>;

impl<T: Throughput> Sink<T> for Seen<T> {
    fn arrive(&mut self, arrival: &Arrival<'_, T>) {
        let Arrival { hit, events, carried, whereabouts, .. } = *arrival;
        self.push(((hit.surface.0, hit.front, events, whereabouts.is_behind(hit.surface)), *carried));
    }
}

fn scene(surfaces: impl IntoIterator<Item = (Shape, Material)>) -> Scene {
    let mut scene = SceneBuilder::new();
    for (i, (shape, material)) in surfaces.into_iter().enumerate() {
        scene.surface(format!("surface {i}"), shape, material);
    }
    scene.emitter("lamp", Emitter::Isotropic(Isotropic::new(DVec3::splat(5.0), 1.0).unwrap()));
    scene.build().unwrap()
}

/// A square about the z axis at this height that looks up or down.
fn plate(z: f64, up: bool) -> Shape {
    let y = if up { 2.0 } else { -2.0 };
    let corner = DVec3::new(-1.0, -0.5 * y, z);
    Shape::Rectangle(Rectangle::new(corner, DVec3::X * 2.0, DVec3::Y * y).unwrap())
}

fn mirror(reflectance: f64) -> Material {
    Material::Mirror(Mirror::new(Reflectance::new(reflectance).unwrap()))
}

fn down() -> Emission {
    Emission { origin: DVec3::new(0.1, 0.2, 0.5), direction: DVec3::NEG_Z, weight: 1.0 }
}

fn walked<C: Chooser, T: Throughput>(
    scene: &Scene,
    emission: Emission,
    carried: T,
    chooser: &mut C,
) -> (End, Seen<T>, Exceptions) {
    let (mut seen, mut exceptions) = (Seen::new(), Exceptions::default());
    let start = Whereabouts::default();
    let end = walk(scene, emission, start, carried, chooser, &mut seen, &mut exceptions);
    (end, seen, exceptions)
}

/// Without what is counted of every photon.
fn odd(exceptions: Exceptions) -> Exceptions {
    Exceptions { events: 0, met: 0, ..exceptions }
}

#[test]
fn arrivals_are_told_before_the_event_until_nothing_is_met() {
    let red = Reflectance::rgb([1.0, 0.5, 0.0]).unwrap();
    let floor = (plate(0.0, true), Material::Mirror(Mirror::new(red)));
    let mut script = Script::new([true], []);
    let (end, seen, exceptions) = walked(&scene([floor]), down(), Rgb::WHITE, &mut script);
    assert_eq!((end, odd(exceptions)), (End::Escaped, Exceptions::default()));
    assert_eq!(seen.len(), 1);
    assert_eq!(seen[0].0, (0, true, 0, false), "direct light on the front");
    assert_eq!(seen[0].1.weight(), [1.0; 3], "what it carried on arrival");
}

#[test]
fn it_ends_on_the_surface_that_absorbs() {
    let dull = Material::Lambertian(Lambertian::new(Reflectance::new(0.5).unwrap()));
    let scene = scene([(plate(0.0, true), mirror(0.75)), (plate(1.0, true), dull)]);
    for (events, on) in [(vec![false], 0), (vec![true, false], 1)] {
        let n = events.len();
        let (end, seen, exceptions) = walked(&scene, down(), Grey, &mut Script::new(events, []));
        assert_eq!((end, odd(exceptions)), (End::Absorbed(SurfaceId(on)), Exceptions::default()));
        // The plate above looks up: its back is met.
        let all = [(0, true, 0, false), (1, false, 1, false)];
        assert_eq!(seen.iter().map(|s| s.0).collect::<Vec<_>>(), all[..n]);
    }
}

#[test]
fn its_side_of_a_closed_surface_is_known_from_event_to_event() {
    let glass = Material::Dielectric(Dielectric::new(1.5, 1.0).unwrap());
    let shape = Shape::Mesh(box_mesh(DVec3::new(-1.0, -1.0, -1.0), DVec3::new(1.0, 1.0, 0.0)).unwrap());
    // In, one reflection at the far side, back to the near side and out.
    let mut script = Script::new([false, true, false], []);
    let (end, seen, exceptions) = walked(&scene([(shape, glass)]), down(), Grey, &mut script);
    assert_eq!((end, odd(exceptions)), (End::Escaped, Exceptions::default()));
    let all = [(0, true, 0, false), (0, false, 1, true), (0, false, 2, true)];
    assert_eq!(seen.iter().map(|s| s.0).collect::<Vec<_>>(), all);
}

#[test]
fn the_guard_ends_what_is_caught_for_ever() {
    let scene = scene([(plate(0.0, true), mirror(1.0)), (plate(1.0, false), mirror(1.0))]);
    let (end, seen, exceptions) = walked(&scene, down(), Grey, &mut Script::default());
    assert_eq!((end, odd(exceptions)), (End::Killed, Exceptions::default()));
    assert_eq!(seen.len(), MAX_EVENTS as usize);
    assert_eq!(seen.last().unwrap().0, (1, true, MAX_EVENTS - 1, false));
}

#[test]
fn exceptions_of_smooth_normals_are_counted() {
    let leaning = |normal: [f64; 3]| {
        let parts = MeshParts {
            vertices: vec![DVec3::new(-2.0, -2.0, 0.0), DVec3::new(2.0, -2.0, 0.0), DVec3::Y * 2.0],
            triangles: vec![[0, 1, 2]],
            normals: vec![DVec3::from_array(normal)],
            normal_indices: vec![[0; 3]],
            ..MeshParts::default()
        };
        let mesh = Mesh::new(parts, Smoothing::Given, false).unwrap().0;
        scene([(Shape::Mesh(mesh), mirror(1.0))])
    };
    // In front of the normal and away from the facet; into the facet, mirrored back; behind the normal.
    for (normal, x, corrected) in
        [([0.1, 0.0, 1.0], 0.0, 0), ([1.0, 0.0, 0.8], 0.0, 1), ([1.0, 0.0, 0.5], 1.0, 1)]
    {
        let direction = DVec3::new(x, 0.0, -1.0).normalize();
        let emission = Emission { origin: -0.5 * direction, direction, weight: 1.0 };
        let (end, seen, exceptions) = walked(&leaning(normal), emission, Grey, &mut Script::default());
        assert_eq!((end, seen.len()), (End::Escaped, 1));
        let by_surface = (corrected > 0).then_some((SurfaceId(0), corrected)).into_iter().collect();
        let expected = Exceptions { corrected_directions: by_surface, ..Exceptions::default() };
        assert_eq!(odd(exceptions), expected, "normal {normal:?}, direction {direction}");
    }
}

#[test]
fn photons_that_a_table_sends_below_the_horizon_are_counted() {
    // Wide about the mirrored direction, and nothing absorbed: at 70 degrees much lies below.
    let data = LobeData {
        quantity: Quantity::Reflection,
        side: LobeSide::Both,
        frame: Frame::Specular,
        theta_i_deg: vec![0.0],
        phi_i_deg: vec![0.0],
        polar_deg: vec![0.0, 90.0],
        azimuth_deg: vec![0.0, 360.0],
        channels: 1,
        values: vec![1.0; 4],
        declared_tis: Vec::new(),
    };
    let table = ScatterTable::new("wide", vec![data], Vec::new()).unwrap();
    let options = Options { energy: Energy::Scale, ..Options::default() };
    let table = Tabulated::new(&table, &options).unwrap().0;
    let scene = scene([(plate(0.0, true), Material::Tabulated(Box::new(table)))]);
    let (sin, cos) = 70f64.to_radians().sin_cos();
    let direction = DVec3::new(sin, 0.0, -cos);
    let emission = Emission { origin: -0.5 * direction, direction, weight: 1.0 };
    let points = IndependentPoints::new(3, 0);
    let (mut ended, mut counted) = (0, 0);
    for i in 0..256 {
        let mut coordinates = Coordinates::new(&points, i, true);
        let (end, _, exceptions) = walked(&scene, emission, Grey, &mut coordinates);
        ended += u64::from(end == End::Absorbed(SurfaceId(0)));
        counted += exceptions.below_horizon;
    }
    assert_eq!(ended, counted);
    assert!((32..224).contains(&counted), "{counted}");
}

#[test]
fn crossings_seen_again_are_counted() {
    let shape = Shape::Mesh(box_mesh(DVec3::new(-1.0, -1.0, -1.0), DVec3::new(1.0, 1.0, 0.0)).unwrap());
    let scene = scene([(shape, Material::Absorber)]);
    // Behind the surface already: its near side is the crossing just made.
    let start = Whereabouts::start([SurfaceId(0)]);
    let (mut seen, mut exceptions) = (Seen::new(), Exceptions::default());
    let chooser = &mut Script::default();
    let end = walk(&scene, down(), start, Grey, chooser, &mut seen, &mut exceptions);
    assert_eq!(end, End::Absorbed(SurfaceId(0)));
    assert_eq!(seen.iter().map(|s| s.0).collect::<Vec<_>>(), [(0, false, 0, true)]);
    assert_eq!(odd(exceptions), Exceptions { skipped_crossings: 1, ..Exceptions::default() });
}
