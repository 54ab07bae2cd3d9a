//! The command as a stranger types it: exit codes and messages.

use std::fs;

use crate::absorber::SCENE;
use crate::support::data::in_project;
use crate::support::stranger::Stranger;

#[test]
fn unknown_options_are_told_those_that_they_may_be() {
    let s = Stranger::new();
    s.is_told("render --photon 1", 2, &["'--photon'", "'--photons'"]);
    s.is_told("check --error", 2, &["'--error'"]);
    assert_eq!(fs::read_dir(s.folder()).unwrap().count(), 0);
}

#[test]
fn wrong_usage_exits_2_and_help_and_version_exit_0() {
    let s = Stranger::new();
    for line in ["frobnicate", "render --photons", "render a b", "photometry", "render --threads x"] {
        s.is_told(line, 2, &["error:"]);
    }
    // A number that is none is told with what is required, negative ones included: they are no options.
    for (line, option, required) in [
        ("render --seed x", "'x' for '--seed <K>'", "from 0 to 2^64 - 1"),
        ("render --seed -1", "'-1' for '--seed <K>'", "from 0 to 2^64 - 1"),
        ("render --seed 1.5", "'1.5' for '--seed <K>'", "from 0 to 2^64 - 1"),
        ("render --replicates -8", "'-8' for '--replicates <R>'", "from 1 to 65536"),
        ("render --threads x", "'x' for '--threads <T>'", "from 1 to 1024"),
    ] {
        s.is_told(line, 2, &["error: invalid value ", option, "required: a whole number ", required]);
    }
    for line in
        ["--help", "--version", "help", "help render", "render --help", "photometry --help", "check --help"]
    {
        let (code, out, err) = s.types(line);
        assert_eq!((code, err.as_str()), (0, ""), "{line}");
        assert!(out.contains("caustix"), "{line}");
    }
    for line in ["--help", "help"] {
        let (_, out, _) = s.types(line);
        assert!(out.contains("Without a command the built-in scene is rendered"), "{line}\n{out}");
    }
    assert_eq!(s.types("help render").1, s.types("render --help").1);
}

#[test]
fn photons_are_saved_and_seen_again_by_a_camera_alone() {
    let s = Stranger::new();
    fs::write(s.path("plate.toml"), SCENE).unwrap();
    s.is_told("render plate.toml --map old.map", 1, &["--map", "without [camera]", "a scene with a camera"]);
    s.is_told("render plate.toml --save-map new.map", 1, &["--save-map", "without [camera]"]);
    s.is_told("render plate.toml --save-map new.map --map old.map", 2, &["error:", "cannot be used with"]);
    assert!(!s.path("caustix-out").exists(), "refused before anything is made");
}

#[test]
fn impossible_requests_exit_1_and_say_what_is_required() {
    let s = Stranger::new();
    for (line, found, required) in [
        ("render --photons 0", "--photons `0`", "from 1 to 2^48"),
        ("render --photons -5", "--photons `-5`", "from 1 to 2^48"),
        ("render --photons -2^22", "--photons `-2^22`", "from 1 to 2^48"),
        ("render --photons --quiet", "--photons `--quiet`", "from 1 to 2^48"),
        ("render --photons abc", "--photons `abc`", "4_456_448, 4.5e6 or 2^22"),
        ("render --photons 4.5", "not whole", "a whole number"),
        ("render --photons 1e99", "more than 2^48", "from 1 to 2^48"),
        ("render --replicates 0", "0 replicates", "1 to 65536"),
        ("render --replicates 70000", "70000 replicates", "1 to 65536"),
        ("render --sequence sobol --replicates 8", "8 replicates", "one replicate"),
        ("render --sequence haltom", "--sequence haltom", "independent, sobol, sobol-owen"),
        ("render --variant qcm", "--variant qcm", "qmc-inverse, qmc-inverse-reuse"),
        ("render --threads 0 --photons 64", "--threads 0", "1 to 1024 threads"),
        ("render --threads 5000 --photons 64", "--threads 5000", "1 to 1024 threads"),
        ("render nowhere.toml", "nowhere.toml: found", "a file that can be read"),
        ("check nowhere.toml", "nowhere.toml: found", "a file that can be read"),
        ("photometry nowhere.ies", "nowhere.ies: found", "a file that can be read"),
    ] {
        s.is_told(line, 1, &[found, "; required: ", required]);
    }
}

