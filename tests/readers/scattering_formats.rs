//! Readers of scattering tables on small files: what every field means, and what is said about bad ones.

use caustix::error::Kind;
use caustix::files::bsdf::{Format, merl, parse};
use caustix::scattering::integral::slice_albedo;
use caustix::scattering::value::value;
use caustix::scattering::{Frame, LobeSide, Quantity};
use glam::DVec3;
use std::f64::consts::PI;

use crate::support::scatter_files::merl_file;
use crate::support::tables::incidence;

const PLANE: &str = "caustix-scattering 1\r
name  A plain table   # not of the name\r
# a comment line\r
frame specular\r
symmetry plane\r
theta_i 0, 45\r
polar 0;10;20\r
azimuth 0\t90\t180\r
lobe reflection front\r
incidence 0\r
tis 0.5\r
1 2 3\r
4 5 6 # wrapped below\r
7 8\r
9\r
incidence 45 tis 0.25 10 20 30 40 50 60 70 80 90\r
";

#[test]
fn text_tables_unfold_by_their_symmetry() {
    let table = parse(PLANE.as_bytes(), "a.scatter").unwrap();
    assert_eq!(table.name, "A plain table");
    let lobe = &table.lobes[0];
    assert_eq!(
        (lobe.quantity, lobe.side, lobe.frame),
        (Quantity::Reflection, LobeSide::Front, Frame::Specular)
    );
    assert_eq!(
        (lobe.azimuth_deg.as_slice(), lobe.phi_i_deg.len()),
        ([0.0, 90.0, 180.0, 270.0, 360.0].as_slice(), 1)
    );
    // Rows of the file are azimuths, those of a slice polar angles.
    assert_eq!(lobe.slice(0, 0, 0), [1., 4., 7., 4., 1., 2., 5., 8., 5., 2., 3., 6., 9., 6., 3.]);
    assert_eq!(lobe.slice(0, 0, 1)[6], 50.0);
    assert_eq!(lobe.declared_tis, [0.5, 0.25]);
}

/// About the direction mirrored at 45 degrees one node with a value looks below the horizon: 60 degrees away from the normal, 105
/// degrees from it in all.
#[test]
fn values_below_the_horizon_are_said_and_counted() {
    let text = "caustix-scattering 1
frame specular symmetry plane
theta_i 45
polar 0 30 60 180
azimuth 0 90 180
lobe reflection both
incidence 45
1 1 1 0
1 1 1 0
1 1 7 0";
    let table = parse(text.as_bytes(), "c.scatter").unwrap();
    let found: Vec<&str> = table.warnings.iter().map(|w| w.found()).collect();
    assert_eq!(found, ["1 values of the reflection below the horizon, up to 7/sr"]);
    assert!(value(&table.lobes[0], 0, incidence(45.0, 180.0), incidence(89.9, 0.0)) > 0.0);
    assert!(parse(text.replace('7', "0").as_bytes(), "c.scatter").unwrap().warnings.is_empty());
}

#[test]
fn rotational_and_coloured_lobes_share_a_header() {
    let text = "caustix-scattering 1
frame surface symmetry rotational channels 3
theta_i 0
polar 0 90
lobe reflection both incidence 0 0.1 0.2 0.3 0.4 0.5 0.6
lobe transmission both
channels 1
incidence 0 0.7 0.8";
    let table = parse(text.as_bytes(), "b.txt").unwrap();
    assert_eq!(table.name, "b.txt");
    assert_eq!(table.lobes[0].channels, 3);
    assert_eq!(table.lobes[0].slice(2, 0, 0), [0.5, 0.5, 0.5, 0.6, 0.6, 0.6]);
    assert_eq!((table.lobes[1].quantity, table.lobes[1].values[3]), (Quantity::Transmission, 0.8));
}

/// A pattern with the symmetry: a surface with planes of symmetry along and across x may depend on cos 2 phi_i, on cos a, and on sin a
/// only times sin 2 phi_i.
fn orthotropic(phi_i: f64, azimuth: f64) -> f64 {
    let (p, a) = (phi_i.to_radians(), azimuth.to_radians());
    5.0 + (2.0 * p).cos() + 0.5 * a.cos() + 0.7 * a.sin() * (2.0 * p).sin()
}

