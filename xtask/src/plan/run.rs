//! `plan`: scenes and seeds to reports, files and an exit code.

use super::files::Files;
use super::mover::Mover;
use super::options::Options;
use super::progress::{self, Line};
use super::report::{Medians, Report, Runs, medians, table};
use super::scene::Scene;
use super::setting::Ready;
use super::task::{State, Task, Written, finish};
use super::{interrupt, search};
use crate::cli::{self, Motion};
use crate::flat::either;
use crate::output::{note, print, write};
use crate::scenes;
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use mp::cspace::{Cancel, Outcome};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Plans on every scene with every seed. True when all runs are solved.
pub(crate) fn run(args: &cli::Plan) -> Result<bool> {
    let options = Options::new(args)?;
    let named = match args.scenes.as_slice() {
        [] => vec![PathBuf::from(scenes::SAMPLE)],
        given => given.to_vec(),
    };
    let (out, picture) = (args.out.as_deref(), args.picture.as_deref());
    let files = Files::new(out, picture, args.json, named.len(), args.runs)?;
    let last = args.seed.checked_add(u64::from(args.runs) - 1);
    let last = last.ok_or_else(|| miette!("the seeds from {} on are too large", args.seed))?;

    let found = named.iter().map(|given| scenes::find(given)).collect::<Result<Vec<_>>>()?;
    let ready = found.iter().map(|file| Scene::load(file)).collect::<Result<Vec<_>>>()?;
    let jobs: Vec<(usize, u64)> =
        (0..ready.len()).flat_map(|scene| (args.seed..=last).map(move |seed| (scene, seed))).collect();
    check_files(&files, &ready, &jobs)?;
    ready.iter().try_for_each(Scene::check_ends)?;
    if let Some(folder) = &args.export {
        export(folder, &ready)?;
    }

    let cancel = Cancel(interrupt::flag());
    let job = |(scene, seed): (usize, u64), quiet: bool| -> Result<Report> {
        let source = found[scene].display().to_string();
        let (source, options, files) = (&source, &options, &files);
        match &ready[scene] {
            Scene::Rigid(Ready::Space(task)) => one(&**task, source, options, seed, &cancel, files, quiet),
            Scene::Rigid(Ready::Plane(task)) => one(&**task, source, options, seed, &cancel, files, quiet),
            Scene::Arm(task) => one(&**task, source, options, seed, &cancel, files, quiet),
            Scene::Flat(any) => {
                either!(any, task => one(&**task, source, options, seed, &cancel, files, quiet))
            }
        }
    };
    let reports = match jobs.as_slice() {
        [only] => vec![job(*only, false)?],
        _ => many(&jobs, usize::from(args.threads), &cancel, |j| job(j, true))?,
    };
    show(args, &reports)?;
    let missing = jobs.len() - reports.len();
    if missing > 0 {
        note(&format!("interrupted: {missing} of {} runs were not begun", jobs.len()));
    }
    Ok(missing == 0 && reports.iter().all(|r| r.solved))
}

/// What a bare search came to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planned {
    pub(crate) solved: bool,
    /// Until a verified path, or the end of the budget.
    pub(crate) seconds: f64,
    pub(crate) queries: u64,
    pub(crate) iterations: u64,
}

/// Plans, and neither shortens nor writes.
pub(crate) fn planned(ready: &Ready, options: &Options, seed: u64) -> Result<Planned> {
    fn on<M: Mover>(setting: &super::setting::Setting<M>, options: &Options, seed: u64) -> Result<Planned> {
        let mut line = Line::new(&setting.problem.name, options.time, false);
        let search = setting.search(options, seed, &Cancel(interrupt::flag()), &mut line)?;
        Ok(Planned {
            solved: matches!(search.outcome, Outcome::Solved(_)),
            seconds: search.time.as_secs_f64(),
            queries: search.queries,
            iterations: search.progress.iterations,
        })
    }
    match ready {
        Ready::Space(setting) => on(setting, options, seed),
        Ready::Plane(setting) => on(setting, options, seed),
    }
}

fn check_files(files: &Files, ready: &[Scene], jobs: &[(usize, u64)]) -> Result<()> {
    let mut taken = HashSet::new();
    for &(scene, seed) in jobs {
        let name = ready[scene].name();
        files.check(name, matches!(ready[scene], Scene::Flat(_)), seed)?;
        let (out, picture) = files.of(name, seed);
        for path in out.into_iter().chain(picture) {
            if !taken.insert(path.clone()) {
                return Err(miette!("{} would be written twice", path.display()));
            }
        }
    }
    Ok(())
}

