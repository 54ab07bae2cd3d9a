//! Spot figures of a receiver: the fine cells that they come from, and where its sections are.

use glam::DVec3;

use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::Rectangle;

/// Fine cells along the longer side; along the other so many that they are about square.
const FINE_CELLS: u32 = 1024;

/// What is asked of a rectangle whose spot is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Fine cells along u.
    pub nu: u32,
    /// Fine cells along v.
    pub nv: u32,
    /// The rectangle.
    pub rectangle: Rectangle,
    /// Its sides along u and v, m.
    pub size_m: [f64; 2],
    /// The point of its sections, m from the corner along u and v; the peak without.
    pub at_m: Option<[f64; 2]>,
}

impl Spot {
    /// Of a rectangle, with sections through this point.
    ///
    /// # Errors
    /// A point outside it.
    pub fn new(rectangle: Rectangle, at_m: Option<[f64; 2]>) -> Result<Self> {
        let size_m = [rectangle.edge_u(), rectangle.edge_v()].map(DVec3::length);
        let [a, b] = size_m;
        if let Some([u, v]) = at_m.filter(|at| !(0..2).all(|i| (0.0..=size_m[i]).contains(&at[i]))) {
            let found = format!("spot_at = [{u}, {v}] on a rectangle of {a} m x {b} m");
            let required = format!("metres from its corner along u and v: [0 to {a}, 0 to {b}]");
            return Err(Diagnostic::new(Kind::Range, found, required));
        }
        let fine = |side: f64| {
            (f64::from(FINE_CELLS) * side / a.max(b)).round().clamp(1.0, f64::from(FINE_CELLS)) as u32
        };
        Ok(Self { nu: fine(a), nv: fine(b), rectangle, size_m, at_m })
    }

    /// The point of space so many metres from the corner along u and v.
    pub fn place(&self, [u, v]: [f64; 2]) -> DVec3 {
        self.rectangle.at(u / self.size_m[0], v / self.size_m[1])
    }

    /// Number of fine cells.
    pub fn cells(&self) -> usize {
        self.nu as usize * self.nv as usize
    }

    /// Sides of a fine cell, m.
    pub fn cell_m(&self) -> [f64; 2] {
        [self.size_m[0] / f64::from(self.nu), self.size_m[1] / f64::from(self.nv)]
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Of a rectangle of this size at the origin.
    pub fn spot([a, b]: [f64; 2], at_m: Option<[f64; 2]>) -> Result<Spot> {
        Spot::new(Rectangle::new(DVec3::ZERO, a * DVec3::X, b * DVec3::Y).unwrap(), at_m)
    }

    #[test]
    fn fine_cells_are_about_square_and_points_lie_on_the_rectangle() {
        let of = |size| spot(size, None).map(|spot| [spot.nu, spot.nv]).unwrap();
        assert_eq!(of([2.0, 2.0]), [1024, 1024]);
        assert_eq!(of([0.3, 0.1]), [1024, 341]);
        assert_eq!(of([1e-6, 1.0]), [1, 1024]);
        let half = spot([0.5, 0.25], None).unwrap();
        assert_eq!((half.cell_m(), half.cells()), ([0.5 / 1024.0, 0.25 / 512.0], 1024 * 512));
        assert_eq!(half.place([0.125, 0.0625]), DVec3::new(0.125, 0.0625, 0.0));
        assert!(spot([2.0, 1.0], Some([2.0, 0.0])).is_ok());
        for at in [[2.1, 0.5], [1.0, -0.1], [f64::NAN, 0.5]] {
            let text = spot([2.0, 1.0], Some(at)).unwrap_err().to_string();
            assert!(text.contains("on a rectangle of 2 m x 1 m"), "{text}");
        }
    }
}
