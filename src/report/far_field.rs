//! Numbers of one far field: flux, efficiency, greatest intensity, beam and field angles, each with its error; its CSV and EXR.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use serde::Serialize;

use crate::error::Result;
use crate::error::warning::{Severity, Warning};
use crate::estimate::far_field::{Table, jackknife_error};
use crate::files::atomic::write_atomically;
use crate::files::exr::{Channel, Light, Value, floats, write_maps};
use crate::photometry::beam::{BEAM_SHARE, FIELD_SHARE, lobe_angle_across_deg, lobe_angle_deg};
use crate::photometry::export::{DataOrigin, Export};
use crate::photometry::{PhotometricType, Web};
use crate::run::Outcome;
use crate::scene::Scene;
use crate::scene::far_field::{FarField, Symmetry};

use super::attributes::run_attributes;
use super::numbers::{bare, grouped, rounded, with_error, written};
use super::unknown::why_no_error;

fn measured((value, error): (f64, f64)) -> Measured {
    Measured { value, standard_error: Some(error) }
}

/// A number and its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// Its standard error; `None` for one replicate.
    pub standard_error: Option<f64>,
}

impl Measured {
    fn scaled(self, factor: f64) -> Self {
        Self { value: factor * self.value, standard_error: self.standard_error.map(|error| factor * error) }
    }

    /// With its error, without the share that this is.
    fn text(self, unit: &str) -> String {
        let text = with_error(self.value, self.standard_error, unit);
        text.rsplit_once(" (").map_or(text.clone(), |(text, _)| text.to_owned())
    }
}

/// The table of a far field and the numbers that sum it up. Names are those of report.json: they are only added to.
#[derive(Debug, Clone, Serialize)]
pub struct FarFieldStatistics {
    /// Intensities and their errors.
    #[serde(skip)]
    pub table: Table,
    /// The same as a photometric file holds it: the planes that its symmetry leaves, the circle closed.
    #[serde(skip)]
    pub web: Web,
    /// Flux of the table, lm.
    pub flux_lm: f64,
    /// Its standard error, lm.
    pub flux_standard_error_lm: Option<f64>,
    /// Flux that left in directions outside the table, lm.
    pub outside_lm: f64,
    /// All flux that left, inside and outside, over the flux of all emitters.
    pub efficiency: Measured,
    /// Angles from the axis.
    pub gamma_angles: usize,
    /// Planes about it.
    pub c_planes: usize,
    /// Greatest step of each, degrees.
    pub widest_step_deg: [f64; 2],
    /// Symmetry that it was averaged to.
    pub symmetry: &'static str,
    /// Greatest intensity, cd.
    pub max_candela: Measured,
    /// Where: gamma and C, degrees.
    pub max_at_deg: [f64; 2],
    /// Full angles at half of the greatest intensity of C0-C180 and of C90-C270; absent in the dark.
    pub beam_angle_deg: [Option<Measured>; 2],
    /// The same at a tenth.
    pub field_angle_deg: [Option<Measured>; 2],
    /// Of the table's norm (root mean square over the sphere): noise.
    pub noise: Option<f64>,
    /// Of its norm: what half the steps would show and these do not.
    pub unresolved: Option<Measured>,
    /// Of its norm: what was not symmetric, and averaged away.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub asymmetry: Option<Measured>,
    /// Nodes at 0 that noise, or light which the steps do not follow, would have made negative.
    pub nodes_held_at_zero: usize,
}

