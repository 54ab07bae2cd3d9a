//! The two tables on the sphere, that of a luminaire and those of a scattering table: each other's samples,
//! the coordinates of a sample by quadrature, and their extremes.

use std::f64::consts::PI;

use caustix::math::solve::Solver;
use caustix::sample::angles::MAX_NODES;
use caustix::sample::choose::Reusable;
use caustix::sample::compact::CompactGrids;
use caustix::sample::grid::Grid;
use caustix::sequence::hash::mix64;
use caustix::sequence::to_unit_f64;

use crate::support::given::{Script, of_grid, of_slice};
use crate::support::sphere_table::SphereTable;

fn grid(table: &SphereTable) -> Grid {
    Grid::new(&table.polar, &table.azimuth, &table.values).unwrap()
}

/// One slice.
fn compact_table(table: &SphereTable) -> CompactGrids {
    let mut grids = CompactGrids::new(&table.polar, &table.azimuth).unwrap();
    grids.push(&table.values).unwrap();
    grids
}

fn value(grids: &CompactGrids, slice: usize, theta: f64, phi: f64) -> f64 {
    grids.locate(theta, phi).map_or(0.0, |at| grids.value(slice, &at))
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
    let table = SphereTable::over_the_sphere([36, 24], -PI, lumpy);
    let grid = grid(&table);
    let mut compact = CompactGrids::new(&table.polar, &table.azimuth).unwrap();
    compact.push(&vec![1.0; table.values.len()]).unwrap();
    let slice = compact.push(&table.values).unwrap();
    assert!((compact.integral(slice) / grid.integral() - 1.0).abs() < 1e-14);
    assert!((compact.integral(0) / (4.0 * PI) - 1.0).abs() < 1e-13);
    for i in 0..50_000u64 {
        let (u1, u2) = (mix64(2 * i), mix64(2 * i + 1));
        let x = of_grid(&grid, u1, u2, Solver::DEFAULT);
        // By cells, as a luminaire: theta is what is left of the first coordinate.
        let mut script = Script::new(0, &[u1, u2]).without_reuse();
        let (y, _) = compact.draw(slice, &mut script);
        assert!((x.direction - y.direction).length() < 1e-9, "{i}: {x:?} {y:?}");
        let ratio = grid.value(x.theta, x.phi) / value(&compact, slice, x.theta, x.phi);
        assert!((ratio - 1.0).abs() < 1e-12, "{ratio}");
        let [v1, v2] = table.by_cell(y.theta, y.phi);
        assert!((v1 - to_unit_f64(u1)).abs() < 1e-13, "{v1} {u1}");
        assert!((v2 - to_unit_f64(u2)).abs() < 1e-11 || table.density(y.theta, y.phi) < 1e-6);
    }
}

#[test]
fn sample_then_invert_returns_the_coordinates() {
    let table = SphereTable::over_the_sphere([36, 24], 0.0, |i, j| match (i + 3 * (j % 24)) % 5 {
        0 => 0.0,
        _ => f64::from(((i * 31 + j % 24 * 17) % 23) as u32).powi(3),
    });
    let grid = grid(&table);
    for i in 0..20_000u64 {
        let (u1, u2) = (mix64(2 * i), mix64(2 * i + 1));
        let point = of_grid(&grid, u1, u2, Solver::DEFAULT);
        let [v1, v2] = table.by_cell(point.theta, point.phi);
        // The remainder resolves theta to 2^-46 of the cell; angles are rounded to 2^-52 of a turn against
        // cells of a tenth, and u inside a cell is worth its probability.
        assert!((v1 - to_unit_f64(u1)).abs() < 1e-13, "{i}: {v1} {u1}");
        let flat = table.density(point.theta, point.phi) < 1e-6;
        assert!((v2 - to_unit_f64(u2)).abs() < 2e-13 || flat, "{i}: {v2} {u2}");
    }
}

