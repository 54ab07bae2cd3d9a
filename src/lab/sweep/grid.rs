//! The grid of a sweep: the product of what its keys take. The last key changes fastest.

use crate::error::{Diagnostic, Kind, Result};

use super::values::{self, MOST_POINTS, Value, too_many};

/// A key and its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The path of the key in the scene, such as `emitter.lamp.position[2]`.
    pub key: String,
    /// What it takes, in this order.
    pub values: Vec<Value>,
}

/// The points of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    axes: Vec<Axis>,
}

impl Grid {
    /// The grid that texts `KEY=VALUES` say, each of another key.
    ///
    /// # Errors
    /// No text, one of another form, a key twice, more than 10 000 points.
    pub fn parse(sets: &[String]) -> Result<Self> {
        const REQUIRED: &str =
            "KEY=VALUES, such as emitter.lamp.position[2]=1:3:0.5 or material.glass.ior=1.5,1.52";
        let mut axes: Vec<Axis> = Vec::new();
        for set in sets {
            let named = |e: Diagnostic| {
                let named = Diagnostic::new(e.kind(), format!("--set {set}: {}", e.found()), e.required());
                e.advice().map_or(named.clone(), |hint| named.clone().hint(hint))
            };
            let Some((key, text)) = set.split_once('=') else {
                return Err(named(Diagnostic::new(Kind::Syntax, "no `=`", REQUIRED)));
            };
            let key = key.trim().to_owned();
            if axes.iter().any(|axis| axis.key == key) {
                return Err(named(Diagnostic::new(Kind::Range, "this key a second time", "every key once")));
            }
            axes.push(Axis { key, values: values::parse(text).map_err(named)? });
        }
        let points = axes.iter().map(|axis| axis.values.len() as i128).product();
        match axes.is_empty() {
            true => Err(Diagnostic::new(Kind::Missing, "no --set", format!("--set {REQUIRED}"))),
            false if points > MOST_POINTS as i128 => Err(too_many(points)),
            false => Ok(Self { axes }),
        }
    }

    /// The keys.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.axes.iter().map(|axis| axis.values.len()).product()
    }

    /// Points from one value of an axis to the next.
    fn stride(&self, axis: usize) -> usize {
        self.axes[axis + 1..].iter().map(|axis| axis.values.len()).product()
    }

    /// Which of an axis' values a point has.
    pub fn at(&self, point: usize, axis: usize) -> usize {
        point / self.stride(axis) % self.axes[axis].values.len()
    }

    /// The value that a point has of an axis.
    pub fn value(&self, point: usize, axis: usize) -> &Value {
        &self.axes[axis].values[self.at(point, axis)]
    }

    /// Every key with its value at a point.
    pub fn values(&self, point: usize) -> impl Iterator<Item = (&str, &Value)> {
        self.axes.iter().enumerate().map(move |(a, axis)| (axis.key.as_str(), self.value(point, a)))
    }

    /// The point one step less along an axis.
    pub fn before(&self, point: usize, axis: usize) -> Option<usize> {
        (self.at(point, axis) > 0).then(|| point - self.stride(axis))
    }

    /// A point as the command line would say it alone.
    pub fn told(&self, point: usize) -> String {
        let set = |(key, value): (&str, &Value)| format!("--set {key}={}", value.shown);
        self.values(point).map(set).collect::<Vec<_>>().join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(sets: &[&str]) -> Result<Grid> {
        Grid::parse(&sets.iter().map(|set| set.to_string()).collect::<Vec<_>>())
    }

    #[test]
    fn the_last_key_changes_fastest_and_neighbours_are_one_step_less() {
        let grid = grid(&["a[0]=1:3:1", "b=x,y", "c=7"]).unwrap();
        let told: Vec<String> = (0..grid.points()).map(|p| grid.told(p)).collect();
        assert_eq!(told.len(), 6);
        assert_eq!(
            (told[0].as_str(), told[1].as_str()),
            ("--set a[0]=1 --set b=x --set c=7", "--set a[0]=1 --set b=y --set c=7")
        );
        assert_eq!(told[5], "--set a[0]=3 --set b=y --set c=7");
        let before = |point| [0, 1, 2].map(|axis| grid.before(point, axis));
        assert_eq!(before(0), [None; 3]);
        assert_eq!(before(1), [None, Some(0), None]);
        assert_eq!(before(5), [Some(3), Some(4), None]);
    }

    #[test]
    fn what_is_no_grid_is_refused() {
        for (sets, found) in [
            (&[][..], "no --set"),
            (&["a"], "--set a: no `=`"),
            (&["a=1", "a=2"], "--set a=2: this key a second time"),
            (&["a=1:x:1"], "--set a=1:x:1: `x`"),
            (&["a=1:200:1", "b=1:51:1"], "10200 points"),
        ] {
            let error = grid(sets).unwrap_err();
            assert!(error.found().contains(found), "{error}");
        }
        assert_eq!(grid(&["a=1:200:1", "b=1:50:1"]).unwrap().points(), 10_000);
    }
}