impl FarFieldStatistics {
    /// The numbers of far field number `index`.
    pub fn new(scene: &Scene, outcome: &Outcome, index: usize) -> Self {
        let field = &scene.far_fields[index];
        let table = outcome.far_field(scene, index);
        let [seen, outside] = outcome.far_field_lm(index);
        let emitted_lm = scene.emitters.flux_lm();
        let web_of = |candela: &[f64]| web(&table, candela, field.symmetry);
        let web = web_of(&table.candela);
        let without_each: Vec<Web> = table.without_each().map(|candela| web_of(&candela)).collect();
        let error = |of: &dyn Fn(&Web) -> Option<f64>| {
            let each: Option<Vec<f64>> = without_each.iter().map(of).collect();
            each.filter(|each| each.len() > 1).map(|each| jackknife_error(&each))
        };
        let angle = |of: fn(&Web, f64) -> Option<f64>, share: f64| {
            let value = of(&web, share)?;
            Some(Measured { value, standard_error: error(&|web| of(web, share)) })
        };
        let angles = |share: f64| [angle(lobe_angle_deg, share), angle(lobe_angle_across_deg, share)];
        // Planes that a symmetry makes equal are so but for rounding.
        let larger = |best: usize, i: usize| table.candela[i] > table.candela[best] * (1.0 + 1e-12);
        let most = (0..table.candela.len()).fold(0, |best, i| if larger(best, i) { i } else { best });
        let (nodes, planes) = (&table.nodes, table.nodes.planes());
        // Without the rounding of angles that are multiples of a step.
        let widest = |pairs: &mut dyn Iterator<Item = f64>| (1e9 * pairs.fold(0.0, f64::max)).round() / 1e9;
        let widest_step_deg = [
            widest(&mut nodes.gamma_deg.windows(2).map(|pair| pair[1] - pair[0])),
            widest(&mut (0..planes).map(|plane| nodes.next_c_deg(plane) - nodes.c_deg[plane])),
        ];
        Self {
            flux_lm: seen.value - outside.value,
            flux_standard_error_lm: seen.standard_error,
            outside_lm: outside.value,
            efficiency: Measured {
                value: seen.value / emitted_lm,
                standard_error: seen.standard_error.map(|error| error / emitted_lm),
            },
            gamma_angles: nodes.gamma_deg.len(),
            c_planes: planes,
            widest_step_deg,
            symmetry: field.symmetry.name(),
            max_candela: Measured {
                value: table.candela[most],
                standard_error: table.standard_error_cd.as_ref().map(|errors| errors[most]),
            },
            max_at_deg: [nodes.gamma_deg[most / planes], nodes.c_deg[most % planes]],
            beam_angle_deg: angles(BEAM_SHARE),
            field_angle_deg: angles(FIELD_SHARE),
            noise: table.noise,
            unresolved: table.unresolved.map(measured),
            asymmetry: table.asymmetry.map(measured),
            nodes_held_at_zero: table.held,
            web,
            table,
        }
    }

    /// What must be known beside the table.
    pub fn warnings(&self, field: &FarField) -> Vec<Warning> {
        /// Steps that miss more of the light than this make a table that is another light.
        const UNRESOLVED: f64 = 0.02;
        /// An asymmetry of more standard errors than this, and of more than a hundredth, is none of noise.
        const ERRORS: f64 = 4.0;
        const ASYMMETRY: f64 = 0.01;
        let name = &field.name;
        let percent = |share: f64| format!("{} %", rounded(100.0 * share, 2));
        let tell = |code, message: String, share: f64, remedy: &str| Warning {
            severity: Severity::Doubtful,
            code,
            message: format!("far field \"{name}\": {message}"),
            surfaces: Vec::new(),
            share: Some(share),
            remedy: remedy.into(),
        };
        let mut all = Vec::new();
        let seen_lm = self.flux_lm + self.outside_lm;
        if self.outside_lm > 0.0 {
            let share = self.outside_lm / seen_lm;
            let message = format!("{} of its light leaves in directions outside `gamma_deg`", percent(share));
            all.push(tell(
                "far-field-outside",
                message,
                share,
                "angles up to 180 degrees, or what the luminaire lets out there kept in",
            ));
        }
        if seen_lm == 0.0 {
            let message =
                "no light arrives in it, so that its files hold zeros and there is no EULUMDAT of it"
                    .to_owned();
            all.push(tell(
                "far-field-dark",
                message,
                0.0,
                "light that leaves the scene, or comes out of the front of its `surface`",
            ));
        }
        let is_clear = |of: &Measured| of.standard_error.is_some_and(|error| of.value > ERRORS * error);
        if let Some(missed) = self.unresolved.filter(|missed| missed.value > UNRESOLVED && is_clear(missed)) {
            let [gamma, c] = self.widest_step_deg.map(|step| rounded(step, 3));
            let part = percent(missed.value);
            let message = format!(
                "steps of {gamma} degrees in gamma and {c} in C do not follow {part} of the light (root mean square)"
            );
            all.push(tell(
                "far-field-steps",
                message,
                missed.value,
                "smaller steps, or none, so that they are chosen",
            ));
        }
        if let Some(size) = self.asymmetry.filter(|size| size.value > ASYMMETRY && is_clear(size)) {
            let (part, symmetry) = (percent(size.value), self.symmetry);
            let message = format!(
                "{part} of it (root mean square) is not as symmetry = \"{symmetry}\" says, and was averaged away"
            );
            all.push(tell(
                "far-field-asymmetry",
                message,
                size.value,
                "symmetry = \"none\", or an `axis` and `up` that are the light's",
            ));
        }
        all
    }
}

