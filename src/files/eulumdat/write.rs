//! Writes EULUMDAT: a field a line, CR LF, Windows-1252, intensities in candela per 1000 lm of one lamp set.

use crate::error::{Diagnostic, Kind, Result};
use crate::files::decimal::{rounded, rounded_table, text};
use crate::files::letters::western;
use crate::photometry::Web;
use crate::photometry::export::{Export, PhotometricFile};
use crate::photometry::web::Symmetry;
use crate::photometry::zones::ZonalLumens;

/// Characters that a line of text has room for: company, report, name, number and date; the kind of lamps;
/// their colour; their rendering.
const TEXT: usize = 78;
const LAMP_WORDS: [usize; 3] = [24, 16, 6];

/// The bytes of a file. Intensities have nine significant digits; those below 1e-12 of the largest are
/// written as 0. Direct ratios are 0: not stated.
///
/// # Errors
/// [`Kind::Range`] for a table without light, which has no candela per 1000 lm.
pub fn write(export: &Export) -> Result<PhotometricFile> {
    let flux_lm = export.flux_lm();
    let lamps_lm = rounded(export.lamps_lm.unwrap_or(flux_lm));
    if lamps_lm.is_nan() || lamps_lm <= 0.0 {
        let required = "some light, or lamps with lumens: EULUMDAT has candela per 1000 lm of them";
        return Err(Diagnostic::new(Kind::Range, "a flux of 0 lm", required));
    }
    let mut lines = FieldLines::default();
    let web = export.web();
    let mut planes = Planes::of(web);
    lines.text(export.label("MANUFAC"), TEXT);
    lines.word(if planes.isym == 1 { "1" } else { "3" });
    lines.word(planes.isym);
    lines.word(planes.c_deg.len());
    lines.number(even_step(&planes.c_deg, 360.0));
    lines.word(web.vertical_deg.len());
    lines.number(even_step(&planes.circle.vertical_deg, f64::INFINITY));
    for keyword in ["TEST", "LUMINAIRE", "LUMCAT"] {
        lines.text(export.label(keyword), TEXT);
    }
    // The name of the file, eight characters: nobody's.
    lines.text(None, TEXT);
    lines.text(export.label("ISSUEDATE"), TEXT);
    lines.sizes(export);
    let down = ZonalLumens::new(web).and_then(|zonal| zonal.zones[3].percent);
    lines.number(down.unwrap_or(0.0));
    lines.number(export.lamps_lm.map_or(100.0, |lm| 100.0 * flux_lm / lm));
    lines.word("1");
    lines.word("0");
    lines.lamps(export, lamps_lm);
    (0..10).for_each(|_| lines.word("0"));
    planes.c_deg.iter().chain(&planes.circle.vertical_deg).for_each(|&angle| lines.number(angle));
    let (per_klm, n_v) = (planes.per_klm(lamps_lm), web.vertical_deg.len());
    let values = planes.stored.iter().flat_map(|&plane| &per_klm[plane * n_v..(plane + 1) * n_v]);
    values.for_each(|&value| lines.number(value));
    if planes.seam_differs {
        lines.notes.push("planes C0 and C360 differ: EULUMDAT has one for both, C0 is written".to_owned());
    }
    Ok(PhotometricFile { bytes: lines.bytes, table: planes.circle, notes: lines.notes })
}

/// The distance of evenly spread angles, else 0; those of a circle of `turn` go on to the first.
fn even_step(angles: &[f64], turn: f64) -> f64 {
    let [first, second, ..] = angles else { return 0.0 };
    let step = second - first;
    let next = angles.iter().skip(1).copied().chain(turn.is_finite().then_some(first + turn));
    let is_even = angles.iter().zip(next).all(|(a, b)| (b - a - step).abs() <= 1e-9 * step);
    if is_even { rounded(step) } else { 0.0 }
}

/// The planes of the circle, and which of them are stored.
struct Planes {
    isym: u32,
    /// The table over the circle, its last plane the first one again.
    circle: Web,
    /// Angles of all planes without 360.
    c_deg: Vec<f64>,
    /// Those with values, in the order of the file.
    stored: Vec<usize>,
    seam_differs: bool,
}

