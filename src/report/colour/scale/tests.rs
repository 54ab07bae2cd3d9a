//! Tests of [`super`].

use super::*;

fn labels(ticks: &[Tick]) -> Vec<&str> {
    ticks.iter().map(|t| t.label.as_str()).collect()
}

#[test]
fn linear_ticks_are_round_and_exact() {
    assert_eq!(
        labels(&linear_ticks(0.0, 0.3, 6)),
        ["0.00", "0.05", "0.10", "0.15", "0.20", "0.25", "0.30"].map(|l| if l == "0.00" { "0" } else { l })
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