/// What the summary says of a far field.
pub fn text(field: &FarField, s: &FarFieldStatistics, files: &[String]) -> String {
    written(|out| {
        let [gamma, c] = s.widest_step_deg.map(|step| rounded(step, 4));
        let planes = if s.c_planes == 1 {
            "1 plane".into()
        } else {
            format!("{} planes, {c} degrees apart", s.c_planes)
        };
        writeln!(
            out,
            "\nfar field \"{}\": {} angles, {gamma} degrees apart, in {planes}",
            field.name, s.gamma_angles
        )?;
        writeln!(out, "  flux         {}", with_error(s.flux_lm, s.flux_standard_error_lm, "lm"))?;
        let efficiency = s.efficiency.scaled(100.0);
        writeln!(out, "  efficiency   {} of what the emitters give", efficiency.text("%"))?;
        let [max_gamma, max_c] = s.max_at_deg;
        let max = with_error(s.max_candela.value, s.max_candela.standard_error, "cd");
        writeln!(out, "  maximum      {max} at gamma = {max_gamma}, C = {max_c}")?;
        for (label, [first, across]) in
            [("beam angle ", s.beam_angle_deg), ("field angle", s.field_angle_deg)]
        {
            let degrees = |angle: Option<Measured>| match angle {
                Some(angle) => angle.text("degrees"),
                None => "none".into(),
            };
            writeln!(out, "  {label}  {} in C0-C180, {} in C90-C270", degrees(first), degrees(across))?;
        }
        let noise = s.noise.map_or("unknown".into(), |share| format!("{} %", rounded(100.0 * share, 2)));
        let steps = s.unresolved.map_or("unknown".into(), |share| share.scaled(100.0).text("%"));
        writeln!(
            out,
            "  table        noise {noise} (root mean square); half the steps would show {steps} more"
        )?;
        if s.nodes_held_at_zero > 0 {
            writeln!(
                out,
                "               {} nodes held at 0 that would be negative",
                grouped(s.nodes_held_at_zero as u64)
            )?;
        }
        if let Some(asymmetry) = s.asymmetry {
            let part = asymmetry.scaled(100.0).text("%");
            writeln!(out, "               {part} of it is not {}, and averaged away", s.symmetry)?;
        }
        if !files.is_empty() {
            writeln!(out, "  files        {}", files.join(", "))?;
        }
        Ok(())
    })
}

/// The table as a photometric file holds it; negative values, which noise makes, are 0.
fn web(table: &Table, candela: &[f64], symmetry: Symmetry) -> Web {
    let planes = table.nodes.planes();
    let within =
        |low: f64, high: f64| (0..planes).filter(move |&p| (low..=high).contains(&table.nodes.c_deg[p]));
    let kept: Vec<usize> = match symmetry {
        _ if planes == 1 => vec![0],
        Symmetry::Rotational => vec![0],
        Symmetry::Quadrants => within(0.0, 90.0).collect(),
        Symmetry::Bilateral0To180 => within(0.0, 180.0).collect(),
        Symmetry::Bilateral90To270 => within(90.0, 270.0).collect(),
        _ => (0..planes).chain([0]).collect(),
    };
    let mut horizontal_deg: Vec<f64> = kept.iter().map(|plane| table.nodes.c_deg[*plane]).collect();
    if kept.len() > planes
        && planes > 1
        && let Some(last) = horizontal_deg.last_mut()
    {
        *last = 360.0;
    }
    let rows = table.nodes.gamma_deg.len();
    let of_plane = |plane: usize| (0..rows).map(move |row| candela[row * planes + plane].max(0.0));
    Web {
        photometric_type: PhotometricType::C,
        vertical_deg: table.nodes.gamma_deg.clone(),
        horizontal_deg,
        candela: kept.into_iter().flat_map(of_plane).collect(),
    }
}

