//! The compact grid against the grid that emitters use, and its extremes.

use std::f64::consts::PI;

use caustix::math::solve::Solver;
use caustix::sample::choose::Reusable;
use caustix::sample::compact::CompactGrids;
use caustix::sample::grid::Grid;
use caustix::sequence::hash::mix64;
use caustix::sequence::to_unit_f64;

fn table(rows: usize, columns: usize, f: impl Fn(usize, usize) -> f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let polar = (0..=rows).map(|i| PI * i as f64 / rows as f64).collect();
    let azimuth = (0..=columns).map(|j| 2.0 * PI * j as f64 / columns as f64 - PI).collect();
    let values = (0..=rows).flat_map(|i| (0..=columns).map(move |j| (i, j))).map(|(i, j)| f(i, j)).collect();
    (polar, azimuth, values)
}

/// Zeros, cells apart by twelve decades; values that f32 holds exactly, up to the largest, a power of two.
fn lumpy(i: usize, j: usize) -> f64 {
    let j = j % 24;
    match (i * 31 + j * 17) % 23 {
        0..8 => 0.0,
        8 => 2f64.powi(-40),
        9 => 1024.0,
        k => k as f64,
    }
}

#[test]
fn samples_are_those_of_the_emitters_grid_to_the_last_digits() {
    let (p, a, v) = table(36, 24, lumpy);
    let grid = Grid::new(&p, &a, &v).unwrap();
    let mut compact = CompactGrids::new(&p, &a).unwrap();
    compact.push(&vec![1.0; v.len()]).unwrap();
    let slice = compact.push(&v).unwrap();
    assert!((compact.integral(slice) / grid.integral() - 1.0).abs() < 1e-14);
    assert!((compact.integral(0) / (4.0 * PI) - 1.0).abs() < 1e-13);
    for i in 0..50_000u64 {
        let (u1, u2) = (mix64(2 * i), to_unit_f64(mix64(2 * i + 1)));
        let (x, y) = (grid.sample(u1, u2, Solver::DEFAULT), compact.sample(slice, u1, u2, Solver::DEFAULT));
        assert!((x.direction - y.direction).length() < 1e-9, "{i}: {x:?} {y:?}");
        assert_eq!(grid.pdf_omega(x.theta, x.phi) > 0.0, compact.pdf_omega(slice, x.theta, x.phi) > 0.0);
        let ratio = grid.pdf_omega(x.theta, x.phi) / compact.pdf_omega(slice, x.theta, x.phi);
        assert!((ratio - 1.0).abs() < 1e-12, "{ratio}");
        let (v1, v2) = compact.invert(slice, y.theta, y.phi).unwrap();
        assert!(v1.abs_diff(u1) as f64 / 2f64.powi(64) < 1e-13);
        assert!((v2 - u2).abs() < 1e-11 || compact.pdf_omega(slice, y.theta, y.phi) < 1e-6);
    }
    for i in 0..36 {
        for j in 0..24 {
            let (x, y) = (grid.cell_probability(i, j), compact.cell_probability(slice, i, j));
            assert!((x - y).abs() <= 1e-15, "{i} {j}: {x} {y}");
        }
    }
}

#[test]
fn cells_of_zero_flux_are_never_chosen_at_the_edges_of_u_either() {
    let (p, a, mut v) = table(6, 8, |_, _| 0.0);
    v[3 * 9 + 4] = 1.0; // One node: four cells around it.
    v[1] = 1e-12;
    let mut compact = CompactGrids::new(&p, &a).unwrap();
    let slice = compact.push(&v).unwrap();
    let ends = [0, 1, 1 << 20, u64::MAX - 1, u64::MAX];
    for bits in (0..100_000u64).map(mix64).chain(ends) {
        let mut u = Reusable::fresh(bits);
        let cell = compact.choose(slice, &mut u);
        assert!(compact.cell_probability(slice, cell / 8, cell % 8) > 0.0, "{bits}: {cell}");
        let q = compact.sample(slice, bits, to_unit_f64(mix64(!bits)), Solver::DEFAULT);
        assert!(compact.value(slice, q.theta, q.phi) > 0.0 || q.theta == 0.0, "{bits}");
    }
    assert!(
        compact.sample(slice, 0, 0.5, Solver::DEFAULT).theta <= p[1],
        "the rare cell has the first fraction"
    );
    assert_eq!(compact.cell_probability(slice, 5, 5), 0.0);
    let sum: f64 = (0..48).map(|c| compact.cell_probability(slice, c / 8, c % 8)).sum();
    assert!((sum - 1.0).abs() < 1e-15);
}

#[test]
fn one_cell_no_cell_and_the_smallest_grid() {
    let mut one = CompactGrids::new(&[0.0, 1.0], &[0.0, 1.0]).unwrap();
    let black = one.push(&[0.0; 4]).unwrap();
    let slice = one.push(&[1.0, 2.0, 3.0, 4.0]).unwrap();
    assert!(one.is_single(slice) && one.is_single(black));
    assert_eq!((one.integral(black), one.pdf_omega(black, 0.5, 0.5)), (0.0, 0.0));
    let (v1, v2) = one.invert(slice, 0.5, 0.5).unwrap();
    let back = one.sample(slice, v1, v2, Solver::DEFAULT);
    assert!((back.theta - 0.5).abs() < 1e-12 && (back.phi - 0.5).abs() < 1e-12);
    assert!(one.invert(black, 0.5, 0.5).is_none() && one.invert(slice, 1.5, 0.5).is_none());
    // One cell of positive flux among many: a corner of the range.
    let (p, a, mut v) = table(6, 8, |_, _| 0.0);
    v[0] = 3.0;
    let mut compact = CompactGrids::new(&p, &a).unwrap();
    let slice = compact.push(&v).unwrap();
    assert!(compact.is_single(slice));
    for bits in [0, 7 << 60, u64::MAX] {
        let q = compact.sample(slice, bits, 0.3, Solver::DEFAULT);
        assert!(q.theta <= p[1] && q.phi <= a[1]);
    }
}

#[test]
fn memory_is_sixteen_bytes_a_value() {
    for (rows, columns) in [(90, 72), (180, 360), (18, 36)] {
        let (p, a, v) = table(rows, columns, |i, j| ((i * j) % 1000) as f64 + 1.0);
        let mut compact = CompactGrids::new(&p, &a).unwrap();
        compact.reserve(20);
        for _ in 0..20 {
            compact.push(&v).unwrap();
        }
        let bytes = compact.memory_bytes() as f64 / (20 * v.len()) as f64;
        println!("{rows} x {columns}: {bytes:.2} bytes a value");
        assert!(bytes <= 18.0, "{bytes}");
    }
}

#[test]
fn bad_slices_are_refused() {
    let new = CompactGrids::new;
    assert!(new(&[0.0], &[0.0, 1.0]).is_err() && new(&[0.0, 1.0], &[1.0]).is_err());
    assert!(new(&[0.0, 0.0], &[0.0, 1.0]).is_err() && new(&[0.0, 4.0], &[0.0, 1.0]).is_err());
    assert!(new(&[0.0, f64::NAN], &[0.0, 1.0]).is_err() && new(&[0.0, 1.0], &[0.0, 7.0]).is_err());
    let mut grids = new(&[0.0, 1.0], &[0.0, 1.0]).unwrap();
    for bad in
        [vec![1.0; 3], vec![1.0, f64::NAN, 1.0, 1.0], vec![1.0, -1.0, 1.0, 1.0], vec![f64::INFINITY; 4]]
    {
        assert!(grids.push(&bad).is_err());
    }
    assert!(grids.is_empty());
}
