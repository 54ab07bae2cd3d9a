//! What `caustix photometry` says: what a lighting engineer wants to read about a file.

use std::fmt::Write;
use std::path::Path;

use crate::files::decimal::DIGITS;
use crate::files::lm63::generation_type;
use crate::photometry::export::{Export, PhotometricFile};
use crate::photometry::{Format, Photometry, Revision, Summary, Tilt};

use super::data_sheet;
use super::numbers::printable;

/// The report for a terminal: one quantity a line, names aligned, units behind the numbers. Without the
/// warnings, which the command says on stderr. `klm`: thousands of lumens for which the maximum is told, too.
pub fn text(photometry: &Photometry, summary: &Summary, klm: Option<f64>) -> String {
    let mut out = String::new();
    let mut line = |name: &str, value: String| {
        let _infallible = writeln!(out, "{name:<20}{value}");
    };
    line("file", photometry.file.clone());
    line("format", format!("{}, type {}", format_and_edition(photometry), summary.photometric_type));
    for keyword in ["MANUFAC", "LUMINAIRE", "LUMCAT", "LAMP"] {
        if let Some(text) = photometry.label(keyword).filter(|text| !text.is_empty()) {
            line(&keyword.to_ascii_lowercase(), printable(text));
        }
    }
    line("flux", lumens(summary.flux_lm, "value x multiplier, trapezoid"));
    line("flux with factors", lumens(summary.flux_with_factors_lm, &factors(photometry)));
    line("flux emitted", lumens(summary.flux_emitted_lm, &distance(summary)));
    if let Some(declared) = summary.flux_declared_lm {
        line("flux declared", lumens(declared, &declared_how(photometry)));
    }
    if let Some(lumens_per_lamp) = photometry.lumens_per_lamp {
        let lamps = format!("{} x {} lm", photometry.lamps, lumens_per_lamp);
        let share =
            summary.light_output_ratio.map(|ratio| format!("; the table has {:.1} % of it", 100.0 * ratio));
        line("lamps", lamps + &share.unwrap_or_default());
    } else {
        line("lamps", format!("{}, absolute photometry", photometry.lamps));
    }
    if let Some(set) = photometry.lamp_sets.get(photometry.lamp_set) {
        let of = format!("{} of {}", photometry.lamp_set + 1, photometry.lamp_sets.len());
        let texts = [("", &set.kind), ("colour ", &set.colour), ("CRI ", &set.cri)];
        let texts = texts.iter().filter(|(_, text)| !text.is_empty());
        let texts: String = texts.map(|(name, text)| format!(", {name}{}", printable(text))).collect();
        line("lamp set", format!("{of}: {} lm{texts}", set.flux_lm));
    }
    let at = summary.max_at;
    let place = format!("at V {} deg, H {} deg", at.vertical_deg, at.horizontal_deg);
    line("maximum", format!("{:>12.1} cd   {place}", summary.max_candela));
    if let Some(klm) = klm {
        let of = if photometry.lumens_per_lamp.is_some() { "the lamps" } else { "the luminaire" };
        line(
            "per 1000 lm",
            format!("{:>12.1} cd/klm   for {:.1} lm of {of}", summary.max_candela / klm, 1e3 * klm),
        );
    }
    let planes = planes(summary);
    line("beam angle (50 %)", degrees([summary.beam_angle_deg, summary.beam_angle_across_deg], planes));
    line("field angle (10 %)", degrees([summary.field_angle_deg, summary.field_angle_across_deg], planes));
    if let Some(through) = plane_of_max(summary).filter(|_| planes.len() > 1) {
        let angle = |angle: Option<f64>| degrees([angle, None], &[&through]);
        line("beam at maximum", angle(summary.sheet.beam_angle_at_max_deg));
        line("field at maximum", angle(summary.sheet.field_angle_at_max_deg));
    }
    line(
        "angles",
        format!("{} vertical x {} horizontal", summary.vertical_angles, summary.horizontal_angles),
    );
    line("symmetry", summary.symmetry.to_owned());
    let [width, length, height] = summary.luminous_opening.size_m;
    let size = format!("{width:.3} x {length:.3} x {height:.3} m (width x length x height)");
    line("luminous opening", format!("{}, {size}", summary.luminous_opening.shape));
    if photometry.tilt != Tilt::None {
        line("tilt", tilt(photometry));
    }
    eulumdat(photometry, &mut line);
    match summary.efficacy_lm_w {
        Some(efficacy) => {
            line("input power", format!("{:>12.1} W    {efficacy:.1} lm/W", summary.input_watts))
        }
        None => line("input power", "not stated".to_owned()),
    }
    for line in data_sheet::lines(photometry, summary) {
        out.push_str(&line);
        out.push('\n');
    }
    out
}

/// What is said of a luminaire that was written in another format.
pub fn conversion(export: &Export, written: &PhotometricFile, format: &str, path: &Path) -> String {
    let mut out = String::new();
    let mut line = |name: &str, value: String| {
        let _infallible = writeln!(out, "{name:<20}{value}");
    };
    line("written", format!("{}, {format}", printable(&path.display().to_string())));
    line("flux", lumens(export.flux_lm(), "trapezoid; factors are in the intensities"));
    let (v, h) = (export.web().vertical_deg.len(), export.web().horizontal_deg.len());
    line("angles", format!("{v} vertical x {h} horizontal, {}", export.web().symmetry().name()));
    line("read back", format!("the same intensities, to {DIGITS} digits"));
    for note in export.notes.iter().chain(&written.notes) {
        line("note", printable(note));
    }
    out
}

