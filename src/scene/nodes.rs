//! The nodes of a table on the sphere, in the angles of type C, and the weights of a direction on them.

use crate::photometry::web::Symmetry;

/// A direction's weights on the nodes around it, which sum to [`one`](Nodes::weights).
pub type Weights = [(usize, u64); 4];

/// Node angles gamma (from the axis) and C (about it), degrees.
///
/// Nodes are numbered `gamma * planes + C`. All nodes at a pole are one: the first of their row.
#[derive(Debug, Clone, PartialEq)]
pub struct Nodes {
    /// Increasing, at least two, within 0..=180.
    pub gamma_deg: Vec<f64>,
    /// Increasing from 0 to below 360; the last is joined to the first, a turn further.
    pub c_deg: Vec<f64>,
}

impl Nodes {
    /// Number of nodes, those of a pole counted as often as there are planes.
    pub fn count(&self) -> usize {
        self.gamma_deg.len() * self.c_deg.len()
    }

    /// Planes C.
    pub fn planes(&self) -> usize {
        self.c_deg.len()
    }

    /// Whether all nodes of this row are one.
    pub fn is_pole(&self, row: usize) -> bool {
        let gamma = self.gamma_deg[row];
        gamma == 0.0 || gamma == 180.0
    }

    /// Where the plane after this one stands, degrees.
    pub fn next_c_deg(&self, plane: usize) -> f64 {
        self.c_deg.get(plane + 1).copied().unwrap_or(self.c_deg[0] + 360.0)
    }

    /// With a node in the middle of every step.
    pub fn halved(&self) -> Self {
        let middle = |low: f64, high: f64| 0.5 * (low + high);
        let mut gamma_deg = Vec::with_capacity(2 * self.gamma_deg.len());
        for pair in self.gamma_deg.windows(2) {
            gamma_deg.extend([pair[0], middle(pair[0], pair[1])]);
        }
        gamma_deg.extend(self.gamma_deg.last());
        let both = |plane: usize| [self.c_deg[plane], middle(self.c_deg[plane], self.next_c_deg(plane))];
        Self { gamma_deg, c_deg: (0..self.planes()).flat_map(both).collect() }
    }

    /// Every `every`-th of these angles alone.
    pub fn thinned(&self, [every_gamma, every_c]: [usize; 2]) -> Self {
        Self {
            gamma_deg: self.gamma_deg.iter().copied().step_by(every_gamma).collect(),
            c_deg: self.c_deg.iter().copied().step_by(every_c).collect(),
        }
    }

    /// The plane on the other side of a mirror plane, `2 x mirror_deg - C`; none where the planes are not symmetric.
    pub fn mirrored(&self, plane: usize, mirror_deg: f64) -> Option<usize> {
        /// Angles that were computed from steps agree to this, degrees.
        const SAME_DEG: f64 = 1e-9;
        let image = (2.0 * mirror_deg - self.c_deg[plane]).rem_euclid(360.0);
        let is_there = |c: f64| {
            let apart = (c - image).abs();
            apart.min(360.0 - apart) <= SAME_DEG
        };
        self.c_deg.iter().position(|&c| is_there(c))
    }

    /// The planes that must be equal to this one under a symmetry, itself among them; none where some are not nodes.
    pub fn equal_planes(&self, plane: usize, symmetry: Symmetry) -> Option<Vec<usize>> {
        Some(match symmetry {
            Symmetry::Rotational => (0..self.planes()).collect(),
            Symmetry::Bilateral0To180 => vec![plane, self.mirrored(plane, 0.0)?],
            Symmetry::Bilateral90To270 => vec![plane, self.mirrored(plane, 90.0)?],
            Symmetry::Quadrants => {
                let other = self.mirrored(plane, 0.0)?;
                vec![plane, other, self.mirrored(plane, 90.0)?, self.mirrored(other, 90.0)?]
            }
            _ => vec![plane],
        })
    }

