//! `caustix render`: trace a scene, write its maps, say what was found.

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::Result;
use crate::files::outputs::check_outputs;
use crate::files::run_state::{self, STATE};
use crate::files::set::Set;
use crate::picture::{AnyPicture, Picture, Watch, picture_of_saved, warnings as seen_wrong};
use crate::report::saved::SavedReport;
use crate::report::vouched::vouching;
use crate::run::kept::is_together;
use crate::run::share::Post;
use crate::run::{Plan, choose_cells};
use crate::scene::Scene;

use super::asked::Asked;
use super::long;
use super::progress::{INTERRUPTED, Progress, catch_interrupts};
use super::start::{files_of, load, thread_pool};
use super::written::{REPORT, Told, beside_earlier, say_found, seen_wholly, strictly};
use super::{Done, RenderArgs, exit, part, picture, print, ranks, results, warn, written};

/// Runs the subcommand; the exit code.
pub(super) fn run(args: &RenderArgs, post: Option<&dyn Post>) -> Done {
    let started = Instant::now();
    #[cfg(not(feature = "mpi"))]
    ranks::check_launched(args)?;
    let (mut scene, run) = load(args.scene.as_deref(), args.confine, args.quiet)?;
    warn(&scene.warnings);
    scene.found.iter().for_each(say_found);
    picture::check(args, &scene)?;
    let asked = Asked::new(args, run, started)?;
    asked.check_camera(&scene)?;
    let check_shared = |scene: &Scene, plan: &Plan| match post {
        Some(post) => ranks::check(args, scene, plan, post),
        None => Ok(()),
    };
    // Told before anything is made.
    let (plan, _) = asked.plan(None)?;
    check_shared(&scene, &plan)?;
    if let Some(part) = asked.part {
        return part::run(args, &asked, scene, part);
    }
    if let Some(map) = &args.map {
        catch_interrupts();
        return seen_again(args, map, &scene, &plan, started);
    }
    catch_interrupts();
    if let Some(post) = post {
        ranks::check_all_read(&scene, post)?;
    }
    // Before tracing, not after: a directory that cannot be made should cost nobody an hour.
    let folder = results::take(&args.output)?;
    let inputs = results::inputs(args.scene.as_deref(), &scene);
    check_outputs(&outputs(args, &scene), &inputs)?;
    let state = args.output.join(STATE);
    let saved = if args.resume { long::found(&state, args.quiet)? } else { None };
    let (plan, goal) = asked.plan(saved.as_ref().map(|saved| &saved.head))?;
    asked.say_rounding(&plan);
    let pool = thread_pool(post.map_or(args.threads, |post| ranks::threads(args, post)))?;
    match &saved {
        Some(saved) => saved.head.divide(&mut scene),
        None => {
            let progress = Progress::new(args.quiet, "choosing cells", 0);
            let plan = asked.plan_of_cells(&plan)?;
            pool.install(|| choose_cells(&mut scene, &plan, &INTERRUPTED))?;
            progress.clear();
        }
    }
    goal.check(&scene, &plan)?;
    check_shared(&scene, &plan)?;
    let job = long::Job { scene: &scene, plan, goal, state: &state, part_of: None, quiet: args.quiet };
    let is_kept = scene.camera.is_none() && is_together(&scene, &plan);
    let (outcome, picture) = match post {
        Some(post) => (job.traced_by_all(saved.as_ref(), post, &pool)?, None),
        None => pool.install(|| match is_kept {
            true => Ok((job.traced(saved.as_ref())?, None)),
            false => job.in_turn(saved.as_ref(), args.save_map.is_some()),
        })?,
    };
    let told = Told {
        folder: &folder,
        output: &args.output,
        inputs,
        save_map: args.save_map.as_deref(),
        started,
        diagnose: args.diagnose,
        quiet: args.quiet,
        strict: args.strict,
    };
    let code = pool.install(|| written::write(&told, &scene, &outcome, picture.as_ref()))?;
    if !is_kept && code != exit::INTERRUPTED && code != exit::WRONG {
        // Nothing can be added to replicates in turn.
        run_state::remove(&state);
    }
    Ok(code)
}

/// Every file that a run is to write.
fn outputs(args: &RenderArgs, scene: &Scene) -> Vec<PathBuf> {
    files_of(scene, &args.output, args.map.is_none()).chain(args.save_map.clone()).collect()
}

/// The camera's picture of saved photons, and nothing else.
fn seen_again(args: &RenderArgs, map: &Path, scene: &Scene, plan: &Plan, started: Instant) -> Done {
    let Some(spec) = &scene.camera else { return Ok(exit::DONE) };
    let mut inputs = results::inputs(args.scene.as_deref(), scene);
    inputs.push(map.to_path_buf());
    let folder = results::take(&args.output)?;
    check_outputs(&outputs(args, scene), &inputs)?;
    let picture = if scene.is_coloured() {
        AnyPicture::Rgb(of_saved(args, map, scene, plan)?)
    } else {
        AnyPicture::Grey(of_saved(args, map, scene, plan)?)
    };
    let unseen = picture.summary().pixels_unseen;
    let beside = beside_earlier(&folder, unseen > 0, |_| true)?;
    let folder = beside.as_ref().unwrap_or(&folder);
    let mut set = Set::new(folder, REPORT)?;
    let camera = picture::write(&mut set, scene, plan, spec, &picture);
    let said = seen_wrong(scene, picture.summary());
    let report = SavedReport::new(scene, plan, map, (camera, &said), started.elapsed().as_secs_f64());
    let written = set.finish(|files| vouching(&report, files));
    said.iter().for_each(say_found);
    results::tell(folder, &written, &inputs);
    if !args.quiet {
        let (name, map) = (&scene.identity.name, map.display());
        print(&format!("scene      {name}\nphotons    those saved in {map}; "));
        print("none were traced, so receivers and far fields have no files\n");
        print(&report.camera.text());
        print(&results::written_to(folder, &written));
    }
    if !written.errors.is_empty() {
        return Ok(exit::WRONG);
    }
    let seen = seen_wholly(unseen, &written.directory);
    Ok(strictly(args.strict, seen, said.iter().chain(&scene.found)))
}

/// The picture of photons from a file.
fn of_saved<const C: usize>(args: &RenderArgs, map: &Path, scene: &Scene, plan: &Plan) -> Result<Picture<C>> {
    let pool = thread_pool(args.threads)?;
    let progress = Progress::new(args.quiet, &format!("reading {}", map.display()), 0);
    let saved = picture::read(map, scene, plan)?;
    let watch = Watch { interrupt: &INTERRUPTED, photons: &|_| {}, camera: &|share| progress.picture(share) };
    let picture = pool.install(|| picture_of_saved(scene, plan, saved, watch));
    progress.clear();
    picture
}
