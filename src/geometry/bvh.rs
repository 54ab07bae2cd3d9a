//! The binary tree: built by obvhs (PLOC with reinsertion), the only file that names it.
//!
//! Only the topology is taken from the builder; boxes are united again from the primitives' own, so that nothing
//! about the tree but its speed depends on the builder. Boxes are f32, rounded outward, in the scene's normalised
//! coordinates.

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ploc::{PlocSearchDistance, SortPrecision};

use super::triangle::LANES;

/// An axis-parallel box, `lo <= hi`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bounds {
    pub lo: [f32; 3],
    pub hi: [f32; 3],
}

impl Bounds {
    /// The box of nothing: the neutral element of [`Bounds::union`].
    pub const NOTHING: Self = Self { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };

    pub fn union(&self, other: &Self) -> Self {
        let mut u = *self;
        for k in 0..3 {
            u.lo[k] = u.lo[k].min(other.lo[k]);
            u.hi[k] = u.hi[k].max(other.hi[k]);
        }
        u
    }

    /// Half the surface area.
    pub fn half_area(&self) -> f32 {
        let d: [f32; 3] = std::array::from_fn(|k| self.hi[k] - self.lo[k]);
        d[0] * d[1] + d[1] * d[2] + d[2] * d[0]
    }

    fn middle(&self, k: usize) -> f32 {
        self.lo[k] + self.hi[k]
    }
}

/// A node: two children, or a leaf of at most four primitives `order[first .. first + count]`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BinaryNode {
    pub bounds: Bounds,
    pub children: [u32; 2],
    pub first: u32,
    pub count: u32,
}

/// A binary tree over primitives; node 0 is the root.
#[derive(Debug, Default)]
pub(crate) struct BinaryTree {
    pub nodes: Vec<BinaryNode>,
    pub order: Vec<u32>,
}

impl BinaryTree {
    /// The same tree over other boxes of the same primitives.
    pub fn with_boxes(&self, boxes: &[Bounds]) -> Self {
        let mut tree = Self { nodes: self.nodes.clone(), order: self.order.clone() };
        unite(&mut tree, boxes);
        tree
    }
}

/// Trees deeper than this are replaced by a balanced one, so that the traversal's stack is bounded.
const MAX_DEPTH: usize = 70;
/// Below this many primitives a balanced tree is as good.
const FEW: usize = 16;

/// Builds the tree over these boxes.
pub(crate) fn build(boxes: &[Bounds]) -> BinaryTree {
    let tree = if boxes.len() < FEW { None } else { by_surface_area(boxes) };
    tree.unwrap_or_else(|| balanced(boxes))
}

/// A box as the builder gets it, wider by up to a 64th. It joins pairs of boxes that are each other's best: along a row of boxes
/// that are equal, or grow all the way, the best one is always the one on the same side, and each of its rounds joins one pair.
fn widened(i: u32, b: &Bounds) -> Aabb {
    let share = (i.wrapping_mul(0x9e37_79b9) >> 8) as f32 / (64.0 * (1 << 24) as f32);
    let (lo, hi) = (Vec3A::from_array(b.lo), Vec3A::from_array(b.hi));
    let by = (hi - lo) * (0.5 * share);
    Aabb::new(lo - by, hi + by)
}

fn by_surface_area(boxes: &[Bounds]) -> Option<BinaryTree> {
    let aabbs: Vec<Aabb> = boxes.iter().enumerate().map(|(i, b)| widened(i as u32, b)).collect();
    let params = BvhBuildParams {
        pre_split: false,
        ploc_search_distance: PlocSearchDistance::Medium,
        search_depth_threshold: 2,
        reinsertion_batch_ratio: 0.05,
        post_collapse_reinsertion_batch_ratio_multiplier: 1.0,
        sort_precision: SortPrecision::U64,
        max_prims_per_leaf: LANES as u32,
        collapse_traversal_cost: 3.0,
    };
    let built = build_bvh2(&aabbs, params, &mut Duration::default());
    let mut tree = BinaryTree::default();
    // (node of theirs, parent of ours and which child, depth)
    let mut work = vec![(0u32, None::<(usize, usize)>, 0usize)];
    while let Some((theirs, parent, depth)) = work.pop() {
        let node = built.nodes.get(theirs as usize)?;
        if depth > MAX_DEPTH || node.prim_count as usize > LANES {
            return None;
        }
        let ours = tree.nodes.len();
        if let Some((p, side)) = parent {
            tree.nodes[p].children[side] = ours as u32;
        }
        let first = tree.order.len() as u32;
        tree.nodes.push(BinaryNode {
            bounds: Bounds::NOTHING,
            children: [0; 2],
            first,
            count: node.prim_count,
        });
        if node.prim_count == 0 {
            work.push((node.first_index + 1, Some((ours, 1)), depth + 1));
            work.push((node.first_index, Some((ours, 0)), depth + 1));
        } else {
            let range = node.first_index as usize..(node.first_index + node.prim_count) as usize;
            tree.order.extend(built.primitive_indices.get(range)?);
        }
    }
    if tree.order.len() != boxes.len() {
        return None;
    }
    unite(&mut tree, boxes);
    Some(tree)
}

