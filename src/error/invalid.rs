//! What constructors refuse, typed: the name of the parameter, its value, what is required.
//!
//! A constructor of a scene type checks its parameters with the functions here and returns [`Invalid`]; a reader of files
//! turns it into a [`Diagnostic`] and adds the place of the key of that name.

use std::fmt;

use glam::DVec3;

use super::{Diagnostic, Kind};

/// Why a constructor refused a parameter. Each variant names the parameter as the scene file does.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Invalid {
    /// A number outside its range. NaN is in no range.
    Number {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The range in words, with the unit.
        required: &'static str,
    },
    /// A count outside its range.
    Count {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: u64,
        /// The range in words.
        required: &'static str,
    },
    /// A point or an extent with a component that is not a number or too large.
    Vector {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: DVec3,
        /// What each component must be, in words.
        required: &'static str,
    },
    /// A vector that has no direction: zero, infinite or not a number.
    NoDirection {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: DVec3,
    },
    /// Two directions that must span a plane and are parallel.
    Parallel {
        /// The parameter that would have to be another one.
        what: &'static str,
        /// The other parameter.
        to: &'static str,
    },
    /// Two edges that are not perpendicular.
    Skew {
        /// The parameter that would have to be another one.
        what: &'static str,
        /// The other parameter.
        to: &'static str,
        /// The angle between them, degrees.
        angle_deg: f64,
    },
    /// Numbers that are each in their range and make no shape together.
    Shape {
        /// The parameter that would have to be another one.
        what: &'static str,
        /// What was found, as a clause.
        found: String,
        /// What is required, as a clause.
        required: &'static str,
    },
    /// Anything else about what a parameter holds.
    Content {
        /// The parameter.
        what: &'static str,
        /// What was found, as a clause.
        found: String,
        /// What is required, as a clause.
        required: String,
    },
}

impl Invalid {
    /// The parameter's name: the key of a scene file that sets it.
    pub fn what(&self) -> &'static str {
        match self {
            Self::Number { what, .. }
            | Self::Count { what, .. }
            | Self::Vector { what, .. }
            | Self::NoDirection { what, .. }
            | Self::Parallel { what, .. }
            | Self::Skew { what, .. }
            | Self::Shape { what, .. }
            | Self::Content { what, .. } => what,
        }
    }

    /// What was found, as a clause.
    pub fn found(&self) -> String {
        let vector = |v: &DVec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
        match self {
            Self::Number { what, value, .. } => format!("{what} = {value}"),
            Self::Count { what, value, .. } => format!("{what} = {value}"),
            Self::Vector { what, value, .. } | Self::NoDirection { what, value } => {
                format!("{what} = {}", vector(value))
            }
            Self::Parallel { what, to } => format!("{what} parallel to {to}"),
            Self::Skew { what, to, angle_deg } => format!("{what} at {angle_deg:.6} degrees to {to}"),
            Self::Shape { found, .. } | Self::Content { found, .. } => found.clone(),
        }
    }

    /// What is required, as a clause.
    pub fn required(&self) -> String {
        match self {
            Self::Number { required, .. }
            | Self::Count { required, .. }
            | Self::Vector { required, .. }
            | Self::Shape { required, .. } => (*required).to_string(),
            Self::NoDirection { .. } => "a direction [x, y, z] that is not zero".to_string(),
            Self::Parallel { to, .. } => format!("a direction that is not parallel to {to}"),
            Self::Skew { to, .. } => format!("an edge perpendicular to {to}"),
            Self::Content { required, .. } => required.clone(),
        }
    }
}

impl Invalid {
    /// The class of the broken rule.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Skew { .. } | Self::Shape { .. } => Kind::Geometry,
            _ => Kind::Range,
        }
    }
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "found {}; required: {}", self.found(), self.required())
    }
}

impl std::error::Error for Invalid {}

impl From<Invalid> for Diagnostic {
    fn from(invalid: Invalid) -> Self {
        Self::new(invalid.kind(), invalid.found(), invalid.required())
    }
}

/// A range of numbers and the words for it: one constant serves the constructor that checks and the reader that explains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Least allowed value.
    pub low: f64,
    /// Greatest allowed value.
    pub high: f64,
    /// What is required, as a clause with the unit: `a length from 1e-9 to 1e9 m`.
    pub words: &'static str,
}

impl Interval {
    /// Whether a number lies in it. NaN does not.
    pub fn contains(&self, value: f64) -> bool {
        value >= self.low && value <= self.high
    }

    /// The number, if it lies in the interval.
    ///
    /// # Errors
    /// [`Invalid::Number`], for NaN too.
    pub fn check(&self, what: &'static str, value: f64) -> Result<f64, Invalid> {
        number(what, value, [self.low, self.high], self.words)
    }

    /// The vector, if its components lie in the interval.
    ///
    /// # Errors
    /// [`Invalid::Vector`].
    pub fn vector(&self, what: &'static str, value: DVec3) -> Result<DVec3, Invalid> {
        let fits = value.to_array().into_iter().all(|x| self.contains(x));
        if fits { Ok(value) } else { Err(Invalid::Vector { what, value, required: self.words }) }
    }
}

impl From<Invalid> for Vec<Diagnostic> {
    fn from(invalid: Invalid) -> Self {
        vec![invalid.into()]
    }
}

/// A number from `low` to `high`, both included.
///
/// # Errors
/// [`Invalid::Number`], for NaN too.
pub fn number(
    what: &'static str,
    value: f64,
    [low, high]: [f64; 2],
    required: &'static str,
) -> Result<f64, Invalid> {
    if value >= low && value <= high { Ok(value) } else { Err(Invalid::Number { what, value, required }) }
}

/// A finite number greater than zero.
///
/// # Errors
/// [`Invalid::Number`], for NaN and infinity too.
pub fn positive(what: &'static str, value: f64, required: &'static str) -> Result<f64, Invalid> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(Invalid::Number { what, value, required }) }
}

/// A vector whose components are numbers of at most `most` in size.
///
/// # Errors
/// [`Invalid::Vector`].
pub fn vector(what: &'static str, value: DVec3, most: f64, required: &'static str) -> Result<DVec3, Invalid> {
    let fits = value.to_array().into_iter().all(|x| x.abs() <= most);
    if fits { Ok(value) } else { Err(Invalid::Vector { what, value, required }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_is_in_no_range() {
        for value in [f64::NAN, f64::INFINITY, -1.0, 1.0 + f64::EPSILON] {
            let refused = number("reflectance", value, [0.0, 1.0], "a part from 0 to 1");
            assert!(matches!(refused, Err(Invalid::Number { what: "reflectance", .. })), "{value}");
            let refused = vector("position", DVec3::new(0.0, value, 0.0), 0.5, "metres");
            assert_eq!(refused.is_err(), value.abs() > 0.5 || value.is_nan());
        }
        assert_eq!(number("reflectance", 1.0, [0.0, 1.0], ""), Ok(1.0));
        assert!(positive("flux_lm", 0.0, "").is_err() && positive("flux_lm", f64::INFINITY, "").is_err());
    }

    #[test]
    fn a_message_names_parameter_value_and_requirement() {
        let invalid = positive("radius", -3.0, "a positive length in metres").unwrap_err();
        assert_eq!(invalid.to_string(), "found radius = -3; required: a positive length in metres");
        assert_eq!(Diagnostic::from(invalid).kind(), Kind::Range);
        let parallel = Invalid::Parallel { what: "up", to: "aim" };
        assert_eq!(parallel.required(), "a direction that is not parallel to aim");
    }
}
