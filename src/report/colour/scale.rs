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
mod tests {
    use super::*;

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|t| t.label.as_str()).collect()
    }

    #[test]
    fn linear_ticks_are_round_and_exact() {
        assert_eq!(
            labels(&linear_ticks(0.0, 0.3, 6)),
            ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"].map(|l| if l == "0.00" {
                "0"
            } else {
                l
            })
        );
        assert_eq!(labels(&linear_ticks(0.0, 1234.0, 6)), ["0", "500", "1000"]);
        assert_eq!(labels(&linear_ticks(-0.5, 0.5, 5)), ["-0.4", "-0.2", "0", "0.2", "0.4"]);
        assert_eq!(labels(&linear_ticks(0.0, 5e6, 6)), ["0", "1e6", "2e6", "3e6", "4e6", "5e6"]);
        for tick in linear_ticks(0.0, 0.7, 8).iter().chain(&linear_ticks(0.0, 3e-7, 7)) {
            assert_eq!(tick.value, tick.label.parse::<f64>().unwrap_or(f64::NAN));
        }
        for (low, high) in [(0.0, 0.0), (1.0, 0.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert!(linear_ticks(low, high, 5).is_empty());
        }
    }

    #[test]
    fn log_ticks_thin_out() {
        assert_eq!(labels(&log_ticks(0.5, 20.0)), ["0.5", "1", "2", "5", "10", "20"]);
        assert_eq!(labels(&log_ticks(1e-2, 1e3)), ["0.01", "0.1", "1", "10", "100", "1000"]);
        assert!(log_ticks(0.0, 1.0).is_empty());
    }

    #[test]
    fn round_125_brackets() {
        for (value, below, above) in
            [(3.0, 2.0, 5.0), (0.07, 0.05, 0.1), (1e-9, 1e-9, 1e-9), (999.0, 500.0, 1000.0)]
        {
            assert_eq!((round_125(value, false), round_125(value, true)), (below, above));
        }
    }

    #[test]
    fn linear_scale_goes_from_zero_to_a_round_number_above_the_maximum() {
        let axis = Axis::fit(&[3.0, 431.0, f64::NAN, 17.0]);
        assert_eq!((axis.low, axis.high, axis.log, axis.clipped_above), (0.0, 500.0, false, false));
        assert_eq!(labels(&axis.ticks), ["0", "100", "200", "300", "400", "500"]);
        assert_eq!(axis.place(250.0), 0.5);
        assert_eq!((axis.place(-1.0), axis.place(1e9)), (0.0, 1.0));
        assert!(axis.place(f64::NAN).is_nan());
    }

    #[test]
    fn log_scale_has_equal_steps_for_equal_ratios() {
        let values: Vec<f64> = (0..=400).map(|i| 10f64.powf(i as f64 / 100.0)).collect();
        let axis = Axis::fit(&values);
        assert!(axis.log && axis.low == 1.0 && axis.high == 1e4, "{axis:?}");
        assert!((axis.place(10.0) - 0.25).abs() < 1e-12);
        assert_eq!(axis.place(0.0), 0.0);
    }

    #[test]
    fn automatic_scale_clips_few_bright_cells_and_turns_logarithmic_for_wide_ranges() {
        let mut values: Vec<f64> = (0..10_000).map(|i| 50.0 + (i % 50) as f64).collect();
        assert!(!Axis::fit(&values).clipped_above);
        for bright in values.iter_mut().take(10) {
            *bright = 5000.0;
        }
        let axis = Axis::fit(&values);
        assert_eq!((axis.high, axis.log, axis.clipped_above), (100.0, false, true));
        let wide: Vec<f64> = (0..10_000).map(|i| 10f64.powf(i as f64 / 2500.0)).collect();
        assert!(Axis::fit(&wide).log);
    }

    #[test]
    fn degenerate_data_give_a_scale() {
        for values in [vec![], vec![0.0; 4], vec![f64::NAN; 3], vec![-1.0], vec![f64::INFINITY]] {
            let axis = Axis::fit(&values);
            assert_eq!((axis.low, axis.high), (0.0, 1.0), "{values:?}");
        }
        for constant in [7.0, 1e-12, 1e300, 5e-324] {
            let axis = Axis::fit(&[constant; 9]);
            assert!(axis.high >= constant && axis.low < axis.high, "{constant}: {axis:?}");
            assert!(axis.place(constant).is_finite());
        }
    }
}
