//! The emission of references: directions uniform in solid angle, weighted.

use super::cell::GridPoint;
use super::choose::Reusable;
use super::coordinates::{Chooser, Purpose};
use super::discrete::Discrete;
use super::grid::Grid;
use super::rejection::uniform_in_cell;
use crate::error::{Diagnostic, Kind, Result};

/// Directions uniform in solid angle over the cells of a grid that have a positive value somewhere: an
/// emission map that shares neither the cells' flux nor the cell equation with the sampler. A direction's
/// weight makes it the table's.
#[derive(Debug, Clone)]
pub struct UniformMap {
    choice: Discrete,
    solid_angle: f64,
}

impl UniformMap {
    /// The map of a grid.
    ///
    /// # Errors
    /// None for a grid, which has a cell of positive flux.
    pub fn new(grid: &Grid) -> Result<Self> {
        let solid_angles: Vec<f64> = grid.cells().map(|(_, row, column)| row.cap() * column.width).collect();
        let choice = Discrete::new(&solid_angles).ok_or_else(|| {
            Diagnostic::new(Kind::Range, "a table without cells", "a cell of positive solid angle")
        })?;
        Ok(Self { choice, solid_angle: solid_angles.iter().sum() })
    }

    /// A direction and its weight, 1 on average; `u` is what is left of the coordinate that chose the
    /// emitter.
    pub fn sample<C: Chooser>(&self, grid: &Grid, mut u: Reusable, chooser: &mut C) -> (GridPoint, f64) {
        let (_, row, column) = grid.cell(chooser.choose(&self.choice, &mut u, Purpose::Emission));
        let u_theta = chooser.rest(u, Purpose::EmissionTheta);
        let u_phi = chooser.uniform(Purpose::EmissionPhi);
        let (point, _) = uniform_in_cell(row, column, [u_theta, u_phi]);
        (point, grid.value(point.theta, point.phi) * self.solid_angle / grid.integral())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::coordinates::Coordinates;
    use crate::sequence::owen::OwenPoints;
    use std::f64::consts::PI;

    #[test]
    fn weights_of_the_uniform_map_average_to_one_and_to_the_table() {
        // A cell of zeros, one bright corner: mean weight 1, and the weighted share of a cell is its share of
        // the flux.
        let polar = [0.0, 0.7, 1.5, PI];
        let azimuth = [0.0, 2.0, 2.0 * PI];
        let values = [0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 9.0, 1.0, 1.0, 1.0];
        let grid = Grid::new(&polar, &azimuth, &values).unwrap();
        let map = UniformMap::new(&grid).unwrap();
        let points = OwenPoints::new(3, 0);
        let n = 1u64 << 16;
        let mut shares = [[0.0; 2]; 3];
        for i in 0..n {
            let mut c = Coordinates::new(&points, i, true);
            let u = c.draw_reusable(Purpose::Emission);
            let (point, weight) = map.sample(&grid, u, &mut c);
            assert_eq!(c.drawn(), 2);
            let at = |edges: &[f64], x: f64| edges[1..edges.len() - 1].iter().filter(|e| x >= **e).count();
            shares[at(&polar, point.theta)][at(&azimuth, point.phi)] += weight / n as f64;
        }
        let sum: f64 = shares.iter().flatten().sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        let whole: f64 = grid.cells().map(|(cell, _, column)| cell.flux(column)).sum();
        let part = |i: usize, j: usize| {
            let mut cells = grid.cells();
            let cell = cells.find(|(_, row, column)| (row.theta, column.phi) == (polar[i], azimuth[j]));
            cell.map_or(0.0, |(cell, _, column)| cell.flux(column) / whole)
        };
        for (i, row) in shares.iter().enumerate() {
            for (j, share) in row.iter().enumerate() {
                assert!((share - part(i, j)).abs() < 1e-4, "{i} {j}: {share}");
            }
        }
        assert_eq!(shares[0][0], 0.0);
    }
}