/// d(omega)/d(u1, u2) by central differences against 1 / density: no random numbers, no histogram.
#[test]
fn jacobian_is_the_inverse_density_pointwise() {
    let table = SphereTable::over_the_sphere([12, 8], 0.0, |i, j| ((i * 31 + j % 8 * 17) % 23) as f64);
    let grid = grid(&table);
    let mut checked = 0;
    for i in 0..3000u64 {
        let (u1, u2) = (mix64(i) | 1 << 40, mix64(!i));
        let (h1, h2) = (1u64 << 38, 1u64 << 44);
        // Away from the edges of the cell's share of u1 and of u2: where a corner is zero the map has a
        // square root there.
        let mut rest = Reusable::fresh(u1);
        grid.choice().choose(&mut rest);
        if [rest.bits(), u2].into_iter().any(|u| !(0.01..0.99).contains(&to_unit_f64(u))) {
            continue;
        }
        let at = |u1: u64, u2: u64| of_grid(&grid, u1, u2, Solver::DEFAULT);
        let (here, up, down) = (at(u1, u2), at(u1.wrapping_add(h1), u2), at(u1.wrapping_sub(h1), u2));
        let (right, left) = (at(u1, u2 + h2), at(u1, u2 - h2));
        if table.cell(up.theta, up.phi) != table.cell(down.theta, down.phi) {
            continue;
        }
        let width = |h: u64| 2.0 * h as f64 / 2f64.powi(64);
        let d1 = (up.direction - down.direction) / width(h1);
        let d2 = (right.direction - left.direction) / width(h2);
        let product = d1.cross(d2).length() * table.density(here.theta, here.phi);
        assert!((product - 1.0).abs() < 1e-4, "{i}: {product}");
        checked += 1;
    }
    assert!(checked > 2500, "{checked}");
}

/// The first and the last fraction of every cell, and what lies beside them: the right cell, by its row and
/// its column.
#[test]
fn cells_begin_and_end_where_their_shares_do() {
    let table = SphereTable::over_the_sphere([6, 8], 0.0, |i, j| match (i, j % 8) {
        (0 | 1 | 4, _) | (_, 3 | 4) => 0.0,
        (3, 0) => 128.0, // The largest: f32 holds the others in units of it.
        (i, j) => (1 + i * 5 + j * j) as f64,
    });
    let compact = compact_table(&table);
    let (mut below, mut edges) = (0.0, 0);
    for i in 0..6 {
        let row: f64 = (0..8).map(|j| table.part(i, j)).sum();
        let mut across = 0.0;
        for j in 0..8 {
            let part = table.part(i, j);
            for (along, inside) in [(1e-9, 0.5), (1.0 - 1e-9, 0.5), (0.5, 1e-9), (0.5, 1.0 - 1e-9)] {
                if part == 0.0 {
                    continue;
                }
                let u = [below + row * along, (across + part * inside) / row];
                let [u1, u2] = u.map(|u| (u * 2f64.powi(64)) as u64);
                let q = of_slice(&compact, 0, u1, u2);
                // A point of a far edge may round to it.
                let (theta, phi) = (q.theta - 1e-13, q.phi - 1e-13);
                let edge = if along == 1e-9 || inside == 1e-9 { (q.theta, q.phi) } else { (theta, phi) };
                assert_eq!(table.cell(edge.0, edge.1), (i, j), "{along} {inside}: {q:?}");
                edges += 1;
            }
            across += part;
        }
        below += row;
    }
    assert!(edges > 60, "{edges}");
}

#[test]
fn cells_of_zero_flux_are_never_chosen_at_the_edges_of_u_either() {
    // One node, which has four cells around it, and a faint one at the pole.
    let table = SphereTable::over_the_sphere([6, 8], 0.0, |i, j| match (i, j) {
        (3, 4) => 1.0,
        (0, 1) => 1e-12,
        _ => 0.0,
    });
    let (grid, compact) = (grid(&table), compact_table(&table));
    let ends = [0, 1, 1 << 20, u64::MAX - 1, u64::MAX];
    for bits in (0..100_000u64).map(mix64).chain(ends) {
        let other = mix64(!bits);
        let mut script = Script::new(0, &[bits, other]).without_reuse();
        let by_cell = compact.draw(0, &mut script).0;
        for q in [of_grid(&grid, bits, other, Solver::DEFAULT), of_slice(&compact, 0, bits, other), by_cell] {
            // A far edge, which the last fractions reach, counts as the next cell's.
            let within =
                [(q.theta, q.phi), (q.theta - 1e-9, q.phi - 1e-9)].map(|(theta, phi)| table.cell(theta, phi));
            assert!(within.into_iter().any(|(i, j)| table.part(i, j) > 0.0), "{bits}: {q:?}");
            assert!(ends.contains(&bits) || value(&compact, 0, q.theta, q.phi) > 0.0, "{bits}: {q:?}");
        }
    }
    // The rare cell at the pole has the first fraction.
    let first = [of_grid(&grid, 0, 1 << 63, Solver::DEFAULT), of_slice(&compact, 0, 0, 1 << 63)];
    assert!(first.iter().all(|q| q.theta <= table.polar[1]), "{first:?}");
}

