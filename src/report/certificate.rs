//! What `caustix sample` says: the certificate that directions have the density of a photometric file.

use std::fmt::Write;

use serde::Serialize;

use crate::lab::certificate::{Cells, Certificate, CoordinatesUsed, Discrepancy, PointKind, TestName};

use super::numbers::{grouped, written};

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
        written(|out| self.write(out))
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        let certificate = &self.certificate;
        let Cells { table, zero, pooled } = certificate.cells;
        let Discrepancy { ratio, l2_star, random, .. } = certificate.discrepancy;
        let CoordinatesUsed { mean, max } = certificate.coordinates;
        let more = match certificate.replicates {
            0 => String::new(),
            n => {
                let each = grouped(certificate.replicate_draws / u64::from(n));
                format!("; for the cell means {n} x {each} more")
            }
        };
        let dark = match certificate.draws_in_zero_cells {
            0 => "dark and empty".into(),
            n => format!("dark, {} samples in them", grouped(n)),
        };
        let points = match self.points_per_sample {
            1.0 => String::new(),
            more => format!(", {more:.3} points of the sequence"),
        };
        writeln!(out, "file              {}, type {}", self.file, self.photometric_type)?;
        // The solver stands in the description.
        let variant = self.variant.split(':').next().unwrap_or_default();
        writeln!(out, "variant           {variant}: {}", self.description)?;
        writeln!(out, "samples           {}, seed {}{more}", grouped(certificate.draws), self.seed)?;
        writeln!(out, "table             {table} cells, {zero} {dark}; {pooled} pools")?;
        writeln!(out, "coordinates       {mean:.4} a sample, at most {max}")?;
        writeln!(out, "time              {:.0} ns a sample{points}", self.ns_per_sample)?;
        writeln!(
            out,
            "discrepancy       {ratio:.3} of that of random points: L2-star {l2_star:.2e}, random {random:.2e}"
        )?;
        writeln!(out, "\ntest                 statistic  degrees         p corrected")?;
        let verdict = |passed: bool| if passed { "passed" } else { "FAILED" };
        for test in &certificate.tests {
            let degrees = test.degrees.map(|d| d.to_string()).unwrap_or_default();
            let (name, statistic) = (test.name, statistic(test.name, test.statistic));
            let (p, corrected) = (chance(test.p_value), chance(test.p_corrected));
            let (verdict, what) = (verdict(test.passed), test.what);
            writeln!(out, "{name:<18}{statistic:>12} {degrees:>8} {p:>9} {corrected:>9}  {verdict}  {what}")?;
        }
        writeln!(
            out,
            "\n{}",
            match certificate.points {
                PointKind::Random =>
                    "Expected is the file's own candela, integrated by quadrature. The p-values hold.",
                PointKind::LowDiscrepancy => {
                    "Expected is the file's own candela, integrated by quadrature. The points are no random points: p-values of\n\
                 counts, KS and discrepancy are what random points would do, an upper bound; those of cell means hold."
                }
            }
        )?;
        writeln!(out, "certificate       {}", verdict(certificate.passed))
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
