//! What must be known beside the table of a far field.

use crate::error::warning::{Severity, Warning};
use crate::scene::far_field::FarField;

use super::far_field::{FarFieldStatistics, Measured};
use super::numbers::rounded;

/// Steps that miss more of the light than this make a table that is another light.
const UNRESOLVED: f64 = 0.02;
/// An asymmetry of more than this is told.
const ASYMMETRY: f64 = 0.01;
/// More standard errors than this are none of noise.
const ERRORS: f64 = 4.0;
/// A noisier table is no good as a file.
const NOISE: f64 = 0.05;
/// And this is what it should be at most.
const NOISE_WANTED: f64 = 0.02;
/// Two integrals of the table this far apart are two fluxes to whoever reads the file.
const INTEGRALS: f64 = 0.01;

impl FarFieldStatistics {
    /// The warnings, in the order of what they are about.
    pub fn warnings(&self, field: &FarField) -> Vec<Warning> {
        let of_light = [self.dark(field), self.outside(), self.again(field)];
        let of_table = [self.noise_told(), self.steps(field), self.uneven(), self.integrals()];
        let all = of_light.into_iter().chain(of_table).flatten();
        all.map(|warning| Warning {
            message: format!("far field \"{}\": {}", field.name, warning.message),
            ..warning
        })
        .collect()
    }

    fn dark(&self, field: &FarField) -> Option<Warning> {
        let message = "no light is in its table, so that its files hold zeros and there is no EULUMDAT of it";
        let remedy = match field.surface {
            Some(_) => "a `surface` that light comes out of, at its front, and an `axis` on that side",
            None => "light that leaves the scene, and an `axis` on that side",
        };
        (self.flux_lm == 0.0).then(|| doubtful("far-field-dark", message.into(), 0.0, remedy))
    }

    fn outside(&self) -> Option<Warning> {
        let share = self.outside_lm / (self.flux_lm + self.outside_lm);
        let message = format!("{} of its light leaves in directions outside `gamma_deg`", percent(share));
        let remedy =
            "angles up to 180 degrees; a table that ends at 90 is of a luminaire that lets nothing out above";
        (self.outside_lm > 0.0).then(|| doubtful("far-field-outside", message, share, remedy))
    }

    /// Light that comes out of a surface more often than it was emitted.
    fn again(&self, field: &FarField) -> Option<Warning> {
        let share = self.efficiency.value;
        let message = format!(
            "{} of the light that is emitted comes out of its surface: some comes out, goes in again and is counted again",
            percent(share)
        );
        let remedy = "a far field without `surface`, of what leaves the scene, with nothing around that throws light back";
        let warning = doubtful("far-field-again", message, share, remedy);
        let is_again = field.surface.is_some() && share > 1.0 + 1e-9;
        is_again.then_some(Warning { severity: Severity::Untrusted, ..warning })
    }

    fn noise_told(&self) -> Option<Warning> {
        if self.flux_lm == 0.0 || self.table.standard_error_cd.is_none() {
            return None;
        }
        let remedy = match self.noise {
            Some(noise) if noise > NOISE_WANTED => {
                let more = rounded((noise / NOISE_WANTED).powi(2).max(2.0), 2);
                format!("{more} times the photons, wider steps, or a `symmetry`")
            }
            _ => "many more photons, wider steps, or a `symmetry`".into(),
        };
        let message = match self.noise {
            None => "its table is all noise".to_owned(),
            Some(noise) if noise > NOISE => {
                format!("its table has a noise of {} (root mean square)", percent(noise))
            }
            Some(_) if self.angles_absent.is_some() => "noise hides a beam or field angle".to_owned(),
            Some(_) => return None,
        };
        Some(Warning { remedy, ..doubtful("far-field-noise", message, self.noise.unwrap_or(1.0), "") })
    }

    fn steps(&self, field: &FarField) -> Option<Warning> {
        let missed = self.unresolved.filter(|missed| missed.value > UNRESOLVED && is_clear(missed))?;
        let [gamma, c] = self.widest_step_deg.map(|step| rounded(step, 3));
        let part = percent(missed.value);
        let message = format!(
            "steps of {gamma} degrees in gamma and {c} in C do not follow {part} of the light (root mean square)"
        );
        let remedy = match field.doublings {
            [1, 1] => "smaller steps, or none, so that they are chosen",
            _ => "smaller steps; of a light so narrow that none follow it the flux alone is right",
        };
        Some(doubtful("far-field-steps", message, missed.value, remedy))
    }

    fn uneven(&self) -> Option<Warning> {
        let size = self.asymmetry.filter(|size| size.value > ASYMMETRY && is_clear(size))?;
        let (part, symmetry) = (percent(size.value), self.symmetry);
        let message = format!(
            "{part} of it (root mean square) is not as symmetry = \"{symmetry}\" says, and was averaged away"
        );
        let remedy = "symmetry = \"none\", or an `axis` and `up` that are the light's";
        Some(doubtful("far-field-asymmetry", message, size.value, remedy))
    }

    fn integrals(&self) -> Option<Warning> {
        let apart = self.trapezoid_lm / self.flux_lm - 1.0;
        let message = format!(
            "other programs will read {} lm in its file, {} lm being right: they integrate by trapezoids between its angles",
            rounded(self.trapezoid_lm, 4),
            rounded(self.flux_lm, 4)
        );
        let remedy = "smaller steps where the light is";
        (self.flux_lm > 0.0 && apart.abs() > INTEGRALS)
            .then(|| doubtful("far-field-trapezoid", message, apart.abs(), remedy))
    }
}

fn doubtful(code: &'static str, message: String, share: f64, remedy: &str) -> Warning {
    let share = Some(share);
    Warning {
        severity: Severity::Doubtful,
        code,
        message,
        surfaces: Vec::new(),
        share,
        remedy: remedy.into(),
    }
}

fn is_clear(of: &Measured) -> bool {
    of.standard_error.is_some_and(|error| of.value > ERRORS * error)
}

fn percent(share: f64) -> String {
    format!("{} %", rounded(100.0 * share, 2))
}
