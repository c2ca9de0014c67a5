//! `plan`: plans on scenes with seeds, and writes reports and files.

use crate::cli::{Drawing, Plan};
use crate::files::{Files, numbered};
use crate::input::{is_standard, scene_until};
use crate::output::{Claims, in_time, note, print, print_json, write};
use crate::picture::{Picture, Shown, Watched};
use crate::progress::Line;
use crate::request::{request, request_for};
use crate::text::{caption, summary, table};
use crate::time::{kind_of, say};
use crate::{interrupt, memory};
use mp_batch::{Portfolio, PortfolioOptions};
use mp_io::ProblemChanges;
use mp_plan::{
    Cancel, Control, Error, FilmKind, Finish, Interrupt, Pace, PathFileKind, PathRows, RelaxField, Report,
    Request, Runs, Scene, StopReason, StoppedBy, in_parallel, make_folder,
};
use mp_view::GrownTrees;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The default scene.
const SAMPLE: &str = "cubicles";

/// Plans on every scene with every seed. True when all runs are solved.
pub(crate) fn run(args: &Plan) -> Result<bool, Error> {
    let began = mp_plan::Clock::default().now();
    // Read before signals are heard: standard input may say nothing.
    let (request, names_planner) = request(args)?;
    let cancel = interrupt::flag();
    if let Some(memory) = args.memory {
        memory::limit(&cancel, memory)?;
    }
    let named = match args.scenes.as_slice() {
        [] => vec![PathBuf::from(SAMPLE)],
        given => given.to_vec(),
    };
    let files = Files::new(
        args.out.as_deref(),
        args.picture.as_deref(),
        [request.roadmap.as_deref(), args.certificate.as_deref(), args.trajectory.as_deref()],
        args.json,
        named.len(),
        args.runs,
    )?;
    let last = request.seed.checked_add(u64::from(args.runs) - 1);
    let last = last.ok_or_else(|| Error::new(format!("the seeds from {} on are too large", request.seed)))?;
    refuse_several(args, &named)?;
    let changes = args.changes.of_problem();
    let (scenes, not_loaded) = load(&named, &changes, &request, &cancel)?;
    let requests = scenes.iter().map(|scene| request_for(scene, args, &request, names_planner));
    let requests = requests.collect::<Result<Vec<_>, _>>()?;
    let jobs: Vec<(usize, u64)> =
        (0..scenes.len()).flat_map(|i| (request.seed..=last).map(move |seed| (i, seed))).collect();
    let to_standard = args.out.as_deref().is_some_and(is_standard);
    if jobs.len() > 1 || args.portfolio.is_some() || args.routes.is_some() || to_standard {
        refuse_parts(&scenes)?;
    }
    check_files(args, &files, &scenes, &jobs)?;
    for scene in &scenes {
        for odd in scene.check_ends()? {
            note(&format!("warning: {}: {odd}", scene.name()));
        }
    }
    if let Some(folder) = &args.export {
        export(folder, &scenes)?;
    }

    // Several runs have the whole time each.
    let single = jobs.len() + not_loaded.len() == 1;
    let spent = if single { mp_plan::Clock::default().now() - began } else { Duration::ZERO };
    if let (Some(count), [scene], [request]) = (args.routes, scenes.as_slice(), requests.as_slice()) {
        return routes(args, scene, request, count, (&cancel, spent), &files);
    }
    if let ([scene], [request]) = (scenes.as_slice(), requests.as_slice())
        && scene.parts_left() > 0
    {
        return parts(args, scene, request, (&cancel, spent), &files);
    }
    // Runs have a thread each when there are several.
    let threads = if single { args.threads } else { 1 };
    let settings = RunSettings { args, files: &files, watched: single, threads, part: None };
    let job = |(i, seed): (usize, u64)| one(&scenes[i], &requests[i], seed, (&cancel, spent), &settings);
    let made = match jobs.as_slice() {
        [] => Vec::new(),
        [only] => vec![job(*only)?],
        _ => {
            let line = Line::new("runs", None, true);
            let done = std::sync::atomic::AtomicUsize::new(0);
            let counted = |i: usize| {
                let report = job(jobs[i]);
                let n = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
                line.say(&format!("{n} of {} done", jobs.len()));
                report
            };
            let all = in_parallel(jobs.len(), usize::from(args.threads), &cancel, counted);
            all.into_iter().flatten().collect::<Result<Vec<_>, _>>()?
        }
    };
    let missing = jobs.len() - made.len();
    let (mut reports, complete): (Vec<_>, Vec<_>) = made.into_iter().unzip();
    reports.extend(not_loaded);
    let solved = reports.iter().all(|r| r.solved) && !complete.contains(&false);
    let lost = lost_roadmap(&reports);
    show(args, reports, single)?;
    if missing > 0 {
        note(&format!("{}: {missing} of {} runs were not started", ended_by(&cancel), jobs.len()));
    }
    lost.map_or(Ok(missing == 0 && solved), Err)
}