#[test]
fn numbers_are_read_as_people_write_them() {
    let s = Stranger::new();
    fs::write(s.path("scene.toml"), SCENE).unwrap();
    for (text, photons) in [("44_560", 44_560u64), ("4.5e4", 45_000), ("2^14", 16_384)] {
        let (code, out, err) = s.types(&format!("render scene.toml -o out --photons {text}"));
        assert_eq!(code, 0, "{err}");
        assert_eq!(s.report("out")["photons"], photons, "{out}");
    }
    // Replicates are equal sets: what does not divide is rounded up, and said.
    let (code, _, err) = s.types("render scene.toml -o out --photons 1001");
    assert_eq!((code, s.report("out")["photons"].as_u64()), (0, Some(1008)));
    assert!(err.contains("1 008 photons instead of 1 001"), "{err}");
}

#[test]
fn broken_files_are_named_with_line_and_column() {
    let s = Stranger::new();
    let whole = fs::read_to_string(in_project("ies/spot.ies")).unwrap();
    fs::write(s.path("word.ies"), whole.replace("\r\n12000", "\r\nbright")).unwrap();
    let cut = whole.trim_end().rsplit_once(|c: char| c.is_whitespace()).unwrap().0;
    fs::write(s.path("cut.ies"), cut).unwrap();
    fs::write(s.path("scene.toml"), SCENE.replace("flux_lm", "flux")).unwrap();
    fs::write(s.path("broken.toml"), "[[emitter]\n").unwrap();
    for (line, place) in [
        ("photometry word.ies", "word.ies:"),
        ("photometry cut.ies", "cut.ies:"),
        ("check scene.toml", "scene.toml:5:1: found the unknown key `flux`"),
        ("render scene.toml", "did you mean `flux_lm`?"),
        ("check broken.toml", "broken.toml:1:"),
    ] {
        s.is_told(line, 1, &[place, "found ", "; required: "]);
        let (_, _, err) = s.types(line);
        let place = err.lines().next().unwrap().strip_prefix("error: ").unwrap();
        let numbers: Vec<usize> =
            place.split(':').skip(1).map_while(|part| part.trim().parse().ok()).collect();
        assert!(numbers.len() == 2 && numbers.iter().all(|n| *n > 0), "{err}");
    }
    // A scene's file that is missing is named where the scene names it.
    let scene = SCENE.replace("\"isotropic\"", "\"photometric\"\nfile = \"gone.ies\"");
    fs::write(s.path("scene.toml"), scene).unwrap();
    s.is_told("check scene.toml", 1, &["scene.toml:4:8: found", "gone.ies"]);
}

#[test]
fn a_toml_text_with_too_much_in_it_is_told_the_rule() {
    let s = Stranger::new();
    for (text, required) in [
        ("a == 1", "one `=` between a key and its value"),
        ("a = 01", "a number without leading zeros"),
        ("a = 00.5", "a number without leading zeros"),
        ("a = +-3", "a number with at most one sign"),
        ("a = -0x1f", "begins with 0x, 0o or 0b and has no sign"),
        ("a = 1__0", "a digit before and after every `_`"),
        ("a = _1", "; required: "),
        ("a = 0x0x1", "; required: "),
        ("a = --inf", "; required: "),
        ("a = [1] ] 2", "; required: "),
    ] {
        fs::write(s.path("scene.toml"), format!("{text}\n")).unwrap();
        s.is_told("check scene.toml", 1, &["scene.toml:1:", required]);
        let (_, _, err) = s.types("check scene.toml");
        assert!(!err.contains("required: nothing"), "{text}\n{err}");
    }
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_tracing() {
    let s = Stranger::new();
    fs::write(s.path("file"), "not a folder").unwrap();
    for output in ["file", "file/below"] {
        // 2^48 photons would take years: that this ends shows that nothing was traced.
        s.is_told(
            &format!("render -o {output} --photons 2^48"),
            1,
            &["file", "required: a directory for the results"],
        );
    }
    s.is_told(
        &format!("photometry {} --plot p.jpg", in_project("ies/spot.ies")),
        1,
        &["p.jpg", ".svg or .png"],
    );
}
