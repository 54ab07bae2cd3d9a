//! `caustix photometry`: what a lighting engineer wants to read about a file.

use crate::files::photometric;
use crate::photometry::Summary;
use crate::plot::candela;
use crate::report::json::json;
use crate::report::photometry::text;

use super::{Done, PhotometryArgs, exit, plot, print, warn};

/// Runs the subcommand; the exit code.
pub(super) fn run(args: &PhotometryArgs) -> Done {
    let photometry = photometric::read_with(&args.file, args.lamp_set)?;
    let summary = Summary::new(&photometry);
    plot(args.plot.as_ref(), &args.file, || candela::drawing(&photometry, &summary))?;
    if args.json {
        print(&json(&summary)?);
    } else {
        warn(&photometry.warnings);
        print(&text(&photometry, &summary));
    }
    Ok(exit::DONE)
}
