//! `caustix bsdf`: what a scattering table holds, and whether it keeps to energy and reciprocity.

use std::io::Write;
use std::path::Path;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_atomically;
use crate::files::bsdf::Format;
use crate::files::bytes::read_capped;
use crate::report::bsdf::BsdfSummary;
use crate::report::bsdf_plot::BsdfPlot;
use crate::report::text::rounded;
use crate::scattering::ScatterTable;

use super::{BsdfArgs, exit, fail, print, warn};

/// Runs the subcommand; the exit code.
pub fn run(args: &BsdfArgs) -> u8 {
    match show(args) {
        Ok(()) => exit::DONE,
        Err(error) => fail(&[error]),
    }
}

fn show(args: &BsdfArgs) -> Result<()> {
    let name = args.file.display().to_string();
    let bytes =
        read_capped(&args.file, crate::files::bsdf::MAX_FILE_BYTES).map_err(|e| e.in_file(&args.file))?;
    let format = Format::of(&bytes, &name)?;
    let table = crate::files::bsdf::parse(&bytes, &name)?;
    let summary = BsdfSummary::new(&table, &name, format.name());
    if let Some(path) = &args.plot {
        plot(path, &table, &summary)?;
    }
    if args.json {
        let text = serde_json::to_string_pretty(&summary).map_err(|e| {
            Diagnostic::new(Kind::Io, format!("\"{e}\" while writing JSON"), "numbers that JSON can hold")
        })?;
        print(&(text + "\n"));
    } else {
        warn(&table.warnings);
        print(&summary.text());
    }
    Ok(())
}

/// Writes the polar diagram; the ending of the name says as what.
fn plot(path: &Path, table: &ScatterTable, summary: &BsdfSummary) -> Result<()> {
    // A table without a name of its own is called by its path.
    let title = if summary.name == summary.file {
        Path::new(&summary.file)
            .file_name()
            .map_or_else(|| summary.file.clone().into(), |n| n.to_string_lossy())
    } else {
        summary.name.as_str().into()
    };
    let plot = BsdfPlot::new(table, &title, footer(summary));
    let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("svg") => write_atomically(path, |out| out.write_all(plot.to_svg().as_bytes())),
        Some("png") => plot.to_png(path),
        _ => Err(Diagnostic::new(
            Kind::Range,
            format!("--plot {}", path.display()),
            "a name ending in .svg or .png",
        )),
    }
}

fn footer(summary: &BsdfSummary) -> Vec<String> {
    let most = |energy: &crate::report::bsdf::EnergySummary| {
        format!(
            "largest albedo {} at {}\u{b0}",
            rounded(energy.max_albedo, 4),
            rounded(energy.theta_i_deg, 4)
        )
    };
    summary.energy.first().map(most).into_iter().collect()
}
