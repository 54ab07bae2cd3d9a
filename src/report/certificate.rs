//! What `caustix sample` says: the certificate that directions have the density of a photometric file.

use std::fmt::Write;

use serde::Serialize;

use crate::lab::certificate::{Certificate, PointKind, TestName};

use super::numbers::grouped;

/// Everything that `--json` says. Names are a contract: they are only added to.
#[derive(Debug, Serialize)]
pub struct CertificateReport {
    /// The photometric file, as given.
    pub file: String,
    /// "A", "B" or "C".
    pub photometric_type: &'static str,
    /// Algorithm variant.
    pub variant: String,
    /// Point sequence.
    pub sequence: &'static str,
    /// Seed of the randomisation.
    pub seed: u64,
    /// The tests and their verdict.
    #[serde(flatten)]
    pub certificate: Certificate,
    /// Points of the sequence for each sample: more than one where rejection goes on with the next point.
    pub points_per_sample: f64,
    /// Time of a sample, ns.
    pub ns_per_sample: f64,
    /// Warnings about the file.
    pub warnings: Vec<String>,
    /// The variant in words.
    #[serde(skip)]
    pub description: String,
}

impl CertificateReport {
    /// The certificate for a terminal.
    pub fn text(&self) -> String {
        let certificate = &self.certificate;
        let mut out = String::new();
        let mut line = |name: &str, value: String| {
            let _infallible = writeln!(out, "{name:<18}{value}");
        };
        line("file", format!("{}, type {}", self.file, self.photometric_type));
        line("variant", format!("{}: {}", self.variant, self.description));
        let mut samples = format!("{}, seed {}", grouped(certificate.draws), self.seed);
        if certificate.replicates > 0 {
            let each = grouped(certificate.replicate_draws / u64::from(certificate.replicates));
            let _infallible =
                write!(samples, "; for the cell means {} x {each} more", certificate.replicates);
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
        let points = match self.points_per_sample {
            1.0 => String::new(),
            more => format!(", {more:.3} points of the sequence"),
        };
        line("time", format!("{:.0} ns a sample{points}", self.ns_per_sample));
        let d = certificate.discrepancy;
        line(
            "discrepancy",
            format!(
                "{:.3} of that of random points: L2-star {:.2e}, random {:.2e}",
                d.ratio, d.l2_star, d.random
            ),
        );
        out.push('\n');
        let _infallible =
            writeln!(out, "{:<18}{:>12} {:>8} {:>9} {:>9}", "test", "statistic", "degrees", "p", "corrected");
        for test in &certificate.tests {
            let degrees = test.degrees.map(|d| d.to_string()).unwrap_or_default();
            let statistic = statistic(test.name, test.statistic);
            let verdict = if test.passed { "passed" } else { "FAILED" };
            let (p, corrected) = (chance(test.p_value), chance(test.p_corrected));
            let what = test.what;
            let _infallible = writeln!(
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
        let _infallible = writeln!(out, "certificate       {verdict}");
        out
    }
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
