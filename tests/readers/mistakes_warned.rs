//! Mistakes of new users in scenes that can be traced: warnings, and none where the same is right.

use caustix::error::warning::{Severity, Warning};
use caustix::files::{bsdf, photometric, scene_toml};
use caustix::photometry::Summary;
use caustix::report::statistics::ReceiverStatistics;
use caustix::report::text::summary;
use caustix::run::warnings;
use caustix::scene::Scene;
use caustix::sequence::Sequence;
use caustix::surface::tabulated::{Options, Tabulated};
use std::fs;

use crate::broken_scene::{BLACK, LAMP, PLATE, RECEIVER};
use crate::support::data;
use crate::support::png::{grey_8, grey_16};
use crate::support::scenes::run;

/// The scene of a text beside these files.
fn scene(text: &str, files: &[(&str, &[u8])]) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    scene_toml::read_scene(folder.path().join("scene.toml")).unwrap_or_else(|e| panic!("{e:?}\n{text}"))
}

/// What is found in a scene: nothing, or this.
fn found(scene: &Scene, code: &str) -> Option<Warning> {
    scene.found.iter().for_each(|warning| println!("{warning}"));
    assert!(scene.found.iter().all(|warning| warning.code == code), "{:?}", scene.found);
    scene.found.first().cloned()
}

/// The warnings of the text of a scene.
fn told(text: &str) -> Vec<String> {
    scene(text, &[]).warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn rotations_in_radians_are_told() {
    let rotated = |angles: &str| told(&format!("{LAMP}{BLACK}{PLATE}rotate_deg = {angles}\n{RECEIVER}"));
    for (angles, degrees) in [
        ("[1.5708, 0, 0]", "90"),
        ("[0, 0, 3.14159]", "180"),
        ("[0, -0.7854, 0]", "-45"),
        ("[0, 0.524, 0.5236]", "30"),
        ("[0, 0, 1.57]", "90"),
        ("[2.0944, 0, 0]", "120"),
    ] {
        let said = rotated(angles);
        assert_eq!(said.len(), 1, "{angles}: {said:?}");
        assert!(said[0].contains(&format!("radians are {degrees} degrees")), "{said:?}");
    }
    for angles in ["[90, 0, 0]", "[1.5, 0, 45]", "[0.5, 1, 2]", "[3, 6, 0.1]", "[0, 0, 0]", "[360, 1.6, 3.2]"]
    {
        assert_eq!(rotated(angles), Vec::<String>::new(), "{angles}");
    }
}

/// A table whose value is 0.25 times what `value` makes of the polar angle in degrees; its last angles are divided by `unit`.
fn table(value: impl Fn(f64) -> f64, unit: f64, theta_i: &[f64]) -> String {
    let polar: Vec<f64> = (0..=90).map(f64::from).collect();
    let list = |angles: &[f64]| angles.iter().map(|a| format!(" {:.6}", a / unit)).collect::<String>();
    let row: String = polar.iter().map(|a| format!(" {:.6}", 0.25 * value(*a))).collect();
    let blocks: String = theta_i.iter().map(|t| format!("incidence {:.6}\n{row}\n", t / unit)).collect();
    format!(
        "caustix-scattering 1\nframe surface\nsymmetry rotational\nchannels 1\ntheta_i{}\npolar{}\nlobe reflection both\n{blocks}",
        list(theta_i),
        list(&polar)
    )
}

fn parsed(text: &str) -> caustix::scattering::ScatterTable {
    bsdf::parse(text.as_bytes(), "a.scatter").unwrap()
}

#[test]
fn scattering_angles_in_radians_are_told() {
    let angles = [0.0, 30.0, 60.0, 89.0];
    let told = |unit: f64, theta_i: &[f64]| {
        let warnings = parsed(&table(|_| 1.0, unit, theta_i)).warnings;
        warnings
            .iter()
            .filter_map(|w| w.advice().map(str::to_owned))
            .filter(|a| a.contains("radians"))
            .collect()
    };
    let in_radians: Vec<String> = told(1f64.to_degrees(), &angles);
    // 89 degrees, and the six digits of it.
    assert_eq!(in_radians, ["radians? 1.553343 radians are 89.0 degrees"]);
    assert_eq!(told(1f64.to_degrees(), &[0.0]), ["radians? 1.570796 radians are 90.0 degrees"]);
    assert_eq!(told(1.0, &angles), Vec::<String>::new());
}

/// A floor of a table.
const FLOOR: &str = "[material.floor]\ntype = \"tabulated\"\nfile = \"a.scatter\"\n";

#[test]
fn values_in_per_cent_are_asked_for_and_those_with_the_cosine_are_told() {
    let errors = |factor: f64| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.scatter"), table(|_| factor, 1.0, &[0.0])).unwrap();
        let text = format!("{LAMP}{FLOOR}{}", PLATE.replace("black", "floor"));
        scene_toml::parse_scene(&text, folder.path()).unwrap_err()
    };
    // Lambertian of f = 0.25 /sr: an albedo of pi / 4, which is 78.54 in per cent.
    let advice = |factor: f64| errors(factor)[0].advice().unwrap().to_owned();
    let in_per_cent = advice(100.0);
    let [asks, offers] = ["per cent", "energy = \"scale\""].map(|words| in_per_cent.find(words));
    assert!(asks.is_some() && asks < offers, "{in_per_cent}");
    assert!(errors(100.0)[0].found().contains("an albedo of 78.5"), "{}", errors(100.0)[0]);
    assert!(!advice(1.5).contains("per cent"), "{}", advice(1.5));

    let text = format!("{LAMP}{FLOOR}{}", PLATE.replace("black", "floor"));
    let of = |table: String| scene(&text, &[("a.scatter", table.as_bytes())]);
    assert_eq!(found(&of(table(|_| 1.0, 1.0, &[0.0])), ""), None);
    let cosine = table(|polar| polar.to_radians().cos(), 1.0, &[0.0]);
    let defect = Tabulated::new(&parsed(&cosine), &Options::default()).unwrap().0.with_cosine().unwrap();
    // By hand: c = cos of either direction, independent, sin^2 even up to s = sin^2 85 degrees. The mean square of c - c' is twice
    // the variance of c, and the mean square of f is that of c.
    let s = 85f64.to_radians().sin().powi(2);
    let (mean, square) = (2.0 / 3.0 * (1.0 - (1.0 - s).powf(1.5)) / s, 1.0 - 0.5 * s);
    let by_hand = (2.0 * (square - mean * mean) / square).sqrt();
    assert!((defect.as_it_stands / by_hand - 1.0).abs() < 0.02, "{defect:?}, {by_hand}");
    assert!(defect.divided < 1e-3, "{defect:?}");
    let warning = found(&of(cosine), "cosine-in-table").unwrap();
    assert_eq!((warning.severity, warning.surfaces), (Severity::Doubtful, vec!["plate".to_owned()]));
    assert!(
        warning.message.contains(&format!("by {:.0} %", 100.0 * defect.as_it_stands)),
        "{}",
        warning.message
    );
}

