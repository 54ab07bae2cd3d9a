//! Damaged scattering files: a table or a diagnostic, never a panic, a hang or memory beyond the caps.

use caustix::scattering::{integral::slice_albedo, reciprocity};
use std::time::{Duration, Instant};

use crate::damage::Damage;
use crate::support::data::project;
use crate::support::random::Generator;
use crate::support::scatter_files;

/// Reads bytes and, if they are a table, asks what a program would ask of it; true if they were.
fn survives(bytes: &[u8], name: &str, ask: bool) -> bool {
    match caustix::files::bsdf::parse(bytes, name) {
        Ok(table) => {
            for lobe in table.lobes.iter().filter(|_| ask) {
                assert!(lobe.values.iter().all(|v| v.is_finite() && *v >= 0.0));
                let albedo = slice_albedo(lobe, lobe.channels - 1, 0, lobe.theta_i_deg.len() - 1);
                assert!(albedo >= 0.0 && albedo.is_finite(), "{albedo}");
            }
            if ask {
                let defects = reciprocity::all(&table);
                assert!(defects.iter().all(|(_, _, d)| d.rms.is_finite() && d.largest <= 1.0));
            }
            assert!(table.warnings.iter().all(|w| w.to_string().len() < 1000));
            true
        }
        Err(error) => {
            assert!(error.line().is_some() && error.column().is_some(), "no place: {error}");
            assert!(error.to_string().len() < 1000, "a message, not the file: {error}");
            false
        }
    }
}

const TEXT: &str = "caustix-scattering 1\nname small\nframe specular\nsymmetry plane\nchannels 3\ntheta_i 0 45\npolar 0 10 30\n\
                    azimuth 0 90 180\nlobe reflection front\nincidence 0\n1 2 3\n4 5 6\n7 8 9\n1 2 3\n4 5 6\n7 8 9\n1 2 3\n4 5 6\n\
                    7 8 9\nincidence 45\n0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9\n1 1 1 1 1 1 1 1 1\n0 0 0 0 0 0 0 0 3e-3\n\
                    lobe transmission both\nchannels 1\nincidence 0\n1 2 3\n4 5 6\n7 8 9\nincidence 45\n1 2 3\n4 5 6\n7 8 9\n";

const ZEMAX: &str = "# small\nSource Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n\
                     SampleRotation 1\n0\nAngleOfIncidence 2\n10\t50\nScatterAzimuth 3\n0\t90\t180\nScatterRadial 3\n0\t5\t90\n\nMonochrome\n\
                     DataBegin\nTIS 0.1\n1e-2 2e-2 3e-2\n1e-2 2e-2 3e-2\n1e-2 2e-2 3e-2\nTIS 0.2\n1 2 3\n4 5 6\n7 8 9\nDataEnd\n";

const WINDOW: &str = "<?xml version=\"1.0\"?>\n<WindowElement><Optical><Layer><DataDefinition><IncidentDataStructure>Columns\
                      </IncidentDataStructure><AngleBasis><AngleBasisName>Two</AngleBasisName><AngleBasisBlock><nPhis>1</nPhis><ThetaBounds>\
                      <LowerTheta>0</LowerTheta><UpperTheta>30</UpperTheta></ThetaBounds></AngleBasisBlock><AngleBasisBlock><nPhis>2</nPhis>\
                      <ThetaBounds><LowerTheta>30</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>\
                      </DataDefinition><WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock><WavelengthDataDirection>\
                      Transmission Front</WavelengthDataDirection><ColumnAngleBasis>Two</ColumnAngleBasis><RowAngleBasis>Two</RowAngleBasis>\
                      <ScatteringData>0.1, 0.2, 0.3,\n0.1, 0.2, 0.3,\n0.4, 0.5, 0.6</ScatteringData></WavelengthDataBlock></WavelengthData>\
                      </Layer></Optical></WindowElement>";