impl Planes {
    fn of(web: &Web) -> Self {
        let mut circle = web.over_circle();
        let (n_v, mc) = (circle.vertical_deg.len(), circle.horizontal_deg.len() - 1);
        let seam_differs = circle.candela[..n_v] != circle.candela[mc * n_v..];
        circle.candela.copy_within(..n_v, mc * n_v);
        circle
            .vertical_deg
            .iter_mut()
            .chain(&mut circle.horizontal_deg)
            .for_each(|angle| *angle = rounded(*angle));
        let c_deg = circle.horizontal_deg[..mc].to_vec();
        // Planes at 90 and 270 a quarter and three quarters through the list: else the format cannot say
        // where it begins.
        let has_quarters = mc % 4 == 0 && c_deg[mc / 4] == 90.0 && c_deg[3 * mc / 4] == 270.0;
        let (isym, stored): (u32, Vec<usize>) = match web.symmetry() {
            Symmetry::Rotational => (1, vec![0]),
            Symmetry::Bilateral0To180 if mc % 2 == 0 => (2, (0..=mc / 2).collect()),
            Symmetry::Bilateral90To270 if has_quarters => (3, (3 * mc / 4..mc).chain(0..=mc / 4).collect()),
            Symmetry::Quadrants if has_quarters => (4, (0..=mc / 4).collect()),
            _ => (0, (0..mc).collect()),
        };
        Self { isym, circle, c_deg, stored, seam_differs }
    }

    /// The circle's values per 1000 lm as they are written; what is left of the table then stays here.
    fn per_klm(&mut self, lamps_lm: f64) -> Vec<f64> {
        let per_klm: Vec<f64> = self.circle.candela.iter().map(|c| c * (1000.0 / lamps_lm)).collect();
        let per_klm = rounded_table(&per_klm);
        self.circle.candela = per_klm.iter().map(|value| value * (1e-3 * lamps_lm)).collect();
        per_klm
    }
}

/// The lines of a file.
#[derive(Default)]
struct FieldLines {
    bytes: Vec<u8>,
    notes: Vec<String>,
}

impl FieldLines {
    fn line(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
        self.bytes.extend_from_slice(b"\r\n");
    }

    fn word(&mut self, word: impl ToString) {
        self.line(word.to_string().as_bytes());
    }

    fn number(&mut self, value: f64) {
        self.line(text(value).as_bytes());
    }

    /// A line of text; what it has no room or no letters for is said.
    fn text(&mut self, value: Option<&str>, most: usize) {
        let value = value.unwrap_or_default().replace('\n', " ");
        let (mut bytes, changed) = western(value.trim());
        if changed {
            self.notes.push(format!("\"{}\" has letters that are not in Windows-1252", value.trim()));
        }
        if bytes.len() > most {
            self.notes.push(format!("\"{}\" is cut to {most} characters", value.trim()));
            bytes.truncate(most);
        }
        self.line(bytes.trim_ascii());
    }

    /// The luminaire, as its opening where nothing else is known of it, and the opening; mm.
    fn sizes(&mut self, export: &Export) {
        let (area_m, heights_m, note) = export.opening.eulumdat_sizes();
        self.notes.extend(note.map(str::to_owned));
        let height_m = heights_m.iter().copied().fold(0.0, f64::max);
        let luminaire_m = export.luminaire_size_m.unwrap_or([area_m[0], area_m[1], height_m]);
        for metres in [luminaire_m.as_slice(), &area_m, &heights_m].concat() {
            self.number(1e3 * metres);
        }
    }

