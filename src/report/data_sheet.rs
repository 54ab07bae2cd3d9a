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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::photometric;

    fn lines_of(text: &str) -> Vec<String> {
        let photometry = photometric::parse(text.as_bytes(), "a.ies").unwrap();
        lines(&photometry, &Summary::new(&photometry))
    }

    #[test]
    fn what_goes_up_stands_beside_what_goes_down() {
        // 100 cd everywhere, from a sphere of 0.2 m: 2 pi 100 (1 - cos 10 degrees) lm to 10 degrees on both sides;
        // 100 cd over pi 0.01 m2.
        let all = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 -0.2 -0.2 -0.2\n1 1 0\n0 180\n0\n100 100\n";
        let lines = lines_of(all);
        for line in [
            "in tens                      9.5 lm      0.8 %     0-10 deg          109.1 lm      8.7 %    90-100 deg",
            "                           109.1 lm      8.7 %    80-90 deg            9.5 lm      0.8 %   170-180 deg",
            "CIE flux code       25 50 75 50 100",
            "luminance (cd/m2)                      C0        C45        C90",
            "                      gamma 85       3183       3183       3183",
        ] {
            assert!(lines.iter().any(|l| l == line), "{line}\n{}", lines.join("\n"));
        }
        // Of type B neither zones nor a code: the class alone.
        let flood =
            lines_of("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 2 2 2 0 0 0\n1 1 0\n-90 90\n-90 90\n1 1 1 1\n");
        assert_eq!(flood, ["NEMA type                  7 x 7      H x V"]);
    }
}
