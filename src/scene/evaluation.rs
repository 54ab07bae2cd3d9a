//! The evaluation grid of a receiver: cells at whose middles standards want illuminance.

use crate::error::{Diagnostic, Kind, Result};

/// What a grid must be, in words.
pub const GRID_REQUIRED: &str =
    "\"EN 12464\", or [cells along u, cells along v], each at least 1, at most 2^20 in all";

/// Most cells of an evaluation grid.
pub const MOST_GRID_CELLS: u64 = 1 << 20;

/// How an evaluation grid is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GridKind {
    /// As EN 12464-1 has it: cells p = 0.2 x 5^(log10 d) metres wide, at most 10, d the longer side, or the shorter one
    /// where the longer is at least twice as long.
    En12464,
    /// So many cells along u and v.
    Counts([u32; 2]),
}

/// Cells of equal area on a rectangle but for a border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Cells along u.
    pub nu: u32,
    /// Cells along v.
    pub nv: u32,
    /// Width of what is left out on each side, m.
    pub border_m: f64,
    /// Area of a cell, m2.
    pub area_m2: f64,
    /// The border as parts of the edges.
    border: [f64; 2],
}

impl Grid {
    /// Of a rectangle of this size.
    ///
    /// # Errors
    /// A border that leaves nothing; more than [`MOST_GRID_CELLS`].
    pub fn new(kind: GridKind, size_m: [f64; 2], border_m: f64) -> Result<Self> {
        let inner = size_m.map(|side| side - 2.0 * border_m);
        if !inner.iter().all(|side| *side > 0.0) {
            let [a, b] = size_m;
            let found = format!("a border of {border_m} m on a rectangle of {a} m x {b} m");
            return Err(Diagnostic::new(Kind::Range, found, "`border_m` below half of the shorter side"));
        }
        let [nu, nv] = match kind {
            GridKind::En12464 => en_12464(inner),
            GridKind::Counts(counts) => counts.map(f64::from),
        };
        if nu * nv > MOST_GRID_CELLS as f64 {
            let found = format!("an evaluation grid of {nu} x {nv} cells");
            return Err(Diagnostic::new(Kind::Limit, found, "at most 2^20 cells"));
        }
        let border = size_m.map(|side| border_m / side);
        let area_m2 = inner[0] * inner[1] / (nu * nv);
        Ok(Self { nu: nu as u32, nv: nv as u32, border_m, area_m2, border })
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.nu as usize * self.nv as usize
    }

    /// The cell of a place on the rectangle, row by row from the top left; none in the border.
    #[inline]
    pub fn cell(&self, (u, v): (f64, f64)) -> Option<usize> {
        let inner = |x: f64, border: f64| (x - border) / (1.0 - 2.0 * border);
        let (u, v) = (inner(u, self.border[0]), inner(v, self.border[1]));
        if !(0.0..=1.0).contains(&u) || !(0.0..=1.0).contains(&v) {
            return None;
        }
        let column = ((u * f64::from(self.nu)) as u32).min(self.nu - 1);
        let row = self.nv - 1 - ((v * f64::from(self.nv)) as u32).min(self.nv - 1);
        Some(row as usize * self.nu as usize + column as usize)
    }

    /// (u, v) of the middle of a cell.
    pub fn middle(&self, cell: usize) -> (f64, f64) {
        let outer = |x: f64, border: f64| border + x * (1.0 - 2.0 * border);
        let (u, v) = middle([self.nu, self.nv], cell);
        (outer(u, self.border[0]), outer(v, self.border[1]))
    }
}

/// (u, v) of the middle of a cell of `[nu, nv]`, row by row from the top left.
pub fn middle([nu, nv]: [u32; 2], cell: usize) -> (f64, f64) {
    let (row, column) = (cell / nu as usize, cell % nu as usize);
    let v = (f64::from(nv) - row as f64 - 0.5) / f64::from(nv);
    ((column as f64 + 0.5) / f64::from(nu), v)
}

/// Cells along the sides.
fn en_12464(size_m: [f64; 2]) -> [f64; 2] {
    /// Two to one but for the rounding of lengths.
    const TWO: f64 = 2.0 * (1.0 - 1e-9);
    let (longer, shorter) = (size_m[0].max(size_m[1]), size_m[0].min(size_m[1]));
    let d = if longer >= TWO * shorter { shorter } else { longer };
    let widest = (0.2 * libm::pow(5.0, libm::log10(d))).min(10.0);
    let spacing = d / (d / widest).round().max(1.0);
    size_m.map(|side| (side / spacing).round().max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: d = 0.8, p = 0.171, 5 cells of 0.16 m; d = 5, p = 0.616, 8 of 0.625; a hall's p is 10 at most.
    #[test]
    fn grids_of_the_standard() {
        let of = |size, border| {
            let grid = Grid::new(GridKind::En12464, size, border).unwrap();
            [grid.nu, grid.nv]
        };
        assert_eq!(of([1.6, 0.8], 0.0), [10, 5]);
        assert_eq!(of([0.8, 1.6], 0.0), [5, 10]);
        assert_eq!(of([5.0, 4.0], 0.0), [8, 6]);
        assert_eq!(of([6.0, 5.0], 0.5), [8, 6]);
        assert_eq!(of([0.3, 0.6], 0.0), [3, 6]);
        assert_eq!(of([1000.0, 600.0], 0.0), [100, 60]);
    }

    #[test]
    fn a_border_is_left_out_and_may_not_be_all() {
        let grid = Grid::new(GridKind::Counts([4, 2]), [6.0, 5.0], 0.5).unwrap();
        assert_eq!(grid.area_m2, 2.5);
        assert_eq!(grid.cell((0.05, 0.5)), None);
        assert_eq!(grid.cell((0.5, 0.95)), None);
        assert_eq!(grid.cell((0.1, 0.85)), Some(0));
        assert_eq!(grid.cell((0.9, 0.11)), Some(7));
        assert_eq!(grid.cell((0.51, 0.11)), Some(6));
        for cell in 0..8 {
            assert_eq!(grid.cell(grid.middle(cell)), Some(cell));
        }
        // 6 m x 5 m less 0.5 m all round: cells of 1.25 m x 2 m, the last one's middle at 4.875 m and 1.5 m.
        let (u, v) = grid.middle(7);
        assert!((6.0 * u - 4.875).abs() < 1e-12 && (5.0 * v - 1.5).abs() < 1e-12, "{u} {v}");
        let none = Grid::new(GridKind::En12464, [1.6, 0.8], 0.4).unwrap_err();
        assert!(none.to_string().contains("0.4 m on a rectangle of 1.6 m x 0.8 m"), "{none}");
    }
}