/// Runs `jobs` on `threads` threads. The reports are in the order of the jobs; those that Ctrl-C kept from
/// beginning are left out.
fn many(
    jobs: &[(usize, u64)],
    threads: usize,
    cancel: &Cancel,
    job: impl Fn((usize, u64)) -> Result<Report> + Sync,
) -> Result<Vec<Report>> {
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<Option<Result<Report>>>> = Mutex::new(jobs.iter().map(|_| None).collect());
    let bar = progress::runs(jobs.len(), true);
    let work = || {
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= jobs.len() || cancel.0.load(Ordering::Relaxed) {
                break;
            }
            let report = job(jobs[i]);
            bar.inc(1);
            if let Ok(mut done) = done.lock() {
                done[i] = Some(report);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads.min(jobs.len()) {
            scope.spawn(work);
        }
    });
    bar.finish_and_clear();
    let done = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    done.into_iter().flatten().collect()
}

/// One run: plan, finish, write.
fn one<T: Task>(
    task: &T,
    source: &str,
    options: &Options,
    seed: u64,
    cancel: &Cancel,
    files: &Files,
    quiet: bool,
) -> Result<Report> {
    let mut line = Line::new(task.name(), options.time, !quiet);
    let search = task.search(options, seed, cancel, &mut line)?;
    let mut report = begun(task, source, options, seed, &search);
    let path = match search.outcome {
        Outcome::Stopped(reason) => {
            report.stopped_by = Some(search::word(reason));
            line.clear();
            return Ok(report);
        }
        Outcome::Solved(path) => path,
    };
    report.path_length_found = Some(path.length(task.space()));
    line.say("solved; shortening and verifying the path");
    let began = Instant::now();
    let finished = finish(task, &path, options.shorten, seed, cancel)?;
    report.finish_s = began.elapsed().as_secs_f64();
    let Some(finished) = finished else {
        report.stopped_by = Some("verification");
        line.clear();
        return Ok(report);
    };
    (report.solved, report.verified, report.shortened) = (true, true, finished.shortened);
    report.path_length = Some(finished.length);
    report.clearance = Some(finished.clearance);
    let (out, picture) = files.of(task.name(), seed);
    if let Some(file) = out {
        line.say("writing the path");
        let json = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"));
        let text = if json { finished.file.json() } else { finished.file.text() };
        write(&file, text.as_bytes())?;
        report.path_file = Some(file.display().to_string());
    }
    if let Some(file) = picture {
        line.say("drawing the picture");
        task.draw(&file, &finished.file, report.caption())?;
        report.picture_file = Some(file.display().to_string());
    }
    report.path = Some(finished.file.rows());
    line.clear();
    Ok(report)
}

/// The report of a run that has been planned but not finished.
fn begun<T: Task>(
    task: &T,
    source: &str,
    options: &Options,
    seed: u64,
    search: &search::Search<State<T>>,
) -> Report {
    Report {
        scene: task.name().to_owned(),
        scene_file: source.to_owned(),
        space: task.kind(),
        solved: false,
        verified: false,
        stopped_by: None,
        planner: options.planner.to_string(),
        metric: options.metric_name.clone(),
        motion: match options.motion {
            Motion::Certified => "certified".into(),
            Motion::Discrete(length) => format!("discrete:{length}"),
        },
        seed,
        iterations: search.progress.iterations,
        nodes: search.progress.nodes,
        edges: search.map.map(|map| map.edges),
        components: search.map.map(|map| map.components),
        motion_checks: search.progress.motions,
        collision_checks: search.queries,
        rejected: search.progress.rejected,
        time_s: search.time.as_secs_f64(),
        finish_s: 0.0,
        first_s: search.first.map(|(time, _)| time.as_secs_f64()),
        first_length: search.first.map(|(_, length)| length),
        path_length_found: None,
        path_length: None,
        clearance: None,
        shortened: false,
        path_file: None,
        picture_file: None,
        path: None,
    }
}

/// Prints what came of it: JSON on standard output, or a summary or table.
fn show(args: &cli::Plan, reports: &[Report]) -> Result<()> {
    let single = args.scenes.len() <= 1 && args.runs == 1;
    if args.json {
        let text = match reports {
            [only] if single => serde_json::to_string(only),
            runs => {
                let medians: Vec<Medians> = medians(runs);
                let solved = runs.iter().filter(|r| r.solved).count();
                serde_json::to_string(&Runs { solved, medians, runs })
            }
        };
        return print(&text.into_diagnostic().wrap_err("cannot write JSON")?);
    }
    match reports {
        [] => Ok(()),
        [only] if single => {
            print(&only.summary())?;
            if only.solved { Ok(()) } else { print("  nothing was written") }
        }
        runs => print(&table(runs)),
    }
}

/// Writes every scene as one JSON and two OFF files.
fn export(folder: &Path, ready: &[Scene]) -> Result<()> {
    std::fs::create_dir_all(folder)
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot make the folder {}", folder.display()))?;
    for scene in ready {
        note(&format!("exported {}", scene.export(folder)?.display()));
    }
    Ok(())
}
