//! A sweep as far as it is: its grid, and what was found at each point.

use super::difference::Difference;
use super::figures::{Figure, PointFigures};
use super::grid::Grid;

/// A sweep; points that are not finished are `None`.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// The scene's name or path.
    pub scene_name: String,
    /// SHA-256 of the scene file, as it is without the sweep's values.
    pub scene_sha256: String,
    /// The command that makes this sweep.
    pub command: String,
    /// How it is traced: variant, sequence, seed, in words.
    pub tracing: String,
    /// What else is to be said, a sentence each.
    pub notes: Vec<String>,
    /// Its points.
    pub grid: Grid,
    /// Names of the figures that are shown.
    pub shown: Vec<String>,
    /// What was found, by point.
    pub points: Vec<Option<PointFigures>>,
}

/// Ratios of the independent error to the paired one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratios {
    /// Number of differences.
    pub count: usize,
    /// The least.
    pub least: f64,
    /// The median.
    pub median: f64,
    /// The greatest.
    pub most: f64,
}

impl Sweep {
    /// Number of points that are finished.
    pub fn finished(&self) -> usize {
        self.points.iter().flatten().count()
    }

    /// A shown figure at a point.
    pub fn figure(&self, point: usize, shown: usize) -> Option<&Figure> {
        self.points.get(point)?.as_ref()?.figure(&self.shown[shown])
    }

    /// A shown figure less that of the point one step less along an axis.
    pub fn difference(&self, point: usize, shown: usize, axis: usize) -> Option<Difference> {
        let before = self.grid.before(point, axis)?;
        Difference::new(self.figure(point, shown)?, self.figure(before, shown)?)
    }

    /// Whether a shown figure is known anywhere.
    pub fn is_known(&self, shown: usize) -> bool {
        (0..self.points.len()).any(|point| self.figure(point, shown).is_some_and(|f| f.value.is_some()))
    }

    /// Ratios of all differences of a shown figure along an axis.
    pub fn ratios(&self, shown: usize, axis: usize) -> Option<Ratios> {
        let ratio = |point| self.difference(point, shown, axis)?.ratio();
        let mut all: Vec<f64> = (0..self.points.len()).filter_map(ratio).collect();
        all.sort_by(f64::total_cmp);
        let middle = [all.len().checked_sub(1)? / 2, all.len() / 2].map(|i| all[i]);
        let median = 0.5 * (middle[0] + middle[1]);
        Some(Ratios { count: all.len(), least: *all.first()?, median, most: *all.last()? })
    }

    /// Axes along which there are differences.
    pub fn stepped_axes(&self) -> Vec<usize> {
        (0..self.grid.axes().len()).filter(|a| self.grid.axes()[*a].values.len() > 1).collect()
    }

    /// Every kind of warning, with the first point that has it, its text there, and how many points have it.
    pub fn warnings(&self) -> Vec<(usize, &str, usize)> {
        let mut found: Vec<(&str, usize, &str, usize)> = Vec::new();
        for (point, figures) in self.points.iter().enumerate() {
            let Some(figures) = figures else { continue };
            let mut here: Vec<&str> = Vec::new();
            for (code, text) in &figures.warnings {
                if here.contains(&code.as_str()) {
                    continue;
                }
                here.push(code);
                match found.iter_mut().find(|(known, ..)| known == code) {
                    Some((.., count)) => *count += 1,
                    None => found.push((code, point, text, 1)),
                }
            }
        }
        found.into_iter().map(|(_, point, text, count)| (point, text, count)).collect()
    }
}