#[test]
fn orthotropic_tables_are_the_whole_turn_of_their_quarter() {
    let mut text =
        "caustix-scattering 1\nframe specular\nsymmetry orthotropic\ntheta_i 30\nphi_i 0 30 90\npolar 0 10\n\
                    azimuth 0 60 120 180 240 300\nlobe transmission back\n"
            .to_owned();
    for phi in [0.0, 30.0, 90.0] {
        text += &format!("incidence 30 {phi} tis {}\n", phi / 100.0);
        for a in 0..6 {
            let f = orthotropic(phi, 60.0 * f64::from(a));
            text += &format!("{f} {f}\n");
        }
    }
    let table = parse(text.as_bytes(), "c.scatter").unwrap();
    let lobe = &table.lobes[0];
    assert_eq!(lobe.side, LobeSide::Back);
    assert_eq!(lobe.phi_i_deg, [0.0, 30.0, 90.0, 150.0, 180.0, 210.0, 270.0, 330.0, 360.0]);
    for (p, phi) in lobe.phi_i_deg.iter().enumerate() {
        for (j, a) in lobe.azimuth_deg.iter().enumerate() {
            let (own, expected) = (f64::from(lobe.slice(0, p, 0)[j]), orthotropic(*phi, *a));
            assert!((own - expected).abs() < 1e-6, "{phi} {a}: {own} {expected}");
        }
    }
    assert_eq!(lobe.declared(3, 0), Some(0.3));
}

/// Kind, line and column of the diagnostic that a text gives.
fn refused(text: &str) -> (Kind, usize, usize) {
    let error = parse(text.as_bytes(), "bad.scatter").unwrap_err();
    assert_eq!(error.file(), Some("bad.scatter"), "{error}");
    (error.kind(), error.line().unwrap(), error.column().unwrap())
}

#[test]
fn bad_text_tables_are_refused_at_their_place() {
    for (from, to, expected) in [
        ("caustix-scattering 1", "caustix-scattering 2", (Kind::Unavailable, 1, 20)),
        ("frame specular", "frame mirror", (Kind::Unknown, 4, 7)),
        ("symmetry plane", "", (Kind::Missing, 9, 1)),
        ("symmetry plane", "symetry plane", (Kind::Unknown, 5, 1)),
        ("theta_i 0, 45", "theta_i 45, 0", (Kind::Range, 9, 1)),
        ("theta_i 0, 45", "theta_i 0, x", (Kind::Syntax, 6, 12)),
        ("theta_i 0, 45", "theta_i", (Kind::Missing, 6, 1)),
        ("azimuth 0\t90\t180", "azimuth 0\t90\t170", (Kind::Range, 9, 1)),
        ("incidence 45", "incidence 44", (Kind::Range, 16, 11)),
        ("incidence 45 tis 0.25", "incidence 45", (Kind::Missing, 16, 13)),
        ("lobe reflection", "lobe refraction", (Kind::Unknown, 9, 6)),
        ("80 90", "80", (Kind::Missing, 17, 1)),
        ("80 90", "80 90 91", (Kind::Unknown, 16, 50)),
        ("80 90", "80 nan", (Kind::Syntax, 16, 47)),
        ("80 90", "80 1e40", (Kind::Range, 16, 47)),
        ("polar 0;10;20", "polar 0;10;200", (Kind::Range, 17, 1)),
        ("lobe reflection front", "lobe reflection front lobe", (Kind::Missing, 9, 1)),
    ] {
        let text = PLANE.replace(from, to);
        assert_ne!(text, PLANE, "{from}");
        assert_eq!(refused(&text), expected, "{from} -> {to}: {:?}", parse(text.as_bytes(), "bad.scatter"));
    }
    let negative = parse(PLANE.replace("80 90", "80 -90").as_bytes(), "n.scatter").unwrap();
    assert!(
        negative.warnings.iter().any(|w| w.found().starts_with("1 negative values of 30")),
        "{:?}",
        negative.warnings
    );
}