#[test]
fn one_cell_no_cell_and_the_smallest_grid() {
    let table = SphereTable::new(vec![0.0, 1.0], vec![0.0, 1.0], vec![1.0, 2.0, 3.0, 4.0]);
    let mut one = compact_table(&table);
    let black = one.push(&[0.0; 4]).unwrap();
    assert_eq!((one.integral(black), value(&one, black, 0.5, 0.5)), (0.0, 0.0));
    assert!(grid(&table).choice().is_single());
    let [v1, v2] = table.by_cell(0.5, 0.5).map(crate::support::given::fraction);
    for back in [of_grid(&grid(&table), v1, v2, Solver::DEFAULT), of_slice(&one, 0, v1, v2)] {
        assert!((back.theta - 0.5).abs() < 1e-12 && (back.phi - 0.5).abs() < 1e-12);
    }
    // One cell of positive flux among many, a corner of the range: the whole of both coordinates is its own.
    let corners = [(0, 0), (0, 8), (6, 0), (6, 8)];
    for (k, at) in corners.into_iter().enumerate() {
        let table = SphereTable::over_the_sphere([6, 8], 0.0, |i, j| if (i, j) == at { 3.0 } else { 0.0 });
        let compact = compact_table(&table);
        for (u1, u2) in [(0, 3 << 62), (7 << 60, 1 << 20), (u64::MAX >> 1, u64::MAX >> 1)] {
            let q = of_slice(&compact, 0, u1, u2);
            let expected = (if k < 2 { 0 } else { 5 }, if k % 2 == 0 { 0 } else { 7 });
            assert_eq!(table.cell(q.theta, q.phi), expected, "{u1} {u2}: {q:?}");
            let [v1, v2] = table.inside_cell(q.theta, q.phi);
            let off = [v1 - to_unit_f64(u1), v2 - to_unit_f64(u2)];
            assert!(off.iter().all(|off| off.abs() < 1e-9), "{q:?} {off:?}");
        }
    }
}

/// Outer edges belong to a table, an edge between two cells to the second one; turns by 2 pi do not matter.
#[test]
fn directions_on_edges_are_located() {
    let table = SphereTable::new(
        vec![0.5, 1.0, 2.0],
        vec![-1.0, 0.0, 2.5],
        vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
    );
    let (grid, compact) = (grid(&table), compact_table(&table));
    let place = |theta: f64, phi: f64| compact.locate(theta, phi).map(|at| (at.row, at.column));
    let ulps = |x: f64, n: f64| x * (1.0 + n * f64::EPSILON);
    for (theta, row) in [
        (ulps(0.5, -8.0), None),
        (ulps(0.5, -3.0), Some(0)),
        (0.5, Some(0)),
        (ulps(1.0, -1.0), Some(0)),
        (1.0, Some(1)),
        (2.0, Some(1)),
        (ulps(2.0, 3.0), Some(1)),
        (ulps(2.0, 8.0), None),
        (f64::NAN, None),
    ] {
        assert_eq!(place(theta, 0.5).map(|at| at.0), row, "{theta}");
        let value = grid.value(theta, 0.5);
        assert_eq!(value > 0.0, row.is_some(), "{theta}");
        assert!(row.is_none() || (value - table.value(theta.clamp(0.5, 2.0), 0.5)).abs() < 1e-14 * value);
    }
    for (phi, column) in [
        (-1.5, None),
        (-1.0, Some(0)),
        (-1e-300, Some(0)),
        (0.0, Some(1)),
        (2.5, Some(1)),
        (ulps(2.5, 3.0), Some(1)),
        (2.6, None),
        (f64::NAN, None),
        (f64::INFINITY, None),
    ] {
        assert_eq!(place(1.5, phi).map(|at| at.1), column, "{phi}");
    }
    // Turned, an edge is not kept by the rounding of a turn: just beside it.
    for (phi, column) in
        [(-1.0 + 1e-9, Some(0)), (-1e-9, Some(0)), (1e-9, Some(1)), (2.5 - 1e-9, Some(1)), (2.6, None)]
    {
        for turns in [-2.0, -1.0, 1.0, 3.0] {
            assert_eq!(place(1.5, phi + turns * 2.0 * PI).map(|at| at.1), column, "{phi} {turns}");
        }
    }
    // A full turn: an angle just below its first edge is one just below the last one.
    let whole = SphereTable::over_the_sphere([2, 4], 0.0, |i, j| (1 + i + j % 4) as f64);
    let located = compact_table(&whole).locate(1.0, -1e-20).unwrap();
    assert_eq!((located.column, located.x), (3, 1.0));
}