/// Halves at the median of the longest extent of the middles: depth is the logarithm of the count.
fn balanced(boxes: &[Bounds]) -> BinaryTree {
    let mut tree = BinaryTree { nodes: Vec::new(), order: (0..boxes.len() as u32).collect() };
    let mut work = vec![(0usize, boxes.len(), None::<(usize, usize)>)];
    while let Some((first, end, parent)) = work.pop() {
        let ours = tree.nodes.len();
        if let Some((p, side)) = parent {
            tree.nodes[p].children[side] = ours as u32;
        }
        let leaf = end - first <= LANES;
        tree.nodes.push(BinaryNode {
            bounds: Bounds::NOTHING,
            children: [0; 2],
            first: first as u32,
            count: if leaf { (end - first) as u32 } else { 0 },
        });
        if leaf {
            continue;
        }
        let part = &mut tree.order[first..end];
        let width = |k: usize| {
            let (mut lo, mut hi) = (f32::INFINITY, f32::NEG_INFINITY);
            for &i in part.iter() {
                let m = boxes[i as usize].middle(k);
                lo = lo.min(m);
                hi = hi.max(m);
            }
            hi - lo
        };
        let widths = [width(0), width(1), width(2)];
        let axis = (0..3).fold(0, |best, k| if widths[k] > widths[best] { k } else { best });
        part.sort_by(|&i, &j| {
            boxes[i as usize].middle(axis).total_cmp(&boxes[j as usize].middle(axis)).then(i.cmp(&j))
        });
        let middle = first + (end - first) / 2;
        work.push((middle, end, Some((ours, 1))));
        work.push((first, middle, Some((ours, 0))));
    }
    unite(&mut tree, boxes);
    tree
}

/// Sets every node's box; parents stand before their children.
fn unite(tree: &mut BinaryTree, boxes: &[Bounds]) {
    for i in (0..tree.nodes.len()).rev() {
        let node = tree.nodes[i];
        tree.nodes[i].bounds = if node.count > 0 {
            tree.order[node.first as usize..(node.first + node.count) as usize]
                .iter()
                .fold(Bounds::NOTHING, |b, &p| b.union(&boxes[p as usize]))
        } else if tree.order.is_empty() {
            Bounds::NOTHING
        } else {
            let [l, r] = node.children;
            tree.nodes[l as usize].bounds.union(&tree.nodes[r as usize].bounds)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(n: usize) -> Vec<Bounds> {
        (0..n)
            .map(|i| {
                let x = (i * 7919 % 1013) as f32 / 1013.0;
                let y = (i * 104_729 % 997) as f32 / 997.0;
                Bounds { lo: [x, y, x * y], hi: [x + 0.01, y + 0.02, x * y + 0.01] }
            })
            .collect()
    }

    #[test]
    fn every_primitive_is_in_exactly_one_leaf_and_inside_its_box() {
        for n in [0, 1, 2, 4, 5, 15, 16, 17, 100, 3000] {
            let boxes = boxes(n);
            for tree in [build(&boxes), balanced(&boxes)] {
                let mut seen = vec![0; n];
                for node in &tree.nodes {
                    assert!(node.count as usize <= LANES);
                    for &p in &tree.order[node.first as usize..(node.first + node.count) as usize] {
                        seen[p as usize] += 1;
                        assert_eq!(node.bounds.union(&boxes[p as usize]), node.bounds);
                    }
                    if node.count == 0 && n > 0 {
                        for c in node.children {
                            assert_eq!(node.bounds.union(&tree.nodes[c as usize].bounds), node.bounds);
                        }
                    }
                }
                assert!(seen.iter().all(|&s| s == 1), "{n}: {seen:?}");
            }
        }
    }

    #[test]
    fn equal_boxes_make_a_bounded_tree() {
        let tree = build(&vec![Bounds { lo: [0.0; 3], hi: [1.0; 3] }; 5000]);
        assert_eq!(tree.order.len(), 5000);
    }
}