/// A Zemax file of 2 rotations, 2 incidences, 3 azimuths, 2 radial angles; `spectra` heads its blocks, and value number n of
/// block b is `f(b, n)`.
fn zemax(header: &str, spectra: &[&str], rotations: usize, f: impl Fn(usize, usize) -> f64) -> String {
    let mut text = format!("# made for a test\n{header}\n");
    for (b, name) in spectra.iter().enumerate() {
        text += &format!("\n{name}\nDataBegin\n");
        let mut n = 0;
        for block in 0..rotations * 2 {
            text += &format!("TIS\t0.{block}{b}\n");
            for _ in 0..3 {
                text += &format!("{:.6e}\t{:.6e}\t\n", f(b, n), f(b, n + 1));
                n += 2;
            }
        }
        text += "DataEnd\n";
    }
    text
}

const ZEMAX: &str = "Source  Measured\nSymmetry  ASymmetrical4D\nSpectralContent  XYZ\nScatterType  BTDF\nSampleRotation  2\n0\t90\n\
                     AngleOfIncidence  2\n10\t50\t\nScatterAzimuth 3\n0\t120\t240\nScatterRadial 2\n0\t5";

#[test]
fn zemax_rotations_azimuths_and_colours() {
    // White of n/10: X, Y and Z of D65 at full reflection are 0.9505, 1, 1.089.
    let white = [0.9505, 1.0, 1.089];
    let text = zemax(ZEMAX, &["TristimulusY", "TristimulusX", "TristimulusZ"], 2, |b, n| {
        white[[1, 0, 2][b]] * 0.1 * n as f64
    });
    let table = parse(text.as_bytes(), "z.bsdf").unwrap();
    let lobe = &table.lobes[0];
    assert_eq!((lobe.quantity, lobe.frame, lobe.channels), (Quantity::Transmission, Frame::Specular, 3));
    assert_eq!(lobe.azimuth_deg, [0.0, 120.0, 240.0, 360.0]);
    // Rotations 0 and 90 are light from 360 and 270; the turn is closed with 270 + 360.
    assert_eq!(lobe.phi_i_deg, [270.0, 360.0, 630.0]);
    for channel in 0..3 {
        // Rotation 90, incidence 50: values 18 to 23; nodes [polar][azimuth].
        let expected = [1.8, 2.0, 2.2, 1.8, 1.9, 2.1, 2.3, 1.9];
        let slice = lobe.slice(channel, 0, 1);
        assert!(slice.iter().zip(expected).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-6), "{slice:?}");
        assert!((f64::from(lobe.slice(channel, 1, 0)[1]) - 0.2).abs() < 1e-6);
    }
    // Y's totals: first block of the file, numbers 0.00, 0.10, 0.20, 0.30.
    assert_eq!(lobe.declared_tis, [0.2, 0.3, 0.0, 0.1, 0.2, 0.3]);
}

#[test]
fn bad_zemax_files_are_refused_at_their_place() {
    let header = ZEMAX.replace("XYZ", "Monochrome");
    let good = zemax(&header, &["Monochrome"], 2, |_, n| n as f64);
    assert!(parse(good.as_bytes(), "g.bsdf").is_ok());
    for (from, to, expected) in [
        ("Symmetry  ASymmetrical4D", "Symmetry  Lopsided", (Kind::Unknown, 3, 11)),
        ("ScatterType", "ScatterKind", (Kind::Unknown, 5, 1)),
        ("SampleRotation  2", "SampleRotation  2.5", (Kind::Limit, 6, 17)),
        ("SampleRotation  2", "SampleRotation  1e9", (Kind::Limit, 6, 17)),
        ("10\t50", "50\t10", (Kind::Range, 15, 1)),
        ("\n0\t5\n", "\n0\tfive\n", (Kind::Syntax, 13, 3)),
        ("AngleOfIncidence  2\n10\t50\t\n", "", (Kind::Missing, 13, 1)),
        ("DataBegin", "Data", (Kind::Syntax, 16, 1)),
        ("TIS\t0.10", "TI\t0.10", (Kind::Syntax, 21, 1)),
        ("DataEnd", "", (Kind::Missing, 34, 1)),
        ("DataEnd", "7\nDataEnd", (Kind::Syntax, 33, 1)),
        ("DataEnd", "DataEnd\nMonochrome\nDataBegin", (Kind::Syntax, 34, 1)),
        ("\nMonochrome\n", "\nTristimulusY\n", (Kind::Syntax, 15, 1)),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let error = parse(text.as_bytes(), "bad.bsdf").unwrap_err();
        let found = (error.kind(), error.line().unwrap(), error.column().unwrap());
        assert_eq!(found, expected, "{from} -> {to}: {error}");
    }
    let plane = good.replace("ASymmetrical4D", "PlaneSymmetrical");
    assert_eq!(parse(plane.as_bytes(), "p.bsdf").unwrap_err().kind(), Kind::Range, "azimuths 0 to 240");
    let missing = zemax(ZEMAX, &["TristimulusX", "TristimulusZ"], 2, |_, _| 1.0);
    assert_eq!(parse(missing.as_bytes(), "m.bsdf").unwrap_err().kind(), Kind::Missing);
}

