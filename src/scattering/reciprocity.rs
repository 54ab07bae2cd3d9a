//! How far a table is from reciprocal: f(wi, wo) against f(wo, wi) (Helmholtz; for transmission between equal media the light
//! of the way back comes from the other side).
//!
//! Pairs of directions fill the two hemispheres evenly in projected solid angle, by an additive recurrence of four
//! coordinates (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018). Directions beyond 85 degrees are
//! left out: there f is a small interpolated g over a small cosine, and says nothing about the surface.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use super::value::{direction, value};
use super::{LobeSide, Quantity, ScatterTable};

/// Pairs of directions that are compared.
pub const PAIRS: usize = 4096;

/// The sine squared of the largest polar angle, 85 degrees.
const MOST: f64 = 0.992_403_876_506_104;

/// What the comparison found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Defect {
    /// Root of the mean square of f(wi, wo) - f(wo, wi), relative to the root mean square of f; over projected solid angle.
    pub rms: f64,
    /// The largest |f(wi, wo) - f(wo, wi)| relative to the larger of the two: 1 where one of them is zero.
    pub largest: f64,
    /// Incident and scattered direction of the largest, in the local frame of the first side: z its normal.
    pub at: (DVec3, DVec3),
    /// Pairs where at least one of the two is positive.
    pub pairs: usize,
}

/// The defect of one quantity, all channels together, for light from the front or from the back first. `None` where the table
/// has no lobe for it, or (transmission) none for the way back.
pub fn reciprocity(table: &ScatterTable, quantity: Quantity, from_front: bool) -> Option<Defect> {
    weighted(table, quantity, from_front, |_| 1.0)
}

/// The same of values that are multiplied by a weight of the scattered direction, in the frame of the side its light comes from.
fn weighted(
    table: &ScatterTable,
    quantity: Quantity,
    from_front: bool,
    weight: impl Fn(DVec3) -> f64,
) -> Option<Defect> {
    let there = table.lobe(quantity, from_front)?;
    let through = quantity == Quantity::Transmission;
    let back = if through { table.lobe(quantity, !from_front)? } else { there };
    // The other side's local frame shares the reference direction; its normal is opposite.
    let other = |w: DVec3| if through { DVec3::new(w.x, -w.y, -w.z) } else { w };
    let channels = there.channels.min(back.channels);
    let mut defect = Defect { rms: 0.0, largest: 0.0, at: (DVec3::Z, DVec3::Z), pairs: 0 };
    let (mut squares, mut norm) = (0.0, 0.0);
    for i in 0..PAIRS {
        let u = recurrence(i as f64);
        let wi = on_hemisphere(u[0], u[1]);
        let wo = on_hemisphere(u[2], u[3]);
        let wo = if through { DVec3::new(wo.x, wo.y, -wo.z) } else { wo };
        for channel in 0..channels {
            let forth = weight(wo) * value(there, channel, wi, wo);
            let home = weight(wi) * value(back, channel, other(wo), other(wi));
            let larger = forth.max(home);
            if larger > 0.0 {
                defect.pairs += 1;
                squares += (forth - home) * (forth - home);
                norm += 0.5 * (forth * forth + home * home);
                let relative = (forth - home).abs() / larger;
                if relative > defect.largest {
                    defect.largest = relative;
                    defect.at = (wi, wo);
                }
            }
        }
    }
    defect.rms = if norm > 0.0 { (squares / norm).sqrt() } else { 0.0 };
    Some(defect)
}

/// The defects of everything the table can be asked for, with quantity and whether the light of the first way comes from the
/// front: reflection for each side it has, transmission once.
pub fn all(table: &ScatterTable) -> Vec<(Quantity, bool, Defect)> {
    let one = |(quantity, front)| reciprocity(table, quantity, front).map(|defect| (quantity, front, defect));
    let both = |l: Option<&super::Lobe>| l.is_some_and(|l| l.side == LobeSide::Both);
    let back = (Quantity::Reflection, false);
    let ways = [(Quantity::Reflection, true), back, (Quantity::Transmission, true)];
    let same = both(table.lobe(Quantity::Reflection, true));
    ways.into_iter().filter(|way| !(same && *way == back)).filter_map(one).collect()
}

/// A defect of a table that holds f times the cosine of the scattered direction where f is asked for: as it stands, and with its
/// values divided by that cosine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WithCosine {
    /// Root mean square, as [`Defect::rms`].
    pub as_it_stands: f64,
    /// The same of the divided values.
    pub divided: f64,
}

/// Whether a table breaks reciprocity, and keeps it when its values are divided by the cosine.
pub fn with_cosine(table: &ScatterTable) -> Option<WithCosine> {
    /// Tables of formulas keep it within a few per cent, measured ones within tens.
    const BROKEN: f64 = 0.2;
    /// What is left of the defect where the cosine is what is wrong.
    const LEFT: f64 = 1.0 / 3.0;
    all(table).into_iter().find_map(|(quantity, front, defect)| {
        let divided = weighted(table, quantity, front, |w| 1.0 / w.z.abs())?.rms;
        let is_cosine = defect.rms > BROKEN && divided < LEFT * defect.rms;
        is_cosine.then_some(WithCosine { as_it_stands: defect.rms, divided })
    })
}

/// Point i of the additive recurrence in four dimensions: steps are powers of the root of x^5 = x + 1.
fn recurrence(i: f64) -> [f64; 4] {
    const ROOT: f64 = 1.167_303_978_261_418_7;
    let mut step = 1.0;
    [(); 4].map(|()| {
        step /= ROOT;
        (0.5 + i * step).fract()
    })
}

/// A direction by the sine squared of its polar angle, which is even in projected solid angle.
fn on_hemisphere(u1: f64, u2: f64) -> DVec3 {
    let sine = (MOST * u1).sqrt();
    direction(libm::asin(sine).min(FRAC_PI_2), TAU * u2)
}
