//! `caustix photometry` of several files, as tables, and as other files.

use std::fs;

use serde_json::Value;

use crate::support::stranger::Stranger;

/// A cone of 200 cd in C0-C180, falling to 0 at 40 degrees; in C90-C270 half as fast. 0.5 x 0.9 of it are emitted.
const CONE: &str = "IESNA91\n[LUMINAIRE] a cone\n[MANUFAC] M\u{fc}ller\nTILT=NONE\n\
    2 100 2 3 2 1 2 0.1 0.2 0\n0.5 0.9 10\n0 40 90\n0 90\n100 0 0\n100 50 0\n";

/// The same light twice as bright and as type B.
const FLOOD: &str = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 4 2 2 2 2 0 0 0\n1 1 0\n-90 90\n-90 90\n1 1 1 1\n";

fn json(s: &Stranger, line: &str) -> Value {
    let (code, out, err) = s.types(line);
    assert_eq!((code, err.as_str()), (0, ""), "{line}");
    serde_json::from_str(&out).unwrap()
}

#[test]
fn several_files_have_a_row_each() {
    let s = Stranger::with(&[("a.ies", CONE), ("b.ies", FLOOD), ("c.ies", "IESNA91\n")]);
    let (code, out, err) = s.types("photometry a.ies b.ies");
    assert_eq!(code, 0, "{err}");
    let rows: Vec<Vec<&str>> = out.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(
        (rows.len(), rows[1][0], rows[1][2], rows[2][0], rows[2][2]),
        (3, "a.ies", "200.0", "b.ies", "4.0")
    );
    let list = json(&s, "photometry a.ies b.ies --json");
    assert_eq!((list[0]["file"].as_str(), list[1]["photometric_type"].as_str()), (Some("a.ies"), Some("B")));
    assert!(list[1]["zonal_lumens"].is_null() && list[1]["absent"]["zonal_lumens"].is_string());
    let (code, out, _) = s.types("photometry a.ies b.ies --csv");
    assert_eq!((code, out.lines().count()), (0, 3));
    assert!(out.lines().nth(2).unwrap().starts_with("b.ies,IES LM-63,2002,B,none,"), "{out}");
    // A file that cannot be read costs no other.
    let (code, out, err) = s.types("photometry a.ies c.ies b.ies --csv");
    assert_eq!((code, out.lines().count()), (1, 3));
    assert!(err.contains("error: c.ies:"), "{err}");
    s.is_told("photometry a.ies b.ies --plot p.svg", 1, &["--plot with 2 files", "one file"]);
    s.is_told("photometry a.ies b.ies --to ldt -o b.ldt", 1, &["--to with 2 files"]);
    s.is_told("photometry a.ies --json --csv", 2, &["cannot be used with"]);
}

#[test]
fn the_candela_table_is_csv() {
    let s = Stranger::with(&[("a.ies", CONE)]);
    let (_, out, _) = s.types("photometry a.ies --csv");
    assert_eq!(out, "vertical_deg,0,90\n0,200,200\n40,0,100\n90,0,0\n");
    // Of 200 lm of the lamps.
    let (_, out, _) = s.types("photometry a.ies --csv --per-klm");
    assert_eq!(out, "vertical_deg,0,90\n0,1000,1000\n40,0,500\n90,0,0\n");
    let (_, out, _) = s.types("photometry a.ies --per-klm");
    assert!(out.contains("per 1000 lm               1000.0 cd/klm   for 200.0 lm of the lamps"), "{out}");
}

