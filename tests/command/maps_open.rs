//! Maps as other programs take them: float channels alone, tables with places, meshes in VTK's XML. One run's files say the same.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use crate::support::maps::{Samples, read_maps};
use crate::support::stranger::Stranger;

/// An oblique rectangle, a sphere and a mesh under one lamp, all black.
const SCENE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0.1, -0.6, 1.5]
flux_lm = 100
[material.black]
type = "absorber"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 1.2, 1.6]
[[surface]]
name = "ball"
type = "sphere"
material = "black"
center = [0.1, -0.6, 3.5]
radius = 0.5
[[surface]]
name = "box"
type = "box"
material = "black"
min = [-1.5, -0.5, -0.5]
max = [-1.2, 0.5, 0.5]
[[receiver]]
surface = "plate"
cells = [5, 4]
[[receiver]]
surface = "ball"
cells = [6, 3]
side = "front"
[[receiver]]
name = "case"
surface = "box"
"#;

/// The columns of a table.
fn table(s: &Stranger, name: &str) -> BTreeMap<String, Vec<f64>> {
    let text = fs::read_to_string(s.path(name)).unwrap();
    let mut lines = text.lines();
    let names: Vec<String> = lines.next().unwrap().split(',').map(String::from).collect();
    let mut columns: BTreeMap<String, Vec<f64>> =
        names.iter().map(|name| (name.clone(), Vec::new())).collect();
    for line in lines {
        let fields: Vec<f64> = line.split(',').map(|f| f.parse().unwrap_or(f64::NAN)).collect();
        assert_eq!(fields.len(), names.len());
        names.iter().zip(fields).for_each(|(name, field)| columns.get_mut(name).unwrap().push(field));
    }
    columns
}

fn run(more: &str) -> Stranger {
    let s = Stranger::with(&[("scene.toml", SCENE)]);
    s.is_told(&format!("render scene.toml -o out --photons 2^14 --quiet {more}"), 0, &[]);
    s
}

#[test]
fn an_exr_has_float_channels_alone_and_the_table_s_numbers() {
    let s = run("");
    for (name, size) in [("plate", Some((5, 4))), ("ball", Some((6, 3))), ("case", None)] {
        let maps = read_maps(s.path(&format!("out/{name}.exr"))).unwrap();
        let names: Vec<&str> = maps.channels.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["Y", "hits", "standard_error"]);
        assert!(size.is_none_or(|size| size == (maps.width, maps.height)));
        let table = table(&s, &format!("out/{name}.csv"));
        for ((_, samples), column) in
            maps.channels.iter().zip(["illuminance_lx", "hits", "standard_error_lx"])
        {
            let Samples::F32(values) = samples else { panic!("{column} is not of floats") };
            let told = &table[column];
            assert!(told.len() <= values.len() && told.iter().any(|x| *x > 0.0), "{column}");
            for (cell, (float, exact)) in values.iter().zip(told).enumerate() {
                assert_eq!(*float, *exact as f32, "{name}, {column} of cell {cell}");
            }
        }
    }
}

#[test]
fn rows_of_a_table_are_the_middles_of_cells_from_the_top_left() {
    let s = run("");
    let plate = table(&s, "out/plate.csv");
    assert_eq!(plate["u"].len(), 20);
    // The first pixel is at (u, v) = (0.1, 0.875): corner + 0.1 x 2 along x, 0.875 of (1.2, 1.6) along y and z.
    let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
    let first = ["x", "y", "z", "u", "v"].map(|name| plate[name][0]);
    assert!(first.iter().zip([-0.8, 0.05, 1.4, 0.1, 0.875]).all(|(a, b)| close(*a, b)), "{first:?}");
    let last = ["x", "y", "z", "u", "v"].map(|name| plate[name][19]);
    assert!(last.iter().zip([0.8, -0.85, 0.2, 0.9, 0.125]).all(|(a, b)| close(*a, b)), "{last:?}");
    assert!(close(plate["u"][1], 0.3) && close(plate["v"][5], 0.625));
    // Illuminance of a point lamp at each middle, Phi cos / (4 pi d^2), by the normal (0, -0.8, 0.6) of the plate. Cells of 0.4 m
    // by 0.5 m are not points: within a fifth where the plate is near, and of the sum within a few percent.
    let mut both = [0.0; 2];
    for (k, lux) in plate["illuminance_lx"].iter().enumerate() {
        let d = [0.1 - plate["x"][k], -0.6 - plate["y"][k], 1.5 - plate["z"][k]];
        let square: f64 = d.iter().map(|x| x * x).sum();
        let point =
            (100.0 / (4.0 * std::f64::consts::PI) * (-0.8 * d[1] + 0.6 * d[2]) / square.powf(1.5)).max(0.0);
        both = [both[0] + lux, both[1] + point];
    }
    assert!((both[0] / both[1] - 1.0).abs() < 0.1, "{both:?}");
    // Bands of equal area on the sphere, from the top; azimuth from x.
    let ball = table(&s, "out/ball.csv");
    for (k, (u, v)) in ball["u"].iter().zip(&ball["v"]).enumerate() {
        let (row, column) = ((k / 6) as f64, (k % 6) as f64);
        assert!(close(*u, (column + 0.5) / 6.0) && close(*v, 1.0 - (row + 0.5) / 3.0));
        let z = 0.5 * (2.0 * v - 1.0);
        let across = (0.25 - z * z).sqrt();
        let angle = std::f64::consts::TAU * u;
        assert!(close(ball["z"][k], 3.5 + z));
        assert!(close(ball["x"][k], 0.1 + across * angle.cos()));
        assert!(close(ball["y"][k], -0.6 + across * angle.sin()));
    }
    // The lamp is 2 m below the middle: it lights where z < -R^2 / 2 = -0.125 m, all of the lowest band and nothing of the highest.
    assert!(ball["hits"][..6].iter().all(|hits| *hits == 0.0));
    assert!(ball["hits"][12..].iter().all(|hits| *hits > 0.0));
}