/// A window file of a basis of two rings, one patch up to 30 degrees and four beyond.
fn window(structure: &str, direction: &str, matrix: &[f64]) -> String {
    let block = |theta: f64, from: f64, to: f64, n: usize| {
        format!(
            "<AngleBasisBlock><Theta>{theta}</Theta><nPhis>{n}</nPhis><ThetaBounds><LowerTheta>{from}</LowerTheta>\
             <UpperTheta>{to}</UpperTheta></ThetaBounds></AngleBasisBlock>"
        )
    };
    let basis = format!(
        "<AngleBasis><AngleBasisName>Two</AngleBasisName>{}{}</AngleBasis>",
        block(0.0, 0.0, 30.0, 1),
        block(60.0, 30.0, 90.0, 4)
    );
    let numbers = matrix.iter().map(|x| x.to_string()).collect::<Vec<_>>().join(",\n ");
    format!(
        "<?xml version=\"1.0\"?>\n<WindowElement xmlns=\"http://windows.lbl.gov\"><Optical><Layer><Material><Name>pane</Name></Material>\
         <DataDefinition><IncidentDataStructure>{structure}</IncidentDataStructure>{basis}</DataDefinition>\
         <WavelengthData><Wavelength unit=\"Integral\">Solar</Wavelength></WavelengthData>\
         <WavelengthData><Wavelength unit=\"Integral\">Visible</Wavelength><WavelengthDataBlock>\
         <WavelengthDataDirection>{direction}</WavelengthDataDirection><ColumnAngleBasis>Two</ColumnAngleBasis>\
         <RowAngleBasis>Two</RowAngleBasis><ScatteringData>\n{numbers}\n</ScatteringData>\
         </WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>"
    )
}

#[test]
fn klems_azimuths_turn_the_right_way_on_both_sides() {
    // Scattered patch o of incident patch i: 10 o + i, times 0.001; columns are incident.
    let matrix: Vec<f64> = (0..25).map(|n| 0.001 * f64::from(10 * (n / 5) + n % 5)).collect();
    for (side, name) in [(LobeSide::Back, "Reflection Back"), (LobeSide::Front, "Reflection Front")] {
        let table = parse(window("Columns", name, &matrix).as_bytes(), "w.xml").unwrap();
        assert_eq!((table.name.as_str(), table.lobes[0].side), ("pane", side));
        // Incident patch 2, azimuth 90: light from azimuth 270 of the room's view, -90 of the front's.
        let wi = if side == LobeSide::Back { incidence(60.0, 270.0) } else { incidence(60.0, 90.0) };
        for (patch, azimuth) in [(1, 0.0), (2, 90.0), (3, 180.0), (4, 270.0)] {
            let seen = if side == LobeSide::Back { azimuth } else { -azimuth };
            let (own, expected) =
                (value(&table.lobes[0], 0, wi, incidence(60.0, seen)), 0.01 * f64::from(patch) + 0.002);
            assert!((own / expected - 1.0).abs() < 2e-3, "{name} {patch}: {own} {expected}");
        }
        let (own, expected) = (value(&table.lobes[0], 0, DVec3::Z, incidence(15.0, 10.0)), 0.0);
        assert!((own - expected).abs() < 1e-9, "{own}");
    }
    let columns = parse(window("Columns", "Transmission Front", &matrix).as_bytes(), "w.xml").unwrap();
    let turned: Vec<f64> = (0..25).map(|n| matrix[n % 5 * 5 + n / 5]).collect();
    let rows = parse(window("Rows", "Transmission Front", &turned).as_bytes(), "w.xml").unwrap();
    assert_eq!(columns.lobes, rows.lobes);
    // Flux by patches: incident patch 0, scattered 10 o.
    let cap = PI * 0.25;
    let expected = (0.0 + (0.01 + 0.02 + 0.03 + 0.04) * (PI - cap) / 4.0).max(0.0);
    let own = slice_albedo(&columns.lobes[0], 0, 0, 0);
    assert!((own / expected - 1.0).abs() < 2e-3, "{own} {expected}");
}

