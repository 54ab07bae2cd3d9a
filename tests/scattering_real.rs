#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]
use caustix::scattering;

#[test]
fn every_real_file_reads() {
    let Some(folder) = std::env::var_os("CAUSTIX_TEST_DATA") else {
        println!("skipped: CAUSTIX_TEST_DATA is not set");
        return;
    };
    let folder = std::path::Path::new(&folder).join("brdf");
    for sub in ["zemax", "klems", "fred", "speos", "tensortree"] {
        for entry in std::fs::read_dir(folder.join(sub)).unwrap() {
            let path = entry.unwrap().path();
            let start = std::time::Instant::now();
            match scattering::read(&path) {
                Ok(t) => {
                    println!(
                        "{} {:?} in {:?}",
                        path.display(),
                        t.lobes.iter().map(|l| (l.quantity, l.side, l.counts())).collect::<Vec<_>>(),
                        start.elapsed()
                    );
                    for w in &t.warnings {
                        println!("   {w}");
                    }
                    for l in &t.lobes {
                        let a: Vec<String> = (0..l.theta_i_deg.len())
                            .map(|i| format!("{:.4}", scattering::integral::slice_albedo(l, 0, 0, i)))
                            .collect();
                        println!("   {:?}", a);
                    }
                    for d in scattering::reciprocity::all(&t) {
                        println!("   {d:?}");
                    }
                }
                Err(e) => println!("ERR {e}"),
            }
        }
    }
}
