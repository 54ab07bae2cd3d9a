//! The 8-wide tree that rays walk: boxes of eight children side by side, leaves of up to four primitives inline.
//!
//! Boxes live in normalised coordinates, q = (p - centre) * scale with the scale a power of two, so that a scene and
//! the same scene times a power of two have the same tree bit for bit.

use glam::DVec3;

use super::bvh::{BinaryTree, Bounds};
use super::ray::Ray;
use super::triangle::Block;

/// Children of a wide node.
const WIDTH: usize = 8;
/// Child code: this bit set means a leaf, the rest is its block.
pub(crate) const LEAF: u32 = 1 << 31;
/// Child code of an empty tree.
pub(crate) const NOTHING: u32 = u32::MAX;

/// Absolute slack of a box test in normalised units (the scene is 1 to 2 units wide): f32 rounding of an origin up to
/// 4 units away, with room.
const SLACK: f32 = 1.0 / 1_048_576.0;
/// Relative slack of a slab distance: three f32 roundings, with room.
const RELATIVE: f32 = 1.0 / 1_048_576.0;

/// Eight child boxes, `[axis][low or high][child]`, and what the children are.
#[derive(Debug, Clone)]
#[repr(C, align(32))]
pub(crate) struct WideNode {
    planes: [[[f32; WIDTH]; 2]; 3],
    child: [u32; WIDTH],
}

impl WideNode {
    const EMPTY: Self =
        Self { planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], child: [NOTHING; WIDTH] };

    fn set(&mut self, slot: usize, bounds: &Bounds) {
        for k in 0..3 {
            self.planes[k][0][slot] = bounds.lo[k];
            self.planes[k][1][slot] = bounds.hi[k];
        }
    }
}

/// From world to normalised coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Normalisation {
    pub centre: DVec3,
    pub scale: f64,
}

impl Normalisation {
    /// The one of a world box: its largest half extent comes to lie in (1/2, 1].
    pub fn new(lo: DVec3, hi: DVec3) -> Self {
        let half = (hi - lo).max_element() * 0.5;
        let exponent = if half > 0.0 { libm::ilogb(half) + 1 } else { 0 };
        Self { centre: lo * 0.5 + hi * 0.5, scale: libm::scalbn(1.0, -exponent) }
    }

    /// The f32 box around a world box, rounded outward.
    pub fn bounds(&self, lo: DVec3, hi: DVec3) -> Bounds {
        let (lo, hi) = ((lo - self.centre) * self.scale, (hi - self.centre) * self.scale);
        Bounds { lo: lo.to_array().map(below), hi: hi.to_array().map(above) }
    }
}

/// An f32 below `x` by at least half an ulp: more than f64 rounding can hide.
fn below(x: f64) -> f32 {
    let y = x as f32;
    if f64::from(y) < x { y.next_down() } else { y.next_down().next_down() }
}

fn above(x: f64) -> f32 {
    -below(-x)
}

/// The ray as boxes see it: f32, normalised, its start moved next to the scene.
pub(crate) struct BoxRay {
    near_inverse: [f32; 3],
    far_inverse: [f32; 3],
    near_origin: [f32; 3],
    far_origin: [f32; 3],
    /// Which of the two planes the ray meets first: 1 where it runs towards lower coordinates. An index, not a condition:
    /// choosing among planes by address costs nothing.
    first_plane: [usize; 3],
    /// Normalised parameter at which the moved ray starts.
    start: f64,
    scale: f64,
}