/// The error of the first run whose roadmap was not written. It is told when all else is written.
fn lost_roadmap(reports: &[Report]) -> Option<Error> {
    let why = reports.iter().find_map(|report| report.roadmap_error.as_ref())?;
    let help = "the path and the other files are as they should be; name a --roadmap that can be written, or make room";
    Some(Error::new(format!("the roadmap was not kept: {why}")).help(help))
}

/// Refuses several scenes or runs where there can be one only.
fn refuse_several(args: &Plan, named: &[PathBuf]) -> Result<(), Error> {
    if named.iter().filter(|given| is_standard(given)).count() > 1 {
        return Err(Error::new("standard input can be one scene only"));
    }
    for (option, given) in [("--portfolio", args.portfolio.is_some()), ("--routes", args.routes.is_some())] {
        if given && (named.len() > 1 || args.runs > 1) {
            let message = format!("{option} needs a single run");
            return Err(Error::new(message).help("name one scene, without --runs"));
        }
    }
    if !args.changes.of_problem().is_empty() && named.len() > 1 {
        return Err(Error::new("--from, --to and --obstacle are for one scene").help("name one scene"));
    }
    if args.trajectory.is_none() && args.pace.pace() != Pace::default() {
        let message =
            "--velocity-scale, --acceleration-scale, --jerk-scale and --deviation are of a trajectory";
        return Err(Error::new(message).help("name its file by --trajectory, or leave them out"));
    }
    if args.routes.is_some() && args.out.as_deref().is_some_and(is_standard) {
        return Err(Error::new("--out -: there is a file for each route").help("name a file"));
    }
    Ok(())
}

/// Refuses motions of several parts among several runs.
fn refuse_parts(scenes: &[Scene]) -> Result<(), Error> {
    match scenes.iter().find(|scene| scene.parts_left() > 0) {
        None => Ok(()),
        Some(scene) => Err(Error::new(format!("the motion of {} has several parts", scene.name()))
            .help("plan it alone, without --runs, --routes and --portfolio, into files: --out NAME.txt")),
    }
}

/// Loads the scenes. Returns those that are ready, and a report for each that was interrupted.
fn load(
    named: &[PathBuf],
    changes: &ProblemChanges,
    request: &Request,
    cancel: &Cancel,
) -> Result<(Vec<Scene>, Vec<Report>), Error> {
    let (mut scenes, mut not_loaded) = (Vec::new(), Vec::new());
    for given in named {
        // Each scene may take the whole time.
        let clock = mp_plan::Clock::default();
        let began = clock.now();
        match scene_until(given, changes, &time_limit(request, cancel, began))? {
            Ok(scene) => scenes.push(scene.for_request(request)?),
            Err(reason) => {
                let name = if is_standard(given) { Path::new("stdin") } else { given };
                let name = name.file_stem().unwrap_or(name.as_os_str()).to_string_lossy();
                let report = Report::not_loaded(&name, request, reason, clock.now().saturating_sub(began));
                not_loaded.push(Report { scene_file: Some(given.display().to_string()), ..report });
            }
        }
    }
    Ok((scenes, not_loaded))
}