/// The table as a luminaire's photometric file: absolute photometry from a simulation, with what it is worth in its labels.
///
/// # Errors
/// None for a table of a run, which a file can hold.
pub fn export(scene: &Scene, outcome: &Outcome, field: &FarField, s: &FarFieldStatistics) -> Result<Export> {
    let mut export = Export::new(&field.name, s.web.clone())?;
    export.origin = DataOrigin::Simulation;
    let mut label = |keyword: &str, text: String| export.labels.push((keyword.into(), text));
    label("TEST", format!("simulated by caustix {}", env!("CARGO_PKG_VERSION")));
    label("TESTLAB", "none: a simulation".into());
    label(
        "_PHOTONS",
        format!("{} in {} replicates, seed {}", outcome.photons, outcome.replicates, outcome.plan.seed()),
    );
    if let Some(error) = s.max_candela.standard_error.filter(|_| s.max_candela.value > 0.0) {
        let part = rounded(100.0 * error / s.max_candela.value, 2);
        label("_STANDARD_ERROR", format!("{part} % of the maximum, there; the CSV has that of every node"));
    }
    label("_SCENE_SHA256", scene.identity.sha256.clone());
    Ok(export)
}

/// Writes the table as CSV: a row a node, plane by plane.
///
/// # Errors
/// A file that cannot be written.
pub fn write_csv(path: &Path, s: &FarFieldStatistics) -> Result<()> {
    let (nodes, planes) = (&s.table.nodes, s.table.nodes.planes());
    write_atomically(path, |out| {
        writeln!(out, "c_deg,gamma_deg,intensity_cd,standard_error_cd")?;
        for (plane, c) in nodes.c_deg.iter().enumerate() {
            for (row, gamma) in nodes.gamma_deg.iter().enumerate() {
                let at = row * planes + plane;
                let error = bare(s.table.standard_error_cd.as_ref().map(|errors| errors[at]));
                writeln!(out, "{c},{gamma},{},{error}", s.table.candela[at])?;
            }
        }
        Ok(())
    })
}

/// Writes the table as EXR: `Y` (intensity) and `standard_error` in cd, a row a gamma from the least one down, a column a C.
///
/// # Errors
/// A number beyond a 32-bit float; a file that cannot be written.
pub fn write_exr(
    path: &Path,
    scene: &Scene,
    outcome: &Outcome,
    field: &FarField,
    s: &FarFieldStatistics,
) -> Result<()> {
    let channel = |values: &[f64]| floats(values.iter().copied()).map_err(|e| e.in_file(path));
    let nodes = &s.table.nodes;
    let intensity = channel(&s.table.candela)?;
    let error = match &s.table.standard_error_cd {
        Some(errors) => channel(errors)?,
        None => vec![f32::NAN; intensity.len()],
    };
    let channels =
        [Channel { name: "Y", data: &intensity }, Channel { name: "standard_error", data: &error }];
    let mut all = run_attributes(scene, &outcome.plan, outcome.photons, outcome.replicates);
    let mut text = |name: &str, value: &str| all.push((name.to_string(), Value::Text(value.to_string())));
    let degrees = |angles: &[f64]| angles.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    text("caustix.quantity", "luminous intensity at the nodes of a table of type C, bilinear between them");
    text("caustix.unit.Y", "cd");
    text("caustix.unit.standard_error", "cd");
    text("caustix.far_field", &field.name);
    text(
        "caustix.layout",
        "row 0 is the least gamma, column 0 is C = 0; the column after the last is the first",
    );
    text("caustix.gamma_deg", &degrees(&nodes.gamma_deg));
    text("caustix.c_deg", &degrees(&nodes.c_deg));
    text("caustix.symmetry", s.symmetry);
    if let Some(why) = why_no_error(outcome) {
        text("caustix.standard_error_absent", why);
    }
    all.push(("caustix.flux_lm".into(), Value::F64(s.flux_lm)));
    write_maps(path, [nodes.planes(), nodes.gamma_deg.len()], &channels, &all, Light::Other)
}