#[test]
fn bad_window_files_are_refused_with_a_place() {
    let matrix = [0.1; 25];
    let good = window("Columns", "Transmission Front", &matrix);
    for (from, to, kind) in [
        ("Columns", "Diagonals", Kind::Unknown),
        ("Columns", "TensorTree4", Kind::Unavailable),
        ("<UpperTheta>90", "<UpperTheta>80", Kind::Missing),
        ("<LowerTheta>30", "<LowerTheta>35", Kind::Range),
        ("<nPhis>4", "<nPhis>1e9", Kind::Limit),
        ("<nPhis>4", "<nPhis>5", Kind::Missing),
        ("<nPhis>4", "<nPhis>3", Kind::Range),
        ("Transmission Front", "Transmission Side", Kind::Unknown),
        ("<ColumnAngleBasis>Two", "<ColumnAngleBasis>Three", Kind::Unknown),
        ("0.1,\n", "0.1,\nx ", Kind::Syntax),
        ("Visible", "Infrared", Kind::Missing),
        ("</Optical>", "", Kind::Syntax),
        ("<WindowElement ", "<Window ", Kind::Syntax),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let error = parse(text.as_bytes(), "w.xml").unwrap_err();
        assert_eq!(error.kind(), kind, "{from} -> {to}: {error}");
        assert!(error.line().is_some() && error.column().is_some(), "{error}");
    }
    let error = parse(good.replacen("0.1,\n 0.1,", "0.1,\n x,", 1).as_bytes(), "w.xml").unwrap_err();
    assert_eq!((error.line(), error.column()), (Some(4), Some(2)), "places are the file's: {error}");
    let entities =
        "<!DOCTYPE a [<!ENTITY b \"ccc\"><!ENTITY d \"&b;&b;\">]><WindowElement>&d;</WindowElement>";
    assert!(parse(entities.as_bytes(), "w.xml").is_err());
}

/// f of the synthetic MERL file: a diffuse part and a lobe about the half vector, in half and difference angles.
fn measured(theta_h: f64, theta_d: f64) -> [f64; 3] {
    let lobe = (-(theta_h / 0.3) * (theta_h / 0.3)).exp() * (1.0 + 0.5 * theta_d);
    [0.05 + lobe, 0.1 + 0.5 * lobe, 0.2]
}

#[test]
fn merl_files_are_resampled_about_the_specular_direction() {
    let bytes = merl_file(|h, d, _| measured(h, d));
    assert_eq!((bytes.len(), Format::of(&bytes, "x").unwrap()), (merl::FILE_BYTES, Format::Merl));
    let table = parse(&bytes, "gold.binary").unwrap();
    let lobe = &table.lobes[0];
    assert_eq!((lobe.channels, lobe.frame, lobe.side), (3, Frame::Specular, LobeSide::Both));
    let mut worst = [0.0f64; 3];
    for (ti, to, phi) in
        [(0.0, 20.0, 30.0), (30.0, 30.0, 0.0), (30.0, 45.0, 100.0), (52.0, 47.0, 10.0), (70.0, 60.0, 181.0)]
    {
        let (wi, wo) = (incidence(ti, 180.0), incidence(to, phi));
        let half = (wi + wo).normalize();
        let expected = measured(half.z.acos(), wi.dot(half).acos());
        for c in 0..3 {
            let own = value(lobe, c, wi, wo);
            worst[c] = worst[c].max((own / expected[c] - 1.0).abs());
        }
    }
    println!("worst relative errors {worst:?}");
    assert!(worst.iter().all(|w| *w < 0.02), "{worst:?}");
    // The constant channel is Lambert's: albedo 0.2 pi, but for steps of 5 degrees.
    let albedo = slice_albedo(lobe, 2, 0, 6);
    assert!((albedo / (0.2 * PI) - 1.0).abs() < 0.01, "{albedo}");
}