/// Interrupts work that began at a time when `cancel` is raised or the time of the request is up.
fn time_limit(request: &Request, cancel: &Cancel, began: Duration) -> Interrupt {
    match request.budget.time_s.and_then(|s| Duration::try_from_secs_f64(s).ok()) {
        None => Interrupt::new(cancel.clone()),
        Some(time) => Interrupt::by(cancel.clone(), mp_plan::Clock::default(), began.saturating_add(time)),
    }
}

/// Why the flag was raised, in a few words.
fn ended_by(cancel: &Cancel) -> StoppedBy {
    cancel.reason().map_or(StoppedBy::Interrupted, StoppedBy::from)
}

/// Finds routes, and writes each to files of its own. True when there are as many as asked for.
fn routes(
    args: &Plan,
    scene: &Scene,
    request: &Request,
    count: u16,
    (cancel, spent): (&Cancel, Duration),
    files: &Files,
) -> Result<bool, Error> {
    let mut line = Line::new(scene.name(), request.budget.time_s, true);
    let found = {
        let mut watched = Watched { line: &mut line, grown: None };
        let mut control = Control { spent, ..Control::new(cancel.clone(), &mut watched) };
        scene.routes(request, usize::from(count), args.apart, &mut control)?
    };
    let mut reports = Vec::new();
    for (i, mut report) in found.into_iter().enumerate() {
        let [out, file] = <[_; 2]>::from(files.of(scene.name(), request.seed))
            .map(|file| file.map(|file| numbered(&file, i + 1)));
        let drawing = drawing(scene, request, file.as_deref(), args.threads);
        if let Some(rows) = report.path.clone() {
            let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
            if let Some(file) = out {
                write_path(&mut report, &path, &file)?;
            }
            if let Some(file) = file {
                let picture = Picture::of(scene, &file, &drawing, true)?;
                write_picture(&mut report, scene, &path, (&picture, &file), None, (cancel, &line))?;
            }
        }
        reports.push(report);
    }
    drop(line);
    let solved = reports.iter().filter(|report| report.solved).count();
    let lost = lost_roadmap(&reports);
    if args.json {
        print_json(&Runs::new(reports))?;
    } else {
        for (i, report) in reports.iter().enumerate() {
            print(&format!("route {} of {solved}\n{}", i + 1, summary(report)))?;
        }
    }
    if solved < usize::from(count) {
        note(&format!("{solved} of {count} routes were found that are {} apart", args.apart));
    }
    lost.map_or(Ok(solved >= usize::from(count)), Err)
}

/// Plans the parts of a motion one after the other, and writes each to files of its own. True when all are solved.
fn parts(
    args: &Plan,
    scene: &Scene,
    request: &Request,
    (cancel, mut spent): (&Cancel, Duration),
    files: &Files,
) -> Result<bool, Error> {
    let (mut reports, mut scene, count) = (Vec::new(), scene.clone(), 1 + scene.parts_left());
    let mut all_complete = true;
    let name = scene.name().to_owned();
    let (interrupt, mut cannot_begin) = (Interrupt::new(cancel.clone()), None);
    for number in 1..=count {
        let part = Some((number, name.clone()));
        let settings = RunSettings { args, files, watched: true, threads: args.threads, part };
        let (report, complete) = one(&scene, request, request.seed, (cancel, spent), &settings)?;
        all_complete &= complete;
        spent = Duration::ZERO;
        let end = report.path.as_ref().and_then(|path| path.last().cloned());
        reports.push(report);
        let Some(end) = end else { break };
        let begun = scene.next_part(&end, &interrupt).and_then(|next| {
            next.iter().try_for_each(|next| next.check_ends().map(drop))?;
            Ok(next)
        });
        match begun.map_err(|e| e.context(format!("part {} of {count}", number + 1))) {
            Ok(Some(next)) => scene = next,
            Ok(None) => break,
            Err(_) if interrupt.raised().is_some() => {
                note(&format!("interrupted: part {} of {count} was not begun", number + 1));
                break;
            }
            Err(e) => {
                cannot_begin = Some(e);
                break;
            }
        }
    }
    let solved = all_complete && reports.len() == count && reports.iter().all(|report| report.solved);
    let cannot_begin = cannot_begin.or_else(|| lost_roadmap(&reports));
    if args.json {
        print_json(&Runs::new(reports))?;
    } else {
        for (i, report) in reports.iter().enumerate() {
            print(&format!("part {} of {count}\n{}", i + 1, summary(report)))?;
        }
    }
    cannot_begin.map_or(Ok(solved), Err)
}

