//! Ranks that are threads of one process, with channels between them: the same protocol, without a message library.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use rayon::{ThreadPool, ThreadPoolBuilder};

use super::*;
use crate::files::scene_toml::parse_scene;
use crate::run::goal::{ErrorGoal, ErrorOf, Goal};
use crate::run::outcome::{Outcome, StoppedBy};
use crate::run::plan::{Plan, Settings};
use crate::run::replicates::{Course, Keep, Unkept};
use crate::run::together::{Together, Watched};
use crate::scene::Scene;

/// One end of the channels between all ranks.
struct Wire {
    rank: u32,
    to: Vec<Sender<(u32, Vec<u8>)>>,
    inbox: Receiver<(u32, Vec<u8>)>,
}

impl Wire {
    fn all(size: u32) -> Vec<Self> {
        let (to, inboxes): (Vec<_>, Vec<_>) = (0..size).map(|_| channel()).unzip();
        (0..).zip(inboxes).map(|(rank, inbox)| Self { rank, to: to.clone(), inbox }).collect()
    }
}

impl Post for Wire {
    fn rank(&self) -> u32 {
        self.rank
    }
    fn size(&self) -> u32 {
        self.to.len() as u32
    }
    fn neighbours(&self) -> u32 {
        self.size()
    }
    fn send(&self, to: u32, message: &[u8]) {
        let _gone = self.to[to as usize].send((self.rank, message.to_vec()));
    }
    fn poll(&self) -> Option<(u32, Vec<u8>)> {
        self.inbox.try_recv().ok()
    }
}

/// A lamp over a ball of glass, which a plate below reflects into: spots, an evaluation grid, far fields, light that is lost.
const SCENE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0.0, 0.0, 1.0]
flux_lm = 100
[material.white]
type = "lambertian"
reflectance = 0.5
[material.glass]
type = "dielectric"
ior = 1.5
[[surface]]
name = "ball"
type = "sphere"
material = "glass"
center = [0.2, 0.0, 0.5]
radius = 0.3
[[surface]]
name = "plate"
type = "rectangle"
material = "white"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 2.0, 0.0]
[[receiver]]
name = "plate"
surface = "plate"
cells = [20, 30]
grid = [5, 4]
spot = true
[[receiver]]
name = "indirect"
surface = "plate"
cells = [3, 3]
events = "indirect"
[[far_field]]
name = "all"
axis = [0, 0, -1]
"#;

/// Nothing is kept of what all ranks trace.
struct By<'a, 'b>(&'a mut Shared<'b>);

