//! Numbers, vectors and counts of a table.

use glam::DVec3;
use toml::de::DeValue;

use super::count::parse_count;
use super::table::{Table, Value};
use crate::error::invalid::Interval;
use crate::error::{Diagnostic, Kind};

/// Components of directions.
pub(super) const DIRECTION: Interval = Interval { low: -1e9, high: 1e9, words: "a number from -1e9 to 1e9" };

/// What a direction must be.
pub(super) const DIRECTION_REQUIRED: &str = "a direction [x, y, z] that is not zero";

impl<'t> Table<'t, '_> {
    /// A number in this interval.
    pub fn number(&mut self, key: &'static str, interval: &Interval) -> Option<f64> {
        let value = self.take(key)?;
        self.number_in(key, value, interval)
    }

    /// The same, absent: an error.
    pub fn needed_number(&mut self, key: &'static str, interval: &Interval) -> Option<f64> {
        self.needed(key, interval.words, |table, key| table.number(key, interval))
    }

    fn number_in(&self, label: &str, value: Value<'t>, interval: &Interval) -> Option<f64> {
        match number_of(value.get_ref()) {
            Some(number) if interval.contains(number) => Some(number),
            Some(percent)
                if (interval.low, interval.high) == (0.0, 1.0) && (1.0..=100.0).contains(&percent) =>
            {
                let hint = format!("{percent} % is {}", percent / 100.0);
                self.advised(label, value, Kind::Range, interval.words, &hint)
            }
            Some(_) => self.wrong(label, value, Kind::Range, interval.words),
            None => self.no_number(label, value, interval.words),
        }
    }

    /// Keep an error about a value that is no number; of one that is only in quotes, with advice.
    fn no_number<T>(&self, label: &str, value: Value<'t>, required: &str) -> Option<T> {
        let text = value.get_ref().as_str().map(|text| text.trim().replace(',', "."));
        let hint = text.and_then(|text| match text.parse::<f64>() {
            Ok(number) => number.is_finite().then(|| format!("write it without quotes: {text}")),
            Err(_) => without_unit(&text).map(|number| format!("write it without unit and quotes: {number}")),
        });
        match hint {
            Some(hint) => self.advised(label, value, Kind::Syntax, required, &hint),
            None => self.wrong(label, value, Kind::Syntax, required),
        }
    }

    /// An angle in degrees; one that looks like radians is told.
    pub fn angle(&mut self, key: &'static str, interval: &Interval) -> Option<f64> {
        let angle = self.number(key, interval)?;
        self.warn_of_radians(key, &[angle]);
        Some(angle)
    }

    /// The same of three angles.
    pub fn angles(&mut self, key: &'static str, interval: &Interval) -> Option<DVec3> {
        let angles = self.vector(key, interval)?;
        self.warn_of_radians(key, &angles.to_array());
        Some(angles)
    }

    fn warn_of_radians(&self, key: &str, angles: &[f64]) {
        let degrees = |&angle: &f64| radians_in_degrees(angle).map(|degrees| (angle, degrees));
        let Some((angle, degrees)) = angles.iter().find_map(degrees) else { return };
        let found = format!("{key} with {angle}, which looks like radians");
        let required = format!("degrees: {angle} radians are {degrees} degrees");
        self.document().warn_at(self.place_of(key).unwrap_or(self.place()), Kind::Range, found, required);
    }

    /// `N` numbers in this interval, in a list.
    pub fn numbers<const N: usize>(&mut self, key: &'static str, interval: &Interval) -> Option<[f64; N]> {
        let value = self.take(key)?;
        let required = format!("a list of {N} numbers, each {}", interval.words);
        self.each_of(key, value, &required, |label, item| self.number_in(label, item, interval))
    }

    /// What `read` makes of each of `N` items of a list; all are looked at, so that all their errors are told.
    fn each_of<T, const N: usize>(
        &self,
        key: &str,
        value: Value<'t>,
        required: &str,
        read: impl Fn(&str, Value<'t>) -> Option<T>,
    ) -> Option<[T; N]> {
        let Some(items) = value.get_ref().as_array().filter(|items| items.len() == N) else {
            return match as_list::<N>(value.get_ref()) {
                Some(list) => self.advised(key, value, Kind::Syntax, required, &format!("write {list}")),
                None => self.wrong(key, value, Kind::Syntax, required),
            };
        };
        let read = |(i, item)| read(&format!("{key}[{i}]"), item);
        let read: Vec<_> = items.iter().enumerate().map(read).collect();
        read.into_iter().collect::<Option<Vec<T>>>()?.try_into().ok()
    }

    /// A vector `[x, y, z]` whose components lie in this interval.
    pub fn vector(&mut self, key: &'static str, interval: &Interval) -> Option<DVec3> {
        self.numbers::<3>(key, interval).map(DVec3::from_array)
    }

    /// The same, absent: an error; `words` are for a message.
    pub fn needed_vector(&mut self, key: &'static str, interval: &Interval, words: &str) -> Option<DVec3> {
        self.needed(key, words, |table, key| table.vector(key, interval))
    }

    /// A number for all three components, or a vector.
    pub fn number_or_vector(&mut self, key: &'static str, interval: &Interval) -> Option<DVec3> {
        if self.is_list(key) {
            return self.vector(key, interval);
        }
        let value = self.take(key)?;
        if number_of(value.get_ref()).is_none() {
            let required = format!("{}, or a list of 3 such numbers", interval.words);
            return self.no_number(key, value, &required);
        }
        self.number_in(key, value, interval).map(DVec3::splat)
    }

    /// Angles in degrees: one number, which is a step, or a list of them.
    pub fn step_or_list(&mut self, key: &'static str, required: &str) -> Option<Vec<f64>> {
        /// More angles than any table that is accepted has.
        const MOST: usize = 1 << 16;
        let value = self.take(key)?;
        let Some(items) = value.get_ref().as_array() else {
            return match number_of(value.get_ref()) {
                Some(step) => Some(vec![step]),
                None => self.no_number(key, value, required),
            };
        };
        let angles: Option<Vec<f64>> = items.iter().map(|item| number_of(item.get_ref())).collect();
        match angles.filter(|angles| (2..=MOST).contains(&angles.len()) || angles[..] == [0.0]) {
            Some(angles) => Some(angles),
            None => self.wrong(key, value, Kind::Range, required),
        }
    }

    /// A whole number in this range.
    pub fn integer(&mut self, key: &'static str, low: u64, high: u64, words: &str) -> Option<u64> {
        let value = self.take(key)?;
        self.integer_in(key, value, low, high, words)
    }

    fn integer_in(&self, label: &str, value: Value<'t>, low: u64, high: u64, words: &str) -> Option<u64> {
        let Some(integer) = value.get_ref().as_integer() else {
            return match number_of(value.get_ref()).filter(|x| x.fract() == 0.0 && x.abs() < 1e15) {
                Some(whole) => self.advised(
                    label,
                    value,
                    Kind::Syntax,
                    words,
                    &format!("write it without a point: {whole}"),
                ),
                None => self.no_number(label, value, words),
            };
        };
        match u64::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(number) if (low..=high).contains(&number) => Some(number),
            _ => self.wrong(label, value, Kind::Range, words),
        }
    }

    /// Two cell counts of at least 1 each and a product of at most `most`.
    pub fn cells(&mut self, key: &'static str, most: u64, words: &str) -> Option<[u32; 2]> {
        let value = self.take(key)?;
        let highest = most.min(u64::from(u32::MAX));
        let cells: [u64; 2] =
            self.each_of(key, value, words, |label, item| self.integer_in(label, item, 1, highest, words))?;
        if cells[0] * cells[1] > most {
            return self.wrong(key, value, Kind::Limit, words);
        }
        Some(cells.map(|count| count as u32))
    }

    /// A count as [`parse_count`] reads it: a number, or a text.
    pub fn count(&mut self, key: &'static str) -> Option<u64> {
        let value = self.take(key)?;
        let text = match value.get_ref() {
            DeValue::Integer(integer) if integer.radix() != 10 => {
                u64::from_str_radix(integer.as_str(), integer.radix())
                    .map_or_else(|_| String::new(), |n| n.to_string())
            }
            DeValue::Integer(integer) => integer.as_str().to_string(),
            DeValue::Float(float) => float.as_str().to_string(),
            DeValue::String(text) => text.to_string(),
            _ => String::new(),
        };
        let refused = |e: Diagnostic| match e.advice() {
            Some(hint) => self.advised::<()>(key, value, e.kind(), e.required(), hint),
            None => self.wrong(key, value, e.kind(), e.required()),
        };
        parse_count(&text).map_err(refused).ok()
    }
}