/// The plane through the largest intensity, where it is none of the two that are told anyway.
fn plane_of_max(summary: &Summary) -> Option<String> {
    let (v, h) = (summary.max_at.vertical_deg, summary.max_at.horizontal_deg);
    match summary.photometric_type {
        "A" => (h != 0.0).then(|| format!("H = {h}")),
        "B" => (v != 0.0).then(|| format!("V = {v}")),
        _ => (h % 90.0 != 0.0 && v % 180.0 != 0.0).then(|| format!("C{h}-C{}", (h + 180.0) % 360.0)),
    }
}

fn format_and_edition(photometry: &Photometry) -> String {
    let name = photometry.format.name();
    let Some(revision) = photometry.format.revision() else { return name.to_owned() };
    let year = revision.name();
    match generation_type(&photometry.field12_text).filter(|_| revision == Revision::Y2019) {
        Some(kind) => format!("{name} {year} ({kind})"),
        None => format!("{name} {year}"),
    }
}

fn factors(photometry: &Photometry) -> String {
    let gear = match photometry.format {
        Format::Lm63(revision) if revision.field12_is_factor() => {
            format!("x ballast {} x ballast-lamp {}", photometry.ballast_factor, photometry.field12)
        }
        Format::Lm63(_) => format!("x ballast {}", photometry.ballast_factor),
        Format::Eulumdat => "EULUMDAT has none".to_owned(),
    };
    match photometry.untilted_factor() {
        Some(factor) if factor != 1.0 => format!("{gear} x tilt {factor}"),
        _ => gear,
    }
}

/// Where a declared flux comes from.
fn declared_how(photometry: &Photometry) -> String {
    match &photometry.eulumdat {
        Some(head) => format!("lumens of the lamp set x LORL {} %", head.light_output_ratio_percent),
        None => "[_TOTALLUMINAIRELUMENS]".to_owned(),
    }
}

/// What the tilt table does.
fn tilt(photometry: &Photometry) -> String {
    let Some(table) = photometry.tilt_table() else {
        return "a table that was not read: no factor".to_owned();
    };
    let (low, high) = table.factor_range();
    let taken = photometry.untilted_factor().unwrap_or(1.0);
    format!("factors {low} to {high} at {} deg; {taken} here, tilt_deg of an emitter chooses", table.range())
}

/// The lines that only EULUMDAT has.
fn eulumdat(photometry: &Photometry, line: &mut impl FnMut(&str, String)) {
    let Some(head) = &photometry.eulumdat else { return };
    let [length, width, height] = head.luminaire_size_m;
    line("luminaire size", format!("{length:.3} x {width:.3} x {height:.3} m (length x width x height)"));
    line("Ityp, Isym", format!("{}, {}", head.ityp, head.isym));
    line("conversion factor", head.conversion.to_string());
    line("measured at a tilt", format!("of {} deg (shown only)", head.measured_tilt_deg));
    line("downward declared", format!("{} % of the flux", head.downward_fraction_percent));
}

fn lumens(flux_lm: f64, how: &str) -> String {
    format!("{flux_lm:>12.1} lm   {how}")
}

/// What the emitted flux is, and how far from the trapezoid's.
fn distance(summary: &Summary) -> String {
    let how = "bilinear table, exact, with factors";
    match summary.flux_emitted_relative.map(|relative| 100.0 * relative) {
        Some(percent) => format!("{how}: {percent:+.2} % from the trapezoid"),
        None => how.to_owned(),
    }
}

/// The names of the planes in which angles are given; one where all planes are alike.
fn planes(summary: &Summary) -> &'static [&'static str] {
    match (summary.photometric_type, summary.symmetry) {
        ("C", "rotational") => &["all planes"],
        ("C", _) => &["C0-C180", "C90-C270"],
        _ => &["V = 0", "H = 0"],
    }
}

fn degrees(angles_deg: [Option<f64>; 2], planes: &[&str]) -> String {
    let dark = |plane: &&str| format!("{:>12}      {plane} (dark)", "none");
    let one = |(angle, plane): (Option<f64>, &&str)| {
        angle.map_or_else(|| dark(plane), |angle| format!("{angle:>12.1} deg  {plane}"))
    };
    angles_deg.into_iter().zip(planes).map(one).reduce(|a, b| format!("{a:<32}{b}")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::photometric;

    #[test]
    fn the_report_names_quantities_and_units() {
        let file = "IESNA91\n[LUMINAIRE] a\x1b[31mb\n[MORE] c\nTILT=NONE\n1 -1 2 3 1 1 2 -0.1 0 0\n0.5 0.9 10\n0 40 90\n0\n100 0 0 9\n";
        let photometry = photometric::parse(file.as_bytes(), "small.ies").unwrap();
        let report = text(&photometry, &Summary::new(&photometry), None);
        for line in [
            "luminaire           a [31mb c",
            "flux                       147.0 lm   value x multiplier, trapezoid",
            "flux with factors           66.1 lm   x ballast 0.5 x ballast-lamp 0.9",
            "maximum                    200.0 cd   at V 0 deg, H 0 deg",
            "beam angle (50 %)           40.0 deg  all planes",
            "luminous opening    disk, 0.100 x 0.100 x 0.000 m (width x length x height)",
            "input power                 10.0 W    6.6 lm/W",
            // 2 pi x 100 cd x (1 - cos of 10, 40 degrees), of 147.0 lm.
            "zonal lumens                84.2 lm     57.3 %     0-30 deg",
            "                           147.0 lm    100.0 %     0-90 deg",
            "in tens                      9.5 lm      6.5 %     0-10 deg",
            "NEMA type                  5 x 5      C0-C180 x C90-C270",
        ] {
            assert!(report.lines().any(|l| l == line), "{line}\n{report}");
        }
        assert!(!report.contains("surplus") && !report.contains('\u{1b}'), "{report}");
    }
}
