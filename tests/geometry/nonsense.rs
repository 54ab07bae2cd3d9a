//! Nonsense thrown at every constructor of a shape, a transform and a receiver: each refuses it and names the parameter.

use caustix::error::Invalid;
use caustix::geometry::{
    Formula, HeightImage, Heightfield, Mesh, MeshParts, Noise, Octave, Paraboloid, Rectangle, Smoothing,
    Sphere, Transform, Wave, box_mesh,
};
use caustix::scene::receiver::ReceiverSpec;
use glam::{DVec2, DVec3};

/// What is no coordinate.
const NO_COORDINATE: [f64; 5] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300];
/// What is no length either.
const NO_LENGTH: [f64; 8] =
    [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0, -1.0, f64::MIN_POSITIVE];

type Made = Result<(), Invalid>;

/// Every one of `values` in the place of a number is refused with this parameter's name; 0.5 is not.
#[track_caller]
fn refuses(what: &str, values: &[f64], make: impl Fn(f64) -> Made) {
    assert_eq!(make(0.5), Ok(()), "{what}");
    for &value in values {
        match make(value) {
            Err(e) => assert_eq!(e.what(), what, "{value}: {e}"),
            Ok(()) => panic!("{what} = {value} was taken"),
        }
    }
}

/// The same for each component of a vector that else is `good`.
#[track_caller]
fn refuses_vector(what: &str, values: &[f64], good: DVec3, make: impl Fn(DVec3) -> Made) {
    assert_eq!(make(good), Ok(()), "{what}");
    for (axis, &value) in (0..3).flat_map(|axis| values.iter().map(move |v| (axis, v))) {
        let mut bad = good;
        bad[axis] = value;
        match make(bad) {
            Err(e) => assert_eq!(e.what(), what, "{bad}: {e}"),
            Ok(()) => panic!("{what} = {bad} was taken"),
        }
    }
}

#[test]
fn rectangles() {
    let make = |c, u, v| Rectangle::new(c, u, v).map(drop);
    let (c, u, v) = (DVec3::ONE, DVec3::X, DVec3::Y);
    refuses_vector("corner", &NO_COORDINATE, c, |c| make(c, u, v));
    refuses_vector("edge_u", &NO_COORDINATE, u, |u| make(c, u, v));
    refuses_vector("edge_v", &NO_COORDINATE, v, |v| make(c, u, v));
    for bad in [DVec3::ZERO, u, -u, v + 1e-6 * u, DVec3::new(1e-10, 1.0, 0.0) * 1e10] {
        assert_eq!(make(c, u, bad).unwrap_err().what(), "edge_v", "{bad}");
    }
    // Shorter than the corner's last digit.
    assert_eq!(make(DVec3::splat(9e8), u * 1e-8, v).unwrap_err().what(), "corner");
}

#[test]
fn exact_shapes_and_boxes() {
    refuses_vector("center", &NO_COORDINATE, DVec3::ONE, |c| Sphere::new(c, 1.0).map(drop));
    refuses("radius", &NO_LENGTH, |r| Sphere::new(DVec3::ONE, r).map(drop));
    let bowl = |v, axis, f, r| Paraboloid::new(v, axis, f, r).map(drop);
    refuses_vector("vertex", &NO_COORDINATE, DVec3::ONE, |v| bowl(v, DVec3::Z, 1.0, 1.0));
    refuses("focal_length", &NO_LENGTH, |f| bowl(DVec3::ONE, DVec3::Z, f, 1.0));
    refuses("radius", &NO_LENGTH, |r| bowl(DVec3::ONE, DVec3::Z, 1.0, r));
    for axis in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::new(0.0, f64::NAN, 1.0)] {
        assert_eq!(bowl(DVec3::ONE, axis, 1.0, 1.0).unwrap_err().what(), "axis", "{axis}");
    }
    // Any length of axis is a direction.
    for axis in [DVec3::Z * 1e300, DVec3::Z * 1e-300] {
        assert_eq!(Paraboloid::new(DVec3::ONE, axis, 1.0, 1.0).unwrap().axis(), DVec3::Z);
    }
    let cuboid = |min, max| box_mesh(min, max).map(drop);
    refuses_vector("min", &NO_COORDINATE, DVec3::ZERO, |min| cuboid(min, DVec3::ONE));
    refuses_vector("max", &[NO_COORDINATE.as_slice(), &[0.0, -1.0]].concat(), DVec3::ONE, |max| {
        cuboid(DVec3::ZERO, max)
    });
}

#[test]
fn transforms() {
    let make = |s, r, t| Transform::new(s, r, t).map(drop);
    let zero = DVec3::ZERO;
    refuses_vector("scale", &NO_LENGTH, DVec3::ONE, |s| make(s, zero, zero));
    refuses_vector("rotate_deg", &NO_COORDINATE, DVec3::ONE, |r| make(DVec3::ONE, r, zero));
    refuses_vector("translate", &NO_COORDINATE, DVec3::ONE, |t| make(DVec3::ONE, zero, t));
    let squeezed = Transform::new(DVec3::new(1.0, 1.0, 2.0), zero, zero).unwrap();
    assert_eq!(Sphere::new(zero, 1.0).unwrap().transformed(&squeezed).unwrap_err().what(), "scale");
    let diagonal = Rectangle::new(zero, DVec3::new(0.0, 1.0, 1.0), DVec3::new(0.0, -1.0, 1.0)).unwrap();
    assert!(matches!(diagonal.transformed(&squeezed), Err(Invalid::Skew { what: "edge_v", .. })));
}