/// Whole degrees that an angle is in radians, where it is a multiple of 30 or 45 degrees in radians but for its last digits. Such
/// numbers are rare among angles in degrees.
fn radians_in_degrees(angle: f64) -> Option<f64> {
    /// Of 1.57 for pi / 2, 3.14 for pi, 0.785 for pi / 4.
    const ROUNDED: f64 = 6e-4;
    let degrees = angle.to_degrees();
    let of = |step: f64| step * (degrees / step).round();
    let is_near = |round: &f64| *round != 0.0 && (degrees - round).abs() <= ROUNDED * round.abs();
    [of(30.0), of(45.0)].into_iter().filter(|round| round.abs() <= 360.0).find(is_near)
}

/// The number of a text such as `20 cm`, in metres, degrees, lumens, or parts of 1.
fn without_unit(text: &str) -> Option<f64> {
    const UNITS: [(&str, f64); 11] = [
        ("m", 1.0),
        ("mm", 1e3),
        ("cm", 1e2),
        ("km", 1e-3),
        ("lm", 1.0),
        ("klm", 1e-3),
        ("deg", 1.0),
        ("°", 1.0),
        ("%", 1e2),
        ("lumen", 1.0),
        ("lumens", 1.0),
    ];
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c)))?;
    let (_, divisor) = UNITS.iter().find(|(unit, _)| text[end..].trim() == *unit)?;
    Some(text[..end].parse::<f64>().ok()? / divisor)
}

/// What is meant by a value where a list of two belongs: `16` or `"800x600"`.
fn as_list<const N: usize>(value: &DeValue<'_>) -> Option<String> {
    let pair = match value.as_str() {
        Some(text) => {
            let numbers = text.split(['x', '×', ',', ' ']).filter(|item| !item.is_empty());
            numbers.map(|item| item.parse().ok()).collect::<Option<Vec<u32>>>()?
        }
        None => vec![value.as_integer()?.as_str().parse().ok()?; 2],
    };
    (N == 2 && pair.len() == 2 && !pair.contains(&0)).then(|| format!("[{}, {}]", pair[0], pair[1]))
}

/// A TOML number as f64; integers are welcome where a number is.
fn number_of(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            u64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64)
        }
        _ => None,
    }
}
