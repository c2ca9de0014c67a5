//! A run that is interrupted does little more, and comes to what a run comes to that stopped after its last whole iteration.
//!
//! Time is counted by a clock of the tests, which goes on by a step whenever it is read. So a budget of time ends a run at a
//! question that the test chooses, on every machine at the same one.

#![allow(clippy::print_stdout, reason = "the ignored test is a command that prints what it measured")]

mod counting;

use counting::{Counting, WORK};
use mp_plan::{Clock, Control, ErrorKind, Finish, Report, Request, RunStage, Scene, StoppedBy};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Readings of the clock so far.
static READ: AtomicU64 = AtomicU64::new(0);
/// The reading at which the time is up.
static LAST: AtomicU64 = AtomicU64::new(u64::MAX);
/// How much work was done by then.
static DONE: AtomicU64 = AtomicU64::new(u64::MAX);

/// The time between two readings: so long that no question is answered without the clock.
const STEP: Duration = Duration::from_millis(2);

fn now() -> Duration {
    let read = READ.fetch_add(1, Ordering::SeqCst);
    if read == LAST.load(Ordering::SeqCst) {
        DONE.store(WORK.load(Ordering::SeqCst), Ordering::SeqCst);
    }
    STEP * u32::try_from(read).unwrap()
}

/// The clock is one for all tests.
fn alone() -> MutexGuard<'static, ()> {
    static LOCK: Mutex<()> = Mutex::new(());
    LOCK.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Plans until the clock was read `readings` times by the planner.
fn until(scene: &Scene, request: &Request, readings: u64) -> Result<Report, mp_plan::Error> {
    READ.store(0, Ordering::SeqCst);
    LAST.store(readings, Ordering::SeqCst);
    DONE.store(u64::MAX, Ordering::SeqCst);
    WORK.store(0, Ordering::SeqCst);
    let mut request = request.clone();
    // Planning may take nine tenths of it.
    request.budget.time_s = Some((STEP * u32::try_from(readings).unwrap()).as_secs_f64() / 0.9);
    let mut control = Control { clock: Clock::new(now), ..Control::default() };
    scene.plan_with(&request, &mut control)
}

/// A few numbers that look random.
fn drawn(seed: u64, count: usize, below: u64) -> impl Iterator<Item = u64> {
    let mut x = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    (0..count).map(move |_| {
        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        3 + x % below
    })
}

/// Planners by name and with meta-planners, and settings that make an iteration long.
fn requests() -> Vec<Request> {
    let mut all: Vec<Request> = mp_plan::planners().map(|planner| Request::new(planner.name)).collect();
    for name in ["or-rrt", "or-rrt-connect", "restart-or-rrt", "or-restart-rrt-connect", "or-or-rrt"] {
        all.push(Request::new(name).set("slice", 1_000_000));
    }
    all.push(Request::new("or-rrt-connect").set("step", 1e-9));
    all.push(Request::new("restart-rrt-connect").set("unit", 3));
    all.push(Request::new("shared-rrt").set("batch", 1024));
    all.push(Request::new("shared-bi-rrt").set("batch", 1024));
    all.push(Request::new("or-shared-rrt").set("batch", 64));
    for name in ["rrt-connect", "rrt-con-con", "rrt-con-ext", "rrt", "aorrtc"] {
        all.push(Request::new(name).set("step", 1e-9));
    }
    all.push(Request::new("mvb-rrt").set("samples", 100_000));
    all.push(Request::new("utility-rrt").set("candidates", 100_000));
    all.push(Request::new("rrt-star").set("near", 1000));
    for name in ["prm", "lazy-prm"] {
        all.push(Request::new(name).set("neighbours", 1_000_000).set("cycles", "yes"));
    }
    for name in ["rrt-inputs", "rsrt"] {
        all.push(Request::new(name).set("inputs", 50_000));
    }
    all.push(Request::new("obstacle-geometry-prm").set("bands", 1_000_000));
    all.push(Request::new("obprm").set("directions", 1000));
    all.push(Request::new("rrs").set("snake-steps", 1_000_000));
    let motion = "discrete:0.0000001%".parse().unwrap();
    all.push(Request::new("rrt").motion(motion));
    all
}

