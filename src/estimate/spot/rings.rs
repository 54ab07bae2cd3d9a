//! Fine cells by their distance from a point, and the photons in a circle about it.

use rayon::prelude::*;

use super::overlap::area_in_circle;

/// A fine cell, seen from the centre.
struct Cell {
    distance: f64,
    /// Its middle.
    at: [f64; 2],
    photons: u64,
}

/// Cells about a centre, the nearest first.
pub struct Rings {
    cells: Vec<Cell>,
    /// Photons of the cells before each, and of all at the end.
    before: Vec<u64>,
    half: [f64; 2],
    /// From the middle of a cell to its corner.
    reach: f64,
}

/// How a cell across the circle counts.
#[derive(Debug, Clone, Copy)]
pub enum Across {
    /// By the part of its area inside: exact where its light is uniform.
    ByArea,
    /// Not at all: never too much.
    Out,
    /// Wholly: never too little.
    In,
}

impl Rings {
    /// Of cells of this size with light in them (middle and photons) about a centre.
    pub fn new(cell_m: [f64; 2], centre: [f64; 2], lit: impl Iterator<Item = ([f64; 2], u64)>) -> Self {
        let seen = |(middle, photons): ([f64; 2], u64)| {
            let at = [middle[0] - centre[0], middle[1] - centre[1]];
            Cell { distance: libm::hypot(at[0], at[1]), at, photons }
        };
        let mut cells: Vec<Cell> = lit.map(seen).collect();
        cells.par_sort_by(|a, b| a.distance.total_cmp(&b.distance));
        let mut before = Vec::with_capacity(cells.len() + 1);
        let mut sum = 0;
        before.push(sum);
        for cell in &cells {
            sum += cell.photons;
            before.push(sum);
        }
        let half = cell_m.map(|side| 0.5 * side);
        Self { cells, before, half, reach: libm::hypot(half[0], half[1]) }
    }

    /// All photons.
    pub fn photons(&self) -> u64 {
        self.before[self.cells.len()]
    }

    /// A radius with everything in it.
    pub fn outermost(&self) -> f64 {
        self.cells.last().map_or(0.0, |cell| cell.distance + self.reach)
    }

    /// Photons within a circle, as a part of all.
    pub fn share(&self, radius: f64, across: Across) -> f64 {
        let first = self.cells.partition_point(|cell| cell.distance + self.reach <= radius);
        let last = self.cells.partition_point(|cell| cell.distance - self.reach < radius);
        let part = |cell: &Cell| cell.photons as f64 * self.part(cell, radius, across);
        let across: f64 = self.cells[first..last].iter().map(part).sum();
        (self.before[first] as f64 + across) / self.photons() as f64
    }

    /// The part of a cell that counts as inside a circle.
    fn part(&self, cell: &Cell, radius: f64, across: Across) -> f64 {
        let [u, v] = [0, 1].map(|i| (cell.at[i].abs(), self.half[i]));
        let is_in = match across {
            Across::ByArea => {
                let sides = [u, v].map(|(middle, half)| [middle - half, middle + half]);
                let area = area_in_circle(radius, sides[0], sides[1]);
                return (area / (4.0 * self.half[0] * self.half[1])).clamp(0.0, 1.0);
            }
            Across::Out => libm::hypot(u.0 + u.1, v.0 + v.1) <= radius,
            Across::In => libm::hypot((u.0 - u.1).max(0.0), (v.0 - v.1).max(0.0)) <= radius,
        };
        f64::from(u8::from(is_in))
    }

    /// The least radius with this share of the photons in it.
    pub fn radius(&self, share: f64, across: Across) -> f64 {
        let wanted = share.min(1.0);
        // A cell's photons are within its reach of its middle, so the cell that completes the share leads there.
        let target = wanted * self.photons() as f64;
        let at = self.before[1..].partition_point(|sum| (*sum as f64) < target);
        let Some(cell) = self.cells.get(at.min(self.cells.len().saturating_sub(1))) else { return 0.0 };
        let (mut low, mut high) = ((cell.distance - self.reach).max(0.0), cell.distance + self.reach);
        if self.share(low, across) >= wanted {
            return low;
        }
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return high;
            }
            if self.share(middle, across) >= wanted {
                high = middle;
            } else {
                low = middle;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(n: i32) -> impl Iterator<Item = ([f64; 2], u64)> {
        let middle = move |i: i32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n * n).map(move |i| ([middle(i % n), middle(i / n)], 1))
    }

    /// A uniform square: a circle about its middle holds its area; cells are exact where the light is uniform.
    #[test]
    fn uniform_light_is_exact_whatever_the_cells() {
        for n in [1, 2, 7, 40] {
            let side = 1.0 / f64::from(n);
            let rings = Rings::new([side, side], [0.5, 0.5], square(n));
            for radius in [0.1f64, 0.33, 0.5] {
                let share = std::f64::consts::PI * radius * radius;
                assert!((rings.share(radius, Across::ByArea) - share).abs() < 1e-12, "{n}");
                assert!((rings.radius(share, Across::ByArea) - radius).abs() < 1e-12, "{n}");
                let bounds = [Across::Out, Across::In].map(|across| rings.share(radius, across));
                assert!(bounds[0] <= share && share <= bounds[1], "{n} {bounds:?}");
                let radii = [Across::In, Across::Out].map(|across| rings.radius(share, across));
                let reach = side * std::f64::consts::SQRT_2;
                assert!(radii[0] <= radius && radius <= radii[1] && radii[1] - radii[0] < 3.0 * reach, "{n}");
            }
            assert!((rings.share(0.71, Across::ByArea) - 1.0).abs() < 1e-12);
            assert!((rings.radius(1.0, Across::ByArea) - 0.5f64.sqrt()).abs() < 1e-6);
        }
    }

    #[test]
    fn light_in_one_cell_is_somewhere_in_it() {
        let rings = Rings::new([2.0, 2.0], [0.5, 0.0], std::iter::once(([0.0, 0.0], 9)));
        assert_eq!(rings.radius(0.5, Across::In), 0.0);
        let far = rings.radius(0.5, Across::Out);
        assert!((far - 1.5f64.hypot(1.0)).abs() < 1e-15, "{far}");
        assert!((rings.outermost() - (0.5 + 2.0f64.sqrt())).abs() < 1e-15);
    }
}
