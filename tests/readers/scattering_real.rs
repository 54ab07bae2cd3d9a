//! Real scattering files: what they declare, and the same samples in other formats.

use caustix::error::Kind;
use caustix::scattering::integral::{node_cosine, slice_albedo};
use caustix::scattering::value::value;
use caustix::scattering::{Frame, Lobe, LobeSide, Quantity};
use glam::DVec3;
use std::f64::consts::PI;

use crate::support::scatter_files::{read_fred, read_speos, real_folder};
use crate::support::tables::incidence;

/// The bilinear f (not f cos) of a slice at an angle of its own frame; beyond the last polar angle 0, or the last ring's.
fn bilinear_f(lobe: &Lobe, theta_i: usize, polar: f64, azimuth: f64, hold: bool) -> f64 {
    let (ps, azs) = (&lobe.polar_deg, &lobe.azimuth_deg);
    let last = ps[ps.len() - 1];
    if polar > last && !hold {
        return 0.0;
    }
    let polar = polar.min(last);
    let cell = |nodes: &[f64], x: f64| nodes.partition_point(|n| *n <= x).clamp(1, nodes.len() - 1) - 1;
    let (i, j) = (cell(ps, polar), cell(azs, azimuth));
    let (u, w) = ((polar - ps[i]) / (ps[i + 1] - ps[i]), (azimuth - azs[j]) / (azs[j + 1] - azs[j]));
    let f = |i: usize, j: usize| f64::from(lobe.slice(0, 0, theta_i)[i * azs.len() + j]);
    (1.0 - u) * ((1.0 - w) * f(i, j) + w * f(i, j + 1)) + u * ((1.0 - w) * f(i + 1, j) + w * f(i + 1, j + 1))
}

/// Polar angle and azimuth about the specular direction of a scattered direction given about the normal (azimuth 0: the plane of
/// incidence, on the far side), degrees; written without the library's frames.
fn about_specular(theta_i: f64, theta: f64, phi: f64) -> (f64, f64) {
    let (a, d) = (theta_i.to_radians(), incidence(theta, phi));
    let (along, pole) = (d.x * a.cos() - d.z * a.sin(), d.x * a.sin() + d.z * a.cos());
    (pole.clamp(-1.0, 1.0).acos().to_degrees(), d.y.atan2(-along).to_degrees().rem_euclid(360.0))
}

/// The sum behind the totals of the University of Arizona's files: mean of a cell's corners, mean of the sines, no cosine; of a plane-
/// symmetric file the stored half only; less a specular spot of 3.5 mm at 82 mm.
fn cell_sum_without_cosine(lobe: &Lobe, phi_i: usize, theta_i: usize, last_azimuth: f64) -> f64 {
    let slice = lobe.slice(0, phi_i, theta_i);
    let n = lobe.azimuth_deg.len();
    let mut sum = 0.0;
    for (i, p) in lobe.polar_deg.windows(2).enumerate() {
        for (j, a) in lobe.azimuth_deg.windows(2).enumerate().filter(|(_, a)| a[1] <= last_azimuth) {
            let corners = [i * n + j, i * n + j + 1, (i + 1) * n + j, (i + 1) * n + j + 1];
            let mean = corners.iter().map(|at| f64::from(slice[*at])).sum::<f64>() / 4.0;
            let sine = (p[0].to_radians().sin() + p[1].to_radians().sin()) / 2.0;
            sum += mean * sine * (p[1] - p[0]).to_radians() * (a[1] - a[0]).to_radians();
        }
    }
    let spot = (3.5f64 / 2.0 / 82.0).asin();
    sum - f64::from(slice[0]) * (1.0 - spot.cos()) * spot * PI
}