#[test]
fn heightfields() {
    let flat = || Formula::Waves(Vec::new());
    let field = |origin, size, cells, formula| Heightfield::new(origin, size, cells, formula).map(drop);
    refuses_vector("origin", &NO_COORDINATE, DVec3::ONE, |o| field(o, DVec2::ONE, [2, 2], flat()));
    refuses("size", &NO_LENGTH, |x| field(DVec3::ONE, DVec2::new(x, 1.0), [2, 2], flat()));
    refuses("size", &NO_LENGTH, |y| field(DVec3::ONE, DVec2::new(1.0, y), [2, 2], flat()));
    for cells in [[0, 1], [1, 0], [u32::MAX, u32::MAX], [4096, 1025]] {
        assert_eq!(field(DVec3::ONE, DVec2::ONE, cells, flat()).unwrap_err().what(), "cells");
    }
    let wave = Wave { amplitude_m: 0.1, wavelength_m: 0.5, direction_deg: 1.0, phase_deg: 2.0 };
    let waves = |w| field(DVec3::ONE, DVec2::ONE, [2, 2], Formula::Waves(vec![wave, w]));
    refuses("amplitude", &NO_COORDINATE, |x| waves(Wave { amplitude_m: x, ..wave }));
    refuses("wavelength", &NO_LENGTH, |x| waves(Wave { wavelength_m: x, ..wave }));
    refuses("direction_deg", &NO_COORDINATE, |x| waves(Wave { direction_deg: x, ..wave }));
    refuses("phase_deg", &NO_COORDINATE, |x| waves(Wave { phase_deg: x, ..wave }));
    let octave = Octave { amplitude: 1.0, wavelength_m: 0.5 };
    let noise = |o, peak| Noise::new(1, vec![octave, o], peak).map(drop);
    let negative = [f64::NAN, f64::INFINITY, 1e300, -1.0];
    refuses("amplitude", &negative, |x| noise(Octave { amplitude: x, ..octave }, 1.0));
    refuses("wavelength", &NO_LENGTH, |x| noise(Octave { wavelength_m: x, ..octave }, 1.0));
    refuses("amplitude", &negative, |x| noise(octave, x));
    for octaves in [vec![], vec![Octave { amplitude: 0.0, ..octave }], vec![octave; 33]] {
        assert_eq!(Noise::new(1, octaves, 1.0).unwrap_err().what(), "octaves");
    }
    refuses("height", &NO_COORDINATE, |x| HeightImage::new(2, 2, vec![0.0, x, 0.0, 0.0]).map(drop));
    for (columns, rows) in [(1, 4), (4, 1), (2, 3), (usize::MAX, 2)] {
        assert_eq!(HeightImage::new(columns, rows, vec![0.0; 4]).unwrap_err().what(), "image");
    }
}

#[test]
fn meshes() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let mesh = |corners: [DVec3; 3], triangles: Vec<[u32; 3]>, normal: DVec3| {
        let normal_indices = vec![[0; 3]; triangles.len()];
        let (vertices, normals) = (corners.to_vec(), vec![normal]);
        let parts = MeshParts { vertices, triangles, normals, normal_indices, ..MeshParts::default() };
        Mesh::new(parts, Smoothing::Given, false).map(drop)
    };
    let one = || vec![[0, 1, 2]];
    refuses_vector("vertices", &NO_COORDINATE, DVec3::ONE, |v| {
        mesh([v, corners[1], corners[2]], one(), DVec3::Z)
    });
    for normal in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
        assert_eq!(mesh(corners, one(), normal).unwrap_err().what(), "normals");
    }
    for triangles in [vec![], vec![[0, 1, 3]], vec![[0, 0, 1]], vec![[u32::MAX; 3]]] {
        assert_eq!(mesh(corners, triangles, DVec3::Z).unwrap_err().what(), "triangles");
    }
}

#[test]
fn receivers() {
    let long = "n".repeat(201);
    for name in ["", ".", "../up", "a/b", "a\\b", "camera", "NUL", " a", "a ", "a\u{7}", "*", long.as_str()] {
        assert_eq!(ReceiverSpec::new(name, "plate").unwrap_err().what(), "name", "{name:?}");
    }
    for cells in [[0, 1], [1, 0], [0, 0], [8192, 8193], [u32::MAX, u32::MAX]] {
        let refused = ReceiverSpec::new("plate", "plate").unwrap().with_cells(cells);
        assert_eq!(refused.unwrap_err().what(), "cells", "{cells:?}");
    }
    assert!(ReceiverSpec::new("Wand-Süd 2.1", "plate").unwrap().with_cells([8192, 8192]).is_ok());
}
