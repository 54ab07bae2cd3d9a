//! What is said of a camera: how light got into its pixels, what was chosen, what it costs.

use std::fmt::Write;

use serde::Serialize;

use crate::picture::{Chosen, PictureSummary};
use crate::scene::camera::CameraSpec;

use super::numbers::{grouped, rounded, written};

/// The camera of report.json. Names are a contract: they are only added to.
#[derive(Debug, Clone, Serialize)]
pub struct CameraReport {
    /// Columns and rows.
    pub pixels: [u32; 2],
    /// Eye paths a pixel.
    pub samples: u32,
    /// How its picture was made.
    #[serde(flatten)]
    pub picture: PictureSummary,
    /// Files written.
    pub files: Vec<String>,
}

impl CameraReport {
    /// Of a picture and its files.
    pub fn new(spec: &CameraSpec, summary: &PictureSummary, files: &[String]) -> Self {
        Self { pixels: spec.pixels, samples: spec.samples, picture: summary.clone(), files: files.to_vec() }
    }

    /// The same in words, for the printed summary.
    pub fn text(&self) -> String {
        written(|out| self.write(out))
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        let (picture, [columns, rows], samples) = (&self.picture, self.pixels, self.samples);
        let method = picture.method.word();
        writeln!(out, "\ncamera: {columns} x {rows} pixels, {samples} samples each, method {method}")?;
        let (kept, of, passes) = (grouped(picture.photons_kept), grouped(picture.photons), picture.passes);
        match &picture.bandwidth {
            Some(bandwidth) => {
                let [caustic, diffuse] = bandwidth.each_ref().map(described);
                let passes = format!("{passes} {}", if passes == 1 { "pass" } else { "passes" });
                writeln!(out, "  photons      {kept} arrivals kept, of {of} photons, in {passes}")?;
                writeln!(out, "  bandwidth    caustics {caustic}; light scattered before {diffuse}")?;
            }
            None => {
                writeln!(out, "  photons      {kept} arrivals joined to the pinhole, of {of} photons")?;
                writeln!(out, "  missing      what is scattered last and seen by mirror or through glass")?;
            }
        }
        let [error, bias] = [picture.cost.median_standard_error_percent, picture.cost.median_bias_percent]
            .map(|p| p.map_or("unknown".to_string(), |p| format!("{} %", rounded(p, 2))));
        writeln!(out, "  error        standard error {error}, bias {bias} of a pixel (medians)")?;
        let endless = "eye paths ended by the guard against endless ones: their light is missing";
        for (number, what) in [
            (picture.pixels_unseen, "pixels not seen before the interrupt: black, their error unknown"),
            (picture.eye_paths_killed, endless),
            (picture.splats_cut, "splats cut: the pinhole all but touches a surface"),
        ] {
            if number > 0 {
                writeln!(out, "  missing      {} {what}", grouped(number))?;
            }
        }
        if !self.files.is_empty() {
            writeln!(out, "  files        {}", self.files.join(", "))?;
        }
        writeln!(out, "  time         {:.2} s", picture.time_s)
    }
}

fn described(density: &Chosen) -> String {
    let radius = density.radius_m.map(|r| format!("{} m", rounded(r, 3)));
    let neighbours = density.neighbours.map(|n| format!("{} photons", rounded(n, 3)));
    match (radius, neighbours) {
        (Some(radius), Some(neighbours)) => format!("{radius} ({neighbours})"),
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => "none".to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::summary::Cost;
    use crate::scene::camera::Method;
    use glam::DVec3;

    #[test]
    fn what_was_chosen_and_what_it_cost_is_said() {
        let spec = CameraSpec::pinhole(DVec3::Z, DVec3::ZERO, DVec3::Y, 40.0, [800, 600]);
        let chosen = |r, n| Chosen { radius_m: Some(r), neighbours: n };
        let mut summary = PictureSummary {
            method: Method::Map,
            photons: 4_000_000,
            replicates: 8,
            photons_kept: 1_234_567,
            passes: 2,
            bandwidth: Some([chosen(0.0125, Some(81.25)), chosen(0.1, None)]),
            eye_paths_killed: 0,
            splats_cut: 0,
            pixels_unseen: 0,
            cost: Cost { median_bias_percent: Some(1.234), median_standard_error_percent: None },
            time_s: 12.345,
            ..PictureSummary::default()
        };
        let report = CameraReport::new(&spec, &summary, &["camera.exr".into(), "camera.png".into()]);
        for line in [
            "camera: 800 x 600 pixels, 16 samples each, method map\n",
            "1 234 567 arrivals kept, of 4 000 000 photons, in 2 passes\n",
            "caustics 0.0125 m (81.2 photons); light scattered before 0.1 m\n",
            "standard error unknown, bias 1.2 % of a pixel",
            "files        camera.exr, camera.png\n",
        ] {
            assert!(report.text().contains(line), "{line}\n{}", report.text());
        }
        let json = serde_json::to_value(&report).unwrap();
        assert_eq!(json["bandwidth"]["caustic"]["radius_m"], 0.0125);
        assert_eq!(json["bandwidth"]["diffuse"]["neighbours"], serde_json::Value::Null);
        for number in ["eye_paths_killed", "splats_cut", "pixels_unseen"] {
            assert_eq!(json[number], 0);
        }
        assert!(!report.text().contains("missing"), "{}", report.text());
        (summary.eye_paths_killed, summary.pixels_unseen) = (12_345, 7);
        let told = CameraReport::new(&spec, &summary, &[]).text();
        assert!(
            told.contains("missing      12 345 eye paths") && told.contains("7 pixels not seen"),
            "{told}"
        );
        (summary.method, summary.bandwidth) = (Method::Splat, None);
        let splat = CameraReport::new(&spec, &summary, &[]).text();
        assert!(
            splat.contains("method splat") && splat.contains("seen by mirror or through glass"),
            "{splat}"
        );
    }
}
