//! `caustix bsdf`: what a scattering table holds, and whether it keeps to energy and reciprocity.

use crate::files::bsdf::{Format, MAX_FILE_BYTES, parse};
use crate::files::bytes::read_capped;
use crate::plot::bsdf::drawing;
use crate::report::bsdf::BsdfSummary;
use crate::report::json::json;

use super::{BsdfArgs, Done, exit, plot, print, warn};

/// Runs the subcommand; the exit code.
pub(super) fn run(args: &BsdfArgs) -> Done {
    let name = args.file.display().to_string();
    let bytes = read_capped(&args.file, MAX_FILE_BYTES).map_err(|e| e.in_file(&args.file))?;
    let format = Format::of(&bytes, &name)?;
    let table = parse(&bytes, &name)?;
    let summary = BsdfSummary::new(&table, &name, format.name());
    plot(args.plot.as_ref(), "--plot", &args.file, || drawing(&table, &summary))?;
    if args.json {
        print(&json(&summary)?);
    } else {
        warn(&table.warnings);
        print(&summary.text());
    }
    Ok(exit::DONE)
}
