//! `caustix sample`: directions of a photometric file, and the certificate that they have its density.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use glam::{DMat3, DVec3};
use serde::Serialize;

use crate::emitter::AimFrame;
use crate::emitter::photometric::grid_axes;
use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_atomically;
use crate::files::lm63;
use crate::files::scene_toml::count::parse_count;
use crate::lab::certificate::density::file_angles_deg;
use crate::lab::certificate::sampler::{Effort, Sampled, made_from, sample};
use crate::lab::certificate::{Certificate, Density, Judge, PointKind, REPLICATES, TestName};
use crate::photometry::PhotometricType;
use crate::report::text::grouped;
use crate::run::{Algorithm, Variant};
use crate::sample::grid::Grid;
use crate::sequence::Sequence;

use super::{SampleArgs, exit, fail, print, say, warn};

/// Fewest points of a randomisation for the test of cell means.
const LEAST_REPLICATE: u64 = 64;

/// Runs the subcommand; the exit code.
pub fn run(args: &SampleArgs) -> u8 {
    match certify(args) {
        Ok(report) => {
            match if args.json { json(&report) } else { Ok(text(&report)) } {
                Ok(text) => print(&text),
                Err(error) => return fail(&[error]),
            }
            verdict(&report.certificate)
        }
        Err(error) => fail(&[error]),
    }
}

/// The exit code of a certificate; what failed is said.
fn verdict(certificate: &Certificate) -> u8 {
    for failure in certificate.failures() {
        say(&format!("certificate failed: {failure}"));
    }
    if certificate.passed { exit::DONE } else { exit::WRONG }
}

/// Everything that `--json` says. Names are a contract: they are only added to.
#[derive(Debug, Serialize)]
struct Report {
    file: String,
    photometric_type: &'static str,
    variant: String,
    sequence: &'static str,
    seed: u64,
    #[serde(flatten)]
    certificate: Certificate,
    /// Points of the sequence for each sample: more than one where rejection goes on with the next point.
    points_per_sample: f64,
    ns_per_sample: f64,
    warnings: Vec<String>,
    #[serde(skip)]
    description: String,
}