/// Bytes of base64, by a decoder that shares nothing with the encoder.
fn decoded(text: &str) -> Vec<u8> {
    let value = |c: char| match c {
        'A'..='Z' => c as u32 - 'A' as u32,
        'a'..='z' => c as u32 - 'a' as u32 + 26,
        '0'..='9' => c as u32 - '0' as u32 + 52,
        '+' => 62,
        '/' => 63,
        other => panic!("{other}"),
    };
    let digits: Vec<u32> = text.trim().trim_end_matches('=').chars().map(value).collect();
    let bits: Vec<bool> = digits.iter().flat_map(|d| (0..6).rev().map(move |k| d >> k & 1 == 1)).collect();
    let byte = |bits: &[bool]| bits.iter().fold(0u8, |byte, bit| byte << 1 | u8::from(*bit));
    bits.as_chunks::<8>().0.iter().map(|bits| byte(bits)).collect()
}

#[test]
fn a_vtp_has_the_mesh_and_every_number_of_the_table() {
    for more in ["", "--replicates 1"] {
        let s = run(more);
        let text = fs::read_to_string(s.path("out/case.vtp")).unwrap();
        let xml = roxmltree::Document::parse(&text).unwrap();
        let piece = xml.descendants().find(|node| node.has_tag_name("Piece")).unwrap();
        assert_eq!(
            (piece.attribute("NumberOfPoints"), piece.attribute("NumberOfPolys")),
            (Some("8"), Some("12"))
        );
        let bytes = |name: &str| {
            let array = xml.descendants().find(|node| node.attribute("Name") == Some(name)).unwrap();
            let bytes = decoded(array.text().unwrap());
            let (length, rest) = bytes.split_at(8);
            assert_eq!(u64::from_le_bytes(length.try_into().unwrap()), rest.len() as u64);
            (array.attribute("type").unwrap().to_string(), rest.as_chunks::<8>().0.to_vec())
        };
        let floats = |name: &str| {
            let (kind, words) = bytes(name);
            assert_eq!(kind, "Float64");
            words.into_iter().map(f64::from_le_bytes).collect::<Vec<_>>()
        };
        let whole = |name: &str| {
            let (kind, words) = bytes(name);
            assert_eq!(kind, "Int64");
            words.into_iter().map(i64::from_le_bytes).collect::<Vec<_>>()
        };
        let table = table(&s, "out/case.csv");
        let (points, corners) = (floats("Points"), whole("connectivity"));
        assert_eq!((points.len(), corners.len()), (24, 36));
        assert_eq!(whole("offsets"), (1..=12).map(|face| 3 * face).collect::<Vec<i64>>());
        for face in 0..12 {
            for (axis, name) in ["x_m", "y_m", "z_m"].into_iter().enumerate() {
                let at = |corner: i64| points[3 * corner as usize + axis];
                let middle = corners[3 * face..3 * face + 3].iter().map(|c| at(*c)).sum::<f64>() / 3.0;
                assert!((middle - table[name][face]).abs() < 1e-15, "{face} {name}");
            }
        }
        assert_eq!(floats("Y"), table["illuminance_lx"]);
        assert!(whole("hits").iter().zip(&table["hits"]).all(|(a, b)| *a as f64 == *b));
        let same = |a: &f64, b: &f64| a == b || (a.is_nan() && b.is_nan());
        let errors = floats("standard_error");
        assert!(errors.iter().zip(&table["standard_error_lx"]).all(|(a, b)| same(a, b)));
        assert_eq!(errors.iter().any(|x| x.is_nan()), !more.is_empty());
    }
}