impl Keep for By<'_, '_> {
    fn keep(&mut self, _: &Course<'_>) {}
    fn trace(
        &mut self,
        run: &mut Together<'_>,
        end: u64,
        watched: Watched<'_>,
    ) -> crate::error::Result<bool> {
        self.0.trace(run, end, watched)
    }
    fn install<R: Send>(&self, sum: impl FnOnce() -> R + Send) -> R {
        self.0.install(sum)
    }
}

/// The same with few counters, so that errors are looked at early.
fn small_scene() -> Scene {
    let of_receivers = SCENE.split("[[far_field]]").next().unwrap();
    parse_scene(&of_receivers.replace("spot = true\n", ""), ".").unwrap()
}

/// Photons of each of eight replicates: no power of two, and enough to be shared by four ranks.
const EACH: u64 = 40_000;

fn scene() -> Scene {
    parse_scene(SCENE, ".").unwrap()
}

fn plan(each: u64, replicates: u32) -> Plan {
    let photons = Some(each * u64::from(replicates));
    Plan::new(&Settings { photons, replicates: Some(replicates), ..Settings::default() }).unwrap()
}

fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

/// Does something as rank 0 of so many, of so many threads each; the tasks that the others had.
fn shared<T: Send>(
    scene: &Scene,
    plan: &Plan,
    (size, threads): (u32, usize),
    lead: impl FnOnce(&mut Shared<'_>) -> T + Send,
) -> T {
    let mut wires = Wire::all(size).into_iter();
    let zero = wires.next().unwrap();
    std::thread::scope(|scope| {
        for wire in wires {
            scope.spawn(move || {
                let mut run = Together::new(scene, plan).unwrap();
                work(&wire, &pool(threads), &mut run, &AtomicBool::new(false)).unwrap();
            });
        }
        let pool = pool(threads);
        let led = lead(&mut Shared::new(&zero, &pool));
        Message::End.send_to_all(&zero);
        led
    })
}

fn state(run: &Together<'_>) -> Vec<u8> {
    let mut bytes = Vec::new();
    run.write(&mut bytes).unwrap();
    bytes
}

/// All that a run found, but for the time that it took.
fn found(mut outcome: Outcome) -> String {
    outcome.trace_s = 0.0;
    format!("{outcome:?}")
}

fn never() -> AtomicBool {
    AtomicBool::new(false)
}

#[test]
fn any_number_of_ranks_and_threads_counts_the_same() {
    let (scene, plan) = (scene(), plan(EACH, 8));
    let interrupt = never();
    let mut alone = Together::new(&scene, &plan).unwrap();
    assert!(alone.trace(EACH, Watched { interrupt: &interrupt, progress: &|_| {} }).unwrap());
    for (size, threads) in [(1, 2), (2, 1), (3, 2), (4, 1), (2, 7)] {
        let photons = AtomicU64::new(0);
        let progress = |more| _ = photons.fetch_add(more, Ordering::Relaxed);
        let watched = Watched { interrupt: &interrupt, progress: &progress };
        let run = shared(&scene, &plan, (size, threads), |shared| {
            let mut run = Together::new(&scene, &plan).unwrap();
            // In the middle of an octave, and of a net.
            for end in [1 << 14, 23_456, EACH] {
                assert!(shared.trace(&mut run, end, watched).unwrap());
                assert_eq!((run.done(), run.farthest()), (end, end));
            }
            run
        });
        assert_eq!(photons.into_inner(), plan.photons(), "{size} ranks");
        assert!(state(&run) == state(&alone), "{size} ranks of {threads} threads count other photons");
        assert_eq!(run.doublings(), alone.doublings(), "{size} ranks");
    }
}

#[test]
fn a_run_to_an_error_looks_where_one_process_does() {
    let (scene, plan) = (small_scene(), plan(1 << 20, 8));
    let interrupt = never();
    let watched = Watched { interrupt: &interrupt, progress: &|_| {} };
    let goal = Goal { error: Some(ErrorGoal::new(0.02, ErrorOf::Cells).unwrap()), until: None };
    let alone = Course::new(Together::new(&scene, &plan).unwrap()).run(goal, watched, &mut Unkept).unwrap();
    assert_eq!(alone.stopped_by, StoppedBy::Error);
    assert!(alone.photons < plan.photons() && alone.photons > 1 << 19, "{} photons", alone.photons);
    let shared = shared(&scene, &plan, (3, 1), |shared| {
        let course = Course::new(Together::new(&scene, &plan).unwrap());
        course.run(goal, watched, &mut By(shared)).unwrap()
    });
    assert_eq!(found(shared), found(alone));
}

#[test]
fn a_state_is_gone_on_from_by_other_ranks_and_added_replicates_catch_up() {
    let scene = scene();
    let (four, eight) = (plan(EACH, 4), plan(EACH, 8));
    let interrupt = never();
    let watched = Watched { interrupt: &interrupt, progress: &|_| {} };
    let half = shared(&scene, &four, (2, 2), |shared| {
        let mut run = Together::new(&scene, &four).unwrap();
        assert!(shared.trace(&mut run, 30_000, watched).unwrap());
        state(&run)
    });
    let whole = shared(&scene, &eight, (3, 1), |shared| {
        let mut run = Together::new(&scene, &eight).unwrap();
        run.add_from(&mut &half[..], 4).unwrap();
        assert_eq!((run.done(), run.farthest()), (0, 30_000));
        for end in [30_000, EACH] {
            assert!(shared.trace(&mut run, end, watched).unwrap());
        }
        state(&run)
    });
    let mut alone = Together::new(&scene, &eight).unwrap();
    assert!(alone.trace(EACH, watched).unwrap());
    assert!(whole == state(&alone));
}

#[test]
fn whoever_is_interrupted_stops_all() {
    let (scene, plan) = (small_scene(), plan(1 << 24, 8));
    for interrupted in [0, 1] {
        let mut wires = Wire::all(2).into_iter();
        let (zero, one) = (wires.next().unwrap(), wires.next().unwrap());
        let interrupts = [never(), never()];
        let photons = AtomicU64::new(0);
        let outcome = std::thread::scope(|scope| {
            let (scene, plan, interrupts) = (&scene, &plan, &interrupts);
            scope.spawn(move || {
                let mut run = Together::new(scene, plan).unwrap();
                work(&one, &pool(1), &mut run, &interrupts[1]).unwrap();
            });
            let progress = |more| {
                if photons.fetch_add(more, Ordering::Relaxed) > 1 << 19 {
                    interrupts[interrupted].store(true, Ordering::Relaxed);
                }
            };
            let watched = Watched { interrupt: &interrupts[0], progress: &progress };
            let course = Course::new(Together::new(scene, plan).unwrap());
            let outcome = course.run(Goal::default(), watched, &mut By(&mut Shared::new(&zero, &pool(1))));
            Message::End.send_to_all(&zero);
            outcome.unwrap()
        });
        assert_eq!(outcome.stopped_by, StoppedBy::Interrupt, "rank {interrupted}");
        // Whole nets of every replicate, and of what was traced at least a half.
        let each = outcome.photons / 8;
        assert!(each.is_power_of_two() && (1 << 15..1 << 19).contains(&each), "{each}");
        assert!(outcome.ledger.is_balanced() && outcome.ledger.total_emitted() == 8 * each);
        assert!(interrupts.iter().all(|interrupt| interrupt.load(Ordering::Relaxed)));
    }
}

/// What rank 0 says of a rank 1 that answers so.
fn with_a_rank_that(answers: fn(&Wire, Message)) -> String {
    let (scene, plan) = (scene(), plan(EACH, 8));
    let mut wires = Wire::all(2).into_iter();
    let (zero, one) = (wires.next().unwrap(), wires.next().unwrap());
    let interrupt = never();
    let watched = Watched { interrupt: &interrupt, progress: &|_| {} };
    std::thread::scope(|scope| {
        scope.spawn(move || {
            Message::Ask.send(&one, 0);
            loop {
                match Message::poll(&one).unwrap() {
                    Some((_, Message::End)) => break,
                    Some((_, message)) => answers(&one, message),
                    None => std::thread::sleep(SHORTEST),
                }
            }
        });
        let pool = pool(1);
        let mut run = Together::new(&scene, &plan).unwrap();
        let error = Shared::new(&zero, &pool).trace(&mut run, EACH, watched).unwrap_err();
        Message::End.send_to_all(&zero);
        error.to_string()
    })
}

#[test]
fn what_goes_wrong_on_a_rank_is_said_and_ends_the_run() {
    let error = with_a_rank_that(|one, message| {
        if let Message::Task(_) = message {
            Message::Failed { found: "a leak".into(), required: "none".into() }.send(one, 0);
        }
    });
    assert_eq!(error, "found a leak (rank 1); required: none");
    let error = with_a_rank_that(|one, message| match message {
        Message::Task(_) => Message::Done { photons: 1, complete: true }.send(one, 0),
        Message::AddUp => Message::Sums(vec![vec![1]; 3]).send(one, 0),
        _ => {}
    });
    assert!(error.contains("sums of rank 1 that hold 3 replicates instead of 8"), "{error}");
    let error = with_a_rank_that(|one, message| {
        if let Message::Task(_) = message {
            one.send(0, b"\x00\x05");
        }
    });
    assert!(error.contains("a message from rank 1 that holds"), "{error}");
}

#[test]
fn a_panic_in_a_task_ends_its_rank_instead_of_leaving_it_waiting() {
    let (scene, plan) = (scene(), plan(EACH, 8));
    let mut wires = Wire::all(2).into_iter();
    let (zero, one) = (wires.next().unwrap(), wires.next().unwrap());
    std::thread::scope(|scope| {
        let (scene, plan) = (&scene, &plan);
        let rank = scope.spawn(move || {
            let mut run = Together::new(scene, plan).unwrap();
            work(&one, &pool(2), &mut run, &never())
        });
        // A replicate that no run has.
        Message::Task(tasks::Task { replicate: 99, indices: 0..10 }).send(&zero, 1);
        assert!(rank.join().is_err());
    });
}

#[test]
fn every_rank_gives_its_sums_once_on_the_way_to_rank_0() {
    for size in [1, 2, 3, 4, 5, 8, 13, 1024] {
        let mut given = vec![0; size as usize];
        for rank in 0..size {
            for child in children(rank, size) {
                assert_eq!(parent(child), rank);
                given[child as usize] += 1;
            }
        }
        assert!(given[0] == 0 && given[1..].iter().all(|times| *times == 1), "{size}: {given:?}");
        let steps = |mut rank: u32| std::iter::from_fn(|| (rank > 0).then(|| rank = parent(rank))).count();
        assert!((0..size).all(|rank| steps(rank) <= size.next_power_of_two().ilog2() as usize));
    }
}

#[test]
fn messages_come_as_they_were_sent() {
    let wires = Wire::all(2);
    let task = |indices| tasks::Task { replicate: 7, indices };
    for message in [
        Message::Hello("{\"a\":1}".into()),
        Message::Ask,
        Message::Task(task(u64::MAX - 1..u64::MAX)),
        Message::Done { photons: 1 << 60, complete: false },
        Message::AddUp,
        Message::Sums(vec![]),
        Message::Sums(vec![vec![], vec![0; 300], vec![255, 1]]),
        Message::End,
    ] {
        message.send(&wires[1], 0);
        assert_eq!(Message::poll(&wires[0]).unwrap(), Some((1, message)));
    }
    assert_eq!(Message::poll(&wires[0]).unwrap(), None);
}
