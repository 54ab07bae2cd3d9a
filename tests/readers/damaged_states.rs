//! States of runs, damaged with a checksum that fits all the same: refused or read, never a panic.

use std::fs;
use std::sync::atomic::AtomicBool;

use caustix::files::run_state::{Head, Saved, newest, write};
use caustix::parse_scene;
use caustix::run::replicates::{Course, Keep};
use caustix::run::together::{Together, Watched};
use caustix::run::{Goal, Plan, Settings};
use sha2::{Digest, Sha256};

use crate::support::random::Generator;

const SCENE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0.0, 0.0, 1.0]
flux_lm = 100
[material.black]
type = "absorber"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 2.0, 0.0]
[[receiver]]
surface = "plate"
cells = [3, 2]
grid = [2, 2]
[[far_field]]
name = "up"
axis = [0, 0, 1]
gamma_deg = 45
c_deg = 90
"#;

/// Writes the last state to a file.
struct ToFile<'a>(&'a std::path::Path);

impl Keep for ToFile<'_> {
    fn keep(&mut self, course: &Course<'_>) {
        write(self.0, &Head::of(course, None, None), |out| course.run.write(out)).unwrap();
    }
}

#[test]
fn a_damaged_state_is_refused_or_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.state");
    let scene = parse_scene(SCENE, ".").unwrap();
    let settings = Settings { photons: Some(800), ..Settings::default() };
    let plan = Plan::new(&settings).unwrap();
    let never = AtomicBool::new(false);
    let watched = Watched { interrupt: &never, progress: &|_| {} };
    let course = Course::new(Together::new(&scene, &plan).unwrap());
    let outcome = course.run(Goal::default(), watched, &mut ToFile(&path)).unwrap();
    let whole = fs::read(&path).unwrap();
    let resumed = |path: &std::path::Path| Saved::open(path)?.resumed(&scene, &plan, None);
    let again = resumed(&path).unwrap().run(Goal::default(), watched, &mut ToFile(&path)).unwrap();
    assert_eq!((again.cells(), again.accounts()), (outcome.cells(), outcome.accounts()));
    // Every truncation.
    for length in 0..whole.len() {
        fs::write(&path, &whole[..length]).unwrap();
        assert!(Saved::open(&path).is_err(), "{length} bytes");
    }
    // Bytes changed, left out or put in.
    let body = &whole[..whole.len() - 32];
    let mut generator = Generator(15);
    let (mut read, mut refused) = (0, 0);
    for _ in 0..3000 {
        let mut bytes = body.to_vec();
        for _ in 0..1 + generator.below(3) {
            let at = generator.below(bytes.len());
            match generator.below(4) {
                0 => bytes[at] ^= 1 << generator.below(8),
                1 => bytes[at] = 255,
                2 => drop(bytes.remove(at)),
                _ => bytes.insert(at, 200),
            }
        }
        bytes.extend(Sha256::digest(&bytes));
        fs::write(&path, &bytes).unwrap();
        match resumed(&path) {
            Ok(_) => read += 1,
            Err(error) => {
                assert!(error.file().is_some(), "{error}");
                refused += 1;
            }
        }
    }
    assert!(refused > 2000 && read > 10, "{refused} refused, {read} read");
    // Of the newest and the one before it the first that is whole.
    fs::write(&path, &whole[..100]).unwrap();
    fs::write(folder.path().join("run.state.previous"), &whole).unwrap();
    let (saved, wrong) = newest(&path).unwrap().unwrap();
    assert!(saved.path().ends_with("run.state.previous") && wrong.unwrap().to_string().contains("cut short"));
    fs::write(folder.path().join("run.state.new"), &whole).unwrap();
    assert!(newest(&path).unwrap().unwrap().0.path().ends_with("run.state.new"));
}