impl BoxRay {
    /// `None` where the ray misses the ball around the scene.
    #[inline(always)]
    pub fn new(ray: &Ray, to: &Normalisation) -> Option<Self> {
        let mut o = (ray.origin - to.centre) * to.scale;
        let size = o.abs().max_element();
        let mut start = 0.0;
        if size > 4.0 {
            // The scene lies within sqrt(3) < 2 of the centre.
            let closest = -o.dot(ray.direction);
            if closest < 0.0 {
                return None;
            }
            start = (closest - 2.0).max(0.0);
            o += ray.direction * start;
            if o.length() > 3.0 + 1e-9 * size {
                return None;
            }
        }
        let slack = SLACK + (size * f64::EPSILON * 16.0) as f32;
        let d = ray.direction;
        let (ix, iy, iz) = (1.0 / d.x as f32, 1.0 / d.y as f32, 1.0 / d.z as f32);
        let axis = |o: f64, negative: bool| {
            let (o, towards) = (o as f32, if negative { -slack } else { slack });
            (o + towards, o - towards, usize::from(negative))
        };
        // Written out: arrays that are mapped went through memory.
        let (nx, fx, px) = axis(o.x, d.x.is_sign_negative());
        let (ny, fy, py) = axis(o.y, d.y.is_sign_negative());
        let (nz, fz, pz) = axis(o.z, d.z.is_sign_negative());
        let (near, far) = (1.0 - RELATIVE, 1.0 + RELATIVE);
        Some(Self {
            near_inverse: [ix * near, iy * near, iz * near],
            far_inverse: [ix * far, iy * far, iz * far],
            near_origin: [nx, ny, nz],
            far_origin: [fx, fy, fz],
            first_plane: [px, py, pz],
            start,
            scale: to.scale,
        })
    }

    /// The normalised distance, rounded up, beyond which no box can hold a hit at `t` metres or nearer.
    #[inline(always)]
    pub fn limit(&self, t: f64) -> f32 {
        let x = (t * self.scale - self.start) as f32;
        x + x.abs() * RELATIVE + SLACK
    }
}

/// The tree.
#[derive(Debug)]
pub(crate) struct WideTree {
    nodes: Vec<WideNode>,
    pub blocks: Vec<Block>,
    root: u32,
    /// Nodes on the longest way down.
    pub depth: usize,
}

impl WideTree {
    /// Collapses a binary tree; `fill` writes a primitive into a lane of a leaf block.
    pub fn new(binary: &BinaryTree, fill: impl Fn(&mut Block, usize, u32)) -> Self {
        let mut tree = Self { nodes: Vec::new(), blocks: Vec::new(), root: NOTHING, depth: 0 };
        if binary.order.is_empty() {
            return tree;
        }
        // (binary node, wide parent and slot, depth)
        let mut work = vec![(0u32, None::<(usize, usize)>, 1usize)];
        while let Some((b, parent, depth)) = work.pop() {
            let node = &binary.nodes[b as usize];
            let code = if node.count > 0 {
                let mut block = Block::EMPTY;
                let range = node.first as usize..(node.first + node.count) as usize;
                for (lane, &p) in binary.order[range].iter().enumerate() {
                    fill(&mut block, lane, p);
                }
                block.count = node.count;
                tree.blocks.push(block);
                LEAF | (tree.blocks.len() - 1) as u32
            } else {
                let children = widen(binary, b);
                let index = tree.nodes.len();
                let mut wide = WideNode::EMPTY;
                for (slot, &c) in children.iter().enumerate() {
                    wide.set(slot, &binary.nodes[c as usize].bounds);
                }
                tree.nodes.push(wide);
                for (slot, &c) in children.iter().enumerate().rev() {
                    work.push((c, Some((index, slot)), depth + 1));
                }
                tree.depth = tree.depth.max(depth);
                index as u32
            };
            match parent {
                Some((p, slot)) => tree.nodes[p].child[slot] = code,
                None => tree.root = code,
            }
        }
        tree
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.blocks.as_slice())
    }

    /// Walks all leaves the ray may touch, nearest boxes first, as long as they begin within the visitor's limit.
    ///
    /// `STACK` must be at least `7 depth + 1`: every node popped pushes at most seven.
    #[inline(always)]
    pub fn walk<'a, const STACK: usize, V: Visitor<'a>>(&'a self, ray: &BoxRay, visitor: &mut V) {
        let mut stack = [(0.0f32, 0u32); STACK];
        let mut top = 0;
        let mut current = self.root;
        if current == NOTHING {
            return;
        }
        loop {
            if current & LEAF != 0 {
                visitor.leaf(&self.blocks[(current & !LEAF) as usize]);
            } else {
                let node = &self.nodes[current as usize];
                let (near, mut mask) = test(node, ray, visitor.limit());
                if mask != 0 {
                    let i = mask.trailing_zeros() as usize & (WIDTH - 1);
                    let mut nearest = (near[i], node.child[i]);
                    mask &= mask - 1;
                    let base = top;
                    while mask != 0 {
                        let i = mask.trailing_zeros() as usize & (WIDTH - 1);
                        mask &= mask - 1;
                        let mut entry = (near[i], node.child[i]);
                        if entry.0 < nearest.0 {
                            std::mem::swap(&mut entry, &mut nearest);
                        }
                        // Insertion from the far end: the nearest of those that wait comes to lie on top.
                        let mut j = top;
                        while j > base && stack[j - 1].0 < entry.0 {
                            stack[j] = stack[j - 1];
                            j -= 1;
                        }
                        stack[j] = entry;
                        top += 1;
                    }
                    // The nearest never goes through the stack: most nodes have one or two children that are touched.
                    current = nearest.1;
                    continue;
                }
            }
            let limit = visitor.limit();
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                if stack[top].0 <= limit {
                    current = stack[top].1;
                    break;
                }
            }
        }
    }
}