/// Cells of 0.9 m x 0.6 m within a border of 0.1 m: mean of the table is the report's, a value is hits over area.
#[test]
fn cells_of_an_evaluation_grid_have_a_table_of_their_own() {
    let s =
        Stranger::with(&[("scene.toml", &SCENE.replace("cells = [5, 4]", "grid = [2, 3]\nborder_m = 0.1"))]);
    s.is_told("render scene.toml -o out --photons 2^14 --quiet", 0, &[]);
    let grid = table(&s, "out/plate.grid.csv");
    let place = |row: usize| ["x", "y", "z", "u", "v"].map(|name| grid[name][row]);
    let close = |a: &f64, b: &f64| (a - b).abs() < 1e-12;
    // From the top left: 0.1 m + 0.45 m along x; 1.9 m - 0.3 m along (0, 0.6, 0.8).
    assert!(
        place(0).iter().zip(&[-0.45, -0.04, 1.28, 0.275, 0.8]).all(|(a, b)| close(a, b)),
        "{:?}",
        place(0)
    );
    assert!(
        place(5).iter().zip(&[0.45, -0.76, 0.32, 0.725, 0.2]).all(|(a, b)| close(a, b)),
        "{:?}",
        place(5)
    );
    let report: Value =
        serde_json::from_str(&fs::read_to_string(s.path("out/report.json")).unwrap()).unwrap();
    let of_plate = &report["receivers"][0];
    assert!(report["files"]["plate.grid.csv"].is_string() && grid["hits"].len() == 6);
    let area = 0.9 * 0.6;
    for (lux, hits) in grid["illuminance_lx"].iter().zip(&grid["hits"]) {
        let lumens = hits * 100.0 / f64::from(1 << 14);
        assert!(*hits > 0.0 && (lux * area / lumens - 1.0).abs() < 1e-12, "{lux} {hits}");
    }
    let mean = grid["illuminance_lx"].iter().sum::<f64>() / 6.0;
    assert!((of_plate["grid"]["mean_lx"].as_f64().unwrap() / mean - 1.0).abs() < 1e-12);
    // Without `cells` a pilot chooses, and it is told how many; the map's table has so many rows.
    let [nu, nv] = [0, 1].map(|k| of_plate["cells_by_pilot"][k].as_u64().unwrap());
    assert_eq!((nu, nu * nv), (nv, table(&s, "out/plate.csv")["u"].len() as u64));
    assert!(report["receivers"][1].get("cells_by_pilot").is_none());
    let check: Value = serde_json::from_str(&s.types("check scene.toml --json").1).unwrap();
    assert_eq!(check["receivers"][0]["cells_by_pilot"], true);
}

/// The curve goes from nothing to all; sections are the row and the column of the map that go through the point.
#[test]
fn spots_have_their_files_and_no_other_receiver_has() {
    let keys = "cells = [5, 4]\nspot = true\nspot_at = [1.3, 0.7]";
    let s = Stranger::with(&[("scene.toml", &SCENE.replace("cells = [5, 4]", keys))]);
    s.is_told("render scene.toml -o out --photons 2^14 --quiet", 0, &["the spot may be cut"]);
    let report: Value =
        serde_json::from_str(&fs::read_to_string(s.path("out/report.json")).unwrap()).unwrap();
    let (of_plate, of_ball) = (&report["receivers"][0], &report["receivers"][1]);
    for ending in ["encircled.csv", "encircled.svg", "sections.csv", "sections.svg"] {
        assert!(report["files"][format!("plate.{ending}")].is_string(), "{ending}");
        assert!(report["files"].get(format!("ball.{ending}")).is_none(), "{ending}");
    }
    assert!(of_ball.get("spot").is_none() && of_plate["spot"]["d50_m"]["high"].is_number());
    assert_eq!(
        of_plate["spot"]["photons"].as_u64(),
        Some(table(&s, "out/plate.csv")["hits"].iter().sum::<f64>() as u64)
    );
    let curve = table(&s, "out/plate.encircled.csv");
    let (shares, radii) = (&curve["share"], &curve["radius_m"]);
    assert_eq!((radii[0], shares[0], shares.last()), (0.0, 0.0, Some(&1.0)));
    assert!(radii.is_sorted() && shares.is_sorted() && curve["standard_error"].iter().all(|e| *e >= 0.0));
    // 1.3 m of 2 m is in column 3 of 5, 0.7 m of 2 m in row 1 of 4 from below: 2 from the top.
    let map = table(&s, "out/plate.csv");
    let cells = (0..5).map(|column| 2 * 5 + column).chain((0..4).rev().map(|row| row * 5 + 3));
    let text = fs::read_to_string(s.path("out/plate.sections.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 9);
    for (i, (row, cell)) in rows.iter().zip(cells).enumerate() {
        assert_eq!(row[0], if i < 5 { "u" } else { "v" });
        let along = map[row[0]][cell] * 2.0;
        for (text, expected) in row[1..].iter().zip([
            along,
            map["x"][cell],
            map["y"][cell],
            map["z"][cell],
            map["illuminance_lx"][cell],
            map["standard_error_lx"][cell],
            map["hits"][cell],
        ]) {
            let number: f64 = text.parse().unwrap();
            assert!((number - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{row:?} {expected}");
        }
    }
}