    /// The bilinear weights of a direction, as integers that sum to `one` exactly; `None` outside the nodes.
    #[inline]
    pub fn weights(&self, gamma_deg: f64, c_deg: f64, one: u64) -> Option<Weights> {
        let (first, last) = (self.gamma_deg[0], self.gamma_deg[self.gamma_deg.len() - 1]);
        if !(gamma_deg >= first && gamma_deg <= last) {
            return None;
        }
        let above = self.gamma_deg.partition_point(|&g| g <= gamma_deg).min(self.gamma_deg.len() - 1);
        let (low, high) = (self.gamma_deg[above - 1], self.gamma_deg[above]);
        let turn = if c_deg < 0.0 { c_deg + 360.0 } else { c_deg };
        // A negative angle of the size of a rounding error turns to 360 itself.
        let turn = if turn >= 360.0 { turn - 360.0 } else { turn };
        let plane = self.c_deg.partition_point(|&c| c <= turn) - 1;
        let (left, right) = (self.c_deg[plane], self.next_c_deg(plane));
        let next = if plane + 1 == self.planes() { 0 } else { plane + 1 };
        let share = |whole: u64, part: f64| (whole as f64 * part + 0.5) as u64;
        let outer = share(one, (gamma_deg - low) / (high - low));
        let part = (turn - left) / (right - left);
        let row = |row: usize, whole: u64| {
            let first = row * self.planes();
            if self.is_pole(row) {
                return [(first, whole), (first, 0)];
            }
            let onward = share(whole, part);
            [(first + plane, whole - onward), (first + next, onward)]
        };
        let ([a, b], [c, d]) = (row(above - 1, one - outer), row(above, outer));
        Some([a, b, c, d])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes() -> Nodes {
        Nodes { gamma_deg: vec![0.0, 30.0, 90.0, 180.0], c_deg: vec![0.0, 90.0, 270.0] }
    }

    /// By hand: a third of the way from 30 to 90 degrees, half of that from 90 to 270.
    #[test]
    fn weights_by_hand_at_poles_and_across_the_seam() {
        let nodes = nodes();
        assert_eq!(nodes.weights(50.0, 180.0, 12), Some([(4, 4), (5, 4), (7, 2), (8, 2)]));
        assert_eq!(nodes.weights(30.0, 315.0, 12), Some([(5, 6), (3, 6), (8, 0), (6, 0)]));
        assert_eq!(nodes.weights(30.0, -45.0, 12), nodes.weights(30.0, 315.0, 12));
        // At a pole, whatever C; at C = 360, which is 0.
        assert_eq!(nodes.weights(0.0, 77.0, 12).unwrap()[0], (0, 12));
        assert_eq!(nodes.weights(180.0, 360.0, 12).unwrap()[2], (9, 12));
        assert_eq!(nodes.weights(90.0, 360.0, 12), nodes.weights(90.0, 0.0, 12));
        assert_eq!(nodes.weights(90.0, -1e-300, 12).unwrap()[2].1, 0);
        let part = Nodes { gamma_deg: vec![0.0, 90.0], ..nodes };
        assert_eq!((part.weights(90.1, 0.0, 12), part.weights(f64::NAN, 0.0, 12)), (None, None));
    }

    #[test]
    fn halves_and_mirrors_are_found() {
        let fine = nodes().halved();
        assert_eq!(fine.gamma_deg, [0.0, 15.0, 30.0, 60.0, 90.0, 135.0, 180.0]);
        assert_eq!(fine.c_deg, [0.0, 45.0, 90.0, 180.0, 270.0, 315.0]);
        assert_eq!(fine.thinned([2, 2]), nodes());
        assert_eq!(fine.equal_planes(1, Symmetry::Bilateral0To180), Some(vec![1, 5]));
        assert_eq!(fine.equal_planes(1, Symmetry::Quadrants), None);
        let five = Nodes { c_deg: vec![0.0, 72.0, 144.0, 216.0, 288.0], ..nodes() };
        assert_eq!(five.equal_planes(2, Symmetry::Bilateral0To180), Some(vec![2, 3]));
        assert_eq!(five.equal_planes(2, Symmetry::Bilateral90To270), None);
        let eight = Nodes { c_deg: (0..8).map(|i| 45.0 * f64::from(i)).collect(), ..nodes() };
        assert_eq!(eight.equal_planes(1, Symmetry::Quadrants), Some(vec![1, 7, 3, 5]));
    }
}
