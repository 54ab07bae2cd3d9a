//! `caustix sweep` as a user types it: its files, its messages, and that it goes on where it was stopped.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::absorber::SCENE;
use crate::support::stranger::Stranger;
use crate::support::vouched::whole;

const LIST: &str = "sweep.json";
const FILES: [&str; 4] = ["sweep.csv", LIST, "sweep.md", "sweep.svg"];

fn stranger() -> Stranger {
    let camera =
        "[camera]\nposition = [0.3, -1.2, 0.8]\nlook_at = [0.0, 0.0, 0.1]\nfov_deg = 45\npixels = [24, 18]\n";
    let open =
        SCENE.replace("\"isotropic\"", "\"isotropic\"\nname = \"lamp\"").replace("cells = [4, 4]\n", camera);
    Stranger::with(&[("scene.toml", SCENE), ("open.toml", &open)])
}

/// The rows of sweep.csv by column.
fn table(s: &Stranger, folder: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let csv = fs::read_to_string(s.path(folder).join("sweep.csv")).unwrap();
    let mut rows = csv.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    (rows.next().unwrap(), rows.collect())
}

#[test]
fn a_sweep_writes_one_set_with_every_value_and_difference() {
    let s = stranger();
    let line = "sweep scene.toml --set emitter[0].position[2]=1:2:0.5 --set emitter[0].flux_lm=100,300 --photons 2^16 --of plate.flux_lm,plate.max_lx";
    let (code, out, err) = s.types(line);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    assert!(out.contains("points     6\n") && out.contains("written to caustix-out"), "{out}");
    assert!(whole(&s.path("caustix-out"), LIST).iter().eq(&FILES));
    let (header, rows) = table(&s, "caustix-out");
    assert_eq!(rows.len(), 6);
    let column = |name: &str| {
        let at =
            header.iter().position(|known| known == name).unwrap_or_else(|| panic!("{name} in {header:?}"));
        rows.iter().map(|row| row[at].parse::<f64>().ok()).collect::<Vec<_>>()
    };
    assert_eq!(column("emitter[0].position[2]"), [1.0, 1.0, 1.5, 1.5, 2.0, 2.0].map(Some));
    assert_eq!(column("emitter[0].flux_lm"), [100.0, 300.0, 100.0, 300.0, 100.0, 300.0].map(Some));
    assert_eq!(column("photons"), [65536.0; 6].map(Some));
    // Three times the flux is three times every count: the same photons in both scenes.
    let flux: Vec<f64> = column("plate.flux_lm").into_iter().flatten().collect();
    assert!((flux[1] - 3.0 * flux[0]).abs() < 1e-9 && (flux[5] - 3.0 * flux[4]).abs() < 1e-9, "{flux:?}");
    let along = column("plate.flux_lm:difference:emitter[0].position[2]");
    assert_eq!(along.iter().map(Option::is_some).collect::<Vec<_>>(), [false, false, true, true, true, true]);
    assert_eq!(along[4], Some(flux[4] - flux[2]));
    let of_flux = column("plate.flux_lm:difference:emitter[0].flux_lm");
    assert_eq!((of_flux[0], of_flux[1], of_flux[4]), (None, Some(flux[1] - flux[0]), None));
    // The difference of each replicate is 2 a_r, so its error is twice that of the flux, where independent ones give sqrt(1 + 9).
    let error = column("plate.flux_lm:standard_error")[0].unwrap();
    let paired = column("plate.flux_lm:difference_standard_error:emitter[0].flux_lm")[1].unwrap();
    assert!((paired - 2.0 * error).abs() < 1e-9 * error, "{paired} {error}");
    let ratio = column("plate.flux_lm:error_ratio:emitter[0].flux_lm")[1].unwrap();
    assert!((ratio * paired - 10.0_f64.sqrt() * error).abs() < 1e-9 * error, "{ratio}");
    // Extremes have an error of their own and no paired one.
    assert!(column("plate.max_lx:standard_error").iter().all(Option::is_some));
    assert!(column("plate.max_lx:difference_standard_error:emitter[0].flux_lm").iter().all(Option::is_none));
    let md = fs::read_to_string(s.path("caustix-out/sweep.md")).unwrap();
    for told in [
        "## plate.flux_lm",
        "difference along `emitter[0].flux_lm`",
        "| plate.flux_lm | `emitter[0].position[2]` | 4 |",
        "    caustix sweep scene.toml --set 'emitter[0].position[2]=1:2:0.5' --set",
    ] {
        assert!(md.contains(told), "no {told} in\n{md}");
    }
}

#[test]
fn cells_are_chosen_once_and_what_a_scene_leaves_out_can_be_set() {
    let s = stranger();
    let line =
        "sweep open.toml --set surface.plate.translate[0]=0,0.1 --set run.seed=5 -o out --photons 2^14";
    s.is_told(line, 0, &[]);
    let md = fs::read_to_string(s.path("out/sweep.md")).unwrap();
    for told in ["cells of plate: ", "chosen at the first point", "camera's picture is not made", "seed 5"] {
        assert!(md.contains(told), "no {told} in\n{md}");
    }
    // Of the words a value can be, one is a material.
    s.is_told("sweep scene.toml --set surface.plate.material=black -o word --photons 64 --quiet", 0, &[]);
    assert_eq!(table(&s, "word").1[0][0], "black");
}