#[test]
fn memory_is_sixteen_bytes_a_value() {
    for steps in [[90, 72], [180, 360], [18, 36]] {
        let table = SphereTable::over_the_sphere(steps, 0.0, |i, j| ((i * j) % 1000) as f64 + 1.0);
        let mut compact = CompactGrids::new(&table.polar, &table.azimuth).unwrap();
        compact.reserve(20);
        for _ in 0..20 {
            compact.push(&table.values).unwrap();
        }
        let bytes = compact.memory_bytes() as f64 / (20 * table.values.len()) as f64;
        println!("{steps:?}: {bytes:.2} bytes a value");
        assert!(bytes <= 18.0, "{bytes}");
    }
    let largest =
        SphereTable::over_the_sphere([720, 360], 0.0, |i, j| f64::from((i * j % 1000) as u32) + 1.0);
    let bytes = grid(&largest).memory_bytes();
    assert!(bytes < 40 << 20, "{bytes}");
}

/// One check for both: what is no table is neither a luminaire's nor a scattering table's.
#[test]
fn bad_tables_are_refused() {
    let many: Vec<f64> = (0..=MAX_NODES / 2).map(|k| k as f64 * 1e-6).collect();
    let angles: [(&[f64], &[f64]); 10] = [
        (&[0.0], &[0.0, 1.0]),
        (&[0.0, 1.0], &[1.0]),
        (&[0.0, 0.0], &[0.0, 1.0]),
        (&[0.0, 1.0], &[1.0, 1.0]),
        (&[-1e-9, 1.0], &[0.0, 1.0]),
        (&[0.0, 4.0], &[0.0, 1.0]),
        (&[0.0, f64::NAN], &[0.0, 1.0]),
        (&[0.0, 1.0], &[0.0, 7.0]),
        (&[0.0, 1.0], &[0.0, f64::INFINITY]),
        (&[0.0, 1.0], &many),
    ];
    for (polar, azimuth) in angles {
        let values = vec![1.0; polar.len() * azimuth.len()];
        let (grid, compact) = (Grid::new(polar, azimuth, &values), CompactGrids::new(polar, azimuth));
        let (grid, compact) = (grid.unwrap_err(), compact.unwrap_err());
        assert_eq!(grid.found(), compact.found(), "one check");
    }
    let sphere = ([0.0, 1.0], [0.0, 1.0]);
    let mut grids = CompactGrids::new(&sphere.0, &sphere.1).unwrap();
    for bad in [
        vec![1.0; 3],
        vec![1.0, f64::NAN, 1.0, 1.0],
        vec![1.0, -1.0, 1.0, 1.0],
        vec![f64::INFINITY; 4],
        vec![f64::MAX; 4],
    ] {
        let wide = bad[0] == f64::MAX;
        // Finite values whose integral is not: over a solid angle above 1.
        let (polar, azimuth) = if wide { ([0.0, 3.0], [0.0, 6.0]) } else { sphere };
        let mut wider = CompactGrids::new(&polar, &azimuth).unwrap();
        assert!(Grid::new(&polar, &azimuth, &bad).is_err(), "{bad:?}");
        assert!(if wide { wider.push(&bad) } else { grids.push(&bad) }.is_err(), "{bad:?}");
        assert_eq!(wider.push(&[1.0; 4]).unwrap(), 0, "nothing is left of what was refused");
    }
    assert_eq!(grids.count(), 0);
    assert!(Grid::new(&sphere.0, &sphere.1, &[0.0; 4]).is_err(), "a luminaire must emit something");
}
