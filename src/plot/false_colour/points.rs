//! The values of an evaluation grid, printed where they are.

use crate::report::colour::Colour;
use crate::report::numbers::three_digits;

use super::super::canvas::{Anchor, Canvas, TextStyle};
use super::super::font;

const SIZE: f64 = 12.0;
const DOT: f64 = 3.0;
/// From the dot to the baseline of its value.
const RISE: f64 = 5.0;
/// Space around a value.
const SPACE: f64 = 8.0;

/// Values at places of a map.
#[derive(Debug, Clone)]
pub struct Points {
    /// Values a row, rows in all.
    pub counts: [usize; 2],
    /// Of each value, row by row from the top left: (u, v) and the number.
    pub values: Vec<((f64, f64), f64)>,
}

impl Points {
    /// Every how many columns and rows values are printed on a map of this size, so that they don't run into each other.
    pub(super) fn steps(&self, display: [usize; 2]) -> [usize; 2] {
        let (Some(first), Some(last)) = (self.values.first(), self.values.last()) else { return [1, 1] };
        let widest = self.values.iter().map(|(_, x)| font::width_px(&three_digits(*x), SIZE, true));
        let room = [widest.fold(0.0, f64::max) + SPACE, SIZE + RISE + SPACE];
        let spans = [last.0.0 - first.0.0, first.0.1 - last.0.1];
        std::array::from_fn(|k| {
            let between = spans[k] * display[k] as f64 / (self.counts[k].max(2) - 1) as f64;
            if self.counts[k] < 2 { 1 } else { (room[k] / between).ceil().max(1.0) as usize }
        })
    }

    /// What is printed, in words.
    pub(super) fn said(&self, display: [usize; 2]) -> String {
        let [nu, nv] = self.counts;
        let every = match self.steps(display) {
            [1, 1] => String::new(),
            [a, b] => format!(" (one of {a} columns and {b} rows is printed)"),
        };
        format!(
            "numbers: mean of each of the {nu} x {nv} cells of the evaluation grid, lx; dots: their middles{every}"
        )
    }

    /// Draws them on a map at x, y of this width and height.
    pub(super) fn draw(&self, canvas: &mut Canvas, [x, y, width, height]: [usize; 4]) {
        let [every_column, every_row] = self.steps([width, height]);
        let style = TextStyle::new(SIZE, Colour::BLACK).anchored(Anchor::Middle);
        for (i, ((u, v), value)) in self.values.iter().enumerate() {
            let (column, row) = (i % self.counts[0], i / self.counts[0]);
            if column % every_column != (every_column - 1) / 2 || row % every_row != (every_row - 1) / 2 {
                continue;
            }
            let at = [x as f64 + u * width as f64, y as f64 + (1.0 - v) * height as f64];
            let text = three_digits(*value);
            let above = [at[0], at[1] - RISE];
            for (width, colour) in [(DOT + 2.0, Colour::WHITE), (DOT, Colour::BLACK)] {
                canvas.polyline(&[at], width, colour, 1.0);
            }
            let rim = TextStyle { colour: Colour::WHITE, ..style };
            canvas.text_rotated(above, 0.0, &text, &rim, 1.8);
            canvas.text_rotated(above, 0.0, &text, &style, 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points([nu, nv]: [usize; 2], value: f64) -> Points {
        let place = |i: usize| {
            let (column, row) = (i % nu, i / nu);
            ((column as f64 + 0.5) / nu as f64, 1.0 - (row as f64 + 0.5) / nv as f64)
        };
        Points { counts: [nu, nv], values: (0..nu * nv).map(|i| (place(i), value)).collect() }
    }

    #[test]
    fn values_that_would_run_into_each_other_are_left_out_and_it_is_said() {
        assert_eq!(points([10, 5], 286.0).steps([700, 350]), [1, 1]);
        assert!(!points([10, 5], 286.0).said([700, 350]).contains("one of"));
        // 7 pixels apart, with about 22 + 8 of text, and 25 from line to line.
        let dense = points([100, 50], 286.0);
        let [columns, rows] = dense.steps([700, 350]);
        assert!((4..=5).contains(&columns) && rows == 4, "{columns} {rows}");
        assert!(dense.said([700, 350]).contains(&format!("one of {columns} columns and 4 rows")));
        assert_eq!(points([1, 1], 5.0).steps([700, 700]), [1, 1]);
    }
}
