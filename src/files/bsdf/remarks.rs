//! What is worth saying about a table that was read: light below the horizon, light that is cut off, declared totals that
//! its values do not have.

use crate::error::{Diagnostic, Kind};
use crate::scattering::integral::{node_cosine, slice_albedo};
use crate::scattering::{Frame, Lobe, Quantity, ScatterTable};
use crate::units::LUMINANCE_OF_RGB;

/// Deviation of a declared total scatter from the table's own integral that is worth a warning.
const DECLARED_TOLERANCE: f64 = 0.01;

/// The warnings about one table.
pub(crate) fn remarks(table: &ScatterTable) -> Vec<Diagnostic> {
    let of_lobe = |lobe| [below_horizon(lobe), cut_off(lobe), radians(lobe), declared(lobe)];
    table.lobes.iter().flat_map(of_lobe).flatten().collect()
}

fn noun(lobe: &Lobe) -> &'static str {
    match lobe.quantity {
        Quantity::Reflection => "reflection",
        Quantity::Transmission => "transmission",
    }
}

/// Positive values at nodes of the first channel that look below the horizon.
fn below_horizon(lobe: &Lobe) -> Option<Diagnostic> {
    let azimuths = lobe.azimuth_deg.len();
    let (mut count, mut largest) = (0usize, 0.0f32);
    for (t, theta_i) in lobe.theta_i_deg.iter().enumerate() {
        let below: Vec<usize> = (0..lobe.polar_deg.len() * azimuths)
            .filter(|at| {
                let (polar, azimuth) = (lobe.polar_deg[at / azimuths], lobe.azimuth_deg[at % azimuths]);
                node_cosine(lobe.frame, *theta_i, polar, azimuth) < 0.0
            })
            .collect();
        for p in 0..lobe.phi_i_deg.len() {
            let slice = lobe.slice(0, p, t);
            for v in below.iter().map(|at| slice[*at]).filter(|v| *v > 0.0) {
                count += 1;
                largest = largest.max(v);
            }
        }
    }
    (count > 0).then(|| {
        let found =
            format!("{count} values of the {} below the horizon, up to {}/sr", noun(lobe), short(largest));
        Diagnostic::new(Kind::Range, found, "zero below the horizon").hint("they are taken as zero")
    })
}

/// Whether the last ring of polar angles still scatters light above the horizon: beyond it the table is zero.
fn cut_off(lobe: &Lobe) -> Option<Diagnostic> {
    let last_deg = *lobe.polar_deg.last()?;
    if lobe.frame == Frame::Surface && last_deg >= 90.0 {
        return None;
    }
    let azimuths = lobe.azimuth_deg.len();
    let first = (lobe.polar_deg.len() - 1) * azimuths;
    let mut largest = 0.0f32;
    for (t, theta_i) in lobe.theta_i_deg.iter().enumerate() {
        for p in 0..lobe.phi_i_deg.len() {
            for (v, a) in lobe.slice(0, p, t)[first..].iter().zip(&lobe.azimuth_deg) {
                if node_cosine(lobe.frame, *theta_i, last_deg, *a) > 0.0 {
                    largest = largest.max(*v);
                }
            }
        }
    }
    (largest > 0.0 && last_deg < 180.0).then(|| {
        let found =
            format!("a {} that ends at {last_deg} degrees with up to {}/sr", noun(lobe), short(largest));
        Diagnostic::new(Kind::Range, found, "angles up to the horizon")
            .hint("nothing is scattered beyond the last polar angle")
    })
}

/// Angles that end where a right angle or half a turn in radians is: 1.3 to 1.58 are 75 to 90 degrees.
fn radians(lobe: &Lobe) -> Option<Diagnostic> {
    /// Fewer angles than these may well lie all near the normal.
    const FEWEST: usize = 4;
    let ends_so = |angles: &&(&[f64], &str)| {
        let last = angles.0.last().copied().unwrap_or_default();
        angles.0.len() >= FEWEST && ((1.3..1.58).contains(&last) || (3.1..3.15).contains(&last))
    };
    let lists = [(&lobe.theta_i_deg[..], "theta_i"), (&lobe.polar_deg[..], "polar angles")];
    let (angles, what) = lists.iter().find(ends_so)?;
    let last = angles.last()?;
    let found = format!("{what} of the {} that end at {last} degrees", noun(lobe));
    let d = Diagnostic::new(Kind::Range, found, "angles in degrees");
    Some(d.hint(format!("radians? {last} radians are {:.1} degrees", last.to_degrees())))
}

/// The declared total scatter that differs most from the table's integral.
fn declared(lobe: &Lobe) -> Option<Diagnostic> {
    let weights: &[f64] = if lobe.channels == 3 { &LUMINANCE_OF_RGB } else { &[1.0] };
    let mut worst: Option<(f64, String)> = None;
    for p in 0..lobe.phi_i_deg.len() {
        for (t, theta_i) in lobe.theta_i_deg.iter().enumerate() {
            let Some(tis) = lobe.declared(p, t) else { continue };
            let albedo: f64 = weights.iter().enumerate().map(|(c, w)| w * slice_albedo(lobe, c, p, t)).sum();
            let off = (albedo - tis).abs() / tis.abs().max(albedo);
            if off > DECLARED_TOLERANCE && worst.as_ref().is_none_or(|(most, _)| off > *most) {
                let of = noun(lobe);
                let found =
                    format!("a declared total {of} of {tis} at theta_i {theta_i} for a table of {albedo:.6}");
                worst = Some((off, found));
            }
        }
    }
    worst.map(|(_, found)| {
        Diagnostic::new(Kind::Range, found, "agreement within 1 %")
            .hint("the table is used; docs/SCATTERING.md tells what such totals hold")
    })
}

/// A number without rows of zeros.
fn short(x: f32) -> String {
    if x != 0.0 && !(1e-4..1e7).contains(&x) { format!("{x:e}") } else { format!("{x}") }
}
