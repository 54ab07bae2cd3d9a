//! Rows and columns of a table on coordinates of their own: the same density as by cells, steady in both
//! coordinates.

use caustix::sample::compact::CompactGrids;
use caustix::sequence::Points;
use caustix::sequence::hash::mix64;
use caustix::sequence::owen::OwenPoints;
use caustix::sequence::to_unit_f64;

use crate::support::given::of_slice;
use crate::support::sphere_table::SphereTable;

const ROWS: usize = 18;
const COLUMNS: usize = 24;

/// One slice over the sphere.
fn grid(f: impl Fn(usize, usize) -> f64) -> (CompactGrids, SphereTable) {
    let table = SphereTable::over_the_sphere([ROWS, COLUMNS], 0.0, f);
    let mut grids = CompactGrids::new(&table.polar, &table.azimuth).unwrap();
    grids.push(&table.values).unwrap();
    (grids, table)
}

/// Rows and cells of zeros, also first and last ones; values fifteen decades apart, which f32 holds exactly
/// in units of the largest.
fn lumpy(i: usize, j: usize) -> f64 {
    match (i, (i * 31 + j % COLUMNS * 17) % 23) {
        (0 | 1 | 8 | 9 | 17 | 18, _) | (_, 0..8) => 0.0,
        (_, 8) => 2f64.powi(-40),
        (_, 9) => 1024.0,
        (_, k) => k as f64,
    }
}

#[test]
fn the_coordinates_of_a_sample_come_back() {
    let (grids, table) = grid(lumpy);
    for i in 0..50_000u64 {
        let (u1, u2) = (mix64(2 * i), mix64(2 * i + 1));
        let q = of_slice(&grids, 0, u1, u2);
        let [v1, v2] = table.by_row(q.theta, q.phi);
        // Angles are rounded to 2^-52 of a turn; where the density vanishes they tell less of the
        // coordinates.
        let faint = table.density(q.theta, q.phi) < 1e-6;
        assert!(faint || (v1 - to_unit_f64(u1)).abs() < 1e-12, "{i}: {v1} {u1}");
        assert!(faint || (v2 - to_unit_f64(u2)).abs() < 1e-10, "{i}: {v2} {u2}");
    }
}

#[test]
fn every_cell_has_its_share_of_the_unit_square() {
    // Of a net of 2^20 points a box of the square, which is what a cell has, holds its area to within the
    // elementary intervals its borders cut, some tens. By chance alone the counts, up to 20 000, would be off
    // by their roots, and chi2 some 250.
    let (grids, table) = grid(lumpy);
    let points = OwenPoints::new(7, 0);
    let n = 1u64 << 20;
    let mut count = vec![0u32; ROWS * COLUMNS];
    for i in 0..n {
        let q = of_slice(&grids, 0, points.coordinate(i, 0), points.coordinate(i, 1));
        let (row, column) = table.cell(q.theta, q.phi);
        count[row * COLUMNS + column] += 1;
    }
    let mut chi2 = 0.0;
    for (cell, count) in count.iter().enumerate() {
        let expected = table.part(cell / COLUMNS, cell % COLUMNS) * n as f64;
        let off = f64::from(*count) - expected;
        assert!(off.abs() <= 60.0 && (expected > 0.0 || *count == 0), "{cell}: {count} for {expected}");
        chi2 += if expected > 1.0 { off * off / expected } else { 0.0 };
    }
    assert!(chi2 < 10.0, "chi2 {chi2} over {} cells: more than a net's boxes allow", count.len());
}

#[test]
fn the_polar_angle_rises_with_one_coordinate_and_the_azimuth_with_the_other() {
    for f in [lumpy as fn(usize, usize) -> f64, |_, _| 1.0, |i, j| (1 + i + j % COLUMNS) as f64] {
        let (grids, _) = grid(f);
        let place = |u1: u64, u2: u64| of_slice(&grids, 0, u1, u2);
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
