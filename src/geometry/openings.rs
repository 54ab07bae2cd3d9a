//! What of a mesh hangs together, and what its open edges leave open.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::{DVec3, I64Vec3};

/// Number of parts that share no vertex.
pub fn parts(vertices: usize, triangles: &[[u32; 3]]) -> usize {
    part_of(vertices, triangles).into_iter().collect::<BTreeSet<u32>>().len()
}

/// The part of each triangle, by a number that its triangles share.
pub fn part_of(vertices: usize, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut groups = Groups::of(vertices);
    for [a, b, c] in triangles {
        groups.join(*a, *b);
        groups.join(*a, *c);
    }
    triangles.iter().map(|t| groups.root(t[0])).collect()
}

/// Open edges whose ends are nearer than this share of the mesh's size face each other across a crack.
const OF_ONE_PLACE: f64 = 1e-5;

/// Vertices that are kept of each such place.
const MOST_OF_ONE_PLACE: usize = 16;

/// The area that directed edges span, m2: of those that hang together half the sum of cross products, which for a loop is
/// that of any surface in it, seen from where it is largest. What is next to each other hangs together, so that the two sides
/// of a crack cancel, even if they are loops by themselves.
pub fn opening(vertices: &[DVec3], edges: &[[u32; 2]]) -> f64 {
    if edges.is_empty() {
        return 0.0;
    }
    let mut groups = Groups::of(vertices.len());
    edges.iter().for_each(|[p, q]| groups.join(*p, *q));
    let all =
        vertices.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[l, h], v| [l.min(*v), h.max(*v)]);
    let near = OF_ONE_PLACE * (all[1] - all[0]).max_element();
    let cell = |v: u32| ((vertices[v as usize] - all[0]) / near).floor().as_i64vec3();
    let mut places: HashMap<I64Vec3, Vec<u32>> = HashMap::new();
    for v in edges.iter().flatten() {
        // Each vertex is the end of several edges.
        if places.get(&cell(*v)).is_some_and(|here| here.contains(v)) {
            continue;
        }
        for offset in 0..27 {
            let around = cell(*v) + I64Vec3::new(offset % 3 - 1, offset / 3 % 3 - 1, offset / 9 - 1);
            for w in places.get(&around).into_iter().flatten() {
                if (vertices[*v as usize] - vertices[*w as usize]).length() <= near {
                    groups.join(*v, *w);
                }
            }
        }
        let here = places.entry(cell(*v)).or_default();
        // Where many are in one place, what is near to one is near to these.
        if here.len() < MOST_OF_ONE_PLACE {
            here.push(*v);
        }
    }
    let mut spans: BTreeMap<u32, DVec3> = BTreeMap::new();
    for edge in edges {
        let root = groups.root(edge[0]);
        let [p, q] = edge.map(|v| vertices[v as usize] - vertices[root as usize]);
        *spans.entry(root).or_default() += p.cross(q);
    }
    spans.values().map(|span| 0.5 * span.length()).sum()
}

/// Numbers that are joined. (Union by the lower number, with path halving.)
struct Groups {
    above: Vec<u32>,
}

impl Groups {
    /// Each by itself.
    fn of(count: usize) -> Self {
        Self { above: (0..count as u32).collect() }
    }

    fn root(&mut self, mut v: u32) -> u32 {
        while self.above[v as usize] != v {
            self.above[v as usize] = self.above[self.above[v as usize] as usize];
            v = self.above[v as usize];
        }
        v
    }

    fn join(&mut self, v: u32, w: u32) {
        let (p, q) = (self.root(v), self.root(w));
        self.above[p.max(q) as usize] = p.min(q);
    }
}
