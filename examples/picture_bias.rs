//! Measures the bias of the photon map's pictures against splatted ones.
#[path = "../tests/picture_bias_support/mod.rs"]
mod views;

use caustix::scene::camera::Bandwidth;
use caustix::study::picture_bias::{Row, mapped, splatted};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().collect();
    let reference_log2: u32 = args[1].parse()?;
    let seeds: u64 = args[2].parse()?;
    let ladder: Vec<u32> = args[3].split(',').map(|s| s.parse().unwrap()).collect();
    let pixels: u32 = args[4].parse()?;
    for make in [views::wavy_glass, views::ball, views::ring, views::pane] {
        let views::View { name, scene, spec } = make(pixels).map_err(|e| format!("{e:?}"))?;
        if args.len() > 5 && args[5] != name {
            continue;
        }
        let spec = caustix::scene::camera::CameraSpec {
            samples: std::env::var("S").map(|s| s.parse().unwrap()).unwrap_or(16),
            ..spec
        };
        let start = std::time::Instant::now();
        let reference = splatted(&scene, &spec, &views::plan(reference_log2, 16, 1000)?)?;
        println!(
            "{name}: {} compared, {} lit, {:?}",
            reference.compared().count(),
            reference.lit().count(),
            start.elapsed()
        );
        for fixed in [false, true] {
            if fixed && args.len() > 6 {
                continue;
            }
            let mut base = 0.0;
            for &m in &ladder {
                let n = 1u64 << m;
                let mut spec = spec.clone();
                if fixed && base > 0.0 {
                    spec.bandwidth = Bandwidth::Radius(base * 2f64.powf(-f64::from(m - ladder[0]) / 6.0));
                }
                let pictures = (1..=seeds)
                    .map(|seed| Ok(mapped(&scene, &spec, &views::plan(m, 8, seed)?)?))
                    .collect::<Result<Vec<_>, Box<dyn Error>>>()?;
                if let Ok(f) = std::env::var("DUMP") {
                    if !fixed {
                        let mut t = String::new();
                        for (k, m) in pictures.iter().enumerate() {
                            for p in reference.compared() {
                                t += &format!(
                                    "{m_} {k} {p} {} {} {} {} {}\n",
                                    reference.value[p],
                                    reference.standard_error[p],
                                    m.value[p],
                                    m.standard_error[p],
                                    m.bias[p],
                                    m_ = n.ilog2()
                                );
                            }
                        }
                        std::fs::write(format!("{f}_{name}_{}.txt", n.ilog2()), t)?;
                    }
                }
                let row = Row::new(&reference, n, &pictures);
                base = if base == 0.0 { row.radius_m } else { base };
                println!(
                    "2^{m} r {:.5} err {:.4} se {:.4} fig {:.4} bias {:.4} ({:.4}) nrms {:.4} cov.err {:.3} cov.bias {:.3} agree {:.4} {:?}",
                    row.radius_m,
                    row.error,
                    row.standard_error,
                    row.figure,
                    row.bias,
                    row.bias_error,
                    row.bias_nrms,
                    row.figure_covers_error,
                    row.figure_covers_bias,
                    row.agree,
                    start.elapsed()
                );
            }
        }
    }
    Ok(())
}
