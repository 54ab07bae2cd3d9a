//! The PLY of a receiver on a mesh, read back by a reader of its own.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

const SCENE: &str = "[[emitter]]\ntype = \"isotropic\"\nposition = [0.2, 0.1, 0.3]\nflux_lm = 1000\n\
    [material.black]\ntype = \"absorber\"\n\
    [[surface]]\nname = \"hall\"\ntype = \"box\"\nmaterial = \"black\"\nmin = [-1, -1, -1]\nmax = [1, 1, 2]\n\
    [[surface]]\nname = \"plate\"\ntype = \"rectangle\"\nmaterial = \"black\"\n\
    corner = [0, 0, -0.5]\nedge_u = [0.1, 0, 0]\nedge_v = [0, 0.1, 0]\n\
    [[receiver]]\nsurface = \"hall\"\nside = \"back\"\n[[receiver]]\nsurface = \"plate\"\ncells = [2, 2]\n";

/// A binary little-endian PLY as its header describes it: element, then one map of name and numbers a row.
fn read_ply(path: &Path) -> BTreeMap<String, Vec<BTreeMap<String, Vec<f64>>>> {
    let bytes = fs::read(path).unwrap();
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    let mut lines = header.lines();
    assert_eq!(lines.next(), Some("ply"));
    assert_eq!(lines.next(), Some("format binary_little_endian 1.0"));
    let mut elements: Vec<(String, usize, Vec<Vec<String>>)> = Vec::new();
    for line in lines {
        let words: Vec<String> = line.split(' ').map(str::to_string).collect();
        match words[0].as_str() {
            "element" => elements.push((words[1].clone(), words[2].parse().unwrap(), Vec::new())),
            "property" => elements.last_mut().unwrap().2.push(words[1..].to_vec()),
            "comment" | "end_header" => {}
            other => panic!("{other}"),
        }
    }
    let mut at = end;
    let mut number = |kind: &str| -> f64 {
        let mut take = |n: usize| {
            at += n;
            &bytes[at - n..at]
        };
        match kind {
            "uchar" => f64::from(take(1)[0]),
            "int" => f64::from(i32::from_le_bytes(take(4).try_into().unwrap())),
            "uint" => f64::from(u32::from_le_bytes(take(4).try_into().unwrap())),
            "float" => f64::from(f32::from_le_bytes(take(4).try_into().unwrap())),
            "double" => f64::from_le_bytes(take(8).try_into().unwrap()),
            other => panic!("{other}"),
        }
    };
    let mut out = BTreeMap::new();
    for (name, count, properties) in elements {
        let rows = (0..count).map(|_| {
            properties
                .iter()
                .map(|p| {
                    if p[0] == "list" {
                        let n = number(&p[1]) as usize;
                        (p[3].clone(), (0..n).map(|_| number(&p[2])).collect())
                    } else {
                        (p[1].clone(), vec![number(&p[0])])
                    }
                })
                .collect()
        });
        let rows: Vec<_> = rows.collect();
        out.insert(name, rows);
    }
    assert_eq!(at, bytes.len(), "nothing after the last face");
    out
}

#[test]
fn faces_are_those_of_the_csv_and_their_flux_is_what_the_lamp_sends() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.toml");
    fs::write(&file, SCENE).unwrap();
    let output = folder.path().join("out");
    let status = Command::new(env!("CARGO_BIN_EXE_caustix"))
        .args([
            "render",
            file.to_str().unwrap(),
            "--photons",
            "2^14",
            "-o",
            output.to_str().unwrap(),
            "--quiet",
        ])
        .status()
        .unwrap();
    assert!(status.success());
    assert!(!output.join("plate.ply").exists(), "a grid is no mesh");
    let report = fs::read_to_string(output.join("report.json")).unwrap();
    assert!(report.contains("\"hall.ply\""), "{report}");
    let ply = read_ply(&output.join("hall.ply"));
    let (vertices, faces) = (&ply["vertex"], &ply["face"]);
    assert_eq!((vertices.len(), faces.len()), (8, 12));

    let corner = |i: f64| ["x", "y", "z"].map(|axis| vertices[i as usize][axis][0]);
    let csv = fs::read_to_string(output.join("hall.csv")).unwrap();
    let mut flux = 0.0;
    for (face, line) in faces.iter().zip(csv.lines().skip(1)) {
        let row: Vec<f64> = line.split(',').map(|w| w.parse().unwrap()).collect();
        let [a, b, c] = [0, 1, 2].map(|k| corner(face["vertex_indices"][k]));
        for axis in 0..3 {
            assert!(((a[axis] + b[axis] + c[axis]) / 3.0 - row[1 + axis]).abs() < 1e-12);
        }
        let (u, v): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let area = 0.5 * cross.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((area / row[4] - 1.0).abs() < 1e-12);
        // Front is outside: the face's corners run counter-clockwise seen from there.
        let middle = [0, 1, 2].map(|i| row[1 + i] - [0.0, 0.0, 0.5][i]);
        assert!(cross.iter().zip(middle).map(|(n, m)| n * m).sum::<f64>() > 0.0);
        for name in ["quality", "illuminance_lx"] {
            assert_eq!(face[name], [f64::from(row[5] as f32)]);
        }
        assert_eq!(face["standard_error_lx"], [f64::from(row[6] as f32)]);
        assert_eq!(face["hits"], [row[7]]);
        flux += face["illuminance_lx"][0] * area;
    }
    let plate: f64 = 1000.0 - flux;
    assert!(plate > 0.0 && plate < 5.0, "all but what the small plate takes: {plate} lm");
    // The brightest face has the colour of the scale's top half, the darkest that of its lower half.
    let light = |f: &BTreeMap<String, Vec<f64>>| f["red"][0] + f["green"][0] + f["blue"][0];
    let by_lux = |a: &&BTreeMap<String, Vec<f64>>, b: &&BTreeMap<String, Vec<f64>>| {
        a["quality"][0].total_cmp(&b["quality"][0])
    };
    assert!(light(faces.iter().max_by(by_lux).unwrap()) > light(faces.iter().min_by(by_lux).unwrap()));
}
