//! Meshes, random numbers and rays for the geometry tests.

use caustix::geometry::{Mesh, MeshParts, Shape, Smoothing, Surface};
use glam::DVec3;

/// Counter-based random numbers: the same for the same (seed, index) whatever the thread.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64, index: u64) -> Self {
        let mut r =
            Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ index.wrapping_mul(0xd1b5_4a32_d192_ed03));
        r.next();
        r
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    pub fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let phi = std::f64::consts::TAU * self.unit();
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * libm::cos(phi), r * libm::sin(phi), z).normalize()
    }

    pub fn in_box(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5) * (2.0 * half)
    }
}

/// What rays met that went straight through closed surfaces.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub struct Tally {
    pub rays: u64,
    pub crossings: u64,
    /// Left the scene while behind a surface.
    pub leaks: u64,
    /// Met a face from the side on which the ray was not.
    pub doubles: u64,
    /// More crossings than a straight line can have.
    pub endless: u64,
    pub skipped: u64,
}

impl Tally {
    pub fn plus(self, o: Self) -> Self {
        Self {
            rays: self.rays + o.rays,
            crossings: self.crossings + o.crossings,
            leaks: self.leaks + o.leaks,
            doubles: self.doubles + o.doubles,
            endless: self.endless + o.endless,
            skipped: self.skipped + o.skipped,
        }
    }

    pub fn faults(self) -> u64 {
        self.leaks + self.doubles + self.endless
    }
}

pub fn named(name: &str, shape: Shape) -> Surface {
    Surface { name: name.into(), shape }
}

/// The icosahedron, each face split `levels` times, on the unit sphere.
pub fn icosphere(levels: usize) -> Mesh {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut vertices: Vec<DVec3> = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ]
    .map(|v| DVec3::from_array(v).normalize())
    .to_vec();
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..levels {
        let mut middle = |a: u32, b: u32| {
            // (a + b) / 2 has the same bits in either order, so the mesh welds them.
            vertices.push(((vertices[a as usize] + vertices[b as usize]) * 0.5).normalize());
            vertices.len() as u32 - 1
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, d, f], [b, e, d], [c, f, e], [d, e, f]]
            })
            .collect();
    }
    let parts = MeshParts { vertices, triangles: faces, ..MeshParts::default() };
    Mesh::new(parts, Smoothing::Flat, true).unwrap().0
}

/// A closed slab of n x n cells whose upper and lower vertices are displaced at random by up to `rough`.
pub fn slab(n: usize, rough: f64) -> Mesh {
    let mut r = Random::new(77, 0);
    let mut vertices = Vec::new();
    for z in [-0.2, 0.2] {
        for j in 0..=n {
            for i in 0..=n {
                let at = |k: usize| 2.0 * k as f64 / n as f64 - 1.0;
                vertices.push(
                    DVec3::new(at(i), at(j), z)
                        + r.in_box(rough).with_z(0.0) * 0.5
                        + DVec3::Z * rough * (r.unit() - 0.5),
                );
            }
        }
    }
    let v = |k: usize, i: usize, j: usize| ((k * (n + 1) + j) * (n + 1) + i) as u32;
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let quad = |k| [v(k, i, j), v(k, i + 1, j), v(k, i + 1, j + 1), v(k, i, j + 1)];
            let [a, b, c, d] = quad(1);
            triangles.extend([[a, b, c], [a, c, d]]);
            let [a, b, c, d] = quad(0);
            triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    for i in 0..n {
        let mut side = |a: (usize, usize), b: (usize, usize)| {
            let (p, q, r, s) = (v(0, a.0, a.1), v(0, b.0, b.1), v(1, b.0, b.1), v(1, a.0, a.1));
            triangles.extend([[p, q, r], [p, r, s]]);
        };
        side((i, 0), (i + 1, 0));
        side((n, i), (n, i + 1));
        side((i + 1, n), (i, n));
        side((0, i + 1), (0, i));
    }
    let parts = MeshParts { vertices, triangles, ..MeshParts::default() };
    Mesh::new(parts, Smoothing::Flat, true).unwrap().0
}
