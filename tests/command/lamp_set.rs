//! `--lamp-set`: one of the lamp sets of an EULUMDAT file.

use serde_json::Value;

use crate::support::ldt::{EVEN, Ldt};
use crate::support::stranger::Stranger;

const TWO: [[&str; 6]; 2] =
    [["1", "LED 3 W", "1000", "3000", "80", "10"], ["-1", "LED 5 W", "2500", "nw", ">90", "20"]];

#[test]
fn photometry_and_sample_take_the_set_that_is_asked_for() {
    let s = Stranger::new();
    s.write("two.ldt", Ldt { sets: &TWO, ..Ldt::new(1, EVEN) }.text());
    let json = |line: &str| -> Value {
        let (code, out, err) = s.types(line);
        assert_eq!((code, err.as_str()), (0, ""), "{line}");
        serde_json::from_str(&out).unwrap()
    };
    for (option, number, flux_lm, lm_per_w) in
        [("", 1, 1000.0, 100.0), (" --lamp-set 1", 1, 1000.0, 100.0), (" --lamp-set 2", 2, 2500.0, 125.0)]
    {
        let report = json(&format!("photometry two.ldt --json{option}"));
        for (key, value) in [("flux_lm", flux_lm), ("efficacy_lm_w", lm_per_w)] {
            let got = report[key].as_f64().unwrap();
            assert!((got / value - 1.0).abs() < 1e-12, "{option}: {key} {got}");
        }
        assert_eq!((&report["format"], &report["revision"]), (&"EULUMDAT".into(), &Value::Null));
        assert_eq!((&report["lamp_set"], report["lamp_sets"].as_array().unwrap().len()), (&number.into(), 2));
        assert_eq!(report["lamp_sets"][1]["cri"], ">90");
        assert_eq!(report["warnings"].as_array().unwrap().len(), usize::from(option.is_empty()));
        assert_eq!(json(&format!("sample two.ldt -n 4096 --json{option}"))["passed"], true);
    }
    let (code, out, err) = s.types("photometry two.ldt --lamp-set 2");
    assert_eq!((code, err.as_str()), (0, ""));
    for line in [
        "format              EULUMDAT, type C",
        "flux                      2500.0 lm   value x multiplier, trapezoid",
        "lamp set            2 of 2: 2500 lm, LED 5 W, colour nw, CRI >90",
        "luminous opening    rectangle, 1.100 x 0.200 x 0.000 m (width x length x height)",
    ] {
        assert!(out.lines().any(|l| l == line), "{line}\n{out}");
    }
    s.is_told(
        "photometry two.ldt",
        0,
        &["2 lamp sets (1: LED 3 W, 1000 lm, 10 W; 2: LED 5 W", "lamp set 1 is used"],
    );
    s.is_told(
        "sample two.ldt -n 64 --lamp-set 3",
        1,
        &["two.ldt: found lamp set 3 of 2 lamp sets", "required: 1 to 2"],
    );
    s.is_told("photometry two.ldt --lamp-set 0", 1, &["found lamp set 0 of 2 lamp sets", "required: 1 to 2"]);
    s.is_told("photometry two.ldt --lamp-set x", 2, &["--lamp-set", "a whole number from 1 to 1000"]);
}
