//! What is run: every scene, and the options on scenes that have something for each to do.

use crate::workplace::{OUT, Workplace};

/// One run: lines that are typed after `caustix`, in turn.
pub struct Run {
    pub name: String,
    pub lines: Vec<String>,
    pub threads: Threads,
}

/// With how many threads a run is done.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Threads {
    /// 1, and again 3.
    Both,
    /// 3 alone: a run that cannot be made short.
    Three,
    /// The command has no `--threads`.
    NotAsked,
}

impl Run {
    /// Whether the run is one of those with this many threads.
    pub fn is_with(&self, threads: u32) -> bool {
        match self.threads {
            Threads::Both => true,
            Threads::Three => threads == 3,
            Threads::NotAsked => threads == 1,
        }
    }
}

/// Photons of a run in which nothing depends on their number.
const PHOTONS: &str = "2^12";

const OWN: &str = "tests/golden/scenes";

/// Lies under every variant, sequence and solver: one lamp from a table, noise, a scattering table in colour.
const ONE_EMITTER: &str = "tests/golden/scenes/one_emitter.toml";

/// Two emitters, of a table and of a beam, and reliefs below them.
const TWO_EMITTERS: &str = "tests/golden/scenes/reliefs.toml";

const SEQUENCES: [&str; 18] = [
    "independent",
    "sobol",
    "sobol-owen",
    "sobol-shift",
    "halton",
    "halton-rotation",
    "halton-faure",
    "halton-faure-rotation",
    "hammersley",
    "hammersley-rotation",
    "lattice",
    "lattice-rotation",
    "weyl",
    "weyl-rotation",
    "kronecker",
    "kronecker-rotation",
    "jittered",
    "latin-hypercube",
];

const VARIANTS: [&str; 18] = [
    "mc",
    "mc:table",
    "mc:next-point",
    "qmc",
    "qmc:table",
    "qmc:next-point",
    "qmc:halton-rotation",
    "qmc-inverse",
    "qmc-inverse:newton",
    "qmc-inverse:ridder",
    "qmc-inverse:bisection",
    "qmc-inverse:quadratic-newton",
    "qmc-inverse:independent",
    "qmc-inverse-reuse",
    "qmc-inverse-reuse:secant",
    "qmc-inverse-reuse:newton",
    "qmc-inverse-reuse:bisection",
    "qmc-inverse-reuse:ridder",
];

/// All runs, by name.
pub fn all(workplace: &Workplace) -> Vec<Run> {
    let mut runs = Vec::new();
    scenes(workplace, &mut runs);
    options(&mut runs);
    pictures(&mut runs);
    comparisons(&mut runs);
    files(workplace, &mut runs);
    runs
}

fn add(runs: &mut Vec<Run>, threads: Threads, name: String, lines: &[String]) {
    runs.push(Run { name, lines: lines.to_vec(), threads });
}

fn render(runs: &mut Vec<Run>, name: String, arguments: &str) {
    add(runs, Threads::Both, name, &[format!("render {arguments} -o {OUT}")]);
}

fn scenes(workplace: &Workplace, runs: &mut Vec<Run>) {
    render(runs, "built in".into(), &format!("--photons {PHOTONS}"));
    for (folder, called) in [("scenes", "scene"), (OWN, "own scene")] {
        for scene in workplace.list(folder, ".toml") {
            let path = format!("{folder}/{scene}");
            // Those with a [run] of their own say how many.
            let photons = match &scene[..] {
                "camera_passes.toml" | "camera_progressive.toml" | "tabulated_colour.toml" => String::new(),
                _ => format!("--photons {PHOTONS}"),
            };
            render(runs, format!("{called} {scene}"), &format!("{path} {photons}"));
            add(runs, Threads::NotAsked, format!("check {scene}"), &[format!("check {path} --json")]);
        }
    }
}