#[test]
fn a_file_of_one_format_becomes_one_of_the_other_and_comes_back() {
    let s = Stranger::with(&[("a.ies", CONE), ("b.ies", FLOOD)]);
    let was = json(&s, "photometry a.ies --json");
    for (line, name) in [
        ("photometry a.ies --to ies -o b2002.ies", "b2002.ies"),
        ("photometry a.ies --to ies2019 -o b2019.ies", "b2019.ies"),
        ("photometry a.ies --to ldt -o b.ldt", "b.ldt"),
        ("photometry b.ldt --to ies -o again.ies", "again.ies"),
    ] {
        let (code, out, err) = s.types(line);
        assert_eq!(code, 0, "{err}");
        assert!(out.contains(&format!("written             {name}, ")), "{out}");
        let is = json(&s, &format!("photometry {name} --json"));
        // The factors are in the intensities now.
        for (key, from) in [
            ("flux_lm", "flux_with_factors_lm"),
            ("flux_emitted_lm", "flux_emitted_lm"),
            ("beam_angle_across_deg", "beam_angle_across_deg"),
        ] {
            let (is, was) = (is[key].as_f64().unwrap(), was[from].as_f64().unwrap());
            assert!((is / was - 1.0).abs() < 1e-8, "{name} {key}: {is} {was}");
        }
        for key in ["lamps", "lamps_lm", "input_watts", "symmetry"] {
            assert_eq!(is[key], was[key], "{name} {key}");
        }
        assert_eq!(is["luminous_opening"]["size_m"], was["luminous_opening"]["size_m"], "{name}");
        let label = |key: &str| {
            let labels = is["labels"].as_array().unwrap();
            labels.iter().find(|l| l["keyword"] == key).map(|l| l["text"].as_str().unwrap().to_owned())
        };
        assert_eq!(label("LUMINAIRE").unwrap(), "a cone");
        let maker = if name == "b.ldt" { "M\u{fc}ller" } else { "Mueller" };
        assert_eq!(label("MANUFAC").unwrap(), maker, "{name}");
    }
    let text = fs::read_to_string(s.path("b2002.ies")).unwrap();
    assert!(text.starts_with("IESNA:LM-63-2002\r\n[TEST] not stated\r\n"), "{text}");
    // The same bytes every time: no clock is looked at.
    s.types("photometry a.ies --to ies -o once_more.ies");
    assert_eq!(fs::read_to_string(s.path("once_more.ies")).unwrap(), text);
}

#[test]
fn what_is_written_can_be_scaled_and_turned() {
    let s = Stranger::with(&[("a.ies", CONE), ("b.ies", FLOOD)]);
    let (code, out, err) = s.types("photometry a.ies --to ldt -o b.ldt --flux 1234.5 --turn 90");
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("flux                      1234.5 lm"), "{out}");
    let (is, was) = (json(&s, "photometry b.ldt --json"), json(&s, "photometry a.ies --json"));
    assert!((is["flux_lm"].as_f64().unwrap() - 1234.5).abs() < 1e-4);
    // Its wide plane lies where the narrow one was; the lamps have grown with it, and the opening has turned.
    let near = |a: &Value, b: &Value| (a.as_f64().unwrap() - b.as_f64().unwrap()).abs() < 1e-6;
    assert!(near(&is["beam_angle_deg"], &was["beam_angle_across_deg"]));
    assert!(near(&is["beam_angle_across_deg"], &was["beam_angle_deg"]));
    // 0.45 of the table are emitted: the ratio of what is written is that of the light.
    let ratio = 0.45 * was["light_output_ratio"].as_f64().unwrap();
    assert!((is["light_output_ratio"].as_f64().unwrap() / ratio - 1.0).abs() < 1e-7);
    assert_eq!(is["luminous_opening"]["size_m"], serde_json::json!([0.2, 0.1, 0.0]));
    for (line, told) in [
        ("photometry a.ies --to ldt -o c.ldt --flux 0", ["--flux 0 lm", "above 0"]),
        ("photometry a.ies --to ldt -o c.ldt --turn 400", ["--turn 400 degrees", "within +-360"]),
        ("photometry a.ies --to xml -o c.xml", ["--to xml", "ies (LM-63-2002), ies2019, ldt"]),
        ("photometry b.ies --to ldt -o c.ldt", ["a table of type B", "other poles"]),
        ("photometry a.ies --to ldt -o a.ies", ["overwrite", "a.ies"]),
        ("photometry a.ies --lamp-set 2", ["lamp set 2", "LM-63 has no lamp sets"]),
    ] {
        s.is_told(line, 1, &told);
    }
    for line in ["photometry a.ies --to ldt", "photometry a.ies -o b.ldt", "photometry a.ies --flux 3"] {
        s.is_told(line, 2, &["error:"]);
    }
    assert!(!s.path("c.ldt").exists());
}