#[test]
fn no_own_or_real_table_is_suspected() {
    let own = fs::read_dir(data::project().join("brdf_tables")).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = own.filter(|path| path.extension().is_some_and(|e| e == "scatter")).collect();
    assert!(files.len() > 4, "{files:?}");
    let folders =
        data::real_folder().into_iter().flat_map(|f| ["zemax", "klems"].map(|k| f.join("brdf").join(k)));
    files.extend(folders.flat_map(|folder| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path())));
    for path in files {
        let Ok(table) = bsdf::read(&path) else { continue };
        let radians = table.warnings.iter().any(|w| w.advice().is_some_and(|a| a.contains("radians")));
        assert!(!radians, "{}: {:?}", path.display(), table.warnings);
        assert_eq!(caustix::scattering::reciprocity::with_cosine(&table), None, "{}", path.display());
    }
}

#[test]
fn a_flux_far_from_the_files_own_is_told() {
    let file = data::own_file("spot.ies");
    let own_lm = Summary::new(&photometric::read(&file).unwrap()).flux_emitted_lm;
    let with = |flux: &str| {
        let lamp =
            "[[emitter]]\ntype = \"photometric\"\nname = \"lamp\"\nfile = \"a.ies\"\nposition = [0, 0, 2]\n";
        scene(&format!("{lamp}{flux}{BLACK}{PLATE}{RECEIVER}"), &[("a.ies", &fs::read(&file).unwrap())])
    };
    for flux in ["", "flux_lm = 1000\n", "flux_lm = 50\n"] {
        assert_eq!(found(&with(flux), ""), None, "{flux}");
    }
    for (flux_lm, shown) in [(12000.0, "12000"), (20.0, "20.00")] {
        let warning = found(&with(&format!("flux_lm = {flux_lm}\n")), "flux-of-file").unwrap();
        assert_eq!(warning.severity, Severity::Note);
        let words = format!("flux_lm = {shown}, ");
        assert!(warning.message.contains(&words), "{}", warning.message);
        let factor: f64 =
            warning.message.split(&words).nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!((factor * own_lm / flux_lm - 1.0).abs() < 1e-3, "{factor}, {own_lm}");
        assert!(
            warning.message.contains(&format!("{own_lm:.1} lm of its file")),
            "{own_lm}: {}",
            warning.message
        );
    }
}

