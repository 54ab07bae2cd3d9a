//! The sums of a table on the nodes of wider steps: hats nest, so these are sums of those that were counted.

use crate::photometry::web::Symmetry;
use crate::scene::nodes::Nodes;

/// Sums on every other gamma, of sums on `nodes`: a wide hat is its own node's narrow one and half of its neighbours'.
fn every_other_gamma(nodes: &Nodes, b: &[f64]) -> Vec<f64> {
    let planes = nodes.planes();
    let rows = nodes.gamma_deg.len();
    let mut out = Vec::with_capacity(b.len() / 2 + planes);
    for row in (0..rows).step_by(2) {
        let at = |row: usize, plane: usize| b[row * planes + plane];
        let with_neighbours = |plane: usize| {
            let before = if row > 0 { at(row - 1, plane) } else { 0.0 };
            let after = if row + 1 < rows { at(row + 1, plane) } else { 0.0 };
            at(row, plane) + 0.5 * (before + after)
        };
        let first = out.len();
        out.extend((0..planes).map(with_neighbours));
        if nodes.is_pole(row) {
            let all = out[first..].iter().sum();
            out[first..].fill(0.0);
            out[first] = all;
        }
    }
    out
}

/// Sums on every other C.
fn every_other_c(nodes: &Nodes, b: &[f64]) -> Vec<f64> {
    let planes = nodes.planes();
    let of_row = |(row, b): (usize, &[f64])| {
        let with_neighbours = |plane: usize| match (nodes.is_pole(row), plane) {
            (true, 0) => b[0],
            (true, _) => 0.0,
            _ => b[plane] + 0.5 * (b[(plane + planes - 1) % planes] + b[plane + 1]),
        };
        (0..planes).step_by(2).map(with_neighbours).collect::<Vec<_>>()
    };
    b.chunks_exact(planes).enumerate().flat_map(of_row).collect()
}

/// Sums on the nodes that are left after so many doublings of the steps of gamma and C, and those nodes.
pub fn widened(nodes: &Nodes, b: &[f64], [gamma, c]: [u32; 2]) -> (Nodes, Vec<f64>) {
    let (mut nodes, mut b) = (nodes.clone(), b.to_vec());
    for _ in 0..gamma {
        b = every_other_gamma(&nodes, &b);
        nodes = nodes.thinned([2, 1]);
    }
    for _ in 0..c {
        b = every_other_c(&nodes, &b);
        nodes = nodes.thinned([1, 2]);
    }
    (nodes, b)
}

/// Sums averaged to a symmetry: of planes that are equal under it each gets an equal part; of a table that is the same in all
/// planes each gets its part of the circle, which makes the values the same.
pub fn averaged(nodes: &Nodes, b: &[f64], symmetry: Symmetry) -> Vec<f64> {
    if symmetry == Symmetry::None {
        return b.to_vec();
    }
    let planes = nodes.planes();
    // For each plane what it gets of each: equal parts of those that are equal to it, or its part of the circle of all.
    let shares: Vec<(f64, Vec<usize>)> = (0..planes)
        .map(|plane| {
            let equal = nodes.equal_planes(plane, symmetry).unwrap_or(vec![plane]);
            let is_rotational = symmetry == Symmetry::Rotational;
            let share = if is_rotational { part_of_circle(nodes, plane) } else { 1.0 / equal.len() as f64 };
            (share, equal)
        })
        .collect();
    let of_row = |(row, b): (usize, &[f64])| -> Vec<f64> {
        if nodes.is_pole(row) {
            return b.to_vec();
        }
        shares.iter().map(|(share, of)| share * of.iter().map(|plane| b[*plane]).sum::<f64>()).collect()
    };
    b.chunks_exact(planes).enumerate().flat_map(of_row).collect()
}

/// How many planes are averaged into this one, by what they stand for.
pub fn count_of_equals(nodes: &Nodes, plane: usize, symmetry: Symmetry) -> f64 {
    if symmetry == Symmetry::Rotational {
        return 1.0 / part_of_circle(nodes, plane);
    }
    let mut equal = nodes.equal_planes(plane, symmetry).unwrap_or(vec![plane]);
    equal.sort_unstable();
    equal.dedup();
    equal.len() as f64
}

/// The integral of a plane's hat in C, as a part of the circle.
fn part_of_circle(nodes: &Nodes, plane: usize) -> f64 {
    let before = match plane.checked_sub(1) {
        Some(before) => nodes.c_deg[before],
        None => nodes.c_deg[nodes.planes() - 1] - 360.0,
    };
    (nodes.next_c_deg(plane) - before) / 720.0
}

#[cfg(test)]
mod tests {
    use super::super::mass::Mass;
    use super::*;

    fn nodes() -> Nodes {
        Nodes { gamma_deg: vec![0.0, 20.0, 90.0, 180.0], c_deg: vec![0.0, 60.0, 90.0, 180.0, 270.0, 300.0] }
    }

    /// A table of wide steps has the same sums against its hats, whether they are taken at once or by way of narrow ones.
    #[test]
    fn sums_on_wide_hats_are_those_of_the_table() {
        let wide = nodes();
        let fine = wide.halved().halved();
        let f = |gamma: f64, c: f64| 1.0 + gamma * (1.0 + c.to_radians().sin());
        let values = |nodes: &Nodes, of: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
            let all = nodes.gamma_deg.iter().enumerate();
            all.flat_map(|(row, g)| {
                let is_node = move |plane: usize| !nodes.is_pole(row) || plane == 0;
                (0..nodes.planes()).map(move |p| if is_node(p) { of(*g, nodes.c_deg[p]) } else { 0.0 })
            })
            .collect()
        };
        let table = values(&wide, &|g, c| if g == 180.0 { 500.0 } else { f(g, c) });
        // The bilinear table at the fine nodes, by weights.
        const ONE: u64 = 1 << 40;
        let at = |g: f64, c: f64| {
            let weights = wide.weights(g, c, ONE).unwrap();
            weights.iter().map(|(node, w)| table[*node] * *w as f64 / ONE as f64).sum::<f64>()
        };
        let (wide_b, fine_b) = (Mass::new(&wide).apply(&table), Mass::new(&fine).apply(&values(&fine, &at)));
        let (found, summed) = widened(&fine, &fine_b, [2, 2]);
        assert_eq!(found, wide);
        for (a, b) in summed.iter().zip(&wide_b) {
            assert!((a - b).abs() < 1e-8 * wide_b[0].abs(), "{a} {b}");
        }
    }

    #[test]
    fn averages_by_hand() {
        let nodes = nodes();
        let b: Vec<f64> = (0..24).map(f64::from).collect();
        let whole: f64 = (6..12).map(f64::from).sum();
        let rotational = averaged(&nodes, &b, Symmetry::Rotational);
        // Planes stand for 60, 45, 60, 90, 60 and 45 degrees.
        let expected = [60.0, 45.0, 60.0, 90.0, 60.0, 45.0].map(|deg| whole * deg / 360.0);
        assert!(rotational[6..12].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12));
        let mirrored = averaged(&nodes, &b, Symmetry::Bilateral0To180);
        assert_eq!(mirrored[6..12], [6.0, 9.0, 9.0, 9.0, 9.0, 9.0]);
        assert_eq!((averaged(&nodes, &b, Symmetry::None), &mirrored[..6]), (b.clone(), &b[..6]));
    }
}
