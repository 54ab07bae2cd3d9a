//! Scales with round numbers: ticks at 1, 2, 5 times powers of ten, their labels, and the scale of a lux map.

/// A mark of a scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Its value, the double nearest to the decimal its label shows.
    pub value: f64,
    /// The value in decimal.
    pub label: String,
}

/// A scale fitted to data: what value has which place from 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Value at the foot.
    pub low: f64,
    /// Value at the top.
    pub high: f64,
    /// Logarithmic, else linear.
    pub log: bool,
    /// Values above the top exist; they have its colour.
    pub clipped_above: bool,
    /// Values below the foot exist; they have its colour.
    pub clipped_below: bool,
    /// Round values from foot to top.
    pub ticks: Vec<Tick>,
}

/// Share of cells that must fit on an automatic scale.
const AUTO_QUANTILE: f64 = 0.998;
/// A linear scale whose top is this many medians leaves the map black.
const AUTO_LOG_RATIO: f64 = 40.0;
/// Most that a logarithmic scale spans.
const LOG_SPAN: f64 = 1e4;

impl Axis {
    /// The scale for these values: the top at the 99.8 % quantile where the greatest lie far above it, logarithmic where
    /// even then most would be black. NaN and infinities are ignored, negative values count as below the foot.
    pub fn fit(values: &[f64]) -> Self {
        Self::fit_with_typical(values, values)
    }

    /// The same, where what is typical is told by other values, as by averages over larger areas of a map.
    pub fn fit_with_typical(values: &[f64], typical: &[f64]) -> Self {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let max = sorted.last().copied().unwrap_or(0.0);
        // Nothing can be marked between zero and the smallest doubles.
        if max <= f64::MIN_POSITIVE / f64::EPSILON {
            return Self::linear(1.0, &sorted);
        }
        let bulk = quantile(&sorted, AUTO_QUANTILE);
        // A clipped scale must be worth its ">": it shows at least half as much again.
        let top = if bulk > 0.0 && max > 1.5 * bulk { bulk } else { max };
        let mut lit: Vec<f64> = typical.iter().copied().filter(|v| v.is_finite() && *v > 0.0).collect();
        lit.sort_unstable_by(f64::total_cmp);
        if top > AUTO_LOG_RATIO * quantile(&lit, 0.5) {
            Self::log(max, &sorted)
        } else {
            Self::linear(top, &sorted)
        }
    }

    /// Place of a value, 0 at the foot and 1 at the top, held within; NaN stays NaN.
    pub fn place(&self, value: f64) -> f64 {
        let t = if self.log {
            if value > 0.0 { libm::log(value / self.low) / libm::log(self.high / self.low) } else { 0.0 }
        } else {
            (value - self.low) / (self.high - self.low)
        };
        if value.is_nan() { value } else { t.clamp(0.0, 1.0) }
    }

    fn linear(max: f64, sorted: &[f64]) -> Self {
        let ticks = linear_ticks(0.0, max, 6);
        let step = ticks.get(1).map_or(max, |tick| tick.value);
        let ticks = linear_ticks(0.0, (max / step).ceil() * step, 6);
        let high = ticks.last().map_or(max, |tick| tick.value).max(max);
        Self::marked(0.0, high, false, ticks, sorted)
    }

    fn log(max: f64, sorted: &[f64]) -> Self {
        let lit = &sorted[sorted.partition_point(|&v| v <= 0.0)..];
        let foot = quantile(lit, 0.005).max(max / LOG_SPAN);
        let high = round_125(max, true);
        let mut low = round_125(foot, false);
        if low >= high {
            low = round_125(high / 10.0, false);
        }
        Self::marked(low, high, true, log_ticks(low, high), sorted)
    }

    fn marked(low: f64, high: f64, log: bool, ticks: Vec<Tick>, sorted: &[f64]) -> Self {
        let clipped_above = sorted.last().is_some_and(|&v| v > high);
        let clipped_below = sorted.first().is_some_and(|&v| v < low);
        Self { low, high, log, clipped_above, clipped_below, ticks }
    }
}

/// The value below which this share of sorted values lies (nearest rank); 0 for none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.clamp(1, sorted.len().max(1)) - 1).copied().unwrap_or(0.0)
}

/// Multiples of a step of 1, 2 or 5 times a power of ten from `low` to `high`, at most about `count` intervals.
/// Empty unless `low < high` and both are finite.
pub fn linear_ticks(low: f64, high: f64, count: usize) -> Vec<Tick> {
    if !(high - low > 0.0 && (high - low).is_finite()) {
        return Vec::new();
    }
    let (digit, exponent) = step_125((high - low) / count.max(1) as f64, true);
    let step = decimal(digit, exponent);
    // Ends that miss a multiple by rounding alone still get their mark.
    let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    (first..=last.min(first.saturating_add(1000))).map(|i| tick(i * digit, i, exponent)).collect()
}

fn tick(multiple: i64, index: i64, exponent: i32) -> Tick {
    let value = decimal(multiple, exponent);
    let label = if index == 0 { "0".to_owned() } else { label(value, exponent) };
    Tick { value, label }
}

/// 1, 2, 5 times powers of ten from `low` to `high`, powers of ten alone where that is more than fifteen marks.
pub fn log_ticks(low: f64, high: f64) -> Vec<Tick> {
    if !(low > 0.0 && high > low && high.is_finite()) {
        return Vec::new();
    }
    let exponents = step_125(low, false).1..=step_125(high, true).1;
    let marks = |digits: &[i64]| -> Vec<Tick> {
        exponents
            .clone()
            .flat_map(|e| digits.iter().map(move |&d| (d, e)))
            .map(|(d, e)| Tick { value: decimal(d, e), label: label(decimal(d, e), e) })
            .filter(|t| t.value >= low * (1.0 - 1e-12) && t.value <= high * (1.0 + 1e-12))
            .collect()
    };
    let all = marks(&[1, 2, 5]);
    if all.len() <= 15 { all } else { marks(&[1]) }
}

/// The nearest 1, 2 or 5 times a power of ten at or above (`up`) or at or below a positive value.
pub fn round_125(value: f64, up: bool) -> f64 {
    let (digit, exponent) = step_125(value, up);
    decimal(digit, exponent)
}

fn step_125(value: f64, up: bool) -> (i64, i32) {
    let exponent = libm::floor(libm::log10(value)) as i32;
    let candidates = (exponent - 1..=exponent + 1).flat_map(|e| [(1, e), (2, e), (5, e)]);
    if up {
        candidates.into_iter().find(|&(d, e)| decimal(d, e) >= value * (1.0 - 1e-12))
    } else {
        candidates.into_iter().rfind(|&(d, e)| decimal(d, e) <= value * (1.0 + 1e-12))
    }
    .unwrap_or((1, exponent))
}

/// The double nearest to digits times a power of ten, which repeated multiplication would miss.
fn decimal(digits: i64, exponent: i32) -> f64 {
    format!("{digits}e{exponent}").parse().unwrap_or(f64::NAN)
}

/// A decimal whose last digit has this exponent: plain between a thousandth and a million, else with an exponent.
fn label(value: f64, exponent: i32) -> String {
    if (1e-3..1e6).contains(&value.abs()) {
        format!("{value:.*}", usize::try_from(-exponent).unwrap_or(0))
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests;