#[test]
fn steps_of_8_bits_are_told_where_they_make_facets() {
    let png = |deep: bool| {
        let shares = (0..17 * 17).map(|i| (i % 17, i / 17)).map(|(x, y)| f64::from(x * x + y * y) / 512.0);
        if deep {
            grey_16([17, 17], &shares.map(|g| (g * 65535.0) as u16).collect::<Vec<_>>())
        } else {
            grey_8([17, 17], &shares.map(|g| (g * 255.0) as u8).collect::<Vec<_>>())
        }
    };
    let field = |material: &str, top: f64, deep: bool| {
        let relief = format!(
            "[material.it]\n{material}\n[[surface]]\nname = \"lens\"\ntype = \"heightfield\"\nmaterial = \"it\"\n\
             origin = [0, 0, 1]\nsize = [0.16, 0.32]\nfacing = \"up\"\nimage = \"a.png\"\nheight = [0, {top}]\n"
        );
        scene(&format!("{LAMP}{BLACK}{PLATE}{RECEIVER}{relief}"), &[("a.png", &png(deep))])
    };
    let (glass, mirror) = ("type = \"dielectric\"\nior = 1.5", "type = \"mirror\"");
    // Steps of 0.1 mm over pixels of 10 mm: 0.57 degrees.
    for material in [glass, mirror] {
        let warning = found(&field(material, 0.0255, false), "steps-of-image").unwrap();
        assert_eq!((warning.severity, &warning.surfaces[..]), (Severity::Doubtful, &["lens".to_owned()][..]));
        let slope_deg = (1e-4f64 / 0.01).atan().to_degrees();
        assert!(warning.message.contains(&format!("{slope_deg:.1} degrees")), "{}", warning.message);
        assert!(warning.message.contains("1.00e-4 m"), "{}", warning.message);
        assert_eq!(found(&field(material, 0.0255, true), ""), None);
        assert_eq!(found(&field(material, 0.0025, false), ""), None);
    }
    assert_eq!(found(&field("type = \"lambertian\"\nreflectance = 0.5", 0.0255, false), ""), None);
}

/// A cube of 0.4 m over the plate.
fn cube() -> String {
    let corners = (0..8).map(|k| {
        let at = |bit: u32, from: f64| from + if k >> bit & 1 == 1 { 0.4 } else { 0.0 };
        format!("v {} {} {}\n", at(0, 0.3), at(1, 0.3), at(2, 1.0))
    });
    corners.collect::<String>() + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

const MESH: &str = "[material.glass]\ntype = \"dielectric\"\nior = 1.5\n[[surface]]\nname = \"block\"\ntype = \"mesh\"\n\
                    material = \"glass\"\nfile = \"a.obj\"\n";

#[test]
fn smooth_normals_over_sharp_edges_are_named_with_the_remedy() {
    let of = |more: &str| {
        let lamp = LAMP.replace("[0, 0, 2]", "[0.45, 0.55, 1.5]");
        let text = format!("{lamp}{BLACK}{PLATE}{RECEIVER}{MESH}{more}");
        let scene = scene(&text, &[("a.obj", cube().as_bytes())]);
        warnings(&scene, &run(&scene, Sequence::SobolOwen, 1 << 10, 2, 1))
    };
    let said = of("smooth = true\n");
    let warning =
        said.iter().find(|w| w.code == "corrected-directions").unwrap_or_else(|| panic!("{said:?}"));
    println!("{warning}");
    assert_eq!(warning.surfaces, ["block"]);
    // The normal at a corner, along the diagonal.
    let tilt_deg = (1.0 / 3f64.sqrt()).acos().to_degrees();
    assert!(warning.message.contains(&format!("up to {tilt_deg:.0} degrees")), "{warning}");
    assert!(warning.remedy.contains("smooth = false"), "{warning}");
    assert!(of("smooth = false\n").iter().all(|w| w.code != "corrected-directions"));
}

#[test]
fn volumes_and_counts_are_told_as_one_would_say_them() {
    // Each face turned round.
    let cube = cube();
    let turned = cube.lines().map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
        ["f", a, b, c, d] => format!("f {d} {c} {b} {a}\n"),
        _ => format!("{line}\n"),
    });
    let turned: String = turned.collect();
    let scene = scene(&format!("{LAMP}{BLACK}{PLATE}{RECEIVER}{MESH}"), &[("a.obj", turned.as_bytes())]);
    let said: Vec<_> = scene.warnings.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|w| w.contains("of volume -0.06400 m3")), "{said:?}");

    let scene = self::scene(&format!("{LAMP}{BLACK}{PLATE}{RECEIVER}"), &[]);
    for (replicates, words) in [(1, "= 1 replicate x 1 024;"), (2, "= 2 replicates x 1 024;")] {
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 10, replicates, 1);
        let receivers = scene.receivers.iter().enumerate();
        let statistics: Vec<_> = receivers.map(|(i, r)| ReceiverStatistics::new(&outcome, r, i)).collect();
        let text = summary(&scene, &outcome, &statistics, &[vec![]], 1.0);
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn no_own_scene_is_suspected() {
    let codes = ["flux-of-file", "cosine-in-table", "steps-of-image"];
    let mut seen = 0;
    for entry in fs::read_dir(data::project().join("scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let scene = scene_toml::read_scene(&path).unwrap_or_else(|e| panic!("{e:?}"));
        assert!(
            scene.found.iter().all(|w| !codes.contains(&w.code)),
            "{}: {:?}",
            path.display(),
            scene.found
        );
        assert!(scene.warnings.iter().all(|w| !w.to_string().contains("radians")), "{}", path.display());
        seen += 1;
    }
    assert!(seen >= 10, "{seen}");
}
