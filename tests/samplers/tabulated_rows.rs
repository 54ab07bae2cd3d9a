//! Rows and columns of a table on coordinates of their own: the same density as by cells, steady in both coordinates.

use std::f64::consts::PI;

use caustix::math::solve::Solver;
use caustix::sample::compact::CompactGrids;
use caustix::sequence::hash::mix64;
use caustix::sequence::owen::OwenPoints;
use caustix::sequence::{Points, to_unit_f64};

const ROWS: usize = 18;
const COLUMNS: usize = 24;

/// One slice over the sphere.
fn grid(f: impl Fn(usize, usize) -> f64) -> (CompactGrids, Vec<f64>, Vec<f64>) {
    let polar: Vec<f64> = (0..=ROWS).map(|i| PI * i as f64 / ROWS as f64).collect();
    let azimuth: Vec<f64> = (0..=COLUMNS).map(|j| 2.0 * PI * j as f64 / COLUMNS as f64).collect();
    let values: Vec<f64> =
        (0..=ROWS).flat_map(|i| (0..=COLUMNS).map(move |j| (i, j))).map(|(i, j)| f(i, j)).collect();
    let mut grids = CompactGrids::new(&polar, &azimuth).unwrap();
    grids.push(&values).unwrap();
    (grids, polar, azimuth)
}

/// Rows and cells of zeros, also first and last ones; values twelve decades apart.
fn lumpy(i: usize, j: usize) -> f64 {
    match (i, (i * 31 + j % COLUMNS * 17) % 23) {
        (0 | 1 | 8 | 9 | 17 | 18, _) | (_, 0..8) => 0.0,
        (_, 8) => 2f64.powi(-40),
        (_, k) => k as f64,
    }
}

#[test]
fn the_coordinates_of_a_sample_come_back() {
    let (grids, ..) = grid(lumpy);
    for i in 0..50_000u64 {
        let (u1, u2) = (mix64(2 * i), mix64(2 * i + 1));
        let q = grids.sample_by_row(0, u1, u2, Solver::DEFAULT);
        let (v1, v2) = grids.invert_by_row(0, q.theta, q.phi).unwrap();
        let u2 = to_unit_f64(u2);
        // Angles are rounded to 2^-52 of a turn; where the density vanishes they tell less of the coordinates.
        let faint = grids.pdf_omega(0, q.theta, q.phi) < 1e-6;
        assert!(faint || v1.abs_diff(u1) as f64 / 2f64.powi(64) < 1e-12, "{i}: {v1} {u1}");
        assert!(faint || (v2 - u2).abs() < 1e-10, "{i}: {v2} {u2}");
    }
}

#[test]
fn every_cell_has_its_share_of_the_unit_square() {
    // Of a net of 2^20 points a box of the square, which is what a cell has, holds its area to within the elementary intervals
    // its borders cut, some tens. By chance alone the counts, up to 20 000, would be off by their roots, and chi2 some 250.
    let (grids, polar, azimuth) = grid(lumpy);
    let points = OwenPoints::new(7, 0);
    let n = 1u64 << 20;
    let mut count = vec![0u32; ROWS * COLUMNS];
    for i in 0..n {
        let q = grids.sample_by_row(0, points.coordinate(i, 0), points.coordinate(i, 1), Solver::DEFAULT);
        let row = polar.partition_point(|t| *t <= q.theta) - 1;
        let column = azimuth.partition_point(|p| *p <= q.phi) - 1;
        count[row * COLUMNS + column] += 1;
    }
    let mut chi2 = 0.0;
    for (cell, count) in count.iter().enumerate() {
        let expected = grids.cell_probability(0, cell / COLUMNS, cell % COLUMNS) * n as f64;
        let off = f64::from(*count) - expected;
        assert!(off.abs() <= 60.0 && (expected > 0.0 || *count == 0), "{cell}: {count} for {expected}");
        chi2 += if expected > 1.0 { off * off / expected } else { 0.0 };
    }
    assert!(chi2 < 10.0, "chi2 {chi2} over {} cells: more than a net's boxes allow", count.len());
}

#[test]
fn the_polar_angle_rises_with_one_coordinate_and_the_azimuth_with_the_other() {
    for f in [lumpy as fn(usize, usize) -> f64, |_, _| 1.0, |i, j| (1 + i + j % COLUMNS) as f64] {
        let (grids, ..) = grid(f);
        let place = |u1: u64, u2: u64| grids.sample_by_row(0, u1, u2, Solver::DEFAULT);
        for k in 0..200u64 {
            let still = mix64(k);
            let steps = |i: u64| i << 54;
            for i in 0..1023 {
                let (before, after) = (place(steps(i), still), place(steps(i + 1), still));
                assert!(before.theta <= after.theta, "{k} {i}: {before:?} {after:?}");
                let (before, after) = (place(still, steps(i)), place(still, steps(i + 1)));
                assert!(before.phi <= after.phi, "{k} {i}: {before:?} {after:?}");
            }
        }
    }
}

#[test]
fn rows_of_zero_flux_are_never_chosen_at_the_edges_either() {
    let (grids, ..) = grid(lumpy);
    let ends = [0, 1, 1 << 20, 1 << 63, u64::MAX - 1, u64::MAX];
    for u1 in (0..5_000).map(mix64).chain(ends) {
        for u2 in ends {
            let (row, share) = grids.row_of(0, u1);
            let (column, probability, rest) = grids.column_of(0, row, share, u2);
            assert!(grids.cell_probability(0, row, column) > 0.0, "{u1} {u2}: {row} {column}");
            assert!(probability > 0.0 && (0.0..1.0).contains(&rest) && (0.0..1.0).contains(&share.rest(u1)));
        }
    }
    // One cell of positive flux: there is nothing to choose.
    let (one, ..) = grid(|i, j| f64::from(u8::from((i, j) == (ROWS, COLUMNS))));
    assert!(one.is_single(0));
    let (row, share) = one.row_of(0, 5 << 60);
    let (column, probability, rest) = one.column_of(0, row, share, 3 << 62);
    assert_eq!((row, column, probability, rest), (ROWS - 1, COLUMNS - 1, 1.0, 0.75));
}