/// What is done at the leaves.
pub(crate) trait Visitor<'a> {
    /// A leaf that the ray may touch.
    fn leaf(&mut self, block: &'a Block);
    /// Normalised distance beyond which nothing is of interest.
    fn limit(&self) -> f32;
}

/// Entry distances of the eight boxes and a bit for each that the ray may touch.
#[inline(always)]
fn test(node: &WideNode, ray: &BoxRay, limit: f32) -> ([f32; WIDTH], u32) {
    let pick = |k: usize| {
        let first = ray.first_plane[k] & 1;
        (&node.planes[k][first], &node.planes[k][first ^ 1])
    };
    let [(ax, bx), (ay, by), (az, bz)] = [pick(0), pick(1), pick(2)];
    let ([nx, ny, nz], [ix, iy, iz]) = (ray.near_origin, ray.near_inverse);
    let ([fx, fy, fz], [jx, jy, jz]) = (ray.far_origin, ray.far_inverse);
    // A NaN (zero times infinity, in a face of the slab) compares false and bounds nothing.
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let smaller = |a: f32, b: f32| if a < b { a } else { b };
    let mut near = [0.0f32; WIDTH];
    let mut hit = [0u32; WIDTH];
    for i in 0..WIDTH {
        let n = larger((ax[i] - nx) * ix, 0.0);
        let n = larger((ay[i] - ny) * iy, n);
        let n = larger((az[i] - nz) * iz, n);
        let f = smaller((bx[i] - fx) * jx, limit);
        let f = smaller((by[i] - fy) * jy, f);
        let f = smaller((bz[i] - fz) * jz, f);
        near[i] = n;
        hit[i] = if n <= f { BIT[i] } else { 0 };
    }
    (near, hit.iter().fold(0, |mask, bit| mask | bit))
}

/// One bit for each child.
const BIT: [u32; WIDTH] = [1, 2, 4, 8, 16, 32, 64, 128];

/// Up to eight descendants that together cover a node: the largest inner one is opened until there are eight.
fn widen(binary: &BinaryTree, root: u32) -> Vec<u32> {
    let mut children = binary.nodes[root as usize].children.to_vec();
    while children.len() < WIDTH {
        let area = |&i: &usize| binary.nodes[children[i] as usize].bounds.half_area();
        let inner = (0..children.len()).filter(|&i| binary.nodes[children[i] as usize].count == 0);
        let Some(open) = inner.max_by(|i, j| area(i).total_cmp(&area(j))) else { break };
        let [left, right] = binary.nodes[children[open] as usize].children;
        children[open] = left;
        children.push(right);
    }
    children
}
