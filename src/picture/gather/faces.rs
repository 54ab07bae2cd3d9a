//! The faces of one surface, searched by place: how much of a kernel a mesh holds within a ball.
//!
//! A binary tree by the median of the middles. A node knows the area of its faces and the first two moments
//! of it, and how far its normals turn, so that what lies wholly within the ball is one look-up whatever the
//! number of faces, and only those at its rim are taken one by one.

use glam::DVec3;

use crate::scene::camera::Kernel;

/// Cosine between normals from which two faces belong to one footprint: 60 degrees.
pub const LEAST_COSINE: f64 = 0.5;

/// Faces of a leaf.
const LEAF: usize = 4;

#[derive(Debug, Clone, Copy)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Area (m2), its first moment about the box's middle, and the integral of the squared distance from
    /// there.
    area: f64,
    first: DVec3,
    second: f64,
    /// Mean normal, and the farthest that one of the normals is from it.
    normal: DVec3,
    spread: f64,
    /// Faces `order[begin..end]`; the second child, or 0 for a leaf. The first child follows its parent.
    begin: u32,
    end: u32,
    other: u32,
}

/// Triangles with their normals, ready to be asked what of them lies within a ball.
#[derive(Debug)]
pub struct FaceTree {
    triangles: Vec<[DVec3; 3]>,
    normals: Vec<[f32; 3]>,
    order: Vec<u32>,
    nodes: Vec<Node>,
}

impl FaceTree {
    /// Of triangles, right-handed about their outward normals.
    pub fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let normals = triangles.iter().map(|t| normal_of(t).as_vec3().to_array()).collect();
        let order = (0..triangles.len() as u32).collect();
        let mut tree = Self { triangles, normals, order, nodes: Vec::new() };
        if !tree.triangles.is_empty() {
            tree.build(0, tree.triangles.len());
        }
        tree
    }

    /// Outward unit normal of a face, to the precision that faces are compared with.
    #[inline]
    pub fn normal(&self, face: usize) -> DVec3 {
        let [x, y, z] = self.normals[face];
        DVec3::new(f64::from(x), f64::from(y), f64::from(z))
    }

    /// Whether the face is turned less than 60 degrees from `normal`.
    #[inline]
    pub fn faces(&self, face: usize, normal: DVec3) -> bool {
        self.normal(face).dot(normal) > LEAST_COSINE
    }

    /// Integral of a kernel of this radius (m) about `centre` over the faces turned less than 60 degrees from
    /// `normal`.
    pub fn integral(&self, kernel: Kernel, centre: DVec3, normal: DVec3, radius_m: f64) -> f64 {
        let mut stack = [0u32; 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        let mut sum = 0.0;
        while depth > 0 {
            depth -= 1;
            let at = stack[depth];
            let node = &self.nodes[at as usize];
            let near = centre.clamp(node.low, node.high) - centre;
            let cosine = node.normal.dot(normal);
            if near.length_squared() >= radius_m * radius_m || cosine + node.spread <= LEAST_COSINE {
                continue;
            }
            let far = (centre - node.low).abs().max((centre - node.high).abs());
            let whole = far.length_squared() < radius_m * radius_m;
            if whole && cosine - node.spread > LEAST_COSINE {
                let from = 0.5 * (node.low + node.high) - centre;
                let second = node.second + 2.0 * from.dot(node.first) + from.length_squared() * node.area;
                let r2 = radius_m * radius_m;
                sum += kernel.over_whole(node.area / r2, second / node.area / r2);
            } else if node.other == 0 {
                for &face in &self.order[node.begin as usize..node.end as usize] {
                    if self.faces(face as usize, normal) {
                        sum += self.face_integral(kernel, centre, radius_m, face as usize);
                    }
                }
            } else {
                stack[depth] = node.other;
                stack[depth + 1] = at + 1;
                depth += 2;
            }
        }
        sum
    }

    fn face_integral(&self, kernel: Kernel, centre: DVec3, radius_m: f64, face: usize) -> f64 {
        let corners = self.triangles[face].map(|v| (v - centre) / radius_m);
        // Of a sliver the facet's normal is known only as well as its coordinates allow; what it adds is as
        // small.
        kernel.over_polygon(&corners, normal_of(&corners))
    }

    fn build(&mut self, begin: usize, end: usize) -> u32 {
        let at = self.nodes.len();
        let node = self.summary(begin, end);
        self.nodes.push(node);
        if end - begin > LEAF {
            let axis = (node.high - node.low).max_position();
            let triangles = &self.triangles;
            let middle = |face: u32| triangles[face as usize].iter().map(|v| v[axis]).sum::<f64>();
            let half = (end - begin) / 2;
            self.order[begin..end]
                .select_nth_unstable_by(half, |&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
            self.build(begin, begin + half);
            self.nodes[at].other = self.build(begin + half, end);
        }
        at as u32
    }

    fn summary(&self, begin: usize, end: usize) -> Node {
        let faces = &self.order[begin..end];
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut normal = DVec3::ZERO;
        for &face in faces {
            for v in self.triangles[face as usize] {
                low = low.min(v);
                high = high.max(v);
            }
            normal += self.normal(face as usize);
        }
        let normal = normal / faces.len() as f64;
        let middle = 0.5 * (low + high);
        let (mut area, mut first, mut second, mut spread) = (0.0, DVec3::ZERO, 0.0, 0.0f64);
        for &face in faces {
            let [a, b, c] = self.triangles[face as usize].map(|v| v - middle);
            let size = 0.5 * (b - a).cross(c - a).length();
            area += size;
            first += (a + b + c) * (size / 3.0);
            // The mean of a quadratic over a triangle is that over the middles of its edges.
            let square = |p: DVec3, q: DVec3| (0.5 * (p + q)).length_squared();
            second += (square(a, b) + square(b, c) + square(c, a)) * (size / 3.0);
            spread = spread.max((self.normal(face as usize) - normal).length());
        }
        let (begin, end) = (begin as u32, end as u32);
        Node { low, high, area, first, second, normal, spread, begin, end, other: 0 }
    }
}

/// Outward unit normal of a triangle; zero where it has none.
fn normal_of([a, b, c]: &[DVec3; 3]) -> DVec3 {
    let (u, v) = (*b - *a, *c - *a);
    // Scaled first: the product of tiny edges would underflow.
    let scale = u.abs().max(v.abs()).max_element();
    if scale > 0.0 { (u / scale).cross(v / scale).normalize_or_zero() } else { DVec3::ZERO }
}