fn options(runs: &mut Vec<Run>) {
    for sequence in SEQUENCES {
        // A sequence that is not randomised has one replicate.
        let arguments = format!("{ONE_EMITTER} --photons {PHOTONS} --sequence {sequence}");
        render(runs, format!("sequence {sequence}"), &arguments);
    }
    for variant in VARIANTS {
        // Each replicate of retries with the next point counts a million points ahead.
        let replicates = if variant.ends_with(":next-point") { 2 } else { 8 };
        let arguments =
            format!("{ONE_EMITTER} --photons {PHOTONS} --variant {variant} --replicates {replicates}");
        render(runs, format!("variant {variant}"), &arguments);
    }
    for variant in ["mc", "mc:table", "qmc", "qmc-inverse"] {
        let arguments = format!("{TWO_EMITTERS} --photons {PHOTONS} --variant {variant}");
        render(runs, format!("two emitters, variant {variant}"), &arguments);
    }
    render(
        runs,
        "every emitter, variant mc".into(),
        &format!("{OWN}/emitters.toml --photons {PHOTONS} --variant mc"),
    );
    // Enough photons for every thread to have a batch, and numbers that no power of two divides.
    render(runs, "many photons".into(), &format!("{ONE_EMITTER} --photons 100_002 --replicates 2 --seed 9"));
    render(
        runs,
        "many photons, picture".into(),
        &format!("{OWN}/camera_radius.toml --photons 2^16 --replicates 3"),
    );
    render(
        runs,
        "many photons, splat".into(),
        &format!("{OWN}/camera_splat.toml --photons 2^16 --replicates 1"),
    );
    render(runs, "an odd number".into(), &format!("{TWO_EMITTERS} --photons 4.5e3 --replicates 7 --seed 3"));
    for scene in
        ["scenes/glass_sphere.toml", "scenes/room.toml", "tests/golden/scenes/camera_splat_grey.toml"]
    {
        let name = format!("one replicate {scene}");
        render(runs, name, &format!("{scene} --photons {PHOTONS} --replicates 1"));
    }
}

/// Photons that are saved and seen again, in grey and in colour, with each kind of radius.
fn pictures(runs: &mut Vec<Run>) {
    for scene in ["camera_automatic", "camera_radius", "tabulated_grey"] {
        let traced = format!("render {OWN}/{scene}.toml --photons {PHOTONS} -o {OUT}");
        let lines =
            [format!("{traced} --save-map {OUT}/photons.map"), format!("{traced} --map {OUT}/photons.map")];
        add(runs, Threads::Both, format!("saved {scene}"), &lines);
    }
}

fn comparisons(runs: &mut Vec<Run>) {
    let few = "--photons 2^10 --from 2^8 --reference-photons 2^12";
    let compare = format!("compare {few} --seeds 2 --cells 8,16 -o {OUT}");
    add(runs, Threads::Both, "compare".into(), &[compare]);
    let full = format!("compare {ONE_EMITTER} {few} --seeds 1 --cells 12 --seed 5 --full -o {OUT}");
    add(runs, Threads::Both, "compare full".into(), &[full]);
    let room = format!("compare {OWN}/small_room.toml --seeds 1 -o {OUT}");
    add(runs, Threads::Three, "compare room".into(), &[room]);
}

fn files(workplace: &Workplace, runs: &mut Vec<Run>) {
    for file in workplace.list("ies", ".ies") {
        let path = format!("ies/{file}");
        let lines = [format!("photometry {path} --json --plot {OUT}/plot.svg")];
        add(runs, Threads::NotAsked, format!("photometry {file}"), &lines);
        let lines = [format!("sample {path} -n 2^10 -o {OUT}/directions.csv --json")];
        add(runs, Threads::NotAsked, format!("sample {file}"), &lines);
    }
    for variant in
        ["mc", "mc:table", "mc:next-point", "qmc", "qmc-inverse:ridder", "qmc-inverse-reuse:newton"]
    {
        let line = format!(
            "sample ies/floodlight_b.ies -n 2^10 --variant {variant} --seed 4 -o {OUT}/directions.csv"
        );
        add(runs, Threads::NotAsked, format!("sample, variant {variant}"), &[format!("{line} --json")]);
    }
    let line =
        format!("sample ies/spot.ies -n 1000 --sequence lattice-rotation -o {OUT}/directions.csv --json");
    add(runs, Threads::NotAsked, "sample, sequence lattice-rotation".into(), &[line]);
    for (folder, ending) in
        [("brdf_tables", ".scatter"), (OWN, ".scatter"), (OWN, ".bsdf"), (OWN, ".xml"), (OWN, ".binary")]
    {
        for file in workplace.list(folder, ending) {
            let line = format!("bsdf {folder}/{file} --json --plot {OUT}/plot.svg");
            add(runs, Threads::NotAsked, format!("bsdf {file}"), &[line]);
        }
    }
    let line = format!("photometry ies/headlamp_a.ies --plot {OUT}/plot.png");
    add(runs, Threads::NotAsked, "photometry as PNG".into(), &[line]);
    let line = format!("bsdf brdf_tables/satin_pane.scatter --plot {OUT}/plot.png");
    add(runs, Threads::NotAsked, "bsdf as PNG".into(), &[line]);
}
