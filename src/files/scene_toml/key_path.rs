//! The path of a key: names parted by dots, places of lists in brackets, `emitter.lamp.position[2]`. A name with other characters
//! stands in double quotes.

use std::fmt;

use super::table::shown;
use crate::error::{Diagnostic, Kind, Result};

/// A step of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Step {
    /// A key, or the name of an entry.
    Key(String),
    /// A place in a list, from 0.
    Index(usize),
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Key(key) => write!(f, ".{}", shown(key)),
            Self::Index(index) => write!(f, "[{index}]"),
        }
    }
}

/// Steps as they are typed.
pub(super) fn written(steps: &[Step]) -> String {
    let text: String = steps.iter().map(Step::to_string).collect();
    text.trim_start_matches('.').to_owned()
}

/// The steps of a path, of which the first is a key.
///
/// # Errors
/// A path of another form.
pub(super) fn parse_path(path: &str) -> Result<Vec<Step>> {
    let wrong = || {
        let found = format!("the key `{}`", shown(path));
        Diagnostic::new(
            Kind::Syntax,
            found,
            "a path such as emitter.lamp.position[2], emitter[0].flux_lm or material.glass.ior",
        )
    };
    let mut steps = Vec::new();
    let mut rest = path;
    loop {
        let name = match rest.strip_prefix('"') {
            Some(quoted) => {
                let (name, behind) = quoted.split_once('"').ok_or_else(wrong)?;
                rest = behind;
                name
            }
            None => {
                let is_bare = |c: char| c.is_alphanumeric() || "_- ".contains(c);
                let end = rest.find(|c| !is_bare(c)).unwrap_or(rest.len());
                let (name, behind) = rest.split_at(end);
                rest = behind;
                name
            }
        };
        if name.is_empty() {
            return Err(wrong());
        }
        steps.push(Step::Key(name.to_owned()));
        while let Some(inside) = rest.strip_prefix('[') {
            let (index, behind) = inside.split_once(']').ok_or_else(wrong)?;
            steps.push(Step::Index(index.trim().parse().map_err(|_| wrong())?));
            rest = behind;
        }
        match rest.strip_prefix('.') {
            Some(more) => rest = more,
            None if rest.is_empty() => return Ok(steps),
            None => return Err(wrong()),
        }
    }
}
