//! Damaged files for every reader: a million of them take about ten minutes.
//!
//! `CARGO_PROFILE_RELEASE_OVERFLOW_CHECKS=true cargo run --release --features measurements --example fuzz -- CASES SEED` (with the
//! variable, numbers that overflow are found, too; without the two numbers 1,000,000 and 1). A case is drawn from the seed, the
//! reader and its number alone: `-- CASES SEED READER CASE` runs one again. What makes a reader panic, takes a second of processor
//! time, or more memory than docs/SECURITY.md allows, is told and saved; then the exit code is 1. The figures are in docs/TRUST.md.
#![allow(clippy::print_stdout, clippy::print_stderr, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "../../tests/support/allocator.rs"]
mod allocator;
#[path = "../../tests/support/random.rs"]
mod random;

mod corpus;
mod mutate;
mod readers;

use std::hint::black_box;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::Duration;

use cpu_time::ThreadTime;

use allocator::peak_of;
use mutate::mutate;
use random::Generator;
use readers::Reader;

const CASES: u64 = 1_000_000;
/// Whole MERL files: 35 MB each.
const MERLS: u64 = 100;
/// No case takes longer, of its own thread's time.
const LONGEST: Duration = Duration::from_secs(1);
/// Failures of a reader after which it is left.
const ENOUGH: usize = 5;

/// Where a reader panicked last, and what it said.
static PANIC: Mutex<String> = Mutex::new(String::new());

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let mut number = |default| arguments.next().map_or(default, |n| n.parse().expect("a number"));
    let (cases, seed) = (number(CASES), number(1));
    let (only, case) =
        (arguments.next(), arguments.next().map(|n| n.parse::<u64>().expect("a number of a case")));
    panic::set_hook(Box::new(|info| *PANIC.lock().unwrap() = info.to_string()));
    let folder = std::env::temp_dir().join(format!("caustix-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for scratch files");
    let mut readers = readers::all(&folder);
    readers.push(readers::whole_merl());
    readers.retain(|reader| only.as_ref().is_none_or(|name| reader.name == name));
    let checked = panic::catch_unwind(|| black_box(u8::MAX) + black_box(1)).is_err();
    println!("overflow checks: {}\n", if checked { "on" } else { "off" });
    println!(
        "| reader | cases | read | refused | longest, ms | most memory, MiB | failures |\n|---|---|---|---|---|---|---|"
    );
    let mut total = Tally::default();
    for reader in &readers {
        let number = if reader.share == 0 { MERLS.min(cases) } else { (cases * reader.share).div_ceil(1000) };
        let which = case.map_or(0..number, |case| case..case + 1);
        let tally = fuzz(reader, which, seed, &folder);
        println!("{}", tally.row(reader.name));
        total.add(&tally);
    }
    println!("{}", total.row("all"));
    if total.failures == 0 {
        std::fs::remove_dir_all(&folder).ok();
        return ExitCode::SUCCESS;
    }
    println!("inputs are in {}", folder.display());
    ExitCode::FAILURE
}

/// What came of the cases of a reader.
#[derive(Debug, Default)]
struct Tally {
    read: u64,
    refused: u64,
    longest: Duration,
    most_bytes: usize,
    failures: usize,
}

impl Tally {
    fn row(&self, name: &str) -> String {
        let (cases, ms, mib) =
            (self.read + self.refused, self.longest.as_secs_f64() * 1e3, self.most_bytes >> 20);
        let Self { read, refused, failures, .. } = self;
        format!("| {name} | {cases} | {read} | {refused} | {ms:.0} | {mib} | {failures} |")
    }

    fn add(&mut self, other: &Self) {
        self.read += other.read;
        self.refused += other.refused;
        self.longest = self.longest.max(other.longest);
        self.most_bytes = self.most_bytes.max(other.most_bytes);
        self.failures += other.failures;
    }
}

fn fuzz(reader: &Reader, cases: std::ops::Range<u64>, seed: u64, folder: &Path) -> Tally {
    let mut tally = Tally::default();
    // The good files are good.
    for (k, good) in reader.corpus.iter().enumerate() {
        let ran = panic::catch_unwind(AssertUnwindSafe(|| (reader.run)(good.clone(), &mut Generator(0))));
        // Some are of formats that are known and not read.
        let is_other = ["OBJ", "scene's mesh", "MERL head"].contains(&reader.name);
        if !ran.is_ok_and(|read| read || is_other) {
            println!("{}: its good file {k} is not read: {}", reader.name, PANIC.lock().unwrap());
            tally.failures += 1;
        }
    }
    for case in cases {
        let mut random = generator(reader.name, seed, case);
        let good = &reader.corpus[random.below(reader.corpus.len())];
        let other = &reader.corpus[random.below(reader.corpus.len())];
        let input = mutate(good, other, &mut random);
        let (given, start) = (input.clone(), ThreadTime::now());
        let (peak, ran) =
            peak_of(|| panic::catch_unwind(AssertUnwindSafe(|| (reader.run)(given, &mut random))));
        let time = start.elapsed();
        tally.longest = tally.longest.max(time);
        tally.most_bytes = tally.most_bytes.max(peak);
        *(if matches!(ran, Ok(true)) { &mut tally.read } else { &mut tally.refused }) += 1;
        let most = (reader.most_bytes)(input.len());
        let fault = match ran {
            Err(_) => Some(PANIC.lock().unwrap().clone()),
            Ok(_) if time > LONGEST => Some(format!("{time:?}")),
            Ok(_) if peak > most => {
                Some(format!("{peak} bytes for {} of input, {most} allowed", input.len()))
            }
            Ok(_) => None,
        };
        if let Some(fault) = fault {
            let path = folder.join(format!("{}-{seed}-{case}", reader.name.replace([' ', ',', '\''], "")));
            std::fs::write(&path, &input).expect("a file for an input");
            println!("{}, seed {seed}, case {case}, saved as {}: {fault}", reader.name, path.display());
            tally.failures += 1;
            if tally.failures == ENOUGH {
                println!("{}: no more of it", reader.name);
                break;
            }
        }
    }
    tally
}

/// Of a case alone, so that it can be run again.
fn generator(reader: &str, seed: u64, case: u64) -> Generator {
    let mut key = Generator(seed);
    let key = reader.bytes().fold(key.next(), |key, byte| Generator(key ^ u64::from(byte)).next());
    Generator(Generator(key ^ case).next())
}