/// After the time is up, a run samples, measures, checks and verifies a bounded number of times, whatever the planner and its settings.
#[test]
fn little_is_done_after_the_time_is_up() {
    let _alone = alone();
    let scene = Scene::new(Counting::new());
    let (mut ended, mut late) = (0, Vec::new());
    for (i, request) in requests().into_iter().enumerate() {
        for readings in drawn(i as u64 + 1, 4, 2000) {
            let Ok(report) = until(&scene, &request, readings) else { continue };
            let (done, all) = (DONE.load(Ordering::SeqCst), WORK.load(Ordering::SeqCst));
            if report.stopped_by != Some(StoppedBy::Time) {
                continue;
            }
            ended += usize::from(report.motion_checks > 0);
            let (more, most) = (all - done, 200 + 40 * report.nodes as u64);
            if more > most {
                late.push(format!(
                    "{} {:?} at {readings}: {more} more, {} nodes",
                    request.planner, request.settings, report.nodes
                ));
            }
        }
    }
    assert!(late.is_empty(), "{}", late.join("\n"));
    assert!(ended > 60, "{ended} runs were ended by the time");
}

/// What a run comes to that is ended within an iteration is what it comes to without that iteration: path, counts and roadmap.
#[test]
fn an_iteration_cut_short_counts_for_nothing() {
    let _alone = alone();
    let folder = std::env::temp_dir().join(format!("mp-stops-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let roadmaps: Vec<&str> = mp_plan::roadmap_planners().iter().map(|planner| planner.name).collect();
    let (mut compared, mut begun, mut solved, mut maps) = (0, 0, 0, 0);
    for name in ["easy", "rrs-low", "arm"] {
        let scene = Scene::find(name).unwrap();
        for (i, mut request) in requests().into_iter().enumerate() {
            let file =
                (name == "easy" && roadmaps.contains(&request.planner.as_str())).then(|| folder.join("map"));
            request.roadmap.clone_from(&file);
            let written = || file.as_ref().and_then(|file| std::fs::read(file).ok());
            for readings in drawn(100 + i as u64, 2, 1500) {
                file.iter().for_each(|file| drop(std::fs::remove_file(file)));
                let Ok(cut) = until(&scene, &request, readings) else { continue };
                let map = written();
                file.iter().for_each(|file| drop(std::fs::remove_file(file)));
                let mut whole = request.clone().iterations(cut.iterations);
                whole.budget.time_s = None;
                let case = format!("{name} {} {:?} at {readings}", request.planner, request.settings);
                let whole = match scene.plan(&whole) {
                    Ok(whole) => whole,
                    // The time was up before the planner would have been refused.
                    Err(e) => {
                        assert_eq!(e.kind(), ErrorKind::Planner, "{case}: {e}");
                        assert_eq!((cut.iterations, cut.solved), (0, false), "{case}");
                        continue;
                    }
                };
                let counts =
                    |r: &Report| (r.iterations, r.nodes, r.edges, r.components, r.motion_checks, r.rejected);
                assert_eq!(counts(&cut), counts(&whole), "{case}");
                let found = |r: &Report| [r.path_length_found, r.first_length].map(|l| l.map(f64::to_bits));
                assert_eq!(found(&cut), found(&whole), "{case}");
                assert_eq!(map, written(), "{case}");
                compared += 1;
                begun += usize::from(cut.iterations > 0);
                solved += usize::from(cut.solved);
                maps += usize::from(map.is_some());
                if cut.stages.iter().all(|stage| stage.ended_by.is_none()) {
                    assert_eq!(cut.fingerprint, whole.fingerprint, "{case}");
                }
            }
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(compared > 200 && begun > 150 && solved > 20 && maps > 10, "{compared} {begun} {solved} {maps}");
}

/// Plans with a budget of time of so many readings of the clock.
fn within(scene: &Scene, request: &Request, readings: u64) -> Report {
    READ.store(0, Ordering::SeqCst);
    LAST.store(u64::MAX, Ordering::SeqCst);
    let mut request = request.clone();
    request.budget.time_s = Some((STEP * u32::try_from(readings).unwrap()).as_secs_f64());
    let mut control = Control { clock: Clock::new(now), ..Control::default() };
    scene.plan_with(&request, &mut control).unwrap()
}

/// Five times the readings of the run that was planned last, which had all the time it wanted: no stage is cut short within so many.
fn plenty() -> u64 {
    5 * READ.load(Ordering::SeqCst)
}

/// The search may take nine tenths of the time, but a path that it has found by then is proved in all of it.
#[test]
fn a_path_that_was_found_is_proved_within_the_whole_time() {
    let _alone = alone();
    let (mut late, mut alike) = (0, 0);
    // Where the proof takes more than a tenth of planning.
    for name in ["arm", "easy"] {
        let scene = Scene::find(name).unwrap();
        for seed in 1..=8 {
            let request = Request::new("rrt-connect").seed(seed).finish(mp_plan::Finish::AsFound);
            // Proved within the search, which patience asks for.
            let request = request.set("patience", 10);
            let whole = within(&scene, &request, 100_000_000);
            assert!(whole.solved, "{name} {seed}: {:?}", whole.why);
            // Planning ends with the proof of its path.
            let planned = (whole.time_s / STEP.as_secs_f64()) as u64;
            let cut = within(&scene, &request, planned + planned / 20 + 30);
            assert_ne!(cut.stopped_by, Some(StoppedBy::Time), "{name} {seed}: {:?}", cut.stages);
            late += usize::from(cut.time_s > 0.9 * cut.stages.iter().map(|stage| stage.time_s).sum::<f64>());
            alike += usize::from(cut.solved && cut.path == whole.path);
        }
    }
    assert!(late > 6 && alike > 6, "{late} {alike}");
}

/// A path that is proved after the search has for its proof what the search has left.
#[test]
fn a_path_is_proved_in_what_the_search_has_left() {
    let _alone = alone();
    let (mut alike, mut unverified) = (0, 0);
    for name in ["arm", "easy"] {
        let scene = Scene::find(name).unwrap();
        for seed in 1..=8 {
            let request = Request::new("rrt-connect").seed(seed).finish(mp_plan::Finish::AsFound);
            let whole = within(&scene, &request, 100_000_000);
            assert!(whole.solved, "{name} {seed}: {:?}", whole.why);
            let took = |wanted| {
                let of_stage = whole.stages.iter().filter(|stage| stage.stage == wanted);
                (of_stage.map(|stage| stage.time_s).sum::<f64>() / STEP.as_secs_f64()) as u64
            };
            let (planning, proof) = (took(RunStage::Planning), took(RunStage::Verifying));
            let least = 10 * planning / 9 + 50;
            let enough = within(&scene, &request, least.max(planning + proof + 50));
            assert!(enough.solved && enough.path == whole.path, "{name} {seed}: {:?}", enough.stages);
            alike += 1;
            if planning + proof > least + proof / 10 {
                let report = within(&scene, &request, least);
                assert_eq!(
                    report.stopped_by,
                    Some(StoppedBy::Unverified),
                    "{name} {seed}: {:?}",
                    report.stages
                );
                unverified += 1;
            }
        }
    }
    assert!(alike == 16 && unverified > 6, "{alike} {unverified}");
}

/// A path that was not verified in time had all of the time.
#[test]
fn what_is_unverified_had_all_of_the_time() {
    let _alone = alone();
    let (mut unverified, mut solved) = (0, 0);
    for name in ["easy", "maze", "arm"] {
        let scene = Scene::find(name).unwrap();
        for seed in 1..=3 {
            let request = Request::new("rrt-connect").seed(seed);
            let planned = (within(&scene, &request, 100_000_000).time_s / STEP.as_secs_f64()) as u64;
            let readings = [2, 5, 10, 20, 40, 80, 160, 320, 640, 1280];
            let readings = readings.map(|more| planned + more * (planned / 100 + 1) + 10);
            let plenty = plenty();
            for readings in readings.into_iter().filter(|readings| *readings < plenty) {
                let report = within(&scene, &request, readings);
                solved += usize::from(report.solved);
                if report.stopped_by == Some(StoppedBy::Unverified) {
                    let used: f64 = report.stages.iter().map(|stage| stage.time_s).sum();
                    let all = (STEP * u32::try_from(readings).unwrap()).as_secs_f64();
                    assert!(used > 0.9 * all - 0.1, "{name} {seed} {readings}: {:?}", report.stages);
                    unverified += 1;
                }
            }
        }
    }
    assert!(solved > 20, "{solved} solved, {unverified} unverified");
}

/// Where the clock ends relaxing the path is another one than with more time, and the report says what ended it.
#[test]
fn relaxing_that_the_clock_ends_is_said() {
    let _alone = alone();
    let (mut ended, mut whole) = (0, 0);
    for name in ["rrs-low", "arm"] {
        let scene = Scene::find(name).unwrap();
        let mut request = Request::new("rrt-connect").seed(2);
        request.finish = Finish::Relax;
        let relaxed = scene.plan(&request).unwrap();
        assert_eq!(within(&scene, &request, 100_000_000).fingerprint, relaxed.fingerprint);
        for readings in drawn(7, 30, 3000).chain(drawn(8, 20, plenty())) {
            let cut = within(&scene, &request, readings);
            let relaxing = cut.stages.iter().find(|stage| stage.stage == RunStage::Relaxing);
            match relaxing.map(|stage| stage.ended_by) {
                Some(None) => {
                    assert_eq!(cut.fingerprint, relaxed.fingerprint, "{name} {readings}: {:?}", cut.stages);
                    whole += 1;
                }
                Some(by) => {
                    assert_eq!(by, Some(StoppedBy::Time), "{name} {readings}");
                    ended += 1;
                }
                None => assert!(!cut.solved, "{name} {readings}: {:?}", cut.stages),
            }
        }
    }
    assert!(ended > 15 && whole > 5, "{ended} ended, {whole} not");
}

/// A budget that is used up before planning begins.
#[test]
fn loading_that_takes_all_of_the_time_is_said() {
    let _alone = alone();
    for name in ["easy", "arm", "docks", "blade"] {
        let scene = Scene::find(name).unwrap();
        let request = Request::new(scene.default_planner());
        let report = within(&scene, &request, 1);
        assert!(report.is_not_begun() && !report.solved, "{name}: {report:?}");
        assert_eq!((report.stopped_by, report.iterations), (Some(StoppedBy::Time), 0));
        assert_eq!(report.stages[0].ended_by, Some(StoppedBy::Time));
        assert_eq!(report.why.as_deref(), Some("the time is up: loading took all of it"));
        assert_eq!((report.scene.as_str(), report.columns.len()), (scene.name(), scene.columns().len()));
        let cancelled = Control::default();
        cancelled.cancel.cancel();
        let mut cancelled = cancelled;
        let report = Scene::find(name).unwrap().plan_with(&request, &mut cancelled).unwrap();
        assert_eq!(report.stopped_by, Some(StoppedBy::Interrupted), "{name}");
    }
}

/// The time that this thread has worked.
fn worked() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::try_from(time).unwrap()
}

/// The same by the clock, on every shipped scene: `cargo test --release -p mp-plan --test stops -- --ignored --nocapture` prints how late
/// runs of 0.1 s of processor time end, the latest first.
#[test]
#[ignore = "measures time, and takes minutes"]
fn runs_end_within_50_ms_of_processor_time() {
    let (time, mut late) = (0.1, Vec::new());
    for name in mp_scenes::without_solution() {
        let scene = Scene::find(name).unwrap();
        for request in requests() {
            let began = worked();
            let mut control = Control { clock: Clock::new(worked), ..Control::default() };
            let Ok(report) = scene.plan_with(&request.clone().time(time), &mut control) else { continue };
            let by = (worked() - began).as_secs_f64() - time;
            let ended = report.stopped_by.map_or("solved", StoppedBy::word);
            let case =
                format!("{name} {} {:?}: {ended} {:?}", request.planner, request.settings, report.stages);
            if by > 0.02 {
                println!("{:7.1} ms  {case}", 1e3 * by);
            }
            late.push((by, case));
        }
    }
    late.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("{} runs, the latest:", late.len());
    for (by, case) in late.iter().take(20) {
        println!("{:7.1} ms  {case}", 1e3 * by);
    }
    assert!(late[0].0 < 0.05, "{:.1} ms late: {}", 1e3 * late[0].0, late[0].1);
}
