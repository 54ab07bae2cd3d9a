//! Evaluation grids under a lamp of one candela: a cell's flux is its solid angle.

use caustix::report::statistics::ReceiverStatistics;
use caustix::scene::Scene;
use caustix::sequence::Sequence;

use crate::support::scenes::{run, scene, try_scene};

/// The desk's corner and its size, and the lamp's height over its middle.
const SIZE: [f64; 2] = [1.6, 0.8];
const HEIGHT: f64 = 0.7;

fn desk(receivers: &str) -> String {
    format!(
        r#"
[[emitter]]
type = "isotropic"
flux_lm = {}
position = [0, 0, {HEIGHT}]
[material.black]
type = "absorber"
[[surface]]
name = "desk"
type = "rectangle"
material = "black"
corner = [-0.8, -0.4, 0]
edge_u = [1.6, 0, 0]
edge_v = [0, 0.8, 0]
{receivers}"#,
        4.0 * std::f64::consts::PI
    )
}

fn solid_angle([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    let corner = |x: f64, y: f64| (x * y / (HEIGHT * (x * x + y * y + HEIGHT * HEIGHT).sqrt())).atan();
    corner(b, d) - corner(a, d) - corner(b, c) + corner(a, c)
}

/// Least, mean and greatest illuminance of the cells of a grid.
fn truth([nu, nv]: [usize; 2], border: f64) -> [f64; 3] {
    let inner = SIZE.map(|side| side - 2.0 * border);
    let edge = |i: usize, n: usize, side: f64| side * (i as f64 / n as f64 - 0.5);
    let between = |i, n, side| [edge(i, n, side), edge(i + 1, n, side)];
    let area = inner[0] * inner[1] / (nu * nv) as f64;
    let cell = |i: usize| solid_angle(between(i % nu, nu, inner[0]), between(i / nu, nv, inner[1])) / area;
    let cells: Vec<f64> = (0..nu * nv).map(cell).collect();
    let mean = cells.iter().sum::<f64>() / cells.len() as f64;
    [cells.iter().copied().fold(f64::INFINITY, f64::min), mean, cells.iter().copied().fold(0.0, f64::max)]
}

fn numbers(scene: &Scene, per_replicate: u64) -> Vec<ReceiverStatistics> {
    let outcome = run(scene, Sequence::SobolOwen, per_replicate, 8, 3);
    let receivers = scene.receivers.iter().enumerate();
    receivers.map(|(i, receiver)| ReceiverStatistics::new(&outcome, receiver, i)).collect()
}

#[test]
fn intervals_of_evaluation_grids_contain_the_truth() {
    let scene = scene(&desk(
        r#"
[[receiver]]
surface = "desk"
name = "standard"
grid = "EN 12464"
[[receiver]]
surface = "desk"
name = "inner"
cells = [4, 2]
grid = [8, 3]
border_m = 0.16
"#,
    ));
    let numbers = numbers(&scene, 1 << 19);
    for (of, counts, border) in [(&numbers[0], [10, 5], 0.0), (&numbers[1], [8, 3], 0.16)] {
        let [least, mean, most] = truth(counts, border);
        let grid = of.grid.as_ref().unwrap();
        assert_eq!([grid.nu as usize, grid.nv as usize], counts);
        let error = grid.mean_standard_error_lx.unwrap();
        assert!((grid.mean_lx - mean).abs() < 4.0 * error && error < 0.01 * mean, "{} {mean}", grid.mean_lx);
        let intervals = [
            (grid.uniformity.u0, least / mean),
            (grid.uniformity.ud, least / most),
            (grid.uniformity.minimum, least),
            (grid.uniformity.maximum, most),
        ];
        for (interval, truth) in intervals {
            let interval = interval.unwrap();
            assert!(interval.low <= truth && truth <= interval.high, "{truth}: {interval:?}");
            assert!((interval.value / truth - 1.0).abs() < 0.05, "{truth}: {interval:?}");
        }
    }
    // 256 x 256 cells are noise: no number, and a grid that would do.
    assert!(numbers[0].uniformity.u0.is_none() && numbers[0].uniformity.minimum.is_none());
    let reason = numbers[0].uniformity.reason.as_ref().unwrap();
    assert!(reason.contains("are too few") && reason.contains("`grid = ["), "{reason}");
    assert!(numbers[1].uniformity.u0.is_some() && numbers[1].uniformity.reason.is_none());
}

/// The grid of the map's own cells counts what the map counts, and changes nothing of it.
#[test]
fn a_grid_counts_beside_the_map() {
    let receiver = "[[receiver]]\nsurface = \"desk\"\ncells = [10, 5]\n";
    let with = scene(&desk(&format!("{receiver}grid = [10, 5]\n")));
    let without = scene(&desk(receiver));
    let [with, without] = [with, without].map(|scene| run(&scene, Sequence::SobolOwen, 1 << 12, 8, 3));
    assert_eq!(with.grid_cells(0), &with.cells()[0]);
    assert_eq!(with.cells(), without.cells());
    assert!(with.totals().sum[0] > 1000 && without.grid_cells(0).sum.is_empty());
}

#[test]
fn grids_that_cannot_be_are_refused_where_they_stand() {
    for (keys, words) in [
        ("grid = \"EN 13201\"", "EN 12464"),
        ("grid = [0, 5]", "at least 1"),
        ("grid = 5", "EN 12464"),
        ("grid = \"EN 12464\"\nborder_m = 0.4", "below half of the shorter side"),
        ("border_m = 0.1", "`grid`"),
        ("grid = [2000, 2000]", "2^20"),
    ] {
        let errors = try_scene(&desk(&format!("[[receiver]]\nsurface = \"desk\"\n{keys}\n"))).unwrap_err();
        let text = errors.iter().map(|e| format!("{e} {}\n", e.required())).collect::<String>();
        assert!(text.contains(words) && text.contains("test.toml:"), "{keys}: {text}");
    }
    // Cells of grids count among those of all receivers: 64 grids and their maps' one cell each are more than 2^26.
    let many = (0..64).map(|i| {
        format!("[[receiver]]\nname = \"r{i}\"\nsurface = \"desk\"\ncells = [1, 1]\ngrid = [1024, 1024]\n")
    });
    let errors = try_scene(&desk(&many.collect::<String>())).unwrap_err();
    assert!(errors[0].to_string().contains("`r63`, with which there are 67108928 cells"), "{errors:?}");
    let ball = "[[surface]]\nname = \"ball\"\ntype = \"sphere\"\nmaterial = \"black\"\ncenter = [3, 0, 0]\n\
                radius = 0.5\n[[receiver]]\nsurface = \"ball\"\ngrid = [2, 2]\n";
    let errors = try_scene(&desk(ball)).unwrap_err();
    assert!(errors[0].to_string().contains("no rectangle"), "{:?}", errors);
}