#[test]
fn what_cannot_be_swept_is_told_with_what_was_meant() {
    let s = stranger();
    for (line, code, told) in [
        ("", 2, &["--set <KEY=VALUES>"][..]),
        ("--set emitter[0].flux_lm", 1, &["--set emitter[0].flux_lm: no `=`", "KEY=VALUES"]),
        ("--set emitter[0].flux_lm=1:2", 1, &["a range of 2 numbers", "FROM:TO:STEP"]),
        ("--set emitter[0].flux_lm=1:2:-1", 1, &["a step that leads away from the end"]),
        ("--set emitter[0].flux_lm=1:2:1e-6", 1, &["1000001 points", "at most 10000"]),
        ("--set emitter[0].flux_lm=10,-1", 1, &["--set emitter[0].flux_lm=-1: flux_lm = -1", "required: "]),
        ("--set emitter[0].flux=10", 1, &["the unknown key `flux`", "did you mean `flux_lm`?"]),
        ("--set emiter[0].flux=10", 1, &["no `emiter` in the scene", "did you mean `emitter`?"]),
        ("--set surface.plaet.type=box", 1, &["no surface of the name `plaet`", "did you mean `plate`?"]),
        (
            "--set surface.plate.material=blakc",
            1,
            &["surface.plate.material=blakc: the unknown material", "`black`"],
        ),
        ("--set run.seed=1,2 --seed 3", 1, &["--seed beside --set run.seed"]),
        (
            "--set run.seed=1,2 --of plate.flux",
            1,
            &["--of plate.flux", "one of: plate.flux_lm", "did you mean"],
        ),
        ("--set receiver.plate.name=a,b", 1, &["--set receiver.plate.name=b: a scene without a.flux_lm"]),
    ] {
        s.is_told(&format!("sweep scene.toml {line} --photons 2^45"), code, told);
    }
    assert!(!s.path("caustix-out").exists(), "refused before anything is made");
}

fn parts(s: &Stranger, folder: &str) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(s.path(folder).join("parts")) else { return vec![] };
    let mut parts: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    parts.retain(|path| path.extension().is_some_and(|ending| ending == "part"));
    parts.sort();
    parts
}

#[test]
fn killed_and_started_again_it_writes_the_bytes_of_a_sweep_left_alone() {
    let (alone, killed) = (stranger(), stranger());
    let line = "sweep open.toml --set emitter.lamp.position[2]=1:2:0.1 --photons 2^17 -o out --quiet";
    alone.is_told(line, 0, &[]);
    for wanted in [1, 4, 8] {
        let mut child = killed.command(line).stderr(Stdio::null()).spawn().unwrap();
        let started = Instant::now();
        while parts(&killed, "out").len() < wanted && child.try_wait().unwrap().is_none() {
            assert!(started.elapsed() < Duration::from_secs(300), "{wanted} parts");
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let kept: Vec<(PathBuf, Vec<u8>, _)> = parts(&killed, "out")
        .into_iter()
        .map(|path| {
            (path.clone(), fs::read(&path).unwrap(), fs::metadata(&path).unwrap().modified().unwrap())
        })
        .collect();
    assert!((8..=11).contains(&kept.len()), "{}", kept.len());
    killed.is_told(line, 0, &[]);
    for name in FILES {
        let of = |s: &Stranger| fs::read(s.path("out").join(name)).unwrap();
        assert!(of(&killed) == of(&alone), "{name}");
    }
    // What was finished was not done again.
    for (path, bytes, modified) in kept {
        assert!(fs::read(&path).unwrap() == bytes, "{}", path.display());
        assert_eq!(fs::metadata(&path).unwrap().modified().unwrap(), modified, "{}", path.display());
    }
    assert_eq!(parts(&killed, "out").len(), 11);
    // Other settings have other parts.
    killed.is_told("sweep open.toml --set emitter.lamp.position[2]=1 --photons 2^16 -o out --quiet", 0, &[]);
    assert_eq!(parts(&killed, "out").len(), 12);
}

#[test]
fn an_interrupted_sweep_writes_the_points_that_are_finished() {
    let s = stranger();
    let line = "sweep scene.toml --set run.photons=2^10,2^45 -o out";
    let child = s.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let started = Instant::now();
    while parts(&s, "out").is_empty() {
        assert!(started.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let Output { status, stderr, .. } = child.wait_with_output().unwrap();
    let err = String::from_utf8(stderr).unwrap();
    assert_eq!(status.code(), Some(130), "{err}");
    assert!(err.contains("the 1 of 2 points finished by then are in the table"), "{err}");
    assert!(err.contains("The same command goes on from the parts in out/parts"), "{err}");
    assert!(whole(&s.path("out"), LIST).iter().eq(&FILES));
    let (_, rows) = table(&s, "out");
    assert_eq!((rows.len(), rows[0][..2].join(" ").as_str()), (1, "2^10 1024"));
    let md = fs::read_to_string(s.path("out/sweep.md")).unwrap();
    assert!(md.contains("- Points: 1 of 2, interrupted"), "{md}");
}