/// Small files of every text format, complete.
fn small() -> [(&'static str, String); 3] {
    [("small.scatter", TEXT.to_owned()), ("small.bsdf", ZEMAX.to_owned()), ("small.xml", WINDOW.to_owned())]
}

#[test]
fn every_truncation_is_a_table_or_a_diagnostic() {
    for (name, text) in small() {
        assert!(
            survives(text.as_bytes(), name, true),
            "{name}: {:?}",
            caustix::files::bsdf::parse(text.as_bytes(), name)
        );
        let read = (0..text.len()).filter(|n| survives(&text.as_bytes()[..*n], name, true)).count();
        println!("{name}: {} truncations, {read} read", text.len());
        // The last number cut short, the end of the file, and a text table without its second lobe.
        assert!(read < 60, "{name}: {read}");
    }
}

#[test]
fn real_files_cut_anywhere_are_tables_or_diagnostics() {
    let Some(folder) = scatter_files::real_folder() else { return };
    for (file, step) in [
        ("zemax/AnoBlackEC1onAlum.bsdf", 7),
        ("klems/2011-SA1-Small-TabSeparated.XML", 7),
        ("klems/aerc6216_kf.xml", 20_011),
    ] {
        let bytes = std::fs::read(folder.join(file)).unwrap();
        let read = (0..bytes.len()).step_by(step).filter(|n| survives(&bytes[..*n], file, false)).count();
        println!("{file}: {read} of {} read", bytes.len() / step);
        assert!(read < 4, "{file}: {read}");
    }
}

const DAMAGE: Damage = Damage { tokens: &TOKENS, changes: 3, cut: 20 };
const TOKENS: [&str; 20] = [
    "nan",
    "-1",
    "0",
    "1e38",
    "-1e308",
    "1e-320",
    "2147483647",
    "99999",
    "1e18",
    ";",
    "lobe",
    "\n",
    "\r",
    "\0",
    "360",
    "180",
    "<",
    "</Layer>",
    "&amp;",
    "incidence",
];

#[test]
fn thousands_of_mutations_are_tables_or_diagnostics() {
    let mut generator = Generator(4);
    for (name, text) in small() {
        let (mut read, mut refused) = (0, 0);
        for i in 0..4000 {
            if survives(&DAMAGE.mutate(text.as_bytes(), &mut generator), name, i % 20 == 0) {
                read += 1
            } else {
                refused += 1
            }
        }
        println!("{name}: {read} read, {refused} refused");
        assert!(read > 50 && refused > 500, "{name}: the mutations reach both ends: {read}, {refused}");
    }
    let opal = std::fs::read(project().join("brdf_tables/phong.scatter")).unwrap();
    for _ in 0..300 {
        survives(&DAMAGE.mutate(&opal, &mut generator), "phong.scatter", false);
    }
}

#[test]
fn counts_that_ask_for_memory_are_refused_at_once() {
    let start = Instant::now();
    let zemax = |from: &str, to: &str| ZEMAX.replacen(from, to, 1);
    for text in [
        zemax("SampleRotation 1", "SampleRotation 99999"),
        zemax("ScatterAzimuth 3", "ScatterAzimuth 2147483647"),
        zemax("AngleOfIncidence 2", "AngleOfIncidence 1e18"),
        zemax("ScatterRadial 3\n0\t5\t90", &format!("ScatterRadial 90000\n{}", list(90_000, 1e-3))),
    ] {
        assert!(!survives(text.as_bytes(), "big.bsdf", false));
    }
    // Lists of 20,000 and 20,000 angles ask for 400 million values; 3000 by 3000 for 9 million, which are not there.
    for n in [20_000, 3_000] {
        let text = format!(
            "caustix-scattering 1\nframe surface\nsymmetry none\ntheta_i 0\npolar {}\nazimuth {}\nlobe reflection both\nincidence 0\n1 2 3",
            list(n, 90.0 / n as f64),
            list(n, 360.0 / n as f64)
        );
        let error = caustix::files::bsdf::parse(text.as_bytes(), "big.scatter").unwrap_err();
        let kind = if n == 20_000 { caustix::error::Kind::Limit } else { caustix::error::Kind::Missing };
        assert_eq!(error.kind(), kind, "{error}");
    }
    let deep = "<a>".repeat(200_000);
    assert!(!survives(deep.as_bytes(), "deep.xml", false));
    let wide = format!("<WindowElement>{}</WindowElement>", "<a/>".repeat(2 << 20));
    assert!(!survives(wide.as_bytes(), "wide.xml", false));
    let comments = "# x\n".repeat(1 << 20);
    assert!(!survives(comments.as_bytes(), "c.bsdf", false));
    let word = "9".repeat(4 << 20);
    assert!(!survives(format!("caustix-scattering 1\ntheta_i {word}").as_bytes(), "w.scatter", false));
    let basis = WINDOW.replacen("<nPhis>2", "<nPhis>4000", 1);
    assert!(!survives(basis.as_bytes(), "basis.xml", false));
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

fn list(n: usize, step: f64) -> String {
    (0..n).map(|i| (step * i as f64).to_string()).collect::<Vec<_>>().join(" ")
}
