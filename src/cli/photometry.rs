//! `caustix photometry`: what a lighting engineer wants to read about files, and files of one format as
//! another.

use std::path::PathBuf;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_bytes;
use crate::files::converted::{ExportFormat, photometric_file};
use crate::files::outputs::check_outputs;
use crate::files::photometric::read_with;
use crate::photometry::export::Export;
use crate::photometry::sheet::klm;
use crate::photometry::{Photometry, Summary};
use crate::plot::{candela, isocandela};
use crate::report::json::json;
use crate::report::photometry::{conversion, text};
use crate::report::photometry_rows::{CSV_HEAD, candela_csv, row_csv, table};

use super::{Done, PhotometryArgs, exit, in_option, plot, print, say, warn};

/// Runs the subcommand; the exit code.
pub(super) fn run(args: &PhotometryArgs) -> Done {
    match args.files.as_slice() {
        [_] => one(args),
        files => several(args, files),
    }
}

fn one(args: &PhotometryArgs) -> Done {
    let file = &args.files[0];
    let outputs: Vec<PathBuf> =
        [&args.plot, &args.iso, &args.output].into_iter().flatten().cloned().collect();
    check_outputs(&outputs, std::slice::from_ref(file))?;
    let photometry = read_with(file, args.lamp_set)?;
    let summary = Summary::new(&photometry);
    let klm = if args.per_klm { Some(per_klm(&photometry, &summary)?) } else { None };
    plot(args.plot.as_ref(), "--plot", file, || candela::drawing(&photometry, &summary))?;
    plot(args.iso.as_ref(), "--iso", file, || isocandela::drawing(&photometry, &summary))?;
    if !args.json {
        warn(&photometry.warnings);
    }
    if args.json {
        print(&json(&summary)?);
    } else if args.csv {
        print(&candela_csv(&photometry, klm.unwrap_or(1.0)));
    } else if args.to.is_none() {
        print(&text(&photometry, &summary, klm));
    }
    if let Some(to) = &args.to {
        let told = convert(args, to, &photometry)?;
        if args.json || args.csv { told.lines().for_each(say) } else { print(&told) }
    }
    Ok(exit::DONE)
}

/// Thousands of lumens that `--per-klm` divides by.
fn per_klm(photometry: &Photometry, summary: &Summary) -> Result<f64> {
    klm(photometry, summary.flux_lm).ok_or_else(|| {
        let found = format!("--per-klm of {}, whose lamps have 0 lm", photometry.file);
        Diagnostic::new(Kind::Range, found, "lamps with lumens, or absolute photometry with light")
    })
}

/// Writes the luminaire as `--to` says; what is to be said of it.
fn convert(args: &PhotometryArgs, to: &str, photometry: &Photometry) -> Result<String> {
    let target = ExportFormat::from_name(to).ok_or_else(|| {
        let required = "one of: ies (LM-63-2002), ies2019, ldt (EULUMDAT)";
        Diagnostic::new(Kind::Unknown, format!("--to {to}"), required)
    })?;
    let Some(path) = &args.output else {
        return Err(Diagnostic::new(
            Kind::Missing,
            format!("--to {to} without -o"),
            "the file to write: -o FILE",
        ));
    };
    let mut export = Export::of(photometry)?;
    if let Some(by_deg) = args.turn {
        export.turn(by_deg).map_err(|d| in_option("--turn ", &d))?;
    }
    if let Some(flux_lm) = args.flux {
        export.scale_to(flux_lm).map_err(|d| in_option("--flux ", &d))?;
    }
    let written = photometric_file(&export, target).map_err(|d| d.in_file(&photometry.file))?;
    write_bytes(path, &written.bytes)?;
    Ok(conversion(&export, &written, target.name(), path))
}

/// A row for each file. Those that cannot be read are told, and cost no other.
fn several(args: &PhotometryArgs, files: &[PathBuf]) -> Done {
    let single =
        [("--plot", args.plot.is_some()), ("--iso", args.iso.is_some()), ("--to", args.to.is_some())];
    if let Some((option, _)) = single.iter().find(|(_, is_asked)| *is_asked) {
        let found = format!("{option} with {} files", files.len());
        return Err(Diagnostic::new(Kind::Range, found, format!("one file with {option}")).into());
    }
    let (mut summaries, mut failed) = (Vec::new(), false);
    for file in files {
        match read_with(file, args.lamp_set) {
            Ok(photometry) => {
                if !args.json {
                    warn(&photometry.warnings);
                }
                summaries.push(Summary::new(&photometry));
            }
            Err(error) => {
                failed = true;
                say(&format!("error: {error}"));
            }
        }
    }
    if args.json {
        print(&json(&summaries)?);
    } else if args.csv {
        print(&summaries.iter().fold(CSV_HEAD.to_owned(), |out, summary| out + &row_csv(summary)));
    } else {
        print(&table(&summaries));
    }
    Ok(if failed { exit::WRONG } else { exit::DONE })
}
