//! The blocks of a photometric report that are tables: zonal lumens, flux code, luminances.

use crate::photometry::luminance::LuminanceTable;
use crate::photometry::web::Symmetry;
use crate::photometry::zones::{ZonalLumens, Zone};
use crate::photometry::{Photometry, Summary};

use super::numbers::three_digits;

/// Width of the names at the left.
const NAMES: usize = 20;

/// The blocks as lines, without line ends. What a table does not define is left out; the JSON says why.
pub fn lines(photometry: &Photometry, summary: &Summary) -> Vec<String> {
    let sheet = &summary.sheet;
    let mut lines = Vec::new();
    let mut line =
        |name: &str, value: String| lines.push(format!("{name:<NAMES$}{value}").trim_end().to_owned());
    if let Some(zonal) = &sheet.zonal_lumens {
        for (i, zone) in zonal.zones.iter().enumerate() {
            line(if i == 0 { "zonal lumens" } else { "" }, told(zone));
        }
        tens(zonal)
            .into_iter()
            .enumerate()
            .for_each(|(i, row)| line(if i == 0 { "in tens" } else { "" }, row));
    }
    if let Some(code) = sheet.cie_flux_code {
        let word = |part: Option<f64>| part.map_or("-".to_owned(), |percent| format!("{percent:.0}"));
        line("CIE flux code", format!("{:>12}", code.map(word).join(" ")));
    }
    if let Some(nema) = &sheet.nema_type {
        let [first, second] = nema.types;
        let [one, other] = nema.planes;
        line("NEMA type", format!("{:>12}      {one} x {other}", format!("{first} x {second}")));
    }
    if let Some(table) = &sheet.luminance {
        luminances(table, photometry).into_iter().enumerate().for_each(|(i, row)| {
            line(if i == 0 { "luminance (cd/m2)" } else { "" }, row);
        });
    }
    lines
}

/// `0- 30 deg      812.3 lm   25.9 %`.
fn told(zone: &Zone) -> String {
    let percent = zone.percent.map_or(String::new(), |percent| format!("{percent:>8.1} %"));
    format!("{:>12.1} lm {percent}   {:>3}-{} deg", zone.flux_lm, zone.from_deg, zone.to_deg)
}

/// Tens of degrees, those below the horizontal beside those above where there are any.
fn tens(zonal: &ZonalLumens) -> Vec<String> {
    let (below, above) = zonal.tens.split_at(9);
    let has_above = above.iter().any(|zone| zone.flux_lm > 0.0);
    let rows = below.iter().zip(above);
    rows.map(|(low, high)| if has_above { format!("{}   {}", told(low), told(high)) } else { told(low) })
        .collect()
}

/// Rows of gamma, columns of C: as many planes as the symmetry of the table leaves to be told.
fn luminances(table: &LuminanceTable, photometry: &Photometry) -> Vec<String> {
    let last = match photometry.web.symmetry() {
        Symmetry::Rotational | Symmetry::Quadrants => 90.0,
        Symmetry::Bilateral0To180 => 180.0,
        _ => 360.0,
    };
    let planes: Vec<f64> = table.c_deg.iter().copied().filter(|&c| c <= last && c % 45.0 == 0.0).collect();
    let head = planes.iter().map(|c| format!("{:>11}", format!("C{c}"))).collect::<String>();
    let row = |&gamma: &f64| {
        let cell = |&c: &f64| format!("{:>11}", table.at(c, gamma).map_or("-".to_owned(), three_digits));
        format!("  gamma {gamma}{}", planes.iter().map(cell).collect::<String>())
    };
    [format!("          {head}")].into_iter().chain(table.gamma_deg.iter().map(row)).collect()
}
