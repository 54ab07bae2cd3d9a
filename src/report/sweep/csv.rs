//! sweep.csv: a row a point.

use crate::lab::sweep::results::Sweep;
use crate::report::numbers::{bare, quoted};

/// The table as text: every number with all its digits, unknown ones empty; a row for each finished point, in the order of the
/// grid. Names of columns are a contract: the swept keys, `photons`, and of every figure `NAME`, `NAME:standard_error` and for each
/// key of several values `NAME:difference:KEY`, `NAME:difference_standard_error:KEY` and `NAME:error_ratio:KEY`.
pub fn csv(sweep: &Sweep) -> String {
    let axes = sweep.grid.axes();
    let stepped = sweep.stepped_axes();
    let mut header: Vec<String> = axes.iter().map(|axis| axis.key.clone()).collect();
    header.push("photons".to_owned());
    for name in &sweep.shown {
        header.extend([name.clone(), format!("{name}:standard_error")]);
        for axis in &stepped {
            let of = |what: &str| format!("{name}:{what}:{}", axes[*axis].key);
            header.extend(["difference", "difference_standard_error", "error_ratio"].map(of));
        }
    }
    let mut out = row(header.iter().map(|name| quoted(name)));
    for (point, figures) in sweep.points.iter().enumerate() {
        let Some(figures) = figures else { continue };
        let mut fields: Vec<String> =
            sweep.grid.values(point).map(|(_, value)| quoted(&value.shown)).collect();
        fields.push(figures.photons.to_string());
        for shown in 0..sweep.shown.len() {
            let figure = sweep.figure(point, shown);
            fields.push(bare(figure.and_then(|f| f.value)));
            fields.push(bare(figure.and_then(|f| f.standard_error)));
            for axis in &stepped {
                let difference = sweep.difference(point, shown, *axis);
                fields.push(bare(difference.map(|d| d.value)));
                fields.push(bare(difference.and_then(|d| d.standard_error)));
                fields.push(bare(difference.and_then(|d| d.ratio())));
            }
        }
        out += &row(fields.into_iter());
    }
    out
}

fn row(fields: impl Iterator<Item = String>) -> String {
    fields.collect::<Vec<_>>().join(",") + "\n"
}
