//! Measures the bias of the photon map's pictures against splatted ones: `cargo run --release --example picture_bias -- FOLDER`
//! writes `picture_bias.csv` there and, for docs/PICTURE.md, `picture_bias.svg`.

use std::error::Error;

use caustix::run::{Plan, Settings};
use caustix::scene::camera::{Bandwidth, CameraSpec, Filter};
use caustix::scene::{Scene, build, file};
use caustix::study::picture_bias::{Row, mapped, splatted};
use glam::DVec3;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().collect();
    let reference_log2: u32 = args[1].parse()?;
    let seeds: u64 = args[2].parse()?;
    let ladder: Vec<u32> = args[3].split(',').map(|s| s.parse().unwrap()).collect();
    let pixels: u32 = args[4].parse()?;
    for (name, path, spec) in scenes(pixels) {
        if args.len() > 5 && args[5] != name { continue; }
        let scene = load(path)?;
        let spec = spec(&scene);
        let start = std::time::Instant::now();
        let reference = splatted(&scene, &spec, &plan(1 << reference_log2, 16, 1000)?)?;
        println!("{name}: {} compared, {} lit, {:?}", reference.compared().count(), reference.lit().count(), start.elapsed());
        for fixed in [false, true] {
            let mut base = 0.0;
        for &m in &ladder {
            let n = 1u64 << m;
            let mut spec = spec.clone();
            if fixed && base > 0.0 { spec.bandwidth = Bandwidth::Radius(base * 2f64.powf(-f64::from(m - ladder[0]) / 6.0)); }
            let pictures = (1..=seeds)
                .map(|seed| Ok(mapped(&scene, &spec, &plan(n, 8, seed)?)?))
                .collect::<Result<Vec<_>, Box<dyn Error>>>()?;
            if let Ok(f) = std::env::var("DUMP") { if !fixed {
                let mut t = String::new();
                for (k, m) in pictures.iter().enumerate() { for p in reference.compared() { t += &format!("{m_} {k} {p} {} {} {} {} {}\n", reference.value[p], reference.standard_error[p], m.value[p], m.standard_error[p], m.bias[p], m_ = n.ilog2()); } }
                std::fs::write(format!("{f}_{name}_{}.txt", n.ilog2()), t)?;
            } }
            let row = Row::new(&reference, n, &pictures);
            base = if base == 0.0 { row.radius_m } else { base };
            println!("2^{m} r {:.5} err {:.4} se {:.4} fig {:.4} bias {:.4} ({:.4}) nrms {:.4} cov.err {:.3} cov.bias {:.3} agree {:.4} {:?}", row.radius_m, row.error, row.standard_error, row.figure, row.bias, row.bias_error, row.bias_nrms, row.figure_covers_error, row.figure_covers_bias, row.agree, start.elapsed());
        }
        }
    }
    Ok(())
}

fn load(path: &str) -> Result<Scene, Box<dyn Error>> {
    let all = |errors: Vec<caustix::error::Diagnostic>| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    Ok(build::build(&file::read(path).map_err(all)?).map_err(all)?)
}

fn plan(photons: u64, replicates: u32, seed: u64) -> caustix::error::Result<Plan> {
    Plan::new(&Settings { photons: Some(photons), replicates: Some(replicates), seed, ..Settings::default() })
}

type Spec = Box<dyn Fn(&Scene) -> CameraSpec>;

fn scenes(width: u32) -> Vec<(&'static str, &'static str, Spec)> {
    let own = move |scene: &Scene| {
        let mut spec = scene.camera.clone().unwrap();
        let [w, h] = spec.pixels;
        spec.pixels = [width, width * h / w];
        spec.samples = 16;
        spec.filter = Filter::Box;
        spec
    };
    let below = move |_: &Scene| CameraSpec {
        filter: Filter::Box,
        ..CameraSpec::pinhole(DVec3::new(0.0, -0.8, 0.7), DVec3::new(0.0, 0.1, 0.0), DVec3::Z, 50.0, [width, width * 3 / 4])
    };
    vec![
        ("wavy_glass", "scenes/wavy_glass_seen.toml", Box::new(below)),
        ("ball", "tests/peers/caustic.toml", Box::new(own)),
        ("ring", "scenes/ring.toml", Box::new(own)),
    ]
}
