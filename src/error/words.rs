//! Lists and counts as messages and summaries tell them.
//!
//! Counts of what was done or found are grouped by spaces (`4 194 304 photons`). Numbers that a user may type stand
//! as they are typed (`from 1 to 65536`, `2^22`). Measured values have significant digits and no groups.

use std::fmt::Display;

/// Names that a message tells before it only counts the rest.
pub const NAMED: usize = 5;

/// The first `most` of these and the number of the rest: "a, b and c", "a, b and 7 more".
pub fn names(all: impl IntoIterator<Item = impl Display>, most: usize) -> String {
    let mut told: Vec<String> = all.into_iter().map(|name| name.to_string()).collect();
    if told.len() > most {
        let more = told.len() - most;
        told.truncate(most);
        told.push(format!("{} more", grouped(more as u64)));
    }
    match told.as_slice() {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        alone => alone.concat(),
    }
}

/// The same of names in quotes, [`NAMED`] of them.
pub fn quoted_names(all: impl IntoIterator<Item = impl Display>) -> String {
    names(all.into_iter().map(|name| format!("\"{name}\"")), NAMED)
}

/// Digits in groups of three.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(' ');
        }
        out.push(c);
    }
    out
}

/// A limit as it is told: the large powers of two as powers.
pub fn limit(most: u64) -> String {
    if most.is_power_of_two() && most > 1 << 16 { format!("2^{}", most.ilog2()) } else { most.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_name_some_and_count_the_rest() {
        for (most, text) in [(0, "4 more"), (1, "a and 3 more"), (2, "a, b and 2 more"), (4, "a, b, c and d")]
        {
            assert_eq!(names(["a", "b", "c", "d"], most), text);
        }
        assert_eq!((names([1], 5), names([0u32; 0], 5)), ("1".into(), String::new()));
        assert_eq!(quoted_names(["a", "b"]), "\"a\" and \"b\"");
        assert_eq!(names(vec![0; 5001], 1), "0 and 5 000 more");
    }

    #[test]
    fn digits_are_grouped() {
        assert_eq!([limit(1 << 26), limit(4096), limit(100_000)], ["2^26", "4096", "100000"]);
        assert_eq!([grouped(4_456_448), grouped(4096), grouped(12)], ["4 456 448", "4 096", "12"]);
    }
}