#[test]
fn merl_bins_that_were_not_measured_are_counted() {
    let bytes = merl_file(|h, d, bin| if bin >= 60 { [-1.0; 3] } else { measured(h, d) });
    let table = parse(&bytes, "m.binary").unwrap();
    assert!(table.warnings.iter().any(|w| w.found().contains("not measured")), "{:?}", table.warnings);
    for (damaged, kind) in [
        (&bytes[..bytes.len() - 1], Kind::Missing),
        (&[&bytes[..], &[0]].concat()[..], Kind::Limit),
        (&bytes[..12], Kind::Missing),
    ] {
        assert_eq!(parse(damaged, "m.binary").unwrap_err().kind(), kind);
    }
    let mut bad = bytes;
    bad[20..28].copy_from_slice(&f64::NAN.to_le_bytes());
    assert_eq!(parse(&bad, "m.binary").unwrap_err().kind(), Kind::Range);
    assert_eq!(parse(&[1, 2, 3], "m.binary").unwrap_err().kind(), Kind::Syntax);
}

#[test]
fn the_content_decides_the_format() {
    for (bytes, name, expected) in [
        (&b"caustix-scattering 1"[..], "x.bsdf", Ok(Format::Text)),
        (b"# c\n\nSource Measured", "x.txt", Ok(Format::Zemax)),
        (b"  <?xml version=\"1.0\"?>", "x.bsdf", Ok(Format::Klems)),
        (b"garbage", "x.BSDF", Ok(Format::Zemax)),
        (b"", "x.xml", Err(Kind::Missing)),
        (b"garbage", "x.xml", Ok(Format::Klems)),
        (b"garbage", "x.dat", Err(Kind::Unknown)),
        (b"", "x", Err(Kind::Missing)),
        (b"tensor_file\0", "x.bsdf", Err(Kind::Unavailable)),
        (b"type bsdf_data", "x.txt", Err(Kind::Unavailable)),
        (b"OPTIS - brdf surface file v8.0", "x.brdf", Err(Kind::Unavailable)),
    ] {
        assert_eq!(Format::of(bytes, name).map_err(|e| e.kind()), expected, "{name}");
    }
    assert_eq!(caustix::files::bsdf::read("no/such.bsdf").unwrap_err().kind(), Kind::Io);
}

#[test]
fn values_are_interpolated_in_f_cos() {
    // f = 1/pi on nodes of 30 degrees: g is bilinear in cos at the nodes.
    let text = "caustix-scattering 1\nframe surface\nsymmetry rotational\ntheta_i 0\npolar 0 30 60 90\nlobe reflection both\n\
                incidence 0\n0.5 0.5 0.5 0.5";
    let table = parse(text.as_bytes(), "l.scatter").unwrap();
    let lobe = &table.lobes[0];
    let cos = |deg: f64| deg.to_radians().cos();
    for (theta, g) in
        [(30.0, 0.5 * cos(30.0)), (40.0, 0.5 * (2.0 * cos(30.0) + cos(60.0)) / 3.0), (75.0, 0.25 * cos(60.0))]
    {
        let own = value(lobe, 0, incidence(70.0, 20.0), incidence(theta, 250.0));
        assert!((own * cos(theta) - g).abs() < 1e-15, "{theta}: {own}");
    }
    assert_eq!(value(lobe, 0, DVec3::Z, -DVec3::Z), 0.0, "no light to the other side");
    assert_eq!(value(lobe, 0, -DVec3::Z, DVec3::Z), 0.0, "nor from it");
}