/// Refuses outputs that cannot be written, that are inputs, and two outputs in the same file.
fn check_files(args: &Plan, files: &Files, scenes: &[Scene], jobs: &[(usize, u64)]) -> Result<(), Error> {
    let mut claims = Claims::default();
    scenes.iter().flat_map(Scene::inputs_on_disk).for_each(|file| claims.input(file));
    args.request.iter().for_each(|file| claims.input(file));
    if let Some(RelaxField::Image(file)) = &args.relax {
        claims.input(file);
    }
    files.claim_roadmap(&mut claims)?;
    if let Some(file) = &args.checkpoint {
        claims.output("--checkpoint", file)?;
    }
    for &(i, seed) in jobs {
        let parts = 1 + scenes[i].parts_left();
        let several = args.routes.map(usize::from).or((parts > 1).then_some(parts));
        files.claim(&mut claims, &scenes[i], seed, several)?;
    }
    if let Some(folder) = &args.export {
        for file in scenes.iter().flat_map(|scene| mp_io::exported_files(scene.name())) {
            claims.output("--export", &folder.join(file))?;
        }
    }
    Ok(())
}

/// How a run is made, and what is written.
struct RunSettings<'a> {
    args: &'a Plan,
    files: &'a Files,
    watched: bool,
    threads: u16,
    /// The number of a part of a motion, and the name of the scene of the first one.
    part: Option<(usize, String)>,
}

impl RunSettings<'_> {
    /// Plans: by one run, or by many that race.
    fn planned(&self, scene: &Scene, request: &Request, control: &mut Control<'_>) -> Result<Report, Error> {
        let Plan { schedule, unit, round, checkpoint, .. } = self.args;
        let Some(runs) = self.args.portfolio else { return scene.plan_with(request, control) };
        let portfolio = Portfolio { runs, schedule: *schedule, unit: *unit, round: *round };
        let options = PortfolioOptions { threads: usize::from(self.threads), checkpoint: checkpoint.clone() };
        let outcome = portfolio.plan(scene, request, &options, control)?;
        if outcome.known > 0 {
            note(&format!("went on after {} runs", outcome.known));
        }
        Ok(outcome.report)
    }
}

/// One run: plan, then write the path, its certificate and trajectory, and the picture. Also whether there was time to prove and time it.
fn one(
    scene: &Scene,
    request: &Request,
    seed: u64,
    (cancel, spent): (&Cancel, Duration),
    settings: &RunSettings<'_>,
) -> Result<(Report, bool), Error> {
    let RunSettings { files, watched, threads, .. } = *settings;
    let (name, named) = match &settings.part {
        Some((number, name)) => (name.as_str(), Some(*number)),
        None => (scene.name(), None),
    };
    let named = |file: PathBuf| named.map_or(file.clone(), |number| numbered(&file, number));
    let began = mp_plan::Clock::default().now();
    let request = Request { seed, ..request.clone() };
    let mut line = Line::new(scene.name(), request.budget.time_s, watched);
    let [out, file] = <[_; 2]>::from(files.of(name, seed)).map(|file| file.map(named));
    let drawing = drawing(scene, &request, file.as_deref(), threads);
    let picture =
        file.map(|file| Ok::<_, Error>((Picture::of(scene, &file, &drawing, true)?, file))).transpose()?;
    let shows_search = picture.as_ref().is_some_and(|(picture, _)| picture.shows_search());
    let grown = shows_search.then(|| GrownTrees::new(scene, &request));
    let mut watched = Watched { line: &mut line, grown };
    let mut control = Control { spent, ..Control::new(cancel.clone(), &mut watched) };
    let mut report = settings.planned(scene, &request, &mut control)?;
    let grown = watched.grown;
    let Some(rows) = report.path.clone() else { return Ok((report, true)) };
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    if let Some(file) = out {
        line.say("writing the path");
        write_path(&mut report, &path, &file)?;
    }
    let interrupt = time_limit(&request, cancel, began.saturating_sub(spent));
    if let Some(file) = files.certificate(name, seed).map(named) {
        line.say("writing the certificate");
        let made = scene.certificate(&path, report.clearance.unwrap_or(0.0), &interrupt);
        if let Some(certificate) = in_time(made, &interrupt, &file)? {
            write(&file, certificate.to_json().as_bytes())?;
            report.certificate_file = Some(file.display().to_string());
        }
    }
    if let Some(file) = files.trajectory(name, seed).map(named) {
        line.say("timing the path");
        let timed = scene.time(&path, &settings.args.pace.pace(), &interrupt);
        if let Some(timed) = in_time(timed, &interrupt, &file)? {
            write(&file, &scene.trajectory_bytes(&timed.trajectory, kind_of(&file)?)?)?;
            say(&timed);
        }
    }
    if let Some((picture, file)) = &picture {
        write_picture(&mut report, scene, &path, (picture, file), grown, (cancel, &line))?;
    }
    Ok((report, interrupt.raised().is_none()))
}

