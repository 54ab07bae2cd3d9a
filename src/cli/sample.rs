//! `caustix sample`: directions of a photometric file, and the certificate that they have its density.

use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;

use crate::emitter::AimFrame;
use crate::emitter::photometric::grid_axes;
use crate::error::Result;
use crate::files::atomic::write_atomically;
use crate::files::outputs::check_outputs;
use crate::files::photometric;
use crate::files::scene_toml::count::parse_count;
use crate::lab::certificate::density::file_angles_deg;
use crate::lab::certificate::sampler::{Effort, Sampled, made_from, sample};
use crate::lab::certificate::{Certificate, Density, Judge, PointKind, REPLICATES};
use crate::photometry::PhotometricType;
use crate::report::certificate::CertificateReport;
use crate::report::json::json;
use crate::run::Algorithm;
use crate::sample::grid::Grid;

use super::{Done, SampleArgs, algorithm, exit, in_option, print, say, warn};

/// Fewest points of a randomisation for the test of cell means.
const LEAST_REPLICATE: u64 = 64;

/// Runs the subcommand; the exit code.
pub(super) fn run(args: &SampleArgs) -> Done {
    let report = certify(args)?;
    print(&if args.json { json(&report)? } else { report.text() });
    Ok(verdict(&report.certificate))
}

/// The exit code of a certificate; what failed is said.
fn verdict(certificate: &Certificate) -> u8 {
    for failure in certificate.failures() {
        say(&format!("certificate failed: {failure}"));
    }
    if certificate.passed { exit::DONE } else { exit::WRONG }
}

fn certify(args: &SampleArgs) -> Result<CertificateReport> {
    let number = parse_count(&args.samples).map_err(|e| in_option("-n ", &e))?;
    let algorithm = algorithm(Algorithm::default(), args.variant.as_ref(), args.sequence.as_ref())?;
    let photometry = photometric::read_with(&args.file, args.lamp_set)?;
    check_outputs(args.output.as_slice(), std::slice::from_ref(&args.file))?;
    if !args.json {
        warn(&photometry.warnings);
    }
    let kind = photometry.web.photometric_type;
    let full = photometry.web.full_grid();
    let grid = Grid::new(&full.polar_rad, &full.azimuth_rad, &full.intensity_cd)
        .map_err(|e| e.in_file(&args.file))?;
    let density = Density::new(&photometry.web).map_err(|e| e.in_file(&args.file))?;
    let mut judge = Judge::new(&density, made_from(algorithm.sequence));
    let mut first = |sink: &mut dyn FnMut(&[Sampled]) -> bool| {
        sample(&grid, &algorithm, args.seed, 0, number, |block| {
            block.iter().for_each(|s| judge.draw(s.draw));
            sink(block)
        })
    };
    let mut effort = match &args.output {
        None => first(&mut |_| true)?,
        Some(path) => write_directions(path, kind, first)?,
    };
    let each = number / u64::from(REPLICATES);
    let is_repeatable =
        made_from(algorithm.sequence) == PointKind::LowDiscrepancy && algorithm.sequence.is_randomised();
    if is_repeatable && each >= LEAST_REPLICATE {
        for replicate in 1..=REPLICATES {
            let mut draws = Vec::new();
            let more = sample(&grid, &algorithm, args.seed, replicate, each, |block| {
                draws.extend(block.iter().map(|s| s.draw));
                true
            })?;
            judge.replicate(draws);
            effort = effort.with(more);
        }
    }
    Ok(CertificateReport {
        file: photometry.file.clone(),
        photometric_type: kind.name(),
        variant: algorithm.name(),
        sequence: algorithm.sequence.name(),
        seed: args.seed,
        certificate: judge.certificate(),
        points_per_sample: effort.points as f64 / effort.draws.max(1) as f64,
        ns_per_sample: effort.ns_per_draw(),
        warnings: photometry.warnings.iter().map(ToString::to_string).collect(),
        description: algorithm.description(),
    })
}

/// Writes the directions that `first` hands over, block by block, as CSV. Nothing is written where it fails.
///
/// Columns: `index` from 0; `vertical_deg`, `horizontal_deg` in the file's own photometric convention, symmetry unfolded; the
/// unit vector `x,y,z` along (r, u, -a) of docs/PHOTOMETRIC_FRAME.md, which is the world of a lamp that hangs (aim -z, up +y);
/// the coordinates that the sample took.
fn write_directions(
    path: &Path,
    kind: PhotometricType,
    first: impl FnOnce(&mut dyn FnMut(&[Sampled]) -> bool) -> Result<Effort>,
) -> Result<Effort> {
    let mut outcome = Ok(Effort::default());
    let written = write_atomically(path, |out| {
        out.write_all(b"index,vertical_deg,horizontal_deg,x,y,z,coordinates\n")?;
        let axes = AimFrame::new(DVec3::NEG_Z, Some(DVec3::Y))
            .and_then(|frame| grid_axes(kind, frame))
            .map_err(|e| io::Error::other(e.to_string()))?;
        let (mut index, mut rows) = (0u64, Ok(()));
        outcome = first(&mut |block| {
            rows = block.iter().try_for_each(|Sampled { draw, direction }| {
                let (vertical, horizontal) = file_angles_deg(kind, draw.theta_rad, draw.phi_rad);
                let DVec3 { x, y, z } = axes * *direction;
                writeln!(out, "{index},{vertical},{horizontal},{x},{y},{z},{}", draw.coordinates)?;
                index += 1;
                Ok(())
            });
            rows.is_ok()
        });
        match &outcome {
            Ok(_) => rows,
            Err(error) => Err(io::Error::other(error.to_string())),
        }
    });
    let effort = outcome?;
    written.map(|()| effort)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::certificate::Draw;

    #[test]
    fn a_certificate_that_fails_is_exit_1_and_told() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/ies/downlight.ies");
        let photometry = photometric::read(file).unwrap();
        let density = Density::new(&photometry.web).unwrap();
        let judged = |theta_rad: f64| {
            let mut judge = Judge::new(&density, PointKind::Random);
            // All in one direction, whatever the file says.
            (0..if theta_rad > 0.0 { 1000 } else { 0 })
                .for_each(|_| judge.draw(Draw { theta_rad, phi_rad: 1.0, coordinates: 2 }));
            judge.certificate()
        };
        assert_eq!(verdict(&judged(0.0)), exit::DONE);
        let failed = judged(0.7);
        assert_eq!(verdict(&failed), exit::WRONG);
        let told = failed.failures().join("\n");
        assert!(told.contains("chi-square (counts of the table's cells): corrected p below 1e-15"), "{told}");
        let report = CertificateReport {
            file: file.to_owned(),
            photometric_type: "C",
            variant: "mc".to_owned(),
            sequence: "independent",
            seed: 1,
            certificate: failed,
            points_per_sample: 1.0,
            ns_per_sample: 1.0,
            warnings: Vec::new(),
            description: String::new(),
        };
        assert!(report.text().contains("FAILED  counts of the table's cells"));
        assert!(report.text().ends_with("certificate       FAILED\n"));
        assert!(json(&report).unwrap().contains("\"passed\": false"));
    }
}