fn certify(args: &SampleArgs) -> Result<Report> {
    let number = parse_count(&args.samples)
        .map_err(|e| Diagnostic::new(Kind::Range, format!("-n {}", e.found()), e.required().to_string()))?;
    let algorithm = algorithm(args)?;
    let photometry = lm63::read(&args.file)?;
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
    Ok(Report {
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

/// Writes the directions that `first` hands over, block by block. Nothing is written where it fails.
fn write_directions(
    path: &Path,
    kind: PhotometricType,
    first: impl FnOnce(&mut dyn FnMut(&[Sampled]) -> bool) -> Result<Effort>,
) -> Result<Effort> {
    let mut outcome = Ok(Effort::default());
    let written = write_atomically(path, |out| {
        let mut table = Table::new(out, kind)?;
        let mut rows = Ok(());
        outcome = first(&mut |block| {
            rows = table.rows(block);
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

fn algorithm(args: &SampleArgs) -> Result<Algorithm> {
    let mut algorithm = match args.variant.as_deref() {
        Some(name) => Algorithm::parse(name)?,
        None => Algorithm::from(Variant::QmcInverseReuse),
    };
    if let Some(name) = args.sequence.as_deref() {
        algorithm.sequence = Sequence::from_name(name).ok_or_else(|| {
            let names: Vec<_> = Sequence::ALL.iter().map(|s| s.name()).collect();
            let required = format!("one of: {}", names.join(", "));
            Diagnostic::new(Kind::Unknown, format!("--sequence {name}"), required)
        })?;
    }
    Ok(algorithm)
}

/// The directions as CSV: `index` from 0; `vertical_deg`, `horizontal_deg` in the file's own photometric convention,
/// symmetry unfolded; the unit vector `x,y,z` along (r, u, -a) of docs/PHOTOMETRIC_FRAME.md, which is the world of a lamp
/// that hangs (aim -z, up +y); the coordinates that the sample took.
struct Table<'w, W> {
    out: &'w mut W,
    kind: PhotometricType,
    axes: DMat3,
    index: u64,
}

impl<'w, W: Write> Table<'w, W> {
    fn new(out: &'w mut W, kind: PhotometricType) -> io::Result<Self> {
        out.write_all(b"index,vertical_deg,horizontal_deg,x,y,z,coordinates\n")?;
        let axes = AimFrame::new(DVec3::NEG_Z, Some(DVec3::Y))
            .and_then(|frame| grid_axes(kind, frame))
            .map_err(|e| io::Error::other(e.to_string()))?;
        Ok(Self { out, kind, axes, index: 0 })
    }

    fn rows(&mut self, block: &[Sampled]) -> io::Result<()> {
        for Sampled { draw, direction } in block {
            let (vertical, horizontal) = file_angles_deg(self.kind, draw.theta_rad, draw.phi_rad);
            let DVec3 { x, y, z } = self.axes * *direction;
            writeln!(self.out, "{},{vertical},{horizontal},{x},{y},{z},{}", self.index, draw.coordinates)?;
            self.index += 1;
        }
        Ok(())
    }
}

fn json(report: &Report) -> Result<String> {
    let text = serde_json::to_string_pretty(report).map_err(|e| {
        Diagnostic::new(Kind::Io, format!("\"{e}\" while writing JSON"), "numbers that JSON can hold")
    })?;
    Ok(text + "\n")
}

/// The certificate for a terminal.
fn text(report: &Report) -> String {
    let Report { certificate, .. } = report;
    let mut out = String::new();
    let mut line = |name: &str, value: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{name:<18}{value}");
    };
    line("file", format!("{}, type {}", report.file, report.photometric_type));
    line("variant", format!("{}: {}", report.variant, report.description));
    let mut samples = format!("{}, seed {}", grouped(certificate.draws), report.seed);
    if certificate.replicates > 0 {
        let each = grouped(certificate.replicate_draws / u64::from(certificate.replicates));
        let _ = write!(samples, "; for the cell means {} x {each} more", certificate.replicates);
    }
    line("samples", samples);
    let cells = certificate.cells;
    let dark = match certificate.draws_in_zero_cells {
        0 => "dark and empty".into(),
        n => format!("dark, {} samples in them", grouped(n)),
    };
    line("table", format!("{} cells, {} {dark}; {} pools", cells.table, cells.zero, cells.pooled));
    let used = certificate.coordinates;
    line("coordinates", format!("{:.4} a sample, at most {}", used.mean, used.max));
    let points = match report.points_per_sample {
        1.0 => String::new(),
        more => format!(", {more:.3} points of the sequence"),
    };
    line("time", format!("{:.0} ns a sample{points}", report.ns_per_sample));
    let d = certificate.discrepancy;
    line(
        "discrepancy",
        format!(
            "{:.3} of that of random points: L2-star {:.2e}, random {:.2e}",
            d.ratio, d.l2_star, d.random
        ),
    );
    out.push('\n');
    let _ = writeln!(out, "{:<18}{:>12} {:>8} {:>9} {:>9}", "test", "statistic", "degrees", "p", "corrected");
    for test in &certificate.tests {
        let degrees = test.degrees.map(|d| d.to_string()).unwrap_or_default();
        let statistic = statistic(test.name, test.statistic);
        let verdict = if test.passed { "passed" } else { "FAILED" };
        let (p, corrected) = (chance(test.p_value), chance(test.p_corrected));
        let what = test.what;
        let _ = writeln!(
            out,
            "{:<18}{statistic:>12} {degrees:>8} {p:>9} {corrected:>9}  {verdict}  {what}",
            test.name
        );
    }
    out.push('\n');
    out.push_str(match certificate.points {
        PointKind::Random => "Expected is the file's own candela, integrated by quadrature. The p-values hold.\n",
        PointKind::LowDiscrepancy => {
            "Expected is the file's own candela, integrated by quadrature. The points are no random points: p-values of\n\
             counts, KS and discrepancy are what random points would do, an upper bound; those of cell means hold.\n"
        }
    });
    let verdict = if certificate.passed { "passed" } else { "FAILED" };
    let _ = writeln!(out, "certificate       {verdict}");
    out
}

fn statistic(name: TestName, value: f64) -> String {
    match name {
        TestName::LargestCell => format!("{value:+.3} %"),
        TestName::ChiSquare => format!("{value:.1}"),
        TestName::CellMeans => format!("{value:+.2}"),
        _ => format!("{value:.6}"),
    }
}

/// A chance as a short number.
fn chance(p: f64) -> String {
    if p >= 1e-4 {
        format!("{p:.4}")
    } else if p < 1e-15 {
        "< 1e-15".into()
    } else {
        format!("{p:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::certificate::Draw;

    #[test]
    fn a_certificate_that_fails_is_exit_1_and_told() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/ies/downlight.ies");
        let photometry = lm63::read(file).unwrap();
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
        let report = Report {
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
        assert!(text(&report).contains("FAILED  counts of the table's cells"));
        assert!(text(&report).ends_with("certificate       FAILED\n"));
        assert!(json(&report).unwrap().contains("\"passed\": false"));
    }
}