    /// One lamp set.
    fn lamps(&mut self, export: &Export, lamps_lm: f64) {
        let is_whole = export.lamps >= 1.0 && export.lamps.fract() == 0.0;
        let count = if is_whole { export.lamps } else { 1.0 };
        self.word("1");
        self.number(if export.lamps_lm.is_some() { count } else { -count });
        self.text(Some(&export.lamp_words[0]), LAMP_WORDS[0]);
        self.number(lamps_lm);
        self.text(Some(&export.lamp_words[1]), LAMP_WORDS[1]);
        self.text(Some(&export.lamp_words[2]), LAMP_WORDS[2]);
        self.number(export.input_watts);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::photometric;
    use crate::photometry::opening::OpeningShape;
    use crate::photometry::{Format, LuminousOpening, PhotometricType};

    /// About 1000 cd, in no order; at the poles one value.
    fn table(v: &[f64], h: &[f64]) -> Web {
        let noise = |i: usize| f64::from((i * 7919 + 13) as u32 % 1009) / 70.0;
        let at = |i: usize| 1000.0 + if v[i % v.len()] % 180.0 == 0.0 { 0.0 } else { noise(i) };
        let candela = (0..v.len() * h.len()).map(at).collect();
        Web::new(PhotometricType::C, v.to_vec(), h.to_vec(), candela).unwrap()
    }

    #[test]
    fn what_is_written_reads_back_as_the_same_table() {
        let v = [0.0, 33.3, 60.0, 90.0];
        for (web, isym) in [
            (table(&v, &[0.0]), 1),
            (table(&v, &[0.0, 22.5, 45.0, 90.0]), 4),
            (table(&v, &[0.0, 1.0 / 3.0, 180.0]), 2),
            (table(&v, &[90.0, 120.0, 180.0, 200.0, 270.0]), 3),
            (table(&v, &[90.0, 180.0, 200.0, 270.0]), 0),
            (table(&v, &[90.0, 190.0, 270.0]), 0),
            (table(&v, &[0.0, 120.0, 345.0]), 0),
            (table(&v, &[5.0, 120.0, 345.0]), 0),
            (table(&[90.0, 120.0, 180.0], &[0.0]), 1),
            (table(&[0.0, 70.0, 140.0], &[0.0, 90.0]), 4),
        ] {
            for lamps_lm in [None, Some(777.7)] {
                let mut export = Export::new("a", web.clone()).unwrap();
                export.lamps_lm = lamps_lm;
                export.luminaire_size_m = Some([1.5, 0.25, 0.125]);
                let written = write(&export).unwrap();
                assert_eq!(written.notes, [""; 0]);
                let read = photometric::parse(&written.bytes, "a.ldt").unwrap();
                assert_eq!((read.format, read.factor()), (Format::Eulumdat, 1.0));
                let head = read.eulumdat.unwrap();
                assert_eq!(head.isym, isym, "{:?}", web.horizontal_deg);
                assert_eq!(head.luminaire_size_m, [1.5, 0.25, 0.125]);
                assert_eq!(read.lamps_lm(), lamps_lm);
                let (is, was) = (read.web.over_circle(), web.over_circle());
                assert_eq!(is.vertical_deg, written.table.vertical_deg);
                for (is, told) in is.horizontal_deg.iter().zip(&written.table.horizontal_deg) {
                    assert!((is - told).abs() <= 1e-6, "{is} {told}");
                }
                assert_eq!(is.candela.len(), written.table.candela.len());
                for ((read, told), was) in is.candela.iter().zip(&written.table.candela).zip(&was.candela) {
                    assert!(
                        (read - told).abs() <= 1e-15 * told && (told - was).abs() <= 6e-9 * was,
                        "{read} {told} {was}"
                    );
                }
                let flux_lm = export.flux_lm();
                assert!((read.flux_declared_lm.unwrap() / flux_lm - 1.0).abs() < 2e-8);
            }
        }
    }

    #[test]
    fn a_small_file_to_the_letter() {
        let web = Web::new(PhotometricType::C, vec![0.0, 90.0, 180.0], vec![0.0], vec![1.0; 3]).unwrap();
        let mut export = Export::new("Stra\u{df}e \u{65e5}", web).unwrap();
        export.labels.push(("ISSUEDATE".to_owned(), "2026-01-02\nme".to_owned()));
        (export.lamps, export.lamps_lm, export.input_watts) = (2.0, Some(1000.0), 12.5);
        export.lamp_words = ["LED".to_owned(), "4000".to_owned(), "1A/90 and more".to_owned()];
        export.opening =
            LuminousOpening { shape: OpeningShape::Disk, size_m: [0.1, 0.1, 0.0], heights_m: None };
        let written = write(&export).unwrap();
        // 4 pi lm of 1000.
        let expected = [
            "",
            "1",
            "1",
            "1",
            "0",
            "3",
            "90",
            "",
            "Stra\u{df}e ?",
            "",
            "",
            "2026-01-02 me",
            "100",
            "0",
            "0",
            "100",
            "0",
            "0",
            "0",
            "0",
            "0",
            "50",
            "1.25663706",
            "1",
            "0",
            "1",
            "2",
            "LED",
            "1000",
            "4000",
            "1A/90",
            "12.5",
            "0",
            "0",
            "0",
            "0",
            "0",
            "0",
            "0",
            "0",
            "0",
            "0",
            "0",
            "0",
            "90",
            "180",
            "1",
            "1",
            "1",
        ];
        let text: String = written.bytes.iter().map(|&b| char::from(b)).collect();
        assert_eq!(text.split_terminator("\r\n").collect::<Vec<_>>(), expected);
        assert_eq!(written.notes.len(), 2, "{:?}", written.notes);
    }

    #[test]
    fn darkness_has_no_candela_per_lumen() {
        let dark = Web::new(PhotometricType::C, vec![0.0, 90.0], vec![0.0], vec![0.0; 2]).unwrap();
        let mut export = Export::new("a", dark).unwrap();
        assert!(write(&export).is_err());
        export.lamps_lm = Some(1000.0);
        let written = write(&export).unwrap();
        assert!(!String::from_utf8_lossy(&written.bytes).to_lowercase().contains("nan"));
        assert_eq!(photometric::parse(&written.bytes, "a.ldt").unwrap().web.candela, [0.0, 0.0]);
    }
}