fn write_path(report: &mut Report, path: &PathRows, file: &Path) -> Result<(), Error> {
    let kind = if is_standard(file) { PathFileKind::Text } else { PathFileKind::of(file)? };
    write(file, path.to_file(kind).as_bytes())?;
    report.path_file = Some(file.display().to_string());
    Ok(())
}

/// Writes the picture of a report, unless the work was interrupted before it was complete.
fn write_picture(
    report: &mut Report,
    scene: &Scene,
    path: &PathRows,
    (picture, file): (&Picture, &Path),
    grown: Option<GrownTrees>,
    (cancel, line): (&Cancel, &Line),
) -> Result<(), Error> {
    if let Some(StopReason::Memory) = cancel.reason() {
        note(&format!("{}: {} was not drawn", StoppedBy::Memory, file.display()));
        return Ok(());
    }
    line.say("drawing the picture");
    let caption = caption(report);
    let shown = Shown { scene, path: Some(path), verdict: None, report: Some(report), caption: &caption };
    match picture.bytes(&shown, grown, cancel, line)? {
        Some(bytes) => {
            write(file, &bytes)?;
            report.picture_file = Some(file.display().to_string());
        }
        None => note(&format!("{}: {} was not written", ended_by(cancel), file.display())),
    }
    Ok(())
}

/// How the picture of a run is drawn: with the field that has relaxed its path, if that can be drawn.
fn drawing(scene: &Scene, request: &Request, file: Option<&Path>, threads: u16) -> Drawing {
    let drawn = |file: &Path| FilmKind::of(file).is_some() || scene.picture_kind(file).is_ok();
    let shows_field = request.finish == Finish::Relax && scene.is_planar_world() && file.is_some_and(drawn);
    let field = shows_field.then(|| request.field.clone());
    Drawing { threads: Some(threads), field, ..Drawing::default() }
}

/// Prints the results: JSON on standard output, or a summary or table, which go to standard error when the path is on
/// standard output.
fn show(args: &Plan, reports: Vec<Report>, single: bool) -> Result<(), Error> {
    if args.json {
        return match reports.as_slice() {
            [only] if single => print(&only.to_json()?),
            _ => print_json(&Runs::new(reports)),
        };
    }
    let taken = args.out.as_deref().is_some_and(is_standard);
    let tell = |text: &str| match taken {
        true => {
            note(text);
            Ok(())
        }
        false => print(text),
    };
    match reports.as_slice() {
        [] => Ok(()),
        [only] if single => {
            tell(&summary(only))?;
            if only.solved { Ok(()) } else { tell("  nothing was written") }
        }
        runs => tell(&table(runs)),
    }
}

/// Writes every scene as one JSON and two OFF files.
fn export(folder: &Path, scenes: &[Scene]) -> Result<(), Error> {
    make_folder(folder)?;
    for scene in scenes {
        note(&format!("exported {}", scene.export(folder)?.display()));
    }
    Ok(())
}