#[test]
fn declared_totals_are_the_sums_they_were_made_by() {
    let Some(folder) = real_folder() else { return };
    let files = [
        ("AnoBlackEC1onAlum", 180.0),
        ("AnoBlackNiTEonSteel", 180.0),
        ("ValidationTest_of_TIS_via_BrownVinyl", 180.0),
        ("IMX455", 360.0),
    ];
    for (name, last_azimuth) in files {
        let table = caustix::files::bsdf::read(folder.join("zemax").join(format!("{name}.bsdf"))).unwrap();
        let lobe = &table.lobes[0];
        for phi_i in 0..lobe.phi_i_deg.len() {
            for (t, theta_i) in lobe.theta_i_deg.iter().enumerate() {
                let declared = lobe.declared(phi_i, t).unwrap();
                let (own, sum) =
                    (slice_albedo(lobe, 0, phi_i, t), cell_sum_without_cosine(lobe, phi_i, t, last_azimuth));
                if phi_i == 0 {
                    println!(
                        "{name} {theta_i}: declared {declared}, sum without cosine {sum:.6}, albedo {own:.6}"
                    );
                }
                // Values are printed with four digits, totals with six.
                assert!((sum / declared - 1.0).abs() < 5e-4, "{name} {phi_i} {theta_i}: {sum} {declared}");
                assert!(own > 0.0 && own < 1.0);
            }
        }
        let said = table.warnings.iter().any(|w| w.found().contains("declared total"));
        assert!(said, "{name}: {:?}", table.warnings);
    }
}

/// Of the black paint only the plane of incidence was measured; its total is 2 pi times the integral over it, from -80 to 80
/// degrees, of f |sin| cos (twice what an isotropic lobe about the normal would have).
#[test]
fn the_total_of_an_in_plane_file_is_an_integral_in_the_plane() {
    let Some(folder) = real_folder() else { return };
    let table = caustix::files::bsdf::read(folder.join("zemax/aeroglaze_legacy.bsdf")).unwrap();
    let lobe = &table.lobes[0];
    for (t, theta_i) in lobe.theta_i_deg.iter().enumerate() {
        let mut points: Vec<(f64, f64)> = Vec::new();
        for (i, polar) in lobe.polar_deg.iter().enumerate() {
            for (azimuth, sign) in [(0, -1.0), (1, 1.0)] {
                let theta = theta_i + sign * polar;
                if theta.abs() <= 80.0 && (i, azimuth) != (0, 1) {
                    points
                        .push((theta, f64::from(lobe.slice(0, 0, t)[i * lobe.azimuth_deg.len() + azimuth])));
                }
            }
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(points.len(), 161);
        let g = |(theta, f): (f64, f64)| f * theta.to_radians().sin().abs() * theta.to_radians().cos();
        let plane: f64 =
            points.windows(2).map(|w| 0.5 * (g(w[0]) + g(w[1])) * (w[1].0 - w[0].0).to_radians()).sum();
        let (total, declared) = (2.0 * PI * plane, lobe.declared(0, t).unwrap());
        println!(
            "aeroglaze {theta_i}: declared {declared:.6}, plane {total:.6}, albedo {:.6}",
            slice_albedo(lobe, 0, 0, t)
        );
        assert!((total / declared - 1.0).abs() < 2e-3, "{theta_i}: {total} {declared}");
    }
}

/// An instrument that images the whole hemisphere declares what it saw; its file ends 80 degrees from the straight-through direction. The
/// declared total lies between the table cut there and the table with its last ring held to the horizon.
#[test]
fn the_total_of_a_file_that_stops_early_lies_between_cut_and_held() {
    let Some(folder) = real_folder() else { return };
    let table = caustix::files::bsdf::read(folder.join("zemax/ansys_planesymmetric_btdf.bsdf")).unwrap();
    let lobe = &table.lobes[0];
    assert!(table.warnings.iter().any(|w| w.found().contains("ends at 80 degrees")));
    for (t, theta_i) in lobe.theta_i_deg.iter().enumerate() {
        let integral = |hold: bool| {
            let (n, degree) = (180, PI / 180.0);
            let mut sum = 0.0;
            for i in 0..n {
                let theta = (f64::from(i) + 0.5) * 0.5;
                for j in 0..n {
                    let (polar, azimuth) = about_specular(*theta_i, theta, f64::from(j) + 0.5);
                    let f = bilinear_f(lobe, t, polar, azimuth, hold);
                    sum += f * (theta * degree).sin() * (theta * degree).cos();
                }
            }
            sum * 2.0 * 0.5 * degree * degree
        };
        let (cut, held, declared) = (integral(false), integral(true), lobe.declared(0, t).unwrap());
        let own = slice_albedo(lobe, 0, 0, t);
        println!("vinyl {theta_i}: declared {declared:.6}, cut {cut:.6}, held {held:.6}, albedo {own:.6}");
        assert!(cut < declared && declared < held, "{theta_i}: {cut} {declared} {held}");
        // f cos is bilinear in the table, f in the sum; cells that cross the horizon count in full in the table.
        assert!((own / cut - 1.0).abs() < 0.02, "{theta_i}: {own} {cut}");
    }
}

/// The Speos file was made from the Zemax table: bilinear f on a grid about the normal, each incidence scaled so that its own
/// integral is pi times the declared total. But for that scale the two must be the same function, to rounding.
#[test]
fn speos_and_zemax_forms_of_brown_vinyl_agree() {
    let Some(folder) = real_folder() else { return };
    let zemax = caustix::files::bsdf::read(folder.join("zemax/ansys_planesymmetric_btdf.bsdf")).unwrap();
    let speos = read_speos(&folder.join("speos/planesymmetric_brdf.anisotropicbsdf"));
    let lobe = &zemax.lobes[0];
    assert_eq!(speos.incidences, lobe.theta_i_deg);
    assert!((speos.percent / 100.0 - lobe.declared(0, 0).unwrap()).abs() < 1e-12);
    for (t, (thetas, phis, values)) in speos.blocks.iter().enumerate() {
        let theta_i = lobe.theta_i_deg[t];
        let mut ratios = Vec::new();
        let mut total = 0.0;
        for (i, theta) in thetas.iter().enumerate() {
            for (j, phi) in phis.iter().enumerate() {
                let value = values[i * phis.len() + j];
                let (polar, azimuth) = about_specular(theta_i, *theta, *phi);
                let f = bilinear_f(lobe, t, polar, azimuth, false);
                // On the last ring itself rounding decides whether the table still holds.
                if (polar - 80.0).abs() > 1e-6 {
                    let both = f > 1e-9 && value > 1e-9;
                    assert!(both || (f < 1e-9 && value < 1e-9), "{theta_i} {theta} {phi}: {f} {value}");
                    ratios.extend(both.then_some(value / f));
                }
                let ends = |at: usize, n: usize| if at == 0 || at + 1 == n { 0.5 } else { 1.0 };
                let weight = ends(i, thetas.len()) * ends(j, phis.len());
                total += weight * value * theta.to_radians().sin() * theta.to_radians().cos();
            }
        }
        ratios.sort_by(f64::total_cmp);
        let (low, high) = (ratios[0], ratios[ratios.len() - 1]);
        // acos near 1 leaves 1e-8 of the angle at the pole; single precision of the table 6e-8 of a value.
        assert!(ratios.len() > 350 && high / low - 1.0 < 5e-7, "{theta_i}: {low} {high}");
        total *= 5.0f64.to_radians() * 10.0f64.to_radians() / PI;
        let declared = lobe.declared(0, t).unwrap();
        println!(
            "{theta_i}: {} points, scale {low:.9}; total {total:.6}, declared {declared:.6}",
            ratios.len()
        );
        assert!((total / declared - 1.0).abs() < 0.01, "{theta_i}: {total} {declared}");
    }
}

/// Both files come from the same measurement, not from each other: the Zemax form was shifted to put the maximum on the specular
/// direction and interpolated to its grid (`rt300s_to_bsdf_iso.m` of ua-loft/bsdf-tools). They share the peak where the maximum was
/// specular to begin with; elsewhere they agree as well as that processing lets them. A wrong frame is off by factors.
#[test]
fn fred_and_zemax_forms_of_black_anodising_agree() {
    let Some(folder) = real_folder() else { return };
    let zemax = caustix::files::bsdf::read(folder.join("zemax/AnoBlackEC1onAlum.bsdf")).unwrap();
    let fred = read_fred(&folder.join("fred/AnoBlackEC1onAlum.txt"));
    let lobe = &zemax.lobes[0];
    assert_eq!(fred.iter().map(|b| b.0).collect::<Vec<_>>(), lobe.theta_i_deg);
    for (theta_i, rows) in &fred {
        let median = |turned: f64| {
            let wi = incidence(*theta_i, 180.0);
            let off = rows.iter().filter_map(|[theta, phi, f]| {
                let own = value(lobe, 0, wi, incidence(*theta, phi + turned));
                (*theta <= 70.0 && own > 0.0).then(|| (own / f).ln().abs())
            });
            let mut off: Vec<f64> = off.collect();
            off.sort_by(f64::total_cmp);
            off[off.len() / 2]
        };
        let peak = rows.iter().find(|r| (r[0], r[1]) == (*theta_i, 0.0)).unwrap()[2];
        let own = value(lobe, 0, incidence(*theta_i, 180.0), incidence(*theta_i, 0.0));
        println!(
            "{theta_i}: peak {own:.6} and {peak}; median |ln ratio| {:.4}, turned {:.3}",
            median(0.0),
            median(180.0)
        );
        if *theta_i <= 30.0 {
            // Printed: 3.480e-02 and 0.034800.
            assert!((own - peak).abs() <= 5.5e-6, "{theta_i}: {own} {peak}");
        }
        assert!(median(0.0) < 0.08, "{theta_i}: {}", median(0.0));
        assert!(
            *theta_i < 40.0 || median(180.0) > 5.0 * median(0.0),
            "{theta_i}: a turned frame must not pass"
        );
    }
}

const KLEMS_FULL: [(f64, usize); 9] =
    [(0.0, 1), (10.0, 8), (20.0, 16), (30.0, 20), (40.0, 24), (50.0, 24), (60.0, 24), (70.0, 16), (82.5, 12)];

/// Patches of Klems Full whose azimuth is a multiple of 45 degrees: number, theta, phi.
fn aligned_patches() -> Vec<(usize, f64, f64)> {
    let (mut list, mut first) = (Vec::new(), 0);
    for (theta, n) in KLEMS_FULL {
        for j in 0..n {
            let phi = 360.0 * j as f64 / n as f64;
            if phi % 45.0 == 0.0 {
                list.push((first + j, theta, phi));
            }
        }
        first += n;
    }
    assert_eq!(first, 145);
    list
}

#[test]
fn klems_tables_hold_the_values_of_their_patches() {
    let Some(folder) = real_folder() else { return };
    for file in ["sawtooth.xml", "aerc6216_kf.xml"] {
        let path = folder.join("klems").join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        let table = caustix::files::bsdf::read(&path).unwrap();
        assert!(table.warnings[0].found().contains("Reflection Front"), "{:?}", table.warnings);
        for (lobe, part) in table.lobes.iter().zip(text.split("<WavelengthDataDirection>").skip(1)) {
            let title = part.split('<').next().unwrap();
            let data = part.split("<ScatteringData>").nth(1).unwrap().split('<').next().unwrap();
            let matrix: Vec<f64> = data.split_whitespace().map(|w| w.parse().unwrap()).collect();
            assert_eq!(matrix.len(), 145 * 145);
            let name = match (lobe.quantity, lobe.side) {
                (Quantity::Reflection, LobeSide::Back) => "Reflection Back",
                (Quantity::Transmission, LobeSide::Back) => "Transmission Back",
                (Quantity::Transmission, LobeSide::Front) => "Transmission Front",
                other => panic!("{other:?}"),
            };
            assert_eq!(name, title);
            // Seen from the room, +z of the file: to the front's local frame, z out of the other side.
            let front = lobe.side == LobeSide::Front;
            let local = |d: DVec3| if front { DVec3::new(d.x, -d.y, -d.z) } else { d };
            let (mut worst, mut pairs) = (0.0f64, 0);
            for (i, theta_i, phi_i) in aligned_patches() {
                // Radiance: an incident patch's vector is its exit vector turned about, on the side it comes from.
                let source = incidence(theta_i, phi_i + 180.0);
                let wi = local(if front { DVec3::new(source.x, source.y, -source.z) } else { source });
                for (o, theta_o, phi_o) in aligned_patches() {
                    let exit = incidence(theta_o, phi_o);
                    let to_room = front == (lobe.quantity == Quantity::Transmission);
                    let wo = local(if to_room { exit } else { DVec3::new(exit.x, exit.y, -exit.z) });
                    let exit_is_ours = value(lobe, 0, wi, wo);
                    let expected = matrix[o * 145 + i];
                    let off = (exit_is_ours - expected).abs() / expected.max(1e-3);
                    worst = worst.max(off);
                    pairs += 1;
                }
            }
            println!("{file} {name}: {pairs} pairs, worst relative {worst:.5}");
            assert!(pairs > 3000 && worst < 5e-3, "{file} {name}: {worst}");
        }
    }
}

#[test]
fn klems_albedos_are_the_sums_over_patches() {
    let Some(folder) = real_folder() else { return };
    let text = std::fs::read_to_string(folder.join("klems/aerc6216_kf.xml")).unwrap();
    let table = caustix::files::bsdf::read(folder.join("klems/aerc6216_kf.xml")).unwrap();
    let edges = [0.0f64, 5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 90.0];
    let data = text.split("<ScatteringData>").nth(1).unwrap().split('<').next().unwrap();
    let matrix: Vec<f64> = data.split_whitespace().map(|w| w.parse().unwrap()).collect();
    let sine2 = |deg: f64| deg.to_radians().sin() * deg.to_radians().sin();
    let lobe = &table.lobes[0];
    // Light from azimuth 180 of the back is the first patch of each ring.
    let phi_i = lobe.phi_i_deg.iter().position(|p| *p == 180.0).unwrap();
    let mut incident = 0;
    for (t, (_, count)) in KLEMS_FULL.iter().enumerate() {
        let (mut expected, mut first) = (0.0, 0);
        for (ring, (_, n)) in KLEMS_FULL.iter().enumerate() {
            let patch = PI * (sine2(edges[ring + 1]) - sine2(edges[ring])) / *n as f64;
            expected += patch * (first..first + n).map(|o| matrix[o * 145 + incident]).sum::<f64>();
            first += n;
        }
        let own = slice_albedo(lobe, 0, phi_i, t);
        println!("{t}: {own:.6} {expected:.6}");
        assert!((own / expected - 1.0).abs() < 2e-3, "{t}: {own} {expected}");
        incident += count;
    }
}

#[test]
fn files_that_are_not_read_say_why() {
    let Some(folder) = real_folder() else { return };
    for (file, kind, line) in [
        ("fred/AnoBlackEC1onAlum.txt", Kind::Unavailable, 1),
        ("speos/planesymmetric_brdf.anisotropicbsdf", Kind::Unavailable, 1),
        ("tensortree/testBSDF.xml", Kind::Unavailable, 17),
        ("klems/2011-SA1-Small-CommaSeparated.XML", Kind::Missing, 107),
        ("klems/2011-SA1-Small-TabSeparated.XML", Kind::Missing, 107),
    ] {
        let error = caustix::files::bsdf::read(folder.join(file)).unwrap_err();
        assert_eq!((error.kind(), error.line()), (kind, Some(line)), "{error}");
        assert!(error.file().unwrap().ends_with(file), "{error}");
    }
}

#[test]
fn anisotropic_files_keep_their_rotations() {
    let Some(folder) = real_folder() else { return };
    let table = caustix::files::bsdf::read(folder.join("zemax/IMX455.bsdf")).unwrap();
    let lobe = &table.lobes[0];
    assert_eq!(lobe.counts(), [1, 37, 4, 21, 37]);
    assert_eq!(lobe.frame, Frame::Specular);
    // The file is mirrored from a quarter: rotation 20 is rotation 340 with its azimuths reversed. phi_i = 360 - S.
    for (t, _) in lobe.theta_i_deg.iter().enumerate() {
        let (a, b) = (lobe.slice(0, 34, t), lobe.slice(0, 2, t));
        for (at, v) in a.iter().enumerate() {
            let (polar, azimuth) = (at / 37, at % 37);
            assert_eq!(*v, b[polar * 37 + 36 - azimuth]);
        }
    }
    assert!(node_cosine(Frame::Specular, 70.0, 21.0, 180.0) < 0.0, "91 degrees from the normal");
}
